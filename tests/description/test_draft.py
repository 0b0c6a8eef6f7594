"""A draft: what is shown is what is written, and what was written by a person stays.

Source: `tomllib`, which reads both texts; comments are counted by lines, as a person would.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import sevenbar as sb
from gallery_sample import sampled
from sevenbar.description.draft import Draft
from sevenbar.description.files import loads
from sevenbar.description.gallery import loops, text
from sevenbar.errors import RequestError, SevenbarError
from sevenbar.kinematics.numbers.dimensions import Dimension
from sevenbar.studio.panels.shaping import largest_length, number_text, slider_range

RSSR = "M = 700\nN = 700 # height\nL1 = 250\nL3=550\nD = 0 # none\n"
ROWS = (
    (45, 1.4, 70),
    (15, -1.6, 10),
    (100, 0, 10),
    (-115, 0, 10),
    (10, -1.3, 10),
    (35, 1.4, 10),
    (35, 2.6, -60),
)
DRAWN = "kind='R', at=[0,0,0], axis=[0,0,1]|kind='S', at=[0,100,0]|kind='S', at=[220,130,0]|kind='R', at=[200,0,0], axis=[0,0,1]"

#: The ways in which one description can be written.
WAYS = {
    "tables": f"format = 1\n[drive] # slow\nspeed = '60 rpm' # a turn a second\n\n[rssr]\n{RSSR}\n# the end",
    "dotted": "format = 1\n"
    + "".join(f"rssr.{line}\n" for line in RSSR.splitlines())
    + "drive.speed = 3 # s\n",
    "inline": "format = 1 # f\nrssr = {M = 700, N = 700, L1 = 250, L3 = 550, D = 0} # here\ndrive = {speed = -3}\n"
    "point = [{name='Q', link=2, at=[1,2,3]}, {name='T', link=3, at=[1, 2, 4]}] # both\n",
    "inline joints": "format = 1\njoint = [\n"
    + "".join(f" {{{joint}}}, # {i}\n" for i, joint in enumerate(DRAWN.split("|")))
    + " # that is all\n]\n",
    "long arrays": "format = 1\n"
    + "".join(
        "[[joint]]\n" + re.sub(r", (?=at|axis)", "\n", joint).replace("[", "[\n  # first x\n  ") + "\n"
        for joint in DRAWN.split("|")
    ),
    "out of order": f"format = 1\n[[point]] # p\nname='Q'\nlink=1\nat=[1,2,3]\n[rssr]\n{RSSR}[[point]] # q\nname='T'\nlink=2\nat=[1,2,4]\n",
    "radians, inches": "format = 1\nangle_unit = 'rad'\nlength_unit = 'in'\n"
    + "".join(
        f"[[link]]\nlength={a} # a{i}\ntwist={w}\noffset={d}\n\n# next {i}\n"
        for i, (a, w, d) in enumerate(ROWS)
    ),
    "windows": text("seven_r").replace("\n", "\r\n"),
    "no last line end": f"format = 1\n[rssr]\n{RSSR}".rstrip(),
}
TEXTS = {name: text(name) for name in loops()} | WAYS


def comments(content: str) -> list[str]:
    return sorted(line.split("#", 1)[1].strip() for line in content.splitlines() if "#" in line)


def leaves(value: Any, place: tuple[Any, ...] = ()) -> Iterator[tuple[tuple[Any, ...], Any]]:
    """Every place of a TOML document and what stands there."""
    if isinstance(value, dict | list):
        for key, inner in value.items() if isinstance(value, dict) else enumerate(value):
            yield from leaves(inner, (*place, key))
    else:
        yield place, value


def same_bits(one: sb.Linkage, other: sb.Linkage) -> bool:
    arrays = ("base", "ground", "links", "point_frames")
    return (
        all(getattr(one, name).tobytes() == getattr(other, name).tobytes() for name in arrays)
        and (one.joints, one.points, one.drive, one.length_unit, one.name)
        == (other.joints, other.points, other.drive, other.length_unit, other.name)
        and dict(one.dimensions) == dict(other.dimensions)
    )


def moved(dimension: Dimension) -> float:
    return dimension.value * 1.0625 if dimension.value else 0.375


@pytest.mark.parametrize("name", TEXTS)
def test_a_text_that_nothing_changed_comes_back_byte_for_byte(name: str) -> None:
    assert Draft.of(TEXTS[name], name).toml() == TEXTS[name]


@pytest.mark.parametrize("name", [*sampled(), *WAYS])
def test_a_changed_dimension_is_the_only_place_that_differs_in_the_file(name: str) -> None:
    content = TEXTS[name]
    draft = Draft.of(content, name)
    before = dict(leaves(tomllib.loads(content)))
    assert draft.dimensions
    for dimension in draft.dimensions:
        value = moved(dimension)
        changed = draft.with_value(dimension.place, draft.written(dimension, value))
        try:
            shown = changed.linkage
        except SevenbarError:
            assert name == "rssr" or dimension.place[0] == "joint", dimension.key
            continue
        written = changed.toml()
        after = dict(leaves(tomllib.loads(written)))
        differing = {place for place in before | after if before.get(place) != after.get(place)}
        assert differing == {dimension.place}
        now = after[dimension.place]
        assert now == (f"{value!r} {dimension.unit}" if dimension.label == "speed" else value)
        assert comments(written) == comments(content), dimension.key
        assert same_bits(loads(written), shown), dimension.key
        # and what is read back says of the dimension what was asked for
        again = {d.place: d for d in Draft.of(written, name).dimensions}
        assert again[dimension.place].value == value
        assert ("\r\n" in written) == ("\r\n" in content)
        assert written.count("\r\n") in (0, written.count("\n"))


@pytest.mark.parametrize("name", TEXTS)
def test_points_come_and_go_and_leave_the_rest_of_the_file(name: str) -> None:
    content = TEXTS[name]
    draft = Draft.of(content, name)
    count = len(draft.raw.get("point", ()))
    more = draft.with_point("added first", 1, (1.5, -2.0, 0.1)).with_point("added last", 2, (0.0, 1e-7, 1e20))
    written = more.toml()
    assert comments(written) == comments(content)
    assert tomllib.loads(written)["point"][count:] == [
        {"name": "added first", "link": 1, "at": [1.5, -2.0, 0.1]},
        {"name": "added last", "link": 2, "at": [0.0, 1e-7, 1e20]},
    ]
    assert same_bits(loads(written), more.linkage)
    assert [point.name for point in more.linkage.points][-2:] == ["added first", "added last"]
    less = more.without_point(count + 1).without_point(count)
    assert less.toml() == content
    # a text that has them loses them again, one after the other
    saved = Draft.of(written, name)
    assert comments(saved.without_point(count).toml()) == comments(content)
    back = saved.without_point(count).without_point(count)
    assert tomllib.loads(back.toml()) == tomllib.loads(content)
    assert comments(back.toml()) == comments(content) or not count


def test_a_point_that_goes_takes_its_own_comments_and_no_others() -> None:
    head = f"format = 1\n[rssr]\n{RSSR}\n"
    points = [
        f"[[point]] # head {n}\nname = '{n}' # name {n}\nlink = {i}\nat = [1, 2, 3] # at {n}\n"
        for i, n in enumerate("abc", 1)
    ]
    draft = Draft.of(head + "".join(points), "points")
    for gone, name in enumerate("abc"):
        left = draft.without_point(gone).toml()
        assert comments(left) == [c for c in comments(draft.text) if not c.endswith(f" {name}")]
        for other in set("abc") - {name}:
            assert f"[[point]] # head {other}\nname = '{other}' # name {other}\n" in left


def test_the_comments_inside_a_long_array_stay() -> None:
    content = WAYS["long arrays"]
    changed = Draft.of(content, "x").with_value(("joint", 2, "at", 1), 131.5).toml()
    old, new = content.splitlines(), changed.splitlines()
    assert [(a, b) for a, b in zip(old, new, strict=True) if a != b] == [("  220,130,0]", "  220,131.5,0]")]


@pytest.mark.parametrize("way", ["inline", "dotted", "inline joints", "tables", "windows"])
def test_a_drive_is_written_where_the_file_has_none_or_half_of_one(way: str) -> None:
    draft = Draft.of(WAYS[way], way)
    first, last = draft.linkage.drivable()[0], draft.linkage.drivable()[-1]
    turned = draft.with_value(("drive", "joint"), last).with_value(("drive", "output"), first)
    read = loads(turned.toml())
    assert (read.drive.joint, read.drive.output) == (last, first)
    assert comments(turned.toml()) == comments(WAYS[way])


def test_l2_that_was_left_out_follows_until_it_is_given() -> None:
    draft = Draft.of(text("rssr"), "rssr")
    one = {d.label: d for d in draft.dimensions}
    assert one["L2"].follows
    assert one["L2"].value == pytest.approx(np.sqrt(450.0**2 + 550.0**2 + 700.0**2), rel=1e-15)
    assert "L2" not in draft.with_value(one["M"].place, 650.0).toml()
    given = draft.with_value(one["L2"].place, 1000.0)
    assert loads(given.toml()).lengths[1] == 1000.0
    assert not {d.label: d for d in given.dimensions}["L2"].follows


def test_dimensions_are_told_in_the_units_of_the_file() -> None:
    draft = Draft.of(WAYS["radians, inches"], "x")
    by_place = {d.place: d for d in draft.dimensions}
    assert [by_place["link", i, "twist"].value for i in range(7)] == [row[1] for row in ROWS]
    assert {by_place["link", 0, key].unit for key in ("length", "offset")} == {"in"}
    assert by_place["link", 0, "twist"].unit == "rad"
    assert by_place["drive", "speed"].unit == "rad/s"
    slides = Draft.of(text("rssp"), "rssp").with_value(("drive", "joint"), "slider")
    slides = slides.with_value(("drive", "output"), "crank").with_value(("drive", "speed"), "2 cm/s")
    (speed,) = [d for d in slides.dimensions if d.label == "speed"]
    assert (speed.unit, speed.value) == ("mm/s", 20.0)


#: What a person writes for a dimension of a unit, and what it comes to.
READ = [
    ("mm", "250", 250.0),
    ("mm", " 25 cm ", 250.0),
    ("mm", "1in", 25.4),
    ("mm", "-0.5 m", -500.0),
    ("in", "25.4mm", 1.0),
    ("mm", "1e2", 100.0),
    ("mm", ".5", 0.5),
    ("deg", "30", 30.0),
    ("deg", "30°", 30.0),
    ("deg", "30deg", 30.0),
    ("deg", "0.5rad", np.degrees(0.5)),
    ("rad", "30 deg", np.radians(30)),
    ("rad", "30°", np.radians(30)),
    ("rad", "0.5", 0.5),
    ("rad/s", "10", 10.0),
    ("rad/s", "60 rpm", 2 * np.pi),
    ("rad/s", "-90 deg/s", -np.pi / 2),
    ("mm/s", "1 in/s", 25.4),
    ("mm/turn", "12.5", 12.5),
    ("mm/turn", "1 cm/turn", 10.0),
    ("", "-1.5", -1.5),
]


@pytest.mark.parametrize(("unit", "given", "value"), READ)
def test_a_number_is_read_in_any_unit_that_fits(unit: str, given: str, value: float) -> None:
    dimension = Dimension("L1", ("rssr", "L1"), "L1", "dimensions", unit, 1.0)
    assert dimension.read(given) == pytest.approx(value, rel=1e-14)


@pytest.mark.parametrize("unit", ["mm", "deg", "rad", "rad/s", "mm/s", "mm/turn", ""])
@pytest.mark.parametrize(
    "given",
    ["", "  ", "abc", "NaN", "inf", "-inf", "1e400", "1,5", "1 2", "0x10", "5 kg", "1e9999 mm", "<b>"],
)
def test_what_is_no_number_is_refused_with_what_to_give(unit: str, given: str) -> None:
    dimension = Dimension("twist_2", ("link", 1, "twist"), "twist", "link 2", unit, 1.0)
    with pytest.raises(RequestError) as caught:
        dimension.read(given)
    message = str(caught.value)
    assert message.startswith("link[2].twist: ")
    assert given.strip() in message
    hint = message.rpartition("; give ")[2].partition(" (")[0]
    # what is offered is taken
    for offer in re.split(r", | or |as in ", hint.removeprefix("a number")):
        assert not offer or np.isfinite(dimension.read(offer))


@pytest.mark.parametrize(
    ("unit", "given", "words"),
    [
        ("mm", "12 deg", "'12 deg' is not a finite length; give 250 or 250mm"),
        ("deg", "12 mm", "'12 mm' is not a finite angle; give 30, 30deg or 0.5rad"),
        ("mm", "30°", "is not a finite length"),
        ("mm", "1,5", "a decimal point, not a comma"),
        ("rad/s", "3 mm/s", "is not a finite speed; give 10, 10 rad/s or 60 rpm"),
        ("", "3 mm", "is not a finite number; give a number, as in 1.5"),
    ],
)
def test_a_refusal_says_what_is_wrong_with_the_unit(unit: str, given: str, words: str) -> None:
    with pytest.raises(RequestError, match=re.escape(words)):
        Dimension("L1", ("rssr", "L1"), "L1", "dimensions", unit, 1.0).read(given)


# --- sliders

ANY_SIZE = [
    0.0,
    5e-324,
    1e-310,
    1e-300,
    1e-100,
    3e-12,
    0.1,
    1.0,
    3.15,
    3.1500001,
    180.0,
    181.0,
    1e5,
    1e50,
    1e99,
    1e100,
]


@pytest.mark.parametrize("unit", ["mm", "deg", "rad", "mm/turn", "rad/s", "mm/s", ""])
def test_a_slider_holds_its_value_whatever_that_is(unit: str) -> None:
    for value in ANY_SIZE:
        for signed, positive in ((value, False), (-value, False), (value, True)):
            for size in (5e-324, 1e-310, 1e-100, 1.0, 700.0, 1e100):
                if positive and not value:
                    continue
                low, high, step = slider_range(Dimension("a", ("a",), "a", "g", unit, signed, positive), size)
                assert low <= signed <= high, (signed, size)
                assert 0 < step <= high - low, (signed, size)
                assert np.isfinite([low, high, step]).all()
                assert low > 0 or not positive or unit in ("deg", "rad")


@pytest.mark.parametrize("name", loops())
def test_every_slider_of_the_gallery_has_room_on_both_sides_in_fine_steps(name: str) -> None:
    dimensions = Draft.of(text(name), name).dimensions
    size = largest_length(dimensions)
    for dimension in dimensions:
        low, high, step = slider_range(dimension, size)
        assert low < dimension.value < high, dimension.key
        assert 300 <= (high - low) / step <= 2001, dimension.key


def test_a_number_is_written_as_people_write_it_and_read_back() -> None:
    dimension = Dimension("a", ("a",), "a", "g", "mm", 1.0)
    for value, told in ((0.1 + 0.2, "0.3"), (250.0, "250"), (-1e-7, "-1e-07"), (1e100, "1e+100"), (0.0, "0")):
        assert number_text(value) == told
        assert dimension.read(told) == pytest.approx(value, rel=1e-11)


def test_widening_a_slider_never_narrows_it() -> None:
    tops = [
        slider_range(Dimension("a", ("a",), "a", "g", "mm", v), 1.0)[1] for v in np.geomspace(1e-3, 1e6, 400)
    ]
    assert all(a <= b for a, b in pairwise(tops))
