//! What the signs of a chart mean; only those that occur in it.

use super::{
    Drawing, Hazard, Kind, Origin,
    layout::{MARGIN, SMALL},
    text,
};
use std::collections::HashMap;

/// A sign that is explained.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Item {
    Write,
    Read,
    Both,
    Bar(Tint),
    Shared,
    Output,
    Edge(Hazard),
    Implied,
}

/// Colour of a bar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Tint {
    Texture,
    Buffer,
    Sampler,
    Given,
}

impl Tint {
    pub fn of(kind: Kind, origin: Origin) -> Self {
        match kind {
            _ if origin.is_given() => Self::Given,
            Kind::Texture => Self::Texture,
            Kind::Buffer => Self::Buffer,
            Kind::Sampler => Self::Sampler,
        }
    }

    /// After Okabe and Ito, Color Universal Design (2008): told apart by every kind of sight.
    pub fn colour(self) -> &'static str {
        match self {
            Self::Texture => "#56b4e9",
            Self::Buffer => "#009e73",
            Self::Sampler => "#f0e442",
            Self::Given => "#999999",
        }
    }
}

/// Width of a sign with the room behind it.
pub(super) const SIGN: f64 = 28.0;
const LINE: f64 = 20.0;

impl Item {
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
            Self::Edge(Hazard::ReadAfterWrite) => "reads what the upper one wrote",
            Self::Edge(Hazard::WriteAfterRead) => "overwrites what the upper one read",
            Self::Edge(Hazard::WriteAfterWrite) => "overwrites what the upper one wrote",
            Self::Implied => "thin: other edges imply it",
        }
    }
}

/// The items with their places in lines no longer than `room`, and the height of all of them.
pub(super) fn place(drawing: &Drawing, top: f64, room: f64) -> (Vec<(f64, f64, Item)>, f64) {
    let (mut x, mut y) = (MARGIN, top);
    let mut placed = Vec::new();
    for line in items(drawing) {
        for item in line {
            let width = SIGN + text::width(item.text(), SMALL) + 16.0;
            if x > MARGIN && x + width > MARGIN + room {
                (x, y) = (MARGIN, y + LINE);
            }
            placed.push((x, y, item));
            x += width;
        }
        if x > MARGIN {
            (x, y) = (MARGIN, y + LINE);
        }
    }
    (placed, y - top)
}

/// Marks and bars in the first line, edges in the second.
fn items(drawing: &Drawing) -> [Vec<Item>; 2] {
    // A pass has one mark per material, whichever parts it reads and writes.
    let mut uses: HashMap<(&str, &str), (bool, bool)> = HashMap::new();
    for access in &drawing.accesses {
        let (reads, writes) = uses.entry((&access.pass, &access.material)).or_default();
        (*reads, *writes) = (*reads || access.reads, *writes || access.writes);
    }
    let access = |reads, writes| uses.values().any(|of_one| *of_one == (reads, writes));
    let bar = |tint| {
        let lives = |material: &&super::Material| material.lifetime.is_some();
        drawing
            .materials
            .iter()
            .filter(lives)
            .any(|material| Tint::of(material.kind, material.origin) == tint)
    };
    let shares = |index: usize| {
        let memory = drawing.materials[index].memory;
        memory.is_some()
            && drawing.materials[..index]
                .iter()
                .any(|other| other.memory == memory)
    };
    let live = |name: &str| {
        drawing
            .passes
            .iter()
            .any(|pass| pass.position.is_some() && pass.name == name)
    };
    let edge = |hazard| {
        let leads = |edge: &&super::Edge| {
            edge.because.iter().map(|reason| reason.hazard).min() == Some(hazard)
        };
        drawing
            .edges
            .iter()
            .filter(leads)
            .any(|edge| live(&edge.from) && live(&edge.to))
    };
    let signs = [
        (Item::Write, access(false, true)),
        (Item::Read, access(true, false)),
        (Item::Both, access(true, true)),
        (Item::Bar(Tint::Texture), bar(Tint::Texture)),
        (Item::Bar(Tint::Buffer), bar(Tint::Buffer)),
        (Item::Bar(Tint::Sampler), bar(Tint::Sampler)),
        (Item::Bar(Tint::Given), bar(Tint::Given)),
        (Item::Shared, (0..drawing.materials.len()).any(shares)),
        (
            Item::Output,
            drawing
                .materials
                .iter()
                .any(|material| !material.outputs.is_empty()),
        ),
    ];
    let hazards = [
        Hazard::ReadAfterWrite,
        Hazard::WriteAfterRead,
        Hazard::WriteAfterWrite,
    ];
    let edges = hazards.map(|hazard| (Item::Edge(hazard), edge(hazard)));
    let implied = (Item::Implied, drawing.edges.iter().any(|edge| edge.implied));
    let present = |(item, present): (Item, bool)| present.then_some(item);
    [
        signs.into_iter().filter_map(present).collect(),
        edges
            .into_iter()
            .chain([implied])
            .filter_map(present)
            .collect(),
    ]
}
