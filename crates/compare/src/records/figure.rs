//! A figure of a run: its name, its unit, how its value is taken, and where it is shown.
//!
//! ```
//! use skiagraph_compare::records::{figure::Clocks, figures, read_back};
//!
//! # let out = tempfile::tempdir()?;
//! # let name = "skiagraph_compare__records__results__tests__the_schema_is_pinned_and_reads_back";
//! # let pinned = std::fs::read_to_string(format!("src/records/snapshots/{name}.snap"))?;
//! # std::fs::write(out.path().join("results.json"), &pinned[pinned.find('{').unwrap_or(0)..])?;
//! let results = read_back::kept(out.path())?;
//! let wrong = figures::named("wrong").ok_or("it is one of the list")?;
//! let case = Clocks::new(&results).case(&results.runs[0]);
//! assert_eq!(wrong.value(&case).and_then(|value| wrong.number(value)), Some(0.497));
//! assert_eq!(wrong.worst(&[case]).map(|worst| wrong.unit.limit(worst.value)),
//!     Some("0.4970 %".into()));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::quantities::{bytes, milliseconds, percent, positive};
use crate::records::judged_pictures::JudgedPicture;
use crate::records::regimes::When;
use crate::records::results::{Machine, Measured, Part, Results, Run};
use crate::records::sequence::greatest;
use crate::records::statistics::Spread;
use crate::records::steady::Cycle;
use crate::wording::{self, ms, thousands};
use itertools::Itertools;
use skiagraph_reference::PixelCounts;
use std::{collections::BTreeSet, fmt};

/// Takes the value from a run.
type Take = dyn Fn(&Case) -> Option<Value> + Send + Sync;
/// Takes the values from the frames of a path.
type Frames = fn(&Case, &Measured) -> Option<Vec<f64>>;

/// A figure of runs: one number, or one text, of each.
pub struct Figure {
    /// Its name, under which results.csv has its column.
    pub name: String,
    /// Unit of its numbers.
    pub unit: Unit,
    /// Name of the quantity in files of published figures, such as `wrong_percent`; empty if such
    /// files cannot have it.
    pub quantity: &'static str,
    /// Word for the figure in a condition of `--fail-if`; `None` if it cannot be limited.
    pub gate: Option<String>,
    /// Text at the axis of a chart; empty if charts do not draw the figure.
    pub axis: &'static str,
    /// True if results.csv has a column of it.
    pub is_in_csv: bool,
    /// True if documents show it only beside published figures.
    pub is_beside: bool,
    /// Tables that show the figure: the place among the columns of the table, and the head.
    pub heads: Vec<(Table, u16, String)>,
    /// Figure of a judged picture of a view with these pixels.
    pub picture: Option<fn(&JudgedPicture, &PixelCounts) -> f64>,
    value: Box<Take>,
    frames: Option<Frames>,
    steady: Option<fn(&Cycle) -> f64>,
    over: Over,
    only: Vec<fn(&[&Run]) -> bool>,
}

/// Tables with a column for a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Table {
    /// The terminal's table of single runs (`--details`).
    Terminal,
    /// A document's table of single runs. Places from 100 on are behind the times of steps.
    Document,
    /// The summary over all views, in a terminal, in documents and on the page.
    Summary,
}

/// Unit of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Text; not a number.
    Text,
    /// A number of pixels, rays, frames …
    Count,
    /// Pixels of some kind among others ([`Part`]): percent.
    Percent,
    /// Milliseconds.
    Ms,
    /// A small number, such as a root mean square error.
    Plain,
    /// A number of tens or hundreds, such as frames per second.
    Rate,
    /// Bytes.
    Bytes,
}

/// How the values of several views become one in the summary. Parts of pixels are added up, unless
/// the greatest is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    /// The mean of the views.
    Mean,
    /// Added up.
    Sum,
    /// The root of the mean of squares.
    Rms,
    /// The greatest of the views that have the figure.
    Worst,
}

/// Value of a figure.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Text.
    Text(String),
    /// Numbers in the figure's unit: one, or the ends of a range. In [percent](Unit::Percent) they
    /// are a count of pixels, and that of those among which it is.
    Numbers(Vec<f64>),
}

/// A value of a figure as it is taken from a run.
pub trait Taken: 'static {
    /// Returns the value; `None` if it is unknown.
    fn value(self) -> Option<Value>;
}

