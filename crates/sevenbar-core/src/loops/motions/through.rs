//! The one circuit through a pose: followed once, and kept, so that its rows at other inputs need no more following.

use super::circuit::{Circuit, Followed, Kept, OverInput, Wanted, circuit, grid};
use super::met_twice::{Held, held_at};
use super::motion::{How, ends, moving};
use super::passes::Passes;
use super::row::Row;
use super::row_store::RowStore;
use crate::loops::circuits::curve::Curve;
use crate::loops::circuits::known_curves::Curves;
use crate::loops::circuits::on_curve::lies_on;
use crate::loops::description::described_loop::{Column, Described, Loop};
use crate::loops::description::holding::followed;
use crate::loops::description::joint_values::configuration;
use crate::loops::equation::closed::{At, Closed};
use crate::loops::modes::polish::{Settled, polish};

/// How far a joint of a given pose [rad, or relative to the size] may be moved to close the loop.
pub(crate) const PUT_RIGHT: f64 = 0.05;

/// What goes through a pose.
#[derive(Clone, Debug)]
pub enum Through {
    /// The loop closes near the pose, and moves: its circuit, and what makes rows of it at other inputs.
    Circuit(Box<Circuit>, Box<Followed>),
    /// It does not close near it; how far it is from closing, relative to the size or radians.
    Apart(f64),
    /// It closes and no motion could be followed.
    Still,
    /// It moves with the input at rest: the columns that do.
    InputRests(Vec<usize>),
}

/// What goes through a closed pose of whatever closes, where a curve does.
pub(crate) enum Along<S: Closed, K> {
    /// A circuit, and what makes rows of it at other inputs.
    Circuit(Box<OverInput<K>>, Kept<S>),
    /// It has no pass over the input.
    Still,
    /// The input rests along it: the columns that move.
    InputRests(Vec<usize>),
}

/// The motion through a closed pose over an input and an output; `None` where none could be followed.
pub(crate) fn through<S: Closed, D: Described, K: RowStore<S>>(
    linkage: &D,
    chain: &S,
    pose: &At<S>,
    (driver, follower): (Column, Column),
    how: How,
) -> Option<Along<S, K>> {
    let input = driver.inner;
    let wished: Vec<usize> = [input, follower.inner]
        .into_iter()
        .filter(|&c| c < chain.columns())
        .collect();
    let mut curves = Curves::new(&wished);
    curves.take(chain, &[*pose], input);
    curves.finish(chain);
    // not a curve beyond a change point; where several meet there one on which the input moves
    let fits = |curve: &Curve<S>| (lies_on(chain, curve, pose), !curve.rests(input));
    let curve = curves.curves.into_iter().max_by_key(fits)?;
    if curve.rests(input) {
        return Some(Along::InputRests(moving(linkage, &[curve])));
    }
    let Some(passes) = Passes::new(chain, curve, input) else {
        return Some(Along::Still);
    };
    let circuit = on_passes(linkage, &passes, (driver, follower), how);
    Some(Along::Circuit(Box::new(circuit), Kept::of(&passes)))
}

/// A circuit that was followed, once more at other inputs.
pub(crate) fn again<S: Closed, D: Described, K: RowStore<S>>(
    linkage: &D,
    chain: &S,
    kept: &Kept<S>,
    ends: (Column, Column),
    how: How,
) -> OverInput<K> {
    on_passes(linkage, &kept.passes(chain), ends, how)
}

/// The circuit of passes that stand by themselves, with its rows.
fn on_passes<S: Closed, D: Described, K: RowStore<S>>(
    linkage: &D,
    passes: &Passes<S>,
    (driver, follower): (Column, Column),
    (samples, speed, law): How,
) -> OverInput<K> {
    let grid = grid(passes.chain, std::slice::from_ref(passes), samples);
    circuit(linkage, passes, &Wanted { driver, follower, grid, speed, law })
}

/// The one circuit through a pose, given by its joint values and closed by Newton's method with the input held.
///
/// `None` where one of the columns is no joint of one freedom that moves.
pub fn circuit_through(
    linkage: &Loop,
    values: &[f64],
    input: usize,
    output: usize,
    samples: usize,
    speed: f64,
    law: Option<&[[f64; 4]]>,
) -> Option<Through> {
    let chain = linkage.reduced.chain.as_ref()?;
    let ends = ends(linkage, input, output)?;
    let held = ends.0.inner;
    let rough = configuration(linkage, values);
    let Some(Settled { at: pose, .. }) = polish(chain, held, &rough, PUT_RIGHT).filter(|s| s.agrees) else {
        return Some(Through::Apart(chain.residual(&chain.place(&rough))));
    };
    match through::<_, _, Vec<Row>>(linkage, chain, &pose, ends, (samples, speed, law)) {
        Some(Along::Circuit(circuit, kept)) => Some(Through::Circuit(
            Box::new((*circuit).into()),
            Box::new(Followed { kept, still: None }),
        )),
        Some(Along::Still) => Some(Through::Still),
        Some(Along::InputRests(moving)) => Some(Through::InputRests(moving)),
        None => {
            let Some(Held { still, linkage, curves }) = held_at(linkage, &pose) else {
                return Some(Through::Still);
            };
            if linkage.inner(input).is_none() {
                return Some(Through::InputRests(moving(&linkage, &curves.curves)));
            }
            let found = circuit_through(&linkage, values, input, output, samples, speed, law)?;
            Some(match found {
                Through::Circuit(circuit, mut followed) => {
                    followed.still = Some(still);
                    Through::Circuit(Box::new(circuit.holding(still, &linkage, output)), followed)
                }
                other => other,
            })
        }
    }
}

/// A circuit that was followed, once more at other inputs; `None` where a column is no joint of one freedom.
pub fn circuit_again(
    linkage: &Loop,
    known: &Followed,
    input: usize,
    output: usize,
    samples: usize,
    speed: f64,
    law: Option<&[[f64; 4]]>,
) -> Option<Circuit> {
    let own = followed(linkage, known.still);
    let chain = own.reduced.chain.as_ref()?;
    let ends = ends(&own, input, output)?;
    let circuit = again::<_, _, Vec<Row>>(&*own, chain, &known.kept, ends, (samples, speed, law));
    let circuit = Circuit::from(circuit);
    Some(match known.still {
        Some(still) => circuit.holding(still, &own, output),
        None => circuit,
    })
}
