//! Runs graphs of a few texels for the tests of features.

#![allow(dead_code, reason = "each test file uses a part of it")]

use crate::support::{Files, load, right};
use skiagraph_gpu::{
    Content, Executor, Frame, FrameReport,
    device::{self, Gpu},
};
use skiagraph_graph::{NoProvider, ParamValue, PlanRequest};
use std::sync::LazyLock;

/// A device with all that the adapter has of what graphs may ask for.
pub static GPU: LazyLock<Gpu> = LazyLock::new(|| {
    let wanted = wgpu::Features::VERTEX_WRITABLE_STORAGE;
    device::open_with(&device::Wanted::default().with_features(wanted))
        .unwrap_or_else(|error| panic!("{error}"))
});

/// Writes the param `value` into its only target.
pub const VALUE: &str = "struct Params { value: f32 }
    var<uniform> params: Params;
    @fragment fn fragment() -> @location(0) f32 { return params.value; }";

/// Writes 4 · row + column.
pub const COUNT: &str = "@fragment fn fragment(@builtin(position) centre: vec4<f32>)
    -> @location(0) f32 {
        return 4.0 * floor(centre.y) + floor(centre.x);
    }";

/// `graph.ron` of the files on the device, at 4×4.
pub struct Running(Executor);

impl Running {
    pub fn new(files: &Files) -> Self {
        Self::with(files, &[])
    }

    /// With these params.
    pub fn with(files: &Files, params: &[(&str, ParamValue)]) -> Self {
        let mut request = PlanRequest::new([4, 4], &NoProvider);
        request.features = GPU.device.features();
        request.limits = GPU.device.limits();
        let params = params.iter().cloned();
        request.params = params
            .map(|(name, value)| (name.to_owned(), value))
            .collect();
        let plan = right(right(load(files)).plan(&request));
        Self(
            Executor::new(&GPU.device, &GPU.queue, plan, &mut NoProvider)
                .unwrap_or_else(|error| panic!("{error}")),
        )
    }

    /// A frame at this time, in which every pass runs.
    pub fn frame_at(&mut self, seconds: f32, read: &[&str]) -> FrameReport {
        let mut encoder = GPU.device.create_command_encoder(&Default::default());
        let frame = Frame::new().with_all(true);
        let frame = frame.with_read(read).with_seconds(seconds);
        let finished = self.0.encode(&mut encoder, &frame).and_then(|_| {
            GPU.queue.submit([encoder.finish()]);
            self.0.finish()
        });
        finished.unwrap_or_else(|error| panic!("{error}"))
    }

    /// An output after one more frame.
    pub fn content(&mut self, output: &str) -> Content {
        let mut report = self.frame_at(0.0, &[output]);
        report.readbacks.remove(0).content
    }

    /// The floats of a texture after one more frame.
    pub fn floats(&mut self, output: &str) -> Vec<f32> {
        let content = self.content(output);
        content.as_f32().expect("a texture of floats")
    }

    /// The words of a buffer, or of a texture of unsigned integers, after one more frame.
    pub fn words(&mut self, output: &str) -> Vec<u32> {
        let content = self.content(output);
        content.as_u32().expect("words")
    }
}

/// The floats of a texture after the first frame.
pub fn floats(files: &Files, output: &str) -> Vec<f32> {
    Running::new(files).floats(output)
}

/// The words of a buffer, or of a texture of unsigned integers, after the first frame.
pub fn words(files: &Files, output: &str) -> Vec<u32> {
    Running::new(files).words(output)
}

/// The floats of a buffer after the first frame.
pub fn buffer_floats(files: &Files, output: &str) -> Vec<f32> {
    let words = words(files, output);
    words.into_iter().map(f32::from_bits).collect()
}
