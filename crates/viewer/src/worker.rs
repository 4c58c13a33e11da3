//! Thread that runs the graphs: it loads scenes and methods, and runs a frame whenever the desired
//! state changes. It has a device of its own, so that the window never waits for a method.

use crate::desired_state::{DesiredState, Event, Loaded};
use crate::slot::{Lost, Slot};
use crate::stage::{Clock, Stage};
use skiagraph_compare::error::{CompareError, with_causes};
use skiagraph_compare::measuring::device::{self, GpuRequest};
use skiagraph_compare::sink::{Session, Silent};
use skiagraph_gpu::{block_on, device::Gpu, timing::Trust};
use skiagraph_graph::Sources;
use skiagraph_scene::{Scene, View};
use std::error::Error;
use std::sync::{Arc, mpsc};
use std::time::{Duration, Instant};
use std::{io, thread};

/// Commands of the window to the thread that runs the graphs.
pub enum Command {
    /// Run a frame of this state, and send it to the window.
    Show(Box<DesiredState>),
    /// Read the methods' files again; they may have changed.
    Reload,
    /// End the thread behind the frame that runs.
    End,
}

/// Handle of the thread that runs the graphs. The thread ends when the handle is dropped, which
/// waits for a frame that runs: a process that ends while a driver works may crash.
pub struct WorkerThread {
    commands: mpsc::Sender<Command>,
    thread: thread::JoinHandle<()>,
}

/// Longest time that a dropped handle waits for a frame.
const LAST_FRAME: Duration = Duration::from_secs(20);

impl WorkerThread {
    /// Starts the thread.
    ///
    /// # Errors
    /// If the system cannot create a thread.
    pub fn start(worker: Worker) -> io::Result<Self> {
        let (commands, received) = mpsc::channel();
        let named = thread::Builder::new().name("methods".into());
        let thread = named.spawn(move || worker.work(&received))?;
        Ok(Self { commands, thread })
    }

    /// Returns the sender of commands to the thread.
    pub fn commands(&self) -> &mpsc::Sender<Command> {
        &self.commands
    }
}

impl Drop for WorkerThread {
    fn drop(&mut self) {
        let began = Instant::now();
        // A failed send means that it has ended.
        let _ = self.commands.send(Command::End);
        while !self.thread.is_finished() && began.elapsed() < LAST_FRAME {
            thread::sleep(Duration::from_millis(2));
        }
    }
}

/// Function that loads a scene by name. It returns the scene, and further views that the window
/// lists before the scene's own. The viewer calls it on a thread of its own, and shows the text of
/// an error.
pub type LoadScene =
    Box<dyn Fn(&str) -> Result<(Scene, Vec<View>), Box<dyn Error + Send + Sync>> + Send>;

/// Function that sends an event to the window; its thread calls it.
pub type Tell = Box<dyn Fn(Event) + Send>;

/// State of the thread that runs the graphs: the GPU, the scene and the methods.
pub struct Worker {
    request: GpuRequest,
    load_scene: LoadScene,
    gpu: Gpu,
    timing: bool,
    sources: Box<dyn Sources>,
    stage: Option<Stage>,
    /// A scene that could not be loaded.
    failed_scene: Option<String>,
    slots: Vec<Slot>,
    began: Instant,
    tell: Tell,
}

impl Worker {
    /// Creates the worker for a GPU that was opened by `request`, by which it is opened again after
    /// it is lost. `sources` has the methods' files, and `tell` gets the events.
    pub fn new(
        gpu: Gpu,
        (request, load_scene): (GpuRequest, LoadScene),
        sources: Box<dyn Sources>,
        tell: Tell,
    ) -> Self {
        Self {
            timing: block_on(device::timestamp_trust(&gpu)) == Trust::Trusted,
            request,
            load_scene,
            gpu,
            sources,
            stage: None,
            failed_scene: None,
            slots: Vec::new(),
            began: Instant::now(),
            tell,
        }
    }

