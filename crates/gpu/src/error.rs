//! Errors of a device, and the scopes that catch them.

#![expect(
    clippy::disallowed_names,
    reason = "a derive binds public fields by name"
)]

use crate::provider::ProviderError;
use skiagraph_graph::{Diagnostics, LinkedPass, Panicked, Plan, Provided, caught};
use std::time::Duration;

/// Reasons why an [`Executor`](crate::Executor) could not create the resources or pipelines of a
/// plan, or could not encode, run or read back a frame. The text of an error is whole; a
/// [source](std::error::Error::source), such as the error of a provider, is a part of it for those
/// who ask for its type.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExecuteError {
    /// wgpu refused a pipeline, bind group or command of a pass.
    #[error("{place}: pass `{pass}` was refused by the device: {message}")]
    Gpu {
        /// Name of the refused pass, as in the graph document.
        pass: String,
        /// File, line and column of the pass in the graph document, as text.
        place: String,
        /// wgpu's message.
        message: String,
    },
    /// wgpu refused to create a texture, buffer, sampler or query set.
    #[error("`{name}` could not be made: {message}")]
    Resource {
        /// Name of the texture, buffer, sampler or query set. Resources of a graph that share their
        /// memory are named together, separated by ` / `.
        name: String,
        /// wgpu's message.
        message: String,
    },
    /// wgpu, naga, a driver layer or a [`Provider`](crate::Provider) panicked, which is a bug in
    /// that code.
    #[error(
        "{name}: {panicked}; this is a mistake of the library, which may take the same written \
         differently"
    )]
    Panicked {
        /// Name of the resource that was being created, in backticks, or place in the graph
        /// document and name of the pass that was being created or encoded.
        name: String,
        /// Message and source position of the panic.
        #[source]
        panicked: Panicked,
    },
    /// The device has too little memory for a resource or pass.
    #[error("the device has not enough memory for `{name}`")]
    OutOfMemory {
        /// Name of the resource or pass that needed the memory.
        name: String,
        /// The largest resources of the graph as text ([`Plan::memory_table`]).
        table: String,
    },
    /// The [`Provider`](crate::Provider) failed to build a resource, or to submit the commands that
    /// fill resources ([`submit_built`](crate::Provider::submit_built)).
    #[error("the provided resource `{name}` could not be built: {why}")]
    Provider {
        /// Name of the resource that was to be built, such as `scene.positions`; `what the provider
        /// copies` if `submit_built` failed.
        name: String,
        /// The provider's reason.
        #[source]
        why: ProviderError,
    },
    /// Work of a pass on the CPU failed.
    #[error("the work `{name}` on the CPU failed: {why}")]
    CpuWork {
        /// Name of the provided resource that does the work, such as `scene.embree`.
        name: String,
        /// The reason that the work gives.
        #[source]
        why: ProviderError,
    },
    /// The [`Provider`](crate::Provider) now describes a resource in another way than when the
    /// graph was planned: with another binding, number of items, bytes per item or kind; or a
    /// resource on which the plan [relies](skiagraph_graph::Plan::relies_on) has come or gone.
    #[error(
        "{}: plan the graph anew (`executor.plan().with(|request| request.provider = …)`) and hand \
         the plan to `replace_graph`",
        change(name, planned, given)
    )]
    OtherThanPlanned {
        /// Name of the resource whose description changed.
        name: String,
        /// The provider's description when the graph was planned; `None` if it had no such
        /// resource.
        planned: Option<Provided>,
        /// The provider's description now; `None` if it has no such resource any more.
        given: Option<Provided>,
    },
    /// A pass that runs in the frame reads a resource that the [`Provider`](crate::Provider) cannot
    /// build yet.
    #[error("{place}: pass `{pass}` reads `{name}`, which is not there yet: {why}")]
    NotProvided {
        /// Name of the resource that cannot be built yet.
        name: String,
        /// Name of the first pass that reads the resource.
        pass: String,
        /// File, line and column of the pass in the graph document, as text.
        place: String,
        /// The reason that [`Provider::missing`](crate::Provider::missing) returned.
        why: String,
    },
    /// The plan has no import of this name. An import is a texture, buffer or sampler of the host,
    /// named in [`PlanRequest::imports`](skiagraph_graph::PlanRequest).
    #[error("the plan has no import `{name}`; it has {known}")]
    NoSuchImport {
        /// Name that the host gave to [`Executor::import_texture`](crate::Executor::import_texture)
        /// or its counterpart for a buffer or sampler.
        name: String,
        /// Names of the plan's imports, separated by commas; `none` if there are none.
        known: String,
    },
    /// The version that the host gave to
    /// [`Executor::set_import_version`](crate::Executor::set_import_version) is lower than the one
    /// before.
    #[error(
        "the import `{name}` went back from version {before} to {version}: give a larger number \
         for each change; its content counts as changed"
    )]
    ImportVersion {
        /// Name of the import.
        name: String,
        /// Version before.
        before: u64,
        /// Version that was given.
        version: u64,
    },
    /// The name given to [`Executor::touch`](crate::Executor::touch) is neither an import (a
    /// texture, buffer or sampler that the host sets) nor a resource of the
    /// [`Provider`](crate::Provider).
    #[error(
        "neither an import nor a provided resource is called `{name}`; live passes use {known}"
    )]
    NotOfHost {
        /// Name that the host gave to [`Executor::touch`](crate::Executor::touch).
        name: String,
        /// Names of the imports and provided resources that passes whose results are needed use,
        /// separated by commas; `none` if there are none.
        known: String,
    },
    /// A texture, buffer or sampler that the host set as an import differs from its description in
    /// [`PlanRequest::imports`](skiagraph_graph::PlanRequest), which the graph was planned for.
    #[error(
        "`{name}` cannot be imported where another was planned for: {why}; plan again with what \
         it is"
    )]
    Import {
        /// Name of the import that was to be set.
        name: String,
        /// Differences between the described and the given import, as text.
        why: String,
    },
    /// A pass that runs in the frame uses an import (a texture, buffer or sampler of the host) that
    /// the host has not set yet.
    #[error(
        "{place}: pass `{pass}` uses the import `{name}`, which was not handed over: call \
         `import_texture`, `import_buffer` or `import_sampler` first"
    )]
    NotImported {
        /// Name of the import that is not set.
        name: String,
        /// Name of the first pass that uses the import.
        pass: String,
        /// File, line and column of the pass in the graph document, as text.
        place: String,
    },
    /// The graph cannot be planned for the new viewport or param value; or the device's backend
    /// lacks part of WebGPU, and the graph document does not list it in `proven_on`.
    #[error("{0}")]
    Plan(#[source] Box<Diagnostics>),
    /// The plan has no output or capture of the name that was to be read back. A capture is a
    /// content named in [`PlanRequest::captures`](skiagraph_graph::PlanRequest).
    #[error("the plan has no output `{name}`; it has {known}")]
    NoSuchOutput {
        /// Name that the host gave in [`Frame::read`](crate::Frame::read).
        name: String,
        /// Names of the plan's outputs and captures, separated by commas.
        known: String,
    },
    /// An output that was to be read back, or a buffer that work on the CPU reads, is a texture or
    /// buffer of the host that was created without the usage `COPY_SRC`.
    #[error("`{name}` cannot be read back: the host must make it with {usage}")]
    NotReadable {
        /// Name of the output or buffer that cannot be copied.
        name: String,
        /// The usage that the texture or buffer lacks, as wgpu writes it: `TextureUsages::COPY_SRC`
        /// or `BufferUsages::COPY_SRC`.
        usage: &'static str,
    },
    /// The content of an output or capture, or the pipeline statistics, could not be copied to the
    /// host, because wgpu could not map the staging buffer.
    #[error("the content of `{name}` could not be read back")]
    Readback {
        /// Name of the output or capture, or `pipeline statistics`.
        name: String,
    },
    /// Something belongs to another device than the executor. wgpu would refuse it, panic, or take
    /// another thing of the same number for it.
    #[error("{name} is of another device than the executor: {way_out}")]
    OtherDevice {
        /// Thing that is of another device: `the provider`, `the queue`, an import or a provided
        /// resource with its name.
        name: String,
        /// Advice for the host, as text.
        way_out: &'static str,
    },
    /// The device was lost or did not answer; the text describes the symptom.
    #[error("the device was lost: {0}")]
    DeviceLost(String),
    /// The GPU had not finished its work within the timeout of
    /// [`Executor::finish_within`](crate::Executor::finish_within), or when
    /// [`Executor::submit`](crate::Executor::submit) gave up. It may never finish.
    #[error(
        "the GPU was not done with the frame after {:.1} s; in it ran {passes}",
        after.as_secs_f64()
    )]
    Unfinished {
        /// Time that the call waited before it gave up.
        after: Duration,
        /// Names of the passes that ran in the frame that was encoded last, separated by commas;
        /// for a frame of `submit` the text `passes in front of work of the CPU`.
        passes: String,
    },
    /// A pass does its work on the CPU, for which a frame waits, and
    /// [`Executor::encode`](crate::Executor::encode) never does.
    #[error(
        "{place}: pass `{pass}` works on the CPU, and a frame that is encoded into the host's \
         commands cannot wait for it: run frames by `Executor::submit`, or choose what works on \
         the GPU (of a tracer `engine=hierarchy`)"
    )]
    OnCpu {
        /// Name of the first such pass.
        pass: String,
        /// File, line and column of the pass in the graph document, as text.
        place: String,
    },
    /// wgpu refused the commands of a frame that [`Executor::submit`](crate::Executor::submit) has
    /// submitted, for example because an import was destroyed. The frame never ran.
    #[error("wgpu refused the commands of frame {frame}: {message}")]
    Refused {
        /// Number of the frame.
        frame: u32,
        /// wgpu's message.
        message: String,
    },
    /// The frame that [`Executor::finish`](crate::Executor::finish) waits for was encoded and has
    /// not run, so that it has no report.
    #[error(
        "frame {frame} has not run: its encoder was dropped or is not submitted, or wgpu refused \
         its commands; encode another frame and submit it"
    )]
    NotRun {
        /// Number of the frame, as [`Executor::encode`](crate::Executor::encode) returned it.
        frame: u32,
    },
    /// GPU timestamps could not be taken; the text is the reason.
    #[error("timestamps could not be taken: {0}")]
    Timing(String),
    /// A bug in this crate; the text says which assumption failed.
    #[error("internal error: {0}")]
    Internal(&'static str),
}

