//! Pictures of a world that changes, against those of worlds made as it is then.

#[path = "../examples/headless/mod.rs"]
mod headless;

use bevy::{
    camera::{
        RenderTarget, Viewport,
        visibility::{NoFrustumCulling, RenderLayers, VisibilityRange},
    },
    image::{ImageAddressMode, ImageSampler, ImageSamplerDescriptor},
    light::{NotShadowCaster, VolumetricLight},
    mesh::{
        VertexAttributeValues,
        skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    },
    prelude::*,
    render::render_resource::TextureFormat,
};
use bevy_skiagraph::{SkiagraphPlugin, SkiagraphShadows};

const SIZE: UVec2 = UVec2::new(160, 96);

/// A change of the world.
type Step = fn(&mut World);

fn named(world: &mut World, name: &str) -> Entity {
    let mut names = world.query::<(Entity, &Name)>();
    let mut named = names.iter(world).filter(|(_, own)| own.as_str() == name);
    named.next().expect("an entity of this name").0
}

fn add<A: Asset>(world: &mut World, asset: impl Into<A>) -> Handle<A> {
    world.resource_mut::<Assets<A>>().add(asset)
}

fn spawn(world: &mut World, name: &'static str, mesh: impl Into<Mesh>, at: [f32; 3]) {
    let mesh = add::<Mesh>(world, mesh);
    let material = StandardMaterial {
        perceptual_roughness: 1.0,
        reflectance: 0.0,
        ..default()
    };
    let material = add::<StandardMaterial>(world, material);
    let place = Transform::from_translation(at.into());
    world.spawn((
        Name::new(name),
        Mesh3d(mesh),
        MeshMaterial3d(material),
        place,
    ));
}

fn edit_positions(world: &mut World, name: &str, edit: fn(&mut [f32; 3])) {
    let entity = named(world, name);
    let id = world.get::<Mesh3d>(entity).expect("a mesh").0.id();
    let mut meshes = world.resource_mut::<Assets<Mesh>>();
    let mut mesh = meshes.get_mut(id).expect("the mesh is there");
    let positions = mesh.attribute_mut(Mesh::ATTRIBUTE_POSITION);
    if let Some(VertexAttributeValues::Float32x3(positions)) = positions {
        positions.iter_mut().for_each(edit);
    }
}

/// A floor, a box, a ball, a sun, and a camera.
fn set_up(world: &mut World) {
    world.insert_resource(GlobalAmbientLight::NONE);
    spawn(
        world,
        "floor",
        Plane3d::default().mesh().size(9.0, 9.0),
        [0.0; 3],
    );
    spawn(world, "box", Cuboid::new(0.6, 1.4, 0.6), [-0.9, 0.7, 0.0]);
    spawn(world, "ball", Sphere::new(0.5), [0.9, 0.6, 0.3]);
    let sun = Transform::default().looking_to(Vec3::new(0.7, -1.0, -0.4), Vec3::Y);
    let light = DirectionalLight {
        illuminance: 3000.0,
        ..default()
    };
    world.spawn((Name::new("sun"), light, SkiagraphShadows::default(), sun));
    let camera = headless::camera(&mut world.resource_mut::<Assets<Image>>(), SIZE);
    let place = Transform::from_xyz(1.0, 2.6, 4.5).looking_at(Vec3::Y * 0.4, Vec3::Y);
    world.spawn((Name::new("camera"), camera, place));
}

