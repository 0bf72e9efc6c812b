"""A distribution beside this package adds rows of every kind: to files, reports and commands they are as our own."""

from __future__ import annotations

import csv
import json
import math
import os
import re
import shutil
import signal
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from campaigns import sampled
from wang_su import J1

import inerter as it

HERE = Path(__file__).parent
BASE = """title = "A passenger on a ball screw"
[vehicle]
model = "seated-car"
seated_mass = "60 kg"
sprung_mass = "180 kg"
unsprung_mass = "25 kg"
seat_stiffness = "15 kN/m"
seat_damping = "500 N s/m"
tyre_stiffness = "120 kN/m"
[road]
speed = "25 m/s"
roughness = "5e-7 m^3/cycle"
[elements]
k = "40 kN/m"
c = { from = "500 N s/m", to = "20 kN s/m" }
J = { kind = "ball screw", moment = { from = "1e-5 kg m^2", to = "2e-3 kg m^2" }, pitch = "12 mm", friction = "10 N", \
shaft_stiffness = "1000 kN/m", shaft_damping = "3200 N s/m" }
[layouts]
S1 = "k | c"
S3 = "k | c - J"
[methods.quadrature]
middle = "3 Hz"
[study]
indices = ["J1", "T1", "W1"]
weighting_corner = "0.5 Hz"
optimise = "norm"
evaluate = ["norm", "quadrature", "statistical-linearisation"]
"""


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which the distribution is installed, as an installer would: modules, name, version, entry points."""
    return installed(tmp_path_factory.mktemp("site"))


def installed(folder: Path) -> Path:
    project = tomllib.loads((HERE / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    shutil.copytree(HERE / "src", folder, dirs_exist_ok=True, ignore=shutil.ignore_patterns("__pycache__"))
    about = folder / f"{project['name'].replace('-', '_')}-{project['version']}.dist-info"
    about.mkdir()
    metadata = f"Metadata-Version: 2.1\nName: {project['name']}\nVersion: {project['version']}\n"
    (about / "METADATA").write_text(metadata, encoding="utf-8")
    ((group, entries),) = project["entry-points"].items()
    lines = "".join(f"{name} = {module}\n" for name, module in entries.items())
    (about / "entry_points.txt").write_text(f"[{group}]\n{lines}", encoding="utf-8")
    return folder


SESSION = """
import io, json, os, sys, traceback
from contextlib import redirect_stderr, redirect_stdout
from inerter.cli.main import call

for line in sys.stdin:
    folder, program, arguments = json.loads(line)
    os.chdir(folder)
    out, err = (io.TextIOWrapper(io.BytesIO(), "utf-8") for _ in range(2))
    with redirect_stdout(out), redirect_stderr(err):
        try:
            code = call(arguments) if program is None else exec(program, {"__name__": "__main__"}) or 0
        except BaseException:
            code = traceback.print_exc() or -1
    for stream in (out, err):
        stream.flush()
    said = (code, *(stream.buffer.getvalue().decode() for stream in (out, err)))
    print(json.dumps(said), file=sys.__stdout__, flush=True)
