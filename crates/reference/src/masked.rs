//! Masked triangles: whether a hit is one, and whether f32 may take it for another.

use crate::error_bound::F32_ROUNDING;
use glam::DVec2;
use skiagraph_scene::Mesh;
use skiagraph_scene::mask::{Asked, Mask};

/// Roundings of a texture coordinate that is interpolated in f32, in units of the largest
/// coordinate of the corners: two differences, two products, two sums and the weights' own
/// divisions (2.5 each).
const UV_ROUNDINGS: f64 = 16.0;

/// Roundings of a wrapped coordinate on its way to a texel, in units of the whole texture.
const TEXEL_ROUNDINGS: f64 = 4.0;

/// Error of a shader's edge functions, in units of the error that [`FuzzyRay`] assumes: it counts 8
/// roundings of the corners, their products and the bound within which a shader takes an edge
/// function for 0 are 6 more.
///
/// [`FuzzyRay`]: crate::contact::FuzzyRay
const EDGE_ERROR: f64 = 1.75;

/// The mask of a triangle with its texture coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Masked<'a> {
    mask: &'a Mask,
    uvs: [DVec2; 3],
}

impl<'a> Masked<'a> {
    /// Returns the mask of a triangle that has one.
    pub(crate) fn new(mesh: &'a Mesh, primitive: u32) -> Option<Self> {
        let mask = mesh.surfaces.mask(primitive)?;
        let uvs = mesh.surfaces.corner_uvs(primitive).map(|uv| uv.as_dvec2());
        Some(Self { mask, uvs })
    }

    /// Returns true if it is opaque at the weights of its corners.
    pub(crate) fn is_opaque(&self, weights: [f64; 3]) -> bool {
        self.mask.ask(self.uv(weights), DVec2::ZERO).opaque
    }

    /// Asks it where edge functions are `edges`, each off by up to `errors`.
    pub(crate) fn ask(&self, edges: [f64; 3], errors: [f64; 3]) -> Asked {
        let determinant: f64 = edges.iter().sum();
        let errors = errors.map(|error| EDGE_ERROR * error);
        let least = determinant.abs() - errors.iter().sum::<f64>();
        if least <= 0.5 * determinant.abs() {
            let opaque = determinant != 0.0 && self.is_opaque(edges.map(|it| it / determinant));
            return Asked {
                opaque,
                flips: true,
            };
        }
        let uv = self.uv(edges.map(|edge| edge / determinant));
        let corners = self.uvs.iter().zip(errors);
        let moved = corners.map(|(corner, error)| (*corner - uv).abs() * (error / least));
        let moved: DVec2 = moved.sum();
        let uvs = self.uvs.iter();
        let largest = uvs.fold(DVec2::ZERO, |most, uv| most.max(uv.abs()));
        let rounded = largest * (UV_ROUNDINGS * F32_ROUNDING) + TEXEL_ROUNDINGS * F32_ROUNDING;
        self.mask.ask(uv, moved + rounded)
    }

    fn uv(&self, [_, b, c]: [f64; 3]) -> DVec2 {
        let [uv_a, uv_b, uv_c] = self.uvs;
        uv_a + (uv_b - uv_a) * b + (uv_c - uv_a) * c
    }
}
