"""Circuits of nets of dyads or of one block are counted: none is missing between the inputs at which modes are found."""

from __future__ import annotations

import itertools
import math
import tomllib

import numpy as np
import pytest
from test_nets import WATT, carried, circles, net, pin

import sevenbar as sb
from sevenbar.description import gallery
from sevenbar.description.forms import from_description

TURN = 2 * math.pi

#: Pins of a four-bar and of the dyad on its rocker, with a circuit that lies between two of 24 inputs: the width of each.
NARROW = {
    "one of 0.012 rad": [
        (0.49, 0.42), (-0.58, 0.83), (0.51, 0.24), (-0.36, 0.94), (-0.02, -0.43), (-0.09, -0.44), (-0.49, -0.38),
    ],
    "one of 0.013 rad": [
        (-0.2, 0.07), (0.16, -0.86), (0.16, 0.32), (-0.8, -0.68), (0.52, 0.13), (0.35, 0.41), (0.28, -0.79),
    ],
    "four, at most 0.02 rad": [
        (0.73, 0.58), (0.47, 0.12), (-0.02, 0.91), (-0.05, 0.95), (-0.56, 0.54), (-0.58, 0.5), (0.94, 0.41),
    ],
}  # fmt: skip

LINKS = [("frame", "crank"), ("crank", "coupler"), ("coupler", "rocker"), ("rocker", "frame")]
LINKS += [("rocker", "link"), ("link", "lever"), ("lever", "frame")]


def watt(places, size=1.0, turned=0.0, mirrored=False):
    """A six-bar of Watt's with pins at places, written in another way."""
    pins = []
    for place, links in zip(places, LINKS, strict=True):
        at = complex(*place) * size * np.exp(1j * turned)
        at = at.conjugate() if mirrored else at
        names = {("frame", "crank"): "crank", ("lever", "frame"): "lever"}
        pins.append(pin((at.real, at.imag), *links, name=names.get(links)))
    return net(pins)


def modes_by_hand(places, angle):
    """How many modes there are, by four circles."""
    at = [np.array(place) for place in places]
    turned = complex(*(at[1] - at[0])) * complex(math.cos(angle), math.sin(angle))
    crank = at[0] + (turned.real, turned.imag)
    count = 0
    for knee in circles(crank, at[3], math.dist(at[1], at[2]), math.dist(at[3], at[2])):
        side = carried(at[4], at[3], at[2], at[3], knee)
        count += len(circles(side, at[6], math.dist(at[4], at[5]), math.dist(at[6], at[5])))
    return count


def passes(circuit, angle):
    """How often a circuit passes an input, in any turn."""
    values = circuit.q[:, circuit.input_column]
    # it may turn back and go round, too
    first = values[:1] + TURN * round((values[-1] - values[0]) / TURN)
    turns = np.floor((np.append(values, first) - angle) / TURN)
    return int(np.abs(np.diff(turns)).sum())


@pytest.mark.parametrize("name", NARROW)
def test_no_circuit_is_missing_however_narrow(name):
    places = NARROW[name]
    motion = watt(places).motion(720)
    assert (motion.completeness, motion.search.count.open) == ("counted", ())
    # circuits between the grid's inputs are looked at, too
    angles = [0.001 + TURN * k / 7200 for k in range(7200)]
    ends = [end for circuit in motion if circuit.turns_back for end in circuit.input_range]
    away = [a for a in angles if all(abs((a - end + math.pi) % TURN - math.pi) > 1e-3 for end in ends)]
    for angle in away:
        assert sum(passes(circuit, angle) for circuit in motion) == modes_by_hand(places, angle), angle


@pytest.mark.parametrize("name", NARROW)
@pytest.mark.parametrize("how", [{"size": 137.0}, {"size": 1e-3}, {"turned": 1.0}, {"mirrored": True}])
def test_the_count_is_the_same_however_a_net_is_written(name, how):
    def account(linkage):
        motion = linkage.motion(72)
        count = motion.search.count
        widths = sorted(c.input_range[1] - c.input_range[0] for c in motion if c.turns_back)
        return motion.completeness, count.dead_centres, len(motion), np.round(widths, 7).tolist()

    assert account(watt(NARROW[name], **how)) == account(watt(NARROW[name]))


@pytest.mark.parametrize(
    "name",
    gallery.nets(),
)
def test_nets_of_the_gallery_are_counted(name):
    motion = sb.load(name).motion(36)
    assert (motion.completeness, motion.search.uncounted) == ("counted", None)


