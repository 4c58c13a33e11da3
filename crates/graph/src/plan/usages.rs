//! Usages of the host's imports, compared with the needs of passes.

use crate::diagnostics::Reports;
use crate::errors::plan::OutputError;
use crate::flow::GraphView;
use crate::link::{PassId, Usage};
use crate::provider::Import;
use crate::request::PlanRequest;
use crate::resource::Origin;
use crate::source::Located;

/// Checks that the host's imports were created with the usages that passes need.
pub(super) fn check(
    view: GraphView<'_>,
    sequence: &[PassId],
    request: &PlanRequest<'_>,
    reports: &mut Reports,
) {
    fn names<T>(ty: &str, flags: impl Iterator<Item = (&'static str, T)>) -> String {
        let names: Vec<String> = flags.map(|(name, _)| format!("{ty}::{name}")).collect();
        names.join(" | ")
    }
    for pass in sequence.iter().map(|&pass| view.pass(pass)) {
        for access in &pass.accesses {
            let resource = view.resource(access.resource);
            if resource.origin != Origin::Host {
                continue;
            }
            let lacking = match (request.imports.get(&resource.name).copied(), access.usage) {
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
            reports.report(OutputError::ImportUsage {
                name: Located::new(resource.name.clone(), access.span.clone()),
                pass: pass.name.clone(),
                lacking,
            });
        }
    }
}
