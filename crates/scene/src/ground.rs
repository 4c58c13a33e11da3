//! Adds a ground below a mesh that has no floor of its own.

use crate::mesh::{Group, Mesh};
use glam::{DVec3, Vec3};

/// Name of the group of triangles that [`add_ground`] adds to a mesh.
pub const GROUND: &str = "ground (added)";

/// Edge of the ground, in diagonals of the mesh's box.
const EDGE: f64 = 3.0;

/// Gap below the mesh, so that nothing lies in the ground's plane, in diagonals.
const GAP: f64 = 1e-4;

/// Thickness of the slab, in diagonals. A slab is closed, a plane would be an open part.
const THICKNESS: f64 = 0.01;

/// Shares of the mesh's height, and of its lesser width where that is three heights and more, from
/// below, in the greater of which a floor of its own lies: a town's may be hilly, or a thick slab.
const LOWEST: [f64; 2] = [0.05, 0.1];
const WIDE: f64 = 3.0;

/// Share of the mesh's outline from above that such a floor covers, and of both its widths that it
/// spans: the bottom within the walls of a box is none, nor is the foot of a lamp.
const COVERED: f64 = 0.5;
const SPANNED: f64 = 0.98;

/// Height and size of a ground that [`add_ground`] added below a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Ground {
    /// Height of the ground's upper side: the dot product of its points with the unit vector up, in
    /// scene units.
    pub height: f64,
    /// Length of the square ground's edges, in scene units.
    pub edge: f64,
}

/// The box of a mesh along the direction up and two directions across.
struct Extent {
    axes: [DVec3; 3],
    min: DVec3,
    max: DVec3,
}

impl Extent {
    /// `None` of an empty mesh, or without a direction.
    fn new(mesh: &Mesh, up: DVec3) -> Option<Self> {
        let up = up.try_normalize()?;
        let (right, back) = up.any_orthonormal_pair();
        let axes = [right, up, back];
        let along = |place: Vec3| DVec3::from(axes.map(|axis| axis.dot(place.as_dvec3())));
        let mut places = mesh.corner_positions().map(along);
        let first = places.next()?;
        let (min, max) = places.fold((first, first), |(min, max), at| (min.min(at), max.max(at)));
        Some(Self { axes, min, max })
    }

    fn place(&self, [x, y, z]: [f64; 3]) -> Vec3 {
        let [right, up, back] = self.axes;
        (right * x + up * y + back * z).as_vec3()
    }
}

/// Returns true if a mesh has a floor of its own: triangles that face `up`, lie in the lowest
/// twentieth of the mesh's height (in the lowest tenth of its lesser width, if it is three times as
/// wide as high), cover at least half of the area of its box as seen from above, and reach its
/// sides. Returns false for an empty mesh or an `up` without a direction.
pub fn has_ground(mesh: &Mesh, up: DVec3) -> bool {
    let Some(Extent { axes, min, max }) = Extent::new(mesh, up) else {
        return false;
    };
    let size = max - min;
    let width = size.x.min(size.z);
    let is_wide = width >= WIDE * size.y;
    let least = if is_wide { LOWEST[1] * width } else { 0.0 };
    let below = min.y + least.max(LOWEST[0] * size.y);
    let (mut covered, mut low, mut high) = (0.0, max, min);
    for primitive in 0..mesh.triangles.len() as u32 {
        let [a, b, c] = mesh.corners(primitive);
        let area = 0.5 * (b - a).cross(c - a).dot(axes[1]);
        let places = [a, b, c].map(|corner| DVec3::from(axes.map(|axis| axis.dot(corner))));
        if area > 0.0 && places.iter().all(|place| place.y <= below) {
            covered += area;
            low = places.into_iter().fold(low, DVec3::min);
            high = places.into_iter().fold(high, DVec3::max);
        }
    }
    let spans = |axis: fn(DVec3) -> f64| axis(high - low) >= SPANNED * axis(size);
    covered >= COVERED * size.x * size.z && spans(|it| it.x) && spans(|it| it.z)
}

