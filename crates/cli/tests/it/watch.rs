//! `check --watch`: again after every change, until Ctrl-C.
#![cfg(unix)]

use crate::support::skiagraph;
use std::{
    fs,
    io::{BufRead, BufReader, Read},
    process::{Command, Stdio},
};

#[test]
fn a_mistake_and_its_mending_are_told_as_they_are_saved() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    assert!(skiagraph(folder, "new mine").status.success());
    let mut child = Command::new(env!("CARGO_BIN_EXE_skiagraph"))
        .args(["check", "mine.ron", "--watch"])
        .current_dir(folder)
        .env("NO_COLOR", "1")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut out = BufReader::new(child.stdout.take().unwrap()).lines();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    let mut fine = || {
        let line = out.next().unwrap().unwrap();
        assert!(line.starts_with("mine.ron: fine, "), "{line}");
    };
    fine();

    let shader = folder.join("mine.wgsl");
    let good = fs::read_to_string(&shader).unwrap();
    fs::write(&shader, good.replace("params.bias", "params.baas")).unwrap();
    let mut seen = String::new();
    while !seen.contains("baas") {
        let mut line = String::new();
        assert_ne!(
            stderr.read_line(&mut line).unwrap(),
            0,
            "it has ended: {seen}"
        );
        seen += &line;
    }
    fs::write(&shader, &good).unwrap();
    fine();

    let id = child.id().to_string();
    assert!(
        Command::new("kill")
            .args(["-INT", &id])
            .status()
            .unwrap()
            .success()
    );
    let mut rest = String::new();
    stderr.read_to_string(&mut rest).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(0), "{rest}");
}