macro_rules! taken {
    ($($kind:ty: $value:expr;)*) => {
        $(impl Taken for $kind {
            fn value(self) -> Option<Value> {
                Some($value(self))
            }
        })*
    };
}

taken! {
    f64: |number| Value::Numbers(vec![number]);
    u64: |number| Value::Numbers(vec![number as f64]);
    u32: |number| Value::Numbers(vec![f64::from(number)]);
    [f64; 2]: |ends: [f64; 2]| Value::Numbers(ends.into());
    Part: |part: Part| Value::Numbers(vec![part.count as f64, part.of as f64]);
    String: Value::Text;
}

impl<T: Taken> Taken for Option<T> {
    fn value(self) -> Option<Value> {
        self.and_then(T::value)
    }
}

/// A run whose figures are asked for.
#[derive(Clone, Copy, Debug)]
pub struct Case<'a> {
    /// Results that the run is of.
    pub results: &'a Results,
    /// The run.
    pub run: &'a Run,
    /// True if frames are timed by the CPU's clock, since not all that they are compared with have
    /// GPU times.
    pub by_wall: bool,
}

impl<'a> Case<'a> {
    /// Returns the machine on which the run was measured.
    pub fn machine(&self) -> &'a Machine {
        self.results.machine_of(self.run)
    }

    /// Returns the order statistics of the times of frames before which that has moved; `None` if
    /// they were not measured.
    pub fn spread(&self, when: When) -> Option<Spread> {
        let measured = self.run.measured.as_ref()?;
        measured.times(when)?.spread(self.by_wall)
    }
}

/// Clocks by which the frames of results are compared: GPU time and upkeep of the CPU, or wall time
/// for a viewport and light under which a run has no GPU times.
pub struct Clocks<'a> {
    results: &'a Results,
    by_wall: BTreeSet<([u32; 2], Option<&'a str>)>,
}

impl<'a> Clocks<'a> {
    /// Chooses the clocks for the runs of `results`.
    pub fn new(results: &'a Results) -> Self {
        let has_no_times = |run: &&Run| {
            let measured = run.measured.iter();
            let times = measured.flat_map(|measured| {
                let regimes = measured.regimes.iter().map(|times| &times.frame);
                regimes.chain([&measured.frame])
            });
            times.into_iter().any(|times| times.gpu_ms.is_none())
        };
        let runs = results.runs.iter().filter(has_no_times);
        let places = runs.map(|run| (run.viewport, run.light.as_deref()));
        Self {
            results,
            by_wall: places.collect(),
        }
    }

    /// Returns a run of the results with its clock.
    pub fn case<'r>(&self, run: &'r Run) -> Case<'r>
    where
        'a: 'r,
    {
        let place = (run.viewport, run.light.as_deref());
        Case {
            results: self.results,
            run,
            by_wall: self.by_wall.contains(&place),
        }
    }
}

/// Greatest value of a figure among views, and the frames of camera paths.
#[derive(Clone, Debug, PartialEq)]
pub struct Worst {
    /// The value, in the unit of the figure.
    pub value: f64,
    /// Place of the value in words, such as `` `roofs` `` or `` frame 12 of `wind` ``. `None` if
    /// there is one view alone and no path.
    pub place: Option<String>,
}

impl Worst {
    /// Returns the place behind ` on `; nothing if there is only one.
    pub fn on(&self) -> String {
        let place = self.place.as_ref();
        place.map_or(String::new(), |place| format!(" on {place}"))
    }
}

impl Figure {
    /// Creates a figure of results.csv alone.
    pub fn new<T: Taken>(
        name: impl Into<String>,
        unit: Unit,
        value: impl Fn(&Case) -> T + Send + Sync + 'static,
    ) -> Self {
        Self {
            name: name.into(),
            unit,
            quantity: "",
            gate: None,
            axis: "",
            is_in_csv: true,
            is_beside: false,
            heads: Vec::new(),
            picture: None,
            value: Box::new(move |case| value(case).value()),
            frames: None,
            steady: None,
            over: Over::Mean,
            only: Vec::new(),
        }
    }

    /// Shows the figure in a table, at a place among its columns, with this head.
    pub fn shown(mut self, table: Table, place: u16, head: impl Into<String>) -> Self {
        self.heads.push((table, place, head.into()));
        self
    }

    /// Shows the figure only where this is true of the runs of a table.
    pub fn only(mut self, is_shown: fn(&[&Run]) -> bool) -> Self {
        self.only.push(is_shown);
        self
    }

