//! Measures methods and runs the hard cases on the page's device, with progress and an early end.

use crate::answer::{Answer, fault, json, parsed};
use crate::documents::{Files, sources};
use crate::stage::loaded;
use serde::Deserialize;
use serde_json::json;
use skiagraph_compare::comparison::Comparison;
use skiagraph_compare::error::{CompareError, with_causes};
use skiagraph_compare::files::json::to_text;
use skiagraph_compare::graphs::argument::MethodArgument;
use skiagraph_compare::graphs::method::Method;
use skiagraph_compare::graphs::shadow_method::load_methods;
use skiagraph_compare::measuring::ground_truth::PrimaryVisibility;
use skiagraph_compare::measuring::hard_case::{HardCaseContext, MethodRun};
use skiagraph_compare::measuring::hard_cases::{cases, plan};
use skiagraph_compare::measuring::series::Series;
use skiagraph_compare::measuring::view_or_path::ViewOrPath;
use skiagraph_compare::records::results::{Adapter, Measured, Results};
use skiagraph_compare::records::stress::{Report, Verdict};
use skiagraph_compare::sink::{Session, Sink};
use skiagraph_gpu::device::Gpu;
use skiagraph_graph::Sources;
use skiagraph_passes::EmbeddedSources;
use skiagraph_report::summary_table::summaries;
use std::cell::{Cell, RefCell};
use std::sync::atomic::{AtomicBool, Ordering};
use wasm_bindgen::prelude::*;

/// Set by [`stop`].
static STOP: AtomicBool = AtomicBool::new(false);

