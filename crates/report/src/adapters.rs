//! The page of several adapters: what each can do, how exact and how fast it is, from the
//! adapter.json of each.
//!
//! Every table has a row for each adapter, so that two drivers of one GPU stand under each other.

use itertools::Itertools;
use skiagraph_compare::lists::unique;
use skiagraph_compare::records::abilities::Ability;
use skiagraph_compare::records::adapter::{AdapterRecord, CellFigures, Outcome};
use skiagraph_compare::records::table::Table;
use skiagraph_compare::wording::{ms, size, thousands};

/// Name of the page's file in a folder of joined results.
pub const FILE: &str = "adapters.md";

/// Errors of two adapters may differ by so many points of the pixels that face the light, or by the
/// share that rounding decides.
const POINTS: f64 = 0.05;

/// The method that asks lists in fragments, and in a compute stage.
const STAGES: [&str; 2] = ["light_buffer@stage=fragment", "light_buffer"];

/// Returns the tables of adapters in Markdown, without those that have no rows. Errors are compared
/// with those of the first record.
pub fn markdown(records: &[AdapterRecord]) -> String {
    let mut text = String::new();
    let mut add = |title: &str, note: &str, table: Table| {
        if !table.rows.is_empty() {
            text += &format!("### {title}\n\n{note}\n\n{}\n", table.markdown());
        }
    };
    add(
        "Adapters",
        "A row is a question in a process of its own; *not done* names those that failed, crashed, \
         hung or lost the device. The number in front is that of the other tables.",
        adapters(records),
    );
    add(
        "Exactness",
        "Hard cases: cells that kept the method's guarantee, of those judged. Wrong: pixels of \
         exact methods outside the band where rounding decides, of all that face the light. To the \
         bit: pixels that differ, of those compared.",
        exactness(records),
    );
    add(
        "Errors beside the first adapter",
        &format!(
            "The same cells on both. Beyond: their shares of wrong pixels differ by more than \
             {POINTS} points and by more than the share that rounding decides, or their RMSE by \
             more than 0.001."
        ),
        beside_first(records),
    );
    add(
        "A frame by its size",
        "Milliseconds of a frame with its G-buffer: the GPU's clock, or * the CPU's where the \
         GPU's cannot be trusted.",
        times(
            records,
            |cell| size(cell.viewport),
            |row| row.starts_with("sizes"),
        ),
    );
    add(
        "A frame by the number of triangles",
        "The same in a city, at one size.",
        times(
            records,
            |cell| thousands(cell.triangles),
            |row| row.starts_with("city"),
        ),
    );
    add(
        "Asking in fragments or in compute",
        "Milliseconds that `light_buffer@stage=fragment` takes over those of `light_buffer`, which \
         asks its lists in a compute stage: above 1 that is faster.",
        crossing(records),
    );
    add(
        "Longest passes",
        "Pass with the greatest 95th percentile of its GPU time: what a driver's watchdog sees.",
        longest(records),
    );
    text
}

/// The number of an adapter in tables.
fn number(index: usize) -> String {
    format!("{}", index + 1)
}

fn adapters(records: &[AdapterRecord]) -> Table {
    let heads = [
        "",
        "adapter",
        "backend",
        "driver",
        "kind",
        "processor",
        "rows",
        "not done",
        "ray queries",
        "GPU times",
    ];
    let row = |(index, record): (usize, &AdapterRecord)| {
        let abilities = record.abilities.as_ref();
        let word = |of: fn(&skiagraph_compare::records::abilities::Abilities) -> String| {
            abilities.map_or("–".into(), of)
        };
        let yes = |has: bool| if has { "yes" } else { "no" }.to_owned();
        let ran = record.rows.iter();
        let ran = ran.filter(|row| row.outcome != Outcome::Lacking).count();
        let days = record.rows.iter().map(|row| row.date.as_str());
        let ill = record.rows.iter();
        let ill = ill.filter(|row| !matches!(row.outcome, Outcome::Done | Outcome::Lacking));
        let ill = ill.map(|row| format!("{}: {}", row.row, row.outcome.words()));
        let small = if record.is_small { ", small" } else { "" };
        vec![
            number(index),
            word(|of| of.adapter.name.clone()),
            word(|of| of.adapter.backend.clone()),
            word(|of| of.adapter.driver.clone()),
            word(|of| of.adapter.device_type.clone()),
            word(|of| format!("{}, {} cores", of.machine.processor, of.machine.cores)),
            format!("{ran}{small}, {}", days.max().unwrap_or_default()),
            or_dash(ill.collect::<Vec<_>>().join("; ")),
            yes(abilities.is_some_and(|of| of.has(Ability::RayQuery))),
            yes(abilities.is_some_and(|of| of.adapter.gpu_unavailable.is_none())),
        ]
    };
    Table::new(heads, 10, records.iter().enumerate().map(row))
}

