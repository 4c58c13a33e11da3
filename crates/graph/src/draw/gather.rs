//! From a plan to plain data.

use super::{Access, Drawing, Edge, Hazard, Kind, Material, Origin, Part, Pass, Reason};
use crate::{
    document::Run,
    link::{LinkedPass, LinkedStep},
    order::{self, dependences},
    plan::{CAPTURE, Plan},
    resolve::{self, Resource, ResourceId, ResourceKind},
};
use std::collections::{BTreeMap, BTreeSet, HashMap};

impl Plan {
    /// The plan as plain data, to be looked at: serialise it, or have it drawn.
    pub fn drawing(&self) -> Drawing {
        let mut positions = vec![None; self.passes.len()];
        for (position, &pass) in self.schedule.iter().enumerate() {
            positions[pass] = Some(position);
        }
        Drawing {
            title: String::new(),
            passes: self.drawn_passes(&positions),
            materials: self.drawn_materials(&positions),
            accesses: self
                .passes
                .iter()
                .flat_map(|pass| self.drawn_accesses(pass))
                .collect(),
            edges: self.drawn_edges(&positions),
            memory_bytes: self.memory_bytes(),
            saved_bytes: self.saved_bytes(),
        }
    }

    fn drawn_passes(&self, positions: &[Option<usize>]) -> Vec<Pass> {
        let culled: HashMap<&str, &str> = self
            .culled()
            .iter()
            .map(|pass| (pass.name.as_str(), pass.reason.as_str()))
            .collect();
        let drawn = |(pass, &position): (&LinkedPass, &Option<usize>)| Pass {
            name: pass.name.value.clone(),
            kind: pass.kind.to_owned(),
            shaders: shaders(pass),
            file: pass.name.span.file.name.to_string(),
            line: pass.name.span.line_column().0,
            position,
            culled: culled
                .get(pass.name.as_str())
                .map(|&reason| reason.to_owned()),
            run: (pass.run != Run::Always).then(|| pass.run.to_string()),
        };
        self.passes.iter().zip(positions).map(drawn).collect()
    }

    fn drawn_materials(&self, positions: &[Option<usize>]) -> Vec<Material> {
        let mut lifetimes: BTreeMap<ResourceId, [usize; 2]> = BTreeMap::new();
        let mut captured: BTreeSet<ResourceId> = BTreeSet::new();
        for (pass, position) in self.passes.iter().zip(positions) {
            for access in &pass.accesses {
                if pass.kind == CAPTURE && access.writes {
                    captured.insert(access.resource);
                }
                if let &Some(position) = position {
                    let [first, last] = lifetimes.entry(access.resource).or_insert([position; 2]);
                    (*first, *last) = (position.min(*first), position.max(*last));
                }
            }
        }
        let mut outputs: BTreeMap<ResourceId, Vec<String>> = BTreeMap::new();
        for (name, target) in &self.readable {
            outputs.entry(target.id).or_default().push(name.clone());
        }
        let drawn = |(index, resource): (usize, &Resource)| {
            let id = ResourceId(index);
            let mut material = material(resource);
            if captured.contains(&id) {
                material.origin = Origin::Capture;
            }
            material.lifetime = lifetimes.get(&id).copied();
            material.outputs = outputs.remove(&id).unwrap_or_default();
            material.memory = self.slots.of.get(&id).copied().filter(|slot| {
                let slot = &self.slots.list[*slot];
                slot.tenants.len() > 1
            });
            material
        };
        self.resources.iter().enumerate().map(drawn).collect()
    }

