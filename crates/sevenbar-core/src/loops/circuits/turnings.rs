//! Where a column changes direction along a followed curve, and the curve with these places among its nodes.

use super::curve::{self, Curve, Node, measure};
use crate::loops::equation::chain::Chain;
use crate::loops::equation::closed::{Closed, copied};
use crate::loops::equation::dense::{dot, length};

/// A rate of a column below this part of the curve's is zero.
const AT_REST: f64 = 1e-13;

/// A column whose part of the unit tangent is below this stands still.
const STILL: f64 = 1e-9;

/// Places between which a column moves by less than this [rad, or relative to the size] are rounding where it rests.
const UNMOVED: f64 = 1e-12;

/// A dead centre nearer than this to a node that is one [rad, or relative to the size] is that node.
const SAME_PLACE: f64 = 1e-6;

/// Near a change point, where the norm of the screws' inverse is greater, a rate below its square times this is rounding: the place,
/// and so the tangent, is not known better.
const NEAR: f64 = 1e3;
pub(super) const ROUNDED: f64 = 4.0 * f64::EPSILON;

/// A rate at which a column may turn back, where it must turn back once more.
const FLAT: f64 = 1e-7;

/// How far [rad, or relative to the size] from a change point a column's direction is checked to see whether it turns back there.
const BESIDE: f64 = 1e-3;

/// Places looked at within a step for a change of a column's direction.
const PLACES: usize = 6;

/// Where a rate falls to this part of the greatest in its step it is searched for two zeros near each other: the series at a sixth of the
/// step has a rate that touches zero to less than a tenth of that.
const DIPS: f64 = 0.25;

/// Steps of Newton's method to where a rate is least, and the part of that rate that is left for zeros beyond what its series says.
const DIP_STEPS: usize = 6;
const DIP_LEFT: f64 = 0.5;

/// A place where a column changes direction.
#[derive(Debug)]
pub(crate) struct Turning<S: Closed = Chain> {
    /// The node that it follows.
    pub segment: usize,
    pub node: Node<S>,
}

copied!(Turning<S>);

/// Where a column changes direction, in order.
pub(crate) fn turnings<S: Closed>(curve: &Curve<S>, chain: &S, column: usize) -> Vec<Turning<S>> {
    if curve.rests(column) {
        return Vec::new();
    }
    let mut found = turnings_by(curve, chain, column, 0.0);
    // a column that comes back turned once more: at a change point beside which it nearly rests
    if curve.is_closed() && !found.len().is_multiple_of(2) {
        let more = turnings_by(curve, chain, column, STILL);
        if more.len().is_multiple_of(2) {
            found = more;
        } else {
            add_flattest(curve, chain, column, &mut found);
        }
    }
    forget_unmoved(curve, &mut found, column);
    found
}

/// Adds the node, away from all that are known, at which a column is nearest to rest, where that is near: to so high an order that its rate has
/// no sign about it.
fn add_flattest<S: Closed>(curve: &Curve<S>, chain: &S, column: usize, found: &mut Vec<Turning<S>>) {
    let rate = |k: usize| curve.nodes[k].rates[0][column].abs();
    let is_known = |k: usize| {
        let off = |t: &Turning<S>| length(&chain.difference(&curve.nodes[k].at, &t.node.at));
        found.iter().any(|t| off(t) < BESIDE)
    };
    let nodes = (0..curve.nodes.len() - 1).filter(|&k| rate(k) < FLAT && !is_known(k));
    if let Some(segment) = nodes.min_by(|&j, &k| rate(j).total_cmp(&rate(k))) {
        found.push(Turning { segment, node: curve.nodes[segment] });
        found.sort_by_key(|t| t.segment);
    }
}

