//! Names the figures that are missing in charts, as they are only published or only measured.

use crate::published_panels::{Groups, PanelRow};
use itertools::Itertools;
use skiagraph_compare::lists::entry;
use skiagraph_compare::records::figure::Case;
use skiagraph_compare::records::published_row::Row;
use skiagraph_compare::wording::size;
use std::collections::BTreeSet;

/// Returns a line that names the scenes and views of `cells` that a drawn chart does not show;
/// `None` if it shows all. `cells` are all measured runs, `chart` is the chart's name, `drawn` are
/// its pairs of panels, and `groups` is the grouping of its bars.
pub fn views_left_out(
    cells: &[Case],
    chart: &str,
    drawn: &[PanelRow],
    groups: Groups,
) -> Option<String> {
    let measured: BTreeSet<String> = cells
        .iter()
        .map(|cell| format!("{} {}", cell.results.scene.name, cell.run.view))
        .collect();
    let drawn = drawn
        .iter()
        .map(|row| format!("{} {}", row.scene, row.view));
    let lacking: Vec<String> = (&measured - &drawn.collect()).into_iter().collect();
    if lacking.is_empty() {
        return None;
    }
    Some(format!(
        "not in {chart}: {}: no two {} of which there are figures on both sides",
        lacking.join(", "),
        groups.plural()
    ))
}

/// Returns a line for each scene that is only published or only measured, and a line for each other
/// scene with the views, viewports, map sizes and presets that are. `cells` are the measured runs,
/// `rows` the published figures, and `label` names the publication.
pub fn without_counterpart<'a>(
    cells: &[Case],
    rows: impl Iterator<Item = &'a Row>,
    label: &str,
) -> Vec<String> {
    let mut ours: Vec<(&str, Sides)> = Vec::new();
    let mut theirs: Vec<(&str, Sides)> = Vec::new();
    for cell in cells {
        let run = cell.run;
        let sides = entry(&mut ours, &*cell.results.scene.name);
        sides.add(&run.view, run.viewport, run.map_size, &run.preset);
    }
    for row in rows {
        let (scene, view, viewport, map, preset, _) = row.key();
        let is_ours = |name: &String| {
            let mut own = cells.iter().filter(|cell| cell.results.scene.name == scene);
            own.any(|cell| cell.run.preset == *name)
        };
        // One of several presets is enough.
        let is_chosen = if row.named.iter().any(is_ours) {
            is_ours(&row.preset)
        } else {
            row.named.first() == Some(&row.preset)
        };
        if !preset.is_empty() && is_chosen {
            entry(&mut theirs, scene).add(view, viewport, map, preset);
        }
    }
    let find = |scenes: &[(&str, Sides)], scene: &str| {
        let pair = scenes.iter().find(|(name, _)| *name == scene);
        pair.map(|(_, sides)| sides.clone())
    };
    let mut lines = Vec::new();
    for (scene, sides) in &ours {
        lines.extend(match find(&theirs, scene) {
            None => Some(format!("not drawn: {scene}: {label} has no figures of it")),
            Some(there) => sides.lacking(&there).map(|lacking| {
                format!("not drawn, of our {scene}: {lacking}: {label} has no figures")
            }),
        });
    }
    for (scene, sides) in &theirs {
        lines.extend(match find(&ours, scene) {
            None => Some(format!("not drawn: {label}'s {scene}: no results of it")),
            Some(measured) => sides
                .lacking(&measured)
                .map(|lacking| format!("not drawn, of {label}'s {scene}: {lacking}: no results")),
        });
    }
    lines
}

/// Figures that one side has of a scene.
#[derive(Clone, Default)]
struct Sides {
    views: BTreeSet<String>,
    viewports: BTreeSet<[u32; 2]>,
    maps: BTreeSet<u32>,
    presets: BTreeSet<String>,
}

impl Sides {
    fn add(&mut self, view: &str, viewport: [u32; 2], map: Option<u32>, preset: &str) {
        self.views.insert(view.to_owned());
        self.viewports.insert(viewport);
        self.maps.extend(map);
        self.presets.insert(preset.to_owned());
    }

    /// Says what the other side lacks, in words.
    fn lacking(&self, other: &Self) -> Option<String> {
        let viewports = self.viewports.difference(&other.viewports);
        let maps = self.maps.difference(&other.maps);
        let kinds = [
            ("view", self.views.difference(&other.views).join(", ")),
            ("viewport", viewports.map(|it| size(*it)).join(", ")),
            ("map", maps.map(|map| format!("{map}²")).join(", ")),
            ("preset", self.presets.difference(&other.presets).join(", ")),
        ];
        let kinds = kinds.iter().filter(|(_, lacking)| !lacking.is_empty());
        let words = kinds
            .map(|(kind, lacking)| format!("{kind} {lacking}"))
            .join("; ");
        (!words.is_empty()).then_some(words)
    }
}
