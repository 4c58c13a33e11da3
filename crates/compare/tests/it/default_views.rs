//! Views that are chosen for a mesh without cameras: props from outside, rooms from inside, towns
//! from a street as well, all with light and shadow.

use crate::props::{Shape, block, interiors, prop, props, towns};
use glam::DVec3;
use skiagraph_compare::default_view::{Place, ViewRequest, default_views, more_views};
use skiagraph_compare::own_camera::OwnCamera;
use skiagraph_compare::own_scene::{MeshSceneOptions, OwnScene};
use skiagraph_compare::own_scene_notes::notes;
use skiagraph_reference::{BACKGROUND, Class, Oracle, OracleMode, Progress};
use skiagraph_scene::{DirectionalLight, LightKind, Mesh, Parts, Scene, View};
use std::path::Path;

/// How a shape is written.
#[derive(Clone, Copy, Debug)]
struct Form {
    unit: f64,
    off: DVec3,
    is_z_up: bool,
    is_gltf: bool,
    is_double_sided: bool,
}

const PLAIN: Form = Form {
    unit: 1.0,
    off: DVec3::ZERO,
    is_z_up: false,
    is_gltf: false,
    is_double_sided: false,
};

/// Forms in turn: each unit with each kind of file, off the origin by ten thousand where f32 holds
/// the mesh there.
fn form(number: usize) -> Form {
    let unit = [1.0, 100.0, 39.37, 0.01][number % 4];
    let off = if number % 3 == 1 {
        1e4 * f64::min(unit, 1.0)
    } else {
        0.0
    };
    Form {
        unit,
        off: DVec3::new(off, -off, 0.5 * off),
        is_z_up: number % 5 == 2,
        is_gltf: number % 2 == 1,
        is_double_sided: number % 4 == 3,
    }
}

fn load(shape: &Shape, form: Form, ground: bool) -> (OwnScene, MeshSceneOptions) {
    let folder = tempfile::tempdir().unwrap();
    let shape = shape.clone().in_unit(form.unit, form.off, form.is_z_up);
    let file = folder
        .path()
        .join(if form.is_gltf { "it.gltf" } else { "it.obj" });
    if form.is_gltf {
        shape.write_gltf(&file, form.is_double_sided);
    } else {
        shape.write_obj(&file);
    }
    let camera = OwnCamera {
        up: form.is_z_up.then_some(DVec3::Z),
        ..OwnCamera::default()
    };
    let options = MeshSceneOptions {
        camera,
        ground,
        ..MeshSceneOptions::default()
    };
    (
        OwnScene::of_mesh(Path::new(&file), &options).unwrap(),
        options,
    )
}

/// Distances along a way at which it meets triangles, and the triangles; all of them are tried.
fn hits(mesh: &Mesh, from: DVec3, way: DVec3) -> Vec<(f64, u32)> {
    let hit = |primitive: u32| {
        let [a, b, c] = mesh.corners(primitive).map(|it| it - from);
        let sides = [b.cross(c), c.cross(a), a.cross(b)].map(|it| it.dot(way));
        let is_met = sides.iter().all(|it| *it > 0.0) || sides.iter().all(|it| *it < 0.0);
        let total: f64 = sides.iter().sum();
        let place = (a * sides[0] + b * sides[1] + c * sides[2]) / total;
        let distance = place.dot(way) / way.length_squared();
        (is_met && distance > 0.0).then_some((distance, primitive))
    };
    (0..mesh.triangles.len() as u32).filter_map(hit).collect()
}

/// The closed parts that have a place in them, by the parity of most of five rays.
fn around(mesh: &Mesh, place: DVec3) -> Vec<u32> {
    let parts = Parts::new(mesh);
    let ways = [
        [0.3, 0.9, 0.2],
        [-0.7, 0.1, 0.5],
        [0.2, -0.6, -0.4],
        [0.9, 0.2, -0.3],
        [-0.2, -0.3, 0.8],
    ];
    let rays = ways.map(|way| hits(mesh, place, DVec3::from(way)));
    let is_around = |part: &u32| {
        let is_odd = |ray: &&Vec<(f64, u32)>| {
            ray.iter()
                .filter(|(_, it)| parts.of[*it as usize] == *part)
                .count()
                % 2
                == 1
        };
        !parts.open[*part as usize] && rays.iter().filter(is_odd).count() > 2
    };
    (0..parts.open.len() as u32).filter(is_around).collect()
}

