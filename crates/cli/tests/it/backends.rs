//! Adapters by their backend: asked for, listed, and what is said where there is none. And what a
//! driver's own checks say of what is run.

use crate::support::skiagraph;
use std::{
    path::Path,
    process::{Command, Output},
};

fn doctor(line: &str, variable: Option<&str>) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_skiagraph"));
    command.args(line.split_whitespace()).env("NO_COLOR", "1");
    match variable {
        Some(words) => command.env("WGPU_BACKEND", words),
        None => command.env_remove("WGPU_BACKEND"),
    };
    command
        .output()
        .expect("the program was built for this test")
}

/// No system has both, so one of them is not there on any.
const ABSENT: &str = if cfg!(target_vendor = "apple") {
    "dx12"
} else {
    "metal"
};

#[test]
fn a_backend_that_is_not_there_is_an_error_that_lists_what_is() {
    for (line, variable) in [
        (format!("--backend {ABSENT} doctor"), None),
        (format!("doctor --backend {ABSENT}"), Some("vulkan")),
        ("doctor".to_owned(), Some(ABSENT)),
        ("doctor".to_owned(), Some("nonsense")),
    ] {
        let output = doctor(&line, variable);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(
            output.status.code(),
            Some(3),
            "{line}, {variable:?}: {stderr}"
        );
        let named = variable.filter(|_| line == "doctor").unwrap_or(ABSENT);
        assert!(
            stderr.contains(&format!("of the backend `{named}`")),
            "{stderr}"
        );
        assert!(stderr.contains("there are: "), "{stderr}");
    }
}

#[test]
fn each_adapter_is_listed_with_its_backend() {
    let output = doctor("doctor", None);
    let stdout = String::from_utf8_lossy(&output.stdout);
    let chosen = stdout
        .lines()
        .find_map(|line| line.strip_prefix("Chosen: "));
    let chosen = chosen.unwrap_or_else(|| panic!("{stdout}"));
    let backend = chosen.split(" · ").nth(1).unwrap_or_default();
    assert!(["vulkan", "metal", "dx12"].contains(&backend), "{chosen}");
    // The same, asked for by name and by variable.
    for (line, variable) in [
        (format!("doctor --backend {backend}"), None),
        ("doctor".to_owned(), Some(backend)),
    ] {
        let output = doctor(&line, variable);
        let again = String::from_utf8_lossy(&output.stdout);
        assert!(again.contains(&format!("Chosen: {chosen}")), "{again}");
    }
    let help = skiagraph(Path::new("."), "doctor --help");
    let help = String::from_utf8_lossy(&help.stdout);
    assert!(help.contains("--backend"), "{help}");

    // A driver's words choose its adapter, and are listed where no adapter has the name.
    let fields: Vec<&str> = chosen.split(" · ").collect();
    let (name, driver) = (fields[0], fields[3]);
    let version = driver.rsplit(' ').find(|word| !name.contains(word));
    let version = version.unwrap_or(driver).to_uppercase();
    for (asked, code, words) in [
        (version.as_str(), 0, format!("Chosen: {chosen}")),
        (
            "nothing-like-it",
            3,
            format!("{name} ({backend}, {driver})"),
        ),
    ] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_skiagraph"));
        let output = command.args(["doctor", "--backend", backend, "--adapter", asked]);
        let output = output
            .output()
            .expect("the program was built for this test");
        let text = String::from_utf8_lossy(&[output.stdout, output.stderr].concat()).into_owned();
        assert_eq!(output.status.code(), Some(code), "{asked}: {text}");
        assert!(text.contains(&words), "{asked}: {text}");
    }
}

/// Checks runs with the validation layer of Chromium's package: .ci/long does so with every preset.
#[cfg(target_os = "linux")]
#[test]
fn validation_finds_nothing_but_what_is_known() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let output = Command::new("python3")
        .arg(root.join("scripts/validation.py"))
        .arg(env!("CARGO_BIN_EXE_skiagraph"))
        .args(["light_buffer", "nsm", "--size", "32x32"])
        .output()
        .expect("python3 is installed");
    let streams = [output.stdout, output.stderr].concat();
    let streams = String::from_utf8_lossy(&streams);
    assert!(output.status.success(), "{streams}");
    assert!(streams.contains("0 of them not expected"), "{streams}");
}
