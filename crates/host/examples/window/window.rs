//! The window: its surface, its events, its end.

use crate::{Failed, Options, Program};
use skiagraph_host::wgpu::{self, CurrentSurfaceTexture as Current};
use std::{sync::Arc, time::Instant};
use winit::{
    application::ApplicationHandler,
    dpi::PhysicalSize,
    event::WindowEvent,
    event_loop::{ActiveEventLoop, EventLoop, OwnedDisplayHandle},
    keyboard::{Key, NamedKey},
    window::{Window, WindowId},
};

/// Groups of `Indirect` passes are checked. Not a debug build's own flags: Mesa 22.3 crashes on
/// labels.
pub const FLAGS: wgpu::InstanceFlags = wgpu::InstanceFlags::VALIDATION_INDIRECT_CALL;

pub fn run(options: Options) -> Result<(), Failed> {
    let events = EventLoop::new()?;
    let mut app = App {
        options,
        display: events.owned_display_handle(),
        shown: None,
        failed: None,
    };
    events.run_app(&mut app)?;
    app.failed.map_or(Ok(()), Err)
}

struct App {
    options: Options,
    display: OwnedDisplayHandle,
    shown: Option<Shown>,
    failed: Option<Failed>,
}

/// A window that is there, with its surface.
struct Shown {
    window: Arc<Window>,
    instance: wgpu::Instance,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    program: Program,
    began: Instant,
    /// Number of frames with shadows.
    frames: u32,
}

impl Shown {
    fn new(events: &ActiveEventLoop, app: &App) -> Result<Self, Failed> {
        let [width, height] = app.options.size;
        let attributes = Window::default_attributes()
            .with_title("Skiagraph in a program of its own")
            .with_inner_size(PhysicalSize::new(width, height));
        let window = Arc::new(events.create_window(attributes)?);
        let display = Box::new(app.display.clone());
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            flags: FLAGS,
            ..wgpu::InstanceDescriptor::new_with_display_handle(display)
        });
        let surface = instance.create_surface(Arc::clone(&window))?;
        let asked = wgpu::RequestAdapterOptions {
            compatible_surface: Some(&surface),
            ..Default::default()
        };
        let adapter = pollster::block_on(instance.request_adapter(&asked))?;
        let config = surface.get_default_config(&adapter, width, height);
        let mut config = config.ok_or("the adapter cannot draw into the window")?;
        let formats = surface.get_capabilities(&adapter).formats;
        let srgb = formats.into_iter().find(wgpu::TextureFormat::is_srgb);
        config.format = srgb.unwrap_or(config.format);
        config.present_mode = wgpu::PresentMode::AutoVsync;
        let program = Program::new(&adapter, config.format, &app.options)?;
        let mut shown = Self {
            window,
            instance,
            surface,
            config,
            program,
            began: Instant::now(),
            frames: 0,
        };
        shown.resize(shown.window.inner_size());
        Ok(shown)
    }

    /// A minimised window has no size: the surface stays as it was, and nothing is drawn.
    fn resize(&mut self, size: PhysicalSize<u32>) {
        if size.width > 0 && size.height > 0 {
            (self.config.width, self.config.height) = (size.width, size.height);
            self.surface.configure(&self.program.device, &self.config);
            self.window.request_redraw();
        }
    }

    fn draw(&mut self) -> Result<(), Failed> {
        let size = self.window.inner_size();
        if size.width == 0 || size.height == 0 {
            return Ok(()); // `Resized` goes on
        }
        match self.surface.get_current_texture() {
            Current::Success(image) | Current::Suboptimal(image) => {
                self.frames += u32::from(self.program.is_ready(false)?);
                let seconds = self.began.elapsed().as_secs_f64();
                self.program.frame(&image.texture, seconds)?;
                self.window.pre_present_notify();
                self.program.queue.present(image);
            }
            Current::Outdated => self.resize(size),
            Current::Lost => {
                self.surface = self.instance.create_surface(Arc::clone(&self.window))?;
                self.resize(size);
            }
            Current::Occluded => return Ok(()), // `Occluded(false)` goes on
            Current::Timeout => {}
            Current::Validation => return Err("the surface is not valid".into()),
        }
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
                self.failed = shown.draw().err();
                let done = self.options.frames.is_some_and(|most| shown.frames >= most);
                if done || self.failed.is_some() {
                    events.exit();
                }
            }
            _ => {}
        }
    }
}
