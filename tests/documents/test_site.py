"""The site has a page for every public name, and every command and key; the theory names only tests that exist."""

from __future__ import annotations

import doctest
import inspect
import re
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from folders import ROOT
from pages import NUMBER, PAGES, text_of

import inerter
from inerter.cli.main import app
from inerter.files.common.keys import keys_of_files

# "Dodds and Robson 1973", "Smith (2002)", "Saltelli et al. (2010)": the first author, and the year
SOURCE = re.compile(r"\b([A-ZÅ][^\W\d_]+)(?:(?:, [A-Z]\w+)* and [A-Z]\w+| et al\.)? \(?((?:19|20)\d\d)\b")
NO_SITE = "the extra `site` is not installed"
YEAR = re.compile(r"\(((?:19|20)\d\d)\)")


@pytest.fixture(scope="module")
def extensions() -> Iterator[None]:
    """Extensions of the site can be imported."""
    sys.path.insert(0, str(ROOT / "docs" / "_extensions"))
    yield
    sys.path.remove(str(ROOT / "docs" / "_extensions"))


@pytest.fixture(scope="module")
def reference(extensions: None, tmp_path_factory: pytest.TempPathFactory) -> Path:
    reference_pages = pytest.importorskip("reference_pages", reason=NO_SITE)
    folder = tmp_path_factory.mktemp("reference")
    reference_pages.write_reference(folder)
    return folder


def test_every_name_has_a_page(reference: Path) -> None:
    names = {name for name in inerter.__all__ if name != "__version__"}
    assert {path.stem for path in (reference / "python").iterdir()} == names
    listed = (reference / "python.md").read_text(encoding="utf-8")
    assert [name for name in names if f"(python/{name}.rst)" not in listed] == []
    assert [name for name in names if listed.count(f"\npython/{name}\n") != 1] == []


def examples_of(name: str) -> list[doctest.Example]:
    """The examples that the docstring of a name has itself."""
    thing = getattr(inerter, name)
    documented = inspect.isclass(thing) or inspect.isroutine(thing)
    return doctest.DocTestParser().get_examples((inspect.getdoc(thing) or "") if documented else "")


def test_every_name_has_an_example(reference: Path) -> None:
    """One that says what comes out, and is run: those of docstrings with the modules, those of constants here."""
    constants = sys.modules["reference_pages"].EXAMPLES
    for name in (name for name in inerter.__all__ if name != "__version__"):
        found = doctest.DocTestParser().get_examples(constants[name]) if name in constants else examples_of(name)
        assert any(example.want for example in found), name
        assert not any(doctest.SKIP in example.options for example in found), name
        assert not (name in constants and examples_of(name)), name


def test_examples_of_constants(reference: Path) -> None:
    for name, text in sys.modules["reference_pages"].EXAMPLES.items():
        test = doctest.DocTestParser().get_doctest(text, {"it": inerter}, name, None, 0)
        assert doctest.DocTestRunner().run(test).failed == 0
        assert text.split()[-1] in (reference / "python" / f"{name}.rst").read_text(encoding="utf-8")


def test_every_command_is_there(reference: Path) -> None:
    text = (reference / "commands.md").read_text(encoding="utf-8")
    known = [name for name in app if not name.startswith("-")]
    assert len(known) >= 10
    assert [name for name in known if f"## inerter {name}\n" not in text] == []
    assert text.count("Usage: inerter") == len(known)


def test_every_key_is_there(reference: Path) -> None:
    text = (reference / "keys.md").read_text(encoding="utf-8")
    keys = keys_of_files()
    assert [key.place for key in keys if f"`{key.place}`" not in text] == []
    assert [key.sentence for key in keys if key.sentence.replace("|", "\\|") not in text] == []


def test_tests_that_the_theory_names_exist() -> None:
    named = re.findall(
        r"`((?:\w+/)?\w+(?:\.py)?)`", "".join(re.findall(r"Tests:(.*?)\n\n", text_of("theory.md") + "\n\n", re.DOTALL))
    )
    assert len(named) > 20
    assert [name for name in named if not (ROOT / "tests" / name).exists()] == []


def test_numbers_of_the_paper_are_those_of_the_tutorial() -> None:
    paper = (ROOT / "paper" / "paper.md").read_text(encoding="utf-8")
    example = paper.partition("# Example")[2].partition("# References")[0]
    numbers = NUMBER.findall(example)
    assert len(numbers) >= 5
    assert [number for number in numbers if number not in NUMBER.findall(text_of("tutorial.md"))] == []


def test_every_source_that_pages_name_is_among_the_references() -> None:
    """A page says author and year; the page of theory says where that is to be read."""
    references = text_of("theory.md").partition("## References\n")[2]
    entries = {
        (line.split(",")[0].split()[-1], year) for line in references.splitlines() for year in YEAR.findall(line)
    }
    text = "\n".join(text_of(page).partition("## References\n")[0] for page in PAGES if page != "CONTRIBUTING.md")
    named = set(SOURCE.findall(" ".join(text.split())))
    assert len(named) > 25
    assert sorted(named - entries) == []


def a_tree(first: str, group: str, member: str, at: str = "") -> str:
    """The tree of three pages as the theme writes it: links to them, seen from the one at which the reader is."""

    def mark(attribute: str, *pages: str) -> str:
        return attribute if at in pages else ""

    def item(level: int, *pages: str) -> str:
        parent = " has-children" if len(pages) > 1 else ""
        return f'<li class="toctree-l{level}{parent}{mark(" current", *pages)}{mark(" current-page", pages[0])}">'

    def link(name: str, target: str) -> str:
        return f'<a class="{mark("current ", name)}reference internal" href="{target}">{name}</a>'

    inner, outer = mark(' class="current"', "member"), mark(' class="current"', "first", "group", "member")
    switch = f'<input {mark("""checked="" """, "group", "member")}class="toctree-checkbox" id="toctree-checkbox-1"/>'
    arrow = '<label for="toctree-checkbox-1"><svg><use href="#svg-arrow-right"></use></svg></label>'
    return f"""<p class="caption"><span class="caption-text">Use</span></p>
<ul{outer}>
{item(1, "first")}{link("first", first)}</li>
<li class="toctree-l1"><a class="reference external" href="https://a.b/c">current c</a></li>
{item(1, "group", "member")}{link("group", group)}{switch}{arrow}<ul{inner}>
{item(2, "member")}{link("member", member)}</li>
</ul>
</li>
</ul>
"""


VIEWS = {
    "first.html": a_tree("#", "of/group.html", "of/member.html", at="first"),
    "of/group.html": a_tree("../first.html", "#", "member.html", at="group"),
    "of/member.html": a_tree("../first.html", "group.html", "#", at="member"),
    "code/a/b.html": a_tree("../../first.html", "../../of/group.html", "../../of/member.html"),
}


@pytest.mark.usefixtures("extensions")
@pytest.mark.parametrize("made_for", VIEWS)
def test_the_tree_beside_a_page_is_that_which_is_made_for_it(made_for: str) -> None:
    shared_tree = pytest.importorskip("shared_tree", reason=NO_SITE)
    tree = shared_tree.SharedTree(VIEWS[made_for], made_for)
    assert {place: tree.beside(place) for place in VIEWS} == VIEWS
