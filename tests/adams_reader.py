"""A reader of ADAMS/View command files as the public documentation has them: parts, markers, joints, all in space.

It knows nothing of Sevenbar, and refuses what it does not know.
"""

import re
from dataclasses import dataclass, field

import numpy as np

#: The parameters of each command that is known; those that must stand begin with `!`.
COMMANDS = {
    "defaults units": "length angle force mass time coordinate_system_type orientation_type",
    "model create": "!model_name",
    "defaults model": "!model_name",
    "defaults coordinate_system": "!default_coordinate_system",
    "part create rigid_body name_and_position": "!part_name !location !orientation",
    "part modify rigid_body mass_properties": (
        "!part_name !mass !center_of_mass_marker !ixx !iyy !izz ixy izx iyz"
    ),
    "marker create": "!marker_name !location !orientation !relative_to",
    "geometry create shape cylinder": "!cylinder_name !center_marker angle_extent !length !radius",
    "geometry create shape ellipsoid": (
        "!ellipsoid_name !center_marker !x_scale_factor !y_scale_factor !z_scale_factor"
    ),
    "geometry create shape block": "!block_name !corner_marker !diag_corner_coords",
    "constraint create joint revolute": "!joint_name !i_marker_name !j_marker_name",
    "constraint create joint translational": "!joint_name !i_marker_name !j_marker_name",
    "constraint create joint cylindrical": "!joint_name !i_marker_name !j_marker_name",
    "constraint create joint planar": "!joint_name !i_marker_name !j_marker_name",
    "constraint create joint spherical": "!joint_name !i_marker_name !j_marker_name",
    "constraint create joint hooke": "!joint_name !i_marker_name !j_marker_name",
    "constraint create joint screw": "!joint_name !i_marker_name !j_marker_name !pitch",
    "constraint create motion_generator": "!motion_name !type_of_freedom !joint_name !function",
    "force create body gravitational": (
        "!gravity_field_name !x_component_gravity !y_component_gravity !z_component_gravity"
    ),
    "force create element_like translational_spring_damper": (
        "!spring_damper_name !i_marker_name !j_marker_name !stiffness !damping preload !displacement_at_preload"
    ),
    "force create direct general_force": (
        "!general_force_name !i_marker_name !j_part_name !ref_marker_name !x_force_function !y_force_function "
        "!z_force_function !x_torque_function !y_torque_function !z_torque_function"
    ),
    "measure create function": "!measure_name !function units create_measure_display",
    "simulation single_run transient": "type initial_static !end_time !number_of_steps !model_name",
}


@dataclass
class Model:
    """What a command file builds; frames (4, 4) are global."""

    units: dict = field(default_factory=dict)
    parts: dict = field(default_factory=dict)
    masses: dict = field(default_factory=dict)
    markers: dict = field(default_factory=dict)
    shapes: list = field(default_factory=list)
    joints: dict = field(default_factory=dict)
    motions: list = field(default_factory=list)
    measures: dict = field(default_factory=dict)
    gravity: list = field(default_factory=list)
    springs: dict = field(default_factory=dict)
    forces: dict = field(default_factory=dict)
    run: dict = field(default_factory=dict)


