"""What acts on a prototype in Exudyn, and what its constraints bear."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.export.acting import JointSpring, PlacedLoad
from sevenbar.export.prototype import GROUND, Connection
from sevenbar.kinematics.loop.rigid import pose
from sevenbar.simulation.exudyn_assembly import ExudynAssembly
from sevenbar.text.units import LENGTHS


class ConstraintForces(NamedTuple):
    """What the drive gives (n,), and what all connections bear (n, connections, 6), as in a `Record`."""

    drive: Floats
    reactions: Floats


def add_acting(assembly: ExudynAssembly) -> None:
    """Adds weights, loads, springs and dampers."""
    acting = assembly.model.acting
    if acting is None:
        return
    pull = acting.gravity / (assembly.metres * assembly.pace**2)
    for number in acting.masses:
        marker = assembly.add("MarkerBodyMass", bodyNumber=assembly.bodies[number])
        assembly.add("LoadMassProportional", markerNumber=marker, loadVector=list(pull))
    for load in acting.loads:
        _add_load(assembly, load)
    stiff = assembly.newton / assembly.metres
    for spring in acting.springs:
        assembly.add(
            "ObjectConnectorSpringDamper",
            markerNumbers=[assembly.marker(number, pose(np.eye(3), at)) for number, at in spring.ends],
            referenceLength=spring.length / assembly.metres,
            stiffness=spring.stiffness / stiff,
            damping=spring.damping * assembly.pace / stiff,
        )
    for own in acting.joint_springs:
        _add_joint_spring(assembly, own)


def _add_load(assembly: ExudynAssembly, load: PlacedLoad) -> None:
    """A force and a torque, as large as they are at the drive's value."""
    drive, pace, (number, at) = assembly.model.drive, assembly.pace, load.place
    marker = assembly.marker(number, pose(np.eye(3), at))

    def share(_system: Any, time: float, full: list[float]) -> list[float]:
        factor = load.factor(drive.at(time / pace))
        return [factor * x for x in full]

    for kind, vector, unit in (
        ("LoadForceVector", load.force, assembly.newton),
        ("LoadTorqueVector", load.torque, assembly.newton * assembly.metres),
    ):
        if vector.any():
            how = {"bodyFixed": load.turns, "loadVectorUserFunction": share}
            assembly.add(kind, markerNumber=marker, loadVector=list(vector / unit), **how)


def _add_joint_spring(assembly: ExudynAssembly, own: JointSpring) -> None:
    """A spring about or along the axis of a joint's free turn or slide."""
    joint, turns = assembly.model.connections[own.connection], own.freedom >= 3
    # Exudyn's springs act about and along z
    axis = np.roll(np.eye(3), own.freedom % 3 - 2, axis=1)
    sides = ((joint.before, joint.frame_before), (joint.after, joint.frame_after))
    markers = [assembly.marker(body, frame @ pose(axis, np.zeros(3))) for body, frame in sides]
    unit = assembly.newton * assembly.metres if turns else assembly.newton / assembly.metres
    common = {
        "markerNumbers": markers,
        "stiffness": own.stiffness / unit,
        "damping": own.damping * assembly.pace / unit,
    }
    if not turns:
        offset, along = own.slack / assembly.metres, list(axis[:, 2])
        assembly.add("ObjectConnectorLinearSpringDamper", offset=offset, axisMarker0=along, **common)
        return
    start = assembly.model.values[own.connection, own.freedom]
    # its turns begin within half a turn
    whole = start - np.arctan2(np.sin(start), np.cos(start))
    node = assembly.add("NodeGenericData", initialCoordinates=[0], numberOfDataCoordinates=1)
    offset = own.slack - whole
    assembly.add("ObjectConnectorTorsionalSpringDamper", nodeNumber=node, offset=offset, **common)


def constraint_sensors(assembly: ExudynAssembly) -> list[list[Any]]:
    """Sensors of force and torque of each joint's constraints, the drive's last; none without masses."""
    if assembly.model.acting is None:
        return []
    kinds = ("ForceLocal", "TorqueLocal")
    return [
        [assembly.add_sensor("SensorObject", kind, objectNumber=own) for kind in kinds]
        for own in assembly.joints
    ]


def constraint_forces(
    assembly: ExudynAssembly, sensors: list[list[Any]], frames: Floats
) -> ConstraintForces | None:
    """What the constraints bear along the frames (n, bodies, 4, 4) of the bodies; `None` without masses.

    Exudyn gives the constraints' multipliers. Those of places are the force on the body before, in the
    joint's frame there. Those of turns belong to products of two axes: with three of them z0 . y1, z0 . x1
    and x0 . y1, with two x1 . z0 and y1 . z0, of the frames 0 before and 1 after.
    """
    if not sensors:
        return None
    model, drive, carried = assembly.model, assembly.model.drive, assembly.drive_is_carried
    stored = [[assembly.system.GetSensorStoredData(one)[:, 1:4] for one in pair] for pair in sensors]
    places = assembly.newton * np.array([force for force, _ in stored])
    turns = assembly.newton * assembly.metres * np.array([torque for _, torque in stored])
    axis = drive.freedom % 3
    # where the body after carries the slide, its constraint is the other way round
    given = turns[-1, :, axis] if drive.turns else (1.0 if carried else -1.0) * places[-1, :, axis]
    metre = LENGTHS[model.length_unit]
    result = []
    for number, joint in enumerate(model.connections):
        before = _placed(frames, joint.before) @ joint.frame_before
        after = _placed(frames, joint.after) @ joint.frame_after
        force = -_turned(before, places[number])
        moment = _moment(joint, before, after, turns[number])
        place = (_placed(frames, joint.before) @ joint.drawn_before)[:, :3, 3]
        moment = moment + np.cross(metre * (after[:, :3, 3] - place), force)
        if number == drive.connection:
            along = (after if carried else before)[:, :3, axis] * given[:, None]
            force, moment = (force, moment + along) if drive.turns else (force + along, moment)
        result.append(np.concatenate([force, moment], axis=1))
    return ConstraintForces(given, np.stack(result, axis=1))


def _moment(joint: Connection, before: Floats, after: Floats, turns: Floats) -> Floats:
    """The moment (n, 3) on the body after a joint by the multipliers (n, 3) of its turns."""
    if not joint.row.free[5]:
        return _turned(before, turns * [-1.0, 1.0, 1.0])
    if joint.row.free[3]:
        return np.zeros_like(turns)
    own = np.stack([-turns[:, 1], turns[:, 0], np.zeros(len(turns))], axis=1)
    return _turned(after, own)


def _placed(frames: Floats, body: int) -> Floats:
    """The frames (n, 4, 4) of a body; the ground's is the report frame."""
    return np.broadcast_to(np.eye(4), frames[:, 0].shape) if body == GROUND else frames[:, body]


def _turned(frames: Floats, vectors: Floats) -> Floats:
    return np.asarray(np.einsum("nij,nj->ni", frames[:, :3, :3], vectors))
