"""A search for the best network in the browser: its ranking, and a network of it in the editor."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from browser import Served, Visitor, wait_until
from study_text import PAPER_CAR, study_text

ELEMENTS = (
    'k = "120 kN/m"\nc = { from = "100 N s/m", to = "100 kN s/m" }\n'
    'any = { network = 3, springs = { from = "1 kN/m", to = "10 MN/m" }, '
    'dampers = { from = "10 N s/m", to = "1 MN s/m" }, inerters = { from = "10 g", to = "100 t" } }'
)
LAYOUTS = 'S1 = "k | c"\nany = "k | any"'
ASK = 'indices = ["J1", "J3"]\noptimise = "norm"\nbaseline = "S1"'


@pytest.mark.campaign
def test_a_network_of_a_search_is_taken_into_the_editor(
    served: Served, visitors: Callable[..., Visitor], tmp_path: Path
) -> None:
    """Its layout replaces the one that was searched, and the page then shows the index of the ranking."""
    path = tmp_path / "searched.toml"
    path.write_text(study_text(ASK, vehicle=PAPER_CAR, elements=ELEMENTS, layouts=LAYOUTS), encoding="utf-8")
    visitor = visitors(served).visit()
    page = visitor.page
    visitor.open(path)
    visitor.wait_for_text("k | any")
    page.click("#tab-work")
    form = page.locator("form.begin", has_text="Search for the best network")
    form.locator("[name=layout]").select_option("any")
    form.locator("[name=index]").select_option("J3")
    form.get_by_role("button", name="Begin").click()
    page.wait_for_selector(".job[data-state=done] [data-network]", timeout=120_000)
    (job,) = [job for job in json.loads(served.get("work"))["work"] if job["kind"] == "search"]
    found = json.loads(served.get(f"work/{job['id']}/result"))
    rows = page.locator(".job [data-network]")
    assert [row.get_attribute("data-network") for row in rows.all()] == [one["network"] for one in found["ranking"]]
    for number in (3, 0):  # another network of the ranking comes in place of the first
        chosen = found["ranking"][number]
        rows.nth(number).get_by_role("button", name="Into the editor").click()
        visitor.wait_for_text(chosen["entry"])
        wait_until(lambda one=chosen: abs(visitor.values()["J3"] / one["value"] - 1.0) < 1e-6)
