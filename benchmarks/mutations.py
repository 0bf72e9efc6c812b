"""How many wrong digits the tests notice: one random change of the source at a time, against the tests of its area.

    python benchmarks/mutations.py --count 150 --seed 1 -o mutations.csv

Each mutant changes one number in its last digit, one comparison, one sign, one factor or one choice (min for max, all
for any, and for or) in the sources of vehicles, indices, signals, roads, systems, norms, methods, optimisation, records
or units, drawn by the seed with as many for each area. One run of the always-run tests (doctests included, those of
the page left out) records which tests execute which lines. A mutant meets the tests that execute its line: those of its
area first, each group by increasing duration; where no test does (constants of a module), all tests of the area, then
all. The share that is noticed is printed with its 95 % interval (Wilson). The work goes on in copies of the repository;
nothing in it is changed. `--only AREA` draws for one area, `--jobs 2` runs two mutants at a time, `--resume` goes on
where the file of results ends, and `--coverage FOLDER` keeps the record of lines. Needs the extra "bench".
"""

from __future__ import annotations

import argparse
import ast
import csv
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from queue import Queue
from xml.etree import ElementTree

from coverage import CoverageData

ROOT = Path(__file__).resolve().parents[1]
SOURCE = "src/inerter"
AREAS = {  # sources, and the tests that are about them; those of vehicles and roads ask for norms of both
    "vehicle": ("vehicle", "tests/vehicle tests/systems/test_static_loads.py tests/methods/test_criteria.py"),
    "indices": ("indices", "tests/methods tests/vehicle tests/networks/test_formulas.py"),
    "signals": ("signals", "tests/signals tests/methods/test_coherence.py tests/roads"),
    "roads": ("roads", "tests/roads tests/methods/test_measured_roads.py"),
    "systems": ("systems", "tests/systems tests/norms tests/vehicle tests/simulation"),
    "norms": ("norms", "tests/norms tests/methods tests/systems"),
    "methods": ("methods", "tests/methods tests/optimisation tests/uncertainty tests/pareto_fronts"),
    "optimisation": ("optimisation", "tests/optimisation tests/pareto_fronts tests/uncertainty"),
    "records": ("records", "tests/records tests/identification"),
    "units": ("units.py", "tests/test_units.py tests/files tests/report"),
}
EVERYTHING = ["tests", "src", "--ignore", "tests/page"]  # the page's are not about formulas, and minutes long
PYTEST = [sys.executable, "-m", "pytest", "-q", "--no-header"]
MOST_SECONDS = 900.0  # of the tests of one mutant; what hangs is noticed
_SWAPS = {"min": "max", "max": "min", "argmin": "argmax", "argmax": "argmin", "any": "all", "all": "any"}
_SWAPS |= {"minimum": "maximum", "maximum": "minimum", "sin": "cos", "cos": "sin", "floor": "ceil", "ceil": "floor"}
_SIGNS: dict[type, tuple[str, str]] = {
    ast.Add: (r"\+", "-"),
    ast.Sub: (r"-", "+"),
    ast.Mult: (r"\*", "/"),
    ast.Div: (r"/", "*"),
    ast.Pow: (r"\*\*", "*"),
    ast.Lt: (r"<", "<="),
    ast.LtE: (r"<=", "<"),
    ast.Gt: (r">", ">="),
    ast.GtE: (r">=", ">"),
    ast.Eq: (r"==", "!="),
    ast.NotEq: (r"!=", "=="),
    ast.Is: (r"is(?! not)", "is not"),
    ast.IsNot: (r"is not", "is"),
    ast.In: (r"(?<!not )in", "not in"),
    ast.NotIn: (r"not in", "in"),
    ast.And: (r"and", "or"),
    ast.Or: (r"or", "and"),
}


@dataclass(frozen=True)
class Mutant:
    """One change of one file: the text from `begin` to `end` (offsets) becomes `after`."""

    area: str
    file: str
    line: int
    before: str
    after: str
    begin: int
    end: int

    @property
    def key(self) -> tuple[str, int, int, str]:
        """Unique key of the mutant."""
        return self.file, self.begin, self.end, self.after


@dataclass(frozen=True)
class Outcome:
    """Outcome of a mutant: detected by the tests of its "area", by "others", or "survived"."""

    area: str
    file: str
    line: int
    text: str
    before: str
    after: str
    outcome: str
    by: str
    seconds: float


