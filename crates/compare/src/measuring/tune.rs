//! Searches, for each method of a comparison, the params that its document marks with `tune`, and
//! puts the best setting beside the method as it is.
//!
//! Settings are chosen on half of the views, and the comparison goes on with the others, so that
//! no method is judged on the pictures that it was fitted to.
//!
//! ```no_run
//! use skiagraph_compare::{
//!     comparison::Comparison,
//!     measuring::{series, tune::tune},
//!     sink::Session,
//! };
//!
//! # type Done = Result<(), Box<dyn std::error::Error>>;
//! # async fn fair(mut comparison: Comparison, session: Session<'_>) -> Done {
//! tune(&mut comparison, session).await?;
//! for run in series::run(&comparison, session).await?.runs {
//!     if let Some(tuned) = &run.tuned {
//!         println!("{} is {} with {}", run.preset, tuned.of, tuned.words());
//!     }
//! }
//! # Ok(())
//! # }
//! ```

use crate::comparison::Comparison;
use crate::default_view::more_views;
use crate::error::{CompareError, Result};
use crate::graphs::method::{Method, ParamValues, as_json};
use crate::graphs::variants::MAP_SIZE;
use crate::lists::entry;
use crate::measuring::ground_truth::{GroundTruthView, built_oracle};
use crate::measuring::search::{Axis, Trial, search};
use crate::measuring::trial::{Limits, TrialView, Trials};
use crate::measuring::view_or_path::ViewOrPath;
use crate::measuring::{device, guarantee};
use crate::records::tuned::{Tuned, named};
use crate::sink::{Session, Silent, Step};
use crate::wording::size;
use itertools::Itertools;
use skiagraph_gpu::timing::Trust;
use skiagraph_graph::{Param, ParamType, ParamValue};
use skiagraph_passes::SceneProvider;
use skiagraph_scene::{Scene, View};
use std::sync::Arc;

/// Work of a new executor with its pipelines, as a multiple of that of a frame. Of each run there
/// are two, for answers and for diagnostics of the map; a search has one, and changes it.
const NEW_EXECUTOR: u64 = 4;

/// Part of the work that is kept back for trials of map sizes: one in so many.
const RESERVE: u64 = 8;

/// Cost of a comparison with a search, as a multiple of that of the same comparison without one.
const MOST_COST: u64 = 10;

/// Least number of views on which settings are chosen: several, so that one odd view does not
/// decide.
const OTHERS: usize = 3;

/// Least number of pixels of the viewport that settings are chosen in: in a smaller one a few
/// pixels decide between settings that are alike.
const LEAST_PIXELS: u64 = 256 * 256;

/// Longest side of a viewport that was made larger to choose settings in: all adapters have it.
const LONGEST_SIDE: u32 = 8192;

