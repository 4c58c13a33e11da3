//! The table of a scene's resources. A new resource is an entry of it, and the function or struct
//! that makes its content, if that is new: tests write the list of docs/authoring.md.

use super::uploads::{Resource, Uploads};
use crate::buffers::Held;
use crate::lights;
use crate::names::MadeFrom;
use crate::uniforms::{CameraUniform, LightAreaUniform, LightUniform, UnprojectionUniform};
use skiagraph_graph::{Provided, ProvidedBinding};

/// Makes the table, and the macro `table` that writes it in Markdown. An entry is the name; the
/// content in words; what it is made from; how its buffer is held; how plans see it; its upload.
macro_rules! resources {
    ($($(#[$when:meta])?
        $name:literal, $content:literal, $from:ident, $held:ident, $describe:expr, $upload:expr;)+
    ) => {
        pub(super) const RESOURCES: &[Resource] = &[$($(#[$when])? Resource {
            name: $name, made_from: MadeFrom::$from, held: Held::$held,
            describe: $describe, upload: $upload,
        }),+];
        macro_rules! table {
            () => { concat!("| resource | content |\n|---|---|\n",
                $("| `", $name, "` | ", $content, " |\n"),+) };
        }
        pub(super) use table;
    };
}

resources! {
    "scene.positions", "`array<vec4<f32>>`, welded, w = 1", Shape, Traced,
        |it, _| array(Some(it.scene.mesh.positions.len()), 16),
        |it, mesh, name, on| it.upload_corners(name, (&mesh.positions, 1.0), on);
    "scene.indices", "`array<u32>`, three per primitive", Winding, Traced,
        |it, _| array(Some(3 * it.scene.mesh.triangles.len()), 4),
        |it, mesh, name, on| it.upload_triangles(name, &mesh.triangles, on);
    "scene.normals", "`array<vec4<f32>>`, unit length, w = 0", Shape, Storage,
        |it, _| array(Some(it.scene.mesh.normals.len()), 16),
        |it, mesh, name, on| it.upload_corners(name, (&mesh.normals, 0.0), on);
    "scene.normal_indices", "`array<u32>`, three per primitive", Winding, Storage,
        |it, _| array(Some(3 * it.scene.mesh.triangles.len()), 4),
        |it, mesh, name, on| it.upload_triangles(name, &mesh.normal_indices, on);
    "scene.adjacency",
        "`array<u32>`, three per primitive: [`Adjacency::opposite`](skiagraph_scene::Adjacency)",
        Winding, Storage, |it, _| array(Some(3 * it.scene.mesh.triangles.len()), 4),
        |it, mesh, name, on| {
            let opposite = it.geometry.adjacency(mesh, it.version(name));
            it.upload_triangles(name, opposite.as_chunks::<3>().0, on)
        };
    "scene.bvh_nodes", "32-byte [`BvhNode`](skiagraph_scene::BvhNode)s, node 0 is the root",
        Shape, Storage, |_, _| array(None, 32), |it, _, _, on| it.upload_hierarchy(on);
    "scene.bvh_primitives", "`array<u32>`, primitive ids in leaf order", Shape, Storage,
        |it, _| array(Some(it.tree_slots()), 4),
        |it, _, _, on| it.upload_hierarchy(on);
    "scene.light_space_nodes",
        "32-byte [`LightSpaceNode`](skiagraph_scene::LightSpaceNode)s, node 0 the root; last the \
         [centre](skiagraph_scene::LightSpaceNode::centre)",
        LightOverShape, OfLight, |_, _| array(None, 32), |it, _, _, on| it.upload_light_space(on);
    "scene.light_space_primitives", "`array<u32>`, primitive ids in their leaf order",
        LightOverShape, OfLight, |it, _| array(Some(it.tree_slots()), 4),
        |it, _, _, on| it.upload_light_space(on);
    "scene.tlas", "`acceleration_structure`; primitive id = custom data + primitive index",
        Shape, Storage, |_, _| Some(Provided::ACCELERATION_STRUCTURE),
        |it, _, name, _| Err(it.unknown(name));
    #[cfg(feature = "embree")]
    "scene.embree", "work for the CPU, with the feature `embree`",
        Shape, Storage, |_, _| Some(Provided::CPU_WORK), |it, _, name, _| Err(it.unknown(name));
    "scene.casters",
        "`array<vec4<u32>>`, of each primitive that casts shadows its three indices and its id, \
         ascending; of none one item, of 0xffffffff",
        Winding, Storage, |it, _| array(Some(it.facts.casters(&it.scene.mesh)), 16),
        Uploads::upload_casters;
    "scene.shadows",
        "`array<u32>`: [`shadow_words`](skiagraph_scene::packed_masks::shadow_words), what \
         `shared/roles.wgsl` reads; no items if all primitives cast and receive",
        Winding, Storage, |it, _| array(Some(it.facts.shadows.len()), 4),
        |it, _, name, on| it.upload_items(name, &it.facts.clone().shadows, on);
    "scene.masks",
        "`array<u32>`: [`mask_words`](skiagraph_scene::packed_masks::mask_words), what \
         `shared/masks.wgsl` reads",
        Winding, Storage, |it, _| array(Some(it.facts.masks.len()), 4),
        |it, _, name, on| it.upload_items(name, &it.facts.clone().masks, on);
    "scene.sheets", "`array<u32>`: a bit per primitive, of [`Sheets`](skiagraph_scene::Sheets)",
        Mesh, Storage, |it, _| array(Some(it.sheets.words().len()), 4),
        |it, _, name, on| it.upload_items(name, it.sheets.clone().words(), on);
    "scene.uvs", "`array<vec2<f32>>`, v down", Mesh, Storage,
        |it, _| array(Some(it.scene.mesh.surfaces.uvs.len()), 8),
        |it, mesh, name, on| it.upload_appended(name, &mesh.surfaces.uvs, on);
    "scene.uv_indices", "`array<u32>`, three per primitive", Winding, Storage,
        |it, _| array(Some(3 * it.scene.mesh.surfaces.uv_indices.len()), 4),
        |it, mesh, name, on| it.upload_triangles(name, &mesh.surfaces.uv_indices, on);
    "scene.materials", "32-byte [`MaterialRecord`](crate::MaterialRecord)s", Mesh, Storage,
        |it, _| array(Some(it.scene.mesh.surfaces.materials.len()), 32),
        |it, _, name, on| it.atlas().and_then(|at| it.upload_appended(name, &at.records, on));
    "scene.material_indices", "`array<u32>`, one per primitive", Mesh, Storage,
        |it, _| array(Some(it.scene.mesh.surfaces.of.len()), 4),
        |it, mesh, name, on| it.upload_triangles(name, mesh.surfaces.of.as_chunks::<1>().0, on);
    "scene.texels", "`array<u32>`, RGBA8 texels of all base-colour textures, sRGB, red lowest",
        Mesh, Storage, |_, _| array(None, 4),
        |it, _, name, on| it.atlas().and_then(|at| it.upload_appended(name, &at.texels, on));
    "camera", "[`CameraUniform`](crate::uniforms::CameraUniform)", Eye, Uniform,
        |_, _| uniform::<CameraUniform>(),
        Uploads::upload_content;
    "unprojection", "[`UnprojectionUniform`](crate::uniforms::UnprojectionUniform)", Eye, Uniform,
        |_, _| uniform::<UnprojectionUniform>(),
        Uploads::upload_content;
    "light", "[`LightUniform`](crate::uniforms::LightUniform)", LightOverShape, Uniform,
        |it, _| Some(uniform::<LightUniform>()?.with_kind(lights::provided_kind(&it.light()))),
        Uploads::upload_content;
    "light_area", "[`LightAreaUniform`](crate::uniforms::LightAreaUniform)", Light, Uniform,
        |it, _| {
            let extent = lights::provided_extent(&it.light());
            Some(uniform::<LightAreaUniform>()?.with_kind(extent))
        },
        Uploads::upload_content;
    "lights",
        "array of [`LightUniform`](crate::uniforms::LightUniform), one per light; `lights[2]` \
         alone is a uniform",
        LightsOverShape, Lights, |it, name| lights::describe(name, it.lights()),
        Uploads::upload_content;
    "light_areas",
        "array of [`LightAreaUniform`](crate::uniforms::LightAreaUniform); `light_areas[2]` alone \
         is a uniform",
        Lights, Lights, |it, name| lights::describe(name, it.lights()), Uploads::upload_content;
}

/// Describes an array; one whose length depends on how it is built has no number of items.
fn array(items: Option<usize>, stride: u64) -> Option<Provided> {
    let items = items.map(|items| items as u64);
    Some(Provided::new(ProvidedBinding::Storage, items, stride))
}

fn uniform<T>() -> Option<Provided> {
    let (binding, bytes) = (ProvidedBinding::Uniform, size_of::<T>() as u64);
    Some(Provided::new(binding, Some(1), bytes))
}

#[cfg(test)]
mod tests {
    use super::RESOURCES;
    use crate::names::*;
    use std::{env, fs, path::Path};

    #[test]
    fn names_of_the_code_are_in_the_table() {
        let own = [
            [POSITIONS, INDICES, NORMALS, BVH_NODES, BVH_PRIMITIVES, TLAS],
            [
                LIGHT_SPACE_NODES,
                LIGHT_SPACE_PRIMITIVES,
                MASKS,
                SHEETS,
                CAMERA,
                UNPROJECTION,
            ],
            [
                LIGHT,
                LIGHT_AREA,
                crate::lights::LIGHTS,
                crate::lights::LIGHT_AREAS,
                CASTERS,
                SHADOWS,
            ],
        ];
        for name in own.into_iter().flatten() {
            assert!(
                RESOURCES.iter().any(|resource| resource.name == name),
                "{name}"
            );
        }
    }

    /// docs/authoring.md has the table, without links. `INSTA_UPDATE=always` writes it anew.
    #[test]
    fn the_guide_lists_all_resources() {
        let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/authoring.md");
        let text = fs::read_to_string(&page).expect("the guide");
        let (before, rest) = text.split_once("<!-- resources -->\n\n").expect("a place");
        let (table, after) = rest
            .split_once("\n<!-- end of resources -->")
            .expect("its end");
        let mut expected = String::new();
        for (number, piece) in super::table!().split('[').enumerate() {
            match piece.split_once("](").filter(|_| number > 0) {
                Some((word, link)) => {
                    expected += word;
                    expected += link.split_once(')').expect("a link").1;
                }
                None if number > 0 => expected = expected + "[" + piece,
                None => expected += piece,
            }
        }
        if table != expected && env::var("INSTA_UPDATE").is_ok_and(|mode| mode == "always") {
            let text = [before, "<!-- resources -->\n\n", &expected];
            let rest = ["\n<!-- end of resources -->", after];
            fs::write(page, text.concat() + &rest.concat()).expect("written");
        } else {
            assert_eq!(table, expected, "run this test with INSTA_UPDATE=always");
        }
    }
}
