//! Checks a request for hard cases (the scenes of [`skiagraph_cases`], which the program `skiagraph
//! stress` runs) before any of them runs.
//!
//! ```
//! use skiagraph_compare::measuring::hard_cases::{cases, with_triangles};
//!
//! let found = cases(&["torus".into(), "torus".into()])?;
//! assert_eq!(found.len(), 1);
//! assert!(!with_triangles(&found).scene().mesh.triangles.is_empty());
//! let message = cases(&["tors".into()]).unwrap_err().to_string();
//! assert!(message.contains("torus"), "{message}");
//! # Ok::<(), skiagraph_compare::error::CompareError>(())
//! ```

use crate::error::CompareError;
use crate::files::lock::{self, Locked};
use crate::files::write::check_folder;
use crate::lists::unique;
use crate::measuring::hard_case::MethodRun;
use crate::pictures::run_pictures::{check_stems, reference_stem};
use crate::sink::Sink;
use crate::wording::{did_you_mean, unknown};
use skiagraph_cases::HardCase;
use skiagraph_gpu::device::Gpu;
use std::path::Path;

/// Returns the cases of these names, each once, in the order of the names; all cases if `names` is
/// empty.
///
/// # Errors
/// A name that no case has.
pub fn cases(names: &[String]) -> Result<Vec<HardCase>, CompareError> {
    if names.is_empty() {
        return Ok(skiagraph_cases::cases());
    }
    let find = |name: &String| {
        skiagraph_cases::case(name).ok_or_else(|| {
            let known = skiagraph_cases::cases();
            let hint = did_you_mean(name, known.iter().map(|case| case.name));
            CompareError::Input(format!(
                "unknown case `{name}`{hint}\n  `skiagraph stress --list` names them"
            ))
        })
    };
    unique(names).into_iter().map(find).collect()
}

/// Returns the first case whose mesh has triangles, or else the first case. A graph is checked on
/// it before the cases run, as a fault on an empty mesh is a result, not a mistake in the graph.
///
/// # Panics
/// If `cases` is empty.
pub fn with_triangles(cases: &[HardCase]) -> HardCase {
    let has_triangles = |case: &&HardCase| !case.scene().mesh.triangles.is_empty();
    *cases.iter().find(has_triangles).unwrap_or(&cases[0])
}

/// Checks that each name of `exact`, the methods to be judged as guaranteed to be exact
/// ([`MethodRun::new`]), is in `names`, the methods that run.
///
/// # Errors
/// Names the first one that is not.
pub fn check_exact(exact: &[String], names: &[String]) -> Result<(), CompareError> {
    let Some(name) = exact.iter().find(|name| !names.contains(name)) else {
        return Ok(());
    };
    let what = format!("--exact {name}: none of the methods that run has this name");
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    Err(CompareError::Request(unknown(
        &what, name, "methods", &names,
    )))
}

/// Checks that at least one of the methods can run: its
/// [`Column::unavailable`](crate::records::stress::Column::unavailable) is `None`.
///
/// # Errors
/// The reasons why none can run.
pub fn check_abilities(methods: &[MethodRun], gpu: &Gpu) -> Result<(), CompareError> {
    let reasons = methods.iter().map(|run| {
        let reason = run.column.unavailable.as_ref()?;
        Some(format!("\n  {}: {reason}", run.method.name))
    });
    match reasons.collect::<Option<String>>() {
        Some(reasons) => Err(CompareError::Input(format!(
            "no method can run on {}{reasons}",
            gpu.adapter.get_info().name
        ))),
        None => Ok(()),
    }
}

/// Checks that no two pairs of a method and a case have pictures of one file name, and that
/// pictures can be written into `folder`, which is made if it is missing.
///
/// # Errors
/// Two pairs whose pictures have one name; a folder that cannot be written.
pub fn check_pictures(
    methods: &[MethodRun],
    cases: &[HardCase],
    viewport: [u32; 2],
    folder: &Path,
) -> Result<(), CompareError> {
    let mut stems = Vec::new();
    for case in cases {
        let reference = reference_stem(case.name, viewport);
        stems.push((reference, format!("the reference of `{}`", case.name)));
        for run in methods {
            stems.extend(run.stems(case, viewport));
        }
    }
    check_stems(stems)?;
    check_folder(folder)
}

/// Claims a folder, which is made if it is missing, for its file stress.json: no other process may
/// write this file until the returned value is dropped.
///
/// # Errors
/// A folder that another process has claimed, or that cannot be written.
pub fn claim(folder: &Path, sink: &dyn Sink) -> Result<Locked, CompareError> {
    check_folder(folder)?;
    lock::claim(folder, lock::STRESS, sink)?.ok_or_else(|| {
        CompareError::Input(format!(
            "another `skiagraph stress` is writing stress.json into {}\n  wait for its end, or \
             give another --out",
            folder.display()
        ))
    })
}
