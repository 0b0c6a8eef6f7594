"""A prototype put together in Exudyn: bodies, joints, drive, the rule of an idle spin, sensors of motion."""

from __future__ import annotations

from typing import Any

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.export.prototype import GROUND, GYRATION, Connection, MovingBody, Prototype, SpinRule
from sevenbar.forces.bodies import inertia_at
from sevenbar.kinematics.loop.rigid import perpendicular, pose
from sevenbar.simulation.engine import imported
from sevenbar.simulation.exudyn_screw import ScrewConstraint
from sevenbar.text.units import LENGTHS

#: A body's mass, or that of the heaviest. Small against lengths of size one, so that constraints weigh most
#: in the residual.
MASS = 1e-2

#: The mass of what has none, as a part of the heaviest body's: Exudyn takes no body without mass.
MASSLESS = 1e-9

#: What Exudyn gives of each body, in its words.
MOTION = ("Position", "RotationMatrix", "Velocity", "Acceleration", "AngularVelocity", "AngularAcceleration")


def pace_of(model: Prototype) -> float:
    """How many of Exudyn's units of time make a second."""
    drive = model.drive
    return abs(drive.speed) / (1.0 if drive.turns else model.size)


class ExudynAssembly:
    """A prototype put together in an Exudyn system; a length of 1 is its size, a second has `pace` units."""

    def __init__(self, exu: Any, system: Any, model: Prototype, pace: float) -> None:
        self.system, self.model, self.pace = system, model, pace
        self._items, self._outputs = imported("exudyn.itemInterface"), exu.OutputVariableType
        self.ground = self.add("ObjectGround")
        self.nodes = [self._add_node(body) for body in model.bodies]
        self.joints: list[Any] = []
        #: The size [m], and Exudyn's units of mass [kg] and force [N].
        self.metres = model.size * LENGTHS[model.length_unit]
        masses = {} if model.acting is None else model.acting.masses
        self.kilogram = max((own.mass for own in masses.values()), default=MASS) / MASS
        self.newton = self.kilogram * self.metres * pace**2
        self.bodies = [self._add_body(number, node) for number, node in enumerate(self.nodes)]

    def add(self, kind: str, **parameters: Any) -> Any:
        """Adds an item of Exudyn, by the name of its class, which begins with what it is added as."""
        family = next(
            word for word in ("Object", "Node", "Marker", "Load", "Sensor") if kind.startswith(word)
        )
        return getattr(self.system, f"Add{family}")(getattr(self._items, kind)(**parameters))

    def add_sensor(self, kind: str, output: str, **of: Any) -> Any:
        """A sensor whose values are kept until they are read."""
        variable = getattr(self._outputs, output)
        return self.add(kind, storeInternal=True, writeToFile=False, outputVariableType=variable, **of)

    def _add_body(self, number: int, node: Any) -> Any:
        """A rigid body with the mass that acts, or one of its own where none does."""
        acting = self.model.acting
        own = None if acting is None else acting.masses.get(number)
        if own is None:
            mass = MASS if acting is None else MASS * MASSLESS
            moments, centre = mass * GYRATION**2 * np.eye(3), np.zeros(3)
        else:
            mass, centre = own.mass / self.kilogram, own.centre / self.model.size
            # Exudyn counts inertia about the frame's origin
            about = own.inertia / (self.kilogram * self.metres**2)
            moments = about + inertia_at(mass, centre)
        inertia = [moments[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))]
        return self.add(
            "ObjectRigidBody", nodeNumber=node, mass=mass, inertia=inertia, centerOfMass=list(centre)
        )

    def _add_node(self, body: MovingBody) -> Any:
        rigid = imported("exudyn.rigidBodyUtilities")
        parameters = rigid.RotationMatrix2EulerParameters(body.frame[:3, :3])
        rates = rigid.AngularVelocity2EulerParameters_t(body.spin / self.pace, parameters)
        place, velocity = body.frame[:3, 3] / self.model.size, body.velocity / (self.model.size * self.pace)
        start = {"referenceCoordinates": [*place, *parameters], "initialVelocities": [*velocity, *rates]}
        return self.add("NodeRigidBodyEP", **start)

    def marker(self, body: int, frame: Floats) -> Any:
        """A marker at a frame (4, 4) of a body, or of the ground."""
        number = self.ground if body == GROUND else self.bodies[body]
        local = pose(frame[:3, :3], frame[:3, 3] / self.model.size)
        return self.add("MarkerBodyRigid", bodyNumber=number, localHT=local)

    def _add_constraints(
        self, joint: Connection, held: list[int], *, from_after: bool = False, **more: Any
    ) -> None:
        markers = [self.marker(joint.before, joint.frame_before), self.marker(joint.after, joint.frame_after)]
        markers = markers[::-1] if from_after else markers
        self.joints.append(
            self.add("ObjectJointGeneric", markerNumbers=markers, constrainedAxes=held, **more)
        )

    def add_joint(self, joint: Connection) -> None:
        """Adds the constraints of a joint's kind; of a screw those of a cylinder, and one of its own."""
        held = [int(not free) for free in joint.row.free]
        self._add_constraints(joint, held, from_after=joint.row.slides_on_after)
        if not joint.row.is_screw:
            return
        turn = self.model.values[self.model.connections.index(joint), 5]
        screw = ScrewConstraint(joint, self.model.size, turn)
        nodes = [
            self.add("NodePointGround") if body == GROUND else self.nodes[body]
            for body in (joint.before, joint.after)
        ]
        self.add(
            "ObjectConnectorCoordinateVector",
            markerNumbers=[self.add("MarkerNodeCoordinates", nodeNumber=node) for node in nodes],
            scalingMarker0=np.zeros((1, 1)),
            constraintUserFunction=screw.value,
            jacobianUserFunction=screw.slope,
        )

    @property
    def drive_is_carried(self) -> bool:
        """Whether the driven slide is along an axis of the body after.

        Exudyn slides along axes of its first body, so that the body after is first, and slides the other way.
        """
        joint, drive = self.model.connections[self.model.drive.connection], self.model.drive
        return joint.row.slides_on_after and not drive.turns

    def add_drive(self) -> None:
        """Constrains the driven freedom alone; the joint itself has the other constraints."""
        drive, carried = self.model.drive, self.drive_is_carried
        unit = (1.0 if drive.turns else self.model.size) * (-1.0 if carried else 1.0)

        def offset(_system: Any, time: float, _item: int, _parameters: Any) -> list[float]:
            values = [0.0] * 6
            values[drive.freedom] = drive.at(time / self.pace) / unit
            return values

        held = [int(row == drive.freedom) for row in range(6)]
        joint = self.model.connections[drive.connection]
        self._add_constraints(joint, held, from_after=carried, offsetUserFunction=offset)

    def add_spin_rule(self, rule: SpinRule) -> None:
        """Constrains the idle spin of a link."""
        # of a turn about z alone held, x of the first frame and y of the second stay at right angles
        markers = [
            self.marker(rule.before, pose(_axes_with(rule.axis_before, 0))),
            self.marker(rule.after, pose(_axes_with(rule.axis_after, 1))),
        ]
        self.add("ObjectJointGeneric", markerNumbers=markers, constrainedAxes=[0, 0, 0, 0, 0, 1])

    def add_motion_sensors(self) -> list[dict[str, Any]]:
        """Sensors of each body's place, attitude and their rates, by name."""
        return [
            {name: self.add_sensor("SensorBody", name, bodyNumber=body) for name in MOTION}
            for body in self.bodies
        ]


def _axes_with(axis: Floats, place: int) -> Floats:
    """A rotation matrix with this unit vector as its column `place`."""
    second = perpendicular(axis)
    columns = [axis, second, np.cross(axis, second)]
    return np.column_stack(columns[-place:] + columns[:-place])
