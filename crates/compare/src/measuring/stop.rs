//! Reason why the frames of a method ended early.

use crate::error::{CompareError, Result, explain, is_fatal};
use crate::graphs::method::Method;
use crate::measuring::frame;
use crate::sink::Session;
use skiagraph_gpu::ExecuteError;

/// Reason why the frames of a method ended early.
pub enum Stop {
    /// The device refuses the method, for example for want of memory, or is lost.
    Refused(Box<ExecuteError>),
    /// Any other error, such as an early end that the sink asked for.
    Failed(CompareError),
}

impl Stop {
    /// Converts the reason into the error that ends the command. `graph` is the graph's name for
    /// messages.
    pub fn into_error(self, session: Session, graph: &str) -> CompareError {
        match self {
            Self::Refused(error) => frame::failed(session, graph, *error),
            Self::Failed(error) => error,
        }
    }
}

impl From<ExecuteError> for Stop {
    fn from(error: ExecuteError) -> Self {
        Self::Refused(Box::new(error))
    }
}

impl From<CompareError> for Stop {
    fn from(error: CompareError) -> Self {
        Self::Failed(error)
    }
}

/// Splits the errors of running a method. The inner error is the reason why the device refuses this
/// method; other methods may still run. The outer one ends the work on all methods.
///
/// # Errors
/// [`Stop::Failed`], an early end and a lost device.
pub fn attempt<T>(
    session: Session,
    method: &Method,
    outcome: Result<T, impl Into<Stop>>,
) -> Result<Result<T, String>> {
    match outcome.map_err(Into::into) {
        Ok(outcome) => Ok(Ok(outcome)),
        Err(Stop::Refused(error)) if !is_fatal(&error) => Ok(Err(explain(&error))),
        Err(stop) => Err(stop.into_error(session, &method.name)),
    }
}
