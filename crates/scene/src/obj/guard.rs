//! Stands between an OBJ file and `tobj`: hands it one clean line at a time and remembers where
//! each face stood.
//!
//! `tobj` reports no line and no face, fails as a whole on an index out of range (and overflows on
//! a huge one), takes an `l` record of three points for a triangle, reuses the normal of the corner
//! before where one is missing, and does not join lines continued by `\`. All of that is settled
//! here, line by line, before it sees them.

use crate::error::{FACES_SHOWN, FaceFault, FaceProblem, FaceRef, beginning};
use glam::Vec2;
use std::{
    collections::HashSet,
    io::{self, BufRead, Read},
};

/// Where a face that was handed on stood, and whether the file gives it normals.
pub(super) struct FaceRecord {
    /// Index into [`Guard::groups`].
    pub group: u32,
    /// Number within its group, from 1.
    pub number: u32,
    /// Line in the file, from 1.
    pub line: u32,
    /// Whether every corner names a normal.
    pub has_normals: bool,
    /// Index into [`Guard::materials`].
    pub material: u32,
    /// The first of its corners in [`Guard::corner_uvs`], if each names texture coordinates.
    pub uvs: Option<usize>,
}

/// The reader that `tobj` reads from.
pub(super) struct Guard<'a> {
    rest: &'a [u8],
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
    /// The first faulty faces; those are not handed on.
    pub faults: Vec<FaceFault>,
    /// Number of faulty faces.
    pub fault_count: usize,
    /// Faces of groups left out.
    pub faces_left_out: usize,
    /// Points met.
    pub points: usize,
    /// Lines met.
    pub lines: usize,
    /// Whether materials and texture coordinates are of interest.
    with_materials: bool,
    uvs: Vec<Vec2>,
    material: u32,
    group_left_out: bool,
    number: u32,
    vertices: usize,
    normals: usize,
}

/// Vertex, normal and texture coordinates of a corner, from 1.
type Named = (usize, Option<usize>, Option<usize>);

/// Name of the faces that stand before the first `g` or `o`.
const UNNAMED: &str = "unnamed";

