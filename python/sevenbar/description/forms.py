"""From a checked description to a linkage: the RSSR paper's numbers, Denavit-Hartenberg rows, a drawing."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import numpy.typing as npt

from sevenbar.description.angle_doubts import warn_of_angles
from sevenbar.description.proportions import disproportions
from sevenbar.description.slots import angle_between, slots_aslant
from sevenbar.description.written import has_links
from sevenbar.errors import (
    DescriptionError,
    Problem,
    RequestError,
    bare,
    check_kind,
    ends_here,
    shown,
    suggestion,
)
from sevenbar.forces.loading import Loading
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.geometry import Drive, Form, Joint, Place, Point, drawn_off_zero, loop_frames
from sevenbar.kinematics.loop.joint_text import check_own_unit
from sevenbar.kinematics.loop.joints import KINDS
from sevenbar.kinematics.loop.rigid import unit
from sevenbar.kinematics.loop.stops import Cone, Stops
from sevenbar.text.listed import listed
from sevenbar.text.units import LENGTHS, as_written, measured_unit

if TYPE_CHECKING:
    from sevenbar.description.loop_schema import JointForm, LinkForm, LoopForm, RssrForm
    from sevenbar.description.schema import LinkageForm
    from sevenbar.forces.bodies import Body

#: One number for each joint: a list, an array, a column of a data frame; a text has a unit of its own.
Numbers = Sequence[float | str | None] | npt.NDArray[np.float64] | Any

#: Below this share of the size of a drawn pose a link has no length.
NO_LENGTH = 1e-12


@ends_here
def rssr(
    M: float | str,
    N: float | str,
    L1: float | str,
    L3: float | str,
    D: float | str | None = None,
    L2: float | str | None = None,
    *,
    name: str = "RSSR",
    length_unit: str = "mm",
    speed: float | str = 1.0,
) -> Linkage:
    """The RSSR in the layout of Sun and Zhou: crank about z at height N, rocker about x at (M, D, 0).

    `A = (L1 cos alpha, L1 sin alpha, N)`, `B = (M, D + L3 cos beta, L3 sin beta)`, `|A - B| = L2`; lengths
    in `length_unit`, texts with a unit of their own, as "25 cm". D is required, as in files. L2 left out is
    `|A1 B1|`, `L2^2 = (L1 - M)^2 + L3^2 + N^2`. Raises `DescriptionError`
    with all that is wrong.

        >>> import sevenbar as sb
        >>> sb.rssr(M=700, N=700, L1=250, L3=550, D=0).motion().motion_type
        'crank-rocker'

    Source: docs/rssr.md, (1) and (2); Sun and Zhou, Figure 2, eq. (5) to (7).
    """
    given = {"M": M, "N": N, "L1": L1, "L3": L3, "D": D, "L2": L2}
    dimensions = {key: value for key, value in given.items() if value is not None}
    return from_description(head_of(name, length_unit, speed) | {"rssr": _plain(dimensions)})


@ends_here
def from_axes(
    joints: Sequence[Mapping[str, Any]] | Any,
    *,
    name: str = "linkage",
    length_unit: str = "mm",
    speed: float | str = 1.0,
    points: Sequence[Mapping[str, Any]] = (),
    rods: Sequence[Mapping[str, Any]] = (),
    ground: str | None = None,
    drive: str | None = None,
) -> Linkage:
    """A linkage from its joints as drawn in one assembled pose, in loop order: kind, point, direction.

    Each joint is a mapping with `kind` (a letter), `at` (three coordinates), `axis` (three numbers;
    `axes`, two of them, for U; none for S), `pitch` (length per turn) for H, and perhaps `name`. Link i lies
    between joints i and i + 1, the last is the ground. Every joint reads 0 in this pose, or its `value`, of R
    [deg, or text] and P [`length_unit`, or text]. Coordinates and pitches are in `length_unit`, or texts as
    in "12 mm", "8 mm/turn". A joint at the ground, first or last, counts its link against the ground.

    With links by name joints stand in any order: each has `between`, the names of its two links, `ground`
    names the link that stands still, and points name their `link`. `rods`, with `between` and two places
    `at`, are links with a ball at each end. More than one loop makes a net. `drive` names the input.
    `joints` may be a data frame or the path of a table, as `from_table` takes it.

        >>> import sevenbar as sb
        >>> linkage = sb.from_axes([
        ...     {"kind": "R", "at": (0, 0, 700), "axis": (0, 0, 1)},
        ...     {"kind": "S", "at": (250, 0, 700)},
        ...     {"kind": "S", "at": (700, 550, 0)},
        ...     {"kind": "R", "at": (700, 0, 0), "axis": (1, 0, 0)},
        ... ])
        >>> linkage.motion().motion_type
        'crank-rocker'
    """
    return _drawn(name, length_unit, speed, drive, ground, joints=joints, points=points, rods=rods)


@ends_here
def from_pins(
    pins: Sequence[Mapping[str, Any]] | Any,
    *,
    ground: str | None = None,
    drive: str | None = None,
    name: str = "linkage",
    length_unit: str = "mm",
    speed: float | str = 1.0,
    points: Sequence[Mapping[str, Any]] = (),
    rods: Sequence[Mapping[str, Any]] = (),
) -> Linkage:
    """A planar linkage from its pins as drawn in one assembled pose: links that turn on each, by name.

    Each pin is a mapping with `at` (x, y), `links` (two names or more), and perhaps `name`; a pin of k links
    is k - 1 hinges about z. `ground` names the link that stands still; `drive` the input, the first pin where
    it is left out. Points and rods are those of `from_axes`. `pins` may be a data frame or the path of a
    table with columns x, y, links (names with blanks or `;` between) and perhaps name, as `from_table` takes
    it; there `ground` may be left out.

        >>> import sevenbar as sb
        >>> linkage = sb.from_pins([
        ...     {"name": "crank", "at": (0, 0), "links": ("frame", "crank")},
        ...     {"at": (10, 40), "links": ("crank", "coupler")},
        ...     {"at": (100, 70), "links": ("coupler", "rocker")},
        ...     {"name": "rocker", "at": (90, 0), "links": ("frame", "rocker")},
        ... ], ground="frame")
        >>> linkage.motion().motion_type
        'crank-rocker'
    """
    return _drawn(name, length_unit, speed, drive, ground, pins=pins, points=points, rods=rods)


def _drawn(
    name: str, length_unit: str, speed: float | str, drive: str | None, ground: str | None, **lists: Any
) -> Linkage:
    """The linkage of tables as drawn, those that are not empty; the first may be a data frame or a file."""
    key, first = next(iter(lists.items()))
    if isinstance(first, str | os.PathLike | Mapping) or hasattr(first, "columns"):
        return _of_table(key, first, name, length_unit, speed, drive, ground, lists)
    raw = head_of(name, length_unit, speed)
    if drive is not None:
        raw["drive"] = {**raw.get("drive", {}), "joint": drive}
    if ground is not None:
        raw["ground"] = ground
    for key, values in lists.items():
        rows = _plain(values)
        check_kind(key, rows, list, f"a list; give one with a mapping for each of the {key}")
        if rows or key in ("joints", "pins", "points"):
            raw[key.removesuffix("s")] = rows
    return from_description(raw)


def _of_table(
    key: str,
    source: Any,
    name: str,
    length_unit: str,
    speed: float | str,
    drive: str | None,
    ground: str | None,
    lists: Mapping[str, Any],
) -> Linkage:
    """The linkage of a table as drawn, with points and rods besides."""
    from sevenbar.description.table_files import table_of

    if length_unit != "mm":
        raise RequestError("length_unit: is given in addition to a table; write it in the head, as in x [cm]")
    result, place = table_of(source, ground or "")
    if "link" in result.raw or "rssr" in result.raw:
        raise RequestError(f"{key}: the table has no {key} as drawn; give it to sevenbar.from_table")
    if name != "linkage":
        result.raw["name"] = name
    result.drive_by(drive, None if speed == 1.0 else _plain(speed))
    for head in ("point", "rod"):
        if more := _plain(lists.get(f"{head}s", ())):
            result.raw[head] = [*result.raw.get(head, []), *more]
    return result.linkage(from_description, place)


@ends_here
def from_dh(
    joints: Any,
    *,
    length: Numbers | None = None,
    twist: Numbers | None = None,
    offset: Numbers | None = None,
    angle: Numbers | None = None,
    pitch: Numbers | None = None,
    names: Sequence[str] | None = None,
    name: str = "linkage",
    length_unit: str = "mm",
    speed: float | str | None = None,
    points: Sequence[Mapping[str, Any]] = (),
    **others: object,
) -> Linkage:
    """A linkage from classic Denavit-Hartenberg numbers, one of each for a link, the ground last.

    `A_i = Rz(theta_i) Tz(offset_i) Tx(length_i) Rx(twist_i)`, joint i stands before link i, and the product
    of all is the identity. `joints` has a letter R, P or H for each joint. Lengths and offsets are in
    `length_unit` and may be negative, angles in radians; a text has a unit of its own, as in "30 deg". What
    is left out is 0. A twist of more than a turn gets an `AngleUnitWarning`. The last joint turns the ground
    relative to the link before it, as the paper's does. Lists, arrays and columns of a data frame are taken;
    a column whose name has a unit, `alpha [deg]`, is in that. The variable of R and H is theta, that of P the
    offset, its theta being the fixed `angle`; `pitch` is the length per turn of H, whose offset is its value
    at theta = 0. What a joint has not (the offset of P, the angle of R and H, the pitch of R and P) is `None`
    or 0. A point is `{"name": .., "link": .., "at": (u, v, w)}`: from where the link before meets the joint's
    axis, u along that axis, v along the link, w = u x v. `joints` may be a data frame of all columns instead,
    as `from_table` takes it. Raises `DescriptionError` with all that is wrong.

        >>> import sevenbar as sb
        >>> twists = [0.3, 0.6320397, 0.3, 0.6320397]
        >>> bennett = sb.from_dh("RRRR", length=[1, 2, 1, 2], twist=twists)
        >>> bennett.columns
        ('theta_1', 'theta_2', 'theta_3', 'theta_4')
        >>> square = sb.from_dh("RRRR", length=[1] * 4, twist=["30 deg"] * 4, offset=[0] * 4)
        >>> square.dimensions["twist_1_deg"]
        30.0

    Source: docs/conventions.md, (1); the 7R paper's loop and its u, v, w.
    """
    _refuse_others(others)
    columns = {"length": length, "twist": twist, "offset": offset, "angle": angle, "pitch": pitch}
    if hasattr(joints, "columns"):
        also_given = {**columns, "names": names, "length_unit": None if length_unit == "mm" else length_unit}
        if given := [key for key, values in also_given.items() if values is not None]:
            raise RequestError(f"{given[0]}: is given in addition to a data frame; leave one out")
        return _of_frame(joints, name=name, speed=speed, points=points)
    numbers = {key: _in_unit(key, values, length_unit) for key, values in columns.items()}
    rows = _rows(joints, numbers, _plain(names))
    head = head_of(name, length_unit, 1.0 if speed is None else speed)
    linkage = from_description(head | {"angle_unit": "rad", "link": rows, "point": _plain(points)})
    warn_of_angles(linkage.description)
    return linkage


def head_of(name: str, length_unit: str, speed: float | str) -> dict[str, Any]:
    """What the descriptions of all calls begin with."""
    return {"format": 1, "name": name, "length_unit": length_unit, "drive": {"speed": _plain(speed)}}


#: What other books call the arguments of `from_dh`.
_OTHER_NAMES = {
    "a": "length", "r": "length", "alpha": "twist", "d": "offset", "s": "offset", "theta": "angle",
    "lengths": "length", "twists": "twist", "offsets": "offset", "angles": "angle", "kinds": "joints",
    "h": "pitch", "lead": "pitch",
}  # fmt: skip


def _refuse_others(others: Mapping[str, object]) -> None:
    """`RequestError` for an argument of another name."""
    for word in others:
        if word in _OTHER_NAMES:
            ours = "a is length, alpha twist, d offset, theta angle"
            raise RequestError(
                f"{word}: is called {_OTHER_NAMES[word]} here ({ours}); give {_OTHER_NAMES[word]}="
            )
        # of words that are wrong only
        from inspect import signature

        known = list(signature(from_dh).parameters)[1:-1]
        raise RequestError(
            f"{bare(word)}: is no argument; {suggestion(word, known)}allowed: {', '.join(known)}"
        )


def _of_frame(
    frame: Any, *, name: str, speed: float | str | None, points: Sequence[Mapping[str, Any]]
) -> Linkage:
    """The linkage of a data frame of Denavit-Hartenberg rows."""
    from sevenbar.description.table_reader import described_frame

    result = described_frame(frame)
    if "link" not in result.raw:
        raise RequestError("joints: the table has no Denavit-Hartenberg rows; give it to sevenbar.from_table")
    result.raw |= {"name": name, "point": [*result.raw.get("point", []), *_plain(points)]}
    given = {} if speed is None else {"speed": _plain(speed)}
    result.raw["drive"] = {"speed": 1.0, **result.raw.get("drive", {}), **given}
    return result.linkage(from_description, "table")


def _in_unit(key: str, values: Any, length_unit: str) -> Any:
    """A column as a list; one of a data frame is in the unit that its name has."""
    plain = _plain(values)
    name, written = getattr(values, "name", None), ""
    if isinstance(name, str):
        from sevenbar.text.table import name_and_unit

        _, written = name_and_unit(name)
    if isinstance(plain, list) and key in ("twist", "angle"):
        for i, value in enumerate(plain):
            if isinstance(value, str):
                check_own_unit(f"{key}[{i}]", value)
    if not written or not isinstance(plain, list):
        return plain
    unit = measured_unit(written)
    sort = "turn" if key in ("twist", "angle") else "slide"
    if unit is None or (unit.kind, unit.order) != (sort, 0):
        what = {"turn": "angles", "slide": "lengths"}[sort]
        raise RequestError(f"{key}: the unit of column {shown(name)} is not one of {what}; rename the column")
    size = unit.size_in(length_unit) if length_unit in LENGTHS else 1.0
    return [value * size if isinstance(value, int | float) and size != 1.0 else value for value in plain]


def _rows(joints: object, columns: Mapping[str, Any], names: Any) -> list[dict[str, Any]]:
    """The rows that a file would hold, without the zeros that only fill a place."""
    if not isinstance(joints, str):
        raise DescriptionError(
            [Problem("joints", f"{shown(joints)} is not a text; give a letter for each joint, as in 'RRRR'")]
        )
    given = {key: values for key, values in {**columns, "name": names}.items() if values is not None}
    problems = [
        Problem("names" if key == "name" else key, message)
        for key, values in given.items()
        if (message := _miscounted(values, len(joints)))
    ]
    if problems:
        raise DescriptionError(problems)
    rows: list[dict[str, Any]] = []
    for i, letter in enumerate(joints):
        # these keys are refused in a row of this kind, whatever they hold
        own = KINDS[letter].row_keys if letter in KINDS else ()
        idle = {"offset", "angle", "pitch"}.difference(own) if own else ()
        row = {key: values[i] for key, values in given.items() if values[i] is not None}
        numbers = {key: value for key, value in row.items() if not (key in idle and value == 0)}
        rows.append({"joint": letter, **numbers})
    return rows


def _miscounted(values: object, count: int) -> str:
    if not isinstance(values, list):
        return f"{shown(values)} is not a list; give {count}, one for each joint"
    return "" if len(values) == count else f"{len(values)} given for {count} joints; give {count}"


def _plain(value: Any) -> Any:
    """Arrays and NumPy numbers as the lists and numbers that a file would hold; `RequestError` for a nest."""
    try:
        return _listed(value)
    except RecursionError:
        raise RequestError(
            "a list or a mapping is nested without end; give numbers, and lists and mappings of numbers"
        ) from None


def _listed(value: Any) -> Any:
    if not isinstance(value, str | Mapping):
        value = listed(value)
    if isinstance(value, Mapping):
        return {key: _listed(v) for key, v in value.items()}
    if isinstance(value, list | tuple):
        return [_listed(v) for v in value]
    return value


def from_description(raw: Mapping[str, Any], source: str = "") -> Linkage:
    """The linkage of a description, by the tables and keys of a file.

    It keeps the description, with the number of each formula in its place. Raises `DescriptionError` with
    all that is wrong; `source` is the file it came from.
    """
    if has_links(raw):
        from sevenbar.description.links import named_links
        from sevenbar.description.net import net_of

        if not (links := named_links(raw, source)).is_loop:
            return net_of(links, raw, source)
        try:
            return _of_loop(links.loop_tables(), source)
        except DescriptionError as error:
            raise DescriptionError([*map(links.as_written, error.problems)], source) from None
    return _of_loop(raw, source)


def _of_loop(raw: Mapping[str, Any], source: str) -> Linkage:
    """The linkage of one loop."""
    # `import sevenbar` needs no pydantic
    from sevenbar.description.formulas import context_of, with_numbers
    from sevenbar.description.loop_schema import loop_alone

    context = context_of(raw, source)
    raw = with_numbers(raw, context)
    form, more = loop_alone(raw, context), dict[str, Any]()
    whole: LinkageForm | None = None
    if form is None:
        # few files have more, or are wrong
        from sevenbar.description.schema import check

        form = whole = check(raw, context, source=source)
        more = {"loading": _loading(whole), "stops": _stops(whole)}
    if problems := disproportions(form):
        raise DescriptionError(problems, source)
    if form.rssr is not None:
        linkage = _from_dimensions(form, form.rssr)
    elif form.joint is not None:
        linkage = _from_drawing(form, form.joint, source)
    else:
        linkage = _from_rows(form, form.link or (), source)
    made = replace(
        linkage,
        points=linkage.points + tuple(Point(p.name, p.link, p.at) for p in form.point),
        description=raw,
        **more,
    )
    if whole is not None and whole.body:
        from sevenbar.description.loads import planar_flaws

        if problems := planar_flaws(whole.body, made, whole.forces.mass_unit):
            raise DescriptionError(problems, source)
    return made


def _loading(form: LinkageForm) -> Loading:
    """What acts on the linkage of a form."""
    if not (form.body or form.load or form.spring):
        return Loading(form.forces.gravity)
    # most files have none
    from sevenbar.description.loads import body_of, load_of, spring_of

    bodies: dict[int, tuple[Body, ...]] = {}
    for body in form.body:
        own = body_of(body, form.forces.mass_unit, form.length_unit)
        bodies[body.link] = (*bodies.get(body.link, ()), own)
    springs = tuple(spring_of(spring, form.first_columns) for spring in form.spring)
    return Loading(form.forces.gravity, bodies, tuple(map(load_of, form.load)), springs)


def _stops(form: LinkageForm) -> Stops:
    """What keeps the linkage of a form from moving on."""
    columns = form.first_columns
    return Stops(
        {columns.get(s.joint, s.joint): s.range for s in form.stop if s.range is not None},
        {s.joint: cone for s in form.stop if (cone := Cone(s.cone, s.seat, s.stud)) != Cone()},
        {rod.link: rod.radius for rod in form.rod},
    )


def _values(form: LoopForm) -> dict[Place, float]:
    """The numbers of a form by their places, as its word asks for them."""
    result: dict[Place, float] = {}
    if form.rssr is not None:
        dimensions = {**dict(form.rssr), "L2": form.rssr.coupler}
        result |= {("rssr", key): value for key, value in dimensions.items()}
    for i, row in enumerate(form.link or ()):
        result |= {("link", i, key): getattr(row, key) for key in ("length", "twist", "offset", "angle")}
    for i, joint in enumerate(form.joint or ()):
        vectors: dict[Place, Any] = {("at",): joint.at, ("axis",): joint.axis or ()}
        vectors |= {("axes", which): axis for which, axis in enumerate(joint.axes or ())}
        for place, vector in vectors.items():
            result |= {("joint", i, *place, k): value for k, value in enumerate(vector)}
        if joint.longer is not None:
            from sevenbar.kinematics.numbers.lengths import LONGER

            result["joint", i, LONGER] = joint.longer
    return result


def _linkage(form: LoopForm, written: Form, joints: tuple[Joint, ...], **parts: Any) -> Linkage:
    """The linkage of a form's word at its numbers."""
    # `import sevenbar` needs no words, and no lengths of drawings
    from sevenbar.kinematics.numbers.lengths import across
    from sevenbar.kinematics.numbers.word import Slots, outer_of

    numbers = _values(form)
    slots = Slots((place, i) for i, place in enumerate(numbers))
    values = np.array([*numbers.values()], dtype=np.float64)
    slots.across = across(_tables(form.joint or ()))
    slots.to_drawn = drawn_off_zero(joints)
    base, links, ground, frames = outer_of(written, [joint.kind for joint in joints], slots)
    return Linkage(
        name=form.name,
        joints=joints,
        frames=loop_frames(
            base.pose(values), np.stack([link.pose(values) for link in links]), ground.pose(values)
        ),
        point_frames=np.stack([frame.pose(values) for frame in frames]),
        drive=Drive(*form.driven, form.drive.speed),
        length_unit=form.length_unit,
        form=written,
        **parts,
    )


