//! Checks a request for hard cases (the scenes of [`skiagraph_cases`], which the program `skiagraph
//! stress` runs) before any of them runs.
//!
//! ```
//! use skiagraph_compare::measuring::hard_cases::{cases, one_of_each_light};
//!
//! let found = cases(&["torus".into(), "torus".into()])?;
//! assert_eq!(found.len(), 1);
//! assert!(!one_of_each_light(&found)[0].mesh.triangles.is_empty());
//! let message = cases(&["tors".into()]).unwrap_err().to_string();
//! assert!(message.contains("torus"), "{message}");
//! # Ok::<(), skiagraph_compare::error::CompareError>(())
//! ```

use crate::error::{CompareError, Result};
use crate::files::lock::{self, Locked};
use crate::files::write::check_folder;
use crate::graphs::planning::Capabilities;
use crate::graphs::shadow_method::PlanCheck;
use crate::lists::unique;
use crate::measuring::ground_truth::PrimaryVisibility;
use crate::measuring::hard_case::MethodRun;
use crate::pictures::run_pictures::{check_stems, reference_stem};
use crate::sink::{Session, Sink};
use crate::wording::{did_you_mean, unknown};
use itertools::Itertools;
use skiagraph_cases::HardCase;
use skiagraph_passes::SceneProvider;
use skiagraph_scene::Scene;
use std::{path::Path, sync::Arc};

/// Returns the cases of these names, each once, in the order of the names; all cases if `names` is
/// empty.
///
/// # Errors
/// A name that no case has.
pub fn cases(names: &[String]) -> Result<Vec<HardCase>> {
    if names.is_empty() {
        return Ok(skiagraph_cases::cases());
    }
    let find = |name: &String| {
        skiagraph_cases::case(name).ok_or_else(|| {
            let cases = skiagraph_cases::cases();
            let hint = did_you_mean(name, cases.iter().map(|case| case.name));
            CompareError::Input(format!(
                "unknown case `{name}`{hint}\n  `skiagraph stress --list` names them"
            ))
        })
    };
    unique(names).into_iter().map(find).collect()
}

/// Returns the scenes of cases on which methods are planned before the cases run: the first under
/// each kind of light whose mesh has triangles, as a fault on an empty mesh is a result, not a
/// mistake in the graph.
pub fn one_of_each_light(cases: &[HardCase]) -> Vec<Scene> {
    let scenes = cases.iter().map(HardCase::scene);
    let scenes = scenes.sorted_by_key(|scene| scene.mesh.triangles.is_empty());
    scenes.unique_by(|scene| scene.light().word()).collect()
}

/// Plans methods on a scene under each kind of light before the cases run, and says of those that
/// cannot run here why ([`Column::unavailable`](crate::records::stress::Column::unavailable)).
/// Returns the mistakes of documents, one line each.
///
/// # Errors
/// A GPU that cannot run the graph of the visible triangles; no method that can be planned, with
/// the reasons of all.
pub fn plan(
    session: Session,
    primary: &PrimaryVisibility,
    methods: &mut [MethodRun],
    cases: &[HardCase],
    viewport: [u32; 2],
) -> Result<Vec<String>> {
    let (mut plans, device) = (PlanCheck::default(), Capabilities::new(session.gpu));
    for scene in one_of_each_light(cases) {
        let provider = SceneProvider::new(Arc::new(scene));
        primary.plan(session, viewport, &provider)?;
        let methods = methods.iter().map(|run| &run.method);
        plans.add(methods, &[viewport], &provider, &device);
    }
    plans.end(session.sink).none_or_error()?;
    let mut mistakes = Vec::new();
    for run in methods {
        let unclear = run.column.unavailable.take().map(|reason| (reason, true));
        let refusal = unclear.or_else(|| plans.refusal(&run.method));
        if let Some((reason, is_mistake)) = refusal {
            let text = format!("`{}` cannot run: {reason}", run.method.name);
            mistakes.extend(is_mistake.then_some(text));
            run.column.unavailable = Some(reason);
        }
    }
    if mistakes.is_empty() && plans.has_mistakes() {
        mistakes.push("a document has mistakes; they stand above".into());
    }
    Ok(mistakes)
}

/// Checks that each name of `exact`, the methods to be judged as guaranteed to be exact
/// ([`MethodRun::new`]), is in `names`, the methods that run.
///
/// # Errors
/// Names the first one that is not.
pub fn check_exact(exact: &[String], names: &[String]) -> Result<()> {
    let Some(name) = exact.iter().find(|name| !names.contains(name)) else {
        return Ok(());
    };
    let what = format!("--exact {name}: none of the methods that run has this name");
    let text = unknown(&what, name, "methods", names);
    Err(CompareError::Request(text))
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
) -> Result<()> {
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
pub fn claim(folder: &Path, sink: &dyn Sink) -> Result<Locked> {
    check_folder(folder)?;
    lock::claim(folder, lock::STRESS, sink)?.ok_or_else(|| {
        CompareError::Input(format!(
            "another `skiagraph stress` is writing stress.json into {}\n  wait for its end, or \
             give another --out",
            folder.display()
        ))
    })
}
