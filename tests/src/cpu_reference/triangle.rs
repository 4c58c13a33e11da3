//! One triangle in texels of a shadow map: which texels it covers grown, shrunk and joined to
//! others, and at what depth.

use super::{
    bounds::{Bound, LOWEST, SLACK},
    preset::Depth,
};
use glam::{DVec2, DVec3};
use skiagraph_reference::error_bound::F32_ROUNDING;
use std::f64::consts::SQRT_2;

/// A length that is at most this many times what its ends may be off by has no direction.
const NOISE: f64 = 4.0;

/// A triangle as the map sees it: x and y in texels, z the depth.
///
/// Predicates take a `leeway` in texels, by which each corner may be off: 0 asks of exactly this
/// triangle; a positive one whether *some* triangle with corners that near satisfies it; a negative
/// one whether *every* such triangle does (both with errors on the safe side).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TexelTriangle {
    /// Corners in the order of the mesh.
    pub corners: [DVec3; 3],
}

/// Bound on the f32 error of an area, in shares of the longest edge's square: 4 ulp, as the shaders
/// allow for.
const AREA_ROUNDING: f64 = 2.384_185_8e-7;

impl TexelTriangle {
    /// Twice the signed area; negative if the triangle faces the light.
    pub fn area(&self) -> f64 {
        let [a, b, c] = self.corners.map(DVec3::truncate);
        (b - a).perp_dot(c - a)
    }

    /// Length of the longest edge across.
    pub fn longest(&self) -> f64 {
        (0..3).map(|i| self.edge(i).1.length()).fold(0.0, f64::max)
    }

    /// The least height, 0 for a point.
    pub fn height(&self) -> f64 {
        let longest = self.longest();
        if longest == 0.0 {
            return 0.0;
        }
        self.area().abs() / longest
    }

    /// Least and greatest x and y.
    pub fn bounds(&self) -> (DVec2, DVec2) {
        let [a, b, c] = self.corners.map(DVec3::truncate);
        (a.min(b).min(c), a.max(b).max(c))
    }

    /// Corner `i` and the way from it to the next one.
    pub(crate) fn edge(&self, i: usize) -> (DVec2, DVec2) {
        let [p, q] = [i, (i + 1) % 3].map(|corner| self.corners[corner].truncate());
        (p, q - p)
    }

    /// Signed distance of a point to the left of edge `i`'s line in a mirrored image (y is down),
    /// times `winding`, plus what `leeway` adds to it. An edge without length constrains nothing:
    /// infinity.
    ///
    /// A point at share t of the edge sees its line move by |t| + |1 − t| times what the ends are
    /// off by. The line of an edge that is all noise still passes by its ends.
    pub(crate) fn inward(&self, i: usize, point: DVec2, winding: f64, leeway: f64) -> f64 {
        let (p, edge) = self.edge(i);
        let (to_point, length) = (point - p, edge.length());
        let noise = leeway.abs();
        if length <= NOISE * noise || length == 0.0 {
            return if leeway == 0.0 {
                f64::INFINITY
            } else {
                (to_point.length() + NOISE * noise).copysign(leeway)
            };
        }
        let share = to_point.dot(edge) / (length * length);
        let distance = winding * edge.perp_dot(to_point) / length;
        // The edge turns, too, which takes the turn's cosine from the distance.
        let turn = 2.0 * noise / (length - 2.0 * noise);
        let lever = (share.abs() + (1.0 - share).abs()) * (1.0 + turn);
        distance + leeway * lever + leeway.signum() * distance.abs() * turn * turn
    }

    /// Evaluates a condition on the inward distances from all edges for the triangle's winding, or
    /// for both where leeway leaves it open: either will do for what may be, both are needed for
    /// what surely is.
    fn holds(&self, point: DVec2, leeway: f64, condition: impl Fn([f64; 3]) -> bool) -> bool {
        let holds_for =
            |winding| condition([0, 1, 2].map(|i| self.inward(i, point, winding, leeway)));
        if !self.winding_is_open(leeway) {
            holds_for(if self.area() < 0.0 { -1.0 } else { 1.0 })
        } else if leeway > 0.0 {
            holds_for(1.0) || holds_for(-1.0)
        } else {
            holds_for(1.0) && holds_for(-1.0)
        }
    }

