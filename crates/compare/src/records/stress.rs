//! The schema of `stress.json`, version 1, and its verdicts. Scripts rely on it: extend it, rename
//! nothing.
//!
//! ```
//! use skiagraph_compare::records::{read_back, stress::{Report, Verdict}};
//!
//! # let out = tempfile::tempdir()?;
//! # let pinned = "skiagraph_compare__records__stress__tests__the_schema_is_pinned";
//! # let pinned = std::fs::read_to_string(format!("src/records/snapshots/{pinned}.snap"))?;
//! # std::fs::write(out.path().join("stress.json"), &pinned[pinned.find('{').unwrap_or(0)..])?;
//! let report: Report = read_back::stress(out.path())?.ok_or("there is no stress.json")?;
//! for case in &report.cases {
//!     let failed = case.cells.iter().filter(|cell| cell.verdict == Verdict::Fail);
//!     println!("{}: {} failed", case.name, failed.count());
//! }
//! assert_eq!(report.count(Verdict::Fail), 2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::records::results::{Adapter, Images};
use serde::{Deserialize, Serialize};
use serde_json::Value;
pub use skiagraph_cases::Casters;
use skiagraph_reference::{PixelCounts, WrongCounts};
use std::collections::BTreeMap;

/// Results of the command `stress`: a matrix with a row per case and a column per method.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Report {
    /// Version of this schema: 1.
    pub schema: u32,
    /// The program that ran, `skiagraph 0.1.0`.
    pub program: String,
    /// GPU on which the cases ran.
    pub adapter: Adapter,
    /// Width and height of the viewport in pixels.
    pub viewport: [u32; 2],
    /// Methods, the columns of the matrix.
    pub methods: Vec<Column>,
    /// Finished cases, the rows of the matrix, in the order of the catalogue or of the command
    /// line.
    pub cases: Vec<Case>,
}

/// A method of the `stress` matrix, as one of its columns.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Column {
    /// Name of the preset, or path of the graph.
    pub preset: String,
    /// Width and height of the shadow map in texels (the param `map_size`); null where the graph
    /// has no such param.
    pub map_size: Option<u32>,
    /// All params of the graph with the values that it runs with. A [`Cell`] with
    /// [`set`](Cell::set) differs in that one param.
    pub params: BTreeMap<String, Value>,
    /// Pixels that the method guarantees to be right; null where nothing is guaranteed.
    #[serde(rename = "promise")]
    pub guarantee: Option<Guarantee>,
    /// Reason for the guarantee; null where nothing is guaranteed.
    pub because: Option<String>,
    /// Reason why the method cannot run on this adapter, so that it has no results; absent where it
    /// can.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unavailable: Option<String>,
}

/// Set of pixels that a method guarantees to be right, outside the band (the pixels whose answer
/// rounding decides).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Guarantee {
    /// All pixels of the final picture, but for those whose answer rounding decides.
    Exact,
    /// Only the pixels that the method calls certain by its output `status`, but for those whose
    /// answer rounding decides.
    Certain,
}

impl Guarantee {
    /// Returns the word for headers: `exact` or `certain`.
    pub fn word(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Certain => "certain",
        }
    }
}

/// A case with the results of all methods, as a row of the matrix.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Case {
    /// Name of the case in the catalogue.
    pub name: String,
    /// Fault in shadow methods that the case provokes, as a line of text.
    pub reason: String,
    /// Kind of the case's casters: closed or open.
    pub casters: Casters,
    /// Greatest share of the pixels facing the light, 0 to 1, that may be in the band (the pixels
    /// whose answer rounding decides).
    pub band_cap: f64,
    /// Verdict on the case itself: `Fail` if the band (the pixels whose answer rounding decides) is
    /// above `band_cap` or the case has no reference, otherwise `Pass`.
    pub verdict: Verdict,
    /// Reason why the case has no reference, and so no results of methods; absent where it has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failed: Option<String>,
    /// Numbers of the viewport's pixels by the [reference](crate#terms)'s answer.
    pub pixels: PixelCounts,
    /// Number of pixels in the [band](crate#terms): those facing the light whose right answer flips
    /// when the receiver (the point that the pixel shows) or the casters move within their f32
    /// rounding error.
    pub band: u64,
    /// Number of pixels for which the GPU rasterised a triangle that is hidden behind another one,
    /// by more than rounding explains.
    pub wrong_surface: u64,
    /// Results of the methods, in the order of [`Report::methods`]. A method that is `unavailable`
    /// or does not take the case's kind of light has none; one that failed on this case has one,
    /// with `failed`. On open casters a method that culls faces and guarantees something has a
    /// second one behind its first, with `cull=none` (front and back faces cast shadows). Empty if
    /// the case has no reference.
    pub cells: Vec<Cell>,
}

