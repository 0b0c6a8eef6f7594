"""Planar nets of dyads in pylinkage, compiled by numba: rows of a circuit, places alone or with rates."""

from __future__ import annotations

import math
import time
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

import sevenbar as sb
from evidence.benches.harness import Work, compare
from evidence.benches.outcome import Cell, Table
from evidence.benches.peers import reason_of
from evidence.benches.setting import Setting

#: Inputs in a turn, few and many.
SAMPLES = (3_600, 14_400)

#: How each place of a net follows from two others, in the order of solving: `dyad`, or `fixed` on their link.
PLANS: dict[str, list[tuple[str, str, str, str]]] = {
    "watt": [
        ("pin_3", "dyad", "pin_2", "rocker"),
        ("pin_5", "fixed", "rocker", "pin_3"),
        ("pin_6", "dyad", "pin_5", "lever"),
    ],
    "jansen": [
        ("shoulder", "dyad", "crank pin", "axle"),
        ("knee", "dyad", "crank pin", "axle"),
        ("hip", "fixed", "axle", "shoulder"),
        ("ankle", "dyad", "hip", "knee"),
        ("foot", "fixed", "knee", "ankle"),
    ],
}

#: The pin that the crank carries.
CRANK_PINS = {"watt": "pin_2", "jansen": "crank pin"}

#: A peer whose places are further off, relative to the size, did other work.
SAME_CIRCUIT = 1e-6

#: Places, velocities and accelerations, each (n, places, 2), or places alone.
Rows = tuple[np.ndarray, ...]


@dataclass(frozen=True, eq=False)
class Drawn:
    """The places of a net as drawn, and a moving link on which each lies, or none at the frame."""

    places: dict[str, tuple[float, float]]
    links: dict[str, str | None]

    @property
    def size(self) -> float:
        """The greatest distance of two places [length]."""
        places = list(self.places.values())
        return max(math.dist(one, other) for one in places for other in places)


def drawn(name: str) -> Drawn:
    """Of a net of the gallery, by its file."""
    file = tomllib.loads(sb.gallery.text(name))
    places, links = {}, {}
    for number, pin in enumerate(file["pin"], 1):
        label = pin.get("name", f"pin_{number}")
        places[label] = (float(pin["at"][0]), float(pin["at"][1]))
        links[label] = None if file["ground"] in pin["links"] else pin["links"][0]
    for point in file.get("point", []):
        places[point["name"]], links[point["name"]] = (point["at"][0], point["at"][1]), point["link"]
    return Drawn(places, links)


def moving(name: str) -> list[str]:
    """The places of a net that move, as pylinkage has them."""
    return [CRANK_PINS[name], *(place for place, *_ in PLANS[name])]


def true_rows(linkage: sb.Linkage, name: str, samples: int) -> tuple[Rows, float]:
    """Sevenbar's places and rates from the row after the drawn pose to it, and the input's speed [rad/s]."""
    circuit, net = drawn_circuit(linkage, samples), drawn(name)
    traces = []
    for label in moving(name):
        link = net.links[label]
        assert link is not None
        traces.append(circuit.point(linkage.link_names.index(link) + 1, (*net.places[label], 0.0)))
    ranks = ("position", "velocity", "acceleration")
    rows = (np.stack([getattr(trace, rank)[:, :2] for trace in traces], axis=1) for rank in ranks)
    return tuple(np.roll(values, -1, axis=0) for values in rows), circuit.speed


def drawn_circuit(linkage: sb.Linkage, samples: int) -> sb.Circuit:
    """The circuit through the drawn pose, which is its first row."""
    return linkage.circuit(np.zeros(len(linkage.columns)), samples=samples)


