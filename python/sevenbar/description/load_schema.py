"""What acts on a linkage, as a file has it: the models of [forces], [[body]], [[load]] and [[spring]]."""

from __future__ import annotations

from typing import Annotated

from pydantic import WithJsonSchema

from sevenbar.description.load_values import (
    Acceleration,
    Between,
    Damping,
    Force,
    Free,
    Inertia,
    Link,
    Mass,
    Stiffness,
    Table,
    Torque,
    TwoLinks,
)
from sevenbar.description.values import Number, TableForm, Text, Vector, key, one_of
from sevenbar.forces.bodies import ENTRIES, SOLIDS
from sevenbar.text.units import MASSES

#: Along which axes a load may be given.
LOAD_AXES = ("ground", "link")


class ForcesForm(TableForm):
    """What holds for all bodies."""

    gravity: Annotated[Acceleration, key("acceleration in the report frame; left out, none", "m/s^2")] = (
        0.0,
        0.0,
        0.0,
    )
    mass_unit: Annotated[
        str,
        one_of("unit", MASSES),
        WithJsonSchema({"enum": list(MASSES)}),
        key("of the masses and inertias in this file"),
    ] = "kg"


class BodyForm(TableForm):
    """A body on a link; several of a link add up."""

    link: Annotated[Link, key("the link that carries it, counted from 1; not the ground")]
    mass: Annotated[Mass | None, key("left out with solid = drawn: of steel", "mass_unit")] = None
    centre: Annotated[Vector | None, key("of mass, written as a point of the link is", "length")] = None
    inertia: Annotated[
        Inertia | None,
        key(
            f"entries {ENTRIES} of the tensor about the centre, along the axes of points; left out, none",
            "mass_unit length_unit^2",
        ),
    ] = None
    solid: Annotated[
        str | None,
        one_of("solid", SOLIDS),
        WithJsonSchema({"enum": list(SOLIDS)}),
        key("rod: uniform, between the link's two joints; point: in its centre; drawn: as exports draw it"),
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
        one_of("choice of axes", LOAD_AXES),
        WithJsonSchema({"enum": list(LOAD_AXES)}),
        key("of force and torque: those of the report frame, or those of the link's points"),
    ] = "ground"
    between: Annotated[
        Between | None,
        key(
            "from where to where of the input it acts, rising; left out, everywhere", "angle_unit, or length"
        ),
    ] = None
    table: Annotated[
        Table | None,
        key(
            "its factor along the input: a CSV file in the folder of this one, "
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
