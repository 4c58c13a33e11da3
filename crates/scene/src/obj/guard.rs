//! Stands between an OBJ file and `tobj`: hands it one clean line at a time and remembers where
//! each face stood.
//!
//! `tobj` reports no line and no face, fails as a whole on an index out of range (and overflows on
//! a huge one), takes an `l` record of three points for a triangle, reuses the normal of the corner
//! before where one is missing, wants vertices above the faces that name them, and does not join
//! lines continued by `\`. All of that is settled here, line by line, before it sees them: the file
//! is read twice, first all of its vertices, then its faces.

use super::options::ObjMaterials;
use crate::error::{FACES_SHOWN, FaceFault, FaceProblem, FaceRef, SceneError, beginning};
use crate::text::{next_line, without_comment};
use glam::Vec2;
use std::borrow::Cow;
use std::collections::HashSet;
use std::io::{self, BufRead, Read};
use std::path::Path;

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
    pub uvs: Option<u32>,
}

/// The reader that `tobj` reads from.
#[derive(Default)]
pub(super) struct Guard<'a> {
    whole: &'a str,
    rest: &'a str,
    /// True once all vertices are handed on: then faces are.
    hands_on_faces: bool,
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

/// Counts of what the corners of a face name and what is there. Only their vertices must be there.
#[derive(Default)]
struct Named {
    vertices: usize,
    normals: usize,
    uvs: usize,
    normal_absent: bool,
    /// Why the first texture coordinates that are not there are not.
    uv_absent: Option<FaceProblem>,
}

/// Most faces that `tobj` indexes at once: tables of so many fit a processor's cache.
const FACES_AT_ONCE: usize = 1 << 14;

/// Name of the faces that stand before the first `g` or `o`.
const UNNAMED: &str = "unnamed";

impl<'a> Guard<'a> {
    pub fn new(text: &'a str, leave_out: &'a [String], materials: &ObjMaterials) -> Self {
        let leave_out: HashSet<&str> = leave_out.iter().map(String::as_str).collect();
        Self {
            whole: text,
            rest: text,
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
        let text = String::from_utf8_lossy(&self.handed_on);
        let words: Vec<&str> = text.split_whitespace().collect();
        beginning(&words.join(" ")).into_owned()
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
    fn next_line(&mut self) -> Option<(&'a str, bool)> {
        let (line, ended) = next_line(&mut self.rest)?;
        self.line = self.line.saturating_add(1);
        Some((line.trim_ascii(), ended))
    }

    /// Takes the next statement, which may be continued on more lines.
    fn next_statement(&mut self) -> Option<(Cow<'a, str>, bool)> {
        let (line, mut ended) = self.next_line()?;
        let mut statement = Cow::from(line);
        // A name or a comment may end in a backslash (a Windows folder); only numbers are
        // continued.
        while statement.ends_with('\\') && line.starts_with(['v', 'f', 'l', 'p']) {
            let joined = statement.to_mut();
            joined.pop();
            joined.push(' ');
            let next;
            (next, ended) = self.next_line().unwrap_or(("", ended));
            joined.push_str(next);
        }
        Some((statement, ended))
    }

    /// Prepares the next line for `tobj`; false at the end of the file.
    fn advance(&mut self) -> Result<bool, String> {
        self.handed_on.clear();
        self.consumed = 0;
        while self.handed_on.is_empty() {
            match (self.next_statement(), self.hands_on_faces) {
                (Some((line, _)), false) => self.take_vertex(line.trim()),
                (Some((line, ended)), true) => self.take(line.trim(), ended)?,
                (None, false) => {
                    (self.rest, self.line) = (self.whole, 0);
                    (self.total, self.above) = (self.above, Counts::default());
                    self.hands_on_faces = true;
                }
                (None, true) => return Ok(false),
            }
        }
        Ok(true)
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
                let gaps = numbers.bytes().filter(|byte| !byte.is_ascii_graphic());
                let words = numbers.split_whitespace();
                if gaps.count() >= 5 && words.clone().count() >= 6 {
                    let position: Vec<&str> = words.take(3).collect();
                    self.hand_on(keyword, &position.join(" "));
                } else {
                    self.hand_on(keyword, numbers);
                }
            }
            "vn" => {
                self.above.normals += 1;
                let words = numbers.split_whitespace().take(3);
                let read = words.filter(|word| word.parse::<f32>().is_ok()).count();
                self.normals_unread += usize::from(read < 3);
                self.hand_on(keyword, if read < 3 { "0 0 0" } else { numbers });
            }
            "vt" if self.with_materials => {
                self.above.uvs += 1;
                // A number that cannot be read counts as 0, as one that is missing does.
                let mut numbers = numbers.split_whitespace();
                let mut next = || numbers.next().and_then(|word| word.parse::<f32>().ok());
                let (u, v) = (next().unwrap_or(0.0), next().unwrap_or(0.0));
                // The first row of a texture's texels is the upper one, where v is 1.
                self.uvs.push(Vec2::new(u, 1.0 - v));
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
                self.hand_on("g", name);
            }
            "p" => self.points += 1,
            "l" => self.lines += 1,
            "curv" | "curv2" | "surf" => self.curved += 1,
            // Smoothing groups, comments: nothing that we draw.
            _ => {}
        }
        Ok(())
    }

