"""What acts on a linkage, as a file has it: [forces], [[body]], [[load]] and [[spring]], and their values."""

from __future__ import annotations

from functools import partial
from typing import Annotated, Any

from pydantic import BeforeValidator, ValidationInfo, WithJsonSchema

from sevenbar.description.formulas import load_kinds, spring_kinds
from sevenbar.description.values import (
    FORMULA,
    POSITIVE,
    Component,
    Direction,
    Length,
    Number,
    TableForm,
    Text,
    Vector,
    carried,
    key,
    number_for,
    one_of,
    parts_of,
    refuse,
    three,
)
from sevenbar.errors import RequestError, shown
from sevenbar.forces.bodies import ENTRIES, SOLIDS, density_of, flaw_of_inertia, tensor_of
from sevenbar.forces.solids import DENSITIES
from sevenbar.text.units import MASSES

#: Along which axes a load may be given.
LOAD_AXES = ("ground", "link")


def _mass(value: object, info: ValidationInfo) -> float:
    number = number_for(value, info, "mass")
    if number <= 0:
        raise refuse(f"{shown(value)} is not a mass; give a number > 0")
    return number


def _inertia(value: object, info: ValidationInfo) -> float | tuple[float, ...]:
    if isinstance(value, (int, float, str)) and not isinstance(value, bool):
        moment = number_for(value, info, "inertia")
        if moment < 0:
            raise refuse(f"{shown(value)} is not a moment of inertia; give a number >= 0")
        return moment
    parts = parts_of(
        value,
        6,
        f"is not an inertia; give six numbers, {ENTRIES} of the tensor, or of a planar linkage one, about "
        "the axis across its plane",
    )
    entries = tuple(number_for(part, info, "inertia") for part in parts)
    if flaw := flaw_of_inertia(tensor_of(entries)):
        raise refuse(flaw)
    return entries


def _of_spring(value: object, info: ValidationInfo, key: str) -> float:
    """A number of a spring, an angle in radians; `joint` is read before it."""
    table = {"joint": joint} if (joint := info.data.get("joint")) is not None else {}
    return carried(value, info, spring_kinds(table, info.context or {})[key])


def _of_input(value: object, info: ValidationInfo) -> float:
    """A value of the input, an angle in radians."""
    return carried(value, info, load_kinds({}, info.context or {})["between"])


def _between(value: object, info: ValidationInfo) -> tuple[float, float]:
    ends = parts_of(value, 2, "is not a range of the input; give two values, as in [30, 120]")
    return _of_input(ends[0], info), _of_input(ends[1], info)


def _table(value: object, info: ValidationInfo) -> tuple[tuple[float, float], ...]:
    """The rows of a table: values of the input, an angle in radians, and factors."""
    if isinstance(value, str):
        # what can be read has been replaced by its rows
        from sevenbar.description.load_tables import rows_of

        try:
            value = rows_of(value, info.context or {})
        except RequestError as error:
            raise refuse(str(error)) from None
    rows: Any = value if isinstance(value, (list, tuple)) else [value]
    if not all(isinstance(row, (list, tuple)) and len(row) == 2 for row in rows):
        raise refuse(
            f"{shown(value)} is not a table; give the name of a CSV file, or rows of input and factor, "
            "as in [[0, 0], [30, 1], [60, 0]]"
        )
    return tuple((_of_input(at, info), number_for(factor, info, "number")) for at, factor in rows)


def _link(value: object) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or value < 1:
        raise refuse(f"{shown(value)} is not a link; give its number, counted from 1")
    return value


def _two(value: object) -> object:
    return parts_of(value, 2, "are not two; give one for each of the two links")


def _two_ends(value: object) -> object:
    return value if value is None else parts_of(value, 2, "are not two ends; give two places")


def _three_edges(value: object) -> object:
    return value if value is None else parts_of(value, 3, "is no size of a box; give its three edges")


def _density(value: object, info: ValidationInfo) -> float:
    if isinstance(value, str) and value in DENSITIES:
        return DENSITIES[value]
    if isinstance(value, str):
        try:
            value = density_of(value)
        except RequestError as error:
            raise refuse(str(error).removeprefix("density: ")) from None
    number = number_for(value, info, "density")
    if number <= 0:
        raise refuse(f"{shown(value)} is not a density; give kg/m^3 > 0")
    return number


_JSON = WithJsonSchema(FORMULA)
_Vector = tuple[Component, Component, Component]

