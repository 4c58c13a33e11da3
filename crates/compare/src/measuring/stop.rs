//! Why a method's frames ended early.

use crate::error::CompareError;
use crate::measuring::frame;
use crate::sink::Session;
use skiagraph_gpu::ExecuteError;

/// Why a method's frames ended early.
pub enum Stop {
    /// The device refuses it, or is lost.
    Refused(Box<ExecuteError>),
    /// All else.
    Failed(CompareError),
}

impl Stop {
    /// As an error that ends what was to come of `graph`.
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