"""


@dataclass
class Session:
    """One process in which the distribution is installed, for all that does not need a fresh one.

    A process that has not answered when a test runs out of time is ended, since its answer would be read as the next.
    """

    place: Path
    process: subprocess.Popen[str] | None = None

    def command(self, *arguments: str, cwd: Path, code: int = 0) -> tuple[str, str]:
        """What `inerter` with these arguments says on both streams."""
        return self._asked([str(cwd), None, arguments], code)

    def python(self, program: str, cwd: Path) -> str:
        """What a program prints."""
        return self._asked([str(cwd), program, ()], 0)[0]

    def end(self) -> None:
        """End the process; the next request begins another."""
        if self.process is not None:
            self.process.kill()
            self.process.communicate()
            self.process = None

    def _asked(self, request: list[object], expected: int) -> tuple[str, str]:
        if self.process is None:
            environment, pipe = {**os.environ, "PYTHONPATH": _with_path(self.place)}, subprocess.PIPE
            command = [sys.executable, "-c", SESSION]
            self.process = subprocess.Popen(command, env=environment, stdin=pipe, stdout=pipe, text=True)
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        try:
            print(json.dumps(request), file=self.process.stdin, flush=True)
            code, out, err = json.loads(self.process.stdout.readline())
        except BaseException:
            self.end()
            raise
        assert code == expected, err
        return out, err


def _with_path(place: Path) -> str:
    """`PYTHONPATH` with a folder first, so that the package that is tested stays the same."""
    return os.pathsep.join(filter(None, [str(place), os.environ.get("PYTHONPATH")]))


@pytest.fixture(scope="module")
def session(place: Path) -> Iterator[Session]:
    found = Session(place)
    yield found
    found.end()


class _OutOfTimeError(Exception):
    """Raised by the alarm of a test."""


def test_an_answer_that_came_too_late_is_not_read_as_the_next_one(place: Path, tmp_path: Path) -> None:
    """As a time limit of a test interrupts it, while the process goes on."""
    session = Session(place)
    session.python("print('begun')", tmp_path)

    def ring(*_: object) -> None:
        raise _OutOfTimeError

    before = signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, 0.2)
    try:
        with pytest.raises(_OutOfTimeError):
            session.python("import time; time.sleep(1.0); print('late')", tmp_path)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    assert session.python("print('next')", tmp_path) == "next\n"
    session.end()


def inerter(place: Path, *arguments: str, cwd: Path, code: int = 0) -> subprocess.CompletedProcess[str]:
    """The command in a process of its own."""
    done = started(place, cwd, "-c", "from inerter.cli.start import main; main()", *arguments)
    assert done.returncode == code, done.stderr
    return done


def python(place: Path, program: str, cwd: Path) -> str:
    """What a program prints in a process of its own."""
    done = started(place, cwd, "-c", program)
    assert done.returncode == 0, done.stderr
    return done.stdout


def started(place: Path, cwd: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    command, environment = [sys.executable, *arguments], {**os.environ, "PYTHONPATH": _with_path(place)}
    return subprocess.run(command, capture_output=True, text=True, cwd=cwd, env=environment, timeout=280, check=False)


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("study") / "seated.toml"
    path.write_text(BASE, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def results(session: Session, study: Path) -> Path:
    """The folder of `inerter run -j 2`."""
    session.command("run", study.name, "-o", "out", "-j", "2", cwd=study.parent)
    return study.parent / "out"


def rows(results: Path) -> list[dict[str, str]]:
    with (results / "summary.csv").open(encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def test_check_knows_rows_of_another_distribution(session: Session, study: Path) -> None:
    said = " ".join(session.command("check", study.name, cwd=study.parent)[0].split())
    assert "seated-car; layouts S1, S3; indices J1, T1, W1: 6 designs to find." in said
    for method in ("exact norms", "quadrature"):
        assert f"Note: S3: {method}: friction 'J_friction' in 'strut' left out." in said


def test_a_start_is_made_of_the_vehicle_and_the_indices(session: Session, tmp_path: Path) -> None:
    session.command("new", "seated-car", cwd=tmp_path)
    text = (tmp_path / "seated-car.toml").read_text(encoding="utf-8")
    assert 'seat_stiffness = "15 kN/m"' in text
    assert re.search(r"^# More indices: .*T1", text, re.MULTILINE)
    assert "gap" in text
    assert "ball screw" not in text  # no unit alone tells it
    assert "ok." in session.command("check", "seated-car.toml", cwd=tmp_path)[0]
    assert "Of the cushion." in session.command("explain", "vehicle.seat_damping", cwd=tmp_path)[0]
    told = json.loads(session.command("schema", cwd=tmp_path)[0])
    assert "middle" in told["properties"]["methods"]["properties"]["quadrature"]["properties"]


def test_a_run_in_two_processes_values_every_index_by_every_method(results: Path) -> None:
    found = rows(results)
    assert len(found) == 2 * 3 * 3
    assert {row["status"] for row in found} == {"ok"}
    by = {(row["layout"], row["index"], row["method"]): float(row["value"]) for row in found}
    for layout in ("S1", "S3"):
        for index in ("J1", "T1", "W1"):
            assert by[layout, index, "quadrature"] == pytest.approx(by[layout, index, "norm"], rel=1e-7)
        assert by[layout, "W1", "norm"] < by[layout, "J1", "norm"]
    assert {row["unit"] for row in found if row["index"] == "T1"} == {"m"}


def test_the_ball_screw_is_the_network_that_it_stands_for(results: Path) -> None:
    """The same car, written out in elements that everybody has."""
    row = next(row for row in rows(results) if (row["layout"], row["index"], row["method"]) == ("S3", "J1", "norm"))
    inertance = (2.0 * math.pi / 0.012) ** 2 * float(row["J [kg m^2]"])
    screw = (it.Spring(1e6) | it.Damper(3200.0)) - it.Inerter(inertance)
    strut = it.Spring(40e3) | it.Damper(float(row["c [N s/m]"])) - screw
    mechanism = it.Mechanism(
        coordinates=(it.Coordinate("a", 60.0), it.Coordinate("b", 180.0), it.Coordinate("w", 25.0)),
        struts=(
            it.Strut("strut", strut, {"b": 1.0}, {"w": 1.0}),
            it.Strut("seat", it.Spring(15e3) | it.Damper(500.0), {"a": 1.0}, {"b": 1.0}),
        ),
        tyres=(it.Tyre("tyre", it.Spring(120e3), {"w": 1.0}, "road"),),
        roads=(it.RoadInput("road"),),
        measures=it.PerformanceOutputs(comfort=(it.OutputWeight("a_acceleration"),)),
    )
    comfort = J1
    assert it.evaluate(mechanism, comfort, it.Norm()).value == pytest.approx(float(row["value"]), rel=1e-10)


def test_the_report_tells_them_in_their_own_words(results: Path) -> None:
    page = " ".join((results / "report.html").read_text(encoding="utf-8").split())
    for words in (
        "seated car",
        "Seat stiffness",
        "suspension travel",
        "Weighting filter of W1",
        "W1</th><td>0.5 Hz",
        "ball screw",
        "integrals of the squared gains of the linear model over all frequencies",
    ):
        assert words in page
    assert 'kind = "ball screw"' in (results / "study.resolved.toml").read_text(encoding="utf-8").replace("'", '"')


def test_the_resolved_study_asks_the_same(session: Session, results: Path) -> None:
    again = "a = it.load_study('../seated.toml'); b = it.load_study('study.resolved.toml'); print(a == b, a.settings)"
    said = session.python(f"import inerter as it; {again}", results)
    assert said == f"True {{'weighting_corner': {math.pi!r}}}\n"


def test_it_is_drawn(session: Session, tmp_path: Path) -> None:
    program = (
        "import inerter as it; from inerter.figures.networks import schematic; "
        "screw = it.ELEMENTS['ball screw'](1e-3, 0.01, 10.0, 1e6, 3e3, 'J'); "
        "print(len(schematic(it.Spring(1.0) | screw).placed), len(screw.drawing))"
    )
    assert session.python(program, tmp_path) == "2 7\n"


def test_its_simulation_is_that_of_the_network(session: Session, tmp_path: Path) -> None:
    program = """
