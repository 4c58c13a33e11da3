//! Meshes with parts that are moved independently of each other, by affine maps or by bends.

use crate::mesh::{Group, Mesh, bounds};
use crate::outline::{Border, outer};
use glam::{DAffine3, DMat3, DVec3, Vec3};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::ops::Range;
use std::sync::OnceLock;

/// Mesh with parts that are moved independently of each other. Each part is moved by a map from
/// positions at rest to moved positions.
#[derive(Clone, Debug)]
pub struct Movable {
    /// Mesh at rest, before its parts are moved. Each part has normals of its own: one for each
    /// pair of a position and a normal that meet at a corner. Parts from [`joined`](Self::joined)
    /// overlap here, because each is in a space of its own.
    pub rest: Mesh,
    parts: Vec<Part>,
    is_joined: bool,
}

/// Triangles and positions of one part.
#[derive(Clone, Debug)]
struct Part {
    /// Primitive ids.
    triangles: Vec<u32>,
    /// In ascending order.
    positions: Vec<u32>,
    /// Bounds of these.
    bounds: [Vec3; 2],
    /// Border of the corners at rest; of copies, that of the first is asked for.
    border: OnceLock<Border>,
    /// Normals in ascending order, each with the position at which it stands.
    normals: Vec<(u32, u32)>,
    /// Positions that triangles use, where not all of them do.
    corners: Option<Vec<u32>>,
    /// Number of the first part of the same mesh.
    copy_of: usize,
}

/// Part of a [`Movable`] after it was moved, as [`Movable::moved_part`] returns it, to be written
/// into a mesh by [`Movable::put_at`].
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MovedPart {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    /// True if the part was mirrored, so that its triangles are wound the other way than at rest.
    pub is_mirrored: bool,
}

/// Indices at which the positions, normals and triangles of a [`Movable`] begin in the lists of a
/// larger mesh, for [`Movable::put_at`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PartPlace {
    /// Index of the movable's first position in the positions of the larger mesh.
    pub position: usize,
    /// Index of the movable's first normal in the normals of the larger mesh.
    pub normal: usize,
    /// Index of the movable's first triangle in the triangles of the larger mesh.
    pub triangle: usize,
}

/// Reason why parts of a [`Movable`] cannot be moved. Parts are numbered from 0.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MoveError {
    /// The number of maps that were given is not the number of parts.
    #[error(
        "each part needs one map, in the order of the parts; there are {parts} parts, but {maps} \
         maps"
    )]
    Count {
        /// Number of parts of the [`Movable`].
        parts: usize,
        /// Number of maps that were given.
        maps: usize,
    },
    /// A map has entries that are infinite or NaN.
    #[error("the map of part {part} has entries that are not finite: {map}")]
    NotFinite {
        /// Number of the part, from 0.
        part: usize,
        /// Map of the part: the columns of its matrix and its translation.
        map: DAffine3,
    },
    /// A map cannot be inverted (it flattens the part).
    #[error(
        "the map of part {part} is singular: it flattens the part, which has no normals then; give \
         it a scale other than 0, or move a part that is to vanish to where no light and no camera \
         sees it"
    )]
    Singular {
        /// Number of the part, from 0.
        part: usize,
    },
    /// A map moves a position beyond what f32 holds.
    #[error("the map of part {part} moves {from} to {to}, which f32 cannot hold")]
    OutOfRange {
        /// Number of the part, from 0.
        part: usize,
        /// Position at rest, before the map.
        from: Vec3,
        /// Position to which the map moves it.
        to: DVec3,
    },
    /// A map that need not be affine ([`Movable::bent`]) mirrors one place of a part and not
    /// another.
    #[error(
        "part {part} is bent so far that it is turned inside out at {at} (at rest) and not \
         elsewhere: bend it less"
    )]
    Folded {
        /// Number of the part, from 0.
        part: usize,
        /// Position at rest at which the part is mirrored.
        at: Vec3,
    },
}

impl MoveError {
    /// Returns the error with `part` as the number of its part. [`Count`](Self::Count), which names
    /// no part, is returned unchanged.
    pub fn renumbered(self, part: usize) -> Self {
        match self {
            error @ Self::Count { .. } => error,
            Self::NotFinite { map, .. } => Self::NotFinite { part, map },
            Self::Singular { .. } => Self::Singular { part },
            Self::OutOfRange { from, to, .. } => Self::OutOfRange { part, from, to },
            Self::Folded { at, .. } => Self::Folded { part, at },
        }
    }
}