def read(text):
    """The model of a command file."""
    text.encode("ascii")
    model = Model()
    name = None
    for keywords, values in _commands(text):
        if keywords == "defaults units":
            model.units |= values
        elif keywords == "model create":
            name = values["model_name"]
            model.parts[f"{name}.ground"] = np.eye(4)
        elif keywords == "part create rigid_body name_and_position":
            _new(model.parts, values["part_name"], _frame(values, model.units))
            assert values["part_name"].startswith(f"{name}.")
        elif keywords == "marker create":
            owner, _, _ = values["marker_name"].rpartition(".")
            assert owner in model.parts
            frame = model.parts[values["relative_to"]] @ _frame(values, model.units)
            _new(model.markers, values["marker_name"], frame)
        elif keywords == "part modify rigid_body mass_properties":
            assert values["center_of_mass_marker"] in model.markers
            _new(model.masses, values["part_name"], values)
        elif keywords.startswith("geometry create"):
            marker = values.get("center_marker") or values["corner_marker"]
            assert marker in model.markers
            model.shapes.append((keywords.rpartition(" ")[2], model.markers[marker], values))
        elif keywords.startswith("constraint create joint"):
            ends = [values["i_marker_name"], values["j_marker_name"]]
            assert all(end in model.markers for end in ends)
            assert ends[0].rpartition(".")[0] != ends[1].rpartition(".")[0]
            _new(model.joints, values["joint_name"], (keywords.rpartition(" ")[2], *ends, values))
        elif keywords == "constraint create motion_generator":
            assert values["joint_name"] in model.joints
            model.motions.append(values)
        elif keywords == "measure create function":
            for marker in re.findall(r"\.[\w.]+", values["function"]):
                assert marker in model.markers
            _new(model.measures, values["measure_name"], values["function"])
        elif keywords == "force create body gravitational":
            assert not model.gravity
            model.gravity = [float(values[f"{axis}_component_gravity"]) for axis in "xyz"]
        elif keywords == "force create element_like translational_spring_damper":
            assert {values["i_marker_name"], values["j_marker_name"]} <= set(model.markers)
            _new(model.springs, values["spring_damper_name"], values)
        elif keywords == "force create direct general_force":
            functions = [values[f"{a}_{what}_function"] for what in ("force", "torque") for a in "xyz"]
            named = re.findall(r"\.[A-Za-z][\w.]+", " ".join(functions))
            assert {values["i_marker_name"], values["ref_marker_name"], *named} <= set(model.markers)
            assert values["j_part_name"] in model.parts
            _new(model.forces, values["general_force_name"], values | {"functions": functions})
        elif keywords == "simulation single_run transient":
            model.run = values
    return model


def _commands(text):
    lines = [re.sub(r"!.*", "", line).rstrip() for line in text.splitlines()]
    command = ""
    for line in lines:
        command += line.removesuffix("&") + " "
        if line.endswith("&"):
            continue
        if command.strip():
            yield _parsed(command.strip())
        command = ""
    assert not command.strip(), "the last command is not finished"


def _parsed(command):
    words = re.match(r"[a-z_]+(?: [a-z_]+)*?(?=\s+[a-z_]+ =)", command)[0]
    values = dict(re.findall(r'([a-z_]+) = ("[^"]*"|[^=]*?)(?=\s+[a-z_]+ = |\s*$)', command[len(words) :]))
    known = COMMANDS[words].split()
    assert set(values) <= {k.removeprefix("!") for k in known}, command
    assert {k[1:] for k in known if k[0] == "!"} <= set(values), command
    return words, {key: value.strip().strip('"') for key, value in values.items()}


def _new(table, name, value):
    assert re.fullmatch(r"(\.[A-Za-z][A-Za-z0-9_]*)+", name), name
    assert name.lower() not in {known.lower() for known in table}, name
    table[name] = value


def _frame(values, units):
    assert (units["coordinate_system_type"], units["orientation_type"]) == ("cartesian", "body313")
    angles = [word.strip() for word in values["orientation"].split(",")]
    assert all(angle.endswith("d") for angle in angles)
    first, second, third = np.radians([float(angle[:-1]) for angle in angles])
    frame = np.eye(4)
    frame[:3, :3] = _about(2, first) @ _about(0, second) @ _about(2, third)
    frame[:3, 3] = [float(word) for word in values["location"].split(",")]
    return frame


def _about(axis, angle):
    a, b = (axis + 1) % 3, (axis + 2) % 3
    turn = np.eye(3)
    turn[a, a] = turn[b, b] = np.cos(angle)
    turn[b, a], turn[a, b] = np.sin(angle), -np.sin(angle)
    return turn
