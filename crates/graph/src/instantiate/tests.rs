//! An included document behaves as if its text stood in the place of the include, with its names changed.

use crate::{Code, Graph, NoProvider, Plan, PlanRequest, Registry, Sources};
use proptest::prelude::*;
use std::{collections::BTreeMap, fmt::Write as _, sync::Arc};

struct Files(BTreeMap<&'static str, String>);

impl Sources for Files {
    fn read(&self, path: &str) -> Result<Option<Arc<str>>, String> {
        Ok(self.0.get(path).map(|text| text.as_str().into()))
    }

    fn list(&self, _: &str) -> Vec<String> {
        Vec::new()
    }
}

/// A pass over materials by number: those below [`OWN`] are the document's own, the others the including document's.
#[derive(Clone, Debug)]
enum Pass {
    Fill(usize),
    Blur(usize, usize),
    Copy(usize, usize),
    Draw(usize),
}

impl Pass {
    fn is_loop(&self) -> bool {
        matches!(self, Self::Blur(from, to) | Self::Copy(from, to) if from == to)
    }

    /// Of the outer document: reads what the inner one has yet to write.
    fn reads_inner(&self) -> bool {
        matches!(self, Self::Blur(from, _) | Self::Copy(from, _) | Self::Draw(from) if *from >= OWN)
    }
}

/// Materials of either document.
const OWN: usize = 3;

fn pass() -> impl Strategy<Value = Pass> {
    let any = || 0..2 * OWN;
    prop_oneof![
        any().prop_map(Pass::Fill),
        (any(), any()).prop_map(|(from, to)| Pass::Blur(from, to)),
        (any(), any()).prop_map(|(from, to)| Pass::Copy(from, to)),
        any().prop_map(Pass::Draw),
    ]
}

/// How the one document includes the other.
#[derive(Clone, Debug)]
struct Shape {
    prefix: bool,
    /// The inner material 0 is the outer one of this number, or gets a name that is free.
    renamed: Option<Option<usize>>,
    above: Vec<Pass>,
    inner: Vec<Pass>,
    below: Vec<Pass>,
}

fn shape() -> impl Strategy<Value = Shape> {
    let passes = || prop::collection::vec(pass(), 0..5);
    let renamed = prop::option::of(prop::option::of(0..OWN));
    let flags = (any::<bool>(), prop::bool::weighted(0.8));
    (flags, renamed, passes(), passes(), passes()).prop_map(
        |((prefix, filled), renamed, mut above, mut inner, below)| {
            if filled {
                // Else most documents read what nobody wrote.
                above.splice(0..0, (0..OWN).map(Pass::Fill));
                inner.splice(0..0, (0..OWN).map(Pass::Fill));
                above.retain(|pass| !pass.is_loop() && !pass.reads_inner());
                inner.retain(|pass| !pass.is_loop());
            }
            Shape {
                prefix,
                renamed,
                above,
                inner,
                below,
            }
        },
    )
}

fn write(pass: &Pass, name: &str, material: &dyn Fn(usize) -> String) -> String {
    let own = |number: &usize| material(*number);
    match pass {
        Pass::Fill(to) => format!(
            "Fullscreen(name: \"{name}\", shader: \"fill\", color: [(target: \"{}\")]), ",
            own(to)
        ),
        Pass::Blur(from, to) => format!(
            "Fullscreen(name: \"{name}\", shader: \"blur\", bind: {{\"image\": \"{}\"}}, color: [(target: \"{}\")]), ",
            own(from),
            own(to)
        ),
        Pass::Copy(from, to) => format!(
            "Copy(name: \"{name}\", from: \"{}\", to: \"{}\"), ",
            own(from),
            own(to)
        ),
        Pass::Draw(to) => format!(
            "Fullscreen(name: \"{name}\", shader: \"fill\", color: [(target: \"{}\", load: Load)]), ",
            own(to)
        ),
    }
}

fn texture(name: &str) -> String {
    format!("Texture(name: \"{name}\", format: R32Float, size: Viewport), ")
}

fn document(materials: &[String], passes: &str, outputs: &[String]) -> String {
    let materials: String = materials.iter().map(|name| texture(name)).collect();
    let mut outputs_text = String::new();
    for (number, output) in outputs.iter().enumerate() {
        // Writing to a String cannot fail.
        let _ = write!(
            outputs_text,
            "(name: \"out{number}\", material: \"{output}\"), "
        );
    }
    format!("(format: 1, materials: [{materials}], passes: [{passes}], outputs: [{outputs_text}])")
}

impl Shape {
    /// What the inner material of a number is called in the whole graph.
    fn full(&self, number: usize) -> String {
        let prefix = if self.prefix { "it." } else { "" };
        match (number, self.renamed) {
            (0, Some(Some(outer))) => format!("o{outer}"),
            (0, Some(None)) => "free".to_owned(),
            _ if number < OWN => format!("{prefix}i{number}"),
            _ => format!("o{}", number - OWN),
        }
    }

    /// What an outer pass calls the material of a number: the outer document's, or one of the included document.
    fn outer(&self, number: usize) -> String {
        match number < OWN {
            true => format!("o{number}"),
            false => self.full(number - OWN),
        }
    }

    fn passes(&self, inner: &str) -> String {
        let outer = |part: &str, passes: &[Pass]| -> String {
            let write = |(number, pass): (usize, &Pass)| {
                write(pass, &format!("{part}{number}"), &|number| {
                    self.outer(number)
                })
            };
            passes.iter().enumerate().map(write).collect()
        };
        format!(
            "{}{inner}{}",
            outer("above", &self.above),
            outer("below", &self.below)
        )
    }

    fn inner(&self, prefix: &str, material: &dyn Fn(usize) -> String) -> String {
        let write = |(number, pass): (usize, &Pass)| {
            write(pass, &format!("{prefix}inner{number}"), material)
        };
        self.inner.iter().enumerate().map(write).collect()
    }

    fn outer_materials() -> Vec<String> {
        (0..OWN).map(|number| format!("o{number}")).collect()
    }

    fn outputs(&self) -> Vec<String> {
        vec!["o0".to_owned(), self.full(1)]
    }

    fn included(&self) -> BTreeMap<&'static str, String> {
        let own = |number: usize| match number < OWN {
            true => format!("i{number}"),
            false => format!("o{}", number - OWN),
        };
        let materials: Vec<String> = (0..OWN).map(own).collect();
        let inner = document(&materials, &self.inner("", &own), &[]);
        let mut fields = String::new();
        if self.prefix {
            fields.push_str(", prefix: \"it\"");
        }
        if self.renamed.is_some() {
            let _ = write!(fields, ", materials: {{\"i0\": \"{}\"}}", self.full(0));
        }
        let include = format!("Include(graph: \"inner.ron\"{fields}), ");
        let outer = document(
            &Self::outer_materials(),
            &self.passes(&include),
            &self.outputs(),
        );
        BTreeMap::from([("graph.ron", outer), ("inner.ron", inner)])
    }

    fn flattened(&self) -> BTreeMap<&'static str, String> {
        let mut materials = Self::outer_materials();
        let inner = (0..OWN).map(|number| self.full(number));
        materials.extend(inner.filter(|name| !name.starts_with('o')));
        let prefix = if self.prefix { "it." } else { "" };
        let passes = self.passes(&self.inner(prefix, &|number| self.full(number)));
        let document = document(&materials, &passes, &self.outputs());
        BTreeMap::from([("graph.ron", document)])
    }
}