/// Searches good values of the params that documents mark with `tune`, and adds to the comparison,
/// behind each method, the same method with the values of least error that were found. With
/// [`budgets`](Comparison::budgets), these values exceed no budget that the method keeps itself.
/// [`Comparison::tuned`] records the searches. If the comparison has several views, every second
/// one is taken out of it, and settings are chosen on these; otherwise they are chosen on other
/// views of the scene. Where these are fewer than three, views are generated that show from other
/// sides what the judged ones show. Params that a method sets stay as they are,
/// and so do those of the [look](Param::is_look) if no light has an extent. A method whose
/// document promises exact shadows for all casters is not searched, and neither is one that
/// remembers earlier frames. Values are chosen in the first of the comparison's viewports, and run
/// in all. If it has fewer than 256 × 256 pixels, they are chosen in a larger one: both sides are
/// multiplied by the least whole number that gives so many; but not if budgets limit time or
/// memory, as a larger viewport costs more.
///
/// The work is bounded: plans and frames of a method, those of its tuned setting included, are at
/// most ten times those of its part in the comparison.
///
/// # Errors
/// The errors of [`Comparison::check`]; a comparison of camera paths; no method with params to
/// tune; no other view of the scene that can be generated; an [early end](crate#terms), a lost
/// device, a reference that cannot be computed. The comparison is unchanged after an error.
pub async fn tune(comparison: &mut Comparison, session: Session<'_>) -> Result<()> {
    comparison.check(Session::new(session.gpu, &Silent))?;
    let scene = comparison.scene.clone();
    let methods = comparison.settled(session);
    let mut lights = comparison.views.iter().map(|view| view.light(&scene));
    let is_soft = lights.any(|light| light.has_extent());
    check_methods(&methods, is_soft)?;
    let most = most_work(comparison);
    let (chosen_on, judged) = split(&comparison.views, &scene)?;
    let viewport = trial_viewport(comparison);
    let mut provider = SceneProvider::new(scene.clone());
    let seen = (chosen_on, viewport);
    let views = trial_views(comparison, &scene, session, &mut provider, seen);
    let views = views.await?;
    let limits = Limits {
        work: most - most / RESERVE,
        budgets: comparison.budgets,
        has_timestamps: device::timestamp_trust(session.gpu).await == Trust::Trusted,
    };
    let names: Vec<String> = views.iter().map(|view| view.view.name.clone()).collect();
    let (mut compared, mut tuned) = (Vec::new(), Vec::new());
    for (own, method) in comparison.methods.iter().zip(&methods) {
        compared.push(own.clone());
        if !needs_tuning(method, is_soft) {
            continue;
        }
        let method = method.at(viewport);
        let trials = Trials::new(session, &method, &views, &mut provider, limits);
        let Some((params, record)) = best(session, (&method, is_soft), trials, most).await? else {
            session.sink.note(&format!(
                "{} is not tuned: it cannot run on the views that settings are chosen on, \
                 remembers earlier frames, or no pixel faces a light that it takes",
                method.name
            ));
            continue;
        };
        let record = Tuned {
            chosen_on: names.clone(),
            ..record
        };
        if !record.set.is_empty() {
            let name = named(&own.name, &label(&method, &params));
            let set = Method::new(own.preset.clone(), params).named(&name);
            let is_set = |other: &Method| other.name == name && other.map_size == set.map_size;
            if comparison.methods.iter().chain(&compared).any(is_set) {
                let text = format!("{} tuned is {name}, which is compared already", own.name);
                session.sink.note(&text);
                continue;
            }
            compared.push(set);
        }
        tuned.push((compared.len() - 1, record));
    }
    drop(views);
    comparison.methods = compared;
    comparison.tuned = tuned.into_iter().collect();
    comparison.views = judged;
    Ok(())
}

/// The viewport that settings are chosen in.
fn trial_viewport(comparison: &Comparison) -> [u32; 2] {
    let [width, height] = comparison.viewports.first().copied().unwrap_or([512; 2]);
    if comparison.budgets.limits_cost() {
        return [width, height];
    }
    let fits = |times: &u32| times.saturating_mul(width.max(height)) <= LONGEST_SIDE;
    let pixels = |times: u32| u64::from(width * times) * u64::from(height * times);
    let is_enough = |times: &u32| pixels(*times) >= LEAST_PIXELS;
    let enough = (1..).take_while(fits).find(is_enough);
    let times = enough.unwrap_or(1);
    [width * times, height * times]
}

/// Refuses methods among which none has params to tune.
fn check_methods(methods: &[Method], is_soft: bool) -> Result<()> {
    if methods.iter().any(|method| needs_tuning(method, is_soft)) {
        return Ok(());
    }
    let mut names = methods.iter().map(|method| format!("`{}`", method.name));
    let names = names.join(", ");
    Err(CompareError::Input(format!(
        "nothing to tune: {names} set or lack all params that a document marks with `tune`, or are \
         exact with any of them; params with `look` are tuned under lights with an extent alone"
    )))
}

/// True if [`tune`] searches for settings of a method: its document marks with `tune` params that
/// the method does not set, and does not promise exact shadows for all casters. Params of the
/// [look](Param::is_look) count only if `is_soft`: a light of the comparison has an extent.
pub fn needs_tuning(method: &Method, is_soft: bool) -> bool {
    let promise = guarantee::promise(method);
    !promise.is_some_and(|promise| promise.is_exact_for_all()) && !axes(method, is_soft).is_empty()
}

