//! Maps of spot and point lights: a cone, and six faces.

use crate::support::{
    bench::Bench,
    meshes::{joined, mesh, potato},
};
use glam::{DVec3, Vec3};
use skiagraph_graph::ParamValue;
use skiagraph_reference::Statistics;
use skiagraph_scene::{DirectionalLight, LightKind, PointLight, Scene, SpotLight, View};
use std::sync::Arc;

const VIEWPORT: [u32; 2] = [128, 96];

/// Potatoes over a floor of two triangles, which reaches behind every light and every face.
fn scene(light: LightKind) -> Arc<Scene> {
    let corners = [(-12.0, 12.0), (12.0, 12.0), (12.0, -12.0), (-12.0, -12.0)];
    let corners = corners.map(|(x, z)| Vec3::new(x, -1.5, z)).to_vec();
    let floor = mesh(corners, vec![[0, 1, 2], [0, 2, 3]]);
    let mut aside = potato(4, 0.3, 2);
    aside
        .positions
        .iter_mut()
        .for_each(|p| *p += Vec3::new(3.0, 0.2, 1.0));
    let eye = DVec3::new(4.0, 7.0, 9.0);
    let view = View {
        eye,
        direction: -eye,
        near: 0.5,
        far: 60.0,
        ..View::default()
    };
    Arc::new(Scene {
        name: "lamp".into(),
        mesh: joined(joined(potato(4, 0.3, 1), &aside), &floor),
        views: vec![view],
        lights: vec![skiagraph_scene::Light {
            name: "lamp".into(),
            kind: light,
        }],
    })
}

fn spot(position: DVec3, cone_degrees: f64) -> LightKind {
    LightKind::Spot(SpotLight {
        position,
        direction: -position,
        cone_degrees,
        radius: 0.0,
    })
}

fn point(position: DVec3) -> LightKind {
    LightKind::Point(PointLight {
        position,
        radius: 0.0,
    })
}

fn wrong(counts: &Statistics) -> u64 {
    counts.wrong.total - counts.wrong.in_band
}

fn size(texels: u32) -> (&'static str, ParamValue) {
    ("map_size", ParamValue::U32(texels))
}

/// Lamps above, beside, between the potatoes, and so near the floor that it reaches into all
/// faces; cones so wide that most of the floor lies behind the lamp.
fn lamps() -> Vec<LightKind> {
    let places = [
        DVec3::new(0.5, 5.0, 1.0),
        DVec3::new(-3.0, 0.5, 2.0),
        DVec3::new(1.6, 0.1, 0.4),
        DVec3::new(2.0, -1.3, 3.0),
    ];
    let points = places.map(point);
    let spots =
        [(0, 40.0), (1, 100.0), (2, 160.0), (3, 90.0)].map(|(at, cone)| spot(places[at], cone));
    points.into_iter().chain(spots).collect()
}

/// On the seams of faces, too, and whatever reaches behind the lamp: to the bit.
#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn lists_are_exact_under_lamps() {
    let mut certain = 0;
    let (mut lit, mut shadow) = (0, 0);
    for lamp in lamps() {
        let scene = scene(lamp);
        let mut bench = Bench::new(&scene, VIEWPORT);
        let rays = bench.answers("rt", &[]).visibility;
        for map_size in [16, 100, 224] {
            let lists = bench.answers("light_buffer", &[size(map_size)]);
            assert!(lists.visibility == rays, "{lamp:?} {map_size}");
            let counts = lists.counts;
            assert_eq!(wrong(&counts), 0, "{lamp:?} {map_size}: {counts:?}");
            assert!(counts.indeterminate_share() < 0.02, "{lamp:?}: {counts:?}");
            certain += counts.pixels.facing_light - counts.uncertain;
            (lit, shadow) = (lit + counts.pixels.lit, shadow + counts.pixels.shadow);
        }
    }
    assert!(lit > 10_000 && shadow > 5_000, "{lit} {shadow}");
    // Lists answer, not rays.
    assert!(
        certain * 100 > (lit + shadow) * 95,
        "{certain} of {}",
        lit + shadow
    );
}

