//! Cells in which a hybrid takes less time.

use super::{Document, Row, published};

/// Cells of the dissertation and of ours in which a hybrid takes less time than `rt`, or than
/// `crsm`.
pub struct Faster {
    pub cells: usize,
    pub by_frames: usize,
    pub by_steps: usize,
}

impl Faster {
    fn new(cells: impl Iterator<Item = [[f64; 2]; 2]>) -> Self {
        let mut faster = Self {
            cells: 0,
            by_frames: 0,
            by_steps: 0,
        };
        for [frames, steps] in cells {
            faster.cells += 1;
            faster.by_frames += usize::from(frames[0] < frames[1]);
            faster.by_steps += usize::from(steps[0] < steps[1]);
        }
        faster
    }

    /// Hybrids of a document, with the end of their names, against `rt`.
    pub fn than_rt(document: &Document, end: &str) -> Self {
        let hybrids = ["hybrid_pcf", "crsm", "crsma"].map(|name| format!("{name}{end}"));
        let rows = document
            .rows
            .iter()
            .filter(|row| hybrids.contains(&row.method));
        Self::new(rows.map(|row| {
            let rt = document.rt(row);
            let frames = [row, rt].map(|row| row.ours("frame ms"));
            [frames, [row, rt].map(Row::steps)]
        }))
    }

    /// `crsma` against `crsm`.
    pub fn than_crsm(document: &Document, end: &str) -> Self {
        let (crsma, crsm) = (format!("crsma{end}"), format!("crsm{end}"));
        Self::new(document.of(&crsma).map(|row| {
            let other = document.row(&row.view, &row.viewport, &crsm, row.map);
            let frames = [row, other].map(|row| row.ours("frame ms"));
            [frames, [row, other].map(Row::steps)]
        }))
    }

    /// The dissertation's, of the views for which `is_asked` is true.
    pub fn of_theirs(is_asked: impl Fn(&str) -> bool, methods: &[&str], than: &str) -> Self {
        let figures = published();
        let cells = figures.keys().filter(|[view, _, preset, map, quantity]| {
            is_asked(view)
                && methods.contains(&preset.as_str())
                && !map.is_empty()
                && quantity == "fps"
        });
        let cells = cells.map(|[view, viewport, preset, map, _]| {
            let get = |preset: &str, quantity: &str| {
                let map = if preset == "rt" { "" } else { map };
                let key = [view, viewport, preset, map, quantity].map(str::to_owned);
                *figures.get(&key).unwrap_or_else(|| panic!("{key:?}"))
            };
            let frames = [preset.as_str(), than].map(|preset| 1000.0 / get(preset, "fps"));
            [
                frames,
                [preset.as_str(), than].map(|preset| get(preset, "ms.steps")),
            ]
        });
        Self::new(cells)
    }

    pub fn line(&self, what: &str) -> Vec<String> {
        let Self {
            cells,
            by_frames,
            by_steps,
        } = self;
        vec![
            what.to_owned(),
            format!("{by_frames} of {cells}"),
            format!("{by_steps} of {cells}"),
        ]
    }
}
