//! Resolution of references: which resource, and which part of it, a name in a document means.

use super::{growth::Sizing, parts, scopes::Symbol, symbols::At};
use crate::diagnostics::{ErrorGuaranteed, Reported};
use crate::errors::instantiate::InterfaceError;
use crate::expressions::eval;
use crate::language::{Expr, Reference, Segment, Selection};
use crate::resource::{Resource, SubresourceRange, Target};
use crate::source::Located;
use std::ops::Range;

impl Sizing for At<'_, '_> {
    fn resource(&mut self, reference: &Reference) -> Reported<(Target, &Resource)> {
        let target = resolve(self, reference)?;
        let resource = self.symbols.get(target.id);
        Ok((target, resource))
    }
}

/// Returns the resource, or part of it, that a reference at this position means.
fn resolve(at: &mut At<'_, '_>, reference: &Reference) -> Reported<Target> {
    let mut reference = reference;
    while let Some(otherwise) = &reference.otherwise {
        let (condition, other) = &**otherwise;
        if eval::boolean(condition, at)? {
            break;
        }
        reference = other;
    }
    let (mut target, selection) = named(at, reference)?;
    at.symbols.resolve_size(target.id)?;
    // A part of an input is a part of what is bound to it; a whole one is known only now.
    if target.part == SubresourceRange::WHOLE {
        target = at.symbols.whole(target.id);
    }
    // Mips first: of a 3D texture they have fewer slices.
    if let Some(mips) = &reference.mips {
        let have = parts::mips(&target, at.symbols.get(target.id), reference);
        let have = at.symbols.reports.check(have)?;
        let range = range(at, mips, have, reference, &target)?;
        let resource = at.symbols.get(target.id);
        let selected = parts::select_mips(&mut target, range, resource, reference);
        at.symbols.reports.check(selected)?;
    }
    if let Some(selection) = selection {
        let resource = at.symbols.get(target.id);
        let have = parts::layers(&target, resource, reference);
        let have = at.symbols.reports.check(have)?;
        let range = range(at, selection, have, reference, &target)?;
        let start = target.part.layers.start;
        target.part.layers = start + range.start..start + range.end;
    }
    if reference.previous {
        let kept = at.symbols.kept(target.id);
        let id = at.symbols.previous(target.id);
        target.id = id.map_err(|what| {
            let name = reference.located();
            at.report(InterfaceError::NoPrevious { name, what, kept })
        })?;
    }
    Ok(target)
}

/// Resolves the names of a reference. Returns their meanings, and the selection behind the last
/// name.
fn named<'r>(
    at: &mut At<'_, '_>,
    reference: &'r Reference,
) -> Reported<(Target, Option<&'r Selection>)> {
    let first = &reference.segments[0];
    let scope = at.position.scope;
    let symbol = at.symbols.scopes.find(scope, &first.name.value);
    let Some(mut symbol) = symbol.cloned() else {
        return of_scene(at, reference);
    };
    let mut walked = first.name.value.to_string();
    let mut segments = reference.segments.iter().peekable();
    while let Some(segment) = segments.next() {
        let names = match symbol {
            Symbol::Invalid(reported) => return Err(reported),
            Symbol::Value(_) => {
                let name = Located::new(walked, segment.name.span.clone());
                return Err(at.report(InterfaceError::IsValue(name)));
            }
            Symbol::Target(target) => {
                return match segments.peek() {
                    None => Ok((target, segment.selection.as_ref())),
                    Some(next) => {
                        let error = InterfaceError::NotOfMaterial(walked, next.name.text());
                        Err(at.report(error))
                    }
                };
            }
            Symbol::Namespace(names) => names,
            Symbol::Repeated(list) => {
                let index = repetition(at, segment, list.len())?;
                list.into_iter().nth(index).unwrap_or_default()
            }
        };
        let Some(next) = segments.peek() else {
            let name = Located::new(walked, segment.name.span.clone());
            return Err(at.report(InterfaceError::Namespace(name)));
        };
        let Some(member) = names.get(&next.name.value) else {
            let names = names.keys().map(|name| name.to_string());
            let names = at.symbols.reports.known(names);
            return Err(at.report(InterfaceError::Private(walked, next.name.text(), names)));
        };
        walked = format!("{walked}.{}", next.name.value);
        symbol = member.clone();
    }
    Err(unknown(at, reference))
}

