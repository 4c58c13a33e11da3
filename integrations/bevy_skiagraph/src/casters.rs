//! Casters of Bevy's world, on their way to the scene of the graphs. The main world prepares
//! meshes, and tells the render world of what has changed only.

use crate::{
    SkiagraphShadows,
    skins::{Joints, skinned},
    views::Views,
};
use bevy::{
    asset::{AssetEvent, RenderAssetUsages},
    camera::visibility::{InheritedVisibility, RenderLayers, VisibilityRange},
    ecs::entity::EntityHashMap,
    image::{ImageAddressMode, ImageSampler},
    light::NotShadowCaster,
    math::Affine2,
    mesh::{Indices, PrimitiveTopology, VertexAttributeValues, skinning::SkinnedMesh},
    platform::collections::{HashMap, HashSet},
    prelude::*,
    render::MainWorld,
};
use glam::DAffine3;
use skiagraph_passes::PartMesh;
use skiagraph_scene::{Indexed, Mask, Material, Mesh as Solid, Wrap};
use std::{borrow::Cow, sync::Arc};

/// Greatest alpha through which Bevy draws no shadow of a material that blends.
const FAINTEST: f32 = 0.05;

/// Change of a caster, for the render world.
pub enum Change {
    /// The caster is new, or has another mesh.
    Mesh(Entity, PartMesh, DAffine3),
    /// The caster has moved.
    Place(Entity, DAffine3),
    /// The caster is gone, or casts no shadow any more.
    Gone(Entity),
}

/// Casters that the render world knows, and their changes in this frame.
#[derive(Resource, Default)]
pub struct Casters {
    casters: EntityHashMap<Caster>,
    /// Prepared meshes; `None` for those that cannot be prepared, which the log has told.
    meshes: HashMap<Key, Option<PartMesh>>,
    changes: Vec<Change>,
    frame: u32,
    /// True if some prepared meshes may have lost their last caster.
    has_unused: bool,
}

/// Mesh of a caster, and the last frame in which it cast a shadow.
struct Caster {
    key: Key,
    frame: u32,
}

/// A mesh, and the holes that its material cuts into it.
#[derive(Clone, PartialEq, Eq, Hash)]
struct Key {
    mesh: AssetId<Mesh>,
    holes: Option<Holes>,
    is_skinned: bool,
}

#[derive(Clone, PartialEq, Eq, Hash)]
struct Holes {
    image: AssetId<Image>,
    /// Least alpha of a texel that is there, in bits of f32.
    least: u32,
    /// Columns of the map of texture coordinates, in bits of f32.
    map: [u32; 6],
}

/// Assets that are read to prepare meshes.
type Stores<'w> = (Res<'w, Assets<Mesh>>, Res<'w, Assets<Image>>);

/// Lights of ours, with the layers that they shine on, and cameras.
type Seen<'w, 's> = (
    Query<'w, 's, Option<&'static RenderLayers>, With<SkiagraphShadows>>,
    Query<'w, 's, (&'static Camera, &'static GlobalTransform), With<Camera3d>>,
);

/// All that a caster's shadow depends on.
type Candidate<'a> = (
    Entity,
    &'a Mesh3d,
    Ref<'a, GlobalTransform>,
    &'a InheritedVisibility,
    Option<&'a MeshMaterial3d<StandardMaterial>>,
    Option<&'a SkinnedMesh>,
    (Option<&'a RenderLayers>, Option<&'a VisibilityRange>),
);

