//! `extends`: a document is another one with edits, as if the result had been written out.

use super::raw::{Invalid, REMOVE, RawDocument, RawEntry, RawItem, RawMap};
use super::typed::{Narrow, Output};
use crate::{diagnostics::Reports, errors::edit::EditError, source::Located};
use skiagraph_located_ron::reader::{Field, Node};
use std::collections::HashMap;

type Entries = Vec<Result<RawEntry, Invalid>>;

/// Fields of an entry that place it in the extended document: before or after an entry, or instead
/// of it.
pub(crate) const PLACES: [&str; 3] = ["before", "after", "instead"];

/// Applies the edits of the document `own` to the document `base` that it extends. An edit that
/// cannot be made is reported and left out.
pub(crate) fn extend(base: RawDocument, own: RawDocument, reports: &mut Reports) -> RawDocument {
    let mut inputs = without(base.inputs, &own.materials);
    let mut materials = without(base.materials, &own.inputs);
    put(&mut inputs, own.inputs, is_named_as);
    put(&mut materials, own.materials, is_named_as);
    let mut document = RawDocument {
        file: own.file,
        extended: [vec![base.file.name.clone()], base.extended].concat(),
        description: own.description.or(base.description),
        requires: [base.requires, own.requires].concat(),
        needs: [base.needs, own.needs].concat(),
        narrow: narrower(base.narrow, own.narrow, reports),
        imports: [base.imports, own.imports].concat(),
        inputs,
        materials,
        outputs: if own.outputs.is_empty() {
            inherited(base.outputs)
        } else {
            own.outputs
        },
        // Lights, claims and outputs on request belong to a method as written, not to methods that
        // extend it.
        lights: own.lights,
        proven_on: own.proven_on,
        claims: own.claims,
        invalid_params: base.invalid_params.or(own.invalid_params),
        incomplete: base.incomplete.or(own.incomplete),
        ..base
    };
    put(&mut document.params, own.params, is_named_as);
    put(&mut document.values, own.values, is_same_key);
    for (name, value) in own.set {
        let is_named = |item: &&mut RawItem| item.name().is_some_and(|own| *own == *name);
        match document.params.iter_mut().find(is_named) {
            // The document decides, so nothing is left to search for.
            Some(param) => {
                param.fields.retain(|field| *field.name != *"tune");
                let default = default_field(&name, value);
                put(&mut param.fields, [default], is_same_field);
            }
            None => {
                document.set.retain(|(param, _)| **param != *name);
                document.set.push((name, value));
            }
        }
    }
    let mut edits = Edits {
        ends: HashMap::new(),
        above: None,
        reports,
    };
    for edit in own.passes {
        match edit {
            Ok(edit) => {
                if let Err(error) = edits.apply(&mut document.passes, edit) {
                    edits.reports.report(error);
                }
            }
            Err(broken) => document.passes.push(Err(broken)),
        }
    }
    document
}

fn default_field(name: &Located<String>, node: Node) -> Field {
    Field {
        name: Located::new("default".to_owned(), name.span.clone()),
        node,
    }
}

/// Outputs of a document that those have that extend it: diagnostics may not be true of these.
fn inherited(outputs: Vec<Node>) -> Vec<Node> {
    let is_on_request = |node: &Node| node.parse::<Output>().is_ok_and(|it| it.on_request);
    let (_, inherited) = outputs.into_iter().partition::<Vec<_>, _>(is_on_request);
    inherited
}

/// Puts each of `own` into the place of the one that is the same in the list, or behind the others.
fn put<T>(list: &mut Vec<T>, own: impl IntoIterator<Item = T>, is_same: fn(&T, &T) -> bool) {
    for item in own {
        match list.iter_mut().find(|base| is_same(base, &item)) {
            Some(base) => *base = item,
            None => list.push(item),
        }
    }
}

fn is_same_key((base, _): &(Located<String>, Node), (key, _): &(Located<String>, Node)) -> bool {
    **base == **key
}

fn is_same_field(base: &Field, field: &Field) -> bool {
    *base.name == *field.name
}

/// Narrows params of the base further. A word that the base has taken away stays away.
fn narrower(mut base: RawMap, own: RawMap, reports: &mut Reports) -> RawMap {
    for (name, node) in &own {
        let Some((first, before)) = base.iter().find(|(key, _)| **key == **name) else {
            continue;
        };
        // One that cannot be read is reported where it is.
        let (Ok(before), Ok(now)) = (before.parse::<Narrow>(), node.parse::<Narrow>()) else {
            continue;
        };
        for word in now.words {
            if before.words.iter().all(|kept| kept.value != word.value) {
                reports.report(EditError::Widens(name.clone(), word, first.span.clone()));
            }
        }
    }
    put(&mut base, own, is_same_key);
    base
}

/// The items but those of a name that is another item's now: a material may take the place of an
/// input, and an input that of a material.
fn without(items: Vec<RawItem>, own: &[RawItem]) -> Vec<RawItem> {
    let is_free = |item: &RawItem| own.iter().all(|other| !is_named_as(item, other));
    items.into_iter().filter(is_free).collect()
}

fn is_named_as(item: &RawItem, other: &RawItem) -> bool {
    let name = |item: &RawItem| item.name().map(|name| name.value);
    name(item).is_some_and(|own| Some(own) == name(other))
}

/// Edits of a list of entries.
struct Edits<'r> {
    /// By the path after which entries were put: the name of the last of them.
    ends: HashMap<String, String>,
    /// The path behind which an entry without a place stands: that of the new entry above, or the
    /// one that this stands after.
    above: Option<String>,
    reports: &'r mut Reports,
}

