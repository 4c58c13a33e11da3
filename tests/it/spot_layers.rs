//! The two layers of `crsm` under spot lights, texel by texel, against points of the casters in
//! f64.

use crate::support::{
    graphs::{plan, provider, run},
    meshes,
    random::Random,
};
use glam::{DVec2, DVec3, Vec3};
use skiagraph_gpu::Content;
use skiagraph_graph::{Capture, ParamValue};
use skiagraph_passes::uniforms::LightUniform;
use skiagraph_scene::{LightKind, Mesh, Scene, SpotLight, View};
use std::sync::Arc;

const MAP: u32 = 64;

/// A light before the meshes, amid them, and one that barely opens.
fn spots() -> [LightKind; 4] {
    let spot = |position: [f64; 3], towards: [f64; 3], cone_degrees| {
        LightKind::Spot(SpotLight {
            position: position.into(),
            direction: DVec3::from(towards),
            cone_degrees,
            radius: 0.0,
        })
    };
    [
        spot([0.3, 2.5, 0.2], [-0.1, -1.0, 0.1], 60.0),
        spot([0.1, 0.2, -0.1], [1.0, 0.3, 0.2], 110.0),
        spot([-0.6, 0.1, 0.5], [0.5, 0.4, -1.0], 160.0),
        spot([9.0, 6.0, -7.0], [-9.0, -6.0, 7.0], 11.0),
    ]
}

/// Large triangles that cross each other and the light's plane, small ones, needles, a solid.
fn casters() -> Vec<Mesh> {
    let mut random = Random(7);
    let mut needles = meshes::soup(60, 0.6, 5);
    for corners in needles.positions.chunks_exact_mut(3) {
        let (from, along) = (corners[0], random.vector());
        corners[1] = from + along;
        corners[2] = from + 0.5 * along + random.vector() * 2e-3;
    }
    vec![
        meshes::soup(60, 0.9, 1),
        meshes::soup(400, 0.05, 2),
        meshes::soup(40, 6.0, 3),
        needles,
        meshes::potato(3, 0.2, 9),
    ]
}

fn scene(mesh: Mesh, light: LightKind) -> Arc<Scene> {
    Arc::new(Scene {
        name: "spot".into(),
        mesh,
        views: vec![View {
            eye: DVec3::new(0.3, 9.0, 6.0),
            direction: DVec3::new(0.0, -1.0, -0.7),
            far: 100.0,
            ..View::default()
        }],
        lights: vec![light.into()],
    })
}

/// `outer` and `inner`.
fn layers(scene: &Arc<Scene>) -> [Vec<f32>; 2] {
    let names = ["outer", "inner"];
    let mut provider = provider(scene, &scene.views[0], [16, 16]);
    let plan = plan("pipelines/crsm.ron", &provider, [16, 16], |request| {
        let set = [
            ("map_size", ParamValue::U32(MAP)),
            ("cull", ParamValue::Choice("none".into())),
        ];
        let set = set.map(|(name, value)| (name.to_owned(), value));
        request.params.extend(set);
        request.captures.extend(names.map(Capture::new));
    });
    let report = run(plan, &mut provider, &names);
    names.map(|layer| {
        let readback = report.readbacks.iter().find(|read| read.name == layer);
        match &readback.unwrap().content {
            Content::Texture { bytes, .. } => bytemuck::pod_collect_to_vec(bytes),
            Content::Buffer(_) => panic!("a layer is a texture"),
        }
    })
}

/// As the light sees it, in f64: x and y in texels, times w; w.
struct Eye {
    rows: [DVec3; 3],
    position: DVec3,
    range: f64,
}

