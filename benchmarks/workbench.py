"""How soon the workbench is there, and how soon a slider's step is answered: `python benchmarks/workbench.py [STEPS]`.

A server is started as `inerter serve` starts it. Times are from the command to the link, to the answer of what a page
asks first, and to the first indices; then medians and the times that 95 % of the steps take, of requests one after the
other. On a machine that does other work the CPU time of the server tells more.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
import tomllib
from pathlib import Path
from typing import Any

import httpx
import numpy as np

EXAMPLE = Path(__file__).parents[1] / "examples" / "quarter-car.toml"
START = "from inerter.cli.start import main; main()"


def main() -> None:
    steps = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    begun = time.perf_counter()
    command = [sys.executable, "-c", START, "serve", str(EXAMPLE), "--no-browser"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        base, _, token = process.stdout.readline().strip().partition("/#token=")
        print(f"link              {time.perf_counter() - begun:6.2f} s")
        with httpx.Client(base_url=base, headers={"Authorization": f"Bearer {token}"}, timeout=120.0) as client:
            client.get("/api/about")
            client.get("/api/start")
            print(f"what there is     {time.perf_counter() - begun:6.2f} s, CPU {seconds(process.pid):.2f} s")
            study = tomllib.loads(EXAMPLE.read_text(encoding="utf-8"))
            client.post("/api/panel/indices", json={"study": study})
            print(f"first indices     {time.perf_counter() - begun:6.2f} s")
            for panel, more in (("indices", {}), ("response", {"layouts": ["S3"]}), ("history", {"layout": "S3"})):
                ask(client, panel, {"study": study, **more}, steps)
        process.terminate()


def ask(client: httpx.Client, panel: str, body: dict[str, Any], steps: int) -> None:
    """Steps of a slider, one after the other; the first is not counted."""
    times = []
    for number in range(steps + 1):
        car = {**body["study"]["vehicle"], "sprung_mass": f"{180 + 0.1 * number} kg"}
        asked = {**body, "study": {**body["study"], "vehicle": car}, "client": "bench", "sequence": number}
        begun = time.perf_counter()
        client.post(f"/api/panel/{panel}", json=asked).raise_for_status()
        times.append(1e3 * (time.perf_counter() - begun))
    median, most = np.percentile(times[1:], [50, 95])
    print(f"{panel:<17} {median:6.1f} ms median, {most:.1f} ms for 95 %")


def seconds(number: int) -> float:
    """CPU time of a process."""
    fields = Path(f"/proc/{number}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


if __name__ == "__main__":
    main()
