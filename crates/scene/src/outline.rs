//! Outlines of points as a directional light sees them: what its box is fitted to.

use crate::mesh::bounds;
use glam::{DAffine3, DMat3, DVec2, DVec3, Vec3};

/// Outline of points as a directional light sees them: their convex hull across the light, and
/// their least and greatest depth. [`DirectionalLight::outline`](crate::DirectionalLight::outline)
/// makes it, and [`DirectionalLight::fit_outline`](crate::DirectionalLight::fit_outline) fits the
/// light space to it. A caller keeps the outlines of a scene's parts, and [joins](Self::joined)
/// them when some parts have moved.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// Convex hull across the light, counter-clockwise; empty for no points.
    pub(crate) hull: Vec<DVec2>,
    pub(crate) nearest: f64,
    pub(crate) farthest: f64,
    /// The points of the hull that lie farthest in each of [`DIRECTIONS`]; `None` for no points.
    ends: Option<Ends>,
}

/// A point for each of [`DIRECTIONS`].
type Ends = [DVec2; 8];

impl Outline {
    /// The outline of points across the light, and of their least and greatest depth.
    pub(crate) fn new(places: Vec<DVec2>, [nearest, farthest]: [f64; 2]) -> Self {
        let hull = convex_hull(places);
        Self {
            ends: ends(hull.iter().map(|place| [*place; 8])),
            hull,
            nearest,
            farthest,
        }
    }

    /// The outline of one point at the origin.
    pub(crate) fn of_the_origin() -> Self {
        Self::new(vec![DVec2::ZERO], [0.0; 2])
    }

    /// Returns the outline of the points of all parts together; all outlines are of the same light.
    /// `outlines` has an entry for each part: its outline, or `None` if the part has moved since.
    /// For such a part `loose` has, at the same index, a rough outline that contains the part, such
    /// as that of its box, and `exact`, given the index, returns the part's own outline. `exact` is
    /// called only for a part that may reach the border of the result, or that has no rough
    /// outline; its outline is then written into `outlines`.
    pub fn joined(
        outlines: &mut [Option<Self>],
        loose: &[Option<Self>],
        mut exact: impl FnMut(usize) -> Self,
    ) -> Self {
        let unknown = outlines.iter().enumerate();
        let unknown = unknown.filter(|(_, outline)| outline.is_none());
        let unknown: Vec<usize> = unknown.map(|(part, _)| part).collect();
        let rough = |part: usize| loose.get(part).and_then(Option::as_ref);
        let open = unknown
            .iter()
            .filter_map(|&part| Some((part, rough(part)?)));
        for part in farthest_of(outlines, open) {
            outlines[part] = Some(exact(part));
        }
        let within = Within::new(outlines);
        for part in unknown {
            let is_inside = rough(part).is_some_and(|loose| within.contains(loose));
            if outlines[part].is_none() && !is_inside {
                outlines[part] = Some(exact(part));
            }
        }
        let mut places = Vec::new();
        let (mut nearest, mut farthest) = (f64::INFINITY, f64::NEG_INFINITY);
        for outline in outlines.iter().flatten() {
            nearest = nearest.min(outline.nearest);
            farthest = farthest.max(outline.farthest);
            if !within.contains(outline) {
                places.extend(&outline.hull);
            }
        }
        Self::new(places, [nearest, farthest])
    }
}

/// Returns those of `count` points, each the `point` of its number, that may be corners of the box
/// around all of them or of their [`Outline`], whatever the direction of the light: all but those
/// well within a box in their convex hull. Each point is looked at once or twice.
pub fn outer(count: usize, point: impl Fn(usize) -> Vec3) -> Vec<Vec3> {
    outside(sampled_box(count, &point), count, point)
}

/// Points of a solid that [`outer`] may return wherever an affine map takes all of its points: few
/// of them, which take longer to find.
#[derive(Clone, Debug)]
pub struct Border {
    /// The points.
    pub points: Vec<Vec3>,
    /// How deep at least the others lie in the convex hull; infinite if there is no box in that.
    depth: f64,
}

