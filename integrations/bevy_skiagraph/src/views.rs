//! The graphs: one for each camera and light, over one scene.

use crate::{SkiagraphShadows, casters::Change, lights::is_marked, maps};
use bevy::{
    camera::MainPassResolutionOverride,
    core_pipeline::prepass::ViewPrepassTextures,
    ecs::entity::EntityHashMap,
    pbr::{
        ExtractedDirectionalLight, ExtractedPointLight, LightEntity, PointAndSpotLightViewEntities,
        ShadowView, ViewLightEntities,
    },
    platform::{cell::SyncCell, collections::HashMap},
    prelude::*,
    render::{
        camera::TemporalJitter,
        renderer::{RenderContext, RenderDevice, RenderQueue, ViewQuery},
        view::{ExtractedView, RetainedViewEntity},
    },
};
use glam::{DMat4, DVec3};
use skiagraph_gpu::{ExecuteError, Executor, Frame, import};
use skiagraph_graph::{FolderSources, Graph, LayeredSources, MemorySources, PlanRequest, Sources};
use skiagraph_passes::{Depth, EmbeddedSources, Eye, PartId, SceneProvider, SceneView, registry};
use skiagraph_scene::{DirectionalLight, LightKind, Movable, SpotLight};
use std::path::PathBuf;
use wgpu::Extent3d;

/// Name of the document that puts Bevy's prepass in the place of a preset's own.
const DOCUMENT: &str = "bevy_skiagraph.ron";

/// Steps of a depth by which Bevy's vertex shader, which works in f32, may be off.
const DEPTH_STEPS: u32 = 8;

/// Frames for which the graph of a camera and a light is kept that are not drawn.
const LONGEST_REST: u32 = 300;

/// The scene, and an executor for each camera and light.
#[derive(Resource)]
pub struct Views {
    folder: Option<PathBuf>,
    provider: SceneProvider,
    parts: EntityHashMap<PartId>,
    running: HashMap<(RetainedViewEntity, Entity), Running>,
    writers: Vec<maps::Writer>,
    /// Error about the scene that was logged last.
    failure: Option<String>,
}

struct Running {
    preset: String,
    /// `None` if the preset cannot be run.
    executor: Option<SyncCell<Executor>>,
    /// Error that was logged last.
    failure: Option<String>,
    /// Frames since it was drawn.
    rested: u32,
}

/// A camera's matrices, and the prepass that it has drawn.
struct Picture<'a> {
    eye: Eye,
    depth: &'a wgpu::Texture,
    normal: &'a wgpu::Texture,
}

type Gpu<'a> = (&'a wgpu::Device, &'a wgpu::Queue);

impl Views {
    pub fn new(folder: Option<PathBuf>) -> Self {
        let light = DirectionalLight::new(DVec3::NEG_Y);
        Self {
            folder,
            provider: SceneProvider::from_parts(Movable::joined(&[]), light),
            parts: default(),
            running: default(),
            writers: Vec::new(),
            failure: None,
        }
    }

    /// Brings the scene up to date with Bevy's world.
    pub fn follow(&mut self, changes: Vec<Change>) {
        for change in changes {
            if let Err(error) = self.follow_one(change) {
                self.failure = log(self.failure.take(), Some(&error.to_string()), "the scene");
            }
        }
    }

    fn follow_one(&mut self, change: Change) -> Result<(), skiagraph_passes::Error> {
        let Self {
            provider, parts, ..
        } = self;
        match change {
            Change::Mesh(entity, mesh, map) => match parts.get(&entity) {
                Some(part) => provider.replace_part(*part, &mesh, &map),
                None => {
                    parts.insert(entity, provider.add_mesh(&mesh, &map)?);
                    Ok(())
                }
            },
            Change::Place(entity, map) => match parts.get(&entity) {
                Some(part) => provider.set_transform(*part, &map),
                None => Ok(()),
            },
            Change::Gone(entity) => match parts.remove(&entity) {
                Some(part) => provider.remove_part(part),
                None => Ok(()),
            },
        }
    }
}