    /// Leaves the figure out of results.csv.
    pub fn not_in_csv(mut self) -> Self {
        self.is_in_csv = false;
        self
    }

    /// Says what published figures of it are called.
    pub fn published(mut self, quantity: &'static str) -> Self {
        self.quantity = quantity;
        self
    }

    /// Shows the figure in documents only beside published ones of this name.
    pub fn beside(mut self, quantity: &'static str) -> Self {
        self.is_beside = true;
        self.published(quantity)
    }

    /// Says how the values of several views become one.
    pub fn over_views(mut self, over: Over) -> Self {
        self.over = over;
        self
    }

    /// Gives the value in each frame of a camera path, in the figure's unit. The greatest of them
    /// is then what a limit is held against; without them it is the value of the path.
    pub fn in_frames(mut self, frames: Frames) -> Self {
        self.frames = Some(frames);
        self
    }

    /// Gives the mean over the pictures that a method which remembers repeats: the summary takes it
    /// for the value, which is that of the worst of them.
    pub fn repeated(mut self, steady: fn(&Cycle) -> f64) -> Self {
        self.steady = Some(steady);
        self
    }

    /// Lets `--fail-if` limit the figure, by this word.
    pub fn limited(mut self, word: impl Into<String>) -> Self {
        self.gate = Some(word.into());
        self
    }

    /// Gives the figure of a judged picture, which `judge --fail-if` limits.
    pub fn of_picture(mut self, picture: fn(&JudgedPicture, &PixelCounts) -> f64) -> Self {
        self.picture = Some(picture);
        self
    }

    /// Lets charts draw the figure as an error, with this text at the axis.
    pub fn drawn(mut self, axis: &'static str) -> Self {
        self.axis = axis;
        self
    }

    /// True if the figure says something of these runs: shimmer, for example, only of paths.
    pub fn is_of(&self, runs: &[&Run]) -> bool {
        self.only.iter().all(|is_shown| is_shown(runs))
    }

    /// Returns the value of a run; `None` if it is unknown.
    pub fn value(&self, case: &Case) -> Option<Value> {
        (self.value)(case)
    }

    /// Returns the values in the frames of a camera path, in the figure's unit; `None` for a view,
    /// or if frames do not have the figure.
    pub fn of_frames(&self, case: &Case) -> Option<Vec<f64>> {
        let measured = case.run.measured.as_ref()?;
        measured.sequence.as_ref().and(self.frames)?(case, measured)
    }

    /// Returns the value as a number in the figure's unit; `None` if it is not one number.
    pub fn number(&self, value: Value) -> Option<f64> {
        match (self.unit, value) {
            (_, Value::Text(_)) => None,
            (Unit::Percent, Value::Numbers(part)) => match part[..] {
                [count, whole] => Some(100.0 * count / whole.max(1.0)),
                _ => None,
            },
            (_, Value::Numbers(numbers)) => numbers.first().copied().filter(|_| numbers.len() == 1),
        }
    }

    /// Returns the value over several views; `None` if one has none.
    pub fn over(&self, cases: &[Case]) -> Option<Value> {
        let values = cases.iter().map(|case| self.usual(case));
        if self.over == Over::Worst {
            let numbers = values.filter_map(|value| Some((self.number(value.clone()?)?, value?)));
            let worst = numbers.max_by(|(one, _), (other, _)| one.total_cmp(other));
            return worst.map(|(_, value)| value);
        }
        let power = if self.over == Over::Rms { 2 } else { 1 };
        let mut sums: Vec<f64> = Vec::new();
        for value in values {
            let Value::Numbers(numbers) = value? else {
                return None;
            };
            sums.resize(numbers.len(), 0.0);
            for (sum, number) in sums.iter_mut().zip(numbers) {
                *sum += number.powi(power);
            }
        }
        let count = cases.len() as f64;
        for sum in &mut sums {
            match self.over {
                Over::Mean if self.unit != Unit::Percent => *sum /= count,
                Over::Rms => *sum = (*sum / count).sqrt(),
                Over::Mean | Over::Sum | Over::Worst => {}
            }
        }
        (!sums.is_empty()).then_some(Value::Numbers(sums))
    }