/// Result of one method on one case of the stress catalogue.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Cell {
    /// Name of the preset, or path of the graph.
    pub preset: String,
    /// Width and height of the shadow map in texels (the param `map_size`); null where the graph
    /// has no such param.
    pub map_size: Option<u32>,
    /// Assignment in which this run of the method differs from its params: `cull=none`. Null if
    /// there is none.
    pub set: Option<String>,
    /// Verdict on the method on this case.
    pub verdict: Verdict,
    /// Counts of the method's wrong and uncertain pixels; absent where the method could not run.
    #[serde(flatten)]
    pub counts: Option<Counts>,
    /// Reason why the method failed on this case; absent where it ran.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failed: Option<String>,
    /// File names of the method's pictures of this case in the folder of `--save`; absent without
    /// pictures.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub images: Option<Images>,
}

/// Verdict on one method on one case, or on a case itself: its band, the pixels whose answer
/// rounding decides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The guarantee holds.
    Pass,
    /// The guarantee is broken, or the method could not run.
    Fail,
    /// Not judged: the case has open casters, and the method's guarantee holds for closed casters
    /// only.
    Open,
    /// Not judged: the method guarantees nothing, or only the pixels that its output `status` calls
    /// certain, and there are none.
    Unjudged,
}

/// Counts of a method's wrong and uncertain pixels on one case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Counts {
    /// Numbers of the pixels on which method and reference disagree.
    pub wrong: WrongCounts,
    /// Numbers of the wrong pixels that are not in the band (the pixels whose answer rounding
    /// decides).
    pub outside_band: OutsideBand,
    /// Number of pixels facing the light that the method calls uncertain: its shadow map does not
    /// decide them, so that it traces rays or guesses.
    pub uncertain: u64,
    /// Uncertain pixels as a share of the pixels facing the light, 0 to 1.
    pub uncertain_share: f64,
    /// Number of rays traced; null where the graph does not count them.
    pub rays: Option<u64>,
}

/// Numbers of the wrong pixels outside the band (the pixels whose answer rounding decides).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct OutsideBand {
    /// Number of pixels that are lit by the method, but not by the [reference](crate#terms),
    /// without those whose answer rounding decides.
    pub lit: u64,
    /// Number of pixels that are in shadow by the method, but lit by the [reference](crate#terms),
    /// without those whose answer rounding decides.
    pub shadow: u64,
    /// Number of wrong pixels of both kinds that the method called certain by its output `status`,
    /// without those whose answer rounding decides.
    pub certain: u64,
}

impl OutsideBand {
    /// True if any of these wrong pixels breaks the guarantee: any for `Exact`, one that the method
    /// called certain for `Certain`.
    pub fn breaks(&self, guarantee: Guarantee) -> bool {
        match guarantee {
            Guarantee::Exact => self.lit + self.shadow > 0,
            Guarantee::Certain => self.certain > 0,
        }
    }
}

impl Verdict {
    /// Judges a method that ran on a case with these casters. `culls` is true if the method culls
    /// faces from its shadow map; the guarantee then does not cover open casters. `certain` is the
    /// number of pixels that the method calls certain; `outside` counts its wrong pixels outside
    /// the band (the pixels whose answer rounding decides).
    pub fn new(
        guarantee: Option<Guarantee>,
        culls: bool,
        casters: Casters,
        certain: u64,
        outside: &OutsideBand,
    ) -> Self {
        match guarantee {
            None => Self::Unjudged,
            Some(_) if culls && casters == Casters::Open => Self::Open,
            Some(Guarantee::Certain) if certain == 0 => Self::Unjudged,
            Some(guarantee) if outside.breaks(guarantee) => Self::Fail,
            Some(_) => Self::Pass,
        }
    }
}

