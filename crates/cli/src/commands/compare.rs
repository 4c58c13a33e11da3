//! `skiagraph compare`: measures speed and error of methods on every view, viewport and map size.

use crate::args::commands::{CompareArgs, Format, Images};
use crate::args::shared::GpuArgs;
use crate::commands::loaded::{Loaded, Target};
use crate::error::CliError;
use crate::terminal::console::{note, print};
use crate::terminal::{Terminal, interrupt};
use itertools::Itertools;
use skiagraph_compare::comparison::Comparison;
use skiagraph_compare::error::CompareError;
use skiagraph_compare::files::json;
use skiagraph_compare::files::write::{check_folder, write_whole};
use skiagraph_compare::graphs::faults::GraphFaults;
use skiagraph_compare::graphs::planning::Capabilities;
use skiagraph_compare::measuring::{date, resume::Kept, series::Series, tune::tune};
use skiagraph_compare::pictures::run_pictures::graph_name;
use skiagraph_compare::records::{results::Results, results_baseline::Baseline};
use skiagraph_compare::sink::{Session, Silent};
use skiagraph_compare::wording::{or_nothing, plural, size};
use skiagraph_draw::{from_plan, to_svg};
use skiagraph_passes::SceneProvider;
use skiagraph_report::overview::Overview;
use skiagraph_report::summary_table::{self, Summary};
use skiagraph_report::table::terminal;
use skiagraph_report::{baseline_text, markdown, matrices, page, results_table};
use std::io::IsTerminal;
use std::path::{Path, PathBuf};

/// Checks all arguments, then measures the methods on each scene and prints and saves the results.
///
/// # Errors
/// If a scene cannot be loaded, no GPU can be opened, earlier results cannot be continued, Ctrl-C
/// stops the command, no method runs on this adapter, or, behind the results: a document has
/// mistakes, a limit of `--fail-if` is exceeded, or a method is worse than in `--baseline`.
pub async fn compare(args: &CompareArgs, gpu: &GpuArgs) -> Result<(), CliError> {
    let baseline = args.baseline.as_deref().map(Baseline::read).transpose()?;
    let loaded = Loaded::new(args, gpu, std::env::args_os())?;
    let (mut comparisons, targets) = (loaded.comparisons, loaded.targets);
    let session = Session::new(&loaded.gpu, &Terminal);
    let silent = Session::new(&loaded.gpu, &Silent);
    let mut work = Work {
        args,
        baseline,
        session,
        results: Vec::new(),
        mistakes: Vec::new(),
        failures: Vec::new(),
        worse: Vec::new(),
        folders: Vec::new(),
    };
    for (comparison, target) in comparisons.iter_mut().zip(&targets) {
        check_folder(&target.folder)?;
        if args.tune && comparison.refusals(silent)?.is_empty() {
            // Refused before the search, not behind it.
            work.check_earlier(comparison, target).await?;
            tune(comparison, session).await.map_err(search_ended)?;
        }
    }
    check_all(&comparisons, session)?;
    for (comparison, target) in comparisons.iter().zip(&targets) {
        work.check_earlier(comparison, target).await?;
    }
    let outcome = async {
        for (comparison, target) in comparisons.into_iter().zip(&targets) {
            work.measure(&comparison, target).await?;
        }
        Ok(())
    }
    .await;
    let shown = match targets[..] {
        [_] => Ok(()),
        _ => overview(args, &targets, &work.results),
    };
    let (mistakes, failures, worse) = (work.mistakes, work.failures, work.worse);
    let lines = [&mistakes, &failures, &worse].into_iter().flatten();
    if outcome.is_err() {
        lines.clone().for_each(|line| note(line));
    }
    outcome.and(shown)?;
    let text = lines.unique().join("\nerror: ");
    Err(match (&mistakes[..], &failures[..], &worse[..]) {
        ([], [], []) => return Ok(()),
        ([], [], _) => CliError::Baseline(text),
        ([], ..) => CliError::Gate(text),
        _ => CliError::Judged(text),
    })
}

