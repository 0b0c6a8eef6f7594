"""Calibration against curves of known dimensions, made by other programs than the one under test."""

import builtins
import math
from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest
from scipy.stats import binom, t

import sevenbar as sb
from evidence.accuracy import reference_rssr
from evidence.accuracy.reference_loops import Loop
from evidence.fuzz.random_linkages import Dimensions
from evidence.fuzz.random_loops import general
from sevenbar.description.draft import Draft
from sevenbar.description.gallery import text
from sevenbar.errors import MissingExtraError, NotCoveredError, RequestError
from sevenbar.measuring.calibrate import calibrate
from sevenbar.measuring.measured import Ends, Measured
from sevenbar.measuring.rewrite import calibrated_toml

PAPER = Dimensions(700.0, 700.0, 250.0, 550.0, 0.0, math.sqrt(450**2 + 550**2 + 700**2))

#: An RSSR whose D is far from zero, so that its angles tell all dimensions but the scale.
SKEW = Dimensions(700.0, 650.0, 250.0, 550.0, 150.0, 980.0)

#: How improbable a count of intervals that hold may be before it is taken for a fault.
DOUBT = 0.01


def table(**values):
    count = len(next(iter(values.values())))
    return Measured(
        "bench.csv", np.arange(2, count + 2), {k: np.asarray(v, float) for k, v in values.items()}
    )


def measured_rssr(dims, count=120, circuit=0, phase=0.0, offset=0.0):
    inputs = 2 * np.pi / count * np.arange(count)
    return inputs, dims.reference().outputs(inputs + phase)[circuit] + offset


def values(calibration):
    return {p.name: p.value for p in calibration.parameters}


def test_known_dimensions_come_back_from_a_curve_without_noise():
    truth = replace(SKEW, N=655.0, L1=252.5, L3=546.0, D=147.0, L2=984.0)
    inputs, angle = measured_rssr(truth, circuit=1, phase=0.02, offset=-0.01)
    found = calibrate(
        SKEW.linkage(), table(input=inputs, angle=angle), hold=["M"], offsets=["input", "output"]
    )
    wanted = {name: getattr(truth, name) for name in ("M", "N", "L1", "L2", "L3", "D")}
    wanted |= {"input_offset": 0.02, "output_offset": -0.01}
    assert values(found) == pytest.approx(wanted, rel=1e-8)
    assert found.before.chosen.circuit == 1
    assert {p.name for p in found.calibrated} == set(wanted) - {"M"}


def test_velocities_and_accelerations_tell_dimensions_without_angles():
    truth = replace(PAPER, L1=252.0, L3=548.0, L2=999.0)
    precise, times = truth.reference().precise(), np.linspace(0.0, 0.62, 40)
    angle = truth.reference().outputs(10 * times)[0]
    with mp.workdps(reference_rssr.DIGITS):
        rates = np.array(
            [precise.output((10.0 * s, 10.0, 0, 0), a) for s, a in zip(times, angle, strict=True)], float
        )
    measured = table(time=times, velocity=rates[:, 1], acceleration=rates[:, 2])
    found = calibrate(sb.load("rssr"), measured, free=["L?"])
    assert values(found) == pytest.approx({**vars(truth)}, rel=1e-8)


def test_the_scale_is_not_told_by_angles_and_one_length_is_held():
    inputs, angle = measured_rssr(replace(SKEW, L1=252.0))
    found = calibrate(SKEW.linkage(), table(input=inputs, angle=angle))
    held = [p for p in found.parameters if p.status == "unidentified"]
    assert [(p.name, p.value) for p in held] == [("M", 700.0)]
    assert set(held[0].undone_by) == {"N", "L1", "L2", "L3", "D"}
    # the curve is explained, so all lengths are right but for one factor, which is 1 here
    assert found.parameter("L1").value == pytest.approx(252.0, rel=1e-7)


def test_without_d_crank_and_rocker_side_scale_on_their_own():
    inputs, angle = measured_rssr(replace(PAPER, L1=251.0, L3=548.0))
    found = calibrate(sb.load("rssr"), table(input=inputs, angle=angle), hold=["D"])
    held = {p.name: set(p.undone_by) for p in found.parameters if p.status == "unidentified"}
    # |A - B| is kept where L1 and N, or L3 and M, grow in proportion and L2 follows
    assert held == {"M": {"L2", "L3"}, "N": {"L1", "L2"}}
    assert found.parameter("L1").value == pytest.approx(251.0, rel=1e-8)
    assert found.parameter("D").status == "fixed"


