//! Figures as SVG: what stands in them, that nothing covers anything, that they are the same every
//! time.

use roxmltree::{Document, Node};
use skiagraph_chart::{Error, Figure, Kind, Mark, Panel, Series};

fn series(name: &str, marks: &[(f64, f64)]) -> Series {
    let mark = |(size, &(x, y))| Mark {
        size,
        ..Mark::new(x, y)
    };
    Series {
        name: name.into(),
        marks: marks.iter().enumerate().map(mark).collect(),
    }
}

/// Two scenes, methods with one mark and with four, zeros in several lanes.
fn time_against_error() -> Figure {
    let panel = |title: &str, scale: f64| Panel {
        title: title.into(),
        kind: Kind::Front,
        x: "GPU ms of a frame without its G-buffer".into(),
        y: "wrong pixels, % of all".into(),
        series: vec![
            series("rt", &[(1205.0 * scale, 0.0)]),
            series(
                "light_buffer",
                &[(300.0, 0.0), (240.0, 0.0), (260.0, 0.0), (410.0, 0.0)]
                    .map(|(x, y)| (x * scale, y)),
            ),
            series(
                "nsm",
                &[(40.0, 6.7), (57.0, 4.7), (90.0, 3.6), (200.0, 3.0)].map(|(x, y)| (x * scale, y)),
            ),
            series(
                "hybrid_pcf",
                &[(260.0, 3.1), (236.0, 2.1), (250.0, 1.2), (380.0, 0.02)]
                    .map(|(x, y)| (x * scale, y)),
            ),
            series(
                "crsm",
                &[(900.0, 0.0), (817.0, 0.9), (800.0, 0.9), (990.0, 0.0)]
                    .map(|(x, y)| (x * scale, y)),
            ),
        ],
    };
    Figure {
        title: "Time against error".into(),
        notes: vec![
            "llvmpipe (LLVM 15.0.6, 256 bits), medians of 11 frames; <made up> & \"quoted\"".into(),
        ],
        sizes: ["map 512²", "map 1024²", "map 2048²", "map 4096²"]
            .map(str::to_owned)
            .into(),
        panels: vec![
            panel("Sponza, view main", 1.0),
            panel("park, mean of nine views", 0.3),
        ],
        columns: 2,
        ..Figure::default()
    }
}

fn growth() -> Figure {
    let line = |name: &str, base: f64, power: f64| {
        let marks = [1e4, 1e5, 1e6, 1e7f64].map(|x| Mark::new(x, base * (x / 1e4).powf(power)));
        Series {
            name: name.into(),
            marks: marks.into(),
        }
    };
    let panel = |title: &str, y: &str| Panel {
        title: title.into(),
        kind: Kind::Growth,
        x: "triangles".into(),
        y: y.into(),
        series: vec![
            line("rt", 500.0, 0.12),
            line("nsm", 20.0, 0.5),
            line("crsma_full", 150.0, 0.9),
        ],
    };
    Figure {
        title: "Growth".into(),
        panels: vec![
            panel("city", "GPU ms"),
            panel("city", "MB"),
            panel("forest", "GPU ms"),
        ],
        columns: 2,
        ..Figure::default()
    }
}

#[test]
fn marks_of_frames_stand_on_linear_axes_and_are_joined() {
    let marks = [0.0, 10.0, 5.0].into_iter().enumerate();
    let series = Series {
        name: "nsm".into(),
        marks: marks.map(|(frame, y)| Mark::new(frame as f64, y)).collect(),
    };
    let figure = Figure {
        panels: vec![Panel {
            title: "walk".into(),
            kind: Kind::Frames,
            x: "frame".into(),
            y: "wrong pixels, %".into(),
            series: vec![series],
        }],
        ..Figure::default()
    };
    let svg = figure.to_page_svg(520).unwrap();
    let document = Document::parse(&svg).unwrap();
    let is_circle = |node: &Node| node.has_tag_name("circle");
    let circles = document.descendants().filter(is_circle);
    let mut places: Vec<[f64; 2]> = circles
        .map(|node| [number(node, "cx"), number(node, "cy")])
        .collect();
    places.dedup();
    let [first, second, third] = places[..] else {
        panic!("{places:?}")
    };
    // Alike steps to the right; half as high is half way up.
    assert!(
        (second[0] - first[0] - (third[0] - second[0])).abs() <= 1.0,
        "{places:?}"
    );
    assert!(
        ((first[1] + second[1]) / 2.0 - third[1]).abs() <= 1.0,
        "{places:?}"
    );
    let joined = format!("{},{} {},{}", first[0], first[1], second[0], second[1]);
    assert!(svg.contains(&joined), "no line through {joined}");
}

