//! The summary of a comparison: a table with a row for each method and setting over all views, the
//! fastest first, and a verdict.

use crate::notes::{
    band_warning, blocked_by, certain_wrong_of, hint, load_warning, path_costs, remembering,
    scene_notes, surface_warning, times_missing,
};
use crate::results_table::timed_frames;
use crate::summary::{Row, rows};
use crate::table::{TERMINAL, terminal, wrapped};
use crate::verdict::{Verdict, verdict};
use crate::{equal_cost, graded};
use itertools::Itertools;
use skiagraph_compare::lists::unique;
use skiagraph_compare::measuring::date::is_another_hour;
use skiagraph_compare::records::columns::{self, Column};
use skiagraph_compare::records::figure::Clocks;
use skiagraph_compare::records::figures::are_paths;
use skiagraph_compare::records::regimes::{Regime, time_name};
use skiagraph_compare::records::results::{Results, Run};
use skiagraph_compare::records::table::Table;
use skiagraph_compare::wording::{or_nothing, percent, plural, size, thousands};
use skiagraph_reference::BlockerCounts;
use std::collections::{BTreeMap, BTreeSet};

/// Results in one viewport under one light, combined over the views.
pub struct Summary<'a> {
    results: &'a Results,
    /// Width and height of the viewport in pixels.
    pub viewport: [u32; 2],
    /// Name of the light; `None` if the views are not compared under several. Results of different
    /// lights are never averaged.
    pub light: Option<&'a str>,
    runs: Vec<&'a Run>,
    /// A row for each method, setting and map size, the fastest first.
    pub rows: Vec<Row<'a>>,
}

/// Returns a summary for each viewport and light of `results`, in the order of its runs.
pub fn summaries(results: &Results) -> Vec<Summary<'_>> {
    let place = |run: &'_ Run| (run.viewport, run.light.clone());
    let places = unique(results.runs.iter().map(place)).into_iter();
    let summary = |(viewport, light)| {
        let runs = results.runs.iter();
        let runs = runs.filter(|run| run.viewport == viewport && run.light == light);
        Summary::new(results, runs.collect())
    };
    places.map(summary).collect()
}

/// Beginning of lines that warn; the page makes them stand out by it.
const WARNING: &str = "warning: ";

/// First sentence of a verdict on times of an adapter that runs on the CPU.
pub const SOFTWARE: &str = "The adapter is software: its times say nothing about a GPU.";

/// Text in the cell of a row that could not run.
pub const NOT_THERE: &str = "n/a";

impl<'a> Summary<'a> {
    /// Summarises runs of one viewport and light. Runs on views on which settings were chosen are
    /// left out: no method is judged on the pictures that it was fitted to.
    fn new(results: &'a Results, mut runs: Vec<&'a Run>) -> Self {
        let clocks = Clocks::new(results);
        let newest = runs.iter().map(|run| run.session.as_str()).max();
        let is_now = |run: &&&Run| Some(run.session.as_str()) == newest;
        let tuned = runs.iter().filter(is_now);
        let tuned = tuned.filter_map(|run| run.tuned.as_ref());
        let chosen_on: BTreeSet<&String> = tuned.flat_map(|tuned| &tuned.chosen_on).collect();
        runs.retain(|run| !chosen_on.contains(&run.view));
        let viewport = runs.first().map_or([0; 2], |run| run.viewport);
        Self {
            results,
            viewport,
            light: runs.first().and_then(|run| run.light.as_deref()),
            rows: rows(runs.iter().map(|run| clocks.case(run)), viewport),
            runs,
        }
    }

    /// Returns the verdict on the rows: the method to take, within the budgets of the results.
    pub fn verdict(&self) -> Verdict {
        let mut verdict = verdict(&self.rows, &self.results.budgets);
        if self.results.adapter.device_type == "Cpu" && !verdict.sentences.is_empty() {
            verdict.sentences.insert(0, SOFTWARE.into());
        }
        verdict
    }

    /// True if a row was measured an hour or more before the newest one. Such a row takes no part
    /// in the verdict.
    pub fn is_old(&self, row: &Row) -> bool {
        let sessions = self.rows.iter().map(Row::session);
        is_another_hour(row.session(), sessions.max().unwrap_or_default())
    }

    /// True if the light of a measured run has an extent, so that methods are judged by their
    /// [shares of light](skiagraph_compare#terms).
    pub fn is_soft(&self) -> bool {
        self.rows.iter().any(Row::is_soft)
    }

    /// True if any run is of a camera path.
    fn are_paths(&self) -> bool {
        are_paths(&self.runs)
    }

    /// Returns the names of the views or camera paths.
    pub fn views(&self) -> BTreeSet<&str> {
        self.runs.iter().map(|run| run.view.as_str()).collect()
    }

