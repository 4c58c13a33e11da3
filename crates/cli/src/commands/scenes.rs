//! `skiagraph scenes`: lists the scenes that `--scene` can name.

use crate::error::CliError;
use crate::terminal::console::print;
use skiagraph_compare::records::table::Table;
use skiagraph_report::table::terminal;
use skiagraph_scene::{SceneLibrary, SceneListing};

/// Prints the scenes with their views and camera paths, and which of their meshes are missing.
///
/// # Errors
/// If standard output cannot be written.
pub fn scenes() -> Result<(), CliError> {
    let listings = SceneLibrary::from_environment().list();
    let missing = listings.iter().any(|listing| !listing.mesh_found);
    let row = |scene: SceneListing| {
        let mesh = if scene.mesh_found { "found" } else { "missing" };
        let views = scene.views.join("\n");
        let paths = scene.paths.join("\n");
        vec![scene.name, mesh.into(), views, paths, scene.description]
    };
    let heads = ["scene", "mesh", "views", "paths", "description"];
    let table = terminal(&Table::new(heads, 5, listings.into_iter().map(row)));
    let hint = "\n`skiagraph doctor` says where missing meshes are searched.\n";
    let hint = if missing { hint } else { "" };
    print(&format!("{table}\n{hint}"))
}
