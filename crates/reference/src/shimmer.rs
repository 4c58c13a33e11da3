//! Shimmer: shadows of a method that change from one frame to the next though the ground truth does
//! not.

use crate::error::Error;
use crate::ground_truth::GroundTruth;
use crate::pixels::{BACKGROUND, Progress, check_pixel_count, per_pixel, place, shown};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use skiagraph_scene::{Camera, Mesh};

/// A change of visibility that is one: what a picture of 4 bits could show.
const CHANGE: f32 = 1.0 / 16.0;

/// A change of the right share of light that is none: what 8 bits cannot show.
const SAME: f32 = 1.0 / 255.0;

/// Number of receivers (points of surfaces) that two successive frames both show, and number of
/// those whose visibility a shadow method changed without cause.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shimmer {
    /// Number of pixels of the later frame whose receiver faces the light and has the same ground
    /// truth in both frames (shares of an area light may differ by 1/255), and is indeterminate
    /// ([`GroundTruthPixels::indeterminate`](crate::GroundTruthPixels::indeterminate)) in neither.
    pub compared: u64,
    /// Number of pixels of `compared` whose visibility, 0 to 1, the method changed by more than
    /// 1/16, or is NaN in either frame.
    pub changed: u64,
}

/// Scene content of one frame: its mesh, its camera, and the primitive at each pixel.
#[derive(Clone, Copy)]
pub struct Seen<'a> {
    /// Mesh in its shape of this frame; frames that are compared have the same triangles.
    pub mesh: &'a Mesh,
    /// Camera of the frame, with its viewport.
    pub camera: &'a Camera,
    /// Primitive id (index of a triangle of `mesh`) that each pixel shows, row by row from the top
    /// left; [`BACKGROUND`] for a pixel without geometry.
    pub primitives: &'a [u32],
}

/// The surface that a pixel shows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface {
    /// Its place in the scene.
    pub receiver: DVec3,
    /// Unit normal of its primitive.
    pub normal: DVec3,
    /// From the eye to the receiver; as long along the eye's direction as the receiver is away.
    pub way: DVec3,
}

impl Seen<'_> {
    /// Returns the surface that a pixel shows; `None` for the background, and for a primitive that
    /// is seen edge-on.
    pub(crate) fn surface(&self, pixel: usize) -> Option<Surface> {
        let primitive = self.primitives[pixel];
        let place = place(pixel, self.camera.viewport);
        let is_known = (primitive as usize) < self.mesh.triangles.len();
        let receiver = is_known.then(|| hit(self.mesh, primitive, self.camera, place))??;
        let [a, b, c] = self.mesh.corners(primitive);
        let normal = (b - a).cross(c - a).normalize();
        Some(Surface {
            receiver,
            normal,
            way: receiver - self.camera.eye,
        })
    }

    /// Returns the area of a pixel on the image at distance 1.
    pub(crate) fn pixel_area(&self) -> f64 {
        let [width, height] = self.camera.viewport.map(f64::from);
        4.0 * self.camera.half_width * self.camera.half_height / (width * height)
    }
}

/// Finds, for each pixel of the frame `now`, the pixel of the frame `before` that shows the same
/// receiver (point of a surface). The result has an entry for each pixel of `now`: the index of a
/// pixel of `before`, row by row from the top left, or [`BACKGROUND`] if no pixel shows the
/// receiver. The receiver keeps its place on its primitive, which may have moved. The earlier pixel
/// is the one in which that place was, if that pixel showed the same primitive.
///
/// # Errors
/// [`Error::PixelCount`], [`Error::UnknownPrimitive`], [`Error::Interrupted`].
pub fn same_receivers(before: Seen, now: Seen, progress: Progress) -> Result<Vec<u32>, Error> {
    for seen in [before, now] {
        check_pixel_count("primitives", seen.camera.viewport, seen.primitives.len())?;
    }

    let [width_before, _] = before.camera.viewport;
    let triangles = [before, now].map(|seen| seen.mesh.triangles.len());
    let count = triangles[0].min(triangles[1]) as u64;
    per_pixel(now.camera.viewport, progress, |x, y, _| {
        let shown = shown(now.primitives, now.camera.viewport, [x, y], count)?;
        let Some(primitive) = shown else {
            return Ok(BACKGROUND);
        };
        let place = hit(now.mesh, primitive, now.camera, [x, y])
            .map(|receiver| earlier(receiver, primitive, before.mesh, now.mesh))
            .and_then(|receiver| before.camera.pixel_of(receiver))
            .map(|[x, y]| x + y * width_before);
        let same = |&place: &u32| before.primitives[place as usize] == primitive;
        Ok(place.filter(same).unwrap_or(BACKGROUND))
    })
}

/// Where the ray through a pixel's centre meets the plane of its primitive; `None` for one that is
/// edge-on.
pub(crate) fn hit(mesh: &Mesh, primitive: u32, camera: &Camera, [x, y]: [u32; 2]) -> Option<DVec3> {
    let [a, b, c] = mesh.corners(primitive);
    let normal = (b - a).cross(c - a);
    let direction = camera.pixel_direction(x, y);
    let t = normal.dot(a - camera.eye) / normal.dot(direction);
    t.is_finite().then(|| camera.eye + direction * t)
}

/// Where a place on a primitive was in the frame before.
fn earlier(place: DVec3, primitive: u32, before: &Mesh, now: &Mesh) -> DVec3 {
    let corners = now.corners(primitive);
    let corners_before = before.corners(primitive);
    // A triangle that stands still is where it is, without rounding.
    if corners == corners_before {
        return place;
    }
    let [a, b, c] = corners;
    let normal = (b - a).cross(c - a);
    let area = normal.length_squared();
    let v = (place - a).cross(c - a).dot(normal) / area;
    let w = (b - a).cross(place - a).dot(normal) / area;
    let [a, b, c] = corners_before;
    a + (b - a) * v + (c - a) * w
}

/// Counts the receivers whose visibility changed between two frames. `same` is the result of
/// [`same_receivers`]. The first pair holds the shares of light that the method shows at each pixel
/// of the earlier and of the later frame, row by row from the top left; the second pair holds the
/// ground truths of these frames.
///
/// # Errors
/// [`Error::PixelCount`] for a list that does not have one value per pixel of its frame.
pub fn shimmer(
    same: &[u32],
    [before, now]: [&[f32]; 2],
    [truth_before, truth_now]: [&GroundTruth; 2],
) -> Result<Shimmer, Error> {
    let (pixels_before, pixels_now) = (&truth_before.pixels, &truth_now.pixels);
    check_pixel_count("same receivers", pixels_now.viewport, same.len())?;
    check_pixel_count("visibility", pixels_now.viewport, now.len())?;
    check_pixel_count("visibility", pixels_before.viewport, before.len())?;
    let (shares_before, shares_now) = (truth_before.shares(), truth_now.shares());
    let mut counts = Shimmer::default();
    for (pixel, &earlier) in same.iter().enumerate() {
        let earlier = earlier as usize;
        if earlier == BACKGROUND as usize
            || !pixels_now.classes[pixel].faces_light()
            || !pixels_before.classes[earlier].faces_light()
            || pixels_now.indeterminate[pixel]
            || pixels_before.indeterminate[earlier]
            || (shares_now[pixel] - shares_before[earlier]).abs() > SAME
        {
            continue;
        }
        counts.compared += 1;
        let change = now[pixel] - before[earlier];
        counts.changed += u64::from(change.is_nan() || change.abs() > CHANGE);
    }
    Ok(counts)
}
