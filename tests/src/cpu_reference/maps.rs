//! The layers of a shadow map, texel by texel without a rasteriser: the least and the greatest
//! depth that the GPU's may hold.

use super::{
    bounds::{Bound, SLACK},
    casters::Casters,
    preset::Depth,
    triangle::{DepthError, TexelTriangle},
};
use glam::DVec2;
use rayon::prelude::*;
use std::f64::consts::SQRT_2;

/// Rows that one task draws; each goes through all triangles.
const ROWS: usize = 16;

/// Content of a layer for each triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Layer {
    /// Texels whose centre it contains, at its plane's depth: a standard shadow map.
    Centres,
    /// Outer conservative depth: texels that it covers grown by so many texel diagonals (BGSM).
    Outer(f64, Depth),
    /// Inner conservative depth: texels that it covers shrunk (SGSM of `crsm`).
    Inner(f64, Depth),
    /// Texels that it covers shrunk at edges without an adjacent triangle (SGSM of `crsma`).
    InnerAdjacency(f64, Depth),
    /// Texels whose centre it contains and that it covers with its one-ring (SGSM of `crsma_full`).
    InnerOneRing(Depth),
}

/// One layer: the nearest depth of any triangle per texel, infinity for nothing; rows from the top.
#[derive(Clone, Debug)]
pub struct Map {
    size: usize,
    low: Vec<f64>,
    high: Vec<f64>,
}

impl Map {
    /// Draws a layer, with all cores. Takes 16 bytes per texel.
    pub fn draw(casters: &Casters, layer: Layer) -> Self {
        let size = casters.space.size() as usize;
        let mut low = vec![f64::INFINITY; size * size];
        let mut high = low.clone();
        let drawing = Drawing::new(casters, layer);
        low.par_chunks_mut(ROWS * size)
            .zip(high.par_chunks_mut(ROWS * size))
            .enumerate()
            .for_each(|(chunk, (low, high))| {
                let first = chunk * ROWS;
                for primitive in 0..casters.triangles.len() as u32 {
                    let last = first + low.len() / size;
                    drawing.texels(primitive, [first, last], |x, y, centre| {
                        let index = (y - first) * size + x;
                        if let Some(depth) = drawing.low(primitive, centre) {
                            low[index] = low[index].min(depth);
                        }
                        if let Some(depth) = drawing.high(primitive, centre) {
                            high[index] = high[index].min(depth);
                        }
                    });
                }
            });
        Self { size, low, high }
    }

    /// The least depth that the texel may hold.
    ///
    /// # Panics
    /// If x or y is not below the map's size.
    pub fn low(&self, [x, y]: [usize; 2]) -> f64 {
        self.low[y * self.size + x]
    }

    /// The greatest depth that the texel may hold.
    ///
    /// # Panics
    /// If x or y is not below the map's size.
    pub fn high(&self, [x, y]: [usize; 2]) -> f64 {
        self.high[y * self.size + x]
    }
}

/// Where a point lies for a rasteriser that may have moved the triangle's corners.
enum Place {
    Inside,
    /// So near to this edge, and to no other, that it may be on either side.
    OnEdge(usize),
    Elsewhere,
}

struct Drawing<'a> {
    casters: &'a Casters<'a>,
    layer: Layer,
    /// Leeway of the layer's own conditions, texels.
    across: f64,
    /// Leeway of what the rasteriser decides, texels.
    raster: f64,
}

impl<'a> Drawing<'a> {
    fn new(casters: &'a Casters<'a>, layer: Layer) -> Self {
        Self {
            casters,
            layer,
            across: casters.space.across_error(),
            raster: casters.space.raster_error(),
        }
    }

    /// Leeway of what culls a triangle and gives it its depth: a rasteriser or a shader.
    fn drawn(&self) -> f64 {
        match self.layer {
            Layer::Centres => self.raster,
            _ => self.across,
        }
    }

    /// How far beyond its corners a triangle may cover texels, by their centres.
    fn overhang(&self) -> f64 {
        match self.layer {
            Layer::Outer(..) => 0.5 + SLACK + self.across,
            _ => self.raster,
        }
    }

