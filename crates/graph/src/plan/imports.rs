//! What the host will hand over, held against what passes do with it.

use super::PlanRequest;
use crate::{
    diagnostics::{Code, Diagnostic},
    link::{LinkedPass, Usage},
    provider::Import,
    resolve::Resource,
};

/// What the host imports must have been made for what passes do with it.
pub(super) fn check(
    passes: &[LinkedPass],
    schedule: &[usize],
    resources: &[Resource],
    request: &PlanRequest<'_>,
    diagnostics: &mut Vec<Diagnostic>,
) {
    fn names<T>(of: &str, flags: impl Iterator<Item = (&'static str, T)>) -> String {
        let names: Vec<String> = flags.map(|(name, _)| format!("{of}::{name}")).collect();
        names.join(" | ")
    }
    for pass in schedule.iter().map(|&pass| &passes[pass]) {
        for access in &pass.accesses {
            let name = &resources[access.resource.0].name;
            let lacking = match (request.imports.get(name).copied(), access.usage) {
                (Some(Import::Texture { usage, .. }), Usage::Texture(needed))
                    if !usage.contains(needed) =>
                {
                    names("TextureUsages", needed.difference(usage).iter_names())
                }
                (Some(Import::Buffer { usage, .. }), Usage::Buffer(needed))
                    if !usage.contains(needed) =>
                {
                    names("BufferUsages", needed.difference(usage).iter_names())
                }
                _ => continue,
            };
            diagnostics.push(
                Diagnostic::error(
                    Code::Import,
                    format!(
                        "the import `{name}` was not made for what pass `{}` does",
                        *pass.name
                    ),
                )
                .at(access.span.clone(), "used here")
                .at(pass.name.span.clone(), "by this pass")
                .help(format!("the host must make it with {lacking} besides")),
            );
        }
    }
}
