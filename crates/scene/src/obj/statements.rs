//! Reads the statements of an OBJ file: what its faces name, and where each of them stands.
//!
//! A face may name vertices below it, so that the file is read twice: first all of its vertices,
//! then its faces. Statements may be continued on the next line by `\`.

use super::options::{ObjMaterials, ObjOptions};
use crate::{
    error::{FACES_SHOWN, FaceFault, FaceProblem, FaceRef, SceneError, beginning},
    text::{line_text, next_line, without_comment},
};
use glam::{Vec2, Vec3};
use std::{borrow::Cow, collections::HashSet, ops::Range, path::Path};

/// A face, and where it stands.
pub(super) struct Face {
    /// Index into [`Statements::groups`].
    pub group: u32,
    /// Number within its group, from 1.
    pub number: u32,
    /// Line in the file, from 1.
    pub line: u32,
    /// Index into [`Statements::materials`].
    pub material: u32,
    /// Its corners in [`Statements::corners`].
    pub corners: Range<usize>,
}

/// The values that a corner of a face names.
#[derive(Clone, Copy)]
pub(super) struct FaceCorner {
    pub position: Vec3,
    /// Its normal, if every corner of the face names one that is there.
    pub normal: Option<Vec3>,
    /// Its texture coordinates, v down, if every corner of the face names some that are there.
    pub uv: Option<Vec2>,
}

/// The content of a file.
#[derive(Default)]
pub(super) struct Statements<'a> {
    leave_out: HashSet<&'a str>,
    /// Line last read, from 1.
    line: u32,
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    uvs: Vec<Vec2>,
    /// Names of the runs of faces, in file order, those left out included.
    pub groups: Vec<String>,
    /// Names of the materials in use, in the order of their first use; the first is none.
    pub materials: Vec<String>,
    /// The files of materials that the file names.
    pub libraries: Vec<String>,
    /// Corners of the faces, in order.
    pub corners: Vec<FaceCorner>,
    /// Faces with three corners at least, in order.
    pub faces: Vec<Face>,
    pub faults: Faults,
    /// Points met.
    pub points: usize,
    /// Lines met.
    pub lines: usize,
    /// Curves and surfaces met.
    pub curved: usize,
    /// Normals that are no three numbers; they have no direction.
    pub normals_unread: usize,
    /// Faces that name normals which are not there.
    pub normals_absent: usize,
    /// Faces that name texture coordinates which are not there, by their place in `faces`.
    pub uvs_absent: Vec<(usize, FaceProblem)>,
    /// True if materials and texture coordinates are of interest.
    with_materials: bool,
    /// True if masks are made for materials that may stand in no file.
    makes_masks: bool,
    material: u32,
    group_left_out: bool,
    number: u32,
    /// Those above the face.
    above: Counts,
}

/// Faces that cannot be used: the first of them, and how many there are.
#[derive(Default)]
pub(super) struct Faults {
    first: Vec<FaceFault>,
    total: usize,
}

impl Faults {
    pub fn add(&mut self, face: impl FnOnce() -> FaceRef, problem: FaceProblem) {
        self.total += 1;
        if self.first.len() < FACES_SHOWN {
            let face = face();
            self.first.push(FaceFault { face, problem });
        }
    }

    /// Refuses the file if there are any.
    ///
    /// # Errors
    /// [`SceneError::ObjFaces`].
    pub fn refuse(self, path: &Path) -> Result<(), SceneError> {
        match self.total {
            0 => Ok(()),
            total => Err(SceneError::ObjFaces {
                path: path.to_owned(),
                faults: self.first,
                total,
            }),
        }
    }
}

/// Numbers of vertices, normals and texture coordinates.
#[derive(Clone, Copy, Default)]
struct Counts {
    vertices: usize,
    normals: usize,
    uvs: usize,
}

/// A corner: numbers from 1 of what it names, or why what it names is not there. Only its vertex
/// must be.
struct Named {
    vertex: usize,
    normal: Option<Result<usize, ()>>,
    uv: Option<Result<usize, FaceProblem>>,
}

/// Name of the faces that stand before the first `g` or `o`.
const UNNAMED: &str = "unnamed";

impl<'a> Statements<'a> {
    /// Reads a file.
    ///
    /// # Errors
    /// [`SceneError::ObjLine`] for a vertex that cannot be read, or a face that is cut off.
    pub fn read(bytes: &[u8], options: &'a ObjOptions, path: &Path) -> Result<Self, SceneError> {
        let leave_out: HashSet<&str> = options.leave_out.iter().map(String::as_str).collect();
        let mut statements = Self {
            groups: vec![UNNAMED.to_owned()],
            materials: vec![String::new()],
            with_materials: options.materials != ObjMaterials::Ignore,
            makes_masks: matches!(options.materials, ObjMaterials::Made(_)),
            group_left_out: leave_out.contains(UNNAMED),
            leave_out,
            ..Self::default()
        };
        let turns: [fn(&mut Self, &str, bool) -> Result<(), String>; 2] =
            [Self::take_vertex, Self::take];
        for take in turns {
            let mut rest = bytes;
            statements.line = 0;
            while let Some((statement, ended)) = statements.next_statement(&mut rest) {
                let taken = take(&mut statements, statement.trim(), ended);
                taken.map_err(|reason| SceneError::ObjLine {
                    path: path.to_owned(),
                    line: statements.line,
                    reason,
                })?;
            }
        }
        Ok(statements)
    }

