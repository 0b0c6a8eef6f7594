"""A net of several loops in a file, checked with pydantic: its joints and rods between links by name."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, ValidationError, ValidationInfo
from pydantic_core import ErrorDetails

from sevenbar.description.contradictions import wrong_keys
from sevenbar.description.formulas import context_of
from sevenbar.description.loop_schema import DriveForm, JointForm
from sevenbar.description.mistakes import FileForms, with_unknown
from sevenbar.description.not_covered import OF_JOINTS
from sevenbar.description.proportions import MEANT
from sevenbar.description.slots import slots_aslant
from sevenbar.description.values import (
    Component,
    TableForm,
    Text,
    Vector,
    key,
    number_for,
    one_of,
    parts_of,
    refuse,
    three,
)
from sevenbar.description.written import entries
from sevenbar.errors import DescriptionError, Problem, shown
from sevenbar.kinematics.loop.joints import JOINT_KINDS
from sevenbar.text.units import ANGLES, LENGTHS

_BETWEEN = key("the two links that it joins; its value is that of the second against the first")


def _in_plane(value: object, info: ValidationInfo) -> tuple[float, float]:
    parts = parts_of(value, 2, "is not a place in the plane; give x and y, as in [40, 0]")
    x, y = (number_for(part, info, "length") for part in parts)
    return x, y


def _ends(value: object, info: ValidationInfo) -> tuple[tuple[float, float, float], ...]:
    ends = parts_of(value, 2, "are not two places; give that on each link, as in [[0, 0, 0], [100, 0, 0]]")
    first, second = (three(end, info, "length") for end in ends)
    if math.dist(first, second) < MEANT:
        raise refuse("its two ends are one place; give joint S there")
    return first, second


class NetJointForm(JointForm):
    """A joint between two links by name, as drawn in one assembled pose, in ground coordinates."""

    between: Annotated[tuple[Text, Text], _BETWEEN]


class NetRodForm(TableForm):
    """A link with a ball at each end; it takes part with its length alone."""

    between: Annotated[tuple[Text, Text], key("the two links that it joins")]
    at: Annotated[
        tuple[tuple[Component, Component, Component], tuple[Component, Component, Component]],
        BeforeValidator(_ends),
        key("the place of its end on each link, as drawn", "length"),
    ]
    name: Annotated[Text | None, key("left out, rod_1, rod_2 ..")] = None


class PinForm(TableForm):
    """A pin of a planar linkage: a hinge about z for each of its links but the first."""

    at: Annotated[
        tuple[Component, Component], BeforeValidator(_in_plane), key("its place as drawn: x, y", "length")
    ]
    links: Annotated[tuple[Text, ...], key("the links that turn on it; the others against the first")]
    name: Annotated[Text | None, key("left out, pin_1, pin_2 ..")] = None


class NetPointForm(TableForm):
    """A named point of a link."""

    name: Annotated[Text, key("its own among the points")]
    link: Annotated[Text, key("the link that carries it, by name")]
    at: Annotated[Vector, key("its place as drawn, in ground coordinates", "length")]


class NetForm(TableForm):
    """A file of format 1 with links by name that make more than one loop."""

    format: Annotated[Literal[1], key("of this file")]
    ground: Annotated[Text, key("the link that stands still, by name")]
    name: Annotated[Text, key("of the linkage, for reports and figures")] = "linkage"
    length_unit: Annotated[str, *one_of("unit", LENGTHS), key("of all lengths")] = "mm"
    angle_unit: Annotated[str, *one_of("unit", ANGLES), key("of the angles written in this file")] = "deg"
    drive: Annotated[DriveForm, key("the input, the output, the speed")] = DriveForm.model_construct()
    joint: Annotated[tuple[NetJointForm, ...], key("joints as drawn, in any order")] = ()
    pin: Annotated[tuple[PinForm, ...], key("hinges about z, by place")] = ()
    rod: Annotated[tuple[NetRodForm, ...], key("links with a ball at each end")] = ()
    point: Annotated[tuple[NetPointForm, ...], key("points of links")] = ()


_FORMS = FileForms(
    NetForm,
    {"joint": NetJointForm, "pin": PinForm, "rod": NetRodForm, "point": NetPointForm, "drive": DriveForm},
    once=("drive",),
)


#: What to say of keys of the whole file, and of its tables, that people write for a net.
_OF_ONE_LOOP = "is of a single loop so far; leave it out"
_NOT_OF_NETS: dict[tuple[str, ...], str] = {
    **{
        (key,): "describes one loop; a net has [[joint]] with between, [[pin]] and [[rod]]; leave it out"
        for key in ("link", "rssr", "layout")
    },
    **{(key,): _OF_ONE_LOOP for key in ("forces", "body", "load", "spring", "stop")},
    **{(key,): "is not covered: a net has one input, drive.joint; leave it out" for key in ("tie", "ties")},
    **{
        ("drive", key): "is not covered: the input is a joint; give drive.joint"
        for key in ("rod", "point", "along")
    },
    **{
        ("pin", key): "is not of a pin, a hinge about z; write other joints as [[joint]] with between"
        for key in ("kind", "axis", "axes", "value", "pitch")
    },
    **{("joint", key): "is not known here; a joint has its links in between" for key in OF_JOINTS},
    ("joint", "longer"): "is of a single loop; draw the link as long as it is",
    ("joint", "held"): "is not covered; to hold a joint give its two links one name",
    ("rod", "length"): "follows from its two places; leave it out",
    ("rod", "radius"): _OF_ONE_LOOP,
}


def check_net(raw: Mapping[str, Any], context: Mapping[str, Any], *, source: str = "") -> NetForm:
    """The checked form of a net's tables; `DescriptionError` with every problem of the file."""
    form, problems = _checked(raw, context)
    # whether it is one loop is not known of a file with flaws in its links
    longer = [i for i, table in enumerate(entries(raw, "joint"), 1) if "longer" in table]
    problems += [Problem(f"joint[{i}].longer", _NOT_OF_NETS["joint", "longer"]) for i in longer]
    if form is None or problems:
        raise DescriptionError(problems, source)
    return form


