"""Links that rods alone hold: where they are is part of a mode, of every row, and may be the output."""

from __future__ import annotations

import math
import pickle

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.description.forms import from_description
from sevenbar.errors import DescriptionError, RequestError
from sevenbar.kinematics.circuits.poses import poses

#: A suspension whose wheel carrier hangs on five rods; a sixth pushes a rocker, which drives.
ROCKER = {
    "name": "rocker",
    "kind": "R",
    "at": [0, 300, 600],
    "axis": [1, 0, 0],
    "between": ["frame", "rocker"],
}
RODS = {
    "push rod": ([0, 400, 620], [0, 600, 200]),
    "front lower rod": ([150, 330, 190], [50, 660, 180]),
    "rear lower rod": ([-190, 340, 200], [-60, 665, 185]),
    "front upper rod": ([120, 420, 430], [25, 640, 440]),
    "rear upper rod": ([-160, 430, 420], [-45, 635, 435]),
    "track rod": ([-250, 380, 250], [-150, 660, 260]),
}
POINT = {"name": "wheel centre", "link": "wheel carrier", "at": [0, 740, 310]}

#: As drawn.
STILL = np.eye(3)


def suspension(turn=STILL, shift=(0.0, 0.0, 0.0), leg=""):
    """The suspension, moved; with one of its rods as a link on a universal joint and a ball."""

    def moved(v):
        return [float(x) for x in turn @ np.array(v, dtype=float) + np.array(shift)]

    def turned(v):
        return [float(x) for x in np.linalg.det(turn) * turn @ np.array(v, dtype=float)]

    joints = [{**ROCKER, "at": moved(ROCKER["at"]), "axis": turned(ROCKER["axis"])}]
    rods = []
    for name, ends in RODS.items():
        on, other = (["rocker"] if name == "push rod" else ["frame"]), "wheel carrier"
        if name == leg:
            # square to each other and to the leg, so that it points anywhere
            across = np.cross(np.subtract(*ends), [0.0, 0.0, 1.0])
            axes = [turned(axis) for axis in ([0, 0, 1], across)]
            joints += [
                {
                    "name": f"{name} cross",
                    "kind": "U",
                    "at": moved(ends[0]),
                    "axes": axes,
                    "between": [*on, name],
                },
                {"name": f"{name} ball", "kind": "S", "at": moved(ends[1]), "between": [name, other]},
            ]
        else:
            rods.append({"name": name, "between": [*on, other], "at": [*map(moved, ends)]})
    point = {**POINT, "at": moved(POINT["at"])}
    return sb.from_axes(joints, rods=rods, points=[point], ground="frame", drive="rocker")


def carrier(linkage, q):
    """The poses of the wheel carrier, ranked by where it is."""
    frames = poses(linkage, q)[:, linkage.link_names.index("wheel carrier")]
    return frames[np.lexsort(frames[:, :3, 3].round(6).T)]


def test_modes_say_where_the_link_is():
    linkage = suspension()
    assert linkage.columns == ("rocker", *(f"wheel carrier.{k}" for k in range(1, 7)))
    assert [linkage.turns(column) for column in linkage.columns] == [True, *[False] * 3, *[True] * 3]
    modes = linkage.assembly_modes("20 deg")
    assert (len(modes), modes.completeness) == (6, "algebraic")
    frames = poses(linkage, modes.q)
    assert np.isfinite(frames).all()
    for rod in linkage.rods:
        ends = [frames[:, link - 1] @ [*end, 1.0] for link, end in zip(rod.between, rod.at, strict=True)]
        lengths = np.linalg.norm(ends[0] - ends[1], axis=1)
        assert np.abs(lengths - math.dist(*rod.at)).max() < 1e-9
    # no two are one pose
    assert len(np.unique(frames[:, linkage.link_names.index("wheel carrier"), :3, 3].round(6), axis=0)) == 6


@pytest.mark.parametrize("leg", ["track rod", "push rod", "front upper rod"])
def test_the_same_with_a_leg_in_place_of_a_rod(leg):
    plain, other = suspension(), suspension(leg=leg)
    for value in (0.0, 0.3, -0.4):
        ours, theirs = (carrier(one, one.assembly_modes(value).q) for one in (plain, other))
        # each pose twice, for the cross turns over
        assert np.abs(np.repeat(ours, 2, axis=0) - theirs).max() < 1e-7


def test_turned_mirrored_and_shifted():
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    plain = carrier(suspension(), suspension().assembly_modes(0.2).q)
    for moved in (turn, -turn):
        shift = np.array([300.0, -200.0, 50.0])
        other = suspension(moved, shift)
        frames = carrier(other, other.assembly_modes(0.2).q)
        back = frames.copy()
        back[:, :3, :3] = moved.T @ frames[:, :3, :3] @ moved
        # x -> R x + p as drawn in the turned frame
        at = frames[:, :3, 3] + frames[:, :3, :3] @ shift - shift
        back[:, :3, 3] = at @ moved
        back = back[np.lexsort(back[:, :3, 3].round(6).T)]
        assert np.abs(back - plain).max() < 1e-7