impl Border {
    /// Finds the border of `count` points, each the `point` of its number.
    pub fn new(count: usize, point: impl Fn(usize) -> Vec3) -> Self {
        let ends = sampled_box(count, &point);
        let points = outside(ends, count, point);
        let [low, high] = ends.map(|end| end.as_dvec3());
        if !low.cmplt(high).all() {
            let depth = f64::INFINITY;
            return Self { points, depth };
        }
        let mut shell = Shell {
            middle: (low + high) * 0.5,
            half: (high - low) * 0.5,
            points: Vec::new(),
        };
        let farthest = |side: f64| {
            DVec3::AXES.map(|axis| {
                let along = |point: &Vec3| side * axis.dot(point.as_dvec3());
                let farthest = points.iter().max_by(|a, b| along(a).total_cmp(&along(b)));
                farthest.map_or(DVec3::ZERO, |point| shell.scaled(*point))
            })
        };
        let ends = [farthest(-1.0), farthest(1.0)];
        let mut left = points;
        for octant in 0..8 {
            let corners = [0, 1, 2].map(|axis| ends[octant >> axis & 1][axis]);
            let inverse = DMat3::from_cols(corners[0], corners[1], corners[2]).inverse();
            let is_in = |point: &Vec3| (inverse * shell.scaled(*point)).min_element() >= 0.0;
            let (own, rest) = left.into_iter().partition(is_in);
            shell.add(corners, own, Shell::ROUNDS);
            left = rest;
        }
        shell.points.append(&mut left);
        Self {
            depth: MARGIN * shell.half.min_element(),
            points: shell.points,
        }
    }

    /// Returns the points where a map takes them, in f32; `None` if others may be on the border
    /// there, because f32 rounds too much.
    pub fn moved(&self, map: &DAffine3) -> Option<Vec<Vec3>> {
        let most = |places: &[Vec3]| {
            let most = places.iter().map(|at| at.abs().max_element());
            f64::from(most.fold(0.0, f32::max))
        };
        let length = |it: &DMat3| it.x_axis.length() + it.y_axis.length() + it.z_axis.length();
        let place = |from: &Vec3| map.transform_point3(from.as_dvec3()).as_vec3();
        let moved: Vec<Vec3> = self.points.iter().map(place).collect();
        // The least length that the map makes of 1, and more than places err by.
        let least = 1.0 / length(&map.matrix3.inverse());
        let error = 1e-6 * most(&moved) + 1e-12 * length(&map.matrix3) * most(&self.points);
        (self.depth * least > error).then_some(moved)
    }
}

/// A polyhedron within the convex hull goes so far, seen from the middle of the box, as a share,
/// before the border. It is far more than f64 errs by.
const MARGIN: f64 = 1e-3;

/// Points that lie near the surface of a polyhedron between some of them, or beyond.
struct Shell {
    /// Middle and half size of a box in the convex hull.
    middle: DVec3,
    half: DVec3,
    points: Vec<Vec3>,
}

impl Shell {
    /// Corners that a line from the middle may pass by.
    const ROUNDS: u32 = 40;

    /// The way from the middle, in half sizes.
    fn scaled(&self, point: Vec3) -> DVec3 {
        (point.as_dvec3() - self.middle) / self.half
    }

    /// Adds the points of a cone but those well within the tetrahedron between the middle and three
    /// corners. Where one lies beyond it, the cone is cut in three along the farthest one.
    fn add(&mut self, corners: [DVec3; 3], mut points: Vec<Vec3>, rounds: u32) {
        /// Volumes this much smaller than that of a cube as large are flat: far more than f64 errs
        /// by.
        const FLAT: f64 = 1e-7;
        let matrix = DMat3::from_cols(corners[0], corners[1], corners[2]);
        let size = corners.iter().map(|corner| corner.length());
        let size = size.fold(0.0, f64::max);
        if rounds == 0 || matrix.determinant().abs() <= FLAT * size.powi(3) {
            self.points.append(&mut points);
            return;
        }
        let inverse = matrix.inverse();
        let (mut farthest, mut reach) = (None, 1.0 + MARGIN);
        points.retain(|point| {
            let weights = inverse * self.scaled(*point);
            if weights.element_sum() > reach {
                (farthest, reach) = (Some((*point, weights)), weights.element_sum());
            }
            weights.element_sum() >= 1.0 - MARGIN || weights.min_element() < 0.0
        });
        let Some((farthest, whole)) = farthest else {
            self.points.append(&mut points);
            return;
        };
        let mut cones: [Vec<Vec3>; 3] = Default::default();
        for point in points {
            let shares = inverse * self.scaled(point) / whole.max(DVec3::splat(FLAT));
            cones[shares.min_position()].push(point);
        }
        for (corner, points) in cones.into_iter().enumerate() {
            let mut corners = corners;
            corners[corner] = self.scaled(farthest);
            self.add(corners, points, rounds - 1);
        }
    }
}

