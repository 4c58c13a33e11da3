//! `skiagraph schema`: what documents and scene files may be, for editors and for readers.

use crate::args::commands::{SchemaArgs, SchemaFormat, SchemaOf};
use crate::error::CliError;
use crate::terminal::console::print;
use skiagraph_report::language;

/// Prints a JSON Schema, or the reference of the language.
///
/// # Errors
/// Standard output.
pub fn schema(args: &SchemaArgs) -> Result<(), CliError> {
    let schema = match args.of {
        SchemaOf::Documents => skiagraph_graph::schema(&skiagraph_passes::registry()),
        SchemaOf::Scenes => skiagraph_scene::schema(),
    };
    print(&match (args.format, args.of) {
        (SchemaFormat::Json, _) => format!("{schema:#}\n"),
        (SchemaFormat::Markdown, SchemaOf::Documents) => language::markdown(&schema),
        (SchemaFormat::Markdown, SchemaOf::Scenes) => language::scenes(&schema),
    })
}
