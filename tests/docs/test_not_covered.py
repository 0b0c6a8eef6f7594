"""The page of what is not covered has every refusal of the code, word by word; source: the code's own `raise`s."""

import ast

import pytest

import sevenbar as sb
from places import ROOT
from sevenbar.errors import NotCoveredError

PAGE = " ".join((ROOT / "docs" / "not-covered.md").read_text(encoding="utf-8").split())


def refusals() -> list[list[str]]:
    """The fixed parts of the message of each `raise NotCoveredError(..)`."""
    found = []
    for path in sorted((ROOT / "python" / "sevenbar").rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call):
                call = node.exc
                if isinstance(call.func, ast.Name) and call.func.id == "NotCoveredError":
                    parts = call.args[0].values if isinstance(call.args[0], ast.JoinedStr) else call.args
                    found.append([p.value for p in parts if isinstance(p, ast.Constant)])
    return found


def test_every_refusal_of_the_code_stands_on_the_page():
    messages = refusals()
    assert len(messages) >= 7
    for parts in messages:
        place = 0
        for part in parts:
            place = PAGE.find(" ".join(part.split()), place)
            assert place >= 0, parts


def test_the_page_promises_no_refusal_that_the_code_has_lost():
    words = ("output", "linkage", "point", "tolerance", "calibrate", "simulate", "net")
    shown = sum(PAGE.count(f" {word}: ") for word in words)
    assert shown == len(refusals())


@pytest.mark.parametrize("what", ["closed form", "spin of a chain"])
def test_refusals_read_as_they_do_on_the_page(what):
    if what == "closed form":
        with pytest.raises(NotCoveredError) as refused:
            sb.load("seven_r").output([0.0])
    else:
        joints = [
            {"kind": "R", "name": "crank", "at": (0, 0, 0), "axis": (0, 0, 1)},
            {"kind": "S", "name": "ball_a", "at": (1, 0, 0)},
            {"kind": "H", "name": "screw", "at": (2, 1, 0), "axis": (0, 1, 1), "pitch": 0.1},
            {"kind": "S", "name": "ball_b", "at": (3, 0, 1)},
        ]
        with pytest.raises(NotCoveredError) as refused:
            sb.from_axes(joints).motion()
    assert str(refused.value) in PAGE
