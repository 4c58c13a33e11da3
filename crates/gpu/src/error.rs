//! Errors of a device, and the scopes that catch them.

use skiagraph_graph::{Diagnostics, Panicked, Plan, Provided, caught};
use std::time::Duration;

/// Why a plan could not be allocated or a frame not be run.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExecuteError {
    /// wgpu refused something that a pass needs.
    #[error("{place}: pass `{pass}` was refused by the device: {message}")]
    Gpu {
        /// The pass.
        pass: String,
        /// Its place in the document.
        place: String,
        /// wgpu's words.
        message: String,
    },
    /// wgpu refused to make a resource.
    #[error("`{name}` could not be made: {message}")]
    Resource {
        /// The resource.
        name: String,
        /// wgpu's words.
        message: String,
    },
    /// wgpu, naga, the driver's layer or a provider panicked: a mistake of theirs.
    #[error(
        "{name}: {panicked}; this is a mistake of the library, which may take the same written \
         differently"
    )]
    Panicked {
        /// The resource, or the pass with its place in the document.
        name: String,
        /// The panic.
        panicked: Panicked,
    },
    /// The device has no memory for this.
    #[error("the device has not enough memory for `{name}`")]
    OutOfMemory {
        /// The resource or pass.
        name: String,
        /// Largest resources of the graph: [`Plan::memory_table`].
        table: String,
    },
    /// A provided resource could not be built.
    #[error("the provided resource `{name}` could not be built: {why}")]
    Provider {
        /// The resource.
        name: String,
        /// The provider's words.
        why: String,
    },
    /// A provided resource is another than the graph was planned for: other numbers of items, or
    /// another kind of light.
    #[error(
        "{}: plan the graph anew (`executor.plan().with(|request| request.provider = …)`) and hand \
         the plan to `replace_graph`",
        change(name, planned, given)
    )]
    OtherThanPlanned {
        /// The resource.
        name: String,
        /// The provider's description when the graph was planned.
        planned: Provided,
        /// Its description now.
        given: Provided,
    },
    /// A pass reads a provided resource that the host has not set yet.
    #[error("{place}: pass `{pass}` reads `{name}`, which is not there yet: {why}")]
    NotProvided {
        /// The resource.
        name: String,
        /// The first pass that reads it.
        pass: String,
        /// The pass's place in the document.
        place: String,
        /// The provider's word for it: [missing](crate::Provider::missing).
        why: String,
    },
    /// An import that the plan does not know.
    #[error("the plan has no import `{name}`; it has {known}")]
    NoSuchImport {
        /// The name.
        name: String,
        /// Names that exist.
        known: String,
    },
    /// The changed name is neither an import nor a provided resource.
    #[error(
        "neither an import nor a provided resource is called `{name}`; live passes use {known}"
    )]
    NotOfHost {
        /// The name.
        name: String,
        /// Names that exist.
        known: String,
    },
    /// An import is not what the plan was made for.
    #[error(
        "`{name}` cannot be imported where another was planned for: {why}; plan again with what \
         it is"
    )]
    Import {
        /// The name.
        name: String,
        /// How they differ.
        why: String,
    },
    /// A pass uses an import that the host has not handed over.
    #[error(
        "{place}: pass `{pass}` uses the import `{name}`, which was not handed over: call \
         `import_texture`, `import_buffer` or `import_sampler` first"
    )]
    NotImported {
        /// The import.
        name: String,
        /// The first pass that uses it.
        pass: String,
        /// The pass's place in the document.
        place: String,
    },
    /// The request cannot be planned.
    #[error("{0}")]
    Plan(Box<Diagnostics>),
    /// A readback that the plan does not know.
    #[error("the plan has no output `{name}`; it has {known}")]
    NoSuchOutput {
        /// The name.
        name: String,
        /// Names that exist.
        known: String,
    },
    /// A readback of something that the host made for other purposes.
    #[error("`{name}` cannot be read back: the host must make it with {usage}")]
    NotReadable {
        /// The output.
        name: String,
        /// Usage that it lacks.
        usage: &'static str,
    },
    /// A readback did not arrive.
    #[error("the content of `{name}` could not be read back")]
    Readback {
        /// The output.
        name: String,
    },
    /// The device was lost or did not answer.
    #[error("the device was lost: {0}")]
    DeviceLost(String),
    /// The GPU had not finished a frame in the time that it was given, and may never do so.
    #[error(
        "the GPU was not done with the frame after {:.1} s; in it ran {passes}",
        after.as_secs_f64()
    )]
    Unfinished {
        /// How long it was waited for.
        after: Duration,
        /// The passes of the frame.
        passes: String,
    },
    /// A frame is waited for whose encoder was not submitted.
    #[error("the frame that is waited for was encoded, but not submitted")]
    NotSubmitted,
    /// Timestamps could not be taken.
    #[error("timestamps could not be taken: {0}")]
    Timing(String),
    /// A mistake of this crate.
    #[error("internal error: {0}")]
    Internal(&'static str),
}

