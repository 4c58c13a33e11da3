//! GPU timestamps are true, or the adapter is not trusted with a reason.

use skiagraph_graph::{
    gpu,
    timing::{Trust, check},
};

#[test]
fn a_long_dispatch_after_a_raster_pass_is_timed_truly_or_not_at_all() {
    let gpu = gpu::open(None).unwrap_or_else(|error| panic!("{error}"));
    let adapter = gpu.adapter.get_info().name;
    match check(&gpu.device, &gpu.queue).expect("the check's graph runs") {
        Trust::Trusted => {}
        // The software adapter of CI has the trap and the way around it, so there is no excuse.
        Trust::Untrusted { reason } => assert!(
            !adapter.contains("llvmpipe") && !reason.is_empty(),
            "{adapter}: {reason}"
        ),
    }
}
