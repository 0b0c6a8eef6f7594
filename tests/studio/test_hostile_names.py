"""Names that are code elsewhere: every file holds them as text, and pages that play run nothing of them."""

from pathlib import Path

import pytest

from evidence.fuzz.names import NAMES, REFUSED, linkage_of, page_of, written, wrong_on
from sevenbar.errors import DescriptionError


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_not_printed_is_no_name(name: str) -> None:
    with pytest.raises(DescriptionError, match="is not a name"):
        linkage_of(name)


@pytest.fixture(scope="module")
def films(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """A page that plays of each name, in which the name is text."""
    return {name: page_of(name, tmp_path_factory.mktemp("film")) for name in NAMES}


def test_each_name_is_text_in_a_page_that_plays(films: dict[str, Path]) -> None:
    assert len(films) >= 40


@pytest.mark.filterwarnings("ignore:Glyph")  # which fonts there are
@pytest.mark.parametrize("name", ["<svg onload=alert(1)>", "]]>", "=cmd|'/C calc'!A0", "../../x", "联杆“”"])
def test_a_name_is_text_in_every_file(name: str, tmp_path: Path) -> None:
    kinds = [kind for kind, _ in written(name, tmp_path, slow=False)]
    assert {"csv", "xlsx", "json", "mat", "urdf", "cmd", "toml", "svg", "html"} <= set(kinds)


def test_pages_that_play_open_no_dialog_and_play(chromium, films: dict[str, Path]) -> None:
    # one small window for all: a new one each takes longer than the film
    window = chromium.new_context(viewport={"width": 400, "height": 300})
    for name, path in films.items():
        assert wrong_on(window, path) == [], name
    window.close()
