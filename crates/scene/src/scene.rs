//! What is drawn.

use crate::{camera::View, light_kind::Light, mesh::Mesh};

/// A mesh with the views and the light under which it is drawn.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name shown in tables and results.
    pub name: String,
    /// Every triangle, receivers and casters alike.
    pub mesh: Mesh,
    /// At least one view; the first is the default.
    pub views: Vec<View>,
    /// The lights of all views that have none of their own: at least one; the first is the default.
    pub lights: Vec<Light>,
}

impl Scene {
    /// The view of that name, if the scene has one.
    pub fn view(&self, name: &str) -> Option<&View> {
        self.views.iter().find(|view| view.name == name)
    }

    /// The lights under which a view is drawn: its own, or all of the scene's.
    pub fn lights_of(&self, view: &View) -> Vec<Light> {
        match view.light {
            Some(own) => vec![own.into()],
            None => self.lights.clone(),
        }
    }
}
