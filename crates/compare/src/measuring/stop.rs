//! Why a method's frames ended early.

use crate::error::{CompareError, explain, is_fatal};
use crate::graphs::method::Method;
use crate::measuring::frame;
use crate::sink::Session;
use skiagraph_gpu::ExecuteError;

/// Why a method's frames ended early.
pub enum Stop {
    /// The device refuses the method, or is lost.
    Refused(Box<ExecuteError>),
    /// Any other error.
    Failed(CompareError),
}

impl Stop {
    /// Converts the reason into the error that ends all further work on `graph`.
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

/// Turns the result of running a method into one whose inner error is the reason why the device
/// refuses this method, and whose outer error ends other methods, too.
///
/// # Errors
/// An early end, a lost device, and all errors that end more than this method.
pub fn attempt<T>(
    session: Session,
    method: &Method,
    came: Result<T, Stop>,
) -> Result<Result<T, String>, CompareError> {
    match came {
        Ok(came) => Ok(Ok(came)),
        Err(Stop::Refused(error)) if !is_fatal(&error) => Ok(Err(explain(&error))),
        Err(stop) => Err(stop.into_error(session, &method.name)),
    }
}
