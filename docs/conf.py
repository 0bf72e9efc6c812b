"""The site: pages of this folder, the reference of names, commands and keys, and the gallery."""

from __future__ import annotations

import sys
from importlib.util import find_spec
from pathlib import Path

from inerter import __version__ as release

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "_extensions"))

project = "inerter"
author = "the inerter developers"
project_copyright = f"2026, {author}"
version = release
language = "en"
default_role = "code"  # names in docstrings

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
    "sphinx_copybutton",
    "sphinx_gallery.gen_gallery",
    "sphinx.ext.mathjax",
    "reference_pages",
    "shared_tree",
]
source_suffix = {".md": "myst-nb", ".rst": "restructuredtext", ".ipynb": "myst-nb"}
exclude_patterns = ["_build", "_extensions", "gallery", "examples/*.ipynb", "examples/*.py", "examples/*.json"]
suppress_warnings = ["myst.header"]  # sections of records begin at the second level

myst_enable_extensions = ["dollarmath", "amsmath", "deflist", "colon_fence"]
myst_heading_anchors = 4

nb_execution_mode = "force"  # notebooks are kept without outputs, and run whenever the site is built
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_output_stderr = "remove"  # progress
nb_ipywidgets_js = {}  # none are used, and they would come from another host

autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True

html_theme = "furo"
html_title = f"inerter {release}"
_MATHJAX = find_spec("sphinx-mathjax-offline")  # the files of it: no page asks another host for anything
assert _MATHJAX is not None
assert _MATHJAX.origin is not None
html_static_path = ["_static", str(Path(_MATHJAX.origin).parent / "static")]
mathjax_path = "mathjax/tex-svg.js"
html_css_files = ["site.css"]
html_js_files = ["site.js"]
html_copy_source = False
html_show_sphinx = False

sphinx_gallery_conf = {
    "examples_dirs": "gallery",
    "gallery_dirs": "examples",
    "image_scrapers": ("gallery_figures.scrape",),
    "download_all_examples": False,
    "show_memory": False,
    "min_reported_time": 10,
    "write_computation_times": False,  # a page whose scripts come from another host
    "abort_on_example_error": True,
    "nested_sections": False,
    "show_signature": False,
    "capture_repr": (),
}
