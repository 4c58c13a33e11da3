//! `skiagraph stress`: the hard cases with every method, and whether each keeps its promise.

mod matrix;
mod promise;
mod report;
mod trial;

use crate::{
    args::{GpuArgs, StressArgs, StressFormat},
    contract,
    error::{CliError, print},
    files::check_folder,
    interrupt, markdown, measure,
    measure::{Method, check_stems, reference_stem},
    parse::unique,
    preset::{self, closest},
    progress::Step,
    reference::Primary,
    render,
    table::{add_row, new_table},
};
use report::{Column, Report, Verdict};
use skiagraph_graph::{gpu::Gpu, timing::Trust};
use skiagraph_passes::SceneProvider;
use skiagraph_scene::hard::{self, Casters, HardCase};
use std::{path::Path, sync::Arc};
use trial::{Contender, Trial};

/// Checks everything, then runs the matrix.
///
/// # Errors
/// Faulty graphs, an unknown case, no GPU, Ctrl-C, files that cannot be written, a promise that is broken, a band above its cap.
pub fn stress(args: &StressArgs, asked: &GpuArgs) -> Result<(), CliError> {
    if args.list {
        return list();
    }
    let cases = cases(&args.cases)?;
    let sources = preset::sources();
    let names = if args.presets.is_empty() {
        skiagraph_passes::presets()
            .into_iter()
            .map(|preset| preset.name)
            .collect()
    } else {
        args.presets.clone()
    };
    check_exact(&args.exact, &names)?;
    let presets = contract::load_all(&names, &sources)?;
    let methods = measure::methods(&presets, &args.params, &args.map_size)?;
    let primary = Primary::load(&sources)?;
    let provider = SceneProvider::new(Arc::new(tangible(&cases).scene()));
    contract::check_plans(&methods, &[args.size.0], &provider, None)?;
    let wanted = presets.iter().map(|preset| preset.graph.features());
    let gpu = render::open(
        asked,
        wanted.fold(wgpu::Features::empty(), |all, own| all | own),
    )?;
    primary.plan(&gpu, args.size.0, &provider)?;
    let contenders: Vec<Contender> = methods
        .into_iter()
        .map(|method| contender(method, args, &gpu, &provider))
        .collect();
    check_abilities(&contenders, &gpu)?;
    if let Some(folder) = &args.save {
        check_pictures(&contenders, &cases, args)?;
        check_folder(folder)?;
    }
    if let Some(folder) = &args.out {
        check_folder(folder)?;
    }
    let trial = Trial {
        gpu: &gpu,
        primary: &primary,
        contenders: &contenders,
        viewport: args.size.0,
        pictures: args.save.as_deref(),
    };
    let mut report = Report {
        schema: 1,
        program: concat!("skiagraph ", env!("CARGO_PKG_VERSION")).into(),
        // Nothing is timed, so whether timestamps can be trusted is of no interest.
        adapter: render::describe(&gpu, &Trust::Trusted),
        viewport: args.size.0,
        methods: contenders.iter().map(Contender::column).collect(),
        cases: Vec::new(),
    };
    interrupt::install()?;
    let outcome = run(&trial, &cases, &mut report, args.out.as_deref());
    finish(&report, outcome, cases.len(), args)
}

/// Runs case after case; whatever is done is on disk at once.
fn run(
    trial: &Trial,
    cases: &[HardCase],
    report: &mut Report,
    out: Option<&Path>,
) -> Result<(), CliError> {
    let step = Step::bar("hard cases".into(), cases.len() as u64, "cases");
    for (done, case) in (0..).zip(cases) {
        step.name(case.name);
        step.reach(done);
        report.cases.push(trial.run(case)?);
        if let Some(folder) = out {
            report.save(folder)?;
        }
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
            StressFormat::Table => print(&matrix::render(report, &|column, case, set| {
                look(args, column, case, set)
            }))?,
            StressFormat::Json => print(&report.to_json())?,
        }
    }
    if let Err(CliError::Interrupted { .. }) = outcome {
        let kept = match &args.out {
            _ if done == 0 => "no case was finished".into(),
            Some(folder) => format!(
                "{done} of {wanted} cases are kept in {}",
                folder.join("stress.json").display()
            ),
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
    let failed: Vec<String> = failed
        .map(|(count, noun)| match count {
            1 => format!("1 {noun}"),
            _ => format!("{count} {noun}s"),
        })
        .collect();
    match &failed[..] {
        [] => Ok(()),
        _ => Err(CliError::Judged(format!("{} failed", failed.join(" and ")))),
    }
}

/// The method with what is promised of it, and why this adapter cannot run it, if it cannot.
fn contender<'a>(
    method: Method<'a>,
    args: &StressArgs,
    gpu: &Gpu,
    provider: &SceneProvider,
) -> Contender<'a> {
    let plan = method.plan(args.size.0, render::abilities(gpu), provider);
    let unavailable = plan.err().map(|faults| measure::reasons(&faults));
    Contender {
        unavailable,
        ..Contender::new(method, &args.exact)
    }
}

