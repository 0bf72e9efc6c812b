"""Every block of Python and every command of the README and docs/ runs, and gives the figures that the page prints."""

from __future__ import annotations

import doctest
import json
import math
import re
import shlex
import shutil
import tomllib
from collections.abc import Callable, Iterator
from inspect import signature
from pathlib import Path
from typing import Any

import newcomer
import numpy as np
import pytest
from campaigns import sampled
from distributed import SSHCluster
from folders import ROOT
from pages import PAGES, assert_figures, assert_printed, blocks, commands, printed, run, table, text_of

import inerter as it
from inerter.cli.main import app, call
from inerter.files.identification.loading import load_identification

PYTHON = [page for page in PAGES if blocks(page)]
LONG = {
    "README.md",
    "identification.md",
    "synthesis.md",
    "recipes.md",
    "staged-protocol.md",
    "methods.md",
    "cluster.md",
    "limits.md",
    "tutorial-rig.md",
    "tutorial-network.md",
}  # pages whose blocks take long
LONGEST = ["cluster.md", "staged-protocol.md", "tutorial-rig.md"]  # of these the parts have campaigns of their own
WRITTEN = {"exports.md": "car.mo", "study-file.md": "out/summary.csv", "frequency-response.md": "response.csv"}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where a newcomer stands: beside the examples."""
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def registries() -> Iterator[None]:
    """Indices that a page adds, even where it fails, are not there for other tests."""
    before = set(it.INDICES)
    yield
    for key in set(it.INDICES) - before:
        it.INDICES.remove(it.INDICES[key])


@pytest.mark.parametrize("page", sampled(PYTHON, [page for page in PYTHON if page not in LONG], LONGEST))
@pytest.mark.usefixtures("folder", "registries")
def test_python_gives_the_figures_beside_it(page: str) -> None:
    """All blocks of a page one after the other, as a reader would try them."""
    namespace: dict[str, object] = {"__name__": "__main__"}
    for block in blocks(page):
        if not block.code.startswith(">>>"):
            run(block, page, namespace)
    assert Path(WRITTEN.get(page, ".")).exists()
    if all(block.code.startswith(">>>") for block in blocks(page)):
        failed, tried = doctest.testfile(str(PAGES[page]), module_relative=False, encoding="utf-8")
        assert tried > 15
        assert failed == 0


def a_car(folder: Path) -> None:
    shutil.copy(folder / "examples" / "stick_slip.toml", folder / "my-car.toml")


def a_record(folder: Path, name: str = "bench.csv", frequency: float = 3.0) -> None:
    shaft = it.Spring(1e6) | it.Damper(3200.0)
    rig = it.VirtualRig(shaft - (it.Inerter(113.0) | it.Friction(10.0)), seed=0, sampling=500.0)
    it.write_record(rig.run(it.cosine(1e-3, frequency), 1.0), folder / name)


def two_records(folder: Path) -> None:
    """In kgf, though the files say N."""
    for name, frequency in (("slow", 1.0), ("fast", 3.0)):
        a_record(folder, f"{name}.csv", frequency)
        record = it.read_record(folder / f"{name}.csv")
        scaled = it.Record(record.time, record.displacement, record.force / 9.80665)
        it.write_record(scaled, folder / f"{name}.tdms")


def a_configuration(folder: Path) -> None:
    a_record(folder)
    (folder / "rig.toml").write_text(blocks("identification.md", "toml")[1].code, encoding="utf-8")


def a_fit_test(folder: Path) -> None:
    assert call(shlex.split("rig examples/rig_fit.toml -o fit.csv")) == 0


def a_friction_test(folder: Path) -> None:
    assert call(shlex.split("rig examples/rig_friction.toml -o friction.csv")) == 0


def a_van(folder: Path) -> None:
    (folder / "van.toml").write_text(blocks("tutorial-vehicle.md", "toml")[0].code, encoding="utf-8")


def a_sports_car(folder: Path) -> None:
    (folder / "sports-car.toml").write_text(blocks("tutorial.md", "toml")[0].code, encoding="utf-8")


def nothing(folder: Path) -> None:
    pass


IDENTIFY = "inerter identify fit.csv --model ball-screw --force-bandwidth"
FITTED = f'{IDENTIFY} "300 Hz"'
SHOWN = f'{FITTED} --force-range "100 kgf"'
SLOW = 'inerter identify friction.csv --model ball-screw --force-bandwidth "80 Hz"'
EXPORTED = "inerter export examples/quarter-car.toml --layout S3 --index J1 --to"
WHOLE = "inerter reproduce wang-su-2008 -o paper"
SERVES = {
    "inerter serve examples/quarter-car.toml",
    "inerter serve sports-car.toml",
}  # until it is stopped: see tests/app and tests/page
COMMANDS: dict[str, Callable[[Path], None]] = {
    "inerter run examples/quarter-car.toml": nothing,
    "inerter search examples/search_quarter_car.toml": nothing,
    "inerter run sports-car.toml": a_sports_car,
    "inerter check van.toml": a_van,
    "inerter run van.toml": a_van,
    "inerter export van-results --layout S3 --index J1 --to matlab --linear -o van.m": nothing,
    "inerter export van-results --layout S3 --index J1 --to fmu -o van.fmu": nothing,
    "inerter new half-car": nothing,
    "inerter new quarter-car": nothing,
    "inerter explain road.speed": nothing,
    "inerter explain study.subject_to": nothing,
    "inerter explain simulation.step": nothing,
    "inerter simulate examples/backlash_rattle.toml": nothing,
    "inerter simulate my-car.toml -o motion --force": a_car,
    "inerter simulate my-car.toml --window 2:4": a_car,
    "inerter simulate my-car.toml --json": a_car,
    "inerter rig examples/rig_fit.toml -o fit.csv": nothing,
    "inerter rig examples/rig_friction.toml -o friction.csv": nothing,
    "inerter identify bench.csv --model ball-screw": a_record,
    "inerter identify slow.tdms fast.tdms --model ball-screw --unit force=kgf -o bench": two_records,
    "inerter identify bench.csv --config rig.toml --force": a_configuration,
    FITTED: a_fit_test,
    SHOWN: a_fit_test,
    SLOW: a_friction_test,
    'inerter identify fit.csv --model choose --force-bandwidth "300 Hz" --trim 0:2': a_fit_test,
    "inerter reproduce wang-su-2008 --only linear": nothing,
    "inerter reproduce wang-su-2008 --only rig": nothing,
    "inerter reproduce wang-su-2008 --only methods": nothing,
    WHOLE: nothing,
    f"{EXPORTED} matlab": nothing,
    f"{EXPORTED} modelica -o car.mo": nothing,
    f"{EXPORTED} fmu --part strut": nothing,
    f"{EXPORTED} simulation": nothing,
    "inerter plot examples/quarter-car.toml --kind bode --index J1": nothing,
    "inerter plot examples/stick_slip.toml --kind trajectory --window 1:3": nothing,
}
FIRST = {one: "inerter run van.toml" for one in COMMANDS if " van-results " in one}  # the command with those results
BRIEF = [
    f"{EXPORTED} matlab",
    "inerter run sports-car.toml",
    "inerter check van.toml",
    "inerter new half-car",
    "inerter explain road.speed",
    "inerter simulate my-car.toml --window 2:4",
    "inerter rig examples/rig_fit.toml -o fit.csv",
    "inerter rig examples/rig_friction.toml -o friction.csv",
]


SELDOM = [  # those that take long, and of which a part, or what is much the same, is a campaign
    WHOLE,
    "inerter reproduce wang-su-2008 --only linear",
    "inerter reproduce wang-su-2008 --only methods",
    "inerter reproduce wang-su-2008 --only rig",
    FITTED,
    SHOWN,
    SLOW,
    *FIRST.values(),
    "inerter export van-results --layout S3 --index J1 --to matlab --linear -o van.m",
    "inerter search examples/search_quarter_car.toml",
    "inerter identify bench.csv --model ball-screw",
    "inerter identify bench.csv --config rig.toml --force",
    "inerter identify slow.tdms fast.tdms --model ball-screw --unit force=kgf -o bench",
    'inerter identify fit.csv --model choose --force-bandwidth "300 Hz" --trim 0:2',
]


def test_every_command_of_the_pages_is_run() -> None:
    """Those that only name one say which: their help is there."""
    names = {*(f"inerter {name}" for name in app), *SERVES, "inerter"}
    shown = {command for command, pages in commands().items() if set(pages) != {newcomer.PAGE}}  # see test_newcomer.py
    assert shown - names == set(COMMANDS)


@pytest.mark.timeout(1200)
@pytest.mark.parametrize("command", sampled(COMMANDS, BRIEF, SELDOM))
def test_a_command_does_what_the_page_shows(command: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for one in [*filter(None, [FIRST.get(command)]), command]:
        COMMANDS[one](folder)
        capsys.readouterr()
        assert call(shlex.split(one)[1:]) == 0
        out = capsys.readouterr().out
        for page in commands()[one]:
            assert_printed(out, page, one)


@pytest.mark.marathon
def test_what_a_slow_record_tells(folder: Path) -> None:
    """The friction to so many per cent, of the inertance its order of magnitude only."""
    words = r"identifies\s+f to ([\d.]+) %, but of b only the order of magnitude"
    said = re.search(words, text_of("identification.md"))
    assert said is not None
    a_friction_test(folder)
    assert call(shlex.split(SLOW)[1:]) == 0
    found = json.loads((folder / "friction-results" / "fit.json").read_text())["parameters"]
    low, high = found["f"]["interval"]
    assert_figures(said[1], [50.0 * (high - low) / found["f"]["value"]], "f")
    low, high = found["b"]["interval"]
    assert high > 3.0 * low


def test_output_is_shown_where_there_is_some() -> None:
    assert len(printed("identification.md", SHOWN).splitlines()) > 40


@pytest.mark.parametrize("block", blocks("identification.md", "toml"), ids=lambda block: str(block.line))
def test_configurations_are_sound(block, tmp_path: Path) -> None:
    (tmp_path / "rig.toml").write_text(block.code, encoding="utf-8")
    assert load_identification(tmp_path / "rig.toml").models()


def test_blocks_for_other_machines_are_sound() -> None:
    """They cannot run here, but they are Python, and start functions and modules that are there."""
    shown = blocks("cluster.md", "py")
    assert len(shown) > 3
    for block in shown:
        compile(block.code, f"cluster.md:{block.line}", "exec")
    ssh = next(block.code for block in shown if "SSHCluster" in block.code)
    given = set(re.findall(r"^        (\w+)=", ssh, re.MULTILINE))
    assert given == {"worker_options", "remote_python"}
    assert given < set(signature(SSHCluster).parameters)


def test_scripts_of_the_benchmarks_are_there() -> None:
    scripts = {name for page in PAGES for name in re.findall(r"\bbenchmarks/\w+\.py", text_of(page))}
    assert len(scripts) > 5
    for name in scripts:
        compile((ROOT / name).read_text(encoding="utf-8"), name, "exec")


ROAD = it.Road(roughness=5e-7, speed=25)
COMFORT, LOAD, GRIP = it.RideComfort(ROAD), it.LoadCarrying(amplitude=1000.0), it.TyreLoad(ROAD)
EXPECTED, LINEARISED = it.ExpectedValue(), it.StatisticalLinearisation()


def screw(friction: float, damping: float, inertance: float, *shaft: it.Network) -> it.QuarterCar:
    """S3 with this friction, and a shaft if one is given."""
    inner = it.Damper(damping)
    for part in (*shaft, it.Inerter(inertance) | it.Friction(friction) if friction else it.Inerter(inertance)):
        inner = inner - part
    return it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=it.Spring(120e3) | inner)


def real(friction: float) -> it.QuarterCar:
    return screw(friction, 7353, 328.72, it.Spring(1e6) | it.Damper(3200))


def best_of_table_1(friction: float) -> it.QuarterCar:
    return screw(friction, 7544.2, 366.52)


FRICTION = table("methods.md", "| f [N] | J1 simulated [m/s^2] | J1 here | J3 simulated [N] | J3 here |")
PARTING = table("methods.md", "| f [N] | statistical linearisation | random simulation | approximate linear model |")


@pytest.mark.parametrize("row", FRICTION, ids=lambda row: row[0])
def test_what_friction_adds(row: list[str]) -> None:
    """The table of what to expect of statistical linearisation."""
    for index, simulated, linearised in ((COMFORT, row[1], row[2]), (GRIP, row[3], row[4])):
        without = it.evaluate(real(0.0), index, it.Norm()).value
        one, other = (it.evaluate(real(float(row[0])), index, method) for method in (EXPECTED, LINEARISED))
        assert_figures(simulated, [one.value - without, one.standard_error], row[0])
        assert_figures(linearised, [other.value - without], row[0])
        assert ("sticks" in linearised) == any("sticks" in note for note in other.notes)
        assert other.status.ok == (float(row[0]) <= 200.0 or float(row[0]) >= 1000.0)


@pytest.mark.parametrize("row", PARTING, ids=lambda row: row[0])
def test_where_the_methods_agree_and_where_they_part(row: list[str]) -> None:
    """The table of the change of J1 by friction, in per cent."""
    without = it.evaluate(best_of_table_1(0.0), COMFORT, it.Norm()).value
    for cell, method in zip(row[1:], (LINEARISED, EXPECTED, it.ApproximateLinear()), strict=True):
        found = it.evaluate(best_of_table_1(float(row[0])), COMFORT, method)
        figures = [100.0 * (found.value / without - 1.0), 100.0 * (found.standard_error or 0.0) / without]
        assert_figures(cell, figures, f"{row[0]} N, {method.name}")


@pytest.mark.campaign
def test_how_far_harmonic_balance_is_off() -> None:
    said = re.search(r"Its error is (.*?) N\.\n", text_of("methods.md"), re.DOTALL)
    assert said is not None
    for error, friction in re.findall(r"([\d.]+) % at\s+(\d+)", said[1]):
        balanced, simulated = (
            it.evaluate(best_of_table_1(float(friction)), LOAD, method) for method in (LINEARISED, EXPECTED)
        )
        assert_figures(error, [100.0 * abs(balanced.value / simulated.value - 1.0)], friction)
        assert balanced.status.ok == (float(friction) <= 400.0)


@pytest.mark.campaign
def test_statistical_linearisation_finds_as_good_a_design_as_simulation() -> None:
    """Nearly, on the same roads."""
    assert "is as good on these roads, within 0.03 %" in text_of("methods.md")
    c, b = it.Damper(it.free(100, 100e3, name="c")), it.Inerter(it.free(1, 2000, name="b"))
    inner = c - (it.Spring(1e6) | it.Damper(3200)) - (b | it.Friction(100))
    rough = it.QuarterCar(181.75, 25, 120e3, strut=it.Spring(120e3) | inner)
    roads = it.ExpectedValue(realisations=4)
    simulated = it.optimise(rough, COMFORT, roads, seed=0)
    linearised = it.optimise(rough, COMFORT, LINEARISED, seed=0)
    assert it.evaluate(linearised.design, COMFORT, roads).value == pytest.approx(simulated.value, rel=3e-4)


def test_how_fast_the_inerter_moves_on_the_road_and_on_the_excitation() -> None:
    """Sums over lines: a road of kappa V / f^2, and 3.162 mm of white noise up to 500 Hz."""
    said = re.search(r"r\.m\.s\. value of ([\d.]+) m/s on the paper's road and of ([\d.]+) m/s", text_of("methods.md"))
    assert said is not None
    system = it.state_space(best_of_table_1(0.0), "road", "b_velocity")
    frequency = np.arange(0.01, 500.0, 0.01)
    gains = np.abs(it.frequency_response(system, 2.0 * np.pi * frequency)[:, 0, 0])
    on_road = 2.0 * np.pi * math.sqrt(2.0 * ROAD.roughness * ROAD.speed * float(np.sum(gains**2)) * 0.01)
    heights = 3.162e-3 * gains * 2.0 * np.pi * frequency
    assert_figures(said[1], [on_road], "the road")
    assert_figures(said[2], [math.sqrt(float(np.mean(heights**2)))], "the excitation")


def test_what_is_to_be_cited() -> None:
    """The page and `CITATION.cff` say the same."""
    said = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    software, paper = blocks("citing.md", "bibtex")[0].code.split("@article")
    version, title, day = (
        re.search(rf'^{key}: "?(.*?)"?$', said, re.MULTILINE) for key in ("version", "title", "date-released")
    )
    assert version is not None
    assert title is not None
    assert version[1] == it.__version__
    assert all(f"{{{text[1]}}}" in software for text in (version, title))
    released = re.search(rf"^## {re.escape(version[1])} \((.*)\)$", (ROOT / "CHANGELOG.md").read_text("utf-8"), re.M)
    assert released is not None
    assert (day[1] if day else "not released yet") == released[1]
    for text in re.findall(r"^    (?:title|journal|volume|issue|year): \"?(.*?)\"?$", said, re.MULTILINE):
        assert f"{{{text}}}" in paper


def project() -> dict[str, Any]:
    found: dict[str, Any] = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return found


def test_extras_say_what_they_bring() -> None:
    rows = re.findall(
        r"^\| (`\w+`.*) \| (.*) \|$", text_of("README.md").split("in extras")[1].split("##")[0], re.MULTILINE
    )
    named = {extra for row in rows for extra in re.findall(r"`(\w+)`", row[0])}
    assert project()["optional-dependencies"].keys() - named == {"tdms", "mdf", "mat"}  # parts of `records`
    assert named <= project()["optional-dependencies"].keys()


def test_the_conda_recipe_is_of_this_version_and_needs_the_same() -> None:
    """The version and bounds of `pyproject.toml`; matplotlib without its windows is called matplotlib-base there."""
    recipe = (ROOT / "recipe" / "meta.yaml").read_text(encoding="utf-8")
    assert f'version = "{it.__version__}"' in recipe
    listed = recipe.split("  run:\n")[1].split("\n\n")[0]
    needed = {line.strip().removeprefix("- ").replace("-base", "").replace(" ", "") for line in listed.splitlines()}
    assert needed == {*project()["dependencies"], f"python{project()['requires-python']}"}


def test_the_site_says_what_changed() -> None:
    """The changelog is a page of it, whose links are to pages of the site."""
    assert "../CHANGELOG.md" in text_of("changes.md")
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    linked = re.findall(r"\]\((docs/[^)#]*)", changes)
    assert linked
    assert not [link for link in linked if not (ROOT / link).is_file()]
