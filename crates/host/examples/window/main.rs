//! A window with shadows, to start from: `cargo run -p skiagraph-host --example window`.
//!
//! `scene.rs` and `renderer.rs` stand for what a program has anyway. `shadows.rs` is all that it
//! adds, and `Program::frame` below where it calls it. Without a window,
//! `--frames 90 --save OUT.png` writes the last of so many pictures, a 30th of a second apart.

use skiagraph_host::wgpu;
use std::{collections::VecDeque, error::Error, process::ExitCode, thread::JoinHandle};

mod renderer;
mod save;
mod scene;
mod shadows;
mod window;

use renderer::Renderer;
use scene::Moment;
use shadows::Shadows;

type Failed = Box<dyn Error + Send + Sync>;

const USAGE: &str = "usage: window [--preset NAME, or `none`] [--size WIDTHxHEIGHT] [--frames N] \
                     [--save FILE.png]";

struct Options {
    preset: String,
    size: [u32; 2],
    /// Number of frames after which the program ends.
    frames: Option<u32>,
    /// File of the last picture; no window is opened then.
    save: Option<String>,
}

fn main() -> ExitCode {
    let run = |options: Options| match &options.save {
        Some(path) => save::run(&options, path),
        None => window::run(options),
    };
    match options().and_then(run) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn options() -> Result<Options, Failed> {
    let mut options = Options {
        preset: "light_buffer".into(),
        size: [960, 600],
        frames: None,
        save: None,
    };
    let mut arguments = std::env::args().skip(1);
    while let Some(name) = arguments.next() {
        let value = arguments.next().ok_or(USAGE)?;
        match name.as_str() {
            "--preset" => options.preset = value,
            "--size" => {
                let (width, height) = value.split_once('x').ok_or(USAGE)?;
                options.size = [width.parse()?, height.parse()?];
            }
            "--frames" => options.frames = Some(value.parse()?),
            "--save" => options.save = Some(value),
            _ => return Err(USAGE.into()),
        }
    }
    if options.size.contains(&0) || options.frames == Some(0) {
        return Err("a picture has at least one pixel, and a run one frame".into());
    }
    Ok(options)
}

/// The device with all that draws on it.
struct Program {
    device: wgpu::Device,
    queue: wgpu::Queue,
    renderer: Renderer,
    /// Visibility of a sun that nothing hides: one texel of 1.
    unshaded: wgpu::TextureView,
    /// The thread that makes the shadows, until they are there.
    starting: Option<JoinHandle<Result<Shadows, Failed>>>,
    shadows: Option<Shadows>,
    in_flight: VecDeque<wgpu::SubmissionIndex>,
}

impl Program {
    /// Opens a device for textures of a format, and starts to make the shadows of a preset.
    fn new(
        adapter: &wgpu::Adapter,
        format: wgpu::TextureFormat,
        options: &Options,
    ) -> Result<Self, Failed> {
        let (device, queue) =
            pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
                required_limits: adapter.limits(),
                ..Default::default()
            }))?;
        let models = scene::models();
        let renderer = Renderer::new(&device, format, &models);
        let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
        let texel = renderer::texture(&device, [1, 1], wgpu::TextureFormat::R8Unorm, usage);
        queue.write_texture(
            texel.as_image_copy(),
            &[255],
            Default::default(),
            texel.size(),
        );

        let pipelines = skiagraph_host::Pipelines::new(&device);
        let (on, preset, size) = (queue.clone(), options.preset.clone(), options.size);
        let start = move || {
            let first = (&Moment::new(0.0, size), size);
            Shadows::new((&pipelines, &on), &preset, &models, first)
        };
        Ok(Self {
            renderer,
            unshaded: texel.create_view(&Default::default()),
            starting: (options.preset != "none").then(|| std::thread::spawn(start)),
            shadows: None,
            in_flight: VecDeque::new(),
            device,
            queue,
        })
    }

    /// True if no shadows are being made; a finished thread hands them over, `wait` waits for it.
    fn is_ready(&mut self, wait: bool) -> Result<bool, Failed> {
        if let Some(done) = self.starting.take_if(|it| wait || it.is_finished()) {
            let made = done
                .join()
                .map_err(|_| "the thread of the shadows panicked")?;
            self.shadows = Some(made?);
        }
        Ok(self.starting.is_none())
    }

    /// Draws and submits a frame. Waits while two are in flight, so that the CPU is not far ahead.
    fn frame(&mut self, target: &wgpu::Texture, seconds: f64) -> Result<(), Failed> {
        if self.in_flight.len() == 2 {
            self.device.poll(wgpu::PollType::Wait {
                submission_index: self.in_flight.pop_front(),
                timeout: None,
            })?;
        }
        let size = [target.width(), target.height()];
        let moment = Moment::new(seconds, size);
        let mut encoder = self.device.create_command_encoder(&Default::default());
        let visibility = match &mut self.shadows {
            Some(shadows) => shadows.encode(&mut encoder, (&moment, size))?,
            None => self.unshaded.clone(),
        };
        let on = (&self.device, &self.queue);
        self.renderer
            .draw(on, &mut encoder, target, &moment, &visibility);
        self.in_flight
            .push_back(self.queue.submit([encoder.finish()]));
        Ok(())
    }
}
