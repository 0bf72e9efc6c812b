"""The report of a study as one HTML page that needs no other file."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import count
from pathlib import Path
from typing import TypedDict, Unpack

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from inerter.atomic_io import write_text
from inerter.figures.labels import index_words, indices, swept_places
from inerter.figures.layouts import layout_figures
from inerter.figures.study import study_figures
from inerter.files.study.place import Sweep
from inerter.files.study.plausibility import roads_sentences
from inerter.files.study.quantity_texts import write_resolved
from inerter.files.study.running import RESOLVED
from inerter.files.study.study import Study
from inerter.formatting import capital, printed_text
from inerter.report.problem_statement import computation, problem_statement
from inerter.report.sections import Section, trade_off_section
from inerter.report.study_contents import StudyContents

_LARGER = 1.2  # than they are drawn, are drawings between text
_MOST_SWEPT = 1000  # values of a sweep on a page
_METADATA = re.compile(r"<metadata>.*?</metadata>", re.DOTALL)
_SIZE = re.compile(r'\s(?:width|height)="[^"]*"')
_WIDTH = re.compile(r'viewBox="0 0 ([\d.]+) ')
_PART = re.compile(r"<h2>(.*?)</h2>")
_REFERENCE = re.compile(r'(\bid="|href="#|url\(#)')


@dataclass(frozen=True)
class PageFigure:
    """Drawing of the page, with its caption."""

    drawing: Markup
    caption: str


def write_report(contents: StudyContents, figures: Path, path: Path) -> Path:
    """Write the report of a study to `path`, with those drawings (SVG) of it that are in the folder `figures`."""
    write_text(path, report(contents, figures))
    return path


def report(contents: StudyContents, figures: Path) -> str:
    """The page as text."""
    results, study = contents.results, contents.study
    return study_page(
        study,
        contents.conclusions,
        [index_words(results, index) for index in indices(results)],
        title=results.attrs["title"],
        swept=bool(swept_places(results)),
        searched=study.optimise is not None,
        drawings={
            layout: figure.drawing
            for layout, name in layout_figures(study).items()
            for figure in page_figures(figures, name, f"Networks of {layout}", natural=True)
        },
        sections=contents.design_sections,
        further_sections=[*contents.task_sections, *trade_off_section(results)],
        figures=[shown for one in study_figures(results) for shown in page_figures(figures, one.name, one.caption)],
        notes=results.attrs.get("notes", "").splitlines(),
        computation=list(computation(study, results)),
        study_file=_study_file(study),
    )


class PageContents(TypedDict):
    """Contents of a page on a study, in the order of the page."""

    title: str
    swept: bool
    searched: bool  # whether values were free
    drawings: Mapping[str, Markup]  # of the networks, by layout
    sections: Sequence[Section]
    further_sections: Sequence[Section]
    figures: Sequence[PageFigure]
    notes: Sequence[str]
    computation: Sequence[str]
    study_file: str


def study_page(study: Study, answers: Iterable[str], words: Sequence[str], **contents: Unpack[PageContents]) -> str:
    """Page of results on a study: `answers` in sentences, its problem with the titles of the indices, and the rest."""
    page = environment().get_template("report.html")
    headlines = [*answers, *roads_sentences(study)]
    return with_contents(page.render(headlines=headlines, **problem_statement(study, words), **contents))


def page_figures(folder: Path, name: str, caption: str, *, natural: bool = False) -> Iterator[PageFigure]:
    """The drawing of that name in the folder, if there is one; in the size in which it was drawn if `natural`."""
    path = folder / f"{name}.svg"
    if path.exists():
        yield PageFigure(inline(path.read_text(encoding="utf-8"), name, caption, natural=natural), caption)


def _study_file(study: Study) -> str:
    """The study as it was resolved; of a great many swept values the ends, and where they all are."""
    long = [sweep for sweep in study.sweeps if len(sweep.values) > _MOST_SWEPT]
    notes = [f"# {_MOST_SWEPT} of the {len(s.values)} values of {s.label}; {RESOLVED} has all.\n" for s in long]
    return "".join(notes) + write_resolved(replace(study, sweeps=tuple(map(_ends, study.sweeps))))


def _ends(sweep: Sweep) -> Sweep:
    if len(sweep.values) <= _MOST_SWEPT:
        return sweep
    return replace(sweep, values=(*sweep.values[: _MOST_SWEPT // 2], *sweep.values[-_MOST_SWEPT // 2 :]))


def environment(*packages: str) -> Environment:
    """Template environment of the pages: folders of this and other packages, and the filters.

    What is filled in is escaped.
    """
    templates = Environment(
        loader=ChoiceLoader([PackageLoader(package) for package in (*packages, "inerter.report")]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    templates.filters |= {
        "printed": printed_text,
        "breakable": breakable,
        "capital": capital,
    }
    return templates


def breakable(name: str) -> Markup:
    """Name with optional line breaks after its separators."""
    return Markup("<wbr>").join(re.split(r"(?<=[-_.+])(?=.)", name))


def inline(svg: str, name: str, caption: str, *, natural: bool) -> Markup:
    """An SVG file as an element of a page: names are made unique by `name`, and the page decides on the size unless it
    is to have its `natural` one.
    """
    body = _METADATA.sub("", svg[svg.index("<svg") :])
    opening, _, rest = body.partition(">")
    rest = _REFERENCE.sub(rf"\g<1>{name}-", rest)
    width = _WIDTH.search(opening)
    size = f' style="width: {round(_LARGER * float(width[1]))}pt"' if natural and width else ""
    return Markup(f'{_SIZE.sub("", opening)}{size} role="img" aria-label="{escape(caption)}">{rest}')


def with_contents(page: str) -> str:
    """A page with a list of its parts below its header, and a mark at each part."""
    titles = _PART.findall(page)
    links = " ".join(f'<a href="#part-{i}">{title}</a>' for i, title in enumerate(titles, 1))
    numbers = count(1)
    marked = _PART.sub(lambda found: f'<h2 id="part-{next(numbers)}">{found[1]}</h2>', page)
    return marked.replace("</header>", f'<nav class="contents" aria-label="Contents">{links}</nav>\n</header>', 1)