def _from_dimensions(form: LoopForm, rssr: RssrForm) -> Linkage:
    return _linkage(
        form,
        "rssr",
        # the rocker turns against the ground about x, as the last joint of a drawing does
        tuple(Joint(kind, name, backwards=name == "rocker") for name, kind in form.joints),
        points=(Point("A", 1, (rssr.L1, 0.0, 0.0)), Point("B", 3, (0.0, 0.0, 0.0))),
        dimensions={
            k: rssr.coupler if k == "L2" else getattr(rssr, k) for k in ("M", "N", "L1", "L2", "L3", "D")
        },
    )


def _from_rows(form: LoopForm, rows: tuple[LinkForm, ...], source: str) -> Linkage:
    """Denavit-Hartenberg rows: the ground's frame is that of the last link, or that of planar textbooks."""
    dimensions: dict[str, float] = {}
    for i, row in enumerate(rows, 1):
        dimensions |= {f"length_{i}": row.length, f"twist_{i}_deg": as_written(math.degrees(row.twist))}
        if row.joint == "P":
            dimensions[f"angle_{i}_deg"] = as_written(math.degrees(row.angle))
        else:
            dimensions[f"offset_{i}"] = row.offset
        dimensions |= {f"pitch_{i}": row.pitch} if row.joint == "H" else {}
    joints = tuple(
        Joint(kind, name, pitch=row.pitch) for (name, kind), row in zip(form.joints, rows, strict=True)
    )
    if form.layout == "dh":
        return _linkage(form, "rows", joints, dimensions=dimensions)
    ends = [f"link[{i + 1}].joint" for i in (0, -1 % len(rows)) if rows[i].joint != "R"]
    turned = [f"link[{i}].twist" for i, row in enumerate(rows, 1) if row.twist]
    if place := next(iter([*ends, *turned]), None):
        what = "the first and the last joint turn" if ends else "all twists are 0"
        raise DescriptionError([Problem(place, f'does not fit layout = "planar", in which {what}')], source)
    return _linkage(form, "planar", joints, dimensions=dimensions)


