"""The masses of the links that exports draw, for the bodies of a linkage that are given as drawn."""

from __future__ import annotations

from sevenbar.arrays import Floats
from sevenbar.export.layout import arrange
from sevenbar.export.mass import drawn_masses
from sevenbar.export.pose import take
from sevenbar.kinematics.linkage import Linkage


def drawn_bodies(linkage: Linkage, circuit: int) -> list[tuple[float, Floats, Floats]]:
    """Of each moving link the mass [kg] in steel, its centre (3,) in the link's frame, the inertia (3, 3).

    Inertia about the centre, kg times the square of the length unit. The layout is that of an export of this
    circuit.
    """
    assembly = arrange(take(linkage.motion(), circuit))
    return [(one.mass, one.centre, one.inertia) for one in drawn_masses(assembly)[: len(linkage.links)]]
