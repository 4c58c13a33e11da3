//! CPU reference of `shaders/shared/predicates.wgsl` in f32, under the arithmetics of
//! [`Arithmetic`], which are not all that WGSL allows a compiler (docs/precision.md): what the
//! bounds stated there are tested with. Points are (x, y); names are the shader's.
//! `receiver_error_bound` is tested on receivers: tests/it/receivers.rs.

use glam::Vec3;

/// How a·b − c·d is evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arithmetic {
    /// Every operation rounded.
    Rounded,
    /// The first product goes into the difference unrounded.
    FirstFused,
    /// The second one does.
    SecondFused,
    /// Every operation rounded, subnormal results flushed to zero.
    Flushed,
}

/// Half an ulp of 1.
pub const HALF_ULP: f32 = 1.0 / (1u32 << 24) as f32;

/// Share of a product below which the difference of two counts as 0.
pub const EDGE_ERROR: f32 = 4.0 * HALF_ULP;

/// By how much a texel is taken larger than it is, on every side.
pub const SLACK: f32 = 1.0 / 128.0;

/// Points nearer to an edge's line than this, in texels, are on no side of it.
pub const CLEAR_OF_EDGE: f32 = 1.0 / 240.0;

type Point = [f32; 2];

impl Arithmetic {
    /// All of them.
    pub const ALL: [Self; 4] = [
        Self::Rounded,
        Self::FirstFused,
        Self::SecondFused,
        Self::Flushed,
    ];

    fn flush(self, value: f32) -> f32 {
        if self == Self::Flushed && value.is_subnormal() {
            0.0
        } else {
            value
        }
    }

    /// a · b − c · d.
    fn products(self, [a, b]: Point, [c, d]: Point) -> f32 {
        match self {
            Self::FirstFused => a.mul_add(b, -(c * d)),
            Self::SecondFused => (-c).mul_add(d, a * b),
            Self::Rounded | Self::Flushed => self.flush(self.flush(a * b) - self.flush(c * d)),
        }
    }

    /// `cross_2d`.
    pub fn cross(self, p: Point, q: Point) -> f32 {
        self.products([p[0], q[1]], [p[1], q[0]])
    }

    /// `edge_area`: twice the signed area of the origin, p and q, 0 where rounding could decide its
    /// sign.
    pub fn edge_area(self, p: Point, q: Point) -> f32 {
        let swap = q[0] < p[0] || (q[0] == p[0] && q[1] < p[1]);
        let (lesser, greater) = if swap { (q, p) } else { (p, q) };
        let area = self.cross(lesser, greater);
        if area.abs() > EDGE_ERROR * self.flush(lesser[0] * greater[1]).abs() {
            if swap { -area } else { area }
        } else {
            0.0
        }
    }

    /// Whether a triangle around the origin, edges and corners included, would be hit: `intersect`
    /// of `trace_rays.wgsl` but for the distance.
    pub fn hits(self, [a, b, c]: [Point; 3]) -> bool {
        let weights = [(b, c), (c, a), (a, b)].map(|(p, q)| self.edge_area(p, q));
        if weights.iter().any(|&w| w < 0.0) && weights.iter().any(|&w| w > 0.0) {
            return false;
        }
        if weights.contains(&0.0) && !bbox_contains([a, b, c]) {
            return false;
        }
        weights.iter().any(|&w| w != 0.0)
    }

    /// `edge_overlaps_texel`: whether an edge overlaps the texel around `centre`, taken larger by
    /// [`SLACK`].
    pub fn edge_overlaps_texel(self, p: Point, q: Point, centre: Point) -> bool {
        let half = 0.5 + SLACK;
        let beyond = |axis: usize| {
            p[axis].min(q[axis]) > centre[axis] + half || p[axis].max(q[axis]) < centre[axis] - half
        };
        if beyond(0) || beyond(1) {
            return false;
        }
        let edge = minus(q, p);
        self.cross(edge, minus(centre, p)).abs() <= half * (edge[0].abs() + edge[1].abs())
    }

    /// `inward_distance` of a point from the line of an edge of a triangle of that area; 3e38 for
    /// an edge without length. `inverseSqrt` is taken to err by `ulps`, of which WGSL allows it 2.
    pub fn inward_distance(self, [p, q]: [Point; 2], point: Point, area: f32, ulps: i32) -> f32 {
        let edge = minus(q, p);
        let length_squared = self.cross(edge, [-edge[1], edge[0]]);
        if length_squared == 0.0 {
            return 3e38;
        }
        let inverse = (1.0 / f64::from(length_squared).sqrt()) as f32;
        let inverse = f32::from_bits(inverse.to_bits().wrapping_add_signed(ulps));
        (if area < 0.0 { -1.0 } else { 1.0 }) * self.cross(edge, minus(point, p)) * inverse
    }

    /// `side_of_edge`: 1 to the left of the line from p to q, -1 to the right, 0 if nearer to it
    /// than [`CLEAR_OF_EDGE`].
    pub fn side_of_edge(self, [p, q]: [Point; 2], point: Point) -> f32 {
        let edge = minus(q, p);
        let across = self.cross(edge, minus(point, p));
        let length = self.cross(edge, [-edge[1], edge[0]]).sqrt();
        if across.abs() > CLEAR_OF_EDGE * length {
            across.signum()
        } else {
            0.0
        }
    }

    /// `left_of`: whether a point is to the left of the edge from p, number `tail`, to q, number
    /// `head`.
    pub fn left_of(self, [tail, head]: [u32; 2], [p, q]: [Point; 2], point: Point) -> bool {
        let swap = head < tail;
        let (low, high) = if swap { (q, p) } else { (p, q) };
        (self.cross(minus(high, low), minus(point, low)) >= 0.0) != swap
    }
}

fn minus(p: Point, q: Point) -> Point {
    [p[0] - q[0], p[1] - q[1]]
}

/// `receiver_error_bound`: what rounding may have moved a receiver out of its plane, so that its
/// shadow ray meets its own surface beyond an edge.
pub fn receiver_error_bound(receiver: Vec3, eye: Vec3) -> f32 {
    HALF_ULP * (receiver.length() + 2.0 * (receiver - eye).length())
}

/// `bbox_contains`: whether the box around three points has the origin in it.
pub fn bbox_contains(points: [Point; 3]) -> bool {
    (0..2)
        .all(|axis| points.iter().any(|p| p[axis] <= 0.0) && points.iter().any(|p| p[axis] >= 0.0))
}

#[cfg(test)]
mod tests;
