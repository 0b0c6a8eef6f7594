"""A prototype put together in Exudyn: bodies, joints, drive, the rule of an idle spin, sensors of motion."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.kinematics.loop.rigid import perpendicular, pose
from sevenbar.simulation.engine import imported
from sevenbar.simulation.exudyn_screw import ScrewConstraint
from sevenbar.simulation.prototype import GROUND, GYRATION, Connection, MovingBody, Prototype, SpinRule
from sevenbar.text.units import LENGTHS

#: A body's mass, or that of the heaviest. Small against lengths of size one, so that constraints weigh most
#: in the residual.
MASS = 1e-2

#: The mass of what has none, as a part of the heaviest body's: Exudyn takes no body without mass.
MASSLESS = 1e-9


def pace_of(model: Prototype) -> float:
    """How many of Exudyn's units of time make a second."""
    drive = model.drive
    return abs(drive.speed) / (1.0 if drive.turns else model.size)


class ExudynAssembly:
    """A prototype put together in an Exudyn system; a length of 1 is its size, a second has `pace` units."""

    def __init__(self, items: Any, system: Any, model: Prototype, pace: float) -> None:
        self.items, self.system, self.model, self.pace = items, system, model, pace
        self.ground = system.AddObject(items.ObjectGround())
        self.nodes = [self._add_node(body) for body in model.bodies]
        self.joints: list[Any] = []
        #: The size [m], and Exudyn's unit of mass [kg].
        self.metres = model.size * LENGTHS[model.length_unit]
        masses = {} if model.acting is None else model.acting.masses
        self.kilogram = max((own.mass for own in masses.values()), default=MASS) / MASS
        self.bodies = [self._add_body(number, node) for number, node in enumerate(self.nodes)]

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
            moments = about + mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
        inertia = [moments[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))]
        return self.system.AddObject(
            self.items.ObjectRigidBody(nodeNumber=node, mass=mass, inertia=inertia, centerOfMass=list(centre))
        )

    @property
    def newton(self) -> float:
        """Exudyn's unit of force [N]."""
        return self.kilogram * self.metres * self.pace**2

    def _add_node(self, body: MovingBody) -> Any:
        rigid = imported("exudyn.rigidBodyUtilities")
        parameters = rigid.RotationMatrix2EulerParameters(body.frame[:3, :3])
        rates = rigid.AngularVelocity2EulerParameters_t(body.spin / self.pace, parameters)
        place, velocity = body.frame[:3, 3] / self.model.size, body.velocity / (self.model.size * self.pace)
        return self.system.AddNode(
            self.items.NodeRigidBodyEP(
                referenceCoordinates=[*place, *parameters], initialVelocities=[*velocity, *rates]
            )
        )

    def marker(self, body: int, frame: Floats) -> Any:
        """A marker at a frame (4, 4) of a body, or of the ground."""
        return self.system.AddMarker(
            self.items.MarkerBodyRigid(
                bodyNumber=self.ground if body == GROUND else self.bodies[body],
                localHT=pose(frame[:3, :3], frame[:3, 3] / self.model.size),
            )
        )

    def _add_constraints(
        self,
        joint: Connection,
        held: list[int],
        offset: Callable[..., list[float]] | None = None,
        *,
        from_after: bool = False,
    ) -> None:
        markers = [
            self.marker(joint.before, joint.frame_before),
            self.marker(joint.after, joint.frame_after),
        ]
        own = self.system.AddObject(
            self.items.ObjectJointGeneric(
                markerNumbers=markers[::-1] if from_after else markers,
                constrainedAxes=held,
                **({} if offset is None else {"offsetUserFunction": offset}),
            )
        )
        self.joints.append(own)

    def add_joint(self, joint: Connection) -> None:
        """Adds the constraints of a joint's kind; of a screw those of a cylinder, and one of its own."""
        self._add_constraints(joint, [int(not free) for free in joint.row.free])
        if not joint.row.is_screw:
            return
        turn = self.model.values[self.model.connections.index(joint), 5]
        screw = ScrewConstraint(joint, self.model.size, turn)
        one = np.zeros((1, 1))
        nodes = [None if body == GROUND else self.nodes[body] for body in (joint.before, joint.after)]
        self.system.AddObject(
            self.items.ObjectConnectorCoordinateVector(
                markerNumbers=[
                    self.system.AddMarker(
                        self.items.MarkerNodeCoordinates(
                            nodeNumber=self.system.AddNode(self.items.NodePointGround())
                            if node is None
                            else node
                        )
                    )
                    for node in nodes
                ],
                scalingMarker0=one,
                constraintUserFunction=screw.value,
                jacobianUserFunction=screw.slope,
            )
        )

    def add_drive(self) -> None:
        """Constrains the driven freedom alone; the joint itself has the other constraints."""
        drive = self.model.drive
        joint = self.model.connections[drive.connection]
        # Exudyn slides along axes of its first body: where the body after carries them, that one is first,
        # and the slide is the other way
        carried = joint.row.has_plane and joint.backwards and not drive.turns
        unit = (1.0 if drive.turns else self.model.size) * (-1.0 if carried else 1.0)

        def offset(_system: Any, time: float, _item: int, _parameters: Any) -> list[float]:
            values = [0.0] * 6
            values[drive.freedom] = drive.at(time / self.pace) / unit
            return values

        held = [int(row == drive.freedom) for row in range(6)]
        self._add_constraints(joint, held, offset, from_after=carried)

    def add_spin_rule(self, rule: SpinRule) -> None:
        """Constrains the idle spin of a link."""
        # of a turn about z alone held, x of the first frame and y of the second stay at right angles
        self.system.AddObject(
            self.items.ObjectJointGeneric(
                markerNumbers=[
                    self.marker(rule.before, pose(_axes_with(rule.axis_before, 0))),
                    self.marker(rule.after, pose(_axes_with(rule.axis_after, 1))),
                ],
                constrainedAxes=[0, 0, 0, 0, 0, 1],
            )
        )

    def add_sensors(self, kinds: Any) -> list[dict[str, Any]]:
        """Sensors of each body's place, attitude and their rates, by name."""
        names = (
            "Position",
            "RotationMatrix",
            "Velocity",
            "Acceleration",
            "AngularVelocity",
            "AngularAcceleration",
        )
        return [
            {
                name: self.system.AddSensor(
                    self.items.SensorBody(
                        bodyNumber=body,
                        storeInternal=True,
                        writeToFile=False,
                        outputVariableType=getattr(kinds, name),
                    )
                )
                for name in names
            }
            for body in self.bodies
        ]


def _axes_with(axis: Floats, place: int) -> Floats:
    """A rotation matrix with this unit vector as its column `place`."""
    second = perpendicular(axis)
    columns = [axis, second, np.cross(axis, second)]
    return np.column_stack(columns[-place:] + columns[:-place])
