//! OBJ import: what becomes of good files, and what is said about broken ones.

use glam::Vec3;
use insta::assert_snapshot;
use proptest::prelude::*;
use skiagraph_scene::{
    ImportReport, Mesh, ObjMaterials, ObjOptions, QuadDiagonal, SceneError, obj::parse_obj,
};
use std::path::Path;

fn parse_with(
    text: impl AsRef<[u8]>,
    options: &ObjOptions,
) -> Result<(Mesh, ImportReport), SceneError> {
    parse_obj(text.as_ref(), Path::new("house.obj"), options)
}

fn parse(text: impl AsRef<[u8]>) -> (Mesh, ImportReport) {
    parse_with(text, &ObjOptions::default()).unwrap()
}

fn error(text: impl AsRef<[u8]>) -> String {
    parse_with(text, &ObjOptions::default())
        .unwrap_err()
        .to_string()
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

fn quad(quads: QuadDiagonal) -> Vec<[u32; 3]> {
    let text = format!("{SQUARE}f 1 2 3 4\n");
    parse_with(
        text,
        &ObjOptions {
            quads,
            ..ObjOptions::default()
        },
    )
    .unwrap()
    .0
    .triangles
}

#[test]
fn quads_are_split_as_asked() {
    assert_eq!(quad(QuadDiagonal::FirstThird), [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(quad(QuadDiagonal::SecondFourth), [[1, 2, 3], [1, 3, 0]]);
}

#[test]
fn larger_polygons_are_fanned_from_the_same_corner() {
    let text = "v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 2 0\nf 1 2 3 4 5\n";
    assert_eq!(parse(text).0.triangles, [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
    let second = ObjOptions {
        quads: QuadDiagonal::SecondFourth,
        ..ObjOptions::default()
    };
    assert_eq!(
        parse_with(text, &second).unwrap().0.triangles,
        [[1, 2, 3], [1, 3, 4], [1, 4, 0]]
    );
}

#[test]
fn bit_equal_positions_are_one_and_minus_zero_is_zero() {
    let (mesh, _) =
        parse("v 0 0 0\nv 1 0 0\nv 0 1 0\nv -0 -0.0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\nf 4 5 6\n");
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 1, 3]]);
    assert_eq!(mesh.positions.len(), 4);
    assert!(mesh.positions.iter().all(|p| {
        p.to_array()
            .iter()
            .all(|x| x.to_bits() != (-0.0f32).to_bits())
    }));
}

#[test]
fn groups_across_the_file_share_positions() {
    let (mesh, _) = parse(format!("{SQUARE}g a\nf 1 2 3\ng b\nf 1 3 4\n"));
    assert_eq!(mesh.positions.len(), 4);
    let groups: Vec<_> = mesh
        .groups
        .iter()
        .map(|group| (group.name.as_str(), group.triangles.clone()))
        .collect();
    assert_eq!(groups, [("a", 0..1), ("b", 1..2)]);
}

#[test]
fn many_faces_share_positions_and_normals() {
    // More of them than `tobj` is handed at once.
    let count = 40_000;
    let vertices = (0..count + 2).map(|at| format!("v {at} {} 0\n", at % 2));
    let faces = (1..=count).map(|at| match at % 3 {
        0 => format!("f {at} {} {}\n", at + 1, at + 2),
        1 => format!("f {at} {}//2 {}\n", at + 1, at + 2),
        _ => format!("f {at}//3 {}//1 {}//-1\n", at + 1, at + 2),
    });
    let normals = "vn 2 0 0\nvn 0 1 0\nvn 4 0 0\n".to_owned();
    let text: String = vertices.chain([normals]).chain(faces).collect();
    let (mesh, _) = parse(text);
    assert_eq!(mesh.positions.len(), count as usize + 2);
    assert!((0..count).eq(mesh.triangles.iter().map(|[first, ..]| *first)));
    assert!((1..=count).eq(mesh.triangles.iter().map(|[_, second, _]| *second)));
    assert_eq!(mesh.normals, [Vec3::NEG_Z, Vec3::X, Vec3::Z]);
    // Every third face has normals at all of its corners; the others lie up or down.
    let expected = |at: u32| match (at % 3, at % 2) {
        (2, _) => [1; 3],
        (_, 0) => [2; 3],
        _ => [0; 3],
    };
    let normal_indices = mesh.normal_indices.iter().copied();
    assert!((1..=count).map(expected).eq(normal_indices));
}

#[test]
fn given_normals_are_normalised_and_shared() {
    let (mesh, _) = parse(format!(
        "{SQUARE}vn 0 0 2\nvn 0 3 4\nf 1//1 2//1 3//2\nf 1//1 3//2 4//-1\n"
    ));
    assert_eq!(mesh.normals, [Vec3::Z, Vec3::new(0.0, 0.6, 0.8)]);
    assert_eq!(mesh.normal_indices, [[0, 0, 1], [0, 1, 1]]);
}

#[test]
fn faces_without_normals_are_flat() {
    // The second face names a normal at one corner only: that is as good as none.
    let (mesh, _) = parse("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 1 0 0\nf 1 2 3\nf 1//1 3 4\n");
    assert_eq!(mesh.corner_normals(0), [glam::DVec3::Z; 3]);
    assert_eq!(mesh.corner_normals(1), [glam::DVec3::X; 3]);
}

#[test]
fn faces_that_name_normals_which_are_not_there_are_flat() {
    for (normal, normals) in [
        ("2", "vn 0 1 0\n"),
        ("1", ""),
        ("-1", ""),
        ("0", "vn 0 1 0\n"),
    ] {
        let (mesh, report) = parse(format!("{SQUARE}{normals}f 1//{normal} 2//{normal} 3//1\n"));
        assert_eq!(mesh.corner_normals(0), [glam::DVec3::Z; 3]);
        assert_eq!(
            report.remarks,
            ["1 face names normals that are not there: flat"]
        );
    }
}

#[test]
fn normals_that_are_no_numbers_have_no_direction() {
    let (mesh, report) = parse(format!(
        "{SQUARE}vn 1 0 zero\nvn 1\nvn 1 0 0\nf 1//1 2//2 3//3\n"
    ));
    let [one, two, three] = mesh.corner_normals(0);
    assert_eq!(
        [one, two, three],
        [glam::DVec3::Z, glam::DVec3::Z, glam::DVec3::X]
    );
    assert_snapshot!(report, @"
    2 corner normals without a direction replaced by the triangle's own
    2 normals (vn) passed over: not three numbers
    ");
}

#[test]
fn positive_numbers_count_from_the_beginning_of_the_file_and_negative_ones_back() {
    let (mesh, _) =
        parse("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 0 0 1\nf 1 2 4\nf -4 -3 -1\n");
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 1, 2], [0, 1, 3], [0, 1, 3]]);
    let error = error("f -1 1 2\nv 0 0 0\nv 1 0 0\nv 0 1 0\n");
    assert!(
        error.contains("names vertex -1, but 0 vertices stand above it"),
        "{error}"
    );
}

