//! The only crate that knows Python: arrays in, arrays out, the interpreter free while the core works.

mod loops;
mod numbers;
mod sweep;
mod sweep_loops;

use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2,
    PyReadonlyArray3, PyReadwriteArray2,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sevenbar_core::error::Error;
use sevenbar_core::outcome::DeadCentre;
use sevenbar_core::rssr::{self, BatchRates, Circuit, Extent, Extreme, Input, Row};
use sevenbar_core::taylor::Taylor;

pyo3::create_exception!(
    _core,
    CoreError,
    PyValueError,
    "A request that the core cannot take."
);

fn raise(error: Error) -> PyErr {
    CoreError::new_err(error.to_string())
}

fn input_named(name: &str) -> PyResult<Input> {
    match name {
        "crank" => Ok(Input::Crank),
        "rocker" => Ok(Input::Rocker),
        _ => Err(CoreError::new_err(format!(
            "input: '{name}' is not a side link; give crank or rocker"
        ))),
    }
}

type AssemblyModes<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>);

/// A contiguous array as a slice.
fn flat<'a>(what: &str, array: &'a PyReadonlyArray1<'_, f64>) -> PyResult<&'a [f64]> {
    array
        .as_slice()
        .map_err(|_| CoreError::new_err(format!("{what}: the array is not contiguous")))
}

/// The RSSR in closed form.
#[pyclass(frozen, module = "sevenbar._core")]
struct Rssr(rssr::Rssr);

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
        let pose = loops::pose;
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

    /// Fills arrays of shape (2, n) with both branches and their derivatives, one array for each order from 0.
    #[pyo3(signature = (inputs, outputs, input, speed, law=None))]
    fn outputs<'py>(
        &self,
        py: Python<'py>,
        inputs: PyReadonlyArray1<'py, f64>,
        mut outputs: Vec<PyReadwriteArray2<'py, f64>>,
        input: &str,
        speed: f64,
        law: Option<[PyReadonlyArray1<'py, f64>; 3]>,
    ) -> PyResult<()> {
        let pair = self.0.pair(input_named(input)?);
        let values = flat("input", &inputs)?;
        let rates = match &law {
            None => BatchRates::Constant(speed),
            Some([d1, d2, d3]) => {
                BatchRates::Law([flat("speed", d1)?, flat("acceleration", d2)?, flat("jerk", d3)?])
            }
        };
        let mut slices = outputs
            .iter_mut()
            .map(|array| {
                array
                    .as_slice_mut()
                    .map_err(|e| CoreError::new_err(e.to_string()))
            })
            .collect::<PyResult<Vec<_>>>()?;
        py.detach(|| pair.outputs(values, rates, &mut slices))
            .map_err(raise)
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

    /// The whole motion: its type, limits, change points, and a dictionary for each circuit.
    #[pyo3(signature = (input, samples, speed, law=None))]
    fn motion<'py>(
        &self,
        py: Python<'py>,
        input: &str,
        samples: usize,
        speed: f64,
        law: Option<PyReadonlyArray2<'py, f64>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let input = input_named(input)?;
        let law = law_rows(law);
        let (motion, rows) = py.detach(|| {
            let motion = self.0.motion(input);
            let rows: Vec<Vec<Row>> = motion
                .circuits
                .iter()
                .map(|circuit| match &law {
                    None => self.0.rows(&motion, circuit, samples, speed),
                    Some(law) => self.0.law_rows(&motion, circuit, law).concat(),
                })
                .collect();
            (motion, rows)
        });
        let circuits = motion
            .circuits
            .iter()
            .zip(&rows)
            .map(|(circuit, rows)| circuit_dict(py, circuit, rows))
            .collect::<PyResult<Vec<_>>>()?;
        let result = PyDict::new(py);
        result.set_item("motion_type", motion.motion_type.name())?;
        result.set_item("limits", motion.limits.clone().into_pyarray(py))?;
        let change_points: Vec<_> = motion
            .change_points
            .iter()
            .map(|&at| {
                let (values, circuits) = self.0.change_point(&motion, at);
                // two branches cross
                let (ways, freedoms) = if circuits.is_empty() { (0, 0) } else { (4, 1) };
                (values, circuits, ways, freedoms)
            })
            .collect();
        result.set_item("change_points", change_points)?;
        result.set_item("circuits", circuits)?;
        Ok(result)
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

fn circuit_dict<'py>(py: Python<'py>, circuit: &Circuit, rows: &[Row]) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    let column = |pick: &dyn Fn(&Row) -> f64| rows.iter().map(pick).collect::<Vec<f64>>().into_pyarray(py);
    let count = |pick: &dyn Fn(&Row) -> usize| {
        rows.iter()
            .map(|r| pick(r) as i64)
            .collect::<Vec<i64>>()
            .into_pyarray(py)
    };
    let mut joints = Vec::with_capacity(rows.len() * 32);
    for order in 0..4 {
        for row in rows {
            joints.extend(row.joints.iter().map(|q| q[order]));
        }
    }
    let columns = rows.first().map_or(8, |r| r.joints.len());
    result.set_item(
        "joints",
        PyArray1::from_vec(py, joints).reshape([4, rows.len(), columns])?,
    )?;
    result.set_item("status", count(&|r| r.status as usize))?;
    result.set_item("branch", count(&|r| r.branch))?;
    result.set_item("mode", count(&|r| r.mode))?;
    result.set_item("residual", column(&|r| r.residual))?;
    result.set_item("condition", column(&|r| r.condition))?;
    result.set_item("motion_type", circuit.motion_type.name())?;
    result.set_item("input", extent(&circuit.input))?;
    result.set_item("output", extent(&circuit.output))?;
    result.set_item("turns", circuit.turns)?;
    result.set_item("dead_centres", dead_centre_rows(&circuit.dead_centres))?;
    result.set_item("transmission", extremes(circuit.transmission))?;
    result.set_item("velocity", circuit.velocity.map(extremes))?;
    result.set_item("acceleration", circuit.acceleration.map(extremes))?;
    result.set_item("jerk", circuit.jerk.map(extremes))?;
    Ok(result)
}

