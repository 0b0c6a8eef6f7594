//! One computation for each of many indices, shared out among threads: the results in order, whatever the threads.

use std::ops::Range;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Chunks that a thread takes on the average: enough of them that all threads end at about the same time.
const CHUNKS_PER_THREAD: usize = 32;

/// `compute(0), compute(1), .. compute(count - 1)`, on as many threads; 0 and 1 mean the caller's own.
///
/// Chunks are taken as threads become free, so slow indices do not hold up the others.
pub fn in_order<T: Send>(count: usize, threads: usize, compute: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let threads = threads.clamp(1, count.max(1));
    if threads == 1 {
        return (0..count).map(compute).collect();
    }
    let size = (count / (threads * CHUNKS_PER_THREAD)).max(1);
    let next = AtomicUsize::new(0);
    let take = || -> Option<Range<usize>> {
        let start = next.fetch_add(size, Ordering::Relaxed);
        (start < count).then(|| start..count.min(start + size))
    };
    let work = || -> Vec<(usize, Vec<T>)> {
        std::iter::from_fn(take)
            .map(|chunk| (chunk.start, chunk.map(&compute).collect()))
            .collect()
    };
    let mut chunks: Vec<(usize, Vec<T>)> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        workers
            .into_iter()
            .flat_map(|worker| worker.join().unwrap_or_else(|cause| resume_unwind(cause)))
            .collect()
    });
    chunks.sort_unstable_by_key(|chunk| chunk.0);
    chunks.into_iter().flat_map(|chunk| chunk.1).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn results_stand_in_the_order_of_their_indices_for_any_count_and_threads() {
        for count in [0, 1, 2, 63, 1000] {
            let want: Vec<usize> = (0..count).map(|i| 3 * i + 1).collect();
            for threads in [0, 1, 2, 7, 64] {
                assert_eq!(in_order(count, threads, |i| 3 * i + 1), want, "{count} {threads}");
            }
        }
    }

    #[test]
    fn a_slow_index_does_not_hold_up_the_others() {
        let owners = in_order(64, 2, |i| {
            std::thread::sleep(Duration::from_millis(if i == 0 { 200 } else { 1 }));
            std::thread::current().id()
        });
        let with_the_slow_one = owners.iter().filter(|&&id| id == owners[0]).count();
        assert!(with_the_slow_one < 32, "{with_the_slow_one}");
    }

    #[test]
    #[should_panic(expected = "index 5")]
    fn a_panic_of_one_index_reaches_the_caller() {
        in_order(10, 2, |i| assert!(i != 5, "index {i}"));
    }
}