import math, numpy as np, inerter as it
screw = it.ELEMENTS["ball screw"](1e-3, 0.01, 10.0, 1e6, 3e3, "J")
plain = (it.Spring(1e6) | it.Damper(3e3)) - (it.Inerter(1e-3 * (2 * math.pi / 0.01) ** 2) | it.Friction(10.0))
found = [
    it.simulate(it.Rig(device), displacement=it.sine(1e-3, 3.0), duration=1.0, step=1e-3)["device_force"]
    for device in (screw, plain)
]
print(len(found[0]), np.abs(found[0]).max() > 100.0, np.array_equal(*found))
"""
    assert session.python(program, tmp_path) == "1001 True True\n"


@pytest.mark.campaign
def test_a_bump_stop_is_met_in_compression_alone(session: Session, tmp_path: Path) -> None:
    """A car that is let down on it, and drawn up: on two springs, and on one, as closed forms say."""
    program = """
import inerter as it
stop = it.ELEMENTS["bump stop"](9e4, 0.02, "kb")
car = it.QuarterCar(250.0, 35.0, 150e3, it.Spring(10e3) | it.Damper(1e3) | stop)
for force in (-1000.0, 1000.0):
    held = it.Signal.sampled([0.0, 9.0], [force, force], "linear")
    run = it.simulate(car, forces={"sprung_force": held}, initial="preload", duration=1.0, step=1e-3)
    print(round(float(run["strut_travel"][-1]), 9), [name for name in run.states if run.intervals(name, "contact")])
