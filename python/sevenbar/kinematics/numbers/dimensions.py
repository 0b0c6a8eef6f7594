"""The numbers of a description by name: their units, places in a file, and which one follows from others."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.errors import RequestError, shown
from sevenbar.kinematics.loop.geometry import Loop, Place, following_coupler
from sevenbar.kinematics.numbers.lengths import LONGER, drawn_length, link_names
from sevenbar.text.units import ANGLES, MASSES, examples_of


@dataclass(frozen=True)
class Dimension:
    """A number of the description that can be changed.

    `name` is its own among all: "L1"; "length_2"; "crank.axis_x"; "P.u". `value` and `unit` are the file's;
    `group` is what it belongs to; `follows` where the file leaves it out and it follows from the others. The
    file has a length of a drawing as what it is longer than the `drawn` one.
    """

    name: str
    place: Place
    label: str
    group: str
    unit: str
    value: float
    positive: bool = False
    follows: bool = False
    drawn: float = 0.0

    @property
    def key(self) -> str:
        """Its place as messages tell it: `rssr.L1`, `link[2].twist`, `joint[1].at[3]`."""
        parts = [f"[{part + 1}]" if isinstance(part, int) else f".{part}" for part in self.place]
        return "".join(parts).lstrip(".")

    @property
    def column(self) -> str:
        """Its name in tables, with the unit: `L1_mm`, `twist_2_deg`."""
        return f"{self.name}_{self.unit.replace('/', '_')}" if self.unit else self.name

    @property
    def kind(self) -> Literal["length", "angle", "pitch", "number", "speed", "mass"]:
        """What its value is."""
        if self.unit in MASSES:
            return "mass"
        if "/" in self.unit or self.unit == "rpm":
            return "pitch" if self.unit.endswith("turn") else "speed"
        if self.unit in ANGLES:
            return "angle"
        return "length" if self.unit else "number"

    @property
    def scale(self) -> float:
        """The size of its unit beside the one that is carried: radian, length unit, kilogram."""
        return ANGLES.get(self.unit, MASSES.get(self.unit, 1.0))

    def read(self, text: str) -> float:
        """The value that a person wrote, in the dimension's unit: "250", "25 cm", "30deg".

        Raises `RequestError` for a text that is no finite number with a unit that fits.
        """
        # `import sevenbar` needs no reader of formulas
        from sevenbar.text.amounts import amount_in

        value = amount_in(text, self.unit)
        if value is None:
            comma = " (a decimal point, not a comma)" if "," in text else ""
            given = shown(text.strip())
            hint = examples_of(self.unit)
            raise RequestError(f"{self.key}: {given} is not a finite {self.kind}; give {hint}{comma}")
        return value


def read_at(option: str, dimension: Dimension, text: str) -> float:
    """The value of a text given for a dimension; raises `RequestError` that names the option, not the file.

    >>> import sevenbar as sb
    >>> linkage = sb.load("rssr")
    >>> read_at("over", dimensions_of(linkage.description, linkage)[2], "25 cm")
    250.0
    """
    try:
        return dimension.read(text)
    except RequestError as error:
        raise RequestError(f"{option}: {dimension.name}{str(error).removeprefix(dimension.key)}") from None


def description_of(linkage: Loop) -> Mapping[str, Any]:
    """A linkage's own description; `RequestError` for one that was made without."""
    if not linkage.description:
        raise RequestError(
            f"linkage: '{linkage.name}' was made without a description; "
            "make it by load, rssr, from_dh or from_axes"
        )
    return linkage.description


