//! Columns of a comparison's tables, for the terminal, for documents and for results.csv: the
//! [figures](super::figures) that a table shows, in its order and under its heads.
//!
//! ```
//! use skiagraph_compare::{records::{columns, figure::Clocks, read_back}, wording};
//!
//! # let out = tempfile::tempdir()?;
//! # let name = "skiagraph_compare__records__results__tests__the_schema_is_pinned_and_reads_back";
//! # let pinned = std::fs::read_to_string(format!("src/records/snapshots/{name}.snap"))?;
//! # std::fs::write(out.path().join("results.json"), &pinned[pinned.find('{').unwrap_or(0)..])?;
//! let results = read_back::kept(out.path())?;
//! let runs: Vec<_> = results.runs.iter().collect();
//! let case = Clocks::new(&results).case(runs[0]);
//! for column in columns::terminal(&runs) {
//!     println!("{}: {}", column.head, column.cell(&case, wording::percent));
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::records::figure::{Case, Figure, Table};
use crate::records::figures::FIGURES;
use crate::records::results::{GBUFFER, Run};
use itertools::Itertools;

/// Names of the steps of the built-in presets, each with the word for it in heads of table columns.
/// A step is the passes of a graph with the same name up to the first dot. The word for any other
/// step is its name.
pub const STEPS: [(&str, &str); 5] = [
    ("create_shadow_map", "map"),
    ("detect_uncertain", "detect"),
    ("fill_rays", "fill"),
    ("trace_rays", "trace"),
    ("fix_pixels", "fix"),
];

/// Place of a document's first column behind the times of steps.
const BEHIND_STEPS: u16 = 100;

/// Returns the head of the column with the GPU time of a step, or of a sum of steps: `gbuffer +
/// detect ms` for `gbuffer+detect_uncertain`.
pub fn step_head(step: &str) -> String {
    let heads = step.split('+').map(|step| {
        let short = STEPS.iter().find(|(name, _)| *name == step);
        short.map_or(step, |(_, head)| head)
    });
    format!("{} ms", heads.collect::<Vec<_>>().join(" + "))
}

/// A column in a table with a row per run, or per method over all views.
pub struct Column {
    /// Head of the column.
    pub head: &'static str,
    /// The figure that it shows.
    pub figure: &'static Figure,
    place: u16,
}

impl Column {
    /// Returns the text of a run's cell in a table; `–` if the figure is unknown. `share` formats
    /// its first argument, a count, as a share of its second one, for example as percent.
    pub fn cell(&self, case: &Case, share: fn(u64, u64) -> String) -> String {
        self.figure.cell(self.figure.value(case), share, 5)
    }
}

/// The columns of a table of these runs, in its order.
fn of_table(table: Table, runs: &[&Run]) -> impl Iterator<Item = Column> {
    let figures = FIGURES.iter().filter(|figure| figure.is_of(runs));
    let columns = figures.flat_map(move |figure| {
        let heads = figure.heads.iter();
        let heads = heads.filter(move |(shown, ..)| *shown == table);
        heads.map(move |(_, place, head)| Column {
            head,
            figure,
            place: *place,
        })
    });
    columns.sorted_by_key(|column| column.place)
}

/// Returns the columns of the terminal's table of `runs`, in order. Those for map sizes, camera
/// paths or [shares of light](crate#terms) are left out if no run has them.
pub fn terminal(runs: &[&Run]) -> Vec<Column> {
    let has_maps = runs.iter().any(|run| run.map_size.is_some());
    let columns = of_table(Table::Terminal, runs);
    let columns = columns.filter(|column| has_maps || column.figure.name != "map_size");
    columns.collect()
}

/// Returns the columns of the summary of `runs` over all views, in order, behind that of the
/// methods.
pub fn summary(runs: &[&Run]) -> Vec<Column> {
    of_table(Table::Summary, runs).collect()
}

