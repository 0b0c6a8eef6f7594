//! The RSSR, for Python.

use crate::loops::pose;
use crate::values::{RawCircuit, RawMotion, RowArrays};
use crate::working::working;
use crate::{CoreError, in_rows, input_named, law_rows, raise};
use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2,
    PyReadonlyArray3,
};
use pyo3::prelude::*;
use sevenbar_core::rssr::{self, BatchRates, Row};
use sevenbar_core::taylor::Taylor;

type AssemblyModes<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>);

/// The RSSR in closed form.
#[pyclass(frozen, module = "sevenbar._core")]
pub(crate) struct Rssr(rssr::Rssr);

#[pymethods]
impl Rssr {
    /// From the frames of joint 1 and of the ground's side of joint 4, each (4, 4), and the transforms of the moving links
    /// (3, 4, 4).
    #[new]
    fn new(
        base: PyReadonlyArray2<'_, f64>,
        ground: PyReadonlyArray2<'_, f64>,
        links: PyReadonlyArray3<'_, f64>,
    ) -> PyResult<Self> {
        let (base, ground, links) = (base.as_array(), ground.as_array(), links.as_array());
        if base.shape() != [4, 4] || ground.shape() != [4, 4] || links.shape() != [3, 4, 4] {
            return Err(CoreError::new_err(
                "base and ground need shape (4, 4), links shape (3, 4, 4)",
            ));
        }
        let links = std::array::from_fn(|n| pose(links.index_axis(numpy::ndarray::Axis(0), n)));
        rssr::Rssr::new(pose(base), pose(ground), links)
            .map(Self)
            .map_err(raise)
    }

    /// The lengths of crank, coupler and rocker.
    #[getter]
    fn lengths(&self) -> [f64; 3] {
        self.0.lengths()
    }

    /// The size of which residuals are parts.
    #[getter]
    fn size(&self) -> f64 {
        self.0.size()
    }

    /// Whether crank or rocker is free at some angle of the other.
    #[getter]
    fn has_free_side(&self) -> bool {
        self.0.has_free_side()
    }

