//! Sizes of buffers: item layouts come from the shaders that see them, counts from the document.

use crate::{
    diagnostics::{Code, Diagnostic},
    document::located::Located,
    resolve::{Origin, ResourceId, ResourceKind, Resources},
    source::Span,
    wgsl::{Class, Global},
};
use std::collections::BTreeMap;

/// What shaders said about each buffer.
#[derive(Default)]
pub(crate) struct Layouts {
    seen: BTreeMap<ResourceId, Vec<Seen>>,
    least: BTreeMap<ResourceId, (u64, Span)>,
    same: Vec<[(ResourceId, Located<String>); 2]>,
}

struct Seen {
    fixed: u64,
    stride: Option<u64>,
    layout: String,
    span: Span,
}

impl Layouts {
    /// A shader sees the buffer through this global.
    pub fn see(&mut self, id: ResourceId, global: &Global) {
        if let Class::Storage {
            fixed,
            stride,
            layout,
            ..
        } = &global.class
        {
            let seen = Seen {
                fixed: *fixed,
                stride: *stride,
                layout: layout.clone(),
                span: global.span.clone(),
            };
            self.seen.entry(id).or_default().push(seen);
        }
    }

    /// The buffer must hold so many bytes whatever shaders say.
    pub fn at_least(&mut self, id: ResourceId, bytes: u64, span: Span) {
        let entry = self.least.entry(id).or_insert((0, span));
        entry.0 = entry.0.max(bytes);
    }

    /// The first buffer is copied onto the second: they have one size.
    pub fn same(
        &mut self,
        from: (ResourceId, &Located<String>),
        to: (ResourceId, &Located<String>),
    ) {
        self.same
            .push([from, to].map(|(id, name)| (id, name.clone())));
    }

    /// Gives every buffer its size, or says why it has none.
    pub fn settle(
        self,
        resources: &mut Resources<'_>,
        limits: &wgpu::Limits,
        diagnostics: &mut Vec<Diagnostic>,
    ) {
        for index in 0..resources.list.len() {
            let id = ResourceId(index);
            let seen = self.seen.get(&id).map_or(&[][..], Vec::as_slice);
            let resource = &resources.list[index];
            if let Some(error) = disagreement(&resource.name, seen) {
                diagnostics.push(error);
                continue;
            }
            match &resource.kind {
                ResourceKind::Provided(provided) => {
                    for view in seen {
                        let fits = match view.stride {
                            Some(stride) => view.fixed == 0 && stride == provided.stride,
                            None => provided.items.is_none_or(|items| {
                                view.fixed <= items.saturating_mul(provided.stride)
                            }),
                        };
                        if !fits {
                            diagnostics.push(
                                Diagnostic::error(
                                    Code::LayoutMismatch,
                                    format!(
                                        "`{}` has items of {} bytes",
                                        resource.name, provided.stride
                                    ),
                                )
                                .at(
                                    view.span.clone(),
                                    format!("the shader sees {}", view.layout),
                                ),
                            );
                        }
                    }
                }
                ResourceKind::Buffer(_) if matches!(resource.origin, Origin::Previous(_)) => {}
                ResourceKind::Buffer(buffer) if resource.origin == Origin::Host => {
                    let have = buffer.bytes;
                    let least = self.least.get(&id).map(|(bytes, span)| (*bytes, span));
                    let needs = seen
                        .iter()
                        .map(|view| (view.fixed + view.stride.unwrap_or(0), &view.span));
                    for (bytes, span) in needs.chain(least).filter(|(bytes, _)| *bytes > have) {
                        diagnostics.push(
                            Diagnostic::error(
                                Code::LayoutMismatch,
                                format!(
                                    "the import `{}` has {have} bytes, {bytes} are needed",
                                    resource.name
                                ),
                            )
                            .at(span.clone(), "needed here"),
                        );
                    }
                }
                ResourceKind::Buffer(buffer) => match self.bytes(
                    id,
                    buffer.count,
                    seen,
                    &resource.name,
                    resource.declared.as_ref(),
                ) {
                    Ok(bytes) => {
                        let most = limits
                            .max_buffer_size
                            .min(limits.max_storage_buffer_binding_size);
                        if bytes > most {
                            let mut error = Diagnostic::error(
                                Code::Size,
                                format!(
                                    "`{}` needs {bytes} bytes, more than the adapter can bind",
                                    resource.name
                                ),
                            )
                            .help(format!("its limit is {most} bytes"));
                            if let Some(span) = &resource.declared {
                                error = error.at(span.clone(), "");
                            }
                            diagnostics.push(error);
                        } else if let ResourceKind::Buffer(buffer) = &mut resources.list[index].kind
                        {
                            buffer.bytes = bytes;
                        }
                    }
                    Err(Some(error)) => diagnostics.push(*error),
                    Err(None) => {}
                },
                _ => {}
            }
        }
        self.equal_sizes(resources, diagnostics);
        resources.settle_previous();
    }

