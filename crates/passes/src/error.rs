//! Why a scene cannot be brought to the GPU.

/// Error of bringing a scene to the GPU. While a graph is executed, its text is that of the graph's
/// provider error.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The provider has no resource with the requested name.
    #[error("the scene provides no `{name}`; it has {}", known.join(", "))]
    Unknown {
        /// Name that was requested.
        name: String,
        /// Names of the resources that the provider has.
        known: Vec<String>,
    },
    /// The mesh has more triangles than an acceleration structure of the device holds.
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
    /// The mesh has more triangles than the hierarchy in light space holds.
    #[error(
        "`scene.light_space_nodes` cannot hold {triangles} triangles on this device: trace with \
         `engine: Hierarchy`"
    )]
    LightSpace {
        /// Number of triangles of the mesh.
        triangles: usize,
    },
    /// The hierarchy in light space needs a directional light, but the light has this kind.
    #[error(
        "`scene.light_space_nodes` is made for a directional light, not for a {0} light: trace \
         with `engine: Hierarchy`"
    )]
    LightSpaceKind(&'static str),
    /// A texture of the mesh cannot be read.
    #[error("texture {0}")]
    Texture(
        /// Name of the texture, and the reason.
        String,
    ),
    /// A triangle has a corner beyond the mesh's positions.
    #[error("a triangle of the mesh has the corner {index}, but it has only {corners} positions")]
    Corner {
        /// Index of the corner.
        index: u32,
        /// Number of positions of the mesh.
        corners: usize,
    },
    /// The light cannot be used.
    #[error("{0}")]
    Light(
        /// Reason why the light cannot be used.
        String,
    ),
    /// The camera has numbers that are infinite or NaN.
    #[error("the camera has numbers that are infinite or none: {0:?}")]
    Camera(
        /// Camera in the layout that shaders read.
        crate::uniforms::CameraUniform,
    ),
    /// A deformed mesh has another number of positions or normals than the mesh.
    #[error(
        "a deformed mesh has {} positions and {} normals, as before; given were {} and {}: for \
         another mesh there is `set_mesh`",
        expected[0], expected[1], given[0], given[1]
    )]
    Deformed {
        /// Numbers of positions and normals of the mesh.
        expected: [usize; 2],
        /// Numbers of positions and normals that were given.
        given: [usize; 2],
    },
    /// A position or normal of a deformed mesh is infinite or NaN.
    #[error("{what} {index} of a deformed mesh is {value}, which is not finite")]
    NotFinite {
        /// `position` or `normal`.
        what: &'static str,
        /// Index of the position or normal, from 0.
        index: usize,
        /// Position or normal that was given.
        value: glam::Vec3,
    },
    /// Transforms were set for a mesh without parts.
    #[error(
        "the provider's mesh has no parts to be moved: make it with `SceneProvider::from_parts`, \
         or give it parts with `set_parts`"
    )]
    NoParts,
    /// A part cannot be moved by its map.
    #[error(transparent)]
    Move(#[from] skiagraph_scene::MoveError),
    /// A resource needs a larger buffer than the device can bind.
    #[error("`{name}` needs a buffer of {bytes} bytes, but the device binds at most {limit}")]
    TooLarge {
        /// Name of the resource.
        name: String,
        /// Number of bytes that the resource needs.
        bytes: u64,
        /// Number of bytes that the device binds at most: the smaller of its buffer size and
        /// binding size limits.
        limit: u64,
    },
}
