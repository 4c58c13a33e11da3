//! Triangle and texel by separating axes and by clipping: what the layers' predicates are judged
//! by, and of another make than they are.
//!
//! On coordinates that are multiples of 2⁻⁸ up to 2¹⁶ the tests of one triangle are exact: no
//! product needs more than 53 bits.

use super::triangle::TexelTriangle;
use glam::{DVec2, DVec3};

/// The four corners of a texel.
fn square(centre: DVec2) -> [DVec2; 4] {
    [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(|(x, y)| centre + DVec2::new(x, y))
}

/// Returns true if the triangle and the closed texel around `centre` have a point in common.
/// Separating axes: a line that parts two convex polygons can be taken along an edge of one of
/// them. Zero-area triangles are segments and points.
pub fn touches(triangle: &TexelTriangle, centre: DVec2) -> bool {
    let (low, high) = triangle.bounds();
    let half = DVec2::splat(0.5);
    if high.cmplt(centre - half).any() || low.cmpgt(centre + half).any() {
        return false;
    }
    let corners = triangle.corners.map(DVec3::truncate);
    (0..3).all(|i| {
        let (p, edge) = triangle.edge(i);
        let range = |points: &[DVec2]| {
            points
                .iter()
                .map(|&point| edge.perp_dot(point - p))
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), side| {
                    (low.min(side), high.max(side))
                })
        };
        let (of_triangle, of_texel) = (range(&corners), range(&square(centre)));
        of_triangle.0 <= of_texel.1 && of_texel.0 <= of_triangle.1
    })
}

/// Returns true if the closed texel around `centre` lies in the triangle: its four corners do.
pub fn wholly_covers(triangle: &TexelTriangle, centre: DVec2) -> bool {
    let sides = (0..3).map(|i| {
        let (p, edge) = triangle.edge(i);
        square(centre).map(|corner| edge.perp_dot(corner - p))
    });
    let sides: Vec<f64> = sides.flatten().collect();
    triangle.area() != 0.0
        && (sides.iter().all(|&side| side >= 0.0) || sides.iter().all(|&side| side <= 0.0))
}

/// Area of the part of the texel around `centre` that no triangle covers: one triangle after the
/// other is cut out of what is left. Overlaps count once. Exact but for the rounding of cuts.
pub fn uncovered<'a>(triangles: impl IntoIterator<Item = &'a TexelTriangle>, centre: DVec2) -> f64 {
    let mut left = vec![square(centre).to_vec()];
    for triangle in triangles {
        let winding = triangle.area();
        if winding == 0.0 {
            continue;
        }
        left = left
            .iter()
            .flat_map(|polygon| cut_out(polygon, triangle, winding.signum()))
            .collect();
    }
    left.iter().map(|polygon| area(polygon)).sum()
}

/// The parts of a convex polygon outside a triangle: beyond its first edge; within the first but
/// beyond the second; and so on.
fn cut_out(polygon: &[DVec2], triangle: &TexelTriangle, winding: f64) -> Vec<Vec<DVec2>> {
    let mut inside = polygon.to_vec();
    let mut outside = vec![];
    for i in 0..3 {
        let (p, edge) = triangle.edge(i);
        let side = |point: DVec2| winding * edge.perp_dot(point - p);
        outside.push(clip(&inside, |point| -side(point)));
        inside = clip(&inside, side);
    }
    outside.retain(|part| part.len() > 2);
    outside
}

/// The part of a convex polygon where an affine function is not negative (Sutherland and Hodgman
/// 1974).
fn clip(polygon: &[DVec2], side: impl Fn(DVec2) -> f64) -> Vec<DVec2> {
    let mut kept = vec![];
    for (i, &point) in polygon.iter().enumerate() {
        let next = polygon[(i + 1) % polygon.len()];
        let (start, end) = (side(point), side(next));
        if start >= 0.0 {
            kept.push(point);
        }
        if (start > 0.0 && end < 0.0) || (start < 0.0 && end > 0.0) {
            kept.push(point.lerp(next, start / (start - end)));
        }
    }
    kept
}

fn area(polygon: &[DVec2]) -> f64 {
    let twice: f64 = (0..polygon.len())
        .map(|i| {
            let origin = polygon[0];
            (polygon[i] - origin).perp_dot(polygon[(i + 1) % polygon.len()] - origin)
        })
        .sum();
    twice.abs() * 0.5
}
