//! Writes a plan as a graph of nodes and links for Graphviz.

use crate::drawing::{Access, Drawing, Edge, Material, Origin, Pass};
use crate::{text, words};
use skiagraph_graph::Hazard;
use std::collections::{BTreeMap, HashMap, HashSet};

/// Returns the drawing as text in Graphviz's DOT language. Passes are boxes, and materials that a
/// pass uses are ellipses; passes that do not run are dashed. Passes and materials whose names have
/// the same prefix, such as `eye` in `eye.draw`, form a cluster.
pub fn to_dot(drawing: &Drawing) -> String {
    render(drawing).join("\n") + "\n"
}

fn render(drawing: &Drawing) -> Vec<String> {
    let materials = drawing.by_name();
    let mut root = Cluster::default();
    for pass in &drawing.passes {
        root.at(&pass.name).nodes.push(pass_node(pass));
    }
    let touched = drawing.accesses.iter();
    let touched: HashSet<&str> = touched.map(|access| &*access.material).collect();
    for material in &drawing.materials {
        if touched.contains(&*material.name) {
            let cluster = if is_own(material, &materials) {
                root.at(&material.name)
            } else {
                &mut root
            };
            cluster.nodes.push(material_node(material));
        }
    }
    let title = quoted(&drawing.title);
    let mut lines = vec![
        format!("digraph {title} {{"),
        format!("  label={title}; labelloc=t;"),
        "  node [fontname=\"sans-serif\"]; edge [fontname=\"sans-serif\"];".to_owned(),
    ];
    root.write(&mut lines, "", "  ");
    let accesses = drawing.accesses.iter();
    lines.extend(accesses.map(|access| link(access, materials.get(&*access.material))));
    let edges = drawing.edges.iter().filter(|edge| !edge.implied);
    lines.extend(edges.flat_map(order));
    lines.push("}".to_owned());
    lines
}

/// Nodes and inner clusters below one prefix.
#[derive(Default)]
struct Cluster {
    inner: BTreeMap<String, Cluster>,
    nodes: Vec<String>,
}

impl Cluster {
    fn at<'c>(&'c mut self, name: &str) -> &'c mut Self {
        let prefixes = words::split(name).0.split('.');
        let prefixes = prefixes.filter(|prefix| !prefix.is_empty());
        prefixes.fold(self, |cluster, prefix| {
            cluster.inner.entry(prefix.to_owned()).or_default()
        })
    }

    fn write(&self, lines: &mut Vec<String>, path: &str, indent: &str) {
        lines.extend(self.nodes.iter().map(|node| format!("{indent}{node}")));
        for (prefix, inner) in &self.inner {
            let path = format!("{path}{prefix}.");
            let (id, label) = (quoted(&format!("cluster_{path}")), quoted(prefix));
            lines.push(format!("{indent}subgraph {id} {{"));
            lines.push(format!("{indent}  label={label}; color=\"#999999\";"));
            inner.write(lines, &path, &format!("{indent}  "));
            lines.push(format!("{indent}}}"));
        }
    }
}

/// Returns true if the dots in a name are those of the document's includes and groups.
fn is_own(material: &Material, materials: &HashMap<&str, &Material>) -> bool {
    match material.origin {
        Origin::Declared | Origin::Constant | Origin::Scratch => true,
        Origin::Previous => {
            let base = material.name.strip_suffix(words::PREVIOUS);
            let base = base.and_then(|base| materials.get(base));
            base.is_some_and(|base| base.origin == Origin::Declared)
        }
        Origin::Capture | Origin::Provided | Origin::Imported | Origin::Frame => false,
    }
}

/// A quoted string in which nothing is a command to Graphviz; line ends stay line ends.
fn quoted(text: &str) -> String {
    let text = text.replace('\\', "\\\\").replace('"', "\\\"");
    format!("\"{}\"", text.replace('\n', "\\n"))
}

fn id(what: &str, name: &str) -> String {
    quoted(&format!("{what} {name}"))
}

fn pass_node(pass: &Pass) -> String {
    let mut label = format!("{}\n{}", pass.name, pass.kind);
    if let Some(why) = &pass.culled {
        let why = text::wrap(why, 10.0, 260.0).join("\n");
        label.push_str(&format!(", culled:\n{why}"));
    }
    let style = match pass.culled {
        Some(_) => "dashed",
        None => "filled",
    };
    format!(
        "{} [shape=box, style={style}, fillcolor=\"#eeeeee\", label={}];",
        id("pass", &pass.name),
        quoted(&label)
    )
}

fn material_node(material: &Material) -> String {
    let (style, fill) = match material.lifetime {
        None => ("dashed", "#ffffff"),
        Some(_) if material.origin.is_given() => ("filled", "#dddddd"),
        Some(_) if material.format.is_some() => ("filled", "#bfe1f5"),
        Some(_) => ("filled", "#b3dfd2"),
    };
    let bold = match &material.outputs[..] {
        [] => "",
        _ => ",bold",
    };
    format!(
        "{} [shape=ellipse, style=\"{style}{bold}\", fillcolor=\"{fill}\", label={}];",
        id("material", &material.name),
        quoted(&format!("{}\n{}", material.name, words::detail(material)))
    )
}

/// Returns the edge of an access, with the part if it is not the whole.
fn link(access: &Access, material: Option<&&Material>) -> String {
    let (pass, resource) = (id("pass", &access.pass), id("material", &access.material));
    let ends = match (access.reads, access.writes) {
        (false, true) => format!("{pass} -> {resource}"),
        _ => format!("{resource} -> {pass}"),
    };
    let both = (access.reads && access.writes).then(|| "dir=both".to_owned());
    let part = access.part.as_ref().zip(material);
    let part = part.map(|(part, whole)| format!("label={}", quoted(&words::part(part, whole))));
    let attributes: Vec<String> = both.into_iter().chain(part).collect();
    format!("  {ends} [{}];", attributes.join(", "))
}

/// Why two passes keep their order, where no material that one hands to the other says so.
fn order(edge: &Edge) -> impl Iterator<Item = String> {
    let (from, to) = (id("pass", &edge.from), id("pass", &edge.to));
    let reasons = edge.because.iter();
    let reasons = reasons.filter(|reason| reason.hazard != Hazard::ReadAfterWrite);
    reasons.map(move |reason| {
        let verb = words::consequence(reason.hazard);
        let label = quoted(&format!("{verb}: {}", reason.materials.join(", ")));
        format!("  {from} -> {to} [style=dashed, color=\"#d55e00\", tooltip={label}];")
    })
}
