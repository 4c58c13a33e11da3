//! Distances of a method's wrong pixels from the reference's shadow edges.
//!
//! The distances tell the causes apart: the steps of a map's texels stay within a texel of an edge,
//! acne lies anywhere on lit surfaces, and a bias lights the shadow beside its caster.

use crate::error::Error;
use crate::ground_truth::{Class, GroundTruthPixels};
use crate::pixels::{check_pixel_count, neighbours, place};
use crate::shimmer::Seen;
use crate::statistics::{Verdict, for_each_verdict};
use rayon::prelude::*;
use rstar::RTree;
use serde::{Deserialize, Serialize};

/// Pixels within which a wrong pixel counts as lying at an edge.
const NEAR: f64 = 2.0;

/// Distances of a method's wrong pixels from the nearest shadow edge of the reference. Wrong pixels
/// that are indeterminate ([`GroundTruthPixels::indeterminate`]) are left out. A pixel is at a
/// shadow edge if it and one of its four neighbours face the light, and one of the two is lit and
/// the other in shadow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EdgeDistances {
    /// Distances of the pixels that the method wrongly shows lit.
    pub lit: Distances,
    /// Distances of the pixels that the method wrongly shows in shadow.
    pub shadow: Distances,
}

/// Distances of a set of pixels from the nearest shadow edge of the reference. Means and maxima are
/// 0 if `count` is 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Distances {
    /// Number of pixels that have a distance.
    pub count: u64,
    /// Number of pixels whose distance on the screen is at most two pixels.
    pub near: u64,
    /// Mean distance on the screen in pixels, between pixel centres; a pixel at an edge has the
    /// distance 0.
    pub mean_pixels: f64,
    /// Greatest distance on the screen in pixels, between pixel centres.
    pub max_pixels: f64,
    /// Mean distance in the scene, in scene units, from the point that a pixel shows to the nearest
    /// point that a pixel at an edge shows.
    pub mean_world: f64,
    /// Greatest distance in the scene, in scene units, measured as for `mean_world`.
    pub max_world: f64,
    /// Number of pixels that have no distance, because no shadow edge is in the picture or the
    /// pixel's triangle is seen edge-on.
    pub without: u64,
}

impl Distances {
    fn new(distances: impl Iterator<Item = Option<[f64; 2]>>) -> Self {
        let mut sums = Self::default();
        for distance in distances {
            sums = sums.with(match distance {
                None => Self {
                    without: 1,
                    ..Self::default()
                },
                Some([pixels, world]) => Self {
                    count: 1,
                    near: u64::from(pixels <= NEAR),
                    mean_pixels: pixels,
                    max_pixels: pixels,
                    mean_world: world,
                    max_world: world,
                    without: 0,
                },
            });
        }
        sums
    }

    /// Returns the distances of two sets of pixels together. The sets share no pixel, such as those
    /// of two frames.
    pub fn with(self, other: Self) -> Self {
        let count = self.count + other.count;
        let mean = |one: f64, another: f64| {
            let sum = one * self.count as f64 + another * other.count as f64;
            sum / count.max(1) as f64
        };
        Self {
            count,
            near: self.near + other.near,
            mean_pixels: mean(self.mean_pixels, other.mean_pixels),
            max_pixels: self.max_pixels.max(other.max_pixels),
            mean_world: mean(self.mean_world, other.mean_world),
            max_world: self.max_world.max(other.max_world),
            without: self.without + other.without,
        }
    }
}