def main() -> None:
    """Draw mutants, test each, write and print what became of them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=150)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", choices=list(AREAS), action="append")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--coverage", type=Path, help="folder that keeps which tests execute which lines")
    parser.add_argument("--resume", action="store_true")
    parser.add_argument("-o", "--output", type=Path, default=Path("mutations.csv"))
    given = parser.parse_args()
    mutants = draw(given.count, given.seed, given.only or list(AREAS))
    known = read(given.output) if given.resume else []
    pending = mutants[len(known) :]
    with tempfile.TemporaryDirectory() as folder, given.output.open("a" if known else "w", newline="") as stream:
        writer = csv.DictWriter(stream, [field.name for field in fields(Outcome)])
        if not known:
            writer.writeheader()
        copies: Queue[Path] = Queue()
        for i in range(given.jobs):
            copies.put(copy_tree(Path(folder) / str(i)))
        executed = tests_by_line(Path(folder) / "0", given.coverage or Path(folder) / "coverage")

        def test_on_copy(mutant: Mutant) -> Outcome:
            copy = copies.get()
            try:
                return test(mutant, copy, executed.get((mutant.file, header_line(mutant, copy)), []))
            finally:
                copies.put(copy)

        with ThreadPoolExecutor(given.jobs) as threads:
            for outcome in threads.map(test_on_copy, pending):
                writer.writerow(asdict(outcome))
                stream.flush()
                known.append(outcome)
                said = f"{len(known)}/{len(mutants)} {outcome.outcome:10} {outcome.seconds:5.0f} s {outcome.file}"
                print(f"{said}:{outcome.line} {outcome.before!r} -> {outcome.after!r}: {outcome.text}", flush=True)
    summarise(known)


def draw(count: int, seed: int, areas: list[str]) -> list[Mutant]:
    """Equal numbers of mutants of each area, drawn from all of its mutable places, in random order."""
    generator = random.Random(seed)
    chosen: list[Mutant] = []
    for i, area in enumerate(areas):
        places = list(mutants_of(area))
        chosen += generator.sample(places, min(len(places), count * (i + 1) // len(areas) - count * i // len(areas)))
    generator.shuffle(chosen)
    return chosen


def mutants_of(area: str) -> Iterator[Mutant]:
    """Every change that can be made in the sources of an area."""
    place = ROOT / SOURCE / AREAS[area][0]
    for path in sorted(place.rglob("*.py")) if place.is_dir() else [place]:
        text = path.read_text(encoding="utf-8")
        for begin, end, after in changes(text):
            line = text.count("\n", 0, begin) + 1
            yield Mutant(area, path.relative_to(ROOT).as_posix(), line, text[begin:end], after, begin, end)


def changes(text: str) -> Iterator[tuple[int, int, str]]:
    """The changes of a source: from, to (offsets), and what stands there then."""
    tree = ast.parse(text)
    starts = [0]
    for line in text.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))

    def at(line: int, column: int) -> int:
        """The offset of a place whose column counts bytes."""
        begin = starts[line - 1]
        return begin + len(text[begin : starts[line]].encode()[:column].decode())

    def begin_of(node: ast.expr) -> int:
        return at(node.lineno, node.col_offset)

    def end_of(node: ast.expr) -> int:
        assert node.end_lineno is not None
        assert node.end_col_offset is not None
        return at(node.end_lineno, node.end_col_offset)

    skipped = {id(inner) for node in ast.walk(tree) for part in unimportant(node) for inner in ast.walk(part)}
    for node in ast.walk(tree):
        if id(node) in skipped:
            continue
        if isinstance(node, ast.Constant) and type(node.value) in (int, float):
            begin, end = begin_of(node), end_of(node)
            yield begin, end, other_number(text[begin:end])
        elif isinstance(node, ast.BinOp) and type(node.op) in _SIGNS:
            yield from operator_between(text, end_of(node.left), begin_of(node.right), type(node.op))
        elif isinstance(node, ast.Compare):
            left = node.left
            for op, right in zip(node.ops, node.comparators, strict=True):
                yield from operator_between(text, end_of(left), begin_of(right), type(op))
                left = right
        elif isinstance(node, ast.BoolOp):
            yield from operator_between(text, end_of(node.values[0]), begin_of(node.values[1]), type(node.op))
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.Not):
            yield begin_of(node), begin_of(node) + len("-" if isinstance(node.op, ast.USub) else "not "), ""
        elif isinstance(node, ast.Name | ast.Attribute):
            name = node.id if isinstance(node, ast.Name) else node.attr
            if name in _SWAPS:
                yield end_of(node) - len(name), end_of(node), _SWAPS[name]


def unimportant(node: ast.AST) -> Iterator[ast.AST]:
    """Parts of a node that decide no number: annotations, decorators, errors that are raised, formats, imports."""
    if isinstance(node, ast.FunctionDef):
        arguments = (*node.args.args, *node.args.kwonlyargs, *node.args.posonlyargs)
        yield from (a.annotation for a in arguments if a.annotation is not None)
        yield from ([node.returns] if node.returns is not None else [])
        yield from node.decorator_list
    elif isinstance(node, ast.ClassDef):
        yield from node.decorator_list
    elif isinstance(node, ast.AnnAssign):
        yield node.annotation
    elif isinstance(node, ast.Raise | ast.JoinedStr | ast.Import | ast.ImportFrom | ast.Assert):
        yield node
    elif isinstance(node, ast.Assign) and all(isinstance(t, ast.Name) and t.id.istitle() for t in node.targets):
        yield node  # the name of a type


def operator_between(text: str, begin: int, end: int, kind: type) -> Iterator[tuple[int, int, str]]:
    """The change of an operator that stands between two operands."""
    if kind in _SIGNS:
        pattern, after = _SIGNS[kind]
        found = re.search(pattern, re.sub(r"#[^\n]*", lambda m: " " * len(m.group()), text[begin:end]))
        if found:
            yield begin + found.start(), begin + found.end(), after


def other_number(text: str) -> str:
    """A number that differs in its last digit that is not zero; zero becomes one."""
    mantissa, sign, exponent = re.fullmatch(r"([^eE]*)([eE]?)(.*)", text).groups()  # type: ignore[union-attr]
    digits = [i for i, c in enumerate(mantissa) if c.isdigit() and c != "0"]
    if not digits:
        return "1" if "." not in mantissa else "1.0"
    last = digits[-1]
    digit = int(mantissa[last])
    return f"{mantissa[:last]}{digit + 1 if digit < 9 else 8}{mantissa[last + 1 :]}{sign}{exponent}"


def copy_tree(place: Path) -> Path:
    """Copy of the files that the tests need."""
    place.mkdir()
    for name in ("src", "tests", "examples", "docs", "benchmarks"):
        shutil.copytree(ROOT / name, place / name, ignore=shutil.ignore_patterns("__pycache__", "node_modules"))
    for name in ("pyproject.toml", "README.md", "CHANGELOG.md", "CONTRIBUTING.md", "LICENSE"):
        shutil.copy(ROOT / name, place / name)
    return place


def tests_by_line(copy: Path, folder: Path) -> dict[tuple[str, int], list[str]]:
    """Node ids of the always-run tests that execute each line (file, number), in order of increasing duration.

    Runs them once, in a copy of the repository, if the folder does not hold the record of an earlier run."""
    folder.mkdir(parents=True, exist_ok=True)
    data, report = folder.resolve() / "coverage.db", folder.resolve() / "junit.xml"
    if not report.exists():
        (folder / "coverage.ini").write_text(f"[run]\nrelative_files = true\ndata_file = {data}\n")
        options = ["--cov=inerter", "--cov-context=test", "--cov-report=", f"--cov-config={folder / 'coverage.ini'}"]
        junit = [f"--junitxml={report}", "-o", "junit_family=xunit1"]
        subprocess.run([*PYTEST, *options, *junit, *EVERYTHING], cwd=copy, env=environment(copy), check=False)
    seconds = {
        (case.get("file"), case.get("name")): float(case.get("time") or 0.0)
        for case in ElementTree.parse(report).iter("testcase")
    }

    def duration(test: str) -> float:
        return seconds.get((test.partition("::")[0], test.rpartition("::")[2]), 0.0)

    executed: dict[tuple[str, int], list[str]] = {}
    recorded = CoverageData(str(data))
    recorded.read()
    for path in recorded.measured_files():
        file = f"{SOURCE}/{path.partition(f'{SOURCE}/')[2]}"
        for line, contexts in recorded.contexts_by_lineno(path).items():
            tests = {context.rpartition("|")[0] for context in contexts} - {""}
            executed[file, line] = sorted(tests, key=lambda test: (duration(test), test))
    return executed


def header_line(mutant: Mutant, copy: Path) -> int:
    """The first line of the statement that holds a mutant, which is executed whenever the mutant is."""
    tree = ast.parse((copy / mutant.file).read_text(encoding="utf-8"))
    lines = [node.lineno for node in ast.walk(tree) if isinstance(node, ast.stmt) and node.lineno <= mutant.line]
    return max(lines)


def test(mutant: Mutant, copy: Path, executing: list[str]) -> Outcome:
    """Run the tests that execute a mutant's line; where none does, those of its area and then all."""
    path = copy / mutant.file
    original = path.read_text(encoding="utf-8")
    begin = time.perf_counter()
    path.write_text(original[: mutant.begin] + mutant.after + original[mutant.end :], encoding="utf-8")
    source, area = AREAS[mutant.area]
    of_area = [a for a in [*area.split(), f"{SOURCE}/{source}"] if (copy / a).exists()]
    if executing:
        own = [test for test in executing if test.startswith(tuple(of_area))]
        steps = [("area", own), ("others", [test for test in executing if test not in set(own)])]
    else:
        steps = [("area", of_area), ("others", EVERYTHING)]
    outcome, by = "survived", ""
    try:
        for name, tests in steps:
            by = failing(copy, tests) if tests else ""
            if by:
                outcome = name
                break
    finally:
        path.write_text(original, encoding="utf-8")
    text = original.splitlines()[mutant.line - 1].strip()
    seconds = round(time.perf_counter() - begin, 1)
    return Outcome(mutant.area, mutant.file, mutant.line, text, mutant.before, mutant.after, outcome, by, seconds)