/// Shares of the pixels that show the mesh, and of those that face the light those that are lit and
/// those in shadow.
fn shares(scene: &Scene, view: &View, viewport: [u32; 2]) -> [f64; 3] {
    let camera = view.camera(viewport);
    let (oracle, progress) = (Oracle::new(&scene.mesh), Progress::default());
    let primitives = oracle.primary(&camera, progress).unwrap();
    let light = scene.light_of(view);
    let truth = oracle
        .shade(&camera, light, &primitives, OracleMode::Exact, progress)
        .unwrap();
    let count = |class| truth.classes.iter().filter(|it| **it == class).count() as f64;
    let shown = primitives.iter().filter(|it| **it != BACKGROUND).count() as f64;
    let (lit, shadow) = (count(Class::Lit), count(Class::Shadow));
    let facing = (lit + shadow).max(1.0);
    [
        shown / primitives.len() as f64,
        lit / facing,
        shadow / facing,
    ]
}

/// Faults of the views of a scene, by the rule.
fn faults(own: &OwnScene, needs_shadow: bool) -> Vec<String> {
    let views = own.views(Some("all"), &OwnCamera::default(), None).unwrap();
    let fault = |(view, place): (&View, &Place)| {
        let mut text = String::new();
        let buried = around(&own.scene.mesh, view.eye);
        if !buried.is_empty() {
            text += &format!(" in the parts {buried:?}");
        }
        for viewport in [[64, 64], [112, 63]] {
            let [shown, lit, shadow] = shares(&own.scene, view, viewport);
            if shown < 0.25 || needs_shadow && (lit < 0.03 || shadow < 0.03) {
                text += &format!(" shown {shown:.3} lit {lit:.3} shadow {shadow:.3} {viewport:?}");
            }
        }
        (!text.is_empty()).then(|| format!("{} {place:?}:{text}", view.name))
    };
    views
        .iter()
        .zip(&own.chosen.places)
        .filter_map(fault)
        .collect()
}

fn up(form: Form) -> DVec3 {
    if form.is_z_up { DVec3::Z } else { DVec3::Y }
}

/// Props whose surfaces cast no shadow on each other, or hardly any, without a ground.
const CONVEX: [&str; 5] = ["ball", "hollow", "barrel", "torus", "vase"];

