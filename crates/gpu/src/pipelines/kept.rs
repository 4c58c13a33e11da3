//! Compiled shaders that last from one run of a program to the next, as bytes that tell if they are
//! whole.

use crate::error::scoped;
use std::hash::{DefaultHasher, Hasher};

/// Bytes of the checksum.
const CHECK: usize = size_of::<u64>();

/// The shaders of an earlier run, and the function that is handed those of this one.
pub(super) struct Keeper {
    pub before: Vec<u8>,
    pub keep: Box<dyn FnOnce(Vec<u8>) + Send + Sync>,
}

fn checksum(data: &[u8]) -> [u8; CHECK] {
    let mut hasher = DefaultHasher::new();
    hasher.write(data);
    hasher.finish().to_le_bytes()
}

/// Puts a checksum behind the data of a cache.
pub(super) fn sealed(mut data: Vec<u8>) -> Vec<u8> {
    data.extend(checksum(&data));
    data
}

/// The data of a cache, if they are as they were sealed.
fn opened(bytes: &[u8]) -> Option<&[u8]> {
    let (data, check) = bytes.split_last_chunk::<CHECK>()?;
    (*check == checksum(data)).then_some(data)
}

/// Creates a cache with the shaders of an earlier run; an empty one if they are not whole, or of
/// another driver. `None` if the device has no such caches.
pub(super) fn cache(device: &wgpu::Device, kept: &[u8]) -> Option<wgpu::PipelineCache> {
    if !device.features().contains(wgpu::Features::PIPELINE_CACHE) {
        return None;
    }
    let make = |data| {
        let descriptor = wgpu::PipelineCacheDescriptor {
            label: None,
            data,
            fallback: true,
        };
        scoped(device, "pipeline cache", || {
            #[expect(unsafe_code, reason = "wgpu has its caller vouch for the data")]
            // SAFETY: by their checksum the data are those that `get_data` gave, and wgpu refuses
            // those of another driver, adapter or version of itself.
            unsafe {
                device.create_pipeline_cache(&descriptor)
            }
        })
    };
    make(opened(kept)).or_else(|_| make(None)).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_that_are_not_whole_are_none() {
        let bytes = sealed(vec![1, 2, 3]);
        assert_eq!(opened(&bytes), Some(&[1, 2, 3][..]));
        for length in 0..bytes.len() {
            assert_eq!(opened(&bytes[..length]), None, "{length} bytes");
        }
        for at in 0..bytes.len() {
            let mut bytes = bytes.clone();
            bytes[at] ^= 1;
            assert_eq!(opened(&bytes), None, "another byte {at}");
        }
    }
}
