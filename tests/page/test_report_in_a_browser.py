"""Tables of a report in a real Chromium."""

from __future__ import annotations

from importlib.resources import files
from typing import Any

from inerter.report.page import environment
from inerter.table import Column, Row, Table, cells, columns

STYLE = (files("inerter.report") / "templates" / "report.css").read_text(encoding="utf-8")
COVERED = """() => {
  const scroll = document.querySelector(".scroll");
  const wider = scroll.scrollWidth - scroll.clientWidth;
  const covered = [];
  for (const share of [0, 0.5, 1]) {
    scroll.scrollLeft = share * wider;
    for (const row of document.querySelectorAll("tr")) {
      const boxes = [...row.cells].map(each => each.getBoundingClientRect());
      boxes.slice(1).forEach((box, i) => { if (box.left < boxes[i].right - 1) covered.push([share, i]); });
    }
  }
  return { wider, covered };
}"""


def test_the_last_column_covers_no_other_on_a_narrow_screen(chromium: Any) -> None:
    """The networks of a search: the gain in the column before them is as much of an answer."""
    headings = [*columns("Elements", "J1", "Gain on previous"), Column("Network", prose=True)]
    table = Table(
        "Best networks", headings, [Row(cells("3", "2.382 m/s^2", "+1.9 %", "b1 - (c1 | b2 | (k1 - c2) | k2)"))]
    )
    page = chromium.new_page(viewport={"width": 420, "height": 800})
    body = environment().get_template("tables.html").module.grid(table)
    page.set_content(f"<!DOCTYPE html><style>{STYLE}</style><main>{body}</main>")
    found = page.evaluate(COVERED)
    page.close()
    assert found["wider"] > 0
    assert found["covered"] == []