impl Edits<'_> {
    fn apply(&mut self, entries: &mut Entries, mut edit: RawEntry) -> Result<(), EditError> {
        match edit.tag.as_str() {
            "Change" => self.change(entries, edit),
            REMOVE => {
                let path = path_of(&mut edit, "pass")?;
                if let Some(field) = edit.fields.first() {
                    return Err(EditError::Field(field.name.clone(), REMOVE));
                }
                let (list, at) = find(entries, &path)?;
                drop(list.remove(at));
                Ok(())
            }
            _ => self.insert(entries, edit),
        }
    }

    fn change(&mut self, entries: &mut Entries, mut edit: RawEntry) -> Result<(), EditError> {
        let path = path_of(&mut edit, "pass")?;
        let (list, at) = find(entries, &path)?;
        let Ok(entry) = &mut list[at] else {
            return Ok(());
        };
        if edit.passes.is_some() {
            return Err(EditError::Passes(edit.tag.span));
        }
        put(&mut entry.fields, edit.fields, is_same_field);
        put(&mut entry.bind, edit.bind, is_same_key);
        put(&mut entry.set, edit.set, is_same_key);
        Ok(())
    }

    fn insert(&mut self, entries: &mut Entries, mut entry: RawEntry) -> Result<(), EditError> {
        let given = PLACES.into_iter();
        let given: Vec<&str> = given.filter(|place| entry.field(place).is_some()).collect();
        let above = self.above.take();
        let (place, mut path) = match (&given[..], above) {
            ([place], _) => (*place, path_of(&mut entry, place)?),
            ([], Some(above)) => ("after", Located::new(above, entry.tag.span.clone())),
            ([], None) => return Err(EditError::NoPlace(entry.tag.clone())),
            _ => return Err(EditError::TwoPlaces(entry.tag.clone())),
        };
        let name = entry.name().unwrap_or_default();
        self.above = Some(match (place, path.rsplit_once('.')) {
            ("after", _) => path.value.clone(),
            (_, Some((group, _))) => format!("{group}.{name}"),
            (_, None) => name.clone(),
        });
        if place == "after" {
            // Several after one entry stand in the order in which they are written.
            let end = self.ends.insert(path.value.clone(), name.clone());
            if let Some(end) = end {
                let group = path.rsplit_once('.').map(|(group, _)| group.to_owned());
                let last = group.map_or(end.clone(), |group| format!("{group}.{end}"));
                let last = Located::new(last, path.span.clone());
                // It may have been taken out again, or have another name now.
                if find(entries, &last).is_ok() {
                    path = last;
                }
            }
        }
        let (list, at) = find(entries, &path)?;
        match place {
            "before" => list.insert(at, Ok(entry)),
            "after" => list.insert(at + 1, Ok(entry)),
            _ => list[at] = Ok(entry),
        }
        Ok(())
    }
}

/// The path of an entry that a field of an edit names; the field is taken out.
fn path_of(edit: &mut RawEntry, field: &'static str) -> Result<Located<String>, EditError> {
    let path_field = edit.take(field);
    let path_field = path_field.ok_or_else(|| EditError::NoPath(edit.tag.clone(), field))?;
    let path: Result<String, _> = path_field.node.parse();
    let span = path_field.node;
    path.map(|path| Located::new(path, span.clone()))
        .map_err(|_| EditError::NoString(span))
}

/// The list that holds the entry of a path, and its place there.
fn find<'e>(
    entries: &'e mut Entries,
    path: &Located<String>,
) -> Result<(&'e mut Entries, usize), EditError> {
    let mut list = entries;
    let mut names = path.split('.').peekable();
    let mut walked: Vec<&str> = Vec::new();
    while let Some(name) = names.next() {
        let named = |entry: &Result<RawEntry, Invalid>| {
            let entry = entry.as_ref();
            entry.is_ok_and(|entry| entry.name().as_deref() == Some(name))
        };
        let Some(at) = list.iter().position(named) else {
            let peers = list.iter().flatten().filter_map(RawEntry::name).collect();
            return Err(EditError::NoSuchEntry(path.clone(), name.to_owned(), peers));
        };
        if names.peek().is_none() {
            return Ok((list, at));
        }
        walked.push(name);
        let inside = list[at].as_mut();
        let inside = inside.ok().and_then(|entry| entry.passes.as_mut());
        list = inside.ok_or_else(|| EditError::Behind(path.clone(), walked.join(".")))?;
    }
    Err(EditError::NoString(path.span.clone()))
}

/// Reports edits in a document that does not extend another one, and makes their entries invalid.
pub(crate) fn no_edits(entries: &mut Entries, reports: &mut Reports) {
    for slot in entries {
        let Ok(entry) = slot else {
            continue;
        };
        let mut fields = entry.fields.iter();
        let place = fields.find(|field| PLACES.contains(&field.name.as_str()));
        let word = match (entry.tag.as_str(), place) {
            ("Change" | REMOVE, _) => Some(&entry.tag),
            (_, place) => place.map(|field| &field.name),
        };
        if let Some(word) = word {
            let is_include = *entry.tag == "Include";
            let reported = reports.report(EditError::NotExtending(word.clone()));
            *slot = Err(Invalid {
                is_include,
                reported,
            });
            continue;
        }
        if let Some(inside) = &mut entry.passes {
            no_edits(inside, reports);
        }
    }
}
