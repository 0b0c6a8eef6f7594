//! Surveys of many RSSRs, for Python.

use crate::working::working;
use crate::{CoreError, in_rows};
use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2,
    PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use sevenbar_core::survey::{self, Draw, Entry, NUMBERS, Rank, Readings, Tally, Want, Wish};
use std::collections::HashMap;

/// The best of a tally that are handed on.
const BEST: usize = 100;

/// Linkages that are worth keeping (n,): their indices, their parts of the cube, and what was measured of them (n, 8).
type Entries<'py> = (
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray2<f64>>,
);

/// Counts of a measure, and the width of their cells.
type Spread = (f64, Vec<u64>);

/// The tally of the linkages of some indices.
#[pyclass(frozen, module = "sevenbar._core")]
pub(crate) struct RawTally(Tally);

#[pymethods]
impl RawTally {
    /// How many had each verdict.
    #[getter]
    fn verdicts(&self) -> Vec<u64> {
        self.0.verdicts.to_vec()
    }

    /// How many were of each motion type, by its code.
    #[getter]
    fn types(&self) -> Vec<u64> {
        self.0.types.to_vec()
    }

    /// How many inputs have no, two, or four limits.
    #[getter]
    fn limits(&self) -> Vec<u64> {
        self.0.limits.to_vec()
    }

    /// How measures are spread, by their names.
    #[getter]
    fn spreads(&self) -> HashMap<&'static str, Spread> {
        let tally = &self.0;
        [
            ("swing", &tally.swing),
            ("slow", &tally.slow),
            ("transmission", &tally.transmission),
            ("error", &tally.error),
            ("cone", &tally.cone),
        ]
        .into_iter()
        .map(|(name, found)| (name, (found.step, found.counts.to_vec())))
        .collect()
    }

    /// The best of the parts of the cube, best first.
    #[getter]
    fn best<'py>(&self, py: Python<'py>) -> PyResult<Entries<'py>> {
        let best = self.0.best(BEST);
        entries(
            py,
            best.iter().map(|(cell, entry)| (2 * cell + entry.branch, entry)),
        )
    }

    /// Of each verdict the linkage that came nearest to pass; the verdict in the place of the part.
    #[getter]
    fn nearest<'py>(&self, py: Python<'py>) -> PyResult<Entries<'py>> {
        let there = self.0.nearest.iter().enumerate();
        entries(
            py,
            there.filter_map(|(verdict, entry)| entry.as_ref().map(|e| (verdict, e))),
        )
    }
}

fn entries<'py, 'a>(
    py: Python<'py>,
    found: impl Iterator<Item = (usize, &'a Entry)>,
) -> PyResult<Entries<'py>> {
    let (mut indices, mut places, mut rows) = (Vec::new(), Vec::new(), Vec::new());
    for (place, e) in found {
        indices.push(e.index as i64);
        places.push(place as i64);
        let [crank, rocker] = e.cones;
        let branch = e.branch as f64;
        rows.extend([
            e.figure,
            e.error,
            e.transmission,
            crank,
            rocker,
            e.start,
            branch,
            e.sense,
        ]);
    }
    let count = indices.len();
    Ok((
        indices.into_pyarray(py),
        places.into_pyarray(py),
        PyArray1::from_vec(py, rows).reshape([count, 8])?,
    ))
}

/// RSSRs drawn from a sequence, and what is wanted of them.
#[pyclass(frozen, module = "sevenbar._core")]
pub(crate) struct Survey {
    draw: Draw,
    wish: Wish,
}