/// Of places in a row between which a column does not move leaves one where it turns back: rates that are rounding have no sign, and it
/// does where it comes from the side to which it goes. Where an open curve ends in such a place, rates are asked.
fn forget_unmoved<S: Closed>(curve: &Curve<S>, found: &mut Vec<Turning<S>>, column: usize) {
    let value = |t: &Turning<S>| t.node.at.values[column];
    let (closed, gained) = (curve.is_closed(), curve.gained()[column]);
    let mut rows: Vec<Vec<Turning<S>>> = Vec::new();
    for turning in found.drain(..) {
        match rows.last_mut() {
            Some(row) if (value(&row[row.len() - 1]) - value(&turning)).abs() < UNMOVED => row.push(turning),
            _ => rows.push(vec![turning]),
        }
    }
    let last = rows.len().saturating_sub(1);
    if closed && last > 0 && (value(&rows[0][0]) + gained - value(&rows[last][0])).abs() < UNMOVED {
        // round the place where the curve begins
        let first = rows.remove(0);
        rows[last - 1].extend(first);
    }
    let ends = curve.ends().map(|at| at.values[column]);
    let values: Vec<f64> = rows.iter().map(|row| value(&row[0])).collect();
    found.extend(rows.into_iter().enumerate().filter_map(|(k, row)| {
        let here = values[k];
        let before = match k.checked_sub(1) {
            Some(k) => values[k],
            None if closed => values[values.len() - 1] - gained,
            None => ends[0],
        };
        let after = match values.get(k + 1) {
            Some(&next) => next,
            None if closed => values[0] + gained,
            None => ends[1],
        };
        let sides = [before - here, after - here];
        let turns = if sides.iter().any(|side| side.abs() < UNMOVED) {
            !row.len().is_multiple_of(2)
        } else {
            sides[0] * sides[1] > 0.0
        };
        turns.then(|| row[row.len() / 2])
    }));
}

/// The same, where a column turns back at a change point as its rates beside have it, the first of them that is not `still`.
fn turnings_by<S: Closed>(curve: &Curve<S>, chain: &S, column: usize, still: f64) -> Vec<Turning<S>> {
    let mut found = Vec::new();
    let mut marks: Vec<(f64, f64)> = Vec::new();
    let rounded =
        |n: &Node<S>| n.inverse_norm > NEAR && n.rates[0][column].abs() <= ROUNDED * n.inverse_norm.powi(2);
    // the last rate before nodes at which rounding hides it, and the node of these where it is least
    let mut blurred: Option<(f64, usize)> = blurred_start(curve, column, &rounded);
    for (segment, pair) in curve.nodes.windows(2).enumerate() {
        let (a, b) = (&pair[0], &pair[1]);
        if a.is_crossing() || b.is_crossing() {
            if a.is_crossing() && turns_back_over(curve, segment, column, still) {
                found.push(Turning { segment, node: *a });
            }
            blurred = None;
            continue;
        }
        match (rounded(a), rounded(b)) {
            (false, false) => {}
            (false, true) => {
                blurred = Some((a.rates[0][column], segment + 1));
                continue;
            }
            (true, true) => {
                if let Some((_, least)) = &mut blurred
                    && b.rates[0][column].abs() < curve.nodes[*least].rates[0][column].abs()
                {
                    *least = segment + 1;
                }
                continue;
            }
            (true, false) => {
                if let Some((before, least)) = blurred.take()
                    && before * b.rates[0][column] < 0.0
                {
                    found.push(turning_beside(curve, chain, column, least));
                }
                continue;
            }
        }
        // a rate that is zero to the last digit at a node, as where another column turns back there, has no sign beside it
        if turns_at(a, column) && a.rates[1][column] != 0.0 {
            found.push(Turning { segment, node: *a });
        }
        // the place of the greatest rate in each stretch of one direction, as the series at the nearer end has it
        marks.clear();
        let seen: [(f64, f64); PLACES + 1] = std::array::from_fn(|k| {
            let s = a.step * k as f64 / PLACES as f64;
            // at the nodes their own rates, so that two steps see one sign of a rate that is zero up to rounding
            let rate = match k {
                0 => a.rates[0][column],
                PLACES => b.rates[0][column],
                _ if 2 * k < PLACES => a.rate(column, s),
                _ => b.rate(column, s - a.step),
            };
            (s, rate)
        });
        for (s, rate) in seen {
            match marks.last_mut() {
                Some(last) if last.1 * rate >= 0.0 => {
                    if rate.abs() > last.1.abs() {
                        *last = (s, rate);
                    }
                }
                _ => marks.push((s, rate)),
            }
        }
        // one stretch, or a second whose sign is rounding where a node lies in a zero
        if marks.len() < 2 || (marks.len() == 2 && marks.iter().any(|mark| mark.1.abs() < AT_REST)) {
            // two zeros that no place seen lies between
            if let Some(dip) = dip(chain, (a, b), column, &seen) {
                marks = vec![seen[0], dip, seen[PLACES]];
            } else if marks.len() < 2 {
                continue;
            }
        }
        // both ends are known, and the places between are checked
        let count = marks.len();
        let counts =
            |n: &Node<S>, mark: (f64, f64)| mark.1.abs() < AT_REST || n.rates[0][column].abs() >= AT_REST;
        for (k, mark) in marks.iter_mut().enumerate() {
            // an end whose rate is rounding has no sign where a place has one
            *mark = if k == 0 && counts(a, *mark) {
                (0.0, a.rates[0][column])
            } else if k + 1 == count && counts(b, *mark) {
                (a.step, b.rates[0][column])
            } else {
                let rate = curve::ahead(chain, a, mark.0).map_or(mark.1, |n| n.rates[0][column]);
                (mark.0, rate)
            };
        }
        for ends in marks.windows(2) {
            if ends[0].1 * ends[1].1 < 0.0
                && let Some(node) = turning_between(chain, a, column, ends[0], ends[1])
            {
                found.push(Turning { segment, node });
            }
        }
    }
    found.sort_by_key(|t| t.segment);
    found
}

