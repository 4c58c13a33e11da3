//! The light buffer: its lists against a CPU reference, its answers against `rt`'s, whatever has
//! room and whatever has not. To the bit, which is stricter than what is promised: a driver may
//! evaluate one test in two ways in two pipelines (compiled_apart.rs), but none did that this was
//! run on.

use crate::support::{
    graphs::{frame, open, plan, provider, run_on, values},
    map_fit::MapFit,
    meshes::{joined, mesh, potato, soup},
    random::Random,
};
use glam::{DVec2, DVec3, Vec3};
use skiagraph_gpu::{Executor, FrameReport, device::Gpu};
use skiagraph_graph::{Capture, ParamValue};
use skiagraph_passes::SceneProvider;
use skiagraph_reference::statistics::{UNANSWERED, status};
use skiagraph_scene::{DirectionalLight, Mesh, Scene, View};
use skiagraph_tests::cpu_reference::{SLACK, TexelTriangle, exact};
use std::{collections::BTreeSet, sync::Arc};

const VIEWPORT: [u32; 2] = [96, 64];

fn scene(mesh: Mesh, eye: DVec3, light: DVec3) -> Arc<Scene> {
    let view = View {
        eye,
        direction: -eye,
        fov_y_degrees: 50.0,
        near: 0.05,
        far: 50.0,
        ..View::default()
    };
    Arc::new(Scene {
        name: "test".into(),
        mesh,
        views: vec![view],
        lights: vec![DirectionalLight::new(light).into()],
    })
}

/// A horizontal square that faces up.
fn floor(half: f32, y: f32) -> Mesh {
    let corners = [(-half, half), (half, half), (half, -half), (-half, -half)];
    let corners = corners.map(|(x, z)| Vec3::new(x, y, z));
    mesh(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]])
}

/// 100,000 specks over the middle of a floor of 60 by 60, no farther out than `spread`.
fn crowd(spread: f32) -> Mesh {
    let casters = 100_000;
    let mut random = Random(7);
    let corners = (0..casters).flat_map(|_| {
        let centre = random.vector() * Vec3::new(spread, 0.2, spread) + Vec3::Y * 0.5;
        [(); 3].map(|()| centre + random.vector() * 0.01)
    });
    let positions: Vec<Vec3> = corners.collect();
    let triangles = (0..casters).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    joined(floor(30.0, 0.0), &mesh(positions, triangles.collect()))
}

/// A method on a scene.
struct Bench {
    gpu: Gpu,
    provider: SceneProvider,
    viewport: [u32; 2],
    /// The param `unlisted`.
    unlisted: &'static str,
}

const FITS: [&str; 3] = ["scene", "camera", "receivers"];

const CAPTURED: [&str; 5] = ["position", "primitive", "map_fit", "texels", "entries"];

impl Bench {
    fn new(scene: &Arc<Scene>) -> Self {
        Self::from_scene(scene, VIEWPORT)
    }

    fn from_scene(scene: &Arc<Scene>, viewport: [u32; 2]) -> Self {
        Self {
            gpu: open(),
            provider: provider(scene, &scene.views[0], viewport),
            viewport,
            unlisted: "receivers",
        }
    }

    fn executor(&mut self, fit: &str, params: &[(&str, u32)], captured: &[&str]) -> Executor {
        let path = "pipelines/light_buffer.ron";
        let plan = plan(path, &self.provider, self.viewport, |request| {
            let words = [("fit", fit), ("unlisted", self.unlisted)];
            for (name, word) in words {
                let word = ParamValue::Choice(word.to_owned());
                request.params.insert(name.to_owned(), word);
            }
            for (name, value) in params {
                let value = ParamValue::U32(*value);
                request.params.insert((*name).to_owned(), value);
            }
            request
                .captures
                .extend(captured.iter().map(|name| Capture::new(*name)));
            if self.unlisted == "receivers" {
                request.captures.push(Capture::new("pending_state"));
            }
        });
        Executor::on(&self.gpu, plan, &mut self.provider).unwrap_or_else(|error| panic!("{error}"))
    }

    /// Visibility of every pixel by rays alone.
    fn by_rays(&mut self) -> Vec<u32> {
        let plan = plan("pipelines/rt.ron", &self.provider, self.viewport, |_| {});
        let report = run_on(&self.gpu, plan, &mut self.provider, &["visibility"]);
        values(&report, "visibility")
    }

