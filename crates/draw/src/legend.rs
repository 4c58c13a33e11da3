//! Legend of a chart, with only the signs that occur in it.

use crate::drawing::{Drawing, Kind, Material};
use crate::text::{self, SMALL};
use crate::words::{self, Unit};
use skiagraph_graph::Hazard;
use std::collections::{BTreeSet, HashMap, HashSet};

/// Signs that the legend explains, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Item {
    Write,
    Read,
    Both,
    Bar(Tint),
    Shared,
    Output,
    Note(Unit),
    Edge(Hazard),
    Implied,
}

/// Colour of a bar.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Tint {
    Texture,
    Buffer,
    Sampler,
    Given,
}

impl Tint {
    pub fn new(material: &Material) -> Self {
        match material.kind {
            _ if material.origin.is_given() => Self::Given,
            Kind::Texture => Self::Texture,
            Kind::Buffer | Kind::AccelerationStructure | Kind::CpuWork => Self::Buffer,
            Kind::Sampler => Self::Sampler,
        }
    }

    /// Returns the colour as SVG writes it, after Okabe and Ito, Color Universal Design (2008), for
    /// colour-blind readers.
    pub fn colour(self) -> &'static str {
        match self {
            Self::Texture => "#56b4e9",
            Self::Buffer => "#009e73",
            Self::Sampler => "#f0e442",
            Self::Given => "#999999",
        }
    }
}

/// Width of a sign with the space behind it, pixels.
pub(crate) const SIGN: f64 = 28.0;
const LINE: f64 = 20.0;

impl Item {
    /// The sign of a pass that reads and writes so.
    pub fn new(reads: bool, writes: bool) -> Self {
        match (reads, writes) {
            (true, true) => Self::Both,
            (false, true) => Self::Write,
            _ => Self::Read,
        }
    }

    pub fn text(self) -> &'static str {
        match self {
            Self::Write => "writes",
            Self::Read => "reads",
            Self::Both => "reads and writes",
            Self::Bar(Tint::Texture) => "texture, from first to last use",
            Self::Bar(Tint::Buffer) => "buffer",
            Self::Bar(Tint::Sampler) => "sampler",
            Self::Bar(Tint::Given) => "there before the frame",
            Self::Shared => "share one memory",
            Self::Output => "read back",
            Self::Note(unit) => unit.word(),
            Self::Edge(Hazard::ReadAfterWrite) => "reads what the upper one wrote",
            Self::Edge(Hazard::WriteAfterRead) => "overwrites what the upper one read",
            Self::Edge(Hazard::WriteAfterWrite) => "overwrites what the upper one wrote",
            Self::Implied => "thin: other edges imply it",
        }
    }
}

/// Returns the legend's items, each behind its position, and the height of the legend, in pixels.
/// Positions begin at `start`; lines are at most `room` wide. Marks and bars come first, edges on a
/// line of their own.
pub(crate) fn place(drawing: &Drawing, start: [f64; 2], room: f64) -> (Vec<([f64; 2], Item)>, f64) {
    let [left, top] = start;
    let mut at = start;
    let mut placed = Vec::new();
    let mut last = None;
    for item in items(drawing) {
        let width = SIGN + text::width(item.text(), SMALL) + 16.0;
        let is_edge = item >= Item::Edge(Hazard::ReadAfterWrite);
        let breaks = last.is_some_and(|last| last != is_edge) || at[0] + width > left + room;
        if breaks && at[0] > left {
            at = [left, at[1] + LINE];
        }
        placed.push((at, item));
        at[0] += width;
        last = Some(is_edge);
    }
    let height = if placed.is_empty() {
        0.0
    } else {
        at[1] + LINE - top
    };
    (placed, height)
}

fn items(drawing: &Drawing) -> BTreeSet<Item> {
    let mut items = BTreeSet::new();
    // A pass has one mark per material, whichever parts it reads and writes.
    let mut uses: HashMap<[&str; 2], (bool, bool)> = HashMap::new();
    let materials = drawing.by_name();
    for access in &drawing.accesses {
        if let Some((part, whole)) = access.part.as_ref().zip(materials.get(&*access.material)) {
            items.extend(words::narrowed(part, whole).map(|(unit, _)| Item::Note(unit)));
        }
        let (reads, writes) = uses.entry([&access.pass, &access.material]).or_default();
        (*reads, *writes) = (*reads || access.reads, *writes || access.writes);
    }
    items.extend(
        uses.into_values()
            .map(|(reads, writes)| Item::new(reads, writes)),
    );
    let mut memories = HashSet::new();
    for material in &drawing.materials {
        if material.lifetime.is_some() {
            items.insert(Item::Bar(Tint::new(material)));
        }
        if !material.outputs.is_empty() {
            items.insert(Item::Output);
        }
        if material
            .memory
            .is_some_and(|memory| !memories.insert(memory))
        {
            items.insert(Item::Shared);
        }
    }
    let live = drawing.passes.iter().filter(|pass| pass.position.is_some());
    let live: HashSet<&str> = live.map(|pass| pass.name.as_str()).collect();
    let edges = drawing.edges.iter();
    for edge in edges.filter(|edge| live.contains(&*edge.from) && live.contains(&*edge.to)) {
        items.extend(edge.hazard().map(Item::Edge));
        items.extend(edge.implied.then_some(Item::Implied));
    }
    items
}
