"""How long the page takes: from the command to the page, from the step of a slider to its numbers, frames of the car;
and its memory over a thousand steps.

    python benchmarks/page_latency.py [STEPS]

In a real Chromium, on a server of its own, with the quarter car. A step counts from the input event until the table
shows an answer to that very question, and the curves are drawn from theirs.
"""

from __future__ import annotations

import json
import os
import shutil
import socket
import subprocess
import sys
import time
import urllib.request
from pathlib import Path
from statistics import median, quantiles
from typing import Any

from playwright.sync_api import sync_playwright

EXAMPLE = Path(__file__).parents[1] / "examples" / "quarter-car.toml"
TOKEN = "a-token-of-the-benchmark-of-the-page"

STEP = """async ([position, panels]) => {
  const slider = document.getElementById("slider elements.c");
  const done = (panel) => new Promise((resolve) => addEventListener("inerter:shown", function look({ detail }) {
    if (detail.panel !== panel || !detail.newest) return;
    removeEventListener("inerter:shown", look);
    resolve(performance.now());
  }));
  const all = Promise.all(panels.map(done));
  const begun = performance.now();
  slider.value = String(position);
  slider.dispatchEvent(new Event("input", { bubbles: true }));
  return Math.max(...(await all)) - begun;
}"""
DATA = {"object", "array", "string", "concatenated string", "sliced string", "number", "closure", "regexp"}
KEPT = 10  # at least the number of answers that a panel keeps, so that undoing finds them again
FRAMES = """async (seconds) => {
  const canvas = document.querySelector(".vehicle canvas");
  const before = Number(canvas.dataset.frames);
  await new Promise((resolve) => setTimeout(resolve, 1000 * seconds));
  return (Number(canvas.dataset.frames) - before) / seconds;
}"""


def main() -> None:
    steps = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        port = listener.getsockname()[1]
    origin = f"http://127.0.0.1:{port}"
    command = [
        sys.executable,
        "-c",
        "from inerter.cli.start import main; main()",
        "serve",
        str(EXAMPLE),
        "--port",
        str(port),
    ]
    begun = time.perf_counter()
    server = subprocess.Popen(
        [*command, "--no-browser"], stdout=subprocess.PIPE, env={**os.environ, "INERTER_TOKEN": TOKEN}
    )
    try:
        assert server.stdout is not None
        server.stdout.readline()
        print(f"from the command to its link     {time.perf_counter() - begun:8.2f} s")
        ready = urllib.request.Request(f"{origin}/api/ready", headers={"Authorization": f"Bearer {TOKEN}"})
        urllib.request.urlopen(ready, timeout=300).read()
        print(f"from the command to its kernels  {time.perf_counter() - begun:8.2f} s")
        with sync_playwright() as play:
            browser = play.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
            _measure(browser.new_page(viewport={"width": 1280, "height": 800}), f"{origin}/#token={TOKEN}", steps)
            browser.close()
    finally:
        server.terminate()
        server.wait(30)


def _measure(page: Any, link: str, steps: int) -> None:
    for what in ("request", "reload"):
        begun = time.perf_counter()
        page.goto(link) if what == "request" else page.reload()
        for part, selector in (("the page", ".values .amount"), ("numbers", "td[data-index][data-value]")):
            page.wait_for_selector(selector)
            print(f"{f'from the {what} to {part}':32} {time.perf_counter() - begun:8.2f} s")
    page.wait_for_timeout(1000)
    for panels in (["decision"], ["decision", "response"]):
        page.evaluate(STEP, [10, panels])
        times = [page.evaluate(STEP, [40 + (37 * i) % 320, panels]) for i in range(steps)]
        late = quantiles(times, n=20)[-1]
        print(f"a step to {' and '.join(panels):22} {median(times):8.1f} ms, 95 % under {late:.1f} ms ({steps} steps)")
    page.wait_for_selector(".vehicle[data-being=current] canvas")
    page.wait_for_timeout(500)
    print(f"frames of the car in motion      {page.evaluate(FRAMES, 3):8.1f} a second")
    _measure_memory(page)


def _measure_memory(page: Any) -> None:
    """Heap and nodes after further steps, once the answers that each panel keeps are as many as it ever keeps.

    Of the heap also what the page itself holds, without the code that the browser compiles and what it records.
    """
    session = page.context.new_cdp_session(page)
    session.send("Performance.enable")
    session.send("HeapProfiler.enable")
    for i in range(KEPT):
        page.evaluate(STEP, [40 + i, ["decision"]])
        page.wait_for_selector(".vehicle[data-being=current]")
        page.wait_for_timeout(1000)
    begun = 0
    for steps in (0, 100, 300, 1000):
        for i in range(begun, steps):
            page.evaluate(STEP, [40 + (37 * i) % 320, ["decision"]])
        begun = steps
        page.wait_for_timeout(1500)
        session.send("HeapProfiler.collectGarbage")
        found = {one["name"]: one["value"] for one in session.send("Performance.getMetrics")["metrics"]}
        size, held, nodes = found["JSHeapUsedSize"] / 1e6, _size_of_data(session) / 1e6, found["Nodes"]
        print(f"memory after {steps:4} further steps {size:8.2f} MB, of which data {held:.2f} MB; {nodes:.0f} nodes")


def _size_of_data(session: Any) -> int:
    """Bytes of the objects, texts and functions of the page, from a snapshot of its heap."""
    chunks: list[str] = []

    def listener(event: Any) -> None:
        chunks.append(event["chunk"])

    session.on("HeapProfiler.addHeapSnapshotChunk", listener)
    session.send("HeapProfiler.takeHeapSnapshot", {"reportProgress": False})
    session.remove_listener("HeapProfiler.addHeapSnapshotChunk", listener)
    snapshot = json.loads("".join(chunks))
    meta, nodes = snapshot["snapshot"]["meta"], snapshot["nodes"]
    width, kinds = len(meta["node_fields"]), meta["node_types"][0]
    kind, size = (meta["node_fields"].index(name) for name in ("type", "self_size"))
    return sum(nodes[i + size] for i in range(0, len(nodes), width) if kinds[nodes[i + kind]] in DATA)


if __name__ == "__main__":
    main()
