//! Reads documents, shaders and pictures below a folder.

use skiagraph_graph::{FolderSources, Picture, Sources};
use std::{io, sync::Arc};

/// [`FolderSources`] that also read `.png` files, as pictures of 16-bit RGBA texels from the top
/// left, for a graph's textures.
pub struct PictureSources(pub FolderSources);

impl Sources for PictureSources {
    fn read(&self, path: &str) -> Result<Option<Arc<str>>, String> {
        self.0.read(path)
    }

    fn list(&self, folder: &str) -> Vec<String> {
        self.0.list(folder)
    }

    fn picture(&self, path: &str) -> Result<Option<Picture>, String> {
        let path = self.0.root.join(path);
        // Opening a pipe would block.
        if !path.is_file() {
            return Ok(None);
        }
        let decoded =
            image::ImageReader::open(&path).and_then(image::ImageReader::with_guessed_format);
        let decoded = match decoded.map(image::ImageReader::decode) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(error.to_string()),
            Ok(decoded) => decoded.map_err(|error| format!("{error}; a picture is a .png file"))?,
        };
        let size = [decoded.width(), decoded.height()];
        let texels = decoded.into_rgba16();
        let texels = texels.pixels().map(|texel| texel.0).collect();
        Ok(Some(Picture { size, texels }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{ImageBuffer, Rgba};

    fn folder() -> (tempfile::TempDir, PictureSources) {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().to_path_buf();
        (folder, PictureSources(FolderSources { root }))
    }

    #[test]
    fn texels_are_sixteen_bits_from_the_top_left() {
        let (folder, sources) = folder();
        let texels = vec![0u8, 255, 1, 255, 2, 3, 4, 5];
        let picture: ImageBuffer<Rgba<u8>, _> = ImageBuffer::from_raw(2, 1, texels).unwrap();
        picture.save(folder.path().join("a.png")).unwrap();
        let decoded = sources.picture("a.png").unwrap().unwrap();
        assert_eq!(decoded.size, [2, 1]);
        assert_eq!(
            *decoded.texels,
            [[0, 65_535, 257, 65_535], [514, 771, 1028, 1285]]
        );
    }

    #[test]
    fn what_is_missing_is_none_and_what_is_no_picture_says_so() {
        let (folder, sources) = folder();
        assert_eq!(sources.picture("a.png"), Ok(None));
        std::fs::write(folder.path().join("a.png"), "text").unwrap();
        let why = sources.picture("a.png").unwrap_err();
        assert!(why.ends_with("a picture is a .png file"), "{why}");
    }
}
