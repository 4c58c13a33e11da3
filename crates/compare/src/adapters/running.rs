//! Runs the [rows](crate::adapters::rows) of one adapter, one process after the other, and keeps
//! the answer of each.
//!
//! ```no_run
//! use skiagraph_compare::{adapters::running::{AdapterRequest, run}, sink::Silent};
//!
//! let mut request = AdapterRequest::new("skiagraph".into());
//! request.is_small = true;
//! let finished = run(&request, &Silent)?;
//! for row in &finished.record.rows {
//!     println!("{}: {} in {:.0} s", row.row, row.outcome.words(), row.seconds);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::adapters::figures;
use crate::adapters::process::{self, Ended};
use crate::adapters::rows::{Row, rows};
use crate::error::CompareError;
use crate::files::json::to_text;
use crate::files::lock;
use crate::files::write::{check_folder, write_whole};
use crate::measuring::date;
use crate::pictures::run_pictures::slug;
use crate::records::abilities::Abilities;
use crate::records::adapter::{AdapterRecord, Figures, Outcome, RowRecord};
use crate::records::read_back;
use crate::records::results::PROGRAM;
use crate::sink::Sink;
use crate::wording::command_line;
use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
    time::{Duration, Instant},
};

/// Name of the file that holds an [`AdapterRecord`], the records of all rows.
pub const FILE: &str = "adapter.json";

/// Request to run the [`rows`] on one adapter.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct AdapterRequest {
    /// Path of the program `skiagraph`, whose commands answer the rows.
    pub program: PathBuf,
    /// Words for each command that choose the adapter: `--backend`, `gl`.
    pub arguments: Vec<String>,
    /// Folder for the rows, made if it is missing; `None` for one in the working directory, named
    /// `adapter-` with the words of adapter, backend and driver.
    pub out: Option<PathBuf>,
    /// Longest time for all rows. Rows that do not begin or end in it are left for the next call of
    /// [`run`].
    pub limit: Duration,
    /// True for the small rows, which measure little and only try that all works.
    pub is_small: bool,
    /// Names of the rows to run; empty for all.
    pub only: Vec<String>,
    /// True to run again the rows that the folder holds already.
    pub again: bool,
    /// Commit that the program was built from, for the record; `None` if unknown.
    pub commit: Option<String>,
}

impl AdapterRequest {
    /// Creates a request for all rows within eight minutes.
    pub fn new(program: PathBuf) -> Self {
        Self {
            program,
            arguments: Vec::new(),
            out: None,
            limit: Duration::from_secs(480),
            is_small: false,
            only: Vec::new(),
            again: false,
            commit: None,
        }
    }
}

/// Result of [`run`].
#[derive(Clone, Debug)]
pub struct Finished {
    /// Folder with a folder for each row, named like it, and [`FILE`].
    pub folder: PathBuf,
    /// The records of all rows that the folder holds now, earlier ones included.
    pub record: AdapterRecord,
    /// Names of the rows that this call did not finish: the time was up, or the user or the system
    /// ended them by a signal (SIGHUP, SIGINT, SIGTERM).
    pub left: Vec<&'static str>,
}

/// The longest time for the question which adapter this is.
const FIRST: Duration = Duration::from_secs(60);

/// A row is not begun with less time than this.
const LEAST: Duration = Duration::from_secs(3);

/// Seconds after which a frame is given up: sooner than a row's process, so that the row tells
/// which pass hung.
const FRAME_SECONDS: &str = "25";

