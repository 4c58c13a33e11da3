//! Where things stand in charts of plans made by hand.

use crate::{
    chart::{Area, BESIDE, COLUMN},
    drawing::{Access, Aspect, Drawing, Edge, Kind, Material, Origin, Part, Pass, Reason},
    layout::chart,
    legend::Item,
    text::{self, NOTE, SMALL},
    words::{Label, Unit},
};
use skiagraph_graph::Hazard;

/// A chain of passes, each of which reads what the one above wrote; every third does not run, and
/// all even materials share.
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
            culled: (!runs).then(|| "nothing that an output needs reads what it writes ".repeat(6)),
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
            is_3d: false,
            samples: 1,
            versions: 1,
            bytes: Some(1 << 20),
            lifetime: runs.then_some([position, position]),
            outputs: Vec::new(),
            memory: (runs && index % 2 == 0).then_some(0),
            alone: None,
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
        let chart = chart(&drawing);
        assert_eq!(chart.rows.len(), passes);
        for (index, row) in chart.rows.iter().enumerate() {
            for other in &chart.rows[..index] {
                assert!(!overlap(&row.band, &other.band) && !overlap(&row.label, &other.label));
            }
            let name = row.name.width();
            assert!(
                chart.names + name < chart.abouts,
                "{:?} runs into its kind",
                row.name
            );
            assert!(
                chart.abouts + text::width(&row.about, SMALL) < chart.lanes,
                "{}",
                row.about
            );
            assert!(row.band.y + row.band.height < chart.height);
            assert!(row.band.y > chart.top, "below the heads");
            let lines = row
                .reason
                .iter()
                .map(|line| chart.names + text::width(line, SMALL));
            assert!(lines.fold(0.0, f64::max) < chart.width, "{:?}", row.reason);
        }
        for pair in chart.columns.windows(2) {
            assert!(
                pair[1].x - pair[0].x >= COLUMN - 0.01,
                "columns stand apart"
            );
        }
        assert!(chart.legend.iter().all(|([_, y], _)| *y < chart.top));
        assert!(chart.arcs.iter().all(|arc| chart.spine - arc.swing > 0.0));
    }
}

#[test]
fn what_shares_memory_stands_side_by_side_and_what_is_not_made_last() {
    let drawing = chain(12);
    let chart = chart(&drawing);
    let names: Vec<&str> = chart
        .columns
        .iter()
        .map(|column| column.material.name.as_str())
        .collect();
    let order = [0, 4, 6, 10, 1, 3, 7, 9, 2, 5, 8, 11].map(|index| format!("material_{index}"));
    assert_eq!(names, order);
    let [group] = &chart.groups[..] else {
        panic!("one group")
    };
    assert_eq!(
        (group.from, group.to),
        (chart.columns[0].x, chart.columns[3].x)
    );
    let title = "material_0, material_4, material_6, material_10 share 1.0 MiB";
    assert_eq!(group.title, title);
}

#[test]
fn a_name_that_nothing_declares_is_left_out() {
    let mut drawing = chain(4);
    drawing.materials.clear();
    drawing.passes.remove(1);
    let chart = chart(&drawing);
    assert!(chart.columns.is_empty() && chart.marks.is_empty());
    // 0 → 1 has lost its end, 1 → 2 and 2 → 3 have an end that does not run.
    assert!(chart.arcs.is_empty());
}

#[test]
fn a_mark_names_the_mips_it_reads_and_writes() {
    let mut drawing = chain(1);
    drawing.materials[0].mips = 3;
    let part = |mips: std::ops::Range<u32>| {
        Some(Part {
            mips: Some(mips),
            ..Part::default()
        })
    };
    drawing.accesses[0].part = part(2..3);
    let read = Access {
        reads: true,
        writes: false,
        part: part(0..2),
        ..drawing.accesses[0].clone()
    };
    drawing.accesses.push(read);
    let chart = chart(&drawing);
    let [mark] = &chart.marks[..] else {
        panic!("one mark per pass and material")
    };
    assert_eq!(mark.note, "m0–1→m2");
    let both = |(_, item): &([f64; 2], Item)| *item == Item::Both;
    assert!(chart.legend.iter().any(both), "the sign is explained");
    assert_eq!(
        mark.title,
        "pass_0_ writes (mip 2), reads (mips 0–1) material_0"
    );
}

