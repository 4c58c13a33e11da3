//! All lights of a scene, each with a name of its own: `lights[2]` in documents.

use crate::error::Error;
use crate::uniforms::{LightAreaUniform, LightUniform};
use skiagraph_graph::{Provided, ProvidedBinding, ProvidedKind};
use skiagraph_scene::{LightKind, Scene};

/// Every light as `shared/light.wgsl` has it.
pub(crate) const LIGHTS: &str = "lights";
/// Every light's extent as `shared/light_area.wgsl` has it.
pub(crate) const LIGHT_AREAS: &str = "light_areas";

/// All lights of a scene; the default one of a scene that has none.
pub(crate) fn from_scene(scene: &Scene) -> Vec<LightKind> {
    match &scene.lights[..] {
        [] => vec![scene.light()],
        lights => lights.iter().map(|light| light.kind).collect(),
    }
}

/// The kind of a light, as plans and shaders know it.
pub(crate) fn provided_kind(light: &LightKind) -> ProvidedKind {
    let mut words = LightKind::WORDS.iter();
    let number = words.position(|word| *word == light.word());
    ProvidedKind {
        words: &LightKind::WORDS,
        number: number.unwrap_or_default() as u32,
    }
}

/// The extent of a light, as plans and shaders know it.
pub(crate) fn provided_extent(light: &LightKind) -> ProvidedKind {
    /// Radius of a sun at the distance 1: 2.3 degrees across. In four scenes no receiver had a list
    /// longer than 3,008 under 2 degrees (64 samples, 128² pixels); under 5 degrees 6 of 16,384.
    const WIDE: f64 = 0.02;
    let is_sun = matches!(light, LightKind::Directional(_));
    let (_, radius) = light.disk();
    ProvidedKind {
        words: &["none", "narrow", "wide"],
        number: u32::from(radius > 0.0) + u32::from(is_sun && radius > WIDE),
    }
}

/// Names of the lists, and of what is in them.
pub(crate) fn names(count: usize) -> impl Iterator<Item = String> {
    [LIGHTS, LIGHT_AREAS].into_iter().flat_map(move |list| {
        let items = (0..count).map(move |number| format!("{list}.{number}"));
        std::iter::once(list.to_owned()).chain(items)
    })
}

/// Checks lights that are to be the scene's.
///
/// # Errors
/// The number of the first that is none, or that there are none.
pub(crate) fn check(lights: &[LightKind]) -> Result<(), Error> {
    if lights.is_empty() {
        return Err(Error::NoLights);
    }
    for (number, light) in lights.iter().enumerate() {
        let checked = light.check();
        checked.map_err(|why| Error::LightNumber { number, why })?;
    }
    Ok(())
}

/// Returns the error of a name that is asked for, but of a light that the scene does not have (any
/// more); `None` if it is not of a light.
pub(crate) fn gone(name: &str, lights: &[LightKind]) -> Option<Error> {
    let (list, number) = parse(name)?;
    let number = number.filter(|number| *number >= lights.len())?;
    Some(Error::LightGone {
        name: format!("{list}[{number}]"),
        lights: lights.len(),
    })
}

/// Describes the resource behind one of these names.
pub(crate) fn describe(name: &str, lights: &[LightKind]) -> Option<Provided> {
    let (list, number) = parse(name)?;
    let bytes = match list {
        LIGHTS => size_of::<LightUniform>(),
        _ => size_of::<LightAreaUniform>(),
    };
    let Some(number) = number else {
        let (binding, items) = (ProvidedBinding::Storage, lights.len() as u64);
        return Some(Provided::new(binding, Some(items), bytes as u64));
    };
    let light = lights.get(number)?;
    let kind = match list {
        LIGHTS => provided_kind(light),
        _ => provided_extent(light),
    };
    let provided = Provided::new(ProvidedBinding::Uniform, Some(1), bytes as u64);
    Some(provided.with_kind(kind))
}

/// The bytes of what stands behind one of these names; `lay` lays a light around the scene.
pub(crate) fn content(
    name: &str,
    lights: &[LightKind],
    mut lay: impl FnMut(LightKind) -> LightUniform,
) -> Option<Vec<u8>> {
    let (list, number) = parse(name)?;
    let chosen = match number {
        Some(number) => lights.get(number..=number)?,
        None => lights,
    };
    let bytes = |light: &LightKind| match list {
        LIGHTS => bytemuck::bytes_of(&lay(*light)).to_vec(),
        _ => bytemuck::bytes_of(&LightAreaUniform::from(light)).to_vec(),
    };
    Some(chosen.iter().flat_map(bytes).collect())
}

/// The list that a name is of, if it is one of these.
pub(crate) fn list_of(name: &str) -> Option<&'static str> {
    Some(parse(name)?.0)
}

/// The number of the light that a name is of; `None` for other names.
pub(crate) fn number(name: &str) -> Option<usize> {
    parse(name)?.1
}

/// The list of a name, and which of it.
fn parse(name: &str) -> Option<(&'static str, Option<usize>)> {
    let (list, number) = match name.split_once('.') {
        Some((list, number)) => (list, Some(number.parse().ok()?)),
        None => (name, None),
    };
    let mut lists = [LIGHTS, LIGHT_AREAS].into_iter();
    Some((lists.find(|own| *own == list)?, number))
}
