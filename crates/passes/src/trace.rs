//! `Trace`: rays in, hits out, by one of several engines. The number of rays stays on the GPU.

use crate::names::{EMBREE, LIGHT, MASKS};
use serde::Deserialize;
use skiagraph_graph::{
    Chosen, Code, Diagnostic, Lowering, PassKind, Reference, Span,
    step::{CpuCall, CpuItems, Dispatch, Groups, Operand, Program, Step, Threads},
};
use skiagraph_scene::LightKind;

/// Choice of the hit that a [`Trace`] pass records for a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Mode {
    /// The first hit found, in no particular order: enough to know that the ray is blocked.
    Any,
    /// The nearest hit: the one with the least t, the distance from the ray's origin in units of
    /// its direction's length.
    Closest,
}

/// Acceleration structure with which a [`Trace`] pass finds hits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Engine {
    /// A bounding-volume hierarchy in buffers (`scene.bvh_nodes`), walked by compute shaders;
    /// watertight, on every device.
    Hierarchy,
    /// The device's own ray queries, on devices with `EXPERIMENTAL_RAY_QUERY`; how they round is up
    /// to the device. A ray hits nothing if its t_min is negative or a coordinate is not finite.
    RayQuery,
    /// A hierarchy for rays that all go towards one directional light; watertight, the same hits as
    /// `Hierarchy`, on every device. Needs `direction: Light`.
    LightSpace,
    /// Embree 3, with its own hierarchy, triangle test and rounding, on all cores of the CPU. The
    /// frame waits for it. Needs the feature `embree` of `skiagraph-passes`, and a host that runs
    /// frames by `Executor::submit`. A ray hits nothing if its t_min is negative or a coordinate is
    /// not finite.
    Embree,
}

/// Property that all rays of a pass share.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Direction {
    /// Every ray's direction is exactly `to_light_from(origin)` of `shared/light.wgsl`; under a
    /// directional light that is `light.to_light`.
    Light,
}

/// The modules that shaders import in the place of others where triangles are masked.
const MASKED: [(&str, &str); 2] = [
    ("shared/solid.wgsl", "shared/masks.wgsl"),
    ("shared/ray_total.wgsl", "shared/ray_total_uniform.wgsl"),
];

impl Engine {
    /// Words by which a `Choice` param of a document selects an engine, each with its engine.
    pub const WORDS: [(&str, Self); 4] = [
        ("hierarchy", Self::Hierarchy),
        ("ray_query", Self::RayQuery),
        ("light_space", Self::LightSpace),
        ("embree", Self::Embree),
    ];

    /// The shader that traces, if it is one.
    fn shader(self) -> Option<&'static str> {
        match self {
            Self::Hierarchy => Some("trace_rays"),
            Self::RayQuery => Some("trace_ray_query"),
            Self::LightSpace => Some("trace_light_space"),
            Self::Embree => None,
        }
    }

    /// Returns the device features that it cannot do without.
    fn features(self) -> wgpu::Features {
        match self {
            Self::Hierarchy | Self::LightSpace | Self::Embree => wgpu::Features::empty(),
            Self::RayQuery => wgpu::Features::EXPERIMENTAL_RAY_QUERY,
        }
    }
}

fn hierarchy() -> Chosen<Engine> {
    Chosen::Word(Engine::Hierarchy)
}

/// Pass kind of graph documents, in the [`registry`](crate::registry), that traces a buffer of rays
/// through the scene of a [`SceneProvider`](crate::SceneProvider) and writes a buffer of hits:
///
/// ```ron
/// Trace(
///     name: "trace_rays", rays: "rays", hits: "hits", count: "ray_count",
///     groups: "ray_groups", skip: "ray_primitives", mode: Any,
/// )
/// ```
///
/// docs/reference.md describes the fields and the layout of the buffers. A hit counts if t_min < t
/// ≤ t_max, where t is in units of the length of the ray's direction. Triangles are two-sided;
/// those without area are never hit, and a masked one only where its mask is opaque.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(
        description = "Follows rays through the scene. Triangles are two-sided; those without \
            area are never hit, and a masked one only where its mask is opaque."
    )
)]
#[serde(deny_unknown_fields)]
pub struct Trace {
    /// Buffer of 32-byte items `origin: vec3<f32>, t_min: f32, direction: vec3<f32>, t_max: f32`; a
    /// hit counts if t_min < t ≤ t_max, t in units of `direction`, which need not be of unit
    /// length.
    rays: Reference,
    /// Buffer of 16-byte items `t: f32, primitive: u32, u: f32, v: f32`; u and v are the weights of
    /// the primitive's second and third corner. A ray that hits nothing gets its t_max and the
    /// primitive `0xffffffff`; one without an answer, because the driver ended the shader's loops
    /// before it had passed all triangles on its way, `0xfffffffd`.
    hits: Reference,
    /// Buffer of one u32, the number of rays; rays beyond the end of `rays` or `hits` are left out.
    count: Reference,
    /// Buffer of three u32, the workgroups of 64 rays, folded to two dimensions, that `count` comes
    /// to, as `dispatch_arguments.wgsl` makes them; without it the pass counts them once more.
    groups: Option<Reference>,
    /// Buffer of one u32 per ray, the primitive that the ray does not see, such as its own.
    skip: Option<Reference>,
    /// Which hit is recorded.
    mode: Mode,
    /// Engine that walks the rays, `Hierarchy` without it, or in quotes a `Choice` of `hierarchy`,
    /// `ray_query`, `light_space`, `embree`. Rays of `RayQuery` and `Embree` need t_min ≥ 0 and
    /// finite coordinates; others hit nothing.
    #[serde(default = "hierarchy")]
    engine: Chosen<Engine>,
    /// `Light` is your word that all rays go towards the light, without which `LightSpace` is
    /// refused. A ray that does not is recorded as a miss with t = −1.
    direction: Option<Direction>,
}

