//! Rows of a circuit eight at a time, for chains of seven one-freedom joints: the same Newton steps and series of screws as
//! for a single row, in vector lanes. What does not settle at once is left to the single row.

use super::chain::{COLUMNS, Chain, Columns, Configuration, Joint};
use super::circuits::{Row, SETTLED};
use super::rates::{ORDERS, Rates};
use crate::outcome::RowStatus;
use crate::vectors::{LANES, LaneKernel, Reals, Vector, dispatch};

/// Passive columns.
const PASSIVE: usize = COLUMNS - 1;

/// A first correction [rad, or parts of the size] up to which the series for a small turn is exact to rounding.
const SMALL_TURN: f64 = 1e-3;

/// The closure error that a row may keep.
const CLOSED: f64 = 1e-12;

/// Whether rows of this chain can be solved side by side.
pub(super) fn suits(chain: &Chain) -> bool {
    chain.columns == COLUMNS && chain.joints.iter().all(|j| !matches!(j, Joint::Ball(_)))
}

/// Rows near rough columns, whose input is exact, at unit speed of the input; `None` for those to be solved singly.
pub(super) fn solved(chain: &Chain, input: usize, rough: &[Columns]) -> Vec<Option<Row>> {
    let mut rows = vec![None; rough.len()];
    dispatch(Many { chain, input, rough, rows: &mut rows });
    rows
}

struct Many<'a> {
    chain: &'a Chain,
    input: usize,
    rough: &'a [Columns],
    rows: &'a mut [Option<Row>],
}

type Triple<V> = [V; 3];
type Screw<V> = [V; 6];

/// The chain at eight configurations.
struct Here<V> {
    screws: [Screw<V>; COLUMNS],
    error: Screw<V>,
    cosine: V,
}

#[inline(always)]
fn cross<V: Vector>(a: &[V], b: &[V]) -> Triple<V> {
    [
        a[1].mul(b[2]).minus_product(a[2], b[1]),
        a[2].mul(b[0]).minus_product(a[0], b[2]),
        a[0].mul(b[1]).minus_product(a[1], b[0]),
    ]
}

#[inline(always)]
fn bracket<V: Vector>(a: &Screw<V>, b: &Screw<V>) -> Screw<V> {
    let turn = cross(&a[..3], &b[..3]);
    let (first, second) = (cross(&a[..3], &b[3..]), cross(&a[3..], &b[..3]));
    [
        turn[0],
        turn[1],
        turn[2],
        first[0].add(second[0]),
        first[1].add(second[1]),
        first[2].add(second[2]),
    ]
}

impl LaneKernel for Many<'_> {
    #[inline(always)]
    fn run<V: Vector>(self) {
        let count = self.rough.len();
        for start in (0..count).step_by(LANES) {
            let of_lane = |k: usize| (start + k).min(count - 1);
            let mut values = [[0.0; LANES]; COLUMNS];
            for (c, column) in values.iter_mut().enumerate() {
                for (k, value) in column.iter_mut().enumerate() {
                    *value = self.rough[of_lane(k)][c];
                }
            }
            let solved = self.block::<V>(&values);
            for (k, row) in solved.into_iter().enumerate().take(count - start) {
                self.rows[start + k] = row;
            }
        }
    }
}

