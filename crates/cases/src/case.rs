//! Describes one stress case, and builds its scene.

use crate::shape::{Block, Seen, Shape};
use serde::{Deserialize, Serialize};
use skiagraph_scene::Scene;

/// Stress case of the catalogue: a small scene on which shadow methods go wrong, with the
/// conditions that its ground truth must meet.
#[derive(Clone, Copy, Debug)]
pub struct HardCase {
    /// Name of the case on the command line: lower case, words joined by `_`.
    pub name: &'static str,
    /// Difficulty of the scene, or the error that it provokes in shadow methods, as one line of
    /// text.
    pub reason: &'static str,
    /// Kind of the scene's casters. On open casters, a method that culls front faces is also tested
    /// without culling.
    pub casters: Casters,
    pub(crate) seen: Seen,
    pub(crate) geometry: Geometry,
    change: fn(&mut Scene),
    indeterminate: Indeterminate,
}

/// Bound on the indeterminate pixels of a case.
#[derive(Clone, Copy, Debug)]
enum Indeterminate {
    /// A share of the pixels that face the light, 0 to 1.
    Share(f64),
    /// Those along the shadows' edges of a scene far from the origin.
    Edges(Edges),
}

/// Edges of shadows in a scene whose positions f32 rounds by whole parts of a pixel: within a strip
/// around each edge rounding decides.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edges {
    /// Distance of the scene from the origin along each axis, scene units.
    pub offset: f32,
    /// Half the width of a strip, in units in the last place of `offset`.
    pub roundings: f64,
    /// Length of all edges in the picture, in heights of it.
    pub length: f64,
    /// Height of the picture at the edges' distance, scene units.
    pub height: f64,
}

impl Edges {
    /// Returns the most pixels that may lie in the strips of a picture that is `rows` pixels high.
    ///
    /// The edges cross `length * rows` rows or columns of pixels, and in each of them a strip is
    /// `width` pixels wide. It holds so many pixel centres in the mean, rounded up or down, as the
    /// edge passes through the grid of pixels in ever other places. Of a number that is rounded up
    /// or down the standard deviation is at most a half, and three of the sum's are allowed.
    fn most(&self, rows: u32) -> f64 {
        let spacing = f64::from(self.offset.next_up() - self.offset);
        let width = 2.0 * self.roundings * spacing / (self.height / f64::from(rows));
        let across = self.length * f64::from(rows);
        width * across + 3.0 * 0.5 * across.sqrt()
    }
}

/// Triangles of a case.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Geometry {
    Drawn(fn() -> Shape),
    Boxes(&'static [Block]),
}

/// Kind of the casters in a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Casters {
    /// Closed surfaces wound outward that do not pass through each other: no lit surface is its own
    /// caster when front faces are culled.
    Closed,
    /// Sheets, surfaces wound both ways, or solids that pass through each other: some of them cast
    /// no shadow when front faces are culled.
    Open,
}

impl HardCase {
    /// Creates a case of closed casters, with at most 1 % indeterminate pixels.
    pub(crate) const fn closed(
        name: &'static str,
        reason: &'static str,
        seen: Seen,
        shape: fn() -> Shape,
    ) -> Self {
        Self {
            name,
            reason,
            casters: Casters::Closed,
            seen,
            geometry: Geometry::Drawn(shape),
            change: |_| {},
            indeterminate: Indeterminate::Share(0.01),
        }
    }

    /// Creates a case of closed boxes.
    pub(crate) const fn boxes(
        name: &'static str,
        reason: &'static str,
        seen: Seen,
        blocks: &'static [Block],
    ) -> Self {
        Self {
            geometry: Geometry::Boxes(blocks),
            ..Self::closed(name, reason, seen, Shape::default)
        }
    }

    /// Creates a case of open casters; otherwise as [`closed`](Self::closed).
    pub(crate) const fn open(
        name: &'static str,
        reason: &'static str,
        seen: Seen,
        shape: fn() -> Shape,
    ) -> Self {
        Self {
            casters: Casters::Open,
            ..Self::closed(name, reason, seen, shape)
        }
    }

    /// Returns the case with a function that changes its scene after it is built.
    pub(crate) const fn changed(mut self, change: fn(&mut Scene)) -> Self {
        self.change = change;
        self
    }

    /// Returns the case with another share, 0 to 1, of pixels that may be indeterminate.
    pub(crate) const fn indeterminate_up_to(mut self, share: f64) -> Self {
        self.indeterminate = Indeterminate::Share(share);
        self
    }

    /// Returns the case as one whose indeterminate pixels lie along the edges of shadows.
    pub(crate) const fn indeterminate_along(mut self, edges: Edges) -> Self {
        self.indeterminate = Indeterminate::Edges(edges);
        self
    }

    /// Returns the largest allowed share of indeterminate pixels among the `facing` pixels that
    /// face the light, in a picture that is `rows` pixels high. A pixel is indeterminate if
    /// rounding to f32 may flip its answer.
    pub fn indeterminate_cap(&self, rows: u32, facing: u64) -> f64 {
        match self.indeterminate {
            Indeterminate::Share(share) => share,
            Indeterminate::Edges(edges) => edges.most(rows) / facing.max(1) as f64,
        }
    }

    /// Builds the scene of the case: its mesh, its view `main` and its light.
    pub fn scene(&self) -> Scene {
        let shape = match self.geometry {
            Geometry::Drawn(draw) => draw(),
            Geometry::Boxes(blocks) => Shape::default().cuboids(blocks),
        };
        let mut scene = shape.scene(self.seen);
        scene.name = self.name.into();
        (self.change)(&mut scene);
        scene
    }
}
