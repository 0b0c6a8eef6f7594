"""The RSSR paper's own case: Table 1, eq. (8) and (9), and the signs of eq. (12) and (13).

Source: Sun and Zhou, "Analytical and Computer-Aided Method for Kinematics of Spatial RSSR Mechanism", typed
in here as printed; Table 1 in references/rssr_table1.json, which tells where each number comes from.
"""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable

import mpmath as mp
import numpy as np
import pytest

import sevenbar as sb
from evidence.fuzz.random_linkages import Dimensions
from places import REFERENCES

TABLE_1 = json.loads((REFERENCES / "rssr_table1.json").read_text())

#: The unit in the last printed digit of the computed column.
LAST_DIGIT = {"angle": (1e-4, 1e-3), "velocity": (1e-3, 1e-2), "acceleration": (1e-1, 1e-2)}


def the_paper_s(D: float = 0.0, L2: float | None = None) -> sb.Linkage:
    return sb.rssr(M=700, N=700, L1=250, L3=550, D=D, L2=L2, speed="10 rad/s")


@pytest.fixture(scope="module")
def eq_8_circuit() -> sb.Circuit:
    """The circuit that the paper follows: branch 0 of the closed form."""
    (circuit,) = (c for c in the_paper_s().motion() if c.mode[0] == 0)
    return circuit


def test_the_paper_s_linkage_is_a_crank_rocker() -> None:
    motion = the_paper_s().motion()
    assert motion.motion_type == "crank-rocker"
    assert motion.limits.size == 0
    assert [c.motion_type for c in motion] == ["crank-rocker"] * 2


@pytest.mark.parametrize("quantity", ["angle", "velocity", "acceleration"])
def test_the_computed_column_of_table_1_comes_out_to_all_its_digits(
    eq_8_circuit: sb.Circuit, quantity: str
) -> None:
    extremes = getattr(eq_8_circuit, quantity)
    for got, printed, digit in zip(
        (extremes.lowest, extremes.highest), TABLE_1["computed"][quantity], LAST_DIGIT[quantity], strict=True
    ):
        assert abs(got - printed) <= digit / 2


@pytest.mark.parametrize("quantity", ["angle", "velocity", "acceleration"])
def test_the_exact_column_comes_out_to_ten_digits(eq_8_circuit: sb.Circuit, quantity: str) -> None:
    extremes = getattr(eq_8_circuit, quantity)
    # its 360001 samples are 1.7e-5 rad apart and miss a peak by up to 4e-10 of its height
    want = tuple(TABLE_1["exact"][quantity])
    assert (extremes.lowest, extremes.highest) == pytest.approx(
        want, rel=1e-9 if quantity == "acceleration" else 1e-10
    )


@pytest.mark.parametrize(("order", "quantity"), list(enumerate(["angle", "velocity", "acceleration"])))
def test_each_extreme_is_that_of_eq_8_in_forty_digits(
    eq_8_circuit: sb.Circuit, order: int, quantity: str
) -> None:
    extremes = getattr(eq_8_circuit, quantity)
    for value, at in ((extremes.lowest, extremes.lowest_at), (extremes.highest, extremes.highest_at)):
        with mp.workdps(40):
            where = mp.findroot(
                lambda a: mp.diff(lambda x: printed_eq_8(x, PAPER), a, order + 1), at, tol=1e-20
            )
            want = float(10**order * mp.diff(lambda x: printed_eq_8(x, PAPER), where, order))
        assert at == pytest.approx(float(where), abs=1e-10)
        assert value == pytest.approx(want, rel=1e-13)


@pytest.mark.parametrize("quantity", ["angle", "velocity", "acceleration"])
def test_each_extreme_occurs_where_it_is_said_to(eq_8_circuit: sb.Circuit, quantity: str) -> None:
    extremes = getattr(eq_8_circuit, quantity)
    output = the_paper_s().output([extremes.lowest_at, extremes.highest_at], order=2)
    values = {"angle": output.position, "velocity": output.velocity, "acceleration": output.acceleration}
    assert values[quantity][0] == pytest.approx([extremes.lowest, extremes.highest], rel=1e-11)


def test_the_sampled_circuit_stays_within_table_1_and_reaches_it() -> None:
    motion = the_paper_s().motion(samples=3600)
    circuit = motion.circuits[0]
    for quantity, sampled in (("angle", circuit.q), ("velocity", circuit.dq), ("acceleration", circuit.ddq)):
        low, high = TABLE_1["exact"][quantity]
        column = sampled[:, circuit.output_column]
        assert column.min() == pytest.approx(low, rel=1e-5)
        assert column.max() == pytest.approx(high, rel=1e-5)


