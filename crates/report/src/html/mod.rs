//! Writes `report.html`: all results that `compare` and `stress` wrote into folders, in one file
//! that works without a network. All figures, charts and tables are made here by the same rules as
//! those for the terminal; the page's script only shows the chosen ones.
//!
//! | | |
//! |-|-|
//! | `shown` | tables to choose from, and parts of the page that belong to some of them |
//! | `first` | these parts: the pictures of the verdict |
//! | `charts`, `steps`, `rows` | charts, bars of steps, tables |
//! | `stress` | matrices of stress cases |
//! | `data` | all other words, as JSON |
//! | `pictures` | which pictures go in, as far as there is room |
//! | `report.html`, `.css`, `*.js` | the page |

mod charts;
mod data;
mod first;
mod pictures;
mod rows;
mod shown;
mod steps;
mod stress;

use crate::summary_table::{Summary, summaries};
use pictures::Pictures;
use shown::shown;
use skiagraph_compare::records::sources::Source;
use skiagraph_compare::records::stress::Report;

/// Greatest size in bytes up to which pictures fill a page. A larger page would be slow to open and
/// too large for a mail.
pub const LIMIT: usize = 30_000_000;

/// In the order in which they need each other.
const SCRIPTS: [&str; 9] = [
    include_str!("page.js"),
    include_str!("shown.js"),
    include_str!("table.js"),
    include_str!("picture.js"),
    include_str!("viewer.js"),
    include_str!("first.js"),
    include_str!("keys.js"),
    include_str!("link.js"),
    include_str!("report.js"),
];

/// A page, and the list of pictures that did not fit into it.
pub struct Page {
    /// Content of the HTML file.
    pub html: String,
    /// Lines that count the pictures left out because the page would exceed [`LIMIT`]. The page
    /// shows them as well. Empty if all pictures are in it.
    pub left_out: Vec<String>,
}

/// Returns the page of results: `sources` of `compare`, and `reports` of `stress`. Pictures are
/// read from the sources' folders.
pub fn page(sources: &[Source], reports: &[Report]) -> Page {
    page_within(sources, reports, LIMIT)
}