fn or_dash(text: String) -> String {
    if text.is_empty() { "–".into() } else { text }
}

fn exactness(records: &[AdapterRecord]) -> Table {
    let heads = [
        "",
        "adapter",
        "hard cases",
        "by ray queries",
        "wrong, exact methods",
        "hard, to the bit",
        "area, to the bit",
        "wrong, nsm",
    ];
    let row = |(index, record): (usize, &AdapterRecord)| {
        let cases = |rows: &[&str]| {
            let rows = rows.iter().filter_map(|row| record.row(row));
            let figures: Vec<_> = rows.flat_map(|row| &row.figures.hard).collect();
            let sum = |of: fn(&skiagraph_compare::records::adapter::HardFigures) -> u64| {
                figures.iter().map(|figures| of(figures)).sum::<u64>()
            };
            let (passed, failed) = (sum(|of| of.passed), sum(|of| of.failed));
            match passed + failed {
                0 => "–".into(),
                judged => format!("{} of {}", thousands(passed), thousands(judged)),
            }
        };
        let share = |counts: &dyn Fn(&CellFigures) -> bool, wrong: fn(&CellFigures) -> u64| {
            let cells: Vec<_> = record.cells().filter(|cell| counts(cell)).collect();
            let facing: u64 = cells.iter().map(|cell| cell.facing).sum();
            let wrong: u64 = cells.iter().map(|cell| wrong(cell)).sum();
            match facing {
                0 => "–".into(),
                _ => format!("{} of {}", thousands(wrong), thousands(facing)),
            }
        };
        let ran = |cell: &CellFigures| cell.unavailable.is_none();
        let bits = |rows: &[&str]| {
            let rows = rows.iter().filter_map(|row| record.row(row));
            let equal: Vec<_> = rows.flat_map(|row| &row.figures.equal).collect();
            let pixels: u64 = equal.iter().map(|it| it.pixels).sum();
            let differing: u64 = equal.iter().map(|it| it.differing).sum();
            match pixels {
                0 => "–".into(),
                _ => format!("{} of {}", thousands(differing), thousands(pixels)),
            }
        };
        vec![
            number(index),
            record.adapter().unwrap_or_default(),
            cases(&["hard", "hard_area"]),
            cases(&["hard_ray_query"]),
            share(&|cell| ran(cell) && cell.is_exact, |cell| {
                cell.wrong_outside
            }),
            bits(&["park", "lamps"]),
            bits(&["area"]),
            share(&|cell| ran(cell) && cell.method == "nsm", |cell| cell.wrong),
        ]
    };
    Table::new(heads, 2, records.iter().enumerate().map(row))
}

fn beside_first(records: &[AdapterRecord]) -> Table {
    let heads = [
        "",
        "adapter",
        "cells of both",
        "equal to the pixel",
        "greatest difference, points",
        "in",
        "beyond",
    ];
    let Some((first, others)) = records.split_first() else {
        return Table::new(heads, 2, []);
    };
    let row = |(index, record): (usize, &AdapterRecord)| {
        let differences = differences(first, record);
        let equal = differences.iter().filter(|it| it.is_equal).count();
        let worst = differences.iter();
        let worst = worst.max_by(|a, b| a.points.total_cmp(&b.points));
        let beyond = differences.iter().filter(|it| it.is_beyond);
        vec![
            number(index + 1),
            record.adapter().unwrap_or_default(),
            thousands(differences.len() as u64),
            thousands(equal as u64),
            worst.map_or("–".into(), |it| format!("{:.4}", it.points)),
            worst.map_or("–".into(), |it| it.place.clone()),
            or_dash(beyond.map(|it| it.place.clone()).join("; ")),
        ]
    };
    Table::new(heads, 2, others.iter().enumerate().map(row))
}