def test_a_dimension_that_noise_hides_is_held_too():
    rng = np.random.default_rng(1)
    inputs, angle = measured_rssr(replace(PAPER, L1=251.0, D=2.0), count=60)
    found = calibrate(sb.load("rssr"), table(input=inputs, angle=angle + 2e-3 * rng.normal(size=60)))
    # D near zero tells the two scales apart in principle, but not through this noise
    assert {p.name for p in found.parameters if p.status == "unidentified"} == {"M", "N"}


def test_what_is_told_is_freed_again_once_it_is_known():
    truth = replace(PAPER, D=150.0, L1=252.0)
    inputs, angle = measured_rssr(truth)
    # at the nominal D = 0 two directions are unidentified, at the true one only the scale
    found = calibrate(replace(PAPER, D=0.0).linkage(), table(input=inputs, angle=angle))
    assert {p.name for p in found.parameters if p.status == "unidentified"} == {"M"}
    assert values(found) == pytest.approx(vars(truth), rel=1e-7)


def test_a_7r_tells_many_dimensions_and_names_those_that_axes_in_parallel_hide():
    linkage = sb.load("seven_r")
    circuit = linkage.motion(90).circuits[0]
    found = calibrate(linkage, table(input=circuit.input, angle=circuit.output), free=["offset_*"])
    held = {p.name: set(p.undone_by) for p in found.parameters if p.status == "unidentified"}
    # axes 3, 4 and 5 are parallel: a slide along one is a slide along any
    assert held["offset_3"] == {"offset_5"}
    assert held["offset_4"] == {"offset_5"}
    assert values(found) == pytest.approx({p.name: p.nominal for p in found.parameters}, abs=1e-7)


def seven_r(seed):
    """A general 7R and, at 90 inputs that close, its output at dimensions of which some are changed."""
    rows = general(np.random.default_rng(seed))
    linkage = rows.linkage()
    circuit = next(c for c in linkage.motion(360).circuits if c.input_range is None)
    keep = np.arange(0, 360, 4)
    truth = {
        "length_2": rows.length[1] + 0.02,
        "twist_4": rows.twist[3] - 0.015,
        "offset_5": rows.offset[4] + 0.01,
    }
    length, twist, offset = rows.length.copy(), rows.twist.copy(), rows.offset.copy()
    length[1], twist[3], offset[4] = truth.values()
    real = Loop.of(sb.from_dh("RRRRRRR", length=length, twist=twist, offset=offset))
    poses = real.polished(circuit.q[keep], 0, steps=12)
    assert real.errors(poses).max() < 1e-12
    return linkage, truth, poses[:, 0], poses[:, 6], circuit


def test_known_dimensions_of_a_general_7r_come_back():
    linkage, truth, inputs, angle, circuit = seven_r(4)
    found = calibrate(linkage, table(input=inputs, angle=angle), free=list(truth))
    assert {p.name: p.value for p in found.calibrated} == pytest.approx(truth, abs=1e-8)
    assert found.before.chosen.circuit == circuit.index


def planar_output(theta, a1, a2, a3, a4, side):
    """theta_4 of a planar four-bar by its two circles: a1 e^(i phi1) + .. + a4 = 0, theta_4 = -phi3."""
    target = -(a1 * np.exp(1j * theta) + a4)
    reach = np.abs(target)
    return -np.unwrap(np.angle(target) + side * np.arccos((reach**2 + a3**2 - a2**2) / (2 * reach * a3)))


def test_a_planar_four_bar_tells_lengths_and_holds_what_would_open_it():
    linkage = sb.load("planar_4r")
    inputs = np.linspace(0.0, 6.2, 80)
    angle = planar_output(inputs, 41.0, 100.0, 79.0, 92.0, 1)
    found = calibrate(linkage, table(input=inputs, angle=angle))
    status = {p.name: p.status for p in found.parameters}
    assert {name for name, word in status.items() if word == "opens the loop"} == {
        f"{word}_{i}" for word in ("offset", "twist") for i in range(1, 5)
    }
    # one length is the scale; the one that is held, 100, is here the true one
    assert [name for name, word in status.items() if word == "unidentified"] == ["length_2"]
    lengths = [values(found)[f"length_{i}"] for i in range(1, 5)]
    assert lengths == pytest.approx([41.0, 100.0, 79.0, 92.0], rel=1e-8)


