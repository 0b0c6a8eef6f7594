//! Polynomials along a path, and the motion that they drive, for Python.

use crate::numbers::{Array, shaped};
use crate::working::working;
use crate::{CoreError, in_rows};
use numpy::{PyReadonlyArray1, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;
use sevenbar_core::driven::{Along, Begin, TERMS};
use sevenbar_core::piecewise::Piecewise;

fn pieces<'a>(edges: &'a [f64], series: &'a [f64], shape: &[usize]) -> PyResult<Piecewise<'a>> {
    Piecewise::new(edges, series, shape[1], shape[2])
        .ok_or_else(|| CoreError::new_err("series: it does not fit the edges"))
}

/// Quantities (j, k) at places (j,), from Chebyshev coefficients (pieces, terms, k) between edges (pieces + 1,); by the polynomials
/// of given pieces (j,), or else of the pieces that the places lie on.
#[pyfunction]
#[pyo3(signature = (edges, series, places, on=None))]
pub(crate) fn piecewise<'py>(
    py: Python<'py>,
    edges: PyReadonlyArray1<'py, f64>,
    series: PyReadonlyArray3<'py, f64>,
    places: PyReadonlyArray1<'py, f64>,
    on: Option<PyReadonlyArray1<'py, i64>>,
) -> PyResult<Array<'py>> {
    let (edges, numbers, places) = (in_rows(&edges), in_rows(&series), in_rows(&places));
    let own = pieces(&edges, &numbers, series.shape())?;
    let on = on.as_ref().map(|numbers| {
        numbers
            .as_array()
            .iter()
            .map(|&piece| piece as usize)
            .collect::<Vec<_>>()
    });
    if on
        .as_ref()
        .is_some_and(|numbers| numbers.len() != places.len() || numbers.iter().any(|&i| i >= own.pieces()))
    {
        return Err(CoreError::new_err("on: give a piece for each place"));
    }
    let mut values = vec![0.0; places.len() * own.width()];
    for (k, (&place, out)) in places
        .iter()
        .zip(values.chunks_exact_mut(own.width().max(1)))
        .enumerate()
    {
        let piece = on.as_ref().map_or_else(|| own.piece(place), |numbers| numbers[k]);
        own.on(piece, place, out);
    }
    shaped(py, values, &[places.len(), own.width()])
}

/// A motor's torque: lines through torques at times, or at speeds of the input, and level beyond; or a function of both.
#[derive(FromPyObject)]
pub(crate) enum Motor<'py> {
    Table(bool, Vec<f64>, Vec<f64>),
    Function(Bound<'py, PyAny>),
}

/// Times, series, the state at the end, whether a bound stopped it, whether it is whole.
type StepsFound<'py> = (Array<'py>, Array<'py>, (f64, f64), bool, bool);

fn between(across: &[f64], torques: &[f64], at: f64) -> f64 {
    let next = across.partition_point(|&x| x <= at);
    if next == 0 || next == across.len() {
        return torques[next.saturating_sub(1)];
    }
    let share = (at - across[next - 1]) / (across[next] - across[next - 1]);
    torques[next - 1] + share * (torques[next] - torques[next - 1])
}

/// The motion (s, s') along a circuit from a time, place and speed until a time or one of the bounds of the place: its steps' times
/// (steps + 1,), Chebyshev coefficients (steps, terms, 2), the state at the end, whether a bound stopped it, and whether it could be
/// followed. `quantities` (pieces, terms, 6) are m, U', D, d(input)/ds, what U' gains with each lap, and m'; `motor` is (by time, times or
/// speeds, torques), or a function of both.
#[pyfunction]
#[pyo3(signature = (edges, quantities, lap, begin, errors, bounds, motor=None))]
#[expect(clippy::too_many_arguments)]
pub(crate) fn driven<'py>(
    py: Python<'py>,
    edges: PyReadonlyArray1<'py, f64>,
    quantities: PyReadonlyArray3<'py, f64>,
    lap: Option<f64>,
    begin: (f64, f64, f64, f64),
    errors: (f64, f64),
    bounds: (f64, f64),
    motor: Option<Motor<'py>>,
) -> PyResult<StepsFound<'py>> {
    let (edges, numbers) = (in_rows(&edges), in_rows(&quantities));
    let own = pieces(&edges, &numbers, quantities.shape())?;
    if own.width() != 6 {
        return Err(CoreError::new_err("quantities: give six"));
    }
    let (time, place, speed, until) = begin;
    let begin = Begin {
        time,
        place,
        speed,
        until,
        place_error: errors.0,
        speed_error: errors.1,
    };
    let along = Along { quantities: own, lap };
    let mut raised = None;
    let found = match motor {
        None => working(py, || along.driven(begin, bounds, None))?,
        Some(Motor::Table(by_time, across, torques)) => {
            if across.is_empty() || across.len() != torques.len() {
                return Err(CoreError::new_err(
                    "motor: give as many torques as places of the table",
                ));
            }
            let mut read = |t: f64, speed: f64| between(&across, &torques, if by_time { t } else { speed });
            working(py, || along.driven(begin, bounds, Some(&mut read)))?
        }
        Some(Motor::Function(torque)) => {
            let mut asked = |t: f64, speed: f64| {
                if raised.is_some() {
                    return f64::NAN;
                }
                torque
                    .call1((t, speed))
                    .and_then(|value| value.extract())
                    .unwrap_or_else(|error| {
                        raised = Some(error);
                        f64::NAN
                    })
            };
            along.driven(begin, bounds, Some(&mut asked))
        }
    };
    if let Some(error) = raised {
        return Err(error);
    }
    let steps = found.times.len() - 1;
    Ok((
        shaped(py, found.times, &[steps + 1])?,
        shaped(py, found.series, &[steps, TERMS, 2])?,
        (found.place, found.speed),
        found.stopped,
        found.whole,
    ))
}
