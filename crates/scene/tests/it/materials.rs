//! OBJ files with materials: masks and colours, and what is said where they are broken.

use skiagraph_scene::{
    ImportReport, Mesh, ObjMaterials, ObjOptions, SceneError, Surfaces, Wrap, load_obj,
};
use std::path::Path;
use tempfile::TempDir;

/// A square of two triangles with texture coordinates, in the material `leaf`.
const LEAF: &str = "mtllib leaf.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\n\
                    vt 0 1\nusemtl leaf\nf 1/1 2/2 3/3 4/4\n";

/// 2 × 2 texels: grey levels row by row from the top left, all opaque.
fn grey(levels: [u8; 4]) -> image::RgbImage {
    image::RgbImage::from_fn(2, 2, |x, y| image::Rgb([levels[(2 * y + x) as usize]; 3]))
}

fn folder(mtl: Option<&str>) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("leaf.obj"), LEAF).unwrap();
    if let Some(mtl) = mtl {
        std::fs::write(folder.path().join("leaf.mtl"), mtl).unwrap();
    }
    std::fs::create_dir(folder.path().join("textures")).unwrap();
    grey([255, 0, 127, 128])
        .save(folder.path().join("textures/mask.tga"))
        .unwrap();
    grey([255, 0, 0, 0])
        .save(folder.path().join("textures/colour.png"))
        .unwrap();
    folder
}

fn load(folder: &Path, materials: ObjMaterials) -> Result<(Mesh, ImportReport), SceneError> {
    let options = ObjOptions {
        materials,
        ..ObjOptions::default()
    };
    load_obj(&folder.join("leaf.obj"), &options)
}

fn error(mtl: Option<&str>) -> String {
    let folder = folder(mtl);
    let text = load(folder.path(), ObjMaterials::All)
        .unwrap_err()
        .to_string();
    text.replace(&folder.path().display().to_string(), "DIR")
}

#[test]
fn a_mask_is_the_texture_of_opacity() {
    let mtl = "newmtl leaf\nKd 0.5 0.25 1\nmap_Kd textures\\colour.png\n\
               map_d -clamp on textures\\mask.tga\n";
    let folder = folder(Some(mtl));
    let (mesh, report) = load(folder.path(), ObjMaterials::All).unwrap();
    assert!(!report.has_warnings());
    let mask = mesh.surfaces.mask(0).unwrap();
    assert_eq!((mask.size, mask.wrap), ([2, 2], [Wrap::Clamp; 2]));
    // 128 of 255 is half and more, 127 is not.
    assert_eq!(mask.opaque, [0b1001]);
    // v is 0 at the bottom of the picture.
    let at = |u: f64, v: f64| {
        mask.ask(glam::DVec2::new(u, 1.0 - v), glam::DVec2::ZERO)
            .opaque
    };
    assert!(at(0.25, 0.75) && !at(0.75, 0.75) && !at(0.25, 0.25) && at(0.75, 0.25));
    assert_eq!(mesh.surfaces.corner_uvs(0)[0], glam::Vec2::new(0.0, 1.0));
    // The corner (0, 1) is white in the picture, the corner (1, 0) black.
    assert_eq!(
        mesh.surfaces.base_color(1, [0.1, 0.1, 0.8]),
        [0.5, 0.25, 1.0]
    );
    assert_eq!(mesh.surfaces.base_color(0, [0.1, 0.8, 0.1]), [0.0; 3]);
}

#[test]
fn opacity_alone_hides_or_does_nothing() {
    for (mtl, hidden) in [
        ("newmtl leaf\nd 0.4\n", true),
        ("newmtl leaf\nd 0.6\n", false),
        ("newmtl other\nd 0\n", false),
    ] {
        let folder = folder(Some(mtl));
        let (mesh, _) = load(folder.path(), ObjMaterials::All).unwrap();
        assert_eq!(mesh.surfaces.need_care(), hidden, "{mtl}");
    }
}

