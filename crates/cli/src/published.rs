//! `compare --beside`: figures that somebody published, to stand beside ours.

use crate::{
    error::{CliError, colour, count_errors},
    parse::{Beside, Size},
    results::{Published, Results, Run},
};
use csv::{ReaderBuilder, StringRecord};
use skiagraph_graph::{Code, Diagnostic, SourceFile, Span, diagnostics};
use skiagraph_scene::Limit;
use std::str::FromStr;

/// A hundred times what was published in ours.
const CSV_FILE: Limit = Limit {
    of: "a file of published figures",
    mib: 16,
    way_out: "split it, and give --beside for each part",
};

/// Figures of the reference: they hold for every preset and map.
const OF_REFERENCE: [&str; 4] = ["facing_light", "facing_away", "lit", "shadow"];

/// Figures of a run.
const OF_RUN: [&str; 11] = [
    "wrong_percent",
    "certain_right_percent",
    "uncertain_percent",
    "certain_wrong_percent",
    "rays",
    "ms.create_shadow_map",
    "ms.detect_uncertain",
    "ms.fill_rays",
    "ms.trace_rays",
    "ms.fix_pixels",
    "ms.frame",
];

const COLUMNS: [&str; 9] = [
    "scene", "view", "viewport", "map_size", "preset", "quantity", "value", "source", "note",
];

/// One line of such a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    scene: String,
    view: String,
    viewport: [u32; 2],
    map_size: Option<u32>,
    /// Empty: of the reference.
    preset: String,
    figure: Published,
    /// Its line in the file.
    line: usize,
}

impl Row {
    /// Where it belongs.
    fn key(&self) -> (&str, &str, [u32; 2], Option<u32>, &str, &str) {
        let Self { scene, view, .. } = self;
        let quantity = &self.figure.quantity;
        let (viewport, map_size) = (self.viewport, self.map_size);
        (scene, view, viewport, map_size, &self.preset, quantity)
    }

    fn is_beside(&self, scene: &str, run: &Run) -> bool {
        let of_run = self.preset == run.preset && self.map_size == run.map_size;
        (self.scene.as_str(), &self.view, self.viewport) == (scene, &run.view, run.viewport)
            && (self.preset.is_empty() || of_run)
    }
}

/// Reads all files.
///
/// # Errors
/// A file that cannot be read; everything that is wrong in them, with its place.
pub fn read(files: &[Beside]) -> Result<Vec<Row>, CliError> {
    let (mut rows, mut faults) = (Vec::new(), Vec::new());
    for Beside { label, file } in files {
        let name = file.display().to_string();
        let text = CSV_FILE
            .read_text(file)
            .map_err(|error| CliError::Input(format!("--beside {name}: {error}")))?;
        let (read, mut found) = parse(label, &SourceFile::new(name, text));
        rows.extend(read);
        faults.append(&mut found);
    }
    if faults.is_empty() {
        return Ok(rows);
    }
    let count = count_errors(faults.iter());
    Err(CliError::Diagnostics {
        rendered: diagnostics::render(&faults, colour()),
        summary: format!(
            "{count} mistake{} in published figures",
            if count == 1 { "" } else { "s" }
        ),
    })
}

/// Puts the figures beside the runs that they belong to.
pub fn put_beside(rows: &[Row], results: &Results, run: &mut Run) {
    let scene = &results.scene.name;
    let figures = rows.iter().filter(|row| row.is_beside(scene, run));
    run.published = figures.map(|row| row.figure.clone()).collect();
}

/// The rows of a file, and what is wrong with the others.
fn parse(label: &str, file: &SourceFile) -> (Vec<Row>, Vec<Diagnostic>) {
    let mut reader = ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .from_reader(file.text.as_bytes());
    let (mut rows, mut faults) = (Vec::<Row>::new(), Vec::new());
    let mut columns: Option<[usize; 9]> = None;
    for record in reader.records() {
        // A text is UTF-8, and lines may be of any length: there is nothing else to go wrong.
        let Ok(record) = record else { continue };
        let line = Line::new(file, &record);
        let Some(columns) = columns else {
            match header(&line) {
                Ok(found) => columns = Some(found),
                Err(mut found) => {
                    faults.append(&mut found);
                    return (Vec::new(), faults);
                }
            }
            continue;
        };
        match row(label, &line, &columns) {
            Ok(row) => match rows.iter().find(|other| other.key() == row.key()) {
                None => rows.push(row),
                Some(other) => {
                    let what = format!("this figure was given on line {}", other.line);
                    faults.push(line.fault(Code::DuplicateName, columns[5], what));
                }
            },
            Err(mut found) => faults.append(&mut found),
        }
    }
    if columns.is_none() {
        let what = format!("`{}` is empty", file.name);
        let error = Diagnostic::error(Code::MissingField, what).at(file.span(0..0), "");
        faults.push(error.help(format!("its first line is {}", COLUMNS.join(","))));
    }
    (rows, faults)
}

