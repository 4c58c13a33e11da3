//! Pairs of panels: what others published of some runs left, what we measured right.

use crate::charts::push;
use skiagraph_chart::{Kind, Mark, Panel, Series};
use skiagraph_compare::records::columns::figure;
use skiagraph_compare::records::results::{Published, Results, Run};
use skiagraph_compare::wording::size;
use std::collections::BTreeSet;

/// A run with what was published about it.
pub struct Cell<'a> {
    /// All results that it is of.
    pub results: &'a Results,
    /// The run, which has measurements.
    pub run: &'a Run,
}

/// All runs with measurements.
pub fn cells(results: &Results) -> impl Iterator<Item = Cell<'_>> {
    let runs = results.runs.iter().filter(|run| run.measured.is_some());
    runs.map(move |run| Cell { results, run })
}

impl<'a> Cell<'a> {
    /// Name of the scene.
    pub fn scene(&self) -> &'a str {
        &self.results.scene.name
    }

    /// The run of the same view and viewport that draws no map, and of which a quantity is
    /// published.
    pub fn whole(&self, quantity: &str) -> Option<&'a Run> {
        let Run { view, viewport, .. } = self.run;
        let mut runs = self.results.runs.iter();
        runs.find(|run| {
            (&run.view, &run.viewport, run.map_size) == (view, viewport, None)
                && published(run, quantity).is_some()
        })
    }
}

/// The published figure of that quantity.
pub fn published<'a>(run: &'a Run, quantity: &str) -> Option<&'a Published> {
    let mut figures = run.published.iter();
    figures.find(|figure| figure.quantity == quantity)
}

/// Quantity that a group of bars stands for; the other one has panels of its own for each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Groups {
    /// Viewports.
    Viewports,
    /// Sizes of maps.
    Maps,
}

impl Groups {
    /// Their name.
    pub fn plural(self) -> &'static str {
        match self {
            Self::Viewports => "viewports",
            Self::Maps => "map sizes",
        }
    }

    /// Name of the axis along which they stand.
    pub fn axis(self) -> &'static str {
        match self {
            Self::Viewports => "viewport",
            Self::Maps => "map",
        }
    }

    fn name(self, group: [u32; 2]) -> String {
        match self {
            Self::Viewports => size(group),
            Self::Maps => format!("{}²", group[0]),
        }
    }
}

/// A figure on both sides.
pub struct Bar<'a> {
    /// The series that it belongs to.
    pub series: String,
    /// Theirs, as it was published.
    pub figure: &'a Published,
    /// Theirs, as it is drawn.
    pub theirs: f64,
    /// Ours.
    pub ours: f64,
}

impl<'a> Bar<'a> {
    /// The bar that a figure of theirs and one of ours make, if there are both, each divided by a
    /// whole.
    pub fn new(
        cell: &Cell<'a>,
        quantity: &str,
        (their_whole, our_whole): (f64, f64),
    ) -> Option<Self> {
        let theirs = published(cell.run, quantity)?;
        let bar = Self {
            series: cell.run.preset.clone(),
            figure: theirs,
            theirs: theirs.value / their_whole,
            ours: figure(quantity, cell.results, cell.run)? / our_whole,
        };
        // Shares of nothing are none.
        (bar.theirs.is_finite() && bar.ours.is_finite()).then_some(bar)
    }
}

/// Content of one pair of panels.
pub struct PanelRow<'a> {
    /// Name of the scene.
    pub scene: &'a str,
    /// Name of the view.
    pub view: &'a str,
    /// The viewport, or the map where groups are viewports.
    place: String,
    bars: Vec<([u32; 2], Bar<'a>)>,
}

