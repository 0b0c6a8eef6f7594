//! What a net is made of, read from Python: rows of its joints and rods, and links that are solved together.

use crate::CoreError;
use crate::loops::kinds;
use pyo3::prelude::*;
use sevenbar_core::nets::{
    BlockJoint, BodyBlock, Dyad, Leg, LoopBlock, LoopLink, LoopStep, Pair, Part, PlanarBlock, Row, Stage,
};
use sevenbar_core::rigid::Vec3;

/// Links that are solved together, each after those at which they hang: what a net is made of over an input.
#[pyclass(frozen, module = "sevenbar._core")]
pub(crate) struct NetParts(pub Vec<Part>);

/// A row by its kind, the steps that it is on (none for the ground), its vectors and its number.
pub(crate) type RawRow = (String, [Option<usize>; 2], [Vec3; 2], f64);

/// A row as the core has it.
pub(crate) fn row((kind, on, [first, second], number): RawRow) -> PyResult<Row> {
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
pub(crate) type RawDyad = (Vec3, [(char, Vec3); 3], [usize; 2], [Option<usize>; 2]);

/// A planar block: its normal, the steps of its links, each joint's letter with its place and its direction, or of a rod two places, and
/// the steps of its two links: R P, of a pin of the first in a slot of the second K, of a rod L.
pub(crate) type RawBlock = (Vec3, Vec<usize>, Vec<(char, Vec3, Vec3, [Option<usize>; 2])>);

/// A link between a known one and a ball: its steps, the place of the ball, and the steps of the ball's two links, its own first.
pub(crate) type RawLeg = (Vec<usize>, Vec3, [Option<usize>; 2]);

/// A link in space: its steps, the rows of each joint and rod between it and known links, its legs.
pub(crate) type RawBody = (Vec<usize>, Vec<Vec<RawRow>>, Vec<RawLeg>);

/// One loop: the letters R P H S of its joints from a known link to another, the advance of each for a radian (H), a place on its axis and the
/// direction of that; each link by how many joints lead to it and the steps of the sides at which the loop comes and leaves; the steps of
/// the known links; the point in which all axes meet, where they do; the steps of joints that have several.
pub(crate) type RawLoop = (
    String,
    Vec<f64>,
    Vec<[Vec3; 2]>,
    Vec<(usize, [usize; 2])>,
    [Option<usize>; 2],
    Option<Vec3>,
    Vec<Vec<usize>>,
);

/// Links that are solved together.
#[derive(FromPyObject)]
pub(crate) enum RawPart {
    Dyad(RawDyad),
    Block(RawBlock),
    Body(RawBody),
    Loop(RawLoop),
}

impl RawPart {
    fn part(self) -> PyResult<Part> {
        Ok(match self {
            Self::Dyad((normal, joints, links, known)) => {
                let pairs = joints.map(|(letter, v)| {
                    if letter == 'R' {
                        Pair::Hinge(v)
                    } else {
                        Pair::Slide(v)
                    }
                });
                Part::Dyad(Stage { dyad: Dyad { normal, pairs }, links, known })
            }
            Self::Block((normal, links, joints)) => {
                let joint = |(letter, first, second, on)| {
                    let joint = match letter {
                        'R' => BlockJoint::Hinge(first),
                        'P' => BlockJoint::Slide(first, second),
                        'K' => BlockJoint::Slot(first, second),
                        _ => BlockJoint::Rod([first, second]),
                    };
                    (joint, on)
                };
                let joints = joints.into_iter().map(joint).collect();
                Part::Planar(PlanarBlock { normal, links, joints })
            }
            Self::Body((steps, rows, legs)) => {
                let of_joint = |rows: Vec<RawRow>| rows.into_iter().map(row).collect::<PyResult<_>>();
                let rows = rows.into_iter().map(of_joint).collect::<PyResult<_>>()?;
                let leg = |(steps, ball, on)| Leg { steps, ball, on };
                let legs = legs.into_iter().map(leg).collect();
                Part::Body(BodyBlock { steps, rows, legs })
            }
            Self::Loop((letters, advances, axes, links, ends, centre, joints)) => {
                let kinds = kinds(&letters, &advances)?;
                let step = |(kind, [origin, axis]): (_, [Vec3; 2])| LoopStep { kind, origin, axis };
                let steps = kinds.into_iter().zip(axes).map(step).collect();
                let link = |(after, on)| LoopLink { after, on };
                let links = links.into_iter().map(link).collect();
                Part::Loop(LoopBlock { steps, links, ends, centre, joints })
            }
        })
    }
}

/// Parts of a net of so many steps.
pub(crate) fn parts(raw: Vec<RawPart>, steps: usize) -> PyResult<Vec<Part>> {
    let parts: Vec<Part> = raw.into_iter().map(RawPart::part).collect::<PyResult<_>>()?;
    let beyond = |part: &Part| match part {
        Part::Dyad(stage) => {
            let known = stage.known.into_iter().flatten();
            stage.links.into_iter().chain(known).any(|step| step >= steps)
        }
        Part::Planar(block) => {
            let on = block.joints.iter().flat_map(|(_, on)| on.iter().flatten());
            block.links.iter().chain(on).any(|&step| step >= steps)
        }
        Part::Body(block) => {
            let of_rows = block.rows.iter().flatten().flat_map(Row::on).flatten();
            let of_legs = block.legs.iter().flat_map(|leg| leg.on).flatten();
            let own = block.legs.iter().flat_map(|leg| &leg.steps).chain(&block.steps);
            let bare = block.steps.is_empty() || block.legs.iter().any(|leg| leg.steps.is_empty());
            bare || of_rows
                .chain(of_legs)
                .chain(own.copied())
                .any(|step| step >= steps)
        }
        Part::Loop(block) => {
            let on = block.links.iter().flat_map(|link| link.on);
            let of_joints = block.joints.iter().flatten().copied();
            let mut on = on.chain(block.ends.into_iter().flatten()).chain(of_joints);
            block.steps.is_empty() || on.any(|step| step >= steps)
        }
    };
    if parts.iter().any(beyond) {
        return Err(CoreError::new_err("a part is on a step that is not there"));
    }
    Ok(parts)
}
