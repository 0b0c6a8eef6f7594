"""Random loops of all kinds with masses, loads and springs, each on one circuit of its motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

import sevenbar as sb
from evidence.accuracy.reference_forces import NewtonEuler
from evidence.fuzz import random_linkages, random_loops
from evidence.fuzz.loadings import random_loading
from sevenbar.errors import SevenbarError
from sevenbar.forces.loading import Loading
from sevenbar.text.units import LENGTHS

Case = random_loops.Case | random_linkages.Dimensions | random_linkages.Drawing

#: All families of the tests: seven freedoms, special geometry, compound joints, screws, RSSR.
FAMILIES: dict[str, Callable[[np.random.Generator], Case]] = {
    **random_loops.SPECIAL,
    **random_loops.OVERCONSTRAINED,
    "general": random_loops.general,
    "drawn": random_loops.drawn,
    "joints in a plane": random_loops.planar,
    "screws": random_loops.screws,
    "square RSSR": random_linkages.assembled_square,
    "skew RSSR": random_linkages.skew,
    "nearly parallel RSSR": random_linkages.nearly_parallel,
}

SAMPLES = 12


@dataclass(frozen=True, eq=False)
class Loaded:
    """A circuit of a linkage with what acts on it."""

    family: str
    linkage: sb.Linkage
    circuit: sb.Circuit
    loading: Loading

    @property
    def metre(self) -> float:
        """The linkage's length unit."""
        return LENGTHS[self.linkage.length_unit]

    @property
    def rows(self) -> np.ndarray:
        """Those with a pose and rates."""
        status = self.circuit.status
        return np.flatnonzero((status == "ok") | (status == "turns-undefined"))

    def reference(self, *, precise: bool = False) -> NewtonEuler:
        """What judges it."""
        return NewtonEuler(self.linkage, self.circuit.input_column, self.loading, self.metre, precise=precise)


def loaded_loop(seed: int, number: int) -> Loaded | None:
    """A loop of the family whose turn it is; `None` where it has no motion that both ways can judge."""
    rng = np.random.default_rng((seed, number))
    family = list(FAMILIES)[number % len(FAMILIES)]
    case = FAMILIES[family](rng)
    try:
        if isinstance(case, random_loops.Rows | random_loops.Drawn):
            linkage = case.linkage(length_unit=str(rng.choice(["mm", "m", "in"])))
            modes = linkage.assembly_modes(case.theta).q
            driven = None if rng.random() < 0.5 else str(rng.choice(linkage.drivable()))
            circuits = [linkage.circuit(mode, SAMPLES, input=driven) for mode in rng.permutation(modes)[:1]]
        else:
            linkage = case.linkage()
            circuits = list(linkage.motion(SAMPLES).circuits)
    except SevenbarError:
        return None
    if not circuits:
        return None
    circuit = circuits[int(rng.integers(len(circuits)))]
    loaded = Loaded(family, linkage, circuit, random_loading(rng, linkage))
    # several links that spin together between two balls are judged by no equation of the reference
    return loaded if loaded.rows.size and not linkage.held[2] else None