/// Slices of a 3D texture, beside depth and stencil of another texture: notes have room, and the
/// legend explains them.
#[test]
fn notes_do_not_run_into_the_next_column() {
    let mut drawing = chain(2);
    for (name, size) in [("fog", 3), ("volumes", 1)] {
        drawing.materials.push(Material {
            name: name.to_owned(),
            kind: Kind::Texture,
            layers: size,
            is_3d: size > 1,
            ..drawing.materials[0].clone()
        });
    }
    let part = |layers, aspect| {
        Some(Part {
            layers,
            aspect,
            ..Part::default()
        })
    };
    let parts = [
        ("fog", part(Some(0..2), None)),
        ("volumes", part(None, Some(Aspect::Depth))),
        ("volumes", part(None, Some(Aspect::Stencil))),
    ];
    for (material, part) in parts {
        drawing.accesses.push(Access {
            material: material.to_owned(),
            part,
            ..drawing.accesses[0].clone()
        });
    }
    drawing.accesses[2].reads = true;
    let chart = chart(&drawing);
    let notes: Vec<&str> = chart.marks.iter().map(|mark| &*mark.note).collect();
    assert_eq!(notes, ["", "z0–1", "d,s", ""]);
    assert!(
        chart.marks[1]
            .title
            .ends_with("reads and writes (slices 0–1) fog")
    );
    for mark in &chart.marks {
        let end = chart.columns[mark.column].x + BESIDE + text::width(&mark.note, NOTE);
        let next = chart.columns.get(mark.column + 1);
        assert!(
            next.is_none_or(|next| end < next.x - BESIDE + 0.01),
            "{}",
            mark.note
        );
    }
    for unit in [Unit::Slice, Unit::Depth, Unit::Stencil] {
        let item = Item::Note(unit);
        assert!(chart.legend.iter().any(|(_, other)| *other == item));
    }
}

/// A name too long for a picture loses its prefix first.
#[test]
fn long_names_are_cut_where_it_hurts_least() {
    let owned = |[before, own]: [&str; 2]| Label {
        before: before.to_owned(),
        own: own.to_owned(),
    };
    let short = ["fill_rays.sample[3].", "trace_rays"];
    assert_eq!(Label::new(&short.concat()), owned(short));
    let long = Label::new("the_first_include.the_second_include.a_pass_of_twenty_4_signs");
    assert_eq!(long, owned(["the_fir…ude.", "a_pass_of_twenty_4_signs"]));
    let longer = Label::new("eye.a_name_of_more_signs_than_any_picture_has_room_for");
    assert_eq!(longer, owned(["eye.", "a_name_of_more_signs_…s_room_for"]));
    assert_eq!(
        Label::new("camera.previous"),
        owned(["", "camera.previous"])
    );
    assert_eq!(
        Label::new("left.map.previous"),
        owned(["left.", "map.previous"])
    );
    assert_eq!(
        Label::new("left.map@left.draw"),
        owned(["", "left.map@left.draw"])
    );
}

/// In a long chart what begins in a row is named there; a name that would cross a bar is not
/// written.
#[test]
fn beginnings_are_named_where_nothing_is_in_the_way() {
    let mut drawing = chain(60);
    drawing
        .materials
        .iter_mut()
        .for_each(|material| material.memory = None);
    let named = |drawing: &Drawing, name: &str| {
        let chart = chart(drawing);
        let of_name = chart
            .columns
            .iter()
            .find(|column| column.material.name == name);
        let x = of_name.map(|column| column.x + 12.0);
        chart
            .beginnings
            .iter()
            .any(|([at, _], text)| Some(*at) == x && text == name)
    };
    assert!(named(&drawing, "material_3"));
    assert!(
        !named(&chain(9), "material_3"),
        "a short chart has its heads in sight"
    );
    // material_6 stands beside material_0, whose memory it takes over, and material_1 lives on to
    // its right.
    drawing.materials[0].memory = Some(0);
    drawing.materials[6].memory = Some(0);
    assert!(named(&drawing, "material_6"));
    drawing.materials[1].lifetime = Some([1, 30]);
    assert!(!named(&drawing, "material_6"));
}