/// A param to tune, with its values; the first one is that which the method has.
struct Values {
    name: String,
    values: Vec<ParamValue>,
    is_word: bool,
}

/// The params of a method that may be tuned, but for the size of its map. Against hard shadows the
/// sharpest look always has the least error: such params are left out unless `is_soft`.
fn axes(method: &Method, is_soft: bool) -> Vec<Values> {
    let params = method.preset.graph.params().iter();
    let marked = params.filter(|param| !param.tune.is_empty() && param.name.as_str() != MAP_SIZE);
    let marked = marked.filter(|param| is_soft || !param.is_look);
    let free = marked.filter(|param| !method.params.contains_key(param.name.as_str()));
    let axis = |param: &Param| {
        let now = method.value(param.name.as_str())?.clone();
        let alternatives = param.tune.iter().filter(|value| **value != now).cloned();
        Some(Values {
            name: param.name.value.clone(),
            values: [now.clone()].into_iter().chain(alternatives).collect(),
            is_word: matches!(param.ty, ParamType::Choice(_) | ParamType::Bool),
        })
    };
    let mut axes: Vec<Values> = free.filter_map(axis).collect();
    // The param with most values first: it decides the most, and later ones only refine.
    axes.sort_by_key(|axis| std::cmp::Reverse(axis.values.len()));
    axes
}

/// The work that a search for one method may do: plans and frames.
fn most_work(comparison: &Comparison) -> u64 {
    let protocol = &comparison.protocol;
    let timed = protocol.warmup + protocol.frames + protocol.regime_frames;
    // A frame is judged, one tells of the map, and one is kept by an early end.
    let run = 2 * NEW_EXECUTOR + 3 + u64::from(timed);
    let runs = (comparison.views.len() * comparison.viewports.len()) as u64;
    (MOST_COST - 1) * runs * run
}

/// Splits views into those on which settings are chosen, and those on which they are judged; views
/// that are one under several lights stay together.
fn split(views: &[ViewOrPath], scene: &Scene) -> Result<(Vec<View>, Vec<ViewOrPath>)> {
    let mut places: Vec<(&str, Vec<View>)> = Vec::new();
    for view in views {
        let ViewOrPath::Still(still) = view else {
            let what = "settings are tuned on still views, not along camera paths";
            return Err(CompareError::Input(what.into()));
        };
        let light = view.one_of_lights().map_or(0, |light| light.len() + 1);
        let place = &still.name[..still.name.len() - light];
        entry(&mut places, place).push(still.clone());
    }
    let is_one = places.len() < 2;
    let places = places.into_iter().map(|(_, views)| views).collect_vec();
    let judged = places.iter().step_by(2).cloned().collect_vec();
    let chosen_on = places.iter().skip(1).step_by(2).cloned().collect_vec();
    let missing = OTHERS.saturating_sub(chosen_on.len());
    let mut chosen_on = chosen_on.concat();
    if is_one {
        chosen_on = others(&judged.concat(), scene)?;
    } else {
        // The others of a few may show nothing like those that are judged.
        let each = missing.div_ceil(judged.len());
        let like = judged.iter().enumerate();
        let like = like.flat_map(|(index, views)| generated(views, scene, index * each, each));
        chosen_on.extend(like.take(missing).flatten());
    }
    let judged = judged.concat().into_iter().map(ViewOrPath::Still);
    Ok((chosen_on, judged.collect()))
}