impl Movable {
    /// Cuts a mesh into parts to be moved. Part number n consists of all groups with the name
    /// `parts[n]`.
    ///
    /// # Errors
    /// Text that names the part: a name that no group has or that is given twice, or a part that
    /// shares positions with triangles outside it, so that moving it would tear the surface.
    pub fn new(mesh: &Mesh, parts: &[&str]) -> Result<Self, String> {
        let mut seen = HashSet::new();
        if let Some(name) = parts.iter().find(|name| !seen.insert(**name)) {
            return Err(format!("the part `{name}` is given twice"));
        }
        let mut rest = mesh.clone();
        let parts = parts.iter().enumerate();
        let parts = parts.map(|(part, name)| Part::cut(&mut rest, name, part));
        let parts = parts.collect::<Result<_, _>>()?;
        Ok(Self {
            rest,
            parts,
            is_joined: false,
        })
    }

    /// Joins meshes into one. Part number n is `meshes[n]`, which is given in a space of its own,
    /// such as the model space of an instance; its map leads from there to world space. Triangles
    /// stand in the order of `meshes`, and within a mesh in its own; without meshes
    /// [`rest`](Self::rest) is empty. If only some of the meshes have materials, the others get a
    /// plain white one.
    pub fn joined(meshes: &[&Mesh]) -> Self {
        let mut rest = Mesh::default();
        let has_materials = meshes.iter().any(|mesh| !mesh.surfaces.of.is_empty());
        let mut first_parts: HashMap<*const Mesh, usize> = HashMap::new();
        let parts = meshes.iter().enumerate().map(|(part, &mesh)| {
            if has_materials {
                rest.surfaces.append(&mesh.surfaces, mesh.triangles.len());
            }
            let copy_of = *first_parts.entry(std::ptr::from_ref(mesh)).or_insert(part);
            Part::append(&mut rest, mesh, copy_of)
        });
        let parts = parts.collect();
        Self {
            rest,
            parts,
            is_joined: true,
        }
    }

    /// Adds a last part of the triangles that are in no part, if there are any. They must share no
    /// positions with parts, as [`new`](Self::new) demands.
    pub fn with_outside(mut self) -> Self {
        let triangles = self.outside();
        if triangles.is_empty() {
            return self;
        }
        let mut normals = BTreeMap::new();
        let mut positions = Vec::new();
        for &id in &triangles {
            let corners = self.rest.triangles[id as usize];
            positions.extend(corners);
            normals.extend(
                self.rest.normal_indices[id as usize]
                    .into_iter()
                    .zip(corners),
            );
        }
        positions.sort_unstable();
        positions.dedup();
        self.parts.push(Part {
            triangles,
            bounds: bounds_of(&self.rest, &positions),
            border: OnceLock::new(),
            positions,
            normals: normals.into_iter().collect(),
            corners: None,
            copy_of: self.parts.len(),
        });
        self
    }

    /// Returns the triangles that are in no part, as primitive ids of [`rest`](Self::rest) in
    /// ascending order.
    pub fn outside(&self) -> Vec<u32> {
        let mut is_inside = vec![false; self.rest.triangles.len()];
        for &triangle in self.parts.iter().flat_map(|part| &part.triangles) {
            is_inside[triangle as usize] = true;
        }
        let triangles = (0..).zip(is_inside).filter(|(_, is_inside)| !is_inside);
        triangles.map(|(triangle, _)| triangle).collect()
    }

    /// Returns the number of parts that can be moved.
    pub fn parts(&self) -> usize {
        self.parts.len()
    }

    /// Returns the triangles of part number `part`, as primitive ids of [`rest`](Self::rest) in
    /// ascending order.
    ///
    /// # Panics
    /// If there is no part of that number.
    pub fn triangles(&self, part: usize) -> &[u32] {
        &self.parts[part].triangles
    }

    /// Returns the positions of part number `part` that its triangles use, as indices into the
    /// positions of [`rest`](Self::rest) in ascending order.
    ///
    /// # Panics
    /// If there is no part of that number.
    pub fn corners(&self, part: usize) -> &[u32] {
        let part = &self.parts[part];
        part.corners.as_deref().unwrap_or(&part.positions)
    }

    /// Returns the low and high corner of the box around part number `part` at rest.
    ///
    /// # Panics
    /// If there is no part of that number.
    pub fn bounds(&self, part: usize) -> [Vec3; 2] {
        self.parts[part].bounds
    }