def dimensions_of(description: Mapping[str, Any], linkage: Loop) -> tuple[Dimension, ...]:
    """Every number of a linkage's description that can be changed, in the order of the file."""
    length, angle = linkage.length_unit, str(description.get("angle_unit", "deg"))
    result: list[Dimension] = []
    for key in ("M", "N", "L1", "L2", "L3", "D") if linkage.form == "rssr" else ():
        given = description["rssr"].get(key)
        value = linkage.dimensions[key] if given is None else float(given)
        # L2 left out is that of the pose; it follows on request
        follows = given is None and key == "L2"
        place = ("rssr", key)
        positive = key[0] == "L"
        result.append(Dimension(key, place, key, "dimensions", length, value, positive, follows))
    units = {"twist": angle, "angle": angle, "pitch": f"{length}/turn"}
    joints = linkage.joints
    for i, row in enumerate(description.get("link", ())):
        group = f"link {i + 1}, after {joints[i].name} ({joints[i].kind})"
        for key in joints[i].row.row_keys:
            unit = units.get(key, length)
            value = float(row.get(key, 0.0))
            result.append(Dimension(f"{key}_{i + 1}", ("link", i, key), key, group, unit, value))
    result += _of_net(description, length) if linkage.net is not None else _of_loop(description, linkage)
    letters = "uvw" if linkage.in_rows else "xyz"
    for i, table in enumerate(description.get("point", ())):
        name = table["name"]
        result += _vector(("point", i, "at"), table["at"], letters, (name, f"point {name}"), length)
    speed = f"{linkage.unit_of(linkage.drive.joint)}/s"
    result.append(Dimension("speed", ("drive", "speed"), "speed", "drive", speed, linkage.drive.speed))
    # a point may have the name of a joint
    taken = Counter(dimension.name for dimension in result)
    return tuple(replace(d, name=d.key) if taken[d.name] > 1 else d for d in result)


def lengths_of(description: Mapping[str, Any], linkage: Loop) -> tuple[Dimension, ...]:
    """The length of each moving link of a drawing, whether or not the file says that it is longer."""
    tables = description.get("joint", ())
    result = []
    for i, name in enumerate(link_names(linkage)[: len(tables)]):
        drawn = drawn_length(tables, i)
        # without the rounding of a sum
        value = float(f"{drawn + float(tables[i].get(LONGER, 0.0)):.15g}")
        group, place = f"link {i + 1}", ("joint", i, LONGER)
        one = Dimension(
            name.replace(" ", "_"), place, name, group, linkage.length_unit, value, positive=True, drawn=drawn
        )
        result.append(one)
    return tuple(result)


def check_apart(option: str, dimensions: Sequence[Dimension]) -> None:
    """Raises `RequestError` for a length of a drawing together with a number of a joint at its ends.

    A length counts from the drawn one, which would change with that number.
    """
    for length in dimensions:
        if not length.drawn:
            continue
        ends = length.place[1], int(length.place[1]) + 1
        for other in dimensions:
            if other.place[0] == "joint" and other.place[1] in ends and not other.drawn:
                raise RequestError(
                    f"{option}: {length.name} counts from its drawn length, which {other.name} changes; "
                    "give one of the two"
                )


def masses_of(description: Mapping[str, Any]) -> tuple[Dimension, ...]:
    """The mass of each body that has one: mass_2 is that of the one body of link 2."""
    bodies = description.get("body", ())
    unit = str(description.get("forces", {}).get("mass_unit", "kg"))
    alone = Counter(body["link"] for body in bodies)
    result = []
    for i, body in enumerate(bodies):
        if "mass" in body:
            name, group = f"mass_{body['link']}", f"body of link {body['link']}"
            one = Dimension(
                name, ("body", i, "mass"), "mass", group, unit, float(body["mass"]), positive=True
            )
            result.append(one if alone[body["link"]] == 1 else replace(one, name=one.key))
    return tuple(result)


def _of_loop(description: Mapping[str, Any], linkage: Loop) -> list[Dimension]:
    """The numbers of a loop as drawn: its joints, and the lengths that its file has."""
    result = []
    for i, table in enumerate(description.get("joint", ())):
        result += _of_drawn(i, table, linkage.joints[i].name, linkage.length_unit)
    return result + [
        d for d in lengths_of(description, linkage) if LONGER in description["joint"][d.place[1]]
    ]


