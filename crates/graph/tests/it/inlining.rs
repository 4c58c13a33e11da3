//! An included document behaves as if its text stood in the place of the include, with its names
//! changed.

use crate::support::{Files, codes};
use proptest::prelude::*;
use skiagraph_graph::{Code, Graph, NoProvider, Plan, PlanRequest, Registry};
use std::fmt::Write as _;

/// A pass over materials by number: those below [`OWN`] are the document's own, the others the
/// other document's: inputs from the outer one, outputs of the inner one.
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

    /// Returns the material that it writes.
    fn target(&self) -> usize {
        match self {
            Self::Fill(to) | Self::Draw(to) | Self::Blur(_, to) | Self::Copy(_, to) => *to,
        }
    }

    /// True if a pass of the outer document reads a material that the inner one has yet to write.
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
    named: bool,
    /// The inner material 0 is written into the outer one of this number.
    bound: Option<usize>,
    above: Vec<Pass>,
    inner: Vec<Pass>,
    below: Vec<Pass>,
}

fn shape() -> impl Strategy<Value = Shape> {
    let passes = || prop::collection::vec(pass(), 0..5);
    let flags = (any::<bool>(), prop::bool::weighted(0.8));
    (
        flags,
        prop::option::of(0..OWN),
        passes(),
        passes(),
        passes(),
    )
        .prop_map(|((named, filled), bound, mut above, mut inner, below)| {
            // Outputs must be written.
            inner.splice(0..0, (0..OWN).map(Pass::Fill));
            // Above the include its names mean nothing yet.
            above.retain(|pass| !pass.reads_inner() && pass.target() < OWN);
            if filled {
                // Otherwise most documents would read before any write.
                above.splice(0..0, (0..OWN).map(Pass::Fill));
                above.retain(|pass| !pass.is_loop());
                inner.retain(|pass| !pass.is_loop());
            }
            Shape {
                named,
                bound,
                above,
                inner,
                below,
            }
        })
}

fn write(pass: &Pass, name: &str, material: &dyn Fn(usize) -> String) -> String {
    let own = |number: &usize| material(*number);
    match pass {
        Pass::Fill(to) => format!(
            "Fullscreen(name: \"{name}\", shader: \"fill\", color: [\"{}\"]), ",
            own(to)
        ),
        Pass::Blur(from, to) => format!(
            "Fullscreen(name: \"{name}\", shader: \"blur\", bind: {{\"image\": \"{}\"}}, color: \
             [\"{}\"]), ",
            own(from),
            own(to)
        ),
        Pass::Copy(from, to) => format!(
            "Copy(name: \"{name}\", from: \"{}\", to: \"{}\"), ",
            own(from),
            own(to)
        ),
        Pass::Draw(to) => format!(
            "Fullscreen(name: \"{name}\", shader: \"fill\", color: [(target: \"{}\", load: \
             Load)]), ",
            own(to)
        ),
    }
}

fn textures(names: &[String]) -> String {
    let texture = |name: &String| format!("Texture(name: \"{name}\", format: R32Float), ");
    names.iter().map(texture).collect()
}

fn outputs(names: &[String]) -> String {
    let mut text = String::new();
    for (number, name) in names.iter().enumerate() {
        // Writing to a String cannot fail.
        let _ = write!(text, "(name: \"out{number}\", material: \"{name}\"), ");
    }
    text
}

impl Shape {
    /// Returns the outer document's name for the inner material of a number.
    fn full(&self, number: usize) -> String {
        let namespace = if self.named { "it." } else { "" };
        match (number, self.bound) {
            (0, Some(outer)) => format!("o{outer}"),
            _ if number < OWN => format!("{namespace}i{number}"),
            _ => format!("o{}", number - OWN),
        }
    }

