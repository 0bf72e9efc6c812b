"""The tree of all pages that stands beside each: made for the first, and for others with its links from there.

Sphinx makes it for each of some hundred pages, and the theme adds switches to it: most of the time of the whole site.
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
MARKS = re.compile(r'(?<=<ul) class="current"|(?<=[\w"]) (?:current(?=[ "])|current-page(?=")|checked="")(?=[^<]*>)')
SWITCH = 'class="toctree-checkbox"'
LINK_TO = '(?<=internal" )href="[^":]*"'
PARTS = re.compile(f'(<ul|</ul>|<li class="toctree-l[^"]*|</li>|<a class="(?=reference internal")|{LINK_TO}|{SWITCH})')


class SharedTree:
    """The tree as text with links from the top of the site, and without marks of the page that it stands beside."""

    def __init__(self, text: str, place: str) -> None:
        def from_top(link: re.Match[str]) -> str:
            before, middle, target, after = link.groups()
            return before + middle + (normpath(join(dirname(place), target)) if target != "#" else place) + after

        self.parts = PARTS.split(MARKS.sub("", LINK.sub(from_top, text)))
        self.around: dict[str, list[int]] = {}  # of the target of each link: it, its item and all around it
        self.switches: dict[int, int] = {}  # of items that open and close
        opened: list[int] = []
        for number, part in enumerate(self.parts):
            if part.startswith(("<ul", "<li", "<a")):
                opened.append(number)
            elif part.startswith("href="):
                self.around.setdefault(part[6:-1], []).extend(opened)
                opened.pop()  # the link
            elif part == SWITCH:
                self.switches[opened[-1]] = number
            elif part in ("</ul>", "</li>"):
                opened.pop()

    def beside(self, place: str) -> str:
        """The tree beside the page at a place."""
        parts, items = list(self.parts), list[int]()
        for number in self.around.get(place, ()):
            mark = {"<u": ' class="current"', "<l": " current", "<a": "current "}[parts[number][:2]]
            parts[number] = self.parts[number] + mark
            if mark == " current":
                items.append(number)
            if number in self.switches:
                parts[self.switches[number]] = f'checked="" {SWITCH}'
        if items:  # the innermost, which the theme marks once more
            parts[items[-1]] += " current-page"
        return "".join(self._link(part, place) if part.startswith("href=") else part for part in parts)

    def _link(self, part: str, place: str) -> str:
        target = part[6:-1]
        return f'href="{relative_uri(place, target) if target != place else "#"}"'


def setup(app: Sphinx) -> dict[str, bool]:
    made: list[tuple[str, Callable[..., str]]] = []  # place of the first page, and its tree
    shared: list[SharedTree] = []

    def make_once(app: Sphinx, page: str, template: str, context: dict[str, Any], doctree: object) -> None:
        if not made:
            made.append((app.builder.get_target_uri(page), cache(context["toctree"])))
        context["toctree"] = made[0][1]  # the theme keeps what it makes of an equal tree

    def share(app: Sphinx, page: str, template: str, context: dict[str, Any], doctree: object) -> None:
        if not shared:
            shared.append(SharedTree(context["furo_navigation_tree"], made[0][0]))
        context["furo_navigation_tree"] = shared[0].beside(app.builder.get_target_uri(page))

    app.connect("html-page-context", make_once, priority=400)  # before the theme asks for it
    app.connect("html-page-context", share, priority=600)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
