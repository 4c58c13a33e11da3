//! Closed solids around a centre, and rays whose answers follow from that alone: one from the
//! centre outward, or from outside to the centre, meets the surface, however a tracer rounds. A ray
//! that ends before the nearest corner does not.

use super::brute::Ray;
use glam::DVec3;
use skiagraph_scene::{
    Indexed, Mesh,
    generate::numbers::{Random, turn},
};

/// A closed solid: every ray from its centre passes its surface an odd number of times.
pub struct Solid {
    /// Name for tables.
    pub name: &'static str,
    /// Mesh of the surface, in scene units; triangles share the corners of their edges.
    pub mesh: Mesh,
    centre: DVec3,
    /// Distance of the nearest and of the farthest corner.
    reach: [f64; 2],
}

/// Places of a solid's surface at which rays are aimed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aim {
    /// Corners of triangles.
    Corners,
    /// Points on edges of triangles.
    Edges,
    /// Points in the interior of triangles.
    Inside,
    /// As [`Inside`](Self::Inside), but the ray ends before the surface: it is not blocked.
    Short,
}

impl Aim {
    /// All aims, in the order in which they are tested.
    pub const ALL: [Self; 4] = [Self::Corners, Self::Edges, Self::Inside, Self::Short];

    /// True if the right answer is that rays of this aim are blocked.
    pub fn is_blocked(self) -> bool {
        self != Self::Short
    }
}

/// Returns the solids, the simplest first.
pub fn solids() -> Vec<Solid> {
    let mut random = Random::new(7);
    let heights: Vec<f64> = (0..=64 * 128).map(|_| random.range(0.2, 1.0)).collect();
    vec![
        // 16,128 triangles, slivers at both poles.
        Solid::new("ball", [64, 128], DVec3::ZERO, |_, _, point| point),
        // The same 1,300 radii from the origin: corners and rays round to 2^-13.
        Solid::new(
            "far_ball",
            [64, 128],
            DVec3::new(1000.25, 700.5, -400.125),
            |_, _, point| point,
        ),
        // A ball of 64 × 1 × 1/64: most triangles are seen edge-on.
        Solid::new("flat_ball", [64, 128], DVec3::ZERO, |_, _, point| {
            point * DVec3::new(64.0, 1.0, 1.0 / 64.0)
        }),
        // A random height for each corner: a ray passes many faces at grazing angles.
        Solid::new(
            "spikes",
            [64, 128],
            DVec3::ZERO,
            move |row, column, point| point * heights[(row * 128 + column % 128) as usize],
        ),
        // 523,264 triangles: edges are 1/340 of a radius long.
        Solid::new("dense_ball", [512, 512], DVec3::ZERO, |_, _, point| point),
    ]
}

/// A point of the unit sphere, from its top to its bottom by `row` and around by `column`, both
/// from 0 to 1.
fn at(row: f64, column: f64) -> DVec3 {
    let (up, out) = turn(row / 2.0);
    let (x, z) = turn(column.fract());
    DVec3::new(x * out, up, -z * out)
}

impl Solid {
    /// The ball of `rows` × `columns` cells, each corner moved by `place`, then all by `centre`.
    fn new(
        name: &'static str,
        [rows, columns]: [u32; 2],
        centre: DVec3,
        place: impl Fn(u32, u32, DVec3) -> DVec3,
    ) -> Self {
        let corner = |row: u32, column: u32| {
            // The poles are one corner each, whatever the series leaves of the sine there.
            let column = if row == 0 || row == rows {
                0
            } else {
                column % columns
            };
            let [down, around] =
                [[row, rows], [column, columns]].map(|[part, whole]| ratio(part, whole));
            let mut point = at(down, around);
            if row == 0 || row == rows {
                point = DVec3::new(0.0, point.y, 0.0);
            }
            (place(row, column, point) + centre).as_vec3()
        };
        let mut corners: Vec<[f32; 3]> = Vec::new();
        let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
        for (row, column) in cells {
            let [a, b, c, d] = [
                corner(row, column),
                corner(row + 1, column),
                corner(row + 1, column + 1),
                corner(row, column + 1),
            ];
            for [a, b, c] in [[a, b, c], [a, c, d]] {
                if a != b && b != c && c != a {
                    corners.extend([a, b, c].map(|corner| corner.to_array()));
                }
            }
        }
        let indices: Vec<u32> = (0..corners.len() as u32).collect();
        let indexed = Indexed {
            positions: &corners,
            normals: &[],
            indices: &indices,
        };
        let mesh = indexed.mesh().expect("finite corners, three a triangle");
        let distances = mesh.positions.iter();
        let distances = distances.map(|corner| (corner.as_dvec3() - centre).length());
        let reach = distances.fold([f64::MAX, 0.0], |[near, far], distance| {
            [near.min(distance), far.max(distance)]
        });
        Self {
            name,
            mesh,
            centre,
            reach,
        }
    }

