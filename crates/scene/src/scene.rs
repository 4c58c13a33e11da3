//! What is drawn.

use crate::{camera::View, light::DirectionalLight, mesh::Mesh};

/// A mesh with the views and the light under which it is drawn.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name shown in tables and results.
    pub name: String,
    /// Every triangle, receivers and casters alike.
    pub mesh: Mesh,
    /// At least one view; the first is the default.
    pub views: Vec<View>,
    /// The light of all views that have none of their own.
    pub light: DirectionalLight,
}

impl Scene {
    /// The view of that name, if the scene has one.
    pub fn view(&self, name: &str) -> Option<&View> {
        self.views.iter().find(|view| view.name == name)
    }

    /// The light under which a view is drawn.
    pub fn light_of(&self, view: &View) -> DirectionalLight {
        view.light.unwrap_or(self.light)
    }
}
