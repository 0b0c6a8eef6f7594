"""Batches of general loops against each loop's own motion, dense rows of it, and themselves shared out in other ways.

Source: `Linkage.motion` and `Linkage.assembly_modes`, which the other tests hold against rows followed by Newton's
method; for the extremes of the jerk dense rows.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pytest

import sevenbar as sb
from sevenbar import _core
from sevenbar.kinematics.general import expanded

Floats = np.ndarray
Batch = Mapping[str, np.ndarray]

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

BY_LOOP = ("status", "circuits", "rank", "finite", "complete", "still", "input_rests", "modes")
BY_LIMIT = ("input_dead_centres",)


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
    return linkage._asked(SAMPLES, None, None, None)[:2]


def batch(linkages: Sequence[sb.Linkage], threads: int = 1, samples: int = SAMPLES) -> Batch:
    """All of them, which have one pattern of joints, at once."""
    parts = [expanded(linkage) for linkage in linkages]
    (letters,) = {part.letters for part in parts}
    return _core.measure_loops(
        letters,
        np.array([part.advances for part in parts]),
        np.array([part.base for part in parts]),
        np.array([linkage.ground for linkage in linkages]),
        np.array([part.links for part in parts]),
        *ends(linkages[0]),
        samples,
        threads,
    )


def four(extremes: Any) -> list[float]:
    if extremes is None:
        return [np.nan] * 4
    return [extremes.lowest, extremes.lowest_at, extremes.highest, extremes.highest_at]


def assert_is_the_motion(got: Batch, linkages: Sequence[sb.Linkage]) -> None:
    """Every number of a batch against the motion of each linkage by itself."""
    motions = [linkage.motion(SAMPLES, speed=1.0, method="general") for linkage in linkages]
    assert list(got["circuits"]) == [len(motion.circuits) for motion in motions]
    assert list(got["complete"]) == [motion.completeness != "searched" for motion in motions]
    circuits = [circuit for motion in motions for circuit in motion]
    for name in ("closed", "turns"):
        assert list(got[name]) == [getattr(circuit, name) for circuit in circuits], name
    assert list(got["singular"]) == [circuit.motion_type == "change-point" for circuit in circuits]

    def same(name: str, want: Sequence[Any]) -> None:
        np.testing.assert_allclose(
            got[name], np.reshape(want, got[name].shape), rtol=SAME, atol=SAME, err_msg=name
        )

    for which in ("input", "output"):
        ranges = [getattr(circuit, f"{which}_range") for circuit in circuits]
        same(f"{which}_range", [(np.nan, np.nan) if r is None else r for r in ranges])
        assert list(got[f"{which}_turns_fully"]) == [r is None for r in ranges]
    same("velocity", [four(circuit.velocity) for circuit in circuits])
    same("acceleration", [four(circuit.acceleration) for circuit in circuits])
    same("output_dead_centres", [four(circuit.angle) for circuit in circuits])
    limits = [[(d.input, d.output) for d in c.dead_centres if d.kind == "input"] for c in circuits]
    assert list(got["input_dead_centre_count"]) == [len(of) for of in limits]
    same("input_dead_centres", [d for of in limits for d in of])
    same("residual", [np.nanmax(circuit.residual) for circuit in circuits])
    ok = [circuit.condition[circuit.status == "ok"] for circuit in circuits]
    same("condition", [conditions.max() for conditions in ok])

    for n, (linkage, motion) in enumerate(zip(linkages, motions, strict=True)):
        found = linkage._general._found[ends(linkage)[0]]
        assert got["rank"][n] == (-1 if found.rank is None else found.rank)
        assert got["finite"][n] == (-1 if found.finite is None else found.finite)
        assert got["status"][n] == (motion.motion_type == "two-inputs") * 2
        if got["modes"][n] >= 0:
            assert got["modes"][n] == len(linkage.assembly_modes(0.0))


def test_random_loops_come_to_what_the_motion_of_each_says() -> None:
    linkages = random_seven_r(40, seed=11)
    got = batch(linkages)
    assert_is_the_motion(got, linkages)
    # all that is to be told apart is among them
    assert {0, 1, 2} < set(got["circuits"])
    assert got["complete"].all()
    assert (got["modes"] >= 0).all()
    assert 0 < got["input_turns_fully"].sum() < len(got["turns"])
    assert np.isfinite(got["jerk"]).all(axis=1).any()


@pytest.mark.parametrize(("name", "letters"), GALLERY.items())
def test_loops_of_the_gallery_come_to_what_their_motion_says(name: str, letters: str) -> None:
    linkage = sb.load(name)
    assert expanded(linkage).letters == letters
    got = batch([linkage])
    assert_is_the_motion(got, [linkage])
    assert got["status"] == [0]
    assert got["circuits"][0] > 0


@pytest.mark.parametrize("count", [1, 17])
def test_a_batch_is_the_same_to_the_bit_for_any_threads_and_any_split(count: int) -> None:
    linkages = random_seven_r(count, seed=12)
    whole = batch(linkages)
    for threads in (0, 2, 5):
        other = batch(linkages, threads=threads)
        for name, values in whole.items():
            assert values.tobytes() == other[name].tobytes(), (name, threads)
    for cut in {1, count // 2, count - 1} - {0, count}:
        parts = [batch(linkages[:cut], threads=2), batch(linkages[cut:])]
        for name, values in whole.items():
            joined = np.concatenate([part[name] for part in parts])
            assert values.tobytes() == joined.tobytes(), (name, cut)


def test_a_loop_is_the_same_to_the_bit_after_any_others() -> None:
    linkages = random_seven_r(12, seed=13)
    forwards, backwards = batch(linkages), batch(linkages[::-1])
    for name in BY_LOOP:
        assert forwards[name].tobytes() == backwards[name][::-1].tobytes(), name
    bounds = np.cumsum(np.append(0, forwards["circuits"]))
    order = np.concatenate([np.arange(a, b) for a, b in zip(bounds[-2::-1], bounds[:0:-1], strict=True)])
    for name in set(forwards) - {*BY_LOOP, *BY_LIMIT}:
        assert forwards[name][order.astype(int)].tobytes() == backwards[name].tobytes(), name


@pytest.mark.parametrize("name", ["seven_r", "bennett", "rccc", "rsur"])
def test_extremes_of_the_jerk_are_those_of_dense_rows(name: str) -> None:
    linkage = sb.load(name)
    got = batch([linkage])["jerk"]
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
        bounded = np.isfinite(fine[name]).all(axis=1)
        assert bounded.sum() > 5
        assert (np.isfinite(coarse[name]).all(axis=1) == bounded).all()
        values = [values[name][bounded][:, [0, 2]] for values in (coarse, fine)]
        np.testing.assert_allclose(*values, rtol=1e-9, err_msg=name)


def test_what_does_not_move_or_cannot_be_driven_has_its_status() -> None:
    rng = np.random.default_rng(3)

    def arrays(letters: str) -> tuple[Floats, ...]:
        links = np.tile(np.eye(4), (2, len(letters) - 1, 1, 1))
        links[..., :3, 3] = rng.normal(size=(2, len(letters) - 1, 3))
        frames = np.tile(np.eye(4), (2, 1, 1))
        return np.zeros((2, len(letters))), frames, frames, links

    # twelve freedoms
    got = _core.measure_loops("SRSRSRR", *arrays("SRSRSRR"), 3, 10, SAMPLES, 1)
    assert list(got["status"]) == [2, 2]
    assert list(got["circuits"]) == [0, 0]
    assert list(got["rank"]) == [-1, -1]
    # a ball has no one freedom
    got = _core.measure_loops("RSSR", *arrays("RSSR"), 1, 7, SAMPLES, 1)
    assert list(got["status"]) == [1, 1]
    got = _core.measure_loops("RRR", *arrays("RRR"), 0, 2, SAMPLES, 1)
    assert list(got["circuits"]) == [0, 0]
    assert got["velocity"].shape == (0, 4)


def test_an_empty_batch_has_empty_arrays() -> None:
    frames = np.empty((0, 4, 4))
    got = _core.measure_loops("RRRR", np.empty((0, 4)), frames, frames, np.empty((0, 3, 4, 4)), 0, 3, 90, 2)
    assert {name: values.shape[0] for name, values in got.items()} == dict.fromkeys(got, 0)


def test_what_does_not_fit_is_refused() -> None:
    frames, links, advances = (
        np.tile(np.eye(4), (2, 1, 1)),
        np.tile(np.eye(4), (2, 3, 1, 1)),
        np.zeros((2, 4)),
    )

    def refused(
        message: str, letters: str = "RRRR", input: int = 0, samples: int = 90, **other: Floats
    ) -> None:
        arrays = {"advances": advances, "base": frames, "ground": frames, "links": links} | other
        with pytest.raises(_core.CoreError, match=message):
            _core.measure_loops(letters, *arrays.values(), input, 3, samples, 1)

    refused("'X' is no joint; give R, P, H or S", letters="RRXR")
    refused(r"advances: an array of shape \[2, 4\]; give \[2, 5\]", letters="RRRRR")
    refused(r"base: an array of shape \[1, 4, 4\]; give \[2, 4, 4\]", base=frames[:1])
    refused(r"links: an array of shape \[2, 2, 4, 4\]; give \[2, 3, 4, 4\]", links=links[:, 1:])
    refused("links: NaN is not a finite number", links=links * np.nan)
    refused("input: no column 4; give 0 to 3", input=4)
    refused("4 joints and 0 samples", samples=0)