"""
    squeezed = -(1000.0 + 9e4 * 0.02) / (10e3 + 9e4)
    assert session.python(program, tmp_path) == f"{squeezed:.9g} ['kb_stop']\n0.1 []\n"


def test_a_simulation_file_knows_the_vehicle_the_element_and_the_signal(session: Session, tmp_path: Path) -> None:
    text = BASE[: BASE.index("[methods")].replace("{ from", '"2 kN s/m" # { from', 1)
    text = text.replace('{ from = "1e-5 kg m^2", to = "2e-3 kg m^2" }', '"1e-3 kg m^2"')
    end = '[signal]\nkind = "saw-tooth"\nheight = "20 mm"\n[simulation]\nlayout = "S3"\nduration = "0.2 s"\n'
    (tmp_path / "slabs.toml").write_text(text + end, encoding="utf-8")
    said, _ = session.command("simulate", "slabs.toml", cwd=tmp_path)
    assert "seated-car, S3" in said
    assert "J_friction" in said


def test_a_task_is_worked_on_and_told_as_our_own(session: Session, tmp_path: Path) -> None:
    text = BASE.replace('["norm", "quadrature", "statistical-linearisation"]', '["norm"]').replace(', "T1", "W1"', "")
    moment = '{ from = "1e-5 kg m^2", to = "2e-3 kg m^2" }'
    text = text.replace(f"moment = {moment}", 'moment = "1e-4 kg m^2"')
    text = text.replace('weighting_corner = "0.5 Hz"\n', "").replace('[methods.quadrature]\nmiddle = "3 Hz"\n', "")
    text += 'catalogue_of = "c"\ncatalogue = ["1 kN s/m", "2 kN s/m", "4 kN s/m"]\n'
    (tmp_path / "bought.toml").write_text(text, encoding="utf-8")
    assert "and 2 catalogues." in " ".join(session.command("check", "bought.toml", cwd=tmp_path)[0].split())
    assert "Values in the catalogue" in session.command("explain", "study.catalogue", cwd=tmp_path)[0]
    said = json.loads(session.command("run", "bought.toml", "-j", "1", "-o", "out", "--json", cwd=tmp_path)[0])
    by = {one["layout"]: one for one in said["catalogues"]}
    assert set(by) == {"S1", "S3"}
    for design in said["designs"]:
        assert by[design["layout"]]["value"] >= design["value"] * (1.0 - 1e-9)  # of free values is the best the best
        assert by[design["layout"]]["status"] == "ok"
    with (tmp_path / "out" / "catalogues.csv").open(encoding="utf-8") as stream:
        assert [row["best"] for row in csv.DictReader(stream)] == [by[name]["best"] for name in ("S1", "S3")]
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert ">From the catalogue</h2>" in page
    journal = (tmp_path / "out" / "journal.jsonl").read_text(encoding="utf-8")
    assert journal.count('"task": "catalogues"') == 2
    resolved = (tmp_path / "out" / "study.resolved.toml").read_text(encoding="utf-8").replace("'", '"')
    assert 'catalogue = ["1 kN s/m", "2 kN s/m", "4 kN s/m"]' in resolved
    again = "a = it.load_study('bought.toml'); print(a == it.load_study('out/study.resolved.toml'), a.tasks != {})"
    assert session.python(f"import inerter as it; {again}", tmp_path) == "True True\n"
    text = text.replace('catalogue_of = "c"', 'catalogue_of = "d"')
    (tmp_path / "wrong.toml").write_text(text, encoding="utf-8")
    assert "study.catalogue_of" in session.command("check", "wrong.toml", cwd=tmp_path, code=2)[1]
    for sold, said in (
        ("", "study.catalogue: missing"),
        ('catalogue = ["1 kN s/m", "1 kN/m"]', "study.catalogue: got 1 kN/m"),
    ):
        bought = (tmp_path / "bought.toml").read_text(encoding="utf-8")
        (tmp_path / "wrong.toml").write_text(re.sub("catalogue = .*", sold, bought), encoding="utf-8")
        assert said in " ".join(session.command("check", "wrong.toml", cwd=tmp_path, code=2)[1].split())


STOPPED = """title = "Onto the bump stop"
[vehicle]
model = "quarter-car"
sprung_mass = "250 kg"
unsprung_mass = "35 kg"
tyre_stiffness = "150 kN/m"
[elements]
k = "10 kN/m"
c = "1 kN s/m"
kb = { kind = "bump stop", stiffness = "90 kN/m", clearance = "20 mm" }
[layouts]
stopped = "k | c | kb"
[signal]
kind = "sine"
amplitude = "50 mm"
frequency = "1.5 Hz"
[road]
speed = "20 m/s"
[simulation]
duration = "2 s"
"""


@pytest.mark.campaign
def test_a_report_tells_of_the_states_that_an_element_can_have(session: Session, tmp_path: Path) -> None:
    (tmp_path / "stopped.toml").write_text(STOPPED, encoding="utf-8")
    said, _ = session.command("simulate", "stopped.toml", cwd=tmp_path)
    (row,) = [line for line in said.splitlines() if "kb_stop" in line]
    assert re.search(r"one-sided stop kb_stop +\d+ +open \d+\.\d %, contact \d+\.\d %$", row)
    assert "never" not in said
    text = STOPPED[: STOPPED.index("[signal]")] + '[road]\nspeed = "20 m/s"\nroughness = "5e-7 m^3/cycle"\n'
    text += '[study]\nindices = ["J1"]\nevaluate = ["norm", "expected-value"]\nrealisations = 2\n'
    (tmp_path / "study.toml").write_text(text, encoding="utf-8")
    said, _ = session.command("run", "study.toml", "-j", "1", "-o", "out", cwd=tmp_path)
    assert "without one-sided stop" in said
    assert "friction" not in said


@pytest.mark.campaign
def test_a_journal_counts_for_one_state_of_the_distribution(place: Path, study: Path, tmp_path: Path) -> None:
    """With a changed source, or without the distribution, what makes the numbers is another."""
    origin = "from inerter.work.origin import origin, versions; print(origin(), versions().get('inerter-extending'))"
    changed = installed(tmp_path)
    known = [python(folder, origin, study.parent) for folder in (place, changed)]
    with (changed / "inerter_extending" / "quadrature.py").open("a", encoding="utf-8") as stream:
        stream.write("# another\n")
    known += [python(changed, origin, study.parent), python(HERE, origin, study.parent)]
    assert known[0] == known[1]
    assert len({line.split()[0] for line in known}) == 3
    assert [line.split()[1] for line in known] == ["1.0", "1.0", "1.0", "None"]


@pytest.mark.parametrize("as_json", sampled([False, True], [False]))
def test_the_paper_is_reproduced(session: Session, tmp_path: Path, as_json: bool) -> None:
    assert "usual-strut-2031\n  The usual strut (2031)" in session.command("reproduce", cwd=tmp_path)[0]
    more = ("-j", "1", "--json") if as_json else ("-j", "2")
    out, _ = session.command("reproduce", "usual-strut-2031", "-o", "paper", *more, cwd=tmp_path)
    with (tmp_path / "paper" / "table.csv").open(encoding="utf-8") as stream:
        table = [(float(row["damping"]), float(row["value"]), float(row["printed"])) for row in csv.DictReader(stream)]
    assert len(table) == 4
    for damping, value, printed in table:
        closed = (
            2
            * math.pi
            * math.sqrt(25 * 5e-7 * (285.0 * 20e3**2 / (2 * damping * 250.0**2) + 150e3 * damping / (2 * 250.0**2)))
        )
        assert value == pytest.approx(closed, rel=1e-9)
        assert printed == pytest.approx(closed, abs=5e-5)
    assert (tmp_path / "paper" / "report.html").exists()
    if as_json:
        assert [row["value"] for row in json.loads(out)["table"]] == [value for _, value, _ in table]
    else:
        assert "printed 1.0209" in out
    assert "--force" in session.command("reproduce", "usual-strut-2031", "-o", "paper", cwd=tmp_path, code=2)[1]


@pytest.mark.campaign
def test_the_value_of_the_element_is_swept(session: Session, tmp_path: Path) -> None:
    """A flywheel of twice the moment in a screw of sqrt(2) times the pitch is the same device."""
    values = {}
    for pitch, moments in (
        ("10 mm", '["1e-4 kg m^2", "4e-4 kg m^2"]'),
        ("14.142135623730951 mm", '["2e-4 kg m^2", "8e-4 kg m^2"]'),
    ):
        text = BASE.replace("12 mm", pitch).replace('{ from = "1e-5 kg m^2", to = "2e-3 kg m^2" }', '"1e-4 kg m^2"')
        text = text.replace('{ from = "500 N s/m", to = "20 kN s/m" }', '"3 kN s/m"').replace('optimise = "norm"\n', "")
        text = text.replace('S1 = "k | c"\n', "")
        text = (
            text.replace('"quadrature", "statistical-linearisation"', '"quadrature"') + f"sweep = {{ J = {moments} }}\n"
        )
        (tmp_path / "swept.toml").write_text(text, encoding="utf-8")
        session.command("run", "swept.toml", "-o", pitch, "-j", "1", cwd=tmp_path)
        found = rows(tmp_path / pitch)
        assert len({row["J [kg m^2]"] for row in found}) == 2
        values[pitch] = [float(row["value"]) for row in found]
    ours, theirs = values.values()
    assert ours == pytest.approx(theirs, rel=1e-9)
    assert len(ours) == len(set(ours)) == 12


BAD = {
    "model": ('"seated-car"', '"seeted-car"', "vehicle.model", ['"seated-car"', 'Did you mean "seated-car"?']),
    "field": ('seat_stiffness = "15 kN/m"\n', "", "vehicle.seat_stiffness", ['seat_stiffness = "15 kN/m"']),
    "unit": ('"500 N s/m"\ntyre', '"500 N/m"\ntyre', "vehicle.seat_damping", ["incompatible unit", "N s/m"]),
    "index": ('"T1"', '"T2"', "study.indices", ['"peak-response", "T1", "W1"']),
    "setting": ('["J1", "T1", "W1"]', '["J1"]', "study.weighting_corner", ["weighting filter of W1", "no weighting_c"]),
    "setting's unit": ('"0.5 Hz"', '"0.5 s"', "study.weighting_corner", ["incompatible unit", "rad/s"]),
    "method": ('"quadrature"', '"quadrture"', "study.evaluate", ['Did you mean "quadrature"?']),
    "method's setting": ("middle =", "midle =", "methods.quadrature.midle", ["unknown key", "one of middle"]),
    "method's unit": ('"3 Hz"', '"3 m"', "methods.quadrature.middle", ["incompatible unit", "rad/s"]),
    "method's place": (
        'middle = "3 Hz"\n[study]\n',
        '[study]\nmiddle = "3 Hz"\n',
        "study.middle",
        ["in [methods.quadrature]"],
    ),
    "method's name": ("methods.quadrature", "methods.norm", "methods.norm", ["unknown key", "one of quadrature"]),
    "method unused": ('"quadrature", ', "", "methods.quadrature", ["middle of", "neither in optimise nor in evaluate"]),
    "search": ('optimise = "norm"', 'optimise = "quadrature"', "study.optimise", ["not an optimisation method"]),
    "element": ('pitch = "12 mm", ', "", "elements.J.pitch", ['missing; expected pitch = "1 m"']),
    "kind": ('"ball screw"', '"ball scrw"', "elements.J.kind", ['"gap", "ball screw"']),
    "mounts": ('S1 = "k | c"', 'S1 = { front = "k", rear = "k" }', "layouts.S1", ["a seated car has one strut"]),
}


def test_bad_files_are_told_in_the_words_of_the_rows(session: Session, tmp_path: Path) -> None:
    for name, (old, new, _, _) in BAD.items():
        assert old in BASE, name
        (tmp_path / f"{name}.toml").write_text(BASE.replace(old, new, 1), encoding="utf-8")
    program = (
        "import json, pathlib, inerter as it\n"
        "said = {}\n"
        "for path in pathlib.Path().glob('*.toml'):\n"
        "    try:\n"
        "        it.load_study(path)\n"
        "    except it.InerterError as error:\n"
        "        said[path.stem] = str(error)\n"
        "print(json.dumps(said))\n"
    )
    said = json.loads(session.python(program, tmp_path))
    for name, (_, _, where, words) in BAD.items():
        line = next(line for line in said[name].splitlines() if line.startswith(f"{name}.toml: {where}: "))
        for word in words:
            assert word in line, line


FROZEN = "from dataclasses import dataclass\n@it.INDICES.add\n@dataclass(frozen=True)\n"
BROKEN = {
    "raises": ("1 / 0", "ZeroDivisionError"),
    "imports": ("import nothing_of_that_name", "ModuleNotFoundError"),
    "twice": (
        "from dataclasses import dataclass\n@it.INDICES.add\n@dataclass(frozen=True)\nclass T(it.RideComfort): pass",
        "'J1'",
    ),
    "half": (f"{FROZEN}class T:\n    symbol = 'T'", "title, unit, response, definition"),
    "no dataclass": ("@it.INDICES.add\nclass T(it.RideComfort):\n    symbol = 'T'", "@dataclass"),
    "no key": (
        f"{FROZEN}class T(it.RideComfort):\n    symbol = ''",
        "symbol must be non-empty text, got ''",
    ),
}


@pytest.mark.parametrize("case", sampled(BROKEN, ["raises", "half"], kept=2))
def test_a_broken_distribution_is_one_sentence(case: str, study: Path, tmp_path: Path) -> None:
    program, word = BROKEN[case]
    place = installed(tmp_path)
    (place / "inerter_extending" / "seated_car.py").write_text(f"import inerter as it\n{program}\n", encoding="utf-8")
    done = inerter(place, "check", study.name, cwd=study.parent, code=2)
    assert done.stdout == ""
    (line,) = (line for line in done.stderr.splitlines() if not line.startswith("inerter: preparing"))  # if it is slow
    assert line.startswith("inerter: inerter-extending 1.0: cannot load its extension inerter_extending.seat")
    assert word in line


def test_exports_may_be_the_first_registry_of_a_process(place: Path, tmp_path: Path) -> None:
    """Their modules are imported before those of the distribution, which add to the exports while they are imported."""
    program = """
