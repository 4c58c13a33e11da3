//! `skiagraph doctor`: prints the abilities of this machine, and reasons for those that it lacks.

use crate::args::commands::{DoctorArgs, RecordFormat};
use crate::args::shared::GpuArgs;
use crate::error::CliError;
use crate::terminal::console::print;
use skiagraph_compare::files::json::to_text;
use skiagraph_compare::measuring::abilities::{abilities, adapters, meshes};
use skiagraph_compare::measuring::device::open;
use skiagraph_compare::records::abilities::line;

/// Prints the adapters, their limits and features, the check of timestamps, and the folders that
/// are searched for meshes.
///
/// # Errors
/// If no usable adapter was found; the rest is printed first.
pub fn doctor(args: &DoctorArgs, gpu: &GpuArgs) -> Result<(), CliError> {
    if args.format == RecordFormat::Json {
        return print(&to_text(&abilities(&open(&gpu.request(), &[])?)));
    }
    let mut text = String::from("Adapters\n");
    let adapters = adapters();
    text.extend(adapters.iter().map(|it| format!("  {}\n", line(it))));
    if adapters.is_empty() {
        text.push_str("  none\n");
    }
    print(&(text + &meshes()))?;
    print(&abilities(&open(&gpu.request(), &[])?).to_string())
}