/// A comparison under way, with the results of the scenes so far.
struct Work<'a> {
    args: &'a CompareArgs,
    baseline: Option<Baseline>,
    session: Session<'a>,
    /// Results of the scenes that have any, in the order of the scenes.
    results: Vec<Results>,
    /// Mistakes of methods, and scenes on which none can run.
    mistakes: Vec<String>,
    /// Conditions of `--fail-if` that do not hold.
    failures: Vec<String>,
    /// Methods that are worse than in `--baseline`.
    worse: Vec<String>,
    /// Folders of the scenes that are done.
    folders: Vec<PathBuf>,
}

impl Work<'_> {
    /// Checks that the earlier results of a scene can be continued, and that the baseline has some
    /// of its cells, before the first scene is measured.
    async fn check_earlier(
        &self,
        comparison: &Comparison,
        target: &Target,
    ) -> Result<(), CliError> {
        let silent = Session::new(self.session.gpu, &Silent);
        let kept = Some((&*target.folder, kept(self.args)));
        let series = Series::new(comparison, silent, kept).await?;
        if let Some(baseline) = &self.baseline {
            baseline.check(&series.results, series.planned_runs())?;
        }
        Ok(())
    }

    /// Measures a scene, prints and saves its results.
    async fn measure(&mut self, comparison: &Comparison, target: &Target) -> Result<(), CliError> {
        let (args, folder) = (self.args, &target.folder);
        let mut series = Series::new(comparison, self.session, Some((folder, kept(args)))).await?;
        let file = folder.join("results.json");
        let written = |file: &Path| file.metadata().and_then(|file| file.modified()).ok();
        let (before, has_runs) = (written(&file), !series.results.runs.is_empty());
        let some = format!("finished runs are kept in {}", file.display());
        let [none, some] = [None, Some(some)].map(|runs| self.what_is_kept(target, runs));
        let (page, finished) = (args.out.join(page::FILE), self.folders.clone());
        interrupt::on_end_in_the_middle(move || {
            show_scenes(&finished, &page)?;
            let is_some = has_runs || written(&file) != before;
            let kept = if is_some { some } else { none };
            Err(CliError::Interrupted { kept })
        });
        // Behind the above, so that an end after it tells what is kept of this scene.
        if let Some(name) = &target.name {
            let (number, count) = (self.folders.len() + 1, args.scene.scenes.len());
            note(&format!("{name}, scene {number} of {count}"));
        }
        write_graphs(comparison, folder, self.session)?;
        let outcome = run(args, comparison, &mut series).await;
        let results = self.finish(target, series, outcome)?;
        self.judge(target, &results)?;
        self.folders.push(folder.clone());
        Ok(())
    }

    /// Says what is kept after an early end: finished scenes, and the `runs` of the one under way.
    fn what_is_kept(&self, target: &Target, runs: Option<String>) -> String {
        let (finished, total) = (self.folders.len(), self.args.scene.scenes.len());
        let has_any = finished > 0 || runs.is_some();
        let mut kept = runs.unwrap_or_else(|| NONE_FINISHED.into());
        if has_any {
            kept += &format!("; {RESUME}");
        }
        match &target.name {
            Some(name) => format!("scenes finished: {finished} of {total}; {name}: {kept}"),
            None => kept,
        }
    }

    /// Says what came of a scene, and returns its results.
    fn finish(
        &mut self,
        target: &Target,
        mut series: Series,
        outcome: Result<(), CliError>,
    ) -> Result<Results, CliError> {
        let (planned, folder) = (series.planned(), &target.folder);
        if !series.results.runs.is_empty() {
            let whole = series.whole();
            print_summary(self.args, &whole)?;
            series.save(&[])?;
            page::write_beside(folder, &Terminal)?;
            self.results.push(whole);
        }
        let (results, broken) = (series.results, series.broken);
        let file = folder.join("results.json");
        let (done, file) = (results.runs.len(), file.display());
        let runs = (done > 0).then(|| format!("{done} of {planned} runs are kept in {file}"));
        let kept = self.what_is_kept(target, runs);
        match outcome {
            Ok(()) => {}
            Err(CliError::Interrupted { .. }) => return Err(CliError::Interrupted { kept }),
            Err(error) => {
                note(&kept);
                return Err(error);
            }
        }
        self.mistakes.extend(broken);
        if results.runs.iter().all(|run| run.measured.is_none()) {
            let place = target.name.as_ref().unwrap_or(&results.adapter.name);
            let text = format!("no method can run on {place}; the reasons stand above");
            self.mistakes.push(text);
        }
        tell_files(self.args, target, &results);
        Ok(results)
    }

    /// Holds the results of a scene against the gates, and shows what has changed since the
    /// baseline.
    fn judge(&mut self, target: &Target, results: &Results) -> Result<(), CliError> {
        let scene = or_nothing(target.name.as_ref(), |name| format!("{name}: "));
        let gates = self.args.fail_if.iter();
        let failures = gates.flat_map(|gate| gate.failures(results));
        self.failures
            .extend(failures.map(|line| format!("{scene}{line}")));
        if let Some(baseline) = &self.baseline {
            let changes = baseline.against(results)?;
            let worse = baseline_text::failures(&changes).into_iter();
            self.worse
                .extend(worse.map(|line| format!("{scene}{line}")));
            match self.args.format {
                Format::Table => print(&format!("\n{}", baseline_text::text(&changes)))?,
                Format::Markdown | Format::Json => note(&baseline_text::text(&changes)),
            }
        }
        Ok(())
    }
}

