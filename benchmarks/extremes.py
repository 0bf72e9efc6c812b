"""Whether valid files with quantities over all magnitudes end in time, in a result or in one sentence.

    python benchmarks/extremes.py [--count 300] [--limit 20] [--first 0] [--jobs 2] [--keep FOLDER]

Files that `check` refuses are counted, and do not count among the others. Each runs in a process of its own, which is
ended when it has had the limit [s] of a processor. Needs the extra "test".
"""

from __future__ import annotations

import argparse
import contextlib
import io
import math
import multiprocessing
import resource
import shutil
import sys
import tempfile
import time
import traceback
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from itertools import count
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests"))

from extremes import BASES, extreme, what_is_wrong

from inerter.cli.main import call


def arguments(command: str, path: Path, output: Path) -> list[str]:
    """Of the command line, with the output that is given replaced."""
    if command == "rig":
        output = output.with_suffix(".csv")
        output.unlink(missing_ok=True)
    shutil.rmtree(output, ignore_errors=True)
    return [command, str(path), "-o", str(output), *(["-j", "1"] if command == "run" else [])]


def answer(words: list[str], connection: object, limit: float) -> None:
    """Send exit code, output, errors and processor time [s] of a command through the connection."""
    out, err = io.StringIO(), io.StringIO()
    begun = time.process_time()
    resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(begun + limit), math.ceil(begun + limit)))
    code = 70
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            code = call(words)
        except BaseException:
            traceback.print_exc()
    connection.send((code, out.getvalue(), err.getvalue(), time.process_time() - begun))  # type: ignore[attr-defined]


def run_with_limit(words: list[str], limit: float) -> tuple[int, str, str, float]:
    """Exit code, output, errors and seconds of a command in a process that is ended after the limit [s]."""
    here, there = multiprocessing.Pipe()
    process = multiprocessing.get_context("fork").Process(target=answer, args=(words, there, limit))
    process.start()
    there.close()
    try:
        found: tuple[int, str, str, float] = here.recv()
    except EOFError:
        found = (-1, "", "", math.inf)
    process.join()
    return found


def test_member(seed: int, folder: Path, limit: float) -> tuple[int, str, list[str]]:
    """Seed, outcome ("refused", "result", "sentence" or "WRONG"), and faults."""
    case = extreme(seed)
    path = folder / f"{seed}.toml"
    path.write_text(case.text, encoding="utf-8")
    code, _, err, seconds = run_with_limit(["check", str(path)], limit)
    if code == 2:
        return seed, "refused", [" ".join(err.split())[:160]]
    faults = [f"check: {fault}" for fault in what_is_wrong(code, "", err, seconds, limit)]
    code, out, err, seconds = run_with_limit(arguments(case.command, path, folder / f"{seed}-results"), limit)
    faults += what_is_wrong(code, out, err, seconds, limit)
    (folder / f"{seed}.out").write_text(f"{code} after {seconds:.1f} s\n{out}\n{err}", encoding="utf-8")
    return seed, "WRONG" if faults else "result" if code == 0 else "sentence", faults


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--limit", type=float, default=20.0)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--keep", type=Path)
    given = parser.parse_args()
    folder = given.keep or Path(tempfile.mkdtemp())
    folder.mkdir(exist_ok=True)
    for base, (command, text) in BASES.items():  # loads what is loaded once
        (folder / "base.toml").write_text(text, encoding="utf-8")
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            code = call(arguments(command, folder / "base.toml", folder / f"base-{base}"))
        assert code == 0, base
    kinds: Counter[str] = Counter()
    seeds = count(given.first)
    with ThreadPoolExecutor(given.jobs) as threads:
        while (left := given.count - kinds["result"] - kinds["sentence"] - kinds["WRONG"]) > 0:
            batch = [next(seeds) for _ in range(min(left, 4 * given.jobs))]
            for seed, kind, faults in threads.map(lambda seed: test_member(seed, folder, given.limit), batch):
                kinds[kind] += 1
                if kind in ("WRONG", "refused"):
                    print(f"{kind}: {seed} ({extreme(seed).base}): {'; '.join(faults)}", flush=True)
    print(dict(kinds))
    return int(kinds["WRONG"] > 0)


if __name__ == "__main__":
    sys.exit(main())
