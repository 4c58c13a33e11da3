//! Stands between an OBJ file and `tobj`: hands it one clean line at a time and remembers where
//! each face stood.
//!
//! `tobj` reports no line and no face, fails as a whole on an index out of range (and overflows on
//! a huge one), takes an `l` record of three points for a triangle, reuses the normal of the corner
//! before where one is missing, wants vertices above the faces that name them, and does not join
//! lines continued by `\`. All of that is settled here, line by line, before it sees them: the file
//! is read twice, first all of its vertices, then its faces.

use super::options::ObjMaterials;
use crate::{
    error::{FACES_SHOWN, FaceFault, FaceProblem, FaceRef, SceneError, beginning},
    text::{line_text, next_line, without_comment},
};
use glam::Vec2;
use std::{
    borrow::Cow,
    collections::HashSet,
    io::{self, BufRead, Read},
    path::Path,
};

/// Where a face that was handed on stood, and whether the file gives it normals.
pub(super) struct FaceRecord {
    /// Index into [`Guard::groups`].
    pub group: u32,
    /// Number within its group, from 1.
    pub number: u32,
    /// Line in the file, from 1.
    pub line: u32,
    /// True if every corner names a normal.
    pub has_normals: bool,
    /// Index into [`Guard::materials`].
    pub material: u32,
    /// The first of its corners in [`Guard::corner_uvs`], if each names texture coordinates.
    pub uvs: Option<usize>,
}

/// The reader that `tobj` reads from.
#[derive(Default)]
pub(super) struct Guard<'a> {
    whole: &'a [u8],
    rest: &'a [u8],
    turn: Turn,
    leave_out: HashSet<&'a str>,
    handed_on: Vec<u8>,
    consumed: usize,
    /// Line last handed on: where `tobj` stands when it fails.
    pub line: u32,
    /// Set before an I/O error is returned to `tobj`: the true reason.
    pub fatal: Option<String>,
    /// Names of the runs of faces, in file order, those left out included.
    pub groups: Vec<String>,
    /// Names of the materials in use, in the order of their first use; the first is none.
    pub materials: Vec<String>,
    /// The files of materials that the file names.
    pub libraries: Vec<String>,
    /// Texture coordinates of the corners of faces, v down.
    pub corner_uvs: Vec<Vec2>,
    /// Faces handed on, in order.
    pub faces: Vec<FaceRecord>,
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
    uvs: Vec<Vec2>,
    material: u32,
    group_left_out: bool,
    number: u32,
    /// Those above the line.
    above: Counts,
    /// Those of the whole file, once its vertices are read.
    total: Counts,
}

/// The part of the file that is handed on.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
enum Turn {
    #[default]
    Vertices,
    Faces,
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

impl<'a> Guard<'a> {
    pub fn new(bytes: &'a [u8], leave_out: &'a [String], materials: &ObjMaterials) -> Self {
        let leave_out: HashSet<&str> = leave_out.iter().map(String::as_str).collect();
        Self {
            whole: bytes,
            rest: bytes,
            groups: vec![UNNAMED.to_owned()],
            materials: vec![String::new()],
            with_materials: *materials != ObjMaterials::Ignore,
            makes_masks: matches!(materials, ObjMaterials::Made(_)),
            group_left_out: leave_out.contains(UNNAMED),
            leave_out,
            ..Self::default()
        }
    }

    /// Returns the text that `tobj` was last given to read, shortened to fit a message.
    pub fn current_line(&self) -> String {
        beginning(String::from_utf8_lossy(&self.handed_on).trim_end()).into_owned()
    }

    /// True if the file has no vertex.
    pub fn is_empty(&self) -> bool {
        self.total.vertices == 0
    }

    pub fn face_ref(&self, record: &FaceRecord) -> FaceRef {
        FaceRef {
            group: self.groups[record.group as usize].clone(),
            number: record.number,
            line: record.line,
        }
    }

    /// Takes the next physical line off the file, without its line end; the flag says whether it
    /// had one.
    fn next_line(&mut self) -> Option<(Cow<'a, str>, bool)> {
        let (line, ended) = next_line(&mut self.rest)?;
        self.line = self.line.saturating_add(1);
        Some((line_text(line.trim_ascii()), ended))
    }

    /// Takes the next statement, which may be continued on more lines.
    fn next_statement(&mut self) -> Option<(Cow<'a, str>, bool)> {
        let (mut line, mut ended) = self.next_line()?;
        // A name or a comment may end in a backslash (a Windows folder); only numbers are
        // continued.
        if !line.starts_with(['v', 'f', 'l', 'p']) || !line.ends_with('\\') {
            return Some((line, ended));
        }
        let mut joined = String::new();
        while let Some(start) = line.strip_suffix('\\') {
            joined.push_str(start);
            joined.push(' ');
            let Some((next, next_ended)) = self.next_line() else {
                return Some((joined.into(), ended));
            };
            (line, ended) = (next, next_ended);
        }
        joined.push_str(&line);
        Some((joined.into(), ended))
    }

