//! Shaders that ask more of a device than it has, or than WGSL promises of any.

use crate::source::{Located, Span};

/// An entry point of a shader, for messages.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    pub file: String,
    pub name: String,
    pub span: Span,
}

/// Memory of an entry point above a limit, and its largest variable.
#[derive(Clone, Debug)]
pub(crate) struct Excess {
    /// Memory in bytes that the shader takes.
    pub bytes: u64,
    /// Greatest size in bytes that is allowed.
    pub most: u64,
    /// Size in bytes of the largest variable.
    pub of_largest: u64,
    /// Name of the largest variable, with its place.
    pub largest: Located<String>,
}

mistakes! {
    /// A shader that asks more of a device than it has, or than WGSL promises of any.
    LimitError:

    Workgroup(entry: Entry, excess: Excess) =>
        Limit(
            "workgroups of {entry} share {} bytes, more than the adapter has", excess.bytes
        )
        .at(&excess.largest, largest(&excess))
        .help(format!(
            "its limit is {} bytes (max_compute_workgroup_storage_size); a buffer holds more",
            excess.most
        ));

    Private(entry: Entry, excess: Excess) =>
        Limit("the private variables of {entry} take {} bytes of each thread", excess.bytes)
        .at(&excess.largest, largest(&excess)).help(promised(excess.most));

    Function { file: String, function: String, excess: Excess } =>
        Limit(
            "the variables of `{function}` of `{file}` take {} bytes of each thread", excess.bytes
        )
        .at(&excess.largest, largest(&excess)).help(promised(excess.most));

    Functions(entry: Entry, excess: Excess) =>
        Limit(
            "the functions that {entry} runs take {} bytes of each thread together", excess.bytes
        )
        .at(&excess.largest, largest(&excess))
        .help(format!(
            "no adapter tells a limit; a graph takes {} bytes, since drivers put all of them on \
             the stack of each thread: a storage buffer holds more",
            excess.most
        ));

    Value { file: String, function: Located<String>, bytes: u64, most: u64 } =>
        Limit("a value in `{function}` of `{file}` has {bytes} bytes")
        .at(function, "")
        .help(format!(
            "no adapter tells a limit; a graph takes {most} bytes, since drivers put a value on \
             the stack of each thread: index the variable or buffer itself"
        ));

    TooManyVaryings { entry: Entry, verb: &'static str, number: u64, builtins: u32, most: u32 } =>
        Limit("{entry} {verb} {number} values between the stages, more than the adapter hands on")
        .at(entry.span, match builtins {
            0 => String::new(),
            _ => format!("{builtins} of them for its built-in values"),
        })
        .help(format!(
            "its limit is {most} (max_inter_stage_shader_variables); put several into one vec4"
        ));

    Location { entry: Entry, verb: &'static str, location: u32, most: u32 } =>
        Limit("{entry} {verb} @location({location}), which the adapter does not have")
        .at(entry.span, "")
        .help(format!("locations count from 0, and it has {most} of them"));

    NoVarying {
        entry: Entry,
        location: u32,
        why: String,
        /// Place of the vertex shader's entry point; `None` if the graph brings the vertex shader
        /// itself.
        vertex: Option<Span>,
    } =>
        StageInterface("{entry} reads @location({location}), which {why}")
        .at(entry.span, "read here")
        .help_any(vertex.is_none().then_some(
            "the vertices of a Fullscreen pass hand nothing on",
        ))
        .at_any(vertex, "the vertex shader");

    Attribute(entry: Entry, location: u32) =>
        StageInterface("{entry} reads the vertex attribute @location({location})")
        .at(entry.span, "")
        .help("a graph has no vertex buffers: read a storage buffer at @builtin(vertex_index)");

    BindingNumber { file: String, global: String, binding: u32, most: u32, span: Span } =>
        Limit("`{global}` of `{file}` has @binding({binding}), which the adapter does not have")
        .at(span, "")
        .help(format!(
            "its numbers end below {most} (max_bindings_per_bind_group); leave them out: the graph \
             gives them"
        ));
}

impl std::fmt::Display for Entry {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "`{}` of `{}`", self.name, self.file)
    }
}

fn largest(excess: &Excess) -> String {
    format!("`{}` takes {} bytes", excess.largest, excess.of_largest)
}

fn promised(most: u64) -> String {
    format!(
        "no adapter tells a limit; WGSL promises {most} bytes, and drivers put them on the stack \
         of each thread: a storage buffer holds more"
    )
}
