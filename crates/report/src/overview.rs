//! The overview of several scenes: a table of methods and scenes, the verdict on each scene, and
//! what holds of all of them. Nothing is averaged over scenes or lights.

use crate::contender::Condition;
use crate::matrices::by_summary;
use crate::summary::Row;
use crate::summary_table::{SOFTWARE, Summary};
use crate::table::{or_dash, terminal};
use crate::verdict::{Verdict, main_choice};
use itertools::Itertools;
use skiagraph_compare::lists::unique;
use skiagraph_compare::records::results::Results;
use skiagraph_compare::records::table::Table;
use skiagraph_compare::wording::{ms, percent, size};
use std::path::Path;

/// Summaries of the results of several scenes, one column each.
pub struct Overview<'a> {
    columns: Vec<Column<'a>>,
    /// Number of scenes.
    scenes: usize,
}

/// A column of the table.
struct Column<'a> {
    /// Name of the scene, with the light if it has several.
    head: String,
    /// Index in the list of summaries.
    index: usize,
    summary: &'a Summary<'a>,
    verdict: Verdict,
}

/// The table of an [`Overview`] in one viewport.
pub struct Matrix {
    /// Width and height of the viewport in pixels.
    pub viewport: [u32; 2],
    /// A row for each method and a column for each scene and light. Cells show the percentage of
    /// the pixels facing the light that are wrong outside the band (the pixels whose answer
    /// rounding decides), with a star if there are none, or under a light [with an
    /// extent](skiagraph_compare#terms) the root mean square error, and in a second line the
    /// milliseconds of a frame.
    pub table: Table,
    /// For each column behind the methods, the index of its summary in the list given to
    /// [`Overview::new`].
    pub summaries: Vec<usize>,
}

/// Returns a name for each scene, in order; each scene is given with the folder of its results. The
/// name is the scene's own. Scenes of one name get the last component of their folder, or the whole
/// path if these components are not distinct either.
pub fn scene_names<'a>(scenes: &[(&'a Path, &'a Results)]) -> Vec<String> {
    let scene = |results: &'a Results| results.scene.name.as_str();
    let last = |folder: &'a Path| folder.file_name().map(|name| name.to_string_lossy());
    let name = |(folder, results): &(&'a Path, &'a Results)| {
        let is_alike = |(_, other): &&(_, &'a Results)| scene(other) == scene(results);
        let alike = scenes.iter().filter(is_alike);
        let folders: Vec<&Path> = alike.map(|(folder, _)| *folder).collect();
        match last(folder) {
            _ if folders.len() == 1 => scene(results).to_owned(),
            Some(name) if folders.iter().map(|other| last(other)).all_unique() => name.into(),
            _ => folder.display().to_string(),
        }
    };
    scenes.iter().map(name).collect()
}

impl<'a> Overview<'a> {
    /// Creates the overview of summaries, each behind the name of its scene; `None` if all are of
    /// one scene. The columns are sorted: first those without a recommended method, then by the
    /// share of its wrong pixels outside the band, the greatest first, and by its RMSE.
    pub fn new(summaries: &[(&str, &'a Summary<'a>)]) -> Option<Self> {
        let scenes = summaries.iter().map(|(scene, _)| *scene).unique().count();
        let column = |(index, (scene, summary)): (usize, &(&str, &'a Summary<'a>))| Column {
            head: match summary.light {
                Some(light) => format!("{scene} under {light}"),
                None => (*scene).to_owned(),
            },
            index,
            verdict: summary.verdict(),
            summary,
        };
        let columns = summaries.iter().enumerate().map(column);
        let columns = columns.sorted_by(|one, other| {
            let ([wrong, rmse], worse) = (one.error(), other.error());
            worse[0].total_cmp(&wrong).then(worse[1].total_cmp(&rmse))
        });
        (scenes > 1).then(|| Self {
            columns: columns.collect(),
            scenes,
        })
    }

    /// Returns the tables of methods and scenes, one for each viewport.
    pub fn matrices(&self) -> Vec<Matrix> {
        let matrix = |viewport: [u32; 2]| {
            let columns = self.columns.iter();
            let columns = columns.filter(|column| column.summary.viewport == viewport);
            let (summaries, columns): (Vec<usize>, Vec<_>) = columns
                .map(|column| (column.index, (column.head.as_str(), column.summary)))
                .unzip();
            Matrix {
                viewport,
                table: by_summary(&columns, cell),
                summaries,
            }
        };
        self.viewports().into_iter().map(matrix).collect()
    }