/// A box in the convex hull of some points, by a sample of them.
fn sampled_box(count: usize, point: impl Fn(usize) -> Vec3) -> [Vec3; 2] {
    const SAMPLES: usize = 1 << 16;
    let samples = (0..count).step_by(count / SAMPLES + 1);
    inner_box(&samples.map(point).collect::<Vec<_>>())
}

/// Those points that are not in a box.
fn outside([low, high]: [Vec3; 2], count: usize, point: impl Fn(usize) -> Vec3) -> Vec<Vec3> {
    let is_outer = |point: &Vec3| point.cmple(low).any() || point.cmpge(high).any();
    (0..count).map(point).filter(is_outer).collect()
}

/// A box in the convex hull of some points; none if its low corner is not below its high one. For
/// each corner there is a point beyond it in all three axes, so that no plane parts the corner from
/// all of these points.
fn inner_box(points: &[Vec3]) -> [Vec3; 2] {
    /// The box is smaller by this share on each side, which is far more than f64 errs by.
    const MARGIN: f32 = 1e-3;
    let (low, high) = bounds(points.iter().copied()).unwrap_or_default();
    let (middle, half) = ((low + high) * 0.5, (high - low) * 0.5);
    let mut octants = [(Vec3::ZERO, 0.0); 8];
    for &point in points {
        let from_middle = point - middle;
        let share = (from_middle.abs() / half).min_element();
        let (corner, most) = &mut octants[from_middle.is_negative_bitmask() as usize];
        if share > *most {
            (*corner, *most) = (point, share);
        }
    }
    if octants.iter().any(|(_, share)| *share == 0.0) {
        return [Vec3::INFINITY, Vec3::NEG_INFINITY];
    }
    let [mut low, mut high] = [Vec3::NEG_INFINITY, Vec3::INFINITY];
    for (octant, &(corner, _)) in octants.iter().enumerate() {
        let is_low = [1, 2, 4].map(|axis| octant & axis != 0).into();
        low = Vec3::select(is_low, low.max(corner), low);
        high = Vec3::select(is_low, high, high.min(corner));
    }
    let margin = (high - low) * MARGIN;
    [low + margin, high - margin]
}

/// Directions across the light, counter-clockwise.
const DIRECTIONS: [DVec2; 8] = [
    DVec2::new(1.0, 0.0),
    DVec2::new(1.0, 1.0),
    DVec2::new(0.0, 1.0),
    DVec2::new(-1.0, 1.0),
    DVec2::new(-1.0, 0.0),
    DVec2::new(-1.0, -1.0),
    DVec2::new(0.0, -1.0),
    DVec2::new(1.0, -1.0),
];

/// Returns for each direction the one of some points that lies farthest in it.
fn ends(points: impl Iterator<Item = Ends>) -> Option<Ends> {
    points.reduce(|mut farthest, other| {
        for ((end, other), along) in farthest.iter_mut().zip(other).zip(DIRECTIONS) {
            if along.dot(other) > along.dot(*end) {
                *end = other;
            }
        }
        farthest
    })
}

