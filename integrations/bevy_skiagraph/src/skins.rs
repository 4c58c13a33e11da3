//! Skinned meshes, whose positions in the world are computed here as Bevy's vertex shader computes
//! them.

use bevy::{
    ecs::system::SystemParam,
    mesh::{
        VertexAttributeValues,
        skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    },
    prelude::*,
};

/// All joints of Bevy's world.
#[derive(SystemParam)]
pub struct Joints<'w, 's> {
    places: Query<'w, 's, Ref<'static, GlobalTransform>>,
    bindposes: Res<'w, Assets<SkinnedMeshInverseBindposes>>,
}

impl Joints<'_, '_> {
    /// True if a joint of the skin has moved.
    pub fn have_moved(&self, skin: &SkinnedMesh) -> bool {
        let mut places = skin.joints.iter().map(|joint| self.places.get(*joint));
        places.any(|place| place.is_ok_and(|place| place.is_changed()))
    }

    /// Returns the matrices of a skin's joints; `None` before the skin is loaded.
    pub fn matrices(&self, skin: &SkinnedMesh) -> Option<Vec<Mat4>> {
        let bindposes = self.bindposes.get(&skin.inverse_bindposes)?;
        let joints = skin.joints.iter().zip(bindposes.iter());
        let matrix = |(joint, bindpose): (&Entity, &Mat4)| {
            let place = self.places.get(*joint).ok()?;
            Some(Mat4::from(place.affine()) * *bindpose)
        };
        joints.map(matrix).collect()
    }
}

/// Returns where the joints have brought the positions of a mesh.
pub fn skinned(mesh: &Mesh, positions: &[[f32; 3]], joints: &[Mat4]) -> Result<Vec<[f32; 3]>> {
    let indices = mesh.try_attribute(Mesh::ATTRIBUTE_JOINT_INDEX)?;
    let weights = mesh.try_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT)?;
    let (VertexAttributeValues::Uint16x4(indices), VertexAttributeValues::Float32x4(weights)) =
        (indices, weights)
    else {
        return Err("its joints are not Uint16x4, or its weights not Float32x4".into());
    };
    let corners = positions.iter().zip(indices.iter().zip(weights));
    let moved = |(position, (indices, weights)): (&[f32; 3], (&[u16; 4], &[f32; 4]))| {
        let mut sum = Mat4::ZERO;
        for (index, weight) in indices.iter().zip(weights) {
            let joint = joints.get(usize::from(*index));
            sum += *joint.ok_or("a vertex hangs on a joint that its skin lacks")? * *weight;
        }
        Ok(sum.transform_point3((*position).into()).to_array())
    };
    corners.map(moved).collect()
}
