//! Many linkages at once, for Python.

use crate::{CoreError, input_named, raise};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sevenbar_core::rssr::{self, CircuitMeasures, MOST_LIMITS};

/// M, N, L1, L2, L3 and D as columns of numbers.
fn columns<'a>(dimensions: &'a PyReadonlyArray2<'_, f64>) -> PyResult<[&'a [f64]; 6]> {
    let &[rows, count] = dimensions.shape() else {
        unreachable!("an array of two dimensions");
    };
    let values = dimensions.as_slice().ok().filter(|_| rows == 6).ok_or_else(|| {
        CoreError::new_err(format!(
            "dimensions: an array of shape ({rows}, {count}); give a contiguous one of shape (6, n)"
        ))
    })?;
    Ok(std::array::from_fn(|k| &values[k * count..(k + 1) * count]))
}

/// Rows of numbers as an array of two dimensions.
fn table<const N: usize>(py: Python<'_>, rows: Vec<[f64; N]>) -> PyResult<Bound<'_, PyArray2<f64>>> {
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
    let (columns, input) = (columns(&dimensions)?, input_named(input)?);
    let count = columns[0].len();
    let (mut codes, mut limits) = (vec![0; count], vec![[0.0; MOST_LIMITS]; count]);
    py.detach(|| rssr::classify(columns, input, threads, &mut codes, &mut limits))
        .map_err(raise)?;
    Ok((codes.into_pyarray(py), table(py, limits)?))
}

/// What the motions of square-axis RSSRs (6, n) come to: arrays by linkage, then by circuit, one after the other.
#[pyfunction]
pub(crate) fn measure_rssr<'py>(
    py: Python<'py>,
    dimensions: PyReadonlyArray2<'py, f64>,
    input: &str,
    threads: usize,
) -> PyResult<Bound<'py, PyDict>> {
    let (columns, input) = (columns(&dimensions)?, input_named(input)?);
    let motions = py
        .detach(|| rssr::measure(columns, input, threads))
        .map_err(raise)?;
    let circuits: Vec<&CircuitMeasures> = motions.iter().flat_map(|motion| &motion.circuits).collect();
    let ends =
        |pick: fn(&CircuitMeasures) -> rssr::Ends| table(py, circuits.iter().map(|c| pick(c)).collect());
    let range =
        |pick: fn(&CircuitMeasures) -> [f64; 2]| table(py, circuits.iter().map(|c| pick(c)).collect());

    let result = PyDict::new(py);
    let types: Vec<u8> = motions.iter().map(|motion| motion.motion_type).collect();
    let counts: Vec<i64> = motions
        .iter()
        .map(|motion| motion.circuits.len() as i64)
        .collect();
    let turns: Vec<i64> = circuits.iter().map(|circuit| circuit.turns as i64).collect();
    result.set_item("motion_type", types.into_pyarray(py))?;
    result.set_item("limits", table(py, motions.iter().map(|m| m.limits).collect())?)?;
    result.set_item("circuits", counts.into_pyarray(py))?;
    result.set_item("input_range", range(|c| c.input_range)?)?;
    result.set_item("output_range", range(|c| c.output_range)?)?;
    result.set_item("turns", turns.into_pyarray(py))?;
    result.set_item("transmission", ends(|c| c.transmission)?)?;
    result.set_item("velocity", ends(|c| c.rates[0])?)?;
    result.set_item("acceleration", ends(|c| c.rates[1])?)?;
    result.set_item("jerk", ends(|c| c.rates[2])?)?;
    result.set_item("output_dead_centres", ends(|c| c.output_dead_centres)?)?;
    Ok(result)
}
