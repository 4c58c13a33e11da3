//! docs/data/dissertation.csv against itself: its figures repeat each other often enough that a
//! misread digit of most of them contradicts another.

use std::{collections::HashMap, fs, ops::RangeInclusive};

/// View, viewport, map size or 0, preset.
type Cell = (String, [u32; 2], u32, String);

const VIEWPORTS: [[u32; 2]; 3] = [[512, 512], [1024, 1024], [1920, 1080]];
const MAPS: [u32; 4] = [512, 1024, 2048, 4096];
const HYBRIDS: [&str; 3] = ["hybrid_pcf", "crsm", "crsma"];
/// Views of which there are times: Sponza's, then the appendix's.
const TIMED: [&str; 4] = ["main", "bench_with", "flowers_side", "trees_against"];
const STEPS: [&str; 5] = [
    "ms.create_shadow_map",
    "ms.gbuffer+detect_uncertain",
    "ms.fill_rays",
    "ms.trace_rays",
    "ms.fix_pixels",
];
/// Percentages have two decimals.
const ROUNDED: f64 = 0.0051;
/// Pixels that the rows of Sponza's tables lack.
const LOST: f64 = 9.0;

struct Figure {
    value: f64,
    note: String,
}

/// All figures by cell and quantity.
struct Figures(HashMap<(Cell, String), Figure>);

impl Figures {
    fn read() -> Self {
        let path = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../docs/data/dissertation.csv"
        );
        let text = fs::read(path).unwrap();
        let mut figures = HashMap::new();
        for record in csv::Reader::from_reader(&*text).records() {
            let record = record.unwrap();
            let (width, height) = record[2].split_once('x').unwrap();
            let viewport = [width, height].map(|side| side.parse().unwrap());
            let map = record[3].parse().unwrap_or(0);
            // Ours first, then the one with the dissertation's conventions.
            let preset = record[4].split(' ').next().unwrap_or_default();
            let cell = (record[1].to_owned(), viewport, map, preset.to_owned());
            let figure = Figure {
                value: record[6].parse().unwrap(),
                note: record[8].to_owned(),
            };
            let previous = figures.insert((cell, record[5].to_owned()), figure);
            assert!(previous.is_none(), "twice: {record:?}");
        }
        Self(figures)
    }

    fn find(&self, cell: &Cell, quantity: &str) -> Option<&Figure> {
        self.0.get(&(cell.clone(), quantity.to_owned()))
    }

    fn get(&self, cell: &Cell, quantity: &str) -> f64 {
        let figure = self.find(cell, quantity);
        figure
            .unwrap_or_else(|| panic!("no {quantity} of {cell:?}"))
            .value
    }

    /// A count of the reference in the cell's view and viewport.
    fn of_reference(&self, (view, viewport, ..): &Cell, quantity: &str) -> f64 {
        self.get(&(view.clone(), *viewport, 0, String::new()), quantity)
    }

    /// Cells that have a quantity.
    fn cells<'a>(&'a self, quantity: &'a str) -> impl Iterator<Item = &'a Cell> {
        let keys = self.0.keys().filter(move |(_, name)| name == quantity);
        keys.map(|(cell, _)| cell)
    }

    /// How many of the times' cells of these views and presets satisfy something.
    fn count(
        &self,
        views: &[&str],
        presets: &[&str],
        holds: impl Fn(&Self, &Cell) -> bool,
    ) -> usize {
        let mut count = 0;
        for view in views {
            for viewport in VIEWPORTS {
                for map in MAPS {
                    for preset in presets {
                        let cell = (view.to_string(), viewport, map, preset.to_string());
                        count += usize::from(holds(self, &cell));
                    }
                }
            }
        }
        count
    }

    /// Returns the cell's figure of another preset, `rt` without a map.
    fn of(&self, (view, viewport, map, _): &Cell, preset: &str, quantity: &str) -> f64 {
        let map = if preset == "rt" { 0 } else { *map };
        self.get(&(view.clone(), *viewport, map, preset.to_owned()), quantity)
    }
}

#[track_caller]
fn near(computed: f64, stated: f64, off: f64, what: &Cell) {
    assert!(
        (computed - stated).abs() <= off,
        "{computed} and {stated} of {what:?}"
    );
}

/// Sponza's rows lack a few pixels.
fn lost(cell: &Cell) -> f64 {
    if cell.0 == "main" { LOST } else { 1.0 }
}

#[test]
fn every_pixel_is_lit_or_in_shadow_or_faces_away() {
    let figures = Figures::read();
    assert_eq!(figures.cells("facing_light").count(), 10 * 3);
    for cell in figures.cells("facing_light") {
        let count = |quantity| figures.of_reference(cell, quantity);
        let facing = count("facing_light");
        assert_eq!(count("lit") + count("shadow"), facing, "{cell:?}");
        let [width, height] = cell.1.map(f64::from);
        assert_eq!(facing + count("facing_away"), width * height, "{cell:?}");
    }
}

