"""Four bilinear forms vanish together at six pairs of points: by eigenvalues, by resultants, to 40 digits."""

import itertools

import mpmath
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sevenbar.design.exact.bilinear import cubic_of, on_cubic, partner, solutions
from sevenbar.kinematics.loop.rigid import about


def residual(forms, a, b):
    """The greatest `|a^T T_k b|` relative to the forms (k, 3, 3) and the points (3,)."""
    sizes = np.linalg.norm(forms, axis=(1, 2)) * np.linalg.norm(a) * np.linalg.norm(b)
    return float((np.abs(np.einsum("i,kij,j->k", a, forms, b)) / np.where(sizes > 0, sizes, 1.0)).max())


def spherical_forms(seed):
    """The forms `R_k - 1` (4, 3, 3) of four random orientations."""
    return Rotation.random(5, random_state=np.random.default_rng(seed)).as_matrix()[1:] - np.eye(3)


def test_a_hundred_random_tasks_have_six_solutions_each_and_an_even_number_of_real_ones():
    for seed in range(100):
        forms = spherical_forms(seed)
        result = solutions(forms)
        assert result.multiplicity.tolist() == [1] * 6
        assert result.real.sum() % 2 == 0
        assert max(residual(forms, a, b) for a, b in zip(result.a, result.b, strict=True)) < 1e-13


@pytest.mark.parametrize("seed", range(3))
def test_two_of_the_cubics_meet_in_nine_points_three_of_which_are_poles(seed):
    """9 = 6 + 3: where the two rows that both minors share depend on each other, the third need not."""
    forms = spherical_forms(seed)
    with mpmath.workdps(40):
        rows = [[[mpmath.mpf(x) for x in row] for row in form] for form in forms.tolist()]
        minor = {last: lambda x, y, last=last: det(rows, (0, 1, last), x, y) for last in (2, 3)}
        # the resultant by y at ten places of x, a polynomial of degree nine
        places = [mpmath.mpf(k) / 4 for k in range(-5, 5)]
        heights = [resultant(minor[2], minor[3], x) for x in places]
        roots = mpmath.polyroots(interpolated(places, heights), maxsteps=300, extraprec=200)
        assert len(roots) == 9
        ours = [complex(b[0] / b[2]) for b in solutions(forms).b]
        remaining = [complex(r) for r in roots]
        for x in ours:
            nearest = min(remaining, key=lambda r: abs(r - x))
            assert abs(nearest - x) < 1e-9 * (1 + abs(x))
            remaining.remove(nearest)
    # the other three are the poles: the axes of the rotations between the three orientations of both minors
    first, second = forms[0] + np.eye(3), forms[1] + np.eye(3)
    poles = [Rotation.from_matrix(turn).as_rotvec() for turn in (first, second, first.T @ second)]
    assert sorted(p[0] / p[2] for p in poles) == pytest.approx(sorted(r.real for r in remaining), rel=1e-9)


def det(rows, which, x, y):
    """The minor of three of the forms, `det (T_k b)` with b = (x, y, 1)."""
    n = [[r[0] * x + r[1] * y + r[2] for r in rows[k]] for k in which]
    return (
        n[0][0] * (n[1][1] * n[2][2] - n[1][2] * n[2][1])
        - n[0][1] * (n[1][0] * n[2][2] - n[1][2] * n[2][0])
        + n[0][2] * (n[1][0] * n[2][1] - n[1][1] * n[2][0])
    )


def cubic_in_y(minor, x):
    """Coefficients of a minor at x, a polynomial of degree three in y."""
    places = [mpmath.mpf(k) for k in (-1, 0, 1, 2)]
    return interpolated(places, [minor(x, y) for y in places])


def resultant(first, second, x):
    """The determinant of Sylvester's matrix, zero where both minors are zero at one y."""
    p, q = cubic_in_y(first, x), cubic_in_y(second, x)
    sylvester = mpmath.zeros(6)
    for i in range(3):
        for k in range(4):
            sylvester[i, i + k], sylvester[3 + i, i + k] = p[k], q[k]
    return mpmath.det(sylvester)


def interpolated(places, heights):
    """Coefficients, the highest first, of the polynomial through these points."""
    size = len(places)
    sides = mpmath.matrix(size)
    for i, x in enumerate(places):
        for k in range(size):
            sides[i, k] = x ** (size - 1 - k)
    return list(mpmath.lu_solve(sides, mpmath.matrix(heights)))


@pytest.mark.parametrize("seed", range(3))
def test_newton_in_40_digits_keeps_six_different_solutions(seed):
    forms = spherical_forms(seed)
    result = solutions(forms)
    with mpmath.workdps(40):
        exact = [[[mpmath.mpf(x) for x in row] for row in form] for form in forms.tolist()]
        ends = []
        for a, b in zip(result.a, result.b, strict=True):
            # charts in which both points are finite
            i, j = int(np.abs(a).argmax()), int(np.abs(b).argmax())
            others = [k for k in range(3) if k != i], [k for k in range(3) if k != j]
            start = [complex(a[k] / a[i]) for k in others[0]] + [complex(b[k] / b[j]) for k in others[1]]

            def equations(*u, others=others):
                p, q = [mpmath.mpf(1)] * 3, [mpmath.mpf(1)] * 3
                p[others[0][0]], p[others[0][1]], q[others[1][0]], q[others[1][1]] = u
                pairs = list(itertools.product(range(3), range(3)))
                return [sum(p[r] * form[r][c] * q[c] for r, c in pairs) for form in exact]

            end = mpmath.findroot(equations, start, tol=1e-60)
            assert max(abs(e) for e in equations(*end)) < mpmath.mpf("1e-36")
            assert max(abs(complex(e) - s) for e, s in zip(end, start, strict=True)) < 1e-11
            point = np.zeros(3, complex)
            point[j], point[others[1]] = 1.0, [complex(end[2]), complex(end[3])]
            ends.append(point / np.linalg.norm(point))
        apart = [1 - abs(np.vdot(p, q)) for p, q in itertools.combinations(ends, 2)]
        assert min(apart) > 1e-9


def test_points_on_the_cubic_have_a_partner_that_three_forms_make_zero():
    forms = spherical_forms(7)[:3]
    points = on_cubic(forms, np.array([1.0, 0.2, -0.3]), np.array([0.1, 1.0, 0.4]))
    assert len(points) in (1, 3)
    for b in points:
        assert residual(forms, partner(forms, b), b) < 1e-14
        assert abs(np.linalg.det(forms @ b)) < 1e-13


def test_the_cubic_of_three_forms_is_their_determinant():
    forms, b = spherical_forms(3)[:3], np.array([0.3, -1.2, 0.7])
    monomials = [m for m in itertools.product(range(4), repeat=3) if sum(m) == 3]
    value = cubic_of(forms) @ np.prod(b ** np.array(monomials), axis=1)
    assert value == pytest.approx(np.linalg.det(forms @ b), abs=1e-14)


def test_forms_with_a_curve_of_solutions_have_no_list_of_them():
    assert solutions(np.array([about(2, x) - np.eye(3) for x in (0.3, 0.6, 0.9, 1.2)])) is None


def test_a_double_solution_counts_twice():
    back = (about(0, 0.4) @ about(2, -0.6)).T
    turns = np.array([about(0, 0.1 * i * i) @ about(2, 0.3 * i) for i in (-1, 0, 1, 2)]) @ back
    result = solutions(turns - np.eye(3))
    assert sorted(result.multiplicity.tolist()) == [1, 1, 1, 1, 2]
    assert result.real.sum() == 3
