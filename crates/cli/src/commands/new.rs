//! `skiagraph new`: writes a small method to start from, or a variant of a preset.

use crate::args::commands::NewArgs;
use crate::error::CliError;
use crate::terminal::{Terminal, console::print};
use skiagraph_compare::files::write::write_new;
use skiagraph_compare::graphs::preset;
use skiagraph_graph::{Param, Sources};
use std::{fs, path::Path};

const DOCUMENT: &str = include_str!("../../templates/method.ron");
const SHADER: &str = include_str!("../../templates/method.wgsl");
const VARIANT: &str = include_str!("../../templates/variant.ron");

/// Writes `NAME.ron` into the working directory, and `NAME.wgsl` as well unless the method is a
/// variant of a preset.
///
/// # Errors
/// If the name is invalid or taken, the preset is unknown, or a file cannot be written.
pub fn new(args: &NewArgs) -> Result<(), CliError> {
    let name = &args.name;
    check_name(name)?;
    let files = match &args.from {
        Some(preset) => vec![(format!("{name}.ron"), variant(name, preset)?)],
        None => vec![
            (format!("{name}.ron"), DOCUMENT.replace("METHOD", name)),
            (format!("{name}.wgsl"), SHADER.replace("METHOD", name)),
        ],
    };
    write_all(&files)?;
    let names: Vec<&str> = files.iter().map(|(file, _)| file.as_str()).collect();
    let beside = args.from.as_deref().unwrap_or("nsm");
    print(&format!(
        "wrote {}\n  skiagraph check {name}.ron\n  skiagraph compare rt {beside} {name}.ron \
         --scene park --size 256x256\n",
        names.join(" and ")
    ))
}

/// Documents and shaders look beside themselves first: a name that is built in would hide that.
fn check_name(name: &str) -> Result<(), CliError> {
    let fits = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    if !name.starts_with(|c: char| c.is_ascii_lowercase()) || !name.chars().all(fits) {
        return Err(CliError::Usage(format!(
            "`{name}` cannot name a method; a name is a lowercase letter, then lowercase letters, \
             digits and `_`, and the files get their endings by themselves"
        )));
    }
    let sources = preset::sources(&Terminal);
    for (folder, ending) in [("pipelines", "ron"), ("shaders", "wgsl")] {
        let path = format!("{folder}/{name}.{ending}");
        let taken = "is there already, here or built in; take another name";
        match sources.read(&path) {
            Ok(None) => {}
            Ok(Some(_)) => return Err(CliError::Input(format!("`{path}` {taken}"))),
            Err(why) => return Err(CliError::Input(format!("cannot read `{path}`: {why}"))),
        }
    }
    Ok(())
}

/// A document that extends the preset, with a line for each of its params.
fn variant(name: &str, from: &str) -> Result<String, CliError> {
    let sources = preset::sources(&Terminal);
    // A path is no preset's name: what extends a file in another folder is not found from here.
    if from.contains(['/', '\\', '.']) {
        return Err(CliError::Usage(format!(
            "--from takes the name of a preset, not `{from}`; `skiagraph presets` lists them"
        )));
    }
    let loaded = preset::load_all(&[from.to_owned()], &sources)?;
    let params = preset::graphs(&loaded).flat_map(|graph| graph.params());
    let lines: String = params.map(line_of).collect();
    let text = VARIANT.replace("METHOD", name).replace("PRESET", from);
    Ok(text.replace("PARAMS", &lines))
}

/// A param at its default, as a comment.
fn line_of(param: &Param) -> String {
    let value = match param.default.as_ref().map(|value| value.text()) {
        None => "…".to_owned(),
        Some(text) if is_literal(text) => text.to_owned(),
        Some(text) => format!("\"{text}\""),
    };
    let about = match param.description.as_str() {
        "" => String::new(),
        text => format!(": {text}"),
    };
    let (name, ty) = (param.name.as_str(), &param.ty);
    format!("        // \"{name}\": {value}, // {ty}{about}\n")
}

/// True if a value stands for itself: numbers, a vector of them, a word; else it is an expression
/// and stands in quotes.
fn is_literal(text: &str) -> bool {
    let is_word = text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    let numbers = text.trim_start_matches('(').trim_end_matches(')');
    let is_number = |part: &str| part.trim().parse::<f64>().is_ok();
    is_word || numbers.split(',').all(is_number)
}

/// All files or none, and none that is there already.
fn write_all(files: &[(String, String)]) -> Result<(), CliError> {
    let is_there = |file: &str| {
        let text = format!("there is a `{file}` already; take another name, or move it away");
        CliError::Input(text)
    };
    let mut names = files.iter().map(|(file, _)| file);
    if let Some(file) = names.find(|file| fs::symlink_metadata(file).is_ok()) {
        return Err(is_there(file));
    }
    for (index, (file, text)) in files.iter().enumerate() {
        let error = match write_new(Path::new(file), text.as_bytes()) {
            Ok(true) => continue,
            // By another process, just now.
            Ok(false) => is_there(file),
            Err(error) => error.into(),
        };
        for (written, _) in &files[..index] {
            // The next attempt names a file that is left behind if even this fails.
            let _ = fs::remove_file(written);
        }
        return Err(error);
    }
    Ok(())
}