def test_what_the_output_of_the_paper_s_7r_does_not_depend_on_is_held():
    linkage = sb.load("seven_r")
    circuit = linkage.motion(60).circuits[0]
    found = calibrate(linkage, table(input=circuit.input, angle=circuit.output), free=["length_?"])
    # links 2 to 5 lie across the three parallel axes, and only lengths along these tie the output
    alone = {p.name for p in found.parameters if p.status == "unidentified" and not p.undone_by}
    assert alone == {"length_2", "length_3", "length_4", "length_5"}


def holds(calibrations, truth, level):
    """How often the interval of each parameter at a level holds its true value."""
    counts = dict.fromkeys(truth, 0)
    for found in calibrations:
        reach = t.ppf(0.5 + level / 2, found.freedom)
        for name, value in truth.items():
            parameter = found.parameter(name)
            assert parameter.status == "calibrated"
            counts[name] += abs(parameter.value - value) <= reach * parameter.error
            if level == found.confidence:
                assert (parameter.low <= value <= parameter.high) == (
                    abs(parameter.value - value) <= reach * parameter.error
                )
    return counts


def as_often_as_claimed(calibrations, truth):
    for level in (0.95, 0.5):
        low, high = binom.ppf([DOUBT / 2, 1 - DOUBT / 2], len(calibrations), level)
        for name, count in holds(calibrations, truth, level).items():
            assert low <= count <= high, f"{name}: {count} of {len(calibrations)} at {level}"


@pytest.mark.parametrize("count", [60, pytest.param(300, marks=pytest.mark.proof)])
def test_intervals_of_an_rssr_hold_the_truth_as_often_as_they_claim(count):
    truth = replace(SKEW, N=652.0, L1=251.5, L3=548.0, D=148.0, L2=982.0)
    inputs, angle = measured_rssr(truth, phase=0.01, offset=0.005)
    rng = np.random.default_rng(20)
    found = [
        calibrate(
            SKEW.linkage(),
            table(input=inputs, angle=angle + 2e-4 * rng.normal(size=len(angle))),
            hold=["M"],
            offsets=["input", "output"],
        )
        for _ in range(count)
    ]
    known = {name: getattr(truth, name) for name in ("N", "L1", "L2", "L3", "D")}
    as_often_as_claimed(found, known | {"input_offset": 0.01, "output_offset": 0.005})
    noise = np.array([calibration.noise["angle"] for calibration in found])
    assert noise.mean() == pytest.approx(2e-4, rel=0.02)


@pytest.mark.parametrize("count", [100, pytest.param(400, marks=pytest.mark.proof)])
def test_intervals_hold_where_what_is_untold_was_found_out_on_the_way(count):
    truth = replace(PAPER, L1=251.5, L3=548.0, D=2.0, L2=999.0)
    inputs, angle = measured_rssr(truth)
    rng = np.random.default_rng(21)
    found = [
        calibrate(sb.load("rssr"), table(input=inputs, angle=angle + 1e-3 * rng.normal(size=len(angle))))
        for _ in range(count)
    ]
    as_often_as_claimed(found, {name: getattr(truth, name) for name in ("L1", "L2", "L3", "D")})


@pytest.mark.parametrize("count", [100, pytest.param(300, marks=pytest.mark.proof)])
def test_intervals_hold_where_quantities_of_unlike_noise_are_measured_together(count):
    truth = replace(PAPER, L1=251.5, L3=548.0, L2=999.0)
    reference = truth.reference()
    times = np.linspace(0.0, 0.62, 60)
    angle, precise = reference.outputs(10 * times)[0], reference.precise()
    with mp.workdps(reference_rssr.DIGITS):
        rates = np.array(
            [precise.output((10.0 * s, 10.0, 0, 0), a) for s, a in zip(times, angle, strict=True)], float
        )
    rng = np.random.default_rng(22)
    found = []
    for _ in range(count):
        measured = table(
            time=times,
            angle=angle + 2e-3 * rng.normal(size=60),
            velocity=rates[:, 1] + 5e-3 * rng.normal(size=60),
            acceleration=rates[:, 2] + 1.0 * rng.normal(size=60),
        )
        found.append(calibrate(sb.load("rssr"), measured, free=["L?"]))
    as_often_as_claimed(found, {name: getattr(truth, name) for name in ("L1", "L2", "L3")})
    for quantity, noise in (("angle", 2e-3), ("velocity", 5e-3), ("acceleration", 1.0)):
        assert np.mean([c.noise[quantity] for c in found]) == pytest.approx(noise, rel=0.03)


