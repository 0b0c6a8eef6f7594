"""A block of a net that is one loop between known links, as the core takes it.

Source: docs/theory_nets.md, (7).
"""

from __future__ import annotations

from typing import cast

from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.kinematics.nets.chords import Triple, three
from sevenbar.kinematics.nets.order import LinkBlock, Parts, as_one
from sevenbar.kinematics.nets.tree import Freedom, Tree, freedoms_of

#: The letters of its joints, the advance of each, its place and direction; each link by how many joints lead
#: to it and the steps of the sides at which the loop comes and leaves; the steps of the known links; the
#: point in which all axes meet, where they do; the steps of joints that have several.
RawLoop = tuple[
    str,
    list[float],
    list[tuple[Triple, Triple]],
    list[tuple[int, tuple[int, int]]],
    tuple[int | None, int | None],
    Triple | None,
    list[list[int]],
]


def one_loop(linkage: Loop, tree: Tree, block: LinkBlock) -> RawLoop | None:
    """The joints of a block from one known link to the other; `None` of links that are no loop of joints."""
    if block.solver != "loop" or block.rods:
        return None
    carrier, pairs = tree.carrier, {joint: linkage.graph.between[joint] for joint in block.joints}

    def one(link: int) -> int:
        return as_one(linkage, tree.first[0], link)

    at = begins = next(link for pair in pairs.values() for link in pair if one(link) not in block.links)
    steps: list[Freedom] = []
    links: list[tuple[int, tuple[int, int]]] = []
    while pairs:
        joint, leaves, comes = next(
            (joint, *ends)
            for joint, pair in pairs.items()
            for ends in (pair, pair[::-1])
            if (one(ends[0]) == one(at) if steps else ends[0] == at)
        )
        outwards = pairs.pop(joint)[0] == leaves
        if steps:
            # every moving link has a step
            links.append((len(steps), cast("tuple[int, int]", (carrier[at], carrier[leaves]))))
        freedoms = freedoms_of(linkage, joint, outwards=outwards)
        steps += freedoms[:1] if linkage.joints[joint].row.is_ball else freedoms
        at = comes
    letters, advances, places, axes = zip(*steps, strict=True)
    centre = Parts(linkage).centre(block.joints) if block.group == "spherical" else None
    return (
        "".join(letters),
        list(advances),
        [(three(place), three(axis)) for place, axis in zip(places, axes, strict=True)],
        links,
        (carrier[begins], carrier[at]),
        None if centre is None else three(centre),
        [sorted(own) for joint in block.joints if len(own := tree.columns.get(joint, [])) > 1],
    )