/// Says how a provided resource differs from the description that the graph was planned for.
fn change(name: &str, planned: &Option<Provided>, given: &Option<Provided>) -> String {
    let Some(planned) = planned else {
        return format!("the provider has `{name}` now, but the graph was planned without it");
    };
    let Some(given) = given else {
        return format!("the provider no longer has `{name}`, with which the graph was planned");
    };
    if let (Some(planned), Some(given)) = (&planned.kind, &given.kind)
        && planned != given
    {
        let (planned, given) = (planned.word(), given.word());
        return format!("`{name}` is {given} now, but the graph was planned for {planned}");
    }
    let count = |provided: &Provided| match provided.items {
        Some(items) => format!("{items} items of {} bytes", provided.stride),
        None => format!("items of {} bytes", provided.stride),
    };
    if planned.binding == given.binding {
        let (planned, given) = (count(planned), count(given));
        return format!("`{name}` has {given} now, but the graph was planned for {planned}");
    }
    let (planned, given) = (planned.binding, given.binding);
    format!("`{name}` is bound as {given:?} now, but the graph was planned for {planned:?}")
}

/// Runs `make` inside error scopes and returns errors of wgpu as an error. A panic becomes an
/// error, too: wgpu validates and compiles shaders once more, and naga panics on some.
pub(crate) fn scoped<T>(
    device: &wgpu::Device,
    name: &str,
    make: impl FnOnce() -> T,
) -> Result<T, ExecuteError> {
    let scopes = [
        wgpu::ErrorFilter::OutOfMemory,
        wgpu::ErrorFilter::Internal,
        wgpu::ErrorFilter::Validation,
    ]
    .map(|filter| device.push_error_scope(filter));
    let made = caught(make);
    // Scopes are a stack: the last one pushed is popped first.
    let from_last = scopes.into_iter().rev();
    #[cfg(target_arch = "wasm32")]
    let errors = from_last.filter_map(|scope| crate::late::note(name, scope));
    #[cfg(not(target_arch = "wasm32"))]
    let errors = from_last.filter_map(|scope| pollster::block_on(scope.pop()));
    let errors: Vec<wgpu::Error> = errors.collect();
    let made = made.map_err(|panicked| ExecuteError::Panicked {
        name: format!("`{name}`"),
        panicked,
    })?;
    match errors.into_iter().next() {
        None => Ok(made),
        Some(error) => Err(refusal(name, &error)),
    }
}