impl<'a> Guard<'a> {
    pub fn new(bytes: &'a [u8], leave_out: &'a [String], with_materials: bool) -> Self {
        let leave_out: HashSet<&str> = leave_out.iter().map(String::as_str).collect();
        Self {
            // a byte order mark is no part of the first word
            rest: bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes),
            handed_on: Vec::new(),
            consumed: 0,
            line: 0,
            fatal: None,
            groups: vec![UNNAMED.to_owned()],
            materials: vec![String::new()],
            libraries: Vec::new(),
            corner_uvs: Vec::new(),
            with_materials,
            uvs: Vec::new(),
            material: 0,
            faces: Vec::new(),
            faults: Vec::new(),
            fault_count: 0,
            faces_left_out: 0,
            points: 0,
            lines: 0,
            group_left_out: leave_out.contains(UNNAMED),
            leave_out,
            number: 0,
            vertices: 0,
            normals: 0,
        }
    }

    /// What `tobj` was last given to read, shortened to what fits a message.
    pub fn current_line(&self) -> String {
        beginning(String::from_utf8_lossy(&self.handed_on).trim_end()).into_owned()
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
    fn next_line(&mut self) -> Result<Option<(&'a str, bool)>, String> {
        if self.rest.is_empty() {
            return Ok(None);
        }
        self.line = self.line.saturating_add(1);
        let (line, ended) = match self.rest.iter().position(|&byte| byte == b'\n') {
            Some(end) => {
                let line = &self.rest[..end];
                self.rest = &self.rest[end + 1..];
                (line, true)
            }
            None => (std::mem::take(&mut self.rest), false),
        };
        match std::str::from_utf8(line) {
            Ok(line) => Ok(Some((line.trim(), ended))),
            Err(error) => Err(format!(
                "not an OBJ file, or damaged: byte {} of the line is not UTF-8 text",
                error.valid_up_to() + 1
            )),
        }
    }

    /// Prepares the next line for `tobj`; false at the end of the file.
    fn advance(&mut self) -> Result<bool, String> {
        self.handed_on.clear();
        self.consumed = 0;
        while self.handed_on.is_empty() {
            let Some((line, mut ended)) = self.next_line()? else {
                return Ok(false);
            };
            let mut joined = String::new();
            let mut line = line;
            // A name or a comment may end in a backslash (a Windows folder); only numbers are
            // continued.
            let numbers = line.starts_with(['v', 'f', 'l', 'p']);
            while let Some(start) = line.strip_suffix('\\').filter(|_| numbers) {
                joined.push_str(start);
                joined.push(' ');
                let Some((next, next_ended)) = self.next_line()? else {
                    break;
                };
                (line, ended) = (next, next_ended);
            }
            if joined.is_empty() {
                self.take(line, ended)?;
            } else {
                joined.push_str(line.trim_end_matches('\\'));
                self.take(&joined, ended)?;
            }
        }
        Ok(true)
    }

    fn take(&mut self, line: &str, ended: bool) -> Result<(), String> {
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let numbers = rest.split('#').next().unwrap_or("");
        match keyword {
            "v" => {
                self.vertices += 1;
                // Six numbers are a position with a colour: the colour is not ours, and tobj fails
                // where only some have one.
                let count = numbers.split_whitespace().count();
                let taken = if count >= 6 { 3 } else { count };
                self.hand_on("v", numbers.split_whitespace().take(taken));
            }
            "vn" => {
                self.normals += 1;
                self.hand_on("vn", numbers.split_whitespace());
            }
            "vt" if self.with_materials => self.take_uv(numbers),
            "usemtl" if self.with_materials => {
                let name = rest.trim();
                let known = self.materials.iter().position(|other| other == name);
                self.material = known.unwrap_or(self.materials.len()) as u32;
                if known.is_none() {
                    self.materials.push(name.to_owned());
                }
            }
            "mtllib" if self.with_materials && !rest.trim().is_empty() => {
                self.libraries.push(rest.trim().to_owned());
            }
            "f" => self.take_face(numbers, ended)?,
            "g" | "o" => {
                let name = if rest.trim().is_empty() {
                    UNNAMED
                } else {
                    rest.trim()
                };
                self.group_left_out = self.leave_out.contains(name);
                self.groups.push(name.to_owned());
                self.number = 0;
                self.hand_on("g", [name].into_iter());
            }
            "p" => self.points += 1,
            "l" => self.lines += 1,
            // Smoothing groups, comments, free-form surfaces: nothing that we draw.
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
            self.faces_left_out += 1;
            return Ok(());
        }
        let mut parsed = Vec::with_capacity(4);
        for corner in corners.split_whitespace() {
            match self.corner(corner) {
                Ok(corner) => parsed.push(corner),
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
                let has_normals = parsed.iter().all(|corner| corner.1.is_some());
                let uvs = parsed.iter().all(|corner| corner.2.is_some());
                let uvs = uvs.then_some(self.corner_uvs.len());
                if uvs.is_some() {
                    let named = parsed.iter().filter_map(|corner| corner.2);
                    self.corner_uvs.extend(named.map(|uv| self.uvs[uv - 1]));
                }
                self.handed_on.push(b'f');
                for (vertex, normal, _) in parsed {
                    let text = match normal {
                        Some(normal) if has_normals => format!(" {vertex}//{normal}"),
                        _ => format!(" {vertex}"),
                    };
                    self.handed_on.extend_from_slice(text.as_bytes());
                }
                self.handed_on.push(b'\n');
                let group = (self.groups.len() - 1) as u32;
                self.faces.push(FaceRecord {
                    group,
                    number: self.number,
                    line: self.line,
                    has_normals,
                    material: self.material,
                    uvs,
                });
            }
        }
        Ok(())
    }

    /// Vertex, normal and texture coordinates of a corner, from 1, known to exist.
    fn corner(&self, text: &str) -> Result<Named, FaceProblem> {
        let mut words = text.split('/');
        let (vertex, uv, normal) = (words.next().unwrap_or(""), words.next(), words.next());
        if words.next().is_some() {
            return Err(FaceProblem::NotACorner(text.to_owned()));
        }
        let resolve =
            |written: &str, available: usize, missing: fn(String, usize) -> FaceProblem| {
                // An index may count back from the last vertex; one that overflows names nothing
                // either.
                let digits = written.strip_prefix(['-', '+']).unwrap_or(written);
                if digits.is_empty() || !digits.bytes().all(|byte| byte.is_ascii_digit()) {
                    return Err(FaceProblem::NotACorner(text.to_owned()));
                }
                let index = match digits.parse::<usize>() {
                    Ok(back) if written.starts_with('-') => {
                        (available + 1).checked_sub(back).filter(|_| back > 0)
                    }
                    Ok(index) => Some(index),
                    Err(_) => None,
                };
                match index {
                    Some(index) if (1..=available).contains(&index) => Ok(index),
                    _ => Err(missing(written.to_owned(), available)),
                }
            };
        let vertex = resolve(vertex, self.vertices, |written, available| {
            FaceProblem::NoSuchVertex { written, available }
        })?;
        let normal = match normal {
            None | Some("") => None,
            Some(normal) => Some(resolve(normal, self.normals, |written, available| {
                FaceProblem::NoSuchNormal { written, available }
            })?),
        };
        let uv = match uv {
            // Without a file of materials nothing is looked up by them.
            Some(uv) if !self.libraries.is_empty() && !uv.is_empty() => {
                Some(resolve(uv, self.uvs.len(), |written, available| {
                    FaceProblem::NoSuchUv { written, available }
                })?)
            }
            _ => None,
        };
        Ok((vertex, normal, uv))
    }

    fn fault(&mut self, problem: FaceProblem) {
        self.fault_count += 1;
        if self.faults.len() < FACES_SHOWN {
            let group = self.groups.last().cloned().unwrap_or_default();
            self.faults.push(FaceFault {
                face: FaceRef {
                    group,
                    number: self.number,
                    line: self.line,
                },
                problem,
            });
        }
    }
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
