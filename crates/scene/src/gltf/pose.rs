//! Poses, which move the vertices of a mesh before it is drawn: weights of morph targets, the
//! joints of a skin in the pose of their nodes, and the transforms of instances.

use super::accessor;
use super::beside::Instances;
use super::buffers::Buffers;
use super::nodes::{Nodes, unit};
use glam::{DMat3, DMat4, DQuat, DVec3, Vec3};
use gltf::{Accessor, Document, Primitive, Semantic, Skin};

/// Positions and normals of vertices.
pub(super) struct Vertices {
    pub positions: Vec<DVec3>,
    pub normals: Option<Vec<DVec3>>,
    /// For each vertex, true if the skin turns the winding of its triangles (its blended matrix has
    /// a negative determinant). Empty without a skin: read it with `get`.
    pub turned: Vec<bool>,
}

/// Three numbers for each item.
pub(super) fn vectors(accessor: &Accessor<'_>, buffers: &Buffers) -> Result<Vec<DVec3>, String> {
    let read = accessor::floats::<3>(accessor, buffers)?;
    let wide = |vector| Vec3::from(vector).as_dvec3();
    Ok(read.into_iter().map(wide).collect())
}

impl Vertices {
    /// Moves them by the morph targets of a primitive.
    ///
    /// # Errors
    /// The fault of a target.
    pub fn morph(
        &mut self,
        primitive: &Primitive<'_>,
        weights: &[f32],
        buffers: &Buffers,
    ) -> Result<(), String> {
        let targets = primitive.morph_targets().zip(weights);
        for (target, &weight) in targets.filter(|(_, weight)| **weight != 0.0) {
            let normals = self.normals.as_mut().zip(target.normals());
            let positions = target.positions().map(|morph| (&mut self.positions, morph));
            for (vertices, accessor) in positions.into_iter().chain(normals) {
                let moved = vectors(&accessor, buffers)?;
                if moved.len() < vertices.len() {
                    let (has, needs) = (moved.len(), vertices.len());
                    let why = format!("a morph target of {has} vertices for {needs}");
                    return Err(accessor::named(&accessor, why));
                }
                for (vertex, by) in vertices.iter_mut().zip(moved) {
                    *vertex += f64::from(weight) * by;
                }
            }
        }
        Ok(())
    }

    /// Puts them where the joints of a skin are; false where the primitive names no joints.
    ///
    /// # Errors
    /// A vertex that names a joint which is not there.
    pub fn skin(
        &mut self,
        primitive: &Primitive<'_>,
        joints: &[DMat4],
        buffers: &Buffers,
    ) -> Result<bool, String> {
        let sets: Vec<JointSet> = (0..)
            .map_while(|set| {
                let names = primitive.get(&Semantic::Joints(set))?;
                Some((names, primitive.get(&Semantic::Weights(set))?))
            })
            .map(|(names, weights)| {
                let names = accessor::floats::<4>(&names, buffers)?;
                Ok((names, accessor::floats::<4>(&weights, buffers)?))
            })
            .collect::<Result<_, String>>()?;
        if sets.is_empty() {
            return Ok(false);
        }
        self.turned = Vec::with_capacity(self.positions.len());
        for vertex in 0..self.positions.len() {
            let blend = blend(vertex, &sets, joints)?;
            self.positions[vertex] = blend.transform_point3(self.positions[vertex]);
            let linear = DMat3::from_mat4(blend);
            if let Some(normal) = self.normals.as_mut().and_then(|list| list.get_mut(vertex)) {
                *normal = of_normals(linear) * *normal;
            }
            self.turned.push(linear.determinant() < 0.0);
        }
        Ok(true)
    }
}

/// Numbers of four joints for each vertex, and their weights.
type JointSet = (Vec<[f32; 4]>, Vec<[f32; 4]>);

/// The map of normals that belongs to a linear map; zero if that flattens.
pub(super) fn of_normals(linear: DMat3) -> DMat3 {
    match linear.determinant() {
        0.0 => DMat3::ZERO,
        _ => linear.inverse().transpose(),
    }
}