/// Compares all casters with those that the render world knows.
pub fn gather(
    query: Query<Candidate, Without<NotShadowCaster>>,
    (stores, joints): (Stores, Joints),
    (lights, cameras): Seen,
    materials: Res<Assets<StandardMaterial>>,
    (edited_meshes, edited_images): (
        MessageReader<AssetEvent<Mesh>>,
        MessageReader<AssetEvent<Image>>,
    ),
    mut casters: ResMut<Casters>,
) {
    if lights.is_empty() && casters.casters.is_empty() {
        return;
    }
    let layers = lights.iter().flatten();
    let layers = layers.fold(RenderLayers::none(), |layers, own| layers.union(own));
    let has_plain = lights.iter().any(|own| own.is_none());
    let layers = if has_plain { layers.with(0) } else { layers };
    let (meshes, images) = (edited(edited_meshes), edited(edited_images));
    let is_edited = |key: &Key| {
        let holes = key.holes.as_ref();
        meshes.contains(&key.mesh) || holes.is_some_and(|holes| images.contains(&holes.image))
    };
    if !meshes.is_empty() || !images.is_empty() {
        casters.meshes.retain(|key, _| !is_edited(key));
    }
    casters.frame = casters.frame.wrapping_add(1);
    for (entity, mesh, place, visibility, material, skin, (own_layers, range)) in &query {
        let is_near = |range: &VisibilityRange| {
            let mut cameras = cameras.iter().filter(|(camera, _)| camera.is_active);
            cameras.any(|(_, eye)| {
                range.is_visible_at_all(eye.translation().distance(place.translation()))
            })
        };
        let is_lit = own_layers.unwrap_or_default().intersects(&layers);
        // Programs hide things by a scale of 0, too.
        let has_extent = skin.is_some() || place.affine().matrix3.determinant() != 0.0;
        if !is_lit || !has_extent || !visibility.get() || !range.is_none_or(is_near) {
            continue;
        }
        let material = material.and_then(|material| materials.get(&material.0));
        let Some(holes) = holes(material) else {
            continue;
        };
        let key = Key {
            mesh: mesh.0.id(),
            holes,
            is_skinned: skin.is_some(),
        };
        let is_edited = is_edited(&key);
        match skin {
            None => {
                let prepared = || prepare(&key, &stores, None);
                let map = (affine(&place), place.is_changed());
                casters.follow(entity, &key, map, is_edited, prepared);
            }
            // Its joints bring it into the world.
            Some(skin) => {
                let prepared = || {
                    let joints = joints.matrices(skin);
                    joints.and_then(|joints| prepare(&key, &stores, Some(&joints)))
                };
                let is_other = is_edited || joints.have_moved(skin);
                let map = (DAffine3::IDENTITY, false);
                casters.follow(entity, &key, map, is_other, prepared);
            }
        }
    }
    casters.drop_unseen();
}

impl Casters {
    /// Compares a caster with the one that the render world knows. `is_other` says that its mesh is
    /// another one by the same key; `prepare` is called for a mesh that is not prepared.
    fn follow(
        &mut self,
        entity: Entity,
        key: &Key,
        (map, has_moved): (DAffine3, bool),
        is_other: bool,
        prepare: impl FnOnce() -> Option<Option<PartMesh>>,
    ) {
        let frame = self.frame;
        let mut is_known = false;
        if let Some(caster) = self.casters.get_mut(&entity) {
            // Its shadow stays until another mesh is loaded.
            caster.frame = frame;
            is_known = true;
            if caster.key == *key && !is_other {
                let place = has_moved.then_some(Change::Place(entity, map));
                self.changes.extend(place);
                return;
            }
            self.has_unused |= caster.key != *key;
        }
        let prepared = self.meshes.get(key);
        // A skinned mesh is another one with each move of a joint.
        let prepared = prepared.filter(|mesh| mesh.is_none() || !key.is_skinned);
        let Some(prepared) = prepared.cloned().or_else(prepare) else {
            return; // an asset is not loaded yet
        };
        if !key.is_skinned || prepared.is_none() {
            self.meshes.insert(key.clone(), prepared.clone());
        }
        let change = match prepared {
            Some(mesh) => Some(Change::Mesh(entity, mesh, map)),
            None => is_known.then_some(Change::Gone(entity)),
        };
        self.changes.extend(change);
        let key = key.clone();
        self.casters.insert(entity, Caster { key, frame });
    }

    /// Drops casters that cast no shadow in this frame, and meshes that no caster has any more.
    fn drop_unseen(&mut self) {
        let frame = self.frame;
        let unseen = self.casters.extract_if(|_, caster| caster.frame != frame);
        let before = self.changes.len();
        let gone = unseen.map(|(entity, _)| Change::Gone(entity));
        self.changes.extend(gone);
        self.has_unused |= self.changes.len() > before;
        if std::mem::take(&mut self.has_unused) {
            let used: HashSet<&Key> = self.casters.values().map(|caster| &caster.key).collect();
            self.meshes.retain(|key, _| used.contains(key));
        }
    }
}

fn edited<A: Asset>(mut messages: MessageReader<AssetEvent<A>>) -> HashSet<AssetId<A>> {
    let edited = messages.read().filter_map(|message| match message {
        AssetEvent::Added { id } | AssetEvent::Modified { id } => Some(*id),
        _ => None,
    });
    edited.collect()
}

/// Hands the changes to the render world.
pub fn extract(mut world: ResMut<MainWorld>, mut views: ResMut<Views>) {
    let mut casters = world.resource_mut::<Casters>();
    if !casters.changes.is_empty() {
        views.follow(std::mem::take(&mut casters.changes));
    }
}

fn affine(place: &GlobalTransform) -> DAffine3 {
    let columns = place.affine().to_cols_array();
    DAffine3::from_cols_array(&columns.map(f64::from))
}

