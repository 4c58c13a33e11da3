//! Order statistics of times: quartiles, medians and percentiles.
//!
//! ```
//! use skiagraph_compare::records::statistics::{Series, Spread};
//!
//! let times = [7.0, 5.0, 6.0, 20.0];
//! let spread = Spread::new(times).ok_or("no samples")?;
//! assert_eq!((spread.min, spread.median, spread.p95), (5.0, 6.5, 20.0));
//! assert_eq!([spread.q1, spread.q3], [5.75, 10.25]);
//! assert_eq!(Series::new(times.to_vec()).ok_or("no samples")?.max, 20.0);
//! # Ok::<(), &str>(())
//! ```

use serde::{Deserialize, Serialize};
use std::time::Duration;

/// Order statistics of times over frames, in milliseconds, without the samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Least sample, in milliseconds.
    pub min: f64,
    /// First quartile in milliseconds, interpolated linearly between the two nearest samples.
    pub q1: f64,
    /// Middle sample in milliseconds, or the mean of the two in the middle.
    pub median: f64,
    /// Third quartile in milliseconds, interpolated linearly between the two nearest samples.
    pub q3: f64,
    /// The smallest sample that at least 95 % of the samples do not exceed, in milliseconds.
    pub p95: f64,
}

/// Times of frames in milliseconds, by the GPU's clock and by the CPU's.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FrameTimes {
    /// Order statistics of the GPU times from the start of a frame's first pass to the end of its
    /// last; 0 for a frame without passes, null if there are no timestamps or they cannot be
    /// trusted.
    pub gpu_ms: Option<Spread>,
    /// Order statistics of the CPU times of a frame's upkeep: what is made of the scene for the
    /// method (hierarchies, boxes of lights, uploads), new bind groups and encoding. Null for
    /// frames in which every pass runs whether anything has moved or not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cpu_ms: Option<Spread>,
    /// Order statistics of the times from the start of a frame's upkeep (where it has none, of its
    /// encoding) until the GPU was done, by the CPU's clock.
    pub wall_ms: Spread,
    /// GPU time of each frame in milliseconds, in order; null if the GPU time of any frame is
    /// missing.
    pub gpu_frames: Option<Vec<f64>>,
    /// CPU time of each frame's upkeep in milliseconds, in order.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cpu_frames: Option<Vec<f64>>,
    /// Time of each frame by the CPU's clock in milliseconds, in order.
    pub wall_frames: Vec<f64>,
}

impl FrameTimes {
    /// Creates the times of frames from the GPU time, the CPU time of the upkeep, and the wall time
    /// of each frame in milliseconds, in order. Returns `None` if there are no frames.
    pub fn new(
        gpu_frames: Option<Vec<f64>>,
        cpu_frames: Option<Vec<f64>>,
        wall_frames: Vec<f64>,
    ) -> Option<Self> {
        let spread = |frames: &Vec<f64>| Spread::new(frames.iter().copied());
        Some(Self {
            gpu_ms: gpu_frames.as_ref().and_then(spread),
            cpu_ms: cpu_frames.as_ref().and_then(spread),
            wall_ms: spread(&wall_frames)?,
            gpu_frames,
            cpu_frames,
            wall_frames,
        })
    }

    /// Returns the milliseconds that each frame costs, in order: wall times if `by_wall`, otherwise
    /// GPU time and upkeep of the CPU added. Returns `None` if GPU times are missing.
    pub fn costs(&self, by_wall: bool) -> Option<Vec<f64>> {
        if by_wall {
            return Some(self.wall_frames.clone());
        }
        let mut costs = self.gpu_frames.clone()?;
        let upkeep = self.cpu_frames.iter().flatten();
        for (ms, cpu) in costs.iter_mut().zip(upkeep) {
            *ms += cpu;
        }
        Some(costs)
    }

    /// Returns the order statistics of [`costs`](Self::costs); `None` if GPU times are missing.
    pub fn spread(&self, by_wall: bool) -> Option<Spread> {
        Spread::new(self.costs(by_wall)?)
    }