impl Eye {
    fn new(scene: &Scene) -> Self {
        let light = LightUniform::new(scene.light(), &scene.mesh);
        let rows = light.clip_from_relative.transpose();
        let row = |row: glam::Vec4| row.truncate().as_dvec3();
        let [x, y, w] = [row(rows.x_axis), row(rows.y_axis), row(rows.w_axis)];
        let half = f64::from(MAP) / 2.0;
        Self {
            rows: [half * (x + w), half * (w - y), w],
            position: light.position.as_dvec3() + light.position_low.as_dvec3(),
            range: light.range.into(),
        }
    }

    fn seen(&self, point: DVec3) -> DVec3 {
        DVec3::from(self.rows.map(|row| row.dot(point - self.position)))
    }
}

fn seen(scene: &Scene, eye: &Eye) -> Vec<[DVec3; 3]> {
    let primitives = 0..scene.mesh.triangles.len() as u32;
    let corners = primitives.map(|primitive| scene.mesh.corners(primitive));
    corners
        .map(|corners| corners.map(|at| eye.seen(at)))
        .collect()
}

#[test]
fn nothing_of_a_caster_is_nearer_than_the_outer_depth() {
    let (mut points, mut before) = (0, 0);
    for light in spots() {
        for mesh in casters() {
            let scene = scene(mesh, light);
            let [outer, _] = layers(&scene);
            let eye = Eye::new(&scene);
            let mut random = Random(3);
            for [a, b, c] in seen(&scene, &eye) {
                for turn in 0..300 {
                    let (mut u, mut v) = (f64::from(random.unit()), f64::from(random.unit()));
                    // Inside, on an edge, at a corner.
                    match turn % 4 {
                        0 => v = 0.0,
                        1 => (u, v) = (u.round(), 0.0),
                        _ if u + v > 1.0 => (u, v) = (1.0 - u, 1.0 - v),
                        _ => {}
                    }
                    let point = a + (b - a) * u + (c - a) * v;
                    let at = point.truncate() / point.z;
                    let is_in = at.cmpge(DVec2::ZERO).all() && at.max_element() < MAP.into();
                    if point.z <= 0.0 || !is_in {
                        continue;
                    }
                    let stored = outer[at.y as usize * MAP as usize + at.x as usize];
                    let depth = point.z / eye.range;
                    assert!(
                        f64::from(stored) <= depth,
                        "{light:?}: {depth} before {stored}"
                    );
                    points += 1;
                }
            }
            before += outer.iter().filter(|stored| **stored == 1.0).count();
        }
    }
    // And the layers are not simply full.
    assert!(points > 100_000 && before > 10_000, "{points} {before}");
}

#[test]
fn behind_the_inner_depth_is_no_hole() {
    let mut covered = 0;
    for light in spots() {
        for mesh in casters() {
            let scene = scene(mesh, light);
            let [_, inner] = layers(&scene);
            let eye = Eye::new(&scene);
            let casters = seen(&scene, &eye);
            let mut random = Random(4);
            for (index, &stored) in inner.iter().enumerate() {
                if stored == 1.0 {
                    continue;
                }
                covered += 1;
                let corner = Vec3::new((index % 64) as f32, (index / 64) as f32, 1.0).as_dvec3();
                for turn in 0..16 {
                    let mut within = DVec3::new(random.unit().into(), random.unit().into(), 0.0);
                    if turn < 8 {
                        within = within.round(); // the texel's own corners
                    }
                    let way = corner + within;
                    // Where the way from the light meets a caster: at so many times `way`.
                    let blocked = casters.iter().any(|[a, b, c]| {
                        let sides = [b.cross(*c), c.cross(*a), a.cross(*b)];
                        let sides = DVec3::from(sides.map(|side| side.dot(way)));
                        let met = a.dot(b.cross(*c)) / sides.element_sum();
                        let inside =
                            sides.cmpge(DVec3::ZERO).all() || sides.cmple(DVec3::ZERO).all();
                        inside && met > 0.0 && met / eye.range <= f64::from(stored)
                    });
                    assert!(blocked, "{light:?}: a hole at {way} before {stored}");
                }
            }
        }
    }
    assert!(covered > 10_000, "{covered} texels");
}