    /// One frame of the light buffer.
    fn by_lists(&mut self, fit: &str, params: &[(&str, u32)]) -> Answer {
        let mut executor = self.executor(fit, params, &[]);
        self.answer(&mut executor)
    }

    fn answer(&self, executor: &mut Executor) -> Answer {
        let read = ["visibility", "status", "entry_count", "pending_state"];
        let report = frame(&self.gpu, executor, &read);
        let statuses = values(&report, "status");
        let count = |wanted: u32| statuses.iter().filter(|status| **status == wanted).count();
        let [lit, shadow, unanswered] = [
            status::CERTAIN_LIGHT,
            status::CERTAIN_SHADOW,
            status::UNCERTAIN,
        ]
        .map(count);
        let visibility = values(&report, "visibility");
        let is_unanswered = |shown: &&u32| **shown == UNANSWERED;
        assert_eq!(visibility.iter().filter(is_unanswered).count(), unanswered);
        // As shaders/shared/pending.wgsl has it.
        let state = values(&report, "pending_state");
        let [placed, unplaced] = [state[1], state[2]];
        assert_eq!(*state.last().unwrap(), unanswered as u32);
        Answer {
            visibility,
            lit,
            shadow,
            unlisted: (placed + unplaced) as usize,
            unanswered,
            entries: values(&report, "entry_count")[0],
        }
    }
}

struct Answer {
    visibility: Vec<u32>,
    lit: usize,
    shadow: usize,
    /// Receivers that no list answered.
    unlisted: usize,
    /// Receivers that nothing answered.
    unanswered: usize,
    /// That were needed.
    entries: u32,
}

/// A soup over a potato over a floor: triangles of all sizes, open and closed, through each other.
pub(crate) fn mixed(seed: u64) -> Arc<Scene> {
    let mut random = Random(seed);
    let size = [0.05, 0.3, 1.0][seed as usize % 3];
    let solids = joined(floor(2.5, -1.2), &potato(3, 0.4, seed));
    let light = (random.vector() - Vec3::Y * 1.3).as_dvec3();
    let eye = random.vector().as_dvec3() + DVec3::new(1.5, 2.5, 3.0);
    scene(joined(solids, &soup(300, size, seed)), eye, light)
}

/// Checks for the receivers in reach of the light which casters a list must hold, and which it may.
#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn lists_hold_each_caster_that_shades_a_receiver_and_no_stranger() {
    for fit in FITS {
        let [mut shading, mut covered, mut border] = [0; 3];
        for (seed, map_size) in [(3, 8), (1, 8), (2, 31), (3, 64), (4, 150), (5, 16)] {
            let scene = mixed(seed);
            let mut bench = Bench::new(&scene);
            let mut executor = bench.executor(fit, &[("map_size", map_size)], &CAPTURED);
            let report = frame(&bench.gpu, &mut executor, &CAPTURED);
            let fit = MapFit::new(&report, &scene);
            assert_eq!(fit.size, map_size);
            let [pairs, texels, receivers] = check_lists(&scene, &fit, &report);
            (shading, covered) = (shading + pairs, covered + texels);
            border += receivers;
        }
        assert!(shading > 10_000, "{fit}: {shading}");
        assert!(covered > 10, "{fit}: {covered}");
        assert!(border > 50, "{fit}: {border}");
    }
}

