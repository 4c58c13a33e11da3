//! Checks before each frame that a device is still there, without making anything.

use crate::{
    buffer,
    error::{ExecuteError, scoped},
    signal::{Progress, Signal},
};

/// Says whether a device is lost.
///
/// wgpu tells of a loss only to the one callback that the host may have set. But it refuses at
/// once to map a buffer of a lost device, while a device that is there maps it when it is polled
/// next. So the mapping of a kept buffer is asked for and called off: the driver hears nothing of
/// it.
pub(crate) struct Presence {
    device: wgpu::Device,
    buffer: wgpu::Buffer,
    asked: Signal,
}

impl Presence {
    /// Makes the buffer that is asked for.
    ///
    /// # Errors
    /// If the device is lost, or has no memory for a few bytes.
    pub fn new(device: &wgpu::Device) -> Result<Self, ExecuteError> {
        let presence = Self {
            buffer: scoped(device, NAME, || {
                buffer::make(device, NAME, wgpu::MAP_ALIGNMENT, USAGE)
            })?,
            device: device.clone(),
            asked: Signal::default(),
        };
        presence.check()?;
        Ok(presence)
    }

    /// Returns an error if the device is lost.
    ///
    /// # Errors
    /// [`ExecuteError::DeviceLost`].
    pub fn check(&self) -> Result<(), ExecuteError> {
        // A device that another thread destroys meanwhile has destroyed the buffer, too, which wgpu
        // would complain of.
        let complaints = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        self.asked
            .when_mapped_now(&self.buffer, wgpu::MapMode::Write);
        let progress = self.asked.progress();
        self.buffer.unmap();
        drop(complaints);
        match progress {
            // Mapped already: another thread has polled the device.
            Progress::UnderWay | Progress::Done => Ok(()),
            // Or a thread that was polling has mapped it behind the last check's back, or says so
            // only now: a buffer that is new tells for sure.
            Progress::Failed | Progress::Dropped if maps_another(&self.device) => Ok(()),
            Progress::Failed | Progress::Dropped => Err(ExecuteError::DeviceLost(
                "it maps no buffers any more".to_owned(),
            )),
        }
    }
}

/// Makes a buffer that is mapped from the first, which a lost device does not.
fn maps_another(device: &wgpu::Device) -> bool {
    let buffer = buffer::mapped(device, NAME, wgpu::MAP_ALIGNMENT, USAGE);
    buffer.get_mapped_range(..).is_ok()
}

const NAME: &str = "is the device there";

/// A buffer that is only mapped has no usage in the driver's eyes.
const USAGE: wgpu::BufferUsages = wgpu::BufferUsages::MAP_WRITE.union(wgpu::BufferUsages::COPY_SRC);
