//! Why a scene cannot be brought to the GPU.

#![expect(
    clippy::disallowed_names,
    reason = "a derive binds public fields by name"
)]

use crate::parts::PartId;
use skiagraph_gpu::ProviderError;

/// Reason why a [`SceneProvider`](crate::SceneProvider) refuses a change of its scene, or cannot
/// build a resource. An executor reports a failed build as
/// [`ExecuteError::Provider`](skiagraph_gpu::ExecuteError::Provider) with the text of this error.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The provider has no resource with the requested name.
    #[error("the scene provides no `{name}`; it has {}", known.join(", "))]
    Unknown {
        /// Name that was requested.
        name: String,
        /// Names of the resources that every provider has; `lights`, `light_areas` and their items,
        /// such as `lights[2]`, are not listed.
        known: Vec<String>,
    },
    /// The mesh has more triangles than an acceleration structure of the device holds, so the
    /// resource `scene.tlas` cannot be built.
    #[error(
        "`scene.tlas` needs {triangles} triangles, but the device takes {most} at most: trace with \
         `engine: Hierarchy`"
    )]
    TooManyTriangles {
        /// Number of triangles of the mesh.
        triangles: usize,
        /// Number of triangles that the device takes at most.
        most: u32,
    },
    /// The mesh has more triangles than the bounding-volume hierarchy in light space
    /// ([`LightSpaceNode`](skiagraph_scene::LightSpaceNode)) can hold.
    #[error(
        "`scene.light_space_nodes` cannot hold {triangles} triangles on this device: trace with \
         `engine: Hierarchy`"
    )]
    LightSpace {
        /// Number of triangles of the mesh.
        triangles: usize,
    },
    /// The bounding-volume hierarchy in light space needs a directional light, but the light is of
    /// this kind: `spot` or `point`.
    #[error(
        "`scene.light_space_nodes` is made for a directional light, not for a {0} light: trace \
         with `engine: Hierarchy`"
    )]
    LightSpaceKind(&'static str),
    /// The device refuses to build the acceleration structures, for example because it has no
    /// memory for them. Holds the reason that wgpu gives.
    #[error("`scene.tlas` could not be built: {0}")]
    Structures(String),
    /// Embree could not build its hierarchy; the text is its reason.
    #[error("Embree could not build `scene.embree`: {0}")]
    Embree(String),
    /// A texture of the mesh cannot be read. Holds the name of the texture, and the reason.
    #[error("texture {0}")]
    Texture(String),
    /// A triangle of the mesh refers to a position that the mesh does not have.
    #[error("a triangle of the mesh has the corner {index}, but it has only {corners} positions")]
    Corner {
        /// Index of the position that the triangle refers to.
        index: u32,
        /// Number of positions of the mesh.
        corners: usize,
    },
    /// A triangle of the mesh has no normals, material or texture coordinates, or some that the
    /// mesh does not have.
    #[error("triangle {triangle} of the mesh has no {what}, or some that the mesh does not have")]
    Lacks {
        /// Number of the triangle.
        triangle: usize,
        /// `normals`, `material` or `texture coordinates`.
        what: &'static str,
    },
    /// A light cannot be used, for example because a number is not finite or a sun is too wide.
    /// Holds the reason why the light cannot be used, with its name in the scene.
    #[error("{0}")]
    Light(String),
    /// A light of [`SceneProvider::set_lights`](crate::SceneProvider::set_lights) cannot be used,
    /// for example because a number is not finite.
    #[error("`lights[{number}]`: {why}")]
    LightNumber {
        /// Index of the light in the list.
        number: usize,
        /// Reason why the light cannot be used.
        why: String,
    },
    /// [`SceneProvider::set_lights`](crate::SceneProvider::set_lights) was given an empty list.
    #[error("a scene has at least one light, but `set_lights` was given none")]
    NoLights,
    /// A graph reads a light that the scene no longer has, since
    /// [`SceneProvider::set_lights`](crate::SceneProvider::set_lights) was given fewer.
    #[error("the graph was planned with `{name}`, but {lights} lights are set now: plan it anew")]
    LightGone {
        /// Name of the light in documents, such as `lights[3]`.
        name: String,
        /// Number of lights that are set.
        lights: usize,
    },
    /// The camera has numbers that are infinite or NaN. Holds the camera that was set, in the
    /// layout that shaders read.
    #[error("the camera has numbers that are infinite or none: {0:?}")]
    Camera(crate::uniforms::CameraUniform),
    /// [`SceneProvider::deform`](crate::SceneProvider::deform) was given another number of
    /// positions or normals than the mesh has.
    #[error(
        "a deformed mesh has {} positions and {} normals, as before; given were {} and {}: for \
         another mesh there is `set_mesh`",
        expected[0], expected[1], given[0], given[1]
    )]
    Deformed {
        /// Number of positions and number of normals of the mesh.
        expected: [usize; 2],
        /// Number of positions and number of normals that were given.
        given: [usize; 2],
    },
    /// A position or normal of a mesh that was deformed or prepared is infinite or NaN.
    #[error("{what} {index} of the mesh is {value}, which is not finite")]
    NotFinite {
        /// List that holds the value: `position` or `normal`.
        what: &'static str,
        /// Index of the value in the given list of positions or normals.
        index: usize,
        /// Position or normal that was given.
        value: glam::Vec3,
    },
    /// The call needs a mesh in parts, but the mesh of the provider was not given in parts
    /// ([`SceneProvider::set_parts`](crate::SceneProvider::set_parts),
    /// [`from_parts`](crate::SceneProvider::from_parts)).
    #[error(
        "the provider's mesh has no parts to be moved: make it with `SceneProvider::from_parts`, \
         or give it parts with `set_parts`"
    )]
    NoParts,
    /// The mesh has no part with the given handle: the part was removed, or belongs to another
    /// mesh. Holds the handle that was given.
    #[error(
        "the mesh has no part {0:?}: it was removed, or is of a mesh that was replaced; \
         `SceneProvider::parts` lists those that there are"
    )]
    NoPart(PartId),
    /// [`rewrite_part`](crate::SceneProvider::rewrite_part) was called for a part whose vertices
    /// are in no buffer of the host. Holds the handle of the part.
    #[error(
        "the vertices of part {0:?} are in no buffer of the host: only parts of `add_host_part` \
         are rewritten"
    )]
    NoHostPart(PartId),
    /// The bounds of a part hold nothing: they are not finite, or a coordinate of the low corner is
    /// greater than that of the high corner.
    #[error(
        "the bounds of part {part:?} hold nothing: {low} to {high}; give the low corner, then the \
         high one, both finite"
    )]
    Bounds {
        /// Handle of the part.
        part: PartId,
        /// Low corner that was stated.
        low: glam::Vec3,
        /// High corner that was stated.
        high: glam::Vec3,
    },
    /// Something needs all positions on the CPU, but those of a part are in a buffer of the host.
    #[error(
        "`{0}` needs all positions on the CPU, but those of part {1:?} are in a buffer of the \
         host: trace with `engine: Hierarchy`, or add the part by `add_part`"
    )]
    OnDevice(
        /// Name of what needs the positions: `deform`, or a resource such as
        /// `scene.light_space_nodes`.
        &'static str,
        /// Handle of the part.
        PartId,
    ),
    /// The vertices of parts in buffers of the host cannot be read, for example because a buffer
    /// was destroyed, or is on another device than the provider's resources.
    #[error(
        "the vertices of {parts:?} cannot be read: {why}; hand over others by \
         `HostMesh::with_vertices` and `SceneProvider::set_host_mesh`, or remove these parts"
    )]
    HostVertices {
        /// Handles of the parts.
        parts: Vec<PartId>,
        /// Reason, that of wgpu if the device refuses them.
        why: String,
    },
    /// The provider's resources are on another device than the one that is asked of, or a host's
    /// mesh on another one than these. Holds the thing that is of another device: `the provider` or
    /// `the host's mesh`.
    #[error(
        "{0} is of another device, or this one is lost: move the provider by \
         `SceneProvider::move_to`, and make hosts' meshes on its device"
    )]
    OtherDevice(&'static str),
    /// The device could not read back the result of
    /// [`SceneProvider::check_bounds`](crate::SceneProvider::check_bounds).
    #[error(transparent)]
    Read(#[from] crate::host::GpuMeshError),
    /// A vertex lies beyond the bounds of its part, as
    /// [`SceneProvider::check_bounds`](crate::SceneProvider::check_bounds) has found.
    #[error(
        "vertex {vertex} of part {part:?} lies beyond its stated bounds {} to {}: state larger \
         ones by `rewrite_part` or `HostMesh::with_bounds`",
        bounds[0], bounds[1]
    )]
    Beyond {
        /// Handle of the part.
        part: PartId,
        /// Index of the vertex, counted from the first one of the part's
        /// [`HostVertices`](crate::HostVertices).
        vertex: u32,
        /// Low and high corner of the bounds that were stated, in the space of the vertices.
        bounds: [glam::Vec3; 2],
    },
    /// A part of the mesh cannot be moved by the affine transform that was set for it, or the
    /// number of transforms is not the number of parts.
    #[error(transparent)]
    Move(#[from] skiagraph_scene::MoveError),
    /// The device has refused to copy the unchanged items of resources into their new buffers, for
    /// example because it has no memory for these.
    #[error("{} could not be copied: {why}", names.join(", "))]
    Copies {
        /// Names of the resources.
        names: Vec<String>,
        /// Reason that wgpu gives.
        why: String,
    },
    /// A resource needs a larger buffer than the device can bind.
    #[error(
        "`{name}` needs a buffer of {bytes} bytes, but the device binds at most {limit}: the \
         smaller of its limits `max_buffer_size` and `max_storage_buffer_binding_size`"
    )]
    TooLarge {
        /// Name of the resource, such as `scene.positions`.
        name: String,
        /// Number of bytes that the resource needs.
        bytes: u64,
        /// Number of bytes that the device binds at most: the smaller of its limits
        /// `max_buffer_size` and `max_storage_buffer_binding_size`.
        limit: u64,
    },
}

impl From<Error> for ProviderError {
    fn from(error: Error) -> Self {
        Self::from_error(error)
    }
}