/// Pairs of panels of at least two groups. `bar` may be none of a cell.
pub fn rows<'a>(
    cells: &'a [Cell<'a>],
    groups: Groups,
    bar: impl Fn(&'a Cell<'a>) -> Option<Bar<'a>>,
) -> Vec<PanelRow<'a>> {
    let mut rows: Vec<PanelRow> = Vec::new();
    for cell in cells {
        let map = cell.run.map_size;
        let (group, place) = match (groups, map) {
            (Groups::Viewports, Some(map)) => (cell.run.viewport, format!(", map {map}²")),
            (Groups::Viewports, None) => (cell.run.viewport, String::new()),
            (Groups::Maps, Some(map)) => ([map; 2], format!(", {}", size(cell.run.viewport))),
            (Groups::Maps, None) => continue,
        };
        let (scene, view) = (cell.scene(), cell.run.view.as_str());
        if let Some(bar) = bar(cell) {
            let key = (scene, view, &*place);
            let known = rows
                .iter_mut()
                .find(|row| (row.scene, row.view, &*row.place) == key);
            match known {
                Some(row) => row.bars.push((group, bar)),
                None => rows.push(PanelRow {
                    scene,
                    view,
                    place: place.clone(),
                    bars: vec![(group, bar)],
                }),
            }
        }
    }
    rows.retain(|row| row.groups().len() > 1);
    rows
}

impl PanelRow<'_> {
    /// The published figures that are drawn.
    pub fn figures(&self) -> impl Iterator<Item = &Published> {
        self.bars.iter().map(|(_, bar)| bar.figure)
    }

    /// Theirs and ours as bars, `y` upwards.
    pub fn bars(&self, label: &str, groups: Groups, y: &str) -> [Panel; 2] {
        let known = self.groups();
        let names: Vec<String> = known.iter().map(|group| groups.name(*group)).collect();
        let mut sides: [Vec<Series>; 2] = Default::default();
        for (group, bar) in &self.bars {
            let place = known.iter().position(|known| known == group);
            for (side, y) in sides.iter_mut().zip([bar.theirs, bar.ours]) {
                let x = place.unwrap_or(0) as f64;
                push(side, &bar.series, Mark::new(x, y));
            }
        }
        self.pair(label, sides, |title, series| Panel {
            title,
            kind: Kind::Bars(names.clone()),
            x: groups.axis().into(),
            y: y.into(),
            series,
        })
    }

    /// Theirs and ours against the pixels of viewports, as multiples of the smallest one's.
    pub fn growth(&self, label: &str, y: &str) -> [Panel; 2] {
        let mut sides: [Vec<Series>; 2] = Default::default();
        let mut first: Option<&Bar> = None;
        for group in self.groups() {
            for (_, bar) in self.bars.iter().filter(|(known, _)| *known == group) {
                let first = first.get_or_insert(bar);
                let times = [bar.theirs / first.theirs, bar.ours / first.ours];
                for (side, y) in sides.iter_mut().zip(times) {
                    let x = pixels(group) as f64;
                    push(side, &bar.series, Mark::new(x, y));
                }
            }
        }
        self.pair(label, sides, |title, series| Panel {
            title,
            kind: Kind::Growth,
            x: "pixels".into(),
            y: y.into(),
            series,
        })
    }

    /// Viewports or map sizes with a bar, the smallest first.
    fn groups(&self) -> Vec<[u32; 2]> {
        let groups = self.bars.iter().map(|(group, _)| (pixels(*group), *group));
        let groups: BTreeSet<(u64, [u32; 2])> = groups.collect();
        groups.into_iter().map(|(_, group)| group).collect()
    }

    fn pair(
        &self,
        label: &str,
        sides: [Vec<Series>; 2],
        panel: impl Fn(String, Vec<Series>) -> Panel,
    ) -> [Panel; 2] {
        let Self {
            scene, view, place, ..
        } = self;
        let title = |whose: &str| format!("{whose}: {scene}, {view}{place}");
        let [theirs, ours] = sides;
        [panel(title(label), theirs), panel(title("ours"), ours)]
    }
}

fn pixels([width, height]: [u32; 2]) -> u64 {
    u64::from(width) * u64::from(height)
}
