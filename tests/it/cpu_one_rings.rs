//! The patch of a texel (`crsma_full`) against clipping: it covers the texel as a whole, whatever
//! the mesh.

use glam::{DVec2, DVec3, Vec3};
use proptest::prelude::*;
use skiagraph_scene::{Adjacency, LightFit, Mesh};
use skiagraph_tests::cpu_reference::{Casters, Cull, LightSpace, TexelTriangle, exact};
use std::f64::consts::TAU;

/// Edge of the map: a power of two, so that coordinates on the grid stay what they are.
const SIZE: u32 = 64;

/// Area that clipping may leave by rounding.
const ROUNDING: f64 = 1e-9;

/// A light space whose texels are the mesh's own x and y.
fn space(mesh: &Mesh) -> LightSpace {
    let half = f64::from(SIZE) * 0.5;
    let extent = DVec3::new(half, half, 1.0);
    let place = glam::DMat4::from_translation(DVec3::new(-1.0, 1.0, 0.0));
    let scale = glam::DMat4::from_scale(DVec3::new(1.0 / half, -1.0 / half, 1.0));
    let fit = LightFit {
        view_projection: place * scale,
        extent,
    };
    LightSpace::from_fit(fit, mesh, SIZE)
}

fn mesh(corners: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Mesh {
    Mesh {
        normals: vec![Vec3::Z],
        normal_indices: vec![[0; 3]; triangles.len()],
        positions: corners,
        triangles,
        ..Mesh::default()
    }
}

/// A sheet of cells × cells quads around the map's centre, corners displaced, on a grid of 1/256
/// texel.
#[derive(Clone, Debug)]
struct Sheet {
    cells: usize,
    /// Edge of a quad in 1/256 texel.
    step: i32,
    /// Displacement of each corner, likewise.
    off: Vec<[i32; 2]>,
    /// Per quad: which diagonal, windings turned over, and which of the two triangles are there.
    quads: Vec<(bool, [bool; 2], [bool; 2])>,
}

impl Sheet {
    fn mesh(&self) -> Mesh {
        let corners = self.cells + 1;
        let first = 32 * 256 - self.step * self.cells as i32 / 2;
        let position = |i: usize| {
            let at =
                |place: usize, axis: usize| first + self.step * place as i32 + self.off[i][axis];
            Vec3::new(at(i % corners, 0) as f32, at(i / corners, 1) as f32, 128.0) / 256.0
        };
        let mut triangles = vec![];
        for (i, &(diagonal, turned, there)) in self.quads.iter().enumerate() {
            let a = (i % self.cells + i / self.cells * corners) as u32;
            let (b, c, d) = (a + 1, a + corners as u32, a + 1 + corners as u32);
            let halves = if diagonal {
                [[a, b, d], [a, d, c]]
            } else {
                [[a, b, c], [b, d, c]]
            };
            for half in 0..2 {
                let [p, q, r] = halves[half];
                if there[half] {
                    triangles.push(if turned[half] { [q, p, r] } else { [p, q, r] });
                }
            }
        }
        mesh((0..corners * corners).map(position).collect(), triangles)
    }
}

fn sheets() -> impl Strategy<Value = Sheet> {
    let steps = prop_oneof![Just(64), Just(128), 50..400, Just(512), 400..2000];
    (3..7usize, steps, 0..5i32, 0..4u8, 0..3u8).prop_flat_map(
        |(cells, step, folds, holes, turns)| {
            // From a flat sheet to one that folds over itself.
            let range = (step * folds / 6).max(1);
            let off =
                prop::collection::vec([-range..range, -range..range], (cells + 1) * (cells + 1));
            let often = move |share: f64| prop::bool::weighted(share);
            let there = often(if holes == 0 { 0.9 } else { 1.0 });
            let turned = often(if turns == 0 { 0.2 } else { 0.0 });
            let quad = (any::<bool>(), [turned, turned], [there, there]);
            let quads = prop::collection::vec(quad, cells * cells);
            (off, quads).prop_map(move |(off, quads)| Sheet {
                cells,
                step,
                off,
                quads,
            })
        },
    )
}

/// A closed fan around a corner near the middle texel's centre that goes round once, twice or
/// thrice.
fn fans() -> impl Strategy<Value = Mesh> {
    let spoke = (0.5..1.5f64, 0.3..4.0f64);
    (
        prop::collection::vec(spoke, 3..12),
        1..4u32,
        [-100..100, -100..100],
        any::<u64>(),
    )
        .prop_map(|(spokes, turns, off, order)| {
            let total: f64 = spokes.iter().map(|spoke| spoke.0).sum();
            let hub =
                Vec3::new(off[0] as f32, off[1] as f32, 0.0) / 256.0 + Vec3::new(32.5, 32.5, 0.5);
            let mut angle = 0.0;
            let mut positions: Vec<Vec3> = spokes
                .iter()
                .map(|&(share, length)| {
                    angle += share / total * TAU * f64::from(turns);
                    let at = DVec2::from_angle(angle) * length;
                    hub + Vec3::new(at.x as f32, at.y as f32, 0.0)
                })
                .collect();
            // The hub's index is anything from the lowest to the highest: containment goes by it.
            let place = order as usize % (positions.len() + 1);
            positions.insert(place, hub);
            let around: Vec<u32> = (0..positions.len() as u32)
                .filter(|&i| i != place as u32)
                .collect();
            let count = around.len();
            let triangles = (0..count).map(|i| [place as u32, around[i], around[(i + 1) % count]]);
            let triangles = triangles.collect();
            mesh(positions, triangles)
        })
}

/// Centres of the texels of a triangle.
fn texels(triangle: &TexelTriangle) -> impl Iterator<Item = DVec2> {
    let (low, high) = triangle.bounds();
    let range = |low: f64, high: f64| low.floor() as i32..high.floor() as i32 + 1;
    let columns = range(low.x, high.x);
    range(low.y, high.y).flat_map(move |y| {
        columns
            .clone()
            .map(move |x| DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5))
    })
}