    /// Returns true if there is anything to shrink.
    fn has_inside(&self, leeway: f64) -> bool {
        leeway > 0.0 || self.area() != 0.0
    }

    /// Returns true if corners off by `leeway` may turn the triangle over.
    pub(crate) fn winding_is_open(&self, leeway: f64) -> bool {
        leeway != 0.0 && self.height() <= NOISE * leeway.abs()
    }

    /// Returns true if the triangle contains the point, its border included.
    pub fn contains(&self, point: DVec2, leeway: f64) -> bool {
        self.holds(point, leeway, |inward| inward.iter().all(|&d| d >= 0.0))
    }

    /// Returns true if the triangle grown by `cell` texels, cut to its box grown by half a texel
    /// and [`SLACK`], covers the texel around `centre`. With `cell` ≥ √½ that is every texel that
    /// the triangle overlaps (proof: the centre is no farther than √½ from a point of the triangle
    /// in the texel, and no farther than ½ per axis).
    pub fn outer_covers(&self, centre: DVec2, cell: f64, leeway: f64) -> bool {
        let (low, high) = self.bounds();
        let margin = DVec2::splat(0.5 + SLACK + leeway);
        centre.cmpge(low - margin).all()
            && centre.cmple(high + margin).all()
            && self.holds(centre, leeway, |inward| inward.iter().all(|&d| d >= -cell))
    }

    /// Returns true if the triangle shrunk by `cell` texels covers the texel around `centre`. With
    /// `cell` ≥ √½ it covers no texel that the triangle does not cover as a whole.
    pub fn inner_covers(&self, centre: DVec2, cell: f64, leeway: f64) -> bool {
        self.has_inside(leeway)
            && self.holds(centre, leeway, |inward| inward.iter().all(|&d| d >= cell))
    }

    /// Returns true if the triangle that shrinks at all edges but the `kept` ones, and is cut at
    /// corners between two of those, covers the texel around `centre`. Other than its neighbours, a
    /// triangle that meets such a corner alone is unknown, hence the cut, of a texel's diagonal at
    /// least: a corner in the texel may be half of one from either edge's line. This is no proof:
    /// see docs/methods.md.
    pub fn inner_adjacency_covers(
        &self,
        centre: DVec2,
        cell: f64,
        kept: [bool; 3],
        leeway: f64,
    ) -> bool {
        self.has_inside(leeway)
            && self.contains(centre, leeway)
            && self.inner_adjacency_conditions(centre, cell, kept, leeway)
    }

    /// [`inner_adjacency_covers`](Self::inner_adjacency_covers) for a centre that is known to be in
    /// the triangle.
    pub(crate) fn inner_adjacency_conditions(
        &self,
        centre: DVec2,
        cell: f64,
        kept: [bool; 3],
        leeway: f64,
    ) -> bool {
        let corner = cell.max(SQRT_2);
        self.holds(centre, leeway, |inward| {
            (0..3).all(|i| {
                let last = (i + 2) % 3;
                (kept[i] || inward[i] >= cell)
                    && !(kept[last] && kept[i] && inward[last] + inward[i] < corner)
            })
        })
    }

