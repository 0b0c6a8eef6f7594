//! Many general loops at once, for Python.

use crate::CoreError;
use crate::loops::{kinds, pose};
use numpy::ndarray::Axis;
use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyReadonlyArray3, PyReadonlyArray4,
    PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sevenbar_core::loops::{CircuitMeasures, Completeness, Loop, Measures};
use sevenbar_core::rigid::Pose;
use sevenbar_core::sweep::in_order;

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

/// A number for each, -1 where there is none.
fn counts<'py, T>(
    py: Python<'py>,
    of: &[T],
    pick: impl Fn(&T) -> Option<usize>,
) -> Bound<'py, PyArray1<i64>> {
    let values: Vec<i64> = of.iter().map(|x| pick(x).map_or(-1, |n| n as i64)).collect();
    values.into_pyarray(py)
}

fn flags<'py, T>(py: Python<'py>, of: &[T], pick: impl Fn(&T) -> bool) -> Bound<'py, PyArray1<u8>> {
    let values: Vec<u8> = of.iter().map(|x| u8::from(pick(x))).collect();
    values.into_pyarray(py)
}

fn numbers<'py, T>(py: Python<'py>, of: &[T], pick: impl Fn(&T) -> f64) -> Bound<'py, PyArray1<f64>> {
    of.iter().map(pick).collect::<Vec<f64>>().into_pyarray(py)
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

/// What the motions of n loops of one pattern of joints come to, with so many rows a turn: arrays by loop, then by circuit, and
/// the circuits' input dead centres, each list one after the other.
///
/// `advances` (n, joints), `base` and `ground` (n, 4, 4), `links` (n, joints - 1, 4, 4), otherwise as for one loop.
#[pyfunction]
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
    threads: usize,
) -> PyResult<Bound<'py, PyDict>> {
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
    let loops = (0..count)
        .map(|n| {
            let kinds = kinds(letters, &advances.row(n).to_vec())?;
            let [base, ground] = [&base, &ground].map(|frames| pose(frames.index_axis(Axis(0), n)));
            let links: Vec<Pose> = links
                .index_axis(Axis(0), n)
                .axis_iter(Axis(0))
                .map(pose)
                .collect();
            Ok((kinds, base, ground, links))
        })
        .collect::<PyResult<Vec<_>>>()?;
    let measures = py.detach(|| {
        in_order(count, threads, |n| {
            let (kinds, base, ground, links) = &loops[n];
            Loop::new(kinds, *base, *ground, links).measures(input, output, samples)
        })
    });
    written(py, &measures)
}

fn written<'py>(py: Python<'py>, loops: &[Measures]) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    let status: Vec<u8> = loops.iter().map(|m| m.driven as u8).collect();
    result.set_item("status", status.into_pyarray(py))?;
    result.set_item("circuits", counts(py, loops, |m| Some(m.circuits.len())))?;
    result.set_item("rank", counts(py, loops, |m| m.rank))?;
    result.set_item("finite", counts(py, loops, |m| m.finite))?;
    result.set_item(
        "complete",
        flags(py, loops, |m| m.completeness == Completeness::Algebraic),
    )?;
    result.set_item("still", counts(py, loops, |m| Some(m.still)))?;
    result.set_item("input_rests", flags(py, loops, |m| m.input_rests))?;
    result.set_item("modes", counts(py, loops, |m| m.modes))?;

    let circuits: Vec<&CircuitMeasures> = loops.iter().flat_map(|m| &m.circuits).collect();
    let range = |pick: fn(&CircuitMeasures) -> [f64; 2]| table(py, circuits.iter().map(|c| pick(c)));
    let ends = |pick: fn(&CircuitMeasures) -> [f64; 4]| table(py, circuits.iter().map(|c| pick(c)));
    result.set_item("closed", flags(py, &circuits, |c| c.closed))?;
    result.set_item("singular", flags(py, &circuits, |c| c.singular))?;
    result.set_item("turns", counts(py, &circuits, |c| Some(c.turns)))?;
    result.set_item("input_range", range(|c| c.input)?)?;
    result.set_item("output_range", range(|c| c.output)?)?;
    result.set_item("input_turns_fully", flags(py, &circuits, |c| c.input[0].is_nan()))?;
    result.set_item(
        "output_turns_fully",
        flags(py, &circuits, |c| c.output[0].is_nan()),
    )?;
    result.set_item("velocity", ends(|c| c.rates[0])?)?;
    result.set_item("acceleration", ends(|c| c.rates[1])?)?;
    result.set_item("jerk", ends(|c| c.rates[2])?)?;
    result.set_item("output_dead_centres", ends(|c| c.output_dead_centres)?)?;
    result.set_item(
        "input_dead_centre_count",
        counts(py, &circuits, |c| Some(c.input_dead_centres.len())),
    )?;
    let limits = circuits.iter().flat_map(|c| c.input_dead_centres.iter().copied());
    result.set_item("input_dead_centres", table(py, limits)?)?;
    result.set_item("residual", numbers(py, &circuits, |c| c.residual))?;
    result.set_item("condition", numbers(py, &circuits, |c| c.condition))?;
    Ok(result)
}
