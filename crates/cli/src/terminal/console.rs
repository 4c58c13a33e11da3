//! Writes to standard output and standard error, with colours.

use crate::error::CliError;
use skiagraph_compare::error::{CompareError, advice, causes, io_advice, rendered};
use skiagraph_gpu::ExecuteError;
use std::io::{self, IsTerminal, Write};
use std::process::ExitCode;

/// True if standard error takes colours: it is a terminal, and `NO_COLOR` (<https://no-color.org>)
/// is not set.
pub fn colour() -> bool {
    io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}

/// Prints a message on standard error, without marking it as an error.
pub fn note(text: &str) {
    let _ = writeln!(io::stderr(), "{text}");
}

/// Prints text on standard output, without adding a newline.
pub fn print(text: &str) -> Result<(), CliError> {
    let mut stdout = io::stdout().lock();
    let written = stdout.write_all(text.as_bytes());
    let written = written.and_then(|()| stdout.flush());
    written.map_err(CliError::Stdout)
}

/// Prints an error with its causes on standard error, and returns the exit code of the process.
pub fn report(error: &CliError) -> ExitCode {
    let code = error.exit_code();
    if code != 0 {
        let mut text = match error {
            CliError::Compare(CompareError::Diagnostics { faults, summary }) => {
                rendered(faults, colour()) + summary
            }
            CliError::Interrupted { .. } => error.to_string(),
            _ if colour() => format!("\u{1b}[1;31merror:\u{1b}[0m {error}"),
            _ => format!("error: {error}"),
        };
        let mut line = |line: &str| text += &format!("\n  {}", line.replace('\n', "\n  "));
        for error in causes(error) {
            line(&format!("because: {error}"));
            if let Some(way_out) = error.downcast_ref().and_then(io_advice) {
                line(way_out);
            }
        }
        if let CliError::Compare(CompareError::Gpu { source, .. }) = error {
            if let Some(way_out) = advice(source) {
                line(way_out);
            }
            if let ExecuteError::OutOfMemory { table, .. } = &**source {
                line(table);
            }
        }
        // With standard error closed no place is left to tell it.
        note(&text);
    }
    ExitCode::from(code)
}
