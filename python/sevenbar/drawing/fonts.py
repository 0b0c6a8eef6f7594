"""Fonts with Chinese characters: the one that is installed, found when a figure in Chinese is drawn."""

from __future__ import annotations

import logging
import warnings
from functools import cache
from pathlib import Path

from matplotlib.font_manager import findSystemFonts, fontManager

from sevenbar.errors import MissingFontWarning

#: Fonts with Chinese characters by their names, the better ones first.
CHINESE = (
    "Noto Sans CJK SC",
    "Source Han Sans SC",
    "Source Han Sans CN",
    "Noto Sans SC",
    "Microsoft YaHei",
    "PingFang SC",
    "Hiragino Sans GB",
    "Heiti SC",
    "WenQuanYi Micro Hei",
    "WenQuanYi Zen Hei",
    "SimHei",
    "DengXian",
    "STHeiti",
    "SimSun",
    "Songti SC",
    "Noto Serif CJK SC",
    "Arial Unicode MS",
    # the first face of a collection is all that matplotlib reads; its Chinese characters are those of Japan
    "Noto Sans CJK JP",
    "Noto Serif CJK JP",
)

#: How the files of these fonts begin, in small letters.
_FILES = ("notosanscjk", "notosanssc", "notoserifcjk", "sourcehansans", "wqy", "msyh", "simhei", "simsun",
          "pingfang", "hiragino sans gb", "stheiti", "deng", "songti", "arial unicode")  # fmt: skip


def chinese_font() -> str | None:
    """The name of an installed font with Chinese characters; `None`, with a warning, where there is none."""
    result = _installed()
    if result is None:
        warnings.warn(
            "no font with Chinese characters is installed, so figures are in English; install one, as in "
            "'apt install fonts-noto-cjk', and draw again",
            MissingFontWarning,
            stacklevel=2,
        )
    return result


@cache
def _installed() -> str | None:
    # a font that has one weight only is drawn in that, which matplotlib would note for each text
    note = "findfont: Failed to find font weight"
    logging.getLogger("matplotlib.font_manager").addFilter(
        lambda record: not record.getMessage().startswith(note)
    )
    result = _known()
    if result is None:
        # the list that matplotlib keeps may be older than the font
        for path in findSystemFonts():
            if Path(path).name.lower().startswith(_FILES):
                fontManager.addfont(path)
        result = _known()
    return result


def _known() -> str | None:
    there = {font.name for font in fontManager.ttflist}
    return next((name for name in CHINESE if name in there), None)
