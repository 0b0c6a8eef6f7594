"""Forces and equilibria between stops against plain virtual work: own kinematics, own sums, ten linkages."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pytest

import sevenbar as sb

GRAVITY = np.array([0.3, -0.5, -9.81])
STEP = 1e-4


def drawn(joints: list[tuple[Any, ...]], drive: str, body: int, stop: str, slides: bool = False) -> str:
    """A file of drawn joints (name, kind, place, axis), whose link `body` has a mass; lengths in mm."""
    rows = [
        f'{{ name = "{name}", kind = "{kind}", at = {list(at)}'
        + (f", axis = {list(axis[0])} }}" if axis else " }")
        for name, kind, at, *axis in joints
    ]
    speed = 'speed = "1 mm/s", ' if slides else ""
    return f"""
format = 1
drive = {{ {speed}joint = "{drive}" }}
joint = [{", ".join(rows)}]
forces = {{ gravity = {GRAVITY.tolist()} }}
body = [{{ link = {body}, mass = 1.7, centre = [11, 23, 5] }}]
spring = [{{ links = [{body}, {len(joints)}], at = [[5, 12, 3], [-40, 70, 20]], stiffness = "0.05 N/mm", length = 30 }}]
stop = [{stop}]
"""


Z, X = [0, 0, 1], [1, 0, 0]
FOUR = [
    ("a", "R", [0, 0, 0], Z),
    ("b", "R", [10, 40, 0], Z),
    ("c", "R", [110, 80, 0], Z),
    ("d", "R", [90, 0, 0], Z),
]
CRANK = [
    ("a", "R", [0, 0, 0], Z),
    ("b", "R", [30, 0, 0], Z),
    ("c", "R", [110, 10, 0], Z),
    ("d", "P", [110, 10, 0], X),
]
BACK = [CRANK[3], CRANK[2], CRANK[1], CRANK[0]]
BALLS = [
    ("a", "R", [0, 0, 0], Z),
    ("b", "S", [25, 5, 0]),
    ("c", "S", [60, 80, 55]),
    ("d", "R", [70, 20, 50], X),
]
ROUND = [
    (name, "R", at, [x / 100 for x in at])
    for name, at in (("a", [100, 0, 0]), ("b", [90, 40, 17]), ("c", [40, 60, 69]), ("d", [0, 30, 95]))
]

#: Files by what is special about them.
CASES = {
    "planar, drawn": drawn(FOUR, "a", 2, '{ joint = "a", range = [-20, 65] }'),
    "over the seam": drawn(FOUR, "a", 3, '{ joint = "a", range = [-80, 10] }'),
    "stop on the rocker": drawn(FOUR, "a", 2, '{ joint = "d", range = [-5, 20] }'),
    "input last": drawn(FOUR[::-1], "a", 2, '{ joint = "a", range = [-20, 65] }'),
    "slider-crank": drawn(CRANK, "a", 2, '{ joint = "a", range = [10, 130] }'),
    "stop on the slide": drawn(CRANK, "a", 2, '{ joint = "d", range = [-40, -3] }'),
    "slide drives": drawn(CRANK, "d", 2, '{ joint = "d", range = [-45, -4] }', slides=True),
    "slide drives, first": drawn(BACK, "d", 2, '{ joint = "d", range = [-45, -4] }', slides=True),
    "balls": drawn(BALLS, "a", 1, '{ joint = "a", range = [-30, 80] }'),
    "spherical": drawn(ROUND, "a", 2, '{ joint = "a", range = [0, 30] }'),
}


def turn(axis: str, angle: float) -> Any:
    c, s = math.cos(angle), math.sin(angle)
    out, (i, j) = np.eye(4), {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    out[i, i] = out[j, j] = c
    out[i, j], out[j, i] = -s, s
    return out


@dataclass
class Own:
    """A linkage by its transforms alone: poses by Newton's method, torque by differences of energy."""

    linkage: Any

    @cached_property
    def column(self) -> int:
        return self.linkage.columns.index(self.linkage.drive.joint)

    def frames(self, q: Any) -> Any:
        """The frames of the links, and how far the loop is from closed."""
        linkage, at, k, out = self.linkage, self.linkage.base.copy(), 0, []
        for i, joint in enumerate(linkage.joints):
            if joint.kind == "R":
                at, k = at @ turn("z", q[k]), k + 1
            elif joint.kind == "P":
                at, k = at.copy(), k + 1
                at[:3, 3] += at[:3, 2] * q[k - 1]
            else:
                at = at @ turn("z", q[k]) @ turn("y", q[k + 1]) @ turn("x", q[k + 2])
                k += 3
            if i < len(linkage.links):
                out.append(at)
                at = at @ linkage.links[i]
        off = np.linalg.inv(linkage.ground) @ at
        turned = np.array([off[2, 1] - off[1, 2], off[0, 2] - off[2, 0], off[1, 0] - off[0, 1]]) / 2
        return out, np.concatenate([100 * turned, off[:3, 3]])

    def pose(self, x: float, near: Any) -> Any:
        q = near.copy()
        q[self.column] = x
        free = [c for c in range(len(q)) if c != self.column]
        for _ in range(30):
            residual = self.frames(q)[1]
            slopes = np.empty((6, len(free)))
            for j, c in enumerate(free):
                there = q.copy()
                there[c] += 1e-6
                slopes[:, j] = (self.frames(there)[1] - residual) / 1e-6
            step = np.linalg.lstsq(slopes, -residual, rcond=1e-6)[0]
            q[free] += step
            if np.abs(step).max() < 1e-11:
                break
        assert np.abs(self.frames(q)[1]).max() < 1e-9
        return q

    def energy(self, q: Any) -> float:
        """Of weight and spring [J], from places in mm."""
        loading, frames = self.linkage.loading, self.frames(q)[0]
        total = 0.0
        for link, (body,) in loading.bodies.items():
            total -= body.mass * GRAVITY @ self.place(frames, link, body.centre) / 1e3
        for spring in loading.springs:
            one, two = (self.place(frames, *end) for end in zip(spring.links, spring.at, strict=True))
            longer = np.linalg.norm(one - two) - spring.length
            total += spring.stiffness * longer**2 / 2 / 1e3
        return float(total)

    def place(self, frames: Any, link: int, at: Any) -> Any:
        if link > len(frames):
            return np.array(at, dtype=float)
        return (frames[link - 1] @ self.linkage.point_frames[link - 1] @ np.array([*at, 1.0]))[:3]

    def torque(self, x: float, near: Any) -> float:
        """dV/dx by differences of the fourth order [N m, of a slide N]."""
        slides = self.linkage.joints[self._joint].kind == "P"
        h = STEP * (50 if slides else 1)
        v = [self.energy(self.pose(x + k * h, near)) for k in (-2, -1, 1, 2)]
        return (v[0] - 8 * v[1] + 8 * v[2] - v[3]) / (12 * h) * (1e3 if slides else 1)

    @property
    def _joint(self) -> int:
        return [joint.name for joint in self.linkage.joints].index(self.linkage.drive.joint)


