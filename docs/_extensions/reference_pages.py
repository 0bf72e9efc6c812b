"""The pages of the reference, made of the package itself: a page for each public name, the commands, the keys of files.

They are written into `reference/` beside the other pages before the site is built, and are not kept in the repository.
"""

from __future__ import annotations

import inspect
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import is_dataclass
from inspect import cleandoc
from io import StringIO
from pathlib import Path
from textwrap import indent
from typing import Any

from rich.console import Console
from sphinx.application import Sphinx

import inerter
from inerter.cli.main import app as command_line
from inerter.field_metadata import choices_of, fields_of
from inerter.files.common.keys import ANY_NAME, Key, keys_of_files
from inerter.files.common.toml import as_line
from inerter.files.study import KIND
from inerter.formatting import format_list

# titles of packages in the order of the page, by the first part of where a name is defined
SUBJECTS = {
    "networks": "Elements and networks",
    "vehicle": "Vehicles",
    "indices": "Indices",
    "methods": "Methods",
    "norms": "Norms",
    "optimisation": "Optimisation",
    "network_search": "Search over networks",
    "pareto_fronts": "Pareto fronts",
    "uncertainty": "Tolerances",
    "simulation": "Simulation",
    "signals": "Signals",
    "roads": "Roads",
    "records": "Records",
    "identification": "Identification",
    "synthesis": "Passive synthesis",
    "systems": "Linear systems",
    "exports": "Exports",
    "figures": "Figures",
    "papers": "Papers",
    "files": "Study files and results",
    "": "Registries, fields and errors",
}

# examples of constants, which have no docstring; those of all other names stand in theirs
EXAMPLES = {
    "ELEMENTS": """
        >>> {key: kind.unit for key, kind in it.ELEMENTS.items()}
        {'spring': 'N/m', 'damper': 'N s/m', 'inerter': 'kg', 'friction': 'N', 'gap': 'm'}
        """,
    "EXPORTS": """
        >>> it.EXPORTS["matlab"].suffixes
        ('.mat', '.m')
        """,
    "GROUND": """
        >>> it.Strut("column", it.Spring(1e6), upper={"floor": 1.0}, lower=it.GROUND).lower  # no coordinate moves it
        {}
        """,
    "INDICES": """
        >>> it.INDICES["J1"] is it.RideComfort, it.INDICES["J3"].unit
        (True, 'N')
        """,
    "LAYOUTS": """
        >>> it.LAYOUTS["S3"].expression, it.LAYOUTS["SW4"].expression
        ('k | c - b', 'K | kb - (c | b)')
        >>> it.LAYOUTS["SW4"].source
        'Smith and Wang (2004), layouts S1 to S8 by their admittances'
        """,
    "METHODS": """
        >>> it.METHODS["norm"] is it.Norm, [key for key, kind in it.METHODS.items() if not kind.supports_optimisation]
        (True, [])
        """,
    "PAPERS": """
        >>> it.PAPERS["wang-su-2008"].parts[:3]
        ('rig', 'linear', 'table1')
        """,
    "ROAD_CLASSES": """
        >>> [round(it.ROAD_CLASSES[letter].mean * 1e6) for letter in "ABC"]  # Gd(n0) [1e-6 m^3]
        [16, 64, 256]
        """,
    "SIGNALS": """
        >>> it.SIGNALS["sine"].of_roads, sorted(it.SIGNALS["chirp"].keys)
        (False, ['amplitude', 'duration', 'highest', 'lowest'])
        """,
    "SymbolLine": """
        >>> dashpot: it.SymbolLine = ((0.0, 20.0), (0.0, -20.0))  # points of a line in the drawing of an element
        >>> len(dashpot)
        2
        """,
    "TASKS": """
        >>> list(it.TASKS)
        ['fronts', 'tolerances', 'budgets']
        """,
    "VEHICLES": """
        >>> it.VEHICLES["half-car"] is it.HalfCar
        True
        """,
}


def setup(app: Sphinx) -> dict[str, bool]:
    app.connect("autodoc-process-docstring", _escape_bars)
    app.connect("autodoc-process-docstring", _add_quantities)
    app.connect("builder-inited", lambda built: write_reference(Path(built.srcdir) / "reference"))
    app.connect("html-collect-pages", _forget_modules_without_source, priority=400)  # before viewcode lists them
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _forget_modules_without_source(app: Sphinx) -> Iterator[tuple[str, dict[str, Any], str]]:
    """Of such modules, as `builtins`, viewcode writes no page, but a link to it."""
    modules = getattr(app.env, "_viewcode_modules", {})
    for name in [name for name, entry in modules.items() if not entry]:
        del modules[name]
    yield from ()


def write_reference(folder: Path) -> None:
    """Write all pages of the reference; a page that has not changed keeps its time."""
    pages = {
        "index.md": _contents(),
        "commands.md": "\n".join(_commands()),
        "keys.md": "\n".join(_keys(keys_of_files())),
        "python.md": "\n".join(_names()),
        **{f"python/{name}.rst": _page(name) for name in public_names()},
    }
    for path, text in pages.items():
        target = folder / path
        target.parent.mkdir(parents=True, exist_ok=True)
        if not target.exists() or target.read_text(encoding="utf-8") != text:
            target.write_text(text, encoding="utf-8")


def public_names() -> list[str]:
    return [name for name in inerter.__all__ if name != "__version__"]


def _contents() -> str:
    return """# Reference

Every public name of the package, every command, and every key of study files, from their declarations.

```{toctree}
:maxdepth: 1

python
commands
keys
```
"""


