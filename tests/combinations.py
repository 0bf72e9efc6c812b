"""Random studies that combine what study files have: limits, conditions, ties, tolerances and sweeps.

A study is its tables, as a file has them. What it should give is found by `Plain`: every design with all its values as
numbers, in every condition by itself, in a file of its own.
"""

from __future__ import annotations

import json
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
from study_text import load_text

import inerter as it
from inerter.files.study.study import Study

Tables = dict[str, Any]
UNITS = {"k": "N/m", "c": "N s/m", "b": "kg"}
NETWORKS = [
    "k | c",
    "k | c | b",
    "k | c - b",
    "k | c - b | c2",
    "k1 - k2 | c",
    "k1 - k2 | c - b",
    "(k | c2) - k1 | c",
    "k | c - (b | c2)",
    "kf | c - b",
    "kf | (k1 | c) - b",
    "kf | c - b2 | b",
]
ELEMENTS = {
    "k": 60e3,
    "c": (200.0, 5e4),
    "b": (2.0, 800.0),
    "k1": (7e4, 9e5),
    "kf": (1e4, 2e5),
    "c2": "0.4 * c",
    "b2": "0.5 * b",
    "k2": "1 / (1 / k - 1 / k1)",
}
CARS = {
    "quarter-car": {"sprung_mass": (250, "kg"), "unsprung_mass": (35, "kg"), "tyre_stiffness": (150e3, "N/m")},
    "half-car": {
        "sprung_mass": (700, "kg"),
        "pitch_inertia": (1100, "kg m^2"),
        "unsprung_mass_front": (40, "kg"),
        "unsprung_mass_rear": (45, "kg"),
        "tyre_stiffness_front": (180e3, "N/m"),
        "tyre_stiffness_rear": (190e3, "N/m"),
        "distance_front": (1.2, "m"),
        "distance_rear": (1.5, "m"),
    },
    "full-car": {
        "sprung_mass": (1400, "kg"),
        "pitch_inertia": (2300, "kg m^2"),
        "roll_inertia": (500, "kg m^2"),
        "unsprung_mass_front": (40, "kg"),
        "unsprung_mass_rear": (45, "kg"),
        "tyre_stiffness_front": (180e3, "N/m"),
        "tyre_stiffness_rear": (190e3, "N/m"),
        "distance_front": (1.2, "m"),
        "distance_rear": (1.5, "m"),
        "track_front": (1.5, "m"),
        "track_rear": (1.5, "m"),
    },
}
TRAILER = {
    "vehicle.coordinates": {"body": "900 kg", "front": "60 kg", "rear": "70 kg", "pitch": "1500 kg m^2"},
    "vehicle.struts": {
        "bow": {"upper": {"body": 1, "pitch": "1.3 m"}, "lower": {"front": 1}},
        "stern": {"upper": {"body": 1, "pitch": "-1.6 m"}, "lower": {"rear": 1}, "network": "ks | cs"},
    },
    "vehicle.tyres": {
        "first": {"port": {"front": 1}, "road": "a", "network": "kt"},
        "second": {"port": {"rear": 1}, "road": "b", "network": "kt"},
    },
    "vehicle.roads": {"a": {}, "b": {"distance": "2.9 m"}},
    "vehicle.measures": {"comfort": {"body_acceleration": 1, "pitch_acceleration": "0.7 m"}},
}