/// Checks all lists, keys and covers; returns how many pairs of a receiver and a caster there were,
/// how many covered texels, and how many receivers on a border of texels.
fn check_lists(scene: &Scene, fit: &MapFit, report: &FrameReport) -> [usize; 3] {
    // Head of a texel: the depth of its farthest receiver, the length of its list, where that
    // begins, and the depth of its cover, inverted.
    let (heads, entries) = (values(report, "texels"), values(report, "entries"));
    let own = values(report, "primitive");
    let map_size = fit.size;
    let casters = (0..scene.mesh.triangles.len() as u32).map(|primitive| TexelTriangle {
        corners: scene.mesh.corners(primitive).map(|p| fit.texel(p)),
    });
    let casters: Vec<TexelTriangle> = casters.collect();
    let texels = (map_size * map_size) as usize;
    let list = |texel: usize| {
        let mut list = Vec::new();
        let mut number = heads[4 * texel + 2];
        while number != 0 {
            let entry = &entries[4 * (number as usize - 1)..];
            (number, _) = (entry[0], list.push((entry[1], [entry[2], entry[3]])));
        }
        list
    };
    let lists: Vec<Vec<(u32, [u32; 2])>> = (0..texels).map(list).collect();
    let cover = |texel: usize| {
        let inverted = heads[4 * texel + 3];
        (inverted != 0).then(|| f64::from(f32::from_bits(!inverted)))
    };
    let mut covered = 0;
    for (texel, list) in lists.iter().enumerate() {
        let primitives: BTreeSet<u32> = list.iter().map(|(primitive, _)| *primitive).collect();
        assert_eq!(primitives.len(), list.len(), "a caster is in a list twice");
        assert_eq!(heads[4 * texel + 1] as usize, list.len());
        let place = DVec2::new(
            (texel as u32 % map_size).into(),
            (texel as u32 / map_size).into(),
        );
        let farthest = f64::from(f32::from_bits(heads[4 * texel]));
        if let Some(depth) = cover(texel) {
            covered += 1;
            assert!(farthest <= depth + 1e-5, "{place} asks behind its cover");
            let is_cover = |caster| greatest_over(caster, place).is_some_and(|z| z <= depth);
            assert!(
                casters.iter().any(is_cover),
                "nobody covers {place} before {depth}"
            );
        }
        for &(primitive, _) in list {
            let caster = &casters[primitive as usize];
            // The shader's slack, and as much for the corners' rounding.
            assert!(
                touches(caster, place + 0.5, 4.0 * SLACK),
                "{primitive} is not in texel {place}"
            );
            let least = caster.corners.map(|corner| corner.z);
            let least = least.into_iter().fold(f64::INFINITY, f64::min);
            // Those listed before a cover was found may be behind that.
            let is_asked = cover(texel).is_some() || least <= farthest + 1e-5;
            assert!(is_asked, "{primitive} is behind {place}");
        }
    }
    let positions = report
        .readbacks
        .iter()
        .find(|readback| readback.name == "position");
    let positions = positions.unwrap().content.as_f32().unwrap();
    let [mut shading, mut border] = [0; 2];
    for (receiver, &own) in positions.chunks_exact(4).zip(&own) {
        if receiver[3] <= 0.0 {
            continue;
        }
        let position = Vec3::from_slice(receiver).as_dvec3();
        let at = fit.texel(position);
        let place = at.truncate();
        assert!(place.min_element() > 0.0, "{position} is outside");
        assert!(
            place.max_element() < map_size.into(),
            "{position} is outside"
        );
        // On the border of two texels either may be the receiver's.
        let by = [-1.0, 1.0].map(|sign| sign * 0.25 * SLACK);
        let near = by.map(|x| by.map(|y| (place + DVec2::new(x, y)).max(DVec2::ZERO)));
        let near: BTreeSet<[u32; 2]> = near
            .into_iter()
            .flatten()
            .map(|place| [place.x as u32, place.y as u32].map(|at| at.min(map_size - 1)))
            .collect();
        let is_behind = |[x, y]: &[u32; 2]| {
            cover((y * map_size + x) as usize).is_some_and(|depth| at.z > depth)
        };
        if near.iter().any(is_behind) {
            continue;
        }
        border += usize::from(near.len() > 1);
        for (primitive, caster) in (0u32..).zip(&casters) {
            if primitive != own && depth_at(caster, place).is_some_and(|z| z < at.z) {
                shading += 1;
                let is_found = |[x, y]: &[u32; 2]| {
                    let list = &lists[(y * map_size + x) as usize];
                    let offset = place - DVec2::new((*x).into(), (*y).into()) - 0.5;
                    let own_key = list.iter().find(|(listed, _)| *listed == primitive);
                    own_key.is_some_and(|(_, key)| key_passes(*key, offset, at.z))
                };
                assert!(
                    near.iter().any(is_found),
                    "{primitive} shades {position}, and no list of {near:?} lets it"
                );
            }
        }
    }
    [shading, covered, border]
}