impl Many<'_> {
    #[inline(always)]
    fn block<V: Vector>(&self, start: &[Reals; COLUMNS]) -> [Option<Row>; LANES] {
        let mut values = start.map(|v| V::load(&v));
        let mut turns: [(V, V); COLUMNS] = std::array::from_fn(|c| {
            let mut pair = ([0.0; LANES], [0.0; LANES]);
            for k in 0..LANES {
                (pair.1[k], pair.0[k]) = start[c][k].sin_cos();
            }
            (V::load(&pair.0), V::load(&pair.1))
        });
        let mut gone = [0.0; LANES];
        let mut last = [f64::INFINITY; LANES];
        for _ in 0..2 {
            let here = self.place(&values, &turns);
            let inverse = self.inverse(&here);
            let mut square = V::splat(0.0);
            let mut i = 0;
            for c in 0..COLUMNS {
                if c == self.input {
                    continue;
                }
                let mut by = V::splat(0.0);
                for k in 0..6 {
                    by = by.minus_product(inverse[i][k], here.error[k]);
                }
                i += 1;
                square = square.plus_product(by, by);
                values[c] = values[c].add(by);
                let (cosine, sine) = turns[c];
                let half = by.mul(by).mul(V::splat(0.5));
                let rest = V::splat(1.0).sub(half);
                let odd = by.mul(V::splat(1.0).minus_product(half, V::splat(1.0 / 3.0)));
                turns[c] = (
                    cosine.mul(rest).minus_product(sine, odd),
                    sine.mul(rest).plus_product(cosine, odd),
                );
            }
            last = square.store().map(f64::sqrt);
            for k in 0..LANES {
                gone[k] += last[k];
            }
            if last.iter().all(|&l| l < SETTLED) {
                break;
            }
        }
        let here = self.place(&values, &turns);
        let inverse = self.inverse(&here);
        let rates = self.rates(&here, &inverse);
        let (condition, residual) = self.quality(&here, &inverse);
        let values = values.map(V::store);
        let rates = rates.map(|order| order.map(V::store));
        std::array::from_fn(|k| {
            let good = gone[k] < SMALL_TURN && last[k] < SETTLED && residual[k] < CLOSED;
            good.then(|| {
                let mut at = Configuration::ZERO;
                let mut own: Rates = [[0.0; COLUMNS]; ORDERS];
                for c in 0..COLUMNS {
                    at.values[c] = values[c][k];
                    for order in 0..ORDERS {
                        own[order][c] = rates[order][c][k];
                    }
                }
                Row {
                    at,
                    rates: own,
                    status: RowStatus::Ok,
                    pass: 0,
                    residual: residual[k],
                    condition: condition[k],
                }
            })
        })
    }

    #[inline(always)]
    fn place<V: Vector>(&self, values: &[V; COLUMNS], turns: &[(V, V); COLUMNS]) -> Here<V> {
        let (zero, one) = (V::splat(0.0), V::splat(1.0));
        let mut screws = [[zero; 6]; COLUMNS];
        let mut axes = [[one, zero, zero], [zero, one, zero], [zero, zero, one]];
        let mut p = [zero; 3];
        for c in 0..COLUMNS {
            let z = axes[2];
            let moment = cross(&p, &z);
            let advance = match self.chain.joints[c] {
                Joint::Slide => {
                    screws[c] = [zero, zero, zero, z[0], z[1], z[2]];
                    Some(values[c])
                }
                Joint::Screw(a) => {
                    let a = V::splat(a);
                    screws[c] = [z[0], z[1], z[2], moment[0], moment[1], moment[2]];
                    for k in 0..3 {
                        screws[c][k + 3] = moment[k].plus_product(z[k], a);
                    }
                    Some(values[c].mul(a))
                }
                _ => {
                    screws[c] = [z[0], z[1], z[2], moment[0], moment[1], moment[2]];
                    None
                }
            };
            if let Some(slide) = advance {
                for k in 0..3 {
                    p[k] = p[k].plus_product(z[k], slide);
                }
            }
            if self.chain.joints[c] != Joint::Slide {
                let (cosine, sine) = turns[c];
                for k in 0..3 {
                    let (x, y) = (axes[0][k], axes[1][k]);
                    axes[0][k] = x.mul(cosine).plus_product(y, sine);
                    axes[1][k] = y.mul(cosine).minus_product(x, sine);
                }
            }
            let link = &self.chain.links[c];
            let before = axes;
            for j in 0..3 {
                let t = V::splat(link.translation[j]);
                for k in 0..3 {
                    p[k] = p[k].plus_product(before[j][k], t);
                }
            }
            for j in 0..3 {
                for k in 0..3 {
                    axes[j][k] = before[0][k]
                        .mul(V::splat(link.rotation[0][j]))
                        .plus_product(before[1][k], V::splat(link.rotation[1][j]))
                        .plus_product(before[2][k], V::splat(link.rotation[2][j]));
                }
            }
        }
        let half = V::splat(0.5);
        let [x, y, z] = axes;
        Here {
            screws,
            error: [
                y[2].sub(z[1]).mul(half),
                z[0].sub(x[2]).mul(half),
                x[1].sub(y[0]).mul(half),
                p[0],
                p[1],
                p[2],
            ],
            cosine: x[0].add(y[1]).add(z[2]).sub(one).mul(half),
        }
    }

    /// The inverse of the passive columns, row by row, by elimination with row exchanges in each lane.
    #[inline(always)]
    fn inverse<V: Vector>(&self, here: &Here<V>) -> [Screw<V>; PASSIVE] {
        let (zero, one) = (V::splat(0.0), V::splat(1.0));
        let mut a = [[zero; 12]; 6];
        let mut i = 0;
        for c in 0..COLUMNS {
            if c != self.input {
                for r in 0..6 {
                    a[r][i] = here.screws[c][r];
                }
                i += 1;
            }
        }
        for r in 0..6 {
            a[r][6 + r] = one;
        }
        for c in 0..6 {
            for r in c + 1..6 {
                let (upper, lower) = (a[c][c].mul(a[c][c]), a[r][c].mul(a[r][c]));
                for j in c..12 {
                    let (x, y) = (a[c][j], a[r][j]);
                    a[c][j] = lower.if_greater(upper, y, x);
                    a[r][j] = lower.if_greater(upper, x, y);
                }
            }
            let pivot = one.div(a[c][c]);
            for j in c + 1..12 {
                a[c][j] = a[c][j].mul(pivot);
            }
            for r in 0..6 {
                if r != c {
                    let factor = a[r][c];
                    for j in c + 1..12 {
                        a[r][j] = a[r][j].minus_product(factor, a[c][j]);
                    }
                }
            }
        }
        std::array::from_fn(|r| std::array::from_fn(|k| a[r][6 + k]))
    }

    /// As [`Chain::rates`], with the input at unit speed.
    #[inline(always)]
    fn rates<V: Vector>(&self, here: &Here<V>, inverse: &[Screw<V>; PASSIVE]) -> [[V; COLUMNS]; ORDERS] {
        let (zero, half) = (V::splat(0.0), V::splat(0.5));
        let input = self.input;
        let mut u = [[zero; COLUMNS]; ORDERS];
        let passive = |right: &Screw<V>, out: &mut [V; COLUMNS]| {
            let mut i = 0;
            for c in 0..COLUMNS {
                if c != input {
                    let mut sum = zero;
                    for k in 0..6 {
                        sum = sum.minus_product(inverse[i][k], right[k]);
                    }
                    out[c] = sum;
                    i += 1;
                }
            }
        };
        let add = |sum: &mut Screw<V>, screw: &Screw<V>, rate: V| {
            for k in 0..6 {
                sum[k] = sum[k].plus_product(screw[k], rate);
            }
        };
        passive(&here.screws[input], &mut u[0]);
        u[0][input] = V::splat(1.0);
        // accelerations: the screws' first coefficients
        let mut first = [[zero; 6]; COLUMNS];
        let mut before = [[zero; 6]; COLUMNS];
        let mut twist = [zero; 6];
        let mut right = [zero; 6];
        for c in 0..COLUMNS {
            before[c] = twist;
            first[c] = bracket(&twist, &here.screws[c]);
            add(&mut twist, &here.screws[c], u[0][c]);
            add(&mut right, &first[c], u[0][c]);
        }
        passive(&right, &mut u[1]);
        // jerks: their second ones
        let mut carried = [zero; 6];
        let mut right = [zero; 6];
        for c in 0..COLUMNS {
            let (a, b) = (bracket(&before[c], &first[c]), bracket(&carried, &here.screws[c]));
            let second: Screw<V> = std::array::from_fn(|k| a[k].add(b[k]).mul(half));
            add(&mut right, &second, u[0][c]);
            add(&mut right, &first[c], u[1][c]);
            add(&mut carried, &here.screws[c], u[1][c]);
            add(&mut carried, &first[c], u[0][c]);
        }
        passive(&right, &mut u[2]);
        u
    }

    /// Condition numbers of the closure with the input's row, and closure errors.
    #[inline(always)]
    fn quality<V: Vector>(&self, here: &Here<V>, inverse: &[Screw<V>; PASSIVE]) -> (Reals, Reals) {
        // [A; e] has the inverse [A_p^-1, -A_p^-1 a; 0, 1]
        let mut square = V::splat(1.0);
        let mut inverse_square = V::splat(1.0);
        for screw in &here.screws {
            for &x in screw {
                square = square.plus_product(x, x);
            }
        }
        for row in inverse {
            let mut along = V::splat(0.0);
            for k in 0..6 {
                inverse_square = inverse_square.plus_product(row[k], row[k]);
                along = along.plus_product(row[k], here.screws[self.input][k]);
            }
            inverse_square = inverse_square.plus_product(along, along);
        }
        let condition = square.mul(inverse_square).store().map(f64::sqrt);
        let e = &here.error;
        let part = |i: usize| {
            e[i].mul(e[i])
                .plus_product(e[i + 1], e[i + 1])
                .plus_product(e[i + 2], e[i + 2])
                .store()
        };
        let (turn, gap, cosine) = (part(0), part(3), here.cosine.store());
        let residual = std::array::from_fn(|k| {
            let error = f64::max(turn[k].sqrt(), gap[k].sqrt());
            if cosine[k] < 0.0 || error.is_nan() {
                f64::INFINITY
            } else {
                error
            }
        });
        (condition, residual)
    }
}
