//! State of the window: its pictures, and the user's choices. It uses no window toolkit, so tests
//! drive it as the window does.

use crate::desired_state::{
    DesiredMethod, DesiredState, Event, FrameSnapshot, Loaded, MethodSnapshot,
};
use crate::drawn::{Drawn, Reading, Show, draw};
use crate::flight;
use crate::ground_truth::{Answer, GroundTruthThread};
use crate::worker::{Command, WorkerThread};
use glam::DVec3;
use skiagraph_graph::{Capture, ParamValue};
use skiagraph_scene::{Light, LightKind, View};
use std::{collections::VecDeque, sync::mpsc};

/// Number of the last frames whose times a pane shows.
pub const HISTORY: usize = 120;

/// Effect of dragging the pointer in a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drag {
    /// Turn the camera in place.
    Look,
    /// Move the camera around the middle of the scene.
    Orbit,
    /// Move the camera sideways, up and down.
    Pan,
    /// Turn the light, or move a point light.
    Light,
}

/// One of the two pictures side by side.
#[derive(Default)]
pub struct Pane {
    /// Kind of picture to show.
    pub show: Show,
    /// Mip or layer, channel and colours with which a material is shown.
    pub reading: Reading,
    /// Picture, legend and numbers as drawn last.
    pub drawn: Drawn,
    /// Counter that increases whenever `drawn` changes.
    pub version: u64,
    /// GPU times of the last frames in milliseconds, the newest last; wall times of frames without
    /// GPU times.
    pub history: VecDeque<f64>,
    is_stale: bool,
}

/// Channels between the window and the threads that run the graphs and trace the reference.
pub struct Channels {
    /// Handle of the thread that runs the graphs.
    pub worker: WorkerThread,
    /// Events of the thread that runs the graphs.
    pub events: mpsc::Receiver<Event>,
    /// Handle of the thread that traces the reference.
    pub ground_truth: GroundTruthThread,
    /// Answers of the thread that traces the reference.
    pub answers: mpsc::Receiver<Answer>,
}

/// Scenes and methods that the user can choose, and the name of the GPU.
#[derive(Clone, Default)]
pub struct Choices {
    /// Names of the scenes.
    pub scenes: Vec<String>,
    /// Names of the presets, and paths given on the command line.
    pub methods: Vec<String>,
    /// Name of the GPU. If there are no GPU times, the reason follows.
    pub adapter: String,
}

/// State of the viewer's window: the desired state, the newest frame, its pictures, and the user's
/// choices.
pub struct Viewer {
    channels: Channels,
    /// Scenes and methods that the user can choose.
    pub choices: Choices,
    /// State that the window asks the thread that runs the graphs to show.
    pub desired: DesiredState,
    sent: Option<DesiredState>,
    /// The loaded scene; `None` until it is loaded.
    pub loaded: Option<Loaded>,
    /// The newest frame; `None` before the first.
    pub snapshot: Option<FrameSnapshot>,
    /// The newest answer of the reference to the newest frame; `None` if there is none.
    pub answer: Option<Answer>,
    /// The two pictures. The first is shown with one method, both with two.
    pub panes: [Pane; 2],
    /// Effect of dragging the pointer in a picture.
    pub drag: Drag,
    /// True to run frame after frame, even if nothing changes.
    pub keep_running: bool,
    /// True to trace the reference for every shown frame.
    pub is_judged: bool,
    /// The last message to the user, and true if it is an error; `None` if there is none.
    pub notice: Option<(String, bool)>,
}

impl Viewer {
    /// Creates the state of a window that shows nothing yet.
    pub fn new(channels: Channels, choices: Choices, desired: DesiredState) -> Self {
        Self {
            channels,
            choices,
            desired,
            sent: None,
            loaded: None,
            snapshot: None,
            answer: None,
            panes: Default::default(),
            drag: Drag::Look,
            keep_running: false,
            is_judged: false,
            notice: None,
        }
    }

    /// Takes in events and answers of the threads, and sends them the desired state if it has
    /// changed. Returns true if there is something new to see.
    pub fn update(&mut self) -> bool {
        let mut is_new = false;
        while let Ok(event) = self.channels.events.try_recv() {
            self.on_event(event);
            is_new = true;
        }
        while let Ok(answer) = self.channels.answers.try_recv() {
            if self.fits(&answer) {
                self.answer = Some(answer);
                self.redraw();
                is_new = true;
            }
        }
        self.request_ground_truth();
        for index in 0..self.panes.len() {
            self.draw(index);
        }
        if self.sent.as_ref() != Some(&self.desired) {
            self.sent = Some(self.desired.clone());
            let command = Command::Show(Box::new(self.desired.clone()));
            if self.channels.worker.commands().send(command).is_err() {
                self.notify_error("the thread that runs the methods has ended: start anew");
            }
        }
        is_new
    }

