"""Pinocchio's kinematics of the open chain of seven joints, and Newton's method on it, with exact rates."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

#: Closure error at which Newton's method stops, lengths relative to the size.
CLOSED = 1e-12

#: Steps of Newton's method after which it has failed.
STEPS = 20

Follow = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]


def follower(pin: Any, links: np.ndarray) -> Follow:
    """From a pose (7,) and inputs (n,) [rad] to angles, velocities, accelerations (n, 7) at 1 rad/s.

    `links` (7, 4, 4) are the transforms of the loop; lengths are put relative to the longest.
    """
    scaled = links.copy()
    scaled[:, :3, 3] /= np.linalg.norm(links[:, :3, 3], axis=1).max()
    model = pin.Model()
    joint, placement = 0, pin.SE3.Identity()
    for number, link in enumerate(scaled):
        joint = model.addJoint(joint, pin.JointModelRZ(), placement, f"joint_{number + 1}")
        model.appendBodyToJoint(joint, pin.Inertia.Identity(), pin.SE3.Identity())
        placement = pin.SE3(link)
    tip = model.addFrame(pin.Frame("tip", joint, 0, placement, pin.FrameType.OP_FRAME))
    data, local, still = model.createData(), pin.ReferenceFrame.LOCAL, np.zeros(7)

    def follow(start: np.ndarray, inputs: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        q, dq, ddq = (np.zeros((inputs.size, 7)) for _ in range(3))
        here, dq[:, 0] = start.copy(), 1.0
        for row, theta in enumerate(inputs):
            here[0] = theta
            for _ in range(STEPS):
                jacobian = pin.computeFrameJacobian(model, data, here, tip, local)
                pin.framesForwardKinematics(model, data, here)
                error = pin.log6(data.oMf[tip]).vector
                if np.abs(error).max() < CLOSED:
                    break
                here[1:] -= np.linalg.solve(jacobian[:, 1:], error)
            else:
                raise ArithmeticError(f"no closed pose at input {theta}")
            q[row] = here
            inverse = np.linalg.inv(jacobian[:, 1:])
            dq[row, 1:] = -inverse @ jacobian[:, 0]
            pin.forwardKinematics(model, data, here, dq[row], still)
            drift = pin.getFrameAcceleration(model, data, tip, local).vector
            ddq[row, 1:] = -inverse @ drift
        return q, dq, ddq

    return follow