/// Difference of the errors of one cell (one method on one view in one viewport) on two adapters.
pub struct Difference {
    /// Method, scene, number of triangles, view and viewport, as text.
    pub place: String,
    /// Absolute difference of both [shares of wrong pixels](CellFigures::wrong_percent), in
    /// percentage points.
    pub points: f64,
    /// True if both adapters have the same number of wrong pixels, and of pixels facing the light.
    pub is_equal: bool,
    /// True if both differ by more than rasterisers and rounding account for:
    /// [`points`](Self::points) exceeds 0.05 and the greater share of pixels in the
    /// [band](skiagraph_compare#terms), or the root mean square errors differ by more than 0.001.
    pub is_beyond: bool,
}

/// Compares the errors of the cells that two adapters have in common ([`CellFigures::is_same`]), in
/// the order of `one`. Cells that could not run on one of them are left out.
pub fn differences(one: &AdapterRecord, other: &AdapterRecord) -> Vec<Difference> {
    let both = one.cells().filter_map(|cell| {
        let again = other.cells().find(|again| again.is_same(cell))?;
        (cell.unavailable.is_none() && again.unavailable.is_none()).then_some((cell, again))
    });
    let difference = |(cell, again): (&CellFigures, &CellFigures)| {
        let points = (cell.wrong_percent() - again.wrong_percent()).abs();
        let band = cell.band_percent().max(again.band_percent());
        let rmse = cell.rmse.zip(again.rmse);
        let rmse = rmse.map_or(0.0, |(one, other)| (one - other).abs());
        Difference {
            place: format!(
                "{} on {}, {} triangles, {} {}",
                cell.method,
                cell.scene,
                thousands(cell.triangles),
                cell.view,
                size(cell.viewport)
            ),
            points,
            is_equal: (cell.wrong, cell.facing) == (again.wrong, again.facing),
            is_beyond: points > POINTS.max(band) || rmse > 0.001,
        }
    };
    both.map(difference).collect()
}

/// The cells of the rows that are chosen.
fn cells(record: &AdapterRecord, is_of: fn(&str) -> bool) -> impl Iterator<Item = &CellFigures> {
    let rows = record.rows.iter().filter(move |row| is_of(&row.row));
    rows.flat_map(|row| &row.figures.cells)
}

/// Times: a row for each adapter and method, a column for each key.
fn times(
    records: &[AdapterRecord],
    key: fn(&CellFigures) -> String,
    is_of: fn(&str) -> bool,
) -> Table {
    let all = |record| cells(record, is_of);
    let keys = unique(records.iter().flat_map(all).map(key));
    let heads = ["", "adapter", "method"].into_iter().map(str::to_owned);
    let heads = heads.chain(keys.iter().cloned());
    let rows = records.iter().enumerate().flat_map(|(index, record)| {
        let methods = unique(all(record).map(|cell| cell.method.clone()));
        let keys = &keys;
        let row = move |method: String| {
            let time = |wanted: &String| {
                let mut own = all(record).filter(|cell| cell.method == method);
                let cell = own.find(|cell| key(cell) == *wanted);
                cell.map_or("–".into(), time)
            };
            let own = [
                number(index),
                record.adapter().unwrap_or_default(),
                format!("`{method}`"),
            ];
            own.into_iter().chain(keys.iter().map(time)).collect()
        };
        methods.into_iter().map(row).collect::<Vec<Vec<String>>>()
    });
    Table::new(heads, 3, rows.collect::<Vec<_>>())
}

fn time(cell: &CellFigures) -> String {
    match (&cell.unavailable, cell.gpu_ms) {
        (Some(_), _) => "cannot".into(),
        (None, Some(gpu)) => ms(gpu),
        (None, None) => format!("{}*", ms(cell.wall_ms)),
    }
}

