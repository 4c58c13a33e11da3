//! Which of several kinds something is that a graph does not make itself.

/// The kind of something that is provided: `light.kind` is its word in expressions, and a shader's
/// `override light_kind: u32` its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProvidedKind {
    /// The words for all kinds, names as documents have them.
    pub words: &'static [&'static str],
    /// Which of them it is.
    pub number: u32,
}

impl ProvidedKind {
    /// The word; the first where there is none of this number.
    pub fn word(&self) -> &'static str {
        let word = self.words.get(self.number as usize);
        word.or(self.words.first()).copied().unwrap_or_default()
    }
}
