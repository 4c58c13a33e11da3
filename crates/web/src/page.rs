//! The worker that owns the device: shows methods and their materials.

use crate::answer::{Answer, fault, json, parsed, rgba};
use crate::documents::{Files, sources};
use crate::measure;
use crate::stage::{Camera, loaded};
use serde::Deserialize;
use serde_json::json;
use skiagraph_compare::graphs::argument::MethodArgument;
use skiagraph_compare::graphs::shadow_method::Outputs;
use skiagraph_compare::measuring::device;
use skiagraph_compare::records::results::Adapter;
use skiagraph_compare::sink::{Session, Silent};
use skiagraph_gpu::device::{Gpu, Wanted};
use skiagraph_graph::{Capture, Sources};
use skiagraph_passes::EmbeddedSources;
use skiagraph_reference::Image;
use skiagraph_viewer::live::{
    Clock, DesiredMethod, DesiredState, FrameSnapshot, Loaded, MethodSnapshot, Reading, Show, Slot,
    Stage, draw,
};
use std::cell::{Cell, RefCell};
use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Duration;
use wasm_bindgen::prelude::*;

/// Longest time that a frame may take; the browser itself ends most devices before.
const TIMEOUT: Duration = Duration::from_secs(30);

/// Adapter as the browser describes it.
#[derive(Deserialize)]
struct Description {
    #[serde(default)]
    vendor: String,
    #[serde(default)]
    architecture: String,
    #[serde(default)]
    description: String,
    #[serde(default)]
    browser: String,
}

/// Request for a frame of a method.
#[derive(Deserialize)]
struct Request {
    method: String,
    #[serde(default)]
    document: Document,
    view: Camera,
    light: Option<usize>,
    size: [u32; 2],
    #[serde(default)]
    timed: bool,
}

/// A document of the user's own.
#[derive(Default, Deserialize)]
struct Document {
    files: Files,
}

/// A scene on the device and a method on it.
struct Shows {
    stage: Stage,
    /// The two methods that were shown last, so that two beside each other stay prepared.
    slots: Vec<Slot>,
    files: Files,
}

/// The last frame, with what it was asked for.
struct Last {
    snapshot: FrameSnapshot,
    files: Files,
}

/// The device of the page, with the method that it shows.
#[wasm_bindgen]
pub struct Page {
    gpu: Gpu,
    lost: js_sys::Function,
    adapter: RefCell<Adapter>,
    /// True if the timestamps were checked.
    is_checked: Cell<bool>,
    shows: RefCell<Option<Shows>>,
    last: RefCell<Option<Last>>,
}

/// A frame of a method.
#[wasm_bindgen(getter_with_clone)]
pub struct Shown {
    /// JSON with times, memory, passes and the names of the materials.
    pub json: String,
    /// The scene under the light that the method lets through, four bytes a pixel.
    pub rgba: Vec<u8>,
    /// The triangle that each pixel shows.
    pub ids: Vec<u32>,
    /// The share of light of each pixel.
    pub visibility: Vec<f32>,
    /// The verdict of each pixel: 0 background to 4 uncertain.
    pub status: Vec<u32>,
}

/// A picture of a material.
#[wasm_bindgen(getter_with_clone)]
pub struct Picture {
    /// Four bytes a pixel.
    pub rgba: Vec<u8>,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Meaning of the colours.
    pub legend: String,
}

#[wasm_bindgen]
impl Page {
    /// Opens the browser's device. `adapter` is JSON with what the browser tells of its adapter
    /// (`vendor`, `architecture`, `description`, `browser`); `lost` is called with the reason when
    /// the device is lost.
    ///
    /// # Errors
    /// The browser has no WebGPU, or gives no device.
    pub async fn open(adapter: &str, lost: js_sys::Function) -> Answer<Page> {
        let browser: Description = parsed(adapter)?;
        let wanted = Wanted::default().with_features(wgpu::Features::all());
        let opened = skiagraph_gpu::device::request(&wanted).await;
        let mut gpu = opened.map_err(fault)?;
        gpu.timeout = Some(TIMEOUT);
        let of_callback = lost.clone();
        gpu.device
            .set_device_lost_callback(move |_, reason| tell_lost(&of_callback, &reason));
        let mut adapter = device::adapter(gpu.adapter.get_info());
        let words = [&browser.vendor, &browser.architecture, &browser.description];
        let words = words.map(|word| word.trim()).into_iter();
        let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
        adapter.name = if words.is_empty() {
            "a GPU without a name".to_owned()
        } else {
            words.join(" ")
        };
        adapter.driver = browser.browser;
        let (is_checked, shows, last) = Default::default();
        Ok(Self {
            gpu,
            lost,
            adapter: RefCell::new(adapter),
            is_checked,
            shows,
            last,
        })
    }

