"""The report of a free motion and of equilibria: printed, as JSON, and as files in a folder."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from sevenbar.forces.free_motion.equilibria import Equilibrium
from sevenbar.forces.free_motion.result import FreeMotion
from sevenbar.reporting.files import Report, columns_file, figure_files, json_file
from sevenbar.reporting.force_words import free_spin_facts
from sevenbar.reporting.page import Facts, Page, facts_table, page
from sevenbar.reporting.shown import REST
from sevenbar.text.listed import named
from sevenbar.text.printing import figure_of, lines, text_of
from sevenbar.text.words import retold, say

#: How a motion goes on, in words.
GOES_ON = {
    "rotation": "goes round, again and again",
    "oscillation": "swings between two turning points",
    "rest": "rests in an equilibrium",
    "asymptotic": "comes nearer and nearer to an unstable equilibrium",
    "passing": "repeats nothing within this time",
    "ends": "leaves the circuit, which ends",
    "driven": "with dampers or a motor",
    "meets stops": "meets its stops",
    "on its stop": "ends at rest on a stop",
}

#: Stops met that are listed.
MOST_MET = 4


def _angle(value: float, *, turns: bool, unit: str, scale: float = 0.0) -> str:
    """A value with its unit; what is rounding compared with a `scale` is 0."""
    value = 0.0 if abs(value) <= REST * scale else value
    return f"{math.degrees(value):.9g} deg" if turns else f"{value:.9g} {unit}"


def free_facts(result: FreeMotion) -> list[tuple[str, str]]:
    """What there is to say of a free motion: labels and texts."""
    name = result.columns[result.input_column]

    way = math.tau if result.input_turns else float(np.nanmax(np.abs(result.input)))
    # compared with which others may be rounding
    fastest = float(np.abs(result.speed[np.isfinite(result.speed)]).max(initial=0.0))

    def value(x: float) -> str:
        return _angle(float(x), turns=result.input_turns, unit=result.length_unit, scale=way)

    def speed(x: float) -> str:
        shown = _angle(float(x), turns=result.input_turns, unit=result.length_unit, scale=fastest)
        return f"{shown}/s"

    facts = [
        (say("motion"), say(GOES_ON[result.kind])),
        (say("time"), say("0 to {end:g} s, {count} rows", end=result.duration, count=len(result.time))),
        (say("start"), f"{name} = {value(result.input[0])}, {speed(result.speed[0])}"),
        (say("end"), f"{name} = {value(result.input[-1])}, {speed(result.speed[-1])}"),
    ]
    if result.period is not None:
        facts.append((say("period"), f"{result.period:.12g} s"))
    if result.turning:
        turning = say(", ").join(f"{name} = {value(point.input)}" for point in result.turning)
        facts.append((say("turns back at"), turning))
    facts += _stop_facts(result, name, value, speed)
    energy = say("{energy:.9g} J, of these rows", energy=np.nanmax(result.kinetic))
    facts.append((say("greatest kinetic energy"), energy))
    if math.isfinite(result.energy_error):
        facts.append((say("energy"), say("kept to {share:.1e} of that", share=result.energy_error)))
    if math.isfinite(result.difference):
        difference = say("two tolerances differ by {share:.1e} of arc length", share=result.difference)
        facts.append((say("accuracy"), difference))
    facts.append((say("resolution"), say("polynomials along the circuit to {tail:.1e}", tail=result.tail)))
    if result.through_change_points:
        facts.append((say("note"), say("it passes change points along the circuit's smooth continuation")))
    return facts


def _stop_facts(
    result: FreeMotion, name: str, value: Callable[[float], str], speed: Callable[[float], str]
) -> list[tuple[str, str]]:
    """Which stops are met, and how it rests on one."""
    facts = []
    met = [
        say(
            "{stop} at {joint} = {value} after {time} s with {speed}",
            stop=retold(one.stop), joint=name, value=value(one.input), time=f"{one.time:.6g}",
            speed=speed(one.speed),
        )
        for one in result.impacts[:MOST_MET]
    ]  # fmt: skip
    if met:
        more = len(result.impacts) - len(met)
        if more:
            met.append(say("{count} more", count=more))
        facts.append((say("meets"), say("; ").join(met)))
    if (rest := result.rest) is not None:
        held = say(
            "its stop at {joint} = {value} with {holding} ({stop})",
            joint=name, value=value(rest.input), holding=holding_text(rest), stop=retold(rest.stop),
        )  # fmt: skip
        if result.rests_from > 0:
            held = say("{held}, from {time} s on", held=held, time=f"{result.rests_from:.6g}")
        facts.append((say("rests on"), held))
    if result.impacts:
        facts.append((say("restitution"), f"{result.restitution:g}"))
    return facts


def holding_text(place: Equilibrium) -> str:
    """What a stop gives at rest; "-" where its joint does not move there."""
    if not math.isfinite(place.holding):
        return "-"
    return f"{abs(place.holding):.4g} {place.holding_unit}"


@text_of.register
def _(result: FreeMotion) -> str:
    return lines(f"free motion of {result.heading}", [*free_spin_facts(result.spin), *free_facts(result)])


@figure_of.register
def _(result: FreeMotion, **options: Any) -> Any:
    from sevenbar.drawing.free_curves import free_figure

    return free_figure(result, **options)


def _page(result: tuple[FreeMotion, Sequence[Equilibrium]]) -> Page:
    fall, places = result
    facts = Facts()
    # of the equilibria, too
    spin = {
        link: max([most, *(place.spin.get(link, 0.0) for place in places)])
        for link, most in fall.spin.items()
    }
    facts.add_all([*free_spin_facts(spin), *free_facts(fall)])
    rows = [_equilibrium(place, fall, places) for place in places]
    tables = [facts_table(rows, words=[0])] if rows else []
    return page(say("free motion of {linkage}", linkage=fall.heading), facts, *tables)


def _equilibrium(place: Equilibrium, fall: FreeMotion, places: Sequence[Equilibrium]) -> Facts:
    """One of the equilibria of a circuit."""
    row = Facts()
    row.add("equilibrium", say(place.kind), kind=place.kind)
    name = f"{fall.columns[fall.input_column]} [{'deg' if fall.input_turns else fall.length_unit}]"
    row.add(name, _place_text(place, fall), input=place.input)
    row.add("vibration [rad/s]", _vibration(place), frequency_rad_s=place.frequency)
    row.also(rate_1_s=place.rate)
    rounding = REST * max(abs(other.potential) for other in places)
    potential = 0.0 if abs(place.potential) <= rounding else place.potential
    row.add("potential [J]", f"{potential:.9g}", potential_J=place.potential)
    row.also(until=place.until, idle_spin=dict(place.spin))
    if any(other.stop for other in places):
        held = named(place, "stop", "holding", "holding_unit") if place.stop else {}
        row.add("held by its stop", holding_text(place) if place.stop else "", **held)
    return row


def _place_text(place: Equilibrium, fall: FreeMotion) -> str:
    """The input of an equilibrium, of a range of rest both ends, in the unit of the column's head."""
    ends = [place.input, place.until] if math.isfinite(place.until) else [place.input]
    scale = float(fall.input_turns)
    shown = [_angle(x, turns=fall.input_turns, unit=fall.length_unit, scale=scale) for x in ends]
    return say(" to ").join(text.rpartition(" ")[0] for text in shown)