    /// Names the views or paths for a title: `view main`, `9 views` or `path walk, 25 frames`.
    pub fn what(&self) -> String {
        let views = self.views();
        let paths = self.are_paths();
        match (views.first(), views.len()) {
            (Some(view), 1) if paths => {
                let frames = timed_frames(self.results, self.runs.iter().copied());
                format!("path {view}, {frames}")
            }
            (Some(view), 1) => format!("view {view}"),
            (_, count) => {
                let views = plural(count, if paths { "path" } else { "view" });
                views + &or_nothing(self.light, |light| format!(" under {light}"))
            }
        }
    }

    /// Returns the summary as text: conditions, table, verdict and notes. `is_broken` breaks
    /// sentences into lines of 80 characters, as a terminal needs; otherwise each is a line.
    pub fn text(&self, is_broken: bool) -> String {
        let (scene, what, size) = (&self.results.scene, self.what(), size(self.viewport));
        let mut lines = vec![format!("{scene} · {what} · {size}")];
        lines.extend(self.conditions());
        lines.extend(scene_notes(self.results));
        let mut sentences = self.verdict().sentences;
        sentences.extend(self.notes());
        if is_broken {
            for line in lines.iter_mut().chain(&mut sentences) {
                *line = wrapped(line, TERMINAL);
            }
        }
        lines.push(format!("\n{}\n", terminal(&self.table())));
        lines.extend(sentences);
        lines.join("\n") + "\n"
    }

    /// Returns the summary as a section in Markdown: heading, table and verdict.
    pub fn markdown(&self) -> String {
        let mut text = format!("\n## In short: {}, {}\n", self.what(), size(self.viewport));
        text += &format!("\n{}", self.table().markdown());
        let sentences = self.verdict().sentences;
        if !sentences.is_empty() {
            text += &format!("\n{}\n", sentences.join("\n"));
        }
        text
    }

    /// Returns lines about the measurements: adapter, machine, protocol, pixel counts and warnings.
    pub fn conditions(&self) -> Vec<String> {
        let views = self.views();
        let each = self.of_each_view();
        let sum = |count: fn(&Run) -> u64| each.iter().map(|run| count(run)).sum::<u64>();
        let (facing, band) = (sum(|run| run.pixels.facing_light), sum(|run| run.band));
        let mean = match views.len() {
            1 => "",
            _ => ", means of the views",
        };
        let wall = self.by_wall().then_some("wall clock");
        let clock = wall.unwrap_or("GPU and upkeep of the CPU");
        let frames = timed_frames(self.results, self.runs.iter().copied());
        let medians = format!(
            "medians of {frames} after {} to warm up",
            self.results.warmup
        );
        let oracle = &self.results.oracle;
        let (lit, shadow) = (sum(|run| run.pixels.lit), sum(|run| run.pixels.shadow));
        let share = percent(band, facing);
        let [facing, lit, shadow, band] = [facing, lit, shadow, band].map(thousands);
        let mut lines = vec![
            self.results.adapter.to_string(),
            format!("times: {clock}, {medians}{mean} · oracle {oracle}"),
            format!(
                "facing the light {facing} = lit {lit} + shadow {shadow} · in the band, where the \
                 answer hangs on rounding, {band} ({share})"
            ),
        ];
        let area = |run: &Run| Some(graded::area_reference(&run.area?, run.band));
        lines.extend(load_warning(&self.results.machine));
        lines.extend(self.told(&each, band_warning));
        lines.extend(self.told(&each, area));
        lines
    }

    /// True if times are wall times, since a row has no GPU times.
    pub fn by_wall(&self) -> bool {
        self.rows.iter().any(|row| row.by_wall)
    }

    /// Returns the table: a row for each method, setting and map size, in the order of
    /// [`rows`](Self::rows). A star marks, in each column of times, the fastest method without
    /// wrong pixels outside the band (the pixels whose answer rounding decides).
    pub fn table(&self) -> Table {
        let regimes = self.regimes();
        let untimed = Regime::ALL.into_iter().filter(|it| !regimes.contains(it));
        let untimed: Vec<String> = untimed.map(|regime| time_name(Some(regime))).collect();
        let mut columns = columns::summary(&self.runs);
        columns.retain(|column| !untimed.contains(&column.figure.name));
        let fastest = self.verdict().fastest_exact.into_iter();
        let fastest: BTreeSet<_> = fastest.map(|(when, row)| (time_name(when), row)).collect();
        let views = self.views().len();
        let row = |(index, row): (usize, &Row)| {
            let mut label = row.label.clone();
            if row.views() != views && row.views() > 0 {
                label += &format!(" ({} of {})", row.views(), plural(views, "view"));
            }
            if row.is_tuned() {
                label += " (tuned)";
            }
            if !row.is_whole() {
                label += " (cut short)";
            }
            if self.is_old(row) {
                label += &format!(" (of {})", row.session());
            }
            let cell = |(place, Column { figure, .. }): (usize, &Column)| {
                if row.views() == 0 {
                    return if place == 0 { NOT_THERE } else { "–" }.into();
                }
                let is_fastest = fastest.contains(&(figure.name.clone(), index));
                let star = if is_fastest { " *" } else { "" };
                figure.cell(row.over(figure), percent, 4) + star
            };
            let cells = columns.iter().enumerate().map(cell);
            [label].into_iter().chain(cells).collect()
        };
        let heads = columns.iter().map(|column| column.head);
        let rows: Vec<_> = self.rows.iter().enumerate().map(row).collect();
        Table::new(["method"].into_iter().chain(heads), 1, rows)
    }

