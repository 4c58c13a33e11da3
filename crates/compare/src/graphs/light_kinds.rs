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

use crate::error::CompareError;
use crate::wording::did_you_mean;
use skiagraph_graph::Graph;
use skiagraph_passes::{SceneProvider, uniforms::LIGHT_KINDS};

/// Splits the words `directional`, `spot` and `point` into two lists in this order: the kinds of
/// light that a graph takes, and those that it does not. A document that lists no kinds takes
/// directional lights alone.
pub fn split(graph: &Graph) -> [Vec<&'static str>; 2] {
    let says: Vec<&str> = graph.lights().map(|word| word.as_str()).collect();
    let takes = |word: &&'static str| match says[..] {
        [] => *word == LIGHT_KINDS[0],
        _ => says.contains(word),
    };
    let (takes, others) = LIGHT_KINDS.into_iter().partition(takes);
    [takes, others]
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

/// Checks that each kind of light that a graph's document lists is `directional`, `spot` or
/// `point`. `name` is the graph's name for the message.
///
/// # Errors
/// Names the first unknown kind.
pub fn check(name: &str, graph: &Graph) -> Result<(), CompareError> {
    let unknown = |word: &&str| !LIGHT_KINDS.contains(word);
    let mut words = graph.lights().map(|word| word.as_str());
    match words.find(unknown) {
        None => Ok(()),
        Some(word) => Err(CompareError::Input(format!(
            "`{name}` takes the light `{word}`, which there is not{}\n  lights are {}",
            did_you_mean(word, LIGHT_KINDS.into_iter()),
            LIGHT_KINDS.join(", ")
        ))),
    }
}
