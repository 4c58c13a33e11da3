//! A window with shadows, to start from: `cargo run -p skiagraph-host --example window`. The first
//! argument is a preset, or `none`; the second one stops time at that many seconds.
//!
//! `scene.rs` and `renderer.rs` stand for what a program has anyway. `shadows.rs` is all that it
//! adds, and [`Shown::draw`] calls it.

mod renderer;
mod scene;
mod shadows;

use renderer::{Renderer, texture};
use scene::Moment;
use shadows::Shadows;
use skiagraph_host::wgpu::{self, CurrentSurfaceTexture as Current};
use std::{error::Error, process::ExitCode, sync::Arc, time::Instant};
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, EventLoop, OwnedDisplayHandle};
use winit::keyboard::{Key, NamedKey};
use winit::window::{Window, WindowId};

type Failed = Box<dyn Error + Send + Sync>;

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Failed> {
    let mut arguments = std::env::args().skip(1);
    let preset = arguments.next().unwrap_or_else(|| "light_buffer".into());
    let stopped = arguments.next().map(|seconds| seconds.parse());
    let events = EventLoop::new()?;
    let mut app = App {
        preset,
        stopped: stopped.transpose()?,
        display: events.owned_display_handle(),
        shown: None,
        failed: None,
    };
    events.run_app(&mut app)?;
    app.failed.map_or(Ok(()), Err)
}

struct App {
    preset: String,
    /// The time at which everything stands still, in seconds.
    stopped: Option<f64>,
    display: OwnedDisplayHandle,
    shown: Option<Shown>,
    failed: Option<Failed>,
}

/// A window that is there, with its surface and all that draws into it.
struct Shown {
    window: Arc<Window>,
    instance: wgpu::Instance,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    device: wgpu::Device,
    queue: wgpu::Queue,
    renderer: Renderer,
    shadows: Option<Shadows>,
    /// Visibility of a sun that nothing hides: one texel of 1.
    unshaded: wgpu::TextureView,
    began: Instant,
}

impl Shown {
    fn new(events: &ActiveEventLoop, app: &App) -> Result<Self, Failed> {
        let attributes = Window::default_attributes()
            .with_title("Skiagraph in a program of its own")
            .with_inner_size(PhysicalSize::new(960, 600));
        let window = Arc::new(events.create_window(attributes)?);
        let display = Box::new(app.display.clone());
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            // Groups of `Indirect` passes are checked. Not a debug build's own flags: Mesa 22.3
            // crashes on labels.
            flags: wgpu::InstanceFlags::VALIDATION_INDIRECT_CALL,
            ..wgpu::InstanceDescriptor::new_with_display_handle(display)
        });
        let surface = instance.create_surface(Arc::clone(&window))?;
        let asked = wgpu::RequestAdapterOptions {
            compatible_surface: Some(&surface),
            ..Default::default()
        };
        let adapter = pollster::block_on(instance.request_adapter(&asked))?;
        let (device, queue) =
            pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
                required_limits: adapter.limits(),
                ..Default::default()
            }))?;
        let config = surface.get_default_config(&adapter, 960, 600);
        let mut config = config.ok_or("the adapter cannot draw into the window")?;
        let formats = surface.get_capabilities(&adapter).formats;
        let srgb = formats.into_iter().find(wgpu::TextureFormat::is_srgb);
        config.format = srgb.unwrap_or(config.format);

        let first = Moment::new(0.0, [960, 600]);
        let make = |preset| Shadows::new((&device, &queue), preset, &first);
        let preset = (app.preset != "none").then_some(app.preset.as_str());
        let shadows = preset.map(make).transpose()?;
        let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
        let texel = texture(&device, [1, 1], wgpu::TextureFormat::R8Unorm, usage);
        let layout = wgpu::TexelCopyBufferLayout::default();
        queue.write_texture(texel.as_image_copy(), &[255], layout, texel.size());
        let mut shown = Self {
            renderer: Renderer::new(&device, config.format),
            shadows,
            unshaded: texel.create_view(&Default::default()),
            began: Instant::now(),
            window,
            instance,
            surface,
            config,
            device,
            queue,
        };
        shown.resize(shown.window.inner_size());
        Ok(shown)
    }

    /// A minimised window has no size: the surface stays as it was, and nothing is drawn.
    fn resize(&mut self, size: PhysicalSize<u32>) {
        if size.width > 0 && size.height > 0 {
            (self.config.width, self.config.height) = (size.width, size.height);
            self.surface.configure(&self.device, &self.config);
            self.window.request_redraw();
        }
    }

    fn draw(&mut self, stopped: Option<f64>) -> Result<(), Failed> {
        let size = self.window.inner_size();
        if size.width == 0 || size.height == 0 {
            return Ok(()); // `Resized` goes on
        }
        let image = match self.surface.get_current_texture() {
            Current::Success(image) | Current::Suboptimal(image) => image,
            Current::Occluded => return Ok(()), // `Occluded(false)` goes on
            Current::Validation => return Err("the surface is not valid".into()),
            why @ (Current::Timeout | Current::Outdated | Current::Lost) => {
                if matches!(why, Current::Lost) {
                    self.surface = self.instance.create_surface(Arc::clone(&self.window))?;
                }
                self.resize(size);
                return Ok(());
            }
        };
        let seconds = stopped.unwrap_or_else(|| self.began.elapsed().as_secs_f64());
        let moment = Moment::new(seconds, [image.texture.width(), image.texture.height()]);
        let mut encoder = self.device.create_command_encoder(&Default::default());
        let visibility = match &mut self.shadows {
            Some(shadows) => shadows.encode(&mut encoder, &moment)?,
            None => self.unshaded.clone(),
        };
        let (device, target) = (&self.device, &image.texture);
        self.renderer
            .draw(device, &mut encoder, target, &moment, &visibility);
        self.queue.submit([encoder.finish()]);
        self.window.pre_present_notify();
        self.queue.present(image);
        self.window.request_redraw();
        Ok(())
    }
}

impl ApplicationHandler for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.shown.is_none() {
            match Shown::new(events, self) {
                Ok(shown) => self.shown = Some(shown),
                Err(error) => self.failed = Some(error),
            }
        }
        if self.failed.is_some() {
            events.exit();
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(shown) = &mut self.shown else {
            return;
        };
        match event {
            WindowEvent::CloseRequested => events.exit(),
            WindowEvent::KeyboardInput { event, .. }
                if event.logical_key == Key::Named(NamedKey::Escape) =>
            {
                events.exit();
            }
            WindowEvent::Resized(size) => shown.resize(size),
            WindowEvent::Occluded(false) => shown.window.request_redraw(),
            WindowEvent::RedrawRequested => {
                self.failed = shown.draw(self.stopped).err();
                if self.failed.is_some() {
                    events.exit();
                }
            }
            _ => {}
        }
    }
}
