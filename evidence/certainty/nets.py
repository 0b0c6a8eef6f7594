"""Planar nets: all modes against a search over the places of the links, and each mode on one circuit.

The search shares nothing with the core: its unknowns are the shifts and turns of all links, it has no tree,
no blocks and no order, and it starts from anywhere.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Protocol

import numpy as np

import sevenbar as sb
from evidence.certainty.family import Family, Judge
from evidence.fuzz.checks import Broken, hold
from sevenbar.arrays import Floats
from sevenbar.errors import DescriptionError, RequestError
from sevenbar.kinematics.circuits.poses import poses

PART = "Several loops"

#: Links that pins join, and slides (~); the first joint drives. F is the ground.
KINDS = {
    "Watt": "F A|A B|B C|C F|C D|D E|E F",
    "Watt, driven at the lever": "F E|E D|D C|C F|C B|B A|A F",
    "Watt, driven between crank and coupler": "A B|F A|B C|C F|C D|D E|E F",
    "Stephenson I": "F A|A B|B C|C F|A D|D E|E C",
    "Stephenson II": "F E|E A|A C|C B|A D|D B|B F",
    "Stephenson III": "F A|A B|B C|C F|B D|D E|E F",
    "Stephenson III, driven at the dyad": "F E|E D|D B|B A|A F|B C|C F",
    "walking leg of six links": "F A|A B|F C|C B|B L|F D|D L",
    "walking leg of eight links": "F A|A B|A C|F T|B T|F D|C D|D G|T E|E G",
    "eight links, three dyads in a row": "F A|A B|B C|C F|C D|D E|E F|E G|G H|H F",
    "eight links, dyads on couplers": "F A|A B|B C|C F|B D|D E|E F|D G|G H|H F",
    "ten links, four dyads": "F A|A B|B C|C F|C D|D E|E F|E G|G H|H F|H I|I J|J F",
    "platform on three legs": "F A|A B|F C|F D|B P|C P|D P",
    "truss of seven links, star": "F A|A G|F H|F I|G J|J H|H K|K I|I L|L G",
    "truss of seven links, path": "F A|A G|G H|H I|F J|J H|G K|K I|F L|L I",
    "truss of seven links, four": "F A|G H|A I|I G|F J|J G|F K|K H|F L|L H",
    "shaper": "F A|A B|B ~ C|C F|C D|D E|E ~ F",
    "two pistons on a crank": "F A|A B|B C|C ~ F|A D|D E|E ~ F",
    "knee press": "F A|A B|B C|C F|B D|D E|E ~ F",
    "yoke with a dyad": "F A|A B|B ~ C|C ~ F|C D|D E|E F",
    "slider-crank and dyad, driven by the slide": "F ~ A|A B|B C|C F|B D|D E|E F",
    "a slide in a coupler": "F A|A B|B C|C F|B ~ D|D E|E F",
    "two rockers on a crank": "F A|A B|B C|C F|A D|D E|E F",
    "three pistons on a crank": "F A|A B|B C|C ~ F|A D|D E|E ~ F|A G|G H|H ~ F",
    "excavator, driven by its cylinder": "A ~ B|F A|B C|C F|C D|D E|E F",
    "knee press of eight links": "F A|A B|B C|C F|C D|D E|E F|D G|G H|H ~ F",
}

#: How many inputs are tried, one of them as drawn, and how far a slide may be from there [length].
INPUTS, FAR = 3, 0.3

#: Nets that are drawn until one has one freedom.
MOST_DRAWN = 50

#: Starts of the search, its steps, and what closes.
STARTS, STEPS, CLOSED = 300, 50, 1e-10

#: A mode is open by less [size about 1].
CLOSES = 1e-8

#: A pose is isolated, and said to be found, where the least singular value is this part of the greatest.
ISOLATED = 1e-4

#: Poses nearer than this in every number are one.
SAME = 1e-5

#: Rows of a turn whose modes must lie on one circuit each.
ROWS = 24


@dataclass(frozen=True)
class Joint:
    """A pin, or a slide along a direction, of two links as drawn."""

    links: tuple[str, str]
    at: tuple[float, float]
    along: tuple[float, float] | None


@dataclass(frozen=True)
class Net:
    """Joints, of which the first drives."""

    joints: Sequence[Joint]

    def linkage(self) -> sb.Linkage:
        """The same as a linkage."""
        rows = [
            {
                "name": f"j{k}",
                "kind": "P" if joint.along else "R",
                "at": (*joint.at, 0),
                "axis": (*joint.along, 0) if joint.along else (0, 0, 1),
                "between": joint.links,
            }
            for k, joint in enumerate(self.joints)
        ]
        return sb.from_axes(rows, ground="F", drive="j0")

    @property
    def moving(self) -> list[str]:
        """The links but the ground."""
        return list(dict.fromkeys(link for joint in self.joints for link in joint.links if link != "F"))

    @property
    def slides(self) -> bool:
        """Whether the input slides."""
        return self.joints[0].along is not None

    def flat(self, frames: Floats) -> Floats:
        """Poses (m, links, 4, 4) as numbers (m, links, 4)."""
        return frames[:, :, [0, 1, 0, 1], [3, 3, 0, 0]]

    def open_by(self, frames: Floats, value: float) -> float:
        """The greatest error of an equation at poses (m, links, 4, 4)."""
        turns = np.arctan2(frames[..., 1, 0], frames[..., 0, 0])
        states = np.stack([frames[..., 0, 3], frames[..., 1, 3], turns], axis=-1)
        error, _ = self.equations(states.reshape(len(frames), 3 * len(self.moving)), value)
        return float(np.abs(error).max(initial=0.0))

    def equations(self, x: Floats, value: float) -> tuple[Floats, Floats]:
        """Errors (starts, equations) of all joints and of the input; derivatives by shifts and turns."""
        moving, count = self.moving, len(x)
        errors, slopes = [], []

        def add(error: Floats, parts: Sequence[tuple[str, Sequence[Floats | float]]]) -> None:
            slope = np.zeros((count, 3 * len(moving)))
            for link, by in parts:
                if link != "F":
                    first = 3 * moving.index(link)
                    for k in range(3):
                        slope[:, first + k] += by[k]
            errors.append(error)
            slopes.append(slope)

        def state(link: str) -> tuple[Floats, Floats]:
            if link == "F":
                return np.zeros(count, dtype=complex), np.zeros(count)
            first = 3 * moving.index(link)
            return x[:, first] + 1j * x[:, first + 1], x[:, first + 2]

        for number, joint in enumerate(self.joints):
            (one, a), (two, b) = map(state, joint.links)
            before, after = joint.links
            place = complex(*joint.at)
            p, q = np.exp(1j * a) * place, np.exp(1j * b) * place
            apart, turned = two + q - one - p, np.angle(np.exp(1j * (b - a)))
            if joint.along is None:
                add(apart.real, [(after, (1, 0, -q.imag)), (before, (-1, 0, p.imag))])
                add(apart.imag, [(after, (0, 1, q.real)), (before, (0, -1, -p.real))])
            else:
                along = np.exp(1j * a) * complex(*joint.along)
                add(turned, [(after, (0, 0, 1)), (before, (0, 0, -1))])
                for which in (1j * along, along):
                    if which is along and number:
                        continue
                    swung = (apart * np.conj(1j * which)).real - (1j * p * np.conj(which)).real
                    add(
                        (apart * np.conj(which)).real - (value if which is along else 0.0),
                        [
                            (after, (which.real, which.imag, (1j * q * np.conj(which)).real)),
                            (before, (-which.real, -which.imag, swung)),
                        ],
                    )
            if joint.along is None and number == 0:
                off = np.angle(np.exp(1j * (b - a - value)))
                add(off, [(after, (0, 0, 1)), (before, (0, 0, -1))])
        return np.stack(errors, axis=1), np.stack(slopes, axis=1)

    def modes(self, value: float, rng: np.random.Generator) -> Floats:
        """Isolated poses (modes, links, 4) with the input at a value: where damped steps end."""
        count = len(self.moving)
        x = rng.uniform(-1.5, 1.5, (STARTS, count, 3))
        x[:, :, 2] *= math.pi / 1.5
        found = isolated(
            partial(self.equations, value=value),
            x.reshape(STARTS, -1),
            lambda pose: flattened(pose.reshape(count, 3)),
        )
        return np.array(found).reshape(len(found), count, 4)


def isolated(
    equations: Callable[[Floats], tuple[Floats, Floats]],
    x: Floats,
    flat: Callable[[Floats], Floats],
    longest: float = math.inf,
) -> list[Floats]:
    """Isolated poses, each once as `flat` has it, where damped steps from places x (starts, unknowns) end."""
    for _ in range(STEPS):
        error, slope = equations(x)
        square = np.einsum("sek,sel->skl", slope, slope)
        damping = 0.1 * np.minimum((error**2).sum(axis=1), 1.0) + 1e-15
        square += damping[:, None, None] * np.eye(square.shape[1])
        step = np.linalg.solve(square, np.einsum("sek,se->sk", slope, error)[:, :, None])[:, :, 0]
        x = x - np.clip(step, -longest, longest)
    error, slope = equations(x)
    closed = np.abs(error).max(axis=1) < CLOSED
    singular = np.linalg.svd(slope[closed], compute_uv=False)
    found: list[Floats] = []
    for pose, values in zip(x[closed], singular, strict=True):
        numbers = flat(pose)
        if values[-1] > ISOLATED * values[0] and not any(np.abs(numbers - f).max() < SAME for f in found):
            found.append(numbers)
    return found


def flattened(states: Floats) -> Floats:
    """Shifts and turns (.., 3) as numbers without whole turns (.., 4)."""
    return np.stack([states[..., 0], states[..., 1], np.cos(states[..., 2]), np.sin(states[..., 2])], axis=-1)


def drawn(kind: str, rng: np.random.Generator) -> Net:
    """A net of a kind: with places anywhere, or in decimals as people draw."""
    decimals = rng.random() < 0.5
    joints = []
    for text in KINDS[kind].split("|"):
        first, *slide, second = text.split()
        at = rng.uniform(-1, 1, 2)
        slope = rng.uniform(0, math.pi)
        if decimals:
            at, slope = at.round(1), rng.choice([0.0, math.pi / 2, math.pi / 4])
        along = (math.cos(slope), math.sin(slope)) if slide else None
        joints.append(Joint((first, second), (float(at[0]), float(at[1])), along))
    return Net(joints)


class AnyNet(Protocol):
    """A net, and a search for its modes that is its own."""

    @property
    def moving(self) -> list[str]:
        """The links but the ground."""

    @property
    def slides(self) -> bool:
        """Whether the input slides."""

    def linkage(self) -> sb.Linkage:
        """The same as a linkage."""

    def flat(self, frames: Floats) -> Floats:
        """Poses (m, links, 4, 4) as numbers (m, links, k)."""

    def open_by(self, frames: Floats, value: float) -> float:
        """The greatest error of an equation at poses (m, links, 4, 4)."""

    def modes(self, value: float, rng: np.random.Generator) -> Floats:
        """Isolated poses (modes, links, k) with the input at a value."""


def complete(draw: Callable[[np.random.Generator], AnyNet]) -> Judge:
    """Judges nets: no isolated pose is missing, each mode closes, and each of a turn lies on one circuit."""

    def judge(rng: np.random.Generator, seen: Counter[str]) -> None:
        for _ in range(MOST_DRAWN):
            net = draw(rng)
            try:
                linkage = net.linkage()
            except DescriptionError:
                # two joints of a link in one place, say
                continue
            if linkage.mobility().finite == 1:
                break
        else:
            raise Broken(f"none of {MOST_DRAWN} that were drawn moves with one freedom")
        reach = FAR if net.slides else math.pi
        for value in (0.0, *rng.uniform(-reach, reach, INPUTS - 1)):
            modes = linkage.assembly_modes(value)
            seen[str(modes.completeness)] += 1
            frames = poses(linkage, modes.q)
            numbers = [linkage.link_names.index(link) for link in net.moving]
            frames = frames[:, numbers]
            # turns of a ball that have no direction give no pose
            whole = np.isfinite(frames).all(axis=(1, 2, 3))
            if not whole.all():
                seen["modes with undefined turns"] += int((~whole).sum())
            off = net.open_by(frames[whole], value)
            hold(off < CLOSES, f"a mode at {value:g} is open by {off:.2g}")
            known = net.flat(frames[whole])
            for pose in net.modes(value, rng):
                seen["poses"] += 1
                near = np.abs(known - pose).max(axis=(1, 2), initial=0.0) < 10 * SAME
                hold(
                    near.any() or not whole.all(),
                    f"a pose at {value:g} is no mode ({modes.completeness}, {len(known)} modes)",
                )
        if not net.slides:
            try:
                on_one_circuit(linkage, seen)
            except RequestError as error:
                # parallel slides, say
                hold("stands still" in str(error), str(error))
                seen["inputs that rest"] += 1

    return judge


def on_one_circuit(linkage: sb.Linkage, seen: Counter[str]) -> None:
    """Each mode at inputs of a turn is a row of one circuit, or touches a change point."""
    motion = linkage.motion(ROWS)
    column = linkage.columns.index(motion.input)
    turning = linkage.turning
    for angle in np.arange(ROWS) * math.tau / ROWS:
        for mode in linkage.assembly_modes(angle).q:
            on = 0
            for circuit in motion:
                at = np.abs(np.exp(1j * circuit.q[:, column]) - np.exp(1j * angle)) < 1e-9
                rows = circuit.q[at]
                turned = np.abs(np.exp(1j * rows) - np.exp(1j * mode))
                apart = np.where(turning, turned, np.abs(rows - mode) / linkage.size)
                apart = np.where(np.isnan(mode), 0.0, apart)
                on += bool((apart.max(axis=1, initial=0.0) < SAME).any())
            seen["modes on circuits"] += 1
            if on != 1 and not motion.change_points:
                raise Broken(f"a mode at {angle:.4f} lies on {on} circuits of {len(motion)}")


FAMILIES = [Family(PART, kind, 40, complete(partial(drawn, kind)), quick=1) for kind in KINDS]