    /// True if the file has no vertex.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    pub fn face_ref(&self, face: &Face) -> FaceRef {
        FaceRef {
            group: self.groups[face.group as usize].clone(),
            number: face.number,
            line: face.line,
        }
    }

    /// Takes the next physical line off the file, without its line end; the flag says whether it
    /// had one.
    fn next_line<'b>(&mut self, rest: &mut &'b [u8]) -> Option<(Cow<'b, str>, bool)> {
        let (line, ended) = next_line(rest)?;
        self.line = self.line.saturating_add(1);
        Some((line_text(line.trim_ascii()), ended))
    }

    /// Takes the next statement, which may be continued on more lines.
    fn next_statement<'b>(&mut self, rest: &mut &'b [u8]) -> Option<(Cow<'b, str>, bool)> {
        let (mut line, mut ended) = self.next_line(rest)?;
        // A name or a comment may end in a backslash (a Windows folder); only numbers are
        // continued.
        if !line.starts_with(['v', 'f', 'l', 'p']) || !line.ends_with('\\') {
            return Some((line, ended));
        }
        let mut joined = String::new();
        while let Some(start) = line.strip_suffix('\\') {
            joined.push_str(start);
            joined.push(' ');
            let Some((next, next_ended)) = self.next_line(rest) else {
                return Some((joined.into(), ended));
            };
            (line, ended) = (next, next_ended);
        }
        joined.push_str(&line);
        Some((joined.into(), ended))
    }

    /// Takes what faces name.
    fn take_vertex(&mut self, line: &str, _ended: bool) -> Result<(), String> {
        let (keyword, rest) = split(line);
        let numbers = without_comment(rest);
        match keyword {
            "v" => self.positions.push(position(numbers)?),
            "vn" => {
                let words = numbers.split_whitespace().take(3);
                let read: Vec<f32> = words.filter_map(|word| word.parse().ok()).collect();
                self.normals_unread += usize::from(read.len() < 3);
                let normal = <[f32; 3]>::try_from(read).unwrap_or_default();
                self.normals.push(normal.into());
            }
            "vt" if self.with_materials => self.take_uv(numbers),
            "mtllib" if self.with_materials && !rest.trim().is_empty() => {
                self.libraries.push(rest.trim().to_owned());
            }
            _ => {}
        }
        Ok(())
    }

    fn take(&mut self, line: &str, ended: bool) -> Result<(), String> {
        let (keyword, rest) = split(line);
        match keyword {
            "v" => self.above.vertices += 1,
            "vn" => self.above.normals += 1,
            "vt" => self.above.uvs += 1,
            "usemtl" if self.with_materials => {
                let name = rest.trim();
                let index = self.materials.iter().position(|other| other == name);
                self.material = index.unwrap_or(self.materials.len()) as u32;
                if index.is_none() {
                    self.materials.push(name.to_owned());
                }
            }
            "f" => self.take_face(without_comment(rest), ended)?,
            "g" | "o" => {
                let name = Some(rest.trim()).filter(|name| !name.is_empty());
                let name = name.unwrap_or(UNNAMED);
                self.group_left_out = self.leave_out.contains(name);
                self.groups.push(name.to_owned());
                self.number = 0;
            }
            "p" => self.points += 1,
            "l" => self.lines += 1,
            "curv" | "curv2" | "surf" => self.curved += 1,
            // Smoothing groups, comments: nothing that we draw.
            _ => {}
        }
        Ok(())
    }

    /// A number that cannot be read counts as 0, as one that is missing does.
    fn take_uv(&mut self, numbers: &str) {
        let mut numbers = numbers.split_whitespace();
        let mut next = || numbers.next().and_then(|word| word.parse::<f32>().ok());
        let (u, v) = (next().unwrap_or(0.0), next().unwrap_or(0.0));
        // The first row of a texture's texels is the upper one, where v is 1.
        self.uvs.push(Vec2::new(u, 1.0 - v));
    }

    fn take_face(&mut self, corners: &str, ended: bool) -> Result<(), String> {
        self.number += 1;
        if self.group_left_out {
            return Ok(());
        }
        let mut parsed = Vec::with_capacity(4);
        let (mut normals_absent, mut uvs_absent) = (false, None);
        for corner in corners.split_whitespace() {
            match self.corner(corner) {
                Ok(corner) => {
                    normals_absent |= corner.normal.is_some_and(|normal| normal.is_err());
                    if let Some(Err(problem)) = &corner.uv {
                        uvs_absent.get_or_insert_with(|| problem.clone());
                    }
                    parsed.push(corner);
                }
                Err(problem) => {
                    self.fault(problem);
                    return Ok(());
                }
            }
        }
        match parsed.len() {
            0..=2 if !ended => return Err("the file ends in the middle of a face".to_owned()),
            0 => return Err("a face without corners".to_owned()),
            1 => self.points += 1,
            2 => self.lines += 1,
            _ => {
                self.normals_absent += usize::from(normals_absent);
                if let Some(problem) = uvs_absent {
                    self.uvs_absent.push((self.faces.len(), problem));
                }
                self.add_face(&parsed);
            }
        }
        Ok(())
    }

    fn add_face(&mut self, corners: &[Named]) {
        let normals = corners.iter().map(|corner| corner.normal?.ok());
        let normals: Option<Vec<usize>> = normals.collect();
        let uvs = corners
            .iter()
            .map(|corner| corner.uv.as_ref()?.as_ref().ok());
        let uvs: Option<Vec<&usize>> = uvs.collect();
        let first = self.corners.len();
        let corners = corners.iter().enumerate().map(|(at, corner)| FaceCorner {
            position: self.positions[corner.vertex - 1],
            normal: normals
                .as_ref()
                .map(|normals| self.normals[normals[at] - 1]),
            uv: uvs.as_ref().map(|uvs| self.uvs[*uvs[at] - 1]),
        });
        self.corners.extend(corners);
        self.faces.push(Face {
            group: (self.groups.len() - 1) as u32,
            number: self.number,
            line: self.line,
            material: self.material,
            corners: first..self.corners.len(),
        });
    }

    /// A corner whose vertex is known to exist.
    fn corner<'t>(&self, text: &'t str) -> Result<Named, FaceProblem> {
        let mut words = text.split('/');
        let (vertex, uv, normal) = (words.next().unwrap_or(""), words.next(), words.next());
        let not_a_corner = || FaceProblem::NotACorner(text.to_owned());
        if words.next().is_some() {
            return Err(not_a_corner());
        }
        let find = |word: &str, above: usize, total: usize| {
            resolve(word, above, total).ok_or_else(not_a_corner)
        };
        let above = &self.above;
        let written = |word: Option<&'t str>| word.filter(|word| !word.is_empty());
        let vertex = find(vertex, above.vertices, self.positions.len())?
            .map_err(|(written, available)| FaceProblem::NoSuchVertex { written, available })?;
        let normal = written(normal).map(|word| find(word, above.normals, self.normals.len()));
        let normal = normal.transpose()?.map(|index| index.map_err(drop));
        // Without a file of materials nothing is looked up by them.
        let uv = written(uv).filter(|_| self.makes_masks || !self.libraries.is_empty());
        let uv = uv
            .map(|word| find(word, above.uvs, self.uvs.len()))
            .transpose()?;
        let absent = |(written, available)| FaceProblem::NoSuchUv { written, available };
        let uv = uv.map(|index| index.map_err(absent));
        Ok(Named { vertex, normal, uv })
    }

    fn fault(&mut self, problem: FaceProblem) {
        let face = FaceRef {
            group: self.groups.last().cloned().unwrap_or_default(),
            number: self.number,
            line: self.line,
        };
        self.faults.add(|| face, problem);
    }
}

