//! Shader modules and pipelines of a device: each is made once, for all executors that share it.

use super::cores::on_all_cores;
use super::handles::PipelineKind;
use super::kept::{self, Keeper};
use super::key::PipelineKey;
use crate::error::{ExecuteError, named, scoped};
use crate::identity::DeviceIdentity;
use naga::ShaderStage;
use skiagraph_graph::{Ids, LinkedPass, Shader, step::Step};
use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

/// The pipeline of a draw or dispatch, with the layouts of its bind groups.
#[derive(Debug)]
pub(crate) struct Pipeline {
    pub kind: PipelineKind,
    pub layouts: Vec<Option<wgpu::BindGroupLayout>>,
}

/// Number of pipelines without a user that are kept, for a plan that comes back to them.
const UNUSED: usize = 64;

/// Shader modules and pipelines on one device. Executors share them: a pipeline that one of them
/// has made costs the others nothing, also after a change of a plan. [`Executor::new`] takes the
/// [shared](Self::shared) object of its device, [`Executor::with_pipelines`] any other.
/// Clones are handles of the same object; threads may share it.
///
/// [`Executor::new`]: crate::Executor::new
/// [`Executor::with_pipelines`]: crate::Executor::with_pipelines
///
/// Pipelines are equal if shader text (with the modules that it `#import`s), entry points,
/// `override` constants, bind group layouts, target formats and fixed-function state are. The last
/// 64 pipelines that no executor uses any more are kept, others are dropped.
///
/// ```no_run
/// use skiagraph_gpu::{Executor, device};
/// use skiagraph_graph::{FolderSources, Graph, NoProvider, PlanRequest, Registry};
///
/// let sources = FolderSources { root: "graphs".into() };
/// let graph = Graph::load("ramp.ron", &Registry::standard(), &sources)?;
/// let gpu = device::open(None)?;
/// let plan = |viewport| graph.plan(&PlanRequest::new(viewport, &NoProvider));
/// let first = Executor::new(&gpu.device, &gpu.queue, plan([64, 32])?, &mut NoProvider)?;
/// let made = first.pipelines().made();
/// // The second executor makes no pipelines.
/// Executor::new(&gpu.device, &gpu.queue, plan([128, 64])?, &mut NoProvider)?;
/// assert_eq!(first.pipelines().made(), made);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct Pipelines(Arc<Shared>);

struct Shared {
    device: DeviceIdentity,
    cache: Option<wgpu::PipelineCache>,
    keeper: Option<Keeper>,
    store: Mutex<Store>,
}

impl Drop for Shared {
    fn drop(&mut self) {
        let data = self.cache.as_ref().and_then(wgpu::PipelineCache::get_data);
        if let (Some(keeper), Some(data)) = (self.keeper.take(), data.map(kept::sealed))
            && data != keeper.before
        {
            (keeper.keep)(data);
        }
    }
}

#[derive(Default)]
struct Store {
    modules: HashMap<Arc<Shader>, wgpu::ShaderModule>,
    /// Vertex stage of full-screen passes.
    fullscreen: Option<wgpu::ShaderModule>,
    /// Each with the time of its last use.
    pipelines: HashMap<PipelineKey, (Arc<Pipeline>, u64)>,
    /// Counts uses.
    time: u64,
    made: u64,
}

/// The vertex stage of a full-screen pass: one triangle over the whole target.
const FULLSCREEN: &str =
    "@vertex fn fullscreen(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}";

/// Does something with the list of the objects that executors share by default.
#[cfg(not(target_arch = "wasm32"))]
fn with_shared<T>(act: impl FnOnce(&mut Vec<Weak<Shared>>) -> T) -> T {
    static SHARED: Mutex<Vec<Weak<Shared>>> = Mutex::new(Vec::new());
    act(&mut SHARED.lock().unwrap_or_else(PoisonError::into_inner))
}

/// In a browser each thread has a list of its own: a device stays on its thread.
#[cfg(target_arch = "wasm32")]
fn with_shared<T>(act: impl FnOnce(&mut Vec<Weak<Shared>>) -> T) -> T {
    thread_local! {
        static SHARED: std::cell::RefCell<Vec<Weak<Shared>>> = Default::default();
    }
    SHARED.with_borrow_mut(act)
}

