//! The status of each pixel, from layers drawn on the CPU and receivers in f64.

use super::{
    bounds::SLACK,
    casters::Casters,
    light_space::LightSpace,
    maps::{Layer, Map},
    preset::{CpuReference, Method},
};
use glam::DVec3;
use skiagraph_reference::{
    Error, Progress, Receiver,
    pixels::{check_pixel_count, per_pixel},
    statistics::status,
};
use skiagraph_scene::{Adjacency, Camera, DirectionalLight, LightKind, Mesh};

/// Required `status` of a preset. Both buffers have one entry per pixel, row by row from the top
/// left.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Classification {
    /// One of [`status`](mod@skiagraph_reference::statistics::status).
    pub status: Vec<u32>,
    /// True where rounding and snapping may yield another status; nothing is said of these pixels.
    pub indeterminate: Vec<bool>,
}

/// The layers of a preset over one mesh under one light, for any number of views.
pub struct Maps<'a> {
    mesh: &'a Mesh,
    space: LightSpace,
    light: LightKind,
    layers: Layers,
}

enum Layers {
    One(Map),
    Two { outer: Map, inner: Map },
}

impl CpuReference {
    /// Draws the layers. `adjacency` is the mesh's own.
    ///
    /// # Errors
    /// [`Error::Light`].
    pub fn maps<'a>(
        &self,
        mesh: &'a Mesh,
        adjacency: &Adjacency,
        light: &DirectionalLight,
    ) -> Result<Maps<'a>, Error> {
        light.check().map_err(Error::Light)?;
        let space = LightSpace::new(mesh, light, self.map_size);
        let casters = Casters::new(mesh, adjacency, space, self.cull);
        let (n, depth) = (self.n, self.depth);
        let two = |inner| Layers::Two {
            outer: Map::draw(&casters, Layer::Outer(n, depth)),
            inner: Map::draw(&casters, inner),
        };
        let layers = match self.method {
            Method::HybridPcf => Layers::One(Map::draw(&casters, Layer::Centres)),
            Method::Crsm => two(Layer::Inner(n, depth)),
            Method::Crsma => two(Layer::InnerAdjacency(n, depth)),
            Method::CrsmaFull => two(Layer::InnerOneRing(depth)),
        };
        Ok(Maps {
            mesh,
            space,
            light: light.into(),
            layers,
        })
    }
}

/// Statuses that a pixel may have.
#[derive(Clone, Copy, Default)]
struct Possible {
    light: bool,
    shadow: bool,
    uncertain: bool,
}

impl Possible {
    const UNCERTAIN: Self = Self {
        light: false,
        shadow: false,
        uncertain: true,
    };

    fn or(self, other: Self) -> Self {
        Self {
            light: self.light || other.light,
            shadow: self.shadow || other.shadow,
            uncertain: self.uncertain || other.uncertain,
        }
    }

    /// The status, if there is but one; else *uncertain*, indeterminate.
    fn settled(self) -> (u32, bool) {
        match (self.light, self.shadow, self.uncertain) {
            (true, false, false) => (status::CERTAIN_LIGHT, false),
            (false, true, false) => (status::CERTAIN_SHADOW, false),
            (false, false, true) => (status::UNCERTAIN, false),
            _ => (status::UNCERTAIN, true),
        }
    }
}

/// A receiver in texels and depth, the error of each, and what the status's comparison allows for.
struct Place {
    at: DVec3,
    error: DVec3,
    allowance: (f64, f64),
}

impl Place {
    /// Texels in which the receiver may lie, or `None` outside the map.
    fn texels(&self, size: usize) -> impl Iterator<Item = Option<[usize; 2]>> {
        let range = |axis: usize| {
            let floored = |error: f64| (self.at[axis] + error).floor();
            (
                floored(-self.error[axis]) as i64,
                floored(self.error[axis]) as i64,
            )
        };
        let ((left, right), (top, bottom)) = (range(0), range(1));
        let inside = move |x: i64| (0..size as i64).contains(&x).then_some(x as usize);
        (top..=bottom)
            .flat_map(move |y| (left..=right).map(move |x| Some([inside(x)?, inside(y)?])))
    }
}