/// The place of a vertex: three numbers, or four, of which the last divides the others. Six and
/// more are a place with a colour, which is passed over.
fn position(numbers: &str) -> Result<Vec3, String> {
    let mut words: Vec<&str> = numbers.split_whitespace().collect();
    if words.len() >= 6 {
        words.truncate(3);
    }
    let number = |at: usize| {
        let read = words.get(at).and_then(|word| word.parse::<f32>().ok());
        read.ok_or("position parse error")
    };
    let read = || {
        let place = Vec3::new(number(0)?, number(1)?, number(2)?);
        match words.len() {
            3 => Ok(place),
            4 if number(3)? == 0.0 => Err("scaling (w) by zero"),
            4 => Ok(place / number(3)?),
            _ => Err("color parse error (too many or too few components)"),
        }
    };
    read().map_err(|why| {
        let line = format!("v {}", words.join(" "));
        format!("{why} in {:?}", beginning(line.trim_end()))
    })
}

/// A statement's keyword, and what follows.
pub(super) fn split(line: &str) -> (&str, &str) {
    line.split_once(char::is_whitespace).unwrap_or((line, ""))
}

/// The number, from 1, of what a corner names, or the text of one that names nothing and how many
/// there are. `None` where it is no number. A positive one counts from the beginning of the file,
/// to its end; a negative one back from the line. One that overflows names nothing either.
fn resolve(written: &str, above: usize, total: usize) -> Option<Result<usize, (String, usize)>> {
    let digits = written.strip_prefix(['-', '+']).unwrap_or(written);
    if digits.is_empty() || !digits.bytes().all(|byte| byte.is_ascii_digit()) {
        return None;
    }
    let counts_back = written.starts_with('-');
    let most = if counts_back { above } else { total };
    let index = match digits.parse::<usize>() {
        Ok(back) if counts_back => (most + 1).checked_sub(back).filter(|_| back > 0),
        Ok(index) => Some(index),
        Err(_) => None,
    };
    let valid = index.filter(|index| (1..=most).contains(index));
    Some(valid.ok_or_else(|| (written.to_owned(), most)))
}
