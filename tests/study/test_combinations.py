"""Random studies that combine limits, conditions, ties, tolerances and sweeps, against their designs one by one."""

from __future__ import annotations

from copy import deepcopy
from pathlib import Path

import numpy as np
import pytest
import scipy.optimize
from campaigns import sampled
from combinations import Plain, Tables, moved, opened, study_tables, with_place

import inerter as it
from inerter.files.study.cases import Case, Outcome, cases, run_case
from inerter.files.study.parts import run_part
from inerter.files.study.study import Study
from inerter.tasks.tolerances import TolerancePart

KEPT = 1e-6


def limited(seed: int, folder: Path) -> tuple[Tables, Plain]:
    """A random study with limits that some of its designs keep, and its designs by themselves."""
    tables = study_tables(seed)
    names, plain = tables.pop("limited"), Plain(tables, folder)
    rng = np.random.default_rng([seed, 78])
    points = given(plain, opened(tables, folder), 64, seed)
    limits: dict[str, dict[str, object]] = {}
    for name in names:
        values = plain.each(name, points, split=True).reshape(-1, 64)
        values = values[:, np.all(np.isfinite(values), axis=0)]
        sense = str(rng.choice(["at_most", "at_most", "at_most", "at_least"]))
        if sense == "at_most":
            limit = float(np.quantile(values.max(axis=0), rng.uniform(0.1, 0.7)))
        else:
            limit = float(np.quantile(values.min(axis=0), rng.uniform(0.3, 0.9)))
        unit = plain.cases[0][0].unit(name)
        limits[name] = {sense: f"{limit!r} {unit}" if unit not in ("", "1") else limit}
    tables["study"]["subject_to"] = limits
    return tables, plain


def given(plain: Plain, study: Study, count: int, seed: int) -> dict[str, np.ndarray]:
    """Random designs between the bounds."""
    rng = np.random.default_rng([seed, 79])
    free = study.design("one").free_values()
    return {n: np.exp(rng.uniform(np.log(f.lower), np.log(f.upper), count)) for n, f in free.items()}


def excess(tables: Tables, plain: Plain, points: dict[str, np.ndarray]) -> np.ndarray:
    """By how much the worst limit is missed in any condition by any output (designs,); infinite if not known."""
    worst = np.full(next(iter(points.values())).size, -np.inf)
    for name, limit in tables["study"]["subject_to"].items():
        ((sense, quantity),) = limit.items()
        value = float(str(quantity).split()[0])
        off = np.log(plain.each(name, points, split=True) / value).reshape(-1, worst.size)
        off = off if sense == "at_most" else -off
        worst = np.maximum(worst, np.where(np.isnan(off), np.inf, off).max(axis=0))
    return worst


def best_of(study: Study) -> Outcome:
    return run_case(study, Case("one", study.indices[0]))


def check_optimum(tables: Tables, plain: Plain, folder: Path, seed: int) -> Outcome | None:
    """It keeps its limits, its value is that of single designs, and neither chance nor a second search finds better."""
    study = opened(tables, folder)
    (name,), found = study.indices, best_of(study)
    trial = given(plain, study, 2000, seed)
    values, over = plain.index(name, trial), excess(tables, plain, trial)
    if found.kind == "infeasible":
        assert over.min() > 0.0, over.min()
        return None
    assert found.kind == "ok", found.message
    here = {n: np.array([v]) for n, v in found.parameters.items()}
    value = found.values["norm"][name]
    assert plain.index(name, here)[0] == pytest.approx(value, rel=1e-8)
    assert excess(tables, plain, here)[0] <= KEPT
    feasible = values[(over <= 0.0) & np.isfinite(values)]
    assert value <= feasible.min(initial=np.inf) * (1.0 + 1e-7)
    assert value <= by_slsqp(tables, plain, study, found) * (1.0 + 1e-5)
    return found


def by_slsqp(tables: Tables, plain: Plain, study: Study, found: Outcome) -> float:
    """The least that SLSQP with differences finds within the limits from beside the optimum."""
    free = study.design("one").free_values()
    names, rng = list(free), np.random.default_rng(3)
    bounds = np.log([(free[n].lower, free[n].upper) for n in names])

    def at(x: np.ndarray) -> dict[str, np.ndarray]:
        return {n: np.exp(column) for n, column in zip(names, np.atleast_2d(x).T, strict=True)}

    def with_slopes(function):  # type: ignore[no-untyped-def]
        def stencil(x):  # type: ignore[no-untyped-def]
            step = 1e-5
            moves = [x, *(x + s * step * e for e in np.eye(x.size) for s in (1.0, -1.0))]
            values = function(at(np.array(moves)))
            return values[0], (values[1::2] - values[2::2]) / (2.0 * step)

        return stencil

    index = with_slopes(lambda points: np.log(plain.index(study.indices[0], points)))
    over = with_slopes(lambda points: excess(tables, plain, points))
    start = np.log([found.parameters[n] for n in names]) + rng.uniform(-0.1, 0.1, len(names))
    result = scipy.optimize.minimize(
        lambda x: index(x)[0], np.clip(start, *bounds.T), jac=lambda x: index(x)[1], method="SLSQP", bounds=bounds,
        constraints=[{"type": "ineq", "fun": lambda x: -over(x)[0], "jac": lambda x: -over(x)[1]}],
        options={"maxiter": 40, "ftol": 1e-12},
    )  # fmt: skip
    end = at(np.clip(result.x, *bounds.T))
    return float(plain.index(study.indices[0], end)[0]) if excess(tables, plain, end)[0] <= 0.0 else np.inf


