//! Nets of several loops, for Python.

use crate::loops::pose;
use crate::net_parts::{NetParts, RawPart, RawRow, parts, row};
use crate::values::{RawCircuit, RawMotion, RawSearch, RowArrays};
use crate::working::working;
use crate::{CoreError, in_rows, law_rows};
use numpy::ndarray::{ArrayView3, Axis};
use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2,
    PyReadonlyArray3,
};
use pyo3::prelude::*;
use pyo3::types::PyType;
use sevenbar_core::nets::{
    self, DescribedNet, Edge, Facing, Move, NetCircuit, NetJoint, NetThrough, NotFollowed, Over, Reading,
    Row, Standing, Step, Unbalanced,
};
use sevenbar_core::rigid::{Pose, Vec3};

/// A tree of one-freedom steps closed by rows, and the joints that read it.
#[pyclass(frozen, module = "sevenbar._core")]
pub(crate) struct Net(DescribedNet);

/// A circuit as its net followed it, which makes rows of it at any inputs.
#[pyclass(frozen, module = "sevenbar._core")]
pub(crate) struct NetFollowed(nets::NetFollowed);

/// The rows of a circuit of a net, which makes points of them; pickled as their numbers.
#[pyclass(frozen, module = "sevenbar._core")]
pub(crate) struct NetRows(nets::NetRows);

/// Numbers of all rows, how many columns and balls are followed, turns to be added to each column, the speed.
type NetRowNumbers<'py> = (
    Bound<'py, PyArray1<f64>>,
    [usize; 2],
    Bound<'py, PyArray1<f64>>,
    f64,
);

#[pymethods]
impl NetRows {
    /// From what they are pickled as.
    #[new]
    fn new(
        numbers: PyReadonlyArray1<'_, f64>,
        sizes: [usize; 2],
        offsets: PyReadonlyArray1<'_, f64>,
        speed: f64,
    ) -> PyResult<Self> {
        nets::NetRows::from_numbers(&in_rows(&numbers), sizes, in_rows(&offsets).to_vec(), speed)
            .map(Self)
            .ok_or_else(|| CoreError::new_err("no rows of a circuit have these numbers"))
    }

    /// The class and what it makes these rows of again.
    fn __reduce__<'py>(&self, py: Python<'py>) -> (Bound<'py, PyType>, NetRowNumbers<'py>) {
        let (numbers, sizes, offsets, speed) = self.0.numbers();
        let array = |numbers: Vec<f64>| PyArray1::from_vec(py, numbers);
        (
            py.get_type::<Self>(),
            (array(numbers), sizes, array(offsets), speed),
        )
    }
}

/// A joint: its letter, the angle of its cross (U), the steps that carry its links (none for the ground), and those of its columns, if it is
/// in the tree.
type RawJoint = (char, f64, [Option<usize>; 2], Vec<usize>);

fn joint(&(letter, angle, on, _): &RawJoint, frames: [Pose; 2]) -> PyResult<NetJoint> {
    let reading = match letter {
        'R' | 'H' => Reading::Turn,
        'P' => Reading::Slide,
        'C' => Reading::Cylinder,
        'U' => Reading::Cross(angle),
        'S' => Reading::Ball,
        'E' => Reading::Plane,
        'K' => Reading::Slot,
        'L' => Reading::SlotOnPin,
        // a link without a joint
        ' ' => Reading::Anywhere,
        other => return Err(CoreError::new_err(format!("'{other}' is no joint"))),
    };
    Ok(NetJoint { reading, on, frames })
}

fn frames(array: ArrayView3<'_, f64>) -> Vec<Pose> {
    array.axis_iter(Axis(0)).map(pose).collect()
}