/// Other views than a given one, which stands there once for each of its lights: those of the
/// scene, and generated ones. They are under the same lights.
fn others(views: &[View], scene: &Scene) -> Result<Vec<View>> {
    let none = || CompareError::Input("no view of the scene to tune methods on".into());
    let like = views.first().ok_or_else(none)?;
    let is_other = |other: &&View| (other.eye, other.direction) != (like.eye, like.direction);
    let own = scene.views.iter().filter(is_other);
    let own = own.map(|other| under_lights(other, views));
    // Results tell views by name: one of a judged view's name would take its runs away.
    let names: Vec<&str> = views.iter().map(|view| view.name.as_str()).collect();
    let is_free = |other: &View| !names.contains(&other.name.as_str());
    let own = own.filter(|other| other.iter().all(is_free)).take(OTHERS);
    let mut other_views: Vec<Vec<View>> = own.collect();
    other_views.extend(generated(views, scene, 0, OTHERS - other_views.len()));
    if other_views.is_empty() {
        return Err(CompareError::Input(format!(
            "view `{}` is the only one that shows the scene: settings are chosen on other views \
             than they are judged on, so name two at least (--view all)",
            like.name
        )));
    }
    Ok(other_views.concat())
}

/// At most `count` views like a given one, which stands there once for each of its lights: the
/// first two show the same from other sides. Each stands there once for each light, too. Their
/// numbers follow `before`.
fn generated(views: &[View], scene: &Scene, before: usize, count: usize) -> Vec<Vec<View>> {
    let Some(like) = views.first() else {
        return Vec::new();
    };
    let more = more_views(&scene.mesh, &scene.light_of(like), like, count);
    let named = more.into_iter().enumerate().map(|(number, view)| View {
        name: format!("generated {}", before + number + 1),
        ..view
    });
    named.map(|view| under_lights(&view, views)).collect()
}

/// A view under each of the lights that views of one place are under.
fn under_lights(other: &View, views: &[View]) -> Vec<View> {
    let under = |view: &View| View {
        name: match (views.len(), &view.light) {
            (2.., Some(light)) => format!("{}@{}", other.name, light.name),
            _ => other.name.clone(),
        },
        light: view.light.clone().or_else(|| other.light.clone()),
        ..other.clone()
    };
    views.iter().map(under).collect()
}

/// The ground truth of views in a viewport.
async fn trial_views<'s>(
    comparison: &Comparison,
    scene: &'s Arc<Scene>,
    session: Session<'_>,
    provider: &mut SceneProvider,
    (views, viewport): (Vec<View>, [u32; 2]),
) -> Result<Vec<TrialView<'s>>> {
    let oracle = built_oracle(&scene.mesh, "hierarchy to tune with", session.sink);
    let protocol = &comparison.protocol;
    let how = (protocol.oracle, protocol.reference_samples);
    let mut trial_views = Vec::with_capacity(views.len());
    for view in views {
        provider.set_view(&view, viewport);
        let ids = comparison.primary.ids(session, viewport, provider).await?;
        let (camera, light) = (view.camera(viewport), scene.light_of(&view));
        let what = format!("{} {}", view.name, size(viewport));
        let heard = (&*what, session.sink);
        let truth = GroundTruthView::new(oracle.clone(), camera, light, ids, how, heard)?;
        trial_views.push(TrialView { view, light, truth });
    }
    Ok(trial_views)
}

