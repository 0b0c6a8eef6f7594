"""The nets of the gallery: each has its source, closes as drawn with one freedom, and has the modes of circles by hand."""

from __future__ import annotations

import cmath
import math
import re

import numpy as np
import pytest
from matplotlib.patches import Polygon

import sevenbar as sb
from command_runs import mistake
from sevenbar.description import gallery
from sevenbar.drawing.skeleton_figure import skeleton
from sevenbar.kinematics.circuits.poses import poses
from sevenbar.reporting.drawn import drawn_of

#: How many blocks each is solved in, and whether all are dyads.
NETS = {
    "watt": (2, True),
    "stephenson": (2, True),
    "klann": (2, True),
    "jansen": (3, True),
    "peaucellier": (3, True),
    "tandem_wiper": (2, True),
    "double_wishbone": (1, False),
    "five_rod": (1, False),
    "rssr_ss": (1, False),
    "platform": (1, False),
}

#: The steps of a pose by hand, where `crank pin` is known: a place that circles about two others give, or one
#: of a link, carried with two others of it.
BY_CIRCLES = {
    "stephenson": [
        ("circles", "knee", "crank pin", "rocker"), ("carried", "coupler point", "crank pin", "knee"),
        ("circles", "elbow", "coupler point", "lever"),
    ],
    "klann": [
        ("circles", "elbow", "crank pin", "short rocker"), ("carried", "knee", "crank pin", "elbow"),
        ("circles", "hip", "knee", "long rocker"),
    ],
    "jansen": [
        ("circles", "shoulder", "crank pin", "axle"), ("circles", "knee", "crank pin", "axle"),
        ("carried", "hip", "axle", "shoulder"), ("circles", "ankle", "hip", "knee"),
    ],
    "peaucellier": [
        ("circles", "left corner", "pivot O", "corner P"), ("circles", "right corner", "pivot O", "corner P"),
        ("circles", "corner Q", "left corner", "right corner"),
    ],
    "tandem_wiper": [
        ("circles", "driver's pin", "crank pin", "driver's arm"), ("carried", "driver's second pin", "driver's arm", "driver's pin"),
        ("circles", "passenger's pin", "driver's second pin", "passenger's arm"),
    ],
}  # fmt: skip


def test_the_ten_nets_are_all_that_there_are_and_no_loop_is_among_them():
    assert sorted(NETS) == list(gallery.nets())
    assert len(NETS) == 10
    assert all(sb.load(name).net is not None for name in gallery.nets())
    assert all(sb.load(name).net is None for name in gallery.loops())
    assert gallery.names() == (*gallery.loops(), *gallery.nets())


@pytest.mark.parametrize("name", NETS)
def test_a_net_names_its_source_closes_as_drawn_and_has_one_freedom(name):
    linkage = sb.load(name)
    remarks = re.match(r"(?:#.*\n)+", gallery.text(name))
    assert re.search(r"\((?:17|18|19|20)\d\d\)", remarks[0]), "a source with its year"
    mobility = linkage.mobility()
    assert (mobility.finite, drawn_of(linkage, linkage.input_column(), mobility).word) == (1, "regular")
    assert len(mobility.idle) == len(linkage.rods)
    count, dyads = NETS[name]
    blocks = linkage.order.blocks
    assert len(blocks) == count
    assert all(block.solver == "dyad" for block in blocks) == dyads


def drawn_places(linkage):
    return {pin.get("name", ""): complex(*pin["at"]) for pin in linkage.description["pin"]}


def by_circles(name, linkage, angle):
    """All poses by hand: the places of the pins at a turn of the crank from the drawing [rad]."""
    drawn = drawn_places(linkage)
    hub, pin = ("crank", "corner P" if "corner P" in drawn else "crank pin")
    hub = "motor" if "motor" in drawn else hub
    start = {key: place for key, place in drawn.items() if place in linkage_ground(linkage)}
    start[pin] = drawn[hub] + (drawn[pin] - drawn[hub]) * cmath.exp(1j * angle)
    found = [start]
    for kind, new, a, b in BY_CIRCLES[name]:
        further = []
        for pose in found:
            if kind == "carried":
                turn = (pose[b] - pose[a]) / (drawn[b] - drawn[a])
                further.append(pose | {new: pose[a] + turn * (drawn[new] - drawn[a])})
                continue
            one, two, line = abs(drawn[new] - drawn[a]), abs(drawn[new] - drawn[b]), pose[b] - pose[a]
            # two corners in one place leave the rest free: a curve of poses, and no mode
            if abs(line) < 1e-9:
                continue
            along = (one**2 - two**2 + abs(line) ** 2) / (2 * abs(line))
            if one**2 < along**2:
                continue
            side = 1j * math.sqrt(one**2 - along**2)
            further += [pose | {new: pose[a] + (along + sign * side) * line / abs(line)} for sign in (1, -1)]
        found = further
    return found


def linkage_ground(linkage):
    return [complex(*pin["at"]) for pin in linkage.description["pin"] if "frame" in pin["links"]]


@pytest.mark.parametrize("name", BY_CIRCLES)
@pytest.mark.parametrize("angle", [-2.1, -0.3, 0.0, 0.7, 1.9])
def test_modes_are_those_of_circles_by_hand(name, angle):
    linkage = sb.load(name)
    modes = linkage.assembly_modes(angle)
    frames = poses(linkage, modes.q)
    drawn = drawn_places(linkage)
    names = [new for _, new, _, _ in BY_CIRCLES[name]]
    carriers = {pin["name"]: linkage.link_names.index(pin["links"][0]) for pin in linkage.description["pin"]}
    places = np.array([
        [frames[i, carriers[new]] @ [drawn[new].real, drawn[new].imag, 0, 1] for new in names] for i in range(len(modes))
    ]).reshape(len(modes), len(names), 4)  # fmt: skip
    got = places[..., 0] + 1j * places[..., 1]
    want = np.array([[pose[new] for new in names] for pose in by_circles(name, linkage, angle)]).reshape(
        -1, len(names)
    )
    assert len(got) == len(want)
    for row in want:
        assert np.abs(got - row).max(axis=1).min(initial=1.0) < 1e-9 * linkage.size


