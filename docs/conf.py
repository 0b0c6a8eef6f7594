"""Sphinx's settings of the documentation site: `make docs` builds it into build/site."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "_extensions"))

from jupyter_client.manager import KernelManager

import sevenbar

project = "Sevenbar"
author = "the authors of Sevenbar"
version = release = sevenbar.__version__
language = "en"

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.viewcode",
    "sphinx_copybutton",
    "formulas",
    "beyond_docs",
    "docstrings",
    "languages",
    "made_pages",
    "own_server",
]
exclude_patterns = ["_*"]

# what is indented in these pages is what a program printed or was told
highlight_language = "text"
default_role = "py:obj"
# quotes are typed as they stand
smartquotes = False

myst_enable_extensions = ["amsmath", "attrs_inline", "dollarmath"]
myst_heading_anchors = 3

# a notebook that fails, or takes longer than a reader would wait, fails the build
nb_execution_mode = "force"
nb_execution_timeout = 90
nb_execution_raise_on_error = True
nb_merge_streams = True

# kernels would warn that others can listen; files as sockets fail, since each side looks in its own folder
if hasattr(KernelManager, "transport_encryption"):
    KernelManager.transport_encryption.default_value = "auto"

autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
autodoc_preserve_defaults = True
autodoc_type_aliases = {name: name for name in ("Floats", "Integers", "Words", "Format")}
python_maximum_signature_line_length = 80

copybutton_prompt_text = r">>> |\.\.\. |\$ "
copybutton_prompt_is_regexp = True

html_theme = "furo"
templates_path = ["_templates"]
html_favicon = html_logo = "_static/mark.svg"
html_sidebars = {
    "**": [
        "sidebar/brand.html",
        "sidebar/language.html",
        "sidebar/search.html",
        "sidebar/scroll-start.html",
        "sidebar/navigation.html",
        "sidebar/scroll-end.html",
    ]
}
html_title = f"Sevenbar {version}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_copyright = False
html_show_sourcelink = False
