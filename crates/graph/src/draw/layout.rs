//! Where everything in the chart stands. Plain numbers, in pixels, so that tests can ask whether anything overlaps.

use super::{
    Access, Drawing, Edge, Hazard, Material, Pass,
    legend::{self, Item},
    text,
};
use std::collections::{BTreeMap, HashMap};

pub(super) const MARGIN: f64 = 20.0;
/// Size of names.
pub(super) const NAME: f64 = 12.5;
/// Size of everything beside names.
pub(super) const SMALL: f64 = 10.5;
/// Slant of the column heads, degrees: flat enough to be read, steep enough for two lines per column.
pub(super) const SLANT: f64 = 55.0;
pub(super) const COLUMN: f64 = 34.0;
const ROW: f64 = 26.0;
const LINE: f64 = 14.0;
/// Room between the last head and the first row.
const NECK: f64 = 16.0;
/// Characters of a name; longer ones are cut, and whole in their titles.
const MOST: usize = 36;
/// Rows from which on the column heads are too far away, and what begins in a row is named there too.
const FAR: usize = 12;

/// A rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Area {
    pub x: f64,
    pub y: f64,
    pub width: f64,
    pub height: f64,
}

/// A pass.
pub(super) struct Row<'a> {
    pub pass: &'a Pass,
    pub name: String,
    pub about: String,
    /// Why it is culled, in lines.
    pub reason: Vec<String>,
    pub band: Area,
    /// Where its name and its kind stand.
    pub label: Area,
    /// Height of its marks.
    pub middle: f64,
    /// Its last mark; a line leads there from its name.
    pub reach: Option<f64>,
    /// What begins to live here, to be written behind the last mark.
    pub begins: String,
}

/// A material.
pub(super) struct Column<'a> {
    pub material: &'a Material,
    pub name: String,
    pub detail: String,
    pub x: f64,
    /// Top and bottom of its lifetime.
    pub bar: Option<[f64; 2]>,
    /// Bottom of its lane: its last mark of any pass.
    pub end: f64,
}

/// What a pass does with a material.
pub(super) struct Mark {
    pub x: f64,
    pub y: f64,
    pub reads: bool,
    pub writes: bool,
    pub runs: bool,
    /// The part, if it is not the whole.
    pub note: String,
    pub title: String,
}

/// An edge.
pub(super) struct Arc<'a> {
    pub edge: &'a Edge,
    pub hazard: Hazard,
    pub from: f64,
    pub to: f64,
    /// How far it swings out to the left.
    pub swing: f64,
}

/// Columns that share memory.
pub(super) struct Group {
    pub from: f64,
    pub to: f64,
    pub title: String,
}

/// The chart.
pub(super) struct Layout<'a> {
    pub drawing: &'a Drawing,
    pub width: f64,
    pub height: f64,
    pub summary: String,
    pub legend: Vec<(f64, f64, Item)>,
    /// Bottom of the column heads.
    pub top: f64,
    /// Right ends of the arcs.
    pub spine: f64,
    pub names: f64,
    pub abouts: f64,
    pub lanes: f64,
    pub rows: Vec<Row<'a>>,
    pub columns: Vec<Column<'a>>,
    pub marks: Vec<Mark>,
    pub arcs: Vec<Arc<'a>>,
    pub groups: Vec<Group>,
    /// Height of the outputs' arrows.
    pub outputs: Option<f64>,
    /// Top of the passes that do not run.
    pub culled: Option<f64>,
}

