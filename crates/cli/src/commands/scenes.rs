//! `skiagraph scenes`: what `--scene` can name.

use crate::error::CliError;
use crate::reporting::table::table;
use crate::terminal::console::print;
use skiagraph_scene::{SceneLibrary, SceneListing};

/// Lists the scenes with their views and whether their meshes are at hand.
///
/// # Errors
/// Standard output.
pub fn scenes() -> Result<(), CliError> {
    let listings = SceneLibrary::from_environment().list();
    let missing = listings.iter().any(|listing| !listing.mesh_found);
    let row = |scene: SceneListing| {
        let mesh = if scene.mesh_found { "found" } else { "missing" };
        let views = scene.views.join("\n");
        vec![scene.name, mesh.into(), views, scene.description]
    };
    let heads = ["scene", "mesh", "views", "description"];
    let table = table(heads, 4, listings.into_iter().map(row));
    let hint = if missing {
        "\n`skiagraph doctor` says where missing meshes are searched.\n"
    } else {
        ""
    };
    print(&format!("{table}\n{hint}"))
}