/// A place in a step at which a column's rate has another sign than all the `seen`: by Newton's method from the least of these that lies
/// between greater ones to where the rate is least.
fn dip<S: Closed>(
    chain: &S,
    (a, b): (&Node<S>, &Node<S>),
    column: usize,
    seen: &[(f64, f64); PLACES + 1],
) -> Option<(f64, f64)> {
    // a rate of zero has no sign
    let greatest = seen
        .iter()
        .map(|s| s.1)
        .max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
    let sign = greatest.signum();
    let rate = |k: usize| sign * seen[k].1;
    let falls_in = |k: usize| match k {
        0 => sign * a.rates[1][column] < 0.0,
        PLACES => sign * b.rates[1][column] > 0.0,
        _ => rate(k - 1) > rate(k) && rate(k) < rate(k + 1),
    };
    let most = (0..=PLACES).map(rate).fold(0.0, f64::max);
    let least = (0..=PLACES)
        .filter(|&k| rate(k) < DIPS * most && falls_in(k))
        .min_by(|&j, &k| rate(j).total_cmp(&rate(k)))?;
    let mut s = seen[least].0;
    for _ in 0..DIP_STEPS {
        let node = curve::ahead(chain, a, s)?;
        let [rate, slope, bend] = node.rates.map(|order| sign * order[column]);
        // at a zero in a node the sign is rounding
        if rate < -AT_REST {
            return Some((s, sign * rate));
        }
        // where the series is least, its value is `rate - gain`
        let gain = slope * slope / (4.0 * bend);
        let by = -slope / (2.0 * bend) * dot(&node.rates[0], &a.rates[0]);
        if bend <= 0.0 || gain < DIP_LEFT * rate || !(0.0..=a.step).contains(&(s + by)) {
            return None;
        }
        s += by;
    }
    None
}

/// Of a closed curve that begins among nodes whose rates rounding hides: the rate before these, and the node where it is least.
fn blurred_start<S: Closed>(
    curve: &Curve<S>,
    column: usize,
    rounded: &dyn Fn(&Node<S>) -> bool,
) -> Option<(f64, usize)> {
    if !curve.is_closed() || !rounded(&curve.nodes[0]) {
        return None;
    }
    let rate = |k: usize| curve.nodes[k].rates[0][column];
    let mut least = 0;
    for k in (1..curve.nodes.len() - 1).rev() {
        if !rounded(&curve.nodes[k]) {
            return Some((rate(k), least));
        }
        if rate(k).abs() < rate(least).abs() {
            least = k;
        }
    }
    None
}

/// Where a column turns back beside a node at which its rate is rounding: there, or in a step next to it where its sign changes.
fn turning_beside<S: Closed>(curve: &Curve<S>, chain: &S, column: usize, least: usize) -> Turning<S> {
    let rate = |k: usize| curve.nodes[k].rates[0][column];
    // a closed curve's last step leads to its first node
    let before = least.checked_sub(1).unwrap_or(curve.nodes.len() - 2);
    [before, least]
        .into_iter()
        .filter(|&k| k + 1 < curve.nodes.len() && rate(k) * rate(k + 1) < 0.0)
        .find_map(|segment| {
            let a = &curve.nodes[segment];
            let ends = ((0.0, rate(segment)), (a.step, rate(segment + 1)));
            let node = turning_between(chain, a, column, ends.0, ends.1)?;
            Some(Turning { segment, node })
        })
        .unwrap_or(Turning { segment: least, node: curve.nodes[least] })
}

