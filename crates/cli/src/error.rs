//! Errors that end a command early, with their exit codes.

use crate::terminal::stop;
use skiagraph_compare::error::{CompareError, is_fatal};
use std::{error::Error, io};

/// Reasons why a command ended early.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CliError {
    /// Arguments that are valid one by one but not together. Holds the message.
    #[error("{0}\n\nFor more information, try '--help'.")]
    Usage(String),
    /// A file, name or value of the user that cannot be used. Holds the message.
    #[error("{0}")]
    Input(String),
    /// A scene that cannot be loaded.
    #[error("cannot load the scene `{name}`")]
    Scene {
        /// Name of the scene, as on the command line.
        name: String,
        /// Error of the scene's files.
        source: Box<dyn Error + Send + Sync>,
    },
    /// Methods or cases that failed their check, which the output names. Holds the message.
    #[error("{0}")]
    Judged(String),
    /// A figure beyond a limit of `--fail-if`. Holds the message.
    #[error("{0}")]
    Gate(String),
    /// A method that has become more wrong or slower than in `--baseline`. Holds the message.
    #[error("{0}")]
    Baseline(String),
    /// A write to standard output failed.
    #[error("cannot write to standard output")]
    Stdout(#[source] io::Error),
    /// Ctrl-C stopped the command.
    #[error("stopped by Ctrl-C; {kept}")]
    Interrupted {
        /// Results that were kept, as text for the user.
        kept: String,
    },
    /// Any other error of the measuring library.
    #[error(transparent)]
    Compare(CompareError),
}

impl From<CompareError> for CliError {
    fn from(error: CompareError) -> Self {
        match error {
            CompareError::Request(text) => Self::Usage(text),
            CompareError::Input(text) => Self::Input(text),
            CompareError::Interrupted { kept } => {
                // Results are written next, which is not to be cut off.
                stop::raised();
                Self::Interrupted { kept }
            }
            error => Self::Compare(error),
        }
    }
}

impl CliError {
    /// Returns the exit code of the process; 0 if only the reader of standard output has gone.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_) => 2,
            Self::Compare(CompareError::NoGpu(_)) => 3,
            Self::Compare(CompareError::Gpu { source, .. }) if is_fatal(source) => 3,
            Self::Gate(_) => 4,
            Self::Baseline(_) => 5,
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
            (CliError::Baseline("x".into()), 5),
            (CompareError::interrupted().into(), 130),
        ];
        for (error, code) in codes {
            assert_eq!(error.exit_code(), code, "{error:?}");
        }
    }
}
