"""Sphinx configuration of the documentation site; built by ``bash scripts/build_docs.sh``."""

from importlib.metadata import version as version_of

project = "Elastica Gym"
author = "the Elastica Gym developers"
version = release = version_of("elastica-gym")

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx.ext.mathjax", "sphinx_design"]
myst_enable_extensions = ["dollarmath", "colon_fence", "deflist"]
myst_heading_anchors = 3
source_suffix = {".md": "markdown"}

html_theme = "furo"
html_title = "Elastica Gym"
html_static_path: list[str] = []
# readable from disk: formulas need the network once, everything else is in the folder
html_copy_source = False

# single backticks in docstrings are code
default_role = "code"
autodoc_member_order = "bysource"
autodoc_typehints = "none"
napoleon_google_docstring = False
napoleon_use_ivar = True
