//! Holds sentences and tables with figures in README.md and docs/ against what they come from: the
//! tables of docs/results and docs/data/dissertation.csv. They stand between `<!-- figures: NAME
//! -->` and `<!-- end of figures -->`; `INSTA_UPDATE=always` writes them anew.

mod conclusions;
mod faster;
mod front;
mod measured;

use std::{collections::BTreeMap, env, fs, path::PathBuf};

const MAPS: [u32; 4] = [512, 1024, 2048, 4096];
/// Views of `bench` whose cameras the dissertation prints right.
const VIEWS: [&str; 8] = [
    "bench_side",
    "bench_with",
    "bench_against",
    "flowers_with",
    "flowers_against",
    "trees_side",
    "trees_with",
    "trees_against",
];
const STEPS: [&str; 5] = ["map ms", "detect ms", "fill ms", "trace ms", "fix ms"];

fn path(file: &str) -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join(file)
}

fn read(file: &str) -> String {
    fs::read_to_string(path(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
}

/// Reads a number as tables print it: `829,670`, `30.4`.
fn number(text: &str) -> Option<f64> {
    let digits: String = text.chars().filter(|c| !",¹²³⁴".contains(*c)).collect();
    digits.trim().parse().ok()
}

/// A figure of ours, and the dissertation's beside it where it has one.
#[derive(Clone, Copy, Debug)]
struct Figure {
    ours: f64,
    theirs: Option<f64>,
}

impl Figure {
    /// Reads `5.28 (D 5.29)`.
    fn new(text: &str) -> Option<Self> {
        let (ours, theirs) = text.split_once(" (D ").unwrap_or((text, ""));
        Some(Self {
            ours: number(ours)?,
            theirs: number(theirs.trim_end_matches(')')),
        })
    }

    fn off(self) -> f64 {
        self.ours - self.theirs.expect("the dissertation has it")
    }
}

/// A line of a table: a method under a map, 0 for none.
struct Row {
    view: String,
    viewport: String,
    method: String,
    map: u32,
    cells: BTreeMap<String, String>,
}

impl Row {
    fn figure(&self, head: &str) -> Option<Figure> {
        Figure::new(self.cells.get(head)?)
    }

    fn ours(&self, head: &str) -> f64 {
        let figure = self.figure(head);
        figure.map_or(0.0, |figure| figure.ours)
    }

    /// Milliseconds of all steps; of the frame without the G-buffer.
    fn steps(&self) -> f64 {
        let is_step = |head: &&String| {
            head.ends_with(" ms")
                && !head.contains(['+'])
                && !head.starts_with("sum")
                && *head != "frame ms"
        };
        let heads = self.cells.keys().filter(is_step);
        heads.map(|head| self.ours(head)).sum()
    }

    fn less_gbuffer(&self) -> f64 {
        self.ours("frame ms") - self.ours("gbuffer ms")
    }
}

/// A document of docs/results that scripts/tables.py writes.
struct Document {
    text: String,
    rows: Vec<Row>,
    /// Pixels that face the light, those that are lit and those in shadow, by view and viewport.
    pixels: BTreeMap<(String, String), [Figure; 3]>,
}

impl Document {
    fn read(name: &str) -> Self {
        let text = read(&format!("docs/results/{name}.md"));
        let (mut rows, mut pixels) = (Vec::new(), BTreeMap::new());
        let (mut view, mut viewport, mut heads) = (String::new(), String::new(), Vec::new());
        for line in text.lines() {
            let cells = || {
                line.trim_matches('|')
                    .split('|')
                    .map(|cell| cell.trim().to_owned())
            };
            if let Some(name) = line.strip_prefix("### ") {
                name.clone_into(&mut view);
            } else if let Some((size, counts)) = line
                .strip_prefix("**")
                .and_then(|l| l.split_once("**: PFL "))
            {
                size.clone_into(&mut viewport);
                let counts = counts.split(';').next().unwrap();
                let counts: Vec<Figure> = counts
                    .split(" = lit ")
                    .flat_map(|part| part.split(" + shadow "))
                    .map(|figure| Figure::new(figure).unwrap_or_else(|| panic!("{line}")))
                    .collect();
                pixels.insert((view.clone(), viewport.clone()), counts.try_into().unwrap());
            } else if line.starts_with("| method") {
                heads = cells().collect();
            } else if line.starts_with("| ") {
                let cells: BTreeMap<String, String> = heads.iter().cloned().zip(cells()).collect();
                rows.push(Row {
                    view: view.clone(),
                    viewport: viewport.clone(),
                    method: cells["method"].clone(),
                    map: number(&cells["map"]).map_or(0, |map| map as u32),
                    cells,
                });
            }
        }
        assert!(!rows.is_empty(), "docs/results/{name}.md has no table");
        Self { text, rows, pixels }
    }

    fn row(&self, view: &str, viewport: &str, method: &str, map: u32) -> &Row {
        let is_it = |row: &&Row| {
            (
                row.view.as_str(),
                row.viewport.as_str(),
                row.method.as_str(),
                row.map,
            ) == (view, viewport, method, map)
        };
        let row = self.rows.iter().find(is_it);
        row.unwrap_or_else(|| panic!("no row {view} {viewport} {method} {map}"))
    }

    fn rt(&self, row: &Row) -> &Row {
        self.row(&row.view, &row.viewport, "rt", 0)
    }

    fn of<'a>(&'a self, method: &'a str) -> impl Iterator<Item = &'a Row> + Clone {
        self.rows.iter().filter(move |row| row.method == method)
    }

    /// Share of the pixels facing the light that are left to rays, in percent. The dissertation's
    /// is as it prints it, or, where that is another run's than its rays, by its rays.
    fn uncertain(&self, row: &Row) -> Figure {
        let [facing, ..] = self.pixels[&(row.view.clone(), row.viewport.clone())];
        let rays = row.figure("rays").unwrap();
        let by_rays = rays
            .theirs
            .map(|rays| 100.0 * rays / facing.theirs.unwrap());
        let printed = row.figure("uncertain %").and_then(|share| share.theirs);
        let is_of_this_run =
            |printed: &f64| by_rays.is_none_or(|share| (share - printed).abs() < 0.05);
        Figure {
            ours: 100.0 * rays.ours / facing.ours,
            theirs: printed.filter(is_of_this_run).or(by_rays),
        }
    }

    /// Value of a line of the head, such as `date`.
    fn head(&self, name: &str) -> &str {
        let start = format!("- {name}: ");
        let line = self.text.lines().find_map(|line| line.strip_prefix(&start));
        line.unwrap_or("unknown").trim_end_matches(" (UTC)")
    }
}

/// The dissertation's times of hybrids and of `rt`: by view, viewport, preset, map and quantity.
fn published() -> BTreeMap<[String; 5], f64> {
    let text = read("docs/data/dissertation.csv");
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let preset = cells[4].split(' ').next()?;
        let key = [cells[1], cells[2], preset, cells[3], cells[5]].map(str::to_owned);
        Some((key, cells[6].parse().ok()?))
    };
    text.lines().filter_map(row).collect()
}

fn least_and_most(values: impl Iterator<Item = f64> + Clone) -> [f64; 2] {
    [
        values.clone().fold(f64::MAX, f64::min),
        values.fold(f64::MIN, f64::max),
    ]
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Breaks a paragraph into lines of 100 columns at most.
fn wrap(text: &str) -> String {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let line = lines.last_mut().unwrap();
        if !line.is_empty() && line.chars().count() + 1 + word.chars().count() > 100 {
            lines.push(word.to_owned());
        } else {
            let space = if line.is_empty() { "" } else { " " };
            *line += &format!("{space}{word}");
        }
    }
    lines.join("\n")
}

fn table(heads: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let mut text = format!("| {} |\n|{}", heads.join(" | "), "---|".repeat(heads.len()));
    for row in rows {
        text += &format!("\n| {} |", row.join(" | "));
    }
    text
}

/// Milliseconds, to three digits.
fn ms(value: f64) -> String {
    let decimals = match value {
        value if value < 1.0 => 2,
        value if value < 10.0 => 1,
        _ => 0,
    };
    format!("{value:.decimals$}")
}

fn share(percent: f64) -> String {
    match percent {
        0.0 => "0".to_owned(),
        small if small < 0.05 => "<0.1".to_owned(),
        other => format!("{other:.1}"),
    }
}

fn signed(value: f64) -> String {
    match value {
        0.0 => "0".to_owned(),
        value if value < 0.0 => format!("−{}", thousands(-value)),
        value => format!("+{}", thousands(value)),
    }
}

fn thousands(value: f64) -> String {
    let digits = format!("{value:.0}");
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// Differences of pages from their tables: all are told at once.
#[derive(Default)]
struct Pages(Vec<String>);

impl Pages {
    /// Holds a paragraph.
    fn say(&mut self, file: &str, name: &str, text: &str) {
        self.hold(file, name, &wrap(text));
    }

    /// Holds an item of a list.
    fn say_item(&mut self, file: &str, name: &str, text: &str) {
        self.hold(file, name, &wrap(text).replace('\n', "\n  "));
    }

    fn hold(&mut self, file: &str, name: &str, expected: &str) {
        let text = read(file);
        let begin = format!("<!-- figures: {name} -->\n");
        let (before, rest) = text
            .split_once(&begin)
            .unwrap_or_else(|| panic!("{file} lacks {begin}"));
        let (says, after) = rest.split_once("\n<!-- end of figures -->").unwrap();
        // A table in Markdown begins after an empty line.
        let expected = format!("\n{expected}\n");
        if says == expected {
            return;
        }
        if env::var("INSTA_UPDATE").is_ok_and(|value| value == "always") {
            let text = [
                before,
                &begin,
                &expected,
                "\n<!-- end of figures -->",
                after,
            ]
            .concat();
            fs::write(path(file), text).unwrap();
        } else {
            self.0.push(format!(
                "{file}, {name}, says:\n{says}\nits tables say:\n{expected}"
            ));
        }
    }

    fn end(self) {
        assert!(
            self.0.is_empty(),
            "{}\nINSTA_UPDATE=always writes it anew; read the difference",
            self.0.join("\n")
        );
    }
}

/// Cells of the row of docs/results/h200.md that begins so, each by its first number.
fn of_h200(start: &str) -> Vec<f64> {
    let text = read("docs/results/h200.md");
    let row = text.lines().find(|line| line.starts_with(start));
    let row = row.unwrap_or_else(|| panic!("h200.md has no row {start}"));
    let cells = row.trim_matches('|').split('|').skip(1);
    cells
        .filter_map(|cell| number(cell.trim().split(' ').next()?))
        .collect()
}
