//! Sizes of textures, which may refer to each other.

use super::{Environment, Texture, size_error};
use crate::{
    diagnostics::{Code, Diagnostic},
    document::materials::{Size, TextureEntry},
    registry::Params,
};
use std::collections::{HashMap, HashSet};

/// Resolves sizes that may refer to each other.
pub(super) struct Sizes<'a> {
    pub textures: HashMap<&'a str, &'a TextureEntry>,
    pub params: &'a Params,
    pub environment: &'a Environment<'a>,
    pub done: HashMap<&'a str, Option<[u32; 2]>>,
}

impl<'a> Sizes<'a> {
    pub fn texture(
        &mut self,
        entry: &'a TextureEntry,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Option<Texture> {
        let size = self.size(entry, diagnostics)?;
        let mips = self.params.value(&entry.mips, diagnostics)?;
        let layers = self.params.value(&entry.layers, diagnostics)?;
        let limits = self.environment.limits;
        let most = limits.max_texture_dimension_2d;
        if size.contains(&0) || mips == 0 || layers == 0 {
            let what = format!(
                "{}×{} texels, layers: {layers}, mips: {mips}: a texture of no texels",
                size[0], size[1]
            );
            diagnostics.push(size_error(
                &entry.name,
                &entry.size.span,
                &what,
                "give it one at least",
            ));
            return None;
        }
        if size.iter().any(|&edge| edge > most) {
            diagnostics.push(size_error(
                &entry.name,
                &entry.size.span,
                &format!(
                    "{}×{} texels are more than the adapter can hold",
                    size[0], size[1]
                ),
                &format!("its limit is {most} in each direction"),
            ));
            return None;
        }
        if layers > limits.max_texture_array_layers {
            let help = format!("its limit is {}", limits.max_texture_array_layers);
            diagnostics.push(size_error(
                &entry.name,
                &entry.name.span,
                &format!("{layers} layers are more than the adapter can hold"),
                &help,
            ));
            return None;
        }
        let full = size[0].max(size[1]).ilog2() + 1;
        if mips > full {
            let help = format!("{}×{} texels have {full}", size[0], size[1]);
            diagnostics.push(size_error(
                &entry.name,
                &entry.name.span,
                &format!("{mips} mips are too many"),
                &help,
            ));
            return None;
        }
        Some(Texture {
            format: entry.format.0,
            size,
            mips,
            layers,
        })
    }

    /// Follows `Like` from texture to texture to one that has a size of its own.
    fn size(
        &mut self,
        entry: &'a TextureEntry,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Option<[u32; 2]> {
        let mut chain: Vec<&'a str> = Vec::new();
        let mut seen: HashSet<&'a str> = HashSet::new();
        let mut last = entry;
        let size = loop {
            if let Some(known) = self.done.get(last.name.as_str()) {
                break *known;
            }
            chain.push(&last.name);
            seen.insert(&last.name);
            let Size::Like(other) = &last.size.value else {
                break self.own_size(&last.size.value, diagnostics);
            };
            match self.textures.get(other.as_str()) {
                Some(texture) if seen.contains(texture.name.as_str()) => {
                    let error = size_error(
                        &last.name,
                        &last.size.span,
                        "its size is that of itself",
                        "give one of these textures a size of its own",
                    );
                    diagnostics.push(error);
                    break None;
                }
                Some(texture) => last = texture,
                None => {
                    let error = Diagnostic::error(
                        Code::UnknownResource,
                        format!("no texture is called `{}`", other.value),
                    );
                    let error = error.at(other.span.clone(), "");
                    let known = || {
                        let mut known: Vec<&str> = self
                            .textures
                            .keys()
                            .copied()
                            .filter(|name| *name != last.name.as_str())
                            .collect();
                        known.sort_unstable();
                        known
                    };
                    diagnostics.push(error.suggest_to(diagnostics.len(), other, known));
                    break None;
                }
            }
        };
        self.done.extend(chain.into_iter().map(|name| (name, size)));
        size
    }

    fn own_size(&self, size: &Size, diagnostics: &mut Vec<Diagnostic>) -> Option<[u32; 2]> {
        let [width, height] = self.environment.viewport;
        match size {
            Size::Viewport | Size::Like(_) => Some([width, height]),
            Size::ViewportTimes(factor) => self.params.value(factor, diagnostics).map(|factor| {
                // Saturates, NaN becomes 0: both are caught as sizes that cannot be.
                [width, height].map(|edge| (f64::from(edge) * f64::from(factor)).ceil() as u32)
            }),
            Size::Square(edge) => self
                .params
                .value(edge, diagnostics)
                .map(|edge| [edge, edge]),
            Size::Texels(width, height) => {
                let (width, height) = (
                    self.params.value(width, diagnostics),
                    self.params.value(height, diagnostics),
                );
                width.zip(height).map(|(width, height)| [width, height])
            }
        }
    }
}
