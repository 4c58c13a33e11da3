//! Errors that end a comparison early, with advice on what to do.
//!
//! ```
//! use skiagraph_compare::{error::with_causes, graphs::preset};
//! use skiagraph_passes::EmbeddedSources;
//!
//! let error = preset::locate("light_bufer", &EmbeddedSources).unwrap_err();
//! let text = with_causes(&error);
//! assert!(text.contains("light_buffer"), "{text}");
//! ```

use itertools::Itertools;
use skiagraph_gpu::ExecuteError;
use skiagraph_graph::{Diagnostic, diagnostics};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::{io, iter};

/// The outcome of a comparison, or of a part of it.
pub type Result<T, E = CompareError> = std::result::Result<T, E>;

/// Reason why a comparison, a step of one, or a command of `skiagraph` failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CompareError {
    /// Options or arguments that contradict each other or are not in the expected form. Holds the
    /// message.
    #[error("{0}")]
    Request(String),
    /// A file, name or value from the user that cannot be used. Holds the message.
    #[error("{0}")]
    Input(String),
    /// Faults in graphs or other files.
    #[error("{}{summary}", rendered(faults, false))]
    Diagnostics {
        /// One list of faults per graph or set of files, in the order in which they are shown.
        faults: Vec<Vec<Diagnostic>>,
        /// Last line of the message, such as `2 errors in 1 graph`.
        summary: String,
    },
    /// Graphs ran, but the size, format or values of their outputs are not those that a shadow
    /// method must have. Holds the message.
    #[error("{0}")]
    InvalidOutputs(String),
    /// No GPU adapter can be used. Holds the message.
    #[error("{0}")]
    NoGpu(String),
    /// A graph could not be run on the GPU.
    #[error("`{graph}` cannot run")]
    Gpu {
        /// Name of the preset or path of the graph.
        graph: String,
        /// Error with which the run of the graph ended.
        source: Box<ExecuteError>,
    },
    /// A file or folder that cannot be written.
    #[error("cannot write {}", path.display())]
    Write {
        /// The file or folder that cannot be written.
        path: PathBuf,
        /// The cause of the failure.
        source: Box<dyn Error + Send + Sync>,
    },
    /// The work ended early, because [`Sink::stop`](crate::sink::Sink::stop) asked for it.
    #[error("stopped; {kept}")]
    Interrupted {
        /// Text for the user that says which results are kept on disk; empty if the code that made
        /// the error does not know it.
        kept: String,
    },
}

impl CompareError {
    /// Creates the error for a failure to write `path`.
    pub fn write(path: &Path, source: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Self::Write {
            path: path.to_path_buf(),
            source: source.into(),
        }
    }

    /// True if no other method can run either: an early end, or a device that is unusable.
    pub fn ends_all(&self) -> bool {
        match self {
            Self::Interrupted { .. } => true,
            Self::Gpu { source, .. } => is_fatal(source),
            _ => false,
        }
    }

    /// Creates the error [`CompareError::Interrupted`] with an empty `kept`: only the caller knows
    /// which results are kept.
    pub fn interrupted() -> Self {
        Self::Interrupted {
            kept: String::new(),
        }
    }
}

/// Returns faults as text with the faulty source lines, in ANSI colours if `colour` is true. Each
/// list is of one graph or set of files, as in [`CompareError::Diagnostics`].
pub fn rendered(faults: &[Vec<Diagnostic>], colour: bool) -> String {
    let rendered = faults.iter().map(|list| diagnostics::render(list, colour));
    rendered.collect()
}

/// True if an error leaves the device unusable for every graph: the device is lost, or a frame was
/// given up ([`GpuRequest::timeout`](crate::measuring::device::GpuRequest::timeout)) before the GPU
/// had finished it.
pub fn is_fatal(error: &ExecuteError) -> bool {
    matches!(
        error,
        ExecuteError::DeviceLost(_) | ExecuteError::Unfinished { .. }
    )
}

/// Returns advice on how to avoid a GPU error; `None` if there is no advice for this error.
pub fn advice(error: &ExecuteError) -> Option<&'static str> {
    match error {
        ExecuteError::OutOfMemory { .. } => Some("use a smaller viewport or map"),
        ExecuteError::Unfinished { .. } => Some(
            "it was given up: a loop of one of its shaders may never end; if it only takes long, \
             give it a longer timeout, or none to wait for ever",
        ),
        ExecuteError::DeviceLost(_) => Some(
            "the driver resets a GPU that does not answer in time: a shader may never end, or \
             take too long for this GPU",
        ),
        _ => None,
    }
}

/// Returns advice on a file that cannot be written; `None` if there is no advice for this error.
pub fn io_advice(error: &io::Error) -> Option<&'static str> {
    use io::ErrorKind as Kind;
    Some(match error.kind() {
        Kind::StorageFull | Kind::QuotaExceeded | Kind::FileTooLarge => {
            "make room on the disk, or name a file or folder on another one"
        }
        Kind::PermissionDenied | Kind::ReadOnlyFilesystem => {
            "name a file or folder that you may write"
        }
        Kind::NotADirectory | Kind::AlreadyExists => {
            "a part of that path is a file, not a folder: name another one"
        }
        Kind::IsADirectory => "name a file, not a folder",
        _ => return None,
    })
}

/// Returns a GPU error, its causes and its [`advice`] in one line.
pub fn explain(error: &ExecuteError) -> String {
    let advice = advice(error).map(|advice| format!("; {advice}"));
    with_causes(error) + &advice.unwrap_or_default()
}

/// Iterates over the causes of an error, outermost first, without those whose text the text of the
/// error before contains.
pub fn causes<'e>(
    error: &'e (dyn Error + 'static),
) -> impl Iterator<Item = &'e (dyn Error + 'static)> {
    let pairs = iter::successors(Some((error.source(), error.to_string())), |(cause, _)| {
        let cause = (*cause)?;
        Some((cause.source(), cause.to_string()))
    });
    pairs.filter_map(|(cause, message)| cause.filter(|cause| !message.contains(&cause.to_string())))
}

/// Returns an error and its causes in one line, separated by colons.
pub fn with_causes(error: &(dyn Error + 'static)) -> String {
    let causes = causes(error).map(|cause| cause.to_string());
    iter::once(error.to_string()).chain(causes).join(": ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use skiagraph_gpu::ProviderError;

    #[test]
    fn out_of_memory_comes_with_advice_and_nothing_else_does() {
        let full = ExecuteError::OutOfMemory {
            name: "map".into(),
            table: String::new(),
        };
        assert!(explain(&full).ends_with("; use a smaller viewport or map"));
        let other = ExecuteError::Readback { name: "map".into() };
        assert_eq!(explain(&other), with_causes(&other));
    }

    #[test]
    fn a_cause_that_was_told_is_not_told_again() {
        let why = ProviderError::from_error(io::Error::other("the disk is gone"));
        let provider = ExecuteError::Provider {
            name: "scene.texels".into(),
            why,
        };
        let text = "the provided resource `scene.texels` could not be built: the disk is gone";
        assert_eq!(with_causes(&provider), text);
        let mut chain = iter::successors(provider.source(), |&error| error.source());
        assert!(chain.any(|cause| cause.is::<io::Error>()));
        let of_method = CompareError::Gpu {
            graph: "rt".into(),
            source: Box::new(provider),
        };
        assert_eq!(with_causes(&of_method), format!("`rt` cannot run: {text}"));
    }
}
