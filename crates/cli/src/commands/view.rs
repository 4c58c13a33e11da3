//! `skiagraph view`: methods in a window.

use crate::args::commands::ViewArgs;
use crate::args::shared::GpuArgs;
use crate::error::CliError;

/// Opens the window.
///
/// # Errors
/// No display, no GPU, a method or a param that there is not.
#[cfg(feature = "window")]
pub fn view(args: &ViewArgs, gpu: &GpuArgs) -> Result<(), CliError> {
    crate::viewer::open(args, gpu)
}

/// Says why there is no window.
///
/// # Errors
/// Always.
#[cfg(not(feature = "window"))]
pub fn view(_: &ViewArgs, _: &GpuArgs) -> Result<(), CliError> {
    Err(CliError::Input(
        "this program was built without its window; build it with the feature `window`, which is \
         on unless --no-default-features is given"
            .into(),
    ))
}
