//! Plans of cells: the grid of a comparison as a file, one line of JSON for each cell, so that many
//! machines can each measure a part of it.
//!
//! ```
//! use skiagraph_compare::records::cell_plan::{CellPlan, Head};
//!
//! let head = Head::new(vec!["compare".into(), "rt".into()], None);
//! let plan = CellPlan { head, truths: Vec::new(), cells: Vec::new() };
//! let folder = tempfile::tempdir()?;
//! let file = folder.path().join("cells.jsonl");
//! std::fs::write(&file, plan.text())?;
//! let plan = CellPlan::read(&file)?;
//! plan.check_version(None)?;
//! assert!(plan.check_version(Some("4f0c1b2")).is_err(), "another commit");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::error::{CompareError, Result};
use crate::files::fingerprint::Fingerprint;
use crate::files::json::{Mistake, check_schema};
use crate::records::results::PROGRAM;
use crate::wording::{or_nothing, plural, size};
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use serde_json::Value;
use skiagraph_graph::SourceFile;
use skiagraph_scene::Limit;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path};

/// Name of the copy of the plan in a folder of cells.
pub const FILE: &str = "cells.jsonl";

/// The field `kind` of a plan's first line.
const KIND: &str = "cells";

/// Some hundred thousand cells.
const LIMIT: Limit = Limit {
    of: "a plan of cells",
    mib: 256,
    way_out: "plan fewer views, viewports or maps at once",
};

const HELP: &str = "`skiagraph compare … --plan FILE` writes it anew";
const SUMMARY: &str = "the plan cannot be used";

/// Cells of a comparison in the order in which one machine would measure them: scenes, views,
/// viewports, methods.
#[derive(Clone, Debug, PartialEq)]
pub struct CellPlan {
    /// First line of the file.
    pub head: Head,
    /// The reference's answers that the cells wait for, one for each scene, view and viewport.
    pub truths: Vec<PlannedTruth>,
    /// The cells, in the order in which one machine would measure them.
    pub cells: Vec<PlannedCell>,
}

/// First line of a plan: how it was made.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Head {
    /// Version of the format: 1.
    pub schema: u32,
    /// Kind of the file, always `cells`.
    pub kind: String,
    /// The program that wrote the plan, `skiagraph 0.1.0`. No other version measures it.
    pub program: String,
    /// Commit that the program was built from; absent where the program does not know it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub commit: Option<String>,
    /// Words of the command line, without the program's name and `--plan FILE`.
    pub arguments: Vec<String>,
    /// Number of cells in the file, so that a file that was cut off is recognised.
    pub cells: usize,
}

impl Head {
    /// Creates the first line of a plan that this program writes, of no cells yet. `arguments` are
    /// the words of the command line without the program's name, `commit` is the one that the
    /// program was built from.
    pub fn new(arguments: Vec<String>, commit: Option<String>) -> Self {
        Self {
            schema: 1,
            kind: KIND.into(),
            program: PROGRAM.into(),
            commit,
            arguments: without_plan(arguments),
            cells: 0,
        }
    }

    /// Returns the version of the program that wrote the plan, as messages show it.
    pub fn version(&self) -> String {
        version(&self.program, self.commit.as_deref())
    }
}

/// The words of a command line without `--plan FILE`.
fn without_plan(words: Vec<String>) -> Vec<String> {
    let mut words = words.into_iter();
    let mut kept = Vec::new();
    while let Some(word) = words.next() {
        if word == "--plan" {
            words.next();
        } else if !word.starts_with("--plan=") {
            kept.push(word);
        }
    }
    kept
}

/// The reference's answers for a scene from a view or path in a viewport.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlannedTruth {
    /// Id of the truth ([`cell::truth_id`](crate::measuring::cell::truth_id)).
    pub truth: String,
    /// Name of the scene.
    pub scene: String,
    /// Name of the scene's folder below that of all results; absent for a single scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub folder: Option<String>,
    /// Name of the view or camera path.
    pub view: String,
    /// Width and height of the viewport in pixels.
    pub viewport: [u32; 2],
    /// Number of frames: 1 for a still view.
    pub frames: u32,
}

