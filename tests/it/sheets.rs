//! Sheets, which are masked triangles and double-sided ones of open parts: maps hold both of their
//! faces. What a method misses of their shadow, and what it darkens of their light.

use crate::{
    plant,
    support::{
        bench::Bench,
        graphs::{self, open, plan, provider, run_on, shares, values},
        meshes::{self, potato},
        random::Random,
        scenes::load,
    },
};
use glam::{DAffine3, DVec3, Vec2, Vec3};
use skiagraph_graph::{Capture, ParamValue, PlanRequest};
use skiagraph_passes::{Room, SceneProvider};
use skiagraph_reference::{Class, Oracle, OracleMode, Progress};
use skiagraph_scene::{
    DirectionalLight, Indexed, LightKind, Mask, Material, MaterialUse, Mesh, Movable, PointLight,
    Scene, SpotLight, View, Wrap, load_gltf,
};
use std::sync::Arc;

const VIEWPORT: [u32; 2] = [256, 256];

type Params<'a> = &'a [(&'a str, ParamValue)];

fn word(text: &str) -> ParamValue {
    ParamValue::Choice(text.into())
}

/// Materials: plain, double-sided, and masked with holes in rows.
const PLAIN: u32 = 0;
const BOTH: u32 = 1;
const MASKED: u32 = 2;

#[derive(Default)]
struct Shape {
    positions: Vec<Vec3>,
    indices: Vec<u32>,
    of: Vec<u32>,
}

impl Shape {
    /// A parallelogram, its front towards u × v, in so many squares.
    fn sheet(&mut self, corner: Vec3, [u, v]: [Vec3; 2], [across, along]: [u32; 2], material: u32) {
        let at = |x: f32, y: f32| corner + u * x + v * y;
        self.patch(at, [across, along], material);
    }

    /// The same of a surface over (0, 0) to (1, 1).
    fn patch(&mut self, at: impl Fn(f32, f32) -> Vec3, [across, along]: [u32; 2], material: u32) {
        for (x, y) in (0..across).flat_map(|x| (0..along).map(move |y| (x, y))) {
            let place = |x: u32, y: u32| at(x as f32 / across as f32, y as f32 / along as f32);
            let first = self.positions.len() as u32;
            let corners = [
                place(x, y),
                place(x + 1, y),
                place(x + 1, y + 1),
                place(x, y + 1),
            ];
            self.positions.extend(corners);
            let triangles = [0, 1, 2, 0, 2, 3].map(|corner| first + corner);
            self.indices.extend(triangles);
            self.of.extend([material; 2]);
        }
    }

    fn solid(&mut self, centre: Vec3, half: Vec3, material: u32) {
        for axis in 0..3 {
            for side in [-1.0, 1.0] {
                let [face, u, v] = [0, 1, 2].map(|turn| Vec3::AXES[(axis + turn) % 3]);
                let corner = centre + half * (side * face - side * u - v);
                let edges = [2.0 * side * half * u, 2.0 * half * v];
                self.sheet(corner, edges, [1, 1], material);
            }
        }
    }

    fn ground(&mut self, half: f32, material: u32) {
        let corner = Vec3::new(-half, 0.0, half);
        self.sheet(
            corner,
            [2.0 * half * Vec3::X, -2.0 * half * Vec3::Z],
            [1, 1],
            material,
        );
    }

    fn mesh(self) -> Mesh {
        let positions: Vec<[f32; 3]> = self
            .positions
            .iter()
            .map(|place| place.to_array())
            .collect();
        let (positions, normals, indices) = (&positions[..], &[][..], &self.indices[..]);
        let mut mesh = Indexed {
            positions,
            normals,
            indices,
        }
        .mesh()
        .unwrap();
        assert_eq!(mesh.triangles.len(), self.of.len());
        let corners = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
        mesh.surfaces.uvs = corners.to_vec();
        let uvs = [[0, 1, 2], [0, 2, 3]].into_iter().cycle();
        mesh.surfaces.uv_indices = uvs.take(self.of.len()).collect();
        mesh.surfaces.of = self.of;
        let holes = Mask::new([8, 8], [Wrap::Repeat; 2], |x, y| x % 4 != 0 || y % 4 == 0);
        let material = |double_sided, mask| Material {
            double_sided,
            mask,
            ..Material::default()
        };
        mesh.surfaces.materials = vec![
            material(false, None),
            material(true, None),
            material(true, Some(Arc::new(holes))),
        ];
        mesh
    }
}

fn scene(name: &str, mesh: Mesh, light: impl Into<LightKind>, [eye, at]: [DVec3; 2]) -> Arc<Scene> {
    Arc::new(Scene {
        name: name.into(),
        mesh,
        views: vec![View {
            eye,
            direction: at - eye,
            fov_y_degrees: 50.0,
            far: 50.0,
            ..View::default()
        }],
        lights: vec![light.into().into()],
    })
}

fn sun() -> DirectionalLight {
    DirectionalLight::new(DVec3::new(-0.4, -1.0, 0.3))
}

const OUTSIDE: [DVec3; 2] = [DVec3::new(2.0, 4.0, 6.0), DVec3::new(0.0, 1.0, 0.0)];

/// Two leaves over a ground, one turned to the light and one away from it.
fn leaves(ground: u32) -> Mesh {
    let mut shape = Shape::default();
    shape.ground(4.0, ground);
    let [u, v] = [Vec3::new(1.5, 0.4, 0.0), Vec3::new(0.2, 0.3, -1.2)];
    shape.sheet(Vec3::new(-1.8, 1.0, 0.5), [u, v], [1, 1], BOTH);
    shape.sheet(Vec3::new(0.4, 1.3, 0.5), [v, u], [1, 1], BOTH);
    shape.mesh()
}

/// A room of one sheet with a window, a table of one sheet and a curtain in it; wound inward or
/// outward.
fn room(inward: bool) -> Mesh {
    let mut shape = Shape::default();
    let [x, y, z] = [Vec3::X * 6.0, Vec3::Y * 3.0, Vec3::Z * 6.0];
    let corner = Vec3::new(-3.0, 0.0, -3.0);
    let mut wall = |corner, [u, v]: [Vec3; 2], squares| {
        let edges = if inward { [u, v] } else { [v, u] };
        shape.sheet(corner, edges, squares, BOTH);
    };
    wall(corner, [z, x], [6, 6]);
    wall(corner + y, [x, z], [6, 6]);
    wall(corner, [y, z], [3, 6]);
    wall(corner, [x, y], [6, 3]);
    wall(corner + z, [y, x], [3, 6]);
    for (row, column) in (0..3).flat_map(|row| (0..6).map(move |column| (row, column))) {
        if row != 1 || !(1..5).contains(&column) {
            let at = corner + x + Vec3::new(0.0, row as f32, column as f32);
            wall(at, [Vec3::Z, Vec3::Y], [1, 1]);
        }
    }
    shape.sheet(
        Vec3::new(-1.0, 0.8, -1.0),
        [Vec3::Z * 1.5, Vec3::X * 1.8],
        [1, 1],
        BOTH,
    );
    let curtain =
        |u: f32, v: f32| Vec3::new(2.6 + 0.1 * (25.0 * u).sin(), 0.4 + 2.2 * v, 0.4 + 1.5 * u);
    shape.patch(curtain, [40, 1], BOTH);
    shape.mesh()
}

/// A potted plant of leaves that are one bent sheet each; its pot and stem are closed. All of it is
/// double-sided, the ground too.
fn potted(seed: u64) -> Mesh {
    let mut shape = Shape::default();
    let mut random = Random(seed);
    shape.ground(3.0, BOTH);
    shape.solid(Vec3::Y * 0.3, Vec3::new(0.35, 0.3, 0.35), BOTH);
    shape.solid(Vec3::Y * 1.4, Vec3::new(0.04, 0.8, 0.04), BOTH);
    for leaf in 0..90 {
        let turn = 2.4 * leaf as f32 + 0.3 * random.signed();
        let (out, aside) = (
            Vec3::new(turn.cos(), 0.0, turn.sin()),
            Vec3::new(-turn.sin(), 0.0, turn.cos()),
        );
        let (length, width) = (0.7 + 0.2 * random.signed(), 0.12 + 0.04 * random.signed());
        let (root, lift) = (
            Vec3::Y * (0.9 + 0.012 * leaf as f32),
            0.5 + 0.5 * random.signed(),
        );
        let blade = |u: f32, v: f32| {
            let across = width * (4.0 * v * (1.0 - v) + 0.1) * (2.0 * u - 1.0);
            root + out * (0.05 + length * v) + aside * across + Vec3::Y * (lift * v - v * v)
        };
        shape.patch(blade, [2, 6], BOTH);
    }
    shape.mesh()
}

/// Cards of grass, crossed, upright or nearly so, with masks.
fn grass(seed: u64) -> Mesh {
    let mut shape = Shape::default();
    let mut random = Random(seed);
    shape.ground(3.0, BOTH);
    for _ in 0..40 {
        let place = 2.4 * Vec3::new(random.signed(), 0.0, random.signed());
        let turn = 3.2 * random.unit();
        for turn in [turn, turn + 1.6] {
            let along = 0.4 * Vec3::new(turn.cos(), 0.0, turn.sin());
            let up = Vec3::new(0.1 * random.signed(), 0.7, 0.1 * random.signed());
            shape.sheet(place - along, [2.0 * along, up], [1, 1], MASKED);
        }
    }
    shape.mesh()
}

/// Trees of masked squares on closed trunks.
fn trees(seed: u64) -> Mesh {
    let mut shape = Shape::default();
    let mut random = Random(seed);
    shape.ground(4.0, BOTH);
    for tree in 0..3 {
        let root = Vec3::new(2.2 * (tree as f32 - 1.0), 0.0, 1.5 * random.signed());
        shape.solid(root + Vec3::Y * 0.7, Vec3::new(0.08, 0.7, 0.08), BOTH);
        for _ in 0..24 {
            let centre = root + Vec3::Y * 1.8 + 0.7 * random.vector();
            let u = 0.8 * random.vector().normalize();
            let v = 0.8 * u.normalize().cross(random.vector()).normalize();
            shape.sheet(centre - 0.5 * (u + v), [u, v], [1, 1], MASKED);
        }
    }
    shape.mesh()
}

/// Pixels that face the light, and those that a method has wrong.
struct Shown {
    lit: usize,
    shadow: usize,
    darkened: usize,
    missed: usize,
}

impl Shown {
    fn missing(&self) -> f64 {
        self.missed as f64 / self.shadow as f64
    }

    fn false_shadow(&self) -> f64 {
        self.darkened as f64 / self.lit as f64
    }
}

fn see(scene: &Arc<Scene>, preset: &str, params: Params) -> Shown {
    let gpu = open();
    let mut provider = provider(scene, &scene.views[0], VIEWPORT);
    let path = format!("pipelines/{preset}.ron");
    let plan = plan(&path, &provider, VIEWPORT, |request| {
        request.features = gpu.device.features() & wgpu::Features::FLOAT32_FILTERABLE;
        request.captures.push(Capture::new("primitive"));
        set(request, params);
    });
    let report = run_on(&gpu, plan, &mut provider, &["visibility", "primitive"]);
    let (shown, primitives) = (shares(&report, "visibility"), values(&report, "primitive"));
    let (oracle, camera) = (Oracle::new(&scene.mesh), scene.views[0].camera(VIEWPORT));
    let (light, exact) = (scene.light(), OracleMode::Exact);
    let truth = oracle
        .shade(&camera, light, &primitives, exact, Progress::default())
        .unwrap();
    let count = |class: Class, is_counted: &dyn Fn(f32) -> bool| {
        let pixels = truth.classes.iter().zip(&shown);
        pixels
            .filter(|(actual, shown)| **actual == class && is_counted(**shown))
            .count()
    };
    let seen = Shown {
        lit: count(Class::Lit, &|_| true),
        shadow: count(Class::Shadow, &|_| true),
        darkened: count(Class::Lit, &|shown| shown < 0.5),
        missed: count(Class::Shadow, &|shown| shown >= 0.5),
    };
    println!(
        "{:<14} {preset:<16} {params:?}: missing {:.2} % of {}, false {:.2} % of {}",
        scene.name,
        100.0 * seen.missing(),
        seen.shadow,
        100.0 * seen.false_shadow(),
        seen.lit,
    );
    assert!(seen.lit > 1000 && seen.shadow > 1000, "{}", scene.name);
    seen
}

fn set(request: &mut PlanRequest<'_>, params: Params) {
    let params = params
        .iter()
        .map(|(name, value)| ((*name).to_owned(), value.clone()));
    request.params.extend(params);
}

fn room_scene(name: &str, inward: bool) -> Arc<Scene> {
    let light = DirectionalLight::new(DVec3::new(-1.0, -0.6, 0.15));
    let inside = [DVec3::new(-2.6, 2.4, -2.4), DVec3::new(1.0, 0.4, 0.8)];
    scene(name, room(inward), light, inside)
}

/// The generated plant of `scenes/foliage.ron`.
fn plant_of_gltf() -> Mesh {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("foliage.glb");
    std::fs::write(&file, plant::plant()).unwrap();
    load_gltf(&file, MaterialUse::All).unwrap().0
}

fn scenes() -> Vec<Arc<Scene>> {
    let low = DirectionalLight::new(DVec3::new(1.0, -0.7, -0.4));
    vec![
        scene("leaves", leaves(PLAIN), sun(), OUTSIDE),
        scene("leaves, ground", leaves(BOTH), sun(), OUTSIDE),
        room_scene("room inward", true),
        room_scene("room outward", false),
        scene("potted", potted(1), sun(), OUTSIDE),
        scene("potted, low", potted(2), low, OUTSIDE),
        scene("grass", grass(1), sun(), OUTSIDE),
        scene("trees", trees(1), sun(), OUTSIDE),
        scene("plant of glTF", plant_of_gltf(), sun(), OUTSIDE),
    ]
}

/// Shadows of sheets are there, and lit sheets do not shade themselves.
fn assert_cast(scene: &Arc<Scene>, preset: &str, params: Params) {
    let seen = see(scene, preset, params);
    assert!(seen.missing() < 0.05, "{} {preset} {params:?}", scene.name);
    assert!(
        seen.false_shadow() < 0.01,
        "{} {preset} {params:?}",
        scene.name
    );
}

#[test]
fn sheets_cast_by_both_faces() {
    for scene in scenes() {
        for preset in ["nsm", "pcf", "pssm"] {
            assert_cast(&scene, preset, &[]);
        }
    }
}

/// A filter, or a coarse fit, loses what is thinner than a texel with any casters: these are wide.
#[test]
fn sheets_cast_in_maps_of_every_family() {
    let scenes = [
        scene("leaves, ground", leaves(BOTH), sun(), OUTSIDE),
        scene("potted", potted(1), sun(), OUTSIDE),
    ];
    for scene in &scenes {
        for preset in [
            "tsm",
            "sdsm",
            "pcss",
            "hybrid_pcf",
            "hybrid_pcf_area",
            "vsm",
            "esm",
            "evsm",
            "msm",
        ] {
            assert_cast(scene, preset, &[]);
        }
        for fit in ["camera", "receivers", "tsm", "pssm"] {
            assert_cast(scene, "nsm", &[("fit", word(fit))]);
        }
        for cull in ["none", "back"] {
            assert_cast(scene, "nsm", &[("cull", word(cull))]);
        }
        for radius in [0, 4] {
            assert_cast(scene, "pcf", &[("radius", ParamValue::U32(radius))]);
        }
    }
    // The other way round nothing casts, as the dissertation has it.
    for preset in [
        "nsm",
        "pcf",
        "hybrid_pcf",
        "crsm",
        "nsm_d",
        "hybrid_pcf_d",
        "crsm_d",
        "crsma_d",
    ] {
        let culled = ("two_sided", ParamValue::Bool(false));
        let params = if preset.ends_with("_d") {
            vec![]
        } else {
            vec![culled]
        };
        let seen = see(&scenes[1], preset, &params);
        assert!(seen.missing() > 0.5, "{preset}");
    }
}

#[test]
fn sheets_cast_under_lamps() {
    let position = DVec3::new(0.8, 5.0, -0.6);
    let spot = LightKind::Spot(SpotLight {
        position,
        direction: -position,
        cone_degrees: 80.0,
        radius: 0.0,
    });
    let point = LightKind::Point(PointLight {
        position,
        radius: 0.0,
    });
    for (light, presets) in [
        (spot, &["nsm", "pcf", "pcss", "hybrid_pcf", "crsm"][..]),
        (point, &["nsm", "pcf", "pcss"]),
    ] {
        for (name, mesh) in [("leaves, ground", leaves(BOTH)), ("potted", potted(1))] {
            let scene = scene(name, mesh, light, OUTSIDE);
            presets
                .iter()
                .for_each(|preset| assert_cast(&scene, preset, &[]));
        }
    }
}

/// A lit sheet asks a ray, so that conservative maps are right about sheets, as about solids.
#[test]
fn what_conservative_maps_are_certain_of_sheets_is_right() {
    let scenes = scenes();
    for scene in &scenes {
        let mut bench = Bench::new(scene, VIEWPORT);
        for preset in ["crsm", "crsm_depth", "crsma_full"] {
            let wrong = bench.judge(preset, &[]).wrong;
            assert_eq!(wrong.total, wrong.in_band, "{} {preset}", scene.name);
        }
        // One triangle alone may be the wrong one to ask.
        assert_eq!(bench.judge("crsm_single", &[]).wrong.certain, 0);
    }
    // A flag on every other triangle: sheets are next to what is culled.
    let mut half = potted(3);
    let flags = half.surfaces.of.iter_mut().skip(14).step_by(2);
    flags.for_each(|material| *material = PLAIN);
    let half = scene("half", half, sun(), OUTSIDE);
    let mut bench = Bench::new(&half, VIEWPORT);
    for preset in ["crsm", "crsm_depth", "crsma_full"] {
        let answers = bench.answers(preset, &[]);
        let darkened = answers.counts.split.lit.certain_wrong_outside_band;
        assert_eq!(darkened, 0, "{preset}");
    }
}

/// Returns each output of a preset on a scene's first view.
fn outputs(scene: &Arc<Scene>, preset: &str, names: &[&str]) -> Vec<Vec<f32>> {
    let mut provider = provider(scene, &scene.views[0], VIEWPORT);
    let path = format!("pipelines/{preset}.ron");
    let plan = plan(&path, &provider, VIEWPORT, |request| {
        request.captures.push(Capture::new("primitive"));
    });
    assert!(!plan.provided().contains(&"scene.sheets"), "{preset}");
    let report = run_on(&open(), plan, &mut provider, names);
    names.iter().map(|name| shares(&report, name)).collect()
}

/// Closed parts are drawn as they were, whatever their flag, and nothing is bound for sheets.
#[test]
fn a_flag_changes_nothing_of_closed_parts() {
    let park = load("park");
    let mut flagged = Scene::clone(&park);
    let surfaces = &mut flagged.mesh.surfaces;
    assert!(surfaces.of.is_empty());
    surfaces.materials = vec![Material {
        double_sided: true,
        ..Material::default()
    }];
    surfaces.of = vec![0; flagged.mesh.triangles.len()];
    let flagged = Arc::new(flagged);
    for preset in ["nsm", "pcf", "pssm", "hybrid_pcf", "crsm", "crsma_full"] {
        let mut names = vec!["visibility", "primitive"];
        let traces = !["nsm", "pcf", "pssm"].contains(&preset);
        names.extend(traces.then_some("ray_count"));
        let [plain, both] = [&park, &flagged].map(|scene| outputs(scene, preset, &names));
        // Backs that the eye sees between two fronts are seen now.
        let differing = |output: usize| {
            let pixels = plain[output].iter().zip(&both[output]);
            pixels
                .enumerate()
                .filter(|(_, (a, b))| a != b)
                .map(|(pixel, _)| pixel)
        };
        let seen: Vec<usize> = differing(1).collect();
        assert!(seen.len() < 10, "{preset}: {seen:?}");
        assert!(differing(0).all(|pixel| seen.contains(&pixel)), "{preset}");
        if traces {
            let rays = plain[2][0] - both[2][0];
            assert!(rays.abs() <= seen.len() as f32, "{preset}: {rays} rays");
        }
    }
}

/// Sheets come and go with the parts that have them, mirrored ones too.
#[test]
fn sheets_move_with_their_parts() {
    let gpu = open();
    let [ground, stone] = [
        meshes::box_over_floor(12.0, Vec3::splat(0.4)),
        potato(2, 0.2, 1),
    ];
    let (leaves, potted) = (leaves(PLAIN), potted(1));
    let place = |x: f64| DAffine3::from_translation(DVec3::new(x, 2.0, 8.0));
    let mirrored = place(8.0) * DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
    let camera = View {
        name: String::new(),
        eye: DVec3::new(2.0, 8.0, 18.0),
        direction: DVec3::new(0.2, -0.6, -1.0),
        fov_y_degrees: 50.0,
        far: 60.0,
        ..View::default()
    }
    .camera(VIEWPORT);
    let provider_of = |parts: &[(&Mesh, DAffine3)]| {
        let meshes: Vec<&Mesh> = parts.iter().map(|part| part.0).collect();
        let maps: Vec<DAffine3> = parts.iter().map(|part| part.1).collect();
        let mut provider = SceneProvider::from_parts(Movable::joined(&meshes), sun());
        provider.set_camera(&camera);
        provider.set_transforms(&maps).unwrap();
        provider
    };
    let shown = |provider: &mut SceneProvider, preset: &str| {
        let plan = graphs::plan(
            &format!("pipelines/{preset}.ron"),
            provider,
            VIEWPORT,
            |_| {},
        );
        values(&run_on(&gpu, plan, provider, &["visibility"]), "visibility")
    };
    let same = |scene: &mut SceneProvider, parts: &[(&Mesh, DAffine3)]| {
        let mut whole = provider_of(parts);
        for preset in ["nsm", "crsm", "crsma_full"] {
            let (seen, expected) = (shown(scene, preset), shown(&mut whole, preset));
            assert!(seen == expected, "{preset}, {} parts", parts.len());
        }
    };
    let mut scene = provider_of(&[(&ground, place(6.0))]);
    let room = Room::of_copies(&leaves, 1);
    scene.reserve(room, &gpu.device.limits()).unwrap();
    // It fits into that room; then triangles that were sheets are none, and the mesh grows.
    let there = scene.add_part(&leaves, &place(4.0)).unwrap();
    same(&mut scene, &[(&ground, place(6.0)), (&leaves, place(4.0))]);
    scene.set_transform(there, &mirrored).unwrap();
    same(&mut scene, &[(&ground, place(6.0)), (&leaves, mirrored)]);
    scene.remove_part(there).unwrap();
    scene.add_part(&stone, &place(4.0)).unwrap();
    same(&mut scene, &[(&ground, place(6.0)), (&stone, place(4.0))]);
    scene.add_part(&potted, &mirrored).unwrap();
    let parts = [
        (&ground, place(6.0)),
        (&stone, place(4.0)),
        (&potted, mirrored),
    ];
    same(&mut scene, &parts);
    // Without their faces the picture is another.
    let plain = Mesh {
        surfaces: Default::default(),
        ..potted.clone()
    };
    let parts = [
        (&ground, place(6.0)),
        (&stone, place(4.0)),
        (&plain, mirrored),
    ];
    assert!(shown(&mut scene, "nsm") != shown(&mut provider_of(&parts), "nsm"));
}