fn number(node: Node, name: &str) -> f64 {
    node.attribute(name).unwrap_or_default().parse().unwrap()
}

/// Left, top, right, bottom of a text, generously.
fn text_box(node: Node) -> [f64; 4] {
    let (x, y, size) = (
        number(node, "x"),
        number(node, "y"),
        number(node, "font-size"),
    );
    let text = node.text().unwrap_or_default().trim();
    let wide = text.chars().count() as f64 * size * 0.6;
    let left = match node.attribute("text-anchor") {
        Some("middle") => -wide / 2.0,
        Some("end") => -wide,
        _ => 0.0,
    };
    let (top, bottom) = match node.attribute("dy") {
        Some("0.76em") => (0.0, size),
        Some("-0.5ex") => (-size, 0.0),
        _ => (-size / 2.0, size / 2.0),
    };
    if node.attribute("transform").is_some() {
        // Turned by 270° about its anchor: right is up.
        return [x + top, y - left - wide, x + bottom, y - left];
    }
    [x + left, y + top, x + left + wide, y + bottom]
}

/// Each text with its box.
fn texts<'a>(svg: &'a Document) -> Vec<(&'a str, [f64; 4])> {
    let nodes = svg.descendants().filter(|node| node.has_tag_name("text"));
    nodes
        .map(|node| (node.text().unwrap_or_default().trim(), text_box(node)))
        .collect()
}

fn svg(figure: &Figure) -> String {
    figure.to_svg().unwrap()
}

#[test]
fn no_text_covers_another_and_none_leaves_the_picture() {
    for figure in [time_against_error(), growth()] {
        let svg = svg(&figure);
        let svg = Document::parse(&svg).unwrap();
        let height = number(svg.root_element(), "height");
        let texts = texts(&svg);
        assert!(texts.len() > 20);
        for (index, (text, [left, top, right, bottom])) in texts.iter().enumerate() {
            assert!(
                *left >= 0.0 && *right <= 800.0,
                "{text:?} from {left} to {right}"
            );
            assert!(
                *top >= 0.0 && *bottom <= height,
                "{text:?} from {top} to {bottom}"
            );
            for (other, [l, t, r, b]) in &texts[..index] {
                let apart = right <= l || r <= left || bottom <= t || b <= top;
                assert!(apart, "{text:?} and {other:?}");
            }
        }
    }
}

/// `time_against_error()` with marks that a page tells of, one named with what XML escapes.
fn of_a_page() -> Figure {
    let mut figure = time_against_error();
    figure.panels.truncate(1);
    figure.columns = 1;
    for series in &mut figure.panels[0].series {
        for mark in &mut series.marks {
            mark.about = format!("{} {}\n{} <ms> & \"more\"", series.name, mark.size, mark.x);
        }
    }
    figure
}

#[test]
fn a_page_finds_marks_their_names_and_what_they_tell() {
    for width in [1100, 400] {
        let svg = of_a_page().to_page_svg(width).unwrap();
        assert!(!svg.contains("\"#"), "colours are the page's: {svg}");
        let svg = Document::parse(&svg).unwrap();
        let marks = svg
            .descendants()
            .filter(|node| node.attribute("class") == Some("mark"));
        let marks: Vec<Node> = marks.collect();
        assert_eq!(marks.len(), 17);
        let rt = marks
            .iter()
            .find(|mark| mark.attribute("data-series") == Some("rt"))
            .unwrap();
        assert_eq!(rt.attribute("data-name"), Some("rt 0"));
        let label = rt.attribute("aria-label").unwrap();
        assert_eq!(label, "rt 0\n1205 <ms> & \"more\"");
        // Names stand in their marks' groups, cover nothing and leave the picture nowhere.
        let is_name = |node: &Node| node.attribute("class") == Some("name");
        let names: Vec<Node> = svg.descendants().filter(is_name).collect();
        assert!(names.len() > 6, "{}", names.len());
        for (index, name) in names.iter().enumerate() {
            let mark_name = name.parent().and_then(|mark| mark.attribute("data-name"));
            assert_eq!(name.text(), mark_name);
            let [left, top, right, bottom] = text_box(*name);
            assert!(left >= 0.0 && right <= f64::from(width) && top >= 0.0);
            for other in &names[..index] {
                let [l, t, r, b] = text_box(*other);
                assert!(right <= l || r <= left || bottom <= t || b <= top);
            }
        }
        let lines = svg
            .descendants()
            .filter(|node| node.has_tag_name("polyline"));
        let front = lines.filter(|node| node.attribute("stroke") == Some("var(--front)"));
        assert_eq!(front.count(), 1);
    }
}

