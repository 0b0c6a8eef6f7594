"""Both branches of the paper's RSSR with their rates at many inputs: an array in, arrays out."""

from __future__ import annotations

from typing import Any

import numpy as np

from evidence.benches.cases import rssr_formula
from evidence.benches.harness import Work, compare
from evidence.benches.outcome import Outcome, Table, timed
from evidence.benches.peers import AbsentError
from evidence.benches.setting import Setting

TITLE = "RSSR: many inputs at once"
ABOUT = """\
`linkage.output(alpha, order=2)` of the paper's RSSR at inputs drawn at random, against the same formula
in NumPy (each array operation once) and compiled by numba (one loop, `fastmath` off). Two branches an
input, so two poses; position, velocity and acceleration of each. CPU time, one thread."""

#: Allowed difference of two answers, relative to the greatest value: some hundred roundings.
AGREEMENT = 1e-11


def run(setting: Setting) -> Outcome:
    """Three sizes of arrays: a call's own cost, an array in the cache, one in memory."""
    linkage = rssr_formula.linkage()
    absent, compiled = [], None
    try:
        compiled = rssr_formula.with_numba(setting.peers.module("numba"))
    except AbsentError as error:
        absent = [("numba", str(error))]
    tables: list[Table] = []
    for count, rounds in ((36, 101), (3_600, 101), (1_000_000, setting.choose(15, 5))):
        alpha = np.random.default_rng(1).uniform(0.0, 2 * np.pi, count)
        mine = linkage.output(alpha, order=2, speed=rssr_formula.SPEED)

        def agrees(rates: Any, mine: Any = mine) -> None:
            for a, b in zip(rates, (mine.position, mine.velocity, mine.acceleration), strict=True):
                np.testing.assert_allclose(b, a, rtol=0, atol=AGREEMENT * np.abs(a).max())

        works = [
            Work(
                "Sevenbar",
                lambda alpha=alpha: linkage.output(alpha, order=2, speed=rssr_formula.SPEED),  # type: ignore[misc]
                2 * count,
            ),
            Work("NumPy", lambda alpha=alpha: rssr_formula.with_numpy(alpha), 2 * count, check=agrees),  # type: ignore[misc]
        ]
        if compiled is not None:
            works.append(Work("numba", lambda alpha=alpha: compiled(alpha), 2 * count, check=agrees))  # type: ignore[misc]
        timings = compare(works, rounds=setting.choose(rounds, min(rounds, 21)))
        tables.append(timed(f"{count:,} inputs", "ns a pose", timings, absent))
    return Outcome(TITLE, ABOUT, tables)
