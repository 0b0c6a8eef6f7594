"""The measured quantities as functions of a linkage's numbers and of the zeros of the measured joints.

Parameters z are the numbers of the description that move joints, in units of length and radians, and two
offsets. The rows are followed from pose to pose as z changes, each on its own pass; a row that goes over a
dead centre of the input on the way does not close. A coupler that follows the other lengths of an RSSR takes
its derivatives from theirs (`kinematics.numbers.dimensions`).

Source: docs/theory_design.md, (1) and (2).
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from sevenbar.arrays import Floats, Integers
from sevenbar.errors import NotCoveredError
from sevenbar.kinematics.numbers.dimensions import Following
from sevenbar.kinematics.numbers.sensitivity import NumberedLoop, Numbers, Slopes
from sevenbar.measuring.compare import Comparison
from sevenbar.measuring.measured import OUTPUTS

#: Zeros of the measured joints that may be free too: linkage input = measured input + input_offset,
#: measured output = linkage output + output_offset.
OFFSETS = ("input", "output")

#: The order in which dimensions of a row are held where the data do not identify them all.
ROW_ORDER = ("length", "twist", "angle", "offset", "pitch")

#: Share of its nominal value below which a length is none: a link has one.
LEAST_LENGTH = 1e-3

#: Share of the inputs' travel within which two inputs are one.
SAME_INPUT = 1e-6


class CurveModel:
    """A linkage's curve at measured rows, by its parameters."""

    def __init__(
        self,
        numbers: Numbers,
        before: Comparison,
        inputs: Floats,
        free: Collection[str],
        follows: Sequence[str],
    ) -> None:
        chosen, ends = before.chosen, before.ends
        self.before, self.follows = before, tuple(follows)
        self.slides = ends.output_slides
        count, circuit = len(inputs), before.circuit
        own = before.branch * count + np.arange(count)
        q, status = circuit.q[own], circuit.status[own]
        self.places = _in_order(numbers)
        dimensions = [numbers.dimensions[k] for k in self.places]
        self._follower = Following.among(dimensions) if self.follows else None
        self.names = [d.name for d in dimensions] + [f"{side}_offset" for side in OFFSETS]
        self.kinds: list[str] = [d.kind for d in dimensions]
        self.kinds += ["length" if slides else "angle" for slides in (ends.input_slides, ends.output_slides)]
        self.output = circuit.output_column
        self.numbers, self.driver = numbers, circuit.input_column
        #: Rows that are used: rates, and so sensitivities, do not exist at a dead centre of the input.
        self.rows = np.flatnonzero((status != "dead-centre") & np.isfinite(q).all(axis=1))
        poses = numbers.poses(q[self.rows])
        #: The size of one of the file's units, angles being in radians here.
        self.units = np.array([d.scale for d in dimensions])
        self.nominal = np.append(numbers.nominal[self.places] * self.units, [0.0, 0.0])
        lengths = [kind in ("length", "pitch") for kind in self.kinds]
        size = float(np.abs(self.nominal[lengths]).max(initial=0.0)) or 1.0
        self.scales = np.where(lengths, size, 1.0)
        positive = np.array([d.positive for d in dimensions] + [False, False])
        #: What each parameter is to exceed.
        self.floor = np.where(positive, LEAST_LENGTH * self.nominal, -np.inf)
        self.first = self.nominal + np.array([0.0] * len(dimensions) + [chosen.phase, chosen.offset])
        begin = q[self.rows, self.driver] - chosen.phase
        # rows that do not close on their pass are known only here: the loop's own pose is nearer than a row
        loop = numbers.loop(self.driver, only=self.places)
        here = loop.slopes(poses, 0)
        if here.idle[self.output]:
            raise NotCoveredError(
                f"calibrate: {ends.output} takes part in an idle motion, which the input does not tell; give "
                "another output"
            )
        self.opening = frozenset(n for n, opens in zip(self.names, here.opening, strict=False) if opens)
        #: Which of the numbers may change.
        self.moving = [
            k for k, name in enumerate(self.names[:-2]) if name in free and name not in self.opening
        ]
        self.order = max(OUTPUTS.index(q) for q in before.outputs)
        self.begin = begin
        self.values = {q: before.measured[q][self.rows].copy() for q in before.outputs}
        if "angle" in self.values:
            self.values["angle"] += chosen.offset
        self.speeds = before.speeds[self.rows]
        self.extents = {q: ends.extent(q, before.measured[q]) for q in before.outputs}
        self.sites = self._sites()
        #: Rows, of those used, that did not close at the last parameters at which the curve does not exist.
        self.lost: Integers = np.zeros(0, dtype=np.int64)
        #: A length that was too short there.
        self.too_short = ""
        self._start(loop, poses, here)

    def _start(self, loop: NumberedLoop, poses: Floats, here: Slopes) -> None:
        """Takes closed poses of a loop, with derivatives by all numbers, to follow others from."""
        self._only = [self.places[k] for k in self.moving]
        self._slopes: Slopes | None
        self._matrices: dict[str, Floats]
        self._stand(loop.p, poses, self.first)
        if self.order == 0:
            self._known = (loop, poses)
            self._slopes = replace(here, by_number=here.by_number[:, :, self.moving])
        self._first_poses = (self.numbers.loop(self.driver, loop.p, ()), poses)
        at_first = self.computed(self.first)
        #: The curve of the design, with the zeros of the first alignment.
        self.at_first: dict[str, Floats] = {} if at_first is None else at_first

    def _sites(self) -> Integers:
        """Which place of the input each row is at (rows,): inputs of a pass that agree are one."""
        values = self.begin
        if not self.before.ends.input_slides:
            turn = math.tau * max(self.before.circuit.turns, 1)
            values = np.mod(values, turn)
            values = np.where(turn - values < SAME_INPUT * np.ptp(self.begin), values - turn, values)
        branch = self.before.branch[self.rows]
        order = np.lexsort([values, branch])
        apart = np.diff(values[order]) > SAME_INPUT * float(np.ptp(self.begin))
        apart |= np.diff(branch[order]) != 0
        sites = np.empty(len(values), dtype=np.int64)
        sites[order] = np.concatenate([[0], np.cumsum(apart)])[: len(values)]
        return sites

    def leave_out(self, rows: Integers) -> None:
        """Takes some of the used rows out."""
        keep = np.setdiff1d(np.arange(len(self.rows)), rows)
        loop, poses = self._known
        self.rows, self.begin, self.speeds = self.rows[keep], self.begin[keep], self.speeds[keep]
        self.values = {q: v[keep] for q, v in self.values.items()}
        self.at_first = {q: v[keep] for q, v in self.at_first.items()}
        self.sites = np.unique(self.sites[keep], return_inverse=True)[1]
        self._first_poses = (self._first_poses[0], self._first_poses[1][keep])
        # derivatives are those of the poses that are left
        self._stand(loop.p, poses[keep], self._at)

    def filled(self, z: Floats) -> Floats:
        """Parameters with the one that follows the others in its place."""
        return z if self._follower is None else self._follower.whole(z)

    def following(self, z: Floats) -> dict[int, Floats]:
        """The derivatives (parameters,) of each parameter that follows the others."""
        if self._follower is None:
            return {}
        row = np.zeros(len(z))
        row[list(self._follower.leaders)] = self._follower.slopes(z)
        return {self._follower.own: row}

    def _to(self, z: Floats) -> bool:
        """Moves the poses to parameters z; whether every row closes there."""
        short = np.flatnonzero(z <= self.floor)
        if short.size:
            self.lost, self.too_short = np.zeros(0, dtype=np.int64), self.names[int(short[0])]
            return False
        if np.array_equal(z, self._at):
            return True
        loop, poses = self._known
        p = loop.p.copy()
        p[self.places] = z[:-2] / self.units
        x = self.begin + z[-2]
        ahead = None
        if self._slopes is not None:
            change = (p - loop.p)[self._only]
            ahead = np.einsum("nkc,k->nc", self._slopes.by_number[:, 0], change)
            ahead += self._slopes.by_input[:, 0] * (x - poses[:, loop.input])[:, None]
            ahead = ahead[None]
        near = loop.followed(x, poses, p[None], ahead)[0][0]
        bad = np.flatnonzero(~np.isfinite(near).all(axis=1))
        if bad.size:
            near[bad] = loop.closed(x[bad], poses[bad], p)
            lost = bad[~np.isfinite(near[bad]).all(axis=1)]
            if lost.size:
                self.lost, self.too_short = lost, ""
                return False
        self._stand(p, near, z)
        return True

    def back_to(self, z: Floats) -> bool:
        """Moves the poses to parameters from those of the design; whether every row closes there."""
        loop, poses = self._first_poses
        self._stand(loop.p, poses, self.first)
        return self._to(z)

    def _stand(self, p: Floats, poses: Floats, z: Floats) -> None:
        """Takes poses that close with the numbers p, those of parameters z."""
        self._known = (self.numbers.loop(self.driver, p, self._only), poses)
        self._slopes, self._matrices, self._at = None, {}, z.copy()

    def _here(self) -> Slopes:
        """The derivatives at the poses."""
        if self._slopes is None:
            loop, poses = self._known
            self._slopes = loop.slopes(poses, self.order)
        return self._slopes

    def computed(self, z: Floats) -> dict[str, Floats] | None:
        """Each measured quantity as computed, an angle within half a turn of the measured one.

        `None` where a row does not close on its pass, or a length is none.
        """
        if not self._to(z):
            return None
        values = {}
        for quantity, measured in self.values.items():
            order = OUTPUTS.index(quantity)
            if order == 0:
                value = self._known[1][:, self.output] + z[-1]
                if not self.slides:
                    value = value + math.tau * np.round((measured - value) / math.tau)
            else:
                value = self._here().rates[:, order - 1, self.output] * self.speeds**order
            values[quantity] = value
        return values

    def slopes(self, z: Floats) -> dict[str, Floats]:
        """The derivatives (n, parameters) of each measured quantity, by parameters in their scales.

        Those by numbers that are not free are zero. Raises `ValueError` where a row does not close.
        """
        if not self._to(z):
            raise ValueError("no derivatives where the loop does not close")
        if self._matrices:
            return self._matrices
        here = self._here()
        slopes = self._matrices
        for quantity in self.values:
            order = OUTPUTS.index(quantity)
            speeds = self.speeds**order
            matrix = np.zeros((len(self.begin), len(self.names)))
            by_number = here.by_number[:, order, :, self.output] / self.units[self.moving]
            matrix[:, self.moving] = by_number * speeds[:, None]
            matrix[:, -2] = here.by_input[:, order, self.output] * speeds
            matrix[:, -1] = float(quantity == "angle")
            for place, row in self.following(z).items():
                matrix += np.outer(matrix[:, place], row)
                matrix[:, place] = 0.0
            slopes[quantity] = matrix * self.scales
        return slopes


def _in_order(numbers: Numbers) -> list[int]:
    """The numbers that move joints, not points alone, in the order in which they are held."""

    def order(k: int) -> tuple[int, int]:
        place = numbers.dimensions[k].place
        row = place[0] == "link" and isinstance(place[1], int)
        return (int(place[1]), ROW_ORDER.index(str(place[2]))) if row else (0, k)

    moving = [k for k, d in enumerate(numbers.dimensions) if d.place[0] != "point"]
    return sorted(moving, key=order)
