//! `skiagraph schema`: prints the schema of graph documents and scene files, for editors and
//! readers.

use crate::args::commands::{SchemaArgs, SchemaFormat, SchemaOf};
use crate::error::CliError;
use crate::terminal::console::print;
use skiagraph_report::language;

/// Prints the JSON Schema of documents or scene files, or the same as a reference in Markdown.
///
/// # Errors
/// If standard output cannot be written.
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
