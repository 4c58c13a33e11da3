//! The receiver of a pixel: the point of the G-buffer's primitive that its ray meets, and how far
//! f32 may err from it.

use crate::{
    error::Error,
    error_bound::{F32_ROUNDING, Uncertainty},
    pixels::BACKGROUND,
};
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

/// Share of the determinant beyond which the edge functions' error makes the hit meaningless.
const INDETERMINATE: f64 = 0.25;

/// A pixel's receiver.
pub struct Receiver {
    /// The primitive that it lies on.
    pub primitive: u32,
    /// Hit on the primitive's plane, world space.
    pub position: DVec3,
    /// The point of the primitive's border where it would lie, had the rasteriser not snapped
    /// corners; `None` where it lies on the primitive.
    pub on_border: Option<DVec3>,
    /// The way to the light.
    pub towards: Towards,
    /// Whether it lies outside of a spot light's cone.
    pub outside_cone: bool,
    /// Whether f32 may take `outside_cone` for the contrary.
    pub on_cone_edge: bool,
    /// Interpolated, unnormalised vertex normal · unit vector towards the light.
    pub n_dot_l: f64,
    /// Bound on the f32 error of `n_dot_l`.
    pub n_dot_l_error: f64,
    /// Where f32 arithmetic may put the receiver; `None` where it may put it anywhere (a primitive
    /// seen edge-on).
    pub uncertainty: Option<Uncertainty>,
}

impl Receiver {
    /// The receiver of a pixel of a G-buffer, `None` in the background. `primitives` as for
    /// [`Oracle::shade`](crate::Oracle::shade).
    ///
    /// # Errors
    /// [`Error::UnknownPrimitive`].
    pub fn of_pixel(
        mesh: &Mesh,
        primitives: &[u32],
        camera: &Camera,
        [x, y]: [u32; 2],
        light: &LightKind,
    ) -> Result<Option<Self>, Error> {
        let primitive = primitives[x as usize + y as usize * camera.viewport[0] as usize];
        let count = mesh.triangles.len() as u64;
        if primitive == BACKGROUND {
            return Ok(None);
        }
        if u64::from(primitive) >= count {
            return Err(Error::UnknownPrimitive {
                x,
                y,
                primitive,
                count,
            });
        }
        let direction = camera.pixel_direction(x, y);
        Ok(Some(Self::new(
            mesh, primitive, camera.eye, direction, light,
        )))
    }

    /// The point where the ray from `eye` along `direction` meets the plane of `primitive`.
    ///
    /// Barycentrics are not clamped: a rasteriser snaps vertices to a subpixel grid, so that a
    /// pixel's centre may lie a little outside the primitive that covers it, and a deferred shader
    /// that does not clamp sees the same point. A primitive exactly edge-on has no such point; its
    /// centroid stands in, and the pixel is always indeterminate.
    pub fn new(
        mesh: &Mesh,
        primitive: u32,
        eye: DVec3,
        direction: DVec3,
        light: &LightKind,
    ) -> Self {
        let world = mesh.corners(primitive);
        let mut normals = mesh.corner_normals(primitive);
        let [a, b, c] = world.map(|corner| corner - eye);
        let pairs = [(b, c), (c, a), (a, b)];
        let edges = pairs.map(|(p, q)| direction.dot((p + q).cross(q - p)));
        let determinant: f64 = edges.iter().sum();
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
        let errors = pairs.map(|(p, q)| lever * (q - p).length() / determinant.abs());
        let error: f64 = errors.iter().sum();
        let determinate = error < INDETERMINATE;

        let weights = match determinant {
            0.0 => [1.0 / 3.0; 3],
            _ => edges.map(|edge| edge / determinant),
        };
        let position = weighted(weights, world);
        let clamped = weights.map(|weight| weight.max(0.0));
        let on_border =
            (clamped != weights).then(|| weighted(clamped, world) / clamped.iter().sum::<f64>());
        let towards = light.towards(position);
        let to_light = towards.direction;
        let n_dot_l = weighted(weights, normals).dot(to_light);
        // The larger of both lengths: a shader may sum corners relative to the eye and add the eye
        // last.
        let length = |corner: DVec3| corner.length().max((corner - eye).length());
        let lengths: f64 = weights
            .iter()
            .zip(world)
            .map(|(w, corner)| w.abs() * length(corner))
            .sum();
        let position_error = POSITION_ROUNDINGS * F32_ROUNDING * lengths;
        let roundings = match light.position() {
            Some(_) => POSITIONAL_FACING_ROUNDINGS,
            None => FACING_ROUNDINGS,
        };
        let normal_lengths = weights
            .iter()
            .zip(normals)
            .map(|(w, n)| w.abs() * n.length())
            .sum::<f64>();
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
        let beyond_edge = match light {
            LightKind::Spot(spot) => spot.edge_cosine() - spot.axis_cosine(to_light),
            _ => -1.0,
        };
        let cone_error = CONE_ROUNDINGS * F32_ROUNDING + turned;
        Self {
            primitive,
            position,
            on_border,
            towards,
            outside_cone: beyond_edge > 0.0,
            on_cone_edge: matches!(light, LightKind::Spot(_)) && beyond_edge.abs() <= cone_error,
            n_dot_l,
            n_dot_l_error,
            uncertainty,
        }
    }
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

fn weighted(weights: [f64; 3], points: [DVec3; 3]) -> DVec3 {
    weights
        .iter()
        .zip(points)
        .map(|(&weight, point)| point * weight)
        .sum()
}
