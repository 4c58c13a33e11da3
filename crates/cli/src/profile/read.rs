//! Reading what `profile --json` wrote, for `--baseline`.

use crate::{
    error::{CliError, colour},
    profile::record::{KIND, Profile, Series},
};
use serde::Deserialize;
use serde_json::Value;
use skiagraph_graph::{Code, Diagnostic, SourceFile, diagnostics};
use std::{fs, path::Path};

/// Reads an older profile.
///
/// # Errors
/// A file that cannot be read, or that is no profile; with the place.
pub fn read(path: &Path) -> Result<Profile, CliError> {
    let text = fs::read_to_string(path)
        .map_err(|error| CliError::Input(format!("--baseline {}: {error}", path.display())))?;
    let file = SourceFile::new(path.display().to_string(), text);
    parse(&file).map_err(|fault| fault.in_file(&file))
}

/// What is wrong, at a byte of the text.
struct Fault {
    at: usize,
    what: String,
}

impl Fault {
    fn json(text: &str, error: &serde_json::Error) -> Self {
        // serde_json counts lines and, in bytes, columns from 1; an empty text has column 0.
        let lines = text.split_inclusive('\n').map(str::len);
        let before: usize = lines.take(error.line().saturating_sub(1)).sum();
        let message = error.to_string();
        let place = format!(" at line {} column {}", error.line(), error.column());
        Self {
            at: before + error.column().saturating_sub(1),
            what: message.strip_suffix(&place).unwrap_or(&message).to_owned(),
        }
    }

    /// At the first place where `field` is written, or at the begin of the file.
    fn at_field(text: &str, field: &str, what: String) -> Self {
        let at = text.find(field).unwrap_or(0);
        Self { at, what }
    }

    fn in_file(self, file: &SourceFile) -> CliError {
        // Rendering moves a place inside a character or behind the text to where it can be shown.
        let error = Diagnostic::error(
            Code::Syntax,
            format!(
                "`{}` is no profile to compare with: {}",
                file.name, self.what
            ),
        )
        .at(file.span(self.at..self.at + 1), "")
        .help("a baseline is what `skiagraph profile --json FILE` writes");
        CliError::Diagnostics {
            rendered: diagnostics::render(&[error], colour()),
            summary: "the baseline cannot be used".into(),
        }
    }
}

/// What kind of file it is. Any other one lacks many fields, and to name the first that is missing would mislead.
#[derive(Deserialize)]
struct Head {
    kind: Option<Value>,
    schema: Option<Value>,
}

fn parse(file: &SourceFile) -> Result<Profile, Fault> {
    let text = &*file.text;
    let head: Head = serde_json::from_str(text).map_err(|error| Fault::json(text, &error))?;
    if head.kind != Some(KIND.into()) {
        let what = match head.kind {
            Some(kind) => format!("the kind is {kind}, not \"{KIND}\""),
            None => format!("there is no \"kind\": \"{KIND}\" in it"),
        };
        return Err(Fault::at_field(text, "\"kind\"", what));
    }
    if head.schema != Some(1.into()) {
        let version = head.schema.unwrap_or_default();
        let what = format!("this program reads version 1 of the schema, not {version}");
        return Err(Fault::at_field(text, "\"schema\"", what));
    }
    let profile: Profile = serde_json::from_str(text).map_err(|error| Fault::json(text, &error))?;
    match unsound(&profile) {
        None => Ok(profile),
        Some(place) => Err(Fault::at_field(
            text,
            &place,
            "no samples here, or some that are no times".into(),
        )),
    }
}

/// How the JSON begins where something has samples that are no times.
fn unsound(profile: &Profile) -> Option<String> {
    let is_sound = |series: &Series| {
        let samples = &series.samples;
        !samples.is_empty() && samples.iter().all(|ms| ms.is_finite() && *ms >= 0.0)
    };
    let pass = profile.passes.iter().find(|pass| {
        let mut series = pass.gpu_ms.iter().chain([&pass.cpu_ms]);
        !series.all(is_sound)
    });
    if let Some(pass) = pass {
        return Some(format!("\"name\": \"{}\"", pass.name));
    }
    let frame = &profile.frame;
    let mut series = frame.gpu_ms.iter().chain([&frame.cpu_ms, &frame.wall_ms]);
    (!series.all(is_sound)).then(|| "\"frame\": {".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::record::tests::sample;

    fn refused(text: String) -> String {
        let file = SourceFile::new("old.json", text);
        let fault = parse(&file).expect_err("refused");
        let error = fault.in_file(&file);
        assert_eq!(error.exit_code(), 1);
        error.to_string()
    }

    #[test]
    fn what_json_writes_can_be_read() {
        let file = SourceFile::new("old.json", sample().to_json());
        assert!(parse(&file).is_ok_and(|profile| profile == sample()));
    }

    #[test]
    fn a_broken_baseline_is_shown_with_its_place() {
        let good = sample().to_json();
        let texts = [
            good.replacen("\"median\": 2.0", "\"median\": \"two\"", 1),
            good.replacen("\"kind\": \"profile\"", "\"kind\": \"results\"", 1),
            good.replacen("\"schema\": 1", "\"schema\": 2", 1),
            good.replacen("2.5,", "2.5", 1),
            "{\"schema\": 1, \"runs\": []}".to_owned(),
            String::new(),
            good.replacen("        4.0,\n        5.0,\n        4.5\n", "", 1),
            good.replacen("        2.0,", "        -2.0,", 1),
        ];
        assert!(texts.iter().all(|text| *text != good));
        insta::assert_snapshot!(texts.map(refused).join("\n"));
    }
}
