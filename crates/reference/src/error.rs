//! Everything that can go wrong in this crate.

use thiserror::Error;

/// Reason why the reference could not trace a view, judge a method's picture, or draw an image.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum Error {
    /// The caller set [`Progress::interrupted`](crate::Progress::interrupted); no partial result is
    /// returned.
    #[error("interrupted before the reference was finished")]
    Interrupted,
    /// A buffer does not hold one value for each pixel of the viewport.
    #[error(
        "{name} holds {actual} values, but a viewport of {}x{} has {expected} pixels",
        viewport[0],
        viewport[1]
    )]
    PixelCount {
        /// Name of the buffer, such as `primitives`, `visibility` or `status`.
        name: &'static str,
        /// Width and height of the viewport in pixels.
        viewport: [u32; 2],
        /// Number of pixels in the viewport.
        expected: u64,
        /// Number of values in the buffer.
        actual: u64,
    },
    /// The G-buffer (primitive ids of the pixels) names a triangle that the mesh does not have: it
    /// was drawn from another mesh.
    #[error(
        "pixel ({x}, {y}) shows primitive {primitive}, but the mesh has only {count} triangles"
    )]
    UnknownPrimitive {
        /// Column of the pixel, counted from 0 at the left.
        x: u32,
        /// Row of the pixel, counted from 0 at the top.
        y: u32,
        /// Primitive id (index of a triangle) that the G-buffer has for the pixel.
        primitive: u32,
        /// Number of triangles of the mesh.
        count: u64,
    },
    /// A pixel has a `visibility` or `status` that is none of the values that a shadow method may
    /// write.
    #[error("{name} is {value} at pixel ({x}, {y}); {expected}")]
    Value {
        /// Name of the buffer: `visibility` or `status`.
        name: &'static str,
        /// Column of the pixel, counted from 0 at the left.
        x: u32,
        /// Row of the pixel, counted from 0 at the top.
        y: u32,
        /// Value of that pixel.
        value: u32,
        /// The values that are allowed, as a sentence.
        expected: &'static str,
    },
    /// Some pixels have no answer: their `visibility` is
    /// [`UNANSWERED`](crate::statistics::UNANSWERED).
    #[error("{pixels} pixels have no answer, the first at ({x}, {y})")]
    Unanswered {
        /// Number of pixels without an answer.
        pixels: usize,
        /// Column of the first pixel without an answer.
        x: u32,
        /// Row of the first pixel without an answer.
        y: u32,
    },
    /// The light is not valid; the text is the reason, for example that its direction has no length
    /// or a number is not finite.
    #[error("{0}")]
    Light(String),
    /// The offset of [`OracleMode::Offset`](crate::OracleMode::Offset) is negative or not finite.
    #[error("the oracle's offset is {0}; expected a finite length of at least 0, in scene units")]
    Offset(f64),
    /// The offset of [`OracleMode::Offset`](crate::OracleMode::Offset) is out of all proportion to
    /// the mesh.
    #[error(
        "the oracle's offset is {length:e}, a million times the scene and more; expected at most \
         {most:.3e}, in scene units"
    )]
    OffsetTooLong {
        /// The offset, in scene units.
        length: f64,
        /// Longest offset for this mesh, in scene units: a million times the diagonal of its box.
        most: f64,
    },
    /// This text was to be read as an [`OracleMode`](crate::OracleMode), but is neither `exact` nor
    /// `offset:LENGTH`.
    #[error(
        "`{0}` is no oracle mode; expected `exact` or `offset:LENGTH` with a length of at least 0 \
         in scene units, such as `offset:0.03`"
    )]
    Mode(String),
}
