"""Formulas as MathML, written when the site is built: no script, and one font beside the pages."""

import html
import logging
import re
from pathlib import Path

import ziamath
from docutils import nodes
from fontTools import subset
from math_core import LatexError, LatexToMathML
from sphinx.application import Sphinx
from sphinx.errors import ExtensionError
from sphinx.util.math import get_node_equation_number
from sphinx.writers.html5 import HTML5Translator

from primes import with_full_primes

#: The font's characters that formulas may use: Latin, Greek, punctuation and arrows, operators, letters of
#: mathematics. The rest of the font is two thirds of its size.
CHARACTERS = (
    range(0x20, 0x250),
    range(0x2B0, 0x400),
    range(0x2000, 0x2400),
    range(0x27C0, 0x2B00),
    range(0x1D400, 0x1D800),
)

FONT = "STIXTwoMath.woff"

# it lists every glyph that it keeps
logging.getLogger("fontTools.subset").setLevel(logging.WARNING)

_converter = LatexToMathML()


#: Environments that would number their lines, which is Sphinx's to do.
_NUMBERED = re.compile(r"\\(begin|end)\{(align|alignat|equation|flalign|gather|multline)\}")


def _mathml(latex: str, node: nodes.Node, *, displayed: bool) -> str:
    try:
        plain = _NUMBERED.sub(r"\\\1{\2*}", latex)
        return with_full_primes(_converter.convert_with_local_state(plain, displaystyle=displayed))
    except LatexError as error:
        place = f"{node.source}:{node.line}" if node.line else node.source
        raise ExtensionError(f"{place}: formula {latex!r} cannot be written as MathML: {error}") from error


def _inline(translator: HTML5Translator, node: nodes.math) -> None:
    translator.body.append(_mathml(node.astext(), node, displayed=False))
    raise nodes.SkipNode


def _displayed(translator: HTML5Translator, node: nodes.math_block) -> None:
    translator.body.append(translator.starttag(node, "div", CLASS="formula"))
    translator.body.append(_mathml(node.astext(), node, displayed=True))
    if node["number"]:
        number = html.escape(str(get_node_equation_number(translator, node)))
        translator.body.append(f'<span class="equation-number">({number})')
        translator.add_permalink_ref(node, "Link to this equation")
        translator.body.append("</span>")
    translator.body.append("</div>\n")
    raise nodes.SkipNode


def _write_font(app: Sphinx) -> None:
    """The font of formulas, of its package (STIX Two Math, SIL Open Font License), cut to `CHARACTERS`."""
    target = Path(app.outdir) / "_static" / FONT
    if target.exists():
        return
    target.parent.mkdir(parents=True, exist_ok=True)
    options = subset.Options(flavor="woff", layout_features=["*"], drop_tables=["DSIG"])
    font = subset.load_font(str(Path(ziamath.__file__).parent / "fonts" / "STIXTwoMath-Regular.ttf"), options)
    cut = subset.Subsetter(options)
    cut.populate(unicodes=[code for codes in CHARACTERS for code in codes])
    cut.subset(font)
    subset.save_font(font, str(target), options)


def setup(app: Sphinx) -> dict[str, bool]:
    """Sphinx's entry."""
    app.add_html_math_renderer("mathml", inline_renderers=(_inline, None), block_renderers=(_displayed, None))
    app.connect("builder-inited", _write_font)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
