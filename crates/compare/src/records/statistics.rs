//! Order statistics of times.
//!
//! ```
//! use skiagraph_compare::records::statistics::{Series, Spread};
//! use std::time::Duration;
//!
//! let times = [7, 5, 6, 20].map(Duration::from_millis);
//! let spread = Spread::new(&times).ok_or("no samples")?;
//! assert_eq!((spread.min, spread.median, spread.p95), (5.0, 6.5, 20.0));
//! assert_eq!(Series::from_times(&times).ok_or("no samples")?.max, 20.0);
//! # Ok::<(), &str>(())
//! ```

use serde::{Deserialize, Serialize};
use std::time::Duration;

/// Least, median and 95th percentile over frames, milliseconds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Least.
    pub min: f64,
    /// Middle one, or the mean of the two in the middle.
    pub median: f64,
    /// The smallest sample that at least 95 % of the samples do not exceed.
    pub p95: f64,
}

/// Times of frames.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FrameTimes {
    /// From the first pass's begin to the last one's end; null where timestamps cannot be had or
    /// trusted.
    pub gpu_ms: Option<Spread>,
    /// From the start of encoding until the GPU was done, by the CPU's clock.
    pub wall_ms: Spread,
}

impl Spread {
    /// Returns the spread of some samples; `None` if there are none.
    pub fn new(samples: &[Duration]) -> Option<Self> {
        Self::from_ms(samples.iter().map(|sample| sample.as_secs_f64() * 1e3))
    }

    /// Returns the spread of some samples in milliseconds; `None` if there are none.
    pub fn from_ms(samples: impl Iterator<Item = f64>) -> Option<Self> {
        let mut ms: Vec<f64> = samples.collect();
        ms.sort_by(f64::total_cmp);
        let last = ms.len().checked_sub(1)?;
        let rank = (ms.len() as f64 * 0.95).ceil() as usize;
        Some(Self {
            min: ms[0],
            median: (ms[last / 2] + ms[ms.len() / 2]) * 0.5,
            p95: ms[rank.clamp(1, ms.len()) - 1],
        })
    }

    /// Returns the spread of samples of which any may be missing; `None` if one is.
    pub fn from_all(samples: &[Option<Duration>]) -> Option<Self> {
        Self::new(&all(samples)?)
    }
}

fn all(samples: &[Option<Duration>]) -> Option<Vec<Duration>> {
    samples.iter().copied().collect()
}

/// Times in milliseconds, one per frame, and their order statistics.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Series {
    /// Least.
    pub min: f64,
    /// Middle one, or the mean of the two in the middle.
    pub median: f64,
    /// The smallest sample that at least 95 % of the samples do not exceed.
    pub p95: f64,
    /// Greatest.
    pub max: f64,
    /// One per frame, in the order of the frames.
    pub samples: Vec<f64>,
}

impl Series {
    /// Creates a series of some milliseconds; `None` if there are none.
    pub fn new(samples: Vec<f64>) -> Option<Self> {
        let Spread { min, median, p95 } = Spread::from_ms(samples.iter().copied())?;
        Some(Self {
            min,
            median,
            p95,
            max: samples.iter().copied().reduce(f64::max)?,
            samples,
        })
    }

    /// Creates a series of some samples; `None` if there are none.
    pub fn from_times(times: &[Duration]) -> Option<Self> {
        // From whole nanoseconds, so that a sample has no more than six digits behind the point.
        let ms = times.iter().map(|time| time.as_nanos() as f64 / 1e6);
        Self::new(ms.collect())
    }

    /// Creates a series of samples of which any may be missing; `None` if one is.
    pub fn from_all(times: &[Option<Duration>]) -> Option<Self> {
        Self::from_times(&all(times)?)
    }

    /// First and third quartile, linear between the samples beside them.
    pub fn quartiles(&self) -> [f64; 2] {
        let mut sorted = self.samples.clone();
        sorted.sort_by(f64::total_cmp);
        [0.25, 0.75].map(|share| {
            let place = share * sorted.len().saturating_sub(1) as f64;
            let at = |index: f64| sorted.get(index as usize).copied().unwrap_or(f64::NAN);
            let (below, above) = (at(place.floor()), at(place.ceil()));
            below + (above - below) * place.fract()
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
        let ms = |list: &[u64]| {
            Spread::new(
                &list
                    .iter()
                    .map(|&ms| Duration::from_millis(ms))
                    .collect::<Vec<_>>(),
            )
        };
        assert_eq!(ms(&[]), None);
        assert_eq!(
            ms(&[7]),
            Some(Spread {
                min: 7.0,
                median: 7.0,
                p95: 7.0
            })
        );
        assert_eq!(
            ms(&[4, 1, 2, 9]),
            Some(Spread {
                min: 1.0,
                median: 3.0,
                p95: 9.0
            })
        );
        let hundred: Vec<u64> = (1..=100).rev().collect();
        assert_eq!(
            ms(&hundred),
            Some(Spread {
                min: 1.0,
                median: 50.5,
                p95: 95.0
            })
        );
        assert_eq!(Spread::from_all(&[Some(Duration::ZERO), None]), None);
    }

    #[test]
    fn quartiles_lie_between_the_samples_beside_them() {
        let quartiles = |samples: &[f64]| series(samples).quartiles();
        assert_eq!(quartiles(&[5.0, 1.0, 2.0, 4.0, 3.0]), [2.0, 4.0]);
        assert_eq!(quartiles(&[1.0, 2.0]), [1.25, 1.75]);
        assert_eq!(quartiles(&[7.0]), [7.0, 7.0]);
    }
}
