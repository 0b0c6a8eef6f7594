"""What acts on a prototype, as MJCF: masses, springs and dampers.

Loads are not written: MJCF has none. They are applied while the engine runs (`mujoco_engine`).
"""

from __future__ import annotations

from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np

from sevenbar.export.mjcf_elements import add, mark, numbers
from sevenbar.export.prototype import GROUND, GYRATION, Prototype
from sevenbar.kinematics.loop.rigid import pose
from sevenbar.text.units import LENGTHS

#: Mass of every body where nothing acts [kg]: the motion that the drive prescribes does not depend on it.
MASS = 1.0

#: Least radius of gyration [m]: below, MuJoCo takes a body for none at all.
LEAST_GYRATION = 0.01

#: The mass of what has none, as a part of the heaviest body's: MuJoCo takes no moving body without mass, and
#: its soft loop gives way where bodies are very unequal.
MASSLESS = 1e-5


def gyration(model: Prototype) -> float:
    """The radius of gyration [m] of a body that has no inertia of its own."""
    return max(LEAST_GYRATION, GYRATION * model.size * LENGTHS[model.length_unit])


def heaviest(model: Prototype) -> float:
    """The mass [kg] that the flywheel is measured by."""
    masses = {} if model.acting is None else model.acting.masses
    return max((own.mass for own in masses.values()), default=MASS)


def inertial(model: Prototype, number: int) -> dict[str, str]:
    """The mass of a body: its own, a small one where only others have any, or any where nothing acts."""
    acting, metre = model.acting, LENGTHS[model.length_unit]
    own = None if acting is None else acting.masses.get(number)
    unit = heaviest(model) * gyration(model) ** 2
    if own is None:
        # the bare body of a weld does not move, whatever it weighs
        part = 1.0 if acting is None or number == GROUND else MASSLESS
        mass, inertia = part * heaviest(model), numbers([part * unit] * 3)
        return {"pos": "0 0 0", "mass": f"{mass:.17g}", "diaginertia": inertia}
    tensor = own.never_thin(gyration(model))
    entries = [tensor[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
    return {"pos": numbers(own.centre * metre), "mass": f"{own.mass:.17g}", "fullinertia": numbers(entries)}


def joint_spring(model: Prototype, number: int, freedom: int) -> dict[str, str]:
    """The springs and dampers in one freedom of a connection, as one; its coordinate is Sevenbar's column."""
    every = () if model.acting is None else model.acting.joint_springs
    own = [spring for spring in every if (spring.connection, spring.freedom) == (number, freedom)]
    if not own:
        return {}
    stiffness = sum(spring.stiffness for spring in own)
    moment = sum(spring.stiffness * spring.slack for spring in own)
    return {
        "stiffness": f"{stiffness:.17g}",
        "springref": f"{moment / stiffness if stiffness else 0.0:.17g}",
        "damping": f"{sum(spring.damping for spring in own):.17g}",
    }


def add_springs(root: Element, model: Prototype, elements: dict[int, Element]) -> None:
    """The springs between points, each a spatial tendon between two sites; a word on loads."""
    acting = model.acting
    if acting is None:
        return
    if acting.loads:
        loads = f"{len(acting.loads)} load{'s' * (len(acting.loads) > 1)}"
        root.append(ElementTree.Comment(f" {loads} of the linkage not here: MJCF has none "))
    if not acting.springs:
        return
    tendons = add(root, "tendon")
    for place, spring in enumerate(acting.springs, 1):
        numbered = {"stiffness": spring.stiffness, "springlength": spring.length, "damping": spring.damping}
        how = {key: f"{value:.17g}" for key, value in numbered.items()}
        own = add(tendons, "spatial", name=f"spring_{place}", **how)
        for end, (body, at) in zip("ab", spring.ends, strict=True):
            name = f"spring_{place}{end}"
            mark(elements[body], name, pose(np.eye(3), at), model)
            add(own, "site", site=name)
