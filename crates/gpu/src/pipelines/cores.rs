//! Work on all cores.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

/// Stack of a thread, as large as that of most main threads: compilers of shaders recurse.
const STACK: usize = 8 << 20;

/// Calls `work` for each item, on all cores, and returns the results in the order of the items. A
/// browser tells of no cores, and gets one.
pub(super) fn on_all_cores<T: Sync, R: Send + Sync>(
    items: &[T],
    work: impl Fn(&T) -> R + Sync,
) -> Vec<R> {
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let results: Vec<OnceLock<R>> = items.iter().map(|_| OnceLock::new()).collect();
    let next = AtomicUsize::new(0);
    let take = || {
        let numbers = std::iter::repeat_with(|| next.fetch_add(1, Ordering::Relaxed));
        for (item, result) in numbers.map_while(|at| items.get(at).zip(results.get(at))) {
            result.get_or_init(|| work(item));
        }
    };
    thread::scope(|scope| {
        for _ in 1..cores.min(items.len()) {
            // Where there can be no further thread, the others do its work.
            let thread = thread::Builder::new().stack_size(STACK);
            let _ = thread.spawn_scoped(scope, take);
        }
        take();
    });
    let results = results.into_iter();
    results.filter_map(OnceLock::into_inner).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_have_the_order_of_the_items() {
        let items: Vec<u32> = (0..1000).collect();
        let doubled: Vec<u32> = (0..1000).map(|item| 2 * item).collect();
        assert_eq!(on_all_cores(&items, |item| 2 * item), doubled);
        assert!(on_all_cores(&items[..0], |item| 2 * item).is_empty());
    }
}
