//! Chooses the pictures of a page, those of the reference and of errors first, as far as there is
//! room.

use crate::html::first::error_of_frame;
use crate::notes::map_figures;
use base64::{Engine, engine::general_purpose::STANDARD};
use itertools::Itertools;
use serde::Serialize;
use skiagraph_compare::lists::find_or_push;
use skiagraph_compare::pictures::run_pictures::graph_name;
use skiagraph_compare::records::results::{Images, Run};
use skiagraph_compare::records::sources::Source;
use skiagraph_compare::wording::plural;
use std::{collections::BTreeMap, fs};

// Kinds of pictures that are not like the others.
const REFERENCE: &str = "reference";
const GRAPH: &str = "graph";
const VISIBILITY: &str = "visibility";
const TEXELS: &str = "texels";
const SECOND: &str = "worst second";

/// Embedded files of a page. Other structs refer to a file by its index in `files`.
#[derive(Debug, Default, Serialize)]
pub struct Pictures {
    /// One set for each run that has pictures, and one for each picture of a reference.
    pub sets: Vec<Set>,
    /// Drawings of graphs, one for each source and method.
    pub graphs: Vec<Graph>,
    /// Contents of the files, in Base64.
    pub files: Vec<String>,
    /// Lines that count the pictures left out because the page is full; empty if there are none.
    #[serde(skip)]
    pub left_out: Vec<String>,
}

/// Pictures of one run, or of the reference, as indices of files.
#[derive(Debug, Default, Serialize)]
pub struct Set {
    source: usize,
    view: String,
    viewport: [u32; 2],
    /// Method and map in words; none of the reference.
    label: Option<String>,
    /// Frame of a camera path that it shows, counted from 0.
    frame: Option<usize>,
    /// Error of the method in that frame, in words.
    frame_error: Option<String>,
    /// By kind.
    #[serde(flatten)]
    files: BTreeMap<&'static str, usize>,
    /// The frames of a path's worst second.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    second: Vec<usize>,
    /// Figures of its map's texels, in words.
    figures: Option<String>,
    /// True if its answer is a share of light.
    graded: bool,
}

/// Drawing of a method's graph.
#[derive(Debug, Serialize)]
pub struct Graph {
    source: usize,
    method: String,
    file: usize,
}

/// The error of a run in the frame that its pictures show; `None` for a still view.
fn frame_error(run: &Run) -> Option<String> {
    let measured = run.measured.as_ref()?;
    let frame = measured.images.as_ref()?.frame?;
    let frame = measured.sequence.as_ref()?.frames.get(frame)?;
    Some(error_of_frame(frame, run.is_hard()))
}

/// A file that could go in.
struct EmbedCandidate {
    source: usize,
    run: usize,
    /// Its place among the kinds, and its kind in words.
    kind: (usize, &'static str),
    name: String,
    /// Frame of a camera path that it shows.
    frame: Option<usize>,
}

impl Pictures {
    /// Embeds the pictures in the sources' folders, using at most `room` bytes of the page: those
    /// of the references first, then errors, shaded pictures, graphs and the others. Missing files
    /// are skipped without a message.
    pub fn embed(sources: &[Source], mut room: usize) -> Self {
        let mut pictures = Self::default();
        let mut candidates = candidates(sources);
        candidates.sort_by_key(|candidate| candidate.kind);
        let mut left_out: BTreeMap<&str, usize> = BTreeMap::new();
        for file in &candidates {
            let source = &sources[file.source];
            let path = source.folder_of(file.run).join(&file.name);
            let Ok(length) = fs::metadata(&path).map(|metadata| metadata.len() as usize) else {
                continue;
            };
            // Its letters, and what names it.
            let cost = length.div_ceil(3) * 4 + 400;
            if cost > room {
                *left_out.entry(file.kind.1).or_default() += 1;
                continue;
            }
            let Ok(bytes) = fs::read(&path) else {
                continue;
            };
            room -= cost;
            pictures.files.push(STANDARD.encode(bytes));
            pictures.place(source, file);
        }
        if !left_out.is_empty() {
            let count: usize = left_out.values().sum();
            let mut each = left_out.iter().map(|(kind, n)| format!("{n} of {kind}"));
            pictures.left_out.push(format!(
                "{} had no room in this page: {}; they are in the folders of the results",
                plural(count, "picture"),
                each.join(", ")
            ));
        }
        pictures
    }

    /// The newest file, where it belongs.
    fn place(&mut self, source: &Source, candidate: &EmbedCandidate) {
        let file = self.files.len() - 1;
        let run = &source.results.runs[candidate.run];
        let (source, frame, (_, kind)) = (candidate.source, candidate.frame, candidate.kind);
        if kind == GRAPH {
            let method = run.preset.clone();
            self.graphs.push(Graph {
                source,
                method,
                file,
            });
            return;
        }
        let label = (kind != REFERENCE).then(|| run.method_label());
        let key = (source, &run.view, run.viewport, &label, frame);
        let is_of = |set: &Set| (set.source, &set.view, set.viewport, &set.label, set.frame) == key;
        let set = find_or_push(&mut self.sets, is_of, || Set {
            source,
            view: run.view.clone(),
            viewport: run.viewport,
            label: label.clone(),
            frame,
            frame_error: frame_error(run).filter(|_| label.is_some()),
            graded: !run.is_hard(),
            ..Set::default()
        });
        if kind == SECOND {
            set.second.push(file);
            return;
        }
        if kind == TEXELS {
            set.figures = map_figures(run);
        }
        let kind = if kind == REFERENCE { VISIBILITY } else { kind };
        set.files.insert(kind, file);
    }
}

fn candidates(sources: &[Source]) -> Vec<EmbedCandidate> {
    let mut candidates: Vec<EmbedCandidate> = Vec::new();
    for (index, source) in sources.iter().enumerate() {
        for (number, run) in source.results.runs.iter().enumerate() {
            let measured = run.measured.as_ref();
            let Some(images) = measured.and_then(|measured| measured.images.as_ref()) else {
                continue;
            };
            for (kind, name) in names(run, images) {
                let is_shared = [REFERENCE, GRAPH].contains(&kind.1);
                let is_known =
                    |earlier: &EmbedCandidate| (earlier.source, &earlier.name) == (index, &name);
                if !is_shared || !candidates.iter().any(is_known) {
                    candidates.push(EmbedCandidate {
                        source: index,
                        run: number,
                        kind,
                        name,
                        frame: images.frame,
                    });
                }
            }
        }
    }
    candidates
}

/// The pictures of a run with their kinds, the most telling kind first.
fn names(run: &Run, images: &Images) -> impl Iterator<Item = ((usize, &'static str), String)> {
    let one = |name: &String| vec![name.clone()];
    let optional = |name: &Option<String>| name.iter().cloned().collect();
    let kinds = [
        (REFERENCE, one(&images.reference)),
        ("error", one(&images.error)),
        ("shaded", one(&images.shaded)),
        (GRAPH, vec![graph_name(&run.preset)]),
        (VISIBILITY, one(&images.visibility)),
        ("uncertain", optional(&images.uncertain)),
        (TEXELS, optional(&images.texels)),
        ("perspective", optional(&images.perspective)),
        ("projection", optional(&images.projection)),
        (SECOND, images.worst_second.clone()),
    ];
    let kinds = kinds.into_iter().enumerate();
    kinds
        .flat_map(|(place, (kind, names))| names.into_iter().map(move |name| ((place, kind), name)))
}
