//! Whatever stands in a file: an answer, never a panic, and soon. The stable counterpart of the
//! fuzz targets in `fuzz`: the same entry functions on the same corpora, on every former finding,
//! and on what becomes of them by chance.

use crate::bounds::bounded;
use crate::entry;
use proptest::{prelude::*, test_runner::TestRunner};
use std::path::Path;

/// The files of one target, by name; no finding, no folder of findings.
fn files(folder: &str, target: &str) -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../fuzz")
        .join(folder)
        .join(target);
    let mut files: Vec<(String, Vec<u8>)> = std::fs::read_dir(&folder)
        .into_iter()
        .flatten()
        .map(|entry| {
            let entry = entry.expect("the folder can be listed");
            let bytes = std::fs::read(entry.path()).expect("the file can be read");
            (entry.file_name().to_string_lossy().into_owned(), bytes)
        })
        .collect();
    files.sort();
    assert!(
        !files.is_empty() || !folder.ends_with(format!("corpus/{target}")),
        "no corpus in {}",
        folder.display()
    );
    files
}

fn replay(target: &str, run: fn(&[u8]) -> String) {
    for folder in ["corpus", "regressions"] {
        for (name, bytes) in files(folder, target) {
            println!("{folder}/{target}/{name}"); // shown where the next line panics
            bounded(&format!("{folder}/{target}/{name}"), || run(&bytes));
        }
    }
}

/// Replacements of numbers.
const NUMBERS: &[&str] = &[
    "0",
    "-1",
    "-0",
    "1e39",
    "1e-46",
    "NaN",
    "-inf",
    "inf",
    "65536",
    "4294967295",
    "4294967296",
    "2147483648",
    "9223372036854775807",
    "18446744073709551616",
    "0.5",
    "1e400",
    "-9223372036854775808",
];

/// One change: what is done, where (as a share of the bytes), how far it reaches, and with what.
type Change = (u8, f64, usize, usize, f64);

fn any_changes() -> impl Strategy<Value = Vec<Change>> {
    prop::collection::vec(
        (
            0..6u8,
            0.0..1.0,
            1..64usize,
            any::<prop::sample::Index>().prop_map(|index| index.index(1 << 16)),
            0.0..1.0,
        ),
        1..5,
    )
}

fn change(bytes: &mut Vec<u8>, seeds: &[(String, Vec<u8>)], (what, at, reach, with, from): Change) {
    if bytes.is_empty() {
        bytes.push(b'(');
    }
    let start = (bytes.len() as f64 * at) as usize;
    let end = (start + reach).min(bytes.len());
    match what {
        0 => bytes[start] ^= 1 << (with % 8),
        1 => bytes[start] = with as u8,
        2 => drop(bytes.drain(start..end)),
        // Up to a thousand times, so that lists grow and brackets nest.
        3 => {
            let chunk = bytes[start..end].repeat(1 + with % 1000 / reach);
            bytes.splice(end..end, chunk);
        }
        4 => {
            let other = &seeds[with % seeds.len()].1;
            let first = (other.len() as f64 * from) as usize;
            let chunk = other[first..(first + reach).min(other.len())].to_vec();
            bytes.splice(start..end, chunk);
        }
        _ => {
            let Some(digit) = bytes[start..].iter().position(u8::is_ascii_digit) else {
                return;
            };
            let first = start + digit;
            let length = bytes[first..]
                .iter()
                .take_while(|byte| byte.is_ascii_digit())
                .count();
            bytes.splice(first..first + length, NUMBERS[with % NUMBERS.len()].bytes());
        }
    }
}

fn mutate(target: &str, cases: u32, run: fn(&[u8]) -> String) {
    let seeds = files("corpus", target);
    let config = ProptestConfig {
        cases,
        failure_persistence: None,
        ..ProptestConfig::default()
    };
    let outcome =
        TestRunner::new(config).run(&(0..seeds.len(), any_changes()), |(seed, changes)| {
            let mut bytes = seeds[seed].1.clone();
            for edit in changes {
                change(&mut bytes, &seeds, edit);
            }
            bounded(&String::from_utf8_lossy(&bytes), || run(&bytes));
            Ok(())
        });
    outcome.unwrap_or_else(|failure| panic!("{failure}"));
}

#[test]
fn documents_of_the_corpus() {
    replay("document", entry::document);
}

#[test]
fn scenes_of_the_corpus() {
    replay("scene", entry::scene);
}

#[test]
fn shaders_of_the_corpus() {
    replay("wgsl", entry::wgsl);
}

#[test]
fn changed_documents() {
    mutate("document", 2000, entry::document);
}

#[test]
fn changed_scenes() {
    mutate("scene", 2000, entry::scene);
}

#[test]
fn changed_shaders() {
    mutate("wgsl", 1000, entry::wgsl);
}