def check_costs(tables: Tables, folder: Path, found: Outcome) -> None:
    """What a limit costs is what moving it by one per cent costs, on one side at least."""
    study = opened(tables, folder)
    assert len(found.limits) == len(tables["study"]["subject_to"])
    for (name, limit), (_, active, cost, *_) in zip(tables["study"]["subject_to"].items(), found.limits, strict=True):
        ((sense, quantity),) = limit.items()
        slopes = []
        for factor in (1.01, 1.0 / 1.01):
            other = deepcopy(tables)
            other["study"]["subject_to"][name][sense] = (
                moved(quantity, factor) if isinstance(quantity, str) else quantity * factor
            )
            again = best_of(opened(other, folder))
            if again.kind == "ok":
                ratio = again.values["norm"][study.indices[0]] / found.values["norm"][study.indices[0]]
                slopes.append(float(np.log(ratio) / np.log(factor)))
        if len(slopes) == 2 and np.isfinite(cost):
            near = 0.02 + 0.1 * max(map(abs, slopes))
            assert min(slopes) - near <= cost <= max(slopes) + near, (name, cost, slopes, active)


def check_sweep(tables: Tables, folder: Path, place: str) -> None:
    """A case of a sweep is the study with that number written into it."""
    section, _, key = (place if "." in place else f"elements.{place}").rpartition(".")
    values = [moved(tables[section][key], factor) for factor in (0.9, 1.1)]
    swept = deepcopy(tables)
    swept["study"]["sweep"] = {place: values}
    study = opened(swept, folder)
    every = cases(study)
    for number, value in enumerate(values):
        one, other = run_case(study, every[number]), best_of(opened(with_place(tables, place, value), folder))
        assert one.kind == other.kind
        assert one.parameters == pytest.approx(other.parameters, rel=1e-9)
        assert one.values.get("norm") == pytest.approx(other.values.get("norm"), rel=1e-12)


def check_tolerance(tables: Tables, plain: Plain, folder: Path, found: Outcome, seed: int) -> None:
    """The distribution of the best design whose parts scatter, each by itself, against plain random numbers."""
    rng, count = np.random.default_rng([seed, 80]), 3000
    network = tables["layouts"]["one"].replace("(", " ").replace(")", " ").split()
    parts = [n for n in tables["elements"] if n in network]
    spread = {str(n): round(float(rng.uniform(0.05, 0.3)), 3) for n in rng.permutation(parts)[:3]}
    tables = deepcopy(tables)
    tables["study"]["tolerance"] = spread
    study = opened(tables, folder)
    name = study.indices[0]
    told = run_part(study, {Case("one", name): found}, TolerancePart("one", name))
    assert told.ok, told.message
    rows = []
    for number in range(len(plain.cases)):
        if any(set(condition) & set(spread) for condition in tables.get("conditions", [])):
            return  # a part that another number of a condition takes the place of
        design = plain.known(number, {n: np.array([v]) for n, v in found.parameters.items()})
        nominal = plain.known(0, {n: np.array([v]) for n, v in found.parameters.items()})
        design |= {n: nominal[n] for n in spread}
        rows.append({n: np.full(count, v[0]) for n, v in design.items()})
    factors = {n: 1.0 + part * rng.uniform(-1.0, 1.0, count) for n, part in spread.items()}
    values = []
    for (case, _), row in zip(plain.cases, rows, strict=True):
        design = case.design("one")
        points = {n: row[n] * factors.get(n, 1.0) for n in design.free_values()}
        values.append(it.evaluate_many(design, case.index(name), points, it.Norm())[:, 0])
    drawn = np.max(values, axis=0) if plain.worst else plain.shares @ np.array(values)
    error = drawn.std() / np.sqrt(count)
    assert told.numbers["mean"] == pytest.approx(drawn.mean(), abs=5.0 * error)
    assert told.numbers["standard_deviation"] == pytest.approx(drawn.std(), rel=0.08)
    assert told.numbers["quantile"] == pytest.approx(np.quantile(drawn, 0.95), abs=15.0 * error)
    assert told.numbers["worst"] >= drawn.max() - 2.0 * error


@pytest.mark.parametrize("seed", sampled([1, 3, 9, 19, 21], often=[3], kept=0))
def test_what_is_combined_is_what_single_designs_say(seed: int, tmp_path: Path) -> None:
    tables, plain = limited(seed, tmp_path)
    found = check_optimum(tables, plain, tmp_path, seed)
    if found is None:
        return
    check_costs(tables, tmp_path, found)
    held = {place for condition in tables.get("conditions", []) for place in condition}
    if "road.speed" not in held:
        check_sweep(tables, tmp_path, "road.speed")
    if tables["vehicle"]["model"] != "mechanism":
        check_tolerance(tables, plain, tmp_path, found, seed)
