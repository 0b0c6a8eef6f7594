"""The notebooks of `examples/` run from start to end, what they assert is true, and they are kept without outputs."""

import re

import nbformat
import pytest

from places import EXAMPLES

NOTEBOOKS = sorted(EXAMPLES.glob("*.ipynb"))
#: How long one cell may take [s]; alone on two cores none takes more than fifteen.
PATIENCE = 1800
#: Packages that the notebooks may import: Sevenbar's own and what its extras bring.
IMPORTED = {"sevenbar", "numpy", "matplotlib", "pandas", "math"}

each = pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)


def code(book):
    """The texts of a notebook's cells of code."""
    return [cell.source for cell in book.cells if cell.cell_type == "code"]


def test_there_are_the_two_papers_and_a_design_study():
    assert {path.stem for path in NOTEBOOKS} == {"rssr_paper", "seven_r_paper", "design_study"}


@each
def test_a_notebook_holds_text_and_code_and_nothing_else(path):
    content = path.read_text(encoding="utf-8")
    book = nbformat.reads(content, as_version=4)
    nbformat.validate(book)
    assert set(book.metadata) == {"kernelspec", "language_info"}
    assert set(book.metadata.language_info) == {"name"}
    for cell in book.cells:
        assert not cell.metadata
        if cell.cell_type == "code":
            assert cell.outputs == []
            assert cell.execution_count is None
    # no place of anybody's machine, no other server
    assert not re.findall(r"[\"'(\s](?:/|~/|[A-Za-z]:\\\\)\w+/", content)
    assert "http" not in content
    assert path.stat().st_size < 30_000


@each
def test_a_notebook_begins_with_what_it_is_asserts_truths_and_ends_with_exercises(path):
    book = nbformat.read(path, as_version=4)
    first, *_, last = book.cells
    assert first.cell_type == last.cell_type == "markdown"
    assert re.match(r"# \w", first.source)
    assert last.source.startswith("## Exercises")
    assert len(re.findall(r"^\d\. ", last.source, re.MULTILINE)) >= 5
    assert sum(text.count("assert ") for text in code(book)) >= 10
    imported = set(re.findall(r"^(?:import|from) (\w+)", "\n".join(code(book)), re.MULTILINE))
    assert imported <= IMPORTED


# `make docs` runs them too, and an error or a false assertion fails it
@each
@pytest.mark.proof
def test_a_notebook_runs_without_error_and_what_it_asserts_is_true(path):
    # here, since they are slow to import
    from nbclient import NotebookClient

    book = nbformat.read(path, as_version=4)
    place = {"metadata": {"path": str(EXAMPLES)}}
    client = NotebookClient(book, kernel_name="python3", timeout=PATIENCE, resources=place)
    client.execute()
    outputs = [output for cell in book.cells if cell.cell_type == "code" for output in cell.outputs]
    assert not [output for output in outputs if output.output_type == "error"]
    pictures = [output for output in outputs if "image/png" in output.get("data", {})]
    assert len(pictures) >= 4
    # a figure that is told by its repr alone was not drawn
    assert all("image/png" in o.data for o in outputs if "<Figure" in o.get("data", {}).get("text/plain", ""))
    complaints = [output.text for output in outputs if output.get("name") == "stderr"]
    assert complaints == []