/// The unknown parts that may reach farthest in a direction, or along the light.
fn farthest_of<'a>(
    outlines: &'a [Option<Outline>],
    open: impl Iterator<Item = (usize, &'a Outline)>,
) -> Vec<usize> {
    let settled = outlines.iter().flatten().map(|outline| (None, outline));
    let open = open.map(|(part, loose)| (Some(part), loose));
    // The part that reaches farthest in each direction, and how far.
    let mut most: [(Option<usize>, f64); 10] = [(None, f64::NEG_INFINITY); 10];
    for (part, outline) in settled.chain(open) {
        for (direction, (farthest, reach)) in most.iter_mut().enumerate() {
            let own = match DIRECTIONS.get(direction) {
                Some(along) => outline
                    .ends
                    .map_or(f64::NEG_INFINITY, |ends| along.dot(ends[direction])),
                None if direction == DIRECTIONS.len() => outline.farthest,
                None => -outline.nearest,
            };
            if own > *reach {
                (*farthest, *reach) = (part, own);
            }
        }
    }
    let mut parts: Vec<usize> = most.iter().filter_map(|(part, _)| *part).collect();
    parts.sort_unstable();
    parts.dedup();
    parts
}

/// Polygon of the points that lie farthest in eight directions: what is in it is not on the border
/// (Akl and Toussaint, "A fast convex hull algorithm", IPL 7(5), 1978).
struct Octagon {
    /// Where each edge begins, and its way to the next corner; none around a point.
    edges: Vec<[DVec2; 2]>,
    /// A point so near to an edge, in areas, counts as outside.
    margin: f64,
}

impl Octagon {
    fn new(ends: Option<Ends>) -> Self {
        let mut corners = ends.unwrap_or_default().to_vec();
        corners.dedup();
        let size = corners.iter().map(|corner| corner.abs().max_element());
        let size = size.fold(0.0, f64::max);
        let next = corners.iter().cycle().skip(1);
        let edges = corners.iter().zip(next).filter(|(a, b)| a != b);
        Self {
            edges: edges.map(|(a, b)| [*a, *b - *a]).collect(),
            margin: 1e-12 * size * size,
        }
    }

    fn contains(&self, place: DVec2) -> bool {
        let is_left = |[from, way]: &[DVec2; 2]| way.perp_dot(place - *from) > self.margin;
        !self.edges.is_empty() && self.edges.iter().all(is_left)
    }
}

/// Region within some outlines, off their border.
struct Within {
    octagon: Octagon,
    nearest: f64,
    farthest: f64,
}

impl Within {
    fn new(outlines: &[Option<Outline>]) -> Self {
        let there = || outlines.iter().flatten();
        Self {
            octagon: Octagon::new(ends(there().filter_map(|outline| outline.ends))),
            nearest: there().fold(f64::INFINITY, |at, outline| at.min(outline.nearest)),
            farthest: there().fold(f64::NEG_INFINITY, |at, outline| at.max(outline.farthest)),
        }
    }

    fn contains(&self, outline: &Outline) -> bool {
        let Some([right, _, top, _, left, _, bottom, _]) = outline.ends else {
            return true;
        };
        let corners = [left.x, right.x].map(|x| [bottom.y, top.y].map(|y| DVec2::new(x, y)));
        let mut corners = corners.as_flattened().iter();
        self.nearest <= outline.nearest
            && outline.farthest <= self.farthest
            && corners.all(|corner| self.octagon.contains(*corner))
    }
}

/// The corners of the convex hull, counter-clockwise (Andrew's monotone chain).
pub(crate) fn convex_hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
    /// Number of points beyond which it pays to leave out those that are not on it.
    const MANY: usize = 256;
    if points.len() > MANY {
        let octagon = Octagon::new(ends(points.iter().map(|point| [*point; 8])));
        points.retain(|point| !octagon.contains(*point));
    }
    points.sort_unstable_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    let mut hull: Vec<DVec2> = Vec::new();
    for half in 0..2 {
        let first = hull.len();
        for &point in &points {
            while let [.., a, b] = hull[first..]
                && (b - a).perp_dot(point - b) <= 0.0
            {
                hull.pop();
            }
            hull.push(point);
        }
        // The last point of a half is the first of the other.
        if points.len() > 1 || half == 1 {
            hull.pop();
        }
        points.reverse();
    }
    if hull.is_empty() { points } else { hull }
}