#[test]
fn ticks_may_have_names() {
    let mut figure = growth();
    figure.ticks = vec![(1e4, "small".into()), (1e6, "<large>".into())];
    let svg = svg(&figure);
    let svg = Document::parse(&svg).unwrap();
    let count = |name: &str| texts(&svg).iter().filter(|(text, _)| *text == name).count();
    assert_eq!((count("small"), count("<large>"), count("10⁷")), (3, 3, 0));
    let sign = figure.sign("nsm").unwrap();
    assert!(sign.contains("\"var(--s1)\"") && Document::parse(&sign).is_ok());
}

#[test]
fn zeros_stand_in_the_strip_each_series_in_a_lane_and_nothing_else_does() {
    let figure = Figure {
        panels: time_against_error().panels[..1].to_vec(),
        ..time_against_error()
    };
    let svg = svg(&figure);
    let svg = Document::parse(&svg).unwrap();
    let strip = svg
        .descendants()
        .find(|node| node.attribute("fill") == Some("#EEEEEE"))
        .unwrap();
    let (top, bottom) = (
        number(strip, "y"),
        number(strip, "y") + number(strip, "height"),
    );
    // The rims of `rt`'s circle and of four shapes, in the strip and above it.
    let circles = svg.descendants().filter(|node| node.has_tag_name("circle"));
    let in_strip = |y: f64| top < y && y < bottom;
    let circle = circles
        .clone()
        .filter(|node| in_strip(number(*node, "cy")))
        .count();
    assert_eq!(circle, 2, "inside and rim of the only circle");
    let mut lanes: Vec<i32> = svg
        .descendants()
        .filter(|node| node.has_tag_name("polygon"))
        .filter_map(|node| {
            let points = node.attribute("points")?.split_whitespace();
            let heights: Vec<f64> = points
                .map(|point| point.split_once(',').unwrap().1.parse().unwrap())
                .collect();
            let middle = heights.iter().sum::<f64>() / heights.len() as f64;
            in_strip(middle).then_some(((middle - top) / 16.0) as i32)
        })
        .collect();
    assert_eq!(lanes.len(), 6, "four of light_buffer, two of crsm");
    lanes.sort_unstable();
    lanes.dedup();
    assert_eq!(lanes.len(), 2, "a lane each");
    assert!(
        texts(&svg)
            .iter()
            .any(|(text, place)| *text == "0" && in_strip(place[1]))
    );
}

/// Or what is on the front would be hidden by what is not.
#[test]
fn small_marks_lie_on_large_ones() {
    let svg = svg(&Figure {
        panels: time_against_error().panels[..1].to_vec(),
        ..time_against_error()
    });
    let svg = Document::parse(&svg).unwrap();
    let width = |node: Node| {
        let points = node.attribute("points")?.split_whitespace();
        let across = points.map(|point| point.split_once(',').unwrap().0.parse().unwrap());
        let across: Vec<f64> = across.collect();
        let least = across.iter().copied().fold(f64::INFINITY, f64::min);
        Some(across.iter().copied().fold(0.0, f64::max) - least)
    };
    let polygons = svg
        .descendants()
        .filter(|node| node.has_tag_name("polygon"));
    let widths: Vec<f64> = polygons.filter_map(width).collect();
    // Four in the legend, then those of four methods in each of four maps.
    let of_maps: Vec<f64> = widths[4..].chunks(4).map(|map| map.iter().sum()).collect();
    assert_eq!(of_maps.len(), 4);
    assert!(of_maps.is_sorted_by(|a, b| a > b), "{of_maps:?}");
}

#[test]
fn a_series_looks_the_same_whatever_else_is_drawn() {
    let looks = || ["light_buffer", "rt", "nsm"].map(str::to_owned).to_vec();
    // Colours of the lines, one after the other, panel by panel.
    let colours = |figure: &Figure| {
        let svg = svg(figure);
        let svg = Document::parse(&svg).unwrap();
        // Marks are narrow, and axes have two points.
        let is_line = |node: &Node| {
            let points = node.attribute("points").unwrap_or_default();
            let points = points.split_whitespace();
            let across = points.map(|point| point.split_once(',').unwrap().0.parse().unwrap());
            let across: Vec<f64> = across.collect();
            node.has_tag_name("polyline") && across.len() == 4 && across[3] - across[0] > 100.0
        };
        let lines = svg.descendants().filter(is_line);
        let colours = lines.filter_map(|node| Some(node.attribute("stroke")?.to_owned()));
        colours.collect::<Vec<_>>()
    };
    let listed = colours(&Figure {
        looks: looks(),
        ..growth()
    });
    let unlisted = colours(&growth());
    assert_eq!(listed.len(), 9, "three series in three panels");
    assert_eq!(
        unlisted[1..3],
        listed[..2],
        "one place on, since light_buffer is not drawn"
    );
    let mut fewer = growth();
    fewer.looks = looks();
    for panel in &mut fewer.panels {
        panel.series.remove(0);
    }
    assert_eq!(colours(&fewer)[..2], listed[1..3]);
}