def study_tables(seed: int) -> Tables:
    """A random study of one layout, `one`, with an index to make small, limits on others, and perhaps conditions."""
    rng = np.random.default_rng([seed, 77])
    chance = lambda p: bool(rng.random() < p)  # noqa: E731
    model = str(rng.choice(["quarter-car", "quarter-car", "half-car", "full-car", "mechanism"]))
    network = str(rng.choice(NETWORKS))
    names = {name for name in ELEMENTS if name in network.replace("(", " ").replace(")", " ").split()}
    names |= {other for name in names for other in ("k", "k1", "c", "b") if _follows(name, other)}
    tables: Tables = {"vehicle": {"model": model}, "road": {}, "elements": {}, "layouts": {"one": network}}
    if model == "mechanism":
        tables |= deepcopy(TRAILER)
        tables["elements"] |= {"ks": "70000.0 N/m", "cs": "2500.0 N s/m", "kt": "200000.0 N/m"}
    else:
        for key, (value, unit) in CARS[model].items():
            tables["vehicle"][key] = f"{float(value * np.exp(rng.uniform(-0.2, 0.2)))!r} {unit}"
    if model != "mechanism" and chance(0.25):
        tables["vehicle.seat"] = {"mass": "70.0 kg", "network": "ks | cs"}
        tables["elements"] |= {"ks": "12000.0 N/m", "cs": {"from": "100.0 N s/m", "to": "3000.0 N s/m"}}
    for name in ELEMENTS:
        if name in names:
            tables["elements"][name] = _entry(name)
    tables["road"] = {"speed": f"{float(rng.uniform(12.0, 35.0))!r} m/s", "roughness": "5e-7 m^3/cycle"}
    if model == "full-car" and chance(0.6):
        tables["road"]["coherence"] = [{"level": 0.6}, {"track": "1.5 m"}, {"wavenumber": "0.2 cycle/m"}][
            int(rng.integers(3))
        ]
    if chance(0.4):
        tables["indices.comfort"] = {"kind": "ride-comfort", "weighting": str(rng.choice(["Wk", "Wd"]))}
    known = ["comfort" if "indices.comfort" in tables else "J1", "J3", "suspension-travel"]
    if model == "quarter-car":
        pushed = str(rng.choice([name for name in names if name in network.replace("(", " ").split()]))
        tables["indices.pushed"] = {"kind": str(rng.choice(["element-force", "element-velocity"])), "element": pushed}
        known.append("pushed")
    if model not in ("mechanism",):
        known += ["J5", "dynamic-load-coefficient"]
    asked = [str(name) for name in rng.permutation(known)[:4]]
    tables["study"] = {"indices": asked[:1], "optimise": "norm", "seed": int(rng.integers(3))}
    tables["limited"] = asked[1 : 2 + chance(0.4)]  # which indices; their values come later
    if chance(0.6):
        tables["study"]["conditions"] = str(rng.choice(["mean", "worst"]))
        tables["conditions"] = [_condition(rng, tables) for _ in range(int(rng.integers(2, 4)))]
    return tables


def _follows(name: str, other: str) -> bool:
    entry = ELEMENTS[name]
    return isinstance(entry, str) and other in entry.replace("(", " ").replace(")", " ").split()


def _entry(name: str) -> Any:
    entry, unit = ELEMENTS[name], UNITS[name[0]]
    if isinstance(entry, str):
        return {"tied": entry}
    if isinstance(entry, tuple):
        return {"from": f"{entry[0]!r} {unit}", "to": f"{entry[1]!r} {unit}"}
    return f"{entry!r} {unit}"


def _condition(rng: np.random.Generator, tables: Tables) -> dict[str, Any]:
    """One with other numbers of one or two of the places that there are."""
    places = {"road.speed": tables["road"]["speed"]}
    if "sprung_mass" in tables["vehicle"]:
        places["vehicle.sprung_mass"] = tables["vehicle"]["sprung_mass"]
    if "vehicle.coordinates" in tables:
        places["vehicle.coordinates.body"] = tables["vehicle.coordinates"]["body"]
    if "vehicle.seat" in tables:
        places["vehicle.seat.mass"] = tables["vehicle.seat"]["mass"]
    places |= {name: entry for name, entry in tables["elements"].items() if isinstance(entry, str)}
    chosen = rng.permutation(list(places))[: int(rng.integers(1, 3))]
    found: dict[str, Any] = {"share": round(float(rng.uniform(0.1, 2.0)), 3)}
    return found | {str(place): moved(places[str(place)], float(rng.uniform(0.8, 1.15))) for place in chosen}


def moved(quantity: str, factor: float) -> str:
    """A quantity times a factor, with its unit."""
    number, _, unit = quantity.partition(" ")
    return f"{float(number) * factor!r} {unit}"


def with_place(tables: Tables, place: str, quantity: Any) -> Tables:
    """The tables with another quantity at a place."""
    found = deepcopy(tables)
    section, _, key = (place if "." in place else f"elements.{place}").rpartition(".")
    found[section][key] = quantity
    return found


