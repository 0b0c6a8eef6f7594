"""The list of slow tests has tests that there are."""

import ast

from places import TESTS
from slow_tests import listed, name_of


def test_every_test_on_the_list_exists():
    there = {
        f"{file.name}::{node.name}"
        for file in TESTS.rglob("test_*.py")
        for node in ast.parse(file.read_text(encoding="utf-8")).body
        if isinstance(node, ast.FunctionDef)
    }
    assert len(listed()) > 100
    assert listed() <= there


def test_a_test_s_name_has_neither_its_case_nor_its_folder():
    assert name_of("tests/test_x.py::test_y[a/b-[1]]") == "test_x.py::test_y"