/// Why it is not followed, in the words of a message.
fn not_followed(why: NotFollowed) -> PyErr {
    CoreError::new_err(match why {
        NotFollowed::Freedoms(1) => String::from("no independent constraints are found about the drawn pose"),
        NotFollowed::Freedoms(count) => format!("it has {count} freedoms"),
        NotFollowed::Columns(count) => format!("its tree has {count} columns; at most 17 are followed"),
        NotFollowed::NoColumn => String::from("the joint closes a loop"),
    })
}

/// The rank, repeated rows, free motions.
type RawFreedoms = (usize, Vec<Vec<f64>>, Vec<Vec<f64>>);

/// Joint values, closure errors, which are of a curve of poses, and the word for their completeness.
type RawModes<'py> = (
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<bool>>,
    &'static str,
);

#[pymethods]
impl Net {
    /// From the steps' letters R P H, or S R R for a ball, the advance of each for a radian (H), the step before each (none on the ground), places on their axes as
    /// drawn and their directions, each (n, 3), what they read as drawn, the rows, directions of two links that are not opposite, the size of
    /// which residuals are parts, the joints, and their frames (joints, 4, 4) where they read 0 on the link before and on that after.
    #[new]
    #[expect(clippy::too_many_arguments)]
    fn new(
        letters: &str,
        advances: PyReadonlyArray1<'_, f64>,
        parents: Vec<Option<usize>>,
        origins: PyReadonlyArray2<'_, f64>,
        axes: PyReadonlyArray2<'_, f64>,
        reads: PyReadonlyArray1<'_, f64>,
        rows: Vec<RawRow>,
        facing: Vec<([Option<usize>; 2], Vec3)>,
        size: f64,
        joints: Vec<RawJoint>,
        before: PyReadonlyArray3<'_, f64>,
        after: PyReadonlyArray3<'_, f64>,
    ) -> PyResult<Self> {
        let vectors = |array: &PyReadonlyArray2<'_, f64>| -> Vec<Vec3> {
            in_rows(array)
                .chunks(3)
                .map(|v| std::array::from_fn(|k| v.get(k).copied().unwrap_or(0.0)))
                .collect()
        };
        let (advances, origins, axes) = (in_rows(&advances), vectors(&origins), vectors(&axes));
        let count = letters.len();
        let reads = in_rows(&reads);
        if [
            advances.len(),
            parents.len(),
            origins.len(),
            axes.len(),
            reads.len(),
        ] != [count; 5]
        {
            return Err(CoreError::new_err(
                "give an advance, a parent, an origin, an axis and a reading for each letter",
            ));
        }
        let mut steps = Vec::with_capacity(count);
        for (k, letter) in letters.chars().enumerate() {
            let moves = match letter {
                'R' | 'S' => Move::Turn,
                'P' => Move::Slide,
                'H' => Move::Screw(advances[k]),
                other => {
                    return Err(CoreError::new_err(format!(
                        "'{other}' is no step; give R, P, H or S"
                    )));
                }
            };
            if parents[k].is_some_and(|p| p >= k) {
                return Err(CoreError::new_err("the parent of a step is one before it"));
            }
            steps.push(Step {
                parent: parents[k],
                moves,
                origin: origins[k],
                axis: axes[k],
                reads: reads[k],
            });
        }
        let rows: Vec<Row> = rows.into_iter().map(row).collect::<PyResult<_>>()?;
        if rows.iter().flat_map(Row::on).flatten().any(|step| step >= count) {
            return Err(CoreError::new_err("a row is on a step that is not there"));
        }
        let facing: Vec<Facing> = facing
            .into_iter()
            .map(|(on, direction)| Facing { on, direction })
            .collect();
        let on_joints = joints.iter().flat_map(|j| j.2.into_iter().flatten());
        let on_joints = on_joints.chain(joints.iter().flat_map(|j| j.3.iter().copied()));
        let on_facing = facing.iter().flat_map(|f| f.on).flatten();
        if on_joints.chain(on_facing).any(|step| step >= count) {
            return Err(CoreError::new_err("a joint is on a step that is not there"));
        }
        let (before, after) = (frames(before.as_array()), frames(after.as_array()));
        let read: Vec<NetJoint> = joints
            .iter()
            .zip(before.into_iter().zip(after))
            .map(|(raw, (before, after))| joint(raw, [before, after]))
            .collect::<PyResult<_>>()?;
        let balls = letters.chars().enumerate().filter(|(_, letter)| *letter == 'S');
        let balls: Vec<usize> = balls.map(|(k, _)| k).collect();
        if balls.iter().any(|first| first + 2 >= count) {
            return Err(CoreError::new_err("a ball has three steps"));
        }
        let net = nets::Net { steps, rows, facing, balls, size };
        let columns = joints.into_iter().map(|j| j.3);
        Ok(Self(DescribedNet::new(
            net,
            read.into_iter().zip(columns).collect(),
        )))
    }

    /// The freedoms about the pose that is drawn.
    fn freedoms(&self, py: Python<'_>) -> RawFreedoms {
        let found = py.detach(|| self.0.freedoms().clone());
        (found.rank, found.repeated, found.free)
    }

    /// What it is made of, from links solved together.
    fn parts(&self, solved: Vec<RawPart>) -> PyResult<NetParts> {
        parts(solved, self.0.net().steps.len()).map(NetParts)
    }

    /// Joint values (m, columns) and closure errors (m,) of all modes of its parts, with a step
    /// held at a value [rad, or relative to the size], which are of a curve of poses, and their completeness.
    fn modes<'py>(
        &self,
        py: Python<'py>,
        parts: &NetParts,
        driven: usize,
        value: f64,
    ) -> PyResult<RawModes<'py>> {
        if driven >= self.0.net().steps.len() {
            return Err(CoreError::new_err("a step is held that is not there"));
        }
        let found = working(py, || nets::modes(self.0.net(), &parts.0, driven, value))?;
        // what has too many unknowns is searched
        let (found, word) = match found {
            Some(found) => (
                found.modes,
                found.completeness.map_or("closed-form", |c| c.name()),
            ),
            None => (Vec::new(), "searched"),
        };
        let values: Vec<f64> = found
            .iter()
            .flat_map(|mode| self.0.columns_at(&mode.values))
            .collect();
        let residuals: Vec<f64> = found.iter().map(|mode| mode.residual).collect();
        let on_curve: Vec<bool> = found.iter().map(|mode| mode.on_curve).collect();
        let shape = [found.len(), self.0.column_count()];
        Ok((
            PyArray1::from_vec(py, values).reshape(shape)?,
            residuals.into_pyarray(py),
            on_curve.into_pyarray(py),
            word,
        ))
    }

    /// Joint values (m, columns), closure errors (m,) of the poses that are found from many places with a column at a value; which are isolated,
    /// and which are on a curve of poses.
    fn searched_modes<'py>(
        &self,
        py: Python<'py>,
        column: usize,
        value: f64,
    ) -> PyResult<SearchedModes<'py>> {
        let found = working(py, || nets::searched_modes(&self.0, column, value))?.map_err(not_followed)?;
        let values: Vec<f64> = found.iter().flat_map(|mode| mode.0.iter().copied()).collect();
        let residuals: Vec<f64> = found.iter().map(|mode| mode.1).collect();
        let standing =
            |wanted: Standing| -> Vec<bool> { found.iter().map(|mode| mode.2 == wanted).collect() };
        let shape = [found.len(), self.0.column_count()];
        Ok((
            PyArray1::from_vec(py, values).reshape(shape)?,
            residuals.into_pyarray(py),
            standing(Standing::Isolated).into_pyarray(py),
            standing(Standing::OnCurve).into_pyarray(py),
        ))
    }

    /// The whole motion over the inputs of a column; modes are those of its parts, or are searched for.
    #[pyo3(signature = (parts, input, output, samples, speed, law=None))]
    #[expect(clippy::too_many_arguments)]
    fn motion<'py>(
        &self,
        py: Python<'py>,
        parts: Option<&NetParts>,
        input: usize,
        output: usize,
        samples: usize,
        speed: f64,
        law: Option<PyReadonlyArray2<'py, f64>>,
    ) -> PyResult<(RawMotion, Vec<Py<NetRows>>)> {
        let law = law_rows(law);
        let over = Over { input, output, samples, speed, law: law.as_deref() };
        let motion = working(py, || {
            nets::net_motion(&self.0, parts.map(|parts| &*parts.0), &over)
        })?
        .map_err(not_followed)?;
        let (mut circuits, mut rows) = (Vec::new(), Vec::new());
        for circuit in motion.circuits {
            let (circuit, own) = self.circuit(py, circuit)?;
            circuits.push(circuit);
            rows.push(own);
        }
        let raw = RawMotion {
            motion_type: motion.motion_type,
            limits: None,
            circuits,
            change_points: motion.change_points,
            search: Some(Py::new(py, RawSearch::new(py, motion.search)?)?),
            moving: motion.moving,
        };
        Ok((raw, rows))
    }

    /// The one circuit through a pose (columns,), and its rows; else how far the net is from closing, the columns that move with the input at
    /// rest, or nothing where no motion could be followed.
    #[pyo3(signature = (parts, pose, input, output, samples, speed, law=None))]
    #[expect(clippy::too_many_arguments)]
    fn circuit_through<'py>(
        &self,
        py: Python<'py>,
        parts: Option<&NetParts>,
        pose: PyReadonlyArray1<'py, f64>,
        input: usize,
        output: usize,
        samples: usize,
        speed: f64,
        law: Option<PyReadonlyArray2<'py, f64>>,
    ) -> PyResult<RawThrough> {
        let (law, pose) = (law_rows(law), in_rows(&pose));
        if pose.len() != self.0.column_count() {
            return Err(CoreError::new_err("pose needs one value for each column"));
        }
        let over = Over { input, output, samples, speed, law: law.as_deref() };
        let through = working(py, || {
            nets::net_circuit_through(&self.0, parts.map(|parts| &*parts.0), &pose, &over)
        })?
        .map_err(not_followed)?;
        Ok(match through {
            NetThrough::Circuit(circuit, followed) => {
                RawThrough::Circuit((self.circuit(py, *circuit)?, Py::new(py, NetFollowed(*followed))?))
            }
            NetThrough::Apart(gap) => RawThrough::Apart(gap),
            NetThrough::InputRests(moving) => RawThrough::InputRests(moving),
            NetThrough::Still => RawThrough::Still(()),
        })
    }

    /// A circuit that was followed over this input and output, and its rows, once more at other inputs; nothing where none of them is in it.
    #[pyo3(signature = (followed, input, output, samples, speed, law=None))]
    #[expect(clippy::too_many_arguments)]
    fn circuit_again(
        &self,
        py: Python<'_>,
        followed: &NetFollowed,
        input: usize,
        output: usize,
        samples: usize,
        speed: f64,
        law: Option<PyReadonlyArray2<'_, f64>>,
    ) -> PyResult<Option<CircuitAndRows>> {
        let law = law_rows(law);
        let over = Over { input, output, samples, speed, law: law.as_deref() };
        working(py, || nets::net_circuit_again(&self.0, &followed.0, &over))?
            .map_err(not_followed)?
            .map(|circuit| self.circuit(py, circuit))
            .transpose()
    }

    /// d(output)/d(input) at a pose (columns,) where both rest; none where one of them moves.
    fn ratio_at_rest(
        &self,
        pose: PyReadonlyArray1<'_, f64>,
        input: usize,
        output: usize,
    ) -> PyResult<Option<f64>> {
        let pose = in_rows(&pose);
        if pose.len() != self.0.column_count() {
            return Err(CoreError::new_err("pose needs one value for each column"));
        }
        nets::ratio_at_rest(&self.0, &pose, input, output).map_err(not_followed)
    }

    /// A point along rows of a circuit with three derivatives by time, (4, n, 3), in the report frame: of the link that a step carries (none
    /// for the ground), where it is drawn.
    fn point<'py>(
        &self,
        py: Python<'py>,
        rows: &NetRows,
        link: Option<usize>,
        at: [f64; 3],
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        if link.is_some_and(|step| step >= self.0.net().steps.len()) {
            return Err(CoreError::new_err("a point is on a step that is not there"));
        }
        let out = working(py, || self.0.point(&rows.0, link, at))?;
        PyArray1::from_vec(py, out).reshape([4, rows.0.len(), 3])
    }
}