def test_jansens_leg_has_his_numbers():
    p = drawn_places(sb.load("jansen"))
    foot = complex(*sb.load("jansen").points[0].at[:2])
    lengths = {
        ("axle", "shoulder"): 41.5, ("axle", "knee"): 39.3, ("axle", "hip"): 40.1, ("shoulder", "hip"): 55.8,
        ("hip", "ankle"): 39.4, ("knee", "ankle"): 36.7, ("crank pin", "shoulder"): 50, ("crank pin", "knee"): 61.9,
        ("crank", "crank pin"): 15,
    }  # fmt: skip
    for (a, b), length in lengths.items():
        assert abs(p[a] - p[b]) == pytest.approx(length, abs=2e-4)
    assert abs(p["ankle"] - foot) == pytest.approx(65.7, abs=2e-4)
    assert abs(p["knee"] - foot) == pytest.approx(49, abs=2e-4)
    assert p["axle"] == -38 - 7.8j


def test_klanns_leg_has_the_numbers_of_the_patent():
    linkage = sb.load("klann")
    p = drawn_places(linkage) | {"foot": complex(*linkage.points[0].at[:2])}
    lengths = {
        ("crank", "crank pin"): 26.8, ("crank pin", "elbow"): 59, ("elbow", "knee"): 52.2, ("crank pin", "knee"): 110.5,
        ("elbow", "short rocker"): 32.1, ("hip", "long rocker"): 51.8, ("hip", "knee"): 89.7, ("knee", "foot"): 89.7,
        ("hip", "foot"): 173.2,
    }  # fmt: skip
    for (a, b), length in lengths.items():
        assert abs(p[a] - p[b]) == pytest.approx(length, abs=2e-4)


def test_peaucelliers_corner_goes_on_a_straight_line():
    linkage = sb.load("peaucellier")
    link = linkage.link_names.index("left outer side")
    for angle in (-1.2, -0.5, 0.4, 1.1):
        frames = poses(linkage, linkage.assembly_modes(angle).q)
        ends = (frames[:, link] @ [80, 0, 0, 1])[:, :2]
        corner = 30 + 30 * np.array([math.cos(angle), math.sin(angle)]) * [1, 1] - [0, 30]
        # the corner Q is at x = 80, or folded onto P
        folded = np.abs(ends - corner).max(axis=1) < 1e-9
        assert np.abs(ends[~folded, 0] - 80).max() < 1e-9
        assert (~folded).sum() == 2


@pytest.mark.parametrize(
    "words",
    [
        "calibrate watt examples/rssr_bench.csv",
        "design inertia watt --mass P=1",
        "design path watt --path examples/coupler_curve.csv --link 2 --at 0,0,0",
        "export watt --to step",
        "forces watt",
        "free watt --time 1s",
        "map watt --over L1=1:2 --over L2=1:2",
        "simulate watt --engine mujoco",
        "sweep watt --over L1=1:2:3",
        "tolerance watt --tolerance L1=1",
    ],
)
def test_what_is_of_single_loops_refuses_a_net_in_one_line(words):
    said = mistake(*words.split())
    assert said.startswith("net: this linkage has several loops; ")
    assert said.endswith(" are of single loops")


def test_a_name_nearly_right_is_offered():
    offer = "give the path of a TOML file, or a name that 'sevenbar gallery' lists"
    for near, name in {"jansn": "jansen", "Watts": "watt", "double-wishbone": "double_wishbone"}.items():
        assert mistake("analyze", near) == f"{near}: no such file; did you mean '{name}'? {offer}"
    assert mistake("watt") == "watt: is a linkage, where a command should stand; give: sevenbar analyze watt"


def test_a_pin_of_three_links_has_one_name_and_one_path_in_a_figure():
    figure = sb.plot.configuration(sb.load("jansen").motion())
    labels = [text.get_text() for text in figure.axes[0].texts]
    entries = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    assert {"crank pin", "axle", "knee"} <= set(labels)
    assert [entry for entry in entries if "pin" in entry] == ["path of crank pin"]


def test_links_with_more_than_two_joints_have_a_face_in_the_plane_alone():
    def corners(name):
        figure = skeleton(sb.load(name).motion(36))
        faces = [patch.get_xy()[:-1] for patch in figure.axes[0].patches if isinstance(patch, Polygon)]
        # hinges of one pin are one corner
        return [count for face in faces if (count := len(np.unique(face.round(6), axis=0))) > 2]

    # the upper triangle of Jansen's leg, Klann's coupler with its elbow
    assert (corners("jansen"), corners("klann")) == ([3], [3])
    assert (corners("double_wishbone"), corners("planar_4r")) == ([], [])


@pytest.mark.parametrize("angle", [1, 4, 100, 250])
def test_poses_on_a_curve_are_no_modes_however_few_a_search_finds(angle):
    # the inversor's arms lie on each other, and its crank turns them with the far corner held to one of them
    inversor = sb.load("peaucellier")
    modes = inversor.assembly_modes(f"{angle} deg", input="left corner.2")
    assert modes.on_curve is not None
    crank, corner = (inversor.columns.index(name) for name in ("crank", "corner Q"))
    assert np.allclose(modes.q[0, crank], -modes.q[1, crank])
    assert len(modes) == 2
    assert np.ptp(modes.q[:, corner]) < 1e-9
