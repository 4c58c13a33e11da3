//! `skiagraph adapter`: asks one adapter everything, each row in a process of its own.

use crate::args::commands::AdapterArgs;
use crate::args::shared::GpuArgs;
use crate::error::CliError;
use crate::terminal::{Terminal, console::print, interrupt};
use skiagraph_compare::adapters::running::{AdapterRequest, run};
use std::time::Duration;

/// Runs the rows that the folder lacks, and says where they are.
///
/// # Errors
/// If no adapter can be opened, the folder is of another one, Ctrl-C stops the command, or a file
/// cannot be written. Rows that fail are no error.
pub fn adapter(args: &AdapterArgs, gpu: &GpuArgs) -> Result<(), CliError> {
    let program = std::env::current_exe()
        .map_err(|error| CliError::Input(format!("cannot find this program: {error}")))?;
    let mut request = AdapterRequest::new(program);
    request.arguments = gpu.words();
    request.out.clone_from(&args.out);
    request.limit = Duration::from_secs(60 * args.minutes);
    (request.is_small, request.again) = (args.small, args.again);
    request.only.clone_from(&args.only);
    request.commit = option_env!("SKIAGRAPH_COMMIT").map(str::to_owned);
    interrupt::install()?;
    let finished = run(&request, &Terminal)?;
    let folder = finished.folder.display();
    if !finished.left.is_empty() {
        let left = finished.left.join(", ");
        print(&format!(
            "not finished: {left}; run the same command again\n"
        ))?;
    }
    print(&format!("the folder to hand in: {folder}\n"))
}
