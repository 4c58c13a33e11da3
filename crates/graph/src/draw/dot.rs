//! The plan as nodes and links, for Graphviz.

use super::{Access, Drawing, Hazard, Material, Origin, text, words};
use std::{collections::BTreeMap, fmt::Write};

/// What stands below one prefix.
#[derive(Default)]
struct Cluster {
    inner: BTreeMap<String, Cluster>,
    nodes: Vec<String>,
}

impl Cluster {
    fn at<'c>(&'c mut self, name: &str) -> &'c mut Self {
        let prefixes = name.rsplit_once('.').map_or("", |(prefixes, _)| prefixes);
        prefixes
            .split('.')
            .filter(|prefix| !prefix.is_empty())
            .fold(self, |cluster, prefix| {
                cluster.inner.entry(prefix.to_owned()).or_default()
            })
    }

    fn write(&self, out: &mut String, path: &str, depth: usize) {
        let indent = "  ".repeat(depth);
        for node in &self.nodes {
            line(out, format_args!("{indent}{node}"));
        }
        for (prefix, inner) in &self.inner {
            let path = format!("{path}{prefix}.");
            line(
                out,
                format_args!("{indent}subgraph {} {{", quoted(&format!("cluster_{path}"))),
            );
            line(
                out,
                format_args!("{indent}  label={}; color=\"#999999\";", quoted(prefix)),
            );
            inner.write(out, &path, depth + 1);
            line(out, format_args!("{indent}}}"));
        }
    }
}

fn line(out: &mut String, arguments: std::fmt::Arguments<'_>) {
    out.write_fmt(arguments)
        .expect("a String takes all that is written");
    out.push('\n');
}

/// A quoted string in which nothing is a command to Graphviz; line ends stay line ends.
fn quoted(text: &str) -> String {
    format!(
        "\"{}\"",
        text.replace('\\', "\\\\")
            .replace('"', "\\\"")
            .replace('\n', "\\n")
    )
}

pub(super) fn render(drawing: &Drawing) -> String {
    let mut out = String::new();
    line(
        &mut out,
        format_args!("digraph {} {{", quoted(&drawing.title)),
    );
    line(
        &mut out,
        format_args!("  label={}; labelloc=t;", quoted(&drawing.title)),
    );
    line(
        &mut out,
        format_args!("  node [fontname=\"sans-serif\"]; edge [fontname=\"sans-serif\"];"),
    );
    let mut root = Cluster::default();
    for pass in &drawing.passes {
        let (style, note) = match &pass.culled {
            None => ("filled", pass.kind.clone()),
            Some(why) => (
                "dashed",
                format!(
                    "{}, culled:\n{}",
                    pass.kind,
                    text::wrap(why, 10.0, 260.0).join("\n")
                ),
            ),
        };
        let node = format!(
            "{} [shape=box, style={style}, fillcolor=\"#eeeeee\", label={}];",
            id("pass", &pass.name),
            quoted(&format!("{}\n{note}", pass.name))
        );
        root.at(&pass.name).nodes.push(node);
    }
    let touched = |material: &&Material| {
        drawing
            .accesses
            .iter()
            .any(|access| access.material == material.name)
    };
    for material in drawing.materials.iter().filter(touched) {
        let mut style = match material.lifetime {
            Some(_) => "filled",
            None => "dashed",
        }
        .to_owned();
        if !material.outputs.is_empty() {
            style.push_str(",bold");
        }
        let node = format!(
            "{} [shape=ellipse, style=\"{style}\", fillcolor={}, label={}];",
            id("material", &material.name),
            quoted(fill(material)),
            quoted(&format!("{}\n{}", material.name, words::detail(material)))
        );
        match material.origin {
            Origin::Declared => root.at(&material.name).nodes.push(node),
            // Dots in these names are no prefixes of includes.
            _ => root.nodes.push(node),
        }
    }
    root.write(&mut out, "", 1);
    for access in &drawing.accesses {
        let (pass, material) = (id("pass", &access.pass), id("material", &access.material));
        let links = match (access.reads, access.writes) {
            (true, true) => format!("{material} -> {pass} [dir=both"),
            (false, true) => format!("{pass} -> {material} ["),
            _ => format!("{material} -> {pass} ["),
        };
        line(
            &mut out,
            format_args!("  {links}{}];", part(access, drawing)),
        );
    }
    for edge in drawing.edges.iter().filter(|edge| !edge.implied) {
        for reason in edge
            .because
            .iter()
            .filter(|reason| reason.hazard != Hazard::ReadAfterWrite)
        {
            let label = format!("{}: {}", reason.hazard.verb(), reason.materials.join(", "));
            line(
                &mut out,
                format_args!(
                    "  {} -> {} [style=dashed, color=\"#d55e00\", tooltip={}];",
                    id("pass", &edge.from),
                    id("pass", &edge.to),
                    quoted(&label)
                ),
            );
        }
    }
    out.push_str("}\n");
    out
}

fn id(what: &str, name: &str) -> String {
    quoted(&format!("{what} {name}"))
}

fn fill(material: &Material) -> &'static str {
    match material.origin {
        _ if material.lifetime.is_none() => "#ffffff",
        Origin::Provided | Origin::Imported | Origin::Previous => "#dddddd",
        _ if material.format.is_some() => "#bfe1f5",
        _ => "#b3dfd2",
    }
}

/// The part as a label, if it is not the whole.
fn part(access: &Access, drawing: &Drawing) -> String {
    let material = drawing
        .materials
        .iter()
        .find(|material| material.name == access.material);
    let label = access
        .part
        .as_ref()
        .zip(material)
        .map(|(part, material)| words::part(part, material));
    let comma = if access.reads && access.writes {
        ", "
    } else {
        ""
    };
    label.map_or(String::new(), |label| {
        format!("{comma}label={}", quoted(&label))
    })
}