/// The error of a refused resource, or of a pass or frame with this name.
pub(crate) fn refusal(name: &str, error: &wgpu::Error) -> ExecuteError {
    let name = name.to_owned();
    match error {
        wgpu::Error::OutOfMemory { .. } => {
            let table = String::new();
            ExecuteError::OutOfMemory { name, table }
        }
        wgpu::Error::Validation { description, .. } | wgpu::Error::Internal { description, .. } => {
            let message = description.trim().to_owned();
            ExecuteError::Resource { name, message }
        }
    }
}

/// The error of a panic while the host's encoder is written to.
pub(crate) fn in_encoder(panicked: Panicked) -> ExecuteError {
    let name = "the encoder".to_owned();
    if panicked.message.contains("Cannot get ") {
        let way_out = "make it by the executor's device";
        return ExecuteError::OtherDevice { name, way_out };
    }
    ExecuteError::Panicked { name, panicked }
}

/// Submits the commands of the frame with this number, or a part of them.
///
/// # Errors
/// [`ExecuteError::Refused`].
pub(crate) fn submit(
    (device, queue): (&wgpu::Device, &wgpu::Queue),
    encoder: wgpu::CommandEncoder,
    frame: u32,
) -> Result<(), ExecuteError> {
    let submitted = scoped(device, "frame", || queue.submit([encoder.finish()]));
    match submitted {
        Err(ExecuteError::Resource { message, .. }) => {
            Err(ExecuteError::Refused { frame, message })
        }
        other => other.map(drop),
    }
}

