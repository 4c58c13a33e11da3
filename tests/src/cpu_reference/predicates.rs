//! CPU reference of `shaders/shared/predicates.wgsl` in f32, under an [`Arithmetic`]: which bounds
//! hold under which is in docs/precision.md. Points are (x, y); names are the shader's.
//! `receiver_error_bound` is tested on receivers: tests/it/receivers.rs.

pub use super::arithmetic::Arithmetic;

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
    /// `cross_2d`.
    pub fn cross_2d(self, p: Point, q: Point) -> f32 {
        self.products([p[0], q[1]], [p[1], q[0]])
    }

    /// `edge_area`: twice the signed area of the origin, p and q, 0 where rounding could decide its
    /// sign.
    pub fn edge_area(self, p: Point, q: Point) -> f32 {
        let swap = q[0] < p[0] || (q[0] == p[0] && q[1] < p[1]);
        let (lesser, greater) = if swap { (q, p) } else { (p, q) };
        let area = self.cross_2d(lesser, greater);
        let product = self.mul(lesser[0], greater[1]);
        if area.abs() > self.mul(EDGE_ERROR, product.abs()) {
            if swap { -area } else { area }
        } else {
            0.0
        }
    }

    /// Returns true if a triangle around the origin, edges and corners included, would be hit:
    /// `intersect` of `ray_triangle.wgsl` but for the distance.
    pub fn hits(self, corners: [Point; 3]) -> bool {
        Self::hits_by([self; 3], corners)
    }

    /// The same where each edge is evaluated by an arithmetic of its own.
    pub fn hits_by([bc, ca, ab]: [Self; 3], [a, b, c]: [Point; 3]) -> bool {
        let weights = [(bc, b, c), (ca, c, a), (ab, a, b)].map(|(by, p, q)| by.edge_area(p, q));
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
            p[axis].min(q[axis]) > self.add(centre[axis], half)
                || p[axis].max(q[axis]) < self.sub(centre[axis], half)
        };
        if beyond(0) || beyond(1) {
            return false;
        }
        let edge = self.minus(q, p);
        self.cross_2d(edge, self.minus(centre, p)).abs()
            <= self.mul(half, self.add(edge[0].abs(), edge[1].abs()))
    }

    /// `inward_distance` of a point from the line of an edge of a triangle of that area; 3e38 for
    /// an edge without length. `inverseSqrt` is taken to err by `ulps`, of which WGSL allows it 2.
    pub fn inward_distance(self, [p, q]: [Point; 2], point: Point, area: f32, ulps: i32) -> f32 {
        let edge = self.minus(q, p);
        let length_squared = self.cross_2d(edge, [-edge[1], edge[0]]);
        if length_squared == 0.0 {
            return 3e38;
        }
        let inverse = (1.0 / f64::from(length_squared).sqrt()) as f32;
        let inverse = f32::from_bits(inverse.to_bits().wrapping_add_signed(ulps));
        let across = self.cross_2d(edge, self.minus(point, p));
        self.mul(if area < 0.0 { -across } else { across }, inverse)
    }

    /// `side_of_edge`: 1 to the left of the line from p to q, -1 to the right, 0 if nearer to it
    /// than [`CLEAR_OF_EDGE`].
    pub fn side_of_edge(self, [p, q]: [Point; 2], point: Point) -> f32 {
        let edge = self.minus(q, p);
        let across = self.cross_2d(edge, self.minus(point, p));
        let length = self.sqrt(self.cross_2d(edge, [-edge[1], edge[0]]));
        if across.abs() > self.mul(CLEAR_OF_EDGE, length) {
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
        (self.cross_2d(self.minus(high, low), self.minus(point, low)) >= 0.0) != swap
    }

    fn minus(self, p: Point, q: Point) -> Point {
        [self.sub(p[0], q[0]), self.sub(p[1], q[1])]
    }

    /// `receiver_error_bound`: what rounding may have moved a receiver out of its plane, so that
    /// its shadow ray meets its own surface beyond an edge.
    pub fn receiver_error_bound(self, receiver: [f32; 3], eye: [f32; 3]) -> f32 {
        let way = [0, 1, 2].map(|i| self.sub(receiver[i], eye[i]));
        let sum = self.add(self.length(receiver), self.mul(2.0, self.length(way)));
        self.mul(HALF_ULP, sum)
    }
}

/// `bbox_contains`: whether the box around three points has the origin in it.
pub fn bbox_contains(points: [Point; 3]) -> bool {
    (0..2)
        .all(|axis| points.iter().any(|p| p[axis] <= 0.0) && points.iter().any(|p| p[axis] >= 0.0))
}

#[cfg(test)]
mod tests;