    /// Runs commands until [`Command::End`], or until all senders are dropped.
    pub fn work(mut self, commands: &mpsc::Receiver<Command>) {
        let mut desired: Option<DesiredState> = None;
        while let Ok(first) = commands.recv() {
            let mut is_changed = false;
            let mut reload = false;
            // The last one of several counts.
            for command in [first].into_iter().chain(commands.try_iter()) {
                match command {
                    Command::Show(next) => (desired, is_changed) = (Some(*next), true),
                    Command::Reload => reload = true,
                    Command::End => return,
                }
            }
            if reload {
                for slot in &mut self.slots {
                    is_changed |= slot.read(&*self.sources);
                }
            }
            if let Some(desired) = desired.as_ref().filter(|_| is_changed)
                && let Err(error) = block_on(self.show(desired))
            {
                (self.tell)(Event::Broken(error.to_string()));
            }
        }
    }

    async fn show(&mut self, desired: &DesiredState) -> Result<(), CompareError> {
        if !self.load(desired) {
            return Ok(());
        }
        self.fill_slots(desired)?;
        // A device that a method has lost is opened anew once, without that method.
        for _ in 0..=desired.methods.len() {
            let session = Session::new(&self.gpu, &Silent);
            let Some(stage) = &mut self.stage else {
                return Err(CompareError::Input("no scene is loaded".into()));
            };
            let clock = Clock {
                has_timestamps: self.timing,
                seconds: self.began.elapsed().as_secs_f32(),
            };
            let methods = (&mut self.slots[..], &*self.sources);
            match stage
                .take_snapshot(session, methods, desired, clock)
                .await?
            {
                Ok(snapshot) => {
                    (self.tell)(Event::Frame(Box::new(snapshot)));
                    return Ok(());
                }
                Err(Lost) => self.reopen()?,
            }
        }
        Ok(())
    }

    /// Loads the scene, if it is another one; says whether there is one.
    fn load(&mut self, desired: &DesiredState) -> bool {
        let loaded = self.stage.as_ref().map(|stage| &stage.name);
        if loaded == Some(&desired.scene) {
            return true;
        }
        if self.failed_scene.as_ref() == Some(&desired.scene) {
            return false;
        }
        match (self.load_scene)(&desired.scene) {
            Ok((scene, views)) => {
                let scene = Arc::new(scene);
                let is_other = |view: &&View| views.iter().all(|listed| listed.name != view.name);
                let other_views: Vec<View> = scene.views.iter().filter(is_other).cloned().collect();
                let views = [views, other_views].concat();
                let loaded = Loaded { scene, views };
                (self.tell)(Event::Scene(desired.scene.clone(), Ok(loaded.clone())));
                self.slots.iter_mut().for_each(Slot::forget_device);
                self.failed_scene = None;
                self.stage = Some(Stage::new(&desired.scene, loaded));
                true
            }
            Err(error) => {
                self.failed_scene = Some(desired.scene.clone());
                let event = Event::Scene(desired.scene.clone(), Err(with_causes(&*error)));
                (self.tell)(event);
                false
            }
        }
    }

    /// A slot for each method; the device gets the features that they can make use of.
    fn fill_slots(&mut self, desired: &DesiredState) -> Result<(), CompareError> {
        let mut before = std::mem::take(&mut self.slots);
        for method in &desired.methods {
            let index = before.iter().position(|slot| slot.name == method.name);
            self.slots.push(match index {
                Some(index) => before.swap_remove(index),
                None => {
                    let mut slot = Slot::new(&method.name);
                    slot.read(&*self.sources);
                    slot
                }
            });
        }
        let graphs = self.slots.iter().filter_map(Slot::graph);
        let useful = graphs.fold(wgpu::Features::empty(), |useful, it| useful | it.features());
        let experimental = wgpu::Features::all_experimental_mask();
        let missing = (useful & self.gpu.adapter.features()) - self.gpu.device.features();
        if (missing - experimental).is_empty() {
            Ok(())
        } else {
            self.reopen()
        }
    }

    /// Opens the device anew, with what the methods can make use of.
    fn reopen(&mut self) -> Result<(), CompareError> {
        let graphs: Vec<_> = self.slots.iter().filter_map(Slot::graph).collect();
        let gpu = device::open(&self.request, graphs)?;
        self.gpu = gpu;
        self.slots.iter_mut().for_each(Slot::forget_device);
        if let Some(stage) = &mut self.stage {
            *stage = Stage::new(&stage.name, stage.loaded.clone());
        }
        Ok(())
    }
}
