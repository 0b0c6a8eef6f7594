"""Overconstrained loops whose numbers are rounded: how nearly they move, and how they move where that is let pass.

Source: Bennett's condition a / sin(alpha) = b / sin(beta), and his law of the half tangents, which a linkage that is off
by a share of its size keeps to about that share.
"""

import io
import json
import math

import numpy as np
import pytest
from rich.console import Console

import sevenbar as sb
from command_runs import sevenbar
from sevenbar.description.draft import Draft
from sevenbar.errors import RequestError
from sevenbar.kinematics.solvers.general import AGREE
from sevenbar.reporting.report import as_dict, text

ALPHA, BETA = math.radians(30), math.radians(100)
EXACT = 50 * math.sin(BETA) / math.sin(ALPHA)


def bennett(*lengths, twists=(ALPHA, BETA) * 2):
    return sb.from_dh("RRRR", length=lengths, twist=twists, offset=[0] * 4)


def told(motion):
    console = Console(file=io.StringIO(), width=400)
    console.print(text(motion))
    return " ".join(console.file.getvalue().split())


def test_a_bennett_of_four_digits_is_rigid_and_the_report_says_how_nearly_it_moves():
    motion = bennett(*(50, 98.48) * 2).motion(72)
    assert motion.motion_type == "rigid"
    near = motion.near_motion
    assert (near.motion_type, near.agree) == ("double-crank", 1e-5)
    # half of what the lengths are off is left to each of the two links
    assert near.miss == pytest.approx(5.05e-4, rel=0.01)
    assert near.share == pytest.approx(near.miss / (2 * (50 + 98.48)), rel=1e-9)
    report = told(motion)
    assert (
        "nearly moves as a double-crank: redundant constraints miss by up to 1.7e-06 of the size (0.0005 mm)"
        in report
    )
    assert "--agree 1e-05 takes them to agree" in report
    assert as_dict(motion)["near_motion"] == vars(near)


@pytest.mark.parametrize(("b", "agree"), [(98.48, 1e-5), (98.4808, 1e-6), (98.5, 1e-4), (98.48, 1e-3)])
def test_with_what_is_let_pass_it_turns_by_bennett_s_law_and_says_the_closure_error(b, agree):
    motion = bennett(*(50, b) * 2).motion(72, agree=agree)
    (circuit,) = motion.circuits
    assert (circuit.motion_type, circuit.turns, circuit.closed) == ("double-crank", 1, True)
    off = abs(b - EXACT)
    assert 0.1 * off < circuit.residual.max() < 2 * off
    ratio = math.sin((BETA + ALPHA) / 2) / math.sin((BETA - ALPHA) / 2)
    first, second = circuit.q[:, 0] / 2, circuit.q[:, 1] / 2
    law = np.sin(first) * np.sin(second) - ratio * np.cos(first) * np.cos(second)
    assert np.abs(law).max() < 20 * off / (50 + 98.48)
    report = told(motion)
    assert f"closure error at most {circuit.residual.max():.1e} mm" in report
    assert f"redundant constraints are taken to agree up to {agree:.0e}, by request" in report
    assert as_dict(motion)["agree"] == agree
    assert motion.near_motion is None


@pytest.mark.parametrize("seed", range(12))
def test_a_bennett_whose_four_lengths_are_cut_to_a_hundredth_of_a_millimetre_moves_where_that_is_let_pass(
    seed,
):
    rng = np.random.default_rng(seed)
    lengths = np.round(np.array([50, EXACT] * 2) + rng.uniform(-0.01, 0.01, 4), 2)
    linkage = bennett(*lengths)
    near = linkage.motion(72).near_motion
    assert near is not None
    motion = linkage.motion(72, agree=near.agree)
    assert motion.motion_type == near.motion_type == "double-crank"
    assert near.miss < 0.06


def test_the_exact_one_is_the_same_whatever_is_let_pass():
    linkage = bennett(*(50, EXACT) * 2)
    plain = linkage.motion(72)
    assert (plain.agree, plain.near_motion) == (AGREE, None)
    for agree in (1e-12, 1e-7, 1e-3):
        motion = linkage.motion(72, agree=agree)
        np.testing.assert_allclose(motion.circuits[0].q, plain.circuits[0].q, atol=1e-11)
        assert motion.circuits[0].residual.max() < 1e-11


