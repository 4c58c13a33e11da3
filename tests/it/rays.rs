//! The tracer on the GPU against the f64 oracle on random rays through random and degenerate
//! meshes: they agree but on rays that the oracle calls indeterminate.
//!
//! The ten million rays are a suite of their own, which CI runs:
//! `cargo test -p skiagraph-tests --test rays -- --ignored --nocapture`

use crate::support::{
    brute::{MISS, Ray},
    graphs::trace_all,
    meshes,
    random::Random,
};
use glam::Vec3;
use skiagraph_reference::Oracle;
use skiagraph_scene::Mesh;

/// Triangles of which each has something wrong with it: no area, two equal corners, a copy wound
/// the other way, a hair's width.
fn degenerate(count: u32, seed: u64) -> Mesh {
    let mut random = Random(seed);
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for index in 0..count {
        let first = positions.len() as u32;
        let [a, b, c] = [random.vector(), random.vector(), random.vector()];
        let along = random.unit();
        positions.extend(match index % 5 {
            0 => [a, b, a.lerp(b, along)],
            1 => [a, b, a.lerp(b, along) + c * 1e-6],
            2 => [a, b, a + c * 1e-3],
            _ => [a, b, c],
        });
        triangles.push([first, first + 1, first + 2]);
        match index % 5 {
            3 => triangles.push([first + 1, first, first + 2]),
            4 => triangles.push([first, first, first + 2]),
            _ => {}
        }
    }
    meshes::mesh(positions, triangles)
}

/// A soup whose corners lie on a coarse grid: rays between grid points meet corners and edges
/// exactly, and lie in planes.
fn on_a_grid(count: usize, seed: u64) -> Mesh {
    let mut mesh = meshes::soup(count, 0.5, seed);
    mesh.positions.iter_mut().for_each(|p| *p = snapped(*p));
    mesh
}

fn snapped(p: Vec3) -> Vec3 {
    (p * 8.0).round() / 8.0
}

/// A mesh, how it is placed in the world, and the greatest share of rays that may be indeterminate.
struct Subject {
    name: &'static str,
    mesh: Mesh,
    scale: f32,
    offset: Vec3,
    snap: bool,
    cap: f64,
}

fn subjects(seed: u64) -> Vec<Subject> {
    let plain = |name, mesh, cap| Subject {
        name,
        mesh,
        scale: 1.0,
        offset: Vec3::ZERO,
        snap: false,
        cap,
    };
    let placed = |name, scale, offset, cap| Subject {
        scale,
        offset,
        ..plain(name, meshes::soup(60, 0.4, seed), cap)
    };
    vec![
        plain("soup", meshes::soup(60, 0.4, seed), CAP),
        plain("fine soup", meshes::soup(3000, 0.02, seed + 1), CAP),
        plain("closed", meshes::potato(4, 0.3, seed + 2), CAP),
        plain("degenerate", degenerate(60, seed + 3), CAP),
        Subject {
            snap: true,
            // Rays that meet edges exactly.
            ..plain("grid", on_a_grid(60, seed + 4), 0.1)
        },
        placed("tiny", 1e-4, Vec3::ZERO, CAP),
        placed("huge", 1e6, Vec3::ZERO, CAP),
        placed("far off", 1.0, Vec3::new(1e4, -3e3, 7e3), CAP),
        placed("at 1e7", 1e3, Vec3::splat(1e7), CAP),
    ]
}

const CAP: f64 = 0.001;

/// Holds `count` rays through each subject against the oracle; returns how many there were.
fn agree(count: usize, seed: u64) -> usize {
    let mut total = 0;
    for subject in subjects(seed) {
        let Subject {
            name,
            scale,
            offset,
            snap,
            cap,
            ..
        } = subject;
        let place = |p: Vec3| p * scale + offset;
        let mesh = Mesh {
            positions: subject.mesh.positions.iter().map(|&p| place(p)).collect(),
            ..subject.mesh
        };
        let mut random = Random(seed ^ 0x5ca1_ab1e);
        let rays: Vec<Ray> = (0..count)
            .map(|index| {
                let (mut from, mut to) = (random.vector() * 1.5, random.vector());
                if snap {
                    (from, to) = (snapped(from), snapped(to));
                }
                if index % 16 == 0 {
                    // Along an axis.
                    to = from + Vec3::AXES[index / 16 % 3] * random.signed();
                }
                let origin = place(from);
                let direction = place(to) - origin;
                Ray {
                    origin,
                    t_min: 0.0,
                    direction: if direction == Vec3::ZERO {
                        Vec3::Y
                    } else {
                        direction
                    },
                    t_max: 3e38,
                }
            })
            .collect();
        let exact: Vec<(Vec3, Vec3)> = rays.iter().map(|ray| (ray.origin, ray.direction)).collect();
        let exact = Oracle::new(&mesh).occlusion(&exact);
        let hits = trace_all(&mesh, &rays, "Any");
        let wrong: Vec<_> = (0..count)
            .filter(|&i| !exact[i].indeterminate && exact[i].blocked != (hits[i].primitive != MISS))
            .collect();
        let share = exact.iter().filter(|exact| exact.indeterminate).count() as f64 / count as f64;
        let blocked = exact.iter().filter(|exact| exact.blocked).count() as f64 / count as f64;
        println!(
            "{name}: {count} rays, {:.1} % blocked, indeterminate {:.4} %, {} wrong",
            100.0 * blocked,
            100.0 * share,
            wrong.len()
        );
        if let Some(&first) = wrong.first() {
            let hit = hits[first];
            let triangle = mesh.triangles.get(hit.primitive as usize);
            panic!(
                "{name}: {} wrong, first {:?}, {:?}, {hit:?} on {:?}",
                wrong.len(),
                rays[first],
                exact[first],
                triangle.map(|t| t.map(|corner| mesh.positions[corner as usize]))
            );
        }
        assert!(
            share <= cap,
            "{name}: {share} of the rays are indeterminate"
        );
        assert!(
            (0.02..0.999).contains(&blocked),
            "{name}: {blocked} of the rays are blocked"
        );
        total += count;
    }
    total
}

#[test]
fn random_rays_agree_with_the_oracle() {
    agree(20_000, 1);
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn ten_million_rays_agree_with_the_oracle() {
    let mut total = 0;
    for seed in 0..4 {
        total += agree(280_000, 1000 * seed);
    }
    assert!(total >= 10_000_000, "{total}");
}
