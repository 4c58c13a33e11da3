//! Last frame's versions: resources of their own, made like what they are versions of.

use super::{Origin, Resource, ResourceId, ResourceKind, Resources, Target};
use crate::{
    diagnostics::{Code, Diagnostic},
    document::located::Located,
};

/// The name under which last frame's version of `name` stands: as the document writes it, without quotes.
pub(crate) fn previous(name: &str) -> String {
    format!("Previous({name})")
}

/// What a name is last frame's version of.
pub(crate) fn previous_of(name: &str) -> Option<&str> {
    name.strip_prefix("Previous(")?.strip_suffix(')')
}

impl Resources<'_> {
    /// The resource whose layout and size a resource has: itself, or what it is last frame's version of.
    pub fn base(&self, id: ResourceId) -> ResourceId {
        match self.list[id.0].origin {
            Origin::Previous(base) => base,
            _ => id,
        }
    }

    /// Gives last frame's versions the sizes of what they are versions of.
    pub fn settle_previous(&mut self) {
        for (base, previous) in &self.previous {
            self.list[previous.0].kind = self.list[base.0].kind.clone();
        }
    }

    /// What `Previous("name")` stands for; `None` if `name` is nothing that has a version of last frame.
    pub(super) fn find_previous(&mut self, name: &str, of: &str) -> Option<Target> {
        let base = self.find(of)?;
        let kind = match &self.list[base.id.0] {
            Resource {
                kind: kind @ (ResourceKind::Texture(_) | ResourceKind::Buffer(_)),
                origin: Origin::Own,
                ..
            } => kind.clone(),
            _ => return None,
        };
        let id = match self.previous.get(&base.id) {
            Some(id) => *id,
            None => {
                let declared = self.list[base.id.0].declared.clone();
                let whole = previous(&self.list[base.id.0].name);
                let id = self.add(whole, declared, kind);
                self.list[id.0].origin = Origin::Previous(base.id);
                self.previous.insert(base.id, id);
                id
            }
        };
        let target = Target {
            id,
            part: base.part,
        };
        self.names.insert(name.to_owned(), target.clone());
        Some(target)
    }

    /// Says why there is no last frame's version of `of`.
    pub(super) fn explain_previous(
        &mut self,
        name: &Located<String>,
        of: &str,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Option<Target> {
        let base = self.expect(&Located::new(of.to_owned(), name.span.clone()), diagnostics)?;
        let resource = self.get(base.id);
        let what = match resource.origin {
            Origin::Host => "the host's",
            _ => resource.kind.describe(),
        };
        diagnostics.push(
            Diagnostic::error(
                Code::ResourceKind,
                format!("`{of}` has no version of the frame before"),
            )
            .at(name.span.clone(), format!("it is {what}"))
            .help("only textures and buffers of the document have one; copy it into one"),
        );
        None
    }
}
