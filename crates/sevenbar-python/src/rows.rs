//! The rows of a circuit as Python keeps them.

use crate::{CoreError, in_rows};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyType;
use sevenbar_core::loops;

/// What makes the rows of a long circuit whenever they are wanted: its loop does.
#[pyclass(frozen, module = "sevenbar._core")]
pub(crate) struct Course(pub loops::Course);

#[pymethods]
impl Course {
    /// How many rows of each status there are, by its number.
    #[getter]
    fn statuses(&self) -> Vec<usize> {
        self.0.tally.statuses.to_vec()
    }

    /// The greatest closure error, relative to the size or radians; none where no row has one.
    #[getter]
    fn residual(&self) -> Option<f64> {
        self.0.tally.residual
    }
}

/// A circuit as its loop followed it, which makes rows of it at any inputs.
#[pyclass(frozen, module = "sevenbar._core")]
pub(crate) struct Followed(pub loops::Followed);

/// Rows of a circuit, of which their loop tells the points of any link; pickled as their numbers.
#[pyclass(frozen, module = "sevenbar._core")]
pub(crate) struct Rows(pub loops::Rows);

type RowNumbers<'py> = (
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray1<f64>>,
    f64,
    Option<(usize, f64)>,
);

#[pymethods]
impl Rows {
    /// From numbers (n, numbers of a row), turns to be added to each column, the speed, and the joint that rests and where.
    #[new]
    #[pyo3(signature = (numbers, offsets, speed, still=None))]
    fn new(
        numbers: PyReadonlyArray2<'_, f64>,
        offsets: PyReadonlyArray1<'_, f64>,
        speed: f64,
        still: Option<(usize, f64)>,
    ) -> PyResult<Self> {
        if numbers.shape()[1] != loops::ROW_NUMBERS {
            let wanted = loops::ROW_NUMBERS;
            return Err(CoreError::new_err(format!("rows need {wanted} numbers each")));
        }
        let still = still.map(|(joint, value)| loops::Still { joint, value });
        loops::Rows::from_numbers(&in_rows(&numbers), in_rows(&offsets).to_vec(), speed, still)
            .map(Self)
            .ok_or_else(|| CoreError::new_err("no rows of a circuit have these numbers"))
    }

    /// The class and what it makes these rows of again.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyType>, RowNumbers<'py>)> {
        let numbers = PyArray1::from_vec(py, self.0.numbers()).reshape([self.0.len(), loops::ROW_NUMBERS])?;
        let offsets = PyArray1::from_slice(py, self.0.offsets());
        let still = self.0.still().map(|s| (s.joint, s.value));
        Ok((py.get_type::<Self>(), (numbers, offsets, self.0.speed(), still)))
    }
}
