//! `skiagraph schema`: what documents may be, for editors and for readers.

use crate::args::commands::{SchemaArgs, SchemaFormat};
use crate::error::CliError;
use crate::terminal::console::print;
use skiagraph_report::language;

/// Prints the JSON Schema of documents, or the reference of the language.
///
/// # Errors
/// Standard output.
pub fn schema(args: &SchemaArgs) -> Result<(), CliError> {
    let schema = skiagraph_graph::schema(&skiagraph_passes::registry());
    match args.format {
        SchemaFormat::Json => print(&format!("{schema:#}\n")),
        SchemaFormat::Markdown => print(&language::markdown(&schema)),
    }
}