    /// Returns the milliseconds that `percent` percent of the frames keep to, of
    /// [`costs`](Self::costs); `None` if GPU times are missing.
    pub fn percentile(&self, percent: u8, by_wall: bool) -> Option<f64> {
        let mut costs = self.costs(by_wall)?;
        costs.sort_by(f64::total_cmp);
        let rank = (costs.len() * usize::from(percent)).div_ceil(100).max(1);
        costs.get(rank - 1).copied()
    }
}

impl Spread {
    /// Returns the order statistics of samples in milliseconds; `None` if there are no samples.
    pub fn new(samples: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut ms: Vec<f64> = samples.into_iter().collect();
        ms.sort_by(f64::total_cmp);
        let last = ms.len().checked_sub(1)?;
        let rank = (ms.len() as f64 * 0.95).ceil() as usize;
        let [q1, q3] = [0.25, 0.75].map(|share| {
            let place = share * last as f64;
            let [below, above] = [place.floor(), place.ceil()].map(|place| ms[place as usize]);
            below + (above - below) * place.fract()
        });
        Some(Self {
            min: ms[0],
            q1,
            median: (ms[last / 2] + ms[ms.len() / 2]) * 0.5,
            q3,
            p95: ms[rank.clamp(1, ms.len()) - 1],
        })
    }
}

/// The middle of some values, of an even number the greater one of two; 0 of none.
pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// Returns the milliseconds of a time, exact to the nanosecond.
pub fn ms(time: Duration) -> f64 {
    time.as_nanos() as f64 / 1e6
}

/// Times in milliseconds, one per frame, and their order statistics.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Series {
    /// Least sample, in milliseconds.
    pub min: f64,
    /// Middle sample in milliseconds, or the mean of the two in the middle.
    pub median: f64,
    /// The smallest sample that at least 95 % of the samples do not exceed, in milliseconds.
    pub p95: f64,
    /// Greatest sample, in milliseconds.
    pub max: f64,
    /// Samples in milliseconds, one per frame, in the order of the frames.
    pub samples: Vec<f64>,
}

impl Series {
    /// Creates a series of times in milliseconds; `None` if there are no samples.
    pub fn new(samples: Vec<f64>) -> Option<Self> {
        let spread = Spread::new(samples.iter().copied())?;
        Some(Self {
            min: spread.min,
            median: spread.median,
            p95: spread.p95,
            max: samples.iter().copied().reduce(f64::max)?,
            samples,
        })
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub(crate) fn series(samples: &[f64]) -> Series {
        Series::new(samples.to_vec()).unwrap()
    }

    #[test]
    fn spreads_are_order_statistics() {
        let ms = |list: &[u64]| Spread::new(list.iter().map(|&ms| ms as f64));
        assert_eq!(ms(&[]), None);
        assert_eq!(
            ms(&[7]),
            Some(Spread {
                min: 7.0,
                q1: 7.0,
                median: 7.0,
                q3: 7.0,
                p95: 7.0
            })
        );
        assert_eq!(
            ms(&[4, 1, 2, 9]),
            Some(Spread {
                min: 1.0,
                q1: 1.75,
                median: 3.0,
                q3: 5.25,
                p95: 9.0
            })
        );
        let hundred: Vec<u64> = (1..=100).rev().collect();
        assert_eq!(
            ms(&hundred),
            Some(Spread {
                min: 1.0,
                q1: 25.75,
                median: 50.5,
                q3: 75.25,
                p95: 95.0
            })
        );
    }

    #[test]
    fn quartiles_lie_between_the_samples_beside_them() {
        let quartiles = |samples: &[f64]| {
            let spread = Spread::new(samples.iter().copied()).unwrap();
            [spread.q1, spread.q3]
        };
        assert_eq!(quartiles(&[5.0, 1.0, 2.0, 4.0, 3.0]), [2.0, 4.0]);
        assert_eq!(quartiles(&[1.0, 2.0]), [1.25, 1.75]);
        assert_eq!(quartiles(&[7.0]), [7.0, 7.0]);
    }
}
