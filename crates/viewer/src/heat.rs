//! Colours of a heat map: from dark purple over green to yellow, in even steps of perceived
//! brightness.

use skiagraph_reference::image::between;

/// Nine colours of viridis (Smith, van der Walt 2015), evenly spaced.
const VIRIDIS: [[u8; 3]; 9] = [
    [68, 1, 84],
    [71, 45, 123],
    [59, 82, 139],
    [44, 114, 142],
    [33, 145, 140],
    [40, 174, 128],
    [94, 201, 98],
    [173, 220, 48],
    [253, 231, 37],
];

/// Returns the sRGB colour of a value from 0 (dark purple) to 1 (yellow); values outside are
/// clamped.
pub fn colour(share: f64) -> [u8; 3] {
    between(&VIRIDIS, share.clamp(0.0, 1.0) * (VIRIDIS.len() - 1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_begins_and_ends_in_viridis_own_colours_and_grows_brighter() {
        assert_eq!((colour(-1.0), colour(2.0)), (VIRIDIS[0], VIRIDIS[8]));
        let luma = |[r, g, b]: [u8; 3]| {
            0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
        };
        let steps: Vec<f64> = (0..=64)
            .map(|at| luma(colour(f64::from(at) / 64.0)))
            .collect();
        assert!(steps.windows(2).all(|pair| pair[0] < pair[1]), "{steps:?}");
    }
}
