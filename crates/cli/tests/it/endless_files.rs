//! Files without end, and of more bytes than a machine has memory, wherever the command line takes
//! a file: refused at once.
#![cfg(target_os = "linux")]

use std::{fs, os::unix::fs::symlink, process::Command};

/// A graph that lights everything and is sure of it.
const LIT: &str = include_str!("support/lit.ron");

/// The commands, and the kind of file that stands where `FILE` does, with the most MiB that it may
/// have and the way out.
const COMMANDS: [(&str, &str, &str, [&str; 3]); 7] = [
    (
        "compare lit.ron --size 16x16 --beside P:FILE",
        "published.csv",
        "published.csv: ",
        [
            "a file of published figures",
            "16",
            "split it, and name each part",
        ],
    ),
    (
        "profile lit.ron --size 16x16 --baseline FILE",
        "old.json",
        "old.json: ",
        [
            "a profile",
            "256",
            "name one that `skiagraph profile --json FILE` wrote, of fewer --frames",
        ],
    ),
    (
        "compare lit.ron --size 16x16 --frames 1 --warmup 0 --out . --resume",
        "results.json",
        "./results.json: ",
        [
            "a results.json",
            "64",
            "take another folder (`--out`), or replace all that this one holds (`--replace`)",
        ],
    ),
    (
        "run lit.ron --size 16x16 --scene FILE",
        "garden.ron",
        "cannot read garden.ron: ",
        [
            "a scene file",
            "1",
            "a mesh belongs into an .obj file of its own",
        ],
    ),
    (
        "run lit.ron --size 16x16 --scene FILE --eye 0,2,8 --look 0,0,-1 --light 0.3,-1,-0.2",
        "house.obj",
        "cannot read house.obj: ",
        [
            "an .obj file",
            "2048",
            "split it, or leave groups out of it",
        ],
    ),
    (
        "judge FILE",
        "factor.exr",
        "factor.exr: ",
        [
            "a picture",
            "1024",
            "render it in fewer pixels, or save one channel",
        ],
    ),
    (
        "check FILE",
        "graph.ron",
        "cannot read `graph.ron`: ",
        [
            "a document or shader",
            "8",
            "split it into several (`Include`, `#import`), or let `repeat` say what is alike",
        ],
    ),
];

/// Returns the message of each command when its file was made by `make`.
fn said(make: impl Fn(&std::path::Path)) -> Vec<String> {
    let answer = |(line, file, begin, _): &(&str, &str, &str, [&str; 3])| {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("lit.ron"), LIT).unwrap();
        make(&folder.path().join(file));
        let line = line.replace("FILE", file);
        // A pipe that is opened blocks for ever, and a device is read until no memory is left.
        let limited = format!("ulimit -v 4000000; exec timeout 20 \"$0\" {line}");
        let output = Command::new("bash")
            .args(["-c", &limited, env!("CARGO_BIN_EXE_skiagraph")])
            .current_dir(&folder)
            .env("NO_COLOR", "1")
            .output()
            .unwrap();
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{line}: {text}");
        let at = text
            .find(begin)
            .unwrap_or_else(|| panic!("no {begin} in {text}"));
        text[at + begin.len()..].trim_end().to_owned()
    };
    COMMANDS.iter().map(answer).collect()
}

#[test]
fn a_file_of_four_gibibytes_is_refused_unread() {
    let messages = said(|file| fs::File::create(file).unwrap().set_len(4 << 30).unwrap());
    for (message, (line, _, _, [kind, mib, way_out])) in messages.iter().zip(&COMMANDS) {
        assert_eq!(
            *message,
            format!("it has 4096 MiB, {kind} {mib} at most: {way_out}"),
            "{line}"
        );
    }
}

#[test]
fn a_device_is_refused_unopened() {
    for message in said(|file| symlink("/dev/zero", file).unwrap()) {
        assert!(
            message.starts_with("it is a device, a pipe or a socket")
                && message.contains("copy its content into a file"),
            "{message}"
        );
    }
}

#[test]
fn a_pipe_is_refused_unopened() {
    for message in
        said(|file| assert!(Command::new("mkfifo").arg(file).status().unwrap().success()))
    {
        assert!(
            message.starts_with("it is a device, a pipe or a socket")
                && message.contains("copy its content into a file"),
            "{message}"
        );
    }
}