/// Adds the name and place of a pass to an error of creating something for it.
pub(crate) fn named(error: ExecuteError, pass: &LinkedPass) -> ExecuteError {
    let (pass, place) = (pass.name.value.clone(), pass.name.span.to_string());
    match error {
        ExecuteError::Resource { message, .. } => ExecuteError::Gpu {
            pass,
            place,
            message,
        },
        ExecuteError::Panicked { panicked, .. } => {
            let name = format!("{place}: pass `{pass}`");
            ExecuteError::Panicked { name, panicked }
        }
        other => other,
    }
}

/// Adds the table of the plan's largest resources to an out-of-memory error.
pub(crate) fn with_table(error: ExecuteError, plan: &Plan) -> ExecuteError {
    match error {
        ExecuteError::OutOfMemory { name, .. } => ExecuteError::OutOfMemory {
            name,
            table: plan.memory_table(),
        },
        other => other,
    }
}

impl From<Diagnostics> for ExecuteError {
    fn from(diagnostics: Diagnostics) -> Self {
        Self::Plan(Box::new(diagnostics))
    }
}

/// Waits until all submitted work is done; returns false if that takes longer than `timeout`.
pub(crate) fn wait(device: &wgpu::Device, timeout: Option<Duration>) -> Result<bool, ExecuteError> {
    let until_done = wgpu::PollType::Wait {
        submission_index: None,
        timeout,
    };
    poll(device, until_done)
}

/// Polls the device for finished work; returns false if a timeout came first.
pub(crate) fn poll(device: &wgpu::Device, how: wgpu::PollType) -> Result<bool, ExecuteError> {
    // wgpu panics where a device is lost while it is waited for.
    let polled = caught(|| device.poll(how));
    match polled {
        Ok(Ok(_)) => Ok(true),
        Ok(Err(wgpu::PollError::Timeout)) => Ok(false),
        Ok(Err(error)) => Err(ExecuteError::DeviceLost(error.to_string())),
        // wgpu-core 30 panics if another thread's poll ends the work between the end of this one's
        // timeout and its look at the queue.
        Err(panicked) if panicked.message.starts_with("If the queue is empty") => Ok(false),
        Err(panicked) => Err(ExecuteError::DeviceLost(panicked.to_string())),
    }
}
