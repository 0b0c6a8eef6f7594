"""The request of a sweep, from which any part can be computed anywhere; and its description in the folder."""

from __future__ import annotations

import hashlib
import inspect
import json
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import numpy as np

from sevenbar import __version__
from sevenbar.arrays import Floats, whole_number
from sevenbar.description.draft import Draft
from sevenbar.description.held import HeldDimensions, held_of
from sevenbar.errors import RequestError
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.measures import NAMED, Measure, is_of_forces, measures_named
from sevenbar.kinematics.solvers.batches import simd_level
from sevenbar.sweep.axes import Given
from sevenbar.sweep.checked import OWN, checksum
from sevenbar.sweep.space import Space

#: The format of a sweep's description.
FORMAT = 2

#: Linkages of a part: what a processor makes in some tenths of a second to seconds, and a file worth opening.
PART_OF_TYPES, PART_OF_CIRCUITS, PART_OF_LOOPS, PART_OF_FORCES = 65536, 16384, 256, 32

#: Most linkages of a part: some dozens of parts are in memory at once.
MOST_IN_A_PART = 2**20

#: Limits of an RSSR's input: the zeros of a quartic.
MOST_LIMITS = 4


@dataclass(frozen=True)
class SweepPlan:
    """A sweep as requested: which linkages, which measures, how many linkages to a part.

    `measures` are names of those that batches have, others themselves. `input` and `output` are columns.
    """

    draft: Draft
    space: Space
    measures: tuple[str | Measure, ...]
    samples: int
    input: str
    output: str
    part_size: int

    @staticmethod
    def of(
        linkage: Linkage | Draft,
        axes: Mapping[str, Given],
        measures: Sequence[str | Measure | Callable[[Motion], float]],
        *,
        method: str | None = None,
        count: int | None = None,
        seed: int | None = None,
        samples: int = 90,
        input: str | None = None,
        output: str | None = None,
        part_size: int | None = None,
        follow: Collection[str] = (),
    ) -> SweepPlan:
        """The plan of a caller's request.

        Raises `RequestError` for an argument that does not fit, `NotCoveredError` for a linkage that is not
        analysed.
        """
        draft = linkage if isinstance(linkage, Draft) else Draft.of_linkage(linkage)
        space = Space.of(draft, axes, method, count, seed)
        draft = draft.holding(follow)
        for axis in space.axes:
            if axis.name in follow:
                raise RequestError(f"follow: {axis.name} is swept itself; leave one of the two out")
        result = measures_named(measures)
        # whatever is wrong with the request as a whole is wrong with the linkage that was given, too
        motion = draft.linkage.motion(samples, input=input, output=output)
        if part_size is None:
            part_size = _part_size(draft, result)
        size = whole_number("part_size", part_size, 1, MOST_IN_A_PART, "a count of linkages")
        names = tuple(m.name if m.batch else m for m in result)
        bare = replace(draft)  # without what it has cached
        return SweepPlan(bare, space, names, motion.samples, motion.input, motion.output, size)

    @property
    def measured(self) -> tuple[Measure, ...]:
        """The measures themselves."""
        return tuple(NAMED[m] if isinstance(m, str) else m for m in self.measures)

    @property
    def of_forces(self) -> bool:
        """Whether one of the measures is of forces, which take their time at every linkage."""
        return _of_forces(self.measured)

    @property
    def per_circuit(self) -> bool:
        """Whether a linkage has a row for each of its circuits."""
        return any(measure.per == "circuit" for measure in self.measured)

    @property
    def limit_names(self) -> tuple[str, ...]:
        """Columns that hold the limits themselves, where those are requested: of an RSSR at most four."""
        if "limits" not in self.measures or self.draft.linkage.kind != "RSSR":
            return ()
        return tuple(f"limit_{place}" for place in range(1, MOST_LIMITS + 1))

    @property
    def held(self) -> HeldDimensions:
        """What is the same of all linkages."""
        return held_of(self.draft, [axis.name for axis in self.space.axes])

    @property
    def parts(self) -> int:
        """The number of parts."""
        return -(-self.space.count // self.part_size)

    def linkages(self, part: int) -> range:
        """The linkages of a part."""
        first = part * self.part_size
        return range(first, min(first + self.part_size, self.space.count))

    def draft_of(self, values: Floats) -> Draft:
        """The description with the values (axes,) of one linkage."""
        own = [(axis.dimension, float(x)) for axis, x in zip(self.space.axes, values, strict=True)]
        return self.draft.with_places({d.place: self.draft.written(d, x) for d, x in own})

    def request(self) -> dict[str, Any]:
        """What the sweep is, as plain values: two sweeps with one request have the same parts."""
        return {
            "format": FORMAT,
            "linkage": json.loads(json.dumps(dict(self.draft.raw))),
            "input": self.input,
            "output": self.output,
            "samples": self.samples,
            "dimensions": [axis.as_dict for axis in self.space.axes],
            "sampling": {"method": self.space.method, "count": self.space.count, "seed": self.space.seed},
            "measures": [m if isinstance(m, str) else _function_dict(m) for m in self.measures],
            "part_size": self.part_size,
            **({} if self.draft.agree is None else {"agree": self.draft.agree}),
        }

    def digest(self) -> str:
        """The mark that every part carries, so that no other sweep's part is taken for one."""
        text = json.dumps(self.request(), sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()

    def description(self, makers: Sequence[Mapping[str, str]]) -> dict[str, Any]:
        """What a sweep's description holds: the request and what follows from it; `makers` made its parts."""
        about = {
            **self.request(),
            **self.held.as_dict,
            "length_unit": self.draft.linkage.length_unit,
            "toml": self.draft.toml(),
            "linkages": self.space.count,
            "parts": self.parts,
            "mark": self.digest(),
            "made_by": [dict(one) for one in makers],
        }
        return {**about, OWN: checksum(about)}


def _part_size(draft: Draft, measures: Sequence[Measure]) -> int:
    """Linkages of a part, by how long they take: never by the machine, since resumed parts must fit."""
    if _of_forces(measures):
        return PART_OF_FORCES
    if draft.linkage.form != "rssr" or not all(m.batch for m in measures):
        return PART_OF_LOOPS
    return PART_OF_TYPES if all(m.of_type for m in measures) else PART_OF_CIRCUITS


def _of_forces(measures: Sequence[Measure]) -> bool:
    return any(is_of_forces(measure.name) for measure in measures)


def _function_dict(measure: Measure) -> dict[str, Any]:
    """A function as a description holds it: its name, and a mark of its text where that is known."""
    function = measure.value
    try:
        source: str | None = hashlib.sha256(inspect.getsource(function).encode()).hexdigest()
    except (OSError, TypeError):
        source = None
    module, name = (getattr(function, key, "") for key in ("__module__", "__qualname__"))
    known = {"name": measure.name, "per": measure.per, "quantity": measure.quantity}
    return {**known, "function": f"{module}:{name}", "source": source}


def maker() -> dict[str, str]:
    """What makes parts here: the versions and the vector unit on which their bits depend."""
    return {
        "sevenbar": __version__,
        "simd_level": simd_level(),
        "numpy": np.__version__,
        **{name: _version(name) for name in ("pyarrow", "scipy")},
    }


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return ""