#[test]
fn props_are_seen_from_outside_with_light_and_shadow() {
    let mut wrong = Vec::new();
    for (number, (name, shape)) in props().iter().enumerate() {
        for (ground, form) in [
            (true, PLAIN),
            (false, PLAIN),
            (true, form(number)),
            (false, form(number + 1)),
        ] {
            let (own, _) = load(shape, form, ground);
            let needs_shadow = ground || !CONVEX.contains(name);
            let mut faults = faults(&own, needs_shadow);
            if own.chosen.places[0] != Place::Outside {
                faults.push(format!("{:?}", own.chosen.places));
            }
            wrong.extend(
                faults
                    .iter()
                    .map(|it| format!("{name}, ground {ground}, {form:?}: {it}")),
            );
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Where f32 holds the mesh in few steps, rounding may decide at most of its pixels.
#[test]
fn props_far_from_the_origin_are_seen_with_light_and_shadow() {
    let mut wrong = Vec::new();
    for (number, (name, shape)) in props().iter().enumerate() {
        for ground in [false, true] {
            let form = Form {
                off: DVec3::new(1e4, -1e4, 5e3),
                is_z_up: (number % 2 == 0) == ground,
                ..PLAIN
            };
            let (own, _) = load(shape, form, ground);
            let faults = faults(&own, ground || !CONVEX.contains(name));
            wrong.extend(
                faults
                    .iter()
                    .map(|it| format!("{name}, ground {ground}, {form:?}: {it}")),
            );
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn interiors_are_seen_at_eye_height_and_with_a_ground_from_outside() {
    let mut wrong = Vec::new();
    for (number, (name, shape, [floor, ceiling])) in interiors().iter().enumerate() {
        for form in [PLAIN, form(number), form(number + 2), form(number + 3)] {
            let (own, _) = load(shape, form, false);
            let mut faults = faults(&own, true);
            let eye = (own.scene.views[0].eye - form.off).dot(up(form)) / form.unit;
            if own.chosen.places[0] != Place::Inside {
                faults.push(format!("{:?}", own.chosen.places));
            } else if eye < floor + 0.15 * (ceiling - floor)
                || eye > floor + 0.6 * (ceiling - floor)
            {
                faults.push(format!("eye at {eye}"));
            }
            let (own, _) = load(shape, form, true);
            if own
                .chosen
                .places
                .iter()
                .any(|place| *place != Place::Outside)
            {
                faults.push(format!("with a ground {:?}", own.chosen.places));
            }
            wrong.extend(faults.iter().map(|it| format!("{name}, {form:?}: {it}")));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn towns_are_seen_from_a_street_as_well() {
    let mut wrong = Vec::new();
    for (number, (name, shape, has_floor)) in towns().iter().enumerate() {
        for (ground, form) in [
            (false, PLAIN),
            (true, PLAIN),
            (false, form(number)),
            (true, form(number + 1)),
            (false, form(number + 2)),
            (false, form(number + 3)),
        ] {
            let (own, options) = load(shape, form, ground);
            let mut faults = faults(&own, true);
            let places = &own.chosen.places;
            let street = places
                .iter()
                .position(|place| matches!(place, Place::Street(_)));
            match street {
                None => faults.push(format!("{places:?}")),
                Some(_) if !has_floor && !ground => {}
                Some(street) => {
                    let eye = own.scene.views[street].eye;
                    let below = hits(&own.scene.mesh, eye, -up(form));
                    let below = below.iter().map(|it| it.0).fold(f64::INFINITY, f64::min);
                    let metres = below / form.unit;
                    if !(1.0..3.0).contains(&metres) {
                        faults.push(format!("an eye {metres} m above the floor"));
                    }
                }
            }
            if !places.contains(&Place::Outside) {
                faults.push("not from outside".into());
            }
            let text = notes(&options, &own).join("\n");
            if *has_floor && text.contains("it has no floor") {
                faults.push(text);
            }
            wrong.extend(
                faults
                    .iter()
                    .map(|it| format!("{name}, ground {ground}, {form:?}: {it}")),
            );
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Walls of a room that are seen from inside, with or without a ceiling.
fn walls(has_ceiling: bool) -> Shape {
    let walls = block([-4.0, 0.0, -3.0], [4.0, 3.0, 3.0]).inward();
    walls.without(|middle| !has_ceiling && middle.y > 2.9)
}

fn table() -> Shape {
    block([-1.0, 0.7, -0.5], [1.0, 0.9, 0.5])
}

fn plate() -> Shape {
    block([-9.0, -0.2, -9.0], [9.0, 0.0, 9.0])
}

#[test]
fn a_closed_room_has_a_lamp_and_an_empty_one_is_a_box() {
    let (own, options) = load(&walls(false).and(table()), PLAIN, false);
    assert_eq!(own.chosen.places, [Place::Inside]);
    assert!(matches!(
        own.scene.lights[0].kind,
        LightKind::Directional(_)
    ));
    assert!(notes(&options, &own)[1].contains("from inside, for there is a place to stand"));
    let (own, options) = load(&walls(true).and(table()), PLAIN, false);
    assert_eq!(own.chosen.places, [Place::Inside]);
    let eye = own.scene.views[0].eye;
    let lamp = own.scene.lights[0].kind.position().unwrap();
    assert!(lamp.y > eye.y && lamp.y < 3.0, "{lamp}");
    assert!(lamp.x.abs() < 4.0 && lamp.z.abs() < 3.0, "{lamp}");
    assert!(notes(&options, &own)[1].contains("and a lamp at "));
    // With nothing in it, it is a box of which the outside may be meant, wound the other way.
    let (own, _) = load(&walls(true), PLAIN, false);
    assert_eq!(own.chosen.places, [Place::Outside]);
}

#[test]
fn what_surrounds_nothing_is_seen_from_outside() {
    let cup = block([-1.0, 0.1, -1.0], [1.0, 2.0, 1.0]).inward();
    let cup = plate().and(cup.without(|middle| middle.y > 1.9));
    let yard = plate().and(block([-9.0, 0.0, -9.0], [-8.0, 5.0, 9.0]));
    let wall = plate().and(block([-6.0, 0.01, -0.2], [6.0, 6.0, 0.2]));
    for shape in [table(), cup, yard, wall.clone()] {
        assert_eq!(load(&shape, PLAIN, false).0.chosen.places, [Place::Outside]);
    }
    let own = load(&wall, PLAIN, false).0;
    assert_eq!(own.scene.views[0].name, "main");
    assert_eq!(faults(&own, true), [""; 0]);
}

#[test]
fn a_direction_that_is_asked_for_is_kept() {
    for way in [
        DVec3::NEG_Y,
        DVec3::new(0.0, -1.0, 1e-12),
        DVec3::X,
        DVec3::new(1.0, -2.0, 0.5),
    ] {
        let (mut options, shape) = (MeshSceneOptions::default(), plate().and(table()));
        options.camera.direction = Some(way);
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("it.obj");
        shape.write_obj(&file);
        let own = OwnScene::of_mesh(&file, &options).unwrap();
        let views = own.views(None, &options.camera, None).unwrap();
        assert_eq!(views[0].direction, way);
        let [shown, ..] = shares(&own.scene, &views[0], [96, 64]);
        assert!(shown > 0.04, "{way}: {shown}");
        let text = notes(&options, &own).swap_remove(1);
        let mut words = text.split(' ').collect::<Vec<_>>();
        words.retain(|word| word.starts_with("--"));
        assert_eq!(words, ["--eye", "--light"]);
    }
}

#[test]
fn a_mesh_of_many_triangles_is_seen_as_one_of_few() {
    // Each square cut into many, so that its vertices are joined again to choose.
    let cut = |shape: Shape, count: usize| {
        let cut = |polygon: &Vec<DVec3>| {
            let [a, b, .., d] = polygon[..] else { panic!() };
            let at = move |x: usize, z: usize| {
                a + (b - a) * (x as f64 / count as f64) + (d - a) * (z as f64 / count as f64)
            };
            let squares = (0..count).flat_map(move |x| (0..count).map(move |z| (x, z)));
            squares.map(move |(x, z)| vec![at(x, z), at(x + 1, z), at(x + 1, z + 1), at(x, z + 1)])
        };
        Shape(shape.0.iter().flat_map(cut).collect())
    };
    let houses = (0..36).map(|at| {
        let (x, z) = (f64::from(at % 6) * 18.0, f64::from(at / 6) * 20.0);
        block(
            [x, 0.0, z],
            [x + 9.0, 5.0 + f64::from(at * 7 % 5), z + 11.0],
        )
    });
    let houses = houses.reduce(Shape::and).unwrap();
    let floor = block([-10.0, -1.0, -10.0], [110.0, 0.0, 121.0]);
    let (own, _) = load(&cut(houses.and(floor), 18), PLAIN, false);
    assert!(own.scene.mesh.triangles.len() > 140_000);
    assert!(matches!(
        own.chosen.places[..],
        [Place::Street(_), Place::Outside]
    ));
    let wrong = faults(&own, true);
    assert!(wrong.is_empty(), "{wrong:?}");
    let below = hits(
        &own.scene.mesh,
        own.scene.views[0].eye,
        DVec3::new(1e-4, -1.0, 2e-4),
    );
    let below = below.iter().map(|it| it.0).fold(f64::INFINITY, f64::min);
    assert!((below - 1.7).abs() < 1e-3, "{below}");
    let table = prop("table");
    let (own, _) = load(&cut(table, 40), PLAIN, true);
    assert!(own.scene.mesh.triangles.len() > 90_000);
    assert_eq!(own.chosen.places, [Place::Outside]);
    assert!(faults(&own, true).is_empty(), "{:?}", faults(&own, true));
}

#[test]
fn other_views_of_a_room_are_inside_and_those_of_a_table_around_it() {
    let sun = DirectionalLight::new(DVec3::new(-0.3, -1.0, -0.4)).into();
    let own = load(&walls(false).and(table()), PLAIN, false).0;
    let (room, like) = (&own.scene.mesh, &own.scene.views[0]);
    let views = more_views(room, &sun, like, 3);
    assert_eq!(views.len(), 3);
    assert_eq!(views, more_views(room, &sun, like, 3), "the same again");
    for other in &views {
        other.check().unwrap();
        assert!(
            other.eye.x.abs() < 4.0 && other.eye.z.abs() < 3.0,
            "{other:?}"
        );
        assert!(other.eye.y > 0.0 && other.eye.y < 3.0, "{other:?}");
        let same = other.eye == like.eye && other.direction == like.direction;
        assert!(!same && other.fov_y_degrees == like.fov_y_degrees);
    }
    let own = load(&plate().and(table()), PLAIN, false).0;
    let like = &own.scene.views[0];
    let seen = hits(&own.scene.mesh, like.eye, like.direction);
    let seen = seen.iter().map(|it| it.0).fold(f64::INFINITY, f64::min);
    let seen = like.eye + like.direction * seen;
    for other in more_views(&own.scene.mesh, &sun, like, 2) {
        let change = other.eye.distance(seen) - like.eye.distance(seen);
        assert!(change.abs() < 1.0, "{other:?}");
    }
    assert!(more_views(&Mesh::default(), &sun, like, 2).is_empty());
    let nothing = default_views(&Mesh::default(), &ViewRequest::default());
    assert_eq!(nothing, None);
}
