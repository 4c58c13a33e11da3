//! Frames in which entries run.

use super::flat::{Run, Runs};
use super::symbols::At;
use crate::diagnostics::Reported;
use crate::document::{Entry, Run as RunEntry};
use crate::errors::evaluation::EvaluationError;
use crate::expressions::eval;
use crate::language::{Expr, least_common_multiple};
use std::sync::Arc;

/// Greatest number of frames after which the run conditions of a graph repeat: a method is
/// judged over all of them.
const LONGEST_PERIOD: u64 = 64;

/// Returns the frames in which an entry runs, which entries inside inherit. `period` is the number
/// of frames after which all run conditions of the graph repeat.
pub(super) fn runs(
    entry: &Entry,
    inherited: Option<&Runs>,
    period: &mut u64,
    at: &mut At<'_, '_>,
) -> Reported<Option<Runs>> {
    let always = |run| Ok(Some((run, vec![true])));
    let condition = match &entry.run {
        None => return Ok(inherited.cloned()),
        Some(RunEntry::Always) => return always(Run::Always),
        Some(RunEntry::Once) => return always(Run::Once),
        Some(RunEntry::OnChange) => return always(Run::OnChange),
        Some(RunEntry::When(condition)) => condition,
    };
    let turns = turns(condition, period, at)?;
    let instance = at.instance();
    let params = Arc::clone(&instance.params);
    let outer = instance.outer.as_ref();
    let private = outer.map_or(String::new(), |outer| outer.private.clone());
    // Conditions of two documents are one if they are made of the same params of the root;
    // attributes (`index` is one) are what they are here.
    let text = condition.canonical(&mut |leaf| {
        if leaf.is_frame_number() && turns.len() > 1 {
            return leaf.text().to_owned();
        }
        if let Some(name) = leaf.as_param() {
            let is_param = |name: &str| params.bound(name).is_some();
            let part = leaf.as_component().filter(|(owner, _)| is_param(owner));
            let (name, part) = match part.filter(|_| !is_param(name)) {
                Some((owner, part)) => (owner, format!(".{}", part.as_str())),
                None => (name, String::new()),
            };
            match params.bound(name).map(|bound| &bound.root) {
                Some(Some(root)) => return format!("{root}{part}"),
                Some(None) => return format!("{private}{name}{part}"),
                None => {}
            }
            let owner = leaf.as_component().map_or(name, |(owner, _)| owner);
            let scopes = &at.symbols.scopes;
            let is_value = |it: &str| scopes.find_value(at.position.scope, it).is_some();
            if !is_value(name) && !is_value(owner) {
                return name.to_owned();
            }
        }
        let value = eval::value(leaf, &mut at.elsewhere(at.position));
        value.map_or_else(|_| leaf.text().to_owned(), |value| value.to_string())
    });
    Ok(Some((Run::When(text), turns)))
}

/// Returns the values of a run condition, frame by frame until they repeat.
fn turns(condition: &Expr, period: &mut u64, at: &mut At<'_, '_>) -> Reported<Vec<bool>> {
    let mut turns = Vec::new();
    let mut at = at.elsewhere(at.position);
    let (mut frame, mut repeats) = (0, 1);
    while frame < repeats {
        at.frame = Some((frame, repeats));
        turns.push(eval::boolean(condition, &mut at)?);
        (frame, repeats) = (frame + 1, at.frame.map_or(repeats, |(_, repeats)| repeats));
        let period = least_common_multiple(*period, repeats);
        if period > LONGEST_PERIOD {
            return Err(at.report(EvaluationError::FramePeriod {
                place: condition.span.clone(),
                period,
                most: LONGEST_PERIOD,
            }));
        }
    }
    *period = least_common_multiple(*period, repeats);
    Ok(turns)
}
