//! Ratio of the times of two runs that were not measured side by side.
//!
//! ```
//! use skiagraph_compare::records::unpaired;
//!
//! let then = [2.0, 2.1, 2.2, 2.0, 2.3, 2.1, 2.2, 2.1];
//! let ratio = unpaired::ratio(&then.map(|ms| 1.5 * ms), &then).ok_or("too few frames")?;
//! assert!(ratio.low > 1.2 && ratio.high < 1.8 && ratio.is_told_apart());
//! assert!(!unpaired::ratio(&then, &then).ok_or("too few frames")?.is_told_apart());
//! # Ok::<(), &str>(())
//! ```

use crate::records::turns::{LEAST_TURNS, Ratio};
use itertools::Itertools;

/// Quantile of the normal distribution for a confidence of 99.9 %: a comparison has many cells, and
/// of a thousand that have not changed one may be called changed.
const QUANTILE: f64 = 3.290_53;

/// The most frames of a run that count: their ratios are as many as the square of that.
const MOST: usize = 1000;

/// Divides every frame's time in `one` by every frame's time in `other`; both are in the same
/// unit. The median of these ratios is the estimate of Hodges and Lehmann (1963), the interval
/// that of the test of Mann and Whitney (1947) in its normal approximation, with a confidence
/// of at least 99.9 %. Only the first 1,000 frames of each list count. Returns `None` if a list
/// has fewer than [`LEAST_TURNS`] frames.
pub fn ratio(one: &[f64], other: &[f64]) -> Option<Ratio> {
    let [one, other] = [one, other].map(|ms| &ms[..ms.len().min(MOST)]);
    if one.len().min(other.len()) < LEAST_TURNS {
        return None;
    }
    let [n, m] = [one.len() as f64, other.len() as f64];
    let deviation = (n * m * (n + m + 1.0) / 12.0).sqrt();
    let outside = (n * m / 2.0 - QUANTILE * deviation - 0.5).max(0.0) as usize;
    Ratio::within(one.iter().cartesian_product(other), outside)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Times around 10 ms that differ by up to a tenth.
    fn noisy(count: u32, scale: f64) -> Vec<f64> {
        let ms = |frame: u32| scale * (10.0 + f64::from(frame * 7919 % 101) / 100.0);
        (0..count).map(ms).collect()
    }

    #[test]
    fn ranks_by_hand() {
        // Of 20 and 20 frames: 200 - 3.29 * sqrt(400 * 41 / 12) - 0.5 = 77.9 at each end.
        let (one, other) = (noisy(20, 1.0), vec![1.0; 20]);
        let ratio = ratio(&one, &other).unwrap();
        let mut sorted = one.clone();
        sorted.sort_by(f64::total_cmp);
        // Each sample is there 20 times: the 78th ratio from below is of the fourth sample.
        assert_eq!((ratio.low, ratio.high), (sorted[3], sorted[16]));
        assert_eq!(ratio.median, (sorted[9] + sorted[10]) * 0.5);
    }

    #[test]
    fn only_a_shift_of_all_is_a_difference() {
        let apart = |count, scale| {
            let ratio = ratio(&noisy(count, scale), &noisy(count, 1.0)).unwrap();
            ratio.is_told_apart()
        };
        assert!(apart(8, 1.2) && apart(8, 0.8) && apart(2000, 1.05));
        assert!(!apart(8, 1.02) && !apart(2000, 1.02), "level");
        let mut outliers = noisy(20, 1.0);
        outliers[..6].fill(50.0);
        let few = ratio(&outliers, &noisy(20, 1.0)).unwrap();
        assert!(!few.is_told_apart(), "six slow frames of twenty");
        assert_eq!(ratio(&noisy(7, 1.0), &noisy(20, 1.0)), None);
        assert_eq!(ratio(&[0.0; 8], &[0.0; 8]).unwrap().median, 1.0);
    }
}