impl Pipelines {
    /// Returns the object that executors on a device share by default: the one that was returned
    /// before, as long as a handle of it is left, or else a new one.
    pub fn shared(device: &wgpu::Device) -> Self {
        // The last handle of an object may be dropped here, not under the lock.
        let used: Vec<Self> = with_shared(|shared| {
            shared.retain(|object| object.strong_count() > 0);
            shared.iter().filter_map(Weak::upgrade).map(Self).collect()
        });
        if let Some(pipelines) = used.iter().find(|object| object.0.device.is(device)) {
            return pipelines.clone();
        }
        let pipelines = Self::new(device);
        with_shared(|shared| shared.push(Arc::downgrade(&pipelines.0)));
        pipelines
    }

    /// Creates an object without pipelines for a device.
    pub fn new(device: &wgpu::Device) -> Self {
        Self::of(device, None, None)
    }

    /// Creates an object without pipelines whose pipelines are made with wgpu's pipeline cache,
    /// which keeps a driver's compiled shaders from one run of a program to the next. The host
    /// creates `cache` on the same device (feature `PIPELINE_CACHE`), and reads its
    /// [`get_data`](wgpu::PipelineCache::get_data) after the executors are made.
    ///
    /// [`create_pipeline_cache`](wgpu::Device::create_pipeline_cache) takes the data of an earlier
    /// run. With `fallback` it ignores data that are broken or come from another driver or version
    /// of wgpu. Data of another adapter are an error, so keep a file for each
    /// [`pipeline_cache_key`](wgpu::util::pipeline_cache_key). With an invalid cache, or one of
    /// another device, executors fail to be made with
    /// [`ExecuteError::Gpu`](crate::ExecuteError::Gpu), which names the first pass.
    pub fn with_cache(device: &wgpu::Device, cache: wgpu::PipelineCache) -> Self {
        Self::of(device, Some(cache), None)
    }

    /// Creates an object without pipelines whose compiled shaders last from one run of a program to
    /// the next: [`with_cache`](Self::with_cache), with a cache of its own. `kept` are the bytes
    /// that `keep` was given in an earlier run; broken ones, those of another driver and none at
    /// all do no harm. `keep` is called when the last handle is dropped, with the bytes to be
    /// written to a file, unless they are those of before. Nothing is kept if the device lacks
    /// `PIPELINE_CACHE`.
    pub fn with_kept(
        device: &wgpu::Device,
        kept: Vec<u8>,
        keep: impl FnOnce(Vec<u8>) + Send + Sync + 'static,
    ) -> Self {
        let cache = kept::cache(device, &kept);
        let keeper = Keeper {
            before: kept,
            keep: Box::new(keep),
        };
        Self::of(device, cache, Some(keeper))
    }

    fn of(
        device: &wgpu::Device,
        cache: Option<wgpu::PipelineCache>,
        keeper: Option<Keeper>,
    ) -> Self {
        Self(Arc::new(Shared {
            device: DeviceIdentity::new(device),
            cache,
            keeper,
            store: Mutex::default(),
        }))
    }

    /// Returns the device that the pipelines are made on.
    pub fn device(&self) -> &wgpu::Device {
        self.0.device.device()
    }

    /// Returns the cache that pipelines are made with; `None` if there is none, as in an object
    /// created by [`new`](Self::new).
    pub fn cache(&self) -> Option<&wgpu::PipelineCache> {
        self.0.cache.as_ref()
    }

    /// Returns the number of pipelines that were made so far, including pipelines that were dropped
    /// since.
    pub fn made(&self) -> u64 {
        self.store().made
    }

    /// Returns the number of pipelines that are kept now, used or not.
    pub fn kept(&self) -> usize {
        self.store().pipelines.len()
    }