impl Maps<'_> {
    /// Classifies every pixel of a G-buffer; `primitives` as for
    /// [`Oracle::shade`](skiagraph_reference::Oracle::shade), with the same receivers.
    ///
    /// # Errors
    /// [`Error::PixelCount`], [`Error::UnknownPrimitive`], [`Error::Interrupted`].
    pub fn classify(
        &self,
        camera: &Camera,
        primitives: &[u32],
        progress: Progress,
    ) -> Result<Classification, Error> {
        let viewport = camera.viewport;
        check_pixel_count("primitives", viewport, primitives.len())?;
        let answers = per_pixel(viewport, progress, |x, y, _| {
            let pixel = [x, y];
            let receiver = Receiver::from_pixel(self.mesh, primitives, camera, pixel, &self.light)?;
            let background = (status::BACKGROUND, false);
            Ok(receiver.map_or(background, |receiver| self.answer(&receiver)))
        })?;
        let (status, indeterminate) = answers.into_iter().unzip();
        Ok(Classification {
            status,
            indeterminate,
        })
    }

    fn answer(&self, receiver: &Receiver) -> (u32, bool) {
        let facing_indeterminate = receiver.n_dot_l.abs() <= receiver.n_dot_l_error;
        if receiver.n_dot_l <= 0.0 {
            return (status::FACING_AWAY, facing_indeterminate);
        }
        let Some(uncertainty) = &receiver.uncertainty else {
            return (status::UNCERTAIN, true);
        };
        let ball = self.space.texel_ball() * uncertainty.radius;
        let across = self.space.across_error();
        let rounding = DVec3::new(across, across, self.space.depth_error());
        let segments = uncertainty
            .segments
            .map(|s| self.space.texel_vector(s).abs());
        let place = Place {
            at: self.space.texel(receiver.position),
            error: segments.iter().sum::<DVec3>() + ball + rounding,
            allowance: self.space.light_space_error_bound(receiver.position),
        };
        if place.error.truncate().max_element() > 1.0 {
            return (status::UNCERTAIN, true);
        }
        let (status, indeterminate) = match &self.layers {
            Layers::One(map) => self.contours(map, &place),
            Layers::Two { outer, inner } => self.layers(outer, inner, &place),
        }
        .settled();
        (status, indeterminate || facing_indeterminate)
    }

    /// CPU reference of shaders/detect_uncertain.wgsl.
    fn layers(&self, outer: &Map, inner: &Map, place: &Place) -> Possible {
        let size = self.space.size();
        let (across, along) = place.allowance;
        // The shader refuses what may lie in another texel; the allowance itself is rounded.
        let refusal = across - SLACK;
        let refused = refusal > 1e-3 * SLACK;
        let mut possible = Possible {
            uncertain: refusal > -1e-3 * SLACK,
            ..Possible::default()
        };
        if refused {
            return possible;
        }
        let (near, far) = (place.at.z - place.error.z, place.at.z + place.error.z);
        let doubt = along * 1e-3;
        for texel in place.texels(size as usize) {
            let Some(texel) = texel else {
                possible = possible.or(Possible::UNCERTAIN);
                continue;
            };
            let nearest = [
                outer.low(texel).min(inner.low(texel)),
                outer.high(texel).min(inner.high(texel)),
            ];
            let farthest = [
                outer.low(texel).max(inner.low(texel)),
                outer.high(texel).max(inner.high(texel)),
            ];
            let surely_lit = far + along + doubt <= nearest[0];
            let surely_in_shadow = near - along - doubt > farthest[1];
            possible = possible.or(Possible {
                light: near + along - doubt <= nearest[1],
                shadow: far - along + doubt > farthest[0],
                uncertain: !surely_lit && !surely_in_shadow,
            });
        }
        possible
    }

    /// CPU reference of shaders/detect_contours.wgsl.
    fn contours(&self, map: &Map, place: &Place) -> Possible {
        let size = self.space.size() as usize;
        let (near, far) = (place.at.z - place.error.z, place.at.z + place.error.z);
        let mut possible = Possible::default();
        if place.texels(size).any(|texel| texel.is_none()) {
            possible.uncertain = true;
        }
        // Where the four texels may begin: one of them, but next to a texel's centre.
        let begin = |axis: usize| {
            let texel = |error: f64| (place.at[axis] - 0.5 + error).floor() as i64;
            texel(-place.error[axis])..=texel(place.error[axis])
        };
        let inside = |texel: i64| texel.clamp(0, size as i64 - 1) as usize;
        for (top, left) in begin(1).flat_map(|y| begin(0).map(move |x| (y, x))) {
            let mut corners: Vec<[usize; 2]> = [(0, 0), (1, 0), (0, 1), (1, 1)]
                .map(|(right, down)| [inside(left + right), inside(top + down)])
                .to_vec();
            corners.dedup();
            let lit = corners.iter().map(|&texel| near <= map.high(texel));
            let dark = corners.iter().map(|&texel| far > map.low(texel));
            let (lit, dark): (Vec<bool>, Vec<bool>) = (lit.collect(), dark.collect());
            // Two texels that may disagree: one lit, another one dark.
            let disagree = (0..corners.len())
                .any(|i| lit[i] && (0..corners.len()).any(|j| corners[j] != corners[i] && dark[j]));
            possible = possible.or(Possible {
                light: lit.iter().all(|&lit| lit),
                shadow: dark.iter().all(|&dark| dark),
                uncertain: disagree,
            });
        }
        possible
    }
}
