//! The core at work while the interpreter is free: Ctrl+C, any other signal, and a caller who has given up end it.

use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use sevenbar_core::stopping::{Caller, stoppable};
use std::cell::{OnceCell, RefCell};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, ThreadId};
use std::time::{Duration, Instant};

/// How long signals may wait while the core works; checking for them takes the interpreter for some microseconds.
const PATIENCE: Duration = Duration::from_millis(50);

thread_local! {
    /// Whether this is Python's main thread, the only one whose signals are handled.
    static IS_MAIN: OnceCell<bool> = const { OnceCell::new() };
    /// Who may stop the work of this thread.
    static STOPS: RefCell<Vec<Arc<AtomicBool>>> = const { RefCell::new(Vec::new()) };
}

/// Stops the work of the core from another thread.
///
/// Within a `with` block of it the core's calls of this thread raise KeyboardInterrupt once `stop()` was called.
#[pyclass(frozen, module = "sevenbar._core")]
pub(crate) struct WorkStop(Arc<AtomicBool>);

#[pymethods]
impl WorkStop {
    #[new]
    fn new() -> Self {
        Self(Arc::new(AtomicBool::new(false)))
    }

    /// Ends what is at work, and all that follows.
    fn stop(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether it was stopped.
    #[getter]
    fn stopped(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    fn __enter__(own: Py<Self>) -> Py<Self> {
        STOPS.with(|stops| stops.borrow_mut().push(own.get().0.clone()));
        own
    }

    fn __exit__(&self, _kind: Py<PyAny>, _value: Py<PyAny>, _traceback: Py<PyAny>) {
        STOPS.with(|stops| {
            let mut stops = stops.borrow_mut();
            if let Some(place) = stops.iter().rposition(|own| Arc::ptr_eq(own, &self.0)) {
                stops.remove(place);
            }
        });
    }
}

/// A call from Python.
struct Call {
    /// Python's main thread, if the call comes from it, and when it last checked for signals.
    main: Option<ThreadId>,
    checked: Mutex<Instant>,
    /// What a handler of signals raised.
    raised: Mutex<Option<PyErr>>,
    ended: AtomicBool,
    stops: Vec<Arc<AtomicBool>>,
}

impl Caller for Call {
    fn still_wants(&self) -> bool {
        let stopped = |stop: &Arc<AtomicBool>| stop.load(Ordering::Relaxed);
        if self.ended.load(Ordering::Relaxed) || self.stops.iter().any(stopped) {
            return false;
        }
        if self.main != Some(thread::current().id()) {
            return true;
        }
        let mut checked = self.checked.lock().unwrap_or_else(PoisonError::into_inner);
        if checked.elapsed() < PATIENCE {
            return true;
        }
        let found = Python::attach(|py| py.check_signals());
        *checked = Instant::now();
        if let Err(error) = found {
            *self.raised.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
            self.ended.store(true, Ordering::Relaxed);
            return false;
        }
        true
    }
}

fn is_main(py: Python<'_>) -> bool {
    let asked = || -> PyResult<bool> {
        let threading = py.import("threading")?;
        let main = threading.call_method0("main_thread")?;
        let here = threading.call_method0("get_ident")?;
        main.getattr("ident")?.eq(here)
    };
    IS_MAIN.with(|main| *main.get_or_init(|| asked().unwrap_or(false)))
}

/// What the core computes, the interpreter free meanwhile; what a signal raised where it was stopped.
pub(crate) fn working<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    let call = Arc::new(Call {
        main: is_main(py).then(|| thread::current().id()),
        checked: Mutex::new(Instant::now()),
        raised: Mutex::new(None),
        ended: AtomicBool::new(false),
        stops: STOPS.with(|stops| stops.borrow().clone()),
    });
    let asked = call.clone();
    py.detach(|| stoppable(asked, work)).map_err(|_| {
        let raised = call.raised.lock().unwrap_or_else(PoisonError::into_inner).take();
        raised.unwrap_or_else(|| PyKeyboardInterrupt::new_err(()))
    })
}
