//! Progress on standard error. On a terminal it is a bar for the current step, in a pipe a line
//! every few seconds. With `SKIAGRAPH_PROGRESS=lines` it is, in a pipe, a line at the begin and the
//! end of each step instead.

use crate::terminal::console::{self, note};
use crate::terminal::stop;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use skiagraph_compare::sink::Sink;
use skiagraph_compare::wording::or_nothing;
use skiagraph_graph::{Diagnostic, diagnostics};
use std::io::{self, IsTerminal};
use std::sync::atomic::AtomicBool;
use std::sync::{Mutex, MutexGuard, Once, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// Time between two lines in a pipe.
const PERIOD: Duration = Duration::from_secs(5);

#[derive(Clone, Copy, PartialEq)]
enum Style {
    Bar,
    /// A line each [`PERIOD`].
    Periodic,
    /// A line at the begin and the end of each step.
    Steps,
}

fn style() -> Style {
    let is_asked = || std::env::var_os("SKIAGRAPH_PROGRESS").is_some_and(|value| value == "lines");
    if io::stderr().is_terminal() {
        Style::Bar
    } else if is_asked() {
        Style::Steps
    } else {
        Style::Periodic
    }
}

/// Work of `total` equal parts, `done` of them done; `began` when the first was.
#[derive(Clone)]
struct Share {
    done: u64,
    total: u64,
    unit: &'static str,
    began: Instant,
}

impl Share {
    fn begin(total: u64, unit: &'static str) -> Self {
        Self {
            done: 0,
            total,
            unit,
            began: Instant::now(),
        }
    }

    /// Time left in words, if parts go on to take as long as those that are done.
    fn left(&self) -> Option<String> {
        left(self.began.elapsed(), self.done, self.total)
    }
}

/// Time left in words after `done` of `total` parts took `elapsed`; none before the first part and
/// after the last.
fn left(elapsed: Duration, done: u64, total: u64) -> Option<String> {
    let left = total
        .checked_sub(done)
        .filter(|left| done > 0 && *left > 0)?;
    let seconds = elapsed.as_secs_f64() * left as f64 / done as f64;
    Some(format!("about {} left", duration(seconds)))
}

/// A time without more digits than an estimate has.
fn duration(seconds: f64) -> String {
    if seconds < 90.0 {
        format!("{} s", seconds.ceil().max(1.0))
    } else if seconds < 90.0 * 60.0 {
        format!("{} min", (seconds / 60.0).round())
    } else {
        format!("{:.1} h", seconds / 3600.0)
    }
}

/// The step under way, with its bar.
struct Running {
    name: String,
    share: Share,
    bar: ProgressBar,
}

/// Work that the process does now. Standard error, too, belongs to the whole process.
struct Now {
    /// All runs of the command.
    runs: Option<Share>,
    step: Option<Running>,
}

static NOW: Mutex<Now> = Mutex::new(Now {
    runs: None,
    step: None,
});

fn now() -> MutexGuard<'static, Now> {
    NOW.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Now {
    /// A line on the step under way.
    fn line(&self) -> Option<String> {
        let step = self.step.as_ref()?;
        let share = self.runs.as_ref().unwrap_or(&step.share);
        let (done, total, unit, name) = (share.done, share.total, share.unit, &step.name);
        let elapsed = duration(share.began.elapsed().as_secs_f64());
        let left = or_nothing(share.left(), |left| format!(", {left}"));
        Some(format!("{done} of {total} {unit}, {elapsed}{left}: {name}"))
    }
}

/// Prints a line each [`PERIOD`] while a step is under way, from now until the program ends.
fn print_lines() {
    loop {
        thread::sleep(PERIOD);
        if let Some(line) = now().line() {
            note(&line);
        }
    }
}

/// Sink that shows messages and progress on standard error, and stops the work on Ctrl-C.
pub struct Terminal;

impl Sink for Terminal {
    fn note(&self, text: &str) {
        note(text);
    }

    fn warnings(&self, warnings: &[Diagnostic]) {
        note(diagnostics::render(warnings, console::colour()).trim_end());
    }

    fn begin_runs(&self, total: u64) {
        now().runs = Some(Share::begin(total, "runs"));
    }

    fn count_run(&self) {
        if let Some(runs) = &mut now().runs {
            runs.done += 1;
        }
    }

    fn end_runs(&self) {
        now().runs = None;
    }

    fn begin_step(&self, name: &str, total: u64, unit: &'static str) {
        if style() == Style::Steps {
            note(&format!("starting {name}"));
        }
        begin_quietly(name, total, unit);
    }

    fn set_done(&self, done: u64) {
        if let Some(step) = &mut now().step {
            step.bar.set_position(done);
            step.share.done = done;
        }
    }

    /// One cut short by an error must not leave its bar in front of the message.
    fn end_step(&self, is_whole: bool) {
        let Some(step) = now().step.take() else {
            return;
        };
        step.bar.finish_and_clear();
        if is_whole && style() == Style::Steps {
            let seconds = step.share.began.elapsed().as_secs_f64();
            note(&format!("{}: {seconds:.1} s", step.name));
        }
    }

    fn begin_writing(&self) {
        stop::take_end();
    }

    fn stop(&self) -> &AtomicBool {
        stop::flag()
    }
}

/// Begins a step of `total` parts, without the line that `SKIAGRAPH_PROGRESS=lines` prints.
pub fn begin_quietly(name: &str, total: u64, unit: &'static str) {
    let mut now = now();
    let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::stderr());
    let template = format!(
        "{{msg:40!}} {{wide_bar:.cyan/dim}} {{pos}}/{{len}} {unit} {{elapsed:>4}}{{prefix}}"
    );
    // The template is ours and fixed; if indicatif should refuse it, its default does as well.
    let style_of_bar = ProgressStyle::with_template(&template);
    bar.set_style(style_of_bar.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar.set_message(name.to_owned());
    if let Some(runs) = &now.runs {
        let left = or_nothing(runs.left(), |left| format!(", {left}"));
        bar.set_prefix(format!(" · {} of {} runs{left}", runs.done, runs.total));
    }
    bar.enable_steady_tick(Duration::from_millis(250));
    now.step = Some(Running {
        name: name.to_owned(),
        share: Share::begin(total, unit),
        bar,
    });
    if style() == Style::Periodic {
        static PRINTER: Once = Once::new();
        PRINTER.call_once(|| drop(thread::spawn(print_lines)));
    }
}

/// Sets the name of the current part of the step, which the progress shows.
pub fn set_part(part: &str) {
    if let Some(step) = &mut now().step {
        step.bar.set_message(part.to_owned());
        step.name = part.to_owned();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn estimates_follow_the_parts_that_are_done() {
        let after = |seconds, done, total| left(Duration::from_secs(seconds), done, total);
        assert_eq!(after(10, 0, 8), None);
        assert_eq!(after(10, 8, 8), None);
        assert_eq!(after(10, 2, 8).unwrap(), "about 30 s left");
        assert_eq!(after(60, 1, 8).unwrap(), "about 7 min left");
        assert_eq!(after(600, 1, 13).unwrap(), "about 2.0 h left");
    }

    #[test]
    fn a_line_counts_runs_and_names_the_step() {
        let now = Now {
            runs: Some(Share {
                done: 3,
                ..Share::begin(7, "runs")
            }),
            step: Some(Running {
                name: "nsm, bench_side 64x64".into(),
                share: Share::begin(5, "frames"),
                bar: ProgressBar::hidden(),
            }),
        };
        assert_eq!(
            now.line().unwrap(),
            "3 of 7 runs, 1 s, about 1 s left: nsm, bench_side 64x64"
        );
    }
}
