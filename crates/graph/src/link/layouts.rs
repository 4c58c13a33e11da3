//! Sizes of buffers: item layouts come from the shaders that see them, counts from the document.

use crate::{
    errors::layout::LayoutError,
    instantiate::SymbolTable,
    resource::{Buffer, FRAME_BYTES, Origin, ResourceId, ResourceKind, SubresourceRange, Target},
    shader::{Class, Field, Global, Item},
    source::{Located, Span},
};
use std::{collections::BTreeMap, sync::Arc};

/// Layouts that shaders declare for each buffer, from which the sizes of buffers follow.
#[derive(Default)]
pub(super) struct Layouts {
    seen: BTreeMap<ResourceId, Vec<Seen>>,
    least: BTreeMap<ResourceId, (u64, Span)>,
    /// Bytes of an item as the CPU has it.
    handed: BTreeMap<ResourceId, Vec<(u64, Span)>>,
    same: Vec<[(Target, Located<String>); 2]>,
}

/// How a shader sees a buffer or some of its items.
struct Seen {
    fixed: u64,
    stride: Option<u64>,
    layout: String,
    item: Option<Item>,
    span: Span,
    part: SubresourceRange,
    uniform: bool,
}

impl Layouts {
    /// Adds the layout that a shader declares, by the global `global`, for the part `part` of the
    /// buffer `id`. A global that is not a buffer is ignored.
    pub fn see(&mut self, id: ResourceId, part: &SubresourceRange, global: &Global) {
        let (fixed, stride, layout, uniform) = match &global.class {
            Class::Storage {
                fixed,
                stride,
                layout,
                ..
            } => (*fixed, *stride, layout, false),
            Class::Uniform { size, layout, .. } => (*size, None, layout, true),
            _ => return,
        };
        self.seen.entry(id).or_default().push(Seen {
            fixed,
            stride,
            layout: layout.clone(),
            item: global.item.clone(),
            span: global.span.clone(),
            part: part.clone(),
            uniform,
        });
    }

    /// Adds that a buffer must hold at least `bytes` bytes. Does nothing if `part` is a range of
    /// items, whose size shaders declare.
    pub fn at_least(&mut self, id: ResourceId, part: &SubresourceRange, bytes: u64, span: &Span) {
        // Items are as large as shaders say; that these are large enough is theirs to see.
        if *part == SubresourceRange::WHOLE {
            let entry = self.least.entry(id).or_insert((0, span.clone()));
            entry.0 = entry.0.max(bytes);
        }
    }

    /// Adds that the items of a buffer, each of `bytes` bytes, are handed to the CPU.
    pub fn hand(&mut self, id: ResourceId, bytes: u64, span: &Span) {
        let handed = self.handed.entry(id).or_default();
        handed.push((bytes, span.clone()));
    }

    /// Adds that the buffer `from`, or part of it, is copied onto `to`, so that both must have the
    /// same size.
    pub fn same(&mut self, from: (Target, Located<String>), to: (Target, Located<String>)) {
        self.same.push([from, to]);
    }

