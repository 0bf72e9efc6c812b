"""The tree of all pages that stands beside each: made for the first, and for others with its links from there.

Sphinx makes it anew for each of some hundred pages, which took most of the time of the whole site.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cache
from posixpath import dirname, join, normpath
from typing import Any

from sphinx.application import Sphinx
from sphinx.util.osutil import relative_uri

LINK = re.compile(r'(<a class=")(?:current )?(reference internal" href=")([^":]*)(")')
PARTS = re.compile(r'(<ul|</ul>|<li class="toctree-l\d+|</li>|<a class="|href="[^":]*")')


class SharedTree:
    """The tree as text with links from the top of the site, and without marks of the page that it stands beside."""

    def __init__(self, text: str, place: str) -> None:
        def from_top(link: re.Match[str]) -> str:
            before, middle, target, after = link.groups()
            return before + middle + (normpath(join(dirname(place), target)) if target != "#" else place) + after

        text = LINK.sub(from_top, text).replace('<ul class="current">', "<ul>").replace(' current">', '">')
        self.parts = PARTS.split(text)
        self.around: dict[str, list[int]] = {}  # of the target of each link: it, its item and all around it
        opened: list[int] = []
        for number, part in enumerate(self.parts):
            if part.startswith(("<ul", "<li", "<a")):
                opened.append(number)
            elif part.startswith("href="):
                self.around.setdefault(part[6:-1], []).extend(opened)
                opened.pop()  # the link
            elif part in ("</ul>", "</li>"):
                opened.pop()

    def beside(self, place: str) -> str:
        """The tree beside the page at a place."""
        parts = list(self.parts)
        for number in self.around.get(place, ()):
            mark = {"<u": ' class="current"', "<l": " current", "<a": "current "}[parts[number][:2]]
            parts[number] = self.parts[number] + mark
        return "".join(self._link(part, place) if part.startswith("href=") else part for part in parts)

    def _link(self, part: str, place: str) -> str:
        target = part[6:-1]
        return f'href="{relative_uri(place, target) if target != place else "#"}"'


def setup(app: Sphinx) -> dict[str, bool]:
    trees: dict[tuple[tuple[str, Any], ...], SharedTree] = {}

    def share(app: Sphinx, page: str, template: str, context: dict[str, Any], doctree: object) -> None:
        original: Callable[..., str] = context["toctree"]
        place = app.builder.get_target_uri(page)

        @cache
        def toctree(**options: Any) -> str:
            key = tuple(sorted(options.items()))
            if key not in trees:
                trees[key] = SharedTree(original(**options), place)
            return trees[key].beside(place)

        context["toctree"] = toctree

    app.connect("html-page-context", share, priority=400)  # before the theme asks for it
    return {"parallel_read_safe": True, "parallel_write_safe": True}
