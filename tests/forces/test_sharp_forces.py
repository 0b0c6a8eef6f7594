"""Forces of a linkage that nearly folds flat: what is told of peaks and means holds, or is withheld."""

import math
from typing import Any

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.curves.cycle_series import CycleSeries
from sevenbar.curves.pieces import Pieces, cycle_curve, pieces
from sevenbar.forces.result import Forces
from sevenbar.forces.shaking import shaking_along
from sevenbar.reporting.force_words import no_peak

RODS = {2: sb.Body(1.0, solid="rod"), 3: sb.Body(1.0, solid="rod")}


def nearly_folding(off: float, **more: Any) -> Forces:
    """A crank-rocker whose ground is longer than that of a change point by so many mm, at 10 rad/s."""
    linkage = sb.four_bar(crank=40, coupler=100, rocker=80, ground=60 + off, speed="10 rad/s")
    return linkage.motion().circuits[0].forces(bodies=RODS, **more)


@pytest.mark.parametrize(
    ("off", "peak", "at"), [(0.01, 211.382171437, 4.1215e-3), (1e-4, 2118.807, 4.139e-4), (1e-6, 21188.6, 4.1393e-5)]
)  # fmt: skip
def test_next_to_a_fold_the_peak_is_that_of_forty_digits(off: float, peak: float, at: float) -> None:
    forces = nearly_folding(off)
    found = forces.sizing()
    assert found is not None
    assert found.peak_torque.value == pytest.approx(peak, rel=2e-6)
    assert found.peak_torque.input == pytest.approx(at, rel=1e-3)
    assert found.tail < 1e-7
    # nothing acts but inertia
    assert abs(found.mean_torque) < 1e-8 * peak
    assert forces.balance is not None
    assert forces.balance < 1e-5
    assert forces.work is not None
    assert forces.work < 1e-8


def test_the_rms_torque_next_to_a_fold_does_not_depend_on_the_rows() -> None:
    linkage = sb.four_bar(crank=40, coupler=100, rocker=80, ground=60.0001, speed="10 rad/s")
    rms = []
    for samples in (90, 361):
        found = linkage.motion(samples).circuits[0].forces(bodies=RODS).sizing()
        assert found is not None
        assert found.found == "refined"
        rms.append(found.rms_torque)
    assert rms[0] == pytest.approx(rms[1], rel=1e-9)


def test_a_peak_that_cannot_be_followed_is_withheld_with_the_reason() -> None:
    forces = nearly_folding(1e-9)
    found = forces.sizing()
    if found is None:
        assert "no peak: next to a limit" in no_peak(forces)
        assert shaking_along(forces) is None
    else:
        # the peak grows by the root of what is left of the fold
        assert found.peak_torque.value == pytest.approx(21188.6 * math.sqrt(1e3), rel=1e-2)


def test_a_load_that_sets_in_next_to_a_fold_has_its_work() -> None:
    load = sb.Load(1, torque=(0, 0, -3.0), between=("350 deg", "30 deg"))
    found = nearly_folding(1e-4, loads=[load]).sizing()
    assert found is not None
    assert found.found == "pieces"
    assert found.peak_torque.value == pytest.approx(2121.807, rel=1e-5)
    assert found.mean_torque == pytest.approx(3.0 * 40 / 360, rel=1e-9)


@pytest.mark.parametrize("width", [0.3, 1e-2, 1e-4])
def test_the_tail_is_a_bound_of_what_the_rows_miss(width: float) -> None:
    def sharp(x: Any) -> Any:
        return width**2 / (width**2 + np.sin((x - 1.234567) / 2) ** 2)

    for count in (36, 360, 3600):
        rows = np.arange(count) * math.tau / count
        series = CycleSeries(sharp(rows), 0.0, math.tau)
        fine = np.linspace(1.2, 1.3, 801)
        missed = np.abs(series.at(fine) - sharp(fine)).max() / series.scale
        assert missed < 3 * max(series.tail, 1e-11) or series.tail > 0.1
    curve = cycle_curve(sharp, sharp(np.arange(36) * math.tau / 36), 0.0, math.tau)
    assert curve.highest().value == pytest.approx(1.0, rel=1e-9)
    assert isinstance(curve, CycleSeries if width > 5e-3 else Pieces)


def test_pieces_of_noise_are_not_halved_for_ever() -> None:
    noise = np.random.default_rng(1)
    asked = 0

    def noisy(x: Any) -> Any:
        nonlocal asked
        asked += len(x)
        return np.sin(x) + 1e-9 * noise.normal(size=len(x))

    found = pieces(noisy, np.sin(np.arange(36) * math.tau / 36), 0.0, math.tau)
    assert asked < 2000
    assert found.tail < 1e-8
