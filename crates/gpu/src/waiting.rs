//! Waits for a GPU in a way that a host which cannot wait, such as a window's event loop, can drive
//! as well.

use crate::error::poll;
use std::cell::RefCell;
#[cfg(not(target_arch = "wasm32"))]
use std::future::poll_fn;
use std::pin::pin;
use std::sync::Arc;
use std::task::{Context, Poll, Wake, Waker};
use std::thread::Thread;
use std::time::Duration;
#[cfg(target_arch = "wasm32")]
use wasm_bindgen::prelude::*;
#[cfg(target_arch = "wasm32")]
use wasm_bindgen_futures::JsFuture;

/// How often a future that waits for a GPU is asked whether it gives up.
const INTERVAL: Duration = Duration::from_millis(100);

thread_local! {
    /// The device that a future waits for which [`block_on`] runs on this thread: `None` outside of
    /// it, `Some(None)` where the future waits for none.
    static WAITED_FOR: RefCell<Option<Option<wgpu::Device>>> = const { RefCell::new(None) };
}

/// Lets the caller go on when all work submitted to `queue` is done, and whenever its future is
/// polled before. [`block_on`] does so every tenth of a second, and so does a browser's timer.
pub async fn submitted_work(device: &wgpu::Device, queue: &wgpu::Queue) {
    wait_for(device, queue).await;
}

#[cfg(not(target_arch = "wasm32"))]
async fn wait_for(device: &wgpu::Device, queue: &wgpu::Queue) {
    let mut is_told = false;
    poll_fn(|context| {
        if is_told {
            return Poll::Ready(());
        }
        is_told = true;
        let waker = context.waker().clone();
        queue.on_submitted_work_done(move || waker.wake());
        WAITED_FOR.with_borrow_mut(|waited_for| {
            if let Some(waited_for) = waited_for {
                *waited_for = Some(device.clone());
            }
        });
        Poll::Pending
    })
    .await;
}

/// A promise is kept once, so that no timer that comes late wakes a later wait.
#[cfg(target_arch = "wasm32")]
async fn wait_for(_: &wgpu::Device, queue: &wgpu::Queue) {
    let either = js_sys::Promise::new(&mut |resolve, _| {
        set_timeout(&resolve, INTERVAL.as_millis() as i32);
        queue.on_submitted_work_done(move || drop(resolve.call0(&JsValue::NULL)));
    });
    // It is never broken.
    let _ = JsFuture::from(either).await;
}

#[cfg(target_arch = "wasm32")]
#[wasm_bindgen]
extern "C" {
    /// A browser's timer, in its pages and its workers.
    #[wasm_bindgen(js_name = setTimeout)]
    fn set_timeout(then: &js_sys::Function, milliseconds: i32);
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
    let until_done = wgpu::PollType::Wait {
        submission_index: None,
        timeout: Some(INTERVAL),
    };
    loop {
        let outer = WAITED_FOR.replace(Some(None));
        let polled = future.as_mut().poll(&mut Context::from_waker(&waker));
        let waited_for = WAITED_FOR.replace(outer).flatten();
        match (polled, waited_for) {
            (Poll::Ready(output), _) => return output,
            // The future tells if the device is lost.
            (Poll::Pending, Some(device)) => drop(poll(&device, until_done.clone())),
            (Poll::Pending, None) => std::thread::park(),
        }
    }
}