@pytest.mark.parametrize("count", [60, pytest.param(150, marks=pytest.mark.proof)])
def test_intervals_of_a_7r_hold_the_truth_as_often_as_they_claim(count):
    linkage, truth, inputs, angle, _ = seven_r(4)
    rng = np.random.default_rng(23)
    found = [
        calibrate(
            linkage, table(input=inputs, angle=angle + 1e-4 * rng.normal(size=len(angle))), free=list(truth)
        )
        for _ in range(count)
    ]
    as_often_as_claimed(found, truth)


def test_differences_that_follow_each_other_are_told():
    truth = replace(PAPER, D=20.0, L1=252.0)
    inputs, angle = measured_rssr(truth)
    measured = table(input=inputs, angle=angle + 1e-4 * np.random.default_rng(3).normal(size=len(angle)))
    wrong = calibrate(sb.load("rssr"), measured, free=["L1"])
    assert any("follow each other" in note and "too narrow" in note for note in wrong.notes)
    right = calibrate(sb.load("rssr"), measured, free=["L1", "D"])
    assert not any("follow each other" in note for note in right.notes)


def test_repeated_rows_do_not_follow_each_other():
    inputs, angle = measured_rssr(replace(PAPER, L1=252.0))
    places = np.linspace(0, len(angle) - 1, 24).astype(int)
    noisy = angle[places] + 1e-4 * np.random.default_rng(5).normal(size=len(places))
    for rows in (np.repeat(np.arange(24), 10), np.tile(np.arange(24), 10)):
        measured = table(input=inputs[places][rows], angle=noisy[rows])
        found = calibrate(sb.load("rssr"), measured, free=["L1"])
        assert found.places == 24
        assert not any("follow each other" in note for note in found.notes)


@pytest.mark.parametrize("name", ["rssr", "seven_r"])
def test_the_calibrated_file_is_the_old_one_with_new_dimensions(name):
    linkage = sb.load(name)
    circuit = linkage.motion(72).circuits[0]
    moved = circuit.output + 1e-6 * np.sin(circuit.input)
    free = ["L1", "L3"] if name == "rssr" else ["offset_6", "twist_2"]
    found = calibrate(linkage, table(input=circuit.input, angle=moved), free=free)
    written = calibrated_toml(text(name), found)
    other = sb.loads(written)
    for parameter in found.parameters:
        key = parameter.name + ("_deg" if parameter.kind == "angle" else "")
        value = math.degrees(parameter.value) if parameter.kind == "angle" else parameter.value
        assert other.dimensions[key] == pytest.approx(value, rel=1e-13)
        if parameter.status == "fixed":
            assert other.dimensions[key] == linkage.dimensions[key]
        else:
            assert other.dimensions[key] != linkage.dimensions[key]
    assert (other.name, other.drive, other.joints) == (linkage.name, linkage.drive, linkage.joints)
    assert [(point.name, point.link) for point in other.points] == [(p.name, p.link) for p in linkage.points]
    comments = [line for line in text(name).splitlines() if line.startswith("#")]
    assert comments
    assert all(line in written for line in comments)


def test_a_wrong_guess_of_the_start_is_mended_by_the_offsets():
    truth = replace(SKEW, L1=253.0)
    inputs, angle = measured_rssr(truth, phase=0.7)
    found = calibrate(SKEW.linkage(), table(input=inputs, angle=angle), free=["L1"], offsets=["input"])
    assert found.parameter("input_offset").value == pytest.approx(0.7, rel=1e-9)
    assert found.parameter("L1").value == pytest.approx(253.0, rel=1e-9)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            {"free": ["l1"]},
            "free: no dimension 'l1'; did you mean 'L1'? this linkage has M, N, L1, L2, L3, D",
        ),
        ({"hold": ["length_*"]}, "hold: no dimension 'length_*'; this linkage has M, N, L1, L2, L3, D"),
        ({"hold": ["*"]}, "free: nothing is left to be found; free a dimension or an offset"),
        ({"offsets": ["both"]}, "offset: 'both' is not offered; give input or output"),
        ({"confidence": 95}, "confidence: 95 is not a probability; give one like 0.95"),
    ],
)
def test_each_wrong_request_has_its_message(options, message):
    inputs, angle = measured_rssr(PAPER, count=12)
    with pytest.raises(RequestError) as caught:
        calibrate(sb.load("rssr"), table(input=inputs, angle=angle), **options)
    assert str(caught.value) == message


