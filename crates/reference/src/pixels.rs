//! Computes one value for each pixel of a viewport, on all cores.

use crate::error::Error;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Value for a pixel that shows no geometry, in place of a primitive id (the index of a triangle in
/// the mesh).
pub const BACKGROUND: u32 = u32::MAX;

/// Callback that reports how far a run over the pixels of a viewport is, and flag that stops the
/// run. The [`Default`] reports nothing and never stops.
#[derive(Clone, Copy)]
pub struct Progress<'a> {
    /// Function that is called from any thread whenever a row of pixels is done, with the number of
    /// rows done so far, out of the viewport's height.
    pub rows_done: &'a (dyn Fn(u64) + Sync),
    /// Flag that the caller raises to stop the run. The run then ends within a row's time with
    /// [`Error::Interrupted`].
    pub interrupted: &'a AtomicBool,
}

static NEVER: AtomicBool = AtomicBool::new(false);

impl Default for Progress<'_> {
    /// Returns a progress that reports nothing and is never interrupted.
    fn default() -> Self {
        Self {
            rows_done: &|_| (),
            interrupted: &NEVER,
        }
    }
}

/// Returns the indices of the up to four pixels beside one, in a picture of `width` × `height`
/// pixels that are counted row by row.
pub fn neighbours(index: usize, [width, height]: [usize; 2]) -> impl Iterator<Item = usize> {
    let (x, y) = (index % width, index / width);
    let beside = [
        (x > 0).then(|| index - 1),
        (x + 1 < width).then(|| index + 1),
        (y > 0).then(|| index - width),
        (y + 1 < height).then(|| index + width),
    ];
    beside.into_iter().flatten()
}

/// The column and the row of a pixel.
pub(crate) fn place(pixel: usize, [width, _]: [u32; 2]) -> [u32; 2] {
    [pixel as u32 % width, pixel as u32 / width]
}

/// Computes one value per pixel, rows in parallel, and returns the values row by row from the top
/// left. `pixel` gets the column, the row, and a list for use as scratch memory: each thread has
/// one list, which still holds the content of the thread's last call. An error of any pixel ends
/// the run.
///
/// # Errors
/// Those of `pixel`, and [`Error::Interrupted`] if the caller stops the run.
pub fn per_pixel<T: Send>(
    viewport: [u32; 2],
    progress: Progress,
    pixel: impl Fn(u32, u32, &mut Vec<u32>) -> Result<T, Error> + Sync,
) -> Result<Vec<T>, Error> {
    let [width, height] = viewport;
    let done = AtomicU64::new(0);
    let rows: Vec<Vec<T>> = (0..height)
        .into_par_iter()
        .map_init(Vec::new, |stack, y| {
            if progress.interrupted.load(Ordering::Relaxed) {
                return Err(Error::Interrupted);
            }
            let row = (0..width).map(|x| pixel(x, y, stack));
            let row = row.collect::<Result<Vec<T>, Error>>()?;
            (progress.rows_done)(done.fetch_add(1, Ordering::Relaxed) + 1);
            Ok(row)
        })
        .collect::<Result<_, Error>>()?;
    Ok(rows.into_iter().flatten().collect())
}

/// The primitive that a pixel shows, of so many; `None` for the background.
///
/// # Errors
/// [`Error::UnknownPrimitive`].
pub(crate) fn shown(
    primitives: &[u32],
    viewport: [u32; 2],
    [x, y]: [u32; 2],
    count: u64,
) -> Result<Option<u32>, Error> {
    match primitives[x as usize + y as usize * viewport[0] as usize] {
        BACKGROUND => Ok(None),
        primitive => existing(primitive, [x, y], count).map(Some),
    }
}

/// A primitive that a pixel shows, if the mesh has so many.
///
/// # Errors
/// [`Error::UnknownPrimitive`].
pub(crate) fn existing(primitive: u32, [x, y]: [u32; 2], count: u64) -> Result<u32, Error> {
    let unknown = Error::UnknownPrimitive {
        x,
        y,
        primitive,
        count,
    };
    let is_there = u64::from(primitive) < count;
    is_there.then_some(primitive).ok_or(unknown)
}

/// Checks that the buffer `name`, which has `actual` values, holds one value per pixel.
///
/// # Errors
/// [`Error::PixelCount`] if it does not.
pub fn check_pixel_count(
    name: &'static str,
    viewport: [u32; 2],
    actual: usize,
) -> Result<(), Error> {
    let expected = u64::from(viewport[0]) * u64::from(viewport[1]);
    if actual as u64 == expected {
        Ok(())
    } else {
        Err(Error::PixelCount {
            name,
            viewport,
            expected,
            actual: actual as u64,
        })
    }
}