/// Cascades and maps of lights.
type Layers<'w, 's> = Query<'w, 's, (&'static LightEntity, &'static ShadowView)>;

/// Lights of the render world.
type Lights<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        &'static SkiagraphShadows,
        Option<&'static ExtractedDirectionalLight>,
        Option<(
            &'static ExtractedPointLight,
            &'static PointAndSpotLightViewEntities,
        )>,
    ),
>;

/// A camera of the render world.
type View = (
    &'static ExtractedView,
    &'static Msaa,
    &'static ViewPrepassTextures,
    &'static ViewLightEntities,
    Option<&'static TemporalJitter>,
    Option<&'static MainPassResolutionOverride>,
);

/// Runs the graph of each light for a camera, and writes what it finds into the light's map.
pub fn encode(
    view: ViewQuery<View>,
    lights: Lights,
    layers: Layers,
    (device, queue): (Res<RenderDevice>, Res<RenderQueue>),
    mut views: ResMut<Views>,
    mut context: RenderContext,
) {
    let (view, msaa, textures, cascades, jitter, resolution) = view.into_inner();
    let (Some(depth), Some(normal), Msaa::Off) = (&textures.depth, &textures.normal, msaa) else {
        return; // it has Bevy's maps
    };
    let (depth, normal) = (&depth.texture.texture, &normal.texture.texture);
    let eye = eye(view, jitter, resolution, depth.size());
    let gpu = (device.wgpu_device(), &**queue);
    let encoder = context.command_encoder();
    for (light, shadows, directional, spot) in &lights {
        let (kind, maps) = match (directional, spot) {
            (Some(sun), _) if is_marked(sun.shadow_depth_bias) => (
                directional_kind(sun, shadows),
                maps_of(light, &cascades.lights, &layers),
            ),
            (_, Some((spot, held))) if is_marked(spot.shadow_depth_bias) => {
                (spot_kind(spot, shadows), maps_of(light, held, &layers))
            }
            _ => continue,
        };
        let (Some(kind), false) = (kind, maps.is_empty()) else {
            continue; // it has no shadows, or shines on other layers than the camera's
        };
        let visibility = eye.as_ref().and_then(|eye| {
            let picture = Picture {
                eye: *eye,
                depth,
                normal,
            };
            let key = (view.retained_view_entity, light);
            views.run(key, shadows, (kind, picture), gpu, encoder)
        });
        match visibility {
            Some(visibility) => views.writer(gpu.0, visibility.texture().format()).write(
                gpu.0,
                encoder,
                &visibility,
                &maps,
            ),
            None => maps.iter().for_each(|map| maps::clear(encoder, map)),
        }
    }
}

/// Drops the graphs of cameras and lights that have not been drawn for long.
pub fn drop_unused(mut views: ResMut<Views>) {
    views.running.retain(|_, running| {
        running.rested += 1;
        running.rested < LONGEST_REST
    });
}

/// Moves the scene to a device that Bevy has opened after it lost one.
pub fn move_to(device: Res<RenderDevice>, mut views: ResMut<Views>) {
    views.running.clear();
    views.writers.clear();
    views.provider.move_to(device.wgpu_device());
}

impl Views {
    /// Runs the graph of a camera and a light; `None` if it cannot run, which is logged once.
    fn run(
        &mut self,
        key: (RetainedViewEntity, Entity),
        shadows: &SkiagraphShadows,
        (kind, picture): (LightKind, Picture),
        gpu: Gpu,
        encoder: &mut wgpu::CommandEncoder,
    ) -> Option<wgpu::TextureView> {
        if self.parts.is_empty() {
            return None;
        }
        let Extent3d { width, height, .. } = picture.depth.size();
        let view = SceneView::new([width, height], &picture.eye, kind);
        let mut running = self
            .running
            .remove(&key)
            .filter(|it| it.preset == shadows.preset);
        if running.is_none() {
            let executor = self.start(&shadows.preset, &view, &picture, gpu);
            running = Some(Running {
                preset: shadows.preset.clone(),
                failure: log(None, executor.as_ref().err(), &shadows.preset),
                executor: executor.ok().map(SyncCell::new),
                rested: 0,
            });
        }
        let mut running = running?;
        running.rested = 0;
        let mut visibility = None;
        if let Some(executor) = &mut running.executor {
            let executor = executor.get();
            let result = encode_view(executor, &mut self.provider, (&view, &picture), encoder);
            running.failure = log(running.failure, result.as_ref().err(), &shadows.preset);
            visibility = result.ok();
        }
        self.running.insert(key, running);
        visibility
    }