impl Cell {
    /// True if the cell has the preset and map size of `column`.
    pub fn is_of(&self, column: &Column) -> bool {
        (&self.preset, self.map_size) == (&column.preset, column.map_size)
    }
}

impl Case {
    /// True if more than the share `band_cap` of the pixels facing the light is in the band, the
    /// pixels whose answer rounding decides. Such a case proves little.
    pub fn exceeds_cap(&self) -> bool {
        self.band as f64 > self.band_cap * self.pixels.facing_light as f64
    }

    /// True if a method with a shadow map called all pixels facing the light uncertain, so that a
    /// right answer does not test its map.
    pub fn is_left_to_rays(&self, cell: &Cell) -> bool {
        let facing = self.pixels.facing_light;
        let of_all = |counts: &Counts| facing > 0 && counts.uncertain == facing;
        cell.map_size.is_some() && cell.counts.as_ref().is_some_and(of_all)
    }
}

impl Report {
    /// Returns the number of results (one method on one case) with the verdict `verdict`.
    pub fn count(&self, verdict: Verdict) -> usize {
        let cells = self.cases.iter().flat_map(|case| &case.cells);
        cells.filter(|cell| cell.verdict == verdict).count()
    }

    /// Returns the number of results (one method on one case) that passed although the method
    /// called all pixels facing the light uncertain, so that its shadow map was not tested.
    pub fn left_to_rays(&self) -> usize {
        let cases = self.cases.iter();
        let cells = cases.flat_map(|case| case.cells.iter().map(move |cell| (case, cell)));
        let passed = cells.filter(|(_, cell)| cell.verdict == Verdict::Pass);
        let left = passed.filter(|(case, cell)| case.is_left_to_rays(cell));
        left.count()
    }