    /// Returns every buffer of the plan, by id, with its size, item stride and content, and the
    /// mistakes of buffers whose size cannot be found.
    pub fn sized(
        self,
        symbols: &SymbolTable<'_>,
    ) -> (BTreeMap<ResourceId, Buffer>, Vec<LayoutError>) {
        let (mut buffers, mut errors) = (BTreeMap::new(), Vec::new());
        for (index, resource) in symbols.resources.iter().enumerate() {
            let id = ResourceId(index);
            let seen = self.seen.get(&id).map_or(&[][..], Vec::as_slice);
            if let ResourceKind::Buffer(buffer) = &resource.kind {
                buffers.insert(id, buffer.clone());
            }
            if let Some(error) = disagreement(&resource.name, seen) {
                let has_size = matches!(error, LayoutError::Swapped { .. });
                errors.push(error);
                if !has_size {
                    continue;
                }
            }
            match (&resource.kind, resource.origin) {
                (ResourceKind::Provided(provided), Origin::Host) => {
                    let name = resource.name.clone();
                    let sees = seen.iter().filter(|view| !fits(view, *provided));
                    errors.extend(sees.map(|view| LayoutError::Provided {
                        name: name.clone(),
                        stride: provided.stride,
                        layout: view.layout.clone(),
                        span: view.span.clone(),
                    }));
                    let handed = self.handed.get(&id).into_iter().flatten();
                    let other = handed.filter(|(bytes, _)| *bytes != provided.stride);
                    errors.extend(other.map(|(needed, span)| LayoutError::Handed {
                        name: name.clone(),
                        have: provided.stride,
                        needed: *needed,
                        span: span.clone(),
                    }));
                }
                (ResourceKind::Buffer(buffer), Origin::Host) => {
                    let name = resource.name.clone();
                    errors.extend(self.imported(id, &name, buffer, seen));
                }
                (ResourceKind::Buffer(buffer), Origin::Own | Origin::Constant) => {
                    match self.size(id, buffer, seen, symbols) {
                        Ok(buffer) => drop(buffers.insert(id, buffer)),
                        Err(error) => errors.push(error),
                    }
                }
                _ => {}
            }
        }
        errors.extend(self.equal_sizes(symbols, &mut buffers));
        (buffers, errors)
    }

    /// Checks that an import is large enough.
    fn imported(
        &self,
        id: ResourceId,
        name: &str,
        buffer: &Buffer,
        seen: &[Seen],
    ) -> Vec<LayoutError> {
        let have = buffer.bytes;
        let least = self.least.get(&id).map(|(bytes, span)| (*bytes, span));
        let needs = seen.iter();
        let needs = needs.map(|view| (view.fixed + view.stride.unwrap_or(0), &view.span));
        let short = needs.chain(least).filter(|(bytes, _)| *bytes > have);
        short
            .map(|(needed, span)| LayoutError::Import {
                name: name.to_owned(),
                have,
                needed,
                span: span.clone(),
            })
            .collect()
    }

    /// Returns a buffer of the document with its size and content.
    fn size(
        &self,
        id: ResourceId,
        buffer: &Buffer,
        seen: &[Seen],
        symbols: &SymbolTable<'_>,
    ) -> Result<Buffer, LayoutError> {
        let resource = symbols.get(id);
        let mut sized = buffer.clone();
        let declared = || resource.declared.clone();
        // A pass's own buffers and captures have their bytes counted, in fours.
        let is_declared = resource.declared.is_some();
        let items = match buffer.count {
            Some(count) if is_declared => count,
            _ => 1,
        };
        let is_whole = |view: &&Seen| view.part == SubresourceRange::WHOLE;
        let whole = || seen.iter().filter(is_whole);
        let mut bytes = self.least.get(&id).map(|(bytes, _)| *bytes);
        for view in whole() {
            let size = match (view.stride, buffer.count) {
                (None, _) => view.fixed,
                (Some(stride), Some(_)) => {
                    sized.stride = stride;
                    view.fixed.saturating_add(stride.saturating_mul(items))
                }
                (Some(_), None) => {
                    let (name, span) = (resource.name.clone(), view.span.clone());
                    return Err(LayoutError::NoCount(name, span, declared()));
                }
            };
            bytes = Some(bytes.unwrap_or(0).max(size));
        }
        for (item, span) in self.handed.get(&id).into_iter().flatten() {
            let (have, needed) = (sized.stride, *item);
            if have != 0 && have != needed {
                return Err(LayoutError::Handed {
                    name: resource.name.clone(),
                    have,
                    needed,
                    span: span.clone(),
                });
            }
            sized.stride = needed;
            bytes = Some(bytes.unwrap_or(0).max(items.saturating_mul(needed)));
        }
        let is_array = whole().any(|view| view.stride.is_some());
        if is_declared
            && !is_array
            && buffer.data.is_none()
            && let (Some(_), Some(fixed)) = (buffer.count, whole().next())
        {
            let (name, span) = (resource.name.clone(), fixed.span.clone());
            return Err(LayoutError::IgnoredCount(name, span, declared()));
        } else if !is_declared && let Some(count) = buffer.count {
            bytes = Some(bytes.unwrap_or(0).max(count * 4));
        }
        self.items(&sized, seen, symbols, &resource.name)?;
        if let Some(data) = &buffer.data {
            let content = content(&resource.name, data, seen, declared())?;
            bytes = Some(content.len() as u64);
            sized.content = Some(content);
        }
        let limits = &symbols.request.limits;
        let most = limits
            .max_buffer_size
            .min(limits.max_storage_buffer_binding_size);
        // wgpu copies and clears in fours; a buffer without a size is not used.
        let bytes = bytes.map_or(0, |bytes| {
            bytes.checked_next_multiple_of(4).unwrap_or(u64::MAX).max(4)
        });
        sized.bytes = bytes;
        if bytes > most {
            return Err(LayoutError::TooLarge {
                name: resource.name.clone(),
                bytes,
                most,
                declared: declared(),
            });
        }
        Ok(sized)
    }