/// Joint values and closure errors of poses; which are isolated, and which are on a curve.
type SearchedModes<'py> = (
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<bool>>,
    Bound<'py, PyArray1<bool>>,
);

/// A circuit and its rows.
type CircuitAndRows = (Py<RawCircuit>, Py<NetRows>);

/// What goes through a pose.
#[derive(IntoPyObject)]
enum RawThrough {
    Circuit((CircuitAndRows, Py<NetFollowed>)),
    Apart(f64),
    InputRests(Vec<usize>),
    Still(()),
}

impl Net {
    fn circuit(&self, py: Python<'_>, circuit: NetCircuit) -> PyResult<CircuitAndRows> {
        let NetCircuit { rows, measures } = circuit;
        let table = working(py, || self.0.joint_table(&rows))?;
        let (mut status, mut branch) = (Vec::with_capacity(rows.len()), Vec::with_capacity(rows.len()));
        let (mut residual, mut condition) = (Vec::with_capacity(rows.len()), Vec::with_capacity(rows.len()));
        for row in rows.rows() {
            status.push(row.status() as i64);
            branch.push(row.pass() as i64);
            residual.push(row.residual());
            condition.push(row.condition());
        }
        let arrays = RowArrays {
            joints: PyArray1::from_vec(py, table)
                .reshape([4, rows.len(), self.0.column_count()])?
                .unbind(),
            status: status.into_pyarray(py).unbind(),
            branch: branch.into_pyarray(py).unbind(),
            mode: None,
            residual: residual.into_pyarray(py).unbind(),
            condition: condition.into_pyarray(py).unbind(),
        };
        let circuit = RawCircuit::new(arrays, &measures, None, None);
        Ok((Py::new(py, circuit)?, Py::new(py, NetRows(rows))?))
    }
}