def _checked(raw: Mapping[str, Any], context: Mapping[str, Any]) -> tuple[NetForm | None, list[Problem]]:
    problems: list[Problem] = []
    form: NetForm | None = None
    try:
        form = NetForm.model_validate(raw, context=context)
    except ValidationError as error:
        for detail, besides in with_unknown(error.errors(include_url=False), _words_of):
            problem = _FORMS.problem(detail, besides)
            known = _words_of(detail)
            problems.append(Problem(problem.place, known) if known else problem)
    for i, table in enumerate(entries(raw, "joint"), 1):
        if table.get("kind") in JOINT_KINDS:
            problems += [Problem(f"joint[{i}].{name}", message) for name, message in wrong_keys(table)]
    for i, joint in enumerate(form.joint if form else (), 1):
        problems += slots_aslant(joint.kind, joint.axes, f"joint[{i}]")
    return form, problems


def _words_of(detail: ErrorDetails) -> str:
    """What a net says of a key or a value that people write for another one; empty for others."""
    words = tuple(part for part in detail["loc"] if isinstance(part, str))
    if words == ("joint", "kind") and str(detail["input"]).lower() == "rod":
        return "'rod' is not a joint kind; write [[rod]] with between and its two places at"
    if words == ("point", "link") and detail["type"] == "sevenbar":
        return f'{shown(detail["input"])} is not the name of a link; give one, as in link = "crank"'
    return _NOT_OF_NETS.get(words, "") if detail["type"] == "extra_forbidden" else ""


def value_flaws(raw: Mapping[str, Any], source: str) -> list[Problem]:
    """What is wrong with numbers, words and units of joints, pins and rods between links by name."""
    _, problems = _checked(raw, context_of(raw, source))
    rods = enumerate(entries(raw, "rod"), 1)
    thick = tuple(f"rod[{i}]" for i, table in rods if "radius" in table and "between" not in table)
    units = ("format", "length_unit", "angle_unit")
    return [
        p
        for p in problems
        if p.place in units
        or (p.place.startswith(("joint[", "pin[", "rod[")) and not p.place.startswith(thick))
    ]
