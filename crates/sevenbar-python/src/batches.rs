//! Many linkages at once, for Python.

use crate::loops::{kinds, pose};
use crate::working::working;
use crate::{CoreError, in_rows, input_named, raise};
use numpy::ndarray::Axis;
use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3,
    PyReadonlyArray4, PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use sevenbar_core::loops::{self, Loop, Measures};
use sevenbar_core::outcome::{CircuitMeasures, DeadCentreKind, Ends};
use sevenbar_core::parallel::in_order;
use sevenbar_core::rigid::Pose;
use sevenbar_core::rssr::{self, MOST_LIMITS, MotionMeasures};

/// What circuits are measured by: arrays (c,), and extremes (c, 4), the lowest and its input, the highest and its input; NaN where
/// there is nothing.
#[pyclass(frozen, get_all, module = "sevenbar._core")]
pub(crate) struct RawMeasures {
    turns: Py<PyArray1<i64>>,
    swing: Py<PyArray1<f64>>,
    time_ratio: Py<PyArray1<f64>>,
    transmission: Py<PyArray2<f64>>,
    velocity: Py<PyArray2<f64>>,
    acceleration: Py<PyArray2<f64>>,
    jerk: Py<PyArray2<f64>>,
}

impl RawMeasures {
    fn new(py: Python<'_>, circuits: &[&CircuitMeasures]) -> PyResult<Self> {
        let number = |pick: fn(&CircuitMeasures) -> Option<f64>| {
            PyArray1::from_iter(py, circuits.iter().map(|c| pick(c).unwrap_or(f64::NAN))).unbind()
        };
        let extremes = |pick: &dyn Fn(&CircuitMeasures) -> Option<Ends>| -> PyResult<Py<PyArray2<f64>>> {
            let row = |ends: Option<Ends>| {
                ends.map_or([f64::NAN; 4], |[low, high]| [low[0], low[1], high[0], high[1]])
            };
            Ok(table(py, circuits.iter().map(|c| row(pick(c))))?.unbind())
        };
        Ok(Self {
            turns: PyArray1::from_iter(py, circuits.iter().map(|c| c.turns as i64)).unbind(),
            swing: number(CircuitMeasures::swing),
            time_ratio: number(CircuitMeasures::time_ratio),
            transmission: extremes(&|c| c.transmission)?,
            velocity: extremes(&|c| c.rates[0])?,
            acceleration: extremes(&|c| c.rates[1])?,
            jerk: extremes(&|c| c.rates[2])?,
        })
    }
}

/// The motions of RSSRs: codes of motion types (n,), limits (n, 4), rising, NaN after the last, how many circuits each has (n,), and
/// the measures of all circuits (c,), one after the other.
#[pyclass(frozen, get_all, module = "sevenbar._core")]
pub(crate) struct RssrBatch {
    codes: Py<PyArray1<u8>>,
    limits: Py<PyArray2<f64>>,
    circuits: Py<PyArray1<i64>>,
    measures: Py<RawMeasures>,
}

impl RssrBatch {
    fn new(py: Python<'_>, motions: &[MotionMeasures]) -> PyResult<Self> {
        let circuits: Vec<&CircuitMeasures> = motions.iter().flat_map(|motion| &motion.circuits).collect();
        Ok(Self {
            codes: PyArray1::from_iter(py, motions.iter().map(|m| m.motion_type)).unbind(),
            limits: table(py, motions.iter().map(|m| m.limits))?.unbind(),
            circuits: PyArray1::from_iter(py, motions.iter().map(|m| m.circuits.len() as i64)).unbind(),
            measures: Py::new(py, RawMeasures::new(py, &circuits)?)?,
        })
    }
}

/// The motions of general loops: whether each is driven (n,), its motion type, how many circuits it has (n,); of all circuits, one
/// after the other, the motion type, how many input dead centres (c,), the inputs at these, and the measures.
#[pyclass(frozen, get_all, module = "sevenbar._core")]
pub(crate) struct LoopBatch {
    status: Py<PyArray1<u8>>,
    motion_types: Vec<&'static str>,
    circuits: Py<PyArray1<i64>>,
    circuit_types: Vec<&'static str>,
    limit_counts: Py<PyArray1<i64>>,
    limits: Py<PyArray1<f64>>,
    measures: Py<RawMeasures>,
}

