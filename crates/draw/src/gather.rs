//! Converts a plan into a [`Drawing`].

use crate::drawing::{Access, Aspect, Drawing, Edge, Kind, Material, Origin, Part, Pass, Reason};
use crate::reduction::implied;
use skiagraph_graph::{
    Hazard, LinkedPass, PassId, Plan, Resource, ResourceKind, Run, SubresourceRange, step::Step,
};
use std::collections::{BTreeMap, HashMap};
use std::ops::Range;

/// Converts a graph's plan into plain values that can be serialised, or drawn by
/// [`to_svg`](crate::to_svg) and [`to_dot`](crate::to_dot). The title is empty.
pub fn from_plan(plan: &Plan) -> Drawing {
    let mut positions = vec![None; plan.all_passes().len()];
    for (position, pass) in plan.schedule().passes.iter().enumerate() {
        positions[pass.index()] = Some(position);
    }
    let passes = plan.all_passes().iter();
    Drawing {
        title: String::new(),
        passes: drawn_passes(plan, &positions),
        materials: materials(plan),
        accesses: passes.flat_map(|pass| accesses(pass, plan)).collect(),
        edges: edges(plan, &positions),
        memory_bytes: plan.memory_bytes(),
        saved_bytes: plan.saved_bytes(),
    }
}

fn drawn_passes(plan: &Plan, positions: &[Option<usize>]) -> Vec<Pass> {
    let culled = plan.culled().iter();
    let culled = culled.map(|pass| (pass.name.as_str(), &pass.reason));
    let culled: HashMap<&str, &String> = culled.collect();
    let drawn = |(pass, &position): (&LinkedPass, &Option<usize>)| Pass {
        name: pass.name.value.clone(),
        kind: pass.kind.to_owned(),
        shaders: shaders(pass),
        file: pass.name.span.file.name.to_string(),
        line: pass.name.span.line_column().0,
        position,
        culled: culled.get(pass.name.as_str()).map(|&reason| reason.clone()),
        run: (pass.run != Run::Always).then(|| pass.run.to_string()),
    };
    plan.all_passes().iter().zip(positions).map(drawn).collect()
}

/// The shader files of a pass, each once.
fn shaders(pass: &LinkedPass) -> Vec<String> {
    let mut files: Vec<String> = Vec::new();
    for program in pass.steps.iter().filter_map(Step::program) {
        let file = program.shader.file();
        if !files.iter().any(|path| path == file) {
            files.push(file.to_owned());
        }
    }
    files
}

fn materials(plan: &Plan) -> Vec<Material> {
    let schedule = plan.schedule();
    let mut materials: Vec<Material> = plan.resources().iter().map(material).collect();
    let captures = plan.all_passes().iter().filter(|pass| pass.is_capture());
    for access in captures.flat_map(|pass| &pass.accesses) {
        if access.writes {
            materials[access.resource.index()].origin = Origin::Capture;
        }
    }
    for (id, lifetime) in &schedule.lifetimes {
        materials[id.index()].lifetime = Some([lifetime.first, lifetime.last]);
    }
    for id in &schedule.ping_pong {
        let material = &mut materials[id.index()];
        material.versions = plan.versions(*id);
        let total = |bytes: u64| bytes.saturating_mul(material.versions as u64);
        material.bytes = material.bytes.map(total);
    }
    for (name, target) in plan.readable() {
        materials[target.id.index()].outputs.push(name.clone());
    }
    for (id, alone) in &schedule.aliases.alone {
        materials[id.index()].alone = Some(*alone);
    }
    for (id, allocation) in &schedule.aliases.of {
        if schedule.aliases.list[*allocation].aliases.len() > 1 {
            materials[id.index()].memory = Some(*allocation);
        }
    }
    materials
}