def _tables(drawn: Sequence[JointForm]) -> list[dict[str, Any]]:
    """Joints as drawn, as a description has them, without what is left out."""
    return [{key: value for key, value in joint if value is not None} for joint in drawn]


def _from_drawing(form: LoopForm, drawn: tuple[JointForm, ...], source: str) -> Linkage:
    """Joints as drawn, each at the `value` that it is given there, or at zero."""
    from sevenbar.kinematics.numbers.lengths import reached

    names, kinds = zip(*form.joints, strict=True)
    rssr = "".join(kinds) == "RSSR"
    problems = _coincident(drawn, names) if rssr else _coincident_balls(drawn)
    aslant = [
        p for i, joint in enumerate(drawn, 1) for p in slots_aslant(joint.kind, joint.axes, f"joint[{i}]")
    ]
    if problems := problems or aslant or _too_short(drawn):
        raise DescriptionError(problems, source)
    joints = tuple(
        # a joint U at zero is not the identity: it turns from its first axis to its second
        Joint(
            joint.kind,
            name,
            joint.pitch or 0.0,
            angle_between(*joint.axes) if joint.axes else 0.0,
            backwards=i + 1 == len(drawn),
            value=joint.value or 0.0,
        )
        for i, (joint, name) in enumerate(zip(drawn, names, strict=True))
    )
    points = (Point("A", 1, reached(_tables(drawn), 0)), Point("B", 3, drawn[2].at)) if rssr else ()
    return _linkage(form, "drawn", joints, points=points)


