//! Everything that can end a command early, with its exit code.

use crate::render;
use skiagraph_graph::{Diagnostic, ExecuteError, Severity};
use std::{
    error::Error,
    io::{self, IsTerminal, Write},
    path::{Path, PathBuf},
    process::ExitCode,
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
    Contract(String),
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
        /// What of the work so far is still there.
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

    /// The process's exit code.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_) => 2,
            Self::NoGpu(_) => 3,
            Self::Gpu { source, .. } if render::is_fatal(source.as_ref()) => 3,
            Self::Interrupted { .. } => 130,
            // The reader had enough, for example `skiagraph presets | head -1`.
            Self::Stdout(cause) if cause.kind() == io::ErrorKind::BrokenPipe => 0,
            _ => 1,
        }
    }

    /// Prints the error and its chain of causes on standard error and returns the exit code.
    pub fn report(&self) -> ExitCode {
        let code = self.exit_code();
        if code != 0 {
            let mut text = match self {
                Self::Diagnostics { .. } | Self::Interrupted { .. } => self.to_string(),
                _ => format!("{} {self}", style("error:", "1;31")),
            };
            let mut cause = self.source();
            while let Some(error) = cause {
                text.push_str(&format!(
                    "\n  because: {}",
                    error.to_string().replace('\n', "\n  ")
                ));
                if let Some(advice) = error.downcast_ref().and_then(way_out) {
                    text.push_str(&format!("\n  {advice}"));
                }
                cause = error.source();
            }
            if let Self::Gpu { source, .. } = self {
                if let Some(advice) = render::advice(source.as_ref()) {
                    text.push_str(&format!("\n  {advice}"));
                }
                if let Some(ExecuteError::OutOfMemory { table, .. }) = source.downcast_ref() {
                    text.push_str(&format!("\n  {}", table.replace('\n', "\n  ")));
                }
            }
            // With standard error closed there is nobody left to tell.
            let _ = writeln!(io::stderr(), "{text}");
        }
        ExitCode::from(code)
    }
}

/// What to do about a file that cannot be written.
fn way_out(error: &io::Error) -> Option<&'static str> {
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

/// Whether standard error takes colour: a terminal, and <https://no-color.org> not asked for.
pub fn colour() -> bool {
    io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}

/// `text` in an ANSI style where standard error takes it.
pub fn style(text: &str, code: &str) -> String {
    if colour() {
        format!("\u{1b}[{code}m{text}\u{1b}[0m")
    } else {
        text.to_string()
    }
}

/// How many of the diagnostics are errors.
pub fn count_errors<'a>(diagnostics: impl Iterator<Item = &'a Diagnostic>) -> usize {
    diagnostics
        .filter(|diagnostic| diagnostic.severity == Severity::Error)
        .count()
}

/// A line on standard error that is not an error.
pub fn note(text: &str) {
    let _ = writeln!(io::stderr(), "{text}");
}

/// Prints on standard output.
pub fn print(text: &str) -> Result<(), CliError> {
    let mut stdout = io::stdout().lock();
    stdout
        .write_all(text.as_bytes())
        .and_then(|()| stdout.flush())
        .map_err(CliError::Stdout)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exit_codes_are_the_documented_ones() {
        let pipe = CliError::Stdout(io::ErrorKind::BrokenPipe.into());
        let full = CliError::Stdout(io::ErrorKind::StorageFull.into());
        let interrupted = CliError::Interrupted {
            kept: "nothing".into(),
        };
        let codes = [
            (pipe, 0),
            (full, 1),
            (CliError::Input("x".into()), 1),
            (CliError::Usage("x".into()), 2),
            (CliError::NoGpu("x".into()), 3),
            (interrupted, 130),
        ];
        for (error, code) in codes {
            assert_eq!(error.exit_code(), code, "{error:?}");
        }
    }
}
