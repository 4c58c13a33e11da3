//! One hard case.

use glam::DVec3;
use skiagraph_scene::Scene;

/// One case of the catalogue.
#[derive(Clone, Copy, Debug)]
pub struct HardCase {
    /// Name on the command line: lower case, words joined by `_`.
    pub name: &'static str,
    /// Error that it provokes, in one line.
    pub reason: &'static str,
    /// Kind of its casters, which decides how methods that cull front faces are tested.
    pub casters: Casters,
    /// Most indeterminate pixels, as a share of the pixels that face the light.
    pub indeterminate_cap: f64,
    /// Answers that its picture shows.
    pub shows: Shows,
    build: fn() -> Scene,
    lit: Option<fn(DVec3) -> Option<bool>>,
}

/// Kinds of casters in a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Casters {
    /// Closed surfaces wound outward that do not pass through each other: no lit surface is its own
    /// caster when front faces are culled.
    Closed,
    /// Sheets, surfaces wound both ways, or solids that pass through each other: front faces
    /// culled, some cast no shadow.
    Open,
}

/// Answers of the pixels of a case's picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shows {
    /// Some lit, some in shadow.
    Both,
    /// All that face the light are lit.
    LitOnly,
    /// All that face the light are in shadow.
    ShadowOnly,
    /// None faces the light.
    Nothing,
}

impl HardCase {
    /// A case of closed casters.
    pub(crate) const fn closed(
        name: &'static str,
        reason: &'static str,
        build: fn() -> Scene,
    ) -> Self {
        Self {
            name,
            reason,
            casters: Casters::Closed,
            indeterminate_cap: 0.01,
            shows: Shows::Both,
            build,
            lit: None,
        }
    }

    /// A case of open ones.
    pub(crate) const fn open(
        name: &'static str,
        reason: &'static str,
        build: fn() -> Scene,
    ) -> Self {
        Self {
            casters: Casters::Open,
            ..Self::closed(name, reason, build)
        }
    }

    /// Whose light is told from the geometry, too, as by [`HardCase::lit`].
    pub(crate) const fn with_answer(mut self, lit: fn(DVec3) -> Option<bool>) -> Self {
        self.lit = Some(lit);
        self
    }

    /// Whose picture does not show both light and shadow.
    pub(crate) const fn showing(mut self, shows: Shows) -> Self {
        self.shows = shows;
        self
    }

    /// With another share of indeterminate pixels than a hundredth at most.
    pub(crate) const fn indeterminate_up_to(mut self, share: f64) -> Self {
        self.indeterminate_cap = share;
        self
    }

    /// Builds it.
    pub fn scene(&self) -> Scene {
        Scene {
            name: self.name.into(),
            ..(self.build)()
        }
    }

    /// Returns true if light reaches a point of a surface that faces the light, told from the
    /// geometry; `None` where it is too close to call or the case has no such answer.
    pub fn lit(&self, point: DVec3) -> Option<bool> {
        self.lit.and_then(|lit| lit(point))
    }

    /// Returns true if [`HardCase::lit`] has answers at all.
    pub fn is_analytic(&self) -> bool {
        self.lit.is_some()
    }
}