/// How a provided resource differs from what was planned for.
fn change(name: &str, planned: &Provided, given: &Provided) -> String {
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

/// Runs `make` inside error scopes, so that what wgpu finds wrong comes back as an error, and so
/// does a panic: wgpu validates shaders once more and compiles them, and naga panics on some.
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
    let errors: Vec<wgpu::Error> = scopes
        .into_iter()
        .rev()
        .filter_map(|scope| pollster::block_on(scope.pop()))
        .collect();
    let made = made.map_err(|panicked| ExecuteError::Panicked {
        name: format!("`{name}`"),
        panicked,
    })?;
    match errors.into_iter().next() {
        None => Ok(made),
        Some(wgpu::Error::OutOfMemory { .. }) => Err(ExecuteError::OutOfMemory {
            name: name.to_owned(),
            table: String::new(),
        }),
        Some(error) => Err(ExecuteError::Resource {
            name: name.to_owned(),
            message: chain(&error),
        }),
    }
}

/// The error of something that a pass needs.
pub(crate) fn named(error: ExecuteError, pass: &str, place: &str) -> ExecuteError {
    match error {
        ExecuteError::Resource { message, .. } => ExecuteError::Gpu {
            pass: pass.to_owned(),
            place: place.to_owned(),
            message,
        },
        ExecuteError::Panicked { panicked, .. } => ExecuteError::Panicked {
            name: format!("{place}: pass `{pass}`"),
            panicked,
        },
        other => other,
    }
}

/// The error of making or running what a plan says; without memory it shows where the plan's went.
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

/// Waits until all that was submitted is done; false if it is not after so long a time.
pub(crate) fn wait(device: &wgpu::Device, timeout: Option<Duration>) -> Result<bool, ExecuteError> {
    let all = wgpu::PollType::Wait {
        submission_index: None,
        timeout,
    };
    poll(device, all)
}

/// Looks what of the submitted work is done; false if a timeout came first.
pub(crate) fn poll(device: &wgpu::Device, how: wgpu::PollType) -> Result<bool, ExecuteError> {
    // wgpu panics where a device is lost while it is waited for.
    let polled = caught(|| device.poll(how));
    match polled {
        Ok(Ok(_)) => Ok(true),
        Ok(Err(wgpu::PollError::Timeout)) => Ok(false),
        Ok(Err(error)) => Err(ExecuteError::DeviceLost(error.to_string())),
        Err(_) => Err(ExecuteError::DeviceLost(
            "it was lost while its work was waited for".to_owned(),
        )),
    }
}

fn chain(error: &wgpu::Error) -> String {
    match error {
        wgpu::Error::Validation { description, .. } | wgpu::Error::Internal { description, .. } => {
            description.trim().to_owned()
        }
        wgpu::Error::OutOfMemory { .. } => "out of memory".to_owned(),
    }
}
