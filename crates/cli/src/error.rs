//! Everything that can end a command early, with its exit code and the way out.

use skiagraph_gpu::ExecuteError;
use std::{
    error::Error,
    io,
    path::{Path, PathBuf},
};

/// Why a command ended early.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CliError {
    /// Arguments that clap accepts one by one but that do not go together.
    #[error("{0}\n\nFor more information, try '--help'.")]
    Usage(String),
    /// A file, name or value from the user that cannot be used as asked.
    #[error("{0}")]
    Input(String),
    /// Faults in graphs; rendered, in the order of the command line.
    #[error("{rendered}{summary}")]
    Diagnostics {
        /// All faults with their source lines.
        rendered: String,
        /// One sentence for the end.
        summary: String,
    },
    /// A scene that cannot be loaded.
    #[error("cannot load the scene `{name}`")]
    Scene {
        /// As given on the command line.
        name: String,
        /// Why.
        source: Box<dyn Error + Send + Sync>,
    },
    /// Graphs that ran, but whose outputs do not hold what a shadow method's must.
    #[error("{0}")]
    InvalidOutputs(String),
    /// Methods or cases that are not as they must be; which ones was printed before.
    #[error("{0}")]
    Judged(String),
    /// No adapter to run on.
    #[error("{0}")]
    NoGpu(String),
    /// A graph that the GPU would not run.
    #[error("`{graph}` cannot run")]
    Gpu {
        /// Name of the preset or path of the graph.
        graph: String,
        /// Why.
        source: Box<dyn Error + Send + Sync>,
    },
    /// A file or folder that cannot be written.
    #[error("cannot write {}", path.display())]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// Why.
        source: Box<dyn Error + Send + Sync>,
    },
    /// Standard output is closed or full.
    #[error("cannot write to standard output")]
    Stdout(#[source] io::Error),
    /// Ctrl-C.
    #[error("stopped by Ctrl-C; {kept}")]
    Interrupted {
        /// The part of the work so far that is kept.
        kept: String,
    },
}

impl CliError {
    /// A failure to write `path`.
    pub fn write(path: &Path, source: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Self::Write {
            path: path.to_path_buf(),
            source: source.into(),
        }
    }

    /// Ctrl-C, where only the caller knows what is kept.
    pub fn interrupted() -> Self {
        Self::Interrupted {
            kept: String::new(),
        }
    }

    /// The process's exit code.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_) => 2,
            Self::NoGpu(_) => 3,
            Self::Gpu { source, .. } if is_fatal(source.as_ref()) => 3,
            Self::Interrupted { .. } => 130,
            // The reader had enough, for example `skiagraph presets | head -1`.
            Self::Stdout(cause) if cause.kind() == io::ErrorKind::BrokenPipe => 0,
            _ => 1,
        }
    }
}

/// True if the device is of no more use after an error, for any graph.
pub fn is_fatal(error: &(dyn Error + 'static)) -> bool {
    matches!(
        error.downcast_ref(),
        Some(ExecuteError::DeviceLost(_) | ExecuteError::Unfinished { .. })
    )
}

/// Which arguments may avert an error.
pub fn advice(error: &(dyn Error + 'static)) -> Option<&'static str> {
    match error.downcast_ref() {
        Some(ExecuteError::OutOfMemory { .. }) => Some("use a smaller --size or --map-size"),
        Some(ExecuteError::Unfinished { .. }) => Some(
            "it was given up: a loop of one of its shaders may never end; if it only takes long, \
             give it a larger --timeout, or --timeout 0 to wait for ever",
        ),
        Some(ExecuteError::DeviceLost(_)) => Some(
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
pub fn explain(error: &(dyn Error + 'static)) -> String {
    let text = with_causes(error);
    match advice(error) {
        Some(advice) => format!("{text}; {advice}"),
        None => text,
    }
}

/// An error and its causes in one line.
pub fn with_causes(error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        text += &format!(": {error}");
        cause = error.source();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exit_codes_are_the_documented_ones() {
        let pipe = CliError::Stdout(io::ErrorKind::BrokenPipe.into());
        let full = CliError::Stdout(io::ErrorKind::StorageFull.into());
        let codes = [
            (pipe, 0),
            (full, 1),
            (CliError::Input("x".into()), 1),
            (CliError::Usage("x".into()), 2),
            (CliError::NoGpu("x".into()), 3),
            (CliError::interrupted(), 130),
        ];
        for (error, code) in codes {
            assert_eq!(error.exit_code(), code, "{error:?}");
        }
    }

    #[test]
    fn out_of_memory_comes_with_advice_and_nothing_else_does() {
        let full = ExecuteError::OutOfMemory {
            name: "map".into(),
            table: String::new(),
        };
        assert!(explain(&full).ends_with("; use a smaller --size or --map-size"));
        let other = ExecuteError::Readback { name: "map".into() };
        assert_eq!(explain(&other), with_causes(&other));
    }
}
