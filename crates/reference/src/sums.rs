//! Counts of several frames, added up.

use crate::blockers::BlockerCounts;
use crate::graded::{Invalid, OffBy};
use crate::shimmer::Shimmer;
use crate::statistics::{CertainCounts, ClassSplit, PixelCounts, Split, Statistics, WrongCounts};
use std::ops::AddAssign;

/// Adds field by field; a field that is left out does not compile.
macro_rules! added {
    ($($type:ident { $($field:ident),+ })+) => {$(
        impl AddAssign for $type {
            fn add_assign(&mut self, other: Self) {
                let Self { $($field),+ } = other;
                $(self.$field += $field;)+
            }
        }
    )+};
}

added! {
    PixelCounts { background, facing_away, facing_light, lit, shadow }
    CertainCounts { lit, shadow }
    WrongCounts { lit, shadow, total, certain, in_band }
    ClassSplit {
        certain_right, certain_wrong, certain_wrong_outside_band, uncertain, uncertain_wrong
    }
    Split { lit, shadow }
    Statistics { pixels, certain, uncertain, split, wrong, band, facing_mismatch }
    OffBy { over_1_255, over_1_16, over_1_4 }
    Invalid { nan, infinite, outside }
    BlockerCounts { open_part, closed_part, none }
    Shimmer { compared, changed }
}
