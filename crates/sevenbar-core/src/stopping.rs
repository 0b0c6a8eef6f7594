//! Long work that its caller may stop: between its pieces it checks whether it is still wanted.
//!
//! What works deep within loops has no way to return early that would not pass through every function above it. So work that is no
//! longer wanted unwinds its stack up to [`stoppable`], which reports it. It leaves nothing behind: results are built
//! on the way, and the only state outside, the cache of start systems, is written once each is whole.

use std::cell::{Cell, RefCell};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;

/// After so many pieces of work, of some microseconds each, the caller is asked whether to go on.
const PIECES: u32 = 256;

/// Who wants some work, and answers whether to go on from every thread that has a share in it.
pub trait Caller: Send + Sync {
    /// Whether the work is still wanted.
    fn still_wants(&self) -> bool;
}

/// Work ended before it had a result, since it was no longer wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stopped;

thread_local! {
    static ASKED: RefCell<Option<Arc<dyn Caller>>> = const { RefCell::new(None) };
    static LEFT: Cell<u32> = const { Cell::new(PIECES) };
}

/// On drop, the thread asks its earlier caller again.
struct Before(Option<Arc<dyn Caller>>);

impl Drop for Before {
    fn drop(&mut self) {
        let before = self.0.take();
        ASKED.with(|asked| *asked.borrow_mut() = before);
    }
}

/// Does some work as long as it is wanted.
///
/// # Errors
/// [`Stopped`] where it no longer was; a panic goes on.
pub fn stoppable<T>(caller: Arc<dyn Caller>, work: impl FnOnce() -> T) -> Result<T, Stopped> {
    catch_unwind(AssertUnwindSafe(|| asking(Some(caller), work))).map_err(|cause| {
        match cause.downcast::<Stopped>() {
            Ok(stopped) => *stopped,
            Err(other) => resume_unwind(other),
        }
    })
}

/// The caller that this thread asks, if any.
pub(crate) fn asked() -> Option<Arc<dyn Caller>> {
    ASKED.with(|asked| asked.borrow().clone())
}

/// Does a share of some work in this thread, asking this caller; if it is stopped, it unwinds.
pub(crate) fn asking<T>(caller: Option<Arc<dyn Caller>>, work: impl FnOnce() -> T) -> T {
    let _before = Before(ASKED.with(|asked| asked.replace(caller)));
    ask();
    work()
}

/// Counts a piece of work, and asks now and then whether it is to go on.
#[inline(always)]
pub(crate) fn piece() {
    let left = LEFT.get();
    if left == 0 {
        ask();
    } else {
        LEFT.set(left - 1);
    }
}

/// Unwinds if the work is no longer wanted.
#[cold]
#[inline(never)]
pub(crate) fn ask() {
    LEFT.set(PIECES);
    // the question may lead to other work, so nothing is borrowed meanwhile
    if asked().is_some_and(|caller| !caller.still_wants()) {
        // no message is printed, as for a panic: it is none
        resume_unwind(Box::new(Stopped));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parallel::in_order;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// Wanted so many times.
    struct Times(AtomicUsize);

    impl Caller for Times {
        fn still_wants(&self) -> bool {
            let left = |n: usize| n.checked_sub(1);
            self.0
                .fetch_update(Ordering::Relaxed, Ordering::Relaxed, left)
                .is_ok()
        }
    }

    fn times(count: usize) -> Arc<Times> {
        Arc::new(Times(AtomicUsize::new(count)))
    }

    #[test]
    fn work_that_is_wanted_has_its_result() {
        assert_eq!(
            stoppable(times(usize::MAX), || (0..1000).map(|_| piece()).count()),
            Ok(1000)
        );
    }

    #[test]
    fn work_without_end_ends_once_it_is_no_longer_wanted() {
        let endless = || {
            loop {
                piece();
            }
        };
        assert_eq!(stoppable::<()>(times(5), endless), Err(Stopped));
        // and the thread is as it was
        assert!(asked().is_none());
        piece();
    }

    #[test]
    fn work_that_is_not_wanted_at_all_is_not_begun() {
        assert_eq!(stoppable(times(0), || unreachable!()), Err(Stopped));
    }

    #[test]
    fn all_threads_of_stopped_work_end() {
        for threads in [1, 2, 7] {
            let endless = |_| {
                loop {
                    piece();
                }
            };
            let found = stoppable(times(20), || in_order::<()>(10, threads, endless));
            assert_eq!(found, Err(Stopped), "{threads}");
        }
    }

    #[test]
    #[should_panic(expected = "a fault")]
    fn a_panic_is_not_taken_for_a_stop() {
        let _ = stoppable(times(usize::MAX), || panic!("a fault"));
    }
}