    /// Checks items that are bound alone: each must be as large as the shader's type, and begin at
    /// an offset that the device can bind.
    fn items(
        &self,
        sized: &Buffer,
        seen: &[Seen],
        symbols: &SymbolTable<'_>,
        name: &str,
    ) -> Result<(), LayoutError> {
        let limits = &symbols.request.limits;
        for view in seen {
            let Some(items) = view.part.items() else {
                continue;
            };
            let needed = view.fixed + view.stride.unwrap_or(0);
            let have = sized.stride.saturating_mul(items.len() as u64);
            if sized.stride == 0 || needed > have {
                return Err(LayoutError::Item {
                    name: name.to_owned(),
                    have,
                    needed,
                    span: view.span.clone(),
                });
            }
            let alignment = u64::from(if view.uniform {
                limits.min_uniform_buffer_offset_alignment
            } else {
                limits.min_storage_buffer_offset_alignment
            });
            if !sized.stride.is_multiple_of(alignment) {
                return Err(LayoutError::Alignment {
                    name: name.to_owned(),
                    stride: sized.stride,
                    alignment,
                    span: view.span.clone(),
                });
            }
        }
        Ok(())
    }

    /// Gives a buffer that no shader sees the size of the buffer that it is copied from or to.
    /// Checks that all other copied buffers have the same size.
    fn equal_sizes(
        &self,
        symbols: &SymbolTable<'_>,
        buffers: &mut BTreeMap<ResourceId, Buffer>,
    ) -> Vec<LayoutError> {
        let bytes = |buffers: &BTreeMap<ResourceId, Buffer>, copied: &Target| {
            let (bytes, stride) = match (buffers.get(&copied.id), &symbols.get(copied.id).kind) {
                (Some(buffer), _) => (buffer.bytes, buffer.stride),
                (_, ResourceKind::Provided(provided)) => {
                    let items = provided.items.unwrap_or(0);
                    (items.saturating_mul(provided.stride), provided.stride)
                }
                (_, ResourceKind::Frame) => (FRAME_BYTES, FRAME_BYTES),
                _ => (0, 0),
            };
            let items = copied.part.items().map(|items| items.len() as u64 * stride);
            items.unwrap_or(bytes)
        };
        // Copies of copies: each round sizes one more link at least, or is the last.
        let mut sized = true;
        while std::mem::take(&mut sized) {
            for [(a, _), (b, _)] in &self.same {
                let sizes = [bytes(buffers, b), bytes(buffers, a)];
                for (copied, size) in [a, b].into_iter().zip(sizes) {
                    if let Some(buffer) = buffers.get_mut(&copied.id)
                        && buffer.bytes == 0
                        && size > 0
                        && copied.part == SubresourceRange::WHOLE
                    {
                        buffer.bytes = size;
                        sized = true;
                    }
                }
            }
        }
        let mut errors = Vec::new();
        for [(a, from), (b, to)] in &self.same {
            let bytes = [bytes(buffers, a), bytes(buffers, b)];
            if bytes[0] != bytes[1] {
                let (from, to) = (from.clone(), to.clone());
                errors.push(LayoutError::Copy { from, to, bytes });
            }
        }
        errors
    }
}