def _vibration(place: Equilibrium) -> str:
    """The frequency [rad/s] of a stable equilibrium, "none" where nothing with a mass moves."""
    if math.isfinite(place.frequency):
        return f"{place.frequency:.9g}"
    return say("none") if place.kind == "stable" else ""


def free_dict(result: tuple[FreeMotion, Sequence[Equilibrium]]) -> dict[str, Any]:
    """A free motion and the equilibria of its circuit as plain values, in SI units and radians."""
    fall, places = result
    rest: dict[str, Any] | None = None
    if fall.rest is not None:
        rest = {"input": fall.rest.input, "potential_J": fall.rest.potential}
        rest |= named(fall.rest, "stop", "holding", "holding_unit")
    return {
        "kind": fall.kind,
        "period_s": fall.period,
        "duration_s": fall.duration,
        "input": fall.columns[fall.input_column],
        "turning": [{"input": point.input, "potential_J": point.potential} for point in fall.turning],
        "energy_error": fall.energy_error,
        "difference": fall.difference,
        "tail": fall.tail,
        "idle_spin": dict(fall.spin),
        "restitution": fall.restitution,
        "impacts": [
            {"time_s": one.time, "stop": one.stop, "input": one.input, "speed": one.speed}
            for one in fall.impacts
        ],
        "rests_from_s": None if fall.rest is None else fall.rests_from,
        "rest": rest,
        "equilibria": [_equilibrium(place, fall, places).as_dict for place in places],
    }


def free_report(formats: Sequence[str]) -> Report[tuple[FreeMotion, Sequence[Equilibrium]]]:
    """How a free motion is reported: free.json, free.csv and the figure."""
    return Report(
        text=_page,
        as_dict=free_dict,
        files={
            "free.json": json_file(free_dict),
            "free.csv": columns_file(lambda result: result[0].table()),
            **figure_files("free", formats, lambda result: figure_of(result[0])),
        },
        spoken=True,
    )
