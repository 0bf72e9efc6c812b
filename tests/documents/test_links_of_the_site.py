"""Every link within the built site leads somewhere, and no page takes a file from another host.

The folder of the built site is the environment variable INERTER_SITE.
"""

from __future__ import annotations

import os
import re
from dataclasses import dataclass, field
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest

SITE = Path(os.environ.get("INERTER_SITE", ""))
pytestmark = [
    pytest.mark.campaign,
    pytest.mark.skipif(
        "INERTER_SITE" not in os.environ, reason="INERTER_SITE does not name the folder of a built site: see .ci/run"
    ),
]
# What has places, links or files, and the ends of scripts; pages have fifty times as many other tags
TOLD = re.compile(r"""</script>|<[a-zA-Z](?:"[^"]*"|[^">])*?\s(?:id|name|href|src)=(?:"[^"]*"|[^">])*>""")


@dataclass
class Found:
    """What a page has: places to which links may lead, its links, and the files that it takes."""

    places: set[str] = field(default_factory=set)
    links: list[str] = field(default_factory=list)
    files: list[str] = field(default_factory=list)


class Reader(HTMLParser):
    """Reads a page into `found`."""

    def __init__(self) -> None:
        super().__init__()
        self.found = Found()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        told = {name: value for name, value in attrs if value}
        self.found.places |= {told[name] for name in ("id", "name") if name in told}
        if tag == "a" and "href" in told:
            self.found.links.append(told["href"])
        if tag in ("img", "script") and "src" in told:
            self.found.files.append(told["src"])
        if tag == "link" and told.get("rel") == "stylesheet":
            self.found.files.append(told.get("href", ""))


@pytest.fixture(scope="module")
def pages() -> dict[Path, Found]:
    found = {}
    for path in sorted(SITE.resolve().rglob("*.html")):
        reader = Reader()
        reader.feed("".join(TOLD.findall(path.read_text(encoding="utf-8"))))
        found[path] = reader.found
    assert len(found) > 300
    return found


def test_no_page_takes_a_file_from_another_host(pages: dict[Path, Found]) -> None:
    asked = [(page.name, file) for page, found in pages.items() for file in found.files if urlsplit(file).netloc]
    assert asked == []


def test_no_link_is_dead(pages: dict[Path, Found]) -> None:
    @cache
    def target_of(folder: Path, path: str) -> Path | None:
        target = (folder / unquote(path)).resolve()
        target = target / "index.html" if target.is_dir() else target
        return target if target.exists() else None

    dead = []
    for page, found in pages.items():
        for link in dict.fromkeys([*found.links, *found.files]):
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = target_of(page.parent, parts.path) if parts.path else page
            place = unquote(parts.fragment)
            if target is None or (place and target in pages and place not in pages[target].places):
                dead.append((page.name, link))
    assert dead == []
