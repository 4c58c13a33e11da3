//! Reading a file whole, and never more of it than a file of its kind has.

use crate::{handed::handed, text::without_mark};
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

const MIB: u64 = 1 << 20;

/// Size limit for reading a kind of file, with the words for its error message.
#[derive(Clone, Copy, Debug)]
pub struct Limit {
    /// Kind of file with its article, for the message: "an .obj file".
    pub of: &'static str,
    /// Largest size of a file that is read, in MiB.
    pub mib: u64,
    /// Advice to the user whose file is larger, for the message: "scale it down".
    pub way_out: &'static str,
}

impl Limit {
    /// Reads all bytes of the file at `path`, if they are at most [`mib`](Self::mib) MiB.
    ///
    /// # Errors
    /// An error of the operating system; a folder, a device or a pipe, which is not opened because
    /// that alone can block; a file beyond the limit. The message does not name the file.
    pub fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let most = self.mib * MIB;
        let check = |length: u64| {
            let exceeded = || self.exceeded(&format!("{} MiB", length.div_ceil(MIB)));
            (length <= most).then_some(()).ok_or_else(exceeded)
        };
        if let Some(bytes) = handed(path) {
            return check(bytes.len() as u64).map(|()| bytes.to_vec());
        }
        let metadata = std::fs::metadata(path)?;
        if metadata.is_dir() {
            return Err(io::Error::other("it is a folder, expected a file"));
        }
        if !metadata.is_file() {
            return Err(io::Error::other(
                "it is a device, a pipe or a socket, of unknown length: copy its content \
                 into a file, and name that",
            ));
        }
        check(metadata.len())?;
        let mut bytes = Vec::new();
        bytes.try_reserve_exact(metadata.len() as usize + 1)?;
        // Files of the kernel's have length 0 whatever they hold, and others may grow meanwhile.
        File::open(path)?.take(most + 1).read_to_end(&mut bytes)?;
        if bytes.len() as u64 > most {
            return Err(self.exceeded(&format!("more than {} MiB", self.mib)));
        }
        Ok(bytes)
    }

    /// Reads the text of the file at `path`, UTF-8 or UTF-16, with or without a byte order mark,
    /// which is left out.
    ///
    /// # Errors
    /// The errors of [`Self::read`]; bytes that are neither encoding.
    pub fn read_text(&self, path: &Path) -> io::Result<String> {
        String::from_utf8(without_mark(&self.read(path)?).into_owned()).map_err(|_| {
            io::Error::new(
                io::ErrorKind::InvalidData,
                "it is not UTF-8 text: save it in that encoding",
            )
        })
    }

    fn exceeded(&self, length: &str) -> io::Error {
        let Self {
            of: kind,
            mib,
            way_out,
        } = self;
        io::Error::other(format!("it has {length}, {kind} {mib} at most: {way_out}"))
    }
}
