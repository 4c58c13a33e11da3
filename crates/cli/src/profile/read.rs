//! Reading what `profile --json` wrote, for `--baseline`.

use crate::{
    error::CliError,
    fault::Fault,
    profile::record::{KIND, Profile, Series},
};
use serde::Deserialize;
use serde_json::Value;
use skiagraph_graph::SourceFile;
use skiagraph_scene::Limit;
use std::path::Path;

/// The most frames that can be asked for, of fifty passes.
const PROFILE: Limit = Limit {
    of: "a profile",
    mib: 256,
    way_out: "name one that `skiagraph profile --json FILE` wrote, of fewer --frames",
};

/// Reads an older profile.
///
/// # Errors
/// A file that cannot be read, or that is no profile; with the place.
pub fn read(path: &Path) -> Result<Profile, CliError> {
    let text = PROFILE
        .read_text(path)
        .map_err(|error| CliError::Input(format!("--baseline {}: {error}", path.display())))?;
    let file = SourceFile::new(path.display().to_string(), text);
    parse(&file).map_err(|fault| shown(fault, &file))
}

fn shown(fault: Fault, file: &SourceFile) -> CliError {
    let help = "a baseline is what `skiagraph profile --json FILE` writes";
    fault.in_file(
        file,
        "profile to compare with",
        help,
        "the baseline cannot be used",
    )
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
        let error = shown(fault, &file);
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