    /// The value of a run; of a method that remembers the mean of the pictures that it repeats.
    fn usual(&self, case: &Case) -> Option<Value> {
        let mut value = self.value(case)?;
        let steady = case.run.measured.as_ref().and_then(|it| it.steady.as_ref());
        let cycle = steady.and_then(|steady| steady.judged);
        if let (Some((cycle, mean)), Value::Numbers(numbers)) = (cycle.zip(self.steady), &mut value)
        {
            numbers[0] = mean(&cycle);
        }
        Some(value)
    }

    /// Returns the greatest value over views, and frames of paths where these have the figure: the
    /// first of equal ones. `None` if any has none, or without runs.
    pub fn worst(&self, cases: &[Case]) -> Option<Worst> {
        let mut values = Vec::new();
        for case in cases {
            let view = &case.run.view;
            let is_path = |measured: &Measured| measured.sequence.is_some();
            if self.frames.is_some() && case.run.measured.as_ref().is_some_and(is_path) {
                let frames = self.of_frames(case)?.into_iter().enumerate();
                let place = |index| Some(format!("frame {index} of `{view}`"));
                values.extend(frames.map(|(index, value)| (value, place(index))));
            } else {
                let place = (cases.len() > 1).then(|| format!("`{view}`"));
                values.push((self.number(self.value(case)?)?, place));
            }
        }
        let values = values.into_iter();
        let values = values.map(|(value, place)| Worst { value, place });
        greatest(values, |it| it.value).map(|(_, worst)| worst)
    }

    /// Returns the text of a value in a table; `–` if it is unknown. `share` formats its first
    /// argument, a count, as a share of its second one, for example as percent; small numbers have
    /// so many `decimals`.
    pub fn cell(
        &self,
        value: Option<Value>,
        share: fn(u64, u64) -> String,
        decimals: usize,
    ) -> String {
        let number = |number: f64| match self.unit {
            Unit::Ms => ms(number),
            Unit::Plain => format!("{number:.decimals$}"),
            Unit::Rate => format!("{number:.2}"),
            Unit::Bytes => wording::bytes(number as u64),
            Unit::Count | Unit::Percent | Unit::Text => thousands(number.round() as u64),
        };
        match value {
            None => "–".to_owned(),
            Some(Value::Text(text)) => text,
            Some(Value::Numbers(numbers)) => match (self.unit, &numbers[..]) {
                (Unit::Percent, [count, whole]) => share(*count as u64, *whole as u64),
                _ => numbers.into_iter().map(number).join("–"),
            },
        }
    }

    /// Returns the text of a run's cell in results.csv, not yet quoted for CSV; empty if the figure
    /// is unknown.
    pub fn csv_cell(&self, case: &Case) -> String {
        let number = match self.value(case) {
            None => return String::new(),
            Some(Value::Text(text)) => return text,
            Some(Value::Numbers(numbers)) => numbers.first().copied().unwrap_or(f64::NAN),
        };
        match self.unit {
            Unit::Ms => format!("{number:.6}"),
            Unit::Plain | Unit::Rate => format!("{number:.9}"),
            Unit::Count | Unit::Bytes | Unit::Percent | Unit::Text => number.to_string(),
        }
    }
}

impl fmt::Debug for Figure {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.name)
    }
}

impl Unit {
    /// Parses a limit in this unit: `0.1%`, `3ms`, `64MiB`, `0.05`.
    ///
    /// # Errors
    /// Text with the value that was expected.
    pub fn parse(self, text: &str) -> Result<f64, String> {
        match self {
            Self::Percent => percent(text),
            Self::Ms => milliseconds(text),
            Self::Bytes => bytes(text).map(|bytes| bytes as f64),
            Self::Text | Self::Count | Self::Plain | Self::Rate => positive(text),
        }
    }

    /// Returns a value beside a limit as text, with its unit.
    pub fn limit(self, value: f64) -> String {
        match self {
            Self::Percent => format!("{value:.4} %"),
            Self::Ms => format!("{} ms", ms(value)),
            Self::Bytes => wording::bytes(value as u64),
            Self::Count => thousands(value.round() as u64),
            Self::Text | Self::Plain | Self::Rate => format!("{value:.5}"),
        }
    }

    /// Returns a limit for an example.
    pub fn example(self) -> &'static str {
        match self {
            Self::Percent => "5%",
            Self::Ms => "3ms",
            Self::Bytes => "64MiB",
            Self::Text | Self::Count | Self::Plain | Self::Rate => "0.05",
        }
    }
}