    fn store(&self) -> MutexGuard<'_, Store> {
        let store = self.0.store.lock();
        store.unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the pipeline of a step, which is made if there is none yet; `None` for copies and
    /// clears. Errors name `pass`, whose step it is. Other threads may use the object meanwhile.
    pub(crate) fn get_or_make(
        &self,
        pass: &LinkedPass,
        step: &Step<Ids>,
    ) -> Result<Option<Arc<Pipeline>>, ExecuteError> {
        let Some(key) = PipelineKey::new(step) else {
            return Ok(None);
        };
        if let Some(pipeline) = self.store().pipeline(&key) {
            return Ok(Some(pipeline));
        }
        let device = self.device();
        let module = self.module(pass, &key.shader)?;
        let fullscreen = self.store().fullscreen.clone();
        let needs_fullscreen = key.draw.as_ref().is_some_and(|draw| draw.fullscreen);
        // The store gets nothing that the device refuses.
        let made = scoped(device, &pass.name, || {
            let fullscreen =
                fullscreen.or_else(|| needs_fullscreen.then(|| fullscreen_module(device)));
            let modules = (&module, fullscreen.as_ref().filter(|_| needs_fullscreen));
            let pipeline = make(device, &pass.name, &key, modules, self.cache());
            (fullscreen, Arc::new(pipeline))
        });
        let (fullscreen, pipeline) = made.map_err(|error| named(error, pass))?;
        let mut store = self.store();
        store.fullscreen = fullscreen.or(store.fullscreen.take());
        store.insert(key, &pipeline);
        Ok(Some(pipeline))
    }

    /// Returns the module of a pass's shader, which is made if there is none yet.
    fn module(
        &self,
        pass: &LinkedPass,
        shader: &Arc<Shader>,
    ) -> Result<wgpu::ShaderModule, ExecuteError> {
        if let Some(module) = self.store().modules.get(shader) {
            return Ok(module.clone());
        }
        let device = self.device();
        let made = scoped(device, &pass.name, || module_of(device, shader));
        let module = made.map_err(|error| named(error, pass))?;
        let mut store = self.store();
        store.modules.insert(Arc::clone(shader), module.clone());
        Ok(module)
    }

    /// Returns the pipelines of some passes; those that are missing are made on all cores. They are
    /// not dropped before the list is.
    pub(crate) fn of_passes<'p>(
        &self,
        passes: impl Iterator<Item = &'p LinkedPass>,
    ) -> Result<Vec<Arc<Pipeline>>, ExecuteError> {
        let (mut keys, mut shaders) = (HashSet::new(), HashSet::new());
        let (mut steps, mut modules) = (Vec::new(), Vec::new());
        let each = passes.flat_map(|pass| pass.steps.iter().map(move |step| (pass, step)));
        let keyed = each.filter_map(|(pass, step)| Some((pass, step, PipelineKey::new(step)?)));
        for (pass, step, key) in keyed {
            if shaders.insert(Arc::clone(&key.shader)) {
                modules.push((pass, Arc::clone(&key.shader)));
            }
            if keys.insert(key) {
                steps.push((pass, step));
            }
        }
        let ready = on_all_cores(&modules, |(pass, shader)| self.module(pass, shader));
        ready.into_iter().try_for_each(|module| module.map(drop))?;
        let ready = on_all_cores(&steps, |(pass, step)| self.get_or_make(pass, step));
        ready.into_iter().filter_map(Result::transpose).collect()
    }
}

impl Store {
    fn pipeline(&mut self, key: &PipelineKey) -> Option<Arc<Pipeline>> {
        self.time += 1;
        let (pipeline, used) = self.pipelines.get_mut(key)?;
        *used = self.time;
        Some(Arc::clone(pipeline))
    }

    fn insert(&mut self, key: PipelineKey, pipeline: &Arc<Pipeline>) {
        self.made += 1;
        self.time += 1;
        self.pipelines
            .insert(key, (Arc::clone(pipeline), self.time));
        let held = self.pipelines.values();
        let unused = held.filter(|(pipeline, _)| Arc::strong_count(pipeline) == 1);
        let mut unused: Vec<u64> = unused.map(|(_, used)| *used).collect();
        let Some(surplus) = unused.len().checked_sub(UNUSED).filter(|it| *it > 0) else {
            return;
        };
        unused.sort_unstable();
        unused.truncate(surplus);
        self.pipelines
            .retain(|_, (_, used)| unused.binary_search(used).is_err());
        let keys = self.pipelines.keys();
        let shaders: Vec<_> = keys.map(|key| key.shader.clone()).collect();
        self.modules.retain(|shader, _| shaders.contains(shader));
    }
}