    /// Returns the places to which a map takes those corners of part number `part` that may be on
    /// the part's box or [`Outline`](crate::Outline) there. After the first time few are looked at.
    ///
    /// # Panics
    /// If there is no part of that number.
    pub fn moved_border(&self, part: usize, map: &DAffine3) -> Vec<Vec3> {
        let corners = self.corners(part);
        let corner = |at: usize| self.rest.positions[corners[at] as usize];
        let border = &self.parts[self.copy_of(part)].border;
        let border = border.get_or_init(|| Border::new(corners.len(), corner));
        let place = |at: usize| map.transform_point3(corner(at).as_dvec3()).as_vec3();
        let moved = border.moved(map);
        moved.unwrap_or_else(|| outer(corners.len(), place))
    }

    /// Returns the smallest ranges of the positions and of the normals of [`rest`](Self::rest) that
    /// hold those of part number `part`; `0..0` if it has none.
    ///
    /// # Panics
    /// If there is no part of that number.
    pub fn ranges(&self, part: usize) -> [Range<usize>; 2] {
        let Part {
            positions, normals, ..
        } = &self.parts[part];
        let of_positions = [positions.first(), positions.last()].map(|at| Some(*at?));
        let of_normals = [normals.first(), normals.last()].map(|pair| Some(pair?.0));
        [of_positions, of_normals].map(|ends| match ends {
            [Some(first), Some(last)] => first as usize..last as usize + 1,
            _ => 0..0,
        })
    }

    /// Returns the number of the first part that was [joined](Self::joined) from the same mesh (the
    /// same reference) as part number `part`; `part` itself if no earlier part was.
    ///
    /// # Panics
    /// If there is no part of that number.
    pub fn copy_of(&self, part: usize) -> usize {
        self.parts[part].copy_of
    }

    /// Returns true if the parts come from [`joined`](Self::joined), each in a space of its own. In
    /// that case [`rest`](Self::rest) can be drawn only after each part was moved by its map.
    pub fn is_joined(&self) -> bool {
        self.is_joined
    }

    /// Returns the mesh with part number n moved by `maps[n]`, from its place at rest. Triangles of
    /// a part that its map mirrors are wound the other way.
    ///
    /// # Errors
    /// [`MoveError::Count`] if there is not one map for each part; other errors for a part that
    /// cannot be moved by its map.
    pub fn moved(&self, maps: &[DAffine3]) -> Result<Mesh, MoveError> {
        self.check_count(maps.len())?;
        self.all(|part| self.moved_part(part, &maps[part]))
    }

    /// Returns the mesh with each part moved by a map that need not be affine. `map` gets the
    /// number of a part and a position on it at rest. It returns the moved position, and the
    /// derivative (Jacobian matrix) of the map at the position at rest.
    ///
    /// # Errors
    /// [`MoveError::Folded`] for a map that mirrors only some of a part; other errors for a map
    /// that cannot move a part.
    pub fn bent(&self, map: impl Fn(usize, DVec3) -> (DVec3, DMat3)) -> Result<Mesh, MoveError> {
        self.all(|part| self.bent_part(part, |place| map(part, place)))
    }

    fn all(&self, make: impl Fn(usize) -> Result<MovedPart, MoveError>) -> Result<Mesh, MoveError> {
        let mut mesh = self.rest.clone();
        for part in 0..self.parts.len() {
            let moved = make(part)?;
            self.put_at(part, &moved, &mut mesh, PartPlace::default());
            if moved.is_mirrored {
                self.turn_at(part, &mut mesh, PartPlace::default());
            }
        }
        Ok(mesh)
    }

    /// Checks that the number of maps is the number of parts.
    ///
    /// # Errors
    /// [`MoveError::Count`] if it is not.
    pub fn check_count(&self, maps: usize) -> Result<(), MoveError> {
        let parts = self.parts.len();
        if maps == parts {
            Ok(())
        } else {
            Err(MoveError::Count { parts, maps })
        }
    }

