"""The table of error sources in the documentation has those of the package, and a test for each."""

from __future__ import annotations

import re

from folders import ROOT

TABLE = re.search(
    r"\| source \| of \| bound \| tested by \|\n(.*?)\n\n",
    (ROOT / "docs" / "methods.md").read_text(encoding="utf-8"),
    re.DOTALL,
)


def rows():
    assert TABLE is not None
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in TABLE[1].splitlines()[1:]]
    return {row[0]: row[-1].strip("`") for row in cells}


def test_it_names_every_source_that_an_estimate_can_have():
    text = "\n".join(path.read_text(encoding="utf-8") for path in sorted((ROOT / "src").rglob("*.py")))
    named = set(re.findall(r'ErrorSource\(\s*"([^"]+)"', text))
    for constant in set(re.findall(r"ErrorSource\(\s*([A-Z_]+)\b", text)):
        found = re.findall(rf'^{constant} = "([^"]+)"', text, re.MULTILINE)
        assert len(found) == 1, constant
        named |= {*found}
    assert named == set(rows())


def test_each_of_them_has_a_test_that_is_there():
    tests = "\n".join(path.read_text(encoding="utf-8") for path in sorted((ROOT / "tests").rglob("test_*.py")))
    for source, test in rows().items():
        assert re.search(rf"def {test}\(", tests), (source, test)