fn crossing(records: &[AdapterRecord]) -> Table {
    let ratios = |record: &AdapterRecord| -> Vec<(String, f64)> {
        let own = cells(record, |row| {
            row.starts_with("sizes") || row.starts_with("city")
        });
        let own: Vec<_> = own.filter(|cell| cell.unavailable.is_none()).collect();
        let fragments = own.iter().filter(|cell| cell.method == STAGES[0]);
        let pairs = fragments.filter_map(|cell| {
            let mut compute = own.iter().filter(|it| it.method == STAGES[1]);
            let place = |of: &CellFigures| {
                let (scene, triangles) = (&of.scene, thousands(of.triangles));
                format!("{scene} of {triangles}, {}", size(of.viewport))
            };
            let place_of = place(cell);
            let compute = compute.find(|it| place(it) == place_of)?;
            let times = [cell, compute].map(|it| it.gpu_ms.unwrap_or(it.wall_ms));
            Some((place_of, times[0] / times[1]))
        });
        pairs.collect()
    };
    let places = unique(
        records
            .iter()
            .flat_map(|record| ratios(record).into_iter().map(|(place, _)| place)),
    );
    let heads = ["", "adapter"].into_iter().map(str::to_owned);
    let heads = heads.chain(places.iter().cloned());
    let row = |(index, record): (usize, &AdapterRecord)| {
        let own = ratios(record);
        let ratio = |place: &String| {
            let found = own.iter().find(|(it, _)| it == place);
            found.map_or("–".into(), |(_, ratio)| format!("{ratio:.2}"))
        };
        let names = [number(index), record.adapter().unwrap_or_default()];
        names.into_iter().chain(places.iter().map(ratio)).collect()
    };
    let has_some = |(_, record): &(usize, &AdapterRecord)| !ratios(record).is_empty();
    let rows = records.iter().enumerate().filter(has_some).map(row);
    Table::new(heads, 2, rows.collect::<Vec<_>>())
}

fn longest(records: &[AdapterRecord]) -> Table {
    let heads = ["", "adapter", "pass", "method", "scene", "viewport", "ms"];
    let rows = records.iter().enumerate().flat_map(|(index, record)| {
        let passes = record.cells().filter_map(|cell| {
            let (pass, time) = cell.longest_pass.as_ref()?;
            Some((cell, pass, *time))
        });
        let passes = passes.sorted_by(|(.., a), (.., b)| b.total_cmp(a));
        // The longest of each pass, and of these the first three.
        let passes = passes.unique_by(|(cell, pass, _)| (cell.method.clone(), (*pass).clone()));
        passes
            .take(3)
            .map(|(cell, pass, time)| {
                vec![
                    number(index),
                    record.adapter().unwrap_or_default(),
                    format!("`{pass}`"),
                    format!("`{}`", cell.method),
                    format!("{}, {}", cell.scene, thousands(cell.triangles)),
                    size(cell.viewport),
                    ms(time),
                ]
            })
            .collect::<Vec<_>>()
    });
    Table::new(heads, 6, rows.collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_compared_cell_by_cell() {
        let cell = |method: &str, wrong: u64, band: u64| CellFigures {
            method: method.into(),
            wrong,
            band,
            facing: 100_000,
            ..CellFigures::default()
        };
        let record = |cells: Vec<CellFigures>| -> AdapterRecord {
            let text = r#"{"schema": 1, "program": "", "commit": null, "is_small": false,
                "abilities": null, "rows": [{"row": "park", "command": "", "outcome": "done",
                "exit": 0, "signal": null, "seconds": 1, "limit": 1, "date": "", "said": [],
                "figures": {}}]}"#;
            let mut record: AdapterRecord = serde_json::from_str(text).unwrap();
            record.rows[0].figures.cells = cells;
            record
        };
        let one = record(vec![
            cell("rt", 0, 100),
            cell("nsm", 500, 10),
            cell("a", 0, 0),
        ]);
        let other = record(vec![
            cell("nsm", 551, 10),
            cell("rt", 90, 100),
            cell("b", 0, 0),
        ]);
        let found = differences(&one, &other);
        let told: Vec<_> = found.iter().map(|it| (it.is_equal, it.is_beyond)).collect();
        assert_eq!(told, [(false, false), (false, true)]);
        assert!(differences(&one, &one).iter().all(|it| it.is_equal));
        // Two cities of one name are two scenes.
        let city = |triangles| CellFigures {
            triangles,
            ..cell("nsm", triangles, 0)
        };
        let [one, other] = [[city(10), city(100)], [city(100), city(10)]];
        let found = differences(&record(one.into()), &record(other.into()));
        assert_eq!(found.iter().filter(|it| it.is_equal).count(), 2);
    }
}