/// The best setting of a method: its params, and what is to be recorded but for the views; `None`
/// if the method runs on none of the views.
async fn best(
    session: Session<'_>,
    (method, is_soft): (&Method, bool),
    mut trials: Trials<'_>,
    most: u64,
) -> Result<Option<(ParamValues, Tuned)>> {
    if trials.facing_light == 0.0 {
        return Ok(None);
    }
    let axes = axes(method, is_soft);
    let ways = axes.iter().map(|axis| Axis {
        values: axis.values.len(),
        is_word: axis.is_word,
    });
    let ways: Vec<Axis> = ways.collect();
    let params_of = |point: &[usize]| {
        let mut params = method.params.clone();
        for (axis, &value) in axes.iter().zip(point).filter(|(_, value)| **value > 0) {
            params.insert(axis.name.clone(), axis.values[value].clone());
        }
        params
    };
    let name = format!("tuning {}", method.name);
    let step = Step::begin(session.sink, &name, most, "plans and frames");
    trials.holds_memory = trials.is_small(&method.params)?;
    // Every setting that was the best so far, the defaults first.
    let mut bests: Vec<(ParamValues, f64)> = Vec::new();
    let outcome = search(&ways, async |point, best| {
        let params = params_of(point);
        let trial = trials.run(&params, best).await?;
        step.set_done(most - trials.left);
        if let Trial::Error(error) = trial {
            bests.push((params, error));
        }
        Ok::<_, CompareError>(trial)
    });
    let outcome = outcome.await?;
    let default = bests.first().filter(|(params, _)| *params == method.params);
    let default_error = default.map(|(_, error)| *error);
    bests.retain(|(params, error)| *error > outcome.error || *params == params_of(&outcome.point));
    trials.left += most / RESERVE;
    let mut chosen = None;
    while let (None, Some(best)) = (&chosen, bests.pop()) {
        chosen = within_budgets(method, &mut trials, best).await?;
    }
    step.end();
    let Some(default_error) = default_error else {
        return Ok(None);
    };
    let (params, error) = chosen.unwrap_or((method.params.clone(), default_error));
    let set = method.with(params.clone());
    let (now, before) = (set.all_params(), method.all_params());
    let changed = now.into_iter();
    let changed = changed.filter(|(name, value)| before.get(name) != Some(value));
    Ok(Some((
        params,
        Tuned {
            of: method.name.clone(),
            given: as_json(&method.given()),
            set: changed.collect(),
            tried: outcome.tried,
            is_whole: outcome.is_whole,
            default_error,
            error,
            ..Tuned::default()
        },
    )))
}

/// A setting that keeps to the budgets, with the largest map that does and is no worse; with the
/// largest smaller map if it keeps to them with none as large as its own. `None` if it keeps to
/// them with no map. Without budgets the setting as it is.
async fn within_budgets(
    method: &Method,
    trials: &mut Trials<'_>,
    (params, error): (ParamValues, f64),
) -> Result<Option<(ParamValues, f64)>> {
    let keeps = async |params: &ParamValues, trials: &mut Trials| {
        Ok::<_, CompareError>(trials.is_small(params)? && trials.is_quick(params).await?)
    };
    let with = |size: u32| {
        let mut params = params.clone();
        params.insert(MAP_SIZE.into(), ParamValue::U32(size));
        params
    };
    let (larger, smaller) = map_sizes(method);
    if !keeps(&params, trials).await? {
        for size in smaller {
            let params = with(size);
            if keeps(&params, trials).await?
                && let Trial::Error(error) = trials.run(&params, f64::INFINITY).await?
            {
                return Ok(Some((params, error)));
            }
        }
        return Ok(None);
    }
    let mut best = (params.clone(), error);
    if trials.limits.budgets.limits_cost() {
        for size in larger {
            let params = with(size);
            if !keeps(&params, trials).await? {
                break;
            }
            match trials.run(&params, best.1).await? {
                Trial::Error(error) if error < best.1 => best = (params, error),
                Trial::Error(_) | Trial::Worse | Trial::Same => {}
                Trial::Ended => break,
            }
        }
    }
    Ok(Some(best))
}

/// The marked sizes of a method's map above its own, from small to large, and those below, from
/// large to small; none if the size is set.
fn map_sizes(method: &Method) -> (Vec<u32>, Vec<u32>) {
    let (param, own) = (method.preset.param(MAP_SIZE), method.map_size);
    let (Some(param), Some(own), false) = (param, own, method.params.contains_key(MAP_SIZE)) else {
        return Default::default();
    };
    let sizes = param.tune.iter().filter_map(|value| match value {
        ParamValue::U32(size) => Some(*size),
        _ => None,
    });
    let sizes = sizes.filter(|size| *size != own).sorted();
    let (smaller, larger): (Vec<u32>, Vec<u32>) = sizes.partition(|size| *size < own);
    (larger, smaller.into_iter().rev().collect())
}

/// The assignments by which a tuned method is told from the method that it is a setting of. The
/// size of its map stands in a column of its own.
fn label(method: &Method, params: &ParamValues) -> String {
    let is_new = |(name, value): &(&String, &ParamValue)| {
        *name != MAP_SIZE && method.params.get(*name) != Some(value)
    };
    let new = params.iter().filter(is_new);
    new.map(|(name, value)| format!("{name}={value}")).join(",")
}
