"""A random record, or profile, as a table in a random dialect reads back to the same numbers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import inerter as it
from inerter.errors import RecordError
from inerter.records.inspection import findings

NAMES = {
    "time": ("time", "Time", "t", "Zeit", "ZEIT", "temps", "Temps"),
    "displacement": ("displacement", "Position", "Weg", "Hub", "déplacement", "deplacement", "Course"),
    "force": ("force", "Load", "Kraft", "Force", "effort"),
    "velocity": ("velocity", "Geschwindigkeit", "vitesse"),
}
UNITS = {
    "time": {"s": 1.0, "ms": 1e-3},
    "displacement": {"m": 1.0, "mm": 1e-3, "µm": 1e-6},
    "force": {"N": 1.0, "kN": 1e3},
    "velocity": {"m/s": 1.0, "mm/s": 1e-3},
}
PROFILES = {
    "distance": ("distance", "Weg", "Strecke", "Station", "abscisse"),
    "height": ("height", "Höhe", "Hoehe", "links", "hauteur", "gauche"),
    "right": ("right", "rechts", "droite"),
}
REMARKS = ("", "", "ok", "Schlag gehört", "à vérifier", "Start (neu)")
ENDS = ("", "", "Ende", "Fin", "End of data", "*** Messung beendet ***")


def table(rng: np.random.Generator, path: Path, names: dict[str, str], units: dict[str, str], columns: dict) -> str:
    """Writes the columns in some dialect; returns what it is, for messages."""
    delimiter = str(rng.choice([",", ";", "\t", " ; "]))
    decimal = "." if delimiter == "," or rng.random() < 0.3 else ","
    encoding = str(rng.choice(["utf-8", "utf-8-sig", "latin-1", "utf-16"]))
    style = str(rng.choice(["[]", "()", "below", "below in brackets", "DIN", "in"]))
    roles = list(columns)
    rng.shuffle(roles)
    remark = ", ".join(map(str, rng.choice(["(vorn)", "[1]", "(Sensor 2)", ""], 1))) if style != "DIN" else ""
    marked = str(rng.choice(roles))
    heads = {role: f"{names[role]} {remark}".strip() if role == marked else names[role] for role in roles}
    below = style.startswith("below")
    if style == "DIN":
        heads = {role: f"{heads[role]} / {units[role]}" for role in roles}
    elif style == "in":
        heads = {
            role: f"{heads[role]} in {units[role]}" if not remark else f"{heads[role]} [{units[role]}]"
            for role in roles
        }
    elif not below:
        heads = {role: f"{heads[role]} {style[0]}{units[role]}{style[1]}" for role in roles}
    rows = [[heads[role] for role in roles]]
    if below:
        rows.append([f"[{units[role]}]" if "brackets" in style else units[role] for role in roles])
    size = len(next(iter(columns.values())))
    rows += [[f"{columns[role][at]:.17g}".replace(".", decimal) for role in roles] for at in range(size)]
    if rng.random() < 0.6:
        place = int(rng.choice([0, len(roles)]))
        cells = ["Bemerkung", *[""] * below, *map(str, rng.choice(REMARKS, size))]
        for row, cell in zip(rows, cells, strict=True):
            row.insert(place, cell)
    above = ["Prüfstand 7", "Datum: 1.2.2024"] if rng.random() < 0.3 else []
    end = str(rng.choice(ENDS))
    newline = str(rng.choice(["\n", "\r\n"]))
    text = newline.join([*above, *(delimiter.join(row) for row in rows), *([end] if end else []), ""])
    path.write_bytes(text.encode(encoding))
    return f"{delimiter!r} {decimal!r} {encoding} {style!r} {remark!r} {end!r}\n{text[:400]}"


def record_columns(rng: np.random.Generator, size: int) -> dict[str, np.ndarray]:
    columns = {role: rng.normal(0.0, 10.0 ** rng.uniform(-3.0, 2.0), size) for role in [*NAMES][: rng.integers(3, 5)]}
    return columns | {"time": 1e-3 * np.arange(size) + rng.uniform(0.0, 5.0)}


def profile_columns(rng: np.random.Generator, size: int) -> dict[str, np.ndarray]:
    columns = {role: rng.normal(0.0, 0.02, size) for role in [*PROFILES][: rng.integers(2, 4)]}
    return columns | {"distance": rng.uniform(-5.0, 5.0) + np.cumsum(rng.uniform(0.05, 0.2, size))}


KINDS = {
    "record": (12, record_columns, NAMES, UNITS, it.read_record),
    "profile": (13, profile_columns, PROFILES, {role: {"m": 1.0, "mm": 1e-3} for role in PROFILES}, it.read_profile),
}


def check(kind: str, seed: int, folder: Path) -> None:
    number, draw, words, scales, read = KINDS[kind]
    rng = np.random.default_rng([seed, number])
    columns = draw(rng, int(rng.integers(30, 60)))
    units = {role: str(rng.choice(list(scales[role]))) for role in columns}
    names = {role: str(rng.choice(words[role])) for role in columns}
    stored = {role: values / scales[role][units[role]] for role, values in columns.items()}
    said = table(rng, folder / "a.csv", names, units, stored)
    try:
        found = read(folder / "a.csv")
    except RecordError as error:
        pytest.fail(f"{seed}: {error}\n{said}")
    for role, values in columns.items():
        np.testing.assert_allclose(getattr(found, role), values, rtol=1e-13, err_msg=f"{seed}: {role} {said}")


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(30))
def test_every_dialect_is_the_same_table(tmp_path, kind, seed):
    check(kind, seed, tmp_path)


@pytest.mark.marathon
@pytest.mark.parametrize("kind", KINDS)
def test_many_dialects(tmp_path, kind):
    for seed in range(1000, 3000):
        check(kind, seed, tmp_path)


def grid(rng: np.random.Generator, left_out: int) -> tuple[np.ndarray, np.ndarray]:
    """Times of an even clock without some rows in its middle, and which rows there are."""
    kept = np.ones(200, dtype=bool)
    for start in rng.choice(np.arange(20, 180, 20), 3, replace=False):
        kept[start : start + int(rng.integers(1, left_out + 1))] = False
    return 2e-3 * np.arange(200), kept


@pytest.mark.parametrize("seed", range(5))
def test_rows_that_are_left_out_are_filled(tmp_path, seed):
    """The whole grid, to what a cubic spline can know, and nothing left to ask for a new interval."""
    rng = np.random.default_rng([seed, 14])
    time, kept = grid(rng, 8)
    x, force = np.cos(15.0 * time), np.sin(17.0 * time)
    rows = [f"{t:.4f};{a:.9f};{b:.9f}" for t, a, b in zip(time[kept], x[kept], force[kept], strict=True)]
    (tmp_path / "a.csv").write_text("\n".join(["Zeit [s];Weg [mm];Kraft [N]", *rows, "Ende"]), encoding="utf-8")
    assert any(f.kind == "gaps" for f in findings(it.read_record(tmp_path / "a.csv")))
    record = it.read_record(tmp_path / "a.csv", gaps="fill")
    assert record.uniform
    assert record.time == pytest.approx(time, abs=1e-9)
    assert record.displacement == pytest.approx(1e-3 * x, abs=1e-6)
    assert record.force == pytest.approx(force, abs=1e-3)
    assert not any(f.kind in ("gaps", "jitter") for f in findings(record))
    assert f"{np.sum(~kept)}, up to" in " ".join(record.notes)
    longest = it.read_record(tmp_path / "a.csv", gaps="longest")
    assert longest.uniform
    assert np.isin(np.round(longest.time, 6), np.round(time[kept], 6)).all()


def test_rows_that_are_left_out_beyond_the_limit_are_named(tmp_path):
    time = np.delete(2e-3 * np.arange(100), slice(40, 60))
    rows = [f"{t:.4f},{np.cos(t):.6f},{np.sin(t):.6f}" for t in time]
    (tmp_path / "a.csv").write_text("\n".join(["time [s],x [mm],F [N]", *rows]), encoding="utf-8")
    with pytest.raises(
        RecordError,
        match=r"20 samples are missing in the times after 78 ms, too many to interpolate .* gaps='longest'",
    ):
        it.read_record(tmp_path / "a.csv", gaps="fill")
    assert it.read_record(tmp_path / "a.csv", gaps=0.05).uniform
    uneven = np.cumsum(np.random.default_rng(0).uniform(1e-3, 9e-3, 80))
    rows = [f"{t:.5f},{np.cos(t):.6f},{np.sin(t):.6f}" for t in uneven]
    (tmp_path / "b.csv").write_text("\n".join(["time [s],x [mm],F [N]", *rows]), encoding="utf-8")
    assert it.read_record(tmp_path / "b.csv", gaps="fill").time.size == 80  # no clock that leaves out rows


def test_a_choice_is_said_and_two_of_a_kind_are_not_chosen_between(tmp_path):
    rows = "\n".join(f"{0.1 * i:.1f},{i},{-i},{i * i}" for i in range(9))
    (tmp_path / "a.csv").write_text(f"Zeit [s],Weg vorn [mm],Kraft vorn [N],U [V]\n{rows}", encoding="utf-8")
    record = it.read_record(tmp_path / "a.csv")
    assert record.notes[0] == (
        "Channels selected by name: time from Zeit [s], displacement from Weg vorn [mm], force from Kraft vorn [N]."
    )
    (tmp_path / "b.csv").write_text(f"Zeit [s],Weg vorn [mm],Kraft vorn [N],Kraft hinten [N]\n{rows}", encoding="utf-8")
    with pytest.raises(RecordError, match=r"force channel not found by an obvious name .* Name it: force='Kraft v"):
        it.read_record(tmp_path / "b.csv")
    (tmp_path / "c.csv").write_text(f"Zeit [s],Weg [mm],Kraft [N],force [N]\n{rows}", encoding="utf-8")
    with pytest.raises(RecordError, match=r"ambiguous force channel: 'Kraft' \(number 2\) and 'force' \(number 3\)"):
        it.read_record(tmp_path / "c.csv")


def test_both_units_of_a_profile_are_asked_for_at_once(tmp_path):
    (tmp_path / "a.csv").write_text("0,1\n1,2\n2,1\n", encoding="utf-8")
    with pytest.raises(RecordError, match=r"units=\{'distance': 'm', 'height': 'mm'\}\."):
        it.read_profile(tmp_path / "a.csv", distance=0)


@pytest.mark.parametrize("end", ["0.019,1.9000,3.80", "0.019,1.9000,3.8", "0.019,1.9000", "0.01"])
def test_a_last_row_that_is_cut_short_is_left_out(tmp_path, end):
    """Of a recording that broke off, "3.80" would be read as the force."""
    rows = [f"{at / 1000:.3f},{at / 10:.4f},{at / 5:.4f}" for at in range(30)]
    (tmp_path / "a.csv").write_text("\n".join(["time [s],x [mm],F [N]", *rows[:29], end]))
    record = it.read_record(tmp_path / "a.csv")
    assert record.time.size == 29
    assert f'The last line, "{end}", was left out: the file ends within it.' in record.notes
    (tmp_path / "b.csv").write_text("\n".join(["time [s],x [mm],F [N]", *rows]))  # whole, without a last line end
    assert it.read_record(tmp_path / "b.csv").time.size == 30
