//! The Pareto front of points whose coordinates are both costs.

/// Returns the indices into `points` of the Pareto front: the points for which no other point is at
/// most as large in both coordinates and smaller in one. The indices are sorted by the x of their
/// points. Of equal points only the first is included.
pub fn front(points: &[(f64, f64)]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| {
        let [(ax, ay), (bx, by)] = [points[a], points[b]];
        ax.total_cmp(&bx).then(ay.total_cmp(&by)).then(a.cmp(&b))
    });
    let mut least = f64::INFINITY;
    order.retain(|&index| {
        let better = points[index].1 < least;
        if better {
            least = points[index].1;
        }
        better
    });
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn of_equal_points_the_first_and_of_equal_x_the_lowest() {
        let points = [(1.0, 5.0), (1.0, 5.0), (1.0, 4.0), (2.0, 4.0), (3.0, 0.0)];
        assert_eq!(front(&points), [2, 4]);
        assert_eq!(front(&points[..2]), [0]);
        assert_eq!(front(&[]), [] as [usize; 0]);
    }

    proptest! {
        /// Against the definition.
        #[test]
        fn nothing_beats_what_is_on_it_and_something_beats_all_else(
            points in prop::collection::vec((0u8..12, 0u8..12), 0..40),
        ) {
            let points: Vec<(f64, f64)> =
                points.into_iter().map(|(x, y)| (x.into(), y.into())).collect();
            let best = front(&points);
            for (index, &(x, y)) in points.iter().enumerate() {
                let beaten = points.iter().enumerate().any(|(other, &(u, v))| {
                    u <= x && v <= y && (u < x || v < y || other < index)
                });
                prop_assert_eq!(best.contains(&index), !beaten, "{} of {:?}", index, &points);
            }
        }
    }
}
