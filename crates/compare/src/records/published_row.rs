//! Reads one line of a file of published figures: its fields, and the mistakes in them.
//!
//! ```
//! use skiagraph_compare::records::published_row::{HEADER, PublishedFile};
//!
//! let named: PublishedFile = "D:docs/data/dissertation.csv".parse()?;
//! assert_eq!(named.label, "D");
//! let file = "docs/data/dissertation.csv".parse::<PublishedFile>()?;
//! assert_eq!(file.label, "dissertation");
//! println!("its first line: {}", HEADER.join(","));
//! # Ok::<(), String>(())
//! ```

use crate::records::columns::{quantities, steps_of};
use crate::records::results::{Published, Run};
use crate::size::Size;
use csv::StringRecord;
use skiagraph_graph::{Code, Diagnostic, SourceFile, Span};
use std::{path::PathBuf, str::FromStr};

/// A file of published figures, `[LABEL:]FILE.csv`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PublishedFile {
    /// Label that marks the figures in tables; by default the file's name without its extension.
    pub label: String,
    /// Path of the file.
    pub file: PathBuf,
}

impl FromStr for PublishedFile {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (label, file) = match text.split_once(':') {
            Some((label, file)) if !label.contains(['/', '\\']) => (Some(label), file),
            _ => (None, text),
        };
        let path = PathBuf::from(file);
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let label = label.unwrap_or(&stem).trim().to_owned();
        if label.is_empty() || file.is_empty() {
            return Err("expected LABEL:FILE.csv, for example D:published.csv".into());
        }
        Ok(Self { label, file: path })
    }
}

/// Figures of the reference: they hold for every preset and map.
const OF_REFERENCE: [&str; 4] = ["facing_light", "facing_away", "lit", "shadow"];

/// Names of the columns of the file, which may stand in any order: scene, view, viewport, map_size,
/// preset, quantity, value, source, note.
pub const HEADER: [&str; 9] = [
    "scene", "view", "viewport", "map_size", "preset", "quantity", "value", "source", "note",
];

/// A published figure, with the scene, view, viewport, map size and preset that it was published
/// for.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    scene: String,
    view: String,
    viewport: [u32; 2],
    map_size: Option<u32>,
    /// Name of the preset; empty for a figure of the [reference](crate#terms), such as its number
    /// of lit pixels.
    pub preset: String,
    /// The figure, with its quantity and source.
    pub figure: Published,
    /// Number of the row's line in the file, from 1.
    pub line: usize,
}

impl Row {
    /// Returns the fields that identify the figure: scene, view, viewport in pixels, map size in
    /// texels (`None` for a method without a map), preset and quantity.
    pub fn key(&self) -> (&str, &str, [u32; 2], Option<u32>, &str, &str) {
        let Self { scene, view, .. } = self;
        let quantity = &self.figure.quantity;
        let (viewport, map_size) = (self.viewport, self.map_size);
        (scene, view, viewport, map_size, &self.preset, quantity)
    }

    /// True if the figure was published for the scene named `scene`, the view and viewport of
    /// `run`, and, unless it is of the [reference](crate#terms), for its map size and its
    /// [`preset`](Run::preset), which both must spell alike, setting included.
    pub fn applies_to(&self, scene: &str, run: &Run) -> bool {
        let of_run = self.preset == run.preset && self.map_size == run.map_size;
        (self.scene.as_str(), &self.view, self.viewport) == (scene, &run.view, run.viewport)
            && (self.preset.is_empty() || of_run)
    }