/// Runs all rows on an adapter that its folder does not hold yet with the same command. After each
/// row its record is in the folder of the row, as row.json, and in [`FILE`]; a process that is
/// killed at any time loses no row but the one under way.
///
/// # Errors
/// An adapter that cannot be opened; an unknown name in [`AdapterRequest::only`]; a folder of
/// another adapter, program, commit or size of rows, or in which another process runs rows; a file
/// that cannot be read or written; an [early end](crate#terms). Rows that fail, crash or hang are
/// no error.
pub fn run(request: &AdapterRequest, sink: &dyn Sink) -> Result<Finished, CompareError> {
    let began = Instant::now();
    let abilities = abilities(request, sink)?;
    sink.note(&format!("adapter: {}", abilities.adapter));
    let rows = chosen(request)?;
    let folder = request.out.clone().unwrap_or_else(|| folder_of(&abilities));
    check_folder(&folder)?;
    let Some(_claimed) = lock::claim(&folder, lock::ADAPTER, sink)? else {
        return Err(CompareError::Input(format!(
            "another `skiagraph adapter` is at work in {}: wait for its end, or give another --out",
            folder.display()
        )));
    };
    let mut record = kept(request, &folder, &abilities)?;
    let mut left = Vec::new();
    for (index, row) in rows.iter().enumerate() {
        let command = command_of(request, row);
        let place = format!("{:>2}/{} {}", index + 1, rows.len(), row.name);
        let earlier = record.row(row.name);
        if earlier.is_some_and(|it| it.command == command) && !request.again {
            sink.note(&format!("{place}: kept from before"));
            continue;
        }
        let remaining = request.limit.saturating_sub(began.elapsed());
        let limit = remaining.min(Duration::from_secs(row.seconds));
        let lacks = row.needs.is_some_and(|ability| !abilities.has(ability))
            || row
                .unproven_on
                .contains(&abilities.adapter.backend.as_str());
        if limit < LEAST && !lacks {
            left.push(row.name);
            continue;
        }
        sink.note(&format!("{place}: {}", row.asks));
        let found = if lacks {
            lacking(row, command)
        } else {
            answer(request, row, command, (&folder, limit), sink)?
        };
        let is_out_of_time = found.outcome == Outcome::TimedOut && limit.as_secs() < row.seconds;
        let cut = if process::is_from_outside(found.exit, found.signal) {
            Some("ended from outside")
        } else {
            is_out_of_time.then_some("out of all rows' time")
        };
        sink.note(&format!("      {}", told(&found, cut)));
        if cut.is_some() {
            left.push(row.name);
            continue;
        }
        let own = folder.join(row.name);
        check_folder(&own)?;
        write_whole(&own.join("row.json"), to_text(&found).as_bytes())?;
        record.rows.retain(|it| it.row != row.name);
        record.rows.push(found);
        write_whole(&folder.join(FILE), to_text(&record).as_bytes())?;
    }
    write_whole(&folder.join(FILE), to_text(&record).as_bytes())?;
    Ok(Finished {
        folder,
        record,
        left,
    })
}

/// The rows that are asked for.
fn chosen(request: &AdapterRequest) -> Result<Vec<Row>, CompareError> {
    let mut rows = rows(request.is_small);
    let known: Vec<&str> = rows.iter().map(|row| row.name).collect();
    if let Some(name) = request.only.iter().find(|it| !known.contains(&it.as_str())) {
        let what = format!("unknown row `{name}`");
        return Err(CompareError::Request(crate::wording::unknown(
            &what, name, "rows", &known,
        )));
    }
    rows.retain(|row| request.only.is_empty() || request.only.iter().any(|it| it == row.name));
    Ok(rows)
}

/// Asks for the adapter in a process of its own: a driver that crashes when it is opened is told.
fn abilities(request: &AdapterRequest, sink: &dyn Sink) -> Result<Abilities, CompareError> {
    let folder =
        tempfile::tempdir().map_err(|error| CompareError::write(&std::env::temp_dir(), error))?;
    let mut command = Command::new(&request.program);
    command
        .args(["doctor", "--format", "json"])
        .args(&request.arguments);
    let ended = process::run(command, folder.path(), FIRST, sink)?;
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap_or_default();
    let said = read("stderr.txt");
    let said = said.trim().trim_start_matches("error: ");
    match ended.outcome {
        Outcome::Done => {}
        _ if process::is_from_outside(ended.exit, ended.signal) => {
            return Err(CompareError::interrupted());
        }
        Outcome::Lost => return Err(CompareError::NoGpu(said.into())),
        outcome => {
            return Err(CompareError::NoGpu(format!(
                "the adapter cannot be asked: `skiagraph doctor` {}{}\n{said}",
                outcome.words(),
                by_signal(&ended)
            )));
        }
    }
    let mut abilities: Abilities = serde_json::from_str(&read("stdout.txt"))
        .map_err(|why| CompareError::Input(format!("doctor's answer cannot be read: {why}")))?;
    abilities.machine.host = None;
    abilities.machine.load = None;
    Ok(abilities)
}

