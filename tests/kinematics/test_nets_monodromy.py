"""All modes of planar blocks that are no dyads, against polynomials and starts that share nothing with the core."""

from __future__ import annotations

import math

import numpy as np
import pytest
from test_nets import STEPHENSON, net, pin

import sevenbar as sb
from sevenbar.kinematics.circuits.poses import joint_frames, poses

#: A platform on three legs, one of which stands on the crank.
PLATFORM = [
    pin((0, 0), "frame", "crank", name="crank"),
    pin((10, 30), "crank", "one"),
    pin((110, -10), "frame", "two"),
    pin((70, 120), "frame", "three"),
    pin((30, 60), "one", "platform"),
    pin((80, 40), "two", "platform"),
    pin((55, 85), "three", "platform"),
]

#: The pins of eight-bars whose blocks are the trusses of seven links.
TRUSSES = {
    "star": "frame crank|crank a|frame b|frame c|a d|d b|b e|e c|c f|f a",
    "path": "frame crank|crank a|a b|b c|frame d|d b|a e|e c|frame f|f c",
    "four": "frame crank|a b|crank c|c a|frame d|d a|frame e|e b|frame f|f b",
}


def drawn(text, places, drive=0):
    links = [pair.split() for pair in text.split("|")]
    pins = [
        pin((x, y), *pair, name=f"pin {k}")
        for k, ((x, y), pair) in enumerate(zip(places, links, strict=True))
    ]
    return sb.from_pins(pins, ground="frame", drive=f"pin {drive}")


def moved(linkage, modes, link, place):
    """A place (x, y) of a link in each mode, as complex numbers."""
    number = linkage.link_names.index(link)
    at = poses(linkage, modes.q)[:, number] @ [*place, 0, 1]
    return at[:, 0] + 1j * at[:, 1]


def turned(places, angle):
    return np.array([complex(*p) for p in places]) * np.exp(1j * angle)