@pytest.mark.parametrize("name", CASES)
def test_torque_and_rests_between_stops_are_those_of_virtual_work(name: str) -> None:
    linkage = sb.loads(CASES[name])
    own = Own(linkage)
    ((stop, (low, high)),) = linkage.stops.ranges.items()
    on = linkage.columns.index(stop)
    circuit = next(one for one in linkage.motion().circuits if one.allowed.spans)
    found = circuit.forces(at_rest=True)
    part = found.within_stops
    assert part is not None
    assert part.part is not None
    assert len(part.input) > 4
    # every row is between the stops, and its torque is that of virtual work
    rows = np.linspace(0, len(part.input) - 1, 7).round().astype(int)
    near = circuit.q[np.isfinite(circuit.q).all(axis=1)]
    scale = float(np.abs(part.torque).max())
    poses = []
    for row in rows:
        x = float(part.input[row])
        poses.append(_pose_like(own, x, near, part, row))
        assert part.torque[row] == pytest.approx(own.torque(x, poses[-1]), abs=3e-7 * scale)
    ends = [pose[on] for pose in (poses[0], poses[-1])]
    for end in ends:
        assert (
            min(
                abs((end - limit + math.pi) % math.tau - math.pi) if linkage.turns(on) else abs(end - limit)
                for limit in (low, high)
            )
            < 1e-7
        )
    # the peak is that of an own search, ends with it
    xs = np.linspace(part.part.start, part.part.end, 81)
    torques, q = [], poses[0]
    for x in xs:
        q = own.pose(float(x), q)
        torques.append(own.torque(float(x), q))
    best = int(np.abs(torques).argmax())
    peak = found.sizing().peak_torque
    assert abs(peak.value) >= abs(torques[best]) * (1 - 1e-7)
    if 0 < best < 80:
        a, b, c = np.abs(torques[best - 1 : best + 2])
        top = b + (c - a) ** 2 / (8 * (2 * b - a - c))
        assert abs(peak.value) == pytest.approx(top, rel=1e-5)
    else:
        assert peak.value == pytest.approx(torques[best], rel=1e-6)
    assert found.sizing().mean_torque == pytest.approx(
        np.trapezoid(torques, xs) / (xs[-1] - xs[0]), abs=3e-4 * scale
    )
    # rests: where the torque changes its sign, and the ends against which it is pressed
    places = [place for place in circuit.equilibria() if _is_on(place, part, own, poses[0])]
    signs = np.sign(torques)
    inner = sorted(place.input for place in places if not place.stop)
    assert len(inner) == int((signs[1:] != signs[:-1]).sum())
    for x in inner:
        assert (
            abs(own.torque(x, own.pose(x, poses[int(np.abs(part.input[rows] - x).argmin())]))) < 1e-5 * scale
        )
    way = np.sign(xs[-1] - xs[0])
    pressed = {
        float(x) for x, t, side in ((xs[0], torques[0], -1), (xs[-1], torques[-1], 1)) if -t * way * side > 0
    }
    assert sorted(place.input for place in places if place.stop) == pytest.approx(sorted(pressed), abs=1e-7)
    if on == own.column:
        for place in places:
            if place.stop:
                at = 0 if abs(place.input - xs[0]) < 1e-6 else -1
                assert place.holding == pytest.approx(torques[at], rel=1e-5)
    # reactions are those that the whole circuit has at the same inputs
    whole = circuit.forces(at_rest=True)
    for joint, reaction in part.reactions.items():
        for row in rows[1:-1]:
            same = np.flatnonzero(
                np.abs(
                    np.angle(np.exp(1j * (whole.input - part.input[row])))
                    if linkage.turns(own.column)
                    else whole.input - part.input[row]
                )
                < 1e-9
            )
            assert any(
                np.allclose(
                    whole.reactions[joint].force[k], reaction.force[row], rtol=1e-6, atol=1e-6, equal_nan=True
                )
                for k in same
            )


def _pose_like(own: Own, x: float, near: Any, part: Any, row: int) -> Any:
    """The own pose at an input with the energy of a row: of several passes that on which it is."""
    there = []
    for q in (
        near[np.argsort(np.abs(np.angle(np.exp(1j * (near[:, own.column] - x)))))[:6]]
        if own.linkage.turns(own.column)
        else near[np.argsort(np.abs(near[:, own.column] - x))[:6]]
    ):
        start = q.copy()
        try:
            there.append(own.pose(x, start))
        except AssertionError:
            continue
    offs = [abs(own.energy(q) - part.potential[row]) for q in there]
    assert min(offs) < 1e-9 * max(1.0, float(np.abs(part.potential).max()))
    return there[int(np.argmin(offs))]


def _is_on(place: Any, part: Any, own: Own, pose: Any) -> bool:
    """Whether an equilibrium lies on the part: its pose is that which the part's beginning leads to."""
    low, high = sorted((part.part.start, part.part.end))
    if not low - 1e-6 < place.input < high + 1e-6:
        return False
    q = pose
    for x in np.linspace(part.part.start, place.input, 12):
        q = own.pose(float(x), q)
    return abs(own.energy(q) - own.energy(place.q)) < 1e-7
