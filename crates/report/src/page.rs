//! Writes `report.html`, the page of results, to a file, and joins results of several folders.

use crate::html::page;
use itertools::Itertools;
use skiagraph_compare::error::{CompareError, Result};
use skiagraph_compare::files::write::{check_folder, write_whole};
use skiagraph_compare::records::cell_files::{self, Joined};
use skiagraph_compare::records::cells::Cells;
use skiagraph_compare::records::sources::{Kept, Source, merged, sources};
use skiagraph_compare::records::stress::Report;
use skiagraph_compare::records::{read_back, results_csv};
use skiagraph_compare::sink::Sink;
use skiagraph_compare::wording::plural;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Name of the page's file in a folder of results.
pub const FILE: &str = "report.html";

/// Writes the HTML page of one folder of results into that folder, as [`FILE`]. The sink gets
/// notes, as of [`write`](write()).
///
/// # Errors
/// The errors of [`write`](write()).
pub fn write_beside(folder: &Path, sink: &dyn Sink) -> Result<()> {
    write(&[folder.to_path_buf()], &folder.join(FILE), sink)
}

/// Writes the HTML page of the results in `places` to `file`. Each place is a folder that `compare`
/// or `stress` wrote, a results.json, or a folder of such folders. The sink gets notes about
/// pictures that did not fit into the page and planned cells that are not measured yet. The page is
/// written again if another process writes results meanwhile, so that it is never older than they
/// are.
///
/// # Errors
/// If a folder has no results, results cannot be read, or the file cannot be written.
pub fn write(places: &[PathBuf], file: &Path, sink: &dyn Sink) -> Result<()> {
    loop {
        let before = written(places);
        let (read, matrices) = read(places, &[])?;
        let page = page(&sources(read.kept), &matrices);
        write_whole(file, page.html.as_bytes())?;
        if written(places) == before {
            let notes = read.notes.iter().chain(&read.missing).chain(&page.left_out);
            notes.for_each(|text| sink.note(text));
            return Ok(());
        }
    }
}

/// When the results in `places` were written last.
fn written(places: &[PathBuf]) -> Vec<Option<SystemTime>> {
    let places = read_back::with_scenes(places).into_iter();
    let files = places.flat_map(|place| {
        let names = ["results.json", "stress.json"].map(|name| place.join(name));
        names.into_iter().chain([place])
    });
    let files = files.filter_map(|file| file.metadata().ok());
    let files = files.filter(|file| file.is_file());
    files.map(|file| file.modified().ok()).collect()
}

/// Joins the results in `places`, each as for [`write`](write()), and writes their cells,
/// results.json, results.csv and the HTML page into the folder `out`, which is made if it is
/// missing. Results that `out` holds already stay in it. Pictures are embedded in the page, but not
/// copied into `out`. The sink is told which results are joined and which are kept apart.
///
/// # Errors
/// If a place has no results, results cannot be read, or a file cannot be written; cells of two
/// versions of the program, or that two machines measured with different errors. If there is
/// nothing to join, or planned cells are not measured yet, the error is [`CompareError::Input`]; in
/// the second case the measured cells are written first.
pub fn merge(places: &[PathBuf], out: &Path, sink: &dyn Sink) -> Result<()> {
    // All is read before anything is written.
    read(places, &[])?;
    check_folder(out)?;
    let earlier = out.join("results.json").exists();
    let earlier = earlier.then(|| read_back::kept(out)).transpose()?;
    if earlier.is_some() {
        let out = out.display();
        sink.note(&format!("the results that {out} holds already stay in it"));
    }
    let is_out = |place: &Path| of_place(place) == of_place(out);
    let mut places = places.to_vec();
    for place in places.iter_mut().filter(|place| is_out(place)) {
        *place = out.to_path_buf();
    }
    places.retain(|place| place != out || cell_files::is_folder(out));
    let mut cells = Cells::open(out, None, earlier)?;
    let (read, matrices, sources) = loop {
        if let Some(why) = cells.torn.pop() {
            return Err(why);
        }
        let own = cells.in_order().into_iter().map(|results| Kept {
            folder: out.to_path_buf(),
            results: results.clone(),
        });
        let (mut read, matrices) = read(&places, &own.collect_vec())?;
        let sources = sources(std::mem::take(&mut read.kept));
        let Some(results) = merged(&sources, out) else {
            let text = read.missing.unwrap_or_else(|| {
                "there is nothing to join: name folders that `skiagraph compare --out DIR` wrote"
                    .into()
            });
            return Err(CompareError::Input(text));
        };
        cells.set(results.clone())?;
        results_csv::save(&results, out)?;
        if cells.refresh().is_empty() {
            break (read, matrices, sources);
        }
    };
    read.notes.iter().for_each(|text| sink.note(text));
    for source in &sources {
        sink.note(&told(source));
    }
    if sources.len() > 1 {
        let count = plural(sources.len(), "group");
        sink.note(&format!(
            "{count} of results, which differ in scene, adapter, machine, program or protocol, or \
             give one label to several settings, are kept apart"
        ));
    }
    let page = page(&sources, &matrices);
    page.left_out.iter().for_each(|text| sink.note(text));
    write_whole(&out.join(FILE), page.html.as_bytes())?;
    read.missing
        .map_or(Ok(()), |missing| Err(CompareError::Input(missing)))
}

