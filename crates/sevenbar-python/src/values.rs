//! What crosses the border: values with a getter for each field, which the stub declares.
//!
//! Columns are by their number, angles in radians, lengths in the unit of the description; extremes are the lowest value, the input
//! there, the highest value and the input there.

use crate::rows::{Course, Rows};
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use sevenbar_core::loops::{ChangePoint, Completeness, Count, Found, Search};
use sevenbar_core::outcome::{CircuitMeasures, DeadCentre, Ends};

/// A range, and extremes.
type Range = (f64, f64);
type Extremes = (f64, f64, f64, f64);

/// Kind, input, output, pass and condition of a dead centre.
type DeadCentreRow = (&'static str, f64, f64, usize, f64);

/// A change point: joint values, circuits, ways out, and the most freedoms of a motion out of it.
pub(crate) type ChangePointRow = (Vec<f64>, Vec<usize>, usize, usize);

/// Rows of a circuit: arrays (n,), and joint values with three derivatives (4, n, columns).
pub(crate) struct RowArrays {
    pub joints: Py<PyArray3<f64>>,
    pub status: Py<PyArray1<i64>>,
    pub branch: Py<PyArray1<i64>>,
    pub mode: Option<Py<PyArray1<i64>>>,
    pub residual: Py<PyArray1<f64>>,
    pub condition: Py<PyArray1<f64>>,
}

/// A circuit: its rows, what it is measured by at their speed, and of a general loop the rows as it has them; a long one has no rows and
/// a course instead.
#[pyclass(frozen, get_all, module = "sevenbar._core")]
pub(crate) struct RawCircuit {
    joints: Py<PyArray3<f64>>,
    status: Py<PyArray1<i64>>,
    branch: Py<PyArray1<i64>>,
    mode: Option<Py<PyArray1<i64>>>,
    residual: Py<PyArray1<f64>>,
    condition: Py<PyArray1<f64>>,
    motion_type: &'static str,
    closed: bool,
    turns: usize,
    dead_centres: Vec<DeadCentreRow>,
    input_range: Option<Range>,
    output_range: Option<Range>,
    transmission: Option<Extremes>,
    angle: Option<Extremes>,
    velocity: Option<Extremes>,
    acceleration: Option<Extremes>,
    jerk: Option<Extremes>,
    swing: Option<f64>,
    time_ratio: Option<f64>,
    many_strokes: bool,
    rows: Option<Py<Rows>>,
    course: Option<Py<Course>>,
}

impl RawCircuit {
    pub fn new(
        arrays: RowArrays,
        measures: &CircuitMeasures,
        rows: Option<Py<Rows>>,
        course: Option<Py<Course>>,
    ) -> Self {
        let RowArrays { joints, status, branch, mode, residual, condition } = arrays;
        let [velocity, acceleration, jerk] = measures.rates.map(extremes);
        Self {
            joints,
            status,
            branch,
            mode,
            residual,
            condition,
            motion_type: measures.motion_type,
            closed: measures.closed,
            turns: measures.turns,
            dead_centres: measures.dead_centres.iter().map(dead_centre).collect(),
            input_range: measures.input.map(|[low, high]| (low, high)),
            output_range: measures.output.map(|[low, high]| (low, high)),
            transmission: extremes(measures.transmission),
            angle: extremes(measures.angle()),
            velocity,
            acceleration,
            jerk,
            swing: measures.swing(),
            time_ratio: measures.time_ratio(),
            many_strokes: measures.many_strokes(),
            rows,
            course,
        }
    }
}

fn extremes(ends: Option<Ends>) -> Option<Extremes> {
    ends.map(|[low, high]| (low[0], low[1], high[0], high[1]))
}

fn dead_centre(d: &DeadCentre) -> DeadCentreRow {
    (d.kind.name(), d.input, d.output, d.branch, d.condition)
}

pub(crate) fn change_point(point: ChangePoint) -> ChangePointRow {
    (point.values, point.circuits, point.ways, point.freedoms)
}

/// A whole motion. `limits` are those of an RSSR, `search` that of a general loop; `moving` the columns that move with the input at rest.
#[pyclass(frozen, get_all, module = "sevenbar._core")]
pub(crate) struct RawMotion {
    pub motion_type: &'static str,
    pub limits: Option<Py<PyArray1<f64>>>,
    pub circuits: Vec<Py<RawCircuit>>,
    pub change_points: Vec<ChangePointRow>,
    pub search: Option<Py<RawSearch>>,
    pub moving: Option<Vec<usize>>,
}

/// How freely a loop moves, as found in its poses: the wrenches (k, 6) are those that its redundant constraints bear.
#[pyclass(frozen, get_all, module = "sevenbar._core")]
pub(crate) struct RawFound {
    rank: usize,
    finite: usize,
    wrenches: Py<PyArray2<f64>>,
}

impl RawFound {
    pub fn new(py: Python<'_>, found: &Found) -> PyResult<Self> {
        // force, then moment
        let wrench = |w: &Vec<f64>| [w[3], w[4], w[5], w[0], w[1], w[2]];
        let wrenches: Vec<f64> = found.redundant.iter().flat_map(wrench).collect();
        let wrenches = PyArray1::from_vec(py, wrenches);
        Ok(Self {
            rank: found.rank,
            finite: found.finite,
            wrenches: wrenches.reshape([found.redundant.len(), 6])?.unbind(),
        })
    }
}

/// The result of a search for circuits.
#[pyclass(frozen, get_all, module = "sevenbar._core")]
pub(crate) struct RawSearch {
    found: Option<Py<RawFound>>,
    completeness: &'static str,
    columns: Vec<usize>,
    values: usize,
    unfollowed: usize,
    bound: Option<&'static str>,
    open_by: Py<PyArray1<f64>>,
    count: Option<Py<RawCount>>,
    uncounted: Option<&'static str>,
}

impl RawSearch {
    pub fn new(py: Python<'_>, search: Search) -> PyResult<Self> {
        let counted = search.completeness == Completeness::Algebraic && search.is_counted();
        let found = search.found.as_ref().map(|f| Py::new(py, RawFound::new(py, f)?));
        let (count, uncounted) = match search.count {
            Ok(count) => (Some(Py::new(py, RawCount::from(count))?), None),
            Err(why) => (None, Some(why.name())),
        };
        Ok(Self {
            found: found.transpose()?,
            completeness: if counted {
                "counted"
            } else {
                search.completeness.name()
            },
            columns: search.columns,
            values: search.values,
            unfollowed: search.unfollowed,
            bound: search.bound.map(|bound| bound.name()),
            open_by: PyArray1::from_vec(py, search.open_by).unbind(),
            count,
            uncounted,
        })
    }
}

/// The account of a column's branch points; of each range that is open its ends, and how many are missing there.
#[pyclass(frozen, get_all, module = "sevenbar._core")]
pub(crate) struct RawCount {
    column: usize,
    dead_centres: usize,
    complex_branch_points: usize,
    poles: usize,
    circles: usize,
    open: Vec<(f64, f64, Option<i64>)>,
}

impl From<Count> for RawCount {
    fn from(count: Count) -> Self {
        Self {
            column: count.column,
            dead_centres: count.dead_centres,
            complex_branch_points: count.complex_branch_points,
            poles: count.poles,
            circles: count.circles,
            open: count.open.iter().map(|o| (o.from, o.to, o.missing)).collect(),
        }
    }
}