    /// Returns JSON that describes the adapter: its `name`, `driver` (the browser) and `backend`;
    /// whether its timestamps are `checked`, and why they are not believed, if so (`timestamps`).
    ///
    /// # Errors
    /// None.
    pub fn adapter(&self) -> Answer<String> {
        let (limits, adapter) = (self.gpu.device.limits(), self.adapter.borrow());
        json(&json!({
            "name": adapter.name,
            "driver": adapter.driver,
            "backend": adapter.backend,
            "kind": adapter.device_type,
            "checked": self.is_checked.get(),
            "timestamps": adapter.gpu_unavailable.clone().unwrap_or_default(),
            "limits": {
                "texture": limits.max_texture_dimension_2d,
                "buffer": limits.max_storage_buffer_binding_size,
            },
        }))
    }

    /// Shows a frame of a method on the worker's scene. `request` is JSON with the `method` as the
    /// command line writes it, the files of a `document` of the user's own, `view`, `light` and
    /// `size`; with `timed`, every pass runs.
    ///
    /// # Errors
    /// A document with faults; a method that cannot run here. The page asks for one frame after
    /// another.
    pub async fn show(&self, request: &str) -> Answer<Shown> {
        let request: Request = parsed(request)?;
        let files = request.document.files;
        let argument = MethodArgument::new(&request.method);
        let scene = loaded()?;
        let desired = DesiredState {
            scene: scene.name.clone(),
            view: Some(request.view.view(&scene, request.light)),
            size: request.size,
            methods: vec![DesiredMethod {
                name: argument.preset.clone(),
                ..DesiredMethod::default()
            }],
            all_passes: request.timed,
            frame: 0,
        };
        let snapshot = self.snapshot(desired, &files, Some(&argument)).await?;
        let shown = shown(&snapshot);
        self.last.replace(Some(Last { snapshot, files }));
        shown
    }

    /// Returns a picture of a material of the method that was shown last.
    ///
    /// # Errors
    /// Nothing was shown; a material that is not there, or has no picture.
    pub async fn material(&self, name: &str) -> Answer<Picture> {
        let of_last = |last: &Last| (last.snapshot.desired.clone(), last.files.clone());
        let before = self.last.borrow().as_ref().map(of_last);
        let (mut desired, files) = before.ok_or_else(|| fault("no method was shown yet"))?;
        let capture = Capture::new(name);
        desired.methods[0].material = Some(capture.clone());
        let snapshot = self.snapshot(desired, &files, None).await?;
        let drawn = draw(
            &snapshot,
            0,
            &Show::Material(capture),
            &Reading::default(),
            None,
        );
        let legend = drawn.legend;
        let Image { size, rgb } = drawn.image.ok_or_else(|| fault(legend.clone()))?;
        Ok(Picture {
            width: size[0],
            height: size[1],
            rgba: rgba(&Image { size, rgb }),
            legend,
        })
    }

    /// Checks the timestamps of the device, unless that is done; until then they are not read.
    pub async fn check_clock(&self) {
        self.checked_adapter().await;
    }

    /// Asks the measurement that runs to end; it keeps what it has.
    pub fn stop(&self) {
        measure::stop();
    }

    /// Runs methods on the hard cases and judges them. `request` is JSON with `methods`, `cases`
    /// and `size`. `progress` gets the verdict of each cell, with its pixels that are `wrong`
    /// outside the band, or the reason why it `failed`. Returns the text of a stress.json, as
    /// `skiagraph stress` writes it.
    ///
    /// # Errors
    /// A method or case that is not there, or a lost device. After a stop, the cases that are done
    /// are returned.
    pub async fn conformance(&self, request: &str, progress: js_sys::Function) -> Answer<String> {
        let device = (&self.gpu, self.checked_adapter().await);
        measure::reported(progress, measure::conformance(device, request)).await
    }

    /// Measures methods on views of the worker's scene, in turns. `request` is JSON with `views`,
    /// `methods`, `size`, `frames`, and `files` of the user's own. Returns the text of a
    /// results.json, as `skiagraph compare` writes it.
    ///
    /// # Errors
    /// Those of a comparison. After a stop, the runs that are done are returned.
    pub async fn measure(&self, request: &str, progress: js_sys::Function) -> Answer<String> {
        let device = (&self.gpu, self.checked_adapter().await);
        measure::reported(progress, measure::measure(device, request)).await
    }

    /// Loses the device, as a driver may: for tests of the page.
    pub fn lose(&self) {
        self.gpu.device.destroy();
    }
}

impl Page {
    /// Describes the adapter, its clock included.
    async fn checked_adapter(&self) -> Adapter {
        if !self.is_checked.get() {
            let trust = device::timestamp_trust(&self.gpu).await;
            let described = device::describe(&self.gpu, trust);
            self.adapter.borrow_mut().gpu_unavailable = described.gpu_unavailable;
            self.is_checked.set(true);
        }
        self.adapter.borrow().clone()
    }

