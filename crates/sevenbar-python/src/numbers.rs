//! Derivatives of a loop by the numbers of its description, for Python.

use crate::working::working;
use crate::{CoreError, in_rows, loops::pose};
use numpy::{
    IntoPyArray, PyArrayDyn, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3,
    PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use sevenbar_core::loops::{self, Axis, DrawnFrame, Factor, Held, NumberedLoop, Three, slopes};
use std::sync::Arc;

/// A rigid motion that depends on numbers of a description, in radians and lengths.
#[pyclass(frozen, eq, from_py_object, module = "sevenbar._core")]
#[derive(Clone, PartialEq)]
pub(crate) struct Product(loops::Product);

/// A point of the link behind so many steps (joints of the core); coordinates are numbers, or given.
#[pyclass(frozen, eq, from_py_object, module = "sevenbar._core")]
#[derive(Clone, PartialEq)]
pub(crate) struct Carried(loops::Carried);

/// The joints of a loop, and what is between them by the numbers of a description.
#[pyclass(frozen, module = "sevenbar._core")]
pub(crate) struct LoopWord(Arc<loops::Word>);

/// A loop that knows what its numbers move; lengths relative to the size.
#[pyclass(frozen, module = "sevenbar._core")]
pub(crate) struct Numbers(pub NumberedLoop);

pub(crate) type Array<'py> = Bound<'py, PyArrayDyn<f64>>;

pub(crate) fn shaped<'py>(py: Python<'py>, values: Vec<f64>, shape: &[usize]) -> PyResult<Array<'py>> {
    values.into_pyarray(py).reshape(shape.to_vec())
}

fn wrong() -> PyErr {
    CoreError::new_err("numbers: the parts of the loop do not fit together")
}

impl Product {
    fn along(axis: usize, factor: Factor) -> PyResult<Self> {
        if axis > 2 {
            return Err(CoreError::new_err("axis: give 0, 1 or 2"));
        }
        Ok(Self(loops::Product::of(factor)))
    }
}

#[pymethods]
impl Product {
    /// The identity.
    #[new]
    fn new() -> Self {
        Self(loops::Product::default())
    }

    /// A motion (4, 4) that depends on nothing.
    #[staticmethod]
    fn still(matrix: PyReadonlyArray2<'_, f64>) -> PyResult<Self> {
        if matrix.shape() != [4, 4] {
            return Err(CoreError::new_err("still: give a matrix (4, 4)"));
        }
        Ok(Self(loops::Product::of(Factor::Still(pose(matrix.as_array())))))
    }

    /// A turn about an axis 0, 1, 2 by a number.
    #[staticmethod]
    fn turn(axis: usize, number: usize) -> PyResult<Self> {
        Self::along(axis, Factor::Turn(axis, number))
    }

    /// A slide along an axis 0, 1, 2 by a number.
    #[staticmethod]
    fn slide(axis: usize, number: usize) -> PyResult<Self> {
        Self::along(axis, Factor::Slide(axis, number))
    }

    /// The frame on a joint as drawn: its place, its axes (two of U, none of a ball), which of them is z, the place towards which
    /// x goes where there is one axis, and whether x counts, since the joint slides in a plane.
    #[staticmethod]
    fn drawn(at: Three, axes: Vec<Three>, which: usize, towards: Three, has_plane: bool) -> PyResult<Self> {
        if which >= axes.len().max(1) || axes.len() > 2 {
            return Err(CoreError::new_err(
                "drawn: give at most two axes, and one of them",
            ));
        }
        let own = DrawnFrame { at, axes, which, towards, has_plane };
        Ok(Self(loops::Product::of(Factor::Drawn(own))))
    }

    /// The frame of an axis (0), of one square to it and to the line between places (1), of one square to both (2; 3 to slide along
    /// it), about which a drawn ball turns; the axis is that `written` by numbers, or the one given.
    #[staticmethod]
    fn held(line: [Three; 2], which: usize, written: Option<Three>, given: [f64; 3]) -> Self {
        let axis = written.map_or(Axis::Given(given), Axis::Written);
        Self(loops::Product::of(Factor::Held(Held { axis, line, which })))
    }

    /// This motion, then another.
    fn __add__(&self, other: &Self) -> Self {
        Self(self.0.then(&other.0))
    }

    /// The inverse motion.
    #[getter]
    fn back(&self) -> Self {
        Self(self.0.back())
    }

    /// The numbers by which it slides along an axis.
    #[getter]
    fn slides(&self) -> Vec<usize> {
        self.0.slides().collect()
    }

    /// The motion (4, 4) at values (k,) of all numbers.
    fn pose<'py>(&self, py: Python<'py>, values: PyReadonlyArray1<'py, f64>) -> PyResult<Array<'py>> {
        let values = in_rows(&values);
        if self.0.numbers().any(|k| k >= values.len()) {
            return Err(wrong());
        }
        let found = self.0.pose(&values);
        let mut matrix = Vec::with_capacity(16);
        for (row, shift) in found.rotation.iter().zip(found.translation) {
            matrix.extend([row[0], row[1], row[2], shift]);
        }
        matrix.extend([0.0, 0.0, 0.0, 1.0]);
        shaped(py, matrix, &[4, 4])
    }
}

#[pymethods]
impl Carried {
    #[new]
    #[pyo3(signature = (steps, frame, place=None, at=[0.0; 3]))]
    fn new(steps: usize, frame: &Product, place: Option<Three>, at: [f64; 3]) -> Self {
        Self(loops::Carried { joints: steps, frame: frame.0.clone(), place, at })
    }

    #[getter]
    fn steps(&self) -> usize {
        self.0.joints
    }

    #[getter]
    fn frame(&self) -> Product {
        Product(self.0.frame.clone())
    }

