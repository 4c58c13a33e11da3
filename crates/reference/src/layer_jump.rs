//! Jump of the error where two layers of a shadow map meet: at the planes between the splits of the
//! eye's frustum, or at the edges of a cube's faces.

use crate::error::Error;
use crate::ground_truth::GroundTruthPixels;
use crate::image::error;
use crate::pixels::check_pixel_count;
use crate::shimmer::{Seen, Surface};
use serde::{Deserialize, Serialize};

/// Differences in error between neighbouring pixels, where two layers of a shadow map (cascades or
/// cube faces) meet and elsewhere. They show if a cascade or cube map has visible seams.
///
/// A *pair* is two pixels beside or below each other that face the light, are not indeterminate,
/// and show one surface: the receiver of each lies within a pixel's width of the plane of the
/// other's primitive. An object before a far wall thus makes no pair with the wall. A pair lies
/// *across* a border if the method looks its pixels up in different layers of the map, else
/// *elsewhere*. The error of a pixel is the share of light that it shows minus the reference's. The
/// difference of a pair is the size of the difference of its two errors, 0 to 2; for hard shadows
/// it is 1 where one of the two pixels is wrong.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LayerJump {
    /// Number of pairs of neighbouring pixels that lie across a border between layers of the shadow
    /// map.
    pub pairs: u64,
    /// Mean difference in error of the pairs of neighbouring pixels across a border between layers,
    /// 0 to 2.
    pub across: f64,
    /// Number of pairs of neighbouring pixels that lie within one layer of the shadow map.
    pub pairs_elsewhere: u64,
    /// Mean difference in error of the pairs of neighbouring pixels within one layer, 0 to 2; 0 if
    /// there are none.
    pub elsewhere: f64,
}

impl LayerJump {
    /// Measures the jump in a picture. `seen` is the picture's mesh, camera and G-buffer. `shown`
    /// and `shares` are the shares of light that the method shows and those of the reference;
    /// `layers` is the index of the map layer in which the method looks each pixel up. `truth`
    /// tells which pixels face the light and are not indeterminate. Each list has one entry per
    /// pixel, row by row from the top left. Returns `None` if no pair lies across a border.
    ///
    /// # Errors
    /// [`Error::PixelCount`] if a list does not have one entry per pixel of `truth`.
    pub fn measured(
        seen: Seen,
        [shown, shares]: [&[f32]; 2],
        layers: &[u32],
        truth: &GroundTruthPixels,
    ) -> Result<Option<Self>, Error> {
        check_pixel_count("primitives", truth.viewport, seen.primitives.len())?;
        check_pixel_count("visibility", truth.viewport, shown.len())?;
        check_pixel_count("shares", truth.viewport, shares.len())?;
        check_pixel_count("map_layer", truth.viewport, layers.len())?;
        let is_judged =
            |pixel: usize| truth.classes[pixel].faces_light() && !truth.indeterminate[pixel];
        let surface = |pixel: usize| is_judged(pixel).then(|| seen.surface(pixel))?;
        let surfaces: Vec<_> = (0..truth.classes.len()).map(surface).collect();
        let width = truth.viewport[0] as usize;
        let pixel_width = seen.pixel_area().sqrt();
        let mut jump = Self::default();
        let mut add = |one: usize, other: usize| {
            let (Some(a), Some(b)) = (surfaces[one], surfaces[other]) else {
                return;
            };
            let reach = |side: Surface| pixel_width * seen.camera.forward.dot(side.way);
            let apart = b.receiver - a.receiver;
            let is_within = |side: Surface| side.normal.dot(apart).abs() <= reach(side);
            if !(is_within(a) && is_within(b)) {
                return;
            }
            let [a, b] = [one, other].map(|pixel| error(shown[pixel], shares[pixel]));
            let (pairs, sum) = if layers[one] == layers[other] {
                (&mut jump.pairs_elsewhere, &mut jump.elsewhere)
            } else {
                (&mut jump.pairs, &mut jump.across)
            };
            *pairs += 1;
            *sum += (a - b).abs();
        };
        for pixel in 0..surfaces.len() {
            if pixel % width + 1 < width {
                add(pixel, pixel + 1);
            }
            if pixel + width < surfaces.len() {
                add(pixel, pixel + width);
            }
        }
        jump.across /= jump.pairs.max(1) as f64;
        jump.elsewhere /= jump.pairs_elsewhere.max(1) as f64;
        Ok((jump.pairs > 0).then_some(jump))
    }

