//! What a hostile input may cost: used by the tests of several crates.

use std::time::{Duration, Instant};

/// Ten times the slowest input in a debug build, and half of what 4000 misspelt names took that were each compared with as many.
const LONGEST: Duration = Duration::from_secs(10);

/// Peak of the whole process, whatever else its tests hold meanwhile: less than 0.2 GiB.
const MOST_MIB: u64 = 2048;

/// Runs `work` on an input.
///
/// # Panics
/// Names the input by its beginning, if that took too long, or if the process needed more memory than ever before and than it may.
#[track_caller]
pub fn bounded<T>(input: &str, work: impl FnOnce() -> T) -> T {
    let (before, begin) = (peak_mib(), Instant::now());
    let answer = work();
    let (took, after) = (begin.elapsed(), peak_mib());
    let name: String = input.chars().take(240).collect();
    assert!(
        took <= LONGEST,
        "it took {took:.1?}, {LONGEST:?} at most, for {} bytes: {name}",
        input.len()
    );
    assert!(
        after <= MOST_MIB || after == before,
        "the peak of memory rose from {before} to {after} MiB, {MOST_MIB} at most, over {} bytes: {name}",
        input.len()
    );
    answer
}

/// The most memory that this process ever held. 0 where no system says so: nothing is judged there.
fn peak_mib() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let kib = status.lines().find_map(|line| {
        let number = line.strip_prefix("VmHWM:")?.trim().strip_suffix(" kB")?;
        number.parse::<u64>().ok()
    });
    assert!(kib.is_some() || !cfg!(target_os = "linux"), "{status}");
    kib.unwrap_or(0) >> 10
}