/// A resource, as if no pass used it.
fn material(resource: &Resource) -> Material {
    use skiagraph_graph::Origin as Of;
    let origin = match (resource.origin, &resource.kind) {
        (Of::Own, _) if resource.declared.is_none() => Origin::Scratch,
        (Of::Own, _) => Origin::Declared,
        (Of::Constant, _) => Origin::Constant,
        (Of::Previous(_), _) => Origin::Previous,
        (
            Of::Host,
            ResourceKind::Provided(_) | ResourceKind::AccelerationStructure | ResourceKind::CpuWork,
        ) => Origin::Provided,
        (Of::Host, ResourceKind::Frame) => Origin::Frame,
        (Of::Host, _) => Origin::Imported,
    };
    let bytes = resource.kind.bytes();
    let mut material = Material {
        name: resource.name.clone(),
        kind: Kind::Buffer,
        origin,
        format: None,
        size: None,
        mips: 1,
        layers: 1,
        is_3d: false,
        samples: 1,
        versions: 1,
        // A buffer that no shader sees has no size, and is not made.
        bytes: (origin.is_made() && bytes > 0).then_some(bytes),
        lifetime: None,
        outputs: Vec::new(),
        memory: None,
        alone: None,
    };
    match &resource.kind {
        ResourceKind::Texture(texture) => {
            material.kind = Kind::Texture;
            material.format = Some(format!("{:?}", texture.format));
            material.size = Some(texture.size);
            (material.mips, material.layers) = (texture.mips, texture.layers);
            (material.is_3d, material.samples) = (texture.is_3d, texture.samples);
        }
        ResourceKind::Sampler(_) => material.kind = Kind::Sampler,
        ResourceKind::AccelerationStructure => material.kind = Kind::AccelerationStructure,
        ResourceKind::CpuWork => material.kind = Kind::CpuWork,
        ResourceKind::Buffer(_) | ResourceKind::Provided(_) | ResourceKind::Frame => {}
    }
    material
}

/// Returns the accesses of a pass, with one entry for each part.
fn accesses(pass: &LinkedPass, plan: &Plan) -> Vec<Access> {
    let mut drawn: Vec<Access> = Vec::new();
    // In the place of attachments there is what is neither read nor written.
    let uses = pass.accesses.iter();
    for access in uses.filter(|access| access.reads || access.writes) {
        let resource = plan.resource(access.resource);
        let part = part(&access.part, &resource.kind);
        let earlier = drawn
            .iter_mut()
            .find(|other| other.material == resource.name && other.part == part);
        match earlier {
            Some(earlier) => {
                earlier.reads |= access.reads;
                earlier.writes |= access.writes;
            }
            None => drawn.push(Access {
                pass: pass.name.value.clone(),
                material: resource.name.clone(),
                reads: access.reads,
                writes: access.writes,
                part,
            }),
        }
    }
    drawn
}

/// Returns the part that a range selects; `None` if it leaves nothing out.
fn part(range: &SubresourceRange, kind: &ResourceKind) -> Option<Part> {
    let some = |range: &Range<u32>, count: u32| (*range != (0..count)).then(|| range.clone());
    let part = match kind {
        ResourceKind::Texture(texture) => Part {
            mips: some(&range.mips, texture.mips),
            layers: some(&range.layers, texture.mip_layers(range.mips.start)),
            aspect: match range.aspect {
                _ if !texture.format.is_combined_depth_stencil_format() => None,
                wgt::TextureAspect::DepthOnly => Some(Aspect::Depth),
                wgt::TextureAspect::StencilOnly => Some(Aspect::Stencil),
                _ => None,
            },
        },
        _ => Part {
            layers: range.items(),
            ..Part::default()
        },
    };
    (part != Part::default()).then_some(part)
}

fn edges(plan: &Plan, positions: &[Option<usize>]) -> Vec<Edge> {
    let runs = |pass: PassId| positions[pass.index()].is_some();
    let mut dependences = plan.dependences(runs);
    if positions.contains(&None) {
        // A pass that does not run delays no other; only its reads are of interest.
        let mut reads = plan.dependences(|_| true);
        reads.retain(|&(from, to, hazard), _| {
            hazard == Hazard::ReadAfterWrite && !(runs(from) && runs(to))
        });
        dependences.append(&mut reads);
    }
    let mut reasons: BTreeMap<[PassId; 2], Vec<Reason>> = BTreeMap::new();
    for ((from, to, hazard), resources) in dependences {
        let names = resources.iter().map(|id| plan.resource(*id).name.clone());
        reasons.entry([from, to]).or_default().push(Reason {
            hazard,
            materials: names.collect(),
        });
    }
    let ends = |passes: &[PassId; 2]| passes.map(PassId::index);
    let implied = implied(
        positions.len(),
        &reasons.keys().map(ends).collect::<Vec<_>>(),
    );
    let name = |pass: PassId| plan.pass(pass).name.value.clone();
    let edge = |(passes, because): ([PassId; 2], Vec<Reason>)| Edge {
        from: name(passes[0]),
        to: name(passes[1]),
        because,
        implied: implied.contains(&ends(&passes)),
    };
    reasons.into_iter().map(edge).collect()
}
