//! Devices besides the one that all tests share.

use skiagraph_gpu::{
    Pipelines,
    device::{self, Gpu, Wanted},
};

/// A device of an instance of its own. For wgpu it is equal to the first device of any other one,
/// and its buffers to the buffers there.
pub fn of_own_instance() -> Gpu {
    let wanted = Wanted::default().with_features(super::graphs::RAY_QUERY);
    device::open_with(&wanted).unwrap_or_else(|error| panic!("{error}"))
}

/// Another device of the same instance, with all that its adapter has.
pub fn beside(gpu: &Gpu) -> Gpu {
    let mut other = gpu.clone();
    let opened = gpu.adapter.request_device(&wgpu::DeviceDescriptor {
        required_features: gpu.device.features() - super::graphs::RAY_QUERY,
        required_limits: gpu.device.limits(),
        ..Default::default()
    });
    let opened = pollster::block_on(opened).unwrap_or_else(|error| panic!("{error}"));
    (other.device, other.queue) = opened;
    other.pipelines = Pipelines::new(&other.device);
    other
}

/// Both kinds of other devices.
pub fn others(gpu: &Gpu) -> [Gpu; 2] {
    [beside(gpu), of_own_instance()]
}