thread_local! {
    static PROGRESS: RefCell<Option<js_sys::Function>> = const { RefCell::new(None) };
    static RUNS: Cell<[u64; 2]> = const { Cell::new([0, 0]) };
    static STEP: RefCell<(String, u64, &'static str)> =
        const { RefCell::new((String::new(), 0, "")) };
}

/// Reports progress to the page.
struct Reporter;

impl Reporter {
    fn tell(value: &serde_json::Value) {
        PROGRESS.with_borrow(|progress| {
            if let Some(progress) = progress {
                // An error of the page's function is the page's.
                let _ = progress.call1(&JsValue::NULL, &JsValue::from_str(&value.to_string()));
            }
        });
    }
}

impl Sink for Reporter {
    fn note(&self, text: &str) {
        Self::tell(&json!({"note": text}));
    }

    fn begin_runs(&self, total: u64) {
        RUNS.set([0, total]);
    }

    fn count_run(&self) {
        let [done, total] = RUNS.get();
        RUNS.set([done + 1, total]);
    }

    fn begin_step(&self, name: &str, total: u64, unit: &'static str) {
        STEP.set((name.to_owned(), total, unit));
        self.set_done(0);
    }

    fn set_done(&self, done: u64) {
        let [runs, of_runs] = RUNS.get();
        STEP.with_borrow(|(name, total, unit)| {
            Self::tell(&json!({
                "done": done, "of": total, "unit": unit, "step": name, "runs": runs,
                "of_runs": of_runs,
            }));
        });
    }

    fn stop(&self) -> &AtomicBool {
        &STOP
    }
}

/// Request for the hard cases; all of them if `cases` is empty.
#[derive(Deserialize)]
struct Conformance {
    methods: Vec<String>,
    #[serde(default)]
    cases: Vec<String>,
    size: u32,
}

/// Request for a comparison on the worker's scene.
#[derive(Deserialize)]
struct Measure {
    views: Vec<String>,
    methods: Vec<String>,
    size: [u32; 2],
    frames: u32,
    #[serde(default)]
    files: Files,
}

/// Asks the measurement that runs to end.
pub fn stop() {
    STOP.store(true, Ordering::Relaxed);
}

/// Runs a measurement that reports to the page's function. A wish to stop ends with it.
pub async fn reported(
    progress: js_sys::Function,
    measurement: impl Future<Output = Answer<String>>,
) -> Answer<String> {
    PROGRESS.set(Some(progress));
    let outcome = measurement.await;
    PROGRESS.take();
    STOP.store(false, Ordering::Relaxed);
    outcome
}

/// [`Page::conformance`](crate::page::Page::conformance).
pub async fn conformance((gpu, adapter): (&Gpu, Adapter), request: &str) -> Answer<String> {
    let request: Conformance = parsed(request)?;
    let viewport = [request.size; 2];
    let methods = load_methods(&request.methods, &[], &[], &EmbeddedSources).map_err(fault)?;
    let features = gpu.device.features();
    let methods = methods
        .into_iter()
        .map(|method| MethodRun::new(method.at(viewport).settled(features), &[]));
    let mut methods: Vec<MethodRun> = methods.collect();
    let primary = PrimaryVisibility::load(&EmbeddedSources).map_err(fault)?;
    let (cases, session) = (
        cases(&request.cases).map_err(fault)?,
        Session::new(gpu, &Reporter),
    );
    plan(session, &primary, &mut methods, &cases, viewport).map_err(fault)?;
    let context = HardCaseContext {
        session,
        primary: &primary,
        methods: &methods,
        viewport,
        pictures: None,
    };
    let mut report = context.report(adapter);
    for case in &cases {
        match context.run(case).await {
            Ok(judged) => {
                report.cases.push(judged);
                tell_case(&report, cases.len());
            }
            Err(CompareError::Interrupted { .. }) => break,
            Err(error) if report.cases.is_empty() => return Err(fault(error)),
            Err(error) => {
                Reporter.note(&with_causes(&error));
                break;
            }
        }
    }
    Ok(to_text(&report))
}

/// [`Page::measure`](crate::page::Page::measure).
pub async fn measure((gpu, adapter): (&Gpu, Adapter), request: &str) -> Answer<String> {
    let request: Measure = parsed(request)?;
    let (scene, sources) = (loaded()?, sources(&request.files));
    // A built-in method keeps its shaders, whatever the user's own are called.
    let load = |word: &String| {
        let is_own = request
            .files
            .contains_key(&MethodArgument::new(word).preset);
        let sources: &dyn Sources = if is_own { &sources } else { &EmbeddedSources };
        load_methods(&[word], &[], &[], sources).map_err(fault)
    };
    let methods = request.methods.iter().map(load);
    let methods: Vec<Vec<Method>> = methods.collect::<Answer<_>>()?;
    let methods = methods.concat();
    let mut comparison = Comparison::new(scene, methods).map_err(fault)?;
    let is_asked = |view: &ViewOrPath| request.views.iter().any(|it| it == view.name());
    comparison.views.retain(is_asked);
    comparison.viewports = vec![request.size];
    comparison.protocol.frames = request.frames.max(1);
    comparison.protocol.regime_frames = request.frames;
    let session = Session::new(gpu, &Reporter);
    comparison.check(session).map_err(fault)?;
    let series = Series::new(&comparison, session, None).await;
    let mut series = series.map_err(fault)?;
    series.results.adapter = adapter;
    let measured = series.measure_all().await;
    let mut results = series.results;
    match measured {
        Ok(()) | Err(CompareError::Interrupted { .. }) => (),
        Err(error) if results.runs.is_empty() => return Err(fault(error)),
        Err(error) => {
            let note = with_causes(&error);
            Reporter.note(&note);
            results.notes.push(note);
        }
    }
    results.notes.extend(step(&results));
    Ok(to_text(&results))
}

/// Tells the outcome of the last case: of each cell, or of the case if it has none.
fn tell_case(report: &Report, total: usize) {
    let Some(case) = report.cases.last() else {
        return;
    };
    let tell = |method: &str, verdict: Verdict, wrong: u64, failed: &Option<String>| {
        Reporter::tell(&json!({
            "done": report.cases.len(), "of": total, "case": case.name, "method": method,
            "verdict": verdict, "wrong": wrong, "failed": failed,
        }));
    };
    if case.verdict == Verdict::Fail || case.cells.is_empty() {
        tell("", case.verdict, 0, &case.failed);
    }
    for cell in &case.cells {
        let outside = cell.counts.as_ref().map(|counts| &counts.outside_band);
        let wrong = outside.map_or(0, |outside| outside.lit + outside.shadow);
        tell(&cell.preset, cell.verdict, wrong, &cell.failed);
    }
}

/// Least step of a clock that is worth a note, in milliseconds.
const COARSE: f64 = 0.005;

/// A note on the step of the timestamps, if the times are multiples of one, as browsers make them.
fn step(results: &Results) -> Option<String> {
    let measured = results.runs.iter().filter_map(|run| run.measured.as_ref());
    let times = measured.flat_map(|Measured { passes, .. }| passes);
    let times = times.filter_map(|pass| pass.gpu_ms.map(|gpu| gpu.min));
    let times: Vec<f64> = times.filter(|ms| *ms > 0.0).collect();
    let step = times.iter().copied().min_by(f64::total_cmp)?;
    let is_multiple = |ms: &f64| (ms / step - (ms / step).round()).abs() < 0.02;
    (step >= COARSE && times.len() > 3 && times.iter().all(is_multiple)).then(|| {
        format!("GPU times are multiples of {step:.4} ms, the step of the browser's clock")
    })
}

/// Returns the text of a results.json as JSON: its `verdict`, and the table (`header`, `rows`) of
/// the methods over all views.
///
/// # Errors
/// A text that is no results.json.
#[wasm_bindgen]
pub fn verdict(results: &str) -> Answer<String> {
    let results: Results = parsed(results)?;
    let tables = summaries(&results);
    let sentences = tables
        .iter()
        .flat_map(|summary| summary.verdict().sentences);
    let sentences: Vec<String> = sentences.collect();
    let table = tables.first().map(|summary| summary.table());
    let (header, rows) = table.map_or_else(Default::default, |table| (table.heads, table.rows));
    json(&json!({"verdict": sentences.join("\n"), "header": header, "rows": rows}))
}