impl LoopBatch {
    fn new(py: Python<'_>, loops: &[Measures]) -> PyResult<Self> {
        let circuits: Vec<&CircuitMeasures> = loops.iter().flat_map(|m| &m.circuits).collect();
        let limits = |c: &CircuitMeasures| -> Vec<f64> {
            let inputs = c.dead_centres.iter().filter(|d| d.kind == DeadCentreKind::Input);
            inputs.map(|d| d.input).collect()
        };
        let limits: Vec<Vec<f64>> = circuits.iter().map(|c| limits(c)).collect();
        Ok(Self {
            status: PyArray1::from_iter(py, loops.iter().map(|m| m.driven as u8)).unbind(),
            motion_types: loops.iter().map(|m| m.motion_type).collect(),
            circuits: PyArray1::from_iter(py, loops.iter().map(|m| m.circuits.len() as i64)).unbind(),
            circuit_types: circuits.iter().map(|c| c.motion_type).collect(),
            limit_counts: PyArray1::from_iter(py, limits.iter().map(|l| l.len() as i64)).unbind(),
            limits: PyArray1::from_vec(py, limits.concat()).unbind(),
            measures: Py::new(py, RawMeasures::new(py, &circuits)?)?,
        })
    }
}

/// M, N, L1, L2, L3 and D, from an array of this shape row by row.
fn columns<'a>(dimensions: &'a [f64], shape: &[usize]) -> PyResult<[&'a [f64]; 6]> {
    let &[6, count] = shape else {
        return Err(CoreError::new_err(format!(
            "dimensions: an array of shape {shape:?}; give one of shape (6, n)"
        )));
    };
    Ok(std::array::from_fn(|k| &dimensions[k * count..(k + 1) * count]))
}

/// Rows of numbers as an array of two dimensions.
fn table<const N: usize>(
    py: Python<'_>,
    rows: impl Iterator<Item = [f64; N]>,
) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let rows: Vec<[f64; N]> = rows.collect();
    let count = rows.len();
    PyArray1::from_vec(py, rows.into_flattened()).reshape([count, N])
}

type Classes<'py> = (Bound<'py, PyArray1<u8>>, Bound<'py, PyArray2<f64>>);

/// Motion types as codes (n,) and limits (n, 4), rising, NaN after the last, of square-axis RSSRs (6, n).
#[pyfunction]
pub(crate) fn classify_rssr<'py>(
    py: Python<'py>,
    dimensions: PyReadonlyArray2<'py, f64>,
    input: &str,
    threads: usize,
) -> PyResult<Classes<'py>> {
    let numbers = in_rows(&dimensions);
    let (columns, input) = (columns(&numbers, dimensions.shape())?, input_named(input)?);
    let count = columns[0].len();
    let (mut codes, mut limits) = (vec![0; count], vec![[0.0; MOST_LIMITS]; count]);
    working(py, || {
        rssr::classify(columns, input, threads, &mut codes, &mut limits)
    })?
    .map_err(raise)?;
    Ok((codes.into_pyarray(py), table(py, limits.into_iter())?))
}

/// The measures of the motions of square-axis RSSRs (6, n), the input of each at its speed (n,).
#[pyfunction]
pub(crate) fn measure_rssr<'py>(
    py: Python<'py>,
    dimensions: PyReadonlyArray2<'py, f64>,
    input: &str,
    speed: PyReadonlyArray1<'py, f64>,
    threads: usize,
) -> PyResult<RssrBatch> {
    let (numbers, speeds) = (in_rows(&dimensions), in_rows(&speed));
    let (columns, input) = (columns(&numbers, dimensions.shape())?, input_named(input)?);
    checked("speed", speed.shape(), &[columns[0].len()])?;
    let motions = working(py, || rssr::measure(columns, input, &speeds, threads))?.map_err(raise)?;
    RssrBatch::new(py, &motions)
}