const STEPS: [(&str, Step); 16] = [
    ("moves", |world| {
        let ball = named(world, "ball");
        world
            .get_mut::<Transform>(ball)
            .expect("a place")
            .translation
            .y += 0.5;
    }),
    ("comes", |world| {
        spawn(world, "torus", Torus::new(0.2, 0.5), [0.2, 0.9, 1.2])
    }),
    ("sun turns", |world| {
        let sun = named(world, "sun");
        let turned = Transform::default().looking_to(Vec3::new(-0.5, -1.0, -0.6), Vec3::Y);
        *world.get_mut::<Transform>(sun).expect("a place") = turned;
    }),
    ("edited in place", |world| {
        edit_positions(world, "box", |position| position[0] *= 2.5)
    }),
    ("another mesh", |world| {
        let ball = named(world, "ball");
        let mesh = add::<Mesh>(world, Capsule3d::new(0.3, 0.8));
        world.entity_mut(ball).insert(Mesh3d(mesh));
    }),
    ("lamp comes", |world| {
        let lamp = Transform::from_xyz(1.5, 3.0, 2.0).looking_at(Vec3::ZERO, Vec3::Y);
        let light = SpotLight {
            intensity: 900_000.0,
            outer_angle: 0.6,
            ..default()
        };
        world.spawn((Name::new("lamp"), light, SkiagraphShadows::default(), lamp));
    }),
    ("hidden", |world| {
        let torus = named(world, "torus");
        world.entity_mut(torus).insert(Visibility::Hidden);
    }),
    ("shown, mirrored", |world| {
        let torus = named(world, "torus");
        let scale = Vec3::new(-1.0, 1.5, 1.0);
        world.entity_mut(torus).insert(Visibility::Inherited);
        world.get_mut::<Transform>(torus).expect("a place").scale = scale;
    }),
    ("with holes", |world| {
        let (ball, side) = (named(world, "box"), 8u32);
        let texel = |n: u32| {
            [
                255,
                255,
                255,
                if (n % side + n / side).is_multiple_of(2) {
                    255
                } else {
                    0
                },
            ]
        };
        let texels: Vec<u8> = (0..side * side).flat_map(texel).collect();
        let format = TextureFormat::Rgba8UnormSrgb;
        let mut image = Image::new_target_texture(side, side, format, None);
        image.data = Some(texels);
        image.sampler = ImageSampler::Descriptor(ImageSamplerDescriptor {
            address_mode_u: ImageAddressMode::Repeat,
            ..ImageSamplerDescriptor::nearest()
        });
        let image = add::<Image>(world, image);
        let id = world
            .get::<MeshMaterial3d<StandardMaterial>>(ball)
            .expect("a material")
            .0
            .id();
        let mut materials = world.resource_mut::<Assets<StandardMaterial>>();
        let mut material = materials.get_mut(id).expect("the material is there");
        material.base_color_texture = Some(image);
        material.alpha_mode = AlphaMode::Mask(0.5);
    }),
    ("skinned", |world| {
        let mut mesh: Mesh = Cuboid::new(0.2, 2.0, 0.2).into();
        let Some(VertexAttributeValues::Float32x3(positions)) =
            mesh.attribute(Mesh::ATTRIBUTE_POSITION)
        else {
            return;
        };
        let joints = positions
            .iter()
            .map(|position| [u16::from(position[1] > 0.0), 0, 0, 0]);
        let joints = VertexAttributeValues::Uint16x4(joints.collect());
        let weights = vec![[1.0f32, 0.0, 0.0, 0.0]; positions.len()];
        mesh.insert_attribute(Mesh::ATTRIBUTE_JOINT_INDEX, joints);
        mesh.insert_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, weights);
        spawn(world, "reed", mesh, [0.0; 3]);
        let place = Transform::from_xyz(-0.1, 1.0, 1.6);
        let foot = world.spawn((place, Visibility::default())).id();
        let tip = world
            .spawn((Name::new("tip"), Transform::default(), ChildOf(foot)))
            .id();
        let poses = add::<SkinnedMeshInverseBindposes>(world, vec![Mat4::IDENTITY; 2]);
        let skin = SkinnedMesh {
            inverse_bindposes: poses,
            joints: vec![foot, tip],
        };
        let reed = named(world, "reed");
        world.entity_mut(reed).insert((skin, NoFrustumCulling));
    }),
    ("bends", |world| {
        let tip = named(world, "tip");
        let turned = Quat::from_rotation_z(0.6);
        world.get_mut::<Transform>(tip).expect("a place").rotation = turned;
    }),
    ("no caster", |world| {
        let torus = named(world, "torus");
        world.entity_mut(torus).insert(NotShadowCaster);
    }),
    ("larger", |world| {
        let camera = headless::camera(&mut world.resource_mut::<Assets<Image>>(), SIZE * 3);
        let entity = named(world, "camera");
        world.entity_mut(entity).insert(camera);
    }),
    ("goes", |world| {
        let ball = named(world, "ball");
        world.despawn(ball);
    }),
    ("split screen", |world| {
        let first = named(world, "camera");
        let target = world.get::<RenderTarget>(first).expect("a target").clone();
        let half = |x: u32| {
            Some(Viewport {
                physical_position: UVec2::new(x, 0),
                physical_size: UVec2::new(SIZE.x * 3 / 2, SIZE.y * 3),
                ..default()
            })
        };
        world.get_mut::<Camera>(first).expect("a camera").viewport = half(0);
        let camera = Camera {
            order: 1,
            viewport: half(SIZE.x * 3 / 2),
            clear_color: ClearColorConfig::None,
            ..default()
        };
        let other = headless::camera(&mut world.resource_mut::<Assets<Image>>(), SIZE);
        let place = Transform::from_xyz(-3.0, 3.0, 3.0).looking_at(Vec3::ZERO, Vec3::Y);
        let projection = OrthographicProjection {
            scale: 0.02,
            ..OrthographicProjection::default_3d()
        };
        let mut entity = world.spawn((other, place, Projection::from(projection)));
        entity.insert((camera, target));
    }),
    ("other preset", |world| {
        let sun = named(world, "sun");
        world.entity_mut(sun).insert(SkiagraphShadows::new("rt"));
    }),
];