    /// Prepares the next line for `tobj`; false at the end of the file.
    fn advance(&mut self) -> Result<bool, String> {
        self.handed_on.clear();
        self.consumed = 0;
        while self.handed_on.is_empty() {
            match (self.next_statement(), self.turn) {
                (Some((line, _)), Turn::Vertices) => self.take_vertex(line.trim()),
                (Some((line, ended)), Turn::Faces) => self.take(line.trim(), ended)?,
                (None, Turn::Vertices) => self.begin_faces(),
                (None, Turn::Faces) => return Ok(false),
            }
        }
        Ok(true)
    }

    fn begin_faces(&mut self) {
        (self.rest, self.line) = (self.whole, 0);
        (self.total, self.above) = (self.above, Counts::default());
        self.turn = Turn::Faces;
    }

    /// Takes what faces name.
    fn take_vertex(&mut self, line: &str) {
        let (keyword, rest) = split(line);
        let numbers = without_comment(rest);
        match keyword {
            "v" => {
                self.above.vertices += 1;
                // Six numbers are a position with a colour: the colour is not ours, and tobj fails
                // where only some have one.
                let count = numbers.split_whitespace().count();
                let taken = if count >= 6 { 3 } else { count };
                self.hand_on("v", numbers.split_whitespace().take(taken));
            }
            "vn" => {
                self.above.normals += 1;
                let words = || numbers.split_whitespace().take(3);
                let read = words().filter(|word| word.parse::<f32>().is_ok()).count();
                match read {
                    3 => self.hand_on("vn", words()),
                    _ => {
                        self.normals_unread += 1;
                        self.hand_on("vn", ["0"; 3].into_iter());
                    }
                }
            }
            "vt" if self.with_materials => {
                self.above.uvs += 1;
                self.take_uv(numbers);
            }
            "mtllib" if self.with_materials && !rest.trim().is_empty() => {
                self.libraries.push(rest.trim().to_owned());
            }
            _ => {}
        }
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
                self.hand_on("g", [name].into_iter());
            }
            "p" => self.points += 1,
            "l" => self.lines += 1,
            "curv" | "curv2" | "surf" => self.curved += 1,
            // Smoothing groups, comments: nothing that we draw.
            _ => {}
        }
        Ok(())
    }

    fn hand_on<'b>(&mut self, keyword: &str, words: impl Iterator<Item = &'b str>) {
        self.handed_on.extend_from_slice(keyword.as_bytes());
        for word in words {
            self.handed_on.push(b' ');
            self.handed_on.extend_from_slice(word.as_bytes());
        }
        self.handed_on.push(b'\n');
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
                self.hand_on_face(&parsed);
            }
        }
        Ok(())
    }

    fn hand_on_face(&mut self, corners: &[Named]) {
        let normals = corners.iter().map(|corner| corner.normal?.ok());
        let normals: Option<Vec<usize>> = normals.collect();
        let uvs = corners
            .iter()
            .map(|corner| corner.uv.as_ref()?.as_ref().ok());
        let uvs: Option<Vec<Vec2>> = uvs.map(|uv| Some(self.uvs[*uv? - 1])).collect();
        let uvs = uvs.map(|uvs| {
            self.corner_uvs.extend(uvs);
            self.corner_uvs.len() - corners.len()
        });
        self.handed_on.push(b'f');
        for (at, corner) in corners.iter().enumerate() {
            let text = match &normals {
                Some(normals) => format!(" {}//{}", corner.vertex, normals[at]),
                None => format!(" {}", corner.vertex),
            };
            self.handed_on.extend_from_slice(text.as_bytes());
        }
        self.handed_on.push(b'\n');
        let group = (self.groups.len() - 1) as u32;
        self.faces.push(FaceRecord {
            group,
            number: self.number,
            line: self.line,
            has_normals: normals.is_some(),
            material: self.material,
            uvs,
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
        let find = |word: &str, count: fn(&Counts) -> usize| {
            resolve(word, count(&self.above), count(&self.total)).ok_or_else(not_a_corner)
        };
        let written = |word: Option<&'t str>| word.filter(|word| !word.is_empty());
        let vertex = find(vertex, |counts| counts.vertices)?
            .map_err(|(written, available)| FaceProblem::NoSuchVertex { written, available })?;
        let normal = written(normal).map(|word| find(word, |counts| counts.normals));
        let normal = normal.transpose()?.map(|index| index.map_err(drop));
        // Without a file of materials nothing is looked up by them.
        let uv = written(uv).filter(|_| self.makes_masks || !self.libraries.is_empty());
        let uv = uv.map(|word| find(word, |counts| counts.uvs)).transpose()?;
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

impl Read for Guard<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.fill_buf()?.read(buffer)?;
        self.consume(read);
        Ok(read)
    }
}

impl BufRead for Guard<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.consumed >= self.handed_on.len() {
            self.advance().map_err(|reason| {
                self.fatal = Some(reason);
                io::Error::from(io::ErrorKind::InvalidData)
            })?;
        }
        Ok(&self.handed_on[self.consumed..])
    }

    fn consume(&mut self, amount: usize) {
        self.consumed += amount;
    }
}
