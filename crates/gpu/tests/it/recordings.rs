//! Commands in encoders of the host, which run, are lost, or come in another order.

use crate::host::{GPU, LOSSES, encoder, lose};
use skiagraph_gpu::Recordings;

#[test]
fn commands_are_kept_until_they_have_run_in_order() {
    let device = &GPU.device;
    let mut kept = Recordings::default();
    let record = |kept: &mut Recordings<_>, name: &'static str| {
        let mut encoder = encoder();
        kept.keep(name, device, &mut encoder).unwrap();
        encoder
    };
    let run = |encoders: Vec<wgpu::CommandEncoder>| {
        let commands = encoders.into_iter().map(wgpu::CommandEncoder::finish);
        GPU.queue.submit(commands);
        device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    };
    let pending = |kept: &Recordings<_>| kept.iter().copied().collect::<Vec<&str>>();
    let first = record(&mut kept, "first");
    assert!(kept.lost(device).unwrap().is_empty());
    assert_eq!(pending(&kept), ["first"]);
    run(vec![first]);
    assert!(kept.lost(device).unwrap().is_empty());
    assert!(pending(&kept).is_empty());

    for loss in LOSSES {
        let names = ["before", "lost", "behind"];
        let [before, lost, behind] = names.map(|name| record(&mut kept, name));
        lose(lost, loss);
        device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
        assert_eq!(kept.lost(device).unwrap(), ["lost", "behind"], "{loss:?}");
        assert_eq!(pending(&kept), ["before"]);
        run(vec![before, behind]);
        assert!(kept.lost(device).unwrap().is_empty());
        assert!(pending(&kept).is_empty());
    }

    let [early, late] = ["early", "late"].map(|name| record(&mut kept, name));
    run(vec![late, early]);
    assert_eq!(kept.lost(device).unwrap(), ["early", "late"]);
    record(&mut kept, "taken");
    assert_eq!(kept.take(), ["taken"]);
}