    /// Returns sentences: that the adapter is software, where it is; how the scenes are sorted, the
    /// verdict on each scene, the methods that are exact on all scenes, and the methods that the
    /// verdicts recommend.
    pub fn sentences(&self) -> Vec<String> {
        let verdict = |column: &Column| {
            let name = self.name(column);
            let sentences = column.verdict.sentences.iter();
            let sentences = sentences.filter(|sentence| *sentence != SOFTWARE);
            let sentences = sentences.map(|sentence| format!("{name}: {sentence}"));
            sentences.collect::<Vec<_>>()
        };
        let mut verdicts = self.columns.iter().map(|column| &column.verdict.sentences);
        let is_software = verdicts.any(|sentences| sentences.iter().any(|one| one == SOFTWARE));
        let first = is_software.then_some(SOFTWARE).into_iter();
        let mut sentences: Vec<String> = first.chain([ORDER]).map(str::to_owned).collect();
        sentences.extend(self.columns.iter().flat_map(verdict));
        sentences.push(self.exact_on_all());
        sentences.extend(self.taken());
        sentences
    }

    /// Returns the overview as text for a terminal: tables and sentences.
    pub fn text(&self) -> String {
        let matrices = self.matrices().into_iter();
        let tables = matrices.map(|matrix| {
            let (viewport, table) = (size(matrix.viewport), terminal(&matrix.table));
            format!("Overview, {viewport}: {LEGEND}\n{table}\n")
        });
        tables.collect::<String>() + &self.sentences().join("\n") + "\n"
    }

    /// Returns the overview as a section in Markdown.
    pub fn markdown(&self) -> String {
        let matrices = self.matrices().into_iter();
        let tables = matrices.map(|matrix| {
            let (viewport, table) = (size(matrix.viewport), matrix.table.markdown());
            format!("\n## Overview, {viewport}\n\n{LEGEND}\n\n{table}")
        });
        let sentences = self.sentences().into_iter();
        let sentences = sentences.map(|sentence| format!("- {sentence}\n"));
        tables.collect::<String>() + "\n" + &sentences.collect::<String>()
    }

    fn viewports(&self) -> Vec<[u32; 2]> {
        let columns = self.columns.iter().sorted_by_key(|column| column.index);
        unique(columns.map(|column| column.summary.viewport))
    }

    /// A column in words, with its viewport where there are several.
    fn name(&self, column: &Column) -> String {
        match self.viewports().len() {
            1 => column.head.clone(),
            _ => format!("{} at {}", column.head, size(column.summary.viewport)),
        }
    }

    /// Which methods have no wrong pixel on any scene.
    fn exact_on_all(&self) -> String {
        let rows = self.columns.iter().flat_map(|column| &column.summary.rows);
        let labels = unique(rows.map(|row| row.label.as_str()));
        let is_exact = |label: &&str| {
            self.columns.iter().all(|Column { summary, .. }| {
                let mut rows = summary.rows.iter();
                rows.any(|row| row.label == *label && is_exact(summary, row))
            })
        };
        let exact = labels.into_iter().filter(is_exact);
        let exact = exact.map(|label| format!("`{label}`")).join(", ");
        let mut rows = self.columns.iter().flat_map(|column| &column.summary.rows);
        let is_part = rows.any(|row| Condition::new(row.wrong()).is_some());
        let right = is_part.then_some("right wherever that can be judged");
        let right = right.unwrap_or("exact");
        let scenes = match self.scenes {
            2 => "both scenes".to_owned(),
            count => format!("all {count} scenes"),
        };
        match exact.as_str() {
            "" => format!("No method is {right} on {scenes}."),
            exact => format!("On {scenes} {right}: {exact}."),
        }
    }

    /// Which methods the verdicts name first; `None` if none names any.
    fn taken(&self) -> Option<String> {
        let clause = |(is_taken, what): (bool, &str)| {
            let columns = self.columns.iter();
            let columns = columns.filter(|column| column.verdict.is_taken == is_taken);
            let mut named = columns.filter_map(|column| {
                let rows = column.verdict.first.iter();
                let mut rows = rows.map(|row| format!("`{}`", column.summary.rows[*row].label));
                let names = Some(rows.join(" or ")).filter(|names| !names.is_empty())?;
                Some(format!("{names} on {}", self.name(column)))
            });
            let named = Some(named.join(", ")).filter(|named| !named.is_empty())?;
            Some(format!("{what}: {named}"))
        };
        let parts = [(true, "taken"), (false, "the least wrong")];
        let mut text = parts.into_iter().filter_map(clause).join("; ");
        text.get_mut(..1)?.make_ascii_uppercase();
        Some(text + ".")
    }
}

/// How the columns are sorted.
const ORDER: &str =
    "Order of the scenes: the worst first, by the share of wrong pixels of the recommended method.";

