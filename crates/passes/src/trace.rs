//! `Trace`: rays in, hits out, by one of several engines. The number of rays stays on the GPU.

use crate::names::{EMBREE, LIGHT};
use serde::Deserialize;
use skiagraph_graph::step::{CpuCall, CpuItems, Dispatch, Groups, Operand, Program, Step, Threads};
use skiagraph_graph::{Chosen, Code, Diagnostic, Expr, Located, Lowering, PassKind, Reference};
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

/// The module that gives rays and takes hits, unless another one stands in for it.
const RAYS: &str = "shared/ray_buffers.wgsl";

/// The same where each ray has a primitive that it does not see.
const RAYS_WITH_SKIP: &str = "shared/skipping_ray_buffers.wgsl";

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

/// Pass kind of graph documents, in the [`registry`](crate::registry), that traces rays through the
/// scene of a [`SceneProvider`](crate::SceneProvider): from a buffer of rays to a buffer of hits,
///
/// ```ron
/// Trace(
///     name: "trace_rays", rays: "rays", hits: "hits", count: "ray_count",
///     groups: "ray_groups", skip: "ray_primitives", mode: Any,
/// )
/// ```
///
/// or rays that a WGSL module makes when they are traced, and hits that it takes, with neither in
/// memory:
///
/// ```ron
/// Trace(
///     name: "trace_rays", of: "shared/listed_pixels.wgsl", most: "ray_pixels.count",
///     count: "ray_count", groups: "ray_groups", mode: Any,
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
    rays: Option<Reference>,
    /// Buffer of 16-byte items `t: f32, primitive: u32, u: f32, v: f32`; u and v are the weights of
    /// the primitive's second and third corner. A ray that hits nothing gets its t_max and the
    /// primitive `0xffffffff`; one without an answer, because the driver ended the shader's loops
    /// before it had passed all triangles on its way, `0xfffffffd`.
    hits: Option<Reference>,
    /// In the place of `rays`, `hits` and `skip`, a WGSL module with the functions of
    /// `shared/ray_buffers.wgsl`: `ray_limit() -> u32`, the number of rays that it has room for;
    /// `ray_of(index: u32) -> AskedRay`, a ray and the primitive that it does not see; and
    /// `take(index: u32, hit: Hit)`. It is looked for as shaders are, and its globals are bound by
    /// name, as those of a shader of the pass's own.
    of: Option<Located<String>>,
    /// With `of`, the most rays that there can be: `Embree` gets buffers of so many.
    most: Option<Expr>,
    /// Buffer of one u32, the number of rays; rays that there is no room for are left out.
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
        match self.mode {
            Mode::Any => "any_hit",
            Mode::Closest => "closest_hit",
        }
    }

    /// Returns the module that gives rays and takes hits, in the place of the usual one.
    fn imports(&self, pass: &Lowering<'_>) -> Vec<(Located<String>, Located<String>)> {
        let module = match (&self.of, &self.skip) {
            (Some(module), _) => module.clone(),
            (None, Some(_)) => pass.named(RAYS_WITH_SKIP),
            (None, None) => pass.named(RAYS),
        };
        vec![(pass.named(RAYS), module)]
    }

    /// Returns a program of a shader that imports that module.
    fn program(&self, shader: &str, pass: &Lowering<'_>) -> Program {
        let mut program = pass.program_of(shader);
        program.imports = self.imports(pass);
        bind(pass, &mut program, "count", (&self.count).into());
        let buffers = [
            ("rays", &self.rays),
            ("skip", &self.skip),
            ("hits", &self.hits),
        ];
        for (global, buffer) in buffers {
            if let Some(buffer) = buffer {
                bind(pass, &mut program, global, buffer.into());
            }
        }
        program
    }

    /// Reports buffers beside a module, and neither.
    fn check_fields(&self, pass: &mut Lowering<'_>) {
        let buffers = [&self.rays, &self.hits];
        let is_whole = match &self.of {
            Some(_) => self.most.is_some() && buffers.iter().all(|it| it.is_none()),
            None => self.most.is_none() && buffers.iter().all(|it| it.is_some()),
        };
        if is_whole && (self.of.is_none() || self.skip.is_none()) {
            return;
        }
        let mistake = Diagnostic::error(
            Code::Unused,
            "a `Trace` has either `rays` and `hits`, or `of` and `most`",
        );
        let mistake = mistake.at(pass.name().span, "this one").help(
            "write `rays: \"…\", hits: \"…\"` for buffers, with `skip` if rays do not see a \
             primitive; or `of: \"module.wgsl\", most: \"count\"` for a module that makes rays and \
             takes hits",
        );
        pass.report(mistake);
    }

    /// Refuses the engine: says what is wrong, where, and the way out.
    fn refuse(&self, pass: &mut Lowering<'_>, code: Code, what: &str, [label, help]: [&str; 2]) {
        let place = match &self.engine {
            Chosen::Expr(expr) => expr.span().clone(),
            Chosen::Word(_) => pass.name().span,
        };
        pass.report(Diagnostic::error(code, what).at(place, label).help(help));
    }

    /// Refuses the engine `LightSpace` if rays do not go towards one directional light.
    fn check_light_space(&self, pass: &mut Lowering<'_>) {
        if self.direction.is_none() {
            let label = "nothing says that those of this pass do";
            let help = "say `direction: Light` if the direction of every ray is `light.to_light`, \
                        as `shared/fill_rays.ron` makes them; else take `engine: Hierarchy`";
            let what = "`LightSpace` traces only rays that go towards the light";
            self.refuse(pass, Code::Unused, what, [label, help]);
        } else if let Some(kind) = pass.kind_of(LIGHT)
            && kind != LightKind::WORDS[0]
        {
            let label = "its rays all have one direction";
            let help = "take the engine `hierarchy`, or `ray_query` where there is one";
            let what = format!("`LightSpace` traces no rays to a {kind} light");
            self.refuse(pass, Code::Light, &what, [label, help]);
        }
    }

    /// Has the CPU trace. Rays of a module are written to memory for it, and hits handed back.
    fn lower_to_cpu(&self, pass: &mut Lowering<'_>) {
        let items = |buffer, bytes| CpuItems { buffer, bytes };
        let call = |pass: &Lowering<'_>, reads, writes| {
            Step::Cpu(CpuCall {
                work: pass.named(EMBREE),
                entry: self.entry_point().to_owned(),
                count: (&self.count).into(),
                reads,
                writes,
            })
        };
        if let (Some(rays), Some(hits)) = (&self.rays, &self.hits) {
            let mut reads = vec![items(rays.into(), 32)];
            reads.extend(self.skip.as_ref().map(|skip| items(skip.into(), 4)));
            return pass.step(call(pass, reads, items(hits.into(), 16)));
        }
        let most = self.most.as_ref().map_or(0, |most| pass.count(most));
        let [rays, skip, hits] = [("rays", 32), ("skip", 4), ("hits", 16)].map(|(name, bytes)| {
            let buffer = pass.scratch(name, most.saturating_mul(bytes));
            items(buffer.into(), bytes)
        });
        let groups = self.groups(pass);
        let mut write = self.program("write_rays", pass);
        bind(pass, &mut write, "written_rays", rays.buffer.clone());
        bind(pass, &mut write, "written_skip", skip.buffer.clone());
        let mut take = self.program("take_hits", pass);
        bind(pass, &mut take, "written_hits", hits.buffer.clone());
        pass.step(dispatch(write, groups.clone()));
        pass.step(call(pass, vec![rays, skip], hits));
        pass.step(dispatch(take, groups));
    }

    fn announce(&self, engine: Engine, pass: &mut Lowering<'_>) {
        let imports = self.imports(pass);
        let shaders = match (engine.shader(), &self.of) {
            (Some(shader), _) => vec![shader],
            (None, Some(_)) => vec!["write_rays", "take_hits"],
            (None, None) => Vec::new(),
        };
        for shader in shaders {
            pass.alternative(shader, &imports, engine.features());
        }
    }

    /// Returns the workgroups of a dispatch with a thread for each ray.
    fn groups(&self, pass: &mut Lowering<'_>) -> Operand {
        match &self.groups {
            Some(groups) => Operand::from(groups),
            None => self.count_groups(pass),
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
        self.check_fields(pass);
        // A document that chooses by a param is read with the shaders of all its words.
        if let Chosen::Expr(_) = &self.engine {
            for (_, engine) in Engine::WORDS {
                self.announce(engine, pass);
            }
        }
        let mut engine = pass.word(&self.engine, &Engine::WORDS);
        if engine == Engine::Embree && !pass.is_provided(EMBREE) {
            let label = "its rays would be traced by it";
            let help = "build it with `--features embree`, which needs Embree 3 (on Debian 12 the \
                        package `libembree-dev`; elsewhere its folder in EMBREE_DIR), or take \
                        another engine: `hierarchy` traces on every device";
            let what = "this program was built without Embree";
            self.refuse(pass, Code::Feature, what, [label, help]);
            // So that nothing that follows from it is told, too.
            engine = Engine::Hierarchy;
        }
        let Some(shader) = engine.shader() else {
            // For hosts without it, as above.
            self.announce(Engine::Hierarchy, pass);
            self.announce(engine, pass);
            return self.lower_to_cpu(pass);
        };
        self.announce(engine, pass);
        if engine == Engine::LightSpace {
            self.check_light_space(pass);
        }
        let groups = self.groups(pass);
        let mut trace = self.program(shader, pass);
        trace.compute = Some(pass.named(self.entry_point()));
        pass.step(dispatch(trace, groups));
    }
}

fn dispatch(program: Program, groups: Operand) -> Step<skiagraph_graph::step::Names> {
    Step::Dispatch(Dispatch {
        program,
        groups: Groups::Indirect(groups),
    })
}

fn bind(pass: &Lowering<'_>, program: &mut Program, global: &str, operand: Operand) {
    program.bind.push((pass.named(global), operand));
}
