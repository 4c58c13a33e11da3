//! The patch of a texel: the triangle at its centre and those of its one-ring that it takes to
//! cover the texel, without holes and folds.
//!
//! Proof. Each edge of a member that overlaps the texel has a member on either side, apart as the
//! light sees them; so the number of members over a point of the texel does not change across
//! edges, is the same all over the texel, and is 1 at the centre. Moving corners by less than
//! [`SLACK`] keeps the patch's border off the texel and with it the patch's winding number there,
//! which is odd: some member covers each point.

use super::{bounds::SLACK, casters::Casters, triangle::TexelTriangle};
use glam::DVec2;

/// Triangles of a patch; a texel that needs more is not covered.
const MOST_MEMBERS: usize = 16;

/// The members of a patch.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    members: [u32; MOST_MEMBERS],
    count: usize,
}

impl Patch {
    /// Primitive ids, the first triangle's first.
    pub fn members(&self) -> &[u32] {
        &self.members[..self.count]
    }

    fn add(&mut self, primitive: u32) -> Option<()> {
        if !self.members().contains(&primitive) {
            *self.members.get_mut(self.count)? = primitive;
            self.count += 1;
        }
        Some(())
    }
}

impl Casters<'_> {
    /// The patch around a texel's centre that begins with a primitive that contains it, and whose
    /// members contain it exactly once; `None` if it is not whole. `leeway` as for
    /// [`TexelTriangle`].
    pub fn patch(&self, first: u32, centre: DVec2, leeway: f64) -> Option<Patch> {
        self.patch_across(first, centre, leeway, |primitive, edge| {
            self.adjacent_triangle(primitive, edge, leeway)
        })
    }

    /// [`patch`](Self::patch) with the triangle beyond each edge given.
    pub(crate) fn patch_across(
        &self,
        first: u32,
        centre: DVec2,
        leeway: f64,
        beyond: impl Fn(u32, usize) -> Option<u32>,
    ) -> Option<Patch> {
        let mut patch = Patch {
            members: [first; MOST_MEMBERS],
            count: 1,
        };
        let ring = self.mesh.triangles[first as usize];
        let mut next = 0;
        while next < patch.count {
            let member = patch.members[next];
            next += 1;
            for edge in 0..3 {
                if !edge_overlaps_texel(self.triangle(member), edge, centre, leeway) {
                    continue;
                }
                let neighbour = beyond(member, edge)?;
                let corners = self.mesh.triangles[neighbour as usize];
                if !corners.iter().any(|corner| ring.contains(corner)) {
                    return None;
                }
                patch.add(neighbour)?;
            }
        }
        self.contains_once(&patch, centre, leeway).then_some(patch)
    }

    /// Returns true if exactly one member contains the centre. On an edge between two of them one
    /// does, whichever arithmetic says so, because both see the same sign; near a corner the signs
    /// of several edges may not fit together.
    fn contains_once(&self, patch: &Patch, centre: DVec2, leeway: f64) -> bool {
        let members = || patch.members().iter();
        if leeway == 0.0 {
            return members().filter(|&&p| self.contains(p, centre)).count() == 1;
        }
        let within = |leeway| {
            members()
                .filter(move |&&p| self.triangle(p).contains(centre, leeway))
                .count()
        };
        let (surely, perhaps) = (within(-leeway.abs()), within(leeway.abs()));
        if leeway > 0.0 {
            return surely <= 1 && perhaps >= 1;
        }
        perhaps == 1 && surely == 1 || perhaps == 2 && surely == 0
    }

    /// Returns true if a primitive contains a point; of two that lie on opposite sides of an edge
    /// through the point, one does.
    fn contains(&self, primitive: u32, point: DVec2) -> bool {
        let indices = self.mesh.triangles[primitive as usize];
        let triangle = self.triangle(primitive);
        let left = [0, 1, 2].map(|i| {
            let [p, q] = [i, (i + 1) % 3];
            let swap = indices[q] < indices[p];
            let (low, high) = if swap { (q, p) } else { (p, q) };
            let [low, high] = [low, high].map(|corner| triangle.corners[corner].truncate());
            ((high - low).perp_dot(point - low) >= 0.0) != swap
        });
        left[0] == left[1] && left[1] == left[2]
    }
}

/// Returns true if an edge overlaps the closed texel around `centre` grown by [`SLACK`]. Separating
/// axes of a segment and a square. An overlap stands against covering the texel, so leeway makes
/// the texel smaller.
fn edge_overlaps_texel(triangle: &TexelTriangle, edge: usize, centre: DVec2, leeway: f64) -> bool {
    let half = 0.5 + SLACK - 2.0 * leeway;
    let (p, along) = triangle.edge(edge);
    let (from, to) = (p - centre, p + along - centre);
    from.min(to).max_element() <= half
        && from.max(to).min_element() >= -half
        && along.perp_dot(from).abs() <= half * (along.x.abs() + along.y.abs())
}