    /// Returns an outer pass's name for the material of a number.
    fn outer(&self, number: usize) -> String {
        if number < OWN {
            format!("o{number}")
        } else {
            self.full(number - OWN)
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

    fn inner(&self, material: &dyn Fn(usize) -> String) -> String {
        let write =
            |(number, pass): (usize, &Pass)| write(pass, &format!("inner{number}"), material);
        self.inner.iter().enumerate().map(write).collect()
    }

    fn outer_materials() -> Vec<String> {
        (0..OWN).map(|number| format!("o{number}")).collect()
    }

    fn wanted(&self) -> Vec<String> {
        vec!["o0".to_owned(), self.full(1)]
    }

    fn included(&self) -> Files {
        let own = |number: usize| {
            if number < OWN {
                format!("i{number}")
            } else {
                format!("o{}", number - OWN)
            }
        };
        let names: Vec<String> = (0..OWN).map(own).collect();
        // Inputs that are written are given back, too.
        let is_written = |name: &String| {
            let bound = self.bound.map(|outer| format!("o{outer}"));
            let mut targets = self.inner.iter().map(|pass| own(pass.target()));
            targets.any(|target| target == *name) || bound.as_ref() == Some(name)
        };
        let inputs = Self::outer_materials();
        let given = names
            .iter()
            .chain(inputs.iter().filter(|name| is_written(name)));
        let given: Vec<String> = given.map(|name| format!("\"{name}\"")).collect();
        let inner = format!(
            "inputs: [{}], materials: [{}], passes: [{}], outputs: [{}]",
            textures(&inputs),
            textures(&names),
            self.inner(&own),
            given.join(", ")
        );
        let mut fields = String::new();
        if self.named {
            fields.push_str(", name: \"it\"");
        }
        if self.bound.is_some() {
            let _ = write!(fields, ", bind: {{\"i0\": \"{}\"}}", self.full(0));
        }
        let include = format!("Include(graph: \"inner.ron\"{fields}), ");
        let outer = format!(
            "materials: [{}], passes: [{}], outputs: [{}]",
            textures(&Self::outer_materials()),
            self.passes(&include),
            outputs(&self.wanted())
        );
        Files::graph(&outer).document("inner.ron", &inner)
    }

    fn flattened(&self) -> Files {
        let plain = |name: &str| name.replace('.', "_");
        let mut materials = Self::outer_materials();
        let inner = (0..OWN).map(|number| plain(&self.full(number)));
        materials.extend(inner.filter(|name| !name.starts_with('o')));
        let inside = self.inner(&|number| plain(&self.full(number)));
        let group = if self.named { "it" } else { "inner" };
        let passes = self.passes(&format!("Group(name: \"{group}\", passes: [{inside}]), "));
        let wanted: Vec<String> = self.wanted().iter().map(|name| plain(name)).collect();
        Files::graph(&format!(
            "materials: [{}], passes: [{}], outputs: [{}]",
            textures(&materials),
            passes.replace("\"it.", "\"it_"),
            outputs(&wanted)
        ))
    }
}

/// Everything that decides what a frame does: the passes with all they access, and which of them
/// run in which order.
fn behaviour(files: Files) -> Result<Vec<String>, Vec<Code>> {
    let fill = "@fragment fn fragment() -> @location(0) f32 { return 1.0; }";
    let blur = "var image: texture_2d<f32>;
        @fragment fn fragment() -> @location(0) f32 {
            return textureLoad(image, vec2(0u), 0).x;
        }";
    let files = files.with("fill.wgsl", fill).with("blur.wgsl", blur);
    let request = PlanRequest::new([4, 4], &NoProvider);
    match Graph::check("graph.ron", &Registry::standard(), &files, &request) {
        Ok((_, plan)) => Ok(describe(&plan)),
        Err(errors) => {
            let mut codes = codes(errors.iter());
            codes.sort();
            Err(codes)
        }
    }
}

fn describe(plan: &Plan) -> Vec<String> {
    let mut lines = Vec::new();
    for pass in plan.all_passes() {
        let mut line = pass.name.value.clone();
        for access in &pass.accesses {
            let name = plan.resource(access.resource).name.replace('.', "_");
            let (reads, writes, covers) = (access.reads, access.writes, access.fully_overwrites);
            // Writing to a String cannot fail.
            let _ = write!(line, " {name} {:?} {reads} {writes} {covers}", access.part);
        }
        lines.push(line);
    }
    lines.extend(plan.live().map(|pass| pass.name.value.clone()));
    lines
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 1000, failure_persistence: None, ..ProptestConfig::default()
    })]

    #[test]
    fn an_include_is_the_text_in_its_place(shape in shape()) {
        prop_assert_eq!(behaviour(shape.included()), behaviour(shape.flattened()));
    }
}
