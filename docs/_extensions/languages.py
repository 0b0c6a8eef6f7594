"""Chinese pages: their language, the theme's labels on them, the way from each page to the other language."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from sphinx.application import Sphinx

#: Where the Chinese pages are.
FOLDER = "zh/"

#: The theme's words, as they are in its templates, in Chinese.
LABELS = {
    "Back to top": "回到顶部",
    "Contents": "目录",
    "Expand": "展开",
    "Home": "首页",
    "Light mode": "浅色",
    "Dark mode": "深色",
    "Auto light/dark, in light mode": "自动，浅色",
    "Auto light/dark, in dark mode": "自动，深色",
    "Made with ": "制作工具：",
    "Menu": "菜单",
    "Next": "下一页",
    "On this page": "本页目录",
    "Previous": "上一页",
    "Search": "搜索",
    "Skip to content": "跳到正文",
    "Toggle Light / Dark / Auto color theme": "切换浅色、深色、自动",
    "Toggle navigation of": "展开或收起",
    "Toggle site navigation sidebar": "切换导航栏",
    "Toggle table of contents sidebar": "切换本页目录",
}


def other_language(docname: str, pages: Iterable[str]) -> str:
    """The same page in the other language, or that language's first page."""
    chinese = docname.startswith(FOLDER)
    other = docname.removeprefix(FOLDER) if chinese else f"{FOLDER}{docname}"
    return other if other in set(pages) else ("index" if chinese else f"{FOLDER}index")


def in_chinese(others: Callable[[str], str]) -> Callable[..., str]:
    """The theme's words in Chinese; `others` has those that are not known here."""

    def label(text: str, **values: Any) -> str:
        found = LABELS.get(text) or LABELS.get(text.strip()) or others(text)
        return found % values if values else found

    return label


def _add(app: Sphinx, docname: str, _template: str, context: dict[str, Any], _doctree: Any) -> None:
    chinese = docname.startswith(FOLDER)
    context["other_language"] = other_language(docname, app.env.found_docs)
    context["other_language_name"] = "English" if chinese else "中文"
    context["other_language_code"] = "en" if chinese else "zh-CN"
    if chinese:
        context["language"] = "zh-CN"
        label = in_chinese(app.builder.templates.environment.globals["gettext"])
        context["_"] = context["gettext"] = label


def setup(app: Sphinx) -> dict[str, bool]:
    """Sphinx's entry."""
    app.connect("html-page-context", _add)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
