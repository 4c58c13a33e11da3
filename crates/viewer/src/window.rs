//! The window: passes winit's events to egui, and egui's shapes to the painter.

use crate::start::{Opening, start};
use crate::state::Viewer;
use crate::ui;
use egui::ViewportId;
use egui_wgpu::winit::Painter;
use egui_wgpu::{RendererOptions, WgpuConfiguration, WgpuSetup, WgpuSetupCreateNew};
use skiagraph_compare::error::CompareError;
use skiagraph_compare::files::watch::Watch;
use skiagraph_compare::sink::Sink;
use skiagraph_graph::caught;
use std::sync::Arc;
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::dpi::LogicalSize;
use winit::event::{StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::window::{Window, WindowId};

/// Something has happened: draw again, after so long.
#[derive(Debug)]
struct Wake(Duration);

/// Opens the viewer's window and blocks until the user closes it. `sink` receives remarks and
/// warnings while the methods are read.
///
/// # Errors
/// If there is no display or no usable GPU, a method or param is unknown, or there are more than
/// two methods.
pub fn open(opening: Opening, sink: &dyn Sink) -> Result<(), CompareError> {
    let events = event_loop()?;
    let proxy = events.create_proxy();
    let context = egui::Context::default();
    context.set_request_repaint_callback(move |info| {
        // A failed send is passed over: the loop is over then.
        let _ = proxy.send_event(Wake(info.delay));
    });
    let woken = context.clone();
    let (viewer, watch) = start(opening, sink, Arc::new(move || woken.request_repaint()))?;
    let mut setup = WgpuSetupCreateNew::from_display_handle(events.owned_display_handle());
    // Mesa 22.3 crashes on debug labels, which wgpu hands on in debug builds.
    setup.instance_descriptor.flags = wgpu::InstanceFlags::empty().with_env();
    let painter = Painter::new(
        context.clone(),
        WgpuConfiguration {
            wgpu_setup: WgpuSetup::CreateNew(setup),
            ..WgpuConfiguration::default()
        },
        false,
        RendererOptions::default(),
    );
    let mut app = App {
        context,
        painter: pollster::block_on(painter),
        window: None,
        viewer,
        surface: ui::Surface::default(),
        _watch: watch,
        failed: None,
    };
    let ran = events.run_app(&mut app);
    if let Some(error) = app.failed {
        return Err(error);
    }
    ran.map_err(|error| no_display(&error.to_string()))
}

fn no_display(why: &str) -> CompareError {
    // winit says first where in its own files it happened.
    let behind_place = why
        .split_once(".rs:")
        .and_then(|(_, rest)| rest.split_once(": "));
    let why = behind_place
        .map_or(why, |(_, reason)| reason)
        .trim_end_matches('.');
    CompareError::NoGpu(format!(
        "no window: {why}\n  `view` needs a display: on Linux $WAYLAND_DISPLAY or $DISPLAY, and \
         for X11 the libraries libX11, libXcursor, libXi and libxkbcommon-x11 (`apt-get install \
         libx11-6 libxcursor1 libxi6 libxkbcommon-x11-0`); without one, `xvfb-run skiagraph view` \
         runs, and `skiagraph run --save` and `compare` write pictures"
    ))
}

/// winit panics where a library of X11 is missing.
fn event_loop() -> Result<EventLoop<Wake>, CompareError> {
    match caught(|| EventLoop::<Wake>::with_user_event().build()) {
        Ok(made) => made.map_err(|error| no_display(&error.to_string())),
        Err(panicked) => Err(no_display(&panicked.message)),
    }
}

struct App {
    context: egui::Context,
    painter: Painter,
    window: Option<(Arc<Window>, egui_winit::State)>,
    viewer: Viewer,
    surface: ui::Surface,
    _watch: Option<Watch>,
    failed: Option<CompareError>,
}

impl App {
    fn make_window(&mut self, events: &ActiveEventLoop) -> Result<(), CompareError> {
        let attributes = Window::default_attributes()
            .with_title("Skiagraph")
            .with_inner_size(LogicalSize::new(1280, 800));
        let window = events.create_window(attributes);
        let window = Arc::new(window.map_err(|error| no_display(&error.to_string()))?);
        let set = self
            .painter
            .set_window(ViewportId::ROOT, Some(window.clone()));
        pollster::block_on(set)
            .map_err(|error| CompareError::NoGpu(format!("no GPU draws into a window: {error}")))?;
        let state = egui_winit::State::new(
            self.context.clone(),
            ViewportId::ROOT,
            &*window,
            Some(window.scale_factor() as f32),
            window.theme(),
            self.painter.max_texture_side(),
        );
        window.request_redraw();
        self.window = Some((window, state));
        Ok(())
    }

    fn draw(&mut self, events: &ActiveEventLoop) {
        let Some((window, state)) = &mut self.window else {
            return;
        };
        let input = state.take_egui_input(window);
        let (viewer, surface) = (&mut self.viewer, &mut self.surface);
        let mut output = self
            .context
            .run_ui(input, |ui| ui::show(ui, viewer, surface));
        state.handle_platform_output(window, output.platform_output);
        let shapes = self
            .context
            .tessellate(output.shapes, output.pixels_per_point);
        self.painter.paint_and_update_textures(
            ViewportId::ROOT,
            output.pixels_per_point,
            [0.0, 0.0, 0.0, 1.0],
            &shapes,
            &mut output.textures_delta,
            Vec::new(),
            window,
        );
        let root = output.viewport_output.get(&ViewportId::ROOT);
        match root.map_or(Duration::MAX, |root| root.repaint_delay) {
            Duration::ZERO => window.request_redraw(),
            delay => wait(events, delay),
        }
    }
}

/// Draws again after so long at the latest.
fn wait(events: &ActiveEventLoop, delay: Duration) {
    let at = Instant::now().checked_add(delay);
    events.set_control_flow(at.map_or(ControlFlow::Wait, ControlFlow::WaitUntil));
}

impl ApplicationHandler<Wake> for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.window.is_none()
            && let Err(error) = self.make_window(events)
        {
            self.failed = Some(error);
            events.exit();
        }
    }

    fn new_events(&mut self, _: &ActiveEventLoop, cause: StartCause) {
        if let (StartCause::ResumeTimeReached { .. }, Some((window, _))) = (cause, &self.window) {
            window.request_redraw();
        }
    }

    fn user_event(&mut self, events: &ActiveEventLoop, Wake(delay): Wake) {
        match (&self.window, delay) {
            (Some((window, _)), Duration::ZERO) => window.request_redraw(),
            _ => wait(events, delay),
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some((window, state)) = &mut self.window else {
            return;
        };
        let response = state.on_window_event(window, &event);
        match event {
            WindowEvent::CloseRequested => events.exit(),
            WindowEvent::RedrawRequested => return self.draw(events),
            WindowEvent::Resized(size) => {
                if let (Some(width), Some(height)) =
                    (size.width.try_into().ok(), size.height.try_into().ok())
                {
                    self.painter
                        .on_window_resized(ViewportId::ROOT, width, height);
                }
            }
            _ => {}
        }
        if response.repaint {
            window.request_redraw();
        }
    }
}
