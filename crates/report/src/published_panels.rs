//! Builds pairs of chart panels (coordinate systems): published figures on the left, measured ones
//! on the right.

use crate::charts::push;
use skiagraph_chart::{Kind, Mark, Panel, Series};
use skiagraph_compare::lists::find_or_push;
use skiagraph_compare::records::columns::figure;
use skiagraph_compare::records::figure::{Case, Clocks};
use skiagraph_compare::records::results::{Published, Results, Run};
use skiagraph_compare::wording::size;
use std::collections::BTreeSet;

/// Returns the runs of `results` that have measurements. They may have published figures
/// ([`Run::published`]).
pub fn cells(results: &Results) -> impl Iterator<Item = Case<'_>> {
    let clocks = Clocks::new(results);
    let runs = results.runs.iter().filter(|run| run.measured.is_some());
    runs.map(move |run| clocks.case(run))
}

/// Returns the run by whose figure of `quantity` the figure of a run is divided, as times of
/// different machines are only comparable as ratios. It is the first of the same view and viewport,
/// of a method without a shadow map, that has a published figure of the quantity. Returns `None` if
/// there is no such run.
pub fn whole<'a>(cell: &Case<'a>, quantity: &str) -> Option<&'a Run> {
    let Run { view, viewport, .. } = cell.run;
    let mut runs = cell.results.runs.iter();
    runs.find(|run| {
        (&run.view, &run.viewport, run.map_size) == (view, viewport, None)
            && published(run, quantity).is_some()
    })
}

/// Returns the published figure of a run for the quantity with this name, such as `wrong_percent`;
/// `None` if there is none.
pub fn published<'a>(run: &'a Run, quantity: &str) -> Option<&'a Published> {
    let mut figures = run.published.iter();
    figures.find(|figure| figure.quantity == quantity)
}

/// Grouping of the bars in panels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Groups {
    /// A group of bars for each viewport, a pair of panels for each map size.
    Viewports,
    /// A group of bars for each map size, a pair of panels for each viewport.
    Maps,
}

impl Groups {
    /// Returns the plural noun for the groups: `viewports` or `map sizes`.
    pub fn plural(self) -> &'static str {
        match self {
            Self::Viewports => "viewports",
            Self::Maps => "map sizes",
        }
    }

    /// Returns the name of the axis along which the groups stand: `viewport` or `map`.
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

/// A published and a measured figure of the same quantity and run, each drawn as a bar.
pub struct Bar<'a> {
    /// Name of the bar's series, which is the preset.
    pub series: String,
    /// The published figure as printed.
    pub figure: &'a Published,
    /// Height of the published bar: the published figure divided by `their_whole` of [`Bar::new`].
    pub theirs: f64,
    /// Height of the measured bar: the measured figure divided by `our_whole` of [`Bar::new`].
    pub ours: f64,
}

impl<'a> Bar<'a> {
    /// Returns the bars of a quantity for a run. The published figure is divided by `their_whole`,
    /// the measured one by `our_whole`; 1 leaves a figure as it is. Returns `None` if the figure is
    /// not both published and measured, or a quotient is not finite.
    pub fn new(
        cell: &Case<'a>,
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

/// Content of one pair of panels: the bars of one scene and view, and of one map size if bars are
/// grouped by viewport, or one viewport if they are grouped by map size.
pub struct PanelRow<'a> {
    /// Name of the scene.
    pub scene: &'a str,
    /// Name of the view.
    pub view: &'a str,
    /// The viewport, or the map size if groups are viewports, as text for the title.
    place: String,
    bars: Vec<([u32; 2], Bar<'a>)>,
}

/// Groups the runs of `cells` into pairs of panels, and returns the contents of the pairs that have
/// at least two groups of bars. `bar` returns the bar of a run; `None` leaves the run out.
pub fn rows<'a>(
    cells: &'a [Case<'a>],
    groups: Groups,
    bar: impl Fn(&'a Case<'a>) -> Option<Bar<'a>>,
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
        let (scene, view) = (&*cell.results.scene.name, cell.run.view.as_str());
        if let Some(bar) = bar(cell) {
            let key = (scene, view, &*place);
            let is_of = |row: &PanelRow| (row.scene, row.view, &*row.place) == key;
            let row = find_or_push(&mut rows, is_of, || PanelRow {
                scene,
                view,
                place: place.clone(),
                bars: Vec::new(),
            });
            row.bars.push((group, bar));
        }
    }
    rows.retain(|row| row.groups().len() > 1);
    rows
}

impl PanelRow<'_> {
    /// Returns the published figures of all bars.
    pub fn figures(&self) -> impl Iterator<Item = &Published> {
        self.bars.iter().map(|(_, bar)| bar.figure)
    }

    /// Returns two panels of bars, grouped by `groups`: the published figures, titled with `label`,
    /// and the measured ones. `y` is the label of the vertical axis.
    pub fn bars(&self, label: &str, groups: Groups, y: &str) -> [Panel; 2] {
        let bar_groups = self.groups();
        let names: Vec<String> = bar_groups.iter().map(|group| groups.name(*group)).collect();
        let mut sides: [Vec<Series>; 2] = Default::default();
        for (group, bar) in &self.bars {
            let place = bar_groups.iter().position(|other| other == group);
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

    /// Returns two panels of lines over the pixels of the viewports: the published figures, titled
    /// with `label`, and the measured ones. Values are multiples of the smallest viewport's. `y` is
    /// the label of the vertical axis.
    pub fn growth(&self, label: &str, y: &str) -> [Panel; 2] {
        let mut sides: [Vec<Series>; 2] = Default::default();
        let mut first: Option<&Bar> = None;
        for group in self.groups() {
            for (_, bar) in self.bars.iter().filter(|(other, _)| *other == group) {
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
