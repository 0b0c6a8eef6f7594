//! Nets of several loops, for Python.

use crate::{CoreError, in_rows};
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use sevenbar_core::nets::{self, Dyad, Edge, Move, Pair, Row, Stage, Step, Unbalanced};
use sevenbar_core::rigid::{Pose, Vec3};

/// A tree of one-freedom steps closed by rows.
#[pyclass(frozen, module = "sevenbar._core")]
pub(crate) struct Net(nets::Net);

/// The rank, repeated rows, free motions.
type RawFreedoms = (usize, Vec<Vec<f64>>, Vec<Vec<f64>>);

/// A row by its kind, the steps that it is on (none for the ground), its vectors and its number.
type RawRow = (String, [Option<usize>; 2], [Vec3; 2], f64);

fn row((kind, on, [first, second], number): RawRow) -> PyResult<Row> {
    Ok(match kind.as_str() {
        "length" => Row::Length { on, at: [first, second], length: number },
        "along" => Row::Along { on, at: first, v: second },
        "angle" => Row::Angle { on, u: first, v: second, cosine: number },
        other => {
            return Err(CoreError::new_err(format!(
                "'{other}' is no row; give length, along, angle"
            )));
        }
    })
}

/// A dyad: its normal, each joint's letter R P with its place or its direction, the steps of its links and those at which it hangs.
type RawDyad = (Vec3, [(char, Vec3); 3], [usize; 2], [Option<usize>; 2]);

/// Values of the columns, the pose (rotation, translation) to which each step leads, the greatest error of a row, whether it is on a curve.
type RawMode = (Vec<f64>, Vec<([[f64; 3]; 3], Vec3)>, f64, bool);

fn stage((normal, joints, links, known): RawDyad) -> Stage {
    let pairs = joints.map(|(letter, v)| {
        if letter == 'R' {
            Pair::Hinge(v)
        } else {
            Pair::Slide(v)
        }
    });
    Stage { dyad: Dyad { normal, pairs }, links, known }
}

#[pymethods]
impl Net {
    /// From the steps' letters R P H, the advance of each for a radian (H), the step before each (none on the ground), places on their axes as
    /// drawn and their directions, each (n, 3), the rows, and the size of which residuals are parts.
    #[new]
    fn new(
        letters: &str,
        advances: PyReadonlyArray1<'_, f64>,
        parents: Vec<Option<usize>>,
        origins: PyReadonlyArray2<'_, f64>,
        axes: PyReadonlyArray2<'_, f64>,
        rows: Vec<RawRow>,
        size: f64,
    ) -> PyResult<Self> {
        let vectors = |array: &PyReadonlyArray2<'_, f64>| -> Vec<Vec3> {
            in_rows(array)
                .chunks(3)
                .map(|v| std::array::from_fn(|k| v.get(k).copied().unwrap_or(0.0)))
                .collect()
        };
        let (advances, origins, axes) = (in_rows(&advances), vectors(&origins), vectors(&axes));
        let count = letters.len();
        if [advances.len(), parents.len(), origins.len(), axes.len()] != [count; 4] {
            return Err(CoreError::new_err(
                "give an advance, a parent, an origin and an axis for each letter",
            ));
        }
        let mut steps = Vec::with_capacity(count);
        for (k, letter) in letters.chars().enumerate() {
            let moves = match letter {
                'R' => Move::Turn,
                'P' => Move::Slide,
                'H' => Move::Screw(advances[k]),
                other => {
                    return Err(CoreError::new_err(format!(
                        "'{other}' is no step; give R, P or H"
                    )));
                }
            };
            if parents[k].is_some_and(|p| p >= k) {
                return Err(CoreError::new_err("the parent of a step is one before it"));
            }
            steps.push(Step { parent: parents[k], moves, origin: origins[k], axis: axes[k] });
        }
        let rows: Vec<Row> = rows.into_iter().map(row).collect::<PyResult<_>>()?;
        if rows.iter().flat_map(Row::on).flatten().any(|step| step >= count) {
            return Err(CoreError::new_err("a row is on a step that is not there"));
        }
        Ok(Self(nets::Net { steps, rows, size }))
    }

    /// The freedoms about the pose that is drawn.
    fn freedoms(&self, py: Python<'_>) -> RawFreedoms {
        let found = py.detach(|| nets::freedoms(&self.0));
        (found.rank, found.repeated, found.free)
    }

    /// All modes of dyads, each after those at which it hangs, with a step held at a value [rad, or relative to the size].
    fn modes(
        &self,
        py: Python<'_>,
        dyads: Vec<RawDyad>,
        driven: usize,
        value: f64,
    ) -> PyResult<Vec<RawMode>> {
        let stages: Vec<Stage> = dyads.into_iter().map(stage).collect();
        let steps = stages
            .iter()
            .flat_map(|s| s.links.into_iter().chain(s.known.into_iter().flatten()));
        if steps.chain([driven]).any(|step| step >= self.0.steps.len()) {
            return Err(CoreError::new_err("a dyad is on a step that is not there"));
        }
        let found = py.detach(|| nets::modes(&self.0, &stages, driven, value));
        let pose = |p: Pose| (p.rotation, p.translation);
        Ok(found
            .into_iter()
            .map(|mode| {
                (
                    mode.values,
                    mode.poses.into_iter().map(pose).collect(),
                    mode.residual,
                    mode.on_curve,
                )
            })
            .collect())
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