/// Whether a column turns back at the node of a change point, as its rates at a distance have it, the first that is not `still`.
fn turns_back_over<S: Closed>(curve: &Curve<S>, node: usize, column: usize, still: f64) -> bool {
    let last = curve.nodes.len() - 1;
    let beside = |ahead: bool| {
        let mut gone = 0.0;
        let mut k = node;
        loop {
            let ends = if ahead { k == last } else { k == 0 };
            k = match (ends, ahead) {
                (true, _) if !curve.is_closed() => return 0.0,
                (true, true) => 1,
                (true, false) => last - 1,
                (false, true) => k + 1,
                (false, false) => k - 1,
            };
            gone += curve.nodes[if ahead { k.max(1) - 1 } else { k }].step;
            let rate = curve.nodes[k].rates[0][column];
            if (gone > BESIDE && rate.abs() > still) || k == node {
                return rate;
            }
        }
    };
    let (before, after) = (beside(false), beside(true));
    before * after < 0.0 && before.abs().min(after.abs()) > STILL
}

/// The place in a step where a column's rate is zero, between two where its sign differs.
fn turning_between<S: Closed>(
    chain: &S,
    a: &Node<S>,
    column: usize,
    mut low: (f64, f64),
    mut high: (f64, f64),
) -> Option<Node<S>> {
    let mut best: Option<Node<S>> = None;
    let mut s = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
    for _ in 0..60 {
        let node = curve::ahead(chain, a, s)?;
        let rate = node.rates[0][column];
        if best
            .as_ref()
            .is_none_or(|b| rate.abs() < b.rates[0][column].abs())
        {
            best = Some(node);
        }
        if rate.abs() < AT_REST || (high.0 - low.0).abs() < 1e-15 {
            break;
        }
        if rate * low.1 > 0.0 {
            low = (s, rate);
        } else {
            high = (s, rate);
        }
        // Newton's step by the second derivative, if it stays between
        let next = s - rate / node.rates[1][column] * dot(&node.rates[0], &a.rates[0]);
        s = if next > low.0 && next < high.0 {
            next
        } else {
            0.5 * (low.0 + high.0)
        };
    }
    best
}

/// Makes each turning a node. The column's rate there is zero by its meaning: where the curve bends sharply, as beside a change point,
/// the rate that is worked out is zero only to what rounding of the place leaves of it.
pub(crate) fn insert<S: Closed>(chain: &S, curve: &mut Curve<S>, turnings: &[Turning<S>], column: usize) {
    let last = curve.nodes.len() - 1;
    // a curve that was begun at a dead centre has that node already
    let known = |t: &Turning<S>| {
        (t.segment..=t.segment + 1).find(|&k| {
            let n = &curve.nodes[k];
            let off = length(&chain.difference(&n.at, &t.node.at));
            let still = n.is_crossing() || n.rates[0][column].abs() < STILL;
            off == 0.0 || (still && off < SAME_PLACE)
        })
    };
    let places: Vec<Option<usize>> = turnings.iter().map(known).collect();
    for &k in places.iter().flatten() {
        curve.nodes[k].rates[0][column] = 0.0;
        if curve.is_closed() && (k == 0 || k == last) {
            curve.nodes[last - k].rates[0][column] = 0.0;
        }
    }
    let mut nodes = Vec::with_capacity(curve.nodes.len() + turnings.len());
    let mut rest = turnings
        .iter()
        .zip(&places)
        .filter(|(_, place)| place.is_none())
        .map(|(t, _)| t)
        .peekable();
    // steps that are now in parts
    let mut parted: Vec<std::ops::Range<usize>> = Vec::new();
    for (k, node) in curve.nodes.iter().enumerate() {
        nodes.push(*node);
        let before = nodes.len() - 1;
        while let Some(t) = rest.next_if(|t| t.segment == k) {
            let mut node = t.node;
            node.rates[0][column] = 0.0;
            nodes.push(node);
        }
        if nodes.len() - 1 > before {
            parted.push(before..nodes.len());
        }
    }
    for range in parted {
        measure(chain, &mut nodes[range.start..=range.end]);
    }
    curve.nodes = nodes;
}

/// Whether a column changes direction at a node, once `insert` has seen the curve.
pub(crate) fn turns_at<S: Closed>(node: &Node<S>, column: usize) -> bool {
    node.rates[0][column] == 0.0
}

/// A closed curve begun at another of its nodes, turns counted on.
pub(crate) fn begun_at<S: Closed>(curve: &Curve<S>, start: usize) -> Curve<S> {
    let last = curve.nodes.len() - 1;
    let gained = curve.gained();
    let mut nodes: Vec<Node<S>> = Vec::with_capacity(curve.nodes.len());
    nodes.extend_from_slice(&curve.nodes[start..last]);
    nodes.extend(curve.nodes[..=start].iter().map(|n| {
        let mut n = *n;
        for c in 0..S::COLUMNS {
            n.at.values[c] += gained[c];
        }
        n
    }));
    Curve { nodes, why: curve.why }
}