def test_modes_circuit_and_mobility_take_it_too():
    linkage = bennett(*(50, 98.48) * 2)
    assert len(linkage.assembly_modes("30 deg")) == 0
    modes = linkage.assembly_modes("30 deg", agree=1e-5)
    assert len(modes) == 1
    assert 1e-5 < modes.residual[0] < 1e-3
    assert linkage.circuit(modes.q[0], 36, agree=1e-5).motion_type == "double-crank"
    with pytest.raises(RequestError):
        linkage.circuit(modes.q[0], 36)
    assert (linkage.mobility().finite, linkage.mobility(agree=1e-5).finite) == (0, 1)


def test_a_truss_does_not_nearly_move():
    rng = np.random.default_rng(3)
    linkage = sb.from_dh("RRRR", length=rng.uniform(1, 2, 4), twist=rng.uniform(1, 2, 4), offset=[0] * 4)
    motion = linkage.motion(24)
    assert motion.circuits == ()
    assert motion.near_motion is None
    assert "nearly moves" not in told(motion)


def test_a_loop_without_redundant_constraints_is_as_it_was():
    linkage = sb.load("rscr")
    one, other = (linkage.motion(36, agree=agree) for agree in (None, 1e-4))
    assert [c.motion_type for c in one] == [c.motion_type for c in other]
    for a, b in zip(one, other, strict=True):
        np.testing.assert_allclose(a.q, b.q, atol=1e-9, equal_nan=True)
    closed = sb.load("rssr").motion(36, agree=1e-4)
    assert closed.completeness == "closed-form"


@pytest.mark.parametrize("bad", [0, -1e-5, 2e-3, math.nan, math.inf, True, "1e-5"])
def test_what_can_be_let_pass_has_bounds(bad):
    with pytest.raises(RequestError, match=r"^agree: .* is not a closure error; give 1e-12 to 0\.001"):
        sb.load("bennett").motion(24, agree=bad)


def test_dimensions_of_an_overconstrained_loop_are_printed_to_the_last_digit():
    for b in (98.48, 98.4808, EXACT):
        assert f" {b!r} " in told(bennett(*(50, b) * 2).motion(24))
    # of any other six digits are enough
    assert "98.48077530122082" not in told(sb.load("seven_r").motion(24))


def test_the_commands_take_it(tmp_path):
    file = tmp_path / "own.toml"
    file.write_text(Draft.of_linkage(bennett(*(50, 98.48) * 2)).toml())
    report = json.loads(sevenbar("analyze", file, "--agree", "1e-5", "--json").stdout)
    assert (report["motion_type"], report["agree"]) == ("double-crank", 1e-5)
    plain = json.loads(sevenbar("analyze", file, "--json").stdout)
    assert (plain["motion_type"], plain["near_motion"]["agree"]) == ("rigid", 1e-5)
    assert json.loads(sevenbar("modes", file, "--agree", "1e-5", "--json").stdout)["count"] == 1
    done = sevenbar("analyze", file, "--agree", "1")
    assert done.returncode == 2
    assert done.stderr.startswith("sevenbar: --agree: 1.0 is not a closure error; give 1e-12 to 0.001")
    sevenbar("export", file, "--agree", "1e-5", "--out", tmp_path / "own.csv")
    assert (tmp_path / "own.csv").is_file()


def test_what_is_nearly_a_surface_of_poses_is_followed_twice_and_the_rest_is_counted():
    # the last twist is a billionth of a degree; at zero the loop moves with two freedoms
    rows = {
        "length": [1, 0, 10, 10, 0, 0.5, 0, 1],
        "twist": np.radians([0, -90, 90, -90, 180, 45, 45, 1e-9]),
        "offset": [1, None, None, 0.5, 2, 0.5, 0, 0],
        "angle": [None, *np.radians([-90, 180]), None, None, None, None, None],
    }
    motion = sb.from_dh("RPPRRRRR", **rows).motion()
    assert [circuit.closed for circuit in motion] == [False, False]
    assert motion.search.unfollowed > 0
