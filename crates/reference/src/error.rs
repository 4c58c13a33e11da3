//! Everything that can go wrong in this crate.

use thiserror::Error;

/// Why an oracle run, a count or an image could not be made.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum Error {
    /// The caller's interruption flag was raised; no partial result is kept.
    #[error("interrupted before the reference was finished")]
    Interrupted,
    /// A buffer does not hold one value per viewport pixel.
    #[error(
        "{name} holds {actual} values, but a viewport of {}x{} has {expected} pixels",
        viewport[0],
        viewport[1]
    )]
    PixelCount {
        /// Which buffer: `primitives`, `visibility` or `status`.
        name: &'static str,
        /// Viewport width and height.
        viewport: [u32; 2],
        /// Pixels of the viewport.
        expected: u64,
        /// Values in the buffer.
        actual: u64,
    },
    /// The G-buffer names a triangle that the mesh does not have: it was drawn from another mesh.
    #[error(
        "pixel ({x}, {y}) shows primitive {primitive}, but the mesh has only {count} triangles"
    )]
    UnknownPrimitive {
        /// Pixel column.
        x: u32,
        /// Pixel row.
        y: u32,
        /// The id found there.
        primitive: u32,
        /// Triangles of the mesh.
        count: u64,
    },
    /// A `visibility` or `status` value that a shadow preset must not have.
    #[error("{name} is {value} at pixel ({x}, {y}); {expected}")]
    Value {
        /// Which buffer: `visibility` or `status`.
        name: &'static str,
        /// Pixel column.
        x: u32,
        /// Pixel row.
        y: u32,
        /// The value found there.
        value: u32,
        /// The values that are allowed, as a sentence.
        expected: &'static str,
    },
    /// Pixels whose `visibility` is [`UNANSWERED`](crate::statistics::UNANSWERED).
    #[error(
        "{pixels} pixels have no answer, the first at ({x}, {y}): the driver ended loops of the \
         shader that traces their rays, which pass too many triangles; another adapter may answer"
    )]
    Unanswered {
        /// Number of such pixels.
        pixels: usize,
        /// Column of the first one.
        x: u32,
        /// Row of the first one.
        y: u32,
    },
    /// The light cannot be: its direction has no length, a number is not finite.
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
        /// The longest one for this mesh: a million times the diagonal of its box.
        most: f64,
    },
    /// Text that is neither `exact` nor `offset:LENGTH`.
    #[error(
        "`{0}` is no oracle mode; expected `exact` or `offset:LENGTH` with a length of at least 0 \
         in scene units, such as `offset:0.03`"
    )]
    Mode(String),
}