#[pymethods]
impl Survey {
    /// Bounds (7, 2) of M, N, L1, L2, L3, D and the angle between the axes, and a seed; what must hold; and either `readings`
    /// (2, n) of input and output, or a `swing`: its angle, and the input's turn on the slower stroke.
    #[new]
    #[pyo3(signature = (
        bounds, seed, *, tolerance, motion_type, ratio, transmission, cones, seats, rank,
        readings=None, swing=None, ends_only=false, monotone=false
    ))]
    #[expect(clippy::too_many_arguments)]
    fn new(
        bounds: PyReadonlyArray2<'_, f64>,
        seed: u64,
        tolerance: f64,
        motion_type: Option<u8>,
        ratio: f64,
        transmission: f64,
        cones: [f64; 2],
        seats: [Option<[f64; 3]>; 2],
        rank: &str,
        readings: Option<PyReadonlyArray2<'_, f64>>,
        swing: Option<[f64; 2]>,
        ends_only: bool,
        monotone: bool,
    ) -> PyResult<Self> {
        if bounds.shape() != [NUMBERS, 2] {
            return Err(CoreError::new_err("bounds: give an array of shape (7, 2)"));
        }
        let table = bounds.as_array();
        let want = match (readings, swing) {
            (Some(readings), None) => {
                if readings.shape()[0] != 2 || readings.shape()[1] < 2 {
                    return Err(CoreError::new_err(
                        "readings: give an array of shape (2, n), n at least 2",
                    ));
                }
                let rows: [Vec<f64>; 2] = std::array::from_fn(|k| readings.as_array().row(k).to_vec());
                Want::Readings(Readings::new(&rows[0], &rows[1], ends_only, monotone))
            }
            (None, Some([angle, slow])) => Want::Swing { angle, slow },
            _ => {
                return Err(CoreError::new_err(
                    "readings: give them or a swing, one of the two",
                ));
            }
        };
        let rank = match rank {
            "error" => Rank::Error,
            "transmission" => Rank::Transmission,
            "cone" => Rank::Cone,
            _ => {
                return Err(CoreError::new_err(format!(
                    "rank: '{rank}' is none; give error, transmission or cone"
                )));
            }
        };
        let draw = Draw::new(std::array::from_fn(|k| [table[[k, 0]], table[[k, 1]]]), seed);
        let wish = Wish { want, tolerance, motion_type, ratio, transmission, cones, seats, rank };
        Ok(Self { draw, wish })
    }

    /// Judges `count` linkages from index `first` on.
    fn tally(&self, py: Python<'_>, first: u64, count: u64) -> PyResult<RawTally> {
        working(py, || survey::survey(&self.draw, &self.wish, first, count)).map(RawTally)
    }

    /// The numbers (n, 7) of linkages by their indices.
    fn numbers<'py>(
        &self,
        py: Python<'py>,
        indices: PyReadonlyArray1<'py, i64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let indices = indices.as_array();
        let rows: Vec<f64> = indices
            .iter()
            .flat_map(|&k| self.draw.numbers(k as u64))
            .collect();
        PyArray1::from_vec(py, rows).reshape([indices.len(), NUMBERS])
    }
}

/// Codes of motion types (n,), limits (n, 4), swings and time ratios of both circuits (n, 2), least transmission angles (n,).
type Figures<'py> = (
    Bound<'py, PyArray1<u8>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray1<f64>>,
);

/// What RSSRs of any axes are measured by, from their numbers (7 n,), one linkage after the other.
#[pyfunction]
pub(crate) fn survey_figures<'py>(
    py: Python<'py>,
    numbers: PyReadonlyArray1<'py, f64>,
) -> PyResult<Figures<'py>> {
    let numbers = in_rows(&numbers);
    let (rows, _) = numbers.as_chunks::<NUMBERS>();
    let found = working(py, || survey::figures(rows))?;
    let count = found.len();
    let table = |values: Vec<f64>, columns: usize| PyArray1::from_vec(py, values).reshape([count, columns]);
    Ok((
        PyArray1::from_iter(py, found.iter().map(|f| f.motion_type)),
        table(found.iter().flat_map(|f| f.limits).collect(), 4)?,
        table(found.iter().flat_map(|f| f.swing).collect(), 2)?,
        table(found.iter().flat_map(|f| f.time_ratio).collect(), 2)?,
        PyArray1::from_iter(py, found.iter().map(|f| f.transmission)),
    ))
}
