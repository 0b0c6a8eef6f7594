"""Inputs at which a whole curve of poses closes: the modes there say so, and elsewhere they do not."""

from math import pi, radians

import numpy as np
import pytest

import sevenbar as sb
from command_runs import sevenbar
from sevenbar.reporting.report import modes_json


def planar(*lengths: float) -> sb.Linkage:
    return sb.from_dh("RRRR", length=list(lengths), twist=[0] * 4, offset=[0] * 4)


def spherical(*arcs: float) -> sb.Linkage:
    return sb.from_dh("RRRR", length=[0] * 4, twist=[radians(a) for a in arcs], offset=[0] * 4)


def planar_gap(lengths: tuple[float, ...], q: np.ndarray) -> float:
    """How far a chain of links in the plane is from closing [length, or rad], by complex numbers."""
    turned = np.cumsum(q)
    return float(np.hypot(abs((np.array(lengths) * np.exp(1j * turned)).sum()), np.sin(turned[-1] / 2)))


# folded flat the pins of crank and rocker are one, so coupler and rocker turn about it: any kite with the crank as long as the ground
FOLDED = [(1, 1, 1, 1), (1, 2.6, 2.6, 1), (0.1, 0.3, 0.3, 0.1), (2.6, 2.6, 2.6, 2.6)]


@pytest.mark.parametrize("lengths", FOLDED, ids=str)
def test_a_kite_folded_flat_closes_along_a_curve_and_says_so(lengths: tuple[float, ...]) -> None:
    linkage = planar(*lengths)
    modes = linkage.assembly_modes(pi)
    assert modes.on_curve is not None
    assert modes.on_curve[0] == pytest.approx(pi) or modes.on_curve[0] == pytest.approx(-pi)
    assert planar_gap(lengths, modes.on_curve) < 1e-9
    assert "a curve of poses closes here" in str(modes)
    assert '"on_curve": [' in modes_json(linkage, modes, 0)


def test_its_pose_is_one_of_many() -> None:
    lengths = (1, 2.6, 2.6, 1)
    pose = planar(*lengths).assembly_modes(pi).on_curve
    assert pose is not None
    # coupler and rocker turn together about the pin that they share with the ground
    for more in (0.1, 1.0, 2.0):
        assert planar_gap(lengths, pose + np.array([0, more, 0, -more])) < 1e-9


def test_a_spherical_four_bar_of_right_angles_has_a_curve_at_both_ends() -> None:
    linkage = spherical(90, 90, 90, 90)
    for value in (0.0, pi):
        assert linkage.assembly_modes(value).on_curve is not None
    assert linkage.assembly_modes(0.7).on_curve is None


@pytest.mark.parametrize("off", [1e-9, 1e-6, 1e-3, 0.3])
@pytest.mark.parametrize("lengths", FOLDED, ids=str)
def test_next_to_it_both_modes_stand_alone(lengths: tuple[float, ...], off: float) -> None:
    modes = planar(*lengths).assembly_modes(pi - off)
    assert len(modes) == 2
    assert modes.on_curve is None
    assert "all modes are found" in str(modes)


@pytest.mark.parametrize(
    "lengths",
    [(1, 2, 1, 2), (2, 1, 2, 1), (1, 2.6, 2.4, 0.8), (3, 1, 1, 1), (1, 2.5, 2, 1.5), (2, 3, 2.5, 1), (1, 1, 1, 2.6)],
    ids=str,
)  # fmt: skip
def test_neither_dead_centres_nor_change_points_are_curves(lengths: tuple[float, ...]) -> None:
    linkage = planar(*lengths)
    motion = linkage.motion(24)
    for value in [*motion.limits, *motion.change_point_inputs, 0.0, pi]:
        assert linkage.assembly_modes(float(value)).on_curve is None


@pytest.mark.parametrize("name", ["rsur", "rscr", "seven_r", "bennett", "rccc", "rssp", "bricard_plane"])
def test_loops_in_space_have_none_at_their_limits(name: str) -> None:
    linkage = sb.load(name)
    for value in [*linkage.motion(24).limits[:4], 0.3]:
        assert linkage.assembly_modes(float(value)).on_curve is None


def test_the_command_says_so_in_both_languages(tmp_path) -> None:
    file = tmp_path / "rhombus.toml"
    file.write_text("format = 1\n" + "[[link]]\njoint = 'R'\nlength = 1\ntwist = 0\n" * 4, encoding="utf-8")
    assert "a curve of poses closes here" in sevenbar("modes", file, "--at", "180deg").stdout
    assert "位形曲线" in sevenbar("modes", file, "--at", "180deg", "--lang", "zh").stdout