/// Returns the holes of a material, or `None` if no part of it casts a shadow.
fn holes(material: Option<&StandardMaterial>) -> Option<Option<Holes>> {
    let Some(material) = material else {
        return Some(None);
    };
    let least = match material.alpha_mode {
        AlphaMode::Opaque => return Some(None),
        AlphaMode::Mask(cutoff) => cutoff,
        _ => FAINTEST,
    };
    let alpha = material.base_color.alpha();
    let Some(image) = &material.base_color_texture else {
        return (alpha >= least).then_some(None);
    };
    Some(Some(Holes {
        image: image.id(),
        least: (least / alpha).to_bits(),
        map: material.uv_transform.to_cols_array().map(f32::to_bits),
    }))
}

/// Prepares a mesh. `None` if it is not loaded yet; `Some(None)`, which the log tells, if it cannot
/// be prepared.
fn prepare(
    key: &Key,
    (meshes, images): &Stores,
    joints: Option<&[Mat4]>,
) -> Option<Option<PartMesh>> {
    let mesh = meshes.get(key.mesh)?;
    let holes = match &key.holes {
        Some(holes) => Some((holes, images.get(holes.image)?)),
        None => None,
    };
    let solid = solid(mesh, holes, joints).and_then(|solid| Ok(PartMesh::new(&solid)?));
    let warn = |error| warn!("{:?} casts no shadow: {error}", key.mesh);
    Some(solid.map_err(warn).ok())
}

fn solid(mesh: &Mesh, holes: Option<(&Holes, &Image)>, joints: Option<&[Mat4]>) -> Result<Solid> {
    if !mesh.asset_usage.contains(RenderAssetUsages::MAIN_WORLD) {
        return Err("it is in the render world only (RenderAssetUsages)".into());
    }
    let positions = match mesh.try_attribute(Mesh::ATTRIBUTE_POSITION)? {
        VertexAttributeValues::Float32x3(positions) => positions,
        _ => return Err("its positions are not Float32x3".into()),
    };
    let positions: Cow<[[f32; 3]]> = match joints {
        Some(joints) => skinned(mesh, positions, joints)?.into(),
        None => positions.into(),
    };
    let count = positions.len() as u32;
    let indices: Vec<u32> = match mesh.try_indices_option()? {
        Some(Indices::U32(indices)) => indices.clone(),
        Some(Indices::U16(indices)) => indices.iter().copied().map(u32::from).collect(),
        None => (0..count).collect(),
    };
    let indices = match mesh.primitive_topology() {
        PrimitiveTopology::TriangleList => indices,
        PrimitiveTopology::TriangleStrip => strip(&indices),
        _ => return Err("it is not of triangles".into()),
    };
    let indexed = Indexed {
        positions: &positions,
        normals: &[],
        indices: &indices,
    };
    let uvs = mesh.try_attribute(Mesh::ATTRIBUTE_UV_0);
    let (Some((holes, image)), Ok(VertexAttributeValues::Float32x2(uvs))) = (holes, uvs) else {
        return Ok(indexed.mesh()?);
    };
    let map = Affine2::from_cols_array(&holes.map.map(f32::from_bits));
    let mapped = |uv: &[f32; 2]| map.transform_point2(Vec2::from(*uv)).to_array();
    let uvs: Vec<[f32; 2]> = uvs.iter().map(mapped).collect();
    let mask = match mask(holes, image) {
        Ok(mask) => mask,
        Err(error) => {
            warn!(
                "a masked mesh casts the shadow of a solid one: its mask cannot be read: {error}"
            );
            return Ok(indexed.mesh()?);
        }
    };
    let material = Material {
        mask: Some(Arc::new(mask)),
        ..Material::default()
    };
    Ok(indexed.mesh_of(material, &uvs)?)
}

/// Every other triangle of a strip is wound the other way.
fn strip(indices: &[u32]) -> Vec<u32> {
    let triangle = |(at, corners): (usize, &[u32])| match at % 2 {
        0 => [corners[0], corners[1], corners[2]],
        _ => [corners[1], corners[0], corners[2]],
    };
    indices.windows(3).enumerate().flat_map(triangle).collect()
}

fn mask(holes: &Holes, image: &Image) -> Result<Mask> {
    image.get_color_at(0, 0)?;
    let least = f32::from_bits(holes.least);
    let is_there = |x, y| {
        let color = image.get_color_at(x, y);
        color.is_ok_and(|color| color.alpha() >= least)
    };
    let wrap = match &image.sampler {
        ImageSampler::Descriptor(it) => [it.address_mode_u, it.address_mode_v].map(wrap),
        ImageSampler::Default => [Wrap::Clamp; 2],
    };
    Ok(Mask::new([image.width(), image.height()], wrap, is_there))
}

fn wrap(mode: ImageAddressMode) -> Wrap {
    match mode {
        ImageAddressMode::Repeat => Wrap::Repeat,
        ImageAddressMode::MirrorRepeat => Wrap::Mirror,
        _ => Wrap::Clamp,
    }
}
