"""Batches of general loops against each loop's own motion, dense rows of it, and themselves shared out in other ways.

Source: `Linkage.motion` and `Linkage.assembly_modes`, which the other tests hold against rows followed by Newton's
method; for the extremes of the jerk dense rows.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

import sevenbar as sb
from sevenbar import _core
from sevenbar.kinematics.solvers.general import expanded

Floats = np.ndarray

#: Rows a turn: fewer than extremes are bracketed by.
SAMPLES = 90

#: Both are the same numbers, those of lengths through one more product with the size.
SAME = 1e-14

#: One pattern of joints for each way in which circuits are found, with columns as input and output.
GALLERY = {
    "seven_r": "RRRRRRR",
    "bennett": "RRRR",
    "six_bar": "RRRRRRP",
    "bricard_trihedral": "RRRRRR",
    "rccc": "RPRPRPR",
    "rscr": "RSRPR",
    "rssp": "RSSP",
    "rssr": "RSSR",
    "screw_drill": "RRRHR",
    "swash_plate": "RPPRRRP",
}

MEASURES = ("turns", "swing", "time_ratio", "transmission", "velocity", "acceleration", "jerk")


def random_seven_r(count: int, seed: int) -> list[sb.Linkage]:
    rng = np.random.default_rng(seed)
    return [
        sb.from_dh(
            "R" * 7,
            length=rng.uniform(0.2, 1, 7),
            twist=rng.uniform(-np.pi, np.pi, 7),
            offset=rng.uniform(-0.5, 0.5, 7),
        )
        for _ in range(count)
    ]


def ends(linkage: sb.Linkage) -> tuple[int, int]:
    """The columns of input and output that the linkage names."""
    return linkage._asked(SAMPLES, None, None, None, None)[:2]


def batch(
    linkages: Sequence[sb.Linkage],
    threads: int = 1,
    samples: int = SAMPLES,
    speed: float = 1.0,
    columns: tuple[int, int] | None = None,
) -> _core.LoopBatch:
    """All of them, which have one pattern of joints, at once."""
    parts = [expanded(linkage) for linkage in linkages]
    (letters,) = {part.letters for part in parts}
    return _core.measure_loops(
        letters,
        np.array([part.advances for part in parts]),
        np.array([part.base for part in parts]),
        np.array([linkage.ground for linkage in linkages]),
        np.array([part.links for part in parts]),
        *(columns or ends(linkages[0])),
        samples,
        np.full(len(linkages), speed),
        threads,
    )


def by_loop(got: _core.LoopBatch) -> dict[str, Floats]:
    """What there is one of for each loop."""
    return {name: np.array(getattr(got, name)) for name in ("status", "motion_types", "circuits")}


def by_circuit(got: _core.LoopBatch) -> dict[str, Floats]:
    """What there is one of for each circuit, and their limits."""
    own = {name: np.array(getattr(got, name)) for name in ("circuit_types", "limit_counts", "limits")}
    return own | {name: getattr(got.measures, name) for name in MEASURES}


def four(extremes: Any) -> list[float]:
    if extremes is None:
        return [np.nan] * 4
    return [extremes.lowest, extremes.lowest_at, extremes.highest, extremes.highest_at]


def assert_is_the_motion(linkages: Sequence[sb.Linkage], speed: float = 1.0) -> _core.LoopBatch:
    """Every number of a batch against the motion of each linkage by itself."""
    got = batch(linkages, speed=speed)
    motions = [linkage.motion(SAMPLES, speed=speed, method="general") for linkage in linkages]
    assert list(got.circuits) == [len(motion.circuits) for motion in motions]
    assert list(got.status) == [(motion.motion_type == "two-inputs") * 2 for motion in motions]
    assert got.motion_types == [motion.motion_type for motion in motions]
    circuits = [circuit for motion in motions for circuit in motion]
    assert got.circuit_types == [circuit.motion_type for circuit in circuits]
    assert list(got.measures.turns) == [circuit.turns for circuit in circuits]

    def same(got: Floats, want: Sequence[Any]) -> None:
        numbers = np.reshape(np.array(want, dtype=np.float64), got.shape)
        np.testing.assert_allclose(got, numbers, rtol=SAME, atol=SAME)

    same(got.measures.swing, [circuit.swing for circuit in circuits])
    same(got.measures.time_ratio, [circuit.time_ratio for circuit in circuits])
    same(got.measures.velocity, [four(circuit.velocity) for circuit in circuits])
    same(got.measures.acceleration, [four(circuit.acceleration) for circuit in circuits])
    same(got.measures.jerk, [four(circuit.jerk) for circuit in circuits])
    limits = [[d.input for d in c.dead_centres if d.kind == "input"] for c in circuits]
    assert list(got.limit_counts) == [len(of) for of in limits]
    same(got.limits, [d for of in limits for d in of])
    return got


def test_random_loops_come_to_what_the_motion_of_each_says() -> None:
    linkages = random_seven_r(40, seed=11)
    got = assert_is_the_motion(linkages)
    # all that is to be told apart is among them
    assert {0, 1, 2} < set(got.circuits)
    assert 0 < np.count_nonzero(got.measures.turns) < len(got.measures.turns)
    assert np.isfinite(got.measures.jerk).all(axis=1).any()
    assert_is_the_motion(linkages[:10], speed=-2.5)


@pytest.mark.parametrize(("name", "letters"), GALLERY.items())
def test_loops_of_the_gallery_come_to_what_their_motion_says(name: str, letters: str) -> None:
    linkage = sb.load(name)
    assert expanded(linkage).letters == letters
    got = assert_is_the_motion([linkage])
    assert got.status == [0]
    assert got.circuits[0] > 0


def test_an_output_with_more_than_two_strokes_has_no_time_ratio_in_a_batch_either() -> None:
    linkage = sb.load("rccc")
    columns = linkage.columns.index("crank"), linkage.columns.index("slide_3")
    ratios = batch([linkage] * 2, columns=columns).measures.time_ratio
    assert len(ratios) > 0
    assert np.isnan(ratios).all()
    assert all(circuit.many_strokes for circuit in linkage.motion(36, output="slide_3"))


@pytest.mark.parametrize("count", [1, 17])
def test_a_batch_is_the_same_to_the_bit_for_any_threads_and_any_split(count: int) -> None:
    linkages = random_seven_r(count, seed=12)
    whole = batch(linkages)
    whole = by_loop(whole) | by_circuit(whole)

    def same(*parts: _core.LoopBatch) -> None:
        each = [by_loop(part) | by_circuit(part) for part in parts]
        for name, values in whole.items():
            assert np.concatenate([part[name] for part in each]).tobytes() == values.tobytes(), name

    for threads in (0, 2, 5):
        same(batch(linkages, threads=threads))
    for cut in {1, count // 2, count - 1} - {0, count}:
        same(batch(linkages[:cut], threads=2), batch(linkages[cut:]))


def test_a_loop_is_the_same_to_the_bit_after_any_others() -> None:
    linkages = random_seven_r(12, seed=13)
    forwards, backwards = batch(linkages), batch(linkages[::-1])
    for name, values in by_loop(forwards).items():
        assert values.tobytes() == by_loop(backwards)[name][::-1].tobytes(), name
    bounds = np.cumsum(np.append(0, forwards.circuits))
    order = np.concatenate([np.arange(a, b) for a, b in zip(bounds[-2::-1], bounds[:0:-1], strict=True)])
    for name, values in by_circuit(forwards).items():
        if name != "limits":
            assert values[order.astype(int)].tobytes() == by_circuit(backwards)[name].tobytes(), name


@pytest.mark.parametrize("name", ["seven_r", "bennett", "rccc", "rsur"])
def test_extremes_of_the_jerk_are_those_of_dense_rows(name: str) -> None:
    linkage = sb.load(name)
    got = batch([linkage]).measures.jerk
    rows = 5000
    dense = linkage.motion(rows, speed=1.0, method="general")
    assert len(got) == len(dense.circuits)
    compared = 0
    for (low, low_at, high, high_at), circuit in zip(got, dense, strict=True):
        jerk = circuit.dddq[:, circuit.output_column]
        if circuit.velocity is None:
            assert np.isnan([low, low_at, high, high_at]).all()
            continue
        compared += 1
        # a parabola through its summit loses what its curvature gives over half a step
        curvature = np.abs(np.diff(jerk, 2)).max()
        for value, at, sampled in ((low, low_at, jerk.min()), (high, high_at, jerk.max())):
            assert abs(value - sampled) <= curvature + 1e-9 * abs(value)
            there = np.interp(at % (2 * np.pi * circuit.turns), circuit.input, jerk)
            assert there == pytest.approx(value, abs=2 * curvature + 1e-9 * abs(value))
        assert low <= jerk.min() + 1e-9 * abs(low)
        assert high >= jerk.max() - 1e-9 * abs(high)
    assert compared


def test_extremes_of_the_jerk_do_not_hang_on_the_rows() -> None:
    linkages = random_seven_r(30, seed=14)
    coarse, fine = batch(linkages, samples=30), batch(linkages, samples=720)
    for name in ("velocity", "acceleration", "jerk"):
        both = [getattr(each.measures, name) for each in (coarse, fine)]
        bounded = np.isfinite(both[1]).all(axis=1)
        assert bounded.sum() > 5
        assert (np.isfinite(both[0]).all(axis=1) == bounded).all()
        values = [values[bounded][:, [0, 2]] for values in both]
        np.testing.assert_allclose(*values, rtol=1e-9, err_msg=name)


def test_what_does_not_move_or_cannot_be_driven_has_its_status() -> None:
    rng = np.random.default_rng(3)

    def arrays(letters: str) -> tuple[Floats, ...]:
        links = np.tile(np.eye(4), (2, len(letters) - 1, 1, 1))
        links[..., :3, 3] = rng.normal(size=(2, len(letters) - 1, 3))
        frames = np.tile(np.eye(4), (2, 1, 1))
        return np.zeros((2, len(letters))), frames, frames, links

    # twelve freedoms
    got = _core.measure_loops("SRSRSRR", *arrays("SRSRSRR"), 3, 10, SAMPLES, np.ones(2), 1)
    assert list(got.status) == [2, 2]
    assert list(got.circuits) == [0, 0]
    # a ball has no one freedom
    got = _core.measure_loops("RSSR", *arrays("RSSR"), 1, 7, SAMPLES, np.ones(2), 1)
    assert list(got.status) == [1, 1]
    got = _core.measure_loops("RRR", *arrays("RRR"), 0, 2, SAMPLES, np.ones(2), 1)
    assert list(got.circuits) == [0, 0]
    assert got.measures.velocity.shape == (0, 4)


def test_an_empty_batch_has_empty_arrays() -> None:
    frames = np.empty((0, 4, 4))
    links = np.empty((0, 3, 4, 4))
    got = _core.measure_loops("RRRR", np.empty((0, 4)), frames, frames, links, 0, 3, 90, np.empty(0), 2)
    assert {len(values) for values in (by_loop(got) | by_circuit(got)).values()} == {0}


def test_what_does_not_fit_is_refused() -> None:
    frames, links, advances = (
        np.tile(np.eye(4), (2, 1, 1)),
        np.tile(np.eye(4), (2, 3, 1, 1)),
        np.zeros((2, 4)),
    )

    def refused(
        message: str,
        letters: str = "RRRR",
        input: int = 0,
        samples: int = 90,
        speeds: int = 2,
        **other: Floats,
    ) -> None:
        arrays = {"advances": advances, "base": frames, "ground": frames, "links": links} | other
        with pytest.raises(_core.CoreError, match=message):
            _core.measure_loops(letters, *arrays.values(), input, 3, samples, np.ones(speeds), 1)

    refused("'X' is no joint; give R, P, H or S", letters="RRXR")
    refused(r"advances: an array of shape \[2, 4\]; give \[2, 5\]", letters="RRRRR")
    refused(r"base: an array of shape \[1, 4, 4\]; give \[2, 4, 4\]", base=frames[:1])
    refused(r"links: an array of shape \[2, 2, 4, 4\]; give \[2, 3, 4, 4\]", links=links[:, 1:])
    refused("links: NaN is not a finite number", links=links * np.nan)
    refused("input: no column 4; give 0 to 3", input=4)
    refused("4 joints and 0 samples", samples=0)
    refused(r"speed: an array of shape \[3\]; give \[2\]", speeds=3)
