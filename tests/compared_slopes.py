"""Derivatives by dimensions, each against a difference."""

import math

import numpy as np

from sevenbar.design.tolerance.sensitivities import sensitivities

#: Change in differences [parts of the size, rad]; their error is its square, rounding over it beside.
CHANGE = 1e-5


def changed(found, k, parts):
    """The linkage with one number changed, by the description, and the change in its unit."""
    step = parts * found.small[k] / 1e-3
    return found.changed(step * np.eye(len(found.dimensions))[k]), step


def same_circuit(found, linkage):
    """The circuit of a slightly changed linkage that is the one looked at."""
    motion = linkage.motion(
        found.samples, input=found.input_name, output=found.output_name, speed=found.speed
    )
    columns = np.flatnonzero(found.loop.numbers.turns & ~found.loop.numbers.is_ball)
    mine = np.exp(1j * found.circuit.q[:, columns])
    alike = [c for c in motion.circuits if c.q.shape == found.circuit.q.shape]
    best = min(alike, key=lambda c: np.nanmax(np.abs(np.exp(1j * c.q[:, columns]) - mine)))
    assert np.nanmax(np.abs(np.exp(1j * best.q[:, columns]) - mine)) < 1e-2
    return best


def told(found, linkage, circuit):
    """Every output of a circuit by the ordinary analysis, (rows, outputs)."""
    traces = [circuit.point(point.link, point.at) for point in linkage.points]
    rates = {"position": circuit.q, "velocity": circuit.dq, "acceleration": circuit.ddq}
    return np.column_stack(
        [
            rates[one.quantity][:, one.place]
            if one.joint
            else getattr(traces[one.place], one.quantity)[:, one.axis]
            for one in found.outputs
        ]
    )


def slopes_by_differences(found, k):
    """The derivatives (rows, outputs) by one number from two ordinary analyses."""
    sides = []
    for sign in (1, -1):
        linkage, step = changed(found, k, sign * CHANGE)
        sides.append((told(found, linkage, same_circuit(found, linkage)), step))
    apart = sides[0][0] - sides[1][0]
    turning = [one.unit == "rad" for one in found.outputs]
    apart[:, turning] = np.remainder(apart[:, turning] + np.pi, math.tau) - np.pi
    return apart / (sides[0][1] - sides[1][1])


def compare_all(linkage, close=3e-5, every=1, **options):
    """Every output and every number of a linkage, or each third, against differences; how many were compared."""
    found = sensitivities(linkage, samples=12, **options)
    compared = 0
    opens = np.array([dimension.name in found.opening for dimension in found.dimensions])
    assert np.isnan(found.slopes[:, :, opens]).all()
    for k in np.flatnonzero(~opens)[::every]:
        dimension = found.dimensions[k]
        slopes = slopes_by_differences(found, k)
        exact = found.slopes[:, :, k]
        both = np.isfinite(exact) & np.isfinite(slopes)
        for j, one in enumerate(found.outputs):
            rows = both[:, j]
            if not rows.any():
                continue
            # in what a change of the whole linkage would be: a coordinate alone may be zero but for rounding
            kin = [o.owner == one.owner and o.quantity == one.quantity for o in found.outputs]
            size = np.nanmax(np.abs(found.values[:, kin])) / (found.small[k] / 1e-3)
            size = max(size, np.nanmax(np.abs(exact[:, kin])), 1e-3 * found.speed**2)
            np.testing.assert_allclose(
                exact[rows, j],
                slopes[rows, j],
                rtol=0,
                atol=close * size,
                err_msg=f"{one.name} by {dimension.name}",
            )
            compared += int(rows.sum())
    return found, compared