/// Returns true if an entry's key lets a receiver at `offset` from the texel's centre ask its
/// caster: 16 bits of depth, and two lines of which x, y and the distance from the centre have 8
/// bits each, in 127ths; a depth below a distance counts as its fraction.
fn key_passes(key: [u32; 2], offset: DVec2, depth: f64) -> bool {
    let byte = |word: u32, shift: u32| f64::from((word >> shift) as u8 as i8);
    let distance = |word: u32| f64::from(word as i32) / f64::from(1 << 24);
    let one = byte(key[0], 16) * offset.x + byte(key[1], 16) * offset.y + distance(key[0]);
    let other = byte(key[1], 8) * offset.x + byte(key[1], 0) * offset.y + distance(key[1]);
    let is_behind = depth >= f64::from(key[0] & 0xffff) / 65535.0 - 1e-6;
    one >= 0.0 && other >= 0.0 && is_behind
}

/// The greatest depth of a triangle over the texel from `corner` on, if it covers that, larger by 3
/// times the slack.
fn greatest_over(caster: &TexelTriangle, corner: DVec2) -> Option<f64> {
    let around = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE];
    let enlarged = around.map(|by| corner + 0.5 + (by - 0.5) * (1.0 + 6.0 * SLACK));
    for point in enlarged {
        depth_at(caster, point)?;
    }
    let corners = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE].map(|by| corner + by);
    corners.iter().try_fold(0.0, |greatest: f64, point| {
        Some(greatest.max(depth_at(caster, *point)?))
    })
}

/// Returns true if a triangle touches a texel that is larger by so much on every side.
fn touches(caster: &TexelTriangle, centre: DVec2, by: f64) -> bool {
    let shrunk = 1.0 / (1.0 + 2.0 * by);
    let corners = caster.corners.map(|corner| {
        let place = centre + (corner.truncate() - centre) * shrunk;
        place.extend(corner.z)
    });
    exact::touches(&TexelTriangle { corners }, centre)
}