    /// Reads a line of the file whose label is `label`. Returns a row for each preset that the line
    /// names; for a figure of the [reference](crate#terms) one.
    ///
    /// # Errors
    /// All mistakes in the line.
    pub fn read(label: &str, line: &Line, columns: &Columns) -> Result<Vec<Self>, Vec<Diagnostic>> {
        let count = line.record.len();
        if count != HEADER.len() {
            let what = format!("{count} fields; expected {}", HEADER.len());
            let last = count.min(HEADER.len()) - 1;
            let fault = line.fault(Code::Syntax, last, what);
            let help = "a field with a comma in it stands in quotes";
            return Err(vec![fault.help(help)]);
        }
        let mut fields = Fields {
            line,
            columns,
            faults: Vec::new(),
        };
        for name in ["scene", "view", "source"] {
            if fields.text(name).is_empty() {
                fields.fault(name, Code::MissingField, format!("no {name}"), "");
            }
        }
        let viewport = fields.viewport();
        let map_size = fields.map_size();
        let value = fields.value();
        fields.check_quantity(map_size.is_some());
        if !fields.faults.is_empty() {
            return Err(fields.faults);
        }
        let text = |name| fields.text(name).to_owned();
        let presets = match fields.text("preset") {
            "" => vec![""],
            names => names.split_whitespace().collect(),
        };
        let rows = presets.into_iter().map(|preset| Self {
            scene: text("scene"),
            view: text("view"),
            viewport,
            map_size,
            preset: preset.into(),
            figure: Published {
                by: label.into(),
                quantity: text("quantity"),
                value,
                source: text("source"),
                note: Some(text("note")).filter(|note| !note.is_empty()),
            },
            line: line.span(0).line_column().0,
        });
        Ok(rows.collect())
    }
}

/// The fields of a line while they are read, and what was found to be wrong with them.
struct Fields<'a> {
    line: &'a Line<'a>,
    columns: &'a Columns,
    faults: Vec<Diagnostic>,
}

impl<'a> Fields<'a> {
    fn text(&self, name: &str) -> &'a str {
        let text = self.line.record.get(self.columns.at(name));
        text.unwrap_or_default().trim()
    }

    fn fault(&mut self, name: &str, code: Code, what: String, help: &str) {
        let fault = self.line.fault(code, self.columns.at(name), what);
        self.faults.push(match help {
            "" => fault,
            help => fault.help(help),
        });
    }

    fn viewport(&mut self) -> [u32; 2] {
        let text = self.text("viewport");
        let Size(size) = text.parse().unwrap_or_else(|why| {
            self.fault("viewport", Code::Syntax, format!("`{text}`: {why}"), "");
            Size([0; 2])
        });
        size
    }

    fn map_size(&mut self) -> Option<u32> {
        let text = self.text("map_size");
        let size = text.parse().ok();
        if size.is_none() && !text.is_empty() {
            let what = format!("`{text}` is not a map size in texels");
            self.fault("map_size", Code::Syntax, what, "");
            return Some(0);
        }
        size
    }

    fn value(&mut self) -> f64 {
        let (text, quantity) = (self.text("value"), self.text("quantity"));
        let number = text.parse::<f64>().ok().filter(|value| value.is_finite());
        let Some(number) = number else {
            let what = format!("`{text}` is not a number");
            let help = "digits with a decimal point, without separators of thousands";
            self.fault("value", Code::Syntax, what, help);
            return 0.0;
        };
        let is_share = quantity.ends_with("_percent");
        let is_time = quantity.starts_with("ms.");
        let is_rate = quantity == "fps";
        let is_count = is_known(quantity) && !(is_share || is_time || is_rate);
        if number < 0.0 || (is_share && number > 100.0) || (is_count && number.fract() != 0.0) {
            let expected = match (is_share, is_count) {
                (true, _) => "expected a share in percent, 0 to 100",
                (_, true) => "expected a count of pixels",
                _ if is_rate => "expected frames per second",
                _ => "expected a time in milliseconds",
            };
            let what = format!("`{quantity}` cannot be {text}");
            self.fault("value", Code::Size, what, expected);
        }
        number
    }

    fn check_quantity(&mut self, has_map: bool) {
        let (quantity, preset) = (self.text("quantity"), self.text("preset"));
        if OF_REFERENCE.contains(&quantity) && (!preset.is_empty() || has_map) {
            let what = format!("`{quantity}` is of the reference, whatever the preset and the map");
            let help = "leave preset and map_size empty";
            self.fault("quantity", Code::Syntax, what, help);
        } else if is_of_run(quantity) && preset.is_empty() {
            let what = format!("`{quantity}` is of a preset, and there is none");
            self.fault("preset", Code::MissingField, what, "");
        } else if !is_known(quantity) {
            let what = format!("unknown quantity `{quantity}`");
            let (line, place) = (self.line, self.columns.at("quantity"));
            let fault = line.fault(Code::UnknownVariant, place, what);
            let of_run = quantities();
            let of_run = of_run.iter().map(String::as_str);
            let names = OF_REFERENCE.into_iter().chain(of_run);
            self.faults.push(fault.suggest(quantity, names));
        }
    }
}