/// The mean of a vertex's joints by their weights, which are brought to a sum of 1. One without
/// weights hangs on its first joint, as in other programs.
fn blend(vertex: usize, sets: &[JointSet], joints: &[DMat4]) -> Result<DMat4, String> {
    let joint = |named: f32| {
        joints.get(named as usize).copied().ok_or_else(|| {
            format!(
                "vertex {vertex} names joint {named}, but its skin has {}",
                joints.len()
            )
        })
    };
    let (mut sum, mut total) = (DMat4::ZERO, 0.0);
    for (names, weights) in sets {
        let short = || format!("vertex {vertex} has no joints");
        let names = names.get(vertex).ok_or_else(short)?;
        let weights = weights.get(vertex).ok_or_else(short)?;
        let pairs = names.iter().zip(weights);
        for (&named, &weight) in pairs.filter(|(_, weight)| **weight != 0.0) {
            sum += joint(named)? * f64::from(weight);
            total += f64::from(weight);
        }
    }
    match total {
        0.0 => joint(sets[0].0[vertex][0]),
        _ => Ok(sum * (1.0 / total)),
    }
}

/// The joints of a skin: where each stands, from where it was bound.
///
/// # Errors
/// The fault of the skin.
pub(super) fn joints(
    skin: &Skin<'_>,
    nodes: &Nodes<'_>,
    buffers: &Buffers,
) -> Result<Vec<DMat4>, String> {
    let bound = match skin.inverse_bind_matrices() {
        Some(accessor) => accessor::floats::<16>(&accessor, buffers)?
            .iter()
            .map(|columns| DMat4::from_cols_array(&columns.map(f64::from)))
            .collect(),
        None => vec![DMat4::IDENTITY; skin.joints().len()],
    };
    if bound.len() < skin.joints().len() {
        let (has, needs) = (bound.len(), skin.joints().len());
        return Err(format!(
            "skin {}: {has} matrices for {needs} joints",
            skin.index()
        ));
    }
    let placed = skin.joints().zip(bound).map(|(joint, bound)| {
        let world = nodes.worlds.get(&joint.index());
        // One that stands nowhere is one of a circle.
        let world = world.ok_or_else(|| format!("joint {} is its own child", joint.index()))?;
        Ok(*world * bound)
    });
    placed.collect()
}

/// The transforms of a node's instances, and whether one of their rotations is none.
///
/// # Errors
/// Their fault.
pub(super) fn instances(
    accessors: Instances,
    document: &Document,
    buffers: &Buffers,
) -> Result<(Vec<DMat4>, bool), String> {
    let there = |number: usize| {
        let missing = || format!("its instances name accessor {number}, which is not there");
        document.accessors().nth(number).ok_or_else(missing)
    };
    let read = |number: Option<usize>| {
        let read = number.map(|number| vectors(&there(number)?, buffers));
        read.transpose()
    };
    let [translation, rotation, scale] = accessors;
    let (translation, scale) = (read(translation)?, read(scale)?);
    let rotation = rotation.map(|number| accessor::floats::<4>(&there(number)?, buffers));
    let unit = |turn: [f32; 4]| unit(DQuat::from_array(turn.map(f64::from)));
    let turns = |rotations: Vec<[f32; 4]>| rotations.into_iter().map(unit).collect::<Vec<_>>();
    let rotation = rotation.transpose()?.map(turns);
    let is_none = rotation.iter().flatten().any(Option::is_none);
    let counts = [
        translation.as_ref().map(Vec::len),
        rotation.as_ref().map(Vec::len),
        scale.as_ref().map(Vec::len),
    ];
    let mut counts = counts.into_iter().flatten();
    let count = counts.next().unwrap_or(0);
    if counts.any(|other| other != count) {
        return Err("its instances have attributes of different counts".to_owned());
    }
    let at = |item: usize| {
        let turn = rotation.as_ref().and_then(|list| list[item]);
        DMat4::from_scale_rotation_translation(
            scale.as_ref().map_or(DVec3::ONE, |list| list[item]),
            turn.unwrap_or_default(),
            translation.as_ref().map_or(DVec3::ZERO, |list| list[item]),
        )
    };
    Ok(((0..count).map(at).collect(), is_none))
}