    /// True if an answer is about what is shown.
    fn fits(&self, answer: &Answer) -> bool {
        let mut shown = self.snapshot.iter();
        shown.any(|snapshot| answer.question.is_like(&snapshot.question))
    }

    fn on_event(&mut self, event: Event) {
        match event {
            Event::Scene(name, Ok(loaded)) if name == self.desired.scene => {
                if self.desired.view.is_none() {
                    self.desired.view = loaded.views.first().cloned();
                }
                self.loaded = Some(loaded);
                self.notice = None;
            }
            Event::Scene(name, Err(why)) if name == self.desired.scene => self.notify_error(&why),
            Event::Scene(..) => {}
            Event::Broken(why) => self.notify_error(&why),
            Event::Frame(snapshot) => {
                for (pane, method) in self.panes.iter_mut().zip(&snapshot.methods) {
                    pane.history
                        .push_back(method.gpu_ms.unwrap_or(method.wall_ms));
                    if pane.history.len() > HISTORY {
                        pane.history.pop_front();
                    }
                }
                // A scene is chosen by its first frame, which says where it is seen from.
                let is_newest = self.sent.as_ref() == Some(&snapshot.desired);
                self.snapshot = Some(*snapshot);
                let answer = self.answer.take();
                self.answer = answer.filter(|answer| self.fits(answer));
                self.redraw();
                if self.keep_running && is_newest {
                    self.desired.frame += 1;
                }
            }
        }
    }

    /// Shows an error message to the user.
    pub fn notify_error(&mut self, what: &str) {
        self.notice = Some((what.to_owned(), true));
    }

    /// Asks for the reference while a pane shows it.
    fn request_ground_truth(&mut self) {
        let shown = self.panes.iter().take(self.desired.methods.len());
        let is_shown = shown.into_iter().any(|pane| pane.show == Show::Difference);
        match &self.snapshot {
            Some(snapshot) if self.is_judged || is_shown => {
                self.channels.ground_truth.ask(&snapshot.question)
            }
            _ => self.channels.ground_truth.forget(),
        }
    }

    /// True if the newest frame is of the desired state.
    pub fn is_current(&self) -> bool {
        let shown = self.snapshot.as_ref().map(|snapshot| &snapshot.desired);
        shown == Some(&self.desired) && self.sent.as_ref() == Some(&self.desired)
    }

    /// Everything is drawn anew.
    fn redraw(&mut self) {
        self.panes.iter_mut().for_each(|pane| pane.is_stale = true);
    }

    fn draw(&mut self, index: usize) {
        let (pane, answer) = (&mut self.panes[index], self.answer.as_ref());
        let Some(snapshot) = self.snapshot.as_ref().filter(|_| pane.is_stale) else {
            return;
        };
        pane.drawn = draw(snapshot, index, &pane.show, &pane.reading, answer);
        pane.version += 1;
        pane.is_stale = false;
    }

    /// Sets the kind of picture that the pane with this index shows.
    pub fn show(&mut self, index: usize, show: Show) {
        let pane = &mut self.panes[index];
        if pane.show != show {
            if let Some(method) = self.desired.methods.get_mut(index) {
                method.material = match &show {
                    Show::Material(capture) => Some(capture.clone()),
                    _ => None,
                };
            }
            pane.show = show;
            pane.reading.part = 0;
            pane.is_stale = true;
        }
    }

    /// Sets how the pane with this index shows a material.
    pub fn read(&mut self, index: usize, reading: Reading) {
        let pane = &mut self.panes[index];
        if pane.reading != reading {
            pane.reading = reading;
            pane.is_stale = true;
        }
    }

    /// Returns the newest frame of the method with this index; `None` if there is no frame, or its
    /// method with this index is another one.
    pub fn method(&self, index: usize) -> Option<&MethodSnapshot> {
        let method = self.snapshot.as_ref()?.methods.get(index)?;
        let desired = self.desired.methods.get(index)?;
        (method.name == desired.name).then_some(method)
    }

    /// Replaces the method in the pane with this index by the one named `name`, with default
    /// params.
    pub fn choose_method(&mut self, index: usize, name: &str) {
        let name = name.to_owned();
        let method = DesiredMethod {
            name,
            ..DesiredMethod::default()
        };
        match self.desired.methods.get_mut(index) {
            Some(place) if place.name == method.name => return,
            Some(place) => *place = method,
            None => self.desired.methods.push(method),
        }
        if let Show::Material(_) = self.panes[index].show {
            self.show(index, Show::Shaded);
        }
        self.panes[index].history.clear();
    }

    /// Sets a param of the method with this index. A value equal to the default is kept as a set
    /// value, since dropping it would need a new plan.
    pub fn set_param(&mut self, index: usize, name: &str, value: ParamValue) {
        if let Some(method) = self.desired.methods.get_mut(index) {
            method.params.insert(name.to_owned(), value);
        }
    }