impl EdgeDistances {
    /// Measures the distances of the wrong pixels of a method's picture. `seen` is the mesh, camera
    /// and G-buffer of the picture. `visibility`, `status` and `truth` are as for
    /// [`Statistics::judged`](crate::Statistics::judged).
    ///
    /// # Errors
    /// Those of [`Statistics::judged`](crate::Statistics::judged); [`Error::PixelCount`] also if
    /// `seen.primitives` does not have one entry per pixel.
    pub fn measured(
        seen: Seen,
        visibility: &[impl Copy + Into<u32>],
        status: &[impl Copy + Into<u32>],
        truth: &GroundTruthPixels,
    ) -> Result<Self, Error> {
        check_pixel_count("primitives", truth.viewport, seen.primitives.len())?;
        let mut wrong: [Vec<usize>; 2] = Default::default();
        for_each_verdict(visibility, status, truth, |pixel| {
            if !pixel.indeterminate && pixel.verdict != Verdict::Right {
                wrong[usize::from(pixel.verdict == Verdict::WronglyShadowed)].push(pixel.place);
            }
        })?;
        if wrong.iter().all(Vec::is_empty) {
            return Ok(Self::default());
        }
        let edges = Edges::new(seen, truth);
        let [lit, shadow] = wrong.map(|pixels| {
            let each = pixels.par_iter().map(|&pixel| edges.distance(pixel));
            // Summed in order, so that the result is the same on any number of cores.
            Distances::new(each.collect::<Vec<_>>().into_iter())
        });
        Ok(Self { lit, shadow })
    }

    /// Returns the distances of the wrong pixels of two pictures, taken together, as
    /// [`Distances::with`] does.
    pub fn with(self, other: Self) -> Self {
        Self {
            lit: self.lit.with(other.lit),
            shadow: self.shadow.with(other.shadow),
        }
    }

    /// Returns the distances of all wrong pixels: those wrongly lit and those wrongly in shadow.
    pub fn all(self) -> Distances {
        self.lit.with(self.shadow)
    }
}

/// The pixels at the edges of the reference's shadows, for the nearest one on the screen and in the
/// scene.
struct Edges<'a> {
    seen: Seen<'a>,
    on_screen: RTree<[f64; 2]>,
    in_scene: RTree<[f64; 3]>,
}

impl<'a> Edges<'a> {
    fn new(seen: Seen<'a>, truth: &GroundTruthPixels) -> Self {
        let size = truth.viewport.map(|edge| edge as usize);
        let is_edge = |pixel: &usize| {
            let class = truth.classes[*pixel];
            let is_other = |other: Class| other.faces_light() && other != class;
            let mut nearby = neighbours(*pixel, size);
            class.faces_light() && nearby.any(|other| is_other(truth.classes[other]))
        };
        let edges: Vec<usize> = (0..truth.classes.len()).filter(is_edge).collect();
        let on_screen = |&pixel: &usize| place(pixel, seen.camera.viewport).map(f64::from);
        let screen = edges.iter().map(on_screen);
        let scene = edges.iter().filter_map(|&pixel| receiver(seen, pixel));
        Self {
            seen,
            on_screen: RTree::bulk_load(screen.collect()),
            in_scene: RTree::bulk_load(scene.collect()),
        }
    }

    /// The distance of a pixel from the nearest edge, in pixels and in scene units.
    fn distance(&self, pixel: usize) -> Option<[f64; 2]> {
        let on_screen = place(pixel, self.seen.camera.viewport).map(f64::from);
        let in_scene = receiver(self.seen, pixel)?;
        let pixels = self.on_screen.nearest_neighbor(on_screen)?;
        let world = self.in_scene.nearest_neighbor(in_scene)?;
        Some([apart(&on_screen, pixels), apart(&in_scene, world)])
    }
}

fn receiver(seen: Seen, pixel: usize) -> Option<[f64; 3]> {
    Some(seen.surface(pixel)?.receiver.to_array())
}