/// One method in one setting on one view or path, in one viewport.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlannedCell {
    /// Id of the cell ([`cell::id`](crate::measuring::cell::id)).
    pub cell: String,
    /// Id of the truth that the cell waits for.
    pub truth: String,
    /// Name of the preset with its setting, as in results.
    pub preset: String,
    /// Width and height of the shadow map in texels; null where the graph has no such param.
    pub map_size: Option<u32>,
    /// All params of the graph with the values that it runs with.
    pub params: BTreeMap<String, Value>,
    /// Hash of everything but the params that the cell depends on, as in results.
    pub fingerprint: String,
}

/// A line of the file behind the first.
#[derive(Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
enum Line {
    Truth(PlannedTruth),
    Cell(PlannedCell),
}

impl CellPlan {
    /// Returns the text of the file: the first line, then each truth, followed by the cells that
    /// wait for it.
    pub fn text(&self) -> String {
        let head = Head {
            cells: self.cells.len(),
            ..self.head.clone()
        };
        let mut text = line(&head);
        for truth in &self.truths {
            text += &line(&Line::Truth(truth.clone()));
            let waiting = self.cells.iter().filter(|cell| cell.truth == truth.truth);
            text.extend(waiting.map(|cell| line(&Line::Cell(cell.clone()))));
        }
        text
    }

    /// Returns the hash of the plan, 16 hexadecimal digits.
    pub fn id(&self) -> String {
        Fingerprint::EMPTY.with_text(&self.text()).to_string()
    }

    /// Reads a plan.
    ///
    /// # Errors
    /// A file that cannot be read, that is not a plan, or that was cut off; a cell that is there
    /// twice, or waits for a truth that is not there. The message shows the place.
    pub fn read(path: &Path) -> Result<Self> {
        let name = path.display().to_string();
        let text = LIMIT.read_text(path);
        let text = text.map_err(|error| {
            let text = format!("cannot read the plan {name}: {error}; {HELP}");
            CompareError::Input(text)
        })?;
        parse(&text).map_err(|mistake| {
            let file = SourceFile::new(name, text);
            mistake.in_file(&file, "plan of cells", HELP, SUMMARY)
        })
    }

    /// Checks that this program wrote the plan; `commit` is the commit that this program was built
    /// from.
    ///
    /// # Errors
    /// Another version or commit.
    pub fn check_version(&self, commit: Option<&str>) -> Result<()> {
        let (theirs, ours) = (self.head.version(), version(PROGRAM, commit));
        if theirs == ours {
            return Ok(());
        }
        Err(CompareError::Input(format!(
            "the plan was written by {theirs}, and this is {ours}\n  one version measures all \
             cells: take that one, or plan anew with this one (--plan)"
        )))
    }

    /// Returns the truth that a cell waits for; `None` if the plan lacks that truth, which
    /// [`read`](Self::read) refuses.
    pub fn truth_of(&self, cell: &PlannedCell) -> Option<&PlannedTruth> {
        let mut truths = self.truths.iter();
        truths.find(|truth| truth.truth == cell.truth)
    }

    /// Returns the number of pixels of each cell, over all its frames, in the order of
    /// [`cells`](Self::cells).
    pub fn pixels(&self) -> Vec<u64> {
        let truths = self.truths.iter().map(|truth| {
            let [width, height] = truth.viewport.map(u64::from);
            let pixels = width * height * u64::from(truth.frames);
            (truth.truth.as_str(), pixels)
        });
        let by_truth: BTreeMap<&str, u64> = truths.collect();
        let cells = self.cells.iter();
        let pixels = cells.map(|cell| by_truth.get(&*cell.truth).copied().unwrap_or_default());
        pixels.collect()
    }

