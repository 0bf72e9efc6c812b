"""Numbers of enormous and tiny size in study files: refused in one sentence, or run to their end."""

from __future__ import annotations

import numpy as np
import pytest
from campaigns import sampled
from folders import EXAMPLES

from inerter.cli.main import call
from inerter.formatting import format_percent

QUARTER = (EXAMPLES / "quarter-car.toml").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("181.75 kg", "3.2e152 kg", "vehicle.sprung_mass"),
        ("181.75 kg", "1e-80 kg", "vehicle.sprung_mass"),
        ("5e-7 m^3/cycle", "1e90 m^3/cycle", "road.roughness"),
        ('k = "120 kN/m"', 'k = "1e60 N/m"', "elements.k"),
        ('from = "1 kg", to = "2000 kg"', 'from = "1e-300 kg", to = "1e300 kg"', "elements.b"),
        ('from = "1 kg", to = "2000 kg"', 'from = "1e-20 kg", to = "1e20 kg"', "wider than a search can cover"),
    ],
)
def test_what_nothing_has_is_one_sentence(tmp_path, capsys, old, new, said):
    assert old in QUARTER
    path = tmp_path / "study.toml"
    path.write_text(QUARTER.replace(old, new), encoding="utf-8")
    for command in (["check"], ["run", "-o", str(tmp_path / "results")]):
        assert call([command[0], str(path), *command[1:]]) == 2
        assert said in capsys.readouterr().err


def test_percentages_stay_short():
    for value in (1e7, -3.2e154, 1e300):
        assert len(format_percent(value)) < 16
        assert float(format_percent(value).rstrip("% ")) == pytest.approx(value, rel=5e-3)
    assert format_percent(18.73) == "+18.7 %"
    assert format_percent(np.inf) == "+inf %"


@pytest.mark.parametrize("seed", sampled(range(12), often=[0, 10], kept=0))
def test_valid_extremes_run_to_their_end(tmp_path, capsys, seed):
    """Masses, stiffnesses and roads over forty decades: a result of 80 columns or so, or one sentence."""
    rng = np.random.default_rng([seed, 17])
    text = QUARTER.replace('indices = ["J1", "J3", "J5"]', f'indices = ["{["J1", "J3", "J5"][seed % 3]}"]')
    for number in ("181.75 kg", "25 kg", "5e-7 m^3/cycle"):
        size = 10.0 ** rng.uniform(-20.0, 20.0)
        text = text.replace(f'"{number}"', f'"{size:.6e} {number.partition(" ")[2]}"')
    path = tmp_path / "study.toml"
    path.write_text(text, encoding="utf-8")
    assert call(["check", str(path)]) == 0
    code = call(["run", str(path), "-o", str(tmp_path / "results")])
    found = capsys.readouterr()
    assert code in (0, 1)
    assert "Traceback" not in found.err
    assert (tmp_path / "results" / "report.html").exists()


def test_a_new_file_replaces_its_own_kind_alone(tmp_path):
    path = tmp_path / "car.toml"
    assert call(["new", "-o", str(path)]) == 0
    first = path.read_bytes()
    assert call(["new", "half-car", "-o", str(path)]) == 2
    assert path.read_bytes() == first
    assert call(["new", "half-car", "-o", str(path), "--force"]) == 0
    assert b"half-car" in path.read_bytes()
    path.write_text("# mine", encoding="utf-8")
    assert call(["new", "-o", str(path), "--force"]) == 2
    assert path.read_text(encoding="utf-8") == "# mine"
