//! The receiver of a pixel: the point where the pixel's ray meets its primitive in the G-buffer,
//! and the bounds of its f32 error.

use crate::error::Error;
use crate::error_bound::{F32_ROUNDING, Uncertainty};
use crate::pixels::shown;
use glam::DVec3;
use skiagraph_scene::{Camera, LightKind, Mesh, Towards};

/// Roundings in an edge function of a receiver, `dir · ((p + q) × (q − p))` with corners relative
/// to the eye: the pixel's direction (three products and two sums of rounded vectors, 4), corners
/// relative to the eye (1), cross product (2), dot product (2). Nine that all align do not happen,
/// and the three edge functions' errors are added up below as if they did: with 4, the worst of
/// 200,000 random receivers errs by half of its bound (test below).
const EDGE_ROUNDINGS: f64 = 4.0;

/// Roundings in a position as the sum of barycentric × corner, in units of Σ |barycentric|
/// |corner|: the sum of the edge functions and the division by it (3), product (1), sums (2), less
/// one for not aligning.
const POSITION_ROUNDINGS: f64 = 5.0;

/// Roundings in dot(Σ barycentric × normal, l) apart from the barycentrics' own: products and sums
/// (6), the light's rounded direction (2).
const FACING_ROUNDINGS: f64 = 8.0;

/// The same where the way to the light is a difference of two rounded places.
const POSITIONAL_FACING_ROUNDINGS: f64 = FACING_ROUNDINGS + 4.0;

/// Roundings in the comparison of a receiver with a cone, in units of 1: axis and way (3 each, of
/// the components that are summed up), products and sums (5), the way's length and the product with
/// the cosine (5).
const CONE_ROUNDINGS: f64 = 16.0;

/// Least distance of a [`Receiver`] from the edges of its triangle, in pixels. It is far more than
/// f32 may move the receiver, which therefore does not touch adjoining surfaces.
pub const INSET: f64 = 1.0 / 64.0;

/// Share of the determinant beyond which the edge functions' error makes the hit meaningless.
const INDETERMINATE: f64 = 0.25;

/// Receiver of a pixel: the point of the visible surface whose shadow the pixel shows.
pub struct Receiver {
    /// Primitive id of the surface: the index of its triangle in the mesh.
    pub primitive: u32,
    /// Position of the receiver on its primitive, world space.
    pub position: DVec3,
    /// Direction and distance from the receiver to the light's centre.
    pub towards: Towards,
    /// True if the surface receives shadows.
    pub receives: bool,
    /// True if the receiver lies outside of a spot light's cone; false for other lights.
    pub outside_cone: bool,
    /// True if f32 arithmetic may find the opposite of `outside_cone`: the receiver lies on the
    /// edge of a spot light's cone. False for other lights.
    pub on_cone_edge: bool,
    /// Dot product of the interpolated, unnormalised vertex normal and the unit vector towards the
    /// light's centre. The normal is turned round for the back of a double-sided primitive.
    pub n_dot_l: f64,
    /// Bound on the f32 error of `n_dot_l`; infinite for a primitive seen edge-on or nearly so, and
    /// for a receiver at the position of a spot or point light.
    pub n_dot_l_error: f64,
    /// Region in which f32 arithmetic may put the receiver; `None` for a primitive seen edge-on or
    /// nearly so, where f32 may put the receiver anywhere.
    pub uncertainty: Option<Uncertainty>,
}

impl Receiver {
    /// Returns true if a caster may shade the receiver: it receives shadows, faces the light, and
    /// is not outside of a spot light's cone.
    pub fn may_be_shaded(&self) -> bool {
        self.receives && self.n_dot_l > 0.0 && !self.outside_cone
    }

    /// Finds the receiver of a pixel (column and row, from the top left) of a G-buffer. Returns
    /// `None` if the pixel shows the background. `primitives` is as for
    /// [`Oracle::shade`](crate::Oracle::shade).
    ///
    /// # Errors
    /// [`Error::UnknownPrimitive`] if the pixel names a triangle that the mesh does not have.
    pub fn from_pixel(
        mesh: &Mesh,
        primitives: &[u32],
        camera: &Camera,
        pixel: [u32; 2],
        light: &LightKind,
    ) -> Result<Option<Self>, Error> {
        let count = mesh.triangles.len() as u64;
        let primitive = shown(primitives, camera.viewport, pixel, count)?;
        Ok(primitive.map(|primitive| Self::new(mesh, primitive, camera, pixel, light)))
    }

