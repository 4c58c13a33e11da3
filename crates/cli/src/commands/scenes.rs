//! `skiagraph scenes`: what `--scene` can name.

use crate::{
    error::{CliError, print},
    table::{add_row, new_table},
};
use skiagraph_scene::{SceneLibrary, SceneListing};

/// Lists the scenes with their views and whether their meshes are at hand.
///
/// # Errors
/// Standard output.
pub fn scenes() -> Result<(), CliError> {
    let mut table = new_table(&["scene", "mesh", "views", "description"], 4);
    let listings = SceneLibrary::from_environment().list();
    let missing = listings.iter().any(|listing| !listing.mesh_found);
    for SceneListing {
        name,
        description,
        views,
        mesh_found,
        ..
    } in listings
    {
        let mesh = if mesh_found { "found" } else { "missing" };
        add_row(
            &mut table,
            vec![name, mesh.into(), views.join("\n"), description],
            4,
        );
    }
    let hint = if missing {
        "\n`skiagraph doctor` says where missing meshes are searched.\n"
    } else {
        ""
    };
    print(&format!("{table}\n{hint}"))
}