/// Where each of [`COLUMNS`] stands.
fn header(line: &Line) -> Result<[usize; 9], Vec<Diagnostic>> {
    let names: Vec<&str> = line.record.iter().map(str::trim).collect();
    let mut faults: Vec<Diagnostic> = names
        .iter()
        .enumerate()
        .filter(|(_, name)| !COLUMNS.contains(name))
        .map(|(index, name)| {
            let what = format!("no column is called `{name}`");
            let fault = line.fault(Code::UnknownField, index, what);
            fault.suggest(name, COLUMNS)
        })
        .collect();
    let mut columns = [0; 9];
    for (place, column) in columns.iter_mut().zip(COLUMNS) {
        match names.iter().position(|name| *name == column) {
            Some(index) => *place = index,
            None => {
                let what = format!("there is no column `{column}`");
                let fault = line.fault(Code::MissingField, 0, what);
                faults.push(fault.help(format!("the columns are {}", COLUMNS.join(","))));
            }
        }
    }
    match faults.is_empty() {
        true => Ok(columns),
        false => Err(faults),
    }
}

fn row(label: &str, line: &Line, columns: &[usize; 9]) -> Result<Row, Vec<Diagnostic>> {
    let fields = line.record.len();
    if fields != COLUMNS.len() {
        let what = format!("{fields} fields; expected {}", COLUMNS.len());
        let last = fields.min(COLUMNS.len()) - 1;
        let fault = line.fault(Code::Syntax, last, what);
        return Err(vec![
            fault.help("a field with a comma in it stands in quotes"),
        ]);
    }
    let [
        scene,
        view,
        viewport,
        map_size,
        preset,
        quantity,
        value,
        source,
        note,
    ] = columns.map(|column| line.record[column].trim());
    let mut faults = Vec::new();
    let mut fault = |column: usize, code, what: String, help: &str| {
        let fault = line.fault(code, columns[column], what);
        faults.push(match help {
            "" => fault,
            help => fault.help(help),
        });
    };
    for (column, text) in [(0, scene), (1, view), (7, source)] {
        if text.is_empty() {
            let what = format!("no {}", COLUMNS[column]);
            fault(column, Code::MissingField, what, "");
        }
    }
    let size = Size::from_str(viewport).unwrap_or_else(|why| {
        fault(2, Code::Syntax, format!("`{viewport}`: {why}"), "");
        Size([0; 2])
    });
    let map_size = (!map_size.is_empty()).then(|| {
        map_size.parse().unwrap_or_else(|_| {
            let what = format!("`{map_size}` is no size of a map in texels");
            fault(3, Code::Syntax, what, "");
            0
        })
    });
    let number = value.parse::<f64>().ok().filter(|value| value.is_finite());
    let number = number.unwrap_or_else(|| {
        let help = "digits with a decimal point, without separators of thousands";
        fault(6, Code::Syntax, format!("`{value}` is no number"), help);
        0.0
    });
    let is_share = quantity.ends_with("_percent");
    let is_count = quantity == "rays" || OF_REFERENCE.contains(&quantity);
    if number < 0.0 || (is_share && number > 100.0) || (is_count && number.fract() != 0.0) {
        let expected = match (is_share, is_count) {
            (true, _) => "a share in percent, 0 to 100",
            (_, true) => "a count of pixels",
            _ => "a time in milliseconds",
        };
        let what = format!("`{quantity}` cannot be {value}");
        fault(6, Code::Size, what, &format!("expected {expected}"));
    }
    if OF_REFERENCE.contains(&quantity) {
        if !preset.is_empty() || map_size.is_some() {
            let what = format!("`{quantity}` is of the reference, whatever the preset and the map");
            fault(5, Code::Syntax, what, "leave preset and map_size empty");
        }
    } else if OF_RUN.contains(&quantity) {
        if preset.is_empty() {
            let what = format!("`{quantity}` is of a preset, and there is none");
            fault(4, Code::MissingField, what, "");
        }
    } else {
        let known = OF_REFERENCE.into_iter().chain(OF_RUN);
        let what = format!("no quantity is called `{quantity}`");
        let error = line.fault(Code::UnknownVariant, columns[5], what);
        faults.push(error.suggest(quantity, known));
    }
    if !faults.is_empty() {
        return Err(faults);
    }
    Ok(Row {
        scene: scene.into(),
        view: view.into(),
        viewport: size.0,
        map_size,
        preset: preset.into(),
        figure: Published {
            by: label.into(),
            quantity: quantity.into(),
            value: number,
            source: source.into(),
            note: (!note.is_empty()).then(|| note.into()),
        },
        line: line.span(0).line_column().0,
    })
}

