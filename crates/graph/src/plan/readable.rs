//! What can be read back: outputs, captures, and why some cannot.

use super::{CAPTURE, Capture, PlanRequest};
use crate::{
    diagnostics::{Code, Diagnostic},
    document::{Run, located::Located},
    graph::Graph,
    instantiate::LoweredPass,
    link::{LinkedPass, Linker},
    provider::Provided,
    resolve::{Buffer, Part, ResourceKind, Resources, Target},
    step::Step,
};

impl Graph {
    /// The targets of all outputs and captures that are wanted.
    pub(super) fn readable(
        &self,
        request: &PlanRequest<'_>,
        resources: &mut Resources<'_>,
        written: impl Fn(&Target) -> bool,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Vec<(String, Target)> {
        let mut readable = Vec::new();
        let declared = self.outputs();
        for wanted in request.outputs.iter().flatten() {
            if !declared.contains(&wanted.as_str()) {
                diagnostics.push(
                    Diagnostic::error(
                        Code::Output,
                        format!("`{}` has no output `{wanted}`", self.path()),
                    )
                    .suggest(wanted, declared.iter().copied()),
                );
            }
        }
        for output in &self.document.outputs {
            let wanted = request
                .outputs
                .as_ref()
                .is_none_or(|wanted| wanted.contains(&output.name.value));
            let material = output.material.as_ref().unwrap_or(&output.name);
            let Some(target) = resources.expect(material, diagnostics) else {
                continue;
            };
            if !written(&target) {
                diagnostics.push(
                    Diagnostic::error(
                        Code::ReadBeforeWrite,
                        format!("no pass writes the output `{}`", *output.name),
                    )
                    .at(
                        material.span.clone(),
                        format!("`{}` is never written", material.value),
                    )
                    .help("let a pass write it, or name another `material`"),
                );
            } else if let Some(why) = unreadable(resources, &target) {
                diagnostics.push(
                    Diagnostic::error(
                        Code::FormatMismatch,
                        format!("the output `{}` cannot be read back", *output.name),
                    )
                    .at(material.span.clone(), why)
                    .help("use Depth32Float or Depth16Unorm"),
                );
            } else if wanted {
                readable.push((output.name.value.clone(), target));
            }
        }
        for capture in &request.captures {
            let name = capture.name();
            // Those after a pass were entered as resources of their own; an output of that name is there already.
            let found = resources.find(&name);
            match found {
                Some(target)
                    if matches!(resources.get(target.id).kind, ResourceKind::Provided(_)) =>
                {
                    let help = format!("name a pass that binds it: `{name}@PASS`");
                    let message = format!("`{name}` is provided, not written by a pass");
                    diagnostics.push(Diagnostic::error(Code::Output, message).help(help));
                }
                Some(target) if !written(&target) => diagnostics.push(Diagnostic::error(
                    Code::Output,
                    format!("`{name}` cannot be read back: no pass writes it"),
                )),
                Some(target) if unreadable(resources, &target).is_some() => {
                    let why = unreadable(resources, &target).unwrap_or_default();
                    diagnostics.push(Diagnostic::error(
                        Code::Output,
                        format!("`{name}` cannot be read back: it is {why}"),
                    ));
                }
                Some(target) if readable.iter().all(|(known, _)| *known != name) => {
                    readable.push((name, target))
                }
                Some(_) => {}
                None if capture.after.is_some() => {}
                None => {
                    let known = resources.known();
                    diagnostics.push(
                        Diagnostic::error(
                            Code::Output,
                            format!("`{}` has no output or material `{name}`", self.path()),
                        )
                        .suggest(&name, known.iter().map(String::as_str)),
                    );
                }
            }
        }
        readable
    }
}

pub(super) fn check_captures(
    request: &PlanRequest<'_>,
    lowered: &[LoweredPass],
    diagnostics: &mut Vec<Diagnostic>,
) {
    let passes: Vec<&str> = lowered.iter().map(|pass| pass.name.as_str()).collect();
    for pass in request
        .captures
        .iter()
        .filter_map(|capture| capture.after.as_deref())
    {
        if !passes.contains(&pass) {
            diagnostics.push(
                Diagnostic::error(
                    Code::Output,
                    format!("there is no pass `{pass}` to read a material after"),
                )
                .suggest(pass, passes.iter().copied()),
            );
        }
    }
}

/// Why the content of a resource cannot come back to the host.
fn unreadable(resources: &Resources<'_>, target: &Target) -> Option<String> {
    match &resources.get(target.id).kind {
        ResourceKind::Texture(texture) if texture.format.block_copy_size(None).is_none() => {
            Some(format!(
                "a texture of format {:?}, whose layout is the driver's own",
                texture.format
            ))
        }
        _ => None,
    }
}

impl Linker<'_, '_> {
    /// A copy of a material as it stands after the pass that was linked last.
    pub(super) fn capture(&mut self, capture: &Capture, graph: &Graph) -> Option<LinkedPass> {
        let name = Located::new(capture.name(), graph.place());
        let from = Located::new(capture.material.clone(), graph.place());
        let Some(target) = self.resources.find(&from) else {
            if !self.resources.is_broken(&from) {
                let known = self.resources.known();
                let message = format!(
                    "`{}` has no material `{}` to read back",
                    graph.path(),
                    from.value
                );
                self.report(
                    Diagnostic::error(Code::Output, message)
                        .suggest(&from, known.iter().map(String::as_str)),
                );
            }
            return None;
        };
        let kind = match &self.resources.get(target.id).kind {
            ResourceKind::Texture(texture) => {
                let mut copy = texture.clone();
                let Part { mips, layers } = &target.part;
                copy.size = copy.size.map(|edge| (edge >> mips.start).max(1));
                (copy.mips, copy.layers) = (mips.len() as u32, layers.len() as u32);
                ResourceKind::Texture(copy)
            }
            ResourceKind::Buffer(buffer) => ResourceKind::Buffer(buffer.clone()),
            ResourceKind::Provided(Provided { items: None, .. }) => {
                let message = format!("`{}` cannot be read back", from.value);
                let help =
                    "its size is known only once it is built, and the copy is planned before";
                self.report(Diagnostic::error(Code::Output, message).help(help));
                return None;
            }
            ResourceKind::Provided(_) => ResourceKind::Buffer(Buffer::default()),
            ResourceKind::Sampler(_) => {
                self.diagnostics.push(Diagnostic::error(
                    Code::Output,
                    format!("`{}` is a sampler and has no content", from.value),
                ));
                return None;
            }
        };
        self.resources.add(name.value.clone(), None, kind);
        let steps = [Step::Copy {
            from,
            to: name.clone(),
        }];
        let mut pass = self.pass(&name, CAPTURE, &steps)?;
        // Whether or not the pass that it comes after runs: what has changed may have been written above that one.
        pass.run = Run::OnChange;
        Some(pass)
    }

    /// Takes the author's word that a pass writes all of some resources.
    pub(super) fn overwrites(&mut self, pass: &mut LinkedPass, names: &[Located<String>]) {
        for name in names {
            let Some(target) = self.expect(name) else {
                continue;
            };
            let mut written = false;
            for access in &mut pass.accesses {
                if access.writes && access.resource == target.id && access.part == target.part {
                    written = true;
                    access.covers = true;
                }
            }
            if !written {
                self.report(
                    Diagnostic::error(
                        Code::ResourceKind,
                        format!("pass `{}` does not write `{}`", *pass.name, name.value),
                    )
                    .at(name.span.clone(), "said to be overwritten"),
                );
            }
        }
    }
}
