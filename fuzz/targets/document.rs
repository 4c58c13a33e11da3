#![no_main]

#[allow(dead_code, reason = "each target runs one of the entries")]
#[path = "../entry.rs"]
mod entry;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| drop(entry::document(bytes)));
