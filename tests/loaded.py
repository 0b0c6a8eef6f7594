"""Loops of the gallery with random bodies, loads and springs."""

from __future__ import annotations

import numpy as np

import sevenbar as sb
from sevenbar.kinematics.circuits.circuit import Circuit


def random_body(rng: np.random.Generator, size: float, metre: float = 1e-3) -> sb.Body:
    """A body of five particles, so that no rule of inertia is broken."""
    places, masses = rng.normal(size=(5, 3)) * 0.2 * size, rng.uniform(0.1, 1.0, 5)
    centre = masses @ places / masses.sum()
    arms = metre * (places - centre)
    inertia = sum(m * (x @ x * np.eye(3) - np.outer(x, x)) for m, x in zip(masses, arms, strict=True))
    return sb.Body(float(masses.sum()), tuple(centre), inertia)


def loaded_circuit(name: str, samples: int = 360) -> tuple[sb.Linkage, Circuit]:
    rng = np.random.default_rng(7)
    linkage = sb.load(name)
    size, last = linkage.motion(8).circuits[0].size, len(linkage.joints)
    linkage = linkage.loaded(
        bodies={link: random_body(rng, size) for link in range(1, last)},
        gravity=(1.0, 2.0, -9.8),
        loads=[sb.Load(last - 1, (3.0, 4.0, -5.0), (0.1, 0.2, 0.3), at=(0.1 * size, 0.0, 0.0), axes="link")],
        springs=[
            sb.Spring(0.3, 0.4 * size, 0.01, links=(1, last), at=((0.1 * size, 0.0, 0.0), (0.0, 0.0, size))),
            sb.Spring(0.0, damping=0.3, joint=linkage.drive.output),
        ],
    )
    return linkage, linkage.motion(samples).circuits[0]
