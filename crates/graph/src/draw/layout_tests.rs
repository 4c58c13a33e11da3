//! Where things stand in charts of plans made by hand.

use super::{
    Access, Drawing, Edge, Hazard, Kind, Material, Origin, Part, Pass, Reason,
    layout::{Area, COLUMN, Layout, NAME, SMALL},
    legend::Item,
    text,
};

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
    let part = |mips: std::ops::Range<u32>| Some(Part { mips, layers: 0..1 });
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
    let both = |(_, _, item): &(f64, f64, Item)| *item == Item::Both;
    assert!(layout.legend.iter().any(both), "the sign is explained");
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
    let named = |drawing: &Drawing, name: &str| {
        let layout = Layout::new(drawing);
        let of_name = layout
            .columns
            .iter()
            .find(|column| column.material.name == name);
        let x = of_name.map(|column| column.x + 12.0);
        layout
            .beginnings
            .iter()
            .any(|(at, _, text)| Some(*at) == x && text == name)
    };
    assert!(named(&drawing, "material_3"));
    assert!(
        !named(&chain(9), "material_3"),
        "a short chart has its heads in sight"
    );
    // material_6 stands beside material_0, whose memory it takes over, and material_1 lives on to its right.
    drawing.materials[0].memory = Some(0);
    drawing.materials[6].memory = Some(0);
    assert!(named(&drawing, "material_6"));
    drawing.materials[1].lifetime = Some([1, 30]);
    assert!(!named(&drawing, "material_6"));
}