def _too_short(drawn: Sequence[JointForm]) -> list[Problem]:
    """Links that are longer than drawn, where the drawing gives no direction, or shorter by all they have."""
    from sevenbar.kinematics.numbers.lengths import drawn_length

    tables, problems = _tables(drawn), []
    for i, joint in enumerate(drawn, 1):
        if joint.longer is None:
            continue
        length, place = drawn_length(tables, i - 1), f"joint[{i}].longer"
        size = max(math.hypot(*np.subtract(other.at, joint.at)) for other in drawn)
        if not length > NO_LENGTH * size:
            why = f"link {i} has no length as drawn, so no direction; draw it with one, or leave this out"
            problems.append(Problem(place, why))
        elif not length + joint.longer > NO_LENGTH * size:
            why = f"{joint.longer:g} leaves nothing of link {i}; give more than {-length:g}"
            problems.append(Problem(place, why))
    return problems


def _coincident(drawn: tuple[JointForm, ...], names: Sequence[str]) -> list[Problem]:
    """Links of a drawn RSSR that have no length: its closed form has nothing to turn."""
    crank, ball_a, ball_b, rocker = (np.array(joint.at) for joint in drawn)
    arm_a, arm_b, coupler = ball_a - crank, ball_b - rocker, ball_b - ball_a
    size = max(np.linalg.norm(arm) for arm in (arm_a, arm_b, coupler))
    problems = [
        Problem(
            f"joint[{i}].at",
            f"{list(drawn[i - 1].at)} lies on the axis of {names[end]}; the link between has no length",
        )
        for i, end, arm in ((2, 0, arm_a), (3, 3, arm_b))
        if not np.linalg.norm(np.cross(unit(cast(npt.ArrayLike, drawn[end].axis)), arm)) > NO_LENGTH * size
    ]
    if not np.linalg.norm(coupler) > NO_LENGTH * size:
        place = list(drawn[2].at)
        problems.append(
            Problem("joint[3].at", f"{place} is the place of joint[2]; the coupler has no length")
        )
    return problems


def _coincident_balls(drawn: tuple[JointForm, ...]) -> list[Problem]:
    """Two balls in a row at one place: a single ball with three freedoms too many."""
    places = np.array([joint.at for joint in drawn])
    size = np.linalg.norm(places - places[0], axis=1).max()
    problems = []
    for i, joint in enumerate(drawn):
        last = i - 1 if i > 0 else len(drawn) - 1
        apart = np.linalg.norm(places[i] - places[last])
        if KINDS[joint.kind].is_ball and KINDS[drawn[last].kind].is_ball and not apart > NO_LENGTH * size:
            place = f"{list(joint.at)} is the place of joint[{last + 1}]"
            message = f"{place}; link {last + 1} between two balls has no length, so leave one ball out"
            problems.append(Problem(f"joint[{i + 1}].at", message))
    return problems
