//! Kinds of provided resources, such as kinds of light.

/// Kind of a resource that the host's [provider](crate#terms) describes, such as the kind of a
/// light. An expression of a document reads it as a word, `light.kind`; a shader reads it as a
/// number, `override light_kind: u32`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProvidedKind {
    /// Words for all kinds that the resource can have, such as `directional` and `spot`, each spelt
    /// as a [`Name`](crate::Name). The index of a word is its number in shaders.
    pub words: &'static [&'static str],
    /// Index in [`words`](Self::words) of the kind that the resource has.
    pub number: u32,
}

impl ProvidedKind {
    /// Returns the word in [`words`](Self::words) for the kind that the resource has; the first
    /// word if `number` is out of range, and an empty text if `words` is empty.
    pub fn word(&self) -> &'static str {
        let word = self.words.get(self.number as usize);
        word.or(self.words.first()).copied().unwrap_or_default()
    }
}