def test_every_row_says_where_it_is_and_how_it_moves():
    linkage = suspension()
    motion = linkage.motion(256)
    assert len(motion) == 5
    column = linkage.columns.index("wheel carrier.3")
    for circuit in motion:
        frames = poses(linkage, circuit.q)[:, linkage.link_names.index("wheel carrier")]
        place = (frames @ [*POINT["at"], 1.0])[:, :3]
        assert np.abs(place - circuit.point("wheel centre").position).max() < 1e-9
        if circuit.goes_round:
            # one turn is periodic: derivatives of its Fourier series
            orders = np.fft.fftfreq(256, 1 / 256) * 1j
            waves = np.fft.fft(circuit.q[:, column])
            for order, rates in enumerate((circuit.dq, circuit.ddq, circuit.dddq), 1):
                expected = np.fft.ifft(waves * orders**order).real
                assert np.abs(rates[:, column] - expected).max() < 1e-7 * np.abs(expected).max()


def test_where_it_is_may_be_the_output():
    # the rocker is the only joint: the height is the output without a word
    linkage = suspension()
    assert linkage.drive.output == "wheel carrier.3"
    across = from_description(
        {**linkage.description, "drive": {"joint": "rocker", "output": "wheel carrier.2"}}
    )
    assert across.drive.output == "wheel carrier.2"
    ours, theirs = linkage.motion(90, output="wheel carrier.2"), across.motion(90)
    assert [c.output_range for c in ours] == [c.output_range for c in theirs]
    for circuit in theirs:
        # rows lie on the range, and nearly reach its ends
        low, high = circuit.output_range
        assert low - 1e-9 <= circuit.output.min() <= circuit.output.max() <= high + 1e-9
        assert circuit.output.max() - circuit.output.min() > 0.99 * (high - low)


def test_a_hinge_between_two_links_on_rods():
    # the carrier in two parts, hinged: one rod more holds it
    joints = [
        ROCKER,
        {"name": "hinge", "kind": "R", "at": [0, 640, 440], "axis": [1, 2, 3], "between": ["upper", "lower"]},
    ]
    rods = [
        {
            "name": name,
            "between": ["rocker" if name == "push rod" else "frame", "upper" if "upper" in name else "lower"],
            "at": [*map(list, ends)],
        }
        for name, ends in RODS.items()
    ]
    rods.append({"name": "seventh", "between": ["frame", "upper"], "at": [[0, 410, 500], [10, 600, 520]]})
    linkage = sb.from_axes(joints, rods=rods, ground="frame", drive="rocker")
    assert linkage.drive.output == "hinge"
    assert linkage.mobility().finite == 1
    modes = linkage.assembly_modes(0.05)
    frames = poses(linkage, modes.q)
    numbers = [linkage.link_names.index(link) for link in ("upper", "lower")]
    assert len(modes) >= 1
    assert np.isfinite(frames).all()
    on_both = frames[:, numbers] @ [0, 640, 440, 1.0]
    assert np.abs(on_both[:, 0] - on_both[:, 1]).max() < 1e-6


def test_the_link_has_a_name_of_its_own_beside_a_joint_of_that_name():
    rods = [
        {
            "name": name,
            "between": ["crank" if name == "push rod" else "frame", "rocker"],
            "at": [*map(list, ends)],
        }
        for name, ends in RODS.items()
    ]
    linkage = sb.from_axes([{**ROCKER, "between": ["frame", "crank"]}], rods=rods, ground="frame")
    assert linkage.columns[:2] == ("rocker", "link rocker.1")
    assert linkage.drive.output == "link rocker.3"


def test_wrong_ends_are_named():
    linkage = suspension()
    with pytest.raises(
        RequestError, match=r"'wheel carrier.2' is where a link on rods alone is; give a joint: rocker"
    ):
        linkage.motion(90, input="wheel carrier.2")
    with pytest.raises(RequestError, match=r"'wheel carrier' is a link.*rocker, wheel carrier.1, "):
        linkage.motion(90, output="wheel carrier")
    with pytest.raises(RequestError, match=r"'wheel carrier.5' is where"):
        linkage.motion(90, output="wheel carrier.5")
    with pytest.raises(DescriptionError, match=r"drive.output: no joint 'wheel carrier.6'.*wheel carrier.3"):
        from_description({**linkage.description, "drive": {"output": "wheel carrier.6"}})
    joints = [
        ROCKER,
        {"name": "ball", "kind": "S", "at": [0, 600, 200], "between": ["rocker", "wheel carrier"]},
    ]
    rods = [
        {"name": name, "between": ["frame", "wheel carrier"], "at": [*map(list, RODS[name])]}
        for name in list(RODS)[1:4]
    ]
    with pytest.raises(DescriptionError, match=r"a net R S has one freedom outside its balls"):
        sb.from_axes(joints, rods=rods, ground="frame")


def test_it_is_pickled_and_drawn():
    linkage = pickle.loads(pickle.dumps(suspension()))
    motion = linkage.motion(90)
    figure = sb.plot.joints(motion)
    labels = [axes.get_ylabel() for axes in figure.axes]
    assert any("wheel carrier.1 position" in label.replace("\n", " ") for label in labels)
    sb.plot.configuration(motion)
