//! Everything that can end a comparison early, with the way out.
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
use std::{
    error::Error,
    io, iter,
    path::{Path, PathBuf},
};

/// Why work ended early.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CompareError {
    /// A request whose parts do not go together, or that is not written as it must be.
    #[error("{0}")]
    Request(String),
    /// A file, name or value from the user that cannot be used as asked.
    #[error("{0}")]
    Input(String),
    /// Faults in files, in the order in which these were named.
    #[error("{}{summary}", rendered(faults, false))]
    Diagnostics {
        /// The faults of each file.
        faults: Vec<Vec<Diagnostic>>,
        /// One sentence for the end.
        summary: String,
    },
    /// Graphs that ran, but whose outputs do not hold what a shadow method's must.
    #[error("{0}")]
    InvalidOutputs(String),
    /// No adapter to run on.
    #[error("{0}")]
    NoGpu(String),
    /// A graph that the GPU would not run.
    #[error("`{graph}` cannot run")]
    Gpu {
        /// Name of the preset or path of the graph.
        graph: String,
        /// Why.
        source: Box<ExecuteError>,
    },
    /// A file or folder that cannot be written.
    #[error("cannot write {}", path.display())]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// Why.
        source: Box<dyn Error + Send + Sync>,
    },
    /// [`Sink::stop`](crate::sink::Sink::stop) was raised.
    #[error("stopped; {kept}")]
    Interrupted {
        /// The part of the work so far that is kept.
        kept: String,
    },
}

impl CompareError {
    /// A failure to write `path`.
    pub fn write(path: &Path, source: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Self::Write {
            path: path.to_path_buf(),
            source: source.into(),
        }
    }

    /// An early end, where only the caller knows what is kept.
    pub fn interrupted() -> Self {
        Self::Interrupted {
            kept: String::new(),
        }
    }
}

/// Faults with their source lines, coloured for a terminal or not.
pub fn rendered(faults: &[Vec<Diagnostic>], colour: bool) -> String {
    let rendered = faults.iter().map(|list| diagnostics::render(list, colour));
    rendered.collect()
}

/// True if the device is of no more use after an error, for any graph.
pub fn is_fatal(error: &ExecuteError) -> bool {
    matches!(
        error,
        ExecuteError::DeviceLost(_) | ExecuteError::Unfinished { .. }
    )
}

/// Advises how to avert an error.
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

/// Advises what to do about a file that cannot be written.
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

/// An error, its causes and what may avert it in one line.
pub fn explain(error: &ExecuteError) -> String {
    let text = with_causes(error);
    match advice(error) {
        Some(advice) => format!("{text}; {advice}"),
        None => text,
    }
}

/// An error and its causes in one line.
pub fn with_causes(error: &(dyn Error + 'static)) -> String {
    iter::successors(Some(error), |&error| error.source()).join(": ")
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