    #[getter]
    fn place(&self) -> Option<Three> {
        self.0.place
    }

    #[getter]
    fn at(&self) -> [f64; 3] {
        self.0.at
    }
}

#[pymethods]
impl LoopWord {
    /// From the joints' letters R P H S, the numbers that are their advances for a turn, the transforms before, between and behind
    /// them, held columns, how many idle freedoms more there are, what one of each number is in radians or lengths, and the size.
    #[new]
    fn new(
        letters: String,
        pitches: Vec<Option<usize>>,
        fixed: Vec<Product>,
        held: Vec<usize>,
        spins: usize,
        scales: Vec<f64>,
        size: f64,
    ) -> PyResult<Self> {
        let fixed = fixed.into_iter().map(|product| product.0).collect();
        let word = loops::Word { letters, pitches, fixed, held, spins, scales, size };
        if !word.fits(&[]) {
            return Err(wrong());
        }
        Ok(Self(Arc::new(word)))
    }

    /// The loop at numbers (k,) driven by a column, with derivatives by `only` some of them, and with points.
    fn at(
        &self,
        numbers: PyReadonlyArray1<'_, f64>,
        input: usize,
        only: Vec<usize>,
        points: Vec<Carried>,
    ) -> PyResult<Numbers> {
        let points: Vec<_> = points.into_iter().map(|point| point.0).collect();
        NumberedLoop::new(&self.0, &in_rows(&numbers), input, &only, &points)
            .map(Numbers)
            .ok_or_else(wrong)
    }
}

#[pymethods]
impl Numbers {
    /// At closed poses (n, columns): rates by the input (n, 3, columns); derivatives (n, order + 1, numbers + 1, columns), the last
    /// by the input; points with their derivative by the input (n, points, 2, 3), and the derivatives of both (n, points, 2,
    /// numbers + 1, 3); what of each number no joint can follow (n, numbers); what moves with each held freedom, columns (n, held,
    /// columns) and points (n, held, points, 3). NaN at dead centres of the input.
    fn slopes<'py>(
        &self,
        py: Python<'py>,
        values: PyReadonlyArray2<'py, f64>,
        order: usize,
    ) -> PyResult<Vec<Array<'py>>> {
        let (rows, width) = (values.shape()[0], self.0.columns());
        if values.shape()[1] != width || order > 3 {
            return Err(CoreError::new_err(
                "slopes: give rows of all columns, and an order up to 3",
            ));
        }
        let values = in_rows(&values);
        let found = working(py, || slopes(&self.0, &values, order))?;
        let (all, points, idle) = (self.0.numbers() + 1, self.0.points(), self.0.idle());
        Ok(vec![
            shaped(py, found.rates, &[rows, 3, width])?,
            shaped(py, found.by_number, &[rows, order + 1, all, width])?,
            shaped(py, found.points, &[rows, points, 2, 3])?,
            shaped(py, found.points_by_number, &[rows, points, 2, all, 3])?,
            shaped(py, found.aside, &[rows, all - 1])?,
            shaped(py, found.idle, &[rows, idle, width])?,
            shaped(py, found.points_idle, &[rows, idle, points, 3])?,
        ])
    }

    /// The points (n, points, 3) at poses (n, columns).
    fn places<'py>(&self, py: Python<'py>, values: PyReadonlyArray2<'py, f64>) -> PyResult<Array<'py>> {
        let rows = values.shape()[0];
        if values.shape()[1] != self.0.columns() {
            return Err(CoreError::new_err("places: give rows of all columns"));
        }
        let values = in_rows(&values);
        let found = working(py, || self.0.places(&values))?;
        shaped(py, found, &[rows, self.0.points(), 3])
    }

    /// By each number that moves it, counted as its derivatives are, the twist (6,) of a link's frame behind the joints before it.
    fn twists(&self, frame: &Product) -> PyResult<Vec<(usize, [f64; 6])>> {
        self.0.twists(&frame.0).ok_or_else(wrong)
    }

    /// Poses (designs, n, columns) of designs, by their numbers (designs, k) or this one, at inputs (n,), from poses (n, columns) of
    /// this loop moved by `steps` (designs, n, columns), and the determinants (designs, n) that change their sign at a dead centre;
    /// NaN where a pose is lost.
    #[pyo3(signature = (values, inputs, numbers=None, steps=None))]
    fn follow<'py>(
        &self,
        py: Python<'py>,
        values: PyReadonlyArray2<'py, f64>,
        inputs: PyReadonlyArray1<'py, f64>,
        numbers: Option<PyReadonlyArray2<'py, f64>>,
        steps: Option<PyReadonlyArray3<'py, f64>>,
    ) -> PyResult<(Array<'py>, Array<'py>)> {
        let (rows, width) = (inputs.len(), self.0.columns());
        let designs = numbers.as_ref().map_or(1, |all| all.shape()[0]);
        let fits = values.shape() == [rows, width]
            && numbers
                .as_ref()
                .is_none_or(|all| all.shape()[1] == self.0.all_numbers())
            && steps.as_ref().is_none_or(|s| s.shape() == [designs, rows, width]);
        if !fits {
            return Err(CoreError::new_err("follow: the arrays do not fit together"));
        }
        let (values, inputs) = (in_rows(&values), in_rows(&inputs));
        let (numbers, steps) = (numbers.as_ref().map(in_rows), steps.as_ref().map(in_rows));
        let found = working(py, || {
            self.0
                .follow(&values, &inputs, steps.as_deref(), numbers.as_deref())
        })?;
        Ok((
            shaped(py, found.values, &[designs, rows, width])?,
            shaped(py, found.sides, &[designs, rows])?,
        ))
    }
}