    /// Returns part number `part`, from 0, moved by an affine map from its place at rest. The mesh
    /// itself stays at rest.
    ///
    /// # Errors
    /// [`MoveError`] for a map that is not finite or is singular, or that moves a corner beyond
    /// what f32 holds.
    ///
    /// # Panics
    /// If there is no part of that number.
    pub fn moved_part(&self, part: usize, map: &DAffine3) -> Result<MovedPart, MoveError> {
        if !map.is_finite() {
            return Err(MoveError::NotFinite { part, map: *map });
        }
        let positions = &self.parts[part].positions;
        let determinant = map.matrix3.determinant();
        let is_singular = determinant == 0.0 || determinant.is_nan();
        if is_singular && !positions.is_empty() {
            return Err(MoveError::Singular { part });
        }
        let place = |&position: &u32| {
            let from = self.rest.positions[position as usize];
            in_range(part, from, map.transform_point3(from.as_dvec3()))
        };
        let positions = positions.iter().map(place).collect::<Result<_, _>>()?;
        let across = map.matrix3.inverse().transpose();
        Ok(MovedPart {
            positions,
            normals: self.normals(part, |_| across)?,
            is_mirrored: determinant < 0.0,
        })
    }

    /// The normals of a part, each moved by the matrix at its position.
    fn normals(&self, part: usize, across: impl Fn(u32) -> DMat3) -> Result<Vec<Vec3>, MoveError> {
        let moved = |&(normal, position): &(u32, u32)| {
            let normal = across(position) * self.rest.normals[normal as usize].as_dvec3();
            let normal = normal.normalize_or_zero().as_vec3();
            let normal = Some(normal).filter(|normal| normal.is_finite());
            normal.ok_or(MoveError::Singular { part })
        };
        self.parts[part].normals.iter().map(moved).collect()
    }

    fn bent_part(
        &self,
        part: usize,
        map: impl Fn(DVec3) -> (DVec3, DMat3),
    ) -> Result<MovedPart, MoveError> {
        let positions = &self.parts[part].positions;
        let at_rest = |position: u32| self.rest.positions[position as usize];
        let mut mirrored_at = None;
        let mut is_upright = false;
        let mut place = |&position: &u32| {
            let from = at_rest(position);
            let (to, derivative) = map(from.as_dvec3());
            match derivative.determinant() {
                sign if sign < 0.0 => mirrored_at = Some(from),
                sign if sign > 0.0 => is_upright = true,
                _ => return Err(MoveError::Singular { part }),
            }
            in_range(part, from, to)
        };
        let positions = positions.iter().map(&mut place);
        let positions = positions.collect::<Result<_, _>>()?;
        if let Some(at) = mirrored_at.filter(|_| is_upright) {
            return Err(MoveError::Folded { part, at });
        }
        let across = |position: u32| {
            let (_, derivative) = map(at_rest(position).as_dvec3());
            derivative.inverse().transpose()
        };
        Ok(MovedPart {
            positions,
            normals: self.normals(part, across)?,
            is_mirrored: mirrored_at.is_some(),
        })
    }

    /// Writes the positions and normals of a moved part into a mesh that contains those of
    /// [`rest`](Self::rest) from the indices of `at` on.
    ///
    /// # Panics
    /// If there is no part of that number, or if `mesh` is too small.
    pub fn put_at(&self, part: usize, moved: &MovedPart, mesh: &mut Mesh, at: PartPlace) {
        let part = &self.parts[part];
        for (&position, place) in part.positions.iter().zip(&moved.positions) {
            mesh.positions[at.position + position as usize] = *place;
        }
        for (&(normal, _), direction) in part.normals.iter().zip(&moved.normals) {
            mesh.normals[at.normal + normal as usize] = *direction;
        }
    }

    /// Winds the triangles of a part the other way, in a mesh that contains those of
    /// [`rest`](Self::rest) from the indices of `at` on: for a map that mirrors the part, where the
    /// one before did not, or the reverse.
    ///
    /// # Panics
    /// If there is no part of that number, or if `mesh` is too small.
    pub fn turn_at(&self, part: usize, mesh: &mut Mesh, at: PartPlace) {
        for &primitive in &self.parts[part].triangles {
            mesh.turn(at.triangle + primitive as usize);
        }
    }

    /// Returns the lowest and highest coordinate of part number `part` at rest along `axis`, as dot
    /// products with `axis`. Returns `[0, 0]` for a part without corners.
    ///
    /// # Panics
    /// If there is no part of that number.
    pub fn span(&self, part: usize, axis: DVec3) -> [f64; 2] {
        let places = self.parts[part].positions.iter();
        let along = places.map(|&p| self.rest.positions[p as usize].as_dvec3().dot(axis));
        let span = along.map(|at| [at; 2]);
        let span = span.reduce(|[low, high], [at, _]| [low.min(at), high.max(at)]);
        span.unwrap_or_default()
    }
}