fn app(has_plugin: bool, steps: &[Step]) -> App {
    let mut app = App::new();
    app.add_plugins(headless::without_window());
    if has_plugin {
        app.add_plugins(SkiagraphPlugin::default());
    }
    app.finish();
    app.cleanup();
    for step in steps {
        step(app.world_mut());
    }
    app
}

fn look(app: &mut App) -> Vec<u8> {
    // Bevy finds the lights near each pixel on the GPU, some frames late.
    for _ in 0..8 {
        headless::update(app).expect("a frame");
    }
    let camera = named(app.world_mut(), "camera");
    let image = headless::picture(app, camera).expect("a picture");
    image.data.expect("texels")
}

/// Texels that differ between pictures by more than rounding, in thousandths.
fn difference(one: &[u8], other: &[u8]) -> usize {
    assert_eq!(one.len(), other.len());
    let texels = one.chunks_exact(4).zip(other.chunks_exact(4));
    let is_other = |(one, other): &(&[u8], &[u8])| {
        let mut channels = one.iter().zip(*other);
        channels.any(|(one, other)| one.abs_diff(*other) > 2)
    };
    1000 * texels.filter(is_other).count() / (one.len() / 4)
}

#[test]
fn a_world_that_changes_looks_as_if_it_had_always_been_so() {
    let mut steps: Vec<Step> = vec![set_up];
    let mut changing = app(true, &steps);
    let mut before = look(&mut changing);
    for (number, (name, step)) in STEPS.into_iter().enumerate() {
        step(changing.world_mut());
        steps.push(step);
        let seen = look(&mut changing);
        // A world of its own takes some seconds, for pipelines.
        if number % 3 == 0 {
            let fresh = look(&mut app(true, &steps));
            assert_eq!(difference(&seen, &fresh), 0, "{name}");
        }
        if seen.len() == before.len() && name != "other preset" {
            assert_ne!(difference(&seen, &before), 0, "{name} changes nothing");
        }
        before = seen;
    }
}