def _of_net(description: Mapping[str, Any], length: str) -> list[Dimension]:
    """The numbers of a net as drawn: its joints, pins and rods."""
    result = []
    for i, table in enumerate(description.get("joint", ())):
        result += _of_drawn(i, table, str(table.get("name", f"theta_{i + 1}")), length)
    for i, table in enumerate(description.get("pin", ())):
        name = str(table.get("name", f"pin_{i + 1}"))
        result += _vector(("pin", i, "at"), table["at"], "xy", (name, f"pin {name}"), length)
    for i, table in enumerate(description.get("rod", ())):
        name = str(table.get("name", f"rod_{i + 1}"))
        for end, (at, link) in enumerate(zip(table["at"], table["between"], strict=True)):
            letters = [f"{link} {letter}" for letter in "xyz"]
            result += _vector(("rod", i, "at", end), at, letters, (name, f"rod {name}"), length)
    return result


def _of_drawn(index: int, table: Mapping[str, Any], name: str, length: str) -> list[Dimension]:
    """The numbers of a joint as drawn."""
    place = ("joint", index)
    whose = (name, f"{name} ({table['kind']})")
    result = _vector((*place, "at"), table["at"], "xyz", whose, length)
    if "axis" in table:
        result += _vector((*place, "axis"), table["axis"], ("axis x", "axis y", "axis z"), whose, "")
    for which, axis in enumerate(table.get("axes", ())):
        letters = [f"axis {which + 1} {letter}" for letter in "xyz"]
        result += _vector((*place, "axes", which), axis, letters, whose, "")
    if "pitch" in table:
        _, group = whose
        unit, pitch = f"{length}/turn", float(table["pitch"])
        result.append(Dimension(f"{name}.pitch", (*place, "pitch"), "pitch", group, unit, pitch))
    return result


def _vector(
    place: Place, values: Sequence[float], labels: Sequence[str], whose: tuple[str, str], unit: str
) -> list[Dimension]:
    """The numbers of a vector; `whose`: the name of its owner, and what the owner is called among others."""
    name, group = whose
    return [
        Dimension(f"{name}.{label.replace(' ', '_')}", (*place, axis), label, group, unit, float(value))
        for axis, (label, value) in enumerate(zip(labels, values, strict=True))
    ]


#: What a coupler follows from, in the order of `following_coupler`.
LEADERS = ("M", "N", "L1", "L3")


@dataclass(frozen=True)
class Following:
    """The place of L2 among k numbers, and those of M, N, L1 and L3, from which it follows.

    With c = L1 - M:  `L2^2 = c^2 + L3^2 + N^2`,  `L2 dL2 = c (dL1 - dM) + L3 dL3 + N dN`.
    """

    own: int
    leaders: tuple[int, ...]

    @staticmethod
    def among(dimensions: Sequence[Dimension], but: Sequence[int] = ()) -> Following | None:
        """That of the dimensions, `None` where none follows; `but` places are numbers of their own."""
        places = {d.place[1]: k for k, d in enumerate(dimensions) if d.place[0] == "rssr"}
        own = next((k for k, d in enumerate(dimensions) if d.follows and k not in but), None)
        return None if own is None else Following(own, tuple(places[name] for name in LEADERS))

    def whole(self, values: Floats) -> Floats:
        """The numbers (.., k) with the coupler that follows from them."""
        values = np.array(values, dtype=np.float64)
        values[..., self.own] = following_coupler(*(values[..., k] for k in self.leaders))
        return values

    def slopes(self, values: Floats) -> Floats:
        """The derivatives (4,) of the coupler at numbers (k,) by those that it follows from."""
        m, n, crank, rocker = values[list(self.leaders)]
        parts: Floats = np.array([m - crank, n, crank - m, rocker]) / self.whole(values)[self.own]
        return parts

    def chained(self, slopes: Floats, values: Floats) -> Floats:
        """Derivatives (.., k), those by the coupler passed on to what it follows from."""
        slopes = np.array(slopes, dtype=np.float64)
        slopes[..., list(self.leaders)] += slopes[..., self.own, None] * self.slopes(values)
        slopes[..., self.own] = 0.0
        return slopes
