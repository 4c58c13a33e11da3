//! A program with a preset's shadows, drawn as letters: `cargo run -p skiagraph-passes --example
//! preset`. With a window, its device and its frames would take the place of those in `main`.

use glam::{DAffine3, DVec3};
use skiagraph_scene::{Indexed, Mesh, View};
use std::{error::Error, sync::mpsc};

mod shadows;
use shadows::Shadows;

/// Width and height; a row of the picture is copied in 256 bytes.
const SIZE: [u32; 2] = [64, 24];

fn main() -> Result<(), Box<dyn Error>> {
    let gpu = skiagraph_gpu::device::open(None)?;
    let ground = quad(10.0)?;
    let lid = quad(1.0)?;
    let mut shadows = Shadows::new((&gpu.device, &gpu.queue), SIZE, &[&ground, &lid, &lid])?;
    for frame in 0..3 {
        let time = f64::from(frame);
        let view = View {
            name: String::new(),
            eye: DVec3::new(time - 1.0, 9.0, 9.0),
            direction: DVec3::new(0.0, -1.0, -1.0),
            fov_y_degrees: 40.0,
            far: 100.0,
            ..View::default()
        };
        let places = [
            DAffine3::IDENTITY,
            DAffine3::from_translation(DVec3::new(-2.0, 1.0 + time, 0.0)),
            DAffine3::from_rotation_z(0.4 * time)
                * DAffine3::from_translation(DVec3::new(2.0, 1.0, 0.0)),
        ];
        let light = DVec3::new(0.3 * time, -1.0, 0.2);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let seen = shadows.frame(&mut encoder, &view.camera(SIZE), light, &places)?;
        show(&gpu.device, &gpu.queue, encoder, seen.texture())?;
    }
    Ok(())
}

/// A square in the plane y = 0, of two triangles.
fn quad(half: f32) -> Result<Mesh, Box<dyn Error>> {
    let corner = |x: f32, z: f32| [x * half, 0.0, z * half];
    Ok(Indexed {
        positions: &[
            corner(-1.0, -1.0),
            corner(-1.0, 1.0),
            corner(1.0, 1.0),
            corner(1.0, -1.0),
        ],
        normals: &[],
        indices: &[0, 1, 2, 0, 2, 3],
    }
    .mesh()?)
}

/// Prints a picture of zeros and ones.
fn show(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    mut encoder: wgpu::CommandEncoder,
    picture: &wgpu::Texture,
) -> Result<(), Box<dyn Error>> {
    let [width, height] = SIZE;
    let row = 4 * width;
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(row * height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let to = wgpu::TexelCopyBufferInfo {
        buffer: &buffer,
        layout: wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(row),
            rows_per_image: None,
        },
    };
    encoder.copy_texture_to_buffer(picture.as_image_copy(), to, picture.size());
    queue.submit([encoder.finish()]);
    let (sender, receiver) = mpsc::channel();
    buffer.map_async(wgpu::MapMode::Read, .., move |done| drop(sender.send(done)));
    device.poll(wgpu::PollType::wait_indefinitely())?;
    receiver.recv()??;
    for row in buffer.get_mapped_range(..)?.chunks_exact(row as usize) {
        let letters = row
            .chunks_exact(4)
            .map(|texel| if texel[0] == 0 { '#' } else { '.' });
        println!("{}", letters.collect::<String>());
    }
    println!();
    Ok(())
}