def test_dead_centres_that_are_counted_are_those_of_the_circuits():
    motion = net(WATT).motion(72)
    own = [d for circuit in motion for d in circuit.dead_centres if d.kind == "input"]
    assert motion.search.count.dead_centres == len(own)


@pytest.mark.parametrize("name", ["five_rod", "platform"])
def test_modes_between_dead_centres_of_a_slide_lie_on_its_circuits(name):
    linkage = sb.load(name)
    motion = linkage.motion(360)
    ends = sorted(
        {round(d.input, 6) for circuit in motion for d in circuit.dead_centres if d.kind == "input"}
    )
    # of each solution of the platform its leg with the slide goes together in two ways
    assert motion.search.count.dead_centres == len(ends)
    beyond = [ends[0] - 1.0, ends[-1] + 1.0]
    for value in [*beyond, *((a + b) / 2 for a, b in itertools.pairwise(ends))]:
        # a circuit passes it on the way there and back
        passed = sum(
            int(np.abs(np.diff(np.append(c.q[:, c.input_column], c.q[0, c.input_column]) > value)).sum())
            for c in motion
        )
        assert passed == len(linkage.assembly_modes(value)), value


@pytest.mark.parametrize("how", ["turned", "mirrored", "scaled"])
def test_the_count_over_a_slide_is_the_same_however_a_net_is_written(how):
    turn = np.array([[2.0, -2.0, 1.0], [1.0, 2.0, 2.0], [2.0, 1.0, -2.0]]) / 3
    by = {
        "turned": turn * np.sign(np.linalg.det(turn)),
        "mirrored": np.diag([1, -1, 1]),
        "scaled": np.eye(3),
    }[how]
    size = 1e-3 if how == "scaled" else 1.0
    raw = tomllib.loads(gallery.text("five_rod"))
    for table in (*raw["joint"], *raw["rod"], *raw["point"]):
        for key in table.keys() & {"at", "axis", "axes"}:
            moved = np.array(table[key]) @ by.T * (size if key == "at" else 1.0)
            table[key] = moved.tolist()

    def account(linkage, size=1.0):
        motion = linkage.motion(36)
        ends = {
            round(d.input / size, 5) for circuit in motion for d in circuit.dead_centres if d.kind == "input"
        }
        return motion.completeness, motion.search.count.dead_centres, len(motion), ends

    assert account(from_description(raw), size) == account(sb.load("five_rod"))


@pytest.mark.parametrize("off", [1e-3, 1e-6, -1e-6, -1e-3])
def test_a_dyad_that_is_nearly_stretched_at_one_input_alone(off):
    # crank 1, ground 4: the ends of the coupler of 2.5 and the rocker of 2.5 + off are 5 apart at one input
    knee = circles((1, 0), (4, 0), 2.5, 2.5 + off)[0]
    places = [(0, 0), (1, 0), tuple(knee), (4, 0), (5, 2), (7, 3), (7, 0)]
    motion = watt(places).motion(72)
    assert motion.completeness == "counted"
    for angle in np.linspace(0.05, 6.2, 200):
        assert sum(passes(circuit, angle) for circuit in motion) == modes_by_hand(places, angle)


def test_the_longest_train_of_dyads_is_counted():
    # four legs of two dyads on one crank: 17 columns, the most that are followed
    legs = [
        [(-0.6, 0.3), (-0.9, -0.5), (-0.2, -0.4), (-0.7, 0.7), (-1.1, 0.1), (-1.3, -0.3)],
        [(0.1, 0.2), (0.9, 0.4), (0.8, -0.3), (1.2, 0.5), (1.5, 0.2), (1.3, -0.4)],
        [(0.2, 0.1), (0.3, 1.0), (0.9, 0.8), (0.4, 1.4), (1.0, 1.6), (1.2, 1.1)],
        [(-0.1, 0.2), (-0.4, -1.0), (0.3, -0.9), (-0.2, -1.3), (0.1, -1.6), (0.6, -1.3)],
    ]
    pins = [pin((0, 0), "frame", "crank", name="crank")]
    for k, places in enumerate(legs):
        joined = [("crank", f"a{k}"), (f"a{k}", f"b{k}"), (f"b{k}", "frame")]
        joined += [(f"b{k}", f"c{k}"), (f"c{k}", f"d{k}"), (f"d{k}", "frame")]
        pins += [pin(place, *links) for place, links in zip(places, joined, strict=True)]

    motion = net(pins).motion(360)
    assert (motion.completeness, len(motion)) == ("counted", 32)
    ends = [end for circuit in motion if circuit.turns_back for end in circuit.input_range]
    for angle in 0.001 + TURN * np.arange(180) / 180:
        if all(abs((angle - end + math.pi) % TURN - math.pi) > 1e-3 for end in ends):
            by_hand = math.prod(modes_by_hand([(0, 0), *places], angle) for places in legs)
            assert sum(passes(circuit, angle) for circuit in motion) == by_hand, angle


