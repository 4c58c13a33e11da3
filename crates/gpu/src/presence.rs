//! Checks before each frame that the device is not lost, without allocating anything; checks that
//! things are of the device.

use crate::error::{ExecuteError, scoped};
use crate::provider::Provider;
use crate::signal::{Progress, Signal};
use crate::{buffer, identity};

/// Tells whether a device is lost, and whether queues and providers are of it.
///
/// wgpu reports a loss only to a single callback, which the host may have set. But it refuses at
/// once to map a buffer of a lost device, while a working device maps it at the next poll. So this
/// requests the mapping of a kept buffer and cancels it; the driver is not involved.
pub(crate) struct Presence {
    device: wgpu::Device,
    buffer: wgpu::Buffer,
    asked: Signal,
    /// Number of the last provider's device that was found to be this one.
    provider: Option<u64>,
}

impl Presence {
    /// Creates the buffer whose mapping is requested.
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
            provider: None,
        };
        presence.check()?;
        Ok(presence)
    }

    /// Returns an error if `queue` is that of another device.
    ///
    /// # Errors
    /// [`ExecuteError::OtherDevice`], or [`ExecuteError::DeviceLost`].
    pub fn check_queue(&self, queue: &wgpu::Queue) -> Result<(), ExecuteError> {
        let is_own = identity::has_queue(&self.device, queue, &self.buffer);
        let way_out = "hand over the one that came with the device";
        self.check_own(is_own, "the queue", way_out)
    }

    /// Returns an error if the resources of `provider` are on another device.
    ///
    /// # Errors
    /// [`ExecuteError::OtherDevice`], or [`ExecuteError::DeviceLost`].
    pub fn check_provider(&mut self, provider: &dyn Provider) -> Result<(), ExecuteError> {
        if let Some(identity) = provider.device()
            && self.provider != Some(identity.number)
        {
            self.check_own(identity.is(&self.device), "the provider", MOVE)?;
            self.provider = Some(identity.number);
        }
        Ok(())
    }

    /// Returns an error if a thing is not of this device, as it seems; a lost device tells nothing.
    ///
    /// # Errors
    /// [`ExecuteError::OtherDevice`], or [`ExecuteError::DeviceLost`].
    pub fn check_own(
        &self,
        is_own: bool,
        name: impl Into<String>,
        way_out: &'static str,
    ) -> Result<(), ExecuteError> {
        if is_own {
            return Ok(());
        }
        self.check()?;
        let name = name.into();
        Err(ExecuteError::OtherDevice { name, way_out })
    }

    /// Returns an error if the device is lost.
    ///
    /// # Errors
    /// [`ExecuteError::DeviceLost`].
    pub fn check(&self) -> Result<(), ExecuteError> {
        if cfg!(target_arch = "wasm32") {
            // A browser tells by the device's own callback.
            return Ok(());
        }
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

/// True if a new buffer can be mapped at once, which a lost device refuses.
fn maps_another(device: &wgpu::Device) -> bool {
    let buffer = buffer::mapped(device, NAME, wgpu::MAP_ALIGNMENT, USAGE);
    buffer.get_mapped_range(..).is_ok()
}

const NAME: &str = "is the device there";

/// The way out for a provider of another device.
const MOVE: &str = "move it to the executor's (`SceneProvider::move_to`), or make an executor on \
                    the provider's device; executors on two devices need a provider each";

/// A buffer that is only mapped has no usage in the driver's eyes.
const USAGE: wgpu::BufferUsages = wgpu::BufferUsages::MAP_WRITE.union(wgpu::BufferUsages::COPY_SRC);
