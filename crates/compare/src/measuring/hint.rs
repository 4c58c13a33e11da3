//! Finds a setting that makes most of a method's wrong pixels right, by the casters that block
//! their light.

use crate::error::Result;
use crate::graphs::ground_truth;
use crate::graphs::method::{Method, ParamValues};
use crate::graphs::planning::Capabilities;
use crate::measuring::frame;
use crate::measuring::ground_truth::GroundTruthView;
use crate::measuring::guarantee::{CULL, NONE};
use crate::measuring::stop::attempt;
use crate::records::hint::{Cause, Hint};
use crate::records::tuned::named;
use crate::sink::Session;
use itertools::Itertools;
use skiagraph_gpu::Provider;
use skiagraph_graph::ParamValue;
use skiagraph_reference::BlockerCounts;

/// Share of the pixels facing the light that must be wrong for a hint to be worth its frames.
const WORTH: f64 = 1e-3;

/// The param that keeps surfaces from shading themselves.
const SLOPE_BIAS: &str = "slope_bias";

/// Looks for a setting with which more than half of a method's wrong pixels on a view are right.
/// `wrong` is their number, without those whose right answer rounding may flip, and `blockers`
/// counts the casters that block their light. Only values that the method's document marks with
/// `tune` are tried, with a frame for each until one helps; params that are set stay. `None` if
/// fewer than 0.1 % of the pixels facing the light are wrong, no cause explains more than half of
/// these, or no value helps.
///
/// # Errors
/// An early end, a lost device.
pub async fn find(
    session: Session<'_>,
    method: &Method,
    (truth_view, layer): (&GroundTruthView<'_>, usize),
    (wrong, blockers): (u64, BlockerCounts),
    provider: &mut dyn Provider,
) -> Result<Option<Hint>> {
    let classes = &truth_view.ground_truth.pixels.classes;
    let facing = classes.iter().filter(|class| class.faces_light()).count();
    let (open, none) = (blockers.open_part, blockers.none);
    let (cause, explained) = match (2 * open > wrong, 2 * none > wrong) {
        _ if (wrong as f64) < WORTH * facing as f64 => return Ok(None),
        (true, _) => (Cause::OpenParts, open),
        (_, true) => (Cause::NoBlocker, none),
        _ => return Ok(None),
    };
    for changes in candidates(method, cause) {
        session.check_stopped()?;
        let set = method.given().into_iter().chain(changes.clone());
        let set = set.map(|(name, value)| format!("{name}={value}")).join(",");
        let mut params = method.params.clone();
        params.extend(changes);
        let seen = (truth_view, layer);
        let Some(wrong_then) = wrong_with(session, &method.with(params), seen, provider).await?
        else {
            continue;
        };
        if 2 * wrong_then < wrong {
            return Ok(Some(Hint {
                cause,
                explained,
                wrong,
                set: named(&method.name, &set),
                wrong_then,
            }));
        }
    }
    Ok(None)
}

/// The changes of params that are tried against a cause, those of one param first.
fn candidates(method: &Method, cause: Cause) -> Vec<ParamValues> {
    let marked = |name: &str| {
        let param = method.preset.param(name);
        let param = param.filter(|_| !method.params.contains_key(name));
        let values = param.map(|param| param.tune.clone()).unwrap_or_default();
        let now = method.value(name);
        let alternatives = values.into_iter().filter(move |value| Some(value) != now);
        alternatives.collect::<Vec<ParamValue>>()
    };
    let own = match method.value(SLOPE_BIAS) {
        Some(ParamValue::F32(own)) => *own,
        _ => 0.0,
    };
    let is_greater = |value: &ParamValue| matches!(value, ParamValue::F32(value) if *value > own);
    let biases = marked(SLOPE_BIAS).into_iter().filter(is_greater);
    let biases = biases.map(|value| ParamValues::from([(SLOPE_BIAS.to_owned(), value)]));
    let none = ParamValue::Choice(NONE.to_owned());
    match cause {
        Cause::NoBlocker => biases.collect(),
        Cause::OpenParts if marked(CULL).contains(&none) => {
            let all_cast = ParamValues::from([(CULL.to_owned(), none)]);
            let both = biases.map(|bias| all_cast.clone().into_iter().chain(bias).collect());
            [all_cast.clone()].into_iter().chain(both).collect()
        }
        Cause::OpenParts => Vec::new(),
    }
}

/// Wrong pixels of a method outside the band; `None` if it cannot run.
async fn wrong_with(
    session: Session<'_>,
    method: &Method,
    (truth_view, layer): (&GroundTruthView<'_>, usize),
    provider: &mut dyn Provider,
) -> Result<Option<u64>> {
    let names = method.preset.judged();
    let truth = &truth_view.ground_truth;
    let capabilities = Capabilities::new(session.gpu);
    let Ok(plan) = method.plan(truth.pixels.viewport, capabilities, provider) else {
        return Ok(None);
    };
    let rendered = frame::render(session, plan, provider, &names).await;
    let Ok((contents, _)) = attempt(session, method, rendered)? else {
        return Ok(None);
    };
    // A setting whose outputs are not those of a shadow method is no way out.
    let wrong = ground_truth::error(&method.preset, (contents, layer), truth).ok();
    Ok(wrong.map(|wrong| wrong as u64))
}
