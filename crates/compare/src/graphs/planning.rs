//! Plans graphs for an adapter, with a scene or with a placeholder for one.
//!
//! ```
//! use skiagraph_compare::graphs::planning::{Trial, check};
//! use skiagraph_passes::{EmbeddedSources, registry};
//!
//! let trial = Trial::default();
//! let nsm = check("pipelines/nsm.ron", &registry(), &EmbeddedSources, &trial)?;
//! assert_eq!(nsm.planned_for, "64×64 pixels, a small scene and one light");
//! assert!(check("pipelines/none.ron", &registry(), &EmbeddedSources, &trial).is_err());
//! # Ok::<(), skiagraph_graph::Diagnostics>(())
//! ```

use crate::graphs::light_kinds;
use glam::Vec3;
use skiagraph_gpu::Provider;
use skiagraph_gpu::device::{Gpu, adapter_facts, partial};
use skiagraph_graph::{
    AdapterFacts, Code, Diagnostic, Diagnostics, Graph, PartialBackend, Plan, PlanRequest,
    Registry, Sources, Span,
};
use skiagraph_passes::{SceneProvider, registry};
use skiagraph_scene::{Light, LightKind, Mesh, Scene, View};
use std::{iter, sync::Arc};

/// Capabilities of an adapter that a plan depends on.
#[derive(Clone, Debug)]
pub struct Capabilities {
    /// Limits of the device.
    pub limits: wgpu::Limits,
    /// Features of the device.
    pub features: wgpu::Features,
    /// Facts about the adapter that documents ask for.
    pub adapter: AdapterFacts,
    /// The graphics backend, if it lacks part of WebGPU, as OpenGL does; `None` otherwise.
    pub partial_backend: Option<PartialBackend>,
    /// Bytes that the textures and buffers of a graph may take; `None` for no limit.
    pub memory: Option<u64>,
}

impl Capabilities {
    /// Returns the capabilities of an opened device, and its limit on a graph's memory.
    pub fn new(gpu: &Gpu) -> Self {
        Self {
            limits: gpu.device.limits(),
            features: gpu.device.features(),
            adapter: adapter_facts(&gpu.device),
            partial_backend: partial(gpu.adapter.get_info().backend),
            memory: gpu.memory,
        }
    }

    /// Returns capabilities no smaller than those of the largest adapters of today. A graph that
    /// cannot be planned with them is itself at fault.
    pub fn greatest() -> Self {
        let limits = wgpu::Limits {
            max_texture_dimension_2d: 32768,
            max_texture_array_layers: 2048,
            max_compute_invocations_per_workgroup: 2048,
            ..wgpu::Limits::unlimited()
        };
        Self {
            limits,
            features: wgpu::Features::all(),
            adapter: AdapterFacts::default(),
            partial_backend: None,
            memory: None,
        }
    }

    /// Creates the request for a plan on this adapter, for a viewport in pixels and a provider of
    /// the scene.
    pub fn request(self, viewport: [u32; 2], provider: &dyn Provider) -> PlanRequest<'_> {
        let mut request = PlanRequest::new(viewport, provider);
        request.limits = self.limits;
        request.features = self.features;
        request.adapter = self.adapter;
        request.partial_backend = self.partial_backend;
        request.memory_limit = self.memory;
        request
    }
}

/// Viewport, scene and adapter that a graph is checked for, in place of those of the host that will
/// run it. Stand-ins are tried for fields that are `None`: a viewport of 64×64 pixels, a scene of
/// one triangle with one light of each kind that the graph takes, then with 2 and 3, and any
/// adapter. A document whose section `needs` asks for more gets 1920×1080 pixels and a million
/// triangles.
#[derive(Clone, Default)]
pub struct Trial<'a> {
    /// Adapter on which the graph must run; with `None`, needs beyond wgpu's default limits and
    /// features are only warnings.
    pub adapter: Option<&'a Capabilities>,
    /// Width and height of the viewport in pixels.
    pub viewport: Option<[u32; 2]>,
    /// Scene, and at least one view of it, each under its light.
    pub scene: Option<(Arc<Scene>, Vec<View>)>,
    /// Light of the stand-in for a scene.
    pub light: Option<LightKind>,
}