fn by_signal(ended: &Ended) -> String {
    let signal = ended.signal.map(|signal| format!(" by signal {signal}"));
    signal.unwrap_or_default()
}

/// The folder that names an adapter, its backend and its driver: two drivers of one GPU have two.
fn folder_of(abilities: &Abilities) -> PathBuf {
    let adapter = &abilities.adapter;
    let name = format!("{} {} {}", adapter.name, adapter.backend, adapter.driver);
    let words = slug(&name);
    let words = words.split('-').filter(|word| !word.is_empty());
    PathBuf::from(format!("adapter-{}", words.collect::<Vec<_>>().join("-")))
}

/// The rows that the folder holds already, if it is of this adapter.
fn kept(
    request: &AdapterRequest,
    folder: &Path,
    abilities: &Abilities,
) -> Result<AdapterRecord, CompareError> {
    let fresh = AdapterRecord {
        schema: 1,
        program: PROGRAM.into(),
        commit: request.commit.clone(),
        is_small: request.is_small,
        abilities: Some(abilities.clone()),
        rows: Vec::new(),
    };
    let Some(old) = read_back::adapter(folder)? else {
        return Ok(fresh);
    };
    let of = |record: &AdapterRecord| {
        let small = if record.is_small { "small" } else { "full" };
        let commit = record.commit.clone().unwrap_or("no commit".into());
        format!(
            "{}, {} ({commit}), {small} rows",
            record.adapter().unwrap_or_default(),
            record.program
        )
    };
    if of(&old) != of(&fresh) {
        return Err(CompareError::Input(format!(
            "{} holds rows of another kind; give another --out\n  it has {}\n  asked for is {}",
            folder.join(FILE).display(),
            of(&old),
            of(&fresh)
        )));
    }
    Ok(old)
}

fn command_of(request: &AdapterRequest, row: &Row) -> String {
    let words = ["skiagraph".to_owned()].into_iter();
    let words = words.chain(row.command.clone());
    command_line(words.chain(request.arguments.clone()).map(Into::into))
}

/// Runs a row.
fn answer(
    request: &AdapterRequest,
    row: &Row,
    told: String,
    (folder, limit): (&Path, Duration),
    sink: &dyn Sink,
) -> Result<RowRecord, CompareError> {
    let folder = folder.join(row.name);
    check_folder(&folder)?;
    let mut command = Command::new(&request.program);
    command
        .args(&row.command)
        .args(&request.arguments)
        .arg("--out")
        .arg(&folder);
    if !request.arguments.iter().any(|word| word == "--timeout") {
        command.args(["--timeout", FRAME_SECONDS]);
    }
    let ended = process::run(command, &folder, limit, sink)?;
    let figures = figures::of_folder(row, &folder)?;
    let said = match ended.outcome {
        Outcome::Done => Vec::new(),
        _ => last_lines(&folder.join("stderr.txt")),
    };
    Ok(RowRecord {
        row: row.name.into(),
        command: told,
        outcome: ended.outcome,
        exit: ended.exit,
        signal: ended.signal,
        seconds: (ended.took.as_secs_f64() * 10.0).round() / 10.0,
        limit: row.seconds,
        date: date::today(),
        said,
        figures,
    })
}

fn lacking(row: &Row, command: String) -> RowRecord {
    RowRecord {
        row: row.name.into(),
        command,
        outcome: Outcome::Lacking,
        exit: None,
        signal: None,
        seconds: 0.0,
        limit: row.seconds,
        date: date::today(),
        said: Vec::new(),
        figures: Figures::default(),
    }
}

/// The last lines of a text file.
fn last_lines(path: &Path) -> Vec<String> {
    const MOST: usize = 12;
    let text = fs::read(path).unwrap_or_default();
    let text = String::from_utf8_lossy(&text);
    let lines: Vec<&str> = text
        .lines()
        .filter(|line| !line.trim().is_empty())
        .collect();
    let last = lines.len().saturating_sub(MOST);
    lines[last..]
        .iter()
        .map(|line| (*line).to_owned())
        .collect()
}