    /// Changes to the scene of this name, and to its first view.
    pub fn choose_scene(&mut self, name: &str) {
        if self.desired.scene != name {
            self.desired.scene = name.to_owned();
            self.desired.view = None;
            self.loaded = None;
        }
    }

    /// Changes to the view of this name, if the scene has one.
    pub fn choose_view(&mut self, name: &str) {
        let mut views = self.loaded.iter().flat_map(|loaded| &loaded.views);
        if let Some(view) = views.find(|view| view.name == name) {
            self.desired.view = Some(view.clone());
        }
    }

    /// Lists the materials that each pass of the method with this index writes, each after its
    /// pass, in the order of the passes.
    pub fn steps(&self, index: usize) -> Vec<Capture> {
        let passes = self.method(index).into_iter().flat_map(|it| &it.passes);
        let captures = passes.flat_map(|pass| {
            pass.writes
                .iter()
                .map(|material| Capture::new(material).with_after(&pass.name))
        });
        captures.collect()
    }

    /// Shows the next material in the order of [`steps`](Self::steps) in the pane with this index,
    /// or the previous one if `forward` is false; at the ends it stays. A pane that shows none of
    /// them gets the first, or the last if `forward` is false. Without steps nothing changes.
    pub fn step(&mut self, index: usize, forward: bool) {
        let steps = self.steps(index);
        let at = match &self.panes[index].show {
            Show::Material(capture) => steps.iter().position(|step| step == capture),
            _ => None,
        };
        let last = steps.len().saturating_sub(1);
        let next = match (at, forward) {
            (Some(at), true) => (at + 1).min(last),
            (Some(at), false) => at.saturating_sub(1),
            (None, true) => 0,
            (None, false) => last,
        };
        if let Some(step) = steps.into_iter().nth(next) {
            self.show(index, Show::Material(step));
        }
    }

    /// Returns the low and high corner of the scene's box; the unit cube's without a scene.
    fn bounds(&self) -> (DVec3, DVec3) {
        let scene = self.loaded.as_ref().map(|loaded| &loaded.scene);
        let bounds = scene.and_then(|scene| scene.mesh.bounds());
        bounds.map_or((DVec3::ZERO, DVec3::ONE), |(min, max)| {
            (min.as_dvec3(), max.as_dvec3())
        })
    }

    /// Returns the centre of the scene's bounding box and half its diagonal, the scene's radius, in
    /// scene units.
    pub fn extent(&self) -> (DVec3, f64) {
        let (min, max) = self.bounds();
        let radius = (max - min).length() * 0.5;
        ((min + max) * 0.5, radius.max(f64::MIN_POSITIVE))
    }

    /// Applies a drag of the pointer by `by`, to the right and down. Camera and light turn by so
    /// many radians; the eye of [`Drag::Pan`] moves by so many times its
    /// [pace](flight::pace).
    pub fn dragged(&mut self, drag: Drag, by: [f64; 2]) {
        let (centre, radius) = self.extent();
        let Some(view) = &mut self.desired.view else {
            return;
        };
        let [x, y] = by;
        let mut moved = view.clone();
        match drag {
            Drag::Look => flight::look(&mut moved, -x, -y),
            Drag::Orbit => {
                let distance = moved.eye.distance(centre);
                let distance = distance.clamp(radius * 0.05, radius * 4.0);
                flight::orbit(&mut moved, -x, -y, distance);
            }
            Drag::Pan => flight::fly(&mut moved, DVec3::new(-x, y, 0.0), self.bounds()),
            Drag::Light => {
                if let Some((name, mut light)) = self.light() {
                    flight::turn_light(&mut light, &moved, x, y, centre);
                    moved.light = Some(Light { name, kind: light });
                }
            }
        }
        self.look_from(moved);
    }

    /// Moves the eye by `by` along its right, up and forward directions, in multiples of its
    /// [pace](flight::pace).
    pub fn fly(&mut self, by: DVec3) {
        if let Some(mut view) = self.desired.view.clone() {
            flight::fly(&mut view, by, self.bounds());
            self.look_from(view);
        }
    }

    /// Sets the desired view, unless it is invalid.
    pub fn look_from(&mut self, view: View) {
        if view.check().is_ok() {
            self.desired.view = Some(view);
        }
    }

    /// Returns the name and kind of the first light of the desired view; `None` without a view or
    /// scene.
    pub fn light(&self) -> Option<(String, LightKind)> {
        let view = self.desired.view.as_ref()?;
        let lights = self.loaded.as_ref()?.scene.lights_of(view);
        let light = lights.into_iter().next()?;
        Some((light.name, light.kind))
    }
}