def stephenson_by_resultant(pins, angle):
    """Where the upper pin of `right` is in each mode: roots of the closures' resultant in e^(i t).

    With the crank held both ternary links turn about known pins; bars of known length are between them. Each
    bar's equation is linear in cosine and sine of the second turn, whose squares have the sum 1.
    """
    at = [complex(*one["at"]) for one in pins]
    first, second = at[1] * np.exp(1j * angle), at[2]
    arms = [(at[3] - at[1], at[4] - at[2]), (at[5] - at[1], at[6] - at[2])]
    lengths = [abs(at[3] - at[4]), abs(at[5] - at[6])]
    count = 32

    def second_turn(z):
        rows = []
        for (a, b), length in zip(arms, lengths, strict=True):
            # conj of z is 1 / z on the circle, and stays so off it
            p, q = first + z * a - second, np.conj(first) + np.conj(a) / z - np.conj(second)
            k = (p * q + b * np.conj(b) - length**2) / 2
            # k = re(conj(p) b e^(i s)) = c cos s + d sin s
            rows.append((k, (q * b + p * np.conj(b)) / 2, 1j * (q * b - p * np.conj(b)) / 2))
        (k1, c1, d1), (k2, c2, d2) = rows
        return k1 * d2 - k2 * d1, c1 * k2 - c2 * k1, c1 * d2 - c2 * d1

    def resultant(z):
        x, y, whole = second_turn(z)
        return x**2 + y**2 - whole**2

    circle = np.exp(2j * np.pi * np.arange(count) / count)
    coefficients = np.fft.fft([resultant(z) for z in circle]) / count
    coefficients = np.roll(coefficients, count // 2)
    greatest = np.abs(coefficients).max()
    coefficients[np.abs(coefficients) < 1e-12 * greatest] = 0
    result = []
    for z in np.roots(coefficients[::-1]):
        if z != 0 and abs(abs(z) - 1) < 1e-6:
            x, y, whole = second_turn(z)
            if abs(whole) > 1e-9:
                turn = (x + 1j * y) / whole
                result.append(second + turn * arms[0][1])
    return np.array(result)


def dense_starts(pins, angle):
    """Where the first pin of `platform` is in each mode: Newton's method from a grid of poses of it."""
    at = np.array([complex(*one["at"]) for one in pins])
    ground = np.array([at[1] * np.exp(1j * angle), at[2], at[3]])
    own, legs = at[4:7] - at[4], np.abs(at[4:7] - at[1:4])
    found = []
    x, y, t = np.meshgrid(np.linspace(-120, 220, 12), np.linspace(-120, 220, 12), np.linspace(-3, 3, 13))
    x, y, t = x.ravel(), y.ravel(), t.ravel()
    for _ in range(40):
        d = (x + 1j * y)[:, None] + own * np.exp(1j * t)[:, None] - ground
        e = (np.abs(d) ** 2 - legs**2) / 2
        turn = (np.conj(d) * 1j * own * np.exp(1j * t)[:, None]).real
        matrix = np.stack([d.real, d.imag, turn], axis=2)
        good = np.abs(np.linalg.det(matrix)) > 1e-9
        x, y, t, matrix, e = x[good], y[good], t[good], matrix[good], e[good]
        by = np.linalg.solve(matrix, e[..., None])[..., 0]
        x, y, t = x - by[:, 0], y - by[:, 1], t - by[:, 2]
    for one in (x + 1j * y)[np.abs(e).max(axis=1) < 1e-8]:
        if all(abs(one - other) > 1e-5 for other in found):
            found.append(one)
    return np.array(found)


def same_places(some, others, within):
    assert len(some) == len(others)
    for one in some:
        assert np.abs(others - one).min() < within


@pytest.mark.parametrize("seed", range(6))
def test_stephenson_has_the_modes_that_are_roots_of_its_resultant(seed):
    random = np.random.default_rng(seed)
    places = random.uniform(-100, 100, (7, 2))
    pins = [{**one, "at": tuple(place)} for one, place in zip(STEPHENSON, places, strict=True)]
    angle0 = np.angle(complex(*places[1] - places[0]))
    # the crank's pin as the origin, as the resultant has it
    pins = [{**one, "at": tuple(np.subtract(one["at"], places[0]))} for one in pins]
    linkage = net(pins)
    for angle in (0.0, 0.4, angle0):
        modes = linkage.assembly_modes(angle)
        assert modes.completeness == "algebraic"
        ends = moved(linkage, modes, "right", pins[4]["at"])
        same_places(ends, stephenson_by_resultant(pins, angle), 1e-5)
        assert modes.residual.max(initial=0) < 1e-12 * linkage.size


@pytest.mark.parametrize("angle", [0.0, 0.9, -0.7])
def test_a_platform_on_three_legs_has_the_modes_that_dense_starts_find(angle):
    linkage = net(PLATFORM)
    modes = linkage.assembly_modes(angle)
    assert modes.completeness == "algebraic"
    ends = moved(linkage, modes, "platform", PLATFORM[4]["at"])
    same_places(ends, dense_starts(PLATFORM, angle), 1e-6)


def searched_modes(linkage, column, value):
    """Isolated modes (m, columns) that the core's search finds."""
    from sevenbar.kinematics.nets.order import order_of
    from sevenbar.kinematics.nets.tree import Tree

    tree = Tree(linkage, (linkage.column_of(column).joint,), order_of(linkage, column))
    q, _, isolated, _ = tree.core.searched_modes(column, value)
    return q[isolated]


def loses_none(linkage, column, value):
    modes = linkage.assembly_modes(value, input=linkage.columns[column])
    unit = np.where(linkage.turning, 1.0, linkage.size)
    for one in searched_modes(linkage, column, value):
        off = (modes.q - one) / unit
        off = np.where(linkage.turning, np.angle(np.exp(1j * off)), off)
        assert np.abs(off).max(axis=1).min() < 1e-6
    return modes


@pytest.mark.parametrize("name", TRUSSES)
def test_eight_bars_of_one_block_lose_no_mode_of_a_search(name):
    random = np.random.default_rng(5)
    for _ in range(2):
        linkage = drawn(TRUSSES[name], random.uniform(-100, 100, (10, 2)))
        assert [len(block.links) for block in linkage.order.blocks] == [6]
        assert loses_none(linkage, 0, 0.1).completeness == "algebraic"


@pytest.mark.parametrize("off", [0, 1e-16, 1e-13, 1e-10, 1e-7, 1e-3])
def test_parallelograms_in_a_block_lose_no_isolated_mode(off):
    random = np.random.default_rng(3)
    at = np.array([(0, 0), (20, 30), (80, 30), (40, 70), (100, 70), (30, 90), (90, 90)], dtype=float)
    places = at + 100 * off * random.standard_normal(at.shape)
    pins = [{**one, "at": tuple(place)} for one, place in zip(STEPHENSON, places, strict=True)]
    linkage = net(pins)
    column = linkage.columns.index("crank")
    # two equal parallelograms side by side: with the crank as drawn a curve of poses closes
    modes = loses_none(linkage, column, 0.0)
    if off == 0:
        assert modes.completeness == "searched"
        assert modes.on_curve is not None
    elif off > 1e-8:
        assert modes.completeness == "algebraic"
    assert loses_none(linkage, column, 0.3).completeness == "algebraic"


def test_a_platform_drawn_where_modes_meet_keeps_the_drawing():
    # the lines of the three legs meet in one point
    base, top = [(70, 0), (0, 80), (60, 60)], [(20, 0), (0, 30), (20, 20)]
    places = [(0, 0), *base, *top]
    pins = [{**one, "at": place} for one, place in zip(PLATFORM, places, strict=True)]
    modes = net(pins).assembly_modes(0)
    assert (np.abs(modes.q).max(axis=1) < 1e-5).sum() == 1


def test_rods_and_slides_that_drive_lose_no_mode_of_a_search():
    random = np.random.default_rng(2)
    z = [0, 0, 1]

    def hinge(k, *between):
        return {
            "name": f"pin {k}",
            "kind": "R",
            "at": [*random.uniform(-90, 90, 2), 0],
            "axis": z,
            "between": between,
        }

    def slide(k, *between):
        at = [*random.uniform(-90, 90, 2), 0]
        return {"name": f"pin {k}", "kind": "P", "at": at, "axis": [0.6, 0.8, 0], "between": between}

    ends = [[[*place, 1], [*other, 4]] for place, other in random.uniform(-90, 90, (2, 2, 2))]
    rods = [{"name": f"rod {k}", "between": ["left", "right"], "at": at} for k, at in enumerate(ends)]
    joints = [hinge(0, "frame", "crank"), hinge(1, "crank", "left"), hinge(2, "frame", "right")]
    with_rods = sb.from_axes(joints, rods=rods, ground="frame", drive="pin 0")
    assert loses_none(with_rods, 0, 0.2).completeness == "algebraic"
    joints += [hinge(3, "left", "upper"), hinge(4, "upper", "right")]
    joints += [slide(5, "left", "lower"), hinge(6, "lower", "right")]
    driven = sb.from_axes(joints, ground="frame", drive="pin 5")
    assert loses_none(driven, driven.columns.index("pin 5"), 3.0).completeness == "algebraic"


def test_links_are_not_turned_over():
    linkage = net(PLATFORM)
    frames = poses(linkage, linkage.assembly_modes(0).q)
    assert len(frames)
    assert np.abs(frames[:, :, 2, 2] - 1).max() < 1e-12


def test_an_input_between_two_moving_links_has_all_modes():
    links = "frame a|a b|b c|c frame|b d|d e|e frame"
    random = np.random.default_rng(8)
    for drive in (1, 2, 4, 5):
        linkage = drawn(links, random.uniform(-100, 100, (7, 2)), drive)
        column = linkage.columns.index(f"pin {drive}")
        assert loses_none(linkage, column, 0.15).completeness == "algebraic"


def sliders(random):
    """Stephenson's block with a slide on the ground and one between two links."""
    x, y = random.uniform(-100, 100, (2, 7))
    angle = random.uniform(0, math.pi, 2)
    joints = [
        ("R", "frame", "crank"), ("R", "crank", "left"), ("P", "frame", "right"), ("R", "left", "upper"),
        ("R", "upper", "right"), ("P", "left", "lower"), ("R", "lower", "right"),
    ]  # fmt: skip
    tables = []
    for k, (kind, *between) in enumerate(joints):
        turn = angle[k % 2]
        axis = [0, 0, 1] if kind == "R" else [math.cos(turn), math.sin(turn), 0]
        at = [x[k], y[k], 0]
        tables.append({"name": f"pin {k}", "kind": kind, "at": at, "axis": axis, "between": between})
    return sb.from_axes(tables, ground="frame", drive="pin 0")


@pytest.mark.parametrize("seed", range(3))
def test_slides_in_a_block_lose_no_mode_of_a_search(seed):
    linkage = sliders(np.random.default_rng(seed))
    modes = loses_none(linkage, 0, 0.1)
    assert modes.completeness in ("algebraic", "monodromy")


def shaper(kind):
    """A crank whose pin is in a slot of a lever, or has the slot; a link from its end to a ram."""
    pivot, tip, ram = (0, -80), (60, 80), (160, 100)
    slot, z = [30, 80, 0], [0, 0, 1]
    slotted = {"K": (["lever", "crank"], [slot, z]), "L": (["crank", "lever"], [z, slot])}
    between, axes = slotted[kind]
    joints = [
        {"name": "crank", "kind": "R", "at": [0, 0, 0], "axis": z, "between": ["frame", "crank"]},
        {"name": "pin", "kind": kind, "at": [30, 0, 0], "axes": axes, "between": between},
        {"name": "lever", "kind": "R", "at": [*pivot, 0], "axis": z, "between": ["frame", "lever"]},
        {"name": "tip", "kind": "R", "at": [*tip, 0], "axis": z, "between": ["lever", "link"]},
        {"name": "bolt", "kind": "R", "at": [*ram, 0], "axis": z, "between": ["link", "ram"]},
        {"name": "guide", "kind": "P", "at": [*ram, 0], "axis": [1, 0, 0], "between": ["frame", "ram"]},
    ]
    return sb.from_axes(joints, ground="frame", drive="crank")


def shaper_by_hand(angle):
    pivot, tip, ram = -80j, 60 + 80j, 160 + 100j
    result = []
    for way in (1, -1):
        turn = way * (30 * np.exp(1j * angle) - pivot)
        end = pivot + (tip - pivot) * turn / abs(turn) / np.exp(1j * np.angle(30 - pivot))
        half = np.emath.sqrt(abs(tip - ram) ** 2 - (ram - end).imag ** 2)
        result += [end.real + sign * half - ram.real for sign in (1, -1) if half.imag == 0]
    return np.array(result)


@pytest.mark.parametrize("kind", ["K", "L"])
def test_a_pin_in_a_slot_is_met_from_both_sides(kind):
    linkage = shaper(kind)
    guide = linkage.columns.index("guide")
    for angle in (0.0, 0.7, 2.5, -2.0):
        modes = linkage.assembly_modes(angle)
        assert modes.completeness == "algebraic"
        same_places(modes.q[:, guide], shaper_by_hand(angle), 1e-9)
        # every joint closes
        before, after = joint_frames(linkage, poses(linkage, modes.q))
        for joint, own in enumerate(linkage.joints):
            moves = before[:, joint] @ own.motion(modes.q[:, linkage.places[joint]])
            assert np.abs(moves - after[:, joint]).max() < 1e-9 * linkage.size


def test_circuits_of_a_block_are_counted():
    motion = net(PLATFORM).motion(24)
    assert motion.completeness == "counted"
    assert motion.circuits
