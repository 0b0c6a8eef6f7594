//! Work shared out among threads.

use crate::stopping;
use core::time::Duration;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread::Thread;

/// Chunks that a thread takes on the average: enough of them that all threads end at about the same time.
const CHUNKS_PER_THREAD: usize = 32;

/// How long the caller's thread rests while others work, before it asks whether the work is still wanted.
const REST: Duration = Duration::from_millis(20);

/// A thread that works: the caller's is woken as the last one ends, be it by a panic.
struct Working<'a> {
    left: &'a AtomicUsize,
    caller: &'a Thread,
}

impl Drop for Working<'_> {
    fn drop(&mut self) {
        if self.left.fetch_sub(1, Ordering::Release) == 1 {
            self.caller.unpark();
        }
    }
}

/// Does some work on each item, on as many threads; 0 and 1 mean the caller's own.
///
/// Items are taken as threads become free, so slow ones do not hold up the others.
pub fn for_each<T: Send>(
    items: impl ExactSizeIterator<Item = T> + Send,
    threads: usize,
    work: impl Fn(T) + Sync,
) {
    let threads = threads.min(items.len());
    if threads < 2 {
        return items.for_each(|item| {
            stopping::ask();
            work(item);
        });
    }
    let items = Mutex::new(items);
    // nothing can go wrong while it is held
    let take = || items.lock().unwrap_or_else(PoisonError::into_inner).next();
    let (asked, caller) = (stopping::asked(), std::thread::current());
    let left = AtomicUsize::new(threads);
    let run = || {
        let _working = Working { left: &left, caller: &caller };
        stopping::asking(asked.clone(), || {
            std::iter::from_fn(take).for_each(|item| {
                stopping::ask();
                work(item);
            });
        });
    };
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(run)).collect();
        while left.load(Ordering::Acquire) > 0 {
            std::thread::park_timeout(REST);
            stopping::ask();
        }
        for worker in workers {
            worker.join().unwrap_or_else(|cause| resume_unwind(cause));
        }
    });
}

/// `compute(0), compute(1), .. compute(count - 1)`, in this order whatever the threads.
pub fn in_order<T: Send>(count: usize, threads: usize, compute: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let size = (count / (threads.max(1) * CHUNKS_PER_THREAD)).max(1);
    let mut results: Vec<Option<T>> = (0..count).map(|_| None).collect();
    for_each(
        results.chunks_mut(size).enumerate(),
        threads,
        |(chunk, results)| {
            for (k, result) in results.iter_mut().enumerate() {
                stopping::piece();
                *result = Some(compute(chunk * size + k));
            }
        },
    );
    results.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

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
        let done = AtomicUsize::new(0);
        // the first waits for all others, which ends only if another thread takes them
        let waited = in_order(64, 2, |i| {
            let others = || done.load(Ordering::Relaxed);
            if i > 0 {
                done.fetch_add(1, Ordering::Relaxed);
            } else {
                (0..100_000_000)
                    .take_while(|_| others() < 63)
                    .for_each(|_| std::thread::yield_now());
            }
            others()
        });
        assert_eq!(waited[0], 63);
    }

    #[test]
    #[should_panic(expected = "index 5")]
    fn a_panic_of_one_index_reaches_the_caller() {
        in_order(10, 2, |i| assert!(i != 5, "index {i}"));
    }
}
