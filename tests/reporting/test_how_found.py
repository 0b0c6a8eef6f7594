"""How circuits were found, in words."""

from __future__ import annotations

import dataclasses

import sevenbar as sb
from sevenbar.reporting.how_found import how_found


def with_open(*ranges):
    """A motion whose count leaves ranges of the input open."""
    motion = sb.load("watt").motion(36)
    count = dataclasses.replace(motion.search.count, open=tuple(sb.OpenRange(*each) for each in ranges))
    return dataclasses.replace(motion, search=dataclasses.replace(motion.search, count=count))


def test_ranges_of_several_modes_that_read_alike_are_named_once():
    near = (1.0, 1.00001, None)
    found = how_found(with_open(near, near, near, near, near, (2.0, 2.5, 2)))
    assert found.count("within 0.0003 deg of 57.2961 deg") == 1
    assert found.endswith("2 between 114.592 and 143.239 deg")


def test_a_search_speaks_of_screws_where_there_are_any():
    searched = sb.load("peaucellier").motion(36, input="left corner.2")
    assert "modes by search from many starts at" in how_found(searched)
    assert "screws within one turn" in how_found(sb.load("screw_drill").motion(36))