fn checked(name: &str, shape: &[usize], want: &[usize]) -> PyResult<()> {
    if shape == want {
        return Ok(());
    }
    Err(CoreError::new_err(format!(
        "{name}: an array of shape {shape:?}; give {want:?}"
    )))
}

fn finite<'a>(name: &str, values: impl Iterator<Item = &'a f64>) -> PyResult<()> {
    match values.into_iter().find(|x| !x.is_finite()) {
        None => Ok(()),
        Some(x) => Err(CoreError::new_err(format!("{name}: {x} is not a finite number"))),
    }
}

/// The measures of the motions of n loops of one pattern of joints, with so many rows a turn, the input of each at its speed.
///
/// `advances` (n, joints), `base` and `ground` (n, 4, 4), `links` (n, joints - 1, 4, 4), `speed` (n,), `drawn` (n, columns), otherwise as
/// for one loop.
#[pyfunction]
#[pyo3(signature = (letters, advances, base, ground, links, input, output, samples, speed, threads, drawn=None))]
#[expect(clippy::too_many_arguments)]
pub(crate) fn measure_loops<'py>(
    py: Python<'py>,
    letters: &str,
    advances: PyReadonlyArray2<'py, f64>,
    base: PyReadonlyArray3<'py, f64>,
    ground: PyReadonlyArray3<'py, f64>,
    links: PyReadonlyArray4<'py, f64>,
    input: usize,
    output: usize,
    samples: usize,
    speed: PyReadonlyArray1<'py, f64>,
    threads: usize,
    drawn: Option<PyReadonlyArray2<'py, f64>>,
) -> PyResult<LoopBatch> {
    let joints = letters.chars().count();
    if joints < 2 || samples == 0 {
        return Err(CoreError::new_err(format!(
            "{joints} joints and {samples} samples; give two or more joints, one or more samples"
        )));
    }
    let count = advances.shape()[0];
    checked("advances", advances.shape(), &[count, joints])?;
    checked("base", base.shape(), &[count, 4, 4])?;
    checked("ground", ground.shape(), &[count, 4, 4])?;
    checked("links", links.shape(), &[count, joints - 1, 4, 4])?;
    checked("speed", speed.shape(), &[count])?;
    let speed = in_rows(&speed);
    let (advances, base, ground, links) = (
        advances.as_array(),
        base.as_array(),
        ground.as_array(),
        links.as_array(),
    );
    finite("advances", advances.iter())?;
    finite("base", base.iter())?;
    finite("ground", ground.iter())?;
    finite("links", links.iter())?;
    let columns = kinds(letters, &vec![0.0; joints])?
        .iter()
        .map(|k| k.columns())
        .sum();
    for (name, column) in [("input", input), ("output", output)] {
        if column >= columns {
            return Err(CoreError::new_err(format!(
                "{name}: no column {column}; give 0 to {}",
                columns - 1
            )));
        }
    }
    if let Some(drawn) = &drawn {
        checked("drawn", drawn.shape(), &[count, columns])?;
    }
    let described = (0..count)
        .map(|n| {
            let kinds = kinds(letters, &advances.row(n).to_vec())?;
            let [base, ground] = [&base, &ground].map(|frames| pose(frames.index_axis(Axis(0), n)));
            let links: Vec<Pose> = links
                .index_axis(Axis(0), n)
                .axis_iter(Axis(0))
                .map(pose)
                .collect();
            let drawn = drawn.as_ref().map(|d| d.as_array().row(n).to_vec());
            Ok((kinds, base, ground, links, drawn))
        })
        .collect::<PyResult<Vec<_>>>()?;
    let measures = working(py, || {
        in_order(count, threads, |n| {
            let (kinds, base, ground, links, drawn) = &described[n];
            let linkage = Loop::new(kinds, *base, *ground, links);
            let linkage = match drawn {
                Some(values) => loops::drawn_at(linkage, values),
                None => linkage,
            };
            loops::measures(&linkage, input, output, samples, speed[n])
        })
    })?;
    LoopBatch::new(py, &measures)
}
