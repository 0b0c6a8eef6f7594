"""The verdict on a linkage as a piece of the page: the words of the report, with the circuit on view."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape

from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.reporting.facts import facts_of
from sevenbar.reporting.summary import circuit_facts
from sevenbar.studio.state.session import Session
from sevenbar.studio.state.view import View

#: Facts that other parts of the page show.
ELSEWHERE = ("dimensions", "drive", "loop")

GOOD, STALE = "#2b6a4d", "#b3261e"


def heading(session: Session) -> str:
    """The linkage's name, its motion type, and the reason where what is on view is out of date."""
    motion = session.motion
    word = motion.motion_type if motion is not None else "no motion"
    colour = STALE if session.problem else GOOD
    badge = (
        f'<span style="background:{colour};color:white;border-radius:4px;padding:1px 8px;'
        f'font-weight:600;white-space:nowrap">{escape(word)}</span>'
    )
    html = f'<div style="font-weight:600;line-height:1.3">{escape(session.draft.linkage.name)}</div>{badge}'
    if session.problem:
        last = " The last one that moves stays in grey." if session.view is not None else ""
        html += (
            f'<div role="alert" style="color:{STALE};margin-top:6px;line-height:1.35">'
            f"{escape(session.problem)}.{last}</div>"
        )
    return f'<div style="padding:4px 12px 8px;font-size:14px">{html}</div>'


def verdict(session: Session) -> str:
    """What the report says of the motion, and of the circuit on view; in grey where that is out of date."""
    motion = session.motion
    html = "" if motion is None else _facts(_of_motion(motion))
    if session.view is not None:
        html += faded(_of_circuit(session.view), stale=bool(session.problem))
    return _block(html)


def faded(html: str, *, stale: bool) -> str:
    """A piece of the page, in grey where it is out of date."""
    return f'<div style="opacity:0.45">{html}</div>' if stale and html else html


def facts_block(facts: Iterable[tuple[str, str]], *, title: str) -> str:
    """Facts as a piece of the page, below a title."""
    return _block(_head(title) + _facts(facts))


def facts_html(view: View) -> str:
    """What the report says of the motion and the circuit of a view."""
    return _block(_facts(_of_motion(view.motion)) + _of_circuit(view))


def _block(html: str) -> str:
    return f'<div style="padding:2px 12px 10px;font-size:12.5px;line-height:1.4">{html}</div>'


def _of_motion(motion: Motion) -> list[tuple[str, str]]:
    return [(name, fact) for name, fact in facts_of(motion) if name not in ELSEWHERE]


def _of_circuit(view: View) -> str:
    facts = circuit_facts(view.motion, view.circuit)
    if not any(name == "motion type" for name, _ in facts):
        facts.insert(0, ("motion type", view.circuit.motion_type))
    return _head(f"circuit {view.circuit.index}") + _facts(facts)


def _head(title: str) -> str:
    return f'<div style="font-weight:600;margin:8px 0 2px">{escape(title)}</div>'


def _facts(facts: Iterable[tuple[str, str]]) -> str:
    rows = "".join(
        f'<tr><td style="color:#777;vertical-align:top;padding:1px 10px 1px 0;width:38%">{escape(name)}</td>'
        f'<td style="vertical-align:top;overflow-wrap:anywhere">{escape(fact)}</td></tr>'
        for name, fact in facts
    )
    return f'<table style="border-collapse:collapse;width:100%">{rows}</table>'