/// A graph without faults.
pub struct Checked {
    /// The checked graph.
    pub graph: Graph,
    /// Plan of the graph for the first viewport, scene and light that it was checked for.
    pub plan: Plan,
    /// Everything that the graph was planned for, in words: "64×64 pixels, a small scene and 1 to 3
    /// lights".
    pub planned_for: String,
}

/// Viewports of the stand-ins for a host, and triangles of their scenes.
const HOSTS: [([u32; 2], usize); 2] = [([64, 64], 1), ([1920, 1080], 1 << 20)];

/// Most lights of a stand-in for a scene.
const MOST_LIGHTS: usize = 3;

/// Viewport, scene and lights of one plan.
type Host = ([u32; 2], SceneProvider);

impl Trial<'_> {
    /// The hosts that a graph is planned for, in turn. Without a scene there is one for each of the
    /// `lights`, first with that light alone, then with more.
    fn hosts(&self, (viewport, triangles): ([u32; 2], usize), lights: &[LightKind]) -> Vec<Host> {
        let viewport = self.viewport.unwrap_or(viewport);
        if let Some((scene, views)) = &self.scene {
            let seen_in = |view: &View| {
                let mut provider = SceneProvider::new(Arc::clone(scene));
                provider.set_view(view, viewport);
                (viewport, provider)
            };
            return views.iter().map(seen_in).collect();
        }
        let described = described(viewport, triangles);
        let counts = 1..=MOST_LIGHTS;
        let with = |count| (0..lights.len()).map(move |first| (first, count));
        let with = counts.flat_map(with);
        with.map(|(first, count)| (viewport, lit(&described, &lights[first..], count)))
            .collect()
    }

    /// Names everything that a graph is planned for, with the numbers of lights that were tried.
    fn words(&self, viewport: [u32; 2], counts: &[usize]) -> String {
        let size = pixels(viewport);
        match (&self.scene, counts) {
            (Some((scene, _)), _) => format!("{size} and the scene {}", scene.name),
            (None, [first, .., last]) => {
                format!("{size}, a small scene and {first} to {last} lights")
            }
            (None, _) => format!("{size}, a small scene and {}", count_of(counts[0])),
        }
    }
}

/// Checks the graph at `path` for everything in `trial`. Other numbers of lights than one are tried
/// if the graph asks for the list of lights.
///
/// # Errors
/// All faults that were found. The message of a fault that another viewport, scene or number of
/// lights would not have begins with what it was found for: "for one light: …".
pub fn check(
    path: &str,
    registry: &Registry,
    sources: &dyn Sources,
    trial: &Trial<'_>,
) -> Result<Checked, Diagnostics> {
    let check = |(viewport, provider): &Host| {
        let request = match trial.adapter {
            Some(adapter) => adapter.clone().request(*viewport, provider),
            None => PlanRequest::new(*viewport, provider).with_any_adapter(true),
        };
        Graph::check(path, registry, sources, &request)
    };
    // A faulty document does not tell which lights it takes: then a light that is refused is passed
    // over, unless nothing else is wrong with it.
    let graph = Graph::load(path, registry, sources).ok();
    let lights = match (trial.light, &graph) {
        (Some(light), _) => vec![light],
        (None, Some(graph)) => stand_ins(graph),
        (None, None) => LightKind::EACH.to_vec(),
    };
    // Under a light that it refuses, other faults of a graph may follow from that.
    let refuses = |kind: &str| {
        let graph = graph.as_ref().filter(|it| !light_kinds::takes(it, kind))?;
        let takes = light_kinds::split(graph)[0].join(", ");
        let what = format!("`{}` takes no {kind} light", graph.path());
        Some(Diagnostic::error(Code::Light, what).help(format!("it takes: {takes}")))
    };
    let (mut checked, mut counts): (Option<(Graph, Plan)>, Vec<usize>) = (None, Vec::new());
    let (mut refused, mut unmet) = (None, None);
    for host in HOSTS {
        for host in trial.hosts(host, &lights) {
            let count = host.1.lights().len();
            // One kind of light will do for the numbers of lights that are tried besides.
            let is_more = trial.scene.is_none() && count > 1;
            let is_known = |(_, plan): &(Graph, Plan)| {
                is_more && (!asks_for_lights(plan) || counts.last() == Some(&count))
            };
            if checked.as_ref().is_some_and(is_known) {
                continue;
            }
            match check(&host) {
                Ok(planned) => {
                    checked.get_or_insert(planned);
                    counts.push(count);
                    counts.dedup();
                }
                Err(faults) if has(&faults, Code::Light) => {
                    refused.get_or_insert(faults);
                }
                Err(faults) if has(&faults, Code::Need) => {
                    unmet.get_or_insert(faults);
                }
                Err(faults) => {
                    let refused = refuses(host.1.light().word());
                    let unplanned = || for_which(faults, trial, &host, check);
                    return Err(refused.map_or_else(unplanned, Diagnostics::from));
                }
            }
        }
        match (checked, refused) {
            (_, Some(refused)) => return Err(refused),
            (Some((graph, plan)), None) => {
                let planned_for = trial.words(plan.viewport(), &counts);
                return Ok(Checked {
                    graph,
                    plan,
                    planned_for,
                });
            }
            (None, None) => (checked, refused) = (None, None),
        }
    }
    Err(unmet.unwrap_or_else(|| Diagnostic::error(Code::Output, "no view to check it in").into()))
}