    /// Returns remarks on the table, a line each.
    pub fn notes(&self) -> Vec<String> {
        let (mut notes, verdict) = (Vec::new(), self.verdict());
        if !verdict.fastest_exact.is_empty() {
            notes.push("* the fastest with no wrong pixel outside the band".into());
        }
        notes.extend(equal_cost::sentence(&self.rows, &verdict));
        notes.extend(self.open_parts());
        notes.extend(self.wrong_surfaces());
        notes.extend(self.rows.iter().filter_map(|row| {
            let why = row.unavailable?;
            Some(format!("{} is unavailable: {why}", row.label))
        }));
        notes.extend(self.certain_wrong());
        notes.extend(self.told(&self.runs, hint));
        notes.extend(self.still_meshes());
        notes.extend(self.told(&self.runs, graded::no_shares));
        notes.extend(self.told(&self.runs, remembering));
        notes.extend(self.told(&self.runs, path_costs));
        match &self.results.adapter.gpu_unavailable {
            Some(reason) => notes.push(format!("No GPU times: {reason}")),
            None => notes.extend(self.told(&self.runs, times_missing)),
        }
        notes
    }

    /// Returns the regimes in which a row was timed.
    pub fn regimes(&self) -> Vec<Regime> {
        let has = |regime: &Regime| self.rows.iter().any(|row| row.regimes().contains(regime));
        Regime::ALL.into_iter().filter(has).collect()
    }

    /// Says that there are no times of moving meshes.
    fn still_meshes(&self) -> Option<String> {
        let regimes = self.regimes();
        let is_still = !regimes.is_empty() && !regimes.contains(&Regime::AllMeshes);
        is_still.then(|| {
            "No path of this scene moves a part of its mesh, so that there are no times of moving \
             meshes"
                .into()
        })
    }