    /// Returns by how much the mean difference across a border exceeds that elsewhere: `across −
    /// elsewhere`. It is about 0 if the borders cannot be seen.
    pub fn jump(&self) -> f64 {
        self.across - self.elsewhere
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Class::{self, Lit, Shadow};
    use glam::Vec3;
    use skiagraph_scene::{Mesh, View};

    /// A row of pixels on a wall ten units away, the last of which show another one five units
    /// farther off.
    fn jump(shown: &[f32], layers: &[u32], far: usize, in_band: &[usize]) -> Option<LayerJump> {
        let count = shown.len();
        let corners =
            |z: f32| [[-99.0, -99.0, z], [99.0, -99.0, z], [0.0, 99.0, z]].map(Vec3::from);
        let mesh = Mesh {
            positions: [corners(-10.0), corners(-15.0)].concat(),
            triangles: vec![[0, 1, 2], [3, 4, 5]],
            ..Mesh::default()
        };
        let view = View {
            fov_y_degrees: 10.0,
            far: 100.0,
            ..View::default()
        };
        let camera = view.camera([count as u32, 1]);
        let mut truth = GroundTruthPixels {
            viewport: [count as u32, 1],
            classes: vec![Lit; count],
            indeterminate: vec![false; count],
            n_dot_l: vec![1.0; count],
            base_colors: Vec::new(),
        };
        truth.classes[0] = Shadow;
        in_band
            .iter()
            .for_each(|&pixel| truth.indeterminate[pixel] = true);
        let primitives: Vec<u32> = (0..count)
            .map(|pixel| u32::from(pixel >= count - far))
            .collect();
        let seen = Seen {
            mesh: &mesh,
            camera: &camera,
            primitives: &primitives,
        };
        let shares: Vec<f32> = truth
            .classes
            .iter()
            .map(|class| f32::from(u8::from(*class == Class::Lit)))
            .collect();
        LayerJump::measured(seen, [shown, &shares], layers, &truth).unwrap()
    }

    #[test]
    fn a_row_of_two_splits_is_as_counted_by_hand() {
        // The reference: shadow, then light. Errors: 0, 0, −1, −1 | 0, −½. Pairs of one split
        // differ by 0, 1, 0 and ½, the one across by 1.
        let measured = jump(&[0.0, 1.0, 0.0, 0.0, 1.0, 0.5], &[0, 0, 0, 0, 1, 1], 0, &[]).unwrap();
        let expected = LayerJump {
            pairs: 1,
            across: 1.0,
            pairs_elsewhere: 4,
            elsewhere: 0.375,
        };
        assert_eq!(measured, expected);
        assert_eq!(measured.jump(), 0.625);
    }

    #[test]
    fn pairs_of_two_surfaces_and_those_in_the_band_do_not_count() {
        let (shown, layers) = ([0.0, 1.0, 0.0, 1.0, 1.0], [0, 1, 1, 2, 2]);
        // The border of splits 1 and 2 lies at the edge of the near wall.
        let measured = jump(&shown, &layers, 2, &[]).unwrap();
        assert_eq!((measured.pairs, measured.pairs_elsewhere), (1, 2));
        assert_eq!((measured.across, measured.elsewhere), (0.0, 0.5));
        // Without the first pixel none is across.
        assert_eq!(jump(&shown, &layers, 2, &[0]), None);
        assert_eq!(jump(&shown, &[0; 5], 0, &[]), None);
    }
}
