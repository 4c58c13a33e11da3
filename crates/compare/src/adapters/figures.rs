//! Takes the figures of a row from the files that its command wrote.

use crate::adapters::rows::Row;
use crate::error::CompareError;
use crate::pictures::run_pictures::visibility_npy;
use crate::records::adapter::{CellFigures, Equality, Figures, HardFigures};
use crate::records::read_back;
use crate::records::results::{Answer, Results, Run};
use crate::records::stress::{Cell, Report, Verdict};
use std::{fs, path::Path};

/// The figures in a row's folder; empty where it has no files.
///
/// # Errors
/// A file that cannot be read.
pub(super) fn of_folder(row: &Row, folder: &Path) -> Result<Figures, CompareError> {
    let mut figures = Figures::default();
    if folder.join("results.json").exists() {
        let results = read_back::kept(folder)?;
        figures.cells = results.runs.iter().map(|run| cell(&results, run)).collect();
        figures.equal = alike(row, folder, &results);
    }
    if let Some(report) = read_back::stress(folder)? {
        figures.hard = hard(&report);
    }
    Ok(figures)
}

fn cell(results: &Results, run: &Run) -> CellFigures {
    let of_run = CellFigures {
        scene: results.scene.name.clone(),
        triangles: results.scene.triangles,
        view: run.view.clone(),
        light: run.light.clone(),
        viewport: run.viewport,
        method: run.preset.clone(),
        map_size: run.map_size,
        unavailable: run.unavailable.clone(),
        facing: run.pixels.facing_light,
        band: run.band,
        ..CellFigures::default()
    };
    let Some(measured) = &run.measured else {
        return of_run;
    };
    let passes = measured.passes.iter();
    let passes = passes.filter_map(|pass| Some((pass.name.clone(), pass.gpu_ms?.p95)));
    CellFigures {
        // Shares of light are compared by their bits instead.
        is_exact: run.is_hard()
            && run.promise.as_ref().is_some_and(|promise| {
                promise.is_exact_for_all() || promise.of == "exact" && results.scene.parts.open == 0
            }),
        wrong: measured.wrong.total,
        wrong_outside: measured.wrong_outside_band(),
        rmse: (measured.answer == Answer::Graded).then_some(measured.graded.rmse),
        gpu_ms: measured.frame.gpu_ms.map(|spread| spread.median),
        wall_ms: measured.frame.wall_ms.median,
        longest_pass: passes.max_by(|(_, a), (_, b)| a.total_cmp(b)),
        ..of_run
    }
}

/// Compares the arrays of methods that must answer alike.
fn alike(row: &Row, folder: &Path, results: &Results) -> Vec<Equality> {
    let mut found = Vec::new();
    for group in row.alike {
        let own = |method: &str| {
            let runs = results.runs.iter().filter(|run| run.measured.is_some());
            let runs = runs.filter(|run| run.preset == method);
            runs.collect::<Vec<_>>()
        };
        for first in own(group[0]) {
            let place = |run: &Run| (run.view.clone(), run.light.clone(), run.viewport);
            let others = group[1..].iter().flat_map(|method| own(method));
            for other in others.filter(|other| place(other) == place(first)) {
                let read = |run: &Run| fs::read(folder.join(visibility_npy(run))).ok();
                let Some((one, another)) = read(first).zip(read(other)) else {
                    continue;
                };
                let words = one.chunks(4).zip(another.chunks(4));
                let differing = words.filter(|(a, b)| a != b).count();
                let missing = one.len().abs_diff(another.len()).div_ceil(4);
                found.push(Equality {
                    scene: results.scene.name.clone(),
                    view: first.view.clone(),
                    methods: [first.preset.clone(), other.preset.clone()],
                    pixels: first.viewport.map(u64::from).iter().product(),
                    differing: (differing + missing) as u64,
                });
            }
        }
    }
    found
}

fn hard(report: &Report) -> Vec<HardFigures> {
    let columns = report.methods.iter();
    let columns = columns.filter(|column| column.unavailable.is_none());
    let figures = columns.map(|column| {
        let cells = report.cases.iter().flat_map(|case| {
            let own = case.cells.iter().filter(|cell| cell.is_of(column));
            own.map(|cell| (case.name.clone(), cell))
        });
        let cells: Vec<_> = cells.collect();
        let count = |verdict| {
            cells
                .iter()
                .filter(move |(_, cell)| cell.verdict == verdict)
        };
        let outside = |cell: &Cell| {
            let outside = cell.counts.map(|counts| counts.outside_band);
            outside.map_or(0, |outside| outside.lit + outside.shadow)
        };
        HardFigures {
            method: column.preset.clone(),
            passed: count(Verdict::Pass).count() as u64,
            failed: count(Verdict::Fail).count() as u64,
            wrong_outside: cells.iter().map(|(_, cell)| outside(cell)).sum(),
            failed_cases: count(Verdict::Fail).map(|(name, _)| name.clone()).collect(),
        }
    });
    figures.collect()
}
