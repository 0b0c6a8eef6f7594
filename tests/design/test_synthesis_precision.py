"""Linkages are recovered from their own pairs of angles: three to seven precision points in closed form."""

import math

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.design.closure import NAMES, outputs
from sevenbar.design.limits import Limits
from sevenbar.design.synthesis.function.generation import function_generation
from sevenbar.design.synthesis.function.precision import system, through
from sevenbar.design.wish import chebyshev

#: A design with L3 = 1, the zeros of its dials, readings of its input.
KNOWN = np.array([300.0, 200.0, 250.0, 420.0, 350.0, -100.0]) / 350.0
ZEROS = (0.7, -0.4)
READINGS = np.linspace(0.0, 1.2, 7)

ANY = Limits(size=(1e-3, 1e3))


def known_pairs(count):
    """Readings of the known linkage, from the ordinary analysis of it."""
    linkage = sb.rssr(**dict(zip(NAMES, 350.0 * KNOWN, strict=True)))
    readings = READINGS[:count]
    return readings, linkage.output(ZEROS[0] + readings).position[0] - ZEROS[1]


def coefficients(row):
    """k0 .. k4 (5,) of the closure (1) of a design (6,)."""
    m, n, l1, l2, l3, d = row
    k0 = (m * m + n * n + l1 * l1 + l3 * l3 + d * d - l2 * l2) / (2 * l1 * l3)
    return np.array([k0, m / l3, d / l3, d / l1, n / l1])


def misses(row, zeros, pairs):
    """How far the nearer branch of a design is from each pair [rad]."""
    linkage = sb.rssr(**dict(zip(NAMES, row, strict=True)))
    position = linkage.output(zeros[0] + pairs[0]).position - zeros[1] - pairs[1]
    return np.nanmin(np.abs((position + math.pi) % math.tau - math.pi), axis=0)


def test_the_closure_is_linear_in_five_combinations_of_the_dimensions():
    a, b = known_pairs(7)
    rows, right = system(ZEROS[0] + a, ZEROS[1] + b)
    np.testing.assert_allclose(rows @ coefficients(KNOWN), right, atol=1e-14)


def test_five_points_with_given_zeros_give_the_known_linkage_and_no_other():
    rows, zeros = through(*known_pairs(5), zeros=ZEROS)
    assert len(rows) == 1
    np.testing.assert_allclose(rows[0], KNOWN, atol=1e-9)
    np.testing.assert_allclose(zeros[0], ZEROS)


def test_seven_points_give_two_designs_at_most_and_the_known_one_with_its_zeros_is_among_them():
    pairs = known_pairs(7)
    rows, zeros = through(*pairs)
    assert 1 <= len(rows) <= 2
    nearest = np.abs(rows - KNOWN).max(axis=1).argmin()
    np.testing.assert_allclose(rows[nearest], KNOWN, atol=1e-9)
    np.testing.assert_allclose(zeros[nearest], ZEROS, atol=1e-9)
    for row, zero in zip(rows, zeros, strict=True):
        assert misses(row, zero, pairs).max() < 1e-9


def test_six_points_give_a_curve_of_designs_with_the_known_one_on_it():
    pairs = known_pairs(6)
    rows, zeros = through(*pairs, samples=4096)
    assert len(rows) > 2000
    for row, zero in zip(rows[:40], zeros[:40], strict=True):
        assert misses(row, zero, pairs).max() < 1e-9
    near = np.abs(rows - KNOWN).max(axis=1) + np.abs(zeros - ZEROS).max(axis=1)
    assert near.min() < 0.01


@pytest.mark.parametrize("count", [3, 4])
def test_fewer_points_leave_designs_free_and_all_meet_them(count):
    pairs = known_pairs(count)
    rows, zeros = through(*pairs, zeros=ZEROS, samples=64)
    assert len(rows) > 10
    for row, zero in zip(rows, zeros, strict=True):
        assert misses(row, zero, pairs).max() < 1e-9
    # the known one lies in the plane (or on the line) of these coefficients
    k = np.array([coefficients(row) for row in rows if row[5] != 0])
    offsets = k - coefficients(KNOWN)
    sizes = np.linalg.svd(offsets / np.linalg.norm(offsets, axis=1)[:, None], compute_uv=False)
    assert sizes[5 - count] < 1e-8 * sizes[0]