def environment(copy: Path) -> dict[str, str]:
    """The environment in which the package is that of the copy."""
    return {**os.environ, "PYTHONPATH": str(copy / "src"), "PYTHONDONTWRITEBYTECODE": "1"}


def failing(copy: Path, tests: list[str]) -> str:
    """The first test that fails; empty if none does."""
    listed = copy / "tests.txt"
    listed.write_text("\n".join(tests), encoding="utf-8")
    command = [*PYTEST, "-x", "-n", "0", "-p", "no:cacheprovider", f"@{listed}"]
    try:
        done = subprocess.run(
            command, cwd=copy, env=environment(copy), capture_output=True, text=True, timeout=MOST_SECONDS, check=False
        )
    except subprocess.TimeoutExpired:
        return "a time limit"
    if done.returncode == 0:
        return ""
    if done.returncode < 0:
        return f"ended by signal {-done.returncode}"
    if done.returncode not in (1, 2):  # neither a failure nor an error of collection
        raise RuntimeError(f"pytest ended with {done.returncode}: {done.stdout[-500:]}{done.stderr[-500:]}")
    found = re.search(r"^(?:FAILED|ERROR) (\S+)", done.stdout, re.MULTILINE)
    return found.group(1) if found else f"exit code {done.returncode}: {done.stdout[-200:]}{done.stderr[-200:]}"


