"""The inertia of a planar body as one number, about the axis across the plane."""

from typing import Any

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.errors import DescriptionError, RequestError
from sevenbar.kinematics.dynamics.link_bodies import across

FOUR_BAR = """
format = 1
length_unit = "m"
drive = {{ speed = "10 rad/s" }}
joint = [{{ name = "a", kind = "R", at = [0, 0, 0], axis = [0, 0, 1] }},
  {{ name = "b", kind = "R", at = [0.4, 0, 0], axis = [0, 0, 1] }},
  {{ name = "c", kind = "R", at = [0.78359375, 0.923512, 0], axis = [0, 0, 1] }},
  {{ name = "d", kind = "R", at = [0.9, 0, 0], axis = [0, 0, 1] }}]
[[body]]
link = 2
mass = 7.7
centre = [0.5, 0.4, 0]
inertia = {inertia}
"""
WHOLE = "[0.5, 0.6, 0.104271, 0, 0, 0]"


def forces_of(inertia: str) -> Any:
    return sb.loads(FOUR_BAR.format(inertia=inertia)).motion(samples=24).circuits[0].forces()


@pytest.mark.parametrize("inertia", ["0.104271", "'104271 kg mm^2'", "[0, 0, 0.104271, 0, 0, 0]"])
def test_what_is_not_about_the_axis_across_the_plane_does_not_act(inertia: str) -> None:
    # 0.05, 0.06 and 0.104271: a body that there is
    wanted = forces_of("[0.05, 0.06, 0.104271, 0, 0, 0]")
    found = forces_of(inertia)
    assert found.torque == pytest.approx(wanted.torque, rel=1e-12)
    for name in "abcd":
        own, other = (one.reactions[name].force_in_report[:, :2] for one in (found, wanted))
        assert own == pytest.approx(other, rel=1e-11, abs=1e-11)
    # a lamina's, so that exports write a body that there is
    assert np.diag(found.bodies[2].tensor) == pytest.approx([0.0521355, 0.0521355, 0.104271])


def test_python_takes_one_number_and_keeps_it_in_the_description() -> None:
    linkage = sb.four_bar(crank=40, coupler=100, rocker=80, ground=90)
    loaded = linkage.loaded(bodies={2: sb.Body(2.0, centre=(0, 30, 0), inertia=3e-3)})
    assert loaded.description["body"][0]["inertia"] == pytest.approx(3000.0)
    torque = loaded.motion(samples=12).circuits[0].forces().torque
    normal = across(linkage, 2)
    assert normal is not None
    whole = sb.Body(2.0, centre=(0, 30, 0), inertia=1.5e-3 * (np.eye(3) + np.outer(normal, normal)))
    wanted = linkage.motion(samples=12).circuits[0].forces(bodies={2: whole}).torque
    assert torque == pytest.approx(wanted, rel=1e-12)


@pytest.mark.parametrize("name", ["planar_4r", "engine"])
def test_the_axis_across_the_plane_is_that_about_which_each_link_turns(name: str) -> None:
    linkage = sb.load(name)
    circuit = linkage.motion(samples=12).circuits[0]
    for link in range(1, len(linkage.links) + 1):
        normal = across(linkage, link)
        assert normal is not None
        here, there = (circuit.point(link, tuple(at)).position for at in (np.zeros(3), normal))
        # the same direction in every pose: that of the plane
        assert np.abs((there - here) - linkage.normal).max() < 1e-9


def test_one_number_is_refused_of_a_linkage_in_space_and_about_another_axis() -> None:
    circuit = sb.load("rssr").motion(samples=12).circuits[0]
    with pytest.raises(
        RequestError, match=r"0\.1 alone says enough of a planar linkage only; give the six numbers xx yy"
    ):
        circuit.forces(bodies={1: sb.Body(1.0, centre=(0, 0, 0), inertia=0.1)})
    with pytest.raises(
        RequestError, match="no body has one greater than the sum of the others; of a planar linkage"
    ):
        circuit.forces(bodies={1: sb.Body(1.0, centre=(0, 0, 0), inertia=np.diag([0, 0, 0.1]))})
    with pytest.raises(DescriptionError, match=r"body\[1\].inertia: principal moments 0, 0, 0\.1: no body"):
        forces_of("[0.1, 0, 0, 0, 0, 0]")


@pytest.mark.parametrize(
    ("inertia", "message"),
    [
        ("-1", "inertia: -1 is not a moment of inertia; give a number >= 0"),
        ("[1, 2]", "give six numbers, xx yy zz yz xz xy of the tensor, or of a planar linkage one"),
        ("[1, 2, 4, 0, 0, 0]", "no body has one greater than the sum of the others"),
    ],
)
def test_what_is_no_inertia_is_refused_with_both_forms(inertia: str, message: str) -> None:
    with pytest.raises(DescriptionError, match=message):
        sb.loads(FOUR_BAR.format(inertia=inertia))


@pytest.mark.parametrize(
    ("inertia", "message"),
    [
        ([[1, 2], [3]], r"inertia: \[\[1, 2\], \[3\]\] is not an inertia; give 3 x 3 numbers"),
        ([[1, 0.1, 0], [0, 1, 0], [0, 0, 1]], "not symmetric; give each product of inertia twice"),
    ],
)
def test_what_is_no_tensor_is_refused_in_python(inertia: list[list[float]], message: str) -> None:
    with pytest.raises(RequestError, match=message):
        sb.Body(1.0, centre=(0, 0, 0), inertia=inertia)