#[test]
fn error_bars_reach_from_end_to_end_within_the_axes() {
    let mark = Mark {
        spread: Some([20.0, 80.0]),
        ..Mark::new(40.0, 3.0)
    };
    let figure = |mark: Mark, kind: Kind| Figure {
        panels: vec![Panel {
            title: "park".into(),
            kind,
            x: "ms".into(),
            y: "%".into(),
            series: vec![Series {
                name: "nsm".into(),
                marks: vec![mark],
            }],
        }],
        ..Figure::default()
    };
    let drawn = svg(&figure(mark.clone(), Kind::Front));
    let parsed = Document::parse(&drawn).unwrap();
    let thin = parsed.descendants().filter(|node| {
        let is_of_series = node.attribute("stroke") == Some("#0072B2");
        is_of_series && node.attribute("stroke-width") == Some("1")
    });
    let points = thin.filter_map(|node| node.attribute("points"));
    let across: Vec<f64> = points
        .flat_map(|points| points.split_whitespace())
        .map(|point| point.split_once(',').unwrap().0.parse().unwrap())
        .collect();
    assert_eq!(across.len(), 6, "a line and two caps: {across:?}");
    let (left, right) = (across[0], across[2]);
    let mut circles = parsed
        .descendants()
        .filter(|node| node.has_tag_name("circle") && node.attribute("fill") == Some("#0072B2"));
    let middle = number(circles.next_back().unwrap(), "cx"); // The first is the legend's.
    assert!(
        (middle - (left + right) / 2.0).abs() <= 1.0,
        "{left} {middle} {right}"
    );
    assert!(left > 60.0 && right < 800.0 && right - left > 100.0);
    assert!(!svg(&figure(mark.clone(), Kind::Growth)).contains("quartiles"));
    for spread in [[0.0, 1.0], [3.0, 2.0], [1.0, f64::NAN]] {
        let mark = Mark {
            spread: Some(spread),
            ..mark.clone()
        };
        let error = figure(mark, Kind::Front).to_svg().unwrap_err().to_string();
        assert!(error.contains("an error bar from"), "{error}");
    }
}

#[test]
fn the_same_data_give_the_same_bytes_and_they_are_these() {
    assert_eq!(svg(&growth()), svg(&growth()));
    insta::assert_snapshot!(svg(&growth()));
}

#[test]
fn whatever_names_say_it_stays_xml() {
    let mut figure = growth();
    figure.title = "a < b & \"c\" \u{7} d".into();
    let svg = svg(&figure);
    let svg = Document::parse(&svg).unwrap();
    assert_eq!(texts(&svg)[0].0, "a < b & \"c\" \u{fffd} d");
}

#[test]
fn what_has_no_place_is_refused_by_name() {
    let with = |mark: Mark, kind: Kind| {
        let mut figure = growth();
        figure.panels[0].kind = kind;
        figure.panels[0].series[1].marks = vec![mark];
        figure.to_svg()
    };
    let mark = |x, y, size| Mark {
        size,
        ..Mark::new(x, y)
    };
    let refusal = |result: Result<String, Error>| result.unwrap_err().to_string();
    for (x, y) in [
        (0.0, 1.0),
        (1.0, -1.0),
        (f64::NAN, 1.0),
        (1.0, f64::INFINITY),
    ] {
        let message = refusal(with(mark(x, y, 0), Kind::Front));
        assert!(
            message.contains("\"city\"") && message.contains("\"nsm\""),
            "{message}"
        );
    }
    assert!(with(mark(1.0, 0.0, 0), Kind::Front).is_ok());
    assert!(with(mark(1.0, 0.0, 0), Kind::Growth).is_err());
    assert!(refusal(with(mark(1.0, 1.0, 1), Kind::Growth)).contains("size 1"));
    let mut empty = growth();
    empty.panels[2].series.clear();
    assert!(refusal(empty.to_svg()).contains("\"forest\" has no marks"));
    assert!(with(mark(0.0, 0.0, 0), Kind::Frames).is_ok());
    assert!(with(mark(1.0, -0.5, 0), Kind::Frames).is_err());
    // A single mark still has axes around it.
    assert!(with(mark(7.0, 7.0, 0), Kind::Front).is_ok());
}