def _names() -> Iterator[str]:
    yield "# Names in Python\n"
    yield "All are names of the module `inerter`, here imported as `import inerter as it`.\n"
    subjects = {name: _subject(getattr(inerter, name)) for name in public_names()}
    for subject, title in SUBJECTS.items():
        names = [name for name, its in subjects.items() if its == subject]
        if not names:
            continue
        yield f"## {title}\n"
        yield from _table(
            ["name", "what"], ([f"[`{n}`](python/{n}.rst)", _summary(getattr(inerter, n))] for n in names)
        )
        yield "```{toctree}\n:hidden:\n"
        yield from (f"python/{name}" for name in names)
        yield "```\n"


def _subject(thing: Any) -> str:
    home = str(getattr(thing, "__module__", None) or type(thing).__module__)
    part = home.removeprefix("inerter.").partition(".")[0]
    return part if part in SUBJECTS else ""


def _summary(thing: Any) -> str:
    if not _is_documented(thing):
        return _cell(_data(thing))
    text = inspect.getdoc(thing) or ""
    return _cell(" ".join(text.partition("\n\n")[0].split()))


def _is_documented(thing: Any) -> bool:
    return inspect.isclass(thing) or inspect.isroutine(thing)


def _page(name: str) -> str:
    thing = getattr(inerter, name)
    head = f"{name}\n{'=' * len(name)}\n\n.. currentmodule:: inerter\n\n"
    if not _is_documented(thing):
        example = indent(f">>> import inerter as it\n{cleandoc(EXAMPLES[name])}", "   ")
        return f"{head}.. py:data:: {name}\n\n   {_data(thing)}\n\n{example}\n"
    kind, members = ("class", "   :members:\n") if inspect.isclass(thing) else ("function", "")
    return f"{head}.. auto{kind}:: {name}\n{members}"


def _data(thing: Any) -> str:
    """Content of a constant, in one line."""
    if isinstance(thing, Mapping):
        return f"By name: {', '.join(f'``{key}``' for key in thing)}."
    return f"``{thing!r}``"


def _add_quantities(app: Sphinx, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """The declared quantities and choices of a class, with units, below its docstring."""
    if what != "class" or not is_dataclass(thing):
        return
    quantities = [f"``{each.name}`` [{each.unit or '-'}]: {each.sentence}" for each in fields_of(thing)]
    choices = [
        f"``{each.name}``: {each.sentence} One of {', '.join(map(repr, each.options))}."
        if each.options
        else f"``{each.name}``: {each.sentence}"
        for each in choices_of(thing)
    ]
    if quantities or choices:
        lines += ["", *(f"- {line}" for line in quantities + choices), ""]


def _escape_bars(app: Sphinx, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Bars are parallel networks in docstrings, not substitutions: they are escaped outside of literals."""
    for i, line in enumerate(lines):
        parts = line.split("``")
        if not line.startswith("    ") and ">>>" not in line:
            lines[i] = "``".join(part.replace("|", "\\|") if n % 2 == 0 else part for n, part in enumerate(parts))


def _commands() -> Iterator[str]:
    yield "# Commands\n"
    yield "What `inerter COMMAND --help` prints. Exit codes: 0 success, 1 failed computation, no feasible design or "
    yield "unreliable fit, 2 invalid input, 130 interrupted by Ctrl-C.\n"
    for name in commands():
        yield f"## inerter {name}\n"
        yield f"```text\n{_help(name)}\n```\n"


def commands() -> list[str]:
    return sorted(name for name in command_line if not name.startswith("-"))


def _help(name: str) -> str:
    shown = StringIO()
    command_line.help_print([name], console=Console(file=shown, width=100, color_system=None))
    return shown.getvalue().strip()


def _keys(keys: Sequence[Key]) -> Iterator[str]:
    yield "# Keys of files\n"
    yield 'The keys of `inerter explain`. Quantities are texts with a unit, such as `"120 kN/m"`; NAME is a name of'
    yield "your own.\n"
    for section in dict.fromkeys(key.place.partition(".")[0] for key in keys):
        yield f"## {section}\n"
        files = next(key.files for key in keys if key.section_name == section)
        if KIND.plural not in files:
            yield f"In {format_list(files)}.\n"
        places = dict.fromkeys(key.place for key in keys if key.place.partition(".")[0] == section)
        yield from _table(["key", "what"], ([f"`{place}`", _meaning(place, keys)] for place in places))


def _meaning(place: str, keys: Sequence[Key]) -> str:
    """Meaning of a key, once for all models that share it, with unit, choices, default and an example."""
    alike = [key for key in keys if key.place == place]
    sentences = dict.fromkeys(key.sentence for key in alike)
    if len(sentences) == 1:
        texts = [next(iter(sentences))]
    else:
        texts = [f"{key.of}: {key.sentence}" if key.of else key.sentence for key in alike]
    units = dict.fromkeys(key.unit for key in alike if key.unit)
    words = dict.fromkeys(word for key in alike for word in key.words)
    if units:
        texts.append(f"Unit: {' or '.join(units)}.")
    if words:
        texts.append(f"One of {', '.join(f'`{word}`' for word in words)}.")
    first = alike[0]
    if first.default not in (None, []):
        texts.append(f"Default: `{as_line(first.name, first.default)}`.")
    if first.example is not None:
        texts.append(f"Example: `{as_line('k' if first.name == ANY_NAME else first.name, first.example)}`.")
    return " ".join(texts)


def _table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> Iterator[str]:
    yield "| " + " | ".join(heads) + " |"
    yield "|" + "---|" * len(heads)
    for row in rows:
        yield "| " + " | ".join(_cell(cell) for cell in row) + " |"
    yield ""


def _cell(text: str) -> str:
    return text.replace("\\|", "|").replace("|", "\\|").replace("\n", " ")