    fn start(
        &mut self,
        preset: &str,
        view: &SceneView,
        picture: &Picture,
        (device, queue): Gpu,
    ) -> Result<Executor, String> {
        let path = if preset.ends_with(".ron") {
            preset.to_owned()
        } else {
            format!("pipelines/{preset}.ron")
        };
        let load = |document: &str, over: Option<&str>| {
            let over = over.map(|text| MemorySources::new([(document, text)]));
            let folder = self.folder.clone().map(|root| FolderSources { root });
            let mut sources: Vec<Box<dyn Sources>> = Vec::new();
            sources.extend(over.map(|it| Box::new(it) as Box<dyn Sources>));
            sources.extend(folder.map(|it| Box::new(it) as Box<dyn Sources>));
            sources.push(Box::new(EmbeddedSources));
            let graph = Graph::load(document, &registry(), &LayeredSources(sources));
            graph.map_err(|errors| errors.to_string())
        };
        let kinds = load(&path, None)?;
        let kinds: Vec<&str> = kinds.lights().map(|kind| kind.value.as_str()).collect();
        let document = format!(
            r#"(
                format: 3,
                extends: "{path}",
                inputs: [Texture(name: "depth"), Texture(name: "normal")],
                passes: [Change(pass: "gbuffer", graph: "shared/from_depth.ron",
                    set: {{"unsigned": true, "depth_steps": {DEPTH_STEPS}}})],
                claims: {{}},
                lights: [{}],
            )"#,
            kinds.join(", ")
        );
        let graph = load(DOCUMENT, Some(&document))?;
        let mut request = PlanRequest::new(view.size(), view.apply(&mut self.provider));
        request.limits = device.limits();
        request.features = device.features();
        picture.describe(&mut request);
        let plan = graph.plan(&request).map_err(|errors| errors.to_string())?;
        let executor = Executor::new(device, queue, plan, &mut self.provider);
        executor.map_err(|error| error.to_string())
    }

    fn writer(&mut self, device: &wgpu::Device, format: wgpu::TextureFormat) -> &maps::Writer {
        let number = self.writers.iter().position(|writer| writer.is_for(format));
        let number = number.unwrap_or_else(|| {
            self.writers.push(maps::Writer::new(device, format));
            self.writers.len() - 1
        });
        &self.writers[number]
    }
}

impl Picture<'_> {
    fn describe(&self, request: &mut PlanRequest) {
        let size = self.depth.size();
        request.viewport = [size.width, size.height];
        for (name, texture) in [("depth", self.depth), ("normal", self.normal)] {
            request
                .imports
                .insert(name.to_owned(), import::texture(texture));
        }
    }
}

/// Brings an executor up to date, and encodes a frame of it.
fn encode_view(
    executor: &mut Executor,
    provider: &mut SceneProvider,
    (view, picture): (&SceneView, &Picture),
    encoder: &mut wgpu::CommandEncoder,
) -> Result<wgpu::TextureView, String> {
    let text = |error: ExecuteError| error.to_string();
    let has_size = executor.plan().viewport() == view.size();
    let refreshed = match has_size {
        true => view.refresh_in(executor, provider, encoder),
        false => Ok(()),
    };
    let is_other = matches!(refreshed, Err(ExecuteError::OtherThanPlanned { .. }));
    if is_other || !has_size {
        view.apply(provider);
        let plan = executor.plan().with(|request| {
            picture.describe(request);
            request.provider = provider;
        });
        let plan = plan.map_err(|errors| errors.to_string())?;
        executor.replace_graph(plan, provider).map_err(text)?;
        view.refresh_in(executor, provider, encoder).map_err(text)?;
    } else {
        refreshed.map_err(text)?;
    }
    executor
        .import_texture("depth", picture.depth)
        .map_err(text)?;
    executor
        .import_texture("normal", picture.normal)
        .map_err(text)?;
    executor.encode(encoder, &Frame::default()).map_err(text)?;
    let visibility = executor.output_view("visibility");
    visibility.ok_or_else(|| "it has no output `visibility`".to_owned())
}

