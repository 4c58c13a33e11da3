//! Finds the kinds of light that a graph takes.
//!
//! ```
//! use skiagraph_compare::graphs::{light_kinds, preset};
//! use skiagraph_passes::EmbeddedSources;
//!
//! let graph = preset::load("rt", &EmbeddedSources)?.0?;
//! assert!(light_kinds::takes(&graph, "point"));
//! let [taken, refused] = light_kinds::split(&graph);
//! assert_eq!((taken.len(), refused.len()), (3, 0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use skiagraph_graph::{Code, Diagnostic, Graph};
use skiagraph_passes::SceneProvider;
use skiagraph_scene::LightKind;

/// Splits the words `directional`, `spot` and `point` into two lists in this order: the kinds of
/// light that a graph takes, and those that it does not. A document that lists no kinds takes
/// directional lights alone.
pub fn split(graph: &Graph) -> [Vec<&'static str>; 2] {
    let says: Vec<&str> = graph.lights().map(|word| word.as_str()).collect();
    let takes = |word: &&'static str| match says[..] {
        [] => *word == LightKind::WORDS[0],
        _ => says.contains(word),
    };
    let (takes, refuses) = LightKind::WORDS.into_iter().partition(takes);
    [takes, refuses]
}

/// True if a graph takes lights of the kind `kind`, such as `point`.
pub fn takes(graph: &Graph, kind: &str) -> bool {
    split(graph)[0].contains(&kind)
}

/// Returns the word for the kind of the light that is set (`light`), and the number of all lights
/// of the scene (`lights`): a plan holds only for these.
pub fn kind_and_number(provider: &SceneProvider) -> (&'static str, usize) {
    (provider.light().word(), provider.lights().len())
}

/// Returns the mistake of a document that lists another kind of light than `directional`, `spot` or
/// `point`; `None` if it lists only these.
pub fn unknown(graph: &Graph) -> Option<Diagnostic> {
    let is_unknown = |word: &str| !LightKind::WORDS.contains(&word);
    let word = graph.lights().find(|word| is_unknown(word.as_str()))?;
    let text = format!("unknown kind of light `{}`", word.value);
    let mistake = Diagnostic::error(Code::UnknownVariant, text).at(word.span.clone(), "");
    Some(mistake.suggest(word.as_str(), LightKind::WORDS))
}
