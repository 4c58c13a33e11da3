#[path = "../tests/common/mod.rs"]
mod common;
use skiagraph_reference::*;
use std::time::Instant;

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let mesh = common::load(std::path::Path::new(&args[1]));
    println!(
        "{} triangles {} positions",
        mesh.triangles.len(),
        mesh.positions.len()
    );
    let t = Instant::now();
    let oracle = Oracle::new(&mesh);
    println!("build {:?}", t.elapsed());
    for size in args[2..]
        .iter()
        .map(|s| s.split_once('x').unwrap())
        .map(|(w, h)| [w.parse().unwrap(), h.parse().unwrap()])
    {
        let camera = common::view().camera(size);
        let t = Instant::now();
        let primitives = oracle.primary(&camera, Progress::default()).unwrap();
        println!("{size:?} primary {:?}", t.elapsed());
        for mode in [OracleMode::Offset(0.03), OracleMode::Exact] {
            let t = Instant::now();
            let r = oracle
                .shade(
                    &camera,
                    &common::light(),
                    &primitives,
                    mode,
                    Progress::default(),
                )
                .unwrap();
            let s = Statistics::judged(&r.visibility(), &r.status(), &r).unwrap();
            println!(
                "{mode} {:?} {:?} band {} = {:.4} %",
                t.elapsed(),
                s.pixels,
                s.band,
                100.0 * s.band_share()
            );
        }
    }
}