    /// Depth in the texel around `centre`: of the plane there, or a bound on the nearest (`end`
    /// −1) or farthest (1) point in the texel. `error` is what the corners may be off by; the depth
    /// itself is moved to the end of what that leaves open. Within 0 to 1.
    pub fn depth(&self, centre: DVec2, depth: Depth, end: f64, error: DepthError) -> f64 {
        let depths = self.corners.map(|corner| corner.z);
        let least = depths[0].min(depths[1]).min(depths[2]);
        let greatest = depths[0].max(depths[1]).max(depths[2]);
        let extreme = if end > 0.0 { greatest } else { least };
        let (height, longest, area) = (self.height(), self.longest(), self.area());
        // Rounded products of two edges are off by this, as a height.
        let height_error = NOISE * (error.across + F32_ROUNDING * longest);
        let of_corner = error.along(error.depth);
        let extreme = extreme + of_corner;
        let value = if area == 0.0 || height <= height_error {
            match depth {
                Depth::Plane => error.pick(0.0, 1.0, extreme),
                Depth::Conservative => extreme,
            }
        } else {
            let [a, b, c] = self.corners;
            let (p, q) = (b - a, c - a);
            let slope = DVec2::new(p.z * q.y - q.z * p.y, q.z * p.x - p.z * q.x) / area;
            let from_a = centre - a.truncate();
            let plane = a.z + slope.dot(from_a);
            let doubt = self.plane_doubt(centre, slope, greatest - least, error);
            match depth {
                Depth::Plane => plane + error.along(doubt),
                Depth::Conservative => {
                    let half_width = 0.5
                        + SLACK * (1.0 + 2.0 / height)
                        + AREA_ROUNDING * longest * longest / height;
                    let steepness = slope.x.abs() + slope.y.abs();
                    let tilt = steepness * (2.0 * half_width * height_error / height);
                    let bound = plane + end * half_width * steepness + error.along(doubt + tilt);
                    let bound = bound.clamp(least + of_corner, greatest + of_corner);
                    if height < LOWEST - height_error {
                        extreme
                    } else if height >= LOWEST + height_error {
                        bound
                    } else {
                        error.pick(extreme.min(bound), extreme.max(bound), bound)
                    }
                }
            }
        };
        value.clamp(0.0, 1.0)
    }

    /// Bounds the error of the plane's depth at a point: a corner moves it by its weight there, in
    /// the moved triangle, times the slope; then the f32 errors on the way, where areas are
    /// differences of products as long as the triangle.
    fn plane_doubt(&self, point: DVec2, slope: DVec2, range: f64, error: DepthError) -> f64 {
        if error.bound.is_none() {
            return 0.0;
        }
        let (area, height, longest) = (self.area(), self.height(), self.longest());
        let away = self
            .corners
            .map(|corner| (point - corner.truncate()).length())
            .into_iter()
            .fold(0.0, f64::max);
        let weights: f64 = (0..3)
            .map(|i| {
                let (p, edge) = self.edge(i);
                (edge.perp_dot(point - p) / area).abs()
            })
            .sum();
        // The weights in the moved triangle: its own area, and each corner's part of it, have moved
        // as well.
        let moved = error.across / height;
        let weights = (weights + 3.0 * moved * (1.0 + 2.0 * away / longest)) / (1.0 - 2.0 * moved);
        weights * (slope.length() * error.across + error.depth)
            + NOISE
                * F32_ROUNDING
                * away
                * (slope.length() * (1.0 + longest / height) + range / height)
    }
}

/// Error bounds of a depth.
#[derive(Clone, Copy, Debug, Default)]
pub struct DepthError {
    /// Error bound of each corner across, texels.
    pub across: f64,
    /// Error bound of each corner's depth.
    pub depth: f64,
    /// Which end of what these leave open; `None`: they are 0.
    pub bound: Option<Bound>,
}

impl DepthError {
    /// `amount` towards the end that is asked for.
    fn along(self, amount: f64) -> f64 {
        match self.bound {
            None => 0.0,
            Some(Bound::Low) => -amount,
            Some(Bound::High) => amount,
        }
    }

    /// The low value, the high one, or the exact one.
    fn pick(self, low: f64, high: f64, exact: f64) -> f64 {
        match self.bound {
            None => exact,
            Some(Bound::Low) => low,
            Some(Bound::High) => high,
        }
    }
}
