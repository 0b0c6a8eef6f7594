//! Torque and reactions of a loop with its numbers, for Python.

use crate::numbers::{Array, Numbers, shaped};
use crate::working::working;
use crate::{CoreError, in_rows, loops::pose};
use numpy::ndarray::Axis;
use numpy::{PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;
use sevenbar_core::loops::{self, Body, JointSpring, Load, Place, PointSpring, Seat};

/// How many joints are before it, its place, and the twist by one of each number.
type PlaceRow = (usize, [f64; 3], Vec<(usize, [f64; 6])>);
/// How many joints are before it, mass, centre, inertia, and the twist by one of each number.
type BodyRow = (usize, f64, [f64; 3], [[f64; 3]; 3], Vec<(usize, [f64; 6])>);
/// Place, force, torque, and whether they turn with the link.
type LoadRow = (PlaceRow, [f64; 3], [f64; 3], bool);
/// Both ends; stiffness, length, damping.
type SpringRow = (PlaceRow, PlaceRow, [f64; 3]);

/// What acts on a loop; lengths relative to the size, forces in kg size/s^2.
#[pyclass(frozen, module = "sevenbar._core")]
pub(crate) struct Acting(loops::Acting);

fn place((joints, at, ways): PlaceRow) -> Place {
    Place { joints, at, ways }
}

#[pymethods]
impl Acting {
    /// From gravity, bodies, loads, springs between places, and springs in joints: (column, stiffness, slack value, damping).
    #[new]
    fn new(
        gravity: [f64; 3],
        bodies: Vec<BodyRow>,
        loads: Vec<LoadRow>,
        springs: Vec<SpringRow>,
        joint_springs: Vec<(usize, [f64; 3])>,
    ) -> Self {
        Self(loops::Acting {
            gravity,
            bodies: bodies
                .into_iter()
                .map(|(joints, mass, centre, inertia, ways)| Body { joints, mass, centre, inertia, ways })
                .collect(),
            loads: loads
                .into_iter()
                .map(|(at, force, torque, turns)| Load { place: place(at), force, torque, turns })
                .collect(),
            springs: springs
                .into_iter()
                .map(|(first, second, [stiffness, length, damping])| PointSpring {
                    ends: [place(first), place(second)],
                    stiffness,
                    length,
                    damping,
                })
                .collect(),
            joint_springs: joint_springs
                .into_iter()
                .map(|(column, [stiffness, slack, damping])| JointSpring {
                    column,
                    stiffness,
                    slack,
                    damping,
                })
                .collect(),
        })
    }
}

impl Acting {
    fn fits(&self, numbers: &Numbers) -> bool {
        let joints = numbers.0.joints();
        let places = self
            .0
            .loads
            .iter()
            .map(|load| &load.place)
            .chain(self.0.springs.iter().flat_map(|spring| &spring.ends));
        self.0
            .bodies
            .iter()
            .map(|body| body.joints)
            .chain(places.map(|p| p.joints))
            .all(|j| j <= joints)
            && self
                .0
                .joint_springs
                .iter()
                .all(|s| s.column < numbers.0.columns())
    }
}

/// At closed poses (n, columns), with speed and acceleration of the input (n, 2) and the factors of the loads (n, loads), in seats
/// (joint, frame (4, 4)): torque (n,), what holds idle freedoms (n, held), energies and supplied power (n, 3), wrenches (n, seats, 6),
/// seats (n, seats, 12), shaking (n, 6), undetermined wrenches (n, redundant, 6); and by the numbers torque (n, numbers),
/// wrenches (n, numbers, seats, 6) and shaking (n, numbers, 6), for no numbers unless wanted. NaN at dead centres of the input.
#[pyfunction]
#[expect(clippy::too_many_arguments)]
pub(crate) fn reactions<'py>(
    py: Python<'py>,
    numbers: &Numbers,
    acting: &Acting,
    values: PyReadonlyArray2<'py, f64>,
    speeds: PyReadonlyArray2<'py, f64>,
    factors: PyReadonlyArray2<'py, f64>,
    joints: Vec<usize>,
    frames: PyReadonlyArray3<'py, f64>,
    with_numbers: bool,
) -> PyResult<Vec<Array<'py>>> {
    let (rows, width) = (values.shape()[0], numbers.0.columns());
    let fits = values.shape()[1] == width
        && speeds.shape() == [rows, 2]
        && factors.shape() == [rows, acting.0.loads.len()]
        && frames.shape() == [joints.len(), 4, 4]
        && joints.iter().all(|&j| j < numbers.0.joints())
        && acting.fits(numbers);
    if !fits {
        return Err(CoreError::new_err("reactions: the parts do not fit together"));
    }
    let (values, speeds, factors) = (in_rows(&values), in_rows(&speeds), in_rows(&factors));
    let seats: Vec<Seat> = joints
        .iter()
        .zip(frames.as_array().axis_iter(Axis(0)))
        .map(|(&joint, frame)| Seat { joint, frame: pose(frame) })
        .collect();
    let found = working(py, || {
        loops::reactions(
            &numbers.0,
            &values,
            &speeds,
            &acting.0,
            &factors,
            &seats,
            with_numbers,
        )
    })?;
    let (count, all) = (seats.len(), if with_numbers { numbers.0.numbers() } else { 0 });
    Ok(vec![
        shaped(py, found.torque, &[rows])?,
        shaped(py, found.spin, &[rows, numbers.0.idle()])?,
        shaped(py, found.energies, &[rows, 3])?,
        shaped(py, found.wrenches, &[rows, count, 6])?,
        shaped(py, found.seats, &[rows, count, 12])?,
        shaped(py, found.shaking, &[rows, 6])?,
        shaped(py, found.free, &[rows, found.redundant, 6])?,
        shaped(py, found.torque_by_number, &[rows, all])?,
        shaped(py, found.wrenches_by_number, &[rows, all, count, 6])?,
        shaped(py, found.shaking_by_number, &[rows, all, 6])?,
    ])
}