import inerter as it
strut = it.Spring(60e3) | it.Damper(2e3, "c")
print(it.export(it.QuarterCar(250.0, 35.0, 180e3, strut), to="parts-list"), it.EXPORTS["parts-list"].suffixes)
"""
    rows = "strut,element,value,unit\nstrut,k,60000.0,N/m\nstrut,c,2000.0,N s/m\n"
    assert python(place, program, tmp_path) == f"{rows} ('.parts',)\n"


def test_help_looks_for_no_distribution(tmp_path: Path) -> None:
    place = installed(tmp_path)
    (place / "inerter_extending" / "seated_car.py").write_text("1 / 0\n", encoding="utf-8")
    assert "Usage: inerter COMMAND" in inerter(place, "--help", cwd=tmp_path).stdout
    inerter(place, "run", "--help", cwd=tmp_path)
    inerter(place, "reproduce", cwd=tmp_path, code=2)


def test_the_page_shows_every_file_whole() -> None:
    page = (HERE.parents[1] / "docs" / "extending.md").read_text(encoding="utf-8")
    shown = {block.partition("\n")[2] for block in page.split("```")[1::2]}
    files = [path for path in (HERE / "src").rglob("*.py") if path.name != "__init__.py"]
    assert len(files) == 10
    for path in (HERE / "pyproject.toml", *files):
        assert path.read_text(encoding="utf-8") in shown, path.name


def test_the_element_of_the_page_is_one(session: Session, tmp_path: Path) -> None:
    page = (HERE.parents[1] / "docs" / "extending.md").read_text(encoding="utf-8")
    entry = next(block for block in page.split("```")[1::2] if block.startswith("toml\nJ = ")).partition("\n")[2]
    lines = [line for line in BASE.splitlines() if not line.startswith("J = ")]
    lines.insert(lines.index("[layouts]"), entry.strip())
    (tmp_path / "page.toml").write_text("\n".join(lines), encoding="utf-8")
    assert "ok." in session.command("check", "page.toml", cwd=tmp_path)[0]


SCRIPT = """
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
import os
import inerter as it