def written(tables: Tables) -> str:
    """The text of the study file."""
    lines, asked = [], tables["study"]
    used = {*asked["indices"], *asked.get("subject_to", {}), *asked.get("trade_off", [])}
    for section, entries in tables.items():
        own = section.startswith("indices.") and section.removeprefix("indices.") not in used
        if isinstance(entries, dict) and section != "study" and not own:
            lines += [f"[{section}]", *(f"{_key(key)} = {_toml(value)}" for key, value in entries.items())]
    for condition in tables.get("conditions", []):
        lines += ["[[conditions]]", *(f"{_key(key)} = {_toml(value)}" for key, value in condition.items())]
    lines += ["[study]", *(f"{_key(key)} = {_toml(value)}" for key, value in tables["study"].items())]
    return "\n".join(lines) + "\n"


def _key(key: str) -> str:
    return json.dumps(key) if "." in key and not key.startswith("static") else key


def _toml(value: Any) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{_key(key)} = {_toml(one)}" for key, one in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(_toml, value)) + "]"
    return json.dumps(value)


def opened(tables: Tables, folder: Path) -> Study:
    """The study of that file."""
    return load_text(folder, written(tables))


class Plain:
    """What a study's designs come to, each by itself: no ties, no conditions, no limits."""

    def __init__(self, tables: Tables, folder: Path) -> None:
        self.tables, self.worst = tables, tables["study"].get("conditions") == "worst"
        conditions = tables.get("conditions", [{"share": 1.0}])
        shares = np.array([condition["share"] for condition in conditions])
        self.shares = shares / shares.sum()
        self.free = {name: entry for name, entry in tables["elements"].items() if isinstance(entry, dict)}
        self.cases = [self._case(condition, folder) for condition in conditions]

    def _case(self, condition: dict[str, Any], folder: Path) -> tuple[Study, dict[str, float]]:
        """A study of that condition alone, in which all elements are free, and the values of those that were fixed."""
        tables = deepcopy({key: entry for key, entry in self.tables.items() if key not in ("conditions", "limited")})
        for place, quantity in condition.items():
            if place != "share":
                tables = with_place(tables, place, quantity)
        fixed = {n: float(e.split()[0]) for n, e in tables["elements"].items() if isinstance(e, str)}
        for name in tables["elements"]:
            tables["elements"][name] = {"from": f"1e-9 {UNITS[name[0]]}", "to": f"1e12 {UNITS[name[0]]}"}
        own = [section.removeprefix("indices.") for section in tables if section.startswith("indices.")]
        tables["study"] = {"indices": own or ["J1"], "optimise": "norm"}
        return opened(tables, folder), fixed

    def known(self, case: int, given: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
        """All values of the elements in one condition."""
        size = len(next(iter(given.values())))
        found = {name: np.full(size, value) for name, value in self.cases[case][1].items()} | given
        for name, entry in self.free.items():
            if "tied" in entry:
                found[name] = np.broadcast_to(eval(entry["tied"], {}, dict(found)), (size,))
        return found

    def each(self, name: str, given: dict[str, np.ndarray], split: bool = False) -> np.ndarray:
        """An index in each condition (conditions, outputs, designs), each output by itself if they are `split`."""
        rows = []
        for number, (study, _) in enumerate(self.cases):
            values = self.known(number, given)
            good = np.all([(v > 0.0) & np.isfinite(v) for v in values.values()], axis=0)
            design = study.design("one")
            points = {n: values[n][good] for n in design.free_values()}
            outputs = self._outputs(study, design, name) if split else [study.index(name)]
            row = np.full((len(outputs), good.size), np.nan)
            if good.any():
                row[:, good] = it.evaluate_many(design, outputs, points, it.Norm()).T
            rows.append(row)
        return np.array(rows)

    def _outputs(self, study: Study, design: Any, name: str) -> list[Any]:
        index = study.index(name)
        if name not in ("J3", "suspension-travel", "dynamic-load-coefficient", "pushed"):
            return [index]
        outputs = index.definition(design.mechanism()).outputs
        return [it.RandomResponse({one.output: one.weight}, study.road) for one in outputs]

    def index(self, name: str, given: dict[str, np.ndarray]) -> np.ndarray:
        """An index over the conditions (designs,)."""
        each = self.each(name, given)[:, 0]
        return each.max(axis=0) if self.worst else self.shares @ each