    /// Runs a frame of the desired state. The params that `argument` sets are added to it.
    async fn snapshot(
        &self,
        mut desired: DesiredState,
        files: &Files,
        argument: Option<&MethodArgument>,
    ) -> Answer<FrameSnapshot> {
        let (sources, scene) = (sources(files), loaded()?);
        let mut shows = match self.shows.take() {
            Some(shows) if Arc::ptr_eq(&shows.stage.loaded.scene, &scene) => shows,
            _ => Shows {
                stage: Stage::new(
                    &desired.scene,
                    Loaded {
                        views: scene.views.clone(),
                        scene,
                    },
                ),
                slots: Vec::new(),
                files: Files::new(),
            },
        };
        let snapshot = self
            .run(&mut shows, &mut desired, (files, &sources), argument)
            .await;
        self.shows.replace(Some(shows));
        snapshot
    }

    async fn run(
        &self,
        shows: &mut Shows,
        desired: &mut DesiredState,
        (files, sources): (&Files, &dyn Sources),
        argument: Option<&MethodArgument>,
    ) -> Answer<FrameSnapshot> {
        let name = &desired.methods[0].name;
        match shows.slots.iter().position(|slot| slot.name == *name) {
            Some(index) => shows.slots.swap(0, index),
            None => shows.slots.insert(0, Slot::new(name)),
        }
        shows.slots.truncate(2);
        let slot = &mut shows.slots[0];
        // Built-in methods have shaders of the same names as the user's.
        if !files.contains_key(name) {
            if slot.graph().is_none() {
                slot.read(&EmbeddedSources);
            }
        } else if slot.graph().is_none() || shows.files != *files {
            slot.read(sources);
            shows.files.clone_from(files);
        }
        let own = argument.map_or(&[][..], |argument| &argument.own);
        if let Some(graph) = slot.graph() {
            for set in own {
                let value = graph.parse_param(&set.name, &set.value).map_err(fault);
                desired.methods[0].params.insert(set.name.clone(), value?);
            }
        }
        let clock = Clock {
            has_timestamps: self.is_checked.get()
                && self.adapter.borrow().gpu_unavailable.is_none(),
            seconds: 0.0,
        };
        let session = Session::new(&self.gpu, &Silent);
        let methods = (&mut shows.slots[..1], &EmbeddedSources as _);
        let taken = shows
            .stage
            .take_snapshot(session, methods, desired, clock)
            .await;
        let Ok(snapshot) = taken.map_err(fault)? else {
            let reason = "a frame took too long, or the driver gave up";
            tell_lost(&self.lost, reason);
            return Err(fault(format!("the device is lost: {reason}")));
        };
        match snapshot
            .methods
            .first()
            .and_then(|method| method.error.clone())
        {
            Some(error) => Err(fault(error)),
            None => Ok(snapshot),
        }
    }
}

/// Calls the page's function on a lost device; its result is of no interest.
fn tell_lost(lost: &js_sys::Function, reason: &str) {
    let _ = lost.call1(&JsValue::NULL, &JsValue::from_str(reason));
}

/// The parts of a frame that the page gets.
fn shown(snapshot: &FrameSnapshot) -> Answer<Shown> {
    let method = &snapshot.methods[0];
    let drawn = draw(snapshot, 0, &Show::Shaded, &Reading::default(), None);
    let legend = drawn.legend;
    let image = drawn.image.ok_or_else(|| fault(legend))?;
    let layer = method.layer.unwrap_or_default();
    let contents = (*method.contents).clone();
    let outputs = Outputs::from_contents(contents, layer, &snapshot.facing).map_err(fault)?;
    Ok(Shown {
        json: described(snapshot, method)?,
        rgba: rgba(&image),
        ids: snapshot.question.primitives.to_vec(),
        visibility: outputs.shown().into_owned(),
        status: outputs.status,
    })
}

fn described(snapshot: &FrameSnapshot, method: &MethodSnapshot) -> Answer<String> {
    let passes = method
        .passes
        .iter()
        .map(|pass| json!({"name": pass.name, "gpu_ms": pass.gpu_ms, "skipped": pass.skipped}));
    let written = method.passes.iter().flat_map(|pass| &pass.writes);
    let materials: BTreeSet<&String> = written.collect();
    json(&json!({
        "method": method.name,
        "size": snapshot.desired.size,
        "ms_gpu": method.gpu_ms,
        "ms_wall": method.wall_ms,
        "memory_bytes": method.memory[0],
        "passes": passes.collect::<Vec<_>>(),
        "materials": materials,
    }))
}