fn edges(between: Vec<[usize; 2]>, rows: Vec<usize>) -> Vec<Edge> {
    between
        .into_iter()
        .zip(rows)
        .map(|(between, rows)| Edge { between, rows })
        .collect()
}

/// The edges of each biconnected part of a graph, the parts from the root outwards.
#[pyfunction]
pub(crate) fn biconnected_parts(links: usize, between: Vec<[usize; 2]>, root: usize) -> Vec<Vec<usize>> {
    let rows = vec![0; between.len()];
    nets::biconnected_parts(links, &edges(between, rows), root)
}

/// Links and edges, by their numbers.
type LinksAndEdges = (Vec<usize>, Vec<usize>);

/// The links and the edges of each block, in the order of solving; or "free" with links, or "held" with edges.
#[pyfunction]
pub(crate) fn net_blocks(
    between: Vec<[usize; 2]>,
    rows: Vec<usize>,
    known: Vec<bool>,
    freedoms: usize,
) -> (&'static str, Vec<LinksAndEdges>) {
    match nets::blocks(&edges(between, rows), &known, freedoms) {
        Ok(blocks) => ("blocks", blocks.into_iter().map(|b| (b.links, b.edges)).collect()),
        Err(Unbalanced::Free(links)) => ("free", vec![(links, Vec::new())]),
        Err(Unbalanced::Held(edges)) => ("held", vec![(Vec::new(), edges)]),
    }
}