impl<'a> Layout<'a> {
    pub fn new(drawing: &'a Drawing) -> Self {
        let mut live: Vec<&Pass> = drawing
            .passes
            .iter()
            .filter(|pass| pass.position.is_some())
            .collect();
        live.sort_by_key(|pass| pass.position);
        let culled: Vec<&Pass> = drawing
            .passes
            .iter()
            .filter(|pass| pass.position.is_none())
            .collect();
        let materials = order(drawing, &live);

        let place: HashMap<&str, usize> = live
            .iter()
            .enumerate()
            .map(|(index, pass)| (pass.name.as_str(), index))
            .collect();
        let span = |edge: &Edge| {
            Some((
                *place.get(edge.from.as_str())?,
                *place.get(edge.to.as_str())?,
            ))
        };
        let edges: Vec<(&Edge, usize, usize)> = drawing
            .edges
            .iter()
            .filter_map(|edge| span(edge).map(|(from, to)| (edge, from, to)))
            .collect();
        let longest = edges
            .iter()
            .map(|(_, from, to)| to.abs_diff(*from))
            .max()
            .unwrap_or(0) as f64;
        // Swings grow with the root, so that short edges stay apart and long ones stay on the page.
        let stretch = (150.0 / longest.max(1.0).sqrt()).min(13.0);
        let swing = |from: usize, to: usize| stretch * (to.abs_diff(from) as f64).sqrt();

        let spine = MARGIN + stretch * longest.sqrt() + 8.0;
        let number = text::width(&live.len().to_string(), SMALL);
        let names = spine + 8.0 + number + 6.0;
        let all = || live.iter().chain(&culled);
        let widest =
            |measure: &dyn Fn(&Pass) -> f64| all().map(|pass| measure(pass)).fold(0.0, f64::max);
        let abouts = names + widest(&|pass| text::bold(&text::cut(&pass.name, MOST), NAME)) + 12.0;
        let lanes = abouts + widest(&|pass| text::width(&about(pass), SMALL)) + 14.0;

        let heads: Vec<(String, String)> = materials
            .iter()
            .map(|material| {
                (
                    text::cut(&material.name, MOST),
                    text::cut(&text::detail(material), 2 * MOST),
                )
            })
            .collect();
        let head = |(name, detail): &(String, String)| {
            text::bold(name, NAME).max(text::width(detail, SMALL))
        };
        let (rise, run) = SLANT.to_radians().sin_cos();
        let x = |index: usize| lanes + COLUMN * (index as f64 + 0.5);
        let overhang = |(index, texts)| x(index) + head(texts) * run + SMALL;
        let right = heads
            .iter()
            .enumerate()
            .map(overhang)
            .fold(lanes + 40.0, f64::max);
        let width = (right + MARGIN).max(720.0);

        let (legend, legend_height) = legend::place(drawing, 66.0, width - 2.0 * MARGIN);
        let tallest = heads.iter().map(head).fold(0.0, f64::max);
        let top = 66.0 + legend_height + tallest * rise + 18.0;
        let mut layout = Self {
            drawing,
            width,
            height: 0.0,
            summary: summary(drawing, live.len()),
            legend,
            top,
            spine,
            names,
            abouts,
            lanes,
            rows: Vec::new(),
            columns: Vec::new(),
            marks: Vec::new(),
            arcs: Vec::new(),
            groups: Vec::new(),
            outputs: None,
            culled: None,
        };
        let mut y = top + NECK;
        for pass in &live {
            y = layout.row(pass, y);
        }
        let middles: Vec<f64> = layout.rows.iter().map(|row| row.middle).collect();
        if materials
            .iter()
            .any(|material| !material.outputs.is_empty())
        {
            layout.outputs = Some(y + 16.0);
            y += 34.0
                + materials
                    .iter()
                    .map(|material| text::width(&renamed(material), SMALL) * rise)
                    .fold(0.0, f64::max);
        }
        if !culled.is_empty() {
            layout.culled = Some(y + 8.0);
            y += 36.0;
        }
        for pass in &culled {
            y = layout.row(pass, y);
        }
        layout.height = y + MARGIN;
        for (index, (material, (name, detail))) in materials.iter().zip(heads).enumerate() {
            let bar = material.lifetime.and_then(|[first, last]| {
                let [first, last] = [*middles.get(first)?, *middles.get(last)?];
                let from = if material.origin.is_given() {
                    top + 4.0
                } else {
                    first
                };
                let to = match layout.outputs {
                    Some(outputs) if !material.outputs.is_empty() => outputs - 6.0,
                    _ => last,
                };
                Some([from, to])
            });
            let end = bar.map_or(top, |[_, end]| end);
            layout.columns.push(Column {
                material,
                name,
                detail,
                x: x(index),
                bar,
                end,
            });
        }
        layout.place_marks();
        layout.name_beginnings(live.len());
        layout.arcs = edges
            .into_iter()
            .filter_map(|(edge, from, to)| {
                Some(Arc {
                    edge,
                    hazard: edge.because.iter().map(|reason| reason.hazard).min()?,
                    from: middles[from],
                    to: middles[to],
                    swing: swing(from, to),
                })
            })
            .collect();
        // The more telling ones on top: first the implied, last what is read.
        layout
            .arcs
            .sort_by_key(|arc| (!arc.edge.implied, std::cmp::Reverse(arc.hazard)));
        layout.group();
        layout
    }

