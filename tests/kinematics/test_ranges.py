"""One grammar of ranges for every option that takes one."""

import pytest

import sevenbar as sb
from sevenbar.commands.given import angles, lengths
from sevenbar.commands.path import parsed_bounds
from sevenbar.commands.points import parsed_box, parsed_masses
from sevenbar.description.draft import Draft
from sevenbar.design.maps.window import axes_of, split_ranges
from sevenbar.errors import RequestError
from sevenbar.sweep.axes import axis_from_text, axis_of
from sevenbar.text.ranges import split_grid, split_named, split_range

DRAFT = Draft.of_linkage(sb.load("rssr"))

#: What people write, and the two ends [mm] that it means in a file in millimetres.
WRITTEN = {
    "100:400": (100, 400),
    "10:40cm": (100, 400),
    "10cm:40cm": (100, 400),
    "10 : 40 cm": (100, 400),
    "100mm:0.4m": (100, 400),
    "10..40cm": (100, 400),
    "1e2:4e2mm": (100, 400),
    ".1:.4m": (100, 400),
}


@pytest.mark.parametrize("text", WRITTEN)
def test_a_range_means_the_same_in_every_option(text: str) -> None:
    length = DRAFT.dimension("L1")
    along, _ = axes_of(DRAFT, split_ranges([f"L1={text}", "L3=1:2"]))
    bound = parsed_bounds([f"L1={text}"])["L1"]
    _, span = axis_from_text(f"L1={text.replace(':', '..')}")
    swept = axis_of(length, span)
    every = [
        (along.low, along.high),
        lengths("--size", text, "mm"),
        tuple(length.read(end) for end in bound),
        (swept.low, swept.high),
    ]
    for ends in every:
        assert ends == pytest.approx(WRITTEN[text], rel=1e-15)


def test_the_unit_of_a_grid_is_that_of_both_ends() -> None:
    _, written = axis_from_text("L1=20:30cm:51")
    grid = axis_of(DRAFT.dimension("L1"), written)
    assert (grid.low, grid.high, grid.count) == (200, 300, 51)


def test_values_of_a_list_have_units_of_their_own() -> None:
    _, written = axis_from_text("L3=500,0.55m")
    assert axis_of(DRAFT.dimension("L3"), written).listed == (500, 550)


def test_angles_may_have_the_sign_of_a_degree() -> None:
    assert angles("--x", "-90:90\u00b0") == angles("--x", "-90deg:90deg")


@pytest.mark.parametrize("text", ["", "1", "1:", ":2", "1:2:3", "1..2..3", "1:2..3"])
def test_what_is_no_range(text: str) -> None:
    assert split_range(text) is None


@pytest.mark.parametrize("text", ["", "1:2", "1:2:x", "1:2:3:4", "1:2:", "1:2:2.5", "1:2:-3"])
def test_what_is_no_grid(text: str) -> None:
    assert split_grid(text) is None


@pytest.mark.parametrize("word", ["L1", "=1:2", "L1=", " = "])
def test_a_word_without_name_or_value_is_refused_as_written(word: str) -> None:
    with pytest.raises(RequestError, match=r"^over: .* is not a range; give NAME=LOW:HIGH$"):
        split_named("over", [word], "a range", "give NAME=LOW:HIGH")
    with pytest.raises(RequestError, match="--mass"):
        parsed_masses([word])


def test_a_name_given_twice_is_refused() -> None:
    with pytest.raises(RequestError, match=r"L1.* is given twice"):
        split_named("over", ["L1=1:2", "L1 = 2:3"], "a range", "give one")


def test_sides_of_a_box_are_ranges_or_numbers() -> None:
    assert parsed_box("-200:200,0..5cm,7", "mm") == [(-200, 200), (0, 50), (7, 7)]


def test_a_formula_at_the_end_of_a_range_is_no_unit() -> None:
    assert split_range("100:2*200") == ("100", "2*200")
