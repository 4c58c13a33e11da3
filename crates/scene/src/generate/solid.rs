//! Closed solids: everything generated is a loft, a stack of rings closed by a point at either end.

use super::numbers::turn;
use crate::mesh::{Group, Mesh};
use crate::weld::Welder;
use glam::{DVec3, Vec3};

/// Faces around a vertex share a smooth normal where they meet at less than 50° (this is the
/// cosine).
const CREASE_COS: f64 = 0.643;

/// Free space between two parts that would touch in the world; far below a pixel in every view.
pub(super) const GAP: f64 = 0.02;

/// A right-handed frame: where a part stands and how it is turned.
#[derive(Clone, Copy)]
pub(super) struct Frame {
    pub origin: DVec3,
    pub x: DVec3,
    pub y: DVec3,
    pub z: DVec3,
}

impl Frame {
    /// Upright at `origin`, its x axis turned from world x towards world −z by a fraction of a full
    /// turn.
    pub fn upright(origin: DVec3, fraction: f64) -> Self {
        let (cos, sin) = turn(fraction);
        Self {
            origin,
            x: DVec3::new(cos, 0.0, -sin),
            y: DVec3::Y,
            z: DVec3::new(sin, 0.0, cos),
        }
    }

    /// With its y axis along `axis` (unit) and its x axis as near as possible to `x`.
    pub fn along(origin: DVec3, axis: DVec3, x: DVec3) -> Self {
        let x = (x - axis * x.dot(axis))
            .try_normalize()
            .unwrap_or_else(|| axis.any_orthonormal_vector());
        Self {
            origin,
            x,
            y: axis,
            z: x.cross(axis),
        }
    }

    /// The same at another place.
    pub fn moved_to(self, origin: DVec3) -> Self {
        Self { origin, ..self }
    }

    pub fn at(&self, x: f64, y: f64, z: f64) -> DVec3 {
        self.origin + self.x * x + self.y * y + self.z * z
    }

    /// An ellipse at height `y`, counter-clockwise around the y axis.
    pub fn ring(&self, y: f64, radius_x: f64, radius_z: f64, sides: u32) -> Vec<DVec3> {
        let corner = |side| {
            let (cos, sin) = turn(f64::from(side) / f64::from(sides));
            self.at(radius_x * cos, y, -radius_z * sin)
        };
        (0..sides).map(corner).collect()
    }

    /// A rectangle at height `y`, counter-clockwise around the y axis.
    pub fn rectangle(&self, y: f64, half_x: f64, half_z: f64) -> Vec<DVec3> {
        [(1.0, 1.0), (1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0)]
            .map(|(x, z)| self.at(half_x * x, y, half_z * z))
            .into()
    }
}

/// A mesh under construction. Parts do not share vertices: each is a closed surface of its own.
#[derive(Default)]
pub(super) struct Builder {
    pub(super) mesh: Mesh,
    pub(super) normals: Welder,
}

impl Builder {
    /// Begins a group.
    pub fn group(&mut self, name: &str) {
        let start = self.mesh.triangles.len() as u32;
        self.mesh.groups.push(Group {
            name: name.to_owned(),
            triangles: start..start,
        });
    }

    pub fn finish(mut self) -> Mesh {
        self.mesh.normals = self.normals.values;
        self.mesh
    }

    /// A solid through rings of equally many corners, each counter-clockwise around the way from
    /// `start` to `end`.
    pub fn loft(&mut self, start: DVec3, rings: &[Vec<DVec3>], end: DVec3) {
        let sides = rings.first().map_or(0, Vec::len);
        let count = (rings.len() * sides) as u32;
        let mut points: Vec<DVec3> = rings.concat();
        points.extend([start, end]);
        let mut faces = Vec::with_capacity(2 * points.len());
        let corner = |ring: usize, side: usize| (ring * sides + side % sides) as u32;
        let last = rings.len() - 1;
        for side in 0..sides {
            faces.push([count, corner(0, side + 1), corner(0, side)]);
            faces.push([count + 1, corner(last, side), corner(last, side + 1)]);
            for ring in 0..last {
                let [a, b] = [corner(ring, side), corner(ring, side + 1)];
                let [c, d] = [corner(ring + 1, side + 1), corner(ring + 1, side)];
                faces.push([a, b, c]);
                faces.push([a, c, d]);
            }
        }
        self.add(&points, &faces);
    }

    /// A box around the origin of `frame`.
    pub fn cuboid(&mut self, frame: Frame, half: DVec3) {
        let mut points = frame.rectangle(-half.y, half.x, half.z);
        points.extend(frame.rectangle(half.y, half.x, half.z));
        let mut faces = vec![[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7]];
        for side in 0..4u32 {
            let next = (side + 1) % 4;
            faces.extend([[side, next, next + 4], [side, next + 4, side + 4]]);
        }
        self.add(&points, &faces);
    }

    /// A square slab of ground around the origin.
    pub fn ground(&mut self, half: f64) {
        self.group("ground");
        let corner = DVec3::new(half, 0.0, half);
        self.slab(-corner - DVec3::Y * 2.0, corner, 24);
    }