def printed_eq_12(a: mp.mpf, b: mp.mpf, dims: Dimensions) -> mp.mpf:
    """beta' for alpha' = 1, as printed."""
    M, N, L1, L3, D = dims.M, dims.N, dims.L1, dims.L3, dims.D
    above = L1 * (M * mp.sin(a) - D * mp.cos(a) - L3 * mp.cos(a) * mp.cos(b))
    return above / (L3 * (L1 * mp.sin(a) * mp.sin(b) - D * mp.sin(b) - N * mp.cos(b)))


def printed_eq_13(a: mp.mpf, b: mp.mpf, db: mp.mpf, dims: Dimensions) -> mp.mpf:
    """beta'' for alpha' = 1, as printed but for beta^2, which must mean beta'^2."""
    M, N, L1, L3, D = dims.M, dims.N, dims.L1, dims.L3, dims.D
    Q = L1 * (M * mp.cos(a) + D * mp.sin(a) + L3 * mp.sin(a) * mp.cos(b))
    R = L3 * (L1 * mp.sin(a) * mp.sin(b) - D * mp.sin(b) - N * mp.cos(b))
    S = L3 * (L1 * mp.sin(a) * mp.cos(b) - D * mp.cos(b) + N * mp.sin(b))
    T = L1 * L3 * mp.cos(a) * mp.sin(b)
    return (Q + db**2 * S + 2 * db * T) / R


def printed_eq_8(a: mp.mpf, dims: Dimensions) -> mp.mpf:
    """beta as printed, for the L2 of eq. (7)."""
    M, N, L1, L3, D = dims.M, dims.N, dims.L1, dims.L3, dims.D
    above = mp.mpf(D) ** 2 / 2 + L1 * (M * (1 - mp.cos(a)) - D * mp.sin(a))
    y = L1 * mp.sin(a) - D
    return mp.asin(above / (L3 * mp.sqrt(mp.mpf(N) ** 2 + y**2))) - mp.atan(y / N)


def printed_eq_9(b: mp.mpf, dims: Dimensions) -> mp.mpf:
    """alpha as printed, for the L2 of eq. (7)."""
    M, N, L1, L3, D = dims.M, dims.N, dims.L1, dims.L3, dims.D
    x = L3 * mp.cos(b) + D
    above = mp.mpf(D) ** 2 / 2 + L1 * M + L3 * (D * mp.cos(b) - N * mp.sin(b))
    return mp.acos(above / (L1 * mp.sqrt(mp.mpf(M) ** 2 + x**2))) + mp.atan(x / M)


def eq_7_coupler(M: float, N: float, L1: float, L3: float) -> float:
    """The L2 that eq. (7) takes."""
    return float(np.sqrt((L1 - M) ** 2 + L3**2 + N**2))


PAPER = Dimensions(700.0, 700.0, 250.0, 550.0, 0.0, eq_7_coupler(700, 700, 250, 550))
OFFSET = Dimensions(700.0, 600.0, 250.0, 550.0, 120.0, eq_7_coupler(700, 600, 250, 550))
LOWERED = Dimensions(500.0, 700.0, 200.0, 450.0, -80.0, eq_7_coupler(500, 700, 200, 450))


@pytest.mark.parametrize("dims", [PAPER, OFFSET, LOWERED])
@pytest.mark.parametrize("alpha", [0.3, 1.7, 3.9, 5.8])
def test_eq_12_as_printed_gives_the_velocity_with_the_wrong_sign(dims: Dimensions, alpha: float) -> None:
    with mp.workdps(40):
        a, h = mp.mpf(alpha), mp.mpf(10) ** -15
        b = printed_eq_8(a, dims)
        difference = (printed_eq_8(a + h, dims) - printed_eq_8(a - h, dims)) / (2 * h)
        assert abs(printed_eq_12(a, b, dims) + difference) < 1e-25
    assert dims.linkage().output([alpha], 1).velocity[0, 0] == pytest.approx(float(difference), rel=1e-13)


