//! Casters and the light, on their way from Bevy's world to the graph.

use crate::Caster;
use bevy::{
    mesh::{Indices, VertexAttributeValues},
    prelude::*,
    render::{RenderApp, extract_resource::ExtractResource},
};
use glam::{DAffine3, DVec3};
use skiagraph_scene::{Indexed, Mesh as Solid, Movable};
use std::sync::Arc;

/// All casters and the light, as of this frame.
#[derive(Resource, Clone, Default, ExtractResource)]
#[extract_app(RenderApp)]
pub struct Casters {
    /// Which they are, in the order of the parts.
    of: Vec<(Entity, AssetId<Mesh>)>,
    pub parts: Option<Arc<Movable>>,
    pub maps: Vec<DAffine3>,
    /// Whither the light travels.
    pub light: Option<DVec3>,
}

/// Joins the casters' meshes anew when there are others; otherwise takes their places only.
pub fn gather(
    casters: Query<(Entity, &Mesh3d, &GlobalTransform), With<Caster>>,
    lights: Query<&GlobalTransform, With<DirectionalLight>>,
    meshes: Res<Assets<Mesh>>,
    mut gathered: ResMut<Casters>,
) -> Result {
    // One of scale 0, as programs hide things, throws no shadow, and has no normals to be moved.
    let has_extent = |place: &GlobalTransform| place.affine().matrix3.determinant() != 0.0;
    let casters = casters.iter().filter(|(.., place)| has_extent(place));
    let mut casters: Vec<_> = casters.collect();
    casters.sort_by_key(|(entity, ..)| *entity);
    let ids: Vec<_> = casters
        .iter()
        .map(|(entity, mesh, _)| (*entity, mesh.0.id()))
        .collect();
    if ids != gathered.of || gathered.parts.is_none() {
        let solids = casters.iter().map(|(_, mesh, _)| {
            let mesh = meshes.get(&mesh.0).ok_or("a caster's mesh is not loaded")?;
            solid(mesh)
        });
        let solids: Vec<Solid> = solids.collect::<Result<_>>()?;
        let solids: Vec<&Solid> = solids.iter().collect();
        gathered.parts = Some(Arc::new(Movable::joined(&solids)));
        gathered.of = ids;
    }
    gathered.maps = casters.iter().map(|(.., place)| affine(place)).collect();
    let light = lights.iter().next();
    gathered.light = light.map(|place| DVec3::from_array(place.forward().as_dvec3().to_array()));
    Ok(())
}

fn affine(place: &GlobalTransform) -> DAffine3 {
    let columns = place.affine().to_cols_array();
    DAffine3::from_cols_array(&columns.map(f64::from))
}

fn solid(mesh: &Mesh) -> Result<Solid> {
    let vectors = |attribute| match mesh.attribute(attribute) {
        Some(VertexAttributeValues::Float32x3(values)) => values.as_slice(),
        _ => &[],
    };
    let indices: Vec<u32> = match mesh.indices() {
        Some(Indices::U32(indices)) => indices.clone(),
        Some(Indices::U16(indices)) => indices.iter().copied().map(u32::from).collect(),
        None => (0..mesh.count_vertices() as u32).collect(),
    };
    let indexed = Indexed {
        positions: vectors(Mesh::ATTRIBUTE_POSITION),
        normals: vectors(Mesh::ATTRIBUTE_NORMAL),
        indices: &indices,
    };
    Ok(indexed.mesh()?)
}