    /// Finds the point where the ray through a pixel's centre meets `primitive`. The pixel is given
    /// by its column and row.
    ///
    /// A rasteriser snaps corners to a grid within the pixel. The centre may therefore lie a little
    /// outside of the primitive that covers it, where a neighbour may stand before it or beneath
    /// it. So the point is moved inside, [`INSET`] of a pixel from the edges, or to the middle of a
    /// primitive that is narrower than twice that; shaders do the same. A primitive exactly edge-on
    /// has no such point; its centroid stands in, and the pixel is always indeterminate.
    ///
    /// # Panics
    /// If the mesh has no triangle `primitive`.
    pub fn new(
        mesh: &Mesh,
        primitive: u32,
        camera: &Camera,
        [x, y]: [u32; 2],
        light: &LightKind,
    ) -> Self {
        let (eye, direction) = (camera.eye, camera.pixel_direction(x, y));
        let world = mesh.corners(primitive);
        let mut normals = mesh.corner_normals(primitive);
        let [a, b, c] = world.map(|corner| corner - eye);
        let pairs = [(b, c), (c, a), (a, b)];
        let planes = pairs.map(|(p, q)| (p + q).cross(q - p));
        let edges = planes.map(|plane| direction.dot(plane));
        let determinant: f64 = edges.iter().sum();
        let inside = inset(camera, planes, edges);
        let sum = inside.iter().sum::<f64>();
        // Seen from behind, which only a double-sided primitive is.
        if determinant > 0.0 && mesh.surfaces.is_double_sided(primitive) {
            normals = normals.map(|normal| -normal);
        }
        let farthest = a.length().max(b.length()).max(c.length());
        // |(p + q) × (q − p)| ≤ 2 · farthest · edge; the eye itself is rounded, which moves every
        // corner by as much (√3, taken as 2).
        let lever = 2.0
            * (EDGE_ROUNDINGS * farthest + 2.0 * eye.length())
            * F32_ROUNDING
            * direction.length();
        let errors = pairs.map(|(p, q)| lever * (q - p).length());
        // Or it might be seen from the other side.
        let determinate = errors.iter().sum::<f64>() < INDETERMINATE * determinant.abs();
        let errors = errors.map(|error| error / sum);
        let error: f64 = errors.iter().sum();
        let weights = match sum {
            0.0 => [1.0 / 3.0; 3],
            _ => inside.map(|edge| edge / sum),
        };
        let position = weighted(weights, world);
        let towards = light.towards(position);
        let to_light = towards.direction;
        let n_dot_l = weighted(weights, normals).dot(to_light);
        // The larger of both lengths: a shader may sum corners relative to the eye and add the eye
        // last.
        let length = |corner: DVec3| corner.length().max((corner - eye).length());
        let lengths = mean(weights, world.map(length));
        let position_error = POSITION_ROUNDINGS * F32_ROUNDING * lengths;
        let roundings = match light.position() {
            Some(_) => POSITIONAL_FACING_ROUNDINGS,
            None => FACING_ROUNDINGS,
        };
        let normal_lengths = mean(weights, normals.map(DVec3::length));
        let facing_error = roundings * F32_ROUNDING * normal_lengths;
        // Weight i off by errorᵢ moves the point along (cornerᵢ − point), before dividing by the
        // new sum of weights.
        let scale = |i: usize| errors[i] / (1.0 - error);
        let n_dot_l_error = facing_error
            + (0..3)
                .map(|i| scale(i) * (normals[i].dot(to_light) - n_dot_l).abs())
                .sum::<f64>();
        let uncertainty = determinate.then(|| Uncertainty {
            segments: std::array::from_fn(|i| (world[i] - position) * scale(i)),
            radius: position_error,
        });
        // By what angle a displaced receiver sees a light at a place elsewhere.
        let turned = match (light.position(), &uncertainty) {
            (None, _) => 0.0,
            (Some(_), Some(by)) if towards.distance > 0.0 => by.reach() / towards.distance,
            (Some(_), _) => f64::INFINITY,
        };
        let n_dot_l_error = if determinate && turned.is_finite() {
            n_dot_l_error + turned * normal_lengths
        } else {
            f64::INFINITY
        };
        let beyond_edge = light.beyond_cone(to_light);
        let cone_error = CONE_ROUNDINGS * F32_ROUNDING + turned;
        Self {
            primitive,
            position,
            towards,
            receives: mesh.surfaces.shadows(primitive).receives(),
            outside_cone: beyond_edge.is_some_and(|beyond| beyond > 0.0),
            on_cone_edge: beyond_edge.is_some_and(|beyond| beyond.abs() <= cone_error),
            n_dot_l,
            n_dot_l_error,
            uncertainty,
        }
    }
}

/// Edge functions of a ray to a triangle of any winding, at least those of a point [`INSET`] of a
/// pixel within the edge; `planes` are those through the eye and an edge.
fn inset(camera: &Camera, planes: [DVec3; 3], edges: [f64; 3]) -> [f64; 3] {
    let [width, height] = camera.viewport.map(f64::from);
    let steps = [
        camera.right * (2.0 * camera.half_width / width),
        camera.up * (2.0 * camera.half_height / height),
    ];
    let side = edges.iter().sum::<f64>().signum();
    std::array::from_fn(|i| {
        let of_a_pixel: f64 = steps.iter().map(|step| step.dot(planes[i]).abs()).sum();
        (side * edges[i]).max(INSET * of_a_pixel)
    })
}

/// Weights of a primitive's corners where the ray from `eye` meets its plane; a third each where it
/// meets it nowhere.
pub(crate) fn weights(mesh: &Mesh, primitive: u32, eye: DVec3, direction: DVec3) -> [f64; 3] {
    let [a, b, c] = mesh.corners(primitive).map(|corner| corner - eye);
    let edges = [(b, c), (c, a), (a, b)].map(|(p, q)| direction.dot((p + q).cross(q - p)));
    match edges.iter().sum::<f64>() {
        0.0 => [1.0 / 3.0; 3],
        determinant => edges.map(|edge| edge / determinant),
    }
}

/// Mean of the lengths of what is weighted, by the weights' magnitudes.
fn mean(weights: [f64; 3], lengths: [f64; 3]) -> f64 {
    (0..3).map(|i| weights[i].abs() * lengths[i]).sum()
}

fn weighted(weights: [f64; 3], points: [DVec3; 3]) -> DVec3 {
    let pairs = weights.iter().zip(points);
    pairs.map(|(&weight, point)| point * weight).sum()
}