    /// Adds a row at `y`; returns its bottom.
    fn row(&mut self, pass: &'a Pass, y: f64) -> f64 {
        let room = self.width - MARGIN - self.names;
        let reason = pass
            .culled
            .as_deref()
            .map_or(Vec::new(), |reason| text::wrap(reason, SMALL, room));
        let height = ROW + LINE * reason.len() as f64;
        self.rows.push(Row {
            pass,
            name: text::cut(&pass.name, MOST),
            about: about(pass),
            reason,
            band: Area {
                x: MARGIN / 2.0,
                y,
                width: self.width - MARGIN,
                height,
            },
            label: Area {
                x: self.names,
                y: y + 4.0,
                width: self.lanes - self.names,
                height: height - 8.0,
            },
            middle: y + ROW / 2.0,
            reach: None,
            begins: String::new(),
        });
        y + height
    }

    /// One mark per pass and material, whatever parts the pass touches.
    fn place_marks(&mut self) {
        let rows: HashMap<&str, usize> = self
            .rows
            .iter()
            .enumerate()
            .map(|(index, row)| (row.pass.name.as_str(), index))
            .collect();
        let columns: HashMap<&str, usize> = self
            .columns
            .iter()
            .enumerate()
            .map(|(index, column)| (column.material.name.as_str(), index))
            .collect();
        let mut uses: BTreeMap<(usize, usize), Vec<&Access>> = BTreeMap::new();
        for access in &self.drawing.accesses {
            if let (Some(&row), Some(&column)) = (
                rows.get(access.pass.as_str()),
                columns.get(access.material.as_str()),
            ) {
                uses.entry((row, column)).or_default().push(access);
            }
        }
        for ((row, column), accesses) in uses {
            let (row, column) = (&mut self.rows[row], &mut self.columns[column]);
            row.reach = Some(row.reach.unwrap_or(0.0).max(column.x));
            column.end = column.end.max(row.middle);
            let material = column.material;
            let clause = |access: &&Access| {
                let part = access
                    .part
                    .as_ref()
                    .map(|part| format!(" ({})", text::part(part, material)));
                format!("{}{}", text::verb(access), part.unwrap_or_default())
            };
            let clauses: Vec<String> = accesses.iter().map(clause).collect();
            self.marks.push(Mark {
                x: column.x,
                y: row.middle,
                reads: accesses.iter().any(|access| access.reads),
                writes: accesses.iter().any(|access| access.writes),
                runs: row.pass.position.is_some(),
                note: note(&accesses, material),
                title: format!("{} {} {}", row.pass.name, clauses.join(", "), material.name),
            });
        }
    }

