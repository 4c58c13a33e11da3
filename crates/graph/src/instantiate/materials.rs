//! Materials of all documents in one list: declared under a prefix, renamed, or connected with one of an outer document.

use super::{Builder, MOST, ScopeId, clash, scope::Place, split_layer};
use crate::{
    diagnostics::{Code, Diagnostic},
    document::{
        Document, IncludeEntry,
        located::Located,
        materials::{Count, Material, Size},
        value::Value,
    },
    registry::{FromParam, Params},
    source::Span,
};
use std::{collections::HashMap, sync::Arc};

impl Builder<'_, '_> {
    /// Enters the materials of a document.
    pub(super) fn declare(&mut self, document: &Document, scope: ScopeId) {
        for name in &document.broken.materials {
            let place = self.scopes.place(scope, name);
            self.scopes.publish(&place);
            if place.connected.is_none() {
                self.unread.push(place.full);
            }
        }
        for material in &document.materials {
            if self.materials.len() >= MOST {
                return self.full(material.name(), "materials");
            }
            let place = self.scopes.place(scope, material.name());
            match &place.connected {
                None => self.enter(material, place, scope),
                Some(by) => self.connect(material, &place, by, scope),
            }
        }
    }

    fn enter(&mut self, material: &Material, place: Place, scope: ScopeId) {
        let mut entered = material.clone();
        self.scopes.publish(&place);
        let full = place.full;
        let number = self.materials.len();
        if !self.claim(&full, &material.name().span, number) {
            return;
        }
        match &mut entered {
            Material::Texture(texture) => {
                texture.name.value = full;
                for view in &mut texture.views {
                    self.view(&mut view.name, number, scope);
                }
            }
            Material::Buffer(buffer) => buffer.name.value = full,
            Material::Sampler(sampler) => sampler.name.value = full,
        }
        self.materials.push((entered, scope));
    }

    /// Gives a view its name in the whole graph.
    fn view(&mut self, name: &mut Located<String>, texture: usize, scope: ScopeId) {
        let place = self.scopes.place(scope, name);
        self.scopes.publish(&place);
        self.claim(&place.full, &name.span, texture);
        name.value = place.full;
    }

    /// Whether a name is still free; reports it if not.
    fn claim(&mut self, full: &str, place: &Span, number: usize) -> bool {
        if let Some((first, _)) = self.declared.get(full) {
            self.diagnostics.push(clash("material", full, first, place));
            return false;
        }
        self.declared
            .insert(full.to_owned(), (place.clone(), number));
        true
    }

    /// A material that is one of an outer document.
    fn connect(
        &mut self,
        material: &Material,
        place: &Place,
        by: &Located<String>,
        scope: ScopeId,
    ) {
        // One with a mistake that was reported is not declared.
        let Some((declared, number)) = self.declared.get(self.whole(&place.full)).cloned() else {
            return self.scopes.publish(place);
        };
        let outer = &self.materials[number].0;
        if let Some(error) = mismatch(material, outer, (by, &place.full, declared)) {
            self.diagnostics.push(error);
            return self.spoil(material, scope);
        }
        self.scopes.publish(place);
        let Material::Texture(texture) = material else {
            return;
        };
        let mut views = texture.views.clone();
        for view in &mut views {
            self.view(&mut view.name, number, scope);
        }
        if let Material::Texture(outer) = &mut self.materials[number].0 {
            outer.views.extend(views);
        }
    }