/// The depth of a triangle at a point that is inside.
fn depth_at(caster: &TexelTriangle, point: DVec2) -> Option<f64> {
    let [a, b, c] = caster.corners.map(DVec3::truncate);
    let weights = [
        (b - point).perp_dot(c - point),
        (c - point).perp_dot(a - point),
        (a - point).perp_dot(b - point),
    ];
    let sum: f64 = weights.iter().sum();
    let is_inside = sum != 0.0 && weights.iter().all(|weight| weight / sum >= 0.0);
    let depths = weights.iter().zip(caster.corners);
    is_inside.then(|| depths.map(|(weight, corner)| weight / sum * corner.z).sum())
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn answers_are_those_of_rays_whatever_the_map() {
    let [mut lit, mut shadow] = [0; 2];
    for seed in 0..24 {
        let scene = mixed(seed);
        let mut bench = Bench::new(&scene);
        let rays = bench.by_rays();
        for (fit, map_size) in [
            ("scene", 8),
            ("receivers", 13),
            ("scene", 64),
            ("receivers", 160),
        ] {
            let lists = bench.by_lists(fit, &[("map_size", map_size)]);
            assert!(lists.visibility == rays, "scene {seed}, map {map_size}");
            assert_eq!(lists.unlisted, 0, "scene {seed}, map {map_size}");
            (lit, shadow) = (lit + lists.lit, shadow + lists.shadow);
        }
    }
    assert!(
        lit > 50_000 && shadow > 50_000,
        "{lit} lit, {shadow} in shadow"
    );
}

/// Neither in the preset, nor with room for a single entry.
#[test]
fn lists_need_no_hierarchy() {
    for (word, params, is_built) in [
        ("receivers", &[][..], false),
        ("receivers", &[("max_entries", 1)], false),
        ("rays", &[("max_entries", 1)], true),
    ] {
        let mut bench = Bench::new(&mixed(3));
        bench.unlisted = word;
        let expected = bench.by_rays();
        let mut bench = Bench::new(&mixed(3));
        bench.unlisted = word;
        let mut executor = bench.executor("receivers", params, &[]);
        let report = frame(&bench.gpu, &mut executor, &["visibility"]);
        assert!(values(&report, "visibility") == expected, "{word}");
        let mut built = bench.provider.built().iter();
        assert_eq!(
            built.any(|built| built.name == "scene.bvh_nodes"),
            is_built,
            "{word}"
        );
        let passes = executor.plan().passes();
        let traces = passes.iter().any(|pass| pass.name.ends_with("trace_rays"));
        assert_eq!(traces, is_built, "{word}");
    }
}

#[test]
fn what_has_no_room_is_tested_apart() {
    let scene = mixed(2);
    let mut bench = Bench::new(&scene);
    let rays = bench.by_rays();
    let with = |bench: &mut Bench, most: u32| {
        bench.by_lists("receivers", &[("map_size", 64), ("max_entries", most)])
    };
    // About: what lies behind a cover is listed if it came before that.
    let needed = with(&mut bench, 65_536).entries;
    assert!(needed < 32_768, "{needed}");
    for (most, is_short) in [(1, true), (needed / 2, true), (2 * needed, false)] {
        let lists = with(&mut bench, most);
        assert!(lists.visibility == rays, "{most} of {needed} entries");
        assert_eq!(lists.unlisted > 0, is_short, "{most} of {needed} entries");
        assert_eq!(lists.entries > most, is_short, "{most} of {needed} entries");
    }
    // Where some have room, some receivers are answered by their lists.
    let [single, most] = [1, needed / 10 * 9].map(|most| with(&mut bench, most));
    assert!(most.visibility == rays);
    assert!(most.unlisted < single.unlisted, "{}", most.unlisted);
}

/// Nothing covers a texel before another caster, so that their order decides nothing.
#[test]
fn an_entry_without_room_leaves_out_one_texel() {
    let scene = scene(crowd(0.8), DVec3::new(0.3, 1.2, 0.9), DVec3::NEG_Y);
    let mut bench = Bench::new(&scene);
    let rays = bench.by_rays();
    let with = |bench: &mut Bench, most: u32| {
        let params = [
            ("map_size", 64),
            ("longest_list", 40),
            ("max_entries", most),
        ];
        bench.by_lists("receivers", &params)
    };
    let ample = with(&mut bench, 65_536);
    let needed = ample.entries;
    assert!(needed < 65_536, "{needed}");
    let short = with(&mut bench, needed - 1);
    assert!(short.visibility == rays);
    assert_eq!(short.entries, needed);
    let more = short.unlisted - ample.unlisted;
    assert!((1..100).contains(&more), "{more}");
}

#[test]
fn a_list_that_is_too_long_is_not_looked_at() {
    let scene = mixed(1);
    let mut bench = Bench::new(&scene);
    let rays = bench.by_rays();
    let mut before = usize::MAX;
    for longest in [0, 1, 4, 16] {
        let lists = bench.by_lists("receivers", &[("map_size", 16), ("longest_list", longest)]);
        assert!(lists.visibility == rays, "{longest}");
        assert!(
            (1..before).contains(&lists.unlisted),
            "{longest}: {}",
            lists.unlisted
        );
        before = lists.unlisted;
    }
}

#[test]
fn edges_of_a_picture_may_be_no_multiple_of_a_workgroups() {
    let scene = mixed(1);
    let mut bench = Bench::from_scene(&scene, [61, 43]);
    let rays = bench.by_rays();
    for longest in [4, 2048] {
        let lists = bench.by_lists("receivers", &[("map_size", 16), ("longest_list", longest)]);
        let answered = lists.lit + lists.shadow;
        assert!(answered > 500, "{answered}");
        assert!(lists.visibility == rays, "{longest}");
    }
}

/// 100,000 casters in a texel, and every pixel's receiver in the same one: no receiver walks its
/// list.
#[test]
fn a_crowded_texel_is_exact_and_takes_no_more_room_than_others() {
    let crowd = crowd(0.3);
    let scene = scene(crowd, DVec3::new(0.3, 1.2, 0.9), DVec3::NEG_Y);
    let mut bench = Bench::new(&scene);
    let rays = bench.by_rays();
    for (map_size, longest) in [(8, 64), (8, 2048), (64, 512)] {
        let params = [("map_size", map_size), ("longest_list", longest)];
        let lists = bench.by_lists("scene", &params);
        assert!(lists.visibility == rays, "map {map_size}, {longest}");
        assert!(lists.unlisted > 1000, "{}", lists.unlisted);
        assert!(lists.entries <= longest * map_size * map_size);
    }
}

/// More than 100,000 receivers ask the same list.
#[test]
fn receivers_crowd_one_texel() {
    let casters = joined(floor(30.0, 0.0), &soup(40, 0.3, 5));
    let scene = scene(casters, DVec3::new(0.3, 1.2, 0.9), DVec3::NEG_Y);
    let mut bench = Bench::from_scene(&scene, [448, 448]);
    let rays = bench.by_rays();
    let params = [("map_size", 9)];
    let mut executor = bench.executor("scene", &params, &["texels"]);
    let texels = values(&frame(&bench.gpu, &mut executor, &["texels"]), "texels");
    let asked = texels.chunks_exact(4).filter(|texel| texel[0] > 0).count();
    assert_eq!(asked, 1);
    let lists = bench.answer(&mut executor);
    assert!(lists.visibility == rays);
    assert_eq!(lists.unlisted, 0);
    assert!(lists.lit + lists.shadow > 100_000 && lists.shadow > 1000);
}

#[test]
fn lists_are_exact_before_and_after_they_have_grown() {
    let scene = scene(crowd(0.8), DVec3::new(0.3, 1.2, 0.9), DVec3::NEG_Y);
    let mut bench = Bench::from_scene(&scene, [256, 192]);
    let rays = bench.by_rays();
    let params = [("map_size", 362), ("longest_list", 2048)];
    let mut executor = bench.executor("scene", &params, &[]);
    let first = bench.answer(&mut executor);
    assert!(first.visibility == rays);
    assert!(first.entries > 65_536, "{}", first.entries);
    assert!(first.unlisted > 0);
    assert!(executor.grow(&mut bench.provider).unwrap().is_some());
    let second = bench.answer(&mut executor);
    assert!(second.visibility == rays);
    assert_eq!(second.unlisted, 0);
    assert!(executor.grow(&mut bench.provider).unwrap().is_none());
}

/// Lists of some hundred casters.
#[test]
fn long_lists_are_walked() {
    let scene = scene(crowd(0.8), DVec3::new(0.3, 1.2, 0.9), DVec3::NEG_Y);
    let mut bench = Bench::new(&scene);
    let rays = bench.by_rays();
    for map_size in [24, 40] {
        let params = [("map_size", map_size)];
        let mut executor = bench.executor("receivers", &params, &["texels"]);
        frame(&bench.gpu, &mut executor, &[]);
        executor.grow(&mut bench.provider).unwrap();
        let texels = values(&frame(&bench.gpu, &mut executor, &["texels"]), "texels");
        let long = texels
            .chunks_exact(4)
            .filter(|texel| texel[1] > 224)
            .count();
        assert!(long > 30, "map {map_size}: {long}");
        let lists = bench.answer(&mut executor);
        assert!(lists.visibility == rays, "map {map_size}");
        assert_eq!(lists.unlisted, 0, "map {map_size}");
    }
}

/// More parts of large triangles than there is room for: the lists that lack them are not known,
/// and receivers have no answer before there is room.
#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn parts_without_room_are_told_and_get_it() {
    let corners = (0..70_000).flat_map(|layer| {
        let height = 0.5 + 1e-6 * layer as f32;
        [(-2.0, -9.0), (2.0, -9.0), (0.0, 9.0)].map(|(x, z)| Vec3::new(x, height, z))
    });
    let triangles = (0..70_000).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    let sheets = mesh(corners.collect(), triangles.collect());
    let sheets = joined(floor(12.0, -0.5), &sheets);
    let scene = scene(sheets, DVec3::new(0.3, 0.2, 0.9), DVec3::NEG_Y);
    let mut bench = Bench::from_scene(&scene, [24, 24]);
    let rays = bench.by_rays();
    let params = [("map_size", 48), ("longest_list", 16)];
    let mut executor = bench.executor("scene", &params, &[]);
    let first = bench.answer(&mut executor);
    assert!(first.unanswered > 0 && first.unlisted == first.lit + first.shadow + first.unanswered);
    for (shown, right) in first.visibility.iter().zip(&rays) {
        assert!(shown == right || *shown == UNANSWERED);
    }
    assert!(executor.grow(&mut bench.provider).unwrap().is_some());
    let second = bench.answer(&mut executor);
    assert_eq!((second.unlisted, second.unanswered), (first.unlisted, 0));
    // Where drivers do not end the loops of rays that pass all sheets.
    let pixels = second.visibility.iter().zip(&rays);
    let wrong = pixels.filter(|(shown, right)| shown != right && **right != UNANSWERED);
    assert_eq!(wrong.count(), 0);
}