    fn drawn_accesses(&self, pass: &LinkedPass) -> Vec<Access> {
        let mut drawn: Vec<Access> = Vec::new();
        for access in &pass.accesses {
            let resource = &self.resources[access.resource.0];
            let part = match &resource.kind {
                ResourceKind::Texture(texture)
                    if access.part.mips != (0..texture.mips)
                        || access.part.layers != (0..texture.layers) =>
                {
                    Some(Part {
                        mips: access.part.mips.clone(),
                        layers: access.part.layers.clone(),
                    })
                }
                _ => None,
            };
            let known = drawn
                .iter_mut()
                .find(|other| other.material == resource.name && other.part == part);
            match known {
                Some(known) => {
                    known.reads |= access.reads;
                    known.writes |= access.writes;
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

    fn drawn_edges(&self, positions: &[Option<usize>]) -> Vec<Edge> {
        let runs = |pass: usize| positions[pass].is_some();
        let mut reasons: BTreeMap<(usize, usize), Vec<Reason>> = BTreeMap::new();
        let mut add = |(from, to, hazard), resources: BTreeSet<ResourceId>| {
            let name = |id: ResourceId| self.resources[id.0].name.clone();
            reasons.entry((from, to)).or_default().push(Reason {
                hazard: Hazard::from(hazard),
                materials: resources.into_iter().map(name).collect(),
            });
        };
        for (edge, resources) in dependences(&self.passes, &self.resources, runs) {
            add(edge, resources);
        }
        if self.schedule.len() < self.passes.len() {
            // A pass that does not run keeps nobody waiting; only what it would have read is of interest.
            for (edge, resources) in dependences(&self.passes, &self.resources, |_| true) {
                let (from, to, hazard) = edge;
                if hazard == order::Hazard::ReadAfterWrite && !(runs(from) && runs(to)) {
                    add(edge, resources);
                }
            }
        }
        let implied = implied(
            self.passes.len(),
            &reasons.keys().copied().collect::<Vec<_>>(),
        );
        let name = |pass: usize| self.passes[pass].name.value.clone();
        reasons
            .into_iter()
            .map(|((from, to), because)| Edge {
                from: name(from),
                to: name(to),
                because,
                implied: implied.contains(&(from, to)),
            })
            .collect()
    }
}

/// The edges that a longer path replaces. Passes are numbered as in the file, so every edge leads to a greater number.
fn implied(passes: usize, edges: &[(usize, usize)]) -> BTreeSet<(usize, usize)> {
    let mut next: Vec<Vec<usize>> = vec![Vec::new(); passes];
    for &(from, to) in edges {
        next[from].push(to);
    }
    let mut implied = BTreeSet::new();
    // What each pass leads to, one bit per pass.
    let words = passes.div_ceil(64);
    let mut reached: Vec<Vec<u64>> = vec![vec![0; words]; passes];
    for from in (0..passes).rev() {
        let mut mine = vec![0u64; words];
        next[from].sort_unstable();
        for &to in &next[from] {
            if mine[to / 64] >> (to % 64) & 1 == 1 {
                implied.insert((from, to));
                continue;
            }
            mine[to / 64] |= 1 << (to % 64);
            mine.iter_mut()
                .zip(&reached[to])
                .for_each(|(bits, more)| *bits |= more);
        }
        reached[from] = mine;
    }
    implied
}

impl From<order::Hazard> for Hazard {
    fn from(hazard: order::Hazard) -> Self {
        match hazard {
            order::Hazard::ReadAfterWrite => Self::ReadAfterWrite,
            order::Hazard::WriteAfterRead => Self::WriteAfterRead,
            order::Hazard::WriteAfterWrite => Self::WriteAfterWrite,
        }
    }
}

fn shaders(pass: &LinkedPass) -> Vec<String> {
    let mut files: Vec<String> = Vec::new();
    for step in &pass.steps {
        let program = match step {
            LinkedStep::Draw(draw) => &draw.program,
            LinkedStep::Dispatch { program, .. } => program,
            _ => continue,
        };
        let file = program.shader.source.file.name.to_string();
        if !files.contains(&file) {
            files.push(file);
        }
    }
    files
}

fn material(resource: &Resource) -> Material {
    let mut material = Material {
        name: resource.name.clone(),
        kind: Kind::Buffer,
        origin: match (resource.origin, &resource.declared) {
            (resolve::Origin::Host, _) => Origin::Imported,
            (resolve::Origin::Previous(_), _) => Origin::Previous,
            (resolve::Origin::Own, Some(_)) => Origin::Declared,
            (resolve::Origin::Own, None) => Origin::Scratch,
        },
        format: None,
        size: None,
        mips: 1,
        layers: 1,
        bytes: None,
        lifetime: None,
        outputs: Vec::new(),
        memory: None,
    };
    match &resource.kind {
        ResourceKind::Texture(texture) => {
            material.kind = Kind::Texture;
            material.format = Some(format!("{:?}", texture.format));
            material.size = Some(texture.size);
            (material.mips, material.layers) = (texture.mips, texture.layers);
            material.bytes = Some(texture.bytes());
        }
        // A buffer that no shader sees has no size, and is not made.
        ResourceKind::Buffer(buffer) => {
            material.bytes = (buffer.bytes > 0).then_some(buffer.bytes);
        }
        ResourceKind::Sampler(_) => material.kind = Kind::Sampler,
        ResourceKind::Provided(_) => material.origin = Origin::Provided,
    }
    material
}

#[cfg(test)]
mod tests {
    use super::implied;

    /// ```text
    /// 0 ─▶ 1 ─▶ 2 ─▶ 3     and 0 ─▶ 2, 0 ─▶ 3, 1 ─▶ 3; 4 stands alone
    /// ```
    #[test]
    fn an_edge_beside_a_longer_path_is_implied() {
        let edges = [(0, 1), (1, 2), (2, 3), (0, 2), (0, 3), (1, 3)];
        let found: Vec<_> = implied(5, &edges).into_iter().collect();
        assert_eq!(found, [(0, 2), (0, 3), (1, 3)]);
        assert!(implied(3, &[(0, 1), (0, 2)]).is_empty());
        // Beyond one word of bits.
        let chain: Vec<_> = (0..199)
            .map(|pass| (pass, pass + 1))
            .chain([(0, 199)])
            .collect();
        assert_eq!(
            implied(200, &chain).into_iter().collect::<Vec<_>>(),
            [(0, 199)]
        );
    }
}