/// A record with the places of its fields.
struct Line<'a> {
    file: &'a SourceFile,
    record: &'a StringRecord,
}

impl<'a> Line<'a> {
    fn new(file: &'a SourceFile, record: &'a StringRecord) -> Self {
        Self { file, record }
    }

    fn fault(&self, code: Code, field: usize, what: String) -> Diagnostic {
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
    use crate::results::tests::sample;

    const HEADER: &str = "scene,view,viewport,map_size,preset,quantity,value,source,note\n";

    fn parsed(lines: &str) -> (Vec<Row>, String) {
        let file = SourceFile::new("published.csv", format!("{HEADER}{lines}"));
        let (rows, faults) = parse("D", &file);
        (rows, diagnostics::render(&faults, false))
    }

    #[test]
    fn figures_stand_beside_the_runs_that_they_are_of() {
        let (rows, faults) = parsed(
            "park,main,512x256,,,lit,60001,table 6,\n\
             park,main,512x256,1024,nsm,wrong_percent,5.30,table 12,\"misprint: 3.50, by its counts\"\n\
             park,main,512x256,2048,nsm,wrong_percent,3.82,table 12,\n\
             park,main,512x256,,rt,ms.frame,1.5,table 19,\n\
             sponza,main,512x256,,rt,ms.frame,2.5,table 19,\n",
        );
        assert_eq!((rows.len(), faults.as_str()), (5, ""));
        let mut results = sample();
        let mut runs = std::mem::take(&mut results.runs);
        let mut beside = |run: usize| {
            put_beside(&rows, &results, &mut runs[run]);
            let figures = runs[run].published.iter();
            let figures = figures.map(|figure| (figure.quantity.clone(), figure.value));
            figures.collect::<Vec<_>>()
        };
        let lit = || ("lit".to_owned(), 60_001.0);
        assert_eq!(beside(0), [lit(), ("wrong_percent".into(), 5.3)]);
        assert_eq!(beside(1), [lit(), ("ms.frame".into(), 1.5)]);
        assert_eq!(beside(2), [lit()]);
        let note = runs[0].published[1].note.as_deref();
        assert_eq!(note, Some("misprint: 3.50, by its counts"));
    }

    #[test]
    fn every_mistake_is_shown_with_its_place() {
        let (rows, faults) = parsed(
            "park,main,512x256,,,lit,60001,table 6,\n\
             park,main,512x256,,,lit,60002,table 7,\n\
             park,main,512,big,nsm,wrong_percent,\"5,30\",table 12,\n\
             park,main,512x256,512,nsm,wrong_percent,530,table 12,\n\
             \n\
             park,main,512x256,512,nsm,wrong_percnt,5.3,table 12,\n\
             park,main,512x256,512,nsm,lit,5.5,table 12,\n\
             park,main,512x256,512,,rays,5,,\n\
             park,main,512x256,512,nsm,rays,5,table 12,a note, with a comma\n",
        );
        assert_eq!(rows.len(), 1);
        insta::assert_snapshot!(faults);
    }

    #[test]
    fn the_columns_are_those_that_are_known() {
        let refused = |text: &str| {
            let (rows, faults) = parse("D", &SourceFile::new("published.csv", text));
            assert_eq!(rows, []);
            diagnostics::render(&faults, false)
        };
        let texts = [HEADER.replace("quantity", "quantities"), String::new()];
        insta::assert_snapshot!(texts.map(|text| refused(&text)).join("\n"));
        let shuffled = "note,value,scene,view,viewport,map_size,preset,quantity,source\n,7,park,main,1x1,,rt,rays,table 1\n";
        let (rows, faults) = parse("D", &SourceFile::new("published.csv", shuffled));
        assert!(faults.is_empty());
        assert_eq!((rows[0].figure.value, rows[0].preset.as_str()), (7.0, "rt"));
    }
}
