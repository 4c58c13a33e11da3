//! Reads published figures, and puts them beside those of runs.
//!
//! ```
//! use skiagraph_compare::records::{published, published_row::PublishedFile, read_back};
//!
//! # let out = tempfile::tempdir()?;
//! # let name = "skiagraph_compare__records__results__tests__the_schema_is_pinned_and_reads_back";
//! # let pinned = std::fs::read_to_string(format!("src/records/snapshots/{name}.snap"))?;
//! # std::fs::write(out.path().join("results.json"), &pinned[pinned.find('{').unwrap_or(0)..])?;
//! let file = out.path().join("printed.csv");
//! std::fs::write(&file, "scene,view,viewport,map_size,preset,quantity,value,source,note\n\
//!     park,main,512x256,1024,nsm,wrong_percent,0.48,table 12,\n")?;
//! let rows = published::read(&[PublishedFile { label: "D".into(), file }])?;
//! let mut results = read_back::kept(out.path())?;
//! published::attach(&rows, &results.scene.name, &mut results.runs[0]);
//! assert_eq!(results.runs[0].published[0].value, 0.48);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::error::{CompareError, Result};
use crate::records::published_row::{Columns, HEADER, Line, PublishedFile, Row};
use crate::records::results::Run;
use crate::wording::plural;
use csv::ReaderBuilder;
use skiagraph_graph::{Code, Diagnostic, SourceFile};
use skiagraph_scene::Limit;

/// A hundred times what was published in ours.
const CSV_FILE: Limit = Limit {
    of: "a file of published figures",
    mib: 16,
    way_out: "split it, and name each part",
};

/// Reads files of published figures.
///
/// # Errors
/// A file that cannot be read; every mistake in the files, with its place.
pub fn read(files: &[PublishedFile]) -> Result<Vec<Row>> {
    let (mut rows, mut faults) = (Vec::new(), Vec::new());
    for PublishedFile { label, file } in files {
        let name = file.display().to_string();
        let text = CSV_FILE.read_text(file);
        let text = text.map_err(|error| CompareError::Input(format!("{name}: {error}")))?;
        let (read, mut mistakes) = parse(label, &SourceFile::new(name, text));
        rows.extend(read);
        faults.append(&mut mistakes);
    }
    if faults.is_empty() {
        return Ok(rows);
    }
    Err(CompareError::Diagnostics {
        faults: vec![faults.clone()],
        summary: format!("{} in published figures", plural(faults.len(), "mistake")),
    })
}

/// Sets [`Run::published`] of a run to the figures of the `rows` that [apply to the
/// run](Row::applies_to). `scene` is the name of the run's scene.
pub fn attach(rows: &[Row], scene: &str, run: &mut Run) {
    let figures = rows.iter().filter(|row| row.applies_to(scene, run));
    run.published = figures.map(|row| row.figure.clone()).collect();
}

/// The rows of a file, and what is wrong with the others.
fn parse(label: &str, file: &SourceFile) -> (Vec<Row>, Vec<Diagnostic>) {
    let mut builder = ReaderBuilder::new();
    builder.has_headers(false).flexible(true);
    let mut reader = builder.from_reader(file.text.as_bytes());
    let (mut rows, mut faults) = (Vec::<Row>::new(), Vec::new());
    let mut columns: Option<Columns> = None;
    for record in reader.records() {
        // A text is UTF-8, and lines may be of any length: there is nothing else to go wrong.
        let Ok(record) = record else { continue };
        let line = Line { file, record };
        let Some(columns) = &columns else {
            match Columns::new(&line) {
                Ok(header) => columns = Some(header),
                Err(faults) => return (Vec::new(), faults),
            }
            continue;
        };
        match Row::read(label, &line, columns) {
            Ok(read) => {
                for row in read {
                    let Some(other) = rows.iter().find(|other| other.key() == row.key()) else {
                        rows.push(row);
                        continue;
                    };
                    let what = format!("this figure was given on line {}", other.line);
                    faults.push(line.fault(Code::DuplicateName, columns.at("quantity"), what));
                }
            }
            Err(mut mistakes) => faults.append(&mut mistakes),
        }
    }
    if columns.is_none() {
        let what = format!("`{}` is empty", file.name);
        let error = Diagnostic::error(Code::MissingField, what).at(file.span(0..0), "");
        faults.push(error.help(format!("its first line is {}", HEADER.join(","))));
    }
    (rows, faults)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::records::results::tests::sample;
    use skiagraph_graph::diagnostics;

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
             park,main,512x256,1024,nsm,wrong_percent,5.30,table 12,\"misprint: 3.50, by its \
                 counts\"\n\
             park,main,512x256,2048,nsm nsm_d,wrong_percent,3.82,table 12,\n\
             park,main,512x256,,rt,ms.frame,1.5,table 19,\n\
             sponza,main,512x256,,rt,ms.frame,2.5,table 19,\n",
        );
        assert_eq!(
            (rows.len(), faults.as_str()),
            (6, ""),
            "one is of two presets"
        );
        let mut results = sample();
        let mut runs = std::mem::take(&mut results.runs);
        let mut beside = |run: usize| {
            attach(&rows, &results.scene.name, &mut runs[run]);
            let figures = runs[run].published.iter();
            let figures = figures.map(|figure| (figure.quantity.clone(), figure.value));
            figures.collect::<Vec<_>>()
        };
        let lit = || ("lit".to_owned(), 60_001.0);
        assert_eq!(beside(0), [lit(), ("wrong_percent".into(), 5.3)]);
        assert_eq!(beside(1), [lit(), ("ms.frame".into(), 1.5)]);
        assert_eq!(beside(2), [lit()]);
        (runs[2].preset, runs[2].map_size) = ("nsm_d".into(), Some(2048));
        attach(&rows, &results.scene.name, &mut runs[2]);
        let figure = &runs[2].published[1];
        assert_eq!((figure.value, figure.source.as_str()), (3.82, "table 12"));
        let note = runs[0].published[1].note.as_deref();
        assert_eq!(note, Some("misprint: 3.50, by its counts"));
    }

    #[test]
    fn the_dissertations_figures_can_be_read() {
        let text = include_str!("../../../../docs/data/dissertation.csv");
        let (rows, faults) = parse("D", &SourceFile::new("dissertation.csv", text));
        let of_two = text.lines().filter(|line| line.contains("_d,")).count();
        let lines = text.lines().count() - 1;
        assert_eq!((rows.len(), faults.len()), (lines + of_two, 0));
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
             park,main,512x256,512,nsm,wrong_lit,5.5,table 12,\n\
             park,main,512x256,512,nsm,fps,-5.5,table 26,\n\
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
        let shuffled = "note,value,scene,view,viewport,map_size,preset,quantity,source\n\
            ,7,park,main,1x1,,rt,rays,table 1\n";
        let (rows, faults) = parse("D", &SourceFile::new("published.csv", shuffled));
        assert!(faults.is_empty());
        assert_eq!((rows[0].figure.value, rows[0].preset.as_str()), (7.0, "rt"));
    }
}
