"""No class of the package has the name of another: a name in a message or a reference means one thing."""

import ast
from collections import defaultdict

from places import PACKAGE

#: Names that still stand twice; the list only becomes shorter.
STILL_TWICE = {"Output"}


def test_no_class_name_stands_twice():
    places = defaultdict(list)
    for file in sorted(PACKAGE.rglob("*.py")):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ClassDef):
                places[node.name].append(file.relative_to(PACKAGE).as_posix())
    twice = {name: files for name, files in places.items() if len(files) > 1}
    assert set(twice) == STILL_TWICE, twice
