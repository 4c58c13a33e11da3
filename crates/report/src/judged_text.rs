//! Judged pictures of other renderers as a table and sentences for a terminal.

use crate::graded::{counted, invalid_counts};
use crate::notes::{pixels, surface_warning};
use crate::table::{TERMINAL, or_dash, terminal, wrapped};
use itertools::Itertools;
use skiagraph_compare::lists::entry;
use skiagraph_compare::records::judged_pictures::{
    JudgedPicture, JudgedPictures, MOST_UNATTRIBUTABLE,
};
use skiagraph_compare::records::results::Answer;
use skiagraph_compare::records::table::Table;
use skiagraph_compare::wording::{or_nothing, percent, size, thousands};
use skiagraph_reference::Graded;

/// Returns heading, table, verdict and notes of judged pictures as text. `is_broken` breaks
/// sentences into lines of 80 characters, as a terminal needs; otherwise each is a line.
pub fn text(judged: &JudgedPictures, is_broken: bool) -> String {
    let room = if is_broken { TERMINAL } else { usize::MAX };
    let broken = |line: String| wrapped(&line, room);
    let mut lines: Vec<String> = heading(judged).into_iter().map(broken).collect();
    let names = short_names(&judged.pictures);
    lines.push(format!("\n{}\n", terminal(&table(judged, &names))));
    let pictures = names.iter().zip(&judged.pictures);
    let verdicts = pictures.map(|(name, picture)| verdict(judged, name, picture));
    lines.extend(verdicts.chain(notes(judged, &names)).map(broken));
    lines.join("\n") + "\n"
}

/// Characters of a picture's name beside which a table of figures has room.
const NAME: usize = 28;

/// Returns the parts of the pictures' paths that tell them apart: without the folders that all
/// have, and where that is too long for a table without what all end with, and with a gap.
fn short_names(pictures: &[JudgedPicture]) -> Vec<String> {
    let files = pictures.iter().map(|picture| &*picture.file);
    let paths = files.map(|file| file.split(['/', '\\']).collect_vec());
    let paths = paths.collect_vec();
    let shortest = paths.iter().map(Vec::len).min().unwrap_or_default();
    let has_front = |at: &usize| paths.iter().map(|path| path[*at]).all_equal();
    let has_back = |at: &usize| paths.iter().map(|it| it.iter().rev().nth(*at)).all_equal();
    let front = (0..shortest).take_while(has_front).count();
    let front = front.min(shortest.saturating_sub(1));
    let back = (0..shortest - front).take_while(has_back).count();
    let names = |back: usize| -> Vec<String> {
        let name = |path: &Vec<&str>| path[front..(path.len() - back).max(front + 1)].join("/");
        paths.iter().map(name).collect()
    };
    let is_short = |name: &String| name.chars().count() <= NAME;
    let whole = names(0);
    if whole.iter().all(is_short) {
        return whole;
    }
    let cut = |name: String| {
        let (letters, half) = (name.chars().collect_vec(), NAME / 2);
        if is_short(&name) {
            return name;
        }
        let (begin, end) = (&letters[..half - 1], &letters[letters.len() - half..]);
        begin.iter().chain(&['…']).chain(end).collect()
    };
    let short = names(back).into_iter().map(cut).collect_vec();
    if short.iter().all_unique() {
        short
    } else {
        whole
    }
}

fn heading(judged: &JudgedPictures) -> Vec<String> {
    let surfaces = match &*judged.surfaces {
        "ids" => "by the ids given",
        "depth" => "by the depths given",
        _ => "as rasterised here, or any other within 1/16 of a pixel",
    };
    let under = or_nothing(judged.light.as_ref(), |light| format!(" under {light}"));
    let (scene, view, size) = (&judged.scene, &judged.view, size(judged.viewport));
    let count = judged.unattributable;
    let share = percent(count, judged.pixels.facing_light);
    let count = thousands(count);
    let mut lines = vec![
        format!("{scene} · view {view}{under} · {size}"),
        pixels(&judged.pixels, judged.area.as_ref(), judged.band),
        format!("unattributable: {count} ({share} of PFL) · surfaces: {surfaces}"),
    ];
    lines.extend(surface_warning(judged.wrong_surface, &judged.pixels));
    lines
}