#[test]
fn curves_and_surfaces_are_told() {
    let (_, report) = parse(format!(
        "{SQUARE}f 1 2 3\nsurf 0 1 0 1 1 2 3 4\ncurv 0 1 1 2\n"
    ));
    let remark = "2 curves and surfaces (curv, surf) passed over: only faces are drawn";
    assert_eq!(report.remarks, [remark]);
}

#[test]
fn normals_without_a_direction_are_replaced() {
    let (mesh, report) = parse(format!(
        "{SQUARE}vn 0 0 0\nvn nan 0 0\nvn 1 0 0\nf 1//1 2//2 3//3\n"
    ));
    assert_eq!(
        mesh.corner_normals(0),
        [glam::DVec3::Z, glam::DVec3::Z, glam::DVec3::X]
    );
    assert_eq!(report.normals_replaced, 2);
}

#[test]
fn degenerate_triangles_are_reported_by_group_and_face() {
    let (mesh, report) = parse(
        "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 0 0 0\ng roof\nf 1 2 4\nf 1 2 5\ng wall\nf 1 2 \
         3\nf 1 1 2 4\n",
    );
    // numbered as the faces name them
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 1, 3], [0, 1, 2]]);
    assert_snapshot!(report, @"
    2 triangles dropped, two corners being the same point: face 2 of group \"roof\" (line 8), face \
        2 of group \"wall\" (line 11)
    1 triangle without area kept: face 1 of group \"wall\" (line 10)
    ");
}

#[test]
fn a_tiny_area_is_an_area() {
    let (_, report) =
        parse("v 0 0 0\nv 1e-30 0 0\nv 0 1e-30 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 4 5\n");
    assert_eq!(report.zero_area.triangles, 0);
}

#[test]
fn points_and_lines_are_counted_not_drawn() {
    let (mesh, report) = parse(format!("{SQUARE}p 1\nl 1 2 3\nl 1 2\nf 1 2\nf 1 2 3\n"));
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
    assert_snapshot!(report, @"1 point and 3 lines left out");
    assert_eq!((report.points, report.lines), (1, 3));
}

#[test]
fn groups_are_left_out_by_name() {
    let options = ObjOptions {
        leave_out: vec!["cloth 4".into()],
        ..ObjOptions::default()
    };
    // The faces of a group left out are not checked.
    let text = format!("{SQUARE}g a\nf 1 2 3\no cloth 4 \nf 1 2 3\nf 1 2 99\ng a\nf 1 3 4\n");
    let (mesh, report) = parse_with(text, &options).unwrap();
    assert_eq!(mesh.triangles.len(), 2);
    assert_eq!(report.faces, 2);
}