/// Returns the index of the repetition that a segment selects.
fn repetition(at: &mut At<'_, '_>, segment: &Segment, count: usize) -> Reported<usize> {
    let name = &segment.name;
    let Some(Selection::One(expr)) = &segment.selection else {
        return Err(at.report(InterfaceError::Namespace(name.text())));
    };
    let index = eval::count(expr, at)?;
    let index = usize::try_from(index).ok().filter(|index| *index < count);
    index.ok_or_else(|| {
        let part = format!("{}[{}]", name.value, expr.text());
        let part = Located::new(part, expr.span.clone());
        let what = format!("it is repeated {count} times, counted from 0");
        at.report(InterfaceError::Range(part, what, None))
    })
}

/// Resolves a reference to a name of the scene.
fn of_scene<'r>(
    at: &mut At<'_, '_>,
    reference: &'r Reference,
) -> Reported<(Target, Option<&'r Selection>)> {
    let path = reference.path();
    let (last, leading) = match reference.segments.split_last() {
        Some((last, leading)) => (last.selection.as_ref(), leading),
        None => (None, &[][..]),
    };
    let is_plain = leading.iter().all(|segment| segment.selection.is_none());
    if let (Some(Selection::One(number)), true) = (last, is_plain)
        && let Some(of_list) = of_list(at, &path, number, reference)
    {
        return of_list.map(|target| (target, None));
    }
    let target = at.symbols.find_scene(&path, at.position.scope);
    match target.filter(|_| is_plain) {
        Some(target) => Ok((target?, last)),
        None => Err(unknown(at, reference)),
    }
}

/// Finds an item of a provided list whose items have names of their own, such as `lights[1]`,
/// because each may have another kind. `None` if the list is not of this sort, or an own
/// material stands in its place.
fn of_list(
    at: &mut At<'_, '_>,
    list: &str,
    number: &Expr,
    reference: &Reference,
) -> Option<Reported<Target>> {
    let instance = at.symbols.scopes.instance_of(at.position.scope);
    if at.symbols.scopes.scene(instance, list).is_some() {
        return None;
    }
    let provider = at.symbols.request.provider;
    provider.describe(&format!("{list}.0"))?;
    let count = provider.describe(list)?.items?;
    let number = match eval::count(number, at) {
        Ok(number) => number,
        Err(reported) => return Some(Err(reported)),
    };
    let target = at.find_scene(&format!("{list}.{number}"));
    Some(target.unwrap_or_else(|| {
        let what = format!("there are {count} of them, counted from 0; this is [{number}]");
        Err(at.report(InterfaceError::Range(reference.located(), what, None)))
    }))
}

/// Reports a reference to an unknown name.
fn unknown(at: &mut At<'_, '_>, reference: &Reference) -> ErrorGuaranteed {
    let instance = at.symbols.scopes.document(at.position.scope);
    if let Some(reported) = instance.incomplete {
        return reported;
    }
    let names = at.symbols.known(at.position.scope);
    let materials = at.symbols.reports.known(names);
    at.report(InterfaceError::Unknown {
        name: reference.located_path(),
        document: instance.document.file.name.to_string(),
        materials,
    })
}

/// Evaluates a selection to a range of layers, items or mips; `have` is the word for them and
/// their number.
fn range(
    at: &mut At<'_, '_>,
    selection: &Selection,
    have: (&str, u64),
    reference: &Reference,
    target: &Target,
) -> Reported<Range<u32>> {
    let selected = match selection {
        Selection::One(one) => {
            let first = eval::count(one, at)?;
            (first..first.saturating_add(1), &one.span)
        }
        Selection::Range(ends) => {
            let [first, end] = &**ends;
            let range = eval::count(first, at)?..eval::count(end, at)?;
            (range, &end.span)
        }
    };
    let resource = at.symbols.get(target.id);
    let narrowed = parts::narrow(selected, have, reference, resource);
    at.symbols.reports.check(narrowed)
}
