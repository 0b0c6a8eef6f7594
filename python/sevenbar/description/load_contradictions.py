"""What is wrong between the keys of bodies, loads and springs, or with links and joints that they name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from sevenbar.description.load_schema import BodyForm, LoadForm, SpringForm
from sevenbar.description.loads import body_of, load_of, spring_of
from sevenbar.description.values import flaws_of_value, valid_tables
from sevenbar.description.written import Written, named_column, unknown_link
from sevenbar.errors import Problem


def load_contradictions(
    raw: Mapping[str, Any], joints: Sequence[Written], context: Mapping[str, Any]
) -> list[Problem]:
    """What is wrong with tables whose values are each right; wrong values are reported elsewhere."""
    problems: list[Problem] = []
    units = str(context["mass_unit"]), str(context["length_unit"])
    for place, body in valid_tables(raw, "body", BodyForm, context):
        problems += _on_ground(place, body.link, joints, "a body there moves nothing, leave it out")
        if body.mass is None and body.solid != "drawn":
            problems.append(
                Problem(
                    f"{place}.mass", "is missing; give one, or solid = 'drawn' for the drawn solids in steel"
                )
            )
        else:
            problems += flaws_of_value(place, lambda body=body: body_of(body, *units))
    for place, load in valid_tables(raw, "load", LoadForm, context):
        problems += _on_ground(place, load.link, joints, "a load on it moves nothing, leave it out")
        problems += flaws_of_value(place, lambda load=load: load_of(load))
    for place, spring in valid_tables(raw, "spring", SpringForm, context):
        problems += _of_spring(place, spring, joints)
    return problems


def _on_ground(place: str, link: int, joints: Sequence[Written], why: str) -> list[Problem]:
    if link == len(joints):
        message = f"link {link} is the ground; {why}, or give 1 to {link - 1}"
        return [Problem(f"{place}.link", message)]
    return unknown_link(f"{place}.link", link, joints)


def _of_spring(place: str, spring: SpringForm, joints: Sequence[Written]) -> list[Problem]:
    if spring.joint is not None:
        kind, others = "in a joint", {"links": spring.links, "at": spring.at, "length": spring.length}
        remedy = {"length": "give its value there as free"}
    else:
        kind, others = "between links", {"free": spring.free}
        remedy = {"free": "give its length there as length"}
    problems = [
        Problem(f"{place}.{key}", f"does not belong to a spring {kind}; {remedy.get(key, 'leave it out')}")
        for key, value in others.items()
        if value is not None
    ]
    if spring.joint is not None and joints:
        _, wrong = named_column(spring.joint, joints)
        problems += [Problem(f"{place}.joint", wrong)] if wrong else []
    for i, link in enumerate(spring.links or (), 1):
        problems += unknown_link(f"{place}.links[{i}]", link, joints)
    return problems or flaws_of_value(place, lambda: spring_of(spring, {}))
