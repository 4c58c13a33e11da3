//! Why a scene cannot be brought to the GPU.

/// Errors of this crate. They reach the caller as the message of a graph's provider error.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The provider has nothing of that name.
    #[error("the scene provides no `{name}`; it has {}", known.join(", "))]
    Unknown {
        /// Requested name.
        name: String,
        /// Known names.
        known: Vec<String>,
    },
    /// The device's acceleration structures hold fewer triangles.
    #[error(
        "`scene.tlas` needs {triangles} triangles, but the device takes {most} at most: trace with \
         `engine: Hierarchy`"
    )]
    TooManyTriangles {
        /// Triangles of the mesh.
        triangles: usize,
        /// The device's limit.
        most: u32,
    },
    /// The hierarchy in light space holds fewer triangles.
    #[error(
        "`scene.light_space_nodes` cannot hold {triangles} triangles on this device: trace with \
         `engine: Hierarchy`"
    )]
    LightSpace {
        /// Triangles of the mesh.
        triangles: usize,
    },
    /// The hierarchy in light space is that of one direction.
    #[error(
        "`scene.light_space_nodes` is made for a directional light, not for a {0} light: trace \
         with `engine: Hierarchy`"
    )]
    LightSpaceKind(&'static str),
    /// A texture of the mesh that cannot be read.
    #[error("texture {0}")]
    Texture(
        /// Which one, and why.
        String,
    ),
    /// A triangle without its corner.
    #[error("a triangle of the mesh has the corner {index}, but it has only {corners} positions")]
    Corner {
        /// The index.
        index: u32,
        /// Number of positions.
        corners: usize,
    },
    /// A light that shines nowhere.
    #[error("{0}")]
    Light(
        /// Reason.
        String,
    ),
    /// A camera that sees nothing.
    #[error("the camera has numbers that are infinite or none: {0:?}")]
    Camera(
        /// As shaders would have it.
        crate::uniforms::CameraUniform,
    ),
    /// Not as many places or normals as the mesh has.
    #[error(
        "a deformed mesh has {} positions and {} normals, as before; given were {} and {}: for \
         another mesh there is `set_mesh`",
        expected[0], expected[1], given[0], given[1]
    )]
    Deformed {
        /// Positions and normals of the mesh.
        expected: [usize; 2],
        /// Those that were given.
        given: [usize; 2],
    },
    /// A place or normal that is infinite or no number.
    #[error("{what} {index} of a deformed mesh is {value}, which is not finite")]
    NotFinite {
        /// `position` or `normal`.
        what: &'static str,
        /// Which one, counted from 0.
        index: usize,
        /// The number that was given.
        value: glam::Vec3,
    },
    /// Transforms for a mesh in one piece.
    #[error(
        "the provider's mesh has no parts to be moved: make it with `SceneProvider::from_parts`, \
         or give it parts with `set_parts`"
    )]
    NoParts,
    /// A part that cannot be moved so.
    #[error(transparent)]
    Move(#[from] skiagraph_scene::MoveError),
    /// The device cannot bind a buffer of that size.
    #[error("`{name}` needs a buffer of {bytes} bytes, but the device binds at most {limit}")]
    TooLarge {
        /// The resource.
        name: String,
        /// Its size.
        bytes: u64,
        /// The smaller of the device's buffer size and binding size limits.
        limit: u64,
    },
}