/// Describes what was joined.
fn told(source: &Source) -> String {
    let results = &source.results;
    let runs = plural(results.runs.len(), "run");
    let folders = plural(source.folders.len(), "folder");
    let mut text = format!("{}: {runs} of {folders}", results.scene.name);
    text += &format!(" · {} · {}", results.adapter, results.machine);
    if let count @ 1.. = source.replaced {
        text += &format!("; of {count} that were there twice the newer count");
    }
    text
}

/// Reads the results and matrices of folders or files; one that is named twice is read once. The
/// folder of `own` has been read.
fn read(places: &[PathBuf], own: &[Kept]) -> Result<(Joined, Vec<Report>)> {
    let places = places.iter().unique_by(|place| of_place(place));
    let places: Vec<PathBuf> = places.cloned().collect();
    let cells = cell_files::join(&places)?;
    let is_own = |place: &Path| own.iter().any(|kept| kept.folder == place);
    let joined = cells.kept.iter().filter(|kept| is_own(&kept.folder));
    let joined = joined.flat_map(|kept| &kept.results.runs);
    let joined: BTreeSet<&str> = joined.map(|run| &*run.cell).collect();
    let further = own.iter().filter(|kept| {
        let mut runs = kept.results.runs.iter();
        !runs.any(|run| joined.contains(&*run.cell))
    });
    let mut kept: Vec<Kept> = further.chain(&cells.kept).cloned().collect();
    let mut matrices = Vec::new();
    let places = read_back::with_scenes(&places);
    for place in places.iter().unique_by(|place| of_place(place)) {
        let matrix = place.is_dir().then(|| read_back::stress(place));
        let matrix = matrix.transpose()?.flatten();
        // A folder may be of `stress` or of cells alone.
        let has_others = matrix.is_some() || cell_files::is_folder(place);
        if !is_own(place) && (!has_others || place.join("results.json").exists()) {
            kept.extend(Kept::read(place)?);
        }
        matrices.extend(matrix);
    }
    Ok((Joined { kept, ..cells }, matrices))
}

/// The file of the results of a folder, or the file itself, by the one name that all its names lead
/// to.
fn of_place(place: &Path) -> PathBuf {
    let own = place.is_dir().then(|| place.join("results.json"));
    let file = own.unwrap_or_else(|| place.to_path_buf());
    let canonical = fs::canonicalize(&file).or_else(|_| fs::canonicalize(place));
    canonical.unwrap_or(file)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::results as sample;
    use skiagraph_compare::records::results::Results;
    use skiagraph_compare::sink::Silent;

    /// A folder with these results and a picture of the first run.
    fn folder(place: &Path, results: &Results) -> PathBuf {
        fs::create_dir(place).unwrap();
        results_csv::save(results, place).unwrap();
        let images = results.runs[0].measured.as_ref().unwrap().images.as_ref();
        fs::write(place.join(&images.unwrap().shaded), [7; 99]).unwrap();
        place.to_path_buf()
    }

    #[test]
    fn two_machines_are_joined_to_json_csv_and_page_and_again_with_a_third() {
        let root = tempfile::tempdir().unwrap();
        let place = |name: &str| root.path().join(name);
        let near = folder(&place("here"), &sample());
        let on = |host: &str| {
            let mut results = sample();
            results.machine.host = Some(host.into());
            let runs = results.runs.iter_mut();
            runs.for_each(|run| run.machine = Some(results.machine.clone()));
            results
        };
        let far = folder(&place("far"), &on("far"));
        let out = place("out");
        // A folder, a file, and the folder by another name.
        let again = root.path().join(".").join("here");
        let places = [near, far.join("results.json"), again];
        merge(&places, &out, &Silent).unwrap();
        let read = |file: &str| fs::read_to_string(out.join(file)).unwrap();
        assert_eq!(read("results.csv").lines().count(), 1 + 6);
        let page = read(FILE);
        for host in ["bench", "far"] {
            assert!(
                page.contains(&format!("512x256 · {host}, Some CPU, 8 cores")),
                "{host}"
            );
        }
        let picture = "BwcHBwcHBwcH";
        assert!(page.contains(picture), "pictures of both folders are in it");
        let joined = read_back::kept(&out).unwrap();
        let images = |results: &Results| results.runs[0].measured.as_ref().unwrap().images.clone();
        assert!(
            joined
                .clone()
                .each()
                .iter()
                .all(|results| images(results).is_none())
        );
        assert_eq!(joined.others.len(), 1);

        let third = folder(&place("third"), &on("third"));
        merge(&[third], &out, &Silent).unwrap();
        let hosts = read_back::kept(&out).unwrap().each().into_iter();
        let hosts: Vec<_> = hosts.map(|results| results.machine.host.unwrap()).collect();
        assert_eq!(hosts, ["bench", "far", "third"]);
        // What `report` makes of it has the same rows.
        write(std::slice::from_ref(&out), &out.join(FILE), &Silent).unwrap();
        assert!(read(FILE).contains(" · third, Some CPU"));
    }

    #[test]
    fn nothing_and_foreign_files_are_not_joined() {
        let root = tempfile::tempdir().unwrap();
        let out = root.path().join("out");
        let refused = |places: &[PathBuf]| merge(places, &out, &Silent).unwrap_err().to_string();
        assert!(refused(&[]).contains("there is nothing to join"));
        let missing = root.path().join("missing");
        assert!(refused(&[missing]).contains("there is no folder"));
        let foreign = root.path().join("foreign.json");
        fs::write(&foreign, "{\"schema\": 1}").unwrap();
        let message = refused(&[foreign]);
        assert!(message.contains("is not a results.json"), "{message}");
        assert!(!out.join("results.json").exists());
    }
}