#[test]
fn lights_have_shadows_at_all() {
    let shadowed = look(&mut app(true, &[set_up]));
    let mut without = app(true, &[set_up]);
    let sun = named(without.world_mut(), "sun");
    let mut light = without.world_mut().get_mut::<DirectionalLight>(sun);
    light.as_mut().expect("a sun").shadow_maps_enabled = false;
    let lit = look(&mut without);
    assert!(difference(&shadowed, &lit) > 20);

    // A preset that cannot be run leaves the light without shadows.
    let unknown: Step = |world| {
        let sun = named(world, "sun");
        world
            .entity_mut(sun)
            .insert(SkiagraphShadows::new("nothing_like_it"));
    };
    assert_eq!(look(&mut app(true, &[set_up, unknown])), lit);
}

#[test]
fn bevys_own_maps_stay_where_presets_cannot_be() {
    let multisampled: Step = |world| {
        let camera = named(world, "camera");
        world.entity_mut(camera).insert(Msaa::Sample4);
    };
    let volumetric: Step = |world| {
        let sun = named(world, "sun");
        world.entity_mut(sun).insert(VolumetricLight);
    };
    let maps: Step = |world| {
        let sun = named(world, "sun");
        let mut light = world.get_mut::<DirectionalLight>(sun);
        light.as_mut().expect("a sun").shadow_maps_enabled = true;
    };
    for step in [multisampled, volumetric] {
        let own = look(&mut app(false, &[set_up, maps, step]));
        assert_eq!(difference(&look(&mut app(true, &[set_up, step])), &own), 0);
        // It may have been otherwise before, so that the camera has prepasses.
        let mut changing = app(true, &[set_up]);
        look(&mut changing);
        step(changing.world_mut());
        assert_eq!(difference(&look(&mut changing), &own), 0);
    }
}

#[test]
fn what_goes_before_its_mesh_is_loaded_leaves_no_shadow() {
    let alone: Step = |world| {
        let ball = named(world, "ball");
        world.despawn(ball);
    };
    let loading: Step = |world| {
        let ball = named(world, "ball");
        let mesh = world.resource::<Assets<Mesh>>().reserve_handle();
        world.entity_mut(ball).insert(Mesh3d(mesh));
    };
    let mut changing = app(true, &[set_up]);
    look(&mut changing);
    for step in [loading, alone] {
        step(changing.world_mut());
        look(&mut changing);
    }
    let seen = look(&mut changing);
    assert_eq!(
        difference(&seen, &look(&mut app(true, &[set_up, alone]))),
        0
    );
}

/// Levels of detail out of range, and what is on layers that the light does not shine on.
#[test]
fn what_bevy_draws_no_shadow_of_casts_none() {
    let without: Step = |world| {
        let ball = named(world, "ball");
        world.entity_mut(ball).insert(NotShadowCaster);
    };
    let far: Step = |world| {
        spawn(world, "level", Sphere::new(0.5), [0.9, 0.6, 0.3]);
        let level = named(world, "level");
        world
            .entity_mut(level)
            .insert(VisibilityRange::abrupt(50.0, 90.0));
    };
    let other_layer: Step = |world| {
        spawn(world, "arm", Cuboid::new(0.6, 1.4, 0.6), [0.0, 0.7, 1.0]);
        let arm = named(world, "arm");
        world.entity_mut(arm).insert(RenderLayers::layer(3));
    };
    let expected = look(&mut app(true, &[set_up, without]));
    let steps = [set_up, without, far, other_layer];
    assert_eq!(difference(&look(&mut app(true, &steps)), &expected), 0);
}

#[test]
fn a_light_of_another_layer_is_left_alone() {
    let away: Step = |world| {
        let sun = named(world, "sun");
        world.entity_mut(sun).insert(RenderLayers::layer(2));
    };
    let dark = look(&mut app(true, &[set_up, away]));
    assert!(difference(&dark, &look(&mut app(true, &[set_up]))) > 100);
}