#[test]
fn what_is_not_wanted_need_not_be_there() {
    let folder = folder(None);
    let (mesh, report) = load(folder.path(), ObjMaterials::Ignore).unwrap();
    assert!(!report.has_warnings() && mesh.surfaces.materials.is_empty());
    let (mesh, report) = load(folder.path(), ObjMaterials::Color).unwrap();
    assert_eq!(report.colours_missing.len(), 1);
    assert!(report.to_string().contains("leaf.mtl"), "{report}");
    assert_eq!(mesh.triangles.len(), 2);
    // A mask is none of the colours.
    std::fs::write(
        folder.path().join("leaf.mtl"),
        "newmtl leaf\nmap_d no.png\n",
    )
    .unwrap();
    let (mesh, report) = load(folder.path(), ObjMaterials::Color).unwrap();
    assert!(!report.has_warnings() && !mesh.surfaces.need_care());
}

#[test]
fn broken_materials_say_where_and_what_to_do() {
    let errors = [
        error(None),
        error(Some("newmtl leaf\nd dim\n")),
        error(Some("newmtl leaf\nmap_d no.png\n")),
        error(Some("newmtl leaf\nmap_d leaf.obj\n")),
    ];
    insta::assert_snapshot!(errors.join("\n"));
}

/// The mask, the uvs of the first corner and the remarks that a file of materials makes.
fn masked(mtl: &str) -> (Option<Vec<u32>>, glam::Vec2, String) {
    let folder = folder(Some(mtl));
    let (mesh, report) = load(folder.path(), ObjMaterials::All).unwrap();
    let mask = mesh.surfaces.mask(0).map(|mask| mask.opaque.clone());
    let remarks = report.remarks.join("\n");
    let place = format!("{}/", folder.path().display());
    (
        mask,
        mesh.surfaces.corner_uvs(0)[0],
        remarks.replace(&place, ""),
    )
}

#[test]
fn options_of_a_mask_are_followed_or_told() {
    let file = "textures/mask.tga";
    let (plain, uv, remarks) = masked(&format!("newmtl leaf\nmap_d {file}\n"));
    assert_eq!(
        (plain, uv, remarks.as_str()),
        (Some(vec![0b1001]), glam::Vec2::new(0.0, 1.0), "")
    );
    // A quarter to the right and half up, where v counts from below.
    let (_, uv, _) = masked(&format!("newmtl leaf\nmap_d -s 2 4 -o 0.25 0.5 {file}\n"));
    assert_eq!(uv, glam::Vec2::new(0.25, 0.5));
    // Half and more everywhere: a mask of nothing but opaque texels is none.
    let (raised, ..) = masked(&format!("newmtl leaf\nmap_d -mm 0.5 0.5 {file}\n"));
    assert_eq!(raised, None);
    let (lowered, ..) = masked(&format!("newmtl leaf\nmap_d -mm 0 0.6 {file}\n"));
    assert_eq!(lowered, Some(vec![0b0001]));
    let (_, _, remarks) = masked(&format!("newmtl leaf\nmap_d -t 1 1 1 {file}\n"));
    assert_eq!(
        remarks,
        "material \"leaf\" of leaf.mtl: -t of map_d is not followed"
    );
    let text = format!("newmtl leaf\nmap_Kd -o 0.5 0 textures/colour.png\nmap_d {file}\n");
    let (_, uv, remarks) = masked(&text);
    assert_eq!(uv, glam::Vec2::new(0.0, 1.0));
    assert!(
        remarks.contains("-o and -s of map_Kd are not followed"),
        "{remarks}"
    );
}

#[test]
fn transparency_hides_where_d_says_nothing() {
    let (hidden, _, remarks) = masked("newmtl leaf\nTr 0.9\n");
    assert_eq!(hidden, Some(vec![0]));
    assert!(remarks.contains("Tr hides it"), "{remarks}");
    for seen in ["Tr 0.4", "Tr 1\nd 1", "d 1\nTr 1", "Tr", "d"] {
        assert_eq!(masked(&format!("newmtl leaf\n{seen}\n")).0, None, "{seen}");
    }
}