    /// Returns `count` rays with one right answer ([`Aim::is_blocked`]), the same for the same
    /// `seed`: in turn from the centre outward, and from outside to the centre. Directions are not
    /// of unit length.
    pub fn rays(&self, aim: Aim, count: usize, seed: u64) -> Vec<Ray> {
        let mut random = Random::new(seed);
        let triangles = self.mesh.triangles.len() as f64;
        let ray = |index: usize| {
            let primitive = random.range(0.0, triangles) as u32;
            let [a, b, c] = self.mesh.corners(primitive);
            let (u, v) = (random.range(0.0, 1.0), random.range(0.0, 1.0));
            let target = match aim {
                Aim::Corners => a,
                Aim::Edges => a + (b - a) * u,
                Aim::Inside | Aim::Short if u + v > 1.0 => {
                    a + (b - a) * (1.0 - u) + (c - a) * (1.0 - v)
                }
                Aim::Inside | Aim::Short => a + (b - a) * u + (c - a) * v,
            };
            let out = target - self.centre;
            let [near, far] = self.reach;
            if index.is_multiple_of(2) {
                // From the centre: past every corner, or half-way to the nearest one. Faces of flat
                // and spiky solids are nearer than their corners, by less than a tenth.
                let length = if aim.is_blocked() {
                    4.0 * far
                } else {
                    0.05 * near
                };
                self.ray(self.centre, out, length / out.length())
            } else {
                // Twice as far away as the farthest corner, and ending at the centre; or so far
                // away that it ends half-way to the ball around all corners.
                let way = out * (random.range(2.0, 8.0) * far / out.length());
                let end = if aim.is_blocked() {
                    1.0
                } else {
                    0.5 * (1.0 - far / way.length())
                };
                self.ray(self.centre + way, -way, end)
            }
        };
        (0..count).map(ray).collect()
    }

    fn ray(&self, origin: DVec3, direction: DVec3, t_max: f64) -> Ray {
        Ray {
            origin: origin.as_vec3(),
            t_min: 0.0,
            direction: direction.as_vec3(),
            t_max: t_max as f32,
        }
    }
}

fn ratio(part: u32, whole: u32) -> f64 {
    f64::from(part) / f64::from(whole)
}

#[cfg(test)]
mod tests {
    use super::*;
    use skiagraph_reference::Oracle;

    /// The reference agrees on every ray that has no end to matter; the others end where they are
    /// said to.
    #[test]
    fn answers_follow_from_the_geometry() {
        for solid in solids() {
            let [near, far] = solid.reach;
            assert!(near > 0.0, "{}", solid.name);
            let oracle = Oracle::new(&solid.mesh);
            for aim in Aim::ALL {
                let rays = solid.rays(aim, 2000, 5);
                let given: Vec<_> = rays.iter().map(|ray| (ray.origin, ray.direction)).collect();
                let answers = oracle.occlusion(&given);
                for (index, (ray, answer)) in rays.iter().zip(answers).enumerate() {
                    assert!(answer.blocked, "{} {aim:?}: {ray:?}", solid.name);
                    let end =
                        ray.origin.as_dvec3() + ray.direction.as_dvec3() * f64::from(ray.t_max);
                    let end = (end - solid.centre).length();
                    let is_right = match (aim, index % 2) {
                        (Aim::Short, 0) => end < 0.06 * near,
                        (Aim::Short, _) => end > far,
                        (_, 0) => end > 2.0 * far,
                        (_, _) => end < 0.1 * near,
                    };
                    assert!(is_right, "{} {aim:?} ends at {end}: {ray:?}", solid.name);
                }
            }
        }
    }

    /// No face comes nearer to the centre than nine tenths of the nearest corner.
    #[test]
    fn faces_are_about_as_far_as_their_corners() {
        for solid in solids() {
            let near = 0.9 * solid.reach[0];
            for primitive in 0..solid.mesh.triangles.len() as u32 {
                let [a, b, c] = solid.mesh.corners(primitive).map(|it| it - solid.centre);
                for (u, v) in [(0.5, 0.0), (0.0, 0.5), (0.5, 0.5), (0.33, 0.33), (0.1, 0.1)] {
                    let point = a + (b - a) * u + (c - a) * v;
                    assert!(point.length() > near, "{} {primitive}", solid.name);
                }
            }
        }
    }
}
