//! Sample results with every field in use: the ones that pin the schemas of `records`.

use serde::de::DeserializeOwned;
use skiagraph_compare::records::{profile::Profile, results::Results, stress::Report};

macro_rules! pinned {
    ($name:literal) => {
        include_str!(concat!(
            "../../compare/src/records/snapshots/skiagraph_compare__records__",
            $name,
            ".snap"
        ))
    };
}

/// Reads a pinned file behind its header.
fn read<T: DeserializeOwned>(snapshot: &str) -> T {
    let json = snapshot.splitn(3, "---\n").nth(2).unwrap();
    serde_json::from_str(json).unwrap()
}

/// Returns sample results of `compare`.
pub fn results() -> Results {
    read(pinned!(
        "results__tests__the_schema_is_pinned_and_reads_back"
    ))
}

/// Returns a sample profile.
pub fn profile() -> Profile {
    read(pinned!(
        "profile__tests__the_schema_is_pinned_and_reads_back"
    ))
}

/// Returns a sample report of `stress`.
pub fn stress() -> Report {
    read(pinned!("stress__tests__the_schema_is_pinned"))
}