def planar(*pins, drive):
    """A net of pins: their two links, then their place."""
    return sb.from_pins(
        [{"name": f"j{k}", "at": at, "links": links.split()} for k, (links, *at) in enumerate(pins)],
        ground="F",
        drive=f"j{drive}",
    )


def spatial(first, second, rod):
    """Two arms on hinges, each given by a place, an axis and its ball; a link on both balls and a rod."""
    joints = []
    for arm, (at, axis, ball) in zip("AC", (first, second), strict=True):
        joints.append({"name": arm, "kind": "R", "at": at, "axis": axis, "between": ["F", arm]})
        joints.append({"name": f"ball {arm}", "kind": "S", "at": ball, "between": [arm, "B"]})
    rods = [{"name": "rod", "between": ["F", "B"], "at": rod}]
    return sb.from_axes(joints, rods=rods, ground="F", drive="A")


#: Nets of one block, and how many circuits they have; some lie between two of 24 inputs. The numbers are those of a scan of another program.
BLOCKS = {
    "Stephenson III, driven at its dyad": (
        lambda: planar(
            ("F A", 0.867, -0.731), ("A B", -0.924, -0.612), ("B C", 0.437, -0.724), ("C F", 0.382, 0.758),
            ("B D", 0.807, -0.025), ("D E", 0.777, -0.086), ("E F", -0.81, -0.691), drive=6,
        ),
        5,
    ),
    "Stephenson II": (
        lambda: planar(
            ("F E", -0.311, -0.156), ("E A", -0.284, -0.455), ("A C", 0.188, 0.823), ("C B", 0.213, 0.812),
            ("A D", -0.885, 0.527), ("D B", -0.842, 0.201), ("B F", 0.247, 0.916), drive=6,
        ),
        4,
    ),
    "RSSR-SS": (
        lambda: spatial(
            ([0.986, -0.823, -0.532], [-0.299, 0.706, -0.642], [0.671, 0.419, 0.713]),
            ([-0.1, 0.366, -0.35], [0.819, 0.269, 0.507], [0.471, 0.086, -0.181]),
            [[-0.739, -0.668, 0.555], [0.475, -0.333, -0.053]],
        ),
        2,
    ),
    "double wishbone": (
        lambda: spatial(
            ([0.092, 0.318, 0.199], [1.048, -0.104, -0.024], [0.021, 0.679, 0.213]),
            ([-0.098, 0.379, 0.508], [1.071, 0.081, 0.062], [0.035, 0.764, 0.427]),
            [[0.089, 0.303, 0.283], [0.097, 0.719, 0.315]],
        ),
        3,
    ),
    # poles of their functions take as many zeros off, within a range of 15 degrees
    "RSSR-SS with poles": (
        lambda: spatial(
            ([-0.50519, -0.86056, 0.26817], [0.41793, -0.18964, -0.88846], [-0.43116, 0.77829, -0.25388]),
            ([-0.89647, 0.24556, -0.44823], [0.72594, -0.68324, -0.07872], [0.17372, -0.08189, 0.12521]),
            [[0.4609, -0.30286, 0.26096], [0.78685, -0.87605, 0.62565]],
        ),
        2,
    ),
    "double wishbone with poles": (
        lambda: spatial(
            ([0.01116, 0.22567, 0.13122], [1.14588, 0.15813, -0.06552], [-0.04273, 0.61984, 0.15112]),
            ([-0.04321, 0.35232, 0.52599], [1.1216, 0.06311, 0.03617], [0.07375, 0.63041, 0.37622]),
            [[0.16418, 0.31541, 0.22693], [0.06639, 0.70085, 0.30053]],
        ),
        4,
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", BLOCKS)
def test_no_circuit_of_a_block_is_missing(name):
    made, circuits = BLOCKS[name]
    linkage = made()
    motion = linkage.motion(720)
    assert (motion.completeness, len(motion), motion.search.count.open) == ("counted", circuits, ())
    own = [d for circuit in motion for d in circuit.dead_centres if d.kind == "input"]
    assert motion.search.count.dead_centres >= len(own)
    ends = [d.input for d in own]
    for angle in 0.003 + TURN * np.arange(96) / 96:
        if all(abs((angle - end + math.pi) % TURN - math.pi) > 2e-2 for end in ends):
            assert sum(passes(circuit, angle) for circuit in motion) == len(linkage.assembly_modes(angle))