/// So many parts that one workgroup does not see them all.
#[test]
fn a_triangle_over_a_large_grid_is_shared_out() {
    let sheet = joined(floor(3.0, -1.0), &soup(40, 4.0, 3));
    let scene = scene(sheet, DVec3::new(1.0, 2.0, 3.0), DVec3::new(0.3, -1.0, 0.2));
    let mut bench = Bench::from_scene(&scene, [640, 448]);
    let rays = bench.by_rays();
    // 648 texels along an edge: the grid is no finer for so many pixels.
    let lists = bench.by_lists("scene", &[("map_size", 8192)]);
    assert!(lists.visibility == rays);
    assert_eq!(lists.unlisted, 0);
}

/// Whose texels are decided by rounding: the grid of the hard case is that over its scene.
#[test]
fn receivers_on_texel_corners_are_right() {
    let case = skiagraph_cases::case("receivers_on_texel_corners").unwrap();
    let mut bench = Bench::from_scene(&Arc::new(case.scene()), [128, 128]);
    let rays = bench.by_rays();
    for map_size in [128, 256] {
        let lists = bench.by_lists("scene", &[("map_size", map_size)]);
        assert!(lists.visibility == rays, "map {map_size}");
        assert_eq!(lists.unlisted, 0);
    }
}

/// The window is no larger than its receivers need, unless f32 ends the map.
#[test]
fn the_grid_is_laid_over_the_receivers() {
    let mut narrower = 0;
    for seed in 0..12 {
        let mut scene = (*mixed(seed)).clone();
        scene.views[0].fov_y_degrees = 10.0;
        let mut bench = Bench::new(&Arc::new(scene.clone()));
        let captured = ["map_fit", "position"];
        let mut executor = bench.executor("receivers", &[("map_size", 100)], &captured);
        let report = frame(&bench.gpu, &mut executor, &captured);
        let fit = MapFit::new(&report, &scene);
        let positions = report
            .readbacks
            .iter()
            .find(|readback| readback.name == "position");
        let positions = positions.unwrap().content.as_f32().unwrap();
        let facing = positions
            .chunks_exact(4)
            .filter(|receiver| receiver[3] > 0.0);
        let places = facing.map(|receiver| {
            let place = fit.texel(Vec3::from_slice(receiver).as_dvec3());
            place.truncate()
        });
        let (low, high) = places.fold((DVec2::MAX, DVec2::MIN), |(low, high), place| {
            (low.min(place), high.max(place))
        });
        assert!(
            low.min_element() >= 0.0 && high.max_element() < 100.0,
            "{low} {high}"
        );
        assert!(
            (high - low).min_element() > 90.0,
            "scene {seed}: {low} {high}"
        );
        narrower += u32::from(fit.scene_size().min_element() > 120.0);
    }
    assert!(narrower > 3, "{narrower}");
}

