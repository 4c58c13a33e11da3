#![allow(dead_code)]
#[path = "../examples/headless/mod.rs"]
mod headless;
use bevy::{
    camera::{RenderTarget, visibility::{RenderLayers, VisibilityRange}},
    core_pipeline::prepass::*, pbr::*,
    asset::RenderAssetUsages,
    prelude::*,
};
use bevy_skiagraph::{SkiagraphPlugin, SkiagraphShadows};
const SIZE: UVec2 = UVec2::new(160, 96);
fn named(world: &mut World, name: &str) -> Entity {
    let mut names = world.query::<(Entity, &Name)>();
    names.iter(world).find(|(_, own)| own.as_str() == name).unwrap().0
}
fn add<A: Asset>(world: &mut World, asset: impl Into<A>) -> Handle<A> { world.resource_mut::<Assets<A>>().add(asset) }
fn spawn(world: &mut World, name: &'static str, mesh: impl Into<Mesh>, at: [f32; 3]) -> Entity {
    let mesh = add::<Mesh>(world, mesh);
    let material = add::<StandardMaterial>(world, StandardMaterial { perceptual_roughness: 1.0, reflectance: 0.0, ..default() });
    world.spawn((Name::new(name), Mesh3d(mesh), MeshMaterial3d(material), Transform::from_translation(at.into()))).id()
}
fn base(world: &mut World, ours: bool) {
    world.insert_resource(GlobalAmbientLight::NONE);
    spawn(world, "floor", Plane3d::default().mesh().size(9.0, 9.0), [0.0; 3]);
    let sun = Transform::default().looking_to(Vec3::new(0.7, -1.0, -0.4), Vec3::Y);
    let light = DirectionalLight { illuminance: 3000.0, shadow_maps_enabled: true, ..default() };
    let e = world.spawn((Name::new("sun"), light, sun)).id();
    if ours { world.entity_mut(e).insert(SkiagraphShadows::default()); }
    let camera = headless::camera(&mut world.resource_mut::<Assets<Image>>(), SIZE);
    let place = Transform::from_xyz(1.0, 2.6, 4.5).looking_at(Vec3::Y * 0.4, Vec3::Y);
    world.spawn((Name::new("camera"), camera, place));
}
fn the_box(world: &mut World) -> Entity { spawn(world, "box", Cuboid::new(0.6, 1.4, 0.6), [-0.9, 0.7, 0.0]) }
fn new(ours: bool) -> App {
    let mut app = App::new();
    app.add_plugins(headless::without_window());
    if ours { app.add_plugins(SkiagraphPlugin::default()); }
    app.finish(); app.cleanup();
    base(app.world_mut(), ours);
    app
}
fn run(app: &mut App) { for _ in 0..8 { headless::update(app).unwrap(); } }
fn look_at(app: &mut App, name: &str) -> Vec<u8> {
    run(app);
    let camera = named(app.world_mut(), name);
    headless::picture(app, camera).unwrap().data.unwrap()
}
fn look(app: &mut App) -> Vec<u8> { look_at(app, "camera") }
fn diff(one: &[u8], other: &[u8]) -> usize {
    let n = one.chunks_exact(4).zip(other.chunks_exact(4)).filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 2)).count();
    1000 * n / (one.len() / 4)
}
fn mean(one: &[u8]) -> f64 { one.chunks_exact(4).map(|p| p[1] as f64).sum::<f64>() / (one.len() / 4) as f64 }
fn rss() -> usize {
    let s = std::fs::read_to_string("/proc/self/statm").unwrap();
    s.split(' ').nth(1).unwrap().parse::<usize>().unwrap() * 4 / 1024
}