/// Everything that decides what a frame does: the passes with all they access, and which of them run in which order.
fn behaviour(mut files: BTreeMap<&'static str, String>) -> Result<Vec<String>, Vec<Code>> {
    let fill = "@fragment fn fragment() -> @location(0) f32 { return 1.0; }";
    let blur = "var image: texture_2d<f32>;
        @fragment fn fragment() -> @location(0) f32 { return textureLoad(image, vec2(0u), 0).x; }";
    files.insert("fill.wgsl", fill.to_owned());
    files.insert("blur.wgsl", blur.to_owned());
    let request = PlanRequest::new([4, 4], &NoProvider);
    let checked = Graph::check("graph.ron", &Registry::standard(), &Files(files), &request);
    match checked {
        Ok((_, plan)) => Ok(describe(&plan)),
        Err(errors) => {
            let mut codes: Vec<Code> = errors.iter().map(|error| error.code).collect();
            codes.sort();
            Err(codes)
        }
    }
}

fn describe(plan: &Plan) -> Vec<String> {
    let mut lines = Vec::new();
    for pass in &plan.passes {
        let mut line = pass.name.value.clone();
        for access in &pass.accesses {
            let name = &plan.resources[access.resource.0].name;
            let (reads, writes, covers) = (access.reads, access.writes, access.covers);
            // Writing to a String cannot fail.
            let _ = write!(line, " {name} {:?} {reads} {writes} {covers}", access.part);
        }
        lines.push(line);
    }
    let order = plan
        .schedule
        .iter()
        .map(|&pass| plan.passes[pass].name.value.clone());
    lines.extend(order);
    lines
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn an_include_is_the_text_in_its_place(shape in shape()) {
        prop_assert_eq!(behaviour(shape.included()), behaviour(shape.flattened()));
    }
}