    /// A run of each view.
    fn of_each_view(&self) -> Vec<&'a Run> {
        let runs = self.runs.iter().copied();
        runs.unique_by(|run| &run.view).collect()
    }

    /// Lines on runs, with their views where there are several.
    fn told<L: IntoIterator<Item = String>>(
        &self,
        runs: &[&Run],
        say: impl Fn(&Run) -> L,
    ) -> Vec<String> {
        let each = runs.iter().flat_map(|run| {
            let lines = say(run).into_iter();
            lines.map(|line| self.named(run, line)).collect::<Vec<_>>()
        });
        each.collect()
    }

    /// A line with the view or path that it is of, where there are several.
    fn named(&self, run: &Run, line: String) -> String {
        match self.views().len() {
            1 => line,
            _ => match line.strip_prefix(WARNING) {
                Some(line) => format!("{WARNING}{}: {line}", run.view),
                None => format!("{}: {line}", run.view),
            },
        }
    }

    /// That promises end at open parts, and whose.
    fn open_parts(&self) -> Option<String> {
        let parts = &self.results.scene.parts;
        let closed_only = |run: &&&Run| run.promise.iter().any(|promise| promise.closed_only);
        let methods = self.runs.iter().filter(closed_only);
        let methods = methods.map(|run| format!("`{}`", run.preset));
        let methods: Vec<String> = methods.sorted().dedup().collect();
        if parts.open == 0 || methods.is_empty() {
            return None;
        }
        let whole = match parts.all {
            1 => "1 part".into(),
            count => format!("{} parts", thousands(count)),
        };
        let open = thousands(parts.open);
        let share = percent(parts.open_triangles, self.results.scene.triangles);
        let s = if methods.len() == 1 { "s" } else { "" };
        let methods = methods.join(", ");
        Some(format!(
            "{open} of the mesh's {whole} are open ({share} of its triangles): what {methods} \
             promise{s} ends at shadows of these where they are one-sided, unless --set cull=none"
        ))
    }

    /// Says of each view that pixels show a surface that is not seen there.
    fn wrong_surfaces(&self) -> Vec<String> {
        let views = self.views();
        let each = self.of_each_view().into_iter();
        let notes =
            each.filter_map(|run| Some((run, surface_warning(run.wrong_surface, &run.pixels)?)));
        let note = |(run, note): (&Run, _)| match views.len() {
            1 => note,
            _ => format!("{}: {note}", run.view),
        };
        notes.map(note).collect()
    }

    /// Says what blocks the pixels of which a method was certain and wrong, over all views.
    fn certain_wrong(&self) -> Vec<String> {
        let mut sums: BTreeMap<String, (u64, BlockerCounts)> = BTreeMap::new();
        for run in &self.runs {
            if let Some((certain, blockers)) = certain_wrong_of(run) {
                let sum = sums.entry(run.method_label()).or_default();
                sum.0 += certain;
                sum.1 += blockers;
            }
        }
        let line = |(label, sum): (String, _)| format!("{label}: {}", blocked_by(&[sum]));
        sums.into_iter().map(line).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matrices::by_light;
    use crate::test_support::results as sample;
    use skiagraph_compare::records::results::Promise;
    use skiagraph_compare::records::steady::{Cycle, Steady};

    /// `sample()` with a second view, and with a promise that ends at open parts.
    fn two_views() -> Results {
        let mut results = sample();
        results.runs[0].promise = Some(Promise {
            of: "exact".into(),
            closed_only: true,
        });
        results.runs.pop();
        let mut other_runs = results.runs.clone();
        for run in &mut other_runs {
            run.view = "other".into();
        }
        // The second method was not run on it.
        other_runs.truncate(1);
        results.runs.extend(other_runs);
        results
    }

    #[test]
    fn a_row_per_method_over_all_views() {
        insta::assert_snapshot!(summaries(&two_views())[0].text(false));
    }

    /// The presets that one would ship, with figures as they come.
    #[test]
    fn no_line_of_the_summary_is_wider_than_eighty_characters() {
        let mut results = sample();
        let run = results.runs.remove(0);
        let names = skiagraph_compare::graphs::preset::SHIPPED
            .iter()
            .zip(1u64..);
        let run_of = |(name, place): (&&str, u64)| {
            let mut run = run.clone();
            (run.preset, run.map_size) = ((*name).into(), Some(2048));
            let measured = run.measured.as_mut().unwrap();
            measured.wrong.total = 12_345 * (place - 1) + measured.wrong.in_band;
            measured.rays = Some(1_234_567);
            run
        };
        results.runs = names.map(run_of).collect();
        let text = summaries(&results)[0].text(true);
        let wide = |line: &&str| line.chars().count() > 80;
        assert_eq!(text.lines().find(wide), None, "{text}");
        for name in skiagraph_compare::graphs::preset::SHIPPED {
            assert!(
                text.lines()
                    .any(|line| line.starts_with(&format!("{name} 2048")))
            );
        }
    }

    #[test]
    fn surfaces_that_are_hidden_and_methods_that_remember_are_named_below() {
        let mut results = sample();
        results.runs[0].wrong_surface = 1_234;
        results.runs[0].measured.as_mut().unwrap().steady = Some(Steady {
            frames: 36,
            period: Some(3),
            begin: Vec::new(),
            judged: Some(Cycle::default()),
        });
        let text = summaries(&results)[0].text(false);
        for part in [
            "warning: 1,234 of 131,072 pixels show a surface that another one hides",
            "nsm 1024 remembers: its picture repeats every 3 frames",
        ] {
            assert!(text.contains(part), "no {part:?} in\n{text}");
        }
    }

    #[test]
    fn each_light_has_a_table_of_its_own_and_all_stand_in_one() {
        let mut results = two_views();
        for run in &mut results.runs {
            run.light = Some("lamp".into());
        }
        let mut sun = results.runs[0].clone();
        sun.light = Some("sun".into());
        sun.measured.as_mut().unwrap().wrong.total = 6;
        results.runs.push(sun);
        let summaries = summaries(&results);
        let whats: Vec<String> = summaries.iter().map(Summary::what).collect();
        assert_eq!(whats, ["2 views under lamp", "view main"]);
        assert_eq!(summaries[1].rows.len(), 1);
        // Means of other views are not added up.
        let table = &by_light(&results)[0].1;
        assert_eq!(table.rows[0].last().unwrap(), "–");
        results.runs.retain(|run| run.view == "main");
        insta::assert_snapshot!(by_light(&results)[0].1.markdown());
        assert!(by_light(&two_views()).is_empty());
    }

    #[test]
    fn a_document_ends_with_it() {
        insta::assert_snapshot!(summaries(&sample())[0].markdown());
    }
}