/// Every patch of a mesh covers its texel. Returns how many there are, and how many of several
/// triangles.
fn judge(mesh: &Mesh, cull: Cull) -> Result<(usize, usize), TestCaseError> {
    let adjacency = Adjacency::new(mesh);
    let casters = Casters::new(mesh, &adjacency, space(mesh), cull);
    let (mut patches, mut joint) = (0, 0);
    for first in 0..mesh.triangles.len() as u32 {
        if !casters.casts(first, 0.0) {
            continue;
        }
        for centre in texels(casters.triangle(first)) {
            if !casters.triangle(first).contains(centre, 0.0) {
                continue;
            }
            let surely = casters.patch(first, centre, -1e-4);
            let perhaps = casters.patch(first, centre, 1e-4);
            let Some(patch) = casters.patch(first, centre, 0.0) else {
                prop_assert!(surely.is_none(), "leeway must make it harder");
                continue;
            };
            // Where arithmetic may choose between two corners' signs, so may the exact rule.
            let near_corner = casters
                .triangle(first)
                .corners
                .iter()
                .any(|corner| corner.truncate().distance(centre) < 0.05);
            prop_assert!(perhaps.is_some() || near_corner, "leeway must ease it");
            let triangles = || {
                patch
                    .members()
                    .iter()
                    .map(|&member| casters.triangle(member))
            };
            prop_assert!(
                exact::uncovered(triangles(), centre) < ROUNDING,
                "{centre} {:?}",
                patch.members()
            );
            let ring = mesh.triangles[first as usize];
            for &member in patch.members() {
                prop_assert!(casters.casts(member, 0.0));
                prop_assert!(
                    mesh.triangles[member as usize]
                        .iter()
                        .any(|corner| ring.contains(corner))
                );
            }
            patches += 1;
            joint += usize::from(patch.members().len() > 1);
        }
    }
    Ok((patches, joint))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]

    #[test]
    fn the_patch_of_a_sheet_covers_its_texel(
        sheet in sheets(),
        cull in prop_oneof![Just(Cull::None), Just(Cull::Front), Just(Cull::Back)],
    ) {
        judge(&sheet.mesh(), cull)?;
    }

    #[test]
    fn the_patch_of_a_fan_covers_its_texel(fan in fans()) {
        judge(&fan, Cull::None)?;
    }

    /// Corners that are off by half the slack leave no gap: what the patch is proven for is not the
    /// rounded mesh.
    #[test]
    fn the_patch_of_a_rounded_sheet_covers_its_texel(
        sheet in sheets(),
        by in prop::collection::vec([-1.0..1.0f64, -1.0..1.0], 49),
    ) {
        let mesh = sheet.mesh();
        let adjacency = Adjacency::new(&mesh);
        let casters = Casters::new(&mesh, &adjacency, space(&mesh), Cull::None);
        let exactly = |primitive: u32| {
            let mut triangle = *casters.triangle(primitive);
            for (corner, &index) in triangle
                .corners
                .iter_mut()
                .zip(&mesh.triangles[primitive as usize])
            {
                *corner += DVec2::from(by[index as usize]).extend(0.0) * (0.5 / 128.0);
            }
            triangle
        };
        for first in 0..mesh.triangles.len() as u32 {
            for centre in texels(casters.triangle(first)) {
                if casters.triangle(first).contains(centre, 0.0)
                    && let Some(patch) = casters.patch(first, centre, 0.0)
                {
                    let triangles: Vec<_> = patch
                        .members()
                        .iter()
                        .map(|&member| exactly(member))
                        .collect();
                    prop_assert!(
                        exact::uncovered(&triangles, centre) < ROUNDING,
                        "{centre} {:?}",
                        patch.members()
                    );
                }
            }
        }
    }
}

