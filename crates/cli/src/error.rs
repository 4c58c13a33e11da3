//! Everything that can end a command early, with its exit code.

use skiagraph_compare::error::{CompareError, is_fatal};
use std::{error::Error, io};

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
    /// A scene that cannot be loaded.
    #[error("cannot load the scene `{name}`")]
    Scene {
        /// As given on the command line.
        name: String,
        /// Why.
        source: Box<dyn Error + Send + Sync>,
    },
    /// Methods or cases that are not as they must be; which ones was printed before.
    #[error("{0}")]
    Judged(String),
    /// A figure is beyond a condition of `--fail-if`.
    #[error("{0}")]
    Gate(String),
    /// Standard output is closed or full.
    #[error("cannot write to standard output")]
    Stdout(#[source] io::Error),
    /// Ctrl-C.
    #[error("stopped by Ctrl-C; {kept}")]
    Interrupted {
        /// The part of the work so far that is kept.
        kept: String,
    },
    /// All else that ends a comparison.
    #[error(transparent)]
    Compare(CompareError),
}

impl From<CompareError> for CliError {
    fn from(error: CompareError) -> Self {
        match error {
            CompareError::Request(text) => Self::Usage(text),
            CompareError::Input(text) => Self::Input(text),
            CompareError::Interrupted { kept } => Self::Interrupted { kept },
            error => Self::Compare(error),
        }
    }
}

impl CliError {
    /// The process's exit code.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_) => 2,
            Self::Compare(CompareError::NoGpu(_)) => 3,
            Self::Compare(CompareError::Gpu { source, .. }) if is_fatal(source) => 3,
            Self::Gate(_) => 4,
            Self::Interrupted { .. } => 130,
            // The reader had enough, for example `skiagraph presets | head -1`.
            Self::Stdout(cause) if cause.kind() == io::ErrorKind::BrokenPipe => 0,
            _ => 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exit_codes_are_the_documented_ones() {
        let pipe = CliError::Stdout(io::ErrorKind::BrokenPipe.into());
        let full = CliError::Stdout(io::ErrorKind::StorageFull.into());
        let lost = CompareError::Gpu {
            graph: "rt".into(),
            source: Box::new(skiagraph_gpu::ExecuteError::DeviceLost("reset".into())),
        };
        let codes = [
            (pipe, 0),
            (full, 1),
            (CliError::Input("x".into()), 1),
            (CompareError::Request("x".into()).into(), 2),
            (CompareError::NoGpu("x".into()).into(), 3),
            (lost.into(), 3),
            (CliError::Gate("x".into()), 4),
            (CompareError::interrupted().into(), 130),
        ];
        for (error, code) in codes {
            assert_eq!(error.exit_code(), code, "{error:?}");
        }
    }
}
