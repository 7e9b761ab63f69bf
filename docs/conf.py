"""The documentation site: ``sphinx-build -W docs BUILD`` with the extra ``docs``."""

from debrisest import __version__

project = "debrisest"
author = "The debrisest developers"
copyright = "The debrisest developers"
release = __version__
extensions = ["myst_parser", "sphinx.ext.autodoc"]
exclude_patterns = ["_build"]
nitpicky = False
html_theme = "furo"
html_title = f"debrisest {__version__}"
html_show_sourcelink = False
myst_heading_anchors = 3
autodoc_typehints = "description"
autodoc_member_order = "bysource"