    /// Names what begins to live in a row behind its last mark, where nothing is in the way and the page has room.
    fn name_beginnings(&mut self, live: usize) {
        if live <= FAR {
            return;
        }
        for (position, row) in self.rows.iter_mut().enumerate().take(live) {
            let begins = |column: &&Column<'_>| {
                column
                    .material
                    .lifetime
                    .is_some_and(|[first, _]| first == position)
                    && !column.material.origin.is_given()
            };
            let names: Vec<&str> = self
                .columns
                .iter()
                .filter(begins)
                .map(|column| column.material.name.as_str())
                .collect();
            let Some(reach) = row.reach.filter(|_| !names.is_empty()) else {
                continue;
            };
            let names = text::cut(&names.join(", "), MOST);
            let end = reach + 12.0 + text::width(&names, SMALL);
            let crossed = self.columns.iter().any(|column| {
                column.x > reach
                    && column.x - COLUMN < end
                    && column
                        .bar
                        .is_some_and(|[from, to]| from <= row.middle && row.middle <= to)
            });
            if !crossed && end < self.width {
                row.begins = names;
            }
        }
    }

    /// Brackets over the columns that share memory; they stand side by side.
    fn group(&mut self) {
        let mut members: BTreeMap<usize, Vec<&Column<'_>>> = BTreeMap::new();
        for column in &self.columns {
            if let Some(memory) = column.material.memory {
                members.entry(memory).or_default().push(column);
            }
        }
        for columns in members.into_values().filter(|columns| columns.len() > 1) {
            let names: Vec<&str> = columns
                .iter()
                .map(|column| column.material.name.as_str())
                .collect();
            let bytes = columns
                .iter()
                .filter_map(|column| column.material.bytes)
                .max()
                .unwrap_or(0);
            self.groups.push(Group {
                from: columns[0].x,
                to: columns[columns.len() - 1].x,
                title: format!("{} share {}", names.join(", "), text::bytes(bytes)),
            });
        }
    }
}

/// The materials that any pass touches: what is there before the frame, then by first use, those of one memory side by side, then
/// those that only passes touch that do not run.
fn order<'a>(drawing: &'a Drawing, live: &[&Pass]) -> Vec<&'a Material> {
    let touched: std::collections::HashSet<&str> = drawing
        .accesses
        .iter()
        .map(|access| access.material.as_str())
        .collect();
    let first = |material: &Material| material.lifetime.map_or(live.len(), |[first, _]| first);
    let mut opened: HashMap<usize, usize> = HashMap::new();
    for material in &drawing.materials {
        if let Some(memory) = material.memory {
            let known = opened.entry(memory).or_insert(usize::MAX);
            *known = first(material).min(*known);
        }
    }
    let mut materials: Vec<&Material> = drawing
        .materials
        .iter()
        .filter(|material| touched.contains(material.name.as_str()) || !material.outputs.is_empty())
        .collect();
    materials.sort_by_key(|material| {
        let first = first(material);
        let opened = material
            .memory
            .and_then(|memory| opened.get(&memory))
            .copied()
            .unwrap_or(first);
        (
            material.lifetime.is_none(),
            !material.origin.is_given(),
            opened,
            material.memory,
            first,
        )
    });
    materials
}

/// Kind, shaders and condition of a pass. A shader of the pass's own name is what everybody expects.
fn about(pass: &Pass) -> String {
    let stem = |path: &str| {
        let file = path.rsplit('/').next().unwrap_or(path);
        file.strip_suffix(".wgsl").unwrap_or(file).to_owned()
    };
    let own = pass.name.rsplit('.').next().unwrap_or(&pass.name);
    let shaders: Vec<String> = pass
        .shaders
        .iter()
        .map(|path| stem(path))
        .filter(|shader| shader != own)
        .collect();
    let mut parts = vec![pass.kind.clone()];
    if !shaders.is_empty() {
        parts.push(shaders.join(", "));
    }
    parts.extend(pass.run.as_ref().map(|run| format!("run: {run}")));
    text::cut(&parts.join(" · "), MOST)
}

/// Names of the outputs that are not called like their material.
pub(super) fn renamed(material: &Material) -> String {
    let names: Vec<&str> = material
        .outputs
        .iter()
        .map(String::as_str)
        .filter(|name| *name != material.name)
        .collect();
    text::cut(&names.join(", "), MOST)
}

