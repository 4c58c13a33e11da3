//! Writes the mesh of `scenes/foliage.ron`: `cargo run -p skiagraph-scene --example foliage FILE`.

mod plant;

fn main() -> std::io::Result<()> {
    let file = std::env::args().nth(1).unwrap_or("foliage.glb".to_owned());
    std::fs::write(&file, plant::plant())?;
    println!("wrote {file}");
    Ok(())
}