    /// Visits the texels of some rows that a triangle may cover.
    fn texels(&self, primitive: u32, rows: [usize; 2], mut visit: impl FnMut(usize, usize, DVec2)) {
        if !self.casters.casts(primitive, self.drawn()) {
            return;
        }
        let (low, high) = self.casters.triangle(primitive).bounds();
        let overhang = self.overhang() + 0.5;
        // First and one past the last; casts saturate.
        let first = |low: f64| (low - overhang).ceil() as usize;
        let last = |high: f64| (high + overhang).floor().max(0.0) as usize;
        for y in first(low.y).max(rows[0])..last(high.y).min(rows[1]) {
            for x in first(low.x)..last(high.x).min(self.casters.space.size() as usize) {
                visit(x, y, DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
            }
        }
    }

    /// Returns true if the layer's coverage depends on the rasteriser.
    fn by_rasteriser(&self) -> bool {
        !matches!(self.layer, Layer::Outer(..) | Layer::Inner(..))
    }

    fn low(&self, primitive: u32, centre: DVec2) -> Option<f64> {
        let triangle = self.casters.triangle(primitive);
        if self.by_rasteriser() && !triangle.contains(centre, self.raster) {
            return None;
        }
        self.covered(primitive, centre, Bound::Low)
    }

    /// A centre on an edge with an adjacent triangle is covered by one of the two, if both would
    /// cover it.
    fn high(&self, primitive: u32, centre: DVec2) -> Option<f64> {
        if !self.casters.casts(primitive, -self.drawn()) {
            return None;
        }
        let covered = || self.covered(primitive, centre, Bound::High);
        if !self.by_rasteriser() {
            return covered();
        }
        match self.place(primitive, centre) {
            Place::Inside => covered(),
            Place::OnEdge(edge) => {
                let neighbour = self.casters.adjacent(primitive, Bound::High)[edge]?;
                let beyond = match self.place(neighbour, centre) {
                    Place::OnEdge(_) => self.covered(neighbour, centre, Bound::High)?,
                    Place::Inside | Place::Elsewhere => return None,
                };
                Some(covered()?.max(beyond))
            }
            Place::Elsewhere => None,
        }
    }

    fn place(&self, primitive: u32, centre: DVec2) -> Place {
        let triangle = self.casters.triangle(primitive);
        if triangle.contains(centre, -self.raster) {
            return Place::Inside;
        }
        let winding = triangle.area().signum();
        if triangle.winding_is_open(self.raster) {
            return Place::Elsewhere;
        }
        let sides = |leeway| [0, 1, 2].map(|i| triangle.inward(i, centre, winding, leeway) >= 0.0);
        let (surely, perhaps) = (sides(-self.raster), sides(self.raster));
        let open: Vec<usize> = (0..3).filter(|&i| !surely[i]).collect();
        match open[..] {
            [edge] if perhaps[edge] => Place::OnEdge(edge),
            _ => Place::Elsewhere,
        }
    }

    /// The depth at which a triangle covers a texel, given that it contains the centre if that is
    /// the rasteriser's affair.
    fn covered(&self, primitive: u32, centre: DVec2, bound: Bound) -> Option<f64> {
        let triangle = self.casters.triangle(primitive);
        let leeway = bound.leeway(self.across);
        let cell = |n: f64| n * SQRT_2;
        let adjacent = || self.casters.adjacent(primitive, bound);
        let farthest = |depth| Some(self.depth(triangle, centre, depth, 1.0, bound));
        match self.layer {
            Layer::Centres => farthest(Depth::Plane),
            Layer::Outer(n, depth) => triangle
                .outer_covers(centre, cell(n), leeway)
                .then(|| self.depth(triangle, centre, depth, -1.0, bound)),
            Layer::Inner(n, depth) if triangle.inner_covers(centre, cell(n), leeway) => {
                farthest(depth)
            }
            Layer::InnerAdjacency(n, depth) => {
                let kept = adjacent().map(|neighbour| neighbour.is_some());
                let covers = triangle.inner_adjacency_conditions(centre, cell(n), kept, leeway);
                covers.then(|| farthest(depth)).flatten()
            }
            Layer::Inner(..) => None,
            Layer::InnerOneRing(depth) => {
                let beyond = |primitive, edge: usize| self.casters.adjacent(primitive, bound)[edge];
                let patch = self
                    .casters
                    .patch_across(primitive, centre, leeway, beyond)?;
                let members = match depth {
                    Depth::Plane => &patch.members()[..1],
                    Depth::Conservative => patch.members(),
                };
                let member_depth =
                    |&p: &u32| self.depth(self.casters.triangle(p), centre, depth, 1.0, bound);
                Some(members.iter().map(member_depth).fold(0.0, f64::max))
            }
        }
    }

    fn depth(
        &self,
        triangle: &TexelTriangle,
        centre: DVec2,
        depth: Depth,
        end: f64,
        bound: Bound,
    ) -> f64 {
        let error = DepthError {
            across: self.drawn(),
            depth: self.casters.space.depth_error(),
            bound: Some(bound),
        };
        let value = triangle.depth(centre, depth, end, error);
        if self.layer != Layer::Centres {
            return value;
        }
        // A rasteriser interpolates: within the triangle's own depths.
        let depths = triangle.corners.map(|corner| corner.z);
        let doubt = error.depth;
        value.clamp(
            depths.iter().copied().fold(f64::INFINITY, f64::min) - doubt,
            depths.iter().copied().fold(f64::NEG_INFINITY, f64::max) + doubt,
        )
    }
}