/// The reasons of all scenes if no method can run on any; the other errors of
/// [`Comparison::check`].
pub fn check_all(comparisons: &[Comparison], session: Session) -> Result<(), CliError> {
    let (mut refusals, mut refused) = (GraphFaults::default(), 0);
    for comparison in comparisons {
        let reasons = comparison.refusals(session)?;
        refused += usize::from(!reasons.is_empty());
        refusals.append(reasons);
    }
    if refused < comparisons.len() {
        return Ok(());
    }
    Ok(refusals.none_or_error()?)
}

/// The error of a search for settings, before which nothing is measured.
fn search_ended(why: CompareError) -> CliError {
    match why {
        CompareError::Interrupted { .. } => CliError::Interrupted {
            kept: NONE_FINISHED.into(),
        },
        why => why.into(),
    }
}

/// The earlier results that are kept.
fn kept(args: &CompareArgs) -> Kept {
    match (args.replace, args.resume) {
        (true, _) => Kept::Nothing,
        (_, true) => Kept::All,
        _ => Kept::Others,
    }
}

/// Writes a chart of each method's graph, if pictures are written; of one that this adapter cannot
/// run there is none.
pub fn write_graphs(
    comparison: &Comparison,
    folder: &Path,
    session: Session,
) -> Result<(), CliError> {
    let viewport = comparison.viewports.first();
    let Some(&viewport) = viewport.filter(|_| comparison.protocol.pictures) else {
        return Ok(());
    };
    let mut provider = SceneProvider::new(comparison.scene.clone());
    if let Some(&light) = comparison.kinds_of_light().last() {
        provider.set_light(light);
    }
    for method in &comparison.methods {
        let capabilities = Capabilities::new(session.gpu);
        let plan = method.at(viewport).plan(viewport, capabilities, &provider);
        let title = format!("{}, viewport {}", method.name, size(viewport));
        if let Ok(plan) = plan {
            let svg = to_svg(&from_plan(&plan).titled(title));
            write_whole(&folder.join(graph_name(&method.name)), svg.as_bytes())?;
        }
    }
    Ok(())
}

/// Measures what is missing, and prints every view and viewport when it is whole.
async fn run(
    args: &CompareArgs,
    comparison: &Comparison,
    series: &mut Series<'_>,
) -> Result<(), CliError> {
    if args.format == Format::Markdown {
        let is_done = series.results.runs.len() == series.planned();
        let today = (!is_done).then(date::today);
        let (results, published) = (&series.results, &args.published);
        let is_path = args.path.is_some();
        print(&markdown::header(
            results,
            today.as_deref(),
            published,
            is_path,
        ))?;
    }
    for (index, view_or_path) in comparison.views.iter().enumerate() {
        if args.format == Format::Markdown {
            print(&markdown::view(view_or_path.name()))?;
        }
        for viewport in 0..comparison.viewports.len() {
            let outcome = series.measure(index, viewport).await;
            let (results, runs) = (&series.results, series.runs(index, viewport));
            match args.format {
                Format::Table if args.details => {
                    print(&format!("{}\n", results_table::group(results, runs)))?;
                }
                Format::Markdown => print(&markdown::viewport(results, runs))?,
                Format::Table | Format::Json => {}
            }
            outcome?;
        }
    }
    Ok(())
}