/// Rows of the tables of `nsm` follow the map's picture, those of the hybrids the final one: in
/// both "light" is what the method lights.
#[test]
fn wrong_pixels_make_the_methods_picture_out_of_the_references() {
    let figures = Figures::read();
    assert_eq!(figures.cells("wrong_lit").count(), 10 * 6 + 10 * 3);
    for cell in figures.cells("wrong_lit") {
        let get = |quantity| figures.get(cell, quantity);
        let (wrong_lit, wrong_shadow) = (get("wrong_lit"), get("wrong_shadow"));
        let lit = figures.of_reference(cell, "lit") + wrong_lit - wrong_shadow;
        let shadow = figures.of_reference(cell, "shadow") + wrong_shadow - wrong_lit;
        near(
            100.0 * wrong_lit / lit,
            get("wrong_lit_percent"),
            ROUNDED,
            cell,
        );
        near(
            100.0 * wrong_shadow / shadow,
            get("wrong_shadow_percent"),
            ROUNDED,
            cell,
        );
        let wrong_percent = 100.0 * (wrong_lit + wrong_shadow) / (lit + shadow);
        if cell.3 == "nsm" {
            near(wrong_percent, get("wrong_percent"), ROUNDED, cell);
            continue;
        }
        near(wrong_percent, get("certain_wrong_percent"), ROUNDED, cell);
        near(
            get("certain_lit") + get("lit_uncertain"),
            lit,
            lost(cell),
            cell,
        );
        near(
            get("certain_shadow") + get("shadow_uncertain"),
            shadow,
            lost(cell),
            cell,
        );
        let uncertain = get("lit_uncertain") + get("shadow_uncertain");
        near(
            100.0 * uncertain / (lit + shadow),
            get("uncertain_percent"),
            2.0 * ROUNDED,
            cell,
        );
        if figures.find(cell, "rays").is_some() {
            assert_eq!(uncertain, get("rays"), "{cell:?}");
        }
    }
}

#[test]
fn shares_sum_to_the_whole_and_rays_are_the_uncertain_pixels() {
    let figures = Figures::read();
    assert_eq!(
        figures.cells("certain_right_percent").count(),
        10 * 12 + 9 * 6
    );
    for cell in figures.cells("certain_right_percent") {
        let get = |quantity| figures.get(cell, quantity);
        let sum = get("certain_right_percent") + get("certain_wrong_percent");
        near(sum + get("uncertain_percent"), 100.0, 0.0101, cell);
        if let Some(rays) = figures.find(cell, "rays") {
            let share = 100.0 * rays.value / figures.of_reference(cell, "facing_light");
            let printed = figures.find(cell, "uncertain_percent").unwrap();
            let differs = (share - printed.value).abs() > 2.0 * ROUNDED;
            assert_eq!(differs, printed.note.starts_with("another run"), "{cell:?}");
        }
    }
    for cell in figures.cells("rays") {
        let rays = figures.find(cell, "rays").unwrap();
        let fits = rays.value <= figures.of_reference(cell, "facing_light");
        assert!(fits || rays.note.starts_with("misprint"), "{cell:?}");
    }
}

#[test]
fn steps_sum_up_and_frames_are_longer_than_that() {
    let figures = Figures::read();
    let check = |figures: &Figures, cell: &Cell| {
        let sum: f64 = STEPS.iter().map(|step| figures.get(cell, step)).sum();
        near(sum, figures.get(cell, "ms.steps"), 0.0251, cell);
        true
    };
    assert_eq!(figures.count(&TIMED, &HYBRIDS, check), 144);
    let frame = |cell: &Cell, within: RangeInclusive<f64>| {
        let frame = 1000.0 / figures.get(cell, "fps");
        let share = frame / figures.get(cell, "ms.steps");
        assert!(within.contains(&share), "{share} of {cell:?}");
    };
    assert_eq!(figures.cells("fps").count(), 4 * 3 * 17);
    for cell in figures.cells("fps") {
        match &*cell.3 {
            "nsm" => frame(cell, 1.5..=7.0),
            "rt" => frame(cell, 1.0..=1.5),
            _ => frame(cell, 1.2..=2.5),
        }
    }
}

/// The sentences of docs/results.md that count cells.
#[test]
fn the_hybrids_win_38_cells_by_frames_and_82_by_sums() {
    let figures = Figures::read();
    let by_frames =
        |figures: &Figures, cell: &Cell| figures.get(cell, "fps") > figures.of(cell, "rt", "fps");
    let by_sums = |figures: &Figures, cell: &Cell| {
        figures.get(cell, "ms.steps") < figures.of(cell, "rt", "ms.steps")
    };
    let wins = |views: &[&str]| {
        let frames = figures.count(views, &HYBRIDS, by_frames);
        [frames, figures.count(views, &HYBRIDS, by_sums)]
    };
    assert_eq!(wins(&TIMED), [38, 82]);
    let of_each = TIMED.map(|view| wins(&[view]));
    assert_eq!(of_each, [[7, 12], [6, 19], [17, 31], [8, 20]]);
}

/// Against its verdict that adjacency does not pay.
#[test]
fn adjacency_pays_in_23_of_the_appendixs_sums_and_27_of_its_frames() {
    let figures = Figures::read();
    let by_sums = |figures: &Figures, cell: &Cell| {
        figures.get(cell, "ms.steps") < figures.of(cell, "crsm", "ms.steps")
    };
    let by_frames =
        |figures: &Figures, cell: &Cell| figures.get(cell, "fps") > figures.of(cell, "crsm", "fps");
    let wins = |views: &[&str]| {
        let sums = figures.count(views, &["crsma"], by_sums);
        [sums, figures.count(views, &["crsma"], by_frames)]
    };
    assert_eq!(wins(&TIMED[1..]), [23, 27]);
    assert_eq!(wins(&TIMED[..1]), [0, 0]);
}