#[test] fn a_msaa() {
    let msaa = |w: &mut World| { let c = named(w, "camera"); w.entity_mut(c).insert(Msaa::Sample4); };
    let mut own = new(false); the_box(own.world_mut()); msaa(own.world_mut());
    let own = look(&mut own);
    let mut t = new(true); the_box(t.world_mut()); look(&mut t); msaa(t.world_mut());
    let seen = look(&mut t);
    println!("T1 toggled at run time: diff to Bevy {} of 1000; mean {} vs {}", diff(&seen, &own), mean(&seen), mean(&own));
    let mut t = new(true); the_box(t.world_mut()); msaa(t.world_mut());
    let c = named(t.world_mut(), "camera"); t.world_mut().entity_mut(c).insert((DepthPrepass, NormalPrepass));
    let seen = look(&mut t);
    println!("T2 msaa with prepasses: diff {}; mean {} vs {}", diff(&seen, &own), mean(&seen), mean(&own));
}
#[test] fn b_two_cameras_spot() {
    let mut pics = vec![];
    for ours in [false, true] {
        let mut app = new(ours); let w = app.world_mut(); the_box(w);
        let s = named(w, "sun"); w.despawn(s);
        let lamp = Transform::from_xyz(1.5, 3.0, 2.0).looking_at(Vec3::ZERO, Vec3::Y);
        let e = w.spawn((Name::new("lamp"), SpotLight { intensity: 900_000.0, outer_angle: 0.6, shadow_maps_enabled: true, ..default() }, lamp)).id();
        if ours { w.entity_mut(e).insert(SkiagraphShadows::default()); }
        let camera = headless::camera(&mut w.resource_mut::<Assets<Image>>(), SIZE);
        let place = Transform::from_xyz(-1.0, 2.6, 4.5).looking_at(Vec3::Y * 0.4, Vec3::Y);
        let c = w.spawn((Name::new("second"), camera, place)).id();
        w.entity_mut(c).insert((Msaa::Sample4, Camera { order: 5, ..default() }));
        pics.push(look_at(&mut app, "second"));
    }
    println!("T3 second camera msaa, spot: diff {} ; mean {} vs {}", diff(&pics[0], &pics[1]), mean(&pics[1]), mean(&pics[0]));
}
#[test] fn c_ghost() {
    let mut empty = new(true); spawn(empty.world_mut(), "far", Cuboid::new(0.1, 0.1, 0.1), [0.0, -5.0, 0.0]);
    let empty = look(&mut empty);
    let mut app = new(true); spawn(app.world_mut(), "far", Cuboid::new(0.1, 0.1, 0.1), [0.0, -5.0, 0.0]);
    let b = the_box(app.world_mut()); let with = look(&mut app);
    let pending: Handle<Mesh> = app.world().resource::<Assets<Mesh>>().reserve_handle();
    app.world_mut().entity_mut(b).insert(Mesh3d(pending.clone()));
    run(&mut app);
    app.world_mut().despawn(b);
    let seen = look(&mut app);
    println!("T4 ghost: with box vs empty {}; after despawn vs empty {}", diff(&with, &empty), diff(&seen, &empty));
}
#[test] fn d_render_world() {
    let mk = || { let mut m: Mesh = Cuboid::new(0.6, 1.4, 0.6).into(); m.asset_usage = RenderAssetUsages::RENDER_WORLD; m };
    let mut app = new(true); the_box(app.world_mut()); let normal = look(&mut app);
    let mut app = new(true); spawn(app.world_mut(), "box", mk(), [-0.9, 0.7, 0.0]); let same = look(&mut app);
    println!("T5a render-world mesh, spawned with its entity: diff to a usual one {}", diff(&same, &normal));
    let mut app = new(true); let h = add::<Mesh>(app.world_mut(), mk()); run(&mut app);
    let m = add::<StandardMaterial>(app.world_mut(), StandardMaterial { perceptual_roughness: 1.0, reflectance: 0.0, ..default() });
    app.world_mut().spawn((Mesh3d(h), MeshMaterial3d(m), Transform::from_xyz(-0.9, 0.7, 0.0)));
    let later = look(&mut app);
    println!("T5b spawned later: diff {}", diff(&later, &normal));
}
#[test] fn e_leak() {
    let mut app = new(true); let b = the_box(app.world_mut());
    run(&mut app);
    let mut last = rss();
    for frame in 0..161 {
        let m = add::<Mesh>(app.world_mut(), Sphere::new(0.5 + frame as f32 * 1e-4).mesh().ico(30).unwrap());
        app.world_mut().entity_mut(b).insert(Mesh3d(m));
        headless::update(&mut app).unwrap();
        if frame % 40 == 0 { println!("T6 frame {frame}: rss {} MiB (+{})", rss(), rss() as i64 - last as i64); last = rss(); }
    }
    // somebody else leaves
    let o = spawn(app.world_mut(), "o", Cuboid::new(0.1,0.1,0.1), [0.0,-5.0,0.0]); run(&mut app); app.world_mut().despawn(o); run(&mut app);
    println!("T6 after another caster left: rss {}", rss());
}
#[test] fn f_casters() {
    for ours in [false, true] {
        let mut e = new(ours); spawn(e.world_mut(), "far", Cuboid::new(0.1, 0.1, 0.1), [0.0, -5.0, 0.0]); let empty = look(&mut e);
        let mut a = new(ours); spawn(a.world_mut(), "far", Cuboid::new(0.1, 0.1, 0.1), [0.0, -5.0, 0.0]);
        let m = add::<Mesh>(a.world_mut(), Cuboid::new(0.6, 1.4, 0.6));
        a.world_mut().spawn((Mesh3d(m), Transform::from_xyz(-0.9, 0.7, 0.0)));
        println!("T7 ours {ours}: mesh without a material changes {}", diff(&look(&mut a), &empty));
        let mut a = new(ours); let b = the_box(a.world_mut());
        a.world_mut().entity_mut(b).insert(VisibilityRange::abrupt(1000.0, 2000.0));
        println!("T8 ours {ours}: mesh out of its VisibilityRange changes {}", diff(&look(&mut a), &empty));
        let mut a = new(ours); let b = the_box(a.world_mut());
        a.world_mut().entity_mut(b).insert(RenderLayers::layer(3));
        println!("T13 ours {ours}: mesh on another layer changes {}", diff(&look(&mut a), &empty));
    }
}
#[test] fn g_transmission() {
    for ours in [false, true] {
        let mut a = new(ours); let w = a.world_mut();
        let s = named(w, "sun");
        // light from behind the sheet, towards the camera
        w.entity_mut(s).insert(Transform::default().looking_to(Vec3::new(0.0, -0.3, 1.0), Vec3::Y));
        let m = add::<Mesh>(w, Cuboid::new(2.0, 2.0, 0.02));
        let mat = add::<StandardMaterial>(w, StandardMaterial { diffuse_transmission: 0.9, thickness: 0.05, ..default() });
        w.spawn((Mesh3d(m), MeshMaterial3d(mat), Transform::from_xyz(0.0, 1.0, 0.0)));
        let p = look(&mut a);
        let i = ((40 * SIZE.x + 65) * 4) as usize;
        println!("T9 ours {ours}: translucent sheet lit from behind, pixel {:?}, mean {}", &p[i..i + 4], mean(&p));
    }
}
#[test] fn h_ortho_and_deferred() {
    // a glass pane over a shadowed floor: README says it counts as lit
    for ortho in [false, true] {
        let mut a = new(true); let w = a.world_mut(); 
        spawn(w, "roof", Plane3d::default().mesh().size(9.0, 9.0), [-2.0, 3.5, 1.0]);
        let c = named(w, "camera");
        w.entity_mut(c).insert(Transform::from_xyz(0.0, 1.5, 4.0).looking_at(Vec3::ZERO, Vec3::Y));
        if ortho { w.entity_mut(c).insert(Projection::from(OrthographicProjection { scale: 0.02, ..OrthographicProjection::default_3d() })); }
        let dark = look(&mut a);
        let w = a.world_mut();
        let m = add::<Mesh>(w, Plane3d::default().mesh().size(1.5, 1.5));
        let mat = add::<StandardMaterial>(w, StandardMaterial { base_color: Color::srgba(1.0, 1.0, 1.0, 0.5), alpha_mode: AlphaMode::Blend, ..default() });
        w.spawn((Mesh3d(m), MeshMaterial3d(mat), Transform::from_xyz(0.0, 1.0, 0.0), bevy::light::NotShadowCaster));
        let p = look(&mut a);
        println!("T10 ortho {ortho}: pane in a shadow changes {} of 1000 pixels", diff(&p, &dark));
    }
    let mut f = new(true); the_box(f.world_mut()); let fwd = look(&mut f);
    let mut d = new(true); the_box(d.world_mut());
    d.world_mut().resource_mut::<DefaultOpaqueRendererMethod>().set_to_deferred();
    let c = named(d.world_mut(), "camera"); d.world_mut().entity_mut(c).insert(DeferredPrepass);
    println!("T11 deferred vs forward {}", diff(&look(&mut d), &fwd));
}
#[test] fn i_toggle() {
    let mut a = new(true); the_box(a.world_mut()); run(&mut a);
    let t = std::time::Instant::now(); for _ in 0..8 { headless::update(&mut a).unwrap(); } println!("T15 steady 8 frames {:?}", t.elapsed());
    let t = std::time::Instant::now();
    for n in 0..8 { let s = named(a.world_mut(), "sun"); a.world_mut().get_mut::<DirectionalLight>(s).unwrap().shadow_maps_enabled = n % 2 == 1; headless::update(&mut a).unwrap(); }
    println!("T15 toggled 8 frames {:?}", t.elapsed());
    println!("T15 shadow map size now: n/a");
}
#[test] fn j_zero_bias() {
    let mut a = new(true); the_box(a.world_mut()); let p = look(&mut a);
    let mut a = new(true); the_box(a.world_mut()); let s = named(a.world_mut(), "sun"); a.world_mut().get_mut::<DirectionalLight>(s).unwrap().shadow_depth_bias = 0.0;
    println!("T16 zero bias diff {}", diff(&look(&mut a), &p));
}