/// Prints the summary over all views and viewports, as far as they are done.
fn print_summary(args: &CompareArgs, results: &Results) -> Result<(), CliError> {
    let summaries = summary_table::summaries(results);
    match args.format {
        Format::Table => {
            let is_terminal = std::io::stdout().is_terminal();
            let mut texts = summaries.iter().map(|summary| summary.text(is_terminal));
            print(&texts.join("\n"))?;
            for (viewport, lights) in matrices::by_light(results) {
                let head = format!("By light, {}: wrong pixels, frame, memory", size(viewport));
                print(&format!("\n{head}\n{}\n", terminal(&lights)))?;
            }
            if args.passes {
                print(&format!("\n{}\n", matrices::passes(results)))?;
            }
            Ok(())
        }
        Format::Markdown => {
            print(&summaries.iter().map(Summary::markdown).collect::<String>())?;
            for (viewport, lights) in matrices::by_light(results) {
                let (size, table) = (size(viewport), lights.markdown());
                print(&format!("\n## By light, {size}\n\n{table}"))?;
            }
            Ok(())
        }
        // Those of several scenes are printed as one list.
        Format::Json if args.scene.scenes.len() > 1 => Ok(()),
        Format::Json => print(&json::to_text(results)),
    }
}

/// Prints the scenes that have results beside each other, and writes the page of all.
fn overview(args: &CompareArgs, targets: &[Target], results: &[Results]) -> Result<(), CliError> {
    let names = targets.iter().filter_map(|target| target.name.as_deref());
    let summaries: Vec<Vec<Summary>> = results.iter().map(summary_table::summaries).collect();
    let summaries = names.zip(&summaries);
    let summaries = summaries
        .flat_map(|(name, summaries)| summaries.iter().map(move |summary| (name, summary)));
    let overview = Overview::new(&summaries.collect::<Vec<_>>());
    match (args.format, overview) {
        (Format::Json, _) => print(&json::to_text(&results))?,
        (Format::Table, Some(overview)) => print(&format!("\n{}", overview.text()))?,
        (Format::Markdown, Some(overview)) => print(&overview.markdown())?,
        (_, None) => {}
    }
    let folders = targets.iter().map(|target| target.folder.clone());
    let folders: Vec<PathBuf> = folders.take(results.len()).collect();
    show_scenes(&folders, &args.out.join(page::FILE))
}

/// Writes the page of several scenes, if any is finished.
fn show_scenes(folders: &[PathBuf], page: &Path) -> Result<(), CliError> {
    if !folders.is_empty() {
        page::write(folders, page, &Terminal)?;
        let scenes = plural(folders.len(), "scene");
        note(&format!("{} shows {scenes}", page.display()));
    }
    Ok(())
}

/// All that is said after Ctrl-C where nothing is kept.
const NONE_FINISHED: &str = "no run was finished";

/// The way out after Ctrl-C.
const RESUME: &str = "the same command with --resume goes on from there";

/// Says which files are there, and what they lack.
fn tell_files(args: &CompareArgs, target: &Target, results: &Results) {
    let files = match args.images {
        Images::All => "report.html, results.json, results.csv and the pictures",
        Images::None => "report.html, results.json and results.csv",
    };
    if !args.published.is_empty() && results.runs.iter().all(|run| run.published.is_empty()) {
        note(
            "--beside has no effect: none of its figures is of these scenes, views, viewports, \
             maps and presets",
        );
    }
    note(&format!("{files} are in {}", target.folder.display()));
    let runs = results.runs.iter().filter_map(|run| run.measured.as_ref());
    let bare = runs.filter(|run| run.images.is_none()).count();
    if args.images == Images::All && bare > 0 {
        note(&format!(
            "{bare} of the runs that were kept have no pictures: they were measured with --images \
             none"
        ));
    }
}
