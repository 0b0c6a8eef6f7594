"""From a checked description to a linkage: the RSSR paper's numbers, Denavit-Hartenberg rows, a drawing."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import numpy.typing as npt

from sevenbar.description.proportions import disproportions
from sevenbar.description.slots import angle_between, slots_aslant
from sevenbar.description.written import has_links
from sevenbar.errors import DescriptionError, Problem
from sevenbar.forces.loading import Loading
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.geometry import Drive, Form, Joint, Place, Point, drawn_off_zero, loop_frames
from sevenbar.kinematics.loop.joints import KINDS
from sevenbar.kinematics.loop.rigid import unit
from sevenbar.kinematics.loop.stops import Cone, Stops
from sevenbar.text.units import as_written

if TYPE_CHECKING:
    from sevenbar.description.loop_schema import JointForm, LinkForm, LoopForm, RssrForm
    from sevenbar.description.schema import LinkageForm
    from sevenbar.forces.bodies import Body

#: Below this share of the size of a drawn pose a link has no length.
NO_LENGTH = 1e-12


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
