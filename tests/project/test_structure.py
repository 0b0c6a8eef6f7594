"""What `make structure` counts: rooms, floors, arrows, circles; and that the package has no arrow up."""

from pathlib import Path

import pytest

from evidence import ROOT, structure


def graph(**known: str) -> structure.Graph:
    """Modules by dotted names, `__` for the dot, and what each knows."""
    return {
        tuple(name.split("__")): {tuple(other.split(".")) for other in names.split()}
        for name, names in known.items()
    }


def test_rooms_are_the_first_parts_of_names_and_arrows_within_a_room_do_not_count():
    found = structure.squeezed(graph(top="a.x", a__x="a.y", a__y="b", b=""))
    assert found == {("top",): {("a",)}, ("a",): {("b",)}, ("b",): set()}
    assert structure.arrows(found) == [(("a",), ("b",)), (("top",), ("a",))]
    assert structure.floors(found) == 3


def test_a_circle_of_siblings_is_found_at_every_depth_and_no_chain_is_one():
    assert structure.circles(graph(a__x="b.x", b__x="", b__y="a.y", a__y="", c="a.x b.x")) == [
        [("a",), ("b",)]
    ]
    assert structure.circles(graph(a__x="a.y", a__y="a.z", a__z="a.x")) == [
        [("a", "x"), ("a", "y"), ("a", "z")]
    ]
    assert structure.circles(graph(a="b c", b="c", c="")) == []
    # a circle lies on one floor
    assert structure.floors(graph(top="a", a="b", b="a low", low="")) == 3


def test_a_use_of_rust_is_read_with_its_braces(tmp_path: Path):
    source = tmp_path / "crates" / "sevenbar-core" / "src"
    for folder in ("equation", "circuits"):
        (source / "loops" / folder).mkdir(parents=True)
    files = {
        "lib.rs": "pub mod rigid;\npub mod loops;",
        "rigid.rs": "// use crate::loops::equation;\nuse std::f64;",
        "loops/mod.rs": "mod equation;\nmod circuits;\npub use equation::Chain;\nuse super::rigid::Pose;",
        "loops/equation/mod.rs": "pub(super) mod chain;",
        "loops/equation/chain.rs": "use crate::{rigid::{Pose, Vec3 as V}, loops::circuits::walk::Step};\n"
        "#[cfg(test)]\nmod tests {\n    use crate::elsewhere::Thing;\n}",
        "loops/circuits/mod.rs": "mod step;\npub(super) mod walk;",
        "loops/circuits/step.rs": "use super::walk::Walk;",
        "loops/circuits/walk.rs": "fn step() -> super::super::equation::chain::Chain { unreachable!() }",
    }
    for name, text in files.items():
        (source / name).write_text(text)
    found = structure.rust_graph(tmp_path)
    assert found == graph(
        rigid="",
        loops="rigid",
        loops__equation="",
        loops__equation__chain="rigid loops.circuits.walk",
        loops__circuits="",
        loops__circuits__step="loops.circuits.walk",
        loops__circuits__walk="loops.equation.chain",
    )
    assert structure.circles(found) == [[("loops", "circuits"), ("loops", "equation")]]
    (source / "loops/equation/chain.rs").write_text("use crate::rigid::Pose;\n")
    assert structure.folders(tmp_path, structure.rust_graph(tmp_path), ("loops",)) == [
        ["loops.equation", "2", "2", ""],
        ["loops.circuits", "3", "4", "equation"],
    ]


def test_the_package_has_no_circle_and_no_arrow_up_and_an_arrow_up_is_seen():
    pytest.importorskip("grimp")
    known = structure.python_graph(ROOT)
    rooms = structure.squeezed(known)
    assert structure.circles(known) == []
    assert structure.upward(rooms, ROOT) == []
    worse = {**rooms, ("errors",): {("commands",)}}
    assert structure.upward(worse, ROOT) == [(("errors",), ("commands",))]


def test_lines_of_all_parts_are_counted():
    counted = structure.lines(ROOT)
    assert set(counted) == set(structure.PARTS)
    assert all(files and count > files for files, count in counted.values())
    pytest.importorskip("grimp")
    assert f"| tests | {counted['tests'][0]:,} |" in structure.text(ROOT)
