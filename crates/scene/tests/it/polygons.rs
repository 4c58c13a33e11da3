//! Concave faces: cut as their outline is, or refused.

use glam::DVec3;
use insta::assert_snapshot;
use proptest::prelude::*;
use skiagraph_scene::{Concave, Mesh, ObjOptions, QuadDiagonal, SceneError, obj::parse_obj};
use std::path::Path;

fn parse(text: &str, quads: QuadDiagonal) -> Result<Mesh, SceneError> {
    let options = ObjOptions {
        quads,
        ..ObjOptions::default()
    };
    parse_obj(text.as_bytes(), Path::new("house.obj"), &options).map(|(mesh, _)| mesh)
}

/// A face of these corners, in a plane that no axis is along.
fn face(corners: &[[f64; 2]]) -> String {
    let mut text = String::new();
    for [x, y] in corners {
        text += &format!("v {x} {y} {}\n", 0.25 * x - 0.5 * y);
    }
    text += "f";
    for number in 1..=corners.len() {
        text += &format!(" {number}");
    }
    text + "\n"
}

/// Twice the area seen from above, and that of each triangle's size alone.
fn areas(mesh: &Mesh) -> (f64, f64) {
    let up = |primitive| {
        let [a, b, c] = mesh.corners(primitive);
        (b - a).cross(c - a).dot(DVec3::Z)
    };
    let areas: Vec<f64> = (0..mesh.triangles.len() as u32).map(up).collect();
    (
        areas.iter().sum(),
        areas.iter().map(|area| area.abs()).sum(),
    )
}

const L: [[f64; 2]; 6] = [[0., 0.], [2., 0.], [2., 1.], [1., 1.], [1., 2.], [0., 2.]];

#[test]
fn an_l_has_its_area_from_every_corner_on() {
    for first in 0..L.len() {
        let mut corners = L;
        corners.rotate_left(first);
        for quads in [QuadDiagonal::FirstThird, QuadDiagonal::SecondFourth] {
            let mesh = parse(&face(&corners), quads).unwrap();
            assert_eq!(mesh.triangles.len(), 4);
            assert_eq!(areas(&mesh), (6.0, 6.0), "{first} {quads:?}");
        }
        corners.reverse();
        let mesh = parse(&face(&corners), QuadDiagonal::FirstThird).unwrap();
        assert_eq!(areas(&mesh), (-6.0, 6.0), "seen from behind");
    }
}

#[test]
fn a_quad_with_a_dent_takes_the_other_diagonal() {
    let dented = [[0., 0.], [4., 0.], [1., 1.], [0., 4.]];
    let mesh = parse(&face(&dented), QuadDiagonal::SecondFourth).unwrap();
    assert_eq!(areas(&mesh), (8.0, 8.0));
    // The fan from the first corner fits, and stays.
    let mesh = parse(&face(&dented), QuadDiagonal::FirstThird).unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
}

#[test]
fn corners_on_a_line_are_kept_for_the_neighbours() {
    // An L with two more points on each of its long edges.
    let corners = [
        [0., 0.],
        [0.5, 0.],
        [1., 0.],
        [2., 0.],
        [2., 1.],
        [1., 1.],
        [1., 2.],
        [0., 2.],
        [0., 1.5],
        [0., 0.5],
    ];
    let mesh = parse(&face(&corners), QuadDiagonal::FirstThird).unwrap();
    assert_eq!(areas(&mesh), (6.0, 6.0));
    let mut used: Vec<u32> = mesh.triangles.concat();
    used.sort_unstable();
    used.dedup();
    assert_eq!(used.len(), corners.len());
    // Every side of the outline is a triangle's.
    for from in 0..corners.len() as u32 {
        let to = (from + 1) % corners.len() as u32;
        let has = |face: &[u32; 3]| (0..3).any(|i| (face[i], face[(i + 1) % 3]) == (from, to));
        assert!(
            mesh.triangles.iter().any(has),
            "{from} {to} in {:?}",
            mesh.triangles
        );
    }
}

#[test]
fn an_outline_that_crosses_itself_is_refused() {
    let star: Vec<[f64; 2]> = (0..5)
        .map(|i| f64::from(2 * i) * std::f64::consts::TAU / 5.0)
        .map(|angle| [angle.cos(), angle.sin()])
        .collect();
    let bow = [[0., 0.], [1., 1.], [1., 0.], [0., 1.]];
    let text = [
        face(&bow),
        face(&star).replace("f 1 2 3 4 5", "f 5 6 7 8 9"),
    ]
    .concat();
    let error = parse(&text, QuadDiagonal::FirstThird).unwrap_err();
    assert_snapshot!(error);
    let fanned = ObjOptions {
        concave: Concave::Fan,
        ..ObjOptions::default()
    };
    assert!(parse_obj(text.as_bytes(), Path::new("house.obj"), &fanned).is_ok());
}

proptest! {
    /// Stars around a point, which no corner's fan need partition.
    #[test]
    fn any_simple_outline_keeps_its_area(radii in prop::collection::vec(0.1f64..4.0, 4..24)) {
        let count = radii.len() as f64;
        let corners: Vec<[f64; 2]> = radii.iter().enumerate().map(|(i, radius)| {
            let angle = i as f64 * std::f64::consts::TAU / count;
            // In f32, as a file's numbers are read.
            [angle.cos() * radius, angle.sin() * radius].map(|at| f64::from(at as f32))
        }).collect();
        let whole: f64 = (0..corners.len()).map(|i| {
            let ([x, y], [p, q]) = (corners[i], corners[(i + 1) % corners.len()]);
            x * q - y * p
        }).sum();
        let mesh = parse(&face(&corners), QuadDiagonal::FirstThird).unwrap();
        let (signed, sizes) = areas(&mesh);
        prop_assert!((signed - whole).abs() < 1e-4 && (sizes - whole).abs() < 1e-4);
    }
}
