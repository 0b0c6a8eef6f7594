"""The example on the paper's Table 1: which errors of the lengths would cause the differences."""

import contextlib
import io
import runpy

import numpy as np
import pytest

import sevenbar as sb
from places import ROOT


@pytest.fixture(scope="module")
def example():
    return runpy.run_path(str(ROOT / "examples" / "table_1.py"))


@pytest.fixture(scope="module")
def tables(example):
    return example["explained"]()


def extremes(**changes):
    """The six extremes of the paper's mechanism with changed lengths, by the ordinary analysis."""
    linkage = sb.load("rssr")
    circuit = sb.rssr(**(dict(linkage.dimensions) | changes), speed=10.0).motion().circuits[0]
    pairs = (circuit.angle, circuit.velocity, circuit.acceleration)
    return np.array([value for e in pairs for value in (e.lowest, e.highest)])


def test_the_equal_tolerances_cause_the_paper_s_differences_at_worst(tables):
    nominal = extremes()
    for place, one in enumerate(tables[0]):
        most = 0.0
        for corner in np.ndindex(*(2,) * 6):
            signs = 1 - 2 * np.array(corner)
            values = sb.load("rssr").dimensions
            moved = {n: v + s * one["worst"] for (n, v), s in zip(values.items(), signs, strict=True)}
            most = max(most, abs(extremes(**moved)[place] - nominal[place]))
        # the estimate is linear, and the tolerances are some millimetres
        assert most == pytest.approx(abs(one["error"]), rel=0.15), one["name"]


def test_one_length_alone_leaves_the_residual_that_is_printed(example, tables):
    _, alone, _ = tables
    _, _, measured, spans = example["table"](np.zeros(6))
    dimensions = sb.load("rssr").dimensions
    for name, change, least, *_ in alone[:3]:

        def residual(value, name=name):
            return np.sqrt(np.mean(((measured - extremes(**{name: dimensions[name] + value})) / spans) ** 2))

        assert least == pytest.approx(residual(change), rel=1e-9)
        # steps of a fixed slope end near the least, not at it
        assert min(residual(change + step) for step in (-0.2, 0.2)) > least - 2e-5
    assert [row[0] for row in alone[:3]] == ["M", "L2", "L1"]


def test_no_class_of_the_standard_allows_one_length_alone_to_explain_them(tables):
    differences, alone, together = tables
    for letter in "fmc":
        assert min(one[letter] for one in differences) < 50
    assert all(row[3] == "none" for row in alone)
    assert [row[2] for row in together] == ["v", "c", "none", "none"]


def test_the_page_on_tolerances_shows_what_the_example_prints(example):
    page = (ROOT / "docs" / "tolerance.md").read_text(encoding="utf-8")
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        example["main"]()
    lines = printed.getvalue().splitlines()
    assert len(lines) == 23
    for line in lines:
        assert f"    {line}".rstrip() + "\n" in page
