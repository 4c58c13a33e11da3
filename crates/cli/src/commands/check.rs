//! `skiagraph check`: every diagnostic of some graphs, without a GPU.

use crate::{
    args::{CheckArgs, CheckFormat},
    check_json::{CheckReport, FileReport},
    error::{CliError, note, print},
    preset::{self, Faults},
};
use glam::{DVec3, Vec3};
use skiagraph_graph::{Diagnostics, Graph, Plan, PlanRequest, Registry, Sources};
use skiagraph_passes::SceneProvider;
use skiagraph_scene::{DirectionalLight, Mesh, Scene, View};
use std::sync::Arc;

/// Loads and plans each graph under default limits and says what is wrong with it.
///
/// # Errors
/// Every fault of every graph together; warnings are printed and are no error.
pub fn check(args: &CheckArgs) -> Result<(), CliError> {
    let sources = preset::sources();
    let registry = skiagraph_passes::registry();
    let mut found = Vec::new();
    for argument in &args.graphs {
        let checked = match preset::locate(argument, &sources) {
            Ok(path) => all_at_once(&path, &registry, &sources).map_err(Fault::Graph),
            Err(error) => Err(Fault::Missing(error.to_string())),
        };
        found.push((argument.as_str(), checked));
    }
    match args.format {
        CheckFormat::Text => text(&found),
        CheckFormat::Json => json(&found),
    }
}

/// Why an argument cannot be used.
enum Fault {
    /// It names no graph.
    Missing(String),
    /// What is wrong with the graph.
    Graph(Diagnostics),
}

/// The arguments in their order, and what came of them.
type Found<'a> = (&'a str, Result<(Graph, Plan), Fault>);

fn text(found: &[Found]) -> Result<(), CliError> {
    let mut faults = Faults::default();
    let mut fine = String::new();
    let mut missing = Vec::new();
    for (argument, checked) in found {
        match checked {
            Ok((graph, plan)) => {
                preset::warn(graph, plan.warnings());
                let passes = plan.passes().len();
                let noun = if passes == 1 { "pass" } else { "passes" };
                fine.push_str(&format!("{argument}: fine, {passes} {noun}\n"));
            }
            Err(Fault::Graph(diagnostics)) => faults.add(argument, diagnostics),
            Err(Fault::Missing(message)) => missing.push(message.as_str()),
        }
    }
    print(&fine)?;
    let faulty = faults.none_or_error();
    if missing.is_empty() {
        return faulty;
    }
    if let Err(error) = faulty {
        note(&error.to_string());
    }
    Err(CliError::Input(missing.join("\nerror: ")))
}

fn json(found: &[Found]) -> Result<(), CliError> {
    let report = |(argument, checked): &Found| match checked {
        Ok((graph, plan)) => {
            let warnings = graph.warnings().iter().chain(plan.warnings());
            FileReport::fine(argument, plan.passes().len(), warnings)
        }
        Err(Fault::Graph(diagnostics)) => FileReport::faulty(argument, diagnostics.iter()),
        Err(Fault::Missing(message)) => FileReport::missing(argument, message.clone()),
    };
    print(&CheckReport::new(found.iter().map(report).collect()).to_json())?;
    let faulty = found.iter().filter(|(_, checked)| checked.is_err()).count();
    match faulty {
        0 => Ok(()),
        _ => Err(CliError::Input(format!(
            "{faulty} of {} cannot be used; the diagnostics are on standard output",
            found.len()
        ))),
    }
}

const VIEWPORT: [u32; 2] = [64, 64];

/// Everything that is wrong with a graph, as far as it can be said without a scene and an adapter.
pub fn all_at_once(
    path: &str,
    registry: &Registry,
    sources: &dyn Sources,
) -> Result<(Graph, Plan), Diagnostics> {
    let provider = provider(VIEWPORT);
    let mut request = PlanRequest::new(VIEWPORT, &provider);
    // Without an adapter, those that the graph requires are taken to be there; all of them if it does not even say which.
    request.features = Graph::load(path, registry, sources)
        .map_or(wgpu::Features::all(), |graph| graph.features());
    Graph::check(path, registry, sources, &request)
}

/// Describes all that a scene can give, without a scene.
pub fn provider(viewport: [u32; 2]) -> SceneProvider {
    let (scene, view) = one_triangle();
    let mut provider = SceneProvider::new(Arc::new(scene));
    provider.set_view(&view, viewport);
    provider
}

/// The least scene that has all that a provider may be asked for.
fn one_triangle() -> (Scene, View) {
    let view = View {
        name: "main".into(),
        eye: DVec3::ZERO,
        direction: DVec3::NEG_Z,
        up: DVec3::Y,
        fov_y_degrees: 60.0,
        near: 0.1,
        far: 10.0,
    };
    let mesh = Mesh {
        positions: vec![
            Vec3::new(0.0, 0.0, -1.0),
            Vec3::new(1.0, 0.0, -1.0),
            Vec3::new(0.0, 1.0, -1.0),
        ],
        triangles: vec![[0, 1, 2]],
        normals: vec![Vec3::Z],
        normal_indices: vec![[0, 0, 0]],
        groups: Vec::new(),
    };
    let light = DirectionalLight {
        direction: DVec3::NEG_Z,
    };
    (
        Scene {
            name: "check".into(),
            mesh,
            views: vec![view.clone()],
            light,
        },
        view,
    )
}