impl Column<'_> {
    /// Share of wrong pixels of the recommended method, and its RMSE to decide between equal
    /// shares; infinite without such a method.
    fn error(&self) -> [f64; 2] {
        let first = self.verdict.first.first();
        let Some(row) = first.and_then(|index| self.summary.rows.get(*index)) else {
            return [f64::INFINITY; 2];
        };
        [row.wrong().share(), row.rmse().unwrap_or(0.0)]
    }
}

/// Legend of the cells of an overview's tables.
pub const LEGEND: &str = "wrong pixels outside the band (* none) or RMSE, and a frame";

fn cell(summary: &Summary, row: &Row) -> String {
    let wrong = row.wrong();
    let rmse = || or_dash(row.rmse(), |rmse| format!("RMSE {rmse:.4}"));
    let share = || percent(wrong.outside_band, wrong.facing_light);
    let error = if summary.is_soft() { rmse() } else { share() };
    let star = if is_exact(summary, row) { " *" } else { "" };
    let time = or_dash(row.frame_ms(main_choice(&summary.rows)), ms);
    format!("{error}{star}\n{time} ms")
}

/// True if a method was measured on all views and is wrong on none.
fn is_exact(summary: &Summary, row: &Row) -> bool {
    row.views() == summary.views().len() && row.is_exact()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::summary_table::summaries;
    use crate::test_support::results as sample;

    /// `rt` is right on the first two of three scenes, `nsm` on the second.
    fn three() -> [Results; 3] {
        let mut results = ["park", "sponza", "room"].map(|scene| {
            let mut results = sample();
            results.scene.name = scene.into();
            for run in &mut results.runs {
                // Enough frames to tell times apart.
                if let Some(measured) = &mut run.measured {
                    measured.regimes.clear();
                    let frames = &mut measured.frame;
                    frames.wall_frames = frames.wall_frames.repeat(3);
                    frames.gpu_frames = frames.gpu_frames.as_ref().map(|ms| ms.repeat(3));
                }
            }
            results
        });
        for (scene, run) in [(0, 1), (1, 0), (1, 1)] {
            let measured = results[scene].runs[run].measured.as_mut().unwrap();
            (measured.wrong.total, measured.wrong.in_band) = (6, 6);
        }
        results[2].runs.truncate(1);
        results
    }

    /// Calls `check` with the overview of results, or none.
    fn with_overview(results: &[Results], check: impl FnOnce(Option<Overview>)) {
        let summaries: Vec<Vec<Summary>> = results.iter().map(summaries).collect();
        let names = results.iter().map(|results| results.scene.name.as_str());
        let columns = names.zip(&summaries);
        let columns =
            columns.flat_map(|(name, summaries)| summaries.iter().map(move |it| (name, it)));
        check(Overview::new(&columns.collect::<Vec<_>>()));
    }

    #[test]
    fn methods_and_scenes_stand_in_one_table_and_each_scene_has_its_verdict() {
        with_overview(&three(), |overview| {
            let overview = overview.unwrap();
            let text = overview.text();
            let table = text.lines().skip(1).take_while(|line| !line.contains(": "));
            let widths: Vec<usize> = table.map(|line| line.chars().count()).collect();
            assert!(
                widths.len() > 5 && widths.iter().all(|width| *width <= 80),
                "{text}"
            );
            insta::assert_snapshot!(text);
            insta::assert_snapshot!("in_a_document", overview.markdown());
            // On `room` the recommended method is wrong, on the others right.
            assert_eq!(overview.matrices()[0].summaries, [2, 0, 1]);
        });
        with_overview(&three()[..1], |overview| assert!(overview.is_none()));
    }

    #[test]
    fn what_is_exact_on_all_is_named_unless_pixels_cannot_be_judged() {
        let sentence = |results: &[Results]| {
            let mut lines = Vec::new();
            with_overview(results, |overview| lines = overview.unwrap().sentences());
            lines.into_iter().find(|line| line.contains("both scenes"))
        };
        let [park, mut sponza, _] = three();
        let exact = sentence(&[park.clone(), sponza.clone()]);
        assert_eq!(exact.as_deref(), Some("On both scenes exact: `rt`."));
        sponza.runs[0].band = 50_000;
        let right = "On both scenes right wherever that can be judged: `rt`.";
        assert_eq!(sentence(&[park, sponza]).as_deref(), Some(right));
    }

    #[test]
    fn scenes_of_one_name_are_told_apart_by_their_folders() {
        let [park, sponza, _] = three();
        let names = |folders: [&str; 3]| {
            let [a, b, c] = folders.map(Path::new);
            scene_names(&[(a, &park), (b, &sponza), (c, &park)])
        };
        assert_eq!(
            names(["o/park", "o/s", "o/park-2"]),
            ["park", "sponza", "park-2"]
        );
        let machines = names(["desk/park", "desk/s", "laptop/park"]);
        assert_eq!(machines, ["desk/park", "sponza", "laptop/park"]);
    }
}