/// Logs an error, unless it is the one that was logged before, and returns it.
fn log(before: Option<String>, error: Option<&String>, preset: &str) -> Option<String> {
    let error = error?;
    if before.as_ref() != Some(error) {
        error!("SkiagraphShadows of {preset} are not drawn: {error}");
    }
    Some(error.clone())
}

/// Returns the views of a light's map, cascade by cascade.
fn maps_of<'q>(light: Entity, held: &[Entity], layers: &'q Layers) -> Vec<&'q wgpu::TextureView> {
    let own = held.iter().filter_map(|entity| {
        let (owner, map) = layers.get(*entity).ok()?;
        let cascade = match owner {
            LightEntity::Directional {
                light_entity,
                cascade_index,
            } => (*light_entity == light).then_some(*cascade_index),
            LightEntity::Spot { light_entity } => (*light_entity == light).then_some(0),
            LightEntity::Point { .. } => None,
        };
        let view = map.depth_attachment.depth_stencil_views.attachment_view();
        Some((cascade?, &**view))
    });
    let mut own: Vec<_> = own.collect();
    own.sort_by_key(|(cascade, _)| *cascade);
    own.into_iter().map(|(_, view)| view).collect()
}

fn directional_kind(
    light: &ExtractedDirectionalLight,
    shadows: &SkiagraphShadows,
) -> Option<LightKind> {
    let mut sun = DirectionalLight::new(vector(*light.transform.forward()));
    sun.angle_degrees = f64::from(shadows.extent).to_degrees();
    Some(sun.into())
}

/// The cone is a little wider than Bevy's, outside of which the light does not shine.
fn spot_kind(light: &ExtractedPointLight, shadows: &SkiagraphShadows) -> Option<LightKind> {
    let (_, outer) = light.spot_light_angles?;
    let cone = 2.0 * f64::from(outer).to_degrees() + 0.5;
    Some(LightKind::Spot(SpotLight {
        position: vector(light.transform.translation()),
        direction: vector(*light.transform.forward()),
        cone_degrees: cone.min(179.9),
        radius: f64::from(shadows.extent),
    }))
}

fn vector(vector: Vec3) -> DVec3 {
    DVec3::from_array(vector.to_array().map(f64::from))
}

/// Returns the matrices that the prepass was drawn with, as if its viewport were all of the
/// target. `None` for matrices that form no camera.
fn eye(
    view: &ExtractedView,
    jitter: Option<&TemporalJitter>,
    resolution: Option<&MainPassResolutionOverride>,
    target: Extent3d,
) -> Option<Eye> {
    let [x, y, mut width, mut height] = view.viewport.as_vec4().to_array();
    if let Some(resolution) = resolution {
        [width, height] = resolution.0.as_vec2().to_array();
    }
    let mut projection = view.clip_from_view;
    if let Some(jitter) = jitter {
        jitter.jitter_projection(&mut projection, Vec2::new(width, height));
    }
    let matrix = |matrix: Mat4| DMat4::from_cols_array(&matrix.to_cols_array().map(f64::from));
    let view_from_world = matrix(view.world_from_view.to_matrix()).inverse();
    let viewport = [x, y, width, height].map(f64::from);
    Eye::in_viewport(
        view_from_world,
        matrix(projection),
        Depth::Reversed,
        viewport,
        [target.width, target.height],
    )
    .inspect_err(|error| warn_once!("a camera has no SkiagraphShadows: {error}"))
    .ok()
}