@it.INDICES.add
@dataclass(frozen=True)
class WheelTravel:
    road: it.Road
    symbol, title, unit, response = "D1", "tyre deflection", "m", "deflection per road velocity"

    def definition(self, mechanism):
        outputs = tuple(it.OutputWeight(f"{tyre.name}_deflection") for tyre in mechanism.tyres)
        return it.on_road(self, mechanism, outputs, "tyres")

if __name__ == "__main__":
    study = it.load_study("seated.toml")
    with ProcessPoolExecutor(1, get_context("spawn")) as executor:
        away = it.run_study(study, "away", executor=executor)
        print(len(executor._processes))
    here = it.run_study(study, "here")
    print(away.data.equals(here.data), sorted(study.indices), away.failures)
    deflection, load = (away.data.value.sel({"index": name}, drop=True) for name in ("D1", "J3"))
    print(float(abs(deflection * 120e3 / load - 1).max()) < 1e-9)
"""


@pytest.mark.campaign
def test_processes_that_are_spawned_know_the_rows_of_distributions_and_scripts(place: Path, tmp_path: Path) -> None:
    text = BASE.replace('["J1", "T1", "W1"]', '["J3", "T1", "W1", "D1"]').replace('optimise = "norm"\n', "")
    text = text.replace('{ from = "500 N s/m", to = "20 kN s/m" }', '"3 kN s/m"')
    text = text.replace('{ from = "1e-5 kg m^2", to = "2e-3 kg m^2" }', '"1e-3 kg m^2"')
    text = text.replace('"quadrature", "statistical-linearisation"', '"quadrature"')
    (tmp_path / "seated.toml").write_text(text.replace('S1 = "k | c"\n', ""), encoding="utf-8")
    (tmp_path / "script.py").write_text(SCRIPT, encoding="utf-8")
    done = started(place, tmp_path, "script.py")
    assert done.returncode == 0, done.stderr
    assert done.stdout == "1\nTrue ['D1', 'J3', 'T1', 'W1'] []\nTrue\n"