fn apart<const N: usize>(one: &[f64; N], other: &[f64; N]) -> f64 {
    let pairs = one.iter().zip(other);
    let squares = pairs.map(|(one, other)| (one - other).powi(2));
    squares.sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Class::{self, FacingAway, Lit, Shadow};
    use glam::{DVec3, Vec3};
    use proptest::prelude::*;
    use skiagraph_scene::{Camera, Mesh, View};

    /// A wall of two triangles across a camera whose pixels are one unit wide on it.
    fn wall(viewport: [u32; 2]) -> (Mesh, Camera) {
        let corners = [[-99.0, -99.0], [99.0, -99.0], [99.0, 99.0], [-99.0, 99.0]];
        let mesh = Mesh {
            positions: corners.map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        let half_height = f64::from(viewport[1]) * 0.5;
        let view = View {
            eye: DVec3::new(0.25, 0.25, half_height),
            fov_y_degrees: 90.0,
            far: 1000.0,
            ..View::default()
        };
        (mesh, view.camera(viewport))
    }

    fn measured(classes: &[Class], width: u32, shown: &[u8], in_band: &[usize]) -> EdgeDistances {
        let viewport = [width, classes.len() as u32 / width];
        let (mesh, camera) = wall(viewport);
        let mut truth = GroundTruthPixels {
            viewport,
            classes: classes.to_vec(),
            indeterminate: vec![false; classes.len()],
            n_dot_l: vec![1.0; classes.len()],
            base_colors: Vec::new(),
        };
        in_band
            .iter()
            .for_each(|&pixel| truth.indeterminate[pixel] = true);
        // Either triangle lies in the same plane.
        let seen = Seen {
            mesh: &mesh,
            camera: &camera,
            primitives: &vec![0; classes.len()],
        };
        let status = truth.status();
        EdgeDistances::measured(seen, shown, &status, &truth).unwrap()
    }

    #[test]
    fn distances_are_those_counted_by_hand() {
        // The edge lies between the third pixel and the fourth.
        let classes = [Lit, Lit, Lit, Shadow, Shadow, Shadow, Shadow];
        let edges = measured(&classes, 7, &[0, 1, 0, 0, 0, 0, 1], &[]);
        // Wrongly in shadow: two pixels from the third one, and the third one itself.
        let shadow = Distances {
            count: 2,
            near: 2,
            mean_pixels: 1.0,
            max_pixels: 2.0,
            ..edges.shadow
        };
        assert_eq!(edges.shadow, shadow);
        assert!((edges.shadow.mean_world - 1.0).abs() < 1e-9, "{edges:?}");
        assert!((edges.shadow.max_world - 2.0).abs() < 1e-9);
        // Wrongly lit: three pixels from the fourth.
        assert_eq!(
            (edges.lit.count, edges.lit.near, edges.lit.max_pixels),
            (1, 0, 3.0)
        );
        assert!((edges.lit.mean_world - 3.0).abs() < 1e-9);
        assert_eq!(edges.all().count, 3);
        assert!((edges.all().mean_pixels - 5.0 / 3.0).abs() < 1e-12);
    }

    #[test]
    fn distances_go_across_the_picture_and_leave_out_the_band() {
        // Two rows and an edge at the upper right corner.
        let classes = [Lit, Lit, Lit, Shadow, Lit, Lit, Lit, Lit];
        let edges = measured(&classes, 4, &[1, 1, 1, 0, 0, 0, 1, 1], &[5]);
        // From (0, 1) to the edge pixel (2, 0).
        assert_eq!(edges.shadow.count, 1);
        assert!((edges.shadow.max_pixels - 5f64.sqrt()).abs() < 1e-12);
        assert_eq!(edges.lit, Distances::default());
    }

    proptest! {
        /// Figures of a path agree with those of its frames, however these are grouped.
        #[test]
        fn distances_together_are_those_of_all_pixels(
            pixels in prop::collection::vec(prop::option::of([0.0..500.0, 0.0..80.0]), 0..60),
            cut in 0usize..60,
        ) {
            let (one, other) = pixels.split_at(cut.min(pixels.len()));
            let summed = |pixels: &[Option<[f64; 2]>]| Distances::new(pixels.iter().copied());
            let (together, whole) = (summed(one).with(summed(other)), summed(&pixels));
            prop_assert_eq!(
                (together.count, together.near, together.without),
                (whole.count, whole.near, whole.without)
            );
            let figures = |sums: Distances| {
                [sums.mean_pixels, sums.max_pixels, sums.mean_world, sums.max_world]
            };
            for (one, other) in figures(together).into_iter().zip(figures(whole)) {
                prop_assert!((one - other).abs() < 1e-9, "{together:?} {whole:?}");
            }
        }
    }

    #[test]
    fn a_picture_without_edges_has_no_distances() {
        // Facing away is no shadow edge.
        let edges = measured(&[FacingAway, Lit, Lit], 3, &[0, 0, 1], &[]);
        let without = Distances {
            without: 1,
            ..Distances::default()
        };
        assert_eq!(edges.shadow, without);
        assert_eq!(
            measured(&[Lit, Shadow], 2, &[1, 0], &[]),
            EdgeDistances::default()
        );
    }
}