/// True if a document's `lights` or `needs` refuse what it was planned for.
fn has(faults: &Diagnostics, code: Code) -> bool {
    faults.iter().any(|fault| fault.code == code)
}

/// True if a plan depends on the list of lights.
fn asks_for_lights(plan: &Plan) -> bool {
    let asked = plan.relies_on().keys().map(String::as_str);
    let mut names = plan.provided().into_iter().chain(asked);
    names.any(|name| name.starts_with("lights") || name.starts_with("light_areas"))
}

/// The begin of the help on a fault that other hosts would not have.
const FOR_OTHERS: &str = "`check` plans for others with --size, --scene and --light; if the \
                          document is made for these alone, it says so";

/// Returns the faults of a document with these faults, `faults` when it was loaded, and of its
/// plan, as far as it has them for every host.
pub(crate) fn of_every_host(path: &str, sources: &dyn Sources, faults: Diagnostics) -> Diagnostics {
    let planned = check(path, &registry(), sources, &Trial::default());
    let hangs = |fault: &Diagnostic| fault.help.iter().any(|help| help.starts_with(FOR_OTHERS));
    let faults = planned.err().unwrap_or(faults);
    let own = faults.iter().filter(|fault| !hangs(fault));
    Diagnostics::new(own.cloned().collect())
}

/// Begins the message of each fault that does not hold for every host with the part of `host`, a
/// stand-in, on which it depends.
fn for_which(
    faults: Diagnostics,
    trial: &Trial<'_>,
    (viewport, provider): &Host,
    check: impl Fn(&Host) -> Result<(Graph, Plan), Diagnostics>,
) -> Diagnostics {
    let [_, (larger, triangles)] = HOSTS;
    let lights = provider.lights();
    let large = lit(&described(*viewport, triangles), lights, lights.len());
    let number = lights.len();
    // Fewer lights were tried before.
    let counts = if number == 1 { 2..=MOST_LIGHTS } else { 1..=1 };
    let relit = counts.map(|count| {
        let need = match number {
            1 => format!("lights.count >= {count}"),
            _ => format!("lights.count <= {}", number - 1),
        };
        let host = (*viewport, lit(provider, lights, count));
        (count_of(number), need, host)
    });
    let width = "viewport.width >= 1024".to_owned();
    let triangles = "scene.indices.count >= 1000000".to_owned();
    let sized = (pixels(*viewport), width, (larger, provider.clone()));
    let small = ("a small scene".to_owned(), triangles, (*viewport, large));
    let sized = trial.viewport.is_none().then_some(sized);
    let other_scenes = iter::once(small).chain(relit);
    let other_scenes = other_scenes.filter(|_| trial.scene.is_none());
    let mut list: Vec<Diagnostic> = faults.iter().cloned().collect();
    for (words, need, host) in sized.into_iter().chain(other_scenes) {
        let place = format!("for {words}: ");
        let there = match check(&host) {
            Err(refusal) if has(&refusal, Code::Need) || has(&refusal, Code::Light) => continue,
            Err(refusal) => refusal.iter().map(key).collect(),
            Ok(_) => Vec::new(),
        };
        let is_of_it = |fault: &&mut Diagnostic| {
            !there.contains(&key(fault)) && !fault.message.starts_with(&place)
        };
        for fault in list.iter_mut().filter(is_of_it) {
            let named = Diagnostic {
                message: format!("{place}{}", fault.message),
                ..fault.clone()
            };
            *fault = named.help(format!("{FOR_OTHERS}: `needs: [\"{need}\"]`"));
        }
    }
    Diagnostics::new(list)
}