fn is_of_run(quantity: &str) -> bool {
    steps_of(quantity).is_some() || quantities().iter().any(|name| name == quantity)
}

fn is_known(quantity: &str) -> bool {
    OF_REFERENCE.contains(&quantity) || is_of_run(quantity)
}

/// Columns of a file, as its first line names them.
pub struct Columns(Vec<String>);

impl Columns {
    /// Finds the columns of a file in its first line.
    ///
    /// # Errors
    /// Unknown or missing columns.
    pub fn new(line: &Line) -> Result<Self, Vec<Diagnostic>> {
        let names: Vec<String> = line.record.iter().map(|it| it.trim().to_owned()).collect();
        let mut faults = Vec::new();
        for (index, name) in names.iter().enumerate() {
            if !HEADER.contains(&name.as_str()) {
                let what = format!("unknown column `{name}`");
                let fault = line.fault(Code::UnknownField, index, what);
                faults.push(fault.suggest(name, HEADER));
            }
        }
        for column in HEADER {
            if !names.iter().any(|name| name == column) {
                let what = format!("there is no column `{column}`");
                let fault = line.fault(Code::MissingField, 0, what);
                faults.push(fault.help(format!("the columns are {}", HEADER.join(","))));
            }
        }
        if faults.is_empty() {
            Ok(Self(names))
        } else {
            Err(faults)
        }
    }

    /// Returns the index of the column `name`, one of [`HEADER`], among the fields of a line; 0 for
    /// any other name.
    pub fn at(&self, name: &str) -> usize {
        let column = self.0.iter().position(|head| head == name);
        column.unwrap_or(0)
    }
}

/// A line of a CSV file, split into fields.
pub struct Line<'a> {
    /// The file that the line is in.
    pub file: &'a SourceFile,
    /// The fields of the line.
    pub record: StringRecord,
}

impl Line<'_> {
    /// Creates an error with the message `what` at the field with the index `field`.
    pub fn fault(&self, code: Code, field: usize, what: String) -> Diagnostic {
        Diagnostic::error(code, what).at(self.span(field), "")
    }

    /// Where a field is written, without the white space around it.
    fn span(&self, field: usize) -> Span {
        let text = &*self.file.text;
        let begin = self.record.position().map_or(0, |at| at.byte() as usize);
        let rest = text.get(begin..).unwrap_or_default();
        // The reader skips empty lines when it begins the next record.
        let mut begin = begin + rest.len() - rest.trim_start_matches(['\r', '\n']).len();
        let (mut quoted, mut index, mut end) = (false, 0, text.len());
        for (at, byte) in text.bytes().enumerate().skip(begin) {
            match byte {
                b'"' => quoted = !quoted,
                b',' | b'\r' | b'\n' if !quoted => {
                    if index == field || byte != b',' {
                        end = at;
                        break;
                    }
                    index += 1;
                    begin = at + 1;
                }
                _ => {}
            }
        }
        let written = text.get(begin..end).unwrap_or_default();
        let begin = begin + written.len() - written.trim_start().len();
        self.file.span(begin..begin + written.trim().len().max(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_figures_have_a_label_and_a_file() {
        let published = |label: &str, file: &str| {
            Ok(PublishedFile {
                label: label.into(),
                file: file.into(),
            })
        };
        assert_eq!("D:docs/d.csv".parse(), published("D", "docs/d.csv"));
        assert_eq!("docs/d.csv".parse(), published("d", "docs/d.csv"));
        assert_eq!("./a:b.csv".parse(), published("a:b", "./a:b.csv"));
        for wrong in ["", ":d.csv", "D:"] {
            assert!(wrong.parse::<PublishedFile>().is_err(), "{wrong}");
        }
    }
}