    /// Returns the number of cases with the [verdict](Case::verdict) `Fail`: too many of their
    /// pixels are decided by rounding, or they have no reference.
    pub fn failed_cases(&self) -> usize {
        let failed = |case: &&Case| case.verdict == Verdict::Fail;
        self.cases.iter().filter(failed).count()
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::files::json;
    use crate::records::results::tests::adapter;

    fn cell(preset: &str, verdict: Verdict, outside: [u64; 3]) -> Cell {
        let [lit, shadow, certain] = outside;
        let wrong = WrongCounts {
            lit: lit + 1,
            shadow,
            total: lit + shadow + 1,
            certain,
            in_band: 1,
        };
        Cell {
            preset: preset.into(),
            map_size: (preset != "rt").then_some(128),
            set: None,
            verdict,
            counts: Some(Counts {
                wrong,
                outside_band: OutsideBand {
                    lit,
                    shadow,
                    certain,
                },
                uncertain: 250,
                uncertain_share: 0.25,
                rays: Some(250),
            }),
            failed: None,
            images: None,
        }
    }

    fn case(name: &str, casters: Casters, band: u64, cells: Vec<Cell>) -> Case {
        let mut case = Case {
            name: name.into(),
            reason: format!("what {name} provokes"),
            casters,
            band_cap: 0.005,
            verdict: Verdict::Pass,
            failed: None,
            pixels: PixelCounts {
                background: 500,
                facing_away: 200,
                facing_light: 1000,
                lit: 600,
                shadow: 400,
            },
            band,
            wrong_surface: 0,
            cells,
        };
        if case.exceeds_cap() {
            case.verdict = Verdict::Fail;
        }
        case
    }

    /// A report with everything that can occur.
    pub(crate) fn sample() -> Report {
        let column = |preset: &str, guarantee: Option<Guarantee>| Column {
            preset: preset.into(),
            map_size: (preset != "rt").then_some(128),
            params: BTreeMap::from([("cull".into(), "front".into())]),
            guarantee,
            because: guarantee.map(|_| "it is proven".into()),
            unavailable: (preset == "crsm_hw").then(|| "needs what is not here".into()),
        };
        let exact = Some(Guarantee::Exact);
        let mut uncertain = Cell {
            set: Some("cull=none".into()),
            ..cell("crsm", Verdict::Pass, [0; 3])
        };
        if let Some(counts) = &mut uncertain.counts {
            (counts.uncertain, counts.uncertain_share) = (1000, 1.0);
        }
        let unreferenced = Case {
            verdict: Verdict::Fail,
            failed: Some("the light is nowhere".into()),
            pixels: PixelCounts::default(),
            ..case("nothing", Casters::Closed, 0, Vec::new())
        };
        Report {
            schema: 1,
            program: "skiagraph 0.1.0".into(),
            adapter: adapter(),
            viewport: [128, 96],
            methods: vec![
                column("rt", exact),
                column("nsm", None),
                column("crsm", exact),
                column("crsm_hw", exact),
            ],
            cases: vec![
                case(
                    "needles",
                    Casters::Closed,
                    5,
                    vec![
                        Cell {
                            counts: None,
                            failed: Some("out of memory".into()),
                            ..cell("rt", Verdict::Fail, [0; 3])
                        },
                        cell("nsm", Verdict::Unjudged, [12, 3, 15]),
                        cell("crsm", Verdict::Fail, [0, 3, 2]),
                    ],
                ),
                case(
                    "sheet",
                    Casters::Open,
                    6,
                    vec![
                        cell("rt", Verdict::Pass, [0; 3]),
                        cell("nsm", Verdict::Unjudged, [0; 3]),
                        cell("crsm", Verdict::Open, [40, 0, 40]),
                        uncertain,
                    ],
                ),
                unreferenced,
            ],
        }
    }

    #[test]
    fn the_schema_is_pinned() {
        insta::assert_snapshot!(json::to_text(&sample()));
    }

    #[test]
    fn only_what_is_guaranteed_is_judged() {
        use Verdict::{Fail, Open, Pass, Unjudged};
        let (right, guessed) = (
            OutsideBand::default(),
            OutsideBand {
                lit: 1,
                ..OutsideBand::default()
            },
        );
        let certain = OutsideBand {
            shadow: 1,
            certain: 1,
            ..OutsideBand::default()
        };
        let exact = Some(Guarantee::Exact);
        let only_certain = Some(Guarantee::Certain);
        for (guarantee, culls, casters, outside, verdict) in [
            (None, false, Casters::Closed, certain, Unjudged),
            (None, true, Casters::Open, certain, Unjudged),
            (exact, false, Casters::Closed, right, Pass),
            (exact, true, Casters::Closed, right, Pass),
            (exact, true, Casters::Closed, guessed, Fail),
            (exact, false, Casters::Open, guessed, Fail),
            (exact, false, Casters::Open, right, Pass),
            (exact, true, Casters::Open, certain, Open),
            (exact, true, Casters::Open, right, Open),
            (only_certain, true, Casters::Closed, guessed, Pass),
            (only_certain, true, Casters::Closed, certain, Fail),
            (only_certain, false, Casters::Open, certain, Fail),
            (only_certain, true, Casters::Open, certain, Open),
        ] {
            let judged = Verdict::new(guarantee, culls, casters, 7, &outside);
            assert_eq!(
                judged, verdict,
                "{guarantee:?} {culls} {casters:?} {outside:?}"
            );
        }
        for (guarantee, verdict) in [(exact, Pass), (only_certain, Unjudged)] {
            let judged = Verdict::new(guarantee, true, Casters::Closed, 0, &right);
            assert_eq!(judged, verdict, "nothing is certain, {guarantee:?}");
        }
    }

    #[test]
    fn a_band_may_reach_its_cap_and_not_pass_it() {
        let exceeds = |band| case("a", Casters::Closed, band, Vec::new()).exceeds_cap();
        assert_eq!([0, 5, 6].map(exceeds), [false, false, true]);
        let nothing = Case {
            pixels: PixelCounts::default(),
            ..case("nothing", Casters::Closed, 0, Vec::new())
        };
        assert!(!nothing.exceeds_cap(), "no pixel faces the light");
    }
}
