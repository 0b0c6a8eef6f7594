//! Derivatives of a loop by the numbers of its description, for Python.

use crate::{CoreError, flat, loops::pose};
use numpy::ndarray::Axis;
use numpy::{
    IntoPyArray, PyArrayDyn, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3,
    PyReadonlyArray4, PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use sevenbar_core::loops::{Advance, Design, Move, NumberedLoop, NumberedPoint, slopes};

/// A loop that knows what its numbers move; lengths relative to the size.
#[pyclass(frozen, module = "sevenbar._core")]
pub(crate) struct Numbers(pub NumberedLoop);

/// How many joints are before it, its place, and what one of each number moves it by.
type Point = (usize, [f64; 3], Vec<(usize, [f64; 3])>);

pub(crate) type Array<'py> = Bound<'py, PyArrayDyn<f64>>;

pub(crate) fn shaped<'py>(py: Python<'py>, values: Vec<f64>, shape: &[usize]) -> PyResult<Array<'py>> {
    values.into_pyarray(py).reshape(shape.to_vec())
}

#[pymethods]
impl Numbers {
    /// From the joints' letters R P H S, their advances for a radian (joints,) and the transforms before, between and behind them
    /// (joints + 1, 4, 4); the driving column, held columns, and how many idle freedoms more there are; how many numbers, and
    /// what one of each moves: (number, place) with twists (m, 6), (number, joint, rate) of advances, and points: (how many joints before, place,
    /// [(number, way)]).
    #[new]
    #[expect(clippy::too_many_arguments)]
    fn new(
        letters: &str,
        advances: PyReadonlyArray1<'_, f64>,
        fixed: PyReadonlyArray3<'_, f64>,
        input: usize,
        held: Vec<usize>,
        spins: usize,
        numbers: usize,
        moves: Vec<(usize, usize)>,
        twists: PyReadonlyArray2<'_, f64>,
        pitches: Vec<(usize, usize, f64)>,
        points: Vec<Point>,
    ) -> PyResult<Self> {
        let wrong = || CoreError::new_err("numbers: the parts of the loop do not fit together");
        let (fixed, twists) = (fixed.as_array(), twists.as_array());
        if fixed.shape()[1..] != [4, 4] || twists.shape() != [moves.len(), 6] {
            return Err(wrong());
        }
        let nominal = Design {
            fixed: fixed.axis_iter(Axis(0)).map(pose).collect(),
            advances: flat("advances", &advances)?.to_vec(),
        };
        let moves: Vec<Move> = moves
            .iter()
            .zip(twists.outer_iter())
            .map(|(&(number, place), twist)| Move { number, place, twist: std::array::from_fn(|k| twist[k]) })
            .collect();
        let pitches: Vec<Advance> = pitches
            .into_iter()
            .map(|(number, joint, rate)| Advance { number, joint, rate })
            .collect();
        let points = points
            .into_iter()
            .map(|(joints, at, ways)| NumberedPoint { joints, at, ways })
            .collect();
        NumberedLoop::new(
            letters, nominal, input, held, spins, numbers, &moves, &pitches, points,
        )
        .map(Self)
        .ok_or_else(wrong)
    }

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
        let values = values
            .as_slice()
            .map_err(|_| CoreError::new_err("values: the array is not contiguous"))?;
        let found = py.detach(|| slopes(&self.0, values, order));
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
        let values = values
            .as_slice()
            .map_err(|_| CoreError::new_err("values: the array is not contiguous"))?;
        let found = py.detach(|| self.0.places(values));
        shaped(py, found, &[rows, self.0.points(), 3])
    }

    /// Poses (designs, n, columns) of designs, transforms (designs, joints + 1, 4, 4) and advances (designs, joints), at inputs
    /// (n,), from poses (n, columns) of this loop moved by `steps` (designs, n, columns), and the determinants (designs, n) that
    /// change their sign at a dead centre; NaN where a pose is lost.
    #[pyo3(signature = (values, inputs, fixed, advances, steps=None))]
    fn follow<'py>(
        &self,
        py: Python<'py>,
        values: PyReadonlyArray2<'py, f64>,
        inputs: PyReadonlyArray1<'py, f64>,
        fixed: PyReadonlyArray4<'py, f64>,
        advances: PyReadonlyArray2<'py, f64>,
        steps: Option<PyReadonlyArray3<'py, f64>>,
    ) -> PyResult<(Array<'py>, Array<'py>)> {
        let (rows, width, joints) = (inputs.len(), self.0.columns(), self.0.joints());
        let designs = fixed.shape()[0];
        let fits = values.shape() == [rows, width]
            && fixed.shape() == [designs, joints + 1, 4, 4]
            && advances.shape() == [designs, joints]
            && steps.as_ref().is_none_or(|s| s.shape() == [designs, rows, width]);
        if !fits {
            return Err(CoreError::new_err("follow: the arrays do not fit together"));
        }
        let (fixed, advances) = (fixed.as_array(), advances.as_array());
        let all: Vec<Design> = (0..designs)
            .map(|n| Design {
                fixed: fixed
                    .index_axis(Axis(0), n)
                    .axis_iter(Axis(0))
                    .map(pose)
                    .collect(),
                advances: advances.row(n).to_vec(),
            })
            .collect();
        let contiguous = |_| CoreError::new_err("follow: an array is not contiguous");
        let values = values.as_slice().map_err(contiguous)?;
        let steps = steps
            .as_ref()
            .map(|s| s.as_slice().map_err(contiguous))
            .transpose()?;
        let inputs = flat("inputs", &inputs)?;
        let found = py.detach(|| self.0.follow(values, inputs, steps, &all));
        Ok((
            shaped(py, found.values, &[designs, rows, width])?,
            shaped(py, found.sides, &[designs, rows])?,
        ))
    }
}
