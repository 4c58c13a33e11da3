//! Colours and shapes of series: 48 combinations before one repeats.

use crate::canvas::Root;
use crate::colours::{AXIS, LOOKS};
use crate::error::Error;
use plotters::prelude::*;

/// Corners in tenths of the radius; none for a circle.
const SHAPES: [&[(i32, i32)]; 6] = [
    &[],
    &[(-9, -9), (9, -9), (9, 9), (-9, 9)],
    &[(0, -12), (11, 8), (-11, 8)],
    &[(0, -13), (11, 0), (0, 13), (-11, 0)],
    &[(0, 12), (11, -8), (-11, -8)],
    &[
        (-4, -12),
        (4, -12),
        (4, -4),
        (12, -4),
        (12, 4),
        (4, 4),
        (4, 12),
        (-4, 12),
        (-4, 4),
        (-12, 4),
        (-12, -4),
        (-4, -4),
    ],
];

/// Radius of the smallest mark, pixels, and how much each size adds.
const RADIUS: (f64, f64) = (4.0, 1.3);

/// Colour and shape of a series.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Look {
    pub colour: RGBColor,
    shape: usize,
}

impl Look {
    /// Returns the colour and shape of the series with this index in the legend; they repeat after
    /// 48.
    pub fn new(index: usize) -> Self {
        // The colours come around with another shape each.
        let (round, colour) = (index / LOOKS.len(), index % LOOKS.len());
        Self {
            colour: LOOKS[colour],
            shape: (colour + round) % SHAPES.len(),
        }
    }

    /// Returns the colour and shape of marks that belong to no series.
    pub fn neutral() -> Self {
        Self {
            colour: AXIS,
            shape: 0,
        }
    }

    /// Draws a mark with its centre at `at` (pixels) in the size with the index `size`; one that is
    /// not `full` is white inside.
    pub fn draw(self, root: &Root, at: (i32, i32), size: usize, full: bool) -> Result<(), Error> {
        let radius = RADIUS.0 + RADIUS.1 * size as f64;
        let inside = if full { self.colour } else { WHITE };
        let rim = self.colour.stroke_width(2);
        let corners = SHAPES[self.shape];
        if corners.is_empty() {
            let radius = radius.round() as i32;
            root.draw(&Circle::new(at, radius, inside.filled()))?;
            return Ok(root.draw(&Circle::new(at, radius, rim))?);
        }
        let place = |&(x, y): &(i32, i32)| {
            let by = |tenths: i32| (f64::from(tenths) / 10.0 * radius).round() as i32;
            (at.0 + by(x), at.1 + by(y))
        };
        let mut outline: Vec<(i32, i32)> = corners.iter().map(place).collect();
        root.draw(&Polygon::new(outline.clone(), inside.filled()))?;
        outline.extend_from_within(..1);
        Ok(root.draw(&PathElement::new(outline, rim))?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_of_the_first_forty_eight_look_alike() {
        let looks: Vec<Look> = (0..48).map(Look::new).collect();
        for (index, look) in looks.iter().enumerate() {
            assert!(!looks[..index].contains(look), "{index}");
        }
    }
}