def test_fewer_values_than_dimensions_are_told():
    inputs, angle = measured_rssr(SKEW, count=100)
    with pytest.raises(
        RequestError, match=r"3 measured values cannot identify [345] dimensions; measure at more inputs"
    ):
        calibrate(SKEW.linkage(), table(input=inputs[:3], angle=angle[:3]), hold=["M", "N", "D"],
                  offsets=["input", "output"])  # fmt: skip


def drawn(name, **changes):
    """A drawn linkage of the gallery with other numbers, and its output by Newton's method of the reference."""
    linkage = sb.load(name)
    draft = Draft.of_linkage(linkage)
    truth = {
        key.replace("__", "."): draft.dimension(key.replace("__", ".")).value + by
        for key, by in changes.items()
    }
    real = draft.with_values(truth).linkage
    circuit = linkage.motion(90).circuits[0]
    poses = Loop.of(real).polished(circuit.q, circuit.input_column, steps=20)
    assert Loop.of(real).errors(poses).max() < 1e-11
    return linkage, truth, circuit.input, poses[:, circuit.output_column]


@pytest.mark.parametrize(
    ("name", "changes"),
    [
        # two balls with a universal joint between them; a screw; a link that spins idly between its balls
        ("rsur", {"rocker__y": 1.5, "crank__axis_x": 0.01}),
        ("screw_drill", {"thread__pitch": 1.0}),
        ("rssp", {"ball_b__x": 2.0, "ball_a__y": -1.0}),
        ("rscr", {"rocker__x": 1.0}),
    ],
)
def test_known_numbers_of_a_drawn_loop_come_back(name, changes):
    linkage, truth, inputs, output = drawn(name, **changes)
    found = calibrate(linkage, table(input=inputs, angle=output), free=list(truth))
    assert {p.name: p.value for p in found.calibrated} == pytest.approx(truth, rel=1e-8)


def test_what_no_curve_tells_of_a_drawing_is_held():
    linkage, _, inputs, output = drawn("rsur", rocker__y=1.5)
    found = calibrate(linkage, table(input=inputs, angle=output), free=["crank.*"])
    status = {p.name: p.status for p in found.parameters if p.name.startswith("crank.")}
    # along its axis, and by the length of its direction, the crank's line moves nothing
    assert sum(word == "unidentified" for word in status.values()) >= 2
    assert status["crank.z"] == "unidentified" or status["crank.axis_z"] == "unidentified"


def test_an_output_that_spins_idly_is_told():
    joints = [
        {"kind": "R", "at": (0, 0, 0), "axis": (0, 0, 1)},
        {"kind": "R", "at": (40, 0, 0), "axis": (0, 0, 1), "name": "idle"},
        {"kind": "R", "at": (40, 0, 30), "axis": (0, 0, 1)},
        {"kind": "R", "at": (100, 70, 0), "axis": (0, 0, 1)},
        {"kind": "R", "at": (120, 0, 0), "axis": (0, 0, 1), "name": "rocker"},
    ]
    linkage = sb.from_axes(joints)
    circuit = linkage.motion(40).circuits[0]
    found = calibrate(linkage, table(input=circuit.input, angle=circuit.output), free=["rocker.x"])
    assert found.parameter("rocker.x").value == pytest.approx(120.0, rel=1e-9)
    numbers = table(input=circuit.input, angle=circuit.q[:, 1])
    with pytest.raises(
        NotCoveredError, match="idle takes part in an idle motion, which the input does not tell"
    ):
        calibrate(linkage, numbers, Ends(linkage.columns[0], "idle"), free=["rocker.x"])


def test_a_missing_scipy_is_named_with_its_extra(monkeypatch):
    real = builtins.__import__

    def without(name, *arguments, **keywords):
        if name.startswith("scipy"):
            raise ImportError(name)
        return real(name, *arguments, **keywords)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(MissingExtraError, match=r"pip install 'sevenbar\[calibrate\]'"):
        calibrate(sb.load("rssr"), table(input=[0.0, 1.0], angle=[0.0, 1.0]))


def test_a_missing_tomlkit_is_named_with_its_extra(monkeypatch):
    real = builtins.__import__

    def without(name, *arguments, **keywords):
        if name == "tomlkit":
            raise ImportError(name)
        return real(name, *arguments, **keywords)

    inputs, angle = measured_rssr(PAPER, count=30)
    found = calibrate(sb.load("rssr"), table(input=inputs, angle=angle), free=["L1"])
    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(
        MissingExtraError, match=r"needs tomlkit; install it with: pip install 'sevenbar\[design\]'"
    ):
        calibrated_toml(text("rssr"), found)