Mass = Annotated[float, BeforeValidator(_mass), POSITIVE]
Density = Annotated[float, BeforeValidator(_density), WithJsonSchema({"type": ["number", "string"]})]
Inertia = Annotated[
    Component | tuple[Component, Component, Component, Component, Component, Component],
    BeforeValidator(_inertia),
]
Acceleration = Annotated[_Vector, BeforeValidator(partial(three, kind="acceleration"))]
Force = Annotated[_Vector, BeforeValidator(partial(three, kind="force"))]
Torque = Annotated[_Vector, BeforeValidator(partial(three, kind="torque"))]
Link = Annotated[int, BeforeValidator(_link), WithJsonSchema({"type": "integer", "minimum": 1})]
TwoLinks = Annotated[tuple[Link, Link], BeforeValidator(_two)]
Between = Annotated[tuple[Component, Component], BeforeValidator(_between)]
Table = Annotated[
    tuple[tuple[float, float], ...],
    BeforeValidator(_table),
    WithJsonSchema({"type": ["string", "array"], "items": {"type": "array"}}),
]
Stiffness = Annotated[float, BeforeValidator(partial(_of_spring, key="stiffness")), _JSON]
Damping = Annotated[float, BeforeValidator(partial(_of_spring, key="damping")), _JSON]
Free = Annotated[float, BeforeValidator(partial(_of_spring, key="free")), _JSON]


class ForcesForm(TableForm):
    """What holds for all bodies."""

    gravity: Annotated[Acceleration, key("acceleration in the report frame; left out, none", "m/s^2")] = (
        0.0,
        0.0,
        0.0,
    )
    mass_unit: Annotated[str, *one_of("unit", MASSES), key("of the masses and inertias in this file")] = "kg"


class BodyForm(TableForm):
    """A body on a link; several of a link add up."""

    link: Annotated[Link, key("the link that carries it, counted from 1; not the ground")]
    mass: Annotated[Mass | None, key("left out with density, and with solid = drawn", "mass_unit")] = None
    centre: Annotated[Vector | None, key("of mass, written as a point of the link is", "length")] = None
    inertia: Annotated[
        Inertia | None,
        key(
            f"entries {ENTRIES} of the tensor about the centre, along the axes of points; of a planar "
            "linkage one number, about the axis across its plane; left out, none",
            "mass_unit length_unit^2",
        ),
    ] = None
    solid: Annotated[
        str | None,
        *one_of("solid", SOLIDS),
        key(
            "rod: uniform and thin, between the link's two joints; cylinder, box: uniform, by their sizes; "
            "point: in its centre; drawn: as exports draw it"
        ),
    ] = None
    density: Annotated[
        Density | None,
        key(f"of a cylinder or a box in place of mass, or a material: {', '.join(DENSITIES)}", "kg/m^3"),
    ] = None
    diameter: Annotated[Length | None, key("of a cylinder", "length")] = None
    bore: Annotated[Length | None, key("of a cylinder that is a tube", "length")] = None
    ends: Annotated[
        tuple[Vector, Vector] | None,
        BeforeValidator(_two_ends),
        key("of a cylinder: the middles of its ends; left out, the link's two joints", "length"),
    ] = None
    size: Annotated[
        tuple[Length, Length, Length] | None,
        BeforeValidator(_three_edges),
        key("of a box: its three edges; its middle is centre", "length"),
    ] = None
    along: Annotated[
        Direction | None, key("of a box: direction of the first edge; left out, x of the points")
    ] = None
    side: Annotated[
        Direction | None,
        key("of a box: direction of the second edge, made square to the first; left out, y of the points"),
    ] = None
    name: Annotated[Text | None, key("for people; optional")] = None


class LoadForm(TableForm):
    """A force at a point of a link, a torque on it."""

    link: Annotated[Link, key("the link on which it acts, counted from 1; not the ground")]
    at: Annotated[Vector | None, key("the point of a force, written as a point of the link is", "length")] = (
        None
    )
    force: Annotated[Force, key("on the link", "N")] = (0.0, 0.0, 0.0)
    torque: Annotated[Torque, key("on the link", "N m")] = (0.0, 0.0, 0.0)
    axes: Annotated[
        str,
        *one_of("choice of axes", LOAD_AXES),
        key("of force and torque: those of the report frame, or those of the link's points"),
    ] = "ground"
    between: Annotated[
        Between | None,
        key(
            "from where to where of the input it acts, rising, a turn at most; left out, everywhere",
            "angle_unit, or length",
        ),
    ] = None
    table: Annotated[
        Table | None,
        key(
            "its factor along the input: a CSV file below the folder of this one, "
            "or rows of input (angle_unit, or length) and factor"
        ),
    ] = None
    name: Annotated[Text | None, key("for people; optional")] = None


class SpringForm(TableForm):
    """A spring with a damper, between points of two links or in a joint."""

    # before the numbers, whose units depend on it
    joint: Annotated[Text | None, key("the joint in which it is; or links")] = None
    links: Annotated[TwoLinks | None, key("the two links between which it is, counted from 1; or joint")] = (
        None
    )
    at: Annotated[
        tuple[Vector, Vector] | None, key("its two ends, written as points of these links are", "length")
    ] = None
    stiffness: Annotated[Stiffness, key("left out, 0", "N/length_unit; in a joint that turns N m/rad")] = 0.0
    length: Annotated[Number | None, key("between links: where it is free; left out, 0", "length")] = None
    free: Annotated[
        Free | None,
        key("in a joint: the joint's value where it is free; left out, 0", "angle_unit, or length"),
    ] = None
    damping: Annotated[Damping, key("left out, 0", "N s/length_unit; in a joint that turns N m s/rad")] = 0.0
    name: Annotated[Text | None, key("for people; optional")] = None