/// Adds a square slab below the middle of a mesh, as a group of its own ([`GROUND`]). The upper
/// side of the slab lies just below the mesh's lowest point; its edge is three times the diagonal
/// of the mesh's box, its thickness a hundredth of the diagonal. If the mesh has materials, the
/// slab gets a plain white one. Returns the height and size of the slab, or `None` for an empty
/// mesh or an `up` without a direction.
pub fn add_ground(mesh: &mut Mesh, up: DVec3) -> Option<Ground> {
    let extent = Extent::new(mesh, up)?;
    let diagonal = (extent.max - extent.min).length().max(f64::MIN_POSITIVE);
    let middle = (extent.min + extent.max) * 0.5;
    let height = extent.min.y - GAP * diagonal;
    let half = EDGE * 0.5 * diagonal;
    let depth = height - THICKNESS * diagonal;
    let low = DVec3::new(middle.x - half, depth, middle.z - half);
    let high = DVec3::new(middle.x + half, height, middle.z + half);
    let slab = slab(&extent, low, high);
    let [position, normal, first] = [
        mesh.positions.len(),
        mesh.normals.len(),
        mesh.triangles.len(),
    ]
    .map(|count| count as u32);
    if !mesh.surfaces.of.is_empty() {
        mesh.surfaces.append(&slab.surfaces, slab.triangles.len());
    }
    mesh.positions.extend(&slab.positions);
    mesh.normals.extend(&slab.normals);
    let moved = |by: u32| move |corners: &[u32; 3]| corners.map(|corner| by + corner);
    mesh.triangles
        .extend(slab.triangles.iter().map(moved(position)));
    mesh.normal_indices
        .extend(slab.normal_indices.iter().map(moved(normal)));
    mesh.groups.push(Group {
        name: GROUND.to_owned(),
        triangles: first..mesh.triangles.len() as u32,
    });
    Some(Ground {
        height,
        edge: 2.0 * half,
    })
}

/// A closed box between two corners along the axes of an extent.
fn slab(extent: &Extent, low: DVec3, high: DVec3) -> Mesh {
    const FACES: [[u32; 4]; 6] = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let corner = |at: u32| {
        let pick = |axis: usize| [low, high][(at >> axis & 1) as usize][axis];
        extent.place([0, 1, 2].map(pick))
    };
    let [right, up, back] = extent.axes;
    let normals = [-right, right, -up, up, -back, back];
    let mut slab = Mesh {
        positions: (0..8).map(corner).collect(),
        normals: normals.map(|normal| normal.as_vec3()).to_vec(),
        ..Mesh::default()
    };
    // A pair of axes may be left-handed.
    let is_turned = right.cross(up).dot(back) < 0.0;
    for (face, [a, b, c, d]) in (0..).zip(FACES) {
        for [a, b, c] in [[a, b, c], [a, c, d]] {
            slab.triangles
                .push(if is_turned { [a, c, b] } else { [a, b, c] });
            slab.normal_indices.push([face; 3]);
        }
    }
    slab
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{indexed::geometric_normal, parts::Parts};

    fn table() -> Mesh {
        let extent = Extent {
            axes: [DVec3::X, DVec3::Y, DVec3::Z],
            min: DVec3::ZERO,
            max: DVec3::ONE,
        };
        slab(&extent, [2.0, 1.0, 3.0].into(), [6.0, 3.0, 7.0].into())
    }

    #[test]
    fn a_ground_is_a_closed_slab_just_below_the_lowest_point() {
        for up in [
            DVec3::Y,
            DVec3::Z * 2.0,
            DVec3::new(1.0, 2.0, -3.0),
            DVec3::NEG_X,
        ] {
            let mut mesh = table();
            let before = Extent::new(&mesh, up).unwrap();
            let ground = add_ground(&mut mesh, up).unwrap();
            assert_eq!(mesh.triangles.len(), 24);
            assert_eq!(Parts::new(&mesh).open, [false; 2]);
            let diagonal = (before.max - before.min).length();
            assert!(ground.height < before.min.y);
            assert!(ground.height > before.min.y - 1e-3 * diagonal);
            assert!((ground.edge - 3.0 * diagonal).abs() < 1e-12);
            for primitive in 12..24 {
                let [normal, ..] = mesh.corner_normals(primitive);
                let own = geometric_normal(mesh.corners(primitive)).unwrap();
                assert!(own.dot(normal) > 0.999, "{up} {primitive}");
            }
            assert_eq!(mesh.groups[0].name, GROUND);
            // Seen from above it is a floor.
            assert!(has_ground(&mesh, up));
        }
        assert_eq!(add_ground(&mut Mesh::default(), DVec3::Y), None);
    }

    #[test]
    fn a_table_has_no_ground_and_a_sheet_is_one() {
        assert!(!has_ground(&table(), DVec3::Y));
        let mut sheet = table();
        sheet.triangles.drain(..6);
        sheet.triangles.truncate(2);
        sheet.normal_indices.truncate(2);
        let [normal] = [geometric_normal(sheet.corners(0)).unwrap()];
        assert!(has_ground(&sheet, normal));
        assert!(!has_ground(&sheet, -normal));
        assert!(!has_ground(&Mesh::default(), DVec3::Y));
    }
}
