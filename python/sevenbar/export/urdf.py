"""A linkage as URDF: the tree of its links, and in a file beside it the joint that closes the loop."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as Xml

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.export.mass import BodyMass, masses
from sevenbar.export.parts import Assembly, Ball, Rod, Solid, frame_of, length_of
from sevenbar.kinematics.loop.rigid import half_turn, pose, zyx_turns
from sevenbar.text.progress import Progress, silent
from sevenbar.text.units import LENGTHS

#: The mass of a link that only joins the freedoms of one joint, as a share of the heaviest link's.
JOINING = 1e-6
#: What `limit` must tell of a slide and and a linkage does not know [N, m/s].
EFFORT, VELOCITY = 1e6, 1e3


def write_urdf(assembly: Assembly, path: Path, _progress: Progress = silent) -> None:
    """Writes the tree to `path` and the loop joint to `loop_file(path)`; metres and radians.

    The tree begins with `ground`, whose frame is the report frame, and ends with the last moving link. Each
    freedom is a joint named as its column, at zero where the column is. A screw is a turn and a slide that
    mimics it.
    """
    linkage = assembly.pose.linkage
    scale = LENGTHS[linkage.length_unit]
    graph = linkage.graph
    (closing,) = graph.closing
    open_end, _ = graph.between[closing]
    robot = Xml.Element("robot", name=linkage.name)
    robot.append(
        Xml.Comment(
            f" The tree of a closed loop: the joint '{linkage.joints[closing].name}' between "
            f"{assembly.bodies[open_end - 1]} and ground closes it and is in '{loop_file(path).name}'. "
            "Lengths in metres, angles in radians. ".replace("--", "-")
        )
    )
    loading = linkage.loading
    missing = loading.left_out(gravity=True, loads=len(loading.loads), springs=len(loading.springs))
    if missing:
        robot.append(Xml.Comment(f" Left out, for URDF has no place for it: {missing}. "))
    for colour in dict.fromkeys(part.colour for part in assembly.parts):
        channels = " ".join(f"{c / 255:.6g}" for c in bytes.fromhex(colour[1:]))
        material = Xml.SubElement(robot, "material", name=_material(colour))
        Xml.SubElement(material, "color", rgba=f"{channels} 1")
    weights = masses(assembly)
    heaviest = max(weights[: len(graph.moving)], key=lambda one: one.mass)
    _add_link(robot, assembly, assembly.bodies.index("ground"), "ground", None, scale)
    cross = graph.ground
    for i in graph.tree:
        joint, (before, after) = linkage.joints[i], graph.between[i]
        name, parent, mount = (
            assembly.bodies[after - 1],
            assembly.bodies[before - 1],
            linkage.joint_on(i, before),
        )
        q = np.vstack([assembly.pose.circuit.q, assembly.pose.q])[:, linkage.places[i]]
        steps = joint.steps(q)
        names = [column for column, _ in joint.row.named(joint.name)]
        for k, ((step, values), column) in enumerate(zip(steps, names, strict=True)):
            last = k == len(steps) - 1
            child = name if last else f"{name}_{k + 1}"
            kind = "prismatic" if step.freedom == "slide" else "continuous"
            element = Xml.SubElement(robot, "joint", {"name": column, "type": kind})
            _origin(element, mount @ joint.before(step), scale)
            Xml.SubElement(element, "parent", link=parent)
            Xml.SubElement(element, "child", link=child)
            Xml.SubElement(element, "axis", xyz=" ".join("1" if a == step.axis else "0" for a in range(3)))
            if step.freedom == "slide":
                low, high = scale * np.nanmin(values), scale * np.nanmax(values)
                limits = {"lower": low, "upper": high, "effort": EFFORT, "velocity": VELOCITY}
                Xml.SubElement(element, "limit", {key: _number(value) for key, value in limits.items()})
            if step.driven:
                Xml.SubElement(element, "mimic", joint=joint.name, multiplier=_number(scale * joint.advance))
            if last:
                _add_link(robot, assembly, after - 1, name, weights[after - 1], scale)
            elif joint.row.has_cross:
                _add_link(robot, assembly, cross, child, weights[cross], scale)
            else:
                light = BodyMass(JOINING * heaviest.mass, np.zeros(3), JOINING * heaviest.inertia)
                _add_link(robot, assembly, None, child, light, scale)
            parent, mount = child, np.eye(4)
        cross += joint.row.has_cross
    Xml.indent(robot)
    text = '<?xml version="1.0" encoding="utf-8"?>\n' + Xml.tostring(robot, encoding="unicode") + "\n"
    path.write_text(text, encoding="utf-8")
    loop_file(path).write_text(json.dumps(loop(assembly, path), indent=2) + "\n", encoding="utf-8")


def loop_file(path: Path) -> Path:
    """The file of the loop joint beside a URDF file."""
    return path.with_suffix(".loop.json")


def loop(assembly: Assembly, path: Path) -> dict[str, Any]:
    """The joint that closes the loop, and a pose in which it does; lengths in metres, angles in radians."""
    linkage = assembly.pose.linkage
    scale = LENGTHS[linkage.length_unit]
    (closing,) = linkage.graph.closing
    joint = linkage.joints[closing]
    factors = np.where(linkage.turning, 1.0, scale)
    between = linkage.graph.between[closing]
    frames = {assembly.bodies[link - 1]: linkage.joint_on(closing, link) for link in between}
    columns, angle = joint.columns, joint.angle
    if joint.backwards:
        # as written: the link from the ground, about the axes as drawn; of U the ground has the second
        turned = half_turn(joint.row.half_turn)
        frames = {link: frame @ turned for link, frame in reversed(frames.items())}
        columns, angle = columns[:: -1 if joint.row.has_cross or joint.row.numbered_back else 1], -angle
    scaled = {link: pose(frame[:3, :3], scale * frame[:3, 3]) for link, frame in frames.items()}
    sides = [{"link": link, "frame": frame.tolist()} for link, frame in scaled.items()]
    own: dict[str, Any] = {"name": joint.name, "kind": joint.kind, "columns": list(columns)}
    if joint.row.is_screw:
        own["pitch"] = scale * joint.pitch
    if joint.row.has_cross:
        own["angle"] = angle
    return {
        "format": 1,
        "tree": path.name,
        "about": "The joint that closes the loop. With the poses T of both links (of the ground 1) and the "
        "joint's motion Z(q), T_parent parent.frame Z(q) = T_child child.frame; pose holds values of all "
        "columns for which it does.",
        "units": {"length": "m", "angle": "rad"},
        "loop_joint": own | {"parent": sides[0], "child": sides[1]},
        "pose": {
            "circuit": assembly.pose.circuit.index,
            "input": assembly.pose.motion.input,
            "q": dict(zip(linkage.columns, (factors * assembly.pose.q).tolist(), strict=True)),
        },
    }


def _add_link(
    robot: Xml.Element, assembly: Assembly, body: int | None, name: str, mass: BodyMass | None, scale: float
) -> None:
    """A link with what is drawn of it; one that only joins two freedoms has no body."""
    link = Xml.SubElement(robot, "link", name=name)
    if mass is not None:
        inertial = Xml.SubElement(link, "inertial")
        _origin(inertial, pose(np.eye(3), mass.centre), scale)
        Xml.SubElement(inertial, "mass", value=_number(mass.mass))
        moments = scale**2 * mass.inertia
        names = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
        Xml.SubElement(inertial, "inertia", {key: _number(moments[at]) for key, at in names.items()})
    for part in assembly.parts:
        if part.body != body:
            continue
        for solid in part.add:
            visual = Xml.SubElement(link, "visual")
            _geometry(visual, solid, scale)
            Xml.SubElement(visual, "material", name=_material(part.colour))


def _material(colour: str) -> str:
    """The name of a colour's material: some importers take letters, digits and underscores only."""
    return f"colour_{colour.removeprefix('#')}"


def _geometry(visual: Xml.Element, solid: Solid, scale: float) -> None:
    if isinstance(solid, Ball):
        kind, sizes = "sphere", {"radius": _number(scale * solid.radius)}
    elif isinstance(solid, Rod):
        length = _number(scale * length_of(solid))
        kind, sizes = "cylinder", {"radius": _number(scale * solid.radius), "length": length}
    else:
        width = _number(scale * solid.width)
        kind, sizes = "box", {"size": f"{width} {width} {_number(scale * length_of(solid))}"}
    _origin(visual, frame_of(solid), scale)
    Xml.SubElement(Xml.SubElement(visual, "geometry"), kind, sizes)


def _origin(element: Xml.Element, frame: Floats, scale: float) -> None:
    """The frame as URDF writes it: turns about fixed x, y and z, so `Rz(yaw) Ry(pitch) Rx(roll)`."""
    yaw, pitch, roll = zyx_turns(frame[:3, :3])
    xyz = " ".join(_number(x) for x in scale * frame[:3, 3])
    Xml.SubElement(element, "origin", xyz=xyz, rpy=" ".join(map(_number, (roll, pitch, yaw))))


def _number(value: float) -> str:
    """A number to its last digit."""
    return repr(float(value) + 0.0)
