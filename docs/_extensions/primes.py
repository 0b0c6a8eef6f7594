"""Primes in MathML at full size behind their letter: browsers draw those in superscripts too small."""

import copy
from xml.etree import ElementTree

PRIMES = frozenset("′″‴⁗")


def with_full_primes(mathml: str) -> str:
    """The same formula with every prime beside its letter; other superscripts stay where they are."""
    # the one name in formulas that XML does not know
    root = ElementTree.fromstring(mathml.replace("&ApplyFunction;", "\u2061"))
    return ElementTree.tostring(_mended(root), encoding="unicode")


def _mended(element: ElementTree.Element) -> ElementTree.Element:
    children = [_mended(child) for child in element]
    element[:] = children
    if element.tag not in ("msup", "msubsup"):
        return element
    power = children[-1]
    marks = [power] if len(power) == 0 else list(power)
    primes = [mark for mark in marks[:1] if mark.tag == "mo" and set(mark.text or "-") <= PRIMES]
    if not primes:
        return element
    base = children[0]
    if element.tag == "msubsup":
        base = _row("msub", children[:2])
    mark = copy.copy(primes[0])
    mark.attrib.update(form="postfix", lspace="0", rspace="0")
    primed = _row("mrow", [base, mark])
    rest = marks[1:]
    return _row("msup", [primed, rest[0] if len(rest) == 1 else _row("mrow", rest)]) if rest else primed


def _row(tag: str, children: list[ElementTree.Element]) -> ElementTree.Element:
    row = ElementTree.Element(tag)
    row.extend(children)
    return row