#[test]
fn materials_that_are_nowhere_are_told() {
    let (_, _, remarks) = masked("newmtl other\n");
    let remark = "material \"leaf\" is in no .mtl file that the file names: it is white and opaque";
    assert_eq!(remarks, remark);
}

#[test]
fn texture_coordinates_must_be_there_where_a_mask_is() {
    let folder = folder(Some("newmtl leaf\nmap_d textures/mask.tga\n"));
    let text = LEAF.replace("4/4", "4/5");
    std::fs::write(folder.path().join("leaf.obj"), &text).unwrap();
    let error = load(folder.path(), ObjMaterials::All)
        .unwrap_err()
        .to_string();
    let message = "(line 11) names texture coordinates 5, but the file has 4 pairs";
    assert!(error.contains(message), "{error}");
    for materials in [ObjMaterials::Ignore, ObjMaterials::Color] {
        assert!(load(folder.path(), materials).is_ok());
    }
    std::fs::write(folder.path().join("leaf.mtl"), "newmtl leaf\n").unwrap();
    let (_, report) = load(folder.path(), ObjMaterials::All).unwrap();
    let remark = "1 face names texture coordinates that are not there";
    assert_eq!(report.remarks, [remark]);
}

/// Materials may come without texture coordinates, which then are zero.
#[test]
fn surfaces_without_texture_coordinates_are_padded_and_replaced() {
    let folder = folder(Some("newmtl leaf\nKd 1 0 0\n"));
    let (mesh, _) = load(folder.path(), ObjMaterials::All).unwrap();
    let leaf = &mesh.surfaces;
    let mut bare = Surfaces {
        uvs: Vec::new(),
        uv_indices: Vec::new(),
        ..leaf.clone()
    };
    bare.pad(3);
    assert_eq!((bare.of.len(), bare.uv_indices.len()), (3, 0));
    assert_eq!(bare.corner_uvs(2), [glam::Vec2::ZERO; 3]);
    bare.put(leaf, (1, 2), 3);
    assert_eq!(bare.corner_uvs(0), [glam::Vec2::ZERO; 3]);
    assert_eq!(bare.corner_uvs(1), leaf.corner_uvs(0));
    assert_eq!(bare.base_color(2, [0.2, 0.3, 0.5]), [1.0, 0.0, 0.0]);
}

/// Masks are looked up by texture coordinates: without these, all tracers and maps take the
/// triangle for opaque, also once its mesh stands beside one that has some.
#[test]
fn masks_of_surfaces_without_texture_coordinates_hide_nothing() {
    let folder = folder(Some("newmtl leaf\nmap_d textures/mask.tga\n"));
    let (mesh, _) = load(folder.path(), ObjMaterials::All).unwrap();
    let leaf = &mesh.surfaces;
    let bare = Surfaces {
        uvs: Vec::new(),
        uv_indices: Vec::new(),
        ..leaf.clone()
    };
    let broken = Surfaces {
        uvs: vec![glam::Vec2::NAN; leaf.uvs.len()],
        ..leaf.clone()
    };
    let is_masked = |surfaces: &Surfaces| [0, 1].map(|id| surfaces.mask(id).is_some());
    assert_eq!(is_masked(leaf), [true; 2]);
    assert_eq!(is_masked(&bare), [false; 2]);
    assert_eq!(is_masked(&broken), [false; 2]);

    let mut first = bare.clone();
    first.of.resize(4, 0);
    first.put(leaf, (2, 2), 4);
    let mut last = leaf.clone();
    last.pad(4);
    last.put(&bare, (2, 2), 4);
    let masked = |surfaces: &Surfaces| [0, 1, 2, 3].map(|id| surfaces.mask(id).is_some());
    assert_eq!(masked(&first), [false, false, true, true]);
    assert_eq!(masked(&last), [true, true, false, false]);
}
