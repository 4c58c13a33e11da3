//! Tells the program the commit that it is built from, as `SKIAGRAPH_COMMIT`: of a package the one
//! that cargo has noted in it, else the one that is checked out. Without both there is none.
//! Changes that are not committed do not show.

use std::{fs, path::PathBuf, process::Command};

/// Name of the file in which `cargo package` notes the repository's commit.
const NOTE: &str = ".cargo_vcs_info.json";

/// The folder of this crate in its repository.
const OWN: &str = "crates/cli/";

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if let Some(commit) = packaged().or_else(checked_out) {
        println!("cargo::rustc-env=SKIAGRAPH_COMMIT={commit}");
    }
}

/// The commit of a package.
fn packaged() -> Option<String> {
    let note = fs::read_to_string(NOTE).ok()?;
    let (_, behind) = note.split_once("\"sha1\"")?;
    let hash = behind.split('"').nth(1)?;
    is_hash(hash).then(|| hash.to_owned())
}

/// The commit of the repository around; `None` in a repository of something else, as a package in a
/// user's home may lie in one.
fn checked_out() -> Option<String> {
    if git(&["rev-parse", "--show-prefix"])? != OWN {
        return None;
    }
    // HEAD names a branch, whose file changes with each commit. If branches are packed it has none,
    // and the next commit makes one in that folder.
    let branch = git(&["rev-parse", "--symbolic-full-name", "HEAD"])?;
    let place = |name: &str| git(&["rev-parse", "--git-path", name]).map(PathBuf::from);
    let (head, packed, branch) = (place("HEAD")?, place("packed-refs")?, place(&branch)?);
    let branch = match branch.parent() {
        Some(folder) if !branch.exists() => folder.to_path_buf(),
        _ => branch,
    };
    for file in [head, packed, branch] {
        if file.exists() {
            println!("cargo::rerun-if-changed={}", file.display());
        }
    }
    git(&["rev-parse", "HEAD"]).filter(|hash| is_hash(hash))
}

fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}

fn is_hash(text: &str) -> bool {
    text.len() >= 40 && text.bytes().all(|byte| byte.is_ascii_hexdigit())
}
