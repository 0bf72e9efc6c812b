"""All kernels of the package that are not made for one size of system; as a program, it compiles those not kept."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

import inerter
from inerter.kernels.decorators import Kernel
from inerter.kernels.prepare import prepare


def compile_all() -> None:
    prepare(kernel for kernel in _kernels() if kernel.signature is not None)


def _kernels() -> Iterator[Kernel]:
    root = Path(inerter.__file__).parent
    for path in sorted(root.rglob("*.py")):
        if "\n@kernel(" in path.read_text(encoding="utf-8"):
            module = import_module(".".join((root.name, *path.relative_to(root).with_suffix("").parts)))
            yield from (value for value in vars(module).values() if isinstance(value, Kernel))


if __name__ == "__main__":
    compile_all()
