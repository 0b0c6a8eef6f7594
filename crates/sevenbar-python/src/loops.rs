//! Any single loop, for Python.

use crate::rows::{Course, Followed, Rows};
use crate::values::{RawCircuit, RawFound, RawMotion, RawSearch, RowArrays, change_point};
use crate::working::working;
use crate::{CoreError, in_rows, law_rows};
use numpy::ndarray::{ArrayView2, Axis};
use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2,
    PyReadonlyArray3,
};
use pyo3::prelude::*;
use sevenbar_core::loops::{self, Circuit, Idle, Kind, Through};
use sevenbar_core::rigid::Pose;

pub(crate) fn pose(m: ArrayView2<'_, f64>) -> Pose {
    Pose::from_rows(std::array::from_fn(|i| std::array::from_fn(|j| m[[i, j]])))
}

/// A single closed loop of R, P, H and S joints.
#[pyclass(frozen, module = "sevenbar._core")]
pub(crate) struct Loop(loops::Loop);

/// Joints by their letters, screws with their advance for a radian.
pub(crate) fn kinds(letters: &str, advances: &[f64]) -> PyResult<Vec<Kind>> {
    letters
        .chars()
        .zip(advances)
        .map(|(letter, &advance)| match letter {
            'R' => Ok(Kind::Turn),
            'P' => Ok(Kind::Slide),
            'H' => Ok(Kind::Screw(advance)),
            'S' => Ok(Kind::Ball),
            other => Err(CoreError::new_err(format!(
                "'{other}' is no joint; give R, P, H or S"
            ))),
        })
        .collect()
}

type Modes<'py> = (
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray1<f64>>,
    &'static str,
    Vec<f64>,
    Option<Vec<f64>>,
);

/// Joint values with three derivatives (4, n, columns), status, pass, residual and condition (n,), and the rows of a loop.
type RawRows = (
    Py<PyArray3<f64>>,
    Py<PyArray1<i64>>,
    Py<PyArray1<i64>>,
    Py<PyArray1<f64>>,
    Py<PyArray1<f64>>,
    Py<Rows>,
);

fn no_input(column: usize) -> PyErr {
    CoreError::new_err(format!("column {column} has no freedom of its own"))
}

#[pymethods]
impl Loop {
    /// From the joints' letters R P H S, the advance of each for a radian (H), the frames of the first joint and of the ground's
    /// side of the last, each (4, 4), and the transforms of the moving links (n - 1, 4, 4); redundant constraints agree up to a closure
    /// error [rad, or relative to the size]. `drawn` are the values of the columns in the pose of a drawing, all zero without.
    #[new]
    #[pyo3(signature = (letters, advances, base, ground, links, agree=loops::AGREE, drawn=None))]
    fn new(
        letters: &str,
        advances: PyReadonlyArray1<'_, f64>,
        base: PyReadonlyArray2<'_, f64>,
        ground: PyReadonlyArray2<'_, f64>,
        links: PyReadonlyArray3<'_, f64>,
        agree: f64,
        drawn: Option<PyReadonlyArray1<'_, f64>>,
    ) -> PyResult<Self> {
        let kinds = kinds(letters, &in_rows(&advances))?;
        let (base, ground, links) = (base.as_array(), ground.as_array(), links.as_array());
        let right = base.shape() == [4, 4]
            && ground.shape() == [4, 4]
            && links.shape() == [kinds.len().saturating_sub(1), 4, 4]
            && kinds.len() > 1;
        if !right {
            return Err(CoreError::new_err(
                "base and ground need shape (4, 4), links one (4, 4) less than joints",
            ));
        }
        let links: Vec<Pose> = links.axis_iter(Axis(0)).map(pose).collect();
        let own = loops::Loop::new(&kinds, pose(base), pose(ground), &links);
        let own = own.agreeing(agree);
        let Some(drawn) = drawn else {
            return Ok(Self(own));
        };
        let drawn = in_rows(&drawn);
        if drawn.len() != own.columns() {
            return Err(CoreError::new_err(format!(
                "drawn: give {} values",
                own.columns()
            )));
        }
        Ok(Self(loops::drawn_at(own, &drawn)))
    }

