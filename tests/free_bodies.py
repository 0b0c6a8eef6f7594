"""A net in MuJoCo, made of its description alone: every link and rod is a free body, every joint holds points together.

There is no tree and no order of solving. A slide is a body on MuJoCo's own slide joints on the link that has the rail, a
universal joint a cross, a rod a body with a ball at each end. Bodies have the axes of the ground in the drawn pose, and
lengths are relative to the size of the drawing.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import mujoco
import numpy as np

#: Half the distance of the points that hold an axis, relative to the size.
REACH = 0.5

Vector = np.ndarray
#: The rotation and the place of a body.
Pose = tuple[np.ndarray, np.ndarray]


def square_to(axis: Vector) -> tuple[Vector, Vector]:
    """Two directions square to one and to each other."""
    first = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
    first /= np.linalg.norm(first)
    return first, np.cross(axis, first)


def unit(vector: Sequence[float]) -> Vector:
    result = np.array(vector, dtype=float)
    return result / np.linalg.norm(result)


def along(*directions: Vector) -> list[Vector]:
    """Where points are held that leave no turn but about one direction, or none at all of two."""
    return [sign * REACH * direction for direction in directions for sign in (1, -1)]


def turn_between(drawn: Sequence[Vector], now: Sequence[Vector]) -> np.ndarray:
    """The rotation that takes two directions to two others at the same angle."""

    def frame(first: Vector, second: Vector) -> np.ndarray:
        side = unit(np.cross(first, second))
        return np.stack([unit(first), side, np.cross(unit(first), side)], axis=1)

    return frame(*now) @ frame(*drawn).T


@dataclass(frozen=True)
class Cross:
    """The cross of a universal joint: its place, and the axes that its two links hold."""

    body: str
    links: tuple[str, str]
    at: Vector
    axes: tuple[Vector, Vector]

    def pose(self, links: Mapping[str, Pose]) -> Pose:
        (first, place), (second, _) = (links[link] for link in self.links)
        turn = turn_between(self.axes, (first @ self.axes[0], second @ self.axes[1]))
        return turn, first @ self.at + place - turn @ self.at


@dataclass(frozen=True)
class Rod:
    """A rod and its ends as drawn."""

    body: str
    links: tuple[str, str]
    ends: tuple[Vector, Vector]

    def pose(self, links: Mapping[str, Pose]) -> Pose:
        start, end = (
            links[link][0] @ at + links[link][1] for link, at in zip(self.links, self.ends, strict=True)
        )
        drawn, now = unit(self.ends[1] - self.ends[0]), unit(end - start)
        side = square_to(now)[0]
        turn = turn_between((drawn, square_to(drawn)[0]), (now, side))
        return turn, start - turn @ self.ends[0]


@dataclass(frozen=True)
class Rails:
    """The slides of a joint: on the first link, along directions, to a place of the second."""

    joints: tuple[str, ...]
    links: tuple[str, str]
    at: Vector
    directions: tuple[Vector, ...]

    def values(self, links: Mapping[str, Pose]) -> list[float]:
        (turn, place), (other, there) = (links[link] for link in self.links)
        apart = turn.T @ (other @ self.at + there - turn @ self.at - place)
        return [float(direction @ apart) for direction in self.directions]


@dataclass
class FreeBodies:
    """MuJoCo's model of a net: each body free, every joint of points that are held together."""

    text: str
    description: dict[str, Any] = field(init=False)
    #: The links that move, in the order of their columns of velocities.
    links: list[str] = field(init=False, default_factory=list)
    crosses: list[Cross] = field(init=False, default_factory=list)
    rods: list[Rod] = field(init=False, default_factory=list)
    rails: list[Rails] = field(init=False, default_factory=list)
    held: int = field(init=False, default=0)

    def __post_init__(self) -> None:
        self.description = tomllib.loads(self.text)
        self.spec = mujoco.MjSpec()
        self.spec.option.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
        self.bodies = {self.description["ground"]: self.spec.worldbody}
        for joint in self.joints:
            for link in joint["between"]:
                if link not in self.bodies:
                    self.links.append(link)
                    self.body(link)
        for joint in self.joints:
            self.join(joint)
        for number, rod in enumerate(self.description.get("rod", [])):
            self.hang(f"rod {number}", rod)
        self.model = self.spec.compile()
        self.data = mujoco.MjData(self.model)

    @cached_property
    def joints(self) -> list[dict[str, Any]]:
        """All joints, those of pins among them."""
        result = list(self.description.get("joint", []))
        for pin in self.description.get("pin", []):
            first, *others = pin["links"]
            turn = {"kind": "R", "at": [*pin["at"], 0.0], "axis": [0, 0, 1], "name": pin.get("name")}
            result += [turn | {"between": [first, other]} for other in others]
        return result

    @cached_property
    def size(self) -> float:
        """The greatest distance of two places of the drawing [length]."""
        places = [joint["at"] for joint in self.joints]
        places += [end for rod in self.description.get("rod", []) for end in rod["at"]]
        return max(math.dist(one, other) for one in places for other in places)

    def body(self, name: str) -> None:
        self.bodies[name] = self.spec.worldbody.add_body(name=name, mass=1.0, inertia=[1, 1, 1])
        self.bodies[name].explicitinertial = True
        self.bodies[name].add_freejoint()

    def hold(self, first: Any, second: Any, at: Vector) -> None:
        """Two bodies have one point in common, which is at this place as drawn."""
        sites = [
            body.add_site(name=f"{self.held}.{i}", pos=at).name for i, body in enumerate((first, second))
        ]
        self.spec.add_equality(
            type=mujoco.mjtEq.mjEQ_CONNECT, objtype=mujoco.mjtObj.mjOBJ_SITE, name1=sites[0], name2=sites[1]
        )
        self.held += 1

    def join(self, joint: dict[str, Any]) -> None:
        """One joint of the description."""
        at = np.array(joint["at"], dtype=float) / self.size
        first, second = joint["between"]
        axes = [unit(axis) for axis in joint.get("axes", [joint["axis"]] if "axis" in joint else [])]
        rails: tuple[Vector, ...] = ()
        match joint["kind"]:
            case "U":
                cross = Cross(f"cross {joint['name']}", (first, second), at, (axes[0], axes[1]))
                self.crosses.append(cross)
                self.body(cross.body)
                for link, axis in zip(cross.links, axes, strict=True):
                    for offset in along(axis):
                        self.hold(self.bodies[link], self.bodies[cross.body], at + offset)
                return
            case "S":
                points = [np.zeros(3)]
            case "R":
                points = along(axes[0])
            case "C":
                rails, points = (axes[0],), along(axes[0])
            case "P":
                rails, points = (axes[0],), along(*square_to(axes[0]))
            case "E":
                rails, points = square_to(axes[0]), along(axes[0])
            case "K":
                rails, points = (axes[0],), along(axes[1])
            case "L":
                rails, points = (axes[1],), along(axes[0])
                first, second = second, first
        carrier = self.bodies[first]
        if rails:
            carrier = self.slide(joint["name"], (first, second), at, rails)
        for offset in points:
            self.hold(carrier, self.bodies[second], at + offset)

    def slide(self, name: str, links: tuple[str, str], at: Vector, directions: tuple[Vector, ...]) -> Any:
        """A body on slides of the first link."""
        carrier = self.bodies[links[0]].add_body(name=f"carrier {name}", mass=1.0, inertia=[1, 1, 1])
        carrier.explicitinertial = True
        names = tuple(f"{name} {number}" for number in range(len(directions)))
        for own, direction in zip(names, directions, strict=True):
            carrier.add_joint(name=own, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=direction, pos=at)
        self.rails.append(Rails(names, links, at, directions))
        return carrier

    def hang(self, name: str, rod: dict[str, Any]) -> None:
        """A rod of the description."""
        start, end = (np.array(at, dtype=float) / self.size for at in rod["at"])
        first, second = rod["between"]
        self.rods.append(Rod(name, (first, second), (start, end)))
        self.body(name)
        self.hold(self.bodies[first], self.bodies[name], start)
        self.hold(self.bodies[name], self.bodies[second], end)

    @cached_property
    def columns(self) -> np.ndarray:
        """The columns of velocities of the links, six of each: of its origin, then its turn in its own axes."""
        firsts = [int(self.model.body(link).dofadr[0]) for link in self.links]
        return np.concatenate([np.arange(first, first + 6) for first in firsts])

    def input(self, rates: np.ndarray) -> float:
        """The rate of the input, a turn at the ground or a slide, lengths in sizes."""
        name = self.description["drive"]["joint"]
        if f"{name} 0" in (joint.name for joint in self.spec.joints):
            return float(rates[self.model.joint(f"{name} 0").dofadr[0]])
        joint = next(own for own in self.joints if own.get("name") == name)
        ground, link = joint["between"]
        assert (joint["kind"], ground) == ("R", self.description["ground"])
        first = self.model.body(link).dofadr[0] + 3
        return float(unit(joint["axis"]) @ rates[first : first + 3])

    def place(self, links: Mapping[str, Pose]) -> np.ndarray:
        """MuJoCo's coordinates where the links have these poses, lengths in the unit of the description."""
        ground = self.description["ground"]
        poses = {link: (turn, place / self.size) for link, (turn, place) in links.items()}
        poses[ground] = (np.eye(3), np.zeros(3))
        poses |= {own.body: own.pose(poses) for own in (*self.crosses, *self.rods)}
        q = np.zeros(self.model.nq)
        for body, (turn, place) in poses.items():
            if body != ground:
                start = self.model.jnt_qposadr[self.model.body(body).jntadr[0]]
                q[start : start + 3] = place
                mujoco.mju_mat2Quat(q[start + 3 : start + 7], turn.ravel())
        for rails in self.rails:
            for joint, value in zip(rails.joints, rails.values(poses), strict=True):
                q[self.model.joint(joint).qposadr[0]] = value
        return q

    def constraints(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """How far all points are apart, in sizes, and the rows of their velocities, both MuJoCo's."""
        self.data.qpos[:] = q
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_comPos(self.model, self.data)
        mujoco.mj_makeConstraint(self.model, self.data)
        assert self.data.nefc == 3 * self.held
        assert (self.data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY).all()
        return self.data.efc_pos.copy(), self.data.efc_J.reshape(self.data.nefc, self.model.nv).copy()

    def moved(self, q: np.ndarray, velocities: np.ndarray, time: float) -> np.ndarray:
        """MuJoCo's coordinates after a time at constant velocities."""
        result = q.copy()
        mujoco.mj_integratePos(self.model, result, velocities, time)
        return result
