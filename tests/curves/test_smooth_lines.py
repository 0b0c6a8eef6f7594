"""Paths are drawn without corners that only few rows make, and with those that they have."""

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.drawing import plot
from sevenbar.drawing.smooth import CORNER, smooth_line


def circle(angles: np.ndarray) -> np.ndarray:
    return 80 * np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)


def bends(line: np.ndarray) -> np.ndarray:
    steps = np.diff(line, axis=0)
    steps /= np.linalg.norm(steps, axis=1)[:, None]
    return np.arccos(np.clip(np.sum(steps[1:] * steps[:-1], axis=1), -1, 1))


def test_a_circle_in_rows_that_thin_out_to_a_dead_centre_is_round() -> None:
    # equal steps of an input whose square is the angle: rows 12 degrees apart at the dead centre
    inputs = np.concatenate([-np.sqrt(np.linspace(1, 0, 30)), np.sqrt(np.linspace(0, 1, 30))])
    rows = circle(inputs)
    assert bends(np.delete(rows, 30, axis=0)).max() > 0.15
    line = smooth_line(rows)
    assert bends(line).max() < 0.06
    assert np.abs(np.linalg.norm(line, axis=1) - 80).max() < 0.002 * 80
    for row in rows:
        assert np.abs(line - row).max(axis=1).min() == pytest.approx(0, abs=1e-12)


def test_corners_and_gaps_stay() -> None:
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
    assert bends(square).min() > CORNER
    np.testing.assert_array_equal(smooth_line(square), square)
    gap = circle(np.linspace(0, 1, 20))
    gap[7:9] = np.nan
    line = smooth_line(gap)
    assert np.isnan(line).all(axis=1).sum() == 2
    np.testing.assert_array_equal(smooth_line(gap[:2]), gap[:2])
    assert smooth_line(gap[7:9]).shape == (2, 3)


def test_the_path_of_a_rocker_driven_at_its_limits_has_no_corners() -> None:
    figure = plot.configuration(sb.bricard_trihedral((50, 55, 70, 60, 75)).motion(180), view="iso")
    lines = [
        np.array(line.get_data_3d()).T
        for line in figure.axes[0].get_lines()
        if len(line.get_data_3d()[0]) > 90
    ]
    assert lines
    for line in lines:
        line = line[np.concatenate([[True], np.linalg.norm(np.diff(line, axis=0), axis=1) > 1e-6])]
        # a joint that turns back goes the same way again
        turned = bends(line)
        assert turned[turned < 3].max() < 0.15