def read(path: Path) -> list[Outcome]:
    """The outcomes in a file of an earlier run."""
    with path.open(newline="") as stream:
        return [
            Outcome(**{**row, "line": int(row["line"]), "seconds": float(row["seconds"])})  # type: ignore[arg-type]
            for row in csv.DictReader(stream)
        ]


def summarise(outcomes: list[Outcome]) -> None:
    """Print the share that is noticed, of all and by area."""
    print()
    for area in [*AREAS, "all"]:
        some = [o for o in outcomes if area in ("all", o.area)]
        if some:
            noticed = sum(o.outcome != "survived" for o in some)
            by_area = sum(o.outcome == "area" for o in some)
            low, high = wilson(noticed, len(some))
            print(
                f"{area:13} {noticed:4} of {len(some):4} noticed ({by_area} by the tests of the area): "
                f"{100.0 * noticed / len(some):5.1f} % [{100.0 * low:.1f}, {100.0 * high:.1f}]"
            )


def wilson(hits: int, count: int) -> tuple[float, float]:
    """The 95 % confidence interval of a share (Wilson 1927)."""
    z2 = 1.959964**2
    centre = (hits + 0.5 * z2) / (count + z2)
    reach = (z2 * (hits * (count - hits) / count + 0.25 * z2)) ** 0.5 / (count + z2)
    return centre - reach, centre + reach


if __name__ == "__main__":
    main()