/// The end of a row as a line.
fn told(row: &RowRecord, cut: Option<&str>) -> String {
    if let Some(cut) = cut {
        return format!("{cut} after {} s: run it again to go on", row.seconds);
    }
    let signal = row.signal.map(|signal| format!(", signal {signal}"));
    let mut text = format!(
        "{}{} after {} s",
        row.outcome.words(),
        signal
            .filter(|_| row.outcome == Outcome::Crashed)
            .unwrap_or_default(),
        row.seconds
    );
    if row.outcome == Outcome::Lacking {
        text = row.outcome.words().into();
    }
    let cells = row.figures.cells.iter();
    let wrong: u64 = cells.clone().map(|cell| cell.wrong_outside).sum();
    if cells.len() > 0 {
        text += &format!("; {} cells", cells.len());
        let exact = cells.filter(|cell| cell.is_exact);
        let exact: u64 = exact.map(|cell| cell.wrong_outside).sum();
        text += &format!(", exact methods wrong on {exact} pixels, all on {wrong}");
    }
    for equality in row.figures.equal.iter().filter(|it| it.differing > 0) {
        let [one, other] = &equality.methods;
        text += &format!(
            "; {one} and {other} differ on {} pixels",
            equality.differing
        );
    }
    for method in row.figures.hard.iter().filter(|it| it.failed > 0) {
        text += &format!("; {} fails {} cases", method.method, method.failed);
    }
    text
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use crate::sink::Silent;
    use std::os::unix::fs::PermissionsExt;

    /// A program whose rows end as `script` says; it runs on an adapter with ray queries.
    fn program(folder: &Path, backend: &str, script: &str) -> PathBuf {
        let adapter = format!(
            r#"{{"name": "a", "backend": "{backend}", "driver": "c", "device_type": "Cpu"}}"#
        );
        let doctor = format!(
            r#"{{"schema": 1, "program": "p", "machine": {{"host": "h", "processor": "", "cores": 1,
                "load": null}}, "adapters": [], "adapter": {adapter}, "limits": {{"texture_edge": 1,
                "storage_binding": 1, "buffer": 1, "memory": null, "threads": 1, "groups": 1}},
                "features": {{"ray_query": true}}}}"#
        );
        let text =
            format!("#!/bin/sh\nif [ \"$1\" = doctor ]; then echo '{doctor}'; else {script}; fi\n");
        let path = folder.join("program.sh");
        fs::write(&path, text).unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
        path
    }

    /// Runs the row `hard_area` by such a program.
    fn turn(folder: &Path, backend: &str, script: &str) -> Finished {
        let mut request = AdapterRequest::new(program(folder, backend, script));
        request.out = Some(folder.join(format!("out-{backend}")));
        request.only = vec!["hard_area".into()];
        run(&request, &Silent).unwrap()
    }

    #[test]
    fn a_row_whose_methods_are_not_proven_on_the_backend_is_left_out() {
        let folder = tempfile::tempdir().unwrap();
        let finished = turn(folder.path(), "gl", "exit 1");
        assert_eq!(finished.record.rows[0].outcome, Outcome::Lacking);
        let finished = turn(folder.path(), "vulkan", "exit 1");
        assert_eq!(finished.record.rows[0].outcome, Outcome::Failed);
    }

    #[test]
    fn a_row_that_was_ended_from_outside_is_run_again_and_a_crash_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let turn = |script: &str| turn(folder.path(), "vulkan", script);
        // Not by SIGINT, which a shell's background jobs ignore.
        for script in ["kill -TERM $$", "exit 130"] {
            let finished = turn(script);
            assert_eq!(finished.left, ["hard_area"], "{script}");
            assert!(finished.record.rows.is_empty(), "{script}");
        }
        for script in ["kill -SEGV $$", "exit 0"] {
            let finished = turn(script);
            assert!(finished.left.is_empty(), "{script}");
            let row = &finished.record.rows[0];
            let ended = (row.outcome, row.signal);
            assert_eq!(ended, (Outcome::Crashed, Some(11)), "{script}");
        }
    }
}
