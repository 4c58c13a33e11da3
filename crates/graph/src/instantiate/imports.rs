//! Materials that the host gives: inputs of the loaded document, and pictures that it replaces.

use super::include;
use super::scopes::Symbol;
use super::symbols::{At, SymbolTable};
use crate::document::{FormatEntry, Input, InputKind, Material};
use crate::errors::instantiate::InterfaceError;
use crate::provider::Import;
use crate::resource::{Buffer, Origin, Resource, ResourceKind, Sampler, Texture};

/// Adds the host's import for an input of the loaded document, and returns its meaning.
pub(super) fn imported(input: &Input, at: &mut At<'_, '_>) -> Symbol {
    let name = &input.name;
    match import(input, at.symbols) {
        Ok(kind) => {
            let id = at.symbols.add(Resource {
                declared: Some(name.span.clone()),
                ..Resource::new(name.value.to_string(), kind, Origin::Host)
            });
            Symbol::Target(at.symbols.whole(id))
        }
        Err(error) => Symbol::Invalid(at.report(error)),
    }
}

/// Returns the input in the place of a texture of the document at a position whose picture the host
/// replaces.
pub(super) fn replaced_picture(material: &Material, at: &At<'_, '_>) -> Option<Input> {
    let Material::Texture(texture) = material else {
        return None;
    };
    let is_root = at.instance().outer.is_none();
    let name = &texture.name;
    let is_replaced = at.symbols.request.imports.contains_key(name.as_str());
    (is_root && is_replaced && texture.file.is_some()).then(|| Input {
        name: name.clone(),
        kind: InputKind::Texture(match texture.format {
            FormatEntry::Named(format) => Some(format),
            FormatEntry::Expr(_) => None,
        }),
    })
}

fn import(input: &Input, symbols: &SymbolTable<'_>) -> Result<ResourceKind, InterfaceError> {
    let name = input.name.text();
    let Some(import) = symbols.request.imports.get(&name.value) else {
        return Err(InterfaceError::NoImport(name));
    };
    let kind = kind(*import);
    if include::takes(&input.kind, &kind) {
        return Ok(kind);
    }
    let (expected, imported) = match (&input.kind, &kind) {
        (InputKind::Texture(Some(_)), ResourceKind::Texture(_)) => (
            input.kind.describe_with_format(),
            kind.describe_with_format(),
        ),
        (asked, given) => (asked.describe().to_owned(), given.describe().to_owned()),
    };
    Err(InterfaceError::WrongImport {
        name,
        expected,
        imported,
    })
}

/// Returns the resource kind for an import.
fn kind(import: Import) -> ResourceKind {
    match import {
        Import::Texture {
            format,
            size,
            mips,
            layers,
            is_3d,
            samples,
            ..
        } => ResourceKind::Texture(Texture {
            format,
            size,
            layers,
            is_3d,
            mips,
            samples,
            picture: None,
        }),
        Import::Buffer { bytes, items, .. } => ResourceKind::Buffer(Buffer {
            count: items,
            bytes,
            ..Buffer::default()
        }),
        Import::Sampler { filter, compare } => ResourceKind::Sampler(Sampler {
            filter,
            address: Default::default(),
            compare: compare.then_some(wgt::CompareFunction::LessEqual),
        }),
    }
}
