//! Cuts a polygon into triangles.

use super::options::Concave;
use earcut::Earcut;
use glam::{DVec2, DVec3};
use smallvec::SmallVec;

/// Triangles of a polygon, as corner numbers; those of a quad need no memory of their own.
pub(super) type Triangles = SmallVec<[[usize; 3]; 2]>;

/// Share of a polygon's extent, squared, below which an area is rounding: corners are f32.
const FLAT: f64 = 1.0 / (1u32 << 20) as f64;

/// Most corners of a concave polygon: what cutting ears costs grows with their square.
const MOST_CORNERS: usize = 10_000;

/// The triangles of a polygon, as corner numbers, wound as it is: the fan from corner `apex` where
/// that is a partition of it, as it is of every convex polygon; else what an ear cutter makes of
/// it. `None` where the polygon intersects itself, or is too large.
pub(super) fn cut(points: &[DVec3], apex: usize, concave: Concave) -> Option<Triangles> {
    let count = points.len();
    let fan: Triangles = (1..count - 1)
        .map(|step| [apex, (apex + step) % count, (apex + step + 1) % count])
        .collect();
    if count == 3 || concave == Concave::Fan {
        return Some(fan);
    }
    let flat = project(points);
    let extent = flat
        .iter()
        .map(|p| (*p - flat[0]).abs().max_element())
        .fold(0.0, f64::max);
    let least = -FLAT * extent * extent;
    if fan.iter().all(|&triangle| area(&flat, triangle) >= least) {
        return Some(fan);
    }
    if count > MOST_CORNERS {
        return None;
    }
    let outline: Vec<usize> = (0..count).collect();
    let mut triangles = partition(&flat, &outline, least)
        .or_else(|| partition(&flat, &without_spikes(&flat, outline, least), least))?;
    // From the lowest corner on, in the order of the file.
    for triangle in &mut triangles {
        let lowest = (0..3).min_by_key(|&corner| triangle[corner]).unwrap_or(0);
        triangle.rotate_left(lowest);
    }
    triangles.sort_unstable();
    Some(triangles.into())
}

/// Triangles within an outline, by the numbers of its corners; `None` if they do not cover it once,
/// as where it crosses itself. Areas above `least` count as 0.
fn partition(points: &[DVec2], outline: &[usize], least: f64) -> Option<Vec<[usize; 3]>> {
    let flat: Vec<DVec2> = outline.iter().map(|&corner| points[corner]).collect();
    let triangles = ears(&flat);
    let whole: f64 = (2..flat.len()).map(|at| area(&flat, [0, at - 1, at])).sum();
    let areas = triangles.iter().map(|&triangle| area(&flat, triangle));
    let covered: f64 = areas.clone().map(f64::abs).sum();
    let fits = (covered - whole).abs() <= -least * flat.len() as f64;
    (fits && areas.into_iter().all(|area| area >= least)).then(|| {
        triangles
            .into_iter()
            .map(|triangle| triangle.map(|at| outline[at]))
            .collect()
    })
}

/// Leaves out corners at which an outline turns back on the line that it came along, and those that
/// are where the next one is: there is no area beside them.
fn without_spikes(points: &[DVec2], mut outline: Vec<usize>, least: f64) -> Vec<usize> {
    let turns_back = |outline: &[usize], at: usize| {
        let count = outline.len();
        let [before, own, after] = [at + count - 1, at, at + 1].map(|at| outline[at % count]);
        let along = (points[own] - points[before]).dot(points[after] - points[own]);
        along <= 0.0 && area(points, [before, own, after]).abs() <= -least
    };
    while outline.len() > 3
        && let Some(at) = (0..outline.len()).find(|&at| turns_back(&outline, at))
    {
        outline.remove(at);
    }
    outline
}

/// Along the longest axis of the polygon's normal (Newell's method), so that it is wound
/// counter-clockwise. A dropped axis leaves the others as they are, to the bit.
fn project(points: &[DVec3]) -> Vec<DVec2> {
    let normal = normal(points);
    let axes = match normal.abs().max_position() {
        0 => [1, 2],
        1 => [2, 0],
        _ => [0, 1],
    };
    let turned = normal[normal.abs().max_position()] < 0.0;
    let [x, y] = if turned { [axes[1], axes[0]] } else { axes };
    points
        .iter()
        .map(|point| DVec2::new(point[x], point[y]))
        .collect()
}

/// Twice the area of a polygon as a vector along its normal: the sum over its edges.
pub(super) fn normal(points: &[DVec3]) -> DVec3 {
    let origin = points[0];
    let next = points.iter().cycle().skip(1);
    let edges = points.iter().zip(next);
    edges
        .map(|(from, to)| (*from - origin).cross(*to - origin))
        .sum()
}

/// Twice the signed area.
fn area(points: &[DVec2], [a, b, c]: [usize; 3]) -> f64 {
    (points[b] - points[a]).perp_dot(points[c] - points[a])
}

/// The ear cutter leaves out corners on a line with their neighbours. They are put back, so that a
/// face that shares them fits without a crack.
fn ears(points: &[DVec2]) -> Vec<[usize; 3]> {
    let mut indices: Vec<usize> = Vec::new();
    Earcut::new().earcut(points.iter().map(|p| p.to_array()), &[], &mut indices);
    let mut used = vec![false; points.len()];
    for &index in &indices {
        used[index] = true;
    }
    let count = points.len();
    // The corner that follows another one in what the ear cutter took.
    let following = |corner: usize| {
        let rest = (1..count).map(|step| (corner + step) % count);
        rest.into_iter().find(|&next| used[next]).unwrap_or(corner)
    };
    let mut triangles = Vec::new();
    for triangle in indices.chunks_exact(3) {
        let mut triangle = [triangle[0], triangle[1], triangle[2]];
        if area(points, triangle) < 0.0 {
            triangle.swap(1, 2);
        }
        // Around its corners with what lies on its edges between them; the flag says what is a
        // corner.
        let mut ring = Vec::new();
        for side in 0..3 {
            let (from, to) = (triangle[side], triangle[(side + 1) % 3]);
            ring.push((from, true));
            if following(from) == to {
                let between = (1..count).map(|step| (from + step) % count);
                ring.extend(
                    between
                        .take_while(|&next| next != to)
                        .map(|next| (next, false)),
                );
            }
        }
        split(ring, &mut triangles);
    }
    triangles
}

/// Cuts a triangle with more points on its edges: corners beside such a point, until three are
/// left. Each piece cut off makes corners of its neighbours.
fn split(mut ring: Vec<(usize, bool)>, into: &mut Vec<[usize; 3]>) {
    while ring.len() > 3 {
        let count = ring.len();
        let beside = |at: usize| [(at + count - 1) % count, (at + 1) % count];
        let ear = (0..count)
            .find(|&at| ring[at].1 && beside(at).iter().any(|&other| !ring[other].1))
            .unwrap_or(0);
        let [before, after] = beside(ear);
        into.push([ring[before].0, ring[ear].0, ring[after].0]);
        (ring[before].1, ring[after].1) = (true, true);
        ring.remove(ear);
    }
    into.push([ring[0].0, ring[1].0, ring[2].0]);
}