def in_pylinkage(
    setting: Setting, name: str, samples: int, speed: float, *, rates: bool
) -> Callable[[], Rows]:
    """One turn from the drawn pose in so many steps: the call, compiled at its first use."""
    actuators, dyads, components, simulation = (
        setting.peers.module("pylinkage", part) for part in ("actuators", "dyads", "components", "simulation")
    )
    net = drawn(name)
    x, y = net.places[CRANK_PINS[name]]
    own: dict[str, Any] = {
        label: components.Ground(*at, name=label)
        for label, at in net.places.items()
        if net.links[label] is None
    }
    (ground,) = (label for label in own if math.dist(net.places[label], (0.0, 0.0)) == 0.0)
    crank = actuators.Crank(
        anchor=own[ground],
        radius=math.hypot(x, y),
        angular_velocity=2 * math.pi / samples,
        initial_angle=math.atan2(y, x),
        name=CRANK_PINS[name],
    )
    own[CRANK_PINS[name]] = crank
    anchors = own | {CRANK_PINS[name]: crank.output}
    for label, how, first, second in PLANS[name]:
        at, one, other = (net.places[key] for key in (label, first, second))
        common = {"anchor1": anchors[first], "anchor2": anchors[second], "name": label}
        if how == "dyad":
            part = dyads.RRRDyad(distance1=math.dist(at, one), distance2=math.dist(at, other), **common)
        else:
            angles = (math.atan2(end[1] - one[1], end[0] - one[0]) for end in (at, other))
            part = dyads.FixedDyad(distance=math.dist(at, one), angle=next(angles) - next(angles), **common)
        own[label] = anchors[label] = part
    whole = simulation.Linkage(list(own.values()))
    # each dyad is as drawn, whichever of its two poses it began in
    whole.set_coords([net.places[label] for label in own])
    whole.set_input_velocity(crank, omega=speed)
    places = [list(own).index(label) for label in moving(name)]
    run = whole.step_fast_with_kinematics if rates else whole.step_fast

    def call() -> Rows:
        result = run(samples)
        return tuple(part[:, places] for part in (result if rates else (result,)))

    return call


def off(rows: Rows, truth: Rows, size: float) -> list[float | None]:
    """Greatest differences: of places relative to the size, of rates relative to the greatest."""
    scales = (size, *(np.abs(values).max() for values in truth[1:]))
    apart: list[float | None] = [
        float(np.abs(values - true).max() / scale)
        for values, true, scale in zip(rows, truth, scales, strict=False)
    ]
    return apart + [None] * (3 - len(apart))


def tables(setting: Setting) -> list[Table]:
    """One for each net."""
    return [compared(setting, name) for name in PLANS]


def compared(setting: Setting, name: str) -> Table:
    """Sevenbar's circuit and pylinkage's steps, with few rows and with many."""
    linkage, size = sb.load(name), drawn(name).size
    offs: dict[str, list[float | None]] = {}
    absent: list[tuple[str, str]] = []
    works: list[list[Work]] = []
    for samples in SAMPLES:
        truth, speed = true_rows(linkage, name, samples)
        ours = partial(drawn_circuit, linkage, samples)
        works.append([Work("Sevenbar", ours, note="joints to the jerk")])
        for who, rates in (("pylinkage, places", False), ("pylinkage, with rates", True)):
            try:
                call = in_pylinkage(setting, name, samples, speed, rates=rates)
            except Exception as error:
                absent.append((who, reason_of(error)))
                continue

            def check(rows: Rows, who: str = who, truth: Rows = truth) -> None:
                offs[who] = off(rows, truth, size)
                apart = offs[who][0]
                assert apart is not None
                assert apart < SAME_CIRCUIT, f"places are off by {apart:.1e} of the size"

            works[-1].append(
                Work(who, call, check=check, note="to the acceleration" if rates else "no rates")
            )
    rounds = setting.choose(15, 3)
    short, long = (compare(own, rounds=rounds, clock=time.thread_time) for own in works)
    rows: list[list[Cell]] = []
    for few, many in zip(short, long, strict=True):
        row = (many.median - few.median) / (SAMPLES[1] - SAMPLES[0])
        ratios = (many.ratio, many.ratio_low, many.ratio_high)
        note = many.failure or many.note
        errors = offs.get(many.who, [None] * 3)
        rows.append([many.who, 1e3 * many.median, *ratios, 1e9 * row, *errors, note])
    rows += [[who, *[None] * 8, reason] for who, reason in dict(absent).items()]
    columns = [
        "",
        f"ms, {SAMPLES[1]:,} inputs",
        "ratio",
        "from",
        "to",
        "ns a row",
        "places off",
        "velocities off",
        "accelerations off",
        "note",
    ]
    return Table(f"{name}: a circuit and pylinkage's steps", columns, rows)