/// Where f32 cannot place a receiver in as many texels, there are fewer.
#[test]
fn far_from_the_origin_the_grid_is_coarser() {
    let scene = moved(&mixed(4), 1e3);
    let mut bench = Bench::new(&scene);
    let rays = bench.by_rays();
    for fit in FITS {
        let params = [("map_size", 2048)];
        let mut executor = bench.executor(fit, &params, &["map_fit"]);
        let report = frame(&bench.gpu, &mut executor, &["map_fit"]);
        let size = MapFit::new(&report, &scene)
            .rows
            .map(|row| 2.0 * row.truncate().length());
        let is_coarse = |edge: &f64| (4.0..200.0).contains(edge);
        assert!(size.iter().all(is_coarse), "{fit}: {size:?}");
        let lists = bench.by_lists(fit, &params);
        assert!(lists.visibility == rays);
        assert_eq!(lists.unlisted, 0);
    }
}

/// So much farther from the origin than it is wide.
pub(crate) fn moved(scene: &Scene, by: f32) -> Arc<Scene> {
    let mut scene = scene.clone();
    let positions = &mut scene.mesh.positions;
    positions.iter_mut().for_each(|position| *position += by);
    scene.views[0].eye += f64::from(by);
    Arc::new(scene)
}

/// Texels as large as half a texel's rounding: where a receiver's texel is not certain, all casters
/// are tested.
#[test]
fn far_from_the_origin_no_list_answers() {
    let mut bench = Bench::new(&moved(&mixed(4), 4e5));
    let rays = bench.by_rays();
    let lists = bench.by_lists("scene", &[("map_size", 2048)]);
    assert!(lists.visibility == rays);
    assert_eq!(lists.lit + lists.shadow, lists.unlisted);
    assert!(lists.unlisted > 100 && lists.unanswered == 0);
}
