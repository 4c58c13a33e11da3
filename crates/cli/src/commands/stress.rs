//! `skiagraph stress`: runs methods on hard cases and checks that each keeps its guarantee.

use crate::args::commands::{RecordFormat, StressArgs};
use crate::args::shared::GpuArgs;
use crate::error::CliError;
use crate::terminal::console::print;
use crate::terminal::{Terminal, interrupt, progress, stop};
use itertools::Itertools;
use skiagraph_cases::HardCase;
use skiagraph_compare::files::json::to_text;
use skiagraph_compare::files::write::write_whole;
use skiagraph_compare::graphs::{method, preset, shadow_method};
use skiagraph_compare::measuring::device;
use skiagraph_compare::measuring::ground_truth::PrimaryVisibility;
use skiagraph_compare::measuring::hard_case::{HardCaseContext, MethodRun};
use skiagraph_compare::measuring::hard_cases::{cases, check_exact, check_pictures, claim, plan};
use skiagraph_compare::records::stress::{Column, Report, Verdict};
use skiagraph_compare::sink::{Session, Sink};
use skiagraph_compare::wording::{command_line, plural};
use skiagraph_gpu::timing::Trust;
use skiagraph_report::stress_matrix;

/// Checks all arguments, then runs the methods on the cases and prints and saves the results.
///
/// # Errors
/// If no method can run, a case is unknown, no GPU can be opened, Ctrl-C stops the command, a file
/// cannot be written, a guarantee is broken, rounding decides too many pixels of a case, or, behind
/// the results of the others, a document has mistakes.
pub async fn stress(args: &StressArgs, gpu: &GpuArgs) -> Result<(), CliError> {
    if args.list {
        return print(&stress_matrix::catalogue());
    }
    let cases = cases(&args.cases)?;
    let sources = preset::sources(&Terminal);
    let names = preset::named_or_all(&args.presets, &sources);
    check_exact(&args.exact, &names)?;
    let (params, sizes) = (&args.sweep.params, &args.sweep.map_size);
    let methods = method::load(&names, params, sizes, &sources, shadow_method::load_each)?;
    let primary = PrimaryVisibility::load(&sources)?;
    let viewport = args.size.0;
    let graphs = methods.iter().map(|method| &method.preset.graph);
    let gpu = device::open(&gpu.request(), graphs)?;
    let session = Session::new(&gpu, &Terminal);
    let methods = methods.into_iter().map(|method| {
        let method = method.at(viewport).settled(gpu.device.features());
        MethodRun::new(method, &args.exact)
    });
    let mut methods: Vec<MethodRun> = methods.collect();
    let mistakes = plan(session, &primary, &mut methods, &cases, viewport)?;
    if let Some(folder) = &args.save {
        check_pictures(&methods, &cases, viewport, folder)?;
    }
    let out = args.out.as_ref();
    let _claimed = out.map(|folder| claim(folder, &Terminal)).transpose()?;
    let context = HardCaseContext {
        session,
        primary: &primary,
        methods: &methods,
        viewport,
        pictures: args.save.as_deref(),
    };
    // Nothing is timed, so whether timestamps can be trusted is of no interest.
    let mut report = context.report(device::describe(&gpu, Trust::Trusted));
    interrupt::install()?;
    progress::begin_quietly("hard cases", cases.len() as u64, "cases");
    let outcome = run(&context, &cases, &mut report, args).await;
    Terminal.end_step(outcome.is_ok());
    stop::take_end();
    finish(&report, outcome, cases.len(), args)?;
    match &mistakes[..] {
        [] => Ok(()),
        mistakes => Err(CliError::Judged(mistakes.join("\nerror: "))),
    }
}

/// Runs case after case; whatever is done is on disk at once.
async fn run(
    context: &HardCaseContext<'_>,
    cases: &[HardCase],
    report: &mut Report,
    args: &StressArgs,
) -> Result<(), CliError> {
    for (done, case) in (0..).zip(cases) {
        progress::set_part(case.name);
        Terminal.set_done(done);
        report.cases.push(context.run(case).await?);
        if let Some(folder) = &args.out {
            write_whole(&folder.join("stress.json"), to_text(report).as_bytes())?;
        }
        let (report, args, wanted) = (report.clone(), args.clone(), cases.len());
        interrupt::on_end_in_the_middle(move || {
            let kept = String::new();
            finish(&report, Err(CliError::Interrupted { kept }), wanted, &args)
        });
    }
    Ok(())
}

/// Prints what is done, and says what came of it.
fn finish(
    report: &Report,
    outcome: Result<(), CliError>,
    wanted: usize,
    args: &StressArgs,
) -> Result<(), CliError> {
    let done = report.cases.len();
    if done > 0 {
        match args.format {
            RecordFormat::Table => print(&stress_matrix::render(report, &|column, case, set| {
                command_for(args, column, case, set)
            }))?,
            RecordFormat::Json => print(&to_text(report))?,
        }
    }
    if let Err(CliError::Interrupted { .. }) = outcome {
        let kept = match &args.out {
            _ if done == 0 => "no case was finished".into(),
            Some(folder) => {
                let file = folder.join("stress.json");
                format!("{done} of {wanted} cases are kept in {}", file.display())
            }
            None => format!("{done} of {wanted} cases were finished"),
        };
        return Err(CliError::Interrupted { kept });
    }
    outcome?;
    let failed = [
        (report.count(Verdict::Fail), "cell"),
        (report.failed_cases(), "case"),
    ];
    let failed = failed.into_iter().filter(|(count, _)| *count > 0);
    let mut failed = failed.map(|(count, noun)| plural(count, noun));
    match failed.join(" and ").as_str() {
        "" => Ok(()),
        failed => Err(CliError::Judged(format!("{failed} failed"))),
    }
}

/// The command that shows a cell.
fn command_for(args: &StressArgs, column: &Column, case: &str, set: Option<&str>) -> String {
    let mut words = vec!["skiagraph".into(), "stress".into(), column.preset.clone()];
    let mut option = |name: &str, value: String| words.extend([name.into(), value]);
    option("--case", case.into());
    option("--size", args.size.to_string());
    if let Some(size) = column.map_size {
        option("--map-size", size.to_string());
    }
    for param in &args.sweep.params {
        option("--set", format!("{}={}", param.name, param.value));
    }
    if let Some(set) = set {
        option("--set", set.into());
    }
    if args.exact.contains(&column.preset) {
        option("--exact", column.preset.clone());
    }
    option("--save", "pictures".into());
    command_line(words.into_iter().map(|word: String| word.into()))
}
