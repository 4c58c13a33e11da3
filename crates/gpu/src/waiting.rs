//! Waits for a GPU. All other code is `async` as far as it waits, so that a host that cannot wait,
//! such as a window's event loop, can drive it as well.

use crate::error::poll;
use std::{
    cell::RefCell,
    future::poll_fn,
    pin::pin,
    sync::Arc,
    task::{Context, Poll, Wake, Waker},
    thread::Thread,
    time::Duration,
};

/// How often a future that waits for a GPU is asked whether it gives up.
const INTERVAL: Duration = Duration::from_millis(100);

thread_local! {
    /// The device that the future of this thread waits for.
    static WAITED_FOR: RefCell<Option<wgpu::Device>> = const { RefCell::new(None) };
}

/// Lets the caller go on when all work submitted to `queue` is done, and whenever its future is
/// polled before. [`block_on`] does so every tenth of a second.
pub async fn submitted_work(device: &wgpu::Device, queue: &wgpu::Queue) {
    let mut is_told = false;
    poll_fn(|context| {
        if is_told {
            return Poll::Ready(());
        }
        is_told = true;
        let waker = context.waker().clone();
        queue.on_submitted_work_done(move || waker.wake());
        WAITED_FOR.set(Some(device.clone()));
        Poll::Pending
    })
    .await;
}

struct Unpark(Thread);

impl Wake for Unpark {
    fn wake(self: Arc<Self>) {
        self.0.unpark();
    }
}

/// Runs a future to its end on this thread. Where the future waits for a GPU
/// ([`submitted_work`]), so does the thread.
pub fn block_on<T>(future: impl Future<Output = T>) -> T {
    let waker = Waker::from(Arc::new(Unpark(std::thread::current())));
    let mut future = pin!(future);
    loop {
        if let Poll::Ready(output) = future.as_mut().poll(&mut Context::from_waker(&waker)) {
            return output;
        }
        match WAITED_FOR.take() {
            // The future tells if the device is lost.
            Some(device) => drop(poll(
                &device,
                wgpu::PollType::Wait {
                    submission_index: None,
                    timeout: Some(INTERVAL),
                },
            )),
            None => std::thread::park(),
        }
    }
}