    /// The size of which residuals are parts.
    #[getter]
    fn size(&self) -> f64 {
        self.0.size()
    }

    /// Freedoms of the joints less the idle ones.
    #[getter]
    fn freedoms(&self) -> usize {
        self.0.freedoms()
    }

    /// Whether no more than one freedom can remain, and every idle one is held.
    #[getter]
    fn can_be_driven(&self) -> bool {
        self.0.can_be_driven()
    }

    /// Idle freedoms: a word, the joint concerned and its neighbour, counted from 0.
    #[getter]
    fn idle(&self) -> Vec<(&'static str, usize, usize)> {
        self.0
            .idle()
            .iter()
            .map(|idle| match *idle {
                Idle::BetweenBalls(a) => ("between-balls", a, a + 1),
                Idle::ChainBetweenBalls(a, b) => ("chain-between-balls", a, b),
                Idle::BallOnAxis(held, ball) => ("ball-on-axis", held, ball),
                Idle::OneAxis(held, other) => ("one-axis", held, other),
                Idle::OneDirection(held, other) => ("one-direction", held, other),
                Idle::OnPlate(held, ball) => ("on-plate", held, ball),
            })
            .collect()
    }

    /// Joints at which the idle spin of the link after them is held, counted from 0, and the axis that does it, in the frame before.
    #[getter]
    fn spin_axes(&self) -> Vec<(usize, [f64; 3])> {
        self.0.spin_axes()
    }

