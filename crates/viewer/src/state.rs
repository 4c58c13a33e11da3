//! The window's state: the pictures, and the choices made in it. It knows no toolkit: tests drive
//! it as the window does.

use crate::desired_state::{
    DesiredMethod, DesiredState, Event, FrameSnapshot, Loaded, MethodSnapshot,
};
use crate::drawn::{Drawn, Reading, Show, draw};
use crate::flight;
use crate::ground_truth::{Answer, GroundTruthThread};
use crate::worker::Command;
use glam::DVec3;
use skiagraph_graph::{Capture, ParamValue};
use skiagraph_scene::{Light, LightKind, View};
use std::{collections::VecDeque, sync::mpsc};

/// Frames whose times are kept.
pub const HISTORY: usize = 120;

/// Meaning of a press and a move of the pointer in a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drag {
    /// Look around.
    Look,
    /// Go around the middle of the scene.
    Orbit,
    /// Shift the eye.
    Pan,
    /// Turn the light.
    Light,
}

/// One of the pictures.
#[derive(Default)]
pub struct Pane {
    /// Kind of picture that it shows.
    pub show: Show,
    /// How a material is shown.
    pub reading: Reading,
    /// The picture.
    pub drawn: Drawn,
    /// Counts up with each new picture.
    pub version: u64,
    /// GPU times of the last frames, or wall times where there are none, milliseconds.
    pub history: VecDeque<f64>,
    is_stale: bool,
}

/// Channels to and from the other threads.
pub struct Channels {
    /// To that of the graphs.
    pub commands: mpsc::Sender<Command>,
    /// From it.
    pub events: mpsc::Receiver<Event>,
    /// To that of the reference.
    pub ground_truth: GroundTruthThread,
    /// From it.
    pub answers: mpsc::Receiver<Answer>,
}

/// Scenes and methods to choose from.
#[derive(Clone, Default)]
pub struct Choices {
    /// Scenes by name.
    pub scenes: Vec<String>,
    /// Presets by name, and the paths of the command line.
    pub methods: Vec<String>,
    /// The GPU, and why there are no GPU times, if there are none.
    pub adapter: String,
}

/// The state of the window.
pub struct Viewer {
    channels: Channels,
    /// Scenes and methods to choose from.
    pub choices: Choices,
    /// The state that the window asks for.
    pub desired: DesiredState,
    sent: Option<DesiredState>,
    /// The scene that is there.
    pub loaded: Option<Loaded>,
    /// The newest frame.
    pub snapshot: Option<FrameSnapshot>,
    /// The newest answer, if it is to the newest frame.
    pub answer: Option<Answer>,
    /// The pictures; as many are shown as there are methods.
    pub panes: [Pane; 2],
    /// Meaning of a drag.
    pub drag: Drag,
    /// Run a frame after the other, though nothing changes.
    pub keep_running: bool,
    /// Trace the reference of what is shown.
    pub is_judged: bool,
    /// The last notice, and whether it is an error.
    pub notice: Option<(String, bool)>,
}

impl Viewer {
    /// Shows nothing yet.
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

    /// Takes in the events and answers of the threads, and sends them a changed desired state.
    /// Returns whether there is something new to see.
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
            if self.channels.commands.send(command).is_err() {
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

    /// Shows what went wrong.
    pub fn notify_error(&mut self, what: &str) {
        self.notice = Some((what.to_owned(), true));
    }

    /// Asks for the reference while it is shown.
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

    /// True if the picture is of the desired state.
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

    /// Sets the kind of picture that the pane shows from now on.
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

    /// How the pane shows a material from now on.
    pub fn read(&mut self, index: usize, reading: Reading) {
        let pane = &mut self.panes[index];
        if pane.reading != reading {
            pane.reading = reading;
            pane.is_stale = true;
        }
    }

    /// The newest frame of a method, if it is of that method.
    pub fn method(&self, index: usize) -> Option<&MethodSnapshot> {
        let method = self.snapshot.as_ref()?.methods.get(index)?;
        let desired = self.desired.methods.get(index)?;
        (method.name == desired.name).then_some(method)
    }

    /// Another method in a pane, with its defaults.
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

    /// Sets a param; one at its default stays named, so that only its value changes.
    pub fn set_param(&mut self, index: usize, name: &str, value: ParamValue) {
        if let Some(method) = self.desired.methods.get_mut(index) {
            method.params.insert(name.to_owned(), value);
        }
    }

    /// Another scene, from its first view.
    pub fn choose_scene(&mut self, name: &str) {
        if self.desired.scene != name {
            self.desired.scene = name.to_owned();
            self.desired.view = None;
            self.loaded = None;
        }
    }

    /// Another view of the scene.
    pub fn choose_view(&mut self, name: &str) {
        let mut views = self.loaded.iter().flat_map(|loaded| &loaded.views);
        if let Some(view) = views.find(|view| view.name == name) {
            self.desired.view = Some(view.clone());
        }
    }

    /// Lists what each pass writes, in the order of the passes.
    pub fn steps(&self, index: usize) -> Vec<Capture> {
        let passes = self.method(index).into_iter().flat_map(|it| &it.passes);
        let captures = passes.flat_map(|pass| {
            pass.writes.iter().map(|material| Capture {
                material: material.clone(),
                after: Some(pass.name.clone()),
            })
        });
        captures.collect()
    }

    /// Shows what the next or the previous pass writes.
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

    /// Middle and radius of the scene.
    pub fn extent(&self) -> (DVec3, f64) {
        let bounds = self
            .loaded
            .as_ref()
            .and_then(|loaded| loaded.scene.mesh.bounds());
        bounds.map_or((DVec3::ZERO, 1.0), |(min, max)| {
            let (min, max) = (min.as_dvec3(), max.as_dvec3());
            (
                (min + max) * 0.5,
                ((max - min).length() * 0.5).max(f64::MIN_POSITIVE),
            )
        })
    }

    /// Turns camera or light by so many radians, or shifts the eye by these shares of the scene.
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
                let distance = moved
                    .eye
                    .distance(centre)
                    .clamp(radius * 0.05, radius * 4.0);
                flight::orbit(&mut moved, -x, -y, distance);
            }
            Drag::Pan => flight::fly(&mut moved, DVec3::new(-x, y, 0.0) * radius * 0.5),
            Drag::Light => {
                if let Some((name, mut light)) = self.light() {
                    flight::turn_light(&mut light, &moved, x, y, centre);
                    moved.light = Some(Light { name, kind: light });
                }
            }
        }
        self.look_from(moved);
    }

    /// Moves the eye along its own right, up and forward, by shares of the scene.
    pub fn fly(&mut self, by: DVec3) {
        let (_, radius) = self.extent();
        if let Some(mut view) = self.desired.view.clone() {
            flight::fly(&mut view, by * radius);
            self.look_from(view);
        }
    }

    /// Takes a view that can be one.
    pub fn look_from(&mut self, view: View) {
        if view.check().is_ok() {
            self.desired.view = Some(view);
        }
    }

    /// The light of the desired state, with its name.
    pub fn light(&self) -> Option<(String, LightKind)> {
        let view = self.desired.view.as_ref()?;
        let lights = self.loaded.as_ref()?.scene.lights_of(view);
        let light = lights.into_iter().next()?;
        Some((light.name, light.kind))
    }
}