/// An input law as rows of value and three derivatives.
type LawRows = Option<Vec<[f64; 4]>>;

pub(crate) fn law_rows(law: Option<PyReadonlyArray2<'_, f64>>) -> LawRows {
    law.map(|rows| {
        rows.as_array()
            .outer_iter()
            .map(|r| std::array::from_fn(|k| r.get(k).copied().unwrap_or(0.0)))
            .collect()
    })
}

/// Kind, input, output, pass and condition of each.
fn dead_centre_rows(dead_centres: &[DeadCentre]) -> Vec<(&'static str, f64, f64, usize, f64)> {
    dead_centres
        .iter()
        .map(|d| (d.kind.name(), d.input, d.output, d.branch, d.condition))
        .collect()
}

fn extent(extent: &Extent) -> Option<(f64, f64)> {
    match *extent {
        Extent::Full => None,
        Extent::Arc(start, end) => Some((start, end)),
    }
}

fn extremes(pair: [Extreme; 2]) -> [(f64, f64); 2] {
    pair.map(|e| (e.value, e.input))
}

/// The vector unit that batches run on.
#[pyfunction]
fn simd_level() -> &'static str {
    sevenbar_core::simd::level()
}

#[pymodule]
mod _core {
    #[pymodule_export]
    use super::loops::{Loop, Rows};
    #[pymodule_export]
    use super::numbers::Numbers;
    #[pymodule_export]
    use super::sweep::{classify_rssr, measure_rssr};
    #[pymodule_export]
    use super::sweep_loops::measure_loops;
    #[pymodule_export]
    use super::{CoreError, Rssr, simd_level};

    #[pymodule_init]
    fn init(module: &pyo3::Bound<'_, pyo3::types::PyModule>) -> pyo3::PyResult<()> {
        use pyo3::types::PyModuleMethods;
        module.add("AGREE", sevenbar_core::loops::AGREE)?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