    /// A slab over `low`..`high`, its upper side a grid of `cells` × `cells` equal cells: f32
    /// places a point on a triangle the better the nearer its corners are.
    pub fn slab(&mut self, low: DVec3, high: DVec3, cells: u32) {
        let row = cells + 1;
        let mut points: Vec<DVec3> = (0..row * row)
            .map(|i| {
                let (x, z) = (f64::from(i % row), f64::from(i / row));
                let share = DVec3::new(x, f64::from(cells), z) / f64::from(cells);
                low + (high - low) * share
            })
            .collect();
        let mut faces = Vec::new();
        for (x, z) in (0..cells).flat_map(|x| (0..cells).map(move |z| (x, z))) {
            let [a, b] = [z * row + x, z * row + x + 1];
            let [c, d] = [b + row, a + row];
            faces.extend([[a, d, c], [a, c, b]]);
        }
        // Once around the grid, counter-clockwise as seen from above.
        let rim: Vec<u32> = (0..cells)
            .map(|i| i * row)
            .chain((0..cells).map(|i| cells * row + i))
            .chain((0..cells).map(|i| (cells - i) * row + cells))
            .chain((0..cells).map(|i| cells - i))
            .collect();
        let below = points.len() as u32;
        let lowered = |&corner: &u32| points[corner as usize].with_y(low.y);
        let lowered: Vec<DVec3> = rim.iter().map(lowered).collect();
        points.extend(lowered);
        let centre = points.len() as u32;
        points.push(((low + high) * 0.5).with_y(low.y));
        for (i, &corner) in rim.iter().enumerate() {
            let next = (i + 1) % rim.len();
            let [under, under_next] = [i, next].map(|i| below + i as u32);
            faces.extend([
                [under, under_next, rim[next]],
                [under, rim[next], corner],
                [centre, under_next, under],
            ]);
        }
        self.add(&points, &faces);
    }

    /// A tube of round sections along `path`, each point with its radius; the ends are flat.
    pub fn tube(&mut self, path: &[(DVec3, f64)], sides: u32) {
        let mut x = DVec3::X;
        let rings: Vec<Vec<DVec3>> = (0..path.len())
            .map(|i| {
                let before = path[i.saturating_sub(1)].0;
                let after = path[(i + 1).min(path.len() - 1)].0;
                let frame = Frame::along(path[i].0, (after - before).normalize(), x);
                x = frame.x; // carried along, so that the tube does not twist
                frame.ring(0.0, path[i].1, path[i].1, sides)
            })
            .collect();
        self.loft(path[0].0, &rings, path[path.len() - 1].0);
    }

    /// A thin pointed plate in the x–z plane of `frame`, from its origin along x: a leaf or a
    /// petal.
    pub fn leaf(
        &mut self,
        frame: Frame,
        length: f64,
        half_width: f64,
        half_thickness: f64,
        sides: u32,
    ) {
        let centre = frame.moved_to(frame.at(length * 0.5, 0.0, 0.0));
        let ring = centre.ring(0.0, length * 0.5, half_width, sides);
        let [low, high] = [-half_thickness, half_thickness].map(|y| centre.at(0.0, y, 0.0));
        self.loft(low, &[ring], high);
    }

    fn add(&mut self, points: &[DVec3], faces: &[[u32; 3]]) {
        let base = self.mesh.positions.len() as u32;
        let rounded: Vec<Vec3> = points.iter().map(|point| point.as_vec3()).collect();
        self.mesh.positions.extend(&rounded);
        // Twice the area times the unit normal.
        let area = |face: &[u32; 3]| {
            let [a, b, c] = face.map(|index| rounded[index as usize].as_dvec3());
            (b - a).cross(c - a)
        };
        let areas: Vec<DVec3> = faces.iter().map(area).collect();
        let mut around = vec![Vec::new(); points.len()];
        for (face, corners) in faces.iter().enumerate() {
            for &corner in corners {
                around[corner as usize].push(face);
            }
        }
        for (face, corners) in faces.iter().enumerate() {
            let own = areas[face].normalize_or_zero();
            let normals = corners.map(|corner| {
                let smooth = around[corner as usize]
                    .iter()
                    .map(|&other| areas[other])
                    .filter(|area| area.normalize_or_zero().dot(own) > CREASE_COS);
                let smooth = smooth.sum::<DVec3>().try_normalize();
                self.normals.index(smooth.unwrap_or(own).as_vec3())
            });
            self.mesh
                .triangles
                .push(corners.map(|corner| base + corner));
            self.mesh.normal_indices.push(normals);
        }
        self.end_group();
    }

    /// Ends the group behind the last triangle.
    pub fn end_group(&mut self) {
        if let Some(group) = self.mesh.groups.last_mut() {
            group.triangles.end = self.mesh.triangles.len() as u32;
        }
    }

    /// Triangles so far.
    pub fn triangles(&self) -> u32 {
        self.mesh.triangles.len() as u32
    }
}