/// `m0→m1` for a pass that reads one mip and writes the next.
fn note(accesses: &[&Access], material: &Material) -> String {
    let short = |access: &Access| {
        let part = access.part.as_ref()?;
        let range = |letter: char, range: &std::ops::Range<u32>| match range.len() {
            1 => format!("{letter}{}", range.start),
            _ => format!("{letter}{}–{}", range.start, range.end.saturating_sub(1)),
        };
        let mips = (material.mips > 1).then(|| range('m', &part.mips));
        let layers = (material.layers > 1).then(|| range('l', &part.layers));
        Some([mips, layers].into_iter().flatten().collect::<String>())
    };
    let read = accesses
        .iter()
        .find(|access| access.reads && !access.writes)
        .and_then(|access| short(access));
    let written: Vec<String> = accesses
        .iter()
        .filter(|access| access.writes)
        .filter_map(|access| short(access))
        .collect();
    let written = match &written[..] {
        [] => None,
        [one] => Some(one.clone()),
        [first, ..] => Some(format!("{first}…")),
    };
    match (read, written) {
        (Some(read), Some(written)) => format!("{read}→{written}"),
        (read, written) => read.or(written).unwrap_or_default(),
    }
}

fn summary(drawing: &Drawing, live: usize) -> String {
    let made = drawing
        .materials
        .iter()
        .filter(|material| material.lifetime.is_some() && !material.origin.is_given())
        .count();
    let mut parts = vec![format!(
        "{} in order of execution",
        text::plural(live, "pass", "passes")
    )];
    let culled = drawing.passes.len() - live;
    if culled > 0 {
        parts.push(format!("{culled} culled"));
    }
    parts.push(format!(
        "{}, {}",
        text::plural(made, "material", "materials"),
        text::bytes(drawing.memory_bytes)
    ));
    if drawing.saved_bytes > 0 {
        parts.push(format!(
            "{} saved by sharing",
            text::bytes(drawing.saved_bytes)
        ));
    }
    parts.join(" · ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::{Kind, Origin, Reason};

    /// A chain of passes, each of which reads what the one above wrote; every third does not run, and all even materials share.
    fn chain(passes: usize) -> Drawing {
        let mut drawing = Drawing::default();
        let mut position = 0;
        for index in 0..passes {
            let runs = index % 3 != 2;
            drawing.passes.push(Pass {
                name: format!("pass_{index}_{}", "x".repeat(index % 50)),
                kind: "Compute".into(),
                shaders: vec!["shaders/work.wgsl".into()],
                file: "graph.ron".into(),
                line: index,
                position: runs.then_some(position),
                culled: (!runs)
                    .then(|| "nothing that an output needs reads what it writes ".repeat(6)),
                run: None,
            });
            drawing.materials.push(Material {
                name: format!("material_{index}"),
                kind: Kind::Buffer,
                origin: Origin::Declared,
                format: None,
                size: None,
                mips: 1,
                layers: 1,
                bytes: Some(1 << 20),
                lifetime: runs.then_some([position, position]),
                outputs: Vec::new(),
                memory: (runs && index % 2 == 0).then_some(0),
            });
            drawing.accesses.push(Access {
                pass: drawing.passes[index].name.clone(),
                material: format!("material_{index}"),
                reads: false,
                writes: true,
                part: None,
            });
            if index > 0 {
                drawing.edges.push(Edge {
                    from: drawing.passes[index - 1].name.clone(),
                    to: drawing.passes[index].name.clone(),
                    because: vec![Reason {
                        hazard: Hazard::ReadAfterWrite,
                        materials: Vec::new(),
                    }],
                    implied: false,
                });
            }
            position += usize::from(runs);
        }
        drawing
    }

    fn overlap(a: &Area, b: &Area) -> bool {
        a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height
    }

    #[test]
    fn no_label_meets_another_and_all_stand_on_the_page() {
        for passes in [1, 5, 40, 200] {
            let drawing = chain(passes);
            let layout = Layout::new(&drawing);
            assert_eq!(layout.rows.len(), passes);
            for (index, row) in layout.rows.iter().enumerate() {
                for other in &layout.rows[..index] {
                    assert!(!overlap(&row.band, &other.band) && !overlap(&row.label, &other.label));
                }
                let name = text::bold(&row.name, NAME);
                assert!(
                    layout.names + name < layout.abouts,
                    "{} runs into its kind",
                    row.name
                );
                assert!(
                    layout.abouts + text::width(&row.about, SMALL) < layout.lanes,
                    "{}",
                    row.about
                );
                assert!(row.band.y + row.band.height < layout.height);
                assert!(row.band.y > layout.top, "below the heads");
                let lines = row
                    .reason
                    .iter()
                    .map(|line| layout.names + text::width(line, SMALL));
                assert!(lines.fold(0.0, f64::max) < layout.width, "{:?}", row.reason);
            }
            for pair in layout.columns.windows(2) {
                assert!(
                    pair[1].x - pair[0].x >= COLUMN - 0.01,
                    "columns stand apart"
                );
            }
            assert!(layout.legend.iter().all(|(_, y, _)| *y < layout.top));
            assert!(layout.arcs.iter().all(|arc| layout.spine - arc.swing > 0.0));
        }
    }

    #[test]
    fn what_shares_memory_stands_side_by_side_and_what_is_not_made_last() {
        let drawing = chain(12);
        let layout = Layout::new(&drawing);
        let names: Vec<&str> = layout
            .columns
            .iter()
            .map(|column| column.material.name.as_str())
            .collect();
        let order = [0, 4, 6, 10, 1, 3, 7, 9, 2, 5, 8, 11].map(|index| format!("material_{index}"));
        assert_eq!(names, order);
        let [group] = &layout.groups[..] else {
            panic!("one group")
        };
        assert_eq!(
            (group.from, group.to),
            (layout.columns[0].x, layout.columns[3].x)
        );
        let title = "material_0, material_4, material_6, material_10 share 1.0 MiB";
        assert_eq!(group.title, title);
    }

    #[test]
    fn a_name_that_nothing_declares_is_left_out() {
        let mut drawing = chain(4);
        drawing.materials.clear();
        drawing.passes.remove(1);
        let layout = Layout::new(&drawing);
        assert!(layout.columns.is_empty() && layout.marks.is_empty());
        // 0 → 1 has lost its end, 1 → 2 and 2 → 3 have an end that does not run.
        assert!(layout.arcs.is_empty());
    }

    #[test]
    fn a_mark_names_the_mips_it_reads_and_writes() {
        let mut drawing = chain(1);
        drawing.materials[0].mips = 3;
        let part = |mips: std::ops::Range<u32>| Some(crate::draw::Part { mips, layers: 0..1 });
        drawing.accesses[0].part = part(2..3);
        let read = Access {
            reads: true,
            writes: false,
            part: part(0..2),
            ..drawing.accesses[0].clone()
        };
        drawing.accesses.push(read);
        let layout = Layout::new(&drawing);
        let [mark] = &layout.marks[..] else {
            panic!("one mark per pass and material")
        };
        assert_eq!(mark.note, "m0–1→m2");
        assert_eq!(
            mark.title,
            "pass_0_ writes (mip 2), reads (mips 0–1) material_0"
        );
    }

    /// In a long chart what begins in a row is named there; a name that would cross a bar is not written.
    #[test]
    fn beginnings_are_named_where_nothing_is_in_the_way() {
        let mut drawing = chain(60);
        drawing
            .materials
            .iter_mut()
            .for_each(|material| material.memory = None);
        let begins = |drawing: &Drawing| {
            let layout = Layout::new(drawing);
            layout
                .rows
                .iter()
                .map(|row| row.begins.clone())
                .collect::<Vec<_>>()
        };
        assert_eq!(begins(&drawing)[2], "material_3");
        assert!(
            begins(&chain(9)).iter().all(String::is_empty),
            "a short chart has its heads in sight"
        );
        // material_6 stands beside material_0, whose memory it takes over, and material_1 lives on to its right.
        drawing.materials[0].memory = Some(0);
        drawing.materials[6].memory = Some(0);
        assert_eq!(begins(&drawing)[4], "material_6");
        drawing.materials[1].lifetime = Some([1, 30]);
        assert_eq!(begins(&drawing)[4], "");
    }
}