    /// Returns the name of a cell for messages: `nsm on main 512x256, map 1024`; of several scenes
    /// with the scene's folder before it.
    pub fn label(&self, cell: &PlannedCell) -> String {
        let map = or_nothing(cell.map_size, |n| format!(", map {n}"));
        let Some(truth) = self.truth_of(cell) else {
            return format!("{}{map}", cell.preset);
        };
        let folder = or_nothing(truth.folder.as_ref(), |name| format!("{name}: "));
        let (view, size) = (&truth.view, size(truth.viewport));
        format!("{folder}{} on {view} {size}{map}", cell.preset)
    }
}

/// Returns a version of the program as messages show it, with the commit that it was built from.
pub fn version(program: &str, commit: Option<&str>) -> String {
    let commit = or_nothing(commit, |commit| format!(" of commit {commit}"));
    format!("{program}{commit}")
}

fn line(record: &impl Serialize) -> String {
    let mut text =
        serde_json::to_string(record).expect("plain structs with string keys always serialise");
    text.push('\n');
    text
}

fn parse(text: &str) -> Result<CellPlan, Mistake> {
    let mut lines = text.split_inclusive('\n');
    let first = lines.next().unwrap_or_default();
    let mut at = first.len();
    let mut plan = CellPlan {
        head: head(first)?,
        truths: Vec::new(),
        cells: Vec::new(),
    };
    let (mut truths, mut cells) = (BTreeSet::new(), BTreeSet::new());
    for line in lines {
        let wrong = |what: String| Mistake::at_field(line, "{", what).behind(at);
        let twice = |what, id| wrong(format!("the {what} `{id}` is there twice, or not an id"));
        match from_line(line).map_err(|mistake: Mistake| mistake.behind(at))? {
            Line::Truth(truth) => {
                let folder = truth.folder.as_deref().unwrap_or("plain");
                if !is_plain(folder) {
                    return Err(wrong(format!("`{folder}` is not the name of a folder")));
                }
                if !is_id(&truth.truth) || !truths.insert(truth.truth.clone()) {
                    return Err(twice("truth", &truth.truth));
                }
                plan.truths.push(truth);
            }
            Line::Cell(cell) => {
                let id = &cell.cell;
                if !truths.contains(&cell.truth) {
                    let truth = &cell.truth;
                    return Err(wrong(format!(
                        "the cell `{id}` waits for the truth `{truth}`, which no line above names"
                    )));
                }
                if !is_id(id) || !cells.insert(id.clone()) {
                    return Err(twice("cell", id));
                }
                plan.cells.push(cell);
            }
        }
        at += line.len();
    }
    let (planned, listed) = (plan.head.cells, plan.cells.len());
    if planned == listed {
        return Ok(plan);
    }
    let what = format!(
        "its first line says {}, and {listed} are there: it was cut off, or lines were taken out",
        plural(planned, "cell")
    );
    Err(Mistake::at_field(text, "\"cells\":", what))
}

/// The first line. Any other file lacks many of its fields, and to name the first would mislead.
fn head(text: &str) -> Result<Head, Mistake> {
    #[derive(Deserialize)]
    struct Kind {
        schema: Option<Value>,
        kind: Option<Value>,
    }
    let Kind { schema, kind } = from_line(text)?;
    if kind != Some(KIND.into()) {
        let what = format!("its first line lacks \"kind\":\"{KIND}\"");
        return Err(Mistake::at_field(text, "\"kind\"", what));
    }
    check_schema(text, schema, 1)?;
    from_line(text)
}

fn from_line<T: DeserializeOwned>(line: &str) -> Result<T, Mistake> {
    serde_json::from_str(line).map_err(|error| Mistake::from_serde(line, &error))
}

/// True for 16 hexadecimal digits, which are part of a file's name.
fn is_id(text: &str) -> bool {
    text.len() == 16 && text.bytes().all(|byte| byte.is_ascii_hexdigit())
}

/// True for the name of a folder that lies in another.
fn is_plain(name: &str) -> bool {
    let parts: Vec<Component> = Path::new(name).components().collect();
    matches!(parts[..], [Component::Normal(_)])
}