/// Kind and place of a fault, whose message may tell sizes.
fn key(fault: &Diagnostic) -> (Code, Option<Span>) {
    let first = fault.labels.first();
    (fault.code, first.map(|label| label.span.clone()))
}

/// A size in words.
fn pixels([width, height]: [u32; 2]) -> String {
    format!("{width}×{height} pixels")
}

/// A number of lights in words.
fn count_of(lights: usize) -> String {
    match lights {
        1 => "one light".to_owned(),
        _ => format!("{lights} lights"),
    }
}

/// Returns one example light of each kind that a graph takes, in the order of
/// [`LightKind::EACH`]; one of every kind if it takes none of these.
pub fn stand_ins(graph: &Graph) -> Vec<LightKind> {
    let is_taken = |light: &LightKind| light_kinds::takes(graph, light.word());
    let taken: Vec<LightKind> = LightKind::EACH.into_iter().filter(is_taken).collect();
    if taken.is_empty() {
        LightKind::EACH.to_vec()
    } else {
        taken
    }
}

/// Returns a provider of scene resources for planning without a scene, for a viewport in pixels. It
/// describes every resource that a scene can have, under the first kind of light
/// ([`LightKind::EACH`]) that the graph takes, with as many lights, 3 at most, as the graph needs.
pub fn placeholder(viewport: [u32; 2], graph: &Graph) -> SceneProvider {
    let (described, lights) = (described(viewport, 1), stand_ins(graph));
    let with = |count| lit(&described, &lights, count);
    let is_enough = |provider: &SceneProvider| {
        let plan = graph.plan(&PlanRequest::new(viewport, provider));
        !plan.is_err_and(|faults| has(&faults, Code::Need))
    };
    let enough = (1..=MOST_LIGHTS).map(with).find(is_enough);
    enough.unwrap_or_else(|| with(1))
}

/// Returns the same scene under `count` lights, of the kinds in `lights` in turn.
fn lit(described: &SceneProvider, lights: &[LightKind], count: usize) -> SceneProvider {
    let mut provider = described.clone();
    let lights: Vec<LightKind> = lights.iter().cycle().take(count).copied().collect();
    // Lights of a kind that there is are no mistake.
    if provider.set_lights(&lights).is_ok() {
        provider.set_light(lights[0]);
    }
    provider
}

/// Describes all that a scene can give, of the least scene that has it and so many triangles.
fn described(viewport: [u32; 2], triangles: usize) -> SceneProvider {
    let view = View {
        far: 10.0,
        ..View::default()
    };
    let mesh = Mesh {
        positions: [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]
            .map(|[x, y]| Vec3::new(x, y, -1.0))
            .into(),
        triangles: vec![[0, 1, 2]; triangles],
        normals: vec![Vec3::Z],
        normal_indices: vec![[0, 0, 0]; triangles],
        ..Mesh::default()
    };
    let scene = Scene {
        name: "check".into(),
        mesh,
        views: vec![view.clone()],
        lights: vec![Light::only(LightKind::EACH[0])],
    };
    let mut provider = SceneProvider::new(Arc::new(scene));
    provider.set_view(&view, viewport);
    provider
}
