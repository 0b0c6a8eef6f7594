"""Textbook linkages, each from its free dimensions; the dependent ones are computed.

An overconstrained loop moves only at its exact dimensions, so the dependent ones are computed to the last
digit. Lengths are in `length_unit`, or texts with a unit ("6 cm"); angles are in radians, or texts
("40 deg", "pi/3").
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from sevenbar.arrays import finite_number, whole_number
from sevenbar.description.constructors import head_of
from sevenbar.description.forms import from_description
from sevenbar.errors import RequestError, check_kind, shown
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.joint_text import check_own_unit
from sevenbar.text.amounts import value_of
from sevenbar.text.expression import cosd, sind
from sevenbar.text.units import LENGTHS, as_written

#: A length or an angle as a caller gives it: a number, or a text with a unit.
Given = float | str

#: Points by name: the link of each, and its place along the link and to its left [length].
Points = Mapping[str, tuple[int, Sequence[Given]]]

#: A sine below this is rounding: the angle is 0 or half a turn.
NO_SINE = 1e-15


def bennett(
    a: Given,
    alpha: Given,
    beta: Given,
    *,
    name: str = "Bennett linkage",
    length_unit: str = "mm",
    speed: float | str = 1.0,
) -> Linkage:
    """Bennett's loop of four skew turning axes: links (a, alpha), (b, beta), (a, alpha), (b, beta).

        a / sin(alpha) = b / sin(beta),        no offsets

    `a` is the length of the first link, `alpha` and `beta` are the twists of the first and the second; the
    length b follows.

    Raises `RequestError` for an alpha of 0 or half a turn, which has no b.

        >>> import sevenbar as sb
        >>> linkage = sb.bennett(50, "30 deg", "100 deg")
        >>> round(linkage.dimensions["length_2"], 4), linkage.motion().motion_type
        (98.4808, 'double-crank')

    Source: G. T. Bennett, "A new mechanism", Engineering 76 (1903), 777.
    """
    others = head_of(name, length_unit, speed)
    first, twist, other = _length("a", a, others), _angle("alpha", alpha), _angle("beta", beta)
    second = _proportional(first, "alpha", twist, other)
    return _rows([(first, twist), (second, other)] * 2, others)


def goldberg(
    a: Given,
    alpha: Given,
    beta: Given,
    gamma: Given,
    *,
    name: str = "Goldberg five-bar",
    length_unit: str = "mm",
    speed: float | str = 1.0,
) -> Linkage:
    """Goldberg's five-bar: two Bennett loops with a common link b, which is left out.

        a / sin(alpha) = b / sin(beta) = c / sin(gamma)

    The links are (a + c, alpha + gamma), (b, beta), (c, gamma), (a, alpha), (b, beta). Raises `RequestError`
    for an alpha of 0 or half a turn.

        >>> import sevenbar as sb
        >>> sb.goldberg(60, "40 deg", "75 deg", "25 deg").columns[-1]
        'theta_5'

    Source: M. Goldberg, "New five-bar and six-bar linkages in three dimensions", Trans. ASME 65 (1943), 649.
    """
    others = head_of(name, length_unit, speed)
    first, twist = _length("a", a, others), _angle("alpha", alpha)
    other, third = _angle("beta", beta), _angle("gamma", gamma)
    b, c = (_proportional(first, "alpha", twist, angle) for angle in (other, third))
    links = [(first + c, twist + third), (b, other), (c, third), (first, twist), (b, other)]
    return _rows(links, others)


def myard(
    b: Given, alpha: Given, *, name: str = "Myard five-bar", length_unit: str = "mm", speed: float | str = 1.0
) -> Linkage:
    """Myard's five-bar: a Bennett loop with one right-angled twist, and its mirror image.

        a = b sin(alpha)

    The links are (a, alpha), (b, 90 deg), (0, 180 deg + 2 alpha), (b, 90 deg), (a, 180 deg - alpha).

        >>> import sevenbar as sb
        >>> sb.myard(80, "30 deg").dimensions["length_1"]
        40.0

    Source: F. E. Myard, "Contribution à la géométrie des systèmes articulés", Bull. Soc. Math. France 59
    (1931), 183.
    """
    others = head_of(name, length_unit, speed)
    length, twist = _length("b", b, others), _angle("alpha", alpha)
    a = length * float(sind(twist))
    links = [(a, twist), (length, 90.0), (0.0, 180 + 2 * twist), (length, 90.0), (a, 180 - twist)]
    return _rows(links, others)


def bricard_line(
    length: Sequence[Given],
    twist: Sequence[Given],
    offset: Sequence[Given] = (0.0, 0.0, 0.0),
    *,
    name: str = "Line-symmetric Bricard linkage",
    length_unit: str = "mm",
    speed: float | str = 1.0,
) -> Linkage:
    """Bricard's line-symmetric loop of six turning axes: links and offsets three apart are equal.

        length_i = length_(i+3),   twist_i = twist_(i+3),   offset_i = offset_(i+3)

    Three of each are given.

        >>> import sevenbar as sb
        >>> sb.bricard_line((30, 80, 70), ("30 deg", "100 deg", "80 deg"), (10, -20, 35)).columns[-1]
        'theta_6'

    Source: R. Bricard, "Leçons de cinématique", vol. 2 (1927).
    """
    others = head_of(name, length_unit, speed)
    links = list(zip(_lengths("length", length, others), _angles("twist", twist), strict=True))
    return _rows(links * 2, others, _lengths("offset", offset, others) * 2)


def bricard_plane(
    length: Sequence[Given],
    twist: Sequence[Given],
    offset: Sequence[Given] = (0.0, 0.0),
    *,
    name: str = "Plane-symmetric Bricard linkage",
    length_unit: str = "mm",
    speed: float | str = 1.0,
) -> Linkage:
    """Bricard's plane-symmetric loop of six turning axes: a plane through axes 1 and 4 mirrors the others.

        length_(7-i) = length_i,   twist_(7-i) = -twist_i                      i = 1, 2, 3
        offset_(8-i) = -offset_i,  offset_1 = offset_4 = 0                     i = 2, 3

    Three lengths and twists are given, and the offsets of joints 2 and 3.

        >>> import sevenbar as sb
        >>> loop = sb.bricard_plane((30, 80, 75), ("40 deg", "70 deg", "50 deg"), (10, -15))
        >>> loop.dimensions["offset_6"]
        -10.0

    Source: R. Bricard, "Leçons de cinématique", vol. 2 (1927).
    """
    others = head_of(name, length_unit, speed)
    lengths, twists = _lengths("length", length, others), _angles("twist", twist)
    second, third = _lengths("offset", offset, others, count=2)
    links = list(zip(lengths + lengths[::-1], twists + [-angle for angle in twists[::-1]], strict=True))
    offsets = [0.0, second, third, 0.0, -third, -second]
    return _rows(links, others, offsets)


def bricard_trihedral(
    length: Sequence[Given],
    *,
    name: str = "Trihedral Bricard linkage",
    length_unit: str = "mm",
    speed: float | str = 1.0,
) -> Linkage:
    """Bricard's trihedral loop of six turning axes: right-angled twists, no offsets.

        a1^2 + a3^2 + a5^2 = a2^2 + a4^2 + a6^2,    twists 90, 270, 90, 270, 90, 270 deg

    The first five lengths are given, the sixth follows. Raises `RequestError` where no sixth length exists.

        >>> import sevenbar as sb
        >>> sb.bricard_trihedral((50, 55, 70, 60, 75)).dimensions["length_6"]
        80.0

    Source: R. Bricard, "Leçons de cinématique", vol. 2 (1927).
    """
    others = head_of(name, length_unit, speed)
    lengths = _lengths("length", length, others, count=5)
    squares = [value * value for value in lengths]
    last = math.fsum([squares[0], squares[2], squares[4], -squares[1], -squares[3]])
    if last <= 0:
        raise RequestError(
            "length: the squares of the second and fourth add up to more than those of the first, third and "
            f"fifth, by {-last:g}, so there is no sixth length; give other lengths"
        )
    links = list(zip([*lengths, math.sqrt(last)], [90.0, 270.0] * 3, strict=True))
    return _rows(links, others)


def four_bar(
    crank: Given,
    coupler: Given,
    rocker: Given,
    ground: Given,
    *,
    name: str = "Planar four-bar",
    length_unit: str = "mm",
    speed: float | str = 1.0,
    points: Points | None = None,
) -> Linkage:
    """The planar four-bar, as a spatial loop of four parallel axes.

    It lies in the xy plane as in textbooks: the crank's pivot is the origin, the ground goes along +x to the
    rocker's pivot, and theta_1 of the crank and theta_4 of the rocker count counter-clockwise from +x. The
    links are rows without twist, in this order. `points` are named, each (link, (u, v)): u along the link
    from its first joint, v to its left. Raises `RequestError` where a length is not > 0.

        >>> import numpy as np
        >>> import sevenbar as sb
        >>> linkage = sb.four_bar(40, 100, 80, 90)
        >>> circuit = linkage.motion(36).circuits[0]
        >>> crank, rocker = circuit.q[:, 0], circuit.q[:, 3]
        >>> left = 90 / 40 * np.cos(rocker) - 90 / 80 * np.cos(crank) - np.cos(crank - rocker)
        >>> float(np.ptp(left)) < 1e-13  # constant, by Freudenstein's equation
        True

    Source: F. Freudenstein, "Approximate synthesis of four-bar linkages", Trans. ASME 77 (1955), 853.
    """
    others = head_of(name, length_unit, speed)
    given = {"crank": crank, "coupler": coupler, "rocker": rocker, "ground": ground}
    lengths = [_length(what, value, others) for what, value in given.items()]
    named = [{"name": of, "link": link, "at": [0.0, u, v]} for of, link, u, v in _in_links(points, 3, others)]
    return _rows([(length, 0.0) for length in lengths], {**others, "layout": "planar", "point": named})


def spherical_four_bar(
    crank: Given,
    coupler: Given,
    rocker: Given,
    ground: Given,
    *,
    name: str = "Spherical four-bar",
    length_unit: str = "mm",
    speed: float | str = 1.0,
) -> Linkage:
    """The spherical four-bar: four axes through one point, links that are arcs.

    The links are Denavit-Hartenberg rows with a twist alone, in this order.

        >>> import sevenbar as sb
        >>> sb.spherical_four_bar("30 deg", "80 deg", "70 deg", "85 deg").motion().motion_type
        'crank-rocker'

    Source: C. H. Chiang, "Kinematics of spherical mechanisms" (1988).
    """
    others = head_of(name, length_unit, speed)
    given = {"crank": crank, "coupler": coupler, "rocker": rocker, "ground": ground}
    arcs = [_angle(what, value) for what, value in given.items()]
    return _rows([(0.0, arc) for arc in arcs], others)


def slider_crank(
    crank: Given,
    rod: Given,
    offset: Given = 0.0,
    *,
    name: str = "Slider-crank",
    length_unit: str = "mm",
    speed: float | str = 1.0,
    points: Points | None = None,
) -> Linkage:
    """The planar slider-crank in the xy plane: the crank turns about z, the slider moves along x.

        x = crank cos(theta) + sqrt(rod^2 - (offset - crank sin(theta))^2)

    is the place of the pin on the slider, whose guide lies `offset` above the crank's pivot. Drawn with the
    crank along x, theta = 0; the slider's value is the change of x from there. The pin is the point `pin`.
    Other `points` are named as those of `four_bar`, each (link, (u, v)): u along crank or rod from its first
    joint, of the slider along x from the pin. `Circuit.point(link, at)` takes (u, v) likewise. The `centre`
    of a body and the `at` of a load or spring are three numbers, a place of the drawing at theta = 0: the
    middle of a rod without offset is (crank + rod / 2, 0, 0). Raises `RequestError` where the rod does not
    reach the guide.

        >>> import sevenbar as sb
        >>> sb.slider_crank(40, 140).motion().motion_type
        'crank-slider'

    Source: R. S. Hartenberg and J. Denavit, "Kinematic synthesis of linkages" (1964).
    """
    others = head_of(name, length_unit, speed)
    arm, length = _length("crank", crank, others), _length("rod", rod, others)
    aside = _number("offset", offset, "length", others)
    if length <= abs(aside):
        raise RequestError(
            f"rod: {length:g} does not reach the guide at {aside:g}; give a rod longer than the offset"
        )
    pin = [arm + math.sqrt((length - aside) * (length + aside)), aside, 0.0]
    up = [0, 0, 1]
    joints = [
        {"name": "crank", "kind": "R", "at": [0, 0, 0], "axis": up},
        {"name": "crank_pin", "kind": "R", "at": [arm, 0, 0], "axis": up},
        {"name": "wrist_pin", "kind": "R", "at": pin, "axis": up},
        {"name": "slider", "kind": "P", "at": pin, "axis": [1, 0, 0]},
    ]
    starts = ([0.0, 0.0], [arm, 0.0], pin[:2])
    along = ((1.0, 0.0), ((pin[0] - arm) / length, pin[1] / length), (1.0, 0.0))
    named = [{"name": "pin", "link": 3, "at": pin}]
    for of, link, u, v in _in_links(points, 3, others):
        (x, y), (c, s) = starts[link - 1], along[link - 1]
        named.append({"name": of, "link": link, "at": [x + u * c - v * s, y + u * s + v * c, 0.0]})
    return replace(_drawn(joints, named, others), points_by_two=True)


def universal_joint(
    angle: Given,
    reach: Given = 100.0,
    *,
    name: str = "Universal joint",
    length_unit: str = "mm",
    speed: float | str = 1.0,
) -> Linkage:
    """The universal joint (Cardan, Hooke) between two shafts at an angle.

        tan(out) = cos(angle) tan(in)

    counted from the pose drawn, in which the first arm of the cross is at right angles to the plane of the
    shafts. The shafts' bearings are at `reach` from the cross.

        >>> import sevenbar as sb
        >>> sb.universal_joint("30 deg").motion().motion_type
        'double-crank'

    Source: R. S. Hartenberg and J. Denavit, "Kinematic synthesis of linkages" (1964).
    """
    others = head_of(name, length_unit, speed)
    bend, far = _angle("angle", angle), _length("reach", reach, others)
    c, s = float(cosd(bend)), float(sind(bend))
    joints = [
        {"name": "input_shaft", "kind": "R", "at": [-far, 0, 0], "axis": [1, 0, 0]},
        {"name": "cross", "kind": "U", "at": [0, 0, 0], "axes": [[0, 0, 1], [-s, c, 0]]},
        {"name": "output_shaft", "kind": "R", "at": [far * c, far * s, 0], "axis": [c, s, 0]},
    ]
    return _drawn(joints, [], others)


def clemens(
    angle: Given,
    hinge: Given,
    ball: Given,
    *,
    name: str = "Clemens coupling",
    length_unit: str = "mm",
    speed: float | str = 1.0,
) -> Linkage:
    """Clemens's coupling RRSRR, which turns two shafts at an angle at the same speed at every moment.

    The plane that halves the angle of the shafts mirrors one half onto the other, and the ball stays in it.
    The hinges are `hinge` from where the shafts meet, the bearings twice as far; the ball is `ball` above the
    plane of the shafts in the pose drawn.

        >>> import sevenbar as sb
        >>> sb.clemens("45 deg", 65, 72).motion().circuits[0].motion_type
        'double-crank'

    Source: K. H. Hunt, "Constant-velocity shaft couplings: a general theory", J. Eng. Ind. 95 (1973), 455.
    """
    others = head_of(name, length_unit, speed)
    half = _angle("angle", angle) / 2
    near, high = _length("hinge", hinge, others), _length("ball", ball, others)
    c, s = float(cosd(half)), float(sind(half))
    x, y = near * c, near * s
    joints = [
        {"name": "input_shaft", "kind": "R", "at": [-2 * x, 2 * y, 0], "axis": [-c, s, 0]},
        {"name": "input_hinge", "kind": "R", "at": [-x, y, 0], "axis": [s, c, 0]},
        {"name": "ball", "kind": "S", "at": [0, 0, high]},
        {"name": "output_hinge", "kind": "R", "at": [x, y, 0], "axis": [-s, c, 0]},
        {"name": "output_shaft", "kind": "R", "at": [2 * x, 2 * y, 0], "axis": [-c, -s, 0]},
    ]
    return _drawn(joints, [{"name": "ball", "link": 2, "at": [0, 0, high]}], others)


def sarrus(
    first: Sequence[Sequence[Given]],
    second: Sequence[Sequence[Given]],
    *,
    name: str = "Sarrus linkage",
    length_unit: str = "mm",
    speed: float | str = 1.0,
) -> Linkage:
    """Sarrus's linkage: two legs of three parallel hinges, across each other; the platform goes straight.

    Each leg is three places (distance from the vertical, height), from the ground up to the platform, link 3:
    the first leg's in the yz plane with hinges along x, the second one's in the xz plane with hinges along y.

        >>> import sevenbar as sb
        >>> sb.sarrus([(50, 0), (50, 30), (70, 126)], [(50, 0), (104, 72), (65, 126)]).kind
        'RRRRRR'

    Source: P. F. Sarrus, "Note sur la transformation des mouvements rectilignes alternatifs, en mouvements
    circulaires, et réciproquement", C. R. Acad. Sci. 36 (1853), 1036.
    """
    others = head_of(name, length_unit, speed)
    legs = []
    for which, leg in (("first", first), ("second", second)):
        try:
            ends = [_several(which, place, 2) for place in _several(which, leg, 3)]
        except RequestError:
            raise RequestError(
                f"{which}: {shown(leg)} is no leg; give three places (distance, height)"
            ) from None
        legs.append([[_number(which, value, "length", others) for value in place] for place in ends])
    one, other = legs
    names = ("crank", "knee_1", "platform_1", "platform_2", "knee_2", "rocker")
    places = [[0.0, y, z] for y, z in one] + [[x, 0.0, z] for x, z in reversed(other)]
    axes = [[1, 0, 0]] * 3 + [[0, 1, 0]] * 3
    joints = [
        {"name": joint, "kind": "R", "at": at, "axis": axis}
        for joint, at, axis in zip(names, places, axes, strict=True)
    ]
    points = [{"name": "platform", "link": 3, "at": [0.0, 0.0, one[2][1]]}]
    return _drawn(joints, points, others)


def _number(name: str, value: Given, kind: Any, others: Mapping[str, Any]) -> float:
    """A number, or a text with a unit, in the units of the description: `length_unit` and degrees."""
    if not isinstance(value, str):
        return finite_number(name, value)
    try:
        # one that is no unit is refused by the description
        unit = others.get("length_unit")
        known = isinstance(unit, str) and unit in LENGTHS
        return value_of(value, kind, length_unit=str(unit) if known else "mm")
    except RequestError as error:
        raise RequestError(f"{name}: {error}") from None


def _length(name: str, value: Given, others: Mapping[str, Any]) -> float:
    number = _number(name, value, "length", others)
    if number <= 0:
        raise RequestError(f"{name}: {shown(value)} is not a length; give a number > 0")
    return number


def _angle(name: str, value: Given) -> float:
    """An angle [deg], from a number in radians or from a text."""
    if isinstance(value, str):
        check_own_unit(name, value)
        return _number(name, value, "angle", {})
    radians = finite_number(name, value)
    if abs(radians) > math.tau:
        raise RequestError(
            f"{name}: {radians:g} rad is more than a turn; give radians, or a text, as in '{radians:g} deg'"
        )
    return as_written(math.degrees(radians))


def _several(name: str, values: Any, count: int) -> list[Any]:
    several = values.ndim > 0 if isinstance(values, np.ndarray) else isinstance(values, Sequence)
    result = list(values) if several and not isinstance(values, str) else []
    if len(result) != count:
        raise RequestError(f"{name}: {shown(values)} does not fit; give {count} numbers")
    return result


def _lengths(name: str, values: Sequence[Given], others: Mapping[str, Any], count: int = 3) -> list[float]:
    given = _several(name, values, count)
    return [_number(f"{name}[{i}]", value, "length", others) for i, value in enumerate(given)]


def _angles(name: str, values: Sequence[Given]) -> list[float]:
    return [_angle(f"{name}[{i}]", value) for i, value in enumerate(_several(name, values, 3))]


def _proportional(a: float, name: str, alpha: float, beta: float) -> float:
    """The length of a link of a Bennett loop whose twist is `beta` [deg]: a sin(beta) / sin(alpha)."""
    sine = float(sind(alpha))
    if abs(sine) < NO_SINE:
        raise RequestError(
            f"{name}: {alpha:g} deg: its sine is 0, so no other length follows; give another angle"
        )
    return a * float(sind(beta)) / sine


def _in_links(
    points: Points | None, links: int, others: Mapping[str, Any]
) -> Iterator[tuple[str, int, float, float]]:
    """The points of a planar linkage by name, link and place, once checked."""
    if points is None:
        return
    check_kind("points", points, Mapping, "points by name; give {name: (link, (u, v))}")
    for name, given in points.items():
        if not isinstance(given, Sequence) or len(given) != 2 or not hasattr(given[1], "__len__"):
            raise RequestError(
                f"points.{name}: {shown(given)} is no point; give (link, (u, v)), as in (2, (50, 20))"
            )
        link = whole_number(f"points.{name}", given[0], 1, links, "a link")
        if len(given[1]) != 2 or isinstance(given[1], str):
            raise RequestError(f"points.{name}: {shown(given[1])} is no place in the plane; give (u, v)")
        u, v = (_number(f"points.{name}", part, "length", others) for part in given[1])
        yield name, link, u, v


def _rows(
    links: Sequence[tuple[float, float]],
    others: Mapping[str, Any],
    offsets: Sequence[float] | None = None,
) -> Linkage:
    """The loop of turning joints from its links (length, twist [deg]) and its offsets, zero if left out."""
    rows = [{"length": length, "twist": twist} for length, twist in links]
    for row, offset in zip(rows, offsets or [], strict=False):
        row["offset"] = offset
    return from_description({**others, "angle_unit": "deg", "link": rows})


def _drawn(
    joints: Sequence[Mapping[str, Any]], points: Sequence[Mapping[str, Any]], others: Mapping[str, Any]
) -> Linkage:
    return from_description({**others, "joint": list(joints), "point": list(points)})