fn flat(cells: usize, step: i32) -> Mesh {
    let corners = (cells + 1) * (cells + 1);
    Sheet {
        cells,
        step,
        off: vec![[0; 2]; corners],
        quads: vec![(true, [false; 2], [true; 2]); cells * cells],
    }
    .mesh()
}

/// Without slack and with corners on texel corners: the whole inside of a sheet is covered, save
/// where the one-ring is too small.
#[test]
fn the_inside_of_a_flat_sheet_is_covered() {
    for (step, least) in [(512, 0.95), (700, 0.7), (301, 0.5)] {
        let cells = 8;
        let sheet = flat(cells, step);
        let (patches, joint) = judge(&sheet, Cull::None).unwrap();
        let inside = (f64::from(step) / 256.0 * cells as f64 - 3.0).powi(2);
        assert!(
            patches as f64 > least * inside && joint > 0,
            "{step}: {patches} of {inside}, {joint} joint"
        );
    }
    // Quads of a tenth of a texel: every patch would need more than sixteen triangles.
    assert_eq!(judge(&flat(12, 25), Cull::None).unwrap(), (0, 0));
}

/// A fan that goes round twice has its hub's texel in it twice, whatever the hub's index.
#[test]
fn a_fan_that_winds_twice_covers_nothing_at_its_hub() {
    let hub = Vec3::new(32.5, 32.5, 0.5);
    for (turns, expected) in [(1, true), (2, false)] {
        let mut positions = vec![hub + Vec3::new(0.1, 0.05, 0.0)];
        positions.extend((0..10).map(|i| {
            let at =
                DVec2::from_angle(TAU * f64::from(turns * i) / 10.0 + 0.2 + 0.01 * f64::from(i))
                    * 3.0;
            hub + Vec3::new(at.x as f32, at.y as f32, 0.0)
        }));
        let triangles = (0..10).map(|i| [0, 1 + i, 1 + (i + 1) % 10]).collect();
        let fan = mesh(positions, triangles);
        let adjacency = Adjacency::new(&fan);
        let casters = Casters::new(&fan, &adjacency, space(&fan), Cull::None);
        let centre = DVec2::splat(32.5);
        let mut any = false;
        for first in 0..10 {
            if casters.triangle(first).contains(centre, 0.0) {
                any |= casters.patch(first, centre, 0.0).is_some();
            }
        }
        assert_eq!(any, expected, "{turns} turns");
    }
}
