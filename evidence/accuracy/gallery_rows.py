"""Rows of every circuit of a linkage against forty digits: some at random, and the worst conditioned."""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

import sevenbar as sb
from evidence.accuracy.forty_digits import Comparison, reference
from evidence.accuracy.quantiles import Row, summary

#: Rows nearer than this [rad] to an input dead centre are counted apart, with the dead centres.
NEAR = 0.01

#: What seeds the choice of rows and points.
SEED = 7


@dataclass(frozen=True)
class Amount:
    """Rows of a circuit: at random inputs, and of the worst conditioned among `grid` inputs of a turn."""

    random: int
    worst: int
    grid: int


def seeded(name: str, purpose: int) -> np.random.Generator:
    """The generator of one linkage for one purpose, the same in every process."""
    return np.random.default_rng([SEED, purpose, zlib.crc32(name.encode())])


def apart(circuit: sb.Circuit, *, turns: bool) -> np.ndarray:
    """How far each row's input is from the circuit's next input dead centre; infinite where there is none."""
    found = np.full(len(circuit.input), np.inf)
    for dead in circuit.dead_centres:
        if dead.kind == "input":
            off = circuit.input - dead.input
            if turns:
                off = (off + np.pi) % (2 * np.pi) - np.pi
            found = np.minimum(found, np.abs(off))
    return found


def random_law(rng: np.random.Generator, count: int, *, turns: int, speed: float) -> sb.Law:
    """Inputs anywhere in so many turns, rising, passed at constant speed."""
    inputs = np.sort(rng.uniform(0, 2 * np.pi * max(1, turns), size=count))
    return sb.Law.of(np.arange(count), inputs, speed, 0.0, 0.0)


def compared(linkage: sb.Linkage, name: str, amount: Amount) -> Iterator[tuple[str, Row]]:
    """Every row that is compared, with how it was chosen: "random" or "worst"."""
    rng = seeded(name, 0)
    grid = linkage.motion(samples=amount.grid)
    column = linkage.columns.index(grid.input)
    against = reference(linkage, column)
    turns = max(circuit.turns for circuit in grid)
    # a circuit that rocks has each input more than once, and not all of them
    law = random_law(rng, amount.random, turns=turns, speed=grid.speed)
    for chosen, motion in (("random", linkage.motion(law=law)), ("worst", grid)):
        for circuit in motion:
            comparison = Comparison(linkage, circuit, against, rng=rng)
            distances = apart(circuit, turns=linkage.column_kinds[column] == "turn")
            usable = np.flatnonzero((circuit.status == "ok") & (distances > NEAR))
            if chosen == "worst":
                usable = usable[np.argsort(-circuit.condition[usable], kind="stable")][: amount.worst]
            else:
                usable = rng.permutation(usable)[: amount.random]
            for row in usable:
                yield (
                    chosen,
                    Row(
                        linkage=name,
                        circuit=circuit.index,
                        input=float(circuit.input[row]),
                        condition=float(circuit.condition[row]),
                        apart=float(distances[row]),
                        errors=comparison.errors(int(row), (grid.speed, 0.0, 0.0)),
                    ),
                )


def measured(name: str, amount: Amount) -> dict[str, object]:
    """Quantiles of the errors of one linkage of the gallery."""
    linkage = sb.load(name)
    rows: dict[str, list[Row]] = {"random": [], "worst": []}
    for chosen, row in compared(linkage, name, amount):
        rows[chosen].append(row)
    found: dict[str, object] = {
        "kind": linkage.kind,
        "circuits": len({row.circuit for row in rows["random"]}),
        "digits": reference(linkage, linkage.columns.index(linkage.drive.joint)).digits,
    }
    for chosen, some in rows.items():
        found[chosen] = {what: summary(some, what) for what in ("joints", "points")}
    return found