fn module_of(device: &wgpu::Device, shader: &Shader) -> wgpu::ShaderModule {
    // A browser's compiler reads WGSL: the author's, since naga's writer leaves attributes out.
    #[cfg(target_arch = "wasm32")]
    let source = wgpu::ShaderSource::Wgsl(Cow::Owned(shader.wgsl()));
    #[cfg(not(target_arch = "wasm32"))]
    let source = wgpu::ShaderSource::Naga(Cow::Owned(shader.module().clone()));
    let label = Some(shader.file());
    device.create_shader_module(wgpu::ShaderModuleDescriptor { label, source })
}

fn fullscreen_module(device: &wgpu::Device) -> wgpu::ShaderModule {
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("fullscreen"),
        source: wgpu::ShaderSource::Wgsl(Cow::Borrowed(FULLSCREEN)),
    })
}

/// Makes a pipeline from its own module, and that of the vertex stage of a full-screen pass, if it
/// is of one.
fn make(
    device: &wgpu::Device,
    label: &str,
    key: &PipelineKey,
    (module, fullscreen): (&wgpu::ShaderModule, Option<&wgpu::ShaderModule>),
    cache: Option<&wgpu::PipelineCache>,
) -> Pipeline {
    let layouts = layouts(device, label, key);
    let bound: Vec<_> = layouts.iter().map(Option::as_ref).collect();
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(label),
        bind_group_layouts: &bound,
        immediate_size: 0,
    });
    let constants = key.constants();
    let compilation_options = options(&constants);
    let Some(draw) = &key.draw else {
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(label),
            layout: Some(&layout),
            module,
            entry_point: key.entry(ShaderStage::Compute),
            compilation_options,
            cache,
        });
        return Pipeline {
            kind: PipelineKind::Compute(pipeline),
            layouts,
        };
    };
    let own_vertex = (key.entry(ShaderStage::Vertex), compilation_options.clone());
    let (entry_point, options) = match fullscreen {
        Some(_) => (Some("fullscreen"), options(&[])),
        None => own_vertex,
    };
    let vertex = wgpu::VertexState {
        module: fullscreen.unwrap_or(module),
        entry_point,
        compilation_options: options,
        buffers: &[],
    };
    let fragment = key.entry(ShaderStage::Fragment);
    let fragment = fragment.map(|name| wgpu::FragmentState {
        module,
        entry_point: Some(name),
        compilation_options,
        targets: &draw.colors,
    });
    let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(label),
        layout: Some(&layout),
        vertex,
        primitive: draw.primitive,
        depth_stencil: draw.depth_stencil.clone(),
        multisample: wgpu::MultisampleState {
            count: draw.samples,
            ..wgpu::MultisampleState::default()
        },
        fragment,
        multiview_mask: None,
        cache,
    });
    Pipeline {
        kind: PipelineKind::Render(pipeline),
        layouts,
    }
}

/// The layouts of a program's bind groups; groups without a binding have none.
fn layouts(
    device: &wgpu::Device,
    label: &str,
    key: &PipelineKey,
) -> Vec<Option<wgpu::BindGroupLayout>> {
    let groups = key.bindings.iter().map(|slot| slot.group + 1);
    let layout = |group: u32| {
        let slots = key.bindings.iter().filter(|slot| slot.group == group);
        let entries = slots.map(|slot| wgpu::BindGroupLayoutEntry {
            binding: slot.binding,
            visibility: slot.visibility,
            ty: slot.ty,
            count: None,
        });
        let entries: Vec<_> = entries.collect();
        (!entries.is_empty()).then(|| {
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some(label),
                entries: &entries,
            })
        })
    };
    (0..groups.max().unwrap_or(0)).map(layout).collect()
}

fn options<'a>(constants: &'a [(&'a str, f64)]) -> wgpu::PipelineCompilationOptions<'a> {
    wgpu::PipelineCompilationOptions {
        constants,
        ..wgpu::PipelineCompilationOptions::default()
    }
}

impl std::fmt::Debug for Pipelines {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let store = self.store();
        f.debug_struct("Pipelines")
            .field("made", &store.made)
            .field("kept", &store.pipelines.len())
            .finish_non_exhaustive()
    }
}