def test_the_papers_linkage_comes_back_from_three_pairs_of_its_own_equation_8():
    """Sun and Zhou's example: M = N = 700, L1 = 250, L3 = 550, D = 0; eq. (8) is written out here."""
    alpha = np.array([0.2, 0.9, 1.7])
    rise = 250 * 700 * (1 - np.cos(alpha))
    beta = np.arcsin(rise / (550 * np.sqrt(700**2 + (250 * np.sin(alpha)) ** 2))) - np.arctan(
        250 * np.sin(alpha) / 700
    )
    rows, _ = through(alpha, beta, zeros=(0.0, 0.0), samples=4096)
    flat = rows[rows[:, 5] == 0]
    # with D = 0 the function tells M / L3, N / L1 and k0, and leaves L1 / L3 open
    np.testing.assert_allclose(flat[:, 0], 700 / 550, rtol=1e-9)
    np.testing.assert_allclose(flat[:, 1] / flat[:, 2], 700 / 250, rtol=1e-9)
    own = flat[np.abs(flat[:, 2] - 250 / 550).argmin()]
    assert own[2] == pytest.approx(250 / 550, rel=5e-3)
    # L2 follows from k0 = (M^2 + N^2 + L1^2 + L3^2 - L2^2) / (2 L1 L3)
    l2 = math.sqrt((250 - 700) ** 2 + 550**2 + 700**2)
    k0 = (2 * 700**2 + 250**2 + 550**2 - l2**2) / (2 * 250 * 550)
    np.testing.assert_allclose([coefficients(row)[0] for row in flat], k0, rtol=1e-9)


def test_designs_with_D_zero_and_other_L1_share_one_function():
    base = np.array([1.2, 0.9, 0.6, 1.7, 1.0, 0.0])
    k0 = coefficients(base)[0]
    alpha = np.linspace(0.0, 1.0, 9)
    other = base.copy()
    other[2], other[1] = 2 * base[2], 2 * base[1]
    other[3] = math.sqrt(other[0] ** 2 + other[1] ** 2 + other[2] ** 2 + 1 - 2 * k0 * other[2])
    np.testing.assert_allclose(outputs(other[None], alpha, 0), outputs(base[None], alpha, 0), atol=1e-13)


def test_a_cosine_law_that_is_a_linkage_is_recovered():
    """With N = D = 0 the closure is cos beta = (k0 - k1 cos alpha) / sin alpha, whatever the code says."""
    alpha = np.array([1.0, 1.4, 2.0])
    beta = np.arccos((0.15 - 0.5 * np.cos(alpha)) / np.sin(alpha))
    rows, _ = through(alpha, beta, zeros=(0.0, 0.0), samples=256)
    flat = rows[rows[:, 5] == 0]
    assert len(flat) > 20
    np.testing.assert_allclose(flat[:, 0], 0.5, atol=1e-12)
    np.testing.assert_allclose(flat[:, 1], 0.0, atol=1e-10)


def test_the_synthesis_finds_the_known_linkage_among_its_designs():
    a, b = known_pairs(7)
    found = function_generation((a, b), limits=ANY)
    assert len(found.candidates) >= 1
    errors = []
    for candidate in found.candidates:
        dimensions = candidate.draft.linkage.dimensions
        row = np.array([dimensions[name] for name in NAMES])
        errors.append(np.abs(row / row[4] - KNOWN).max())
    assert min(errors) < 1e-9


def test_chebyshevs_points_are_the_zeros_of_his_polynomial():
    x = chebyshev(-1.0, 1.0, 6)
    np.testing.assert_allclose(np.cos(6 * np.arccos(x)), 0.0, atol=1e-14)
    assert (np.diff(x) > 0).all()
    np.testing.assert_allclose(chebyshev(2.0, 4.0, 6), 3.0 + x)


def test_pairs_that_contradict_each_other_give_no_design():
    a, _ = known_pairs(7)
    rows, _ = through(a, np.full(7, 0.3))
    assert len(rows) == 0
