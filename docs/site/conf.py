"""How Sphinx builds the site; `python -m docs` runs it on build/docs/source, where the generated pages are, too."""

from __future__ import annotations

import sys
from pathlib import Path

import giveway

ROOT = Path(giveway.__file__).parents[2]
sys.path.insert(0, str(ROOT))

project = "giveway"
author = "giveway contributors"
copyright = "giveway contributors, MIT licence"
version = release = giveway.__version__
language = "en"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "docs.mathml", "docs.repository_files"]
default_role = "code"
exclude_patterns: list[str] = []

myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3

autodoc_default_options = {"members": True, "member-order": "bysource"}
autodoc_mock_imports = ["pymoo", "distributed", "openturns"]

napoleon_use_ivar = True
napoleon_attr_annotations = False

html_theme = "furo"
html_title = f"giveway {release}"
html_math_renderer = "mathml"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sourcelink = False
html_theme_options = {"navigation_with_keys": True}
pygments_style, pygments_dark_style = "friendly", "native"

# C's own types, and types in Python's signatures: most of them are described nowhere.
nitpick_ignore_regex = [("c:identifier", "bool|u?int(8|16|32|64)_t|size_t|float|double"), ("py:.*", ".*")]