/// A column: its head, and the cell of a picture.
type Column = (&'static str, fn(&JudgedPictures, &JudgedPicture) -> String);

/// The columns behind the name.
#[rustfmt::skip] // A line each.
const COLUMNS: [Column; 14] = [
    ("rank", |_, picture| or_dash(picture.rank, |rank| rank.to_string())),
    ("wrong", |_, picture| thousands(picture.wrong_attributable())),
    ("wrong %", |judged, picture| {
        percent(picture.wrong_attributable(), judged.pixels.facing_light)
    }),
    ("wrongly lit", |_, picture| thousands(picture.wrong.lit)),
    ("wrongly in shadow", |_, picture| thousands(picture.wrong.shadow)),
    ("wrong in band", |_, picture| thousands(picture.wrong.in_band)),
    ("wrong unattributable", |_, picture| thousands(picture.wrong_unattributable)),
    ("RMSE", |_, picture| format!("{:.5}", picture.graded.rmse_outside_band)),
    ("FLIP", |_, picture| format!("{:.5}", picture.graded.flip)),
    ("px from edge", |_, picture| {
        let edges = Some(picture.edges.all()).filter(|edges| edges.count > 0);
        or_dash(edges, |edges| format!("{:.2}", edges.mean_pixels))
    }),
    ("light in umbra", |judged, picture| soft(judged, picture, |by| by.soft.light_in_umbra)),
    ("dark in light", |judged, picture| soft(judged, picture, |by| by.soft.dark_in_light)),
    ("penumbra RMSE", |judged, picture| soft(judged, picture, |by| by.soft.penumbra_rmse)),
    ("off > 1/16", |judged, picture| {
        let share = picture.graded.off.over_1_16 as f64 / judged.pixels.facing_light.max(1) as f64;
        soft(judged, picture, move |_| share)
    }),
];

/// A figure of shares of light.
fn soft(
    judged: &JudgedPictures,
    picture: &JudgedPicture,
    figure: impl Fn(&Graded) -> f64,
) -> String {
    let is_soft = judged.area.is_some() || picture.answer == Answer::Graded;
    or_dash(is_soft.then(|| figure(&picture.graded)), |figure| {
        format!("{figure:.5}")
    })
}

fn table(judged: &JudgedPictures, names: &[String]) -> Table {
    let rows = names.iter().zip(&judged.pictures).map(|(name, picture)| {
        let cells = COLUMNS.iter().map(|(_, cell)| cell(judged, picture));
        [name.clone()].into_iter().chain(cells).collect()
    });
    let heads = COLUMNS.map(|(head, _)| head);
    Table::new(["picture"].into_iter().chain(heads), 1, rows)
}

fn verdict(judged: &JudgedPictures, name: &str, picture: &JudgedPicture) -> String {
    let (wrong, facing) = (picture.wrong_attributable(), judged.pixels.facing_light);
    let (format, share) = (&picture.format, percent(wrong, facing));
    let [wrong, facing] = [wrong, facing].map(thousands);
    let mut text = format!(
        "{name} ({format}): {wrong} of the {facing} pixels that face the light are wrong ({share})"
    );
    if picture.without_answer > 0 {
        let unanswered = thousands(picture.without_answer);
        text += &format!(", and {unanswered} have no finite number and are not judged");
    }
    if judged.area.is_some() {
        let rmse = picture.graded.rmse_outside_band;
        text += &format!(", cut at one half; RMSE {rmse:.5}");
    }
    if let Some(blockers) = picture.wrong_blockers {
        let counts = [
            ("an open part of the mesh", blockers.open_part),
            ("a closed part", blockers.closed_part),
            ("nothing", blockers.none),
        ];
        text += &format!("; what blocks their light: {}", counted(counts));
    }
    text
}

/// Warnings, each once with the pictures that it is about, and what holds of all figures.
fn notes(judged: &JudgedPictures, names: &[String]) -> Vec<String> {
    let mut warnings: Vec<(String, Vec<&str>)> = Vec::new();
    let mut warn = |text: String, name| entry(&mut warnings, text).push(name);
    for (name, picture) in names.iter().zip(&judged.pictures) {
        let invalid = picture.graded.invalid;
        if invalid.total() > 0 {
            let counts = invalid_counts(&invalid);
            let what = "at pixels that face the light the factor is not a share of 0 to 1";
            warn(format!("{what}: {counts}"), name);
        }
        let texts = picture.warnings.iter().cloned();
        texts.for_each(|text| warn(text, name));
    }
    let warning = |(text, names): (String, Vec<&str>)| match &names[..] {
        [name] => format!("warning: {name}: {text}"),
        names => {
            let (count, names) = (names.len(), names.join(", "));
            format!("warning: in {count} pictures ({names}): {text}")
        }
    };
    let mut notes: Vec<String> = warnings.into_iter().map(warning).collect();
    if !judged.is_attributable() {
        let share = percent(judged.unattributable, judged.pixels.facing_light);
        let most = MOST_UNATTRIBUTABLE * 100.0;
        notes.push(format!(
            "no rank: {share} of the pixels are unattributable, more than {most:.0} %: the truth \
             differs between surfaces that they may show. Give the surfaces with --ids or \
             --depth, or render in more pixels"
        ));
    }
    notes.push(
        "wrong: outside the band and attributable; of shares, one half or more counts as lit. \
         Wrongly lit and wrongly in shadow count all. RMSE is over the same pixels as wrong"
            .into(),
    );
    notes
}

#[cfg(test)]
mod tests {
    use super::*;
    use skiagraph_compare::records::results::{OpenParts, Scene};
    use skiagraph_reference::{BlockerCounts, Invalid, PixelCounts, WrongCounts};

    fn judged() -> JudgedPictures {
        let picture = JudgedPicture {
            file: "engine.exr".into(),
            format: "EXR, half, grey".into(),
            answer: Answer::Graded,
            rank: Some(1),
            wrong: WrongCounts {
                lit: 40,
                shadow: 70,
                total: 110,
                certain: 90,
                in_band: 6,
            },
            wrong_unattributable: 4,
            graded: Graded {
                rmse_outside_band: 0.0125,
                invalid: Invalid {
                    nan: 2,
                    ..Invalid::default()
                },
                ..Graded::default()
            },
            wrong_blockers: Some(BlockerCounts {
                open_part: 60,
                closed_part: 0,
                none: 40,
            }),
            warnings: vec!["alpha is not read".into()],
            ..JudgedPicture::default()
        };
        let hard = JudgedPicture {
            file: "other.png".into(),
            format: "PNG, 8 bits, grey".into(),
            answer: Answer::Hard,
            rank: Some(2),
            warnings: Vec::new(),
            graded: Graded::default(),
            wrong_blockers: None,
            ..picture.clone()
        };
        JudgedPictures {
            schema: 1,
            program: "skiagraph".into(),
            scene: Scene {
                name: "park".into(),
                triangles: 55_000,
                parts: OpenParts {
                    all: 40,
                    open: 12,
                    open_triangles: 5_000,
                },
            },
            view: "main".into(),
            light: None,
            viewport: [512, 256],
            oracle: "exact".into(),
            pixels: PixelCounts {
                background: 72,
                facing_away: 31_000,
                facing_light: 100_000,
                lit: 60_000,
                shadow: 40_000,
            },
            band: 12,
            wrong_surface: 0,
            area: None,
            surfaces: "rasterised".into(),
            unattributable: 123,
            pictures: vec![picture, hard],
        }
    }

    #[test]
    fn a_table_tells_what_is_wrong_and_what_is_open() {
        insta::assert_snapshot!(text(&judged(), true));
    }

    #[test]
    fn warnings_that_pictures_share_are_told_once_and_paths_keep_rows_lines() {
        let mut judged = judged();
        let black = "2 pixels facing the light, black in the picture without shadows, too";
        let folder = "/home/somewhere/out/engines/babylon/a_rather_long_name_of_a_run";
        judged.pictures = (0..11)
            .map(|number| JudgedPicture {
                file: format!("{folder}/shadow_generator_with_setting_{number}/shadowed.exr"),
                warnings: vec![black.into(), format!("its own {number}")],
                ..judged.pictures[1].clone()
            })
            .collect();
        let printed = text(&judged, false);
        assert_eq!(printed.matches(black).count(), 1, "{printed}");
        assert!(printed.contains("warning: in 11 pictures ("), "{printed}");
        assert_eq!(printed.matches("its own 7").count(), 1, "{printed}");
        let table: Vec<&str> = printed.split("\n\n").collect();
        assert!(
            table[1]
                .lines()
                .all(|line| line.chars().count() <= TERMINAL),
            "{printed}"
        );
        let rows = table[1].lines().filter(|line| line.contains('…'));
        assert_eq!(rows.unique().count(), 11, "each row is a line: {printed}");
        assert!(!printed.contains(folder), "{printed}");
        // Of one folder only names are left, of names alike the folders that differ.
        for (files, names) in [
            (["a/b/one.png", "a/b/two.png"], ["one.png", "two.png"]),
            (["a/x/one.png", "a/y/one.png"], ["x/one.png", "y/one.png"]),
            (["one.png", "one.png"], ["one.png", "one.png"]),
        ] {
            let pictures = files.map(|file| JudgedPicture {
                file: file.into(),
                ..JudgedPicture::default()
            });
            assert_eq!(short_names(&pictures), names);
        }
    }

    #[test]
    fn a_picture_that_cannot_be_attributed_has_no_rank_and_says_why() {
        let mut judged = judged();
        judged.unattributable = 1_001;
        let text = text(&judged, false);
        assert!(
            text.contains("no rank: 1.001 % of the pixels are unattributable"),
            "{text}"
        );
    }
}