@pytest.mark.parametrize("dims", [PAPER, OFFSET, LOWERED])
@pytest.mark.parametrize("alpha", [0.3, 1.7, 3.9, 5.8])
def test_eq_13_as_printed_gives_the_acceleration_with_the_wrong_sign(dims: Dimensions, alpha: float) -> None:
    with mp.workdps(40):
        a, h = mp.mpf(alpha), mp.mpf(10) ** -10
        before, b, after = (printed_eq_8(x, dims) for x in (a - h, a, a + h))
        velocity, difference = (after - before) / (2 * h), (after - 2 * b + before) / h**2
        assert abs(printed_eq_13(a, b, velocity, dims) + difference) < 1e-17
    got = dims.linkage().output([alpha], 2).acceleration[0, 0]
    assert got == pytest.approx(float(difference), rel=1e-12)


@pytest.mark.parametrize(
    ("dims", "driver", "printed"),
    [
        pytest.param(dims, driver, printed, id=f"{driver}-D{dims.D:g}")
        for dims, (driver, printed) in itertools.product(
            (PAPER, OFFSET, LOWERED), (("crank", printed_eq_8), ("rocker", printed_eq_9))
        )
    ],
)
def test_branch_0_is_eq_8_forward_and_eq_9_backward(
    dims: Dimensions, driver: str, printed: Callable[[mp.mpf, Dimensions], mp.mpf]
) -> None:
    inputs = np.linspace(-3.0, 6.0, 181)
    got = dims.linkage().output(inputs, input=driver).position[0]
    compared = 0
    for value, at in zip(got, inputs, strict=True):
        want = printed(mp.mpf(float(at)), dims)
        if isinstance(want, mp.mpc):  # the printed arcsine of more than 1: no solution
            assert np.isnan(value)
        else:
            assert value == pytest.approx(float(want), abs=1e-12)
            compared += 1
    assert compared > 30


def test_L2_left_out_is_the_distance_of_A1_and_B1() -> None:
    assert the_paper_s().lengths[1] == pytest.approx(np.sqrt(450.0**2 + 550.0**2 + 700.0**2), rel=1e-15)
    # eq. (7) keeps that length where D moves the rocker, though B1 moves along
    assert the_paper_s(D=80.0).lengths[1] == the_paper_s().lengths[1]


def test_L2_given_or_left_out_is_the_same_linkage() -> None:
    coupler = float(np.sqrt(450.0**2 + 550.0**2 + 700.0**2))
    inputs = np.linspace(0, 6, 61)
    left_out, given = (the_paper_s(L2=L2).output(inputs, 2) for L2 in (None, coupler))
    np.testing.assert_allclose(given.position, left_out.position, rtol=0, atol=1e-14)
    np.testing.assert_allclose(given.acceleration, left_out.acceleration, rtol=0, atol=1e-11)


def test_another_L2_is_another_linkage() -> None:
    shorter = the_paper_s(L2=950.0)
    assert shorter.lengths == pytest.approx((250, 950, 550))
    assert shorter.output([0.3]).position[0, 0] != pytest.approx(
        the_paper_s().output([0.3]).position[0, 0], abs=1e-3
    )


@pytest.mark.parametrize("driver", ["crank", "rocker"])
@pytest.mark.parametrize(
    "dims",
    [
        Dimensions(700.0, 0.0, 250.0, 550.0, 0.0, 800.0),
        Dimensions(0.0, 700.0, 250.0, 550.0, 0.0, 800.0),
        Dimensions(0.0, 0.0, 250.0, 550.0, 60.0, 500.0),
        Dimensions(700.0, 0.0, 250.0, 550.0, -90.0, 700.0),
        Dimensions(0.0, 700.0, 250.0, 550.0, 90.0, 900.0),
    ],
    ids=["N=0", "M=0", "M=N=0", "N=0 offset", "M=0 offset"],
)
def test_linkages_that_the_paper_excludes_solve_and_close(dims: Dimensions, driver: str) -> None:
    """Section 3.2 asks for M and N other than 0; the closure itself does not."""
    linkage, reference = dims.linkage(), dims.reference()
    inputs = np.linspace(-np.pi, np.pi, 721)
    output = linkage.output(inputs, 3, input=driver)
    reachable = reference.margin(inputs, driver)
    assert np.isfinite(output.position[:, reachable > 1e-12]).all()
    assert np.isnan(output.position[:, reachable < -1e-12]).all()
    for position in output.position:
        there = np.isfinite(position)
        assert there.sum() > 100
        crank, rocker = (inputs, position) if driver == "crank" else (position, inputs)
        assert reference.closure_error(crank[there], rocker[there]).max() < 1e-14
    motion = linkage.motion(input=driver)
    assert motion.circuits
    assert max(np.nanmax(c.residual) for c in motion) < 1e-12 * reference.size
