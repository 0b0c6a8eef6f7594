"""The order of the core's Rust modules: each names only those before it, and a type's methods stand in one file."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from test_layers import CORE, code_of

SOURCE = CORE / "src"

#: From below; a folder is followed by its files. Its own module comes after them: it only hands on what they hold.
IN_ORDER = """
error outcome one_pose number simd vector_math vectors random taylor twofold trigonometric rigid stopping parallel piecewise driven

rssr: linkage pair free_side rates domain extremes frames motion circuits batch lines classify measures

survey: draw figures kind swing transmission cone wish readings pose tally judge cascade

loops::equation: dense rotations flat screws closed free_direction chain kinds lanes complex_frame closure
loops::rates: velocities turns points
loops::mobility: rank idle singular_place at_rest
loops::numbers: twists factors word numbered_loop slopes
loops::forces: acting stations reactions
loops::description: spun spin_axis reduce described_loop holding joint_values
loops::modes: completeness phases continuation straight circle poles geometry starts chain_closure complex_links polish many_starts curves_at_input finder assembly
loops::branch_points: locating other_input afar survey sectors counting
loops::circuits: curve follow walked_again on_curve turnings join meetings sphere change_points found arcs known_curves search
loops::motions: row row_store row_lanes passes extremes rows circuit met_twice motion through measures
loops

nets: order series square steps rows net freedoms joints before unfolded dyads in_plane monodromy planar_family planar_block dual_quaternions body_family hinged two_turns body_block loop_block modes dyad_sides pin_rows dyad_rows branch_ranges dyad_branch_points dyad_quads sized net_rows plane_points described search complex_known complex_members complex_legs complex_loops complex_pieces piece_branch_points account seeds motion
"""


def in_order(text: str) -> list[str]:
    """The modules of a text of lines `module module` and `folder: file file`."""
    order = []
    for line in text.splitlines():
        folder, colon, files = line.rpartition(": ")
        order += [f"{folder}::{file}" for file in files.split()] + [folder] if colon else line.split()
    return order


ORDER = in_order(IN_ORDER)

USE = re.compile(r"\buse\s+([^;]+);")
PATH = re.compile(r"\b(?:crate|super|self)(?:::\w+)+")
METHODS = re.compile(r"^impl(?:<[^{]*?>)? (\w+)(?:<[^{]*>)? \{", re.MULTILINE)
TYPE = re.compile(r"\b(?:struct|enum) (\w+)")


def module_of(file: Path) -> str:
    parts = file.relative_to(SOURCE).with_suffix("").parts
    return "::".join(parts[:-1] if parts[-1] == "mod" else parts)


FILES = {module_of(file): file for file in sorted(SOURCE.rglob("*.rs")) if file.stem not in {"lib", "tests"}}


def product_of(file: Path) -> str:
    """The code of a file without its tests, which may know whom they like."""
    return code_of(file.read_text(encoding="utf-8")).partition("#[cfg(test)]\nmod tests {")[0]


def paths_of(tree: str) -> list[str]:
    """The paths of a `use`: `a::{b, c::{self, d}}` has a::b, a::c and a::c::d."""
    tree = tree.strip()
    head, brace, rest = tree.partition("{")
    if not brace:
        return [re.sub(r"\s+as\s+\w+$", "", tree)]
    paths, depth, start = [], 0, 0
    inner = rest.rpartition("}")[0]
    for place, letter in enumerate(inner + ","):
        depth += (letter == "{") - (letter == "}")
        if letter == "," and depth == 0:
            part = inner[start:place].strip()
            paths += [head.strip() + path for path in paths_of(part)] if part else []
            start = place + 1
    return paths


def named_by(module: str, text: str, is_folder: bool) -> set[str]:
    """The modules that the code of one names."""
    paths = [path for tree in USE.findall(text) for path in paths_of(tree)]
    paths += PATH.findall(USE.sub(" ", text))
    found = set()
    for path in paths:
        head, *rest = path.split("::")
        here = module.split("::")
        if head == "crate":
            at = rest
        elif head == "super":
            while rest and rest[0] == "super":
                here, rest = here[:-1], rest[1:]
            at = here[:-1] + rest
        elif head == "self":
            at = here + rest
        elif is_folder and "::".join([*here, head]) in FILES:
            at = [*here, head, *rest]
        else:
            continue
        while at and "::".join(at) not in FILES:
            at = at[:-1]
        if at and "::".join(at) != module:
            found.add("::".join(at))
    return found


def test_the_order_names_every_module_once() -> None:
    assert sorted(ORDER) == sorted(FILES)


@pytest.mark.parametrize("module", ORDER)
def test_a_module_names_only_those_before_it(module: str) -> None:
    file = FILES[module]
    known = named_by(module, product_of(file), file.name == "mod.rs")
    assert known <= set(ORDER[: ORDER.index(module)])


def test_the_methods_of_a_type_of_the_loops_stand_in_its_own_file() -> None:
    for module, file in FILES.items():
        if module.startswith("loops"):
            text = product_of(file)
            assert set(METHODS.findall(text)) <= set(TYPE.findall(text)), module


def test_each_file_of_the_loops_lies_in_a_folder_whose_first_line_is_an_equation() -> None:
    for module, file in FILES.items():
        if module.startswith("loops::"):
            first = (file.parent / "mod.rs").read_text(encoding="utf-8").partition("\n")[0]
            assert file.parent.name != "loops", module
            assert re.match(r"//! .*`[^`]*=[^`]*`", first), module


def test_no_file_is_longer_than_a_reader_keeps_in_mind() -> None:
    lengths = {module: len(file.read_text(encoding="utf-8").splitlines()) for module, file in FILES.items()}
    assert {module: length for module, length in lengths.items() if length > 500} == {}


@pytest.mark.parametrize(
    ("code", "named"),
    [
        ("use crate::rigid::{Pose, Vec3};", {"rigid"}),
        ("pub(super) use super::passes::Passes;", {"loops::motions::passes"}),
        (
            "use crate::loops::{equation::dense::{self, dot}, circuits::curve::Curve as C};",
            {"loops::equation::dense", "loops::circuits::curve"},
        ),
        ("fn f() { super::rows::point(); crate::simd::level() }", {"simd", "loops::motions::rows"}),
        ("use std::f64::consts::TAU; let x = self.chain.first;", set()),
        ("use super::super::rates::points::link_twist;", {"loops::rates::points"}),
        ("use super::super::super::outcome::RowStatus;", {"outcome"}),
    ],
)
def test_each_way_to_name_a_module_is_seen(code: str, named: set[str]) -> None:
    assert named_by("loops::motions::row", code, is_folder=False) == named


def test_a_folder_names_its_files() -> None:
    code = "mod equation; pub use equation::chain::Chain;"
    assert named_by("loops", code, is_folder=True) == {"loops::equation::chain"}