/// Returns the columns of a document's table of `runs` in two lists: those to the left and those to
/// the right of the columns with times of steps, which the caller adds. `published` returns true if
/// there are published figures of the quantity with this name.
pub fn document(runs: &[&Run], published: impl Fn(&str) -> bool) -> [Vec<Column>; 2] {
    let columns = of_table(Table::Document, runs);
    let columns =
        columns.filter(|Column { figure, .. }| !figure.is_beside || published(figure.quantity));
    let (front, back) = columns.partition(|column| column.place < BEHIND_STEPS);
    [front, back]
}

/// The columns of documents that published figures can have.
fn published() -> impl Iterator<Item = Column> {
    let columns = of_table(Table::Document, &[]);
    columns.filter(|column| !column.figure.quantity.is_empty())
}

/// Lists the names of the quantities that published figures can have, such as `wrong_percent` and
/// `ms.trace_rays`, without sums of steps such as `ms.gbuffer+detect_uncertain`.
pub fn quantities() -> Vec<String> {
    let of_columns = published().map(|column| column.figure.quantity.to_owned());
    let of_steps = STEPS.iter().map(|(step, _)| format!("ms.{step}"));
    of_columns.chain(of_steps).collect()
}

/// Returns the steps of a quantity that is a time of steps, each of them [`GBUFFER`] or one of
/// [`STEPS`]: `gbuffer+detect_uncertain` for `ms.gbuffer+detect_uncertain`. Returns `None` for any
/// other quantity.
pub fn steps_of(quantity: &str) -> Option<&str> {
    let steps = quantity.strip_prefix("ms.")?;
    let is_known = |step| step == GBUFFER || STEPS.iter().any(|(name, _)| *name == step);
    steps.split('+').all(is_known).then_some(steps)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::records::results::{Answer, tests::sample};

    #[test]
    fn names_and_places_are_there_once() {
        let names = FIGURES.iter().map(|figure| &figure.name);
        assert_eq!(names.duplicates().collect::<Vec<_>>(), [""; 0]);
        let words = FIGURES.iter().filter_map(|figure| figure.gate.as_ref());
        assert_eq!(words.duplicates().collect::<Vec<_>>(), [""; 0]);
        // Of two figures at one place one is of hard answers, the other of graded ones.
        let figures = FIGURES.iter().filter(|figure| figure.name != "worst_rmse");
        let heads = figures.flat_map(|figure| &figure.heads);
        let places = heads.map(|(table, place, _)| format!("{table:?} {place}"));
        assert_eq!(places.duplicates().collect::<Vec<_>>(), [""; 0]);
    }

    #[test]
    fn columns_stand_where_runs_have_them() {
        let runs = sample().runs;
        let heads = |columns: Vec<Column>| columns.iter().map(|by| by.head).collect::<Vec<_>>();
        let mixed: Vec<&Run> = runs.iter().collect();
        let terminal_heads = heads(terminal(&mixed));
        assert_eq!(terminal_heads[..4], ["method", "map", "GPU ms", "wall ms"]);
        let without: Vec<&Run> = runs.iter().filter(|run| run.map_size.is_none()).collect();
        assert_eq!(terminal(&without).len(), terminal_heads.len() - 1);
        let mut graded = runs.clone();
        graded[0].measured.as_mut().unwrap().answer = Answer::Graded;
        let graded: Vec<&Run> = graded.iter().collect();
        let more = heads(terminal(&graded));
        let more = more.iter().filter(|head| !terminal_heads.contains(head));
        let soft = [
            "light in umbra",
            "dark in light",
            "penumbra RMSE",
            "penumbra bias",
        ];
        assert_eq!(
            more.copied().collect::<Vec<_>>(),
            [&["answer"][..], &soft, &["no share"]].concat()
        );
        let [front, back] = document(&mixed, |_| false).map(heads);
        assert!(front.contains(&"rays") && back == ["frame ms"]);
        let [whole, _] = document(&mixed, |_| true).map(heads);
        assert_eq!(whole.len(), front.len() + 6);
    }
}