    /// The name without the layers that it may end in.
    fn whole<'n>(&self, mut name: &'n str) -> &'n str {
        while let (false, Some((whole, _))) = (self.declared.contains_key(name), split_layer(name))
        {
            name = whole;
        }
        name
    }

    /// Nothing more is said about a material with a mistake.
    fn spoil(&mut self, material: &Material, scope: ScopeId) {
        let mut names = vec![material.name()];
        if let Material::Texture(texture) = material {
            names.extend(texture.views.iter().map(|view| &view.name));
        }
        for name in names {
            let full = self.scopes.hide(scope, name);
            self.unread.push(full);
        }
    }

    /// Every rename must be one of a material of the included document.
    pub(super) fn check_renames(
        &mut self,
        include: &IncludeEntry,
        document: &Document,
        scope: ScopeId,
    ) {
        let known = self.scopes.get(scope);
        for (name, _) in &include.materials {
            if !known.knows(name) && !self.is_full {
                let error = Diagnostic::error(
                    Code::UnknownResource,
                    format!("`{}` has no material `{}`", document.file.name, **name),
                );
                let error = error.at(name.span.clone(), "");
                let found = self.diagnostics.len();
                self.diagnostics.push(error.suggest_to(found, name, || {
                    let mut names: Vec<&str> = known.names().collect();
                    names.sort_unstable();
                    names
                }));
            }
        }
    }

    /// Names and params in sizes and counts become names of the whole graph and numbers.
    pub(super) fn settle_materials(&mut self) -> Vec<Material> {
        // A material that is connected with a layer or a view is as large as that.
        let mut views: HashMap<String, String> = HashMap::new();
        for (material, _) in &self.materials {
            if let Material::Texture(texture) = material {
                let first_mip = texture.views.iter().filter(|view| view.mip == 0);
                views.extend(
                    first_mip.map(|view| (view.name.value.clone(), texture.name.value.clone())),
                );
            }
        }
        let mut settled = Vec::new();
        for (mut material, scope) in std::mem::take(&mut self.materials) {
            let params = Arc::clone(&self.scopes.get(scope).params);
            let index = self.scopes.index(scope);
            let mut translate = |name: &mut Located<String>| {
                name.value = self.scopes.full_name(scope, index, name);
            };
            let before = self.diagnostics.len();
            let diagnostics = &mut *self.diagnostics;
            match &mut material {
                Material::Texture(texture) => {
                    fix(&mut texture.mips, &params, diagnostics);
                    fix(&mut texture.layers, &params, diagnostics);
                    match &mut texture.size.value {
                        Size::Viewport => {}
                        Size::ViewportTimes(factor) => fix(factor, &params, diagnostics),
                        Size::Like(name) => {
                            translate(name);
                            let whole = self.whole(name);
                            name.value = views.get(whole).unwrap_or(&whole.to_owned()).clone();
                        }
                        Size::Square(edge) => fix(edge, &params, diagnostics),
                        Size::Texels(width, height) => {
                            fix(width, &params, diagnostics);
                            fix(height, &params, diagnostics);
                        }
                    }
                }
                Material::Buffer(buffer) => {
                    if let Some(count) = &mut buffer.count {
                        count.value.names(&mut translate);
                        count
                            .value
                            .numbers(&mut |value| fix(value, &params, diagnostics));
                    }
                }
                Material::Sampler(_) => {}
            }
            if self.diagnostics.len() == before {
                settled.push(material);
                continue;
            }
            self.unread.push(material.name().value.clone());
            if let Material::Texture(texture) = material {
                self.unread
                    .extend(texture.views.into_iter().map(|view| view.name.value));
            }
        }
        settled
    }
}

/// Puts the value of a param in its place.
fn fix<T: FromParam>(value: &mut Value<T>, params: &Params, diagnostics: &mut Vec<Diagnostic>) {
    if let Some(known) = params.value(value, diagnostics) {
        *value = Value::Literal(known);
    }
}

/// Why a material cannot be the one of an outer document that is called `full` and declared at `place`.
fn mismatch(
    material: &Material,
    outer: &Material,
    (by, full, place): (&Located<String>, &str, Span),
) -> Option<Diagnostic> {
    let name = material.name();
    let (own, others) = (describe(material), describe(outer));
    let code = match (material, outer) {
        (Material::Texture(texture), _) if own == others => {
            if outer.name().value == full || texture.views.is_empty() {
                return None;
            }
            let message = format!("`{}` has views and cannot be a part of a texture", **name);
            return Some(
                Diagnostic::error(Code::ResourceKind, message)
                    .at(by.span.clone(), "connected here")
                    .at(name.span.clone(), "declared here")
                    .help("connect it with a whole texture"),
            );
        }
        _ if own == others => return None,
        (Material::Texture(_), Material::Texture(_)) => Code::FormatMismatch,
        _ => Code::ResourceKind,
    };
    let message = format!("`{}` cannot be connected with `{}`", **name, **by);
    Some(
        Diagnostic::error(code, message)
            .at(by.span.clone(), "connected here")
            .at(name.span.clone(), own)
            .at(place, others),
    )
}

fn describe(material: &Material) -> String {
    match material {
        Material::Texture(texture) => format!("a texture of format {:?}", texture.format.value.0),
        Material::Buffer(_) => "a buffer".to_owned(),
        Material::Sampler(sampler) if sampler.compare.is_some() => {
            "a sampler with `compare`".to_owned()
        }
        Material::Sampler(_) => "a sampler without `compare`".to_owned(),
    }
}

impl Count {
    /// Calls `each` with every resource name that the count is derived from.
    pub(crate) fn names(&mut self, each: &mut dyn FnMut(&mut Located<String>)) {
        match self {
            Self::PixelsOf(name) | Self::CountOf(name) => each(name),
            Self::Times(a, b) => {
                a.names(each);
                b.names(each);
            }
            Self::Number(_) | Self::Pixels => {}
        }
    }

    fn numbers(&mut self, each: &mut dyn FnMut(&mut Value<u32>)) {
        match self {
            Self::Number(value) => each(value),
            Self::Times(a, b) => {
                a.numbers(each);
                b.numbers(each);
            }
            Self::PixelsOf(_) | Self::CountOf(_) | Self::Pixels => {}
        }
    }
}