/// A shadow map of a lamp is as good as its texels, on every face.
#[test]
fn finer_maps_of_lamps_have_fewer_wrong_pixels() {
    for lamp in [lamps()[0], lamps()[1], lamps()[4], lamps()[5]] {
        let scene = scene(lamp);
        let mut bench = Bench::new(&scene, VIEWPORT);
        let counts = [64, 1024].map(|texels| bench.judge("nsm", &[size(texels)]));
        let [coarse, fine] = counts.each_ref().map(wrong);
        println!("{lamp:?}: {coarse} at 64, {fine} at 1024");
        assert!(3 * fine < coarse, "{lamp:?}: {coarse} {fine}");
        assert!(fine * 100 < counts[1].pixels.facing_light, "{fine}");
    }
}

#[test]
fn rays_mend_the_contours_of_a_spot_lights_map() {
    let scene = scene(lamps()[4]);
    let mut bench = Bench::new(&scene, VIEWPORT);
    let nsm = wrong(&bench.judge("nsm", &[size(256)]));
    let hybrid = wrong(&bench.judge("hybrid_pcf", &[size(256)]));
    assert!(2 * hybrid < nsm, "{nsm} {hybrid}");
}

/// Lamps between, beside and inside of solids, and so near that their triangles reach behind them:
/// what the two layers of a spot light's map agree on is so.
#[test]
fn conservative_maps_are_exact_under_spot_lights() {
    let inside = spot(DVec3::new(0.3, 0.2, 0.1), 120.0);
    let narrow = spot(DVec3::new(0.5, 5.0, 1.0), 12.0);
    let spots = lamps().into_iter().skip(4).chain([inside, narrow]);
    let (mut lit, mut shadow, mut uncertain) = (0, 0, 0);
    for lamp in spots {
        let scene = scene(lamp);
        let mut bench = Bench::new(&scene, VIEWPORT);
        for (map_size, cull) in [(16, "front"), (100, "none"), (400, "none"), (1024, "front")] {
            let cull = ("cull", ParamValue::Choice(cull.into()));
            let counts = bench.judge("crsm", &[size(map_size), cull]);
            assert_eq!(wrong(&counts), 0, "{lamp:?} {map_size}: {counts:?}");
            if map_size == 1024 {
                (lit, shadow) = (lit + counts.certain.lit, shadow + counts.certain.shadow);
                uncertain += counts.uncertain;
            }
        }
    }
    // Maps answer, not rays.
    println!("certain {lit} {shadow}, uncertain {uncertain}");
    assert!(lit > 5_000 && shadow > 2_000, "{lit} {shadow}");
    assert!(uncertain * 4 < lit + shadow, "{uncertain}");
}

/// A lamp hangs from a ceiling, in the plane of whose triangles it lies.
#[test]
fn what_a_spot_light_hangs_from_casts_nothing() {
    let case = skiagraph_cases::case("spot_on_a_surface").unwrap();
    let scene = Arc::new(case.scene());
    let mut bench = Bench::new(&scene, VIEWPORT);
    let counts = bench.judge("nsm", &[size(1024)]);
    let lit = counts.pixels.lit;
    assert!(lit > 3000 && wrong(&counts) * 50 < lit, "{counts:?}");
}

/// Far away a spot light is a directional one.
#[test]
fn a_spot_light_far_away_is_parallel_light() {
    let to_light = DVec3::new(-0.4, 1.0, -0.3).normalize();
    let far_away = spot(to_light * 4e4, 0.06);
    let parallel = LightKind::Directional(DirectionalLight::new(-to_light));
    let [spot, parallel] = [far_away, parallel].map(|light| {
        let scene = scene(light);
        let mut bench = Bench::new(&scene, VIEWPORT);
        bench.answers("nsm", &[size(1024)]).visibility
    });
    let differ = spot.iter().zip(&parallel).filter(|(a, b)| a != b).count();
    assert!(differ < 100, "{differ}");
    let dark = parallel.iter().filter(|lit| **lit == 0).count();
    assert!(dark > 300, "{dark}");
}