fn page_within(sources: &[Source], reports: &[Report], limit: usize) -> Page {
    let summaries = sources.iter().enumerate().flat_map(|(index, source)| {
        let summaries = summaries(&source.results).into_iter();
        summaries.map(move |summary| (index, summary))
    });
    let summaries: Vec<(usize, Summary)> = summaries.collect();
    let tables = shown(sources, &summaries);
    let frame = include_str!("report.html")
        .replace("/*STYLE*/", include_str!("report.css"))
        .replace("/*SCRIPT*/", &SCRIPTS.concat())
        // Names are escaped: none looks like a comment.
        .replace("<!--FIRST-->", &first::pictures(&tables))
        .replace("<!--FRONTS-->", &charts::fronts(&tables))
        .replace("<!--LEGEND-->", &charts::legends(&tables))
        .replace("<!--TABLES-->", &rows::tables(&tables))
        .replace("<!--LIGHTS-->", &rows::lights(sources, &tables))
        .replace("<!--OVERVIEW-->", &rows::overview(sources, &tables))
        .replace("<!--STEPS-->", &steps::bars(&tables))
        .replace("<!--GROWTHS-->", &charts::growths(&tables))
        .replace("<!--BEGINS-->", &charts::begins(&tables))
        .replace("<!--PATHS-->", &charts::paths(&tables))
        .replace("<!--STRESS-->", &stress::matrices(reports));
    let filled = |pictures: &Pictures| {
        // Last, since anything may stand in it.
        frame.replacen("<!--DATA-->", &data::text(sources, &tables, pictures), 1)
    };
    let empty = filled(&Pictures::default());
    let pictures = Pictures::embed(sources, limit.saturating_sub(empty.len()));
    Page {
        html: filled(&pictures),
        left_out: pictures.left_out,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::{results as sample, stress};
    use serde_json::Value;
    use skiagraph_compare::records::results::Results;
    use skiagraph_compare::records::sequence::Sequence;
    use skiagraph_compare::records::sources::{Kept, sources};
    use std::path::Path;

    fn source(folder: &Path, results: Results) -> Vec<Source> {
        let folder = folder.to_path_buf();
        sources(vec![Kept { folder, results }])
    }

    /// Returns the data that the page is given.
    fn data_of(html: &str) -> Value {
        let begin = html.find("id=\"data\">").unwrap() + "id=\"data\">".len();
        let data = &html[begin..];
        serde_json::from_str(&data[..data.find("</script>").unwrap()]).unwrap()
    }

    #[test]
    fn hostile_names_stay_text() {
        let mut results = sample();
        let name = "</script><b onload=x>&\u{2028}";
        results.runs[0].preset = name.into();
        results.scene.name = name.into();
        let html = page(&source(Path::new("nowhere"), results), &[]).html;
        assert!(!html.contains("<b onload"));
        let data = data_of(&html);
        assert_eq!(data["sources"][0]["scene"], name);
        let rows = data["tables"][0]["rows"].as_array().unwrap();
        assert!(rows.iter().any(|row| row["method"] == name), "{rows:?}");
        // In the legend, the charts, the tables.
        assert!(
            html.matches("&lt;/script&gt;&lt;b onload=x&gt;&amp;")
                .count()
                > 3
        );
    }

    #[test]
    fn what_a_page_has_no_room_for_is_named_the_least_telling_first() {
        let folder = tempfile::tempdir().unwrap();
        let results = sample();
        let images = results.runs[0].measured.as_ref().unwrap().images.as_ref();
        let images = images.unwrap();
        let names = [&images.shaded, &images.visibility, &images.error];
        let names = names
            .into_iter()
            .chain(&images.uncertain)
            .chain(&images.texels);
        for name in names {
            std::fs::write(folder.path().join(name), [7; 3_000]).unwrap();
        }
        let sources = source(folder.path(), results);
        let whole = page(&sources, &[]);
        assert!(whole.left_out.is_empty(), "{:?}", whole.left_out);
        // The five take 20,000 letters.
        let thin = page_within(&sources, &[], whole.html.len() - 5_000);
        assert!(thin.html.len() <= whole.html.len() - 5_000);
        let [line] = &thin.left_out[..] else {
            panic!("{:?}", thin.left_out)
        };
        assert!(line.contains("2 pictures"), "{line}");
        let data = data_of(&thin.html);
        let set = &data["pictures"]["sets"][0];
        assert!(set["error"].is_u64() && set["shaded"].is_u64(), "{set}");
        assert!(set["uncertain"].is_null() && set["texels"].is_null());
        assert_eq!(data["left_out"][0], line.as_str());
    }

    /// `sample()` with pictures of two methods, of which the second is exact.
    fn two_with_pictures() -> Results {
        let mut results = sample();
        results.runs.truncate(2);
        let [one, other] = &mut results.runs[..] else {
            panic!("two runs")
        };
        let other = other.measured.as_mut().unwrap();
        other.images = one.measured.as_ref().unwrap().images.clone();
        (other.wrong.total, other.wrong.in_band) = (0, 0);
        other.graded = Default::default();
        results
    }

    #[test]
    fn the_first_screen_shows_what_the_verdict_names() {
        let first = |results: Results| {
            let html = page(&source(Path::new("nowhere"), results), &[]).html;
            let (_, block) = html.split_once("<div class=\"first\"")?;
            Some(block.split_once("</div>")?.0.to_owned())
        };
        let html = first(two_with_pictures()).unwrap();
        let kinds = html.split("data-kind=\"").skip(1);
        let kinds: Vec<&str> = kinds.map(|rest| rest.split('"').next().unwrap()).collect();
        assert_eq!(kinds, ["visibility", "shaded", "error"]);
        let captions = html.split("<figcaption>").skip(1);
        let captions: Vec<&str> = captions.collect();
        assert!(
            captions[1].contains("rt</b>: no wrong pixel, 1.50 ms"),
            "{html}"
        );
        let wrong = "nsm 1024</b>: 0.497 % wrong, 1.50 ms; blue lights a shadow, red shadows light";
        assert!(captions[2].contains(wrong), "{html}");

        let mut right = two_with_pictures();
        let measured = right.runs[1].measured.clone();
        right.runs[0].measured = measured;
        let html = first(right).unwrap();
        assert!(html.contains("It has no wrong pixel to show.") && !html.contains("\"error\""));

        let mut without = two_with_pictures();
        for run in &mut without.runs {
            run.measured.as_mut().unwrap().images = None;
        }
        assert_eq!(first(without), None);
    }

    #[test]
    fn a_picture_of_a_path_is_captioned_with_its_frames_own_figures() {
        let mut results = two_with_pictures();
        let frames = |wrong: [u64; 2]| -> Sequence {
            let frame = |wrong: u64| {
                serde_json::json!({
                    "facing_light": 1000, "wrong": wrong, "wrong_outside_band": wrong,
                    "graded": {"rmse": wrong as f64}, "rays": null,
                    "gpu_ms": 0.25 + wrong as f64, "wall_ms": 10.0 + wrong as f64
                })
            };
            let frames = wrong.map(frame);
            let shimmer = serde_json::json!({"compared": 900, "changed": 3});
            let path = serde_json::json!({"shimmer": shimmer, "frames": frames});
            serde_json::from_value(path).unwrap()
        };
        for (run, wrong) in results.runs.iter_mut().zip([[2, 7], [0, 0]]) {
            let measured = run.measured.as_mut().unwrap();
            measured.sequence = Some(frames(wrong));
            measured.images.as_mut().unwrap().frame = Some(1);
        }
        let html = page(&source(Path::new("nowhere"), results), &[]).html;
        for caption in [
            "rt</b>, frame 1: no wrong pixel, 10.0 ms",
            "nsm 1024</b>, frame 1: 0.700 % wrong, 17.0 ms; blue",
        ] {
            assert!(html.contains(caption), "{caption}: {html}");
        }
    }

    #[test]
    fn the_verdict_says_that_the_camera_is_not_the_files() {
        let sentences = |note: &str| {
            let mut results = sample();
            results.notes = vec![note.into()];
            let html = page(&source(Path::new("nowhere"), results), &[]).html;
            let data = data_of(&html);
            assert_eq!(data["sources"][0]["notes"][0], note);
            data["tables"][0]["sentences"].to_string()
        };
        let chosen = "it holds no camera; chosen --eye 0,1,2";
        let sentence = format!("The camera is not the file's: {chosen}.");
        assert!(sentences(chosen).contains(&sentence));
        assert!(!sentences("its cameras, for --view: main").contains("not the file's"));
    }

    #[test]
    fn the_data_and_the_tables_are_pinned() {
        let html = page(&source(Path::new("nowhere"), sample()), &[stress()]).html;
        let text = serde_json::to_string_pretty(&data_of(&html)).unwrap();
        insta::assert_snapshot!("data", text);
        let tables = html.split("<table>").skip(1);
        let tables = tables.filter_map(|table| Some(table.split_once("</table>")?.0));
        insta::assert_snapshot!("tables", tables.collect::<Vec<_>>().join("\n"));
    }
}
