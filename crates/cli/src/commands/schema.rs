//! `skiagraph schema`: what documents and scene files may be, for editors and for readers.

use crate::args::commands::{SchemaArgs, SchemaFormat, SchemaOf};
use crate::error::CliError;
use crate::terminal::console::print;
use skiagraph_report::language;
use skiagraph_scene::scene_schema;

/// Prints a JSON Schema, or the reference of the language.
///
/// # Errors
/// Standard output.
pub fn schema(args: &SchemaArgs) -> Result<(), CliError> {
    let schema = match args.of {
        SchemaOf::Documents => skiagraph_passes::registry().schema(),
        SchemaOf::Scenes => scene_schema(),
    };
    print(&match (args.format, args.of) {
        (SchemaFormat::Json, _) => format!("{schema:#}\n"),
        (SchemaFormat::Markdown, SchemaOf::Documents) => language::markdown(&schema),
        (SchemaFormat::Markdown, SchemaOf::Scenes) => language::scenes(&schema),
    })
}
