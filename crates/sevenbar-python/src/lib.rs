//! The only crate that knows Python: arrays in, arrays out, the interpreter free while the core works.

mod along;
mod batches;
mod forces;
mod loops;
mod net_parts;
mod nets;
mod numbers;
mod rows;
mod rssr;
mod survey;
mod values;
mod working;

use numpy::ndarray::Dimension;
use numpy::{PyReadonlyArray, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use sevenbar_core::error::Error;
use sevenbar_core::rssr::Input;
use std::borrow::Cow;

pyo3::create_exception!(
    _core,
    CoreError,
    PyValueError,
    "A request that the core cannot take."
);

fn raise(error: Error) -> PyErr {
    CoreError::new_err(error.to_string())
}

fn input_named(name: &str) -> PyResult<Input> {
    match name {
        "crank" => Ok(Input::Crank),
        "rocker" => Ok(Input::Rocker),
        _ => Err(CoreError::new_err(format!(
            "input: '{name}' is not a side link; give crank or rocker"
        ))),
    }
}

/// The numbers of an array, row by row, copied only where memory has them in another order, in which `as_slice` of the array
/// itself would give them.
fn in_rows<'a, D: Dimension>(array: &'a PyReadonlyArray<'_, f64, D>) -> Cow<'a, [f64]> {
    let view = array.as_array();
    match view.to_slice() {
        Some(numbers) => Cow::Borrowed(numbers),
        None => Cow::Owned(view.iter().copied().collect()),
    }
}

/// An input law as rows of value and three derivatives.
type LawRows = Option<Vec<[f64; 4]>>;

/// Rows of an array as those of a law; derivatives that it does not have are zero.
pub(crate) fn law_rows(law: Option<PyReadonlyArray2<'_, f64>>) -> LawRows {
    law.map(|rows| {
        rows.as_array()
            .outer_iter()
            .map(|r| std::array::from_fn(|k| r.get(k).copied().unwrap_or(0.0)))
            .collect()
    })
}

/// The vector unit that batches run on.
#[pyfunction]
fn simd_level() -> &'static str {
    sevenbar_core::simd::level()
}

#[pymodule]
mod _core {
    #[pymodule_export]
    use super::along::{driven, piecewise};
    #[pymodule_export]
    use super::batches::{LoopBatch, RawMeasures, RssrBatch, classify_rssr, measure_loops, measure_rssr};
    #[pymodule_export]
    use super::forces::{Acting, reactions};
    #[pymodule_export]
    use super::loops::Loop;
    #[pymodule_export]
    use super::net_parts::NetParts;
    #[pymodule_export]
    use super::nets::{Net, NetFollowed, NetRows, biconnected_parts, net_blocks};
    #[pymodule_export]
    use super::numbers::{Carried, LoopWord, Numbers, Product};
    #[pymodule_export]
    use super::rows::{Course, Followed, Rows};
    #[pymodule_export]
    use super::rssr::Rssr;
    #[pymodule_export]
    use super::survey::{RawTally, Survey, survey_figures};
    #[pymodule_export]
    use super::values::{RawCircuit, RawCount, RawFound, RawMotion, RawSearch};
    #[pymodule_export]
    use super::working::WorkStop;
    #[pymodule_export]
    use super::{CoreError, simd_level};

    #[pymodule_init]
    fn init(module: &pyo3::Bound<'_, pyo3::types::PyModule>) -> pyo3::PyResult<()> {
        use pyo3::types::PyModuleMethods;
        module.add("AGREE", sevenbar_core::loops::AGREE)?;
        module.add("NO_SIZE", sevenbar_core::loops::NO_SIZE)?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