/// The place that a position is moved to, in f32.
fn in_range(part: usize, from: Vec3, to: DVec3) -> Result<Vec3, MoveError> {
    match to.as_vec3() {
        place if place.is_finite() => Ok(place),
        _ => Err(MoveError::OutOfRange { part, from, to }),
    }
}

impl Part {
    fn append(rest: &mut Mesh, mesh: &Mesh, copy_of: usize) -> Self {
        let [first, first_position] =
            [rest.triangles.len(), rest.positions.len()].map(|n| n as u32);
        rest.positions.extend(&mesh.positions);
        let moved = |triangle: &[u32; 3]| triangle.map(|index| first_position + index);
        rest.triangles.extend(mesh.triangles.iter().map(moved));
        for group in &mesh.groups {
            rest.groups.push(Group {
                name: group.name.clone(),
                triangles: first + group.triangles.start..first + group.triangles.end,
            });
        }
        let mut own = BTreeMap::new();
        for (corners, triangle) in mesh.normal_indices.iter().zip(&mesh.triangles) {
            let own = [0, 1, 2].map(|corner| {
                let (normal, position) = (corners[corner], first_position + triangle[corner]);
                *own.entry((normal, position)).or_insert_with(|| {
                    rest.normals.push(mesh.normals[normal as usize]);
                    rest.normals.len() as u32 - 1
                })
            });
            rest.normal_indices.push(own);
        }
        let mut used: Vec<u32> = mesh.triangles.as_flattened().to_vec();
        used.sort_unstable();
        used.dedup();
        used.iter_mut().for_each(|index| *index += first_position);
        let positions: Vec<u32> = (first_position..rest.positions.len() as u32).collect();
        Self {
            triangles: (first..rest.triangles.len() as u32).collect(),
            bounds: bounds_of(rest, &positions),
            border: OnceLock::new(),
            positions,
            normals: at_positions(&own),
            corners: (used.len() < mesh.positions.len()).then_some(used),
            copy_of,
        }
    }

    fn cut(mesh: &mut Mesh, name: &str, copy_of: usize) -> Result<Self, String> {
        let inside: HashSet<u32> = mesh.part(name)?.into_iter().collect();
        let mut positions: Vec<u32> = Vec::new();
        let mut outside = HashSet::new();
        for (primitive, corners) in (0..).zip(&mesh.triangles) {
            if inside.contains(&primitive) {
                positions.extend(corners)
            } else {
                outside.extend(corners.iter().copied())
            }
        }
        positions.sort_unstable();
        positions.dedup();
        let welded = positions.iter().filter(|it| outside.contains(it)).count();
        if welded > 0 {
            return Err(format!(
                "part {name:?} shares {welded} positions with others, so that it cannot move by \
                 itself"
            ));
        }
        let mut own = BTreeMap::new();
        for (primitive, corners) in (0..).zip(&mut mesh.normal_indices) {
            if !inside.contains(&primitive) {
                continue;
            }
            for (normal, &position) in corners.iter_mut().zip(&mesh.triangles[primitive as usize]) {
                let old = mesh.normals[*normal as usize];
                *normal = *own.entry((*normal, position)).or_insert_with(|| {
                    mesh.normals.push(old);
                    mesh.normals.len() as u32 - 1
                });
            }
        }
        let mut triangles: Vec<u32> = inside.into_iter().collect();
        triangles.sort_unstable();
        Ok(Self {
            triangles,
            bounds: bounds_of(mesh, &positions),
            border: OnceLock::new(),
            positions,
            normals: at_positions(&own),
            corners: None,
            copy_of,
        })
    }
}

/// Bounds of some positions; those of no position are 0.
fn bounds_of(mesh: &Mesh, positions: &[u32]) -> [Vec3; 2] {
    let places = positions.iter().map(|at| mesh.positions[*at as usize]);
    bounds(places).map_or_else(Default::default, |(low, high)| [low, high])
}

/// New normals in ascending order, each with the position at which it stands.
fn at_positions(own: &BTreeMap<(u32, u32), u32>) -> Vec<(u32, u32)> {
    let pair = |(&(_, position), &normal): (&(u32, u32), &u32)| (normal, position);
    let mut pairs: Vec<(u32, u32)> = own.iter().map(pair).collect();
    pairs.sort_unstable();
    pairs
}
