"""The public derivatives by dimensions, of circuits and their measures, against changed linkages."""

import math
import pickle
from dataclasses import replace

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.description.draft import Draft
from sevenbar.errors import RequestError
from sevenbar.kinematics.measures import MEASURES, gradient, measures_named, rows_of

#: Change of a number for differences, in parts of its unit beside the size.
CHANGE = 1e-5


def sides(linkage, name, by):
    """The linkage with a number a little greater, and a little less."""
    draft = Draft.of_linkage(linkage)
    value = draft.dimension(name).value
    return [draft.with_values({name: value + way * by}).linkage for way in (1, -1)]


@pytest.mark.parametrize(
    "linkage",
    [
        sb.rssr(M=640, N=-710, L1=210, L3=500, D=130, L2=900),
        sb.load("rssp"),
    ],
)
def test_the_gradient_of_every_measure_is_that_of_differences(linkage):
    motion = linkage.motion(36)
    found = gradient(motion)
    smooth = [m for m in MEASURES.values() if m.per == "circuit" and m.quantity not in ("word", "count")]
    values = rows_of(motion, smooth)[0]
    told = measures_named([m.name for m in smooth if values[m.name] is not None])
    # of the transmission angle the closed form of the RSSR has derivatives
    no_slopes = set() if linkage.kind == "RSSR" else {"transmission_lowest", "transmission_highest"}
    told = [m for m in told if m.name not in no_slopes]
    assert {m.name for m in told} <= set(found)
    assert {"jerk_lowest", "jerk_highest", "swing", "time_ratio"} <= set(found)
    sensitivity = motion.circuits[0].sensitivity()
    for k, (number, unit) in enumerate(zip(sensitivity.names, sensitivity.units, strict=True)):
        # a component of a direction is a number of about one
        by = 500 * CHANGE if unit else 10 * CHANGE
        high, low = (rows_of(side.motion(36), told)[0] for side in sides(linkage, number, by))
        for m in told:
            one = found[m.name]
            assert one.value == pytest.approx(values[m.name], rel=1e-9)
            slope = (high[m.name] - low[m.name]) / (2 * by)
            size = np.nanmax(np.abs(one.slopes))
            assert one.slopes[k] == pytest.approx(slope, abs=2e-5 * size), (m.name, number)


def test_sensitivities_of_a_circuit_are_those_of_differences_under_a_law_too():
    linkage = sb.load("seven_r")
    t = np.linspace(0.0, 1.0, 9)
    law = sb.Law.of(t, q=0.4 + t**2, dq=2 * t, ddq=2.0)
    circuit = linkage.motion(law=law).circuits[0]
    found = circuit.sensitivity()
    assert found.names[:3] == ("length_1", "offset_1", "twist_1")
    assert found.units[:3] == ("mm", "mm", "deg")
    assert found.position.shape == (len(circuit.q), 7, len(found.names))
    assert found.opening == ()
    for number in ("length_2", "twist_3", "offset_6", "P.u"):
        k, by = found.names.index(number), 1e-5
        ends = []
        for side in sides(linkage, number, by):
            motion = side.motion(law=law)
            # the same circuit, whatever its number there
            other = min(
                motion.circuits, key=lambda c: np.abs(np.exp(1j * c.q) - np.exp(1j * circuit.q)).max()
            )
            point = side.points[0]
            ends.append((other, other.point(point.link, point.at)))
        (a, trace_a), (b, trace_b) = ends
        pairs = (
            (found.position, np.remainder(a.q - b.q + np.pi, math.tau) - np.pi),
            (found.velocity, a.dq - b.dq),
            (found.acceleration, a.ddq - b.ddq),
            (found.points["P"], trace_a.position - trace_b.position),
            (found.point_velocities["P"], trace_a.velocity - trace_b.velocity),
        )
        for exact, difference in pairs:
            size = np.nanmax(np.abs(exact))
            np.testing.assert_allclose(exact[..., k], difference / (2 * by), rtol=0, atol=3e-6 * size)


def test_rows_at_dead_centres_and_idle_turns_have_no_derivatives():
    circuit = sb.load("rssr").motion(24, input="rocker").circuits[0]
    found = circuit.sensitivity()
    assert set(circuit.status) == {"ok", "dead-centre"}
    dead = circuit.status == "dead-centre"
    assert np.isnan(found.position[dead]).all()
    told = [name for k, name in enumerate(found.columns) if np.isfinite(found.position[~dead][:, k]).all()]
    assert told == ["crank", "ball_a.1", "ball_a.2", "rocker"]
    assert np.isfinite(found.points["B"][~dead]).all()
    # the rocker drives, and stays as it is
    assert not found.position[~dead][:, -1].any()


def test_a_number_that_opens_the_loop_is_named_and_has_no_derivative():
    found = sb.load("planar_4r").motion(12).circuits[0].sensitivity()
    assert set(found.opening) == {f"{word}_{i}" for word in ("offset", "twist") for i in range(1, 5)}
    opens = [name in found.opening for name in found.names]
    assert np.isnan(found.position[..., opens]).all()
    assert np.isfinite(found.position[..., ~np.array(opens)]).all()


@pytest.mark.parametrize("name", ["rssr", "rscr"])
def test_a_circuit_can_be_pickled_and_asked_again(name):
    circuit = sb.load(name).motion(12).circuits[0]
    again = pickle.loads(pickle.dumps(circuit)).sensitivity()
    np.testing.assert_array_equal(again.position, circuit.sensitivity().position)


def test_a_linkage_without_a_description_says_what_to_do():
    bare = replace(sb.load("rssr"), description={})
    with pytest.raises(RequestError, match="was made without a description; make it by load, rssr"):
        bare.motion(12).circuits[0].sensitivity()