    /// A buffer that no shader sees has the size of what it is copied from or to; others must agree.
    fn equal_sizes(&self, resources: &mut Resources<'_>, diagnostics: &mut Vec<Diagnostic>) {
        let bytes = |resources: &Resources<'_>, id: ResourceId| match &resources.list[id.0].kind {
            ResourceKind::Buffer(buffer) => buffer.bytes,
            ResourceKind::Provided(provided) => {
                provided.items.unwrap_or(0).saturating_mul(provided.stride)
            }
            _ => 0,
        };
        // Copies of copies: each round sizes one more link at least.
        for _ in 0..self.same.len() {
            for [(a, _), (b, _)] in &self.same {
                for (id, size) in [(a, bytes(resources, *b)), (b, bytes(resources, *a))] {
                    if let ResourceKind::Buffer(buffer) = &mut resources.list[id.0].kind
                        && buffer.bytes == 0
                    {
                        buffer.bytes = size;
                    }
                }
            }
        }
        for [(a, from), (b, to)] in &self.same {
            let (from_bytes, to_bytes) = (bytes(resources, *a), bytes(resources, *b));
            if from_bytes != to_bytes {
                diagnostics.push(
                    Diagnostic::error(
                        Code::Size,
                        format!(
                            "`{}` cannot be copied onto `{}`: they differ in size",
                            from.value, to.value
                        ),
                    )
                    .at(from.span.clone(), format!("{from_bytes} bytes"))
                    .at(to.span.clone(), format!("{to_bytes} bytes"))
                    .help("give both the same `count`"),
                );
            }
        }
    }

    /// `Err(None)`: nobody uses the buffer, so it needs no size.
    fn bytes(
        &self,
        id: ResourceId,
        count: Option<u64>,
        seen: &[Seen],
        name: &str,
        declared: Option<&Span>,
    ) -> Result<u64, Option<Box<Diagnostic>>> {
        let least = self.least.get(&id).map(|(bytes, _)| *bytes);
        let mut bytes = least;
        for view in seen {
            let size = match (view.stride, count) {
                (None, _) => view.fixed,
                (Some(stride), Some(count)) => {
                    view.fixed.saturating_add(stride.saturating_mul(count))
                }
                (Some(_), None) => {
                    let mut error = Diagnostic::error(
                        Code::Size,
                        format!("`{name}` does not say how many items it has"),
                    )
                    .at(view.span.clone(), "this shader sees an array of any length");
                    if let Some(span) = declared {
                        error = error.at(span.clone(), "give it a `count`");
                    }
                    return Err(Some(Box::new(error)));
                }
            };
            bytes = Some(bytes.unwrap_or(0).max(size));
        }
        // wgpu copies and clears in fours.
        bytes
            .map(|bytes| bytes.checked_next_multiple_of(4).unwrap_or(u64::MAX).max(4))
            .ok_or(None)
    }
}

/// Two shaders that see one buffer differently.
fn disagreement(name: &str, seen: &[Seen]) -> Option<Diagnostic> {
    let first = seen.first()?;
    let other = seen.iter().find(|view| view.layout != first.layout)?;
    Some(
        Diagnostic::error(
            Code::LayoutMismatch,
            format!("two shaders see `{name}` with different layouts"),
        )
        .at(other.span.clone(), format!("here it is {}", other.layout))
        .at(first.span.clone(), format!("here it is {}", first.layout))
        .help("declare the item type once, in a shared module that both import"),
    )
}