    fn hand_on(&mut self, keyword: &str, text: &str) {
        for part in [keyword, " ", text, "\n"] {
            self.handed_on.extend_from_slice(part.as_bytes());
        }
    }

    fn take_face(&mut self, corners: &str, ended: bool) -> Result<(), String> {
        self.number += 1;
        if self.group_left_out {
            return Ok(());
        }
        let first_uv = self.corner_uvs.len();
        let mut named = Named::default();
        self.handed_on.push(b'f');
        let mut corners = corners.split_whitespace();
        let taken = corners.try_for_each(|corner| self.take_corner(corner, &mut named));
        if taken.is_err() || named.vertices < 3 {
            self.handed_on.clear();
        }
        if let Err(problem) = taken {
            let face = || FaceRef {
                group: self.groups.last().cloned().unwrap_or_default(),
                number: self.number,
                line: self.line,
            };
            self.faults.add(face, problem);
            return Ok(());
        }
        match named.vertices {
            0..=2 if !ended => return Err("the file ends in the middle of a face".to_owned()),
            0 => return Err("a face without corners".to_owned()),
            1 => self.points += 1,
            2 => self.lines += 1,
            _ => self.end_face(named, first_uv),
        }
        Ok(())
    }

    /// Ends a face of three corners or more.
    fn end_face(&mut self, named: Named, first_uv: usize) {
        self.handed_on.push(b'\n');
        self.normals_absent += usize::from(named.normal_absent);
        let problem = named.uv_absent.map(|problem| (self.faces.len(), problem));
        self.uvs_absent.extend(problem);
        self.faces.push(FaceRecord {
            group: (self.groups.len() - 1) as u32,
            number: self.number,
            line: self.line,
            has_normals: named.normals == named.vertices,
            material: self.material,
            uvs: (named.uvs == named.vertices).then_some(first_uv as u32),
        });
        if self.faces.len().is_multiple_of(FACES_AT_ONCE) {
            self.handed_on.extend_from_slice(b"g\n");
        }
    }

    /// Hands on a corner whose vertex exists, with its normal, and keeps its texture coordinates.
    fn take_corner(&mut self, text: &str, named: &mut Named) -> Result<(), FaceProblem> {
        let mut words = text.as_bytes().split(|byte| *byte == b'/');
        let vertex = words.next().unwrap_or_default();
        let [uv, normal] = [(); 2].map(|()| words.next().filter(|word| !word.is_empty()));
        let not_a_corner = || FaceProblem::NotACorner(text.to_owned());
        if words.next().is_some() {
            return Err(not_a_corner());
        }
        let (above, total) = (self.above, self.total);
        let index = resolve(vertex, above.vertices, total.vertices).ok_or_else(not_a_corner)?;
        let index = index
            .map_err(|(written, available)| FaceProblem::NoSuchVertex { written, available })?;
        named.vertices += 1;
        self.push_number(b" ", vertex, index);
        if let Some(normal) = normal {
            match resolve(normal, above.normals, total.normals).ok_or_else(not_a_corner)? {
                Ok(index) => {
                    named.normals += 1;
                    self.push_number(b"//", normal, index);
                }
                Err(_) => named.normal_absent = true,
            }
        }
        // Without a file of materials nothing is looked up by them.
        if let Some(uv) = uv.filter(|_| self.makes_masks || !self.libraries.is_empty()) {
            match resolve(uv, above.uvs, total.uvs).ok_or_else(not_a_corner)? {
                Ok(index) => {
                    named.uvs += 1;
                    self.corner_uvs.push(self.uvs[index - 1]);
                }
                Err((written, available)) => {
                    let problem = FaceProblem::NoSuchUv { written, available };
                    named.uv_absent.get_or_insert(problem);
                }
            }
        }
        Ok(())
    }

    /// Hands on a number as it is written; one that counts back becomes the one that it means.
    fn push_number(&mut self, before: &[u8], written: &[u8], index: usize) {
        let counted = written.starts_with(b"-").then(|| index.to_string());
        let text = counted.as_ref().map_or(written, |text| text.as_bytes());
        self.handed_on.extend_from_slice(before);
        self.handed_on.extend_from_slice(text);
    }
}

/// A statement's keyword, and what follows.
pub(super) fn split(line: &str) -> (&str, &str) {
    line.split_once(char::is_whitespace).unwrap_or((line, ""))
}

/// The number, from 1, of what a corner names, or the text of one that names nothing and how many
/// there are. `None` where it is no number. A positive one counts from the beginning of the file,
/// to its end; a negative one back from the line. One that overflows names nothing either.
fn resolve(written: &[u8], above: usize, total: usize) -> Option<Result<usize, (String, usize)>> {
    let (digits, most, back_from) = match written {
        [b'-', digits @ ..] => (digits, above, Some(above + 1)),
        [b'+', digits @ ..] | digits => (digits, total, None),
    };
    let number = digits.iter().try_fold(0usize, |number, byte| {
        let digit = byte.is_ascii_digit().then(|| usize::from(byte - b'0'))?;
        Some(number.saturating_mul(10).saturating_add(digit))
    });
    let number = number.filter(|_| !digits.is_empty())?;
    let index = back_from.map_or(number, |from| from.saturating_sub(number));
    let valid = (1..=most).contains(&index).then_some(index);
    Some(valid.ok_or_else(|| (String::from_utf8_lossy(written).into_owned(), most)))
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