    /// Both branches and their derivatives up to an order: an array (2, n) for each order from 0.
    #[pyo3(signature = (inputs, order, input, speed, law=None))]
    fn outputs<'py>(
        &self,
        py: Python<'py>,
        inputs: PyReadonlyArray1<'py, f64>,
        order: u8,
        input: &str,
        speed: f64,
        law: Option<[PyReadonlyArray1<'py, f64>; 3]>,
    ) -> PyResult<Vec<Bound<'py, PyArray2<f64>>>> {
        let pair = self.0.pair(input_named(input)?);
        let values = in_rows(&inputs);
        let law = law.as_ref().map(|rates| rates.each_ref().map(in_rows));
        let rates = match &law {
            None => BatchRates::Constant(speed),
            Some(rates) => BatchRates::Law(rates.each_ref().map(|d| &**d)),
        };
        let outputs = (0..=order)
            .map(|_| PyArray2::zeros(py, [2, values.len()], false))
            .collect::<Vec<_>>();
        let mut arrays = outputs.iter().map(|array| array.readwrite()).collect::<Vec<_>>();
        let mut slices = arrays
            .iter_mut()
            .map(|array| array.as_slice_mut())
            .collect::<Result<Vec<_>, _>>()?;
        py.detach(|| pair.outputs(&values, rates, &mut slices))
            .map_err(raise)?;
        drop(arrays);
        Ok(outputs)
    }

    /// Joint values (m, 8) and closure errors (m,) of each assembly mode at one input.
    fn assembly_modes<'py>(&self, py: Python<'py>, theta: f64, input: &str) -> PyResult<AssemblyModes<'py>> {
        let modes = self.0.assembly_modes(input_named(input)?, theta);
        let joints = modes.iter().flat_map(|m| m.0).collect::<Vec<f64>>();
        let residuals = modes.iter().map(|m| m.1).collect::<Vec<f64>>();
        let columns = modes.first().map_or(8, |m| m.0.len());
        Ok((
            PyArray1::from_vec(py, joints).reshape([modes.len(), columns])?,
            residuals.into_pyarray(py),
        ))
    }

    /// The whole motion, by a law where one is given.
    #[pyo3(signature = (input, samples, speed, law=None))]
    fn motion<'py>(
        &self,
        py: Python<'py>,
        input: &str,
        samples: usize,
        speed: f64,
        law: Option<PyReadonlyArray2<'py, f64>>,
    ) -> PyResult<RawMotion> {
        let input = input_named(input)?;
        let law = law_rows(law);
        let motion = working(py, || self.0.motion(input))?;
        let rows = |circuit: &rssr::Circuit| match &law {
            None => self.0.rows(&motion, circuit, samples, speed),
            Some(law) => self.0.law_rows(&motion, circuit, law).concat(),
        };
        let change_points = motion
            .change_points
            .iter()
            .map(|&at| {
                let (values, circuits) = self.0.change_point(&motion, at);
                // two branches cross
                let (ways, freedoms) = if circuits.is_empty() { (0, 0) } else { (4, 1) };
                (values.to_vec(), circuits, ways, freedoms)
            })
            .collect();
        let circuits = motion
            .circuits
            .iter()
            .map(|circuit| {
                // the rows of one circuit at a time, for a million take room
                let rows = working(py, || rows(circuit))?;
                let mut measures = rssr::measures_with_rows(circuit.clone(), &rows, input);
                if law.is_none() {
                    measures = measures.at_speed(speed);
                }
                Py::new(py, RawCircuit::new(arrays(py, &rows)?, &measures, None, None))
            })
            .collect::<PyResult<_>>()?;
        Ok(RawMotion {
            motion_type: motion.motion_type.name(),
            limits: Some(motion.limits.into_pyarray(py).unbind()),
            circuits,
            change_points,
            search: None,
            moving: None,
        })
    }

    /// A point of a link with three derivatives by time, (4, n, 3), from the joints' (n, 4) at crank and rocker.
    fn point<'py>(
        &self,
        py: Python<'py>,
        link: usize,
        at: [f64; 3],
        crank: PyReadonlyArray2<'py, f64>,
        rocker: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let (crank, rocker) = (crank.as_array(), rocker.as_array());
        if crank.shape() != rocker.shape() || crank.shape().get(1) != Some(&4) {
            return Err(CoreError::new_err("crank and rocker need the same shape (n, 4)"));
        }
        let count = crank.shape()[0];
        let mut out = vec![0.0; 4 * count * 3];
        for n in 0..count {
            let row = |joint: &numpy::ndarray::ArrayView2<'_, f64>| -> [f64; 4] {
                std::array::from_fn(|k| joint[[n, k]])
            };
            let (a, b) = (row(&crank), row(&rocker));
            let has_rates = a.iter().chain(&b).all(|x| x.is_finite());
            let columns: [[f64; 3]; 4] = if has_rates {
                let moved = self.0.point(
                    link,
                    at,
                    Taylor::<4>::from_derivatives(&a),
                    Taylor::from_derivatives(&b),
                );
                let moved = moved.map_err(raise)?;
                std::array::from_fn(|k| std::array::from_fn(|i| moved[i].derivative(k)))
            } else {
                let still = self
                    .0
                    .point(link, at, Taylor::<1>::constant(a[0]), Taylor::constant(b[0]))
                    .map_err(raise)?;
                let mut columns = [[f64::NAN; 3]; 4];
                columns[0] = std::array::from_fn(|i| still[i].value());
                columns
            };
            for (k, column) in columns.iter().enumerate() {
                out[(k * count + n) * 3..(k * count + n) * 3 + 3].copy_from_slice(column);
            }
        }
        PyArray1::from_vec(py, out).reshape([4, count, 3])
    }
}

fn arrays(py: Python<'_>, rows: &[Row]) -> PyResult<RowArrays> {
    let column = |pick: fn(&Row) -> f64| PyArray1::from_iter(py, rows.iter().map(pick)).unbind();
    let count =
        |pick: fn(&Row) -> usize| PyArray1::from_iter(py, rows.iter().map(|r| pick(r) as i64)).unbind();
    let mut joints = Vec::with_capacity(rows.len() * 32);
    for order in 0..4 {
        for row in rows {
            joints.extend(row.joints.iter().map(|q| q[order]));
        }
    }
    let columns = rows.first().map_or(8, |r| r.joints.len());
    Ok(RowArrays {
        joints: PyArray1::from_vec(py, joints)
            .reshape([4, rows.len(), columns])?
            .unbind(),
        status: count(|r| r.status as usize),
        branch: count(|r| r.branch),
        mode: Some(count(|r| r.mode)),
        residual: column(|r| r.residual),
        condition: column(|r| r.condition),
    })
}