impl Trace {
    fn entry_point(&self) -> &'static str {
        match (self.mode, &self.skip) {
            (Mode::Any, None) => "any_hit",
            (Mode::Any, Some(_)) => "any_hit_skip",
            (Mode::Closest, None) => "closest_hit",
            (Mode::Closest, Some(_)) => "closest_hit_skip",
        }
    }

    fn refuse(&self, pass: &mut Lowering<'_>) {
        let place = self.engine_place(pass);
        let what = "`LightSpace` traces only rays that go towards the light";
        let mistake = Diagnostic::error(Code::Unused, what)
            .at(place, "nothing says that those of this pass do")
            .help(
                "say `direction: Light` if the direction of every ray is `light.to_light`, as \
                 `shared/fill_rays.ron` makes them; else take `engine: Hierarchy`",
            );
        pass.report(mistake);
    }

    fn refuse_light(&self, pass: &mut Lowering<'_>, kind: &str) {
        let what = format!("`LightSpace` traces no rays to a {kind} light");
        let mistake = Diagnostic::error(Code::Light, what)
            .at(self.engine_place(pass), "its rays all have one direction")
            .help("take the engine `hierarchy`, or `ray_query` where there is one");
        pass.report(mistake);
    }

    /// Refuses the engine that the host lacks.
    fn refuse_embree(&self, pass: &mut Lowering<'_>) {
        let mistake = Diagnostic::error(Code::Feature, "this program was built without Embree")
            .at(self.engine_place(pass), "its rays would be traced by it")
            .help(
                "build it with `--features embree`, which needs Embree 3 (on Debian 12 the package \
                 `libembree-dev`; elsewhere its folder in EMBREE_DIR), or take another engine: \
                 `hierarchy` traces on every device",
            );
        pass.report(mistake);
    }

    /// Has the CPU trace.
    fn lower_to_cpu(&self, pass: &mut Lowering<'_>) {
        let items = |buffer: &Reference, bytes| CpuItems {
            buffer: buffer.into(),
            bytes,
        };
        let mut reads = vec![items(&self.rays, 32)];
        reads.extend(self.skip.as_ref().map(|skip| items(skip, 4)));
        pass.step(Step::Cpu(CpuCall {
            work: pass.named(EMBREE),
            entry: self.entry_point().to_owned(),
            count: (&self.count).into(),
            reads,
            writes: items(&self.hits, 16),
        }));
    }

    fn announce(engine: Engine, pass: &mut Lowering<'_>) {
        if let Some(shader) = engine.shader() {
            pass.alternative(shader, &[], engine.features());
            pass.alternative(shader, &MASKED, engine.features());
        }
    }

    fn engine_place(&self, pass: &Lowering<'_>) -> Span {
        match &self.engine {
            Chosen::Expr(expr) => expr.span().clone(),
            Chosen::Word(_) => pass.name().span,
        }
    }

    /// A dispatch of its own, because a buffer cannot be written and be the size of the dispatch
    /// that writes it.
    fn count_groups(&self, pass: &mut Lowering<'_>) -> Operand {
        let groups = Operand::from(pass.scratch("groups", 12));
        let mut program = pass.program_of("dispatch_arguments");
        bind(pass, &mut program, "count", (&self.count).into());
        bind(pass, &mut program, "groups", groups.clone());
        pass.step(Step::Dispatch(Dispatch {
            program,
            groups: Groups::Direct(Threads::Groups([1; 3])),
        }));
        groups
    }
}

impl PassKind for Trace {
    fn lower(&self, pass: &mut Lowering<'_>) {
        // A document that chooses by a param is read with the shaders of all its words.
        if let Chosen::Expr(_) = &self.engine {
            for (_, engine) in Engine::WORDS {
                Self::announce(engine, pass);
            }
        }
        let mut engine = pass.word(&self.engine, &Engine::WORDS);
        if engine == Engine::Embree && !pass.is_provided(EMBREE) {
            self.refuse_embree(pass);
            // So that nothing that follows from it is told, too.
            engine = Engine::Hierarchy;
        }
        let Some(shader) = engine.shader() else {
            // For hosts without it, as above.
            Self::announce(Engine::Hierarchy, pass);
            return self.lower_to_cpu(pass);
        };
        Self::announce(engine, pass);
        let groups = match &self.groups {
            Some(groups) => Operand::from(groups),
            None => self.count_groups(pass),
        };
        if engine == Engine::LightSpace {
            match (self.direction, pass.kind_of(LIGHT)) {
                (None, _) => self.refuse(pass),
                (Some(Direction::Light), Some(kind)) if kind != LightKind::WORDS[0] => {
                    self.refuse_light(pass, kind);
                }
                (Some(Direction::Light), _) => {}
            }
        }
        let mut trace = pass.program_of(shader);
        if pass.provided_items(MASKS) > 0 {
            let modules = MASKED.iter();
            trace.imports = modules
                .map(|(name, is)| ((*name).to_owned(), (*is).to_owned()))
                .collect();
        }
        trace.compute = Some(pass.named(self.entry_point()));
        bind(pass, &mut trace, "count", (&self.count).into());
        bind(pass, &mut trace, "rays", (&self.rays).into());
        bind(pass, &mut trace, "hits", (&self.hits).into());
        if let Some(skip) = &self.skip {
            bind(pass, &mut trace, "skip", skip.into());
        }
        pass.step(Step::Dispatch(Dispatch {
            program: trace,
            groups: Groups::Indirect(groups),
        }));
    }
}

fn bind(pass: &Lowering<'_>, program: &mut Program, global: &str, operand: Operand) {
    program.bind.push((pass.named(global), operand));
}
