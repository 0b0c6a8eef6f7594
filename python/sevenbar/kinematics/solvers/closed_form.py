"""The RSSR in closed form."""

from __future__ import annotations

from functools import cached_property, partial
from typing import TYPE_CHECKING, Literal

import numpy as np

import sevenbar._core as _core
from sevenbar.arrays import Floats, Integers, Words
from sevenbar.errors import RequestError
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.circuit_values import SPIN_UNDEFINED, Trace
from sevenbar.kinematics.circuits.from_core import change_points_from, circuit_from
from sevenbar.kinematics.circuits.modes import Modes, Output
from sevenbar.kinematics.circuits.motion import Motion, Solvable
from sevenbar.kinematics.circuits.search import Search

if TYPE_CHECKING:
    from sevenbar.kinematics.loop.law import Law

Side = Literal["crank", "rocker"]


class ClosedForm:
    """The solver of one RSSR; columns 0 and 7 are the crank's and the rocker's angles."""

    def __init__(self, linkage: Solvable) -> None:
        self._linkage = linkage
        try:
            self._core = _core.Rssr(linkage.base, linkage.ground, linkage.links)
        except _core.CoreError as error:  # beside the longest dimension it vanishes
            raise RequestError(f"linkage: {error}; give it one that is not lost beside the others") from None

    def __reduce__(self) -> tuple[type[ClosedForm], tuple[Solvable]]:
        return ClosedForm, (self._linkage,)

    @cached_property
    def size(self) -> float:
        """The size [length] of which residuals are parts."""
        return self._core.size

    @property
    def lengths(self) -> tuple[float, float, float]:
        """Crank, coupler and rocker [length]."""
        crank, coupler, rocker = self._core.lengths
        return crank, coupler, rocker

    @cached_property
    def has_free_side(self) -> bool:
        """Whether crank or rocker is free at some angle of the other: (4) gives no angle there.

        Source: docs/rssr.md, (4).
        """
        return self._core.has_free_side

    def outputs(
        self,
        values: Floats,
        order: int,
        column: int,
        speed: float,
        law: tuple[Floats, ...] | None,
    ) -> Output:
        """Both branches of the other side at many inputs."""
        try:
            return Output(*self._core.outputs(values, order, _side(column), speed, law))
        except _core.CoreError as error:
            raise RequestError(str(error)) from None

    def modes(self, column: int, value: float) -> Modes:
        """Both ways to assemble it at one input."""
        q, residual = self._core.assembly_modes(value, _side(column))
        residual *= self.size
        return Modes(q, residual, "closed-form", self._linkage.columns, value)

    def motion(self, column: int, samples: int, speed: float, law: Law | None) -> Motion:
        """Every circuit over the whole range of one side."""
        linkage = self._linkage
        raw = self._core.motion(_side(column), samples, speed, None if law is None else law.table)
        other = 7 - column
        return Motion(
            linkage=linkage,
            input=linkage.columns[column],
            output=linkage.columns[other],
            speed=np.nan if law is not None else speed,
            samples=samples,
            motion_type=raw.motion_type,
            limits=np.array([]) if raw.limits is None else raw.limits,
            change_points=change_points_from(raw, column),
            circuits=tuple(
                self._circuit(i, c, (column, other), speed, law) for i, c in enumerate(raw.circuits)
            ),
            search=Search("closed-form"),
            # two circles and a distance never repeat each other
            redundant=(),
            agree=_core.AGREE,
            law=law,
        )

    def _circuit(
        self, index: int, raw: _core.RawCircuit, columns: tuple[int, int], speed: float, law: Law | None
    ) -> Circuit:
        # (n, 2, 4): crank and rocker, each with three derivatives
        rates = np.moveaxis(raw.joints[:, :, [0, -1]], 0, -1)
        return circuit_from(
            raw,
            linkage=self._linkage,
            index=index,
            columns=columns,
            speed=speed,
            law=law,
            size=self.size,
            point=partial(self._trace, rates),
        )

    def _trace(self, rates: Floats, _order: Integers, _status: Words, link: int, at: Floats) -> Trace:
        """A point, `at` in its link's own frame, along rows of both sides' rates, (n, 2, 4)."""
        position, velocity, acceleration, jerk = self._core.point(link, at, rates[:, 0], rates[:, 1])
        status = np.full(len(rates), "ok", dtype="<U15")
        status[np.isnan(velocity[:, 0])] = "dead-centre"
        unsolved = np.isnan(rates[:, :, 0]).any(axis=1)
        status[np.isnan(position[:, 0])] = SPIN_UNDEFINED
        status[unsolved] = "no-solution"
        return Trace(position, velocity, acceleration, jerk, status)


def _side(column: int) -> Side:
    return "crank" if column == 0 else "rocker"
