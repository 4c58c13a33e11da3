//! Progress on standard error: a bar on a terminal, nothing elsewhere; with
//! `SKIAGRAPH_PROGRESS=lines` a line at the begin and the end of each step, for logs.

use crate::terminal::console::note;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::{
    io::{self, IsTerminal},
    time::{Duration, Instant},
};

fn wants_lines() -> bool {
    let is_asked = || std::env::var_os("SKIAGRAPH_PROGRESS").is_some_and(|value| value == "lines");
    !io::stderr().is_terminal() && is_asked()
}

/// One step of a long command.
pub struct Step {
    what: String,
    bar: ProgressBar,
    began: Instant,
}

impl Step {
    /// Begins a step of `total` parts, counted in `unit`.
    pub fn begin(what: String, total: u64, unit: &str) -> Self {
        if wants_lines() {
            note(&format!("starting {what}"));
        }
        Self::bar(what, total, unit)
    }

    /// The bar alone: dropped instead of ended, a pipe hears nothing of it.
    pub fn bar(what: String, total: u64, unit: &str) -> Self {
        let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::stderr());
        let template =
            format!("{{msg:40!}} {{wide_bar:.cyan/dim}} {{pos}}/{{len}} {unit} {{elapsed:>4}}");
        // The template is ours and fixed; if indicatif should refuse it, its default does as well.
        bar.set_style(
            ProgressStyle::with_template(&template)
                .unwrap_or_else(|_| ProgressStyle::default_bar()),
        );
        bar.set_message(what.clone());
        bar.enable_steady_tick(Duration::from_millis(250));
        Self {
            what,
            bar,
            began: Instant::now(),
        }
    }

    /// Says which part is under way.
    pub fn set_part(&self, part: &str) {
        self.bar.set_message(part.to_owned());
    }

    /// Says how many parts are done; from any thread.
    pub fn set_done(&self, done: u64) {
        self.bar.set_position(done);
    }

    /// Ends the step.
    pub fn end(self) {
        self.bar.finish_and_clear();
        if wants_lines() {
            note(&format!(
                "{}: {:.1} s",
                self.what,
                self.began.elapsed().as_secs_f64()
            ));
        }
    }
}

impl Drop for Step {
    fn drop(&mut self) {
        // A step cut short by an error must not leave its bar in front of the message.
        self.bar.finish_and_clear();
    }
}
