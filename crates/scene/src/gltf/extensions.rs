//! Extensions of glTF: which are followed, which concern looks only, which pack what a mesh is made
//! of.

use serde_json::{Map, Value};

/// Treatment of an extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// It is read.
    Followed,
    /// It moves no triangle and cuts none: passed over.
    Looks,
    /// A part of the mesh is packed in it: refused where it is used and nothing stands in for it.
    Packed,
    /// Not known.
    Unknown,
}

const FOLLOWED: [&str; 7] = [
    "EXT_mesh_gpu_instancing",
    "EXT_mesh_primitive_restart",
    "KHR_lights_punctual",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_mesh_quantization",
    "KHR_node_visibility",
    "KHR_texture_transform",
];

const PACKED: [&str; 3] = [
    "EXT_meshopt_compression",
    "KHR_draco_mesh_compression",
    "KHR_meshopt_compression",
];

/// Words of names that only concern looks, sound, light sources, or data beside the mesh.
const LOOKS: [&str; 23] = [
    "_animation_pointer",
    "_articulations",
    "_audio",
    "_environment",
    "_hoverability",
    "_instance_features",
    "_interactivity",
    "_lights_",
    "_lod",
    "_materials_",
    "_mesh_features",
    "_mesh_manifold",
    "_metadata",
    "_packing_",
    "_physics",
    "_primitive_outline",
    "_selectability",
    "_stk_",
    "_techniques_",
    "_xmp",
    "BIM_data",
    "VRM",
    "_texture",
];

pub(super) fn kind(name: &str) -> Kind {
    let lower = name.to_ascii_lowercase();
    let is_named = |word: &&str| lower.contains(&word.to_ascii_lowercase());
    if FOLLOWED.contains(&name) {
        Kind::Followed
    } else if PACKED.contains(&name) {
        Kind::Packed
    } else if LOOKS.iter().any(is_named) {
        Kind::Looks
    } else {
        Kind::Unknown
    }
}

/// Why what has these extensions cannot be read, if one of them packs it.
pub(super) fn packed(extensions: &Map<String, Value>) -> Option<String> {
    let mut names = extensions.keys();
    let name = names.find(|name| kind(name) == Kind::Packed)?;
    Some(format!(
        "it is compressed ({name}), which this program does not unpack: export it without \
         compression, or import it into Blender, say, and export it again without"
    ))
}

/// True if data of an extension stand in materials, textures, cameras or animations, and nowhere
/// else: then it moves no triangle, whatever it is.
pub(super) fn is_of_looks(root: &Value, name: &str) -> bool {
    const LOOKS: [&str; 6] = [
        "animations",
        "cameras",
        "images",
        "materials",
        "samplers",
        "textures",
    ];
    let mut lists = root.as_object().into_iter().flatten();
    let (mut is_used, mut elsewhere) = (false, false);
    for (list, value) in &mut lists {
        if mentions(value, name) {
            is_used = true;
            elsewhere |= !LOOKS.contains(&list.as_str());
        }
    }
    is_used && !elsewhere
}

/// True if an `extensions` object in it has that name. Nesting is bounded by the parser.
fn mentions(value: &Value, name: &str) -> bool {
    match value {
        Value::Array(items) => items.iter().any(|item| mentions(item, name)),
        Value::Object(fields) => fields.iter().any(|(field, value)| {
            (field == "extensions" && value.get(name).is_some()) || mentions(value, name)
        }),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn names_tell_what_an_extension_is_of() {
        for looks in [
            "ADOBE_materials_clearcoat_tint",
            "EXT_lights_image_based",
            "EXT_texture_webp",
            "FB_geometry_metadata",
            "KHR_animation_pointer",
            "KHR_audio_emitter",
            "KHR_materials_dispersion",
            "KHR_materials_variants",
            "KHR_texture_basisu",
            "KHR_xmp_json_ld",
            "MSFT_lod",
            "MSFT_texture_dds",
        ] {
            assert_eq!(kind(looks), Kind::Looks, "{looks}");
        }
        assert_eq!(kind("KHR_texture_transform"), Kind::Followed);
        assert_eq!(kind("KHR_draco_mesh_compression"), Kind::Packed);
        assert_eq!(kind("ACME_magic"), Kind::Unknown);
    }

    #[test]
    fn an_unknown_one_is_of_looks_by_its_place() {
        let material = json!({"materials": [{"extensions": {"ACME_paint": {}}}]});
        assert!(is_of_looks(&material, "ACME_paint") && !is_of_looks(&material, "ACME_other"));
        let both = json!({
            "materials": [{"extensions": {"ACME_paint": {}}}],
            "nodes": [{"extensions": {"ACME_paint": {}}}],
        });
        assert!(!is_of_looks(&both, "ACME_paint"));
    }
}
