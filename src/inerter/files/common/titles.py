"""The title of a file: its key, and the title of a file without one."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from inerter.atomic_io import escape_surrogates
from inerter.files.common.codec import Declaration, section
from inerter.files.common.entries import TEXT


def title_section(of: str, default: str = "file") -> Declaration:
    """The key `title`: the title `of` what is written, by default the name of the file, or of what `default` says."""
    return section("title", TEXT, f"Title of {of}; the name of the {default} if left out.", 'title = "My car"', None)


def title_of(found: Mapping[str, Any], path: Path) -> str:
    """Title of the loaded file at `path`: that which it gives, or its name without suffix."""
    return escape_surrogates(path.stem) if found["title"] is None else str(found["title"])