/// Refuses to run where there is nothing to run.
fn check_abilities(contenders: &[Contender], gpu: &Gpu) -> Result<(), CliError> {
    let reasons = contenders.iter().map(|contender| {
        let reason = contender.unavailable.as_ref()?;
        Some(format!("\n  {}: {reason}", contender.method.preset.name))
    });
    match reasons.collect::<Option<String>>() {
        Some(reasons) => Err(CliError::Input(format!(
            "no method can run on {}{reasons}",
            gpu.adapter.get_info().name
        ))),
        None => Ok(()),
    }
}

/// The command that shows a cell.
fn look(args: &StressArgs, column: &Column, case: &str, set: Option<&str>) -> String {
    let mut words = vec!["skiagraph".into(), "stress".into(), column.preset.clone()];
    let mut option = |name: &str, value: String| words.extend([name.into(), value]);
    option("--case", case.into());
    option("--size", args.size.to_string());
    if let Some(size) = column.map_size {
        option("--map-size", size.to_string());
    }
    for param in &args.params {
        option("--set", format!("{}={}", param.name, param.value));
    }
    if let Some(set) = set {
        option("--set", set.into());
    }
    if args.exact.contains(&column.preset) {
        option("--exact", column.preset.clone());
    }
    option("--save", "pictures".into());
    markdown::command_line(words.into_iter().map(|word: String| word.into()))
}

/// The cases of these names, or all.
fn cases(names: &[String]) -> Result<Vec<HardCase>, CliError> {
    if names.is_empty() {
        return Ok(hard::cases());
    }
    let find = |name: &String| {
        hard::case(name).ok_or_else(|| {
            let known = hard::cases();
            let hint = closest(name, known.iter().map(|case| case.name))
                .map_or(String::new(), |name| format!("; did you mean `{name}`?"));
            CliError::Input(format!(
                "there is no case `{name}`{hint}\n  `skiagraph stress --list` names them"
            ))
        })
    };
    unique(names).iter().map(find).collect()
}

/// A case with something to draw, if there is one: what is wrong with a graph on an empty mesh is a result, not a mistake in the graph.
fn tangible(cases: &[HardCase]) -> HardCase {
    let is_tangible = |case: &&HardCase| !case.scene().mesh.triangles.is_empty();
    *cases.iter().find(is_tangible).unwrap_or(&cases[0])
}

fn check_exact(exact: &[String], names: &[String]) -> Result<(), CliError> {
    match exact.iter().find(|name| !names.contains(name)) {
        None => Ok(()),
        Some(name) => {
            let hint = closest(name, names.iter().map(String::as_str))
                .map_or(String::new(), |name| format!("; did you mean `{name}`?"));
            Err(CliError::Usage(format!(
                "--exact {name}: none of the methods that run has this name{hint}\n  methods: {}",
                names.join(", ")
            )))
        }
    }
}

/// Refuses cells that would overwrite each other's pictures, before anything runs.
fn check_pictures(
    contenders: &[Contender],
    cases: &[HardCase],
    args: &StressArgs,
) -> Result<(), CliError> {
    let mut stems = Vec::new();
    for case in cases {
        let reference = reference_stem(case.name, args.size.0);
        stems.push((reference, format!("the reference of `{}`", case.name)));
        for contender in contenders {
            stems.extend(contender.stems(case, args.size.0));
        }
    }
    check_stems(stems, "--save")
}

/// Lists the catalogue.
fn list() -> Result<(), CliError> {
    let mut table = new_table(&["case", "casters", "what it provokes"], 3);
    for case in hard::cases() {
        let casters = match case.casters {
            Casters::Closed => "closed",
            Casters::Open => "open",
        };
        add_row(
            &mut table,
            vec![case.name.into(), casters.into(), case.reason.into()],
            3,
        );
    }
    print(&format!("{table}\n"))
}
