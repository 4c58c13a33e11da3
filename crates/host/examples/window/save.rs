//! The same frames without a window: the last one becomes a file.

use crate::{Failed, Options, Program, renderer};
use skiagraph_host::wgpu;

pub fn run(options: &Options, path: &str) -> Result<(), Failed> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        flags: crate::window::FLAGS,
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let adapter = pollster::block_on(instance.request_adapter(&Default::default()))?;
    let format = wgpu::TextureFormat::Rgba8UnormSrgb;
    let mut program = Program::new(&adapter, format, options)?;
    program.is_ready(true)?;
    let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
    let target = renderer::texture(&program.device, options.size, format, usage);
    for frame in 0..options.frames.unwrap_or(1) {
        program.frame(&target, f64::from(frame) / 30.0)?;
    }
    let [width, height] = options.size;
    let picture = read(&program, &target)?;
    image::save_buffer(path, &picture, width, height, image::ColorType::Rgba8)?;
    Ok(())
}

/// Waits for a texture of four bytes per texel and returns them, row by row.
fn read(program: &Program, texture: &wgpu::Texture) -> Result<Vec<u8>, Failed> {
    let row = 4 * texture.width();
    let padded = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = program.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(padded) * u64::from(texture.height()),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let to = wgpu::TexelCopyBufferInfo {
        buffer: &buffer,
        layout: wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(padded),
            rows_per_image: None,
        },
    };
    let mut encoder = program.device.create_command_encoder(&Default::default());
    encoder.copy_texture_to_buffer(texture.as_image_copy(), to, texture.size());
    program.queue.submit([encoder.finish()]);
    let (sender, receiver) = std::sync::mpsc::channel();
    buffer.map_async(wgpu::MapMode::Read, .., move |done| drop(sender.send(done)));
    program.device.poll(wgpu::PollType::wait_indefinitely())?;
    receiver.recv()??;
    let rows = buffer.get_mapped_range(..)?;
    let rows = rows.chunks_exact(padded as usize);
    Ok(rows
        .flat_map(|texels| &texels[..row as usize])
        .copied()
        .collect())
}