#[test]
fn odd_but_valid_text() {
    let (mesh, _) = parse_with(
        "\u{feff}# bom in C:\\\r\n#no space\r\nmtllib none.mtl\r\n  v 0 0 0\r\nv\t1 0 0 1 0 \
         0\r\nv 0 2 0 2 # weight\r\nusemtl x\r\ns off\r\n\
         g C:\\\r\nf 1 \\\r\n 2 3\r\nf -3/7/ -2/8 -1\r\nf +1 2 3# end",
        &ObjOptions {
            materials: ObjMaterials::Ignore,
            ..ObjOptions::default()
        },
    )
    .unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2]; 3]);
    assert_eq!(mesh.positions[2], Vec3::Y, "a fourth number is a weight");
}

#[test]
fn lines_of_old_macs_are_lines() {
    let text = format!("# a house\n{SQUARE}f 1 2 3\nf 1 3 9\n");
    let message = error(text.replace('\n', "\r"));
    assert!(message.contains("(line 7) names vertex 9"), "{message}");
    assert_eq!(error(text.replace('\n', "\r\n")), message);
}

#[test]
fn broken_files_are_explained() {
    assert_snapshot!(error(""), @"house.obj: no triangles: the file holds 0 faces, 0 lines and 0 \
        points");
    assert_snapshot!(error("v 1 2 3\nl 1 1\n"), @"house.obj: no triangles: the file holds 0 \
        faces, 1 line and 0 points");
    assert_snapshot!(error("v 1 2 3\nv 1 zwei 3\n"), @"house.obj:2: position parse error in \"v 1 \
        zwei 3\"");
    assert_snapshot!(error("v 1 2"), @r#"house.obj:1: position parse error in "v 1 2""#);
    assert_snapshot!(error("v 1 2 3 0\n"), @r#"house.obj:1: scaling (w) by zero in "v 1 2 3 0""#);
    assert_snapshot!(error(format!("{SQUARE}f 1 2 3\nf 1 2")), @"house.obj:6: the file ends in \
        the middle of a face");
    assert_snapshot!(error(format!("{SQUARE}f\n")), @"house.obj:5: a face without corners");
    assert_snapshot!(error(b"v 0 0 0\nv 1 \xff 0\n"), @"house.obj:2: position parse error in \"v 1 \
        ÿ 0\"");
    assert_snapshot!(error(b"\x89PNG\r\n\x1a\n\0\0\0"), @"house.obj:1: not an OBJ file, or \
        damaged: it holds no vertex, but bytes that are not text");
}

#[test]
fn broken_faces_are_named() {
    let faces = "g wall\nf 1 2 3\nf 1 2 5\nf 0 1 2\ng roof\nf 1 2 -5\n";
    assert_snapshot!(error(format!("{SQUARE}{faces}")), @r#"
    house.obj: 3 faces cannot be used
      face 2 of group "wall" (line 7) names vertex 5, but the file has 4 vertices
      face 3 of group "wall" (line 8) names vertex 0, but the file has 4 vertices
      face 1 of group "roof" (line 10) names vertex -5, but 4 vertices stand above it
    "#);
    assert_snapshot!(error(format!("{SQUARE}f 1/2/3/4 2 3\nf 1 2 x\nf 1 2 3.5\nf // 1 2\n")), @"
    house.obj: 4 faces cannot be used
      face 1 of group \"unnamed\" (line 5) has the corner \"1/2/3/4\"; expected v, v/vt, v//vn or \
          v/vt/vn
      face 2 of group \"unnamed\" (line 6) has the corner \"x\"; expected v, v/vt, v//vn or v/vt/vn
      face 3 of group \"unnamed\" (line 7) has the corner \"3.5\"; expected v, v/vt, v//vn or \
          v/vt/vn
      face 4 of group \"unnamed\" (line 8) has the corner \"//\"; expected v, v/vt, v//vn or v/vt/vn
    ");
    let huge = [
        "99999999999999999999999",
        "-9223372036854775808",
        "18446744073709551615",
    ];
    let faces = huge.map(|index| format!("f 1 2 {index}\n")).concat();
    assert_snapshot!(error(format!("{SQUARE}{faces}")), @"
    house.obj: 3 faces cannot be used
      face 1 of group \"unnamed\" (line 5) names vertex 99999999999999999999999, but the file \
          has 4 vertices
      face 2 of group \"unnamed\" (line 6) names vertex -9223372036854775808, but 4 vertices stand \
          above it
      face 3 of group \"unnamed\" (line 7) names vertex 18446744073709551615, but the file has 4 \
          vertices
    ");
    let vertices = "v 0 0 0\nv nan 0 0\nv 0 1e39 0\nv 0 1 0\nv 1 1 0\n";
    let faces = "g wall\nf 1 4 5\nf 1 2 4\nf 1 4 3\n";
    assert_snapshot!(error(format!("{vertices}{faces}")), @r#"
    house.obj: 2 faces cannot be used
      face 2 of group "wall" (line 8) has its corner 2 at [NaN, 0, 0], which is not finite
      face 3 of group "wall" (line 9) has its corner 3 at [0, inf, 0], which is not finite
    "#);
    assert_snapshot!(error(format!("{SQUARE}{}", "f 1 2 9\n".repeat(7))), @r#"
    house.obj: 7 faces cannot be used
      face 1 of group "unnamed" (line 5) names vertex 9, but the file has 4 vertices
      face 2 of group "unnamed" (line 6) names vertex 9, but the file has 4 vertices
      face 3 of group "unnamed" (line 7) names vertex 9, but the file has 4 vertices
      face 4 of group "unnamed" (line 8) names vertex 9, but the file has 4 vertices
      face 5 of group "unnamed" (line 9) names vertex 9, but the file has 4 vertices
      and 2 more
    "#);
}

#[test]
fn unused_broken_vertices_do_no_harm() {
    assert_eq!(
        parse(format!("{SQUARE}v nan inf 0\nf 1 2 3\n"))
            .0
            .positions
            .len(),
        3
    );
}

#[test]
fn a_group_to_leave_out_must_exist() {
    let options = ObjOptions {
        leave_out: vec!["clout".into()],
        ..ObjOptions::default()
    };
    let error = parse_with(
        format!("{SQUARE}g cloth\nf 1 2 3\ng wall\nf 1 2 3\n"),
        &options,
    )
    .unwrap_err();
    assert_snapshot!(error, @"house.obj: there is no group \"clout\" to leave out; the file's \
        groups are cloth, wall");
}

#[test]
fn a_missing_file_is_named() {
    let error =
        skiagraph_scene::load_obj(Path::new("no/such.obj"), &ObjOptions::default()).unwrap_err();
    assert!(
        error.to_string().starts_with("cannot read no/such.obj: "),
        "{error}"
    );
}

#[test]
fn a_model_whose_products_leave_f32_is_refused() {
    let scaled =
        |exponent: i32| format!("v 0 0 0\nv 1e{exponent} 0 0\nv 0 1e{exponent} 0\nf 1 2 3\n");
    for exponent in [-11, 0, 11] {
        assert!(parse_with(scaled(exponent), &ObjOptions::default()).is_ok());
    }
    assert_snapshot!(
        error(scaled(13)),
        @"house.obj: the model is 1.4e13 units across and reaches 1.0e13 from the origin, but f32 \
            can only tell right from wrong between 1e-12 and 1e12: scale it"
    );
    assert!(error(scaled(-13)).contains("between 1e-12 and 1e12: scale it"));
    assert!(error("v 1e13 0 0\nv 1e13 1 0\nv 1e13 1 1\nf 1 2 3\n").contains("reaches 1.0e13"));
}

fn any_line() -> impl Strategy<Value = String> {
    prop_oneof![
        "v( -?[0-9.e]{1,4}){2,7}",
        Just("v 1 2 3".to_owned()),
        "vn( -?[0-9]{1,2}){2,4}",
        "f( -?[0-9]{1,2}){0,6}",
        "f( -?[0-9]{0,22}(/-?[0-9]{0,22}){0,3}){2,4}",
        "[flpgov]?( [0-9]{0,3}){0,3}\\\\?",
        "\\PC{0,12}",
    ]
}

proptest! {
    #[test]
    fn no_text_makes_it_panic(
        lines in prop::collection::vec(any_line(), 0..40),
        cut in 0usize..400,
    ) {
        let text = lines.join("\n");
        let cut = cut.min(text.len());
        for bytes in [text.as_bytes(), &text.as_bytes()[..cut]] {
            if let Ok((mesh, _)) = parse_with(bytes, &ObjOptions::default()) {
                prop_assert_eq!(mesh.triangles.len(), mesh.normal_indices.len());
                prop_assert!(
                    mesh.triangles
                        .iter()
                        .flatten()
                        .all(|&index| (index as usize) < mesh.positions.len())
                );
                prop_assert!(mesh.positions.iter().all(|position| position.is_finite()));
                prop_assert!(mesh.normals.iter().all(|normal| normal.is_normalized()));
            }
        }
    }

    #[test]
    fn no_bytes_make_it_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = parse_with(bytes, &ObjOptions::default());
    }
}