    /// Joint values (m, columns) and closure errors (m,) of every assembly mode at one value of a column, how complete they are,
    /// by how much redundant constraints keep other poses open, and a pose on a curve of poses that close there, if one was found.
    fn assembly_modes<'py>(&self, py: Python<'py>, column: usize, value: f64) -> PyResult<Modes<'py>> {
        let found = working(py, || loops::modes(&self.0, column, value))?.ok_or_else(|| no_input(column))?;
        let (values, residuals): (Vec<Vec<f64>>, Vec<f64>) = found.modes.into_iter().unzip();
        Ok((
            PyArray1::from_vec(py, values.concat()).reshape([values.len(), self.0.columns()])?,
            residuals.into_pyarray(py),
            found.completeness.name(),
            found.open_by,
            found.on_curve,
        ))
    }

    /// How freely it moves, from the first poses found over the values of a column; none where there are none.
    fn mobility(&self, py: Python<'_>, column: usize) -> PyResult<Option<RawFound>> {
        working(py, || loops::mobility(&self.0, column))?
            .map(|found| RawFound::new(py, &found))
            .transpose()
    }

    /// The whole motion over the inputs of a column; without `keep` circuits on a grid have no rows but a course.
    #[pyo3(signature = (input, output, samples, speed, law=None, keep=true))]
    #[expect(clippy::too_many_arguments)]
    fn motion<'py>(
        &self,
        py: Python<'py>,
        input: usize,
        output: usize,
        samples: usize,
        speed: f64,
        law: Option<PyReadonlyArray2<'py, f64>>,
        keep: bool,
    ) -> PyResult<RawMotion> {
        let law = law_rows(law);
        let motion = working(py, || {
            loops::motion(&self.0, input, output, samples, speed, law.as_deref(), keep)
        })?
        .ok_or_else(|| no_input(input))?;
        let circuits = motion.circuits.into_iter();
        Ok(RawMotion {
            motion_type: motion.motion_type,
            limits: None,
            circuits: circuits
                .map(|c| Py::new(py, self.circuit(py, c)?))
                .collect::<PyResult<_>>()?,
            change_points: motion.change_points.into_iter().map(change_point).collect(),
            search: Some(Py::new(py, RawSearch::new(py, motion.search)?)?),
            moving: motion.moving,
        })
    }

    /// The rows of a course: arrays as those of a circuit, and the rows as the loop has them.
    fn rows(&self, py: Python<'_>, course: &Course) -> PyResult<RawRows> {
        let rows = working(py, || course.0.rows(&self.0))?;
        let RowArrays { joints, status, branch, residual, condition, .. } = self.arrays(py, &rows)?;
        Ok((
            joints,
            status,
            branch,
            residual,
            condition,
            Py::new(py, Rows(rows))?,
        ))
    }

    /// The one circuit through a pose (columns,), and as it was followed; else how far the loop is from closing, the columns that move with the input at rest,
    /// or nothing where no motion could be followed.
    #[pyo3(signature = (pose, input, output, samples, speed, law=None))]
    #[expect(clippy::too_many_arguments)]
    fn circuit_through<'py>(
        &self,
        py: Python<'py>,
        pose: PyReadonlyArray1<'py, f64>,
        input: usize,
        output: usize,
        samples: usize,
        speed: f64,
        law: Option<PyReadonlyArray2<'py, f64>>,
    ) -> PyResult<RawThrough> {
        let law = law_rows(law);
        let pose = in_rows(&pose);
        if pose.len() != self.0.columns() {
            return Err(CoreError::new_err("pose needs one value for each column"));
        }
        let through = working(py, || {
            loops::circuit_through(&self.0, &pose, input, output, samples, speed, law.as_deref())
        })?
        .ok_or_else(|| no_input(input))?;
        Ok(match through {
            Through::Circuit(circuit, followed) => RawThrough::Circuit((
                Py::new(py, self.circuit(py, *circuit)?)?,
                Py::new(py, Followed(*followed))?,
            )),
            Through::Apart(gap) => RawThrough::Apart(gap),
            Through::InputRests(moving) => RawThrough::InputRests(moving),
            Through::Still => RawThrough::Still(()),
        })
    }

    /// A circuit that was followed over this input and output, once more at other inputs.
    #[pyo3(signature = (followed, input, output, samples, speed, law=None))]
    #[expect(clippy::too_many_arguments)]
    fn circuit_again(
        &self,
        py: Python<'_>,
        followed: &Followed,
        input: usize,
        output: usize,
        samples: usize,
        speed: f64,
        law: Option<PyReadonlyArray2<'_, f64>>,
    ) -> PyResult<RawCircuit> {
        let law = law_rows(law);
        let circuit = working(py, || {
            loops::circuit_again(
                &self.0,
                &followed.0,
                input,
                output,
                samples,
                speed,
                law.as_deref(),
            )
        })?
        .ok_or_else(|| no_input(input))?;
        self.circuit(py, circuit)
    }

    /// A point of a link along rows of a circuit with three derivatives by time, (4, n, 3), in the report frame; `link` counts from 0,
    /// `at` is in the frame after that link's joint.
    fn point<'py>(
        &self,
        py: Python<'py>,
        rows: &Rows,
        link: usize,
        at: [f64; 3],
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let out = working(py, || loops::point(&self.0, &rows.0, link, at))?;
        PyArray1::from_vec(py, out).reshape([4, rows.0.len(), 3])
    }
}

/// What goes through a pose.
#[derive(IntoPyObject)]
enum RawThrough {
    Circuit((Py<RawCircuit>, Py<Followed>)),
    Apart(f64),
    InputRests(Vec<usize>),
    Still(()),
}

impl Loop {
    fn circuit(&self, py: Python<'_>, circuit: Circuit) -> PyResult<RawCircuit> {
        let Circuit { rows, course, measures, .. } = circuit;
        let arrays = self.arrays(py, &rows)?;
        let course = course.map(|course| Py::new(py, Course(course))).transpose()?;
        let rows = Some(Py::new(py, Rows(rows))?);
        Ok(RawCircuit::new(arrays, &measures, rows, course))
    }

    fn arrays(&self, py: Python<'_>, rows: &loops::Rows) -> PyResult<RowArrays> {
        let table = working(py, || loops::joint_table(&self.0, rows))?;
        Ok(RowArrays {
            joints: PyArray1::from_vec(py, table)
                .reshape([4, rows.len(), self.0.columns()])?
                .unbind(),
            status: rows.status().into_pyarray(py).unbind(),
            branch: rows.passes().into_pyarray(py).unbind(),
            mode: None,
            residual: rows.residuals().into_pyarray(py).unbind(),
            condition: rows.conditions().into_pyarray(py).unbind(),
        })
    }
}
