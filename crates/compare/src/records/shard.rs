//! Shards: parts of a plan of cells, one for each machine or job.
//!
//! ```
//! use skiagraph_compare::records::shard::Shard;
//!
//! let shards: Vec<Shard> = Vec::from(["1/2".parse()?, "2/2".parse()?]);
//! let pixels = [4096; 5];
//! assert_eq!(shards[0].of(&pixels), 0..2);
//! assert_eq!(shards[1].of(&pixels), 2..5);
//! assert!("3/2".parse::<Shard>().is_err());
//! # Ok::<(), String>(())
//! ```

use std::{fmt, ops::Range, str::FromStr};

/// Number of pixels that take about as long as all that a cell needs besides its pixels: shaders
/// are compiled, buffers grow.
const BESIDES: u128 = 1 << 17;

/// One of several parts of a plan of cells, written `NUMBER/COUNT` and counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    number: u32,
    count: u32,
}

impl Shard {
    /// All cells.
    pub const ALL: Self = Self {
        number: 1,
        count: 1,
    };

    /// Returns the indices of the shard's cells in a plan. `pixels` is the number of pixels of each
    /// cell, in the order of the plan. Shards are ranges of about the same work, so that methods
    /// of one view mostly stay together, and every cell is in one shard. A shard of few cells may
    /// be empty.
    pub fn of(self, pixels: &[u64]) -> Range<usize> {
        let work = |pixels: &u64| BESIDES + u128::from(*pixels);
        let total: u128 = pixels.iter().map(work).sum();
        // A cell belongs to the shard in whose part of the work its middle lies.
        let middles = pixels.iter().scan(0, |before, pixels| {
            let middle = 2 * *before + work(pixels);
            *before += work(pixels);
            Some(middle)
        });
        let middles: Vec<u128> = middles.collect();
        let first = |shard: u32| {
            let end = 2 * total * u128::from(shard);
            middles.partition_point(|middle| middle * u128::from(self.count) < end)
        };
        first(self.number - 1)..first(self.number)
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text.split_once('/').map(|(number, count)| {
            let [number, count] = [number, count].map(|it| it.trim().parse::<u32>());
            number.and_then(|number| Ok((number, count?)))
        });
        match numbers {
            Some(Ok((_, 0))) => Err("there is at least one shard: 1/1".into()),
            Some(Ok((0, count))) => Err(format!(
                "shards are counted from 1; there are 1/{count} to {count}/{count}"
            )),
            Some(Ok((number, count))) if number > count => Err(format!(
                "there is no shard {number} of {count}; there are 1/{count} to {count}/{count}"
            )),
            Some(Ok((number, count))) => Ok(Self { number, count }),
            _ => Err("expected NUMBER/COUNT, for example 3/10".into()),
        }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cell_is_in_one_shard() {
        let mixed: Vec<u64> = (0..97).map(|cell| 4096 << (cell % 9)).collect();
        for pixels in [&[][..], &[1], &[1 << 20, 1, 1], &mixed] {
            for count in [1, 2, 3, 10, 200] {
                let shards = (1..=count).map(|number| Shard { number, count });
                let cells = shards.flat_map(|shard| shard.of(pixels));
                assert!(cells.eq(0..pixels.len()), "{count} shards of {pixels:?}");
            }
        }
    }

    #[test]
    fn shards_have_about_the_same_work() {
        // Large pictures first.
        let pixels = [[1 << 20; 10], [1 << 12; 10]].concat();
        let one = Shard {
            number: 1,
            count: 2,
        };
        assert_eq!(one.of(&pixels), 0..6);
    }

    #[test]
    fn a_shard_that_is_not_there_is_told_with_those_that_are() {
        let message = |text: &str| text.parse::<Shard>().unwrap_err();
        assert_eq!(
            message("0/3"),
            "shards are counted from 1; there are 1/3 to 3/3"
        );
        assert_eq!(
            message("4/3"),
            "there is no shard 4 of 3; there are 1/3 to 3/3"
        );
        assert_eq!(message("1/0"), "there is at least one shard: 1/1");
        for text in ["", "3", "a/3", "1/", "-1/3", "1/3/5", "1/99999999999"] {
            assert!(message(text).contains("for example 3/10"), "{text}");
        }
    }
}
