"""The page of the grammar of values: every example goes through the reader that the commands use."""

import math
import re
from collections.abc import Callable

import pytest

import sevenbar as sb
from places import DOCS
from sevenbar.commands.command import count_of
from sevenbar.commands.given import angle, angles, input_value, lengths, numbers, point_of
from sevenbar.commands.path import parsed_bounds
from sevenbar.commands.points import parsed_box
from sevenbar.description.draft import Draft
from sevenbar.design.maps.window import axes_of, split_ranges
from sevenbar.errors import RequestError, SevenbarError
from sevenbar.sweep.axes import axis_from_text, axis_of
from sevenbar.text.amounts import value_of
from sevenbar.text.quantities import quantity_of
from sevenbar.text.ranges import split_name
from sevenbar.text.units import turning_speed

PAGE = (DOCS / "values.md").read_text(encoding="utf-8")
LINKAGE = sb.load("rssr")
DRAFT = Draft.of_linkage(LINKAGE)
L1 = DRAFT.dimension("L1")


def tables() -> dict[str, list[list[str]]]:
    """The rows of each table by the words of its first line; code without its marks."""
    found = {}
    for table in re.findall(r"(?:^\|.*\n)+", PAGE, flags=re.MULTILINE):
        lines = [
            [cell.strip().strip("`") for cell in line.strip("|\n").split("|")] for line in table.splitlines()
        ]
        found[lines[0][0]] = lines[2:]
    return found


def span(text: str) -> str:
    along, _ = axes_of(DRAFT, split_ranges([f"L1={text}", "L3=1:2"]))
    bound = parsed_bounds([f"L1={text}"])["L1"]
    every = {(along.low, along.high), tuple(L1.read(end) for end in bound), lengths("--size", text, "mm")}
    (low, high), *others = sorted(every)
    assert all(other == pytest.approx((low, high), rel=1e-15) for other in others)
    return f"{low:g} to {high:g} mm"


def swept(text: str) -> str:
    _, written = axis_from_text(f"L1={text}")
    axis = axis_of(L1, written)
    if axis.listed:
        return f"{', '.join(f'{value:g}' for value in axis.listed)} mm"
    if axis.count:
        return f"{axis.count} values from {axis.low:g} to {axis.high:g} mm"
    return f"between {axis.low:g} and {axis.high:g} mm"


def turned(text: str) -> str:
    low, high = (math.degrees(end) for end in angles("--input-range", text))
    return f"{low:g} to {high:g} deg"


def boxed(text: str) -> str:
    sides = zip("uvw", parsed_box(text, "mm"), strict=True)
    return ", ".join(f"{letter} {low:g} to {high:g}" for letter, (low, high) in sides) + " mm"


def placed(text: str) -> str:
    point = point_of(None, "4", text, LINKAGE)
    assert isinstance(point, tuple)
    return f"({', '.join(f'{value:g}' for value in point[1])})"


READERS: dict[str, Callable[[str], str]] = {
    "L1": lambda text: f"{L1.read(text):g} mm",
    "crank": lambda text: f"{math.degrees(input_value('--at', text, LINKAGE, None)):g} deg",
    "speed": lambda text: f"{turning_speed(text):g} rad/s",
    "range of L1": span,
    "range of angles": turned,
    "range of x": lambda text: "{:g} to {:g}".format(*numbers("--x", text)),
    "values of L1": swept,
    "place": placed,
    "box": boxed,
    "formula of a length": lambda text: f"{value_of(text, 'length'):g} mm",
    "formula of an angle": lambda text: f"{value_of(text, 'angle'):g} deg",
    "mass in a file": lambda text: f"{quantity_of(text, 'mass'):g} kg",
    "inertia in a file": lambda text: f"{quantity_of(text, 'inertia'):g} kg mm^2",
    "torque in a file": lambda text: f"{quantity_of(text, 'torque'):g} N m",
    "stiffness in a file": lambda text: f"{quantity_of(text, 'stiffness'):g} N/mm",
    "stiffness in a joint": lambda text: f"{quantity_of(text, 'turning stiffness'):g} N m/rad",
    "count": lambda text: f"{count_of('--samples')(text)}",
}

REFUSING: dict[str, Callable[[str], object]] = {
    "--over": lambda text: axes_of(DRAFT, split_ranges([text, "L3=1:2"])),
    "--size": lambda text: lengths("--size", text, "mm"),
    "--at": lambda text: point_of(None, "4", text, LINKAGE),
    "--box": lambda text: parsed_box(text, "mm"),
    "L1": lambda text: value_of(text, "length"),
    "mass": lambda text: quantity_of(text, "mass"),
    "--samples": count_of("--samples"),
    "--swing": lambda text: angle("--swing", text),
}


def test_every_table_of_the_page_has_its_reader():
    assert set(tables()) == {*READERS, "word", "option", "call"}


@pytest.mark.parametrize("kind", READERS)
def test_every_example_means_what_the_page_says(kind: str):
    rows = tables()[kind]
    assert rows
    for text, meaning in rows:
        assert READERS[kind](text) == meaning


def test_a_text_in_python_has_the_message_of_the_page():
    for call, text, message in tables()["call"]:
        with pytest.raises(RequestError) as caught:
            getattr(LINKAGE, call)(text)
        assert str(caught.value) == message


def test_names_and_values_are_parted_as_the_page_says():
    for word, name, value in tables()["word"]:
        assert split_name(word) == (name, value)


def test_every_refusal_has_the_message_of_the_page():
    for option, text, message in tables()["option"]:
        with pytest.raises(SevenbarError) as caught:
            REFUSING[option](text)
        assert str(caught.value) == message
