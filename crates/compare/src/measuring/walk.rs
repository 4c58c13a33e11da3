//! Runs a method over the frames of a camera path, and judges each frame.

use crate::graphs::method::Method;
use crate::measuring::frame::{self, Contents};
use crate::measuring::run::MeasureContext;
use crate::measuring::sequence::{Account, cost, ms};
use crate::measuring::stop::Stop;
use crate::measuring::timing::{made_since, timed_frame};
use crate::records::samples::{TimedFrame, Upkeep};
use crate::records::sequence::Remade;
use crate::sink::Step;
use skiagraph_gpu::{Executor, Frame};
use skiagraph_passes::{Built, How, SceneProvider};
use std::time::{Duration, Instant};

impl MeasureContext<'_> {
    /// Runs a method over a camera path and judges each frame; passes whose inputs have not changed
    /// are skipped. Before the path begins, its first frame is drawn for the protocol's warm-up
    /// frames, unless the method has `remembered` it already. Returns the times of the frames.
    ///
    /// # Errors
    /// A method that the device refuses; an early end; a lost device; outputs whose size, format or
    /// values a shadow method must not have.
    pub fn follow(
        &self,
        (method, remembered): (&Method, bool),
        executor: &mut Executor,
        provider: &mut SceneProvider,
        (account, step): (&mut Account, &Step),
    ) -> Result<Vec<TimedFrame>, Stop> {
        let (warmup, layer) = (self.protocol.warmup, self.layer(executor.plan()));
        let request = Frame::new().with_all(true);
        for _ in 0..if remembered { 0 } else { warmup } {
            frame::run(self.session, executor, &request)?;
        }
        let mut times = Vec::new();
        for index in 0..self.path.frames.poses.len() {
            let (contents, timed, remade) = self.frame(method, executor, provider, index)?;
            let (outputs, judgement) = self.judgement(method, index, layer, contents)?;
            account.add(self.path, index, outputs, judgement)?;
            if let Some(frame) = account.frames.last_mut() {
                frame.cost = cost(&timed, self.timestamps);
                (frame.skipped, frame.remade) = (timed.skipped.clone(), remade);
            }
            times.push(timed);
            step.set_done(u64::from(warmup) + index as u64 + 1);
        }
        Ok(times)
    }

    /// Runs a frame of a path; returns its outputs, its times, and the resources that were made for
    /// it.
    fn frame(
        &self,
        method: &Method,
        executor: &mut Executor,
        provider: &mut SceneProvider,
        index: usize,
    ) -> Result<(Contents, TimedFrame, Vec<Remade>), Stop> {
        let (session, frames) = (self.session, self.path.frames);
        session.check_stopped()?;
        frames.show(index, executor.plan().viewport(), provider)?;
        let (built, uploaded) = (provider.built().to_vec(), provider.work().uploaded);
        let began = Instant::now();
        executor.refresh(provider)?;
        let upkeep = Upkeep {
            time: began.elapsed(),
            uploaded: provider.work().uploaded - uploaded,
        };
        let remade = made_since(&built, provider.built()).map(remade).collect();
        let read = method.preset.judged();
        let request = Frame::new()
            .with_timing(true)
            .with_read(&read)
            .with_seconds(frames.seconds(index));
        let (mut report, wall) = frame::run(session, executor, &request)?;
        // As a host does it: between frames, by the counts that have arrived.
        executor.grow(provider)?;
        let contents = frame::contents(std::mem::take(&mut report.readbacks));
        let mut timed = timed_frame(report, Duration::ZERO, wall)?;
        timed.upkeep = Some(upkeep);
        Ok((contents, timed, remade))
    }
}

fn remade(built: &Built) -> Remade {
    Remade {
        name: built.name.to_owned(),
        how: match built.how {
            How::Made => "made",
            How::Refitted => "refitted",
        }
        .to_owned(),
        ms: ms(built.time),
    }
}