/// True if a shader's view of a provided buffer is one of its items.
fn fits(view: &Seen, provided: crate::provider::Provided) -> bool {
    let items = view.part.items().map(|items| items.len() as u64);
    let items = items.or(provided.items);
    match view.stride {
        Some(stride) => view.fixed == 0 && stride == provided.stride,
        None => items.is_none_or(|items| view.fixed <= items.saturating_mul(provided.stride)),
    }
}

/// Returns the mistake of two shaders that declare one buffer differently; `None` if all agree.
fn disagreement(name: &str, seen: &[Seen]) -> Option<LayoutError> {
    let seen = seen.iter();
    let mut whole = seen.filter(|view| view.part == SubresourceRange::WHOLE);
    let first = whole.next()?;
    let (name, spans) = (name.to_owned(), |other: &Seen| {
        [first.span.clone(), other.span.clone()]
    });
    if let Some(other) = whole.clone().find(|view| view.layout != first.layout) {
        let layouts = [first.shown(), other.shown()];
        return Some(LayoutError::Disagreement(name, layouts, spans(other)));
    }
    let (other, (member, offsets)) =
        whole.find_map(|view| Some((view, swapped(first.item.as_ref()?, view.item.as_ref()?)?)))?;
    Some(LayoutError::Swapped {
        name,
        member,
        offsets,
        spans: spans(other),
    })
}

/// Returns the first name that two items have at different offsets, with both.
fn swapped(first: &Item, other: &Item) -> Option<(String, [usize; 2])> {
    first.fields.iter().find_map(|field| {
        let mut named = other.fields.iter().filter(|it| it.name == field.name);
        let other = named.find(|it| it.offset != field.offset)?;
        Some((field.name.clone(), [field.offset, other.offset]))
    })
}

impl Seen {
    /// The layout for a message: the names of its members with their types and offsets, if they are
    /// few.
    fn shown(&self) -> String {
        const FEW: usize = 8;
        match &self.item {
            Some(Item { stride, fields }) if (2..=FEW).contains(&fields.len()) => {
                let shown = |field: &Field| {
                    let (name, scalar) = (&field.name, field.scalar.as_str());
                    format!("{name} ({scalar} at byte {})", field.offset)
                };
                let fields: Vec<String> = fields.iter().map(shown).collect();
                format!("{}; {stride} bytes each", fields.join(", "))
            }
            _ => self.layout.clone(),
        }
    }
}

/// Returns the bytes of the items in `data`, in the layout of the shader that sees them.
fn content(
    name: &str,
    data: &[Vec<f64>],
    seen: &[Seen],
    declared: Option<Span>,
) -> Result<Arc<[u8]>, LayoutError> {
    let Some(view) = seen.first() else {
        // No shader sees it: these are arguments of draws or dispatches.
        let words = data.iter().flatten().map(|number| *number as u32);
        return Ok(words.flat_map(u32::to_le_bytes).collect());
    };
    let wrong = |what: String| LayoutError::Data {
        name: name.to_owned(),
        what,
        span: view.span.clone(),
        declared: declared.clone(),
    };
    let Some(Item { stride, fields }) = &view.item else {
        return Err(wrong(
            "the shader's items are not plain 32-bit numbers".to_owned(),
        ));
    };
    // A fixed type is one item, or an array of so many.
    let fixed = view.fixed / (*stride as u64).max(1);
    if view.stride.is_none() && fixed != data.len() as u64 {
        let have = data.len();
        return Err(wrong(format!("there are {have} items, it holds {fixed}")));
    }
    let mut bytes = vec![0; stride * data.len()];
    for (index, item) in data.iter().enumerate() {
        if item.len() != fields.len() {
            let (have, needed) = (item.len(), fields.len());
            return Err(wrong(format!(
                "item {index} is {have} numbers, the shader's {needed}"
            )));
        }
        for (number, field) in item.iter().zip(fields) {
            let Some(word) = field.scalar.bits(*number) else {
                return Err(wrong(format!(
                    "{number} does not fit into {:?}",
                    field.scalar
                )));
            };
            let at = index * stride + field.offset;
            if let Some(place) = bytes.get_mut(at..at + 4) {
                place.copy_from_slice(&word.to_le_bytes());
            }
        }
    }
    Ok(bytes.into())
}
