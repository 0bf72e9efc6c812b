"""`inerter rig` as a person meets it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from folders import EXAMPLES

import inerter as it
from inerter.cli.main import call
from inerter.files.rig.loading import load_rig

SHORT = (
    (EXAMPLES / "rig_friction.toml")
    .read_text(encoding="utf-8")
    .replace('"30 s"', '"0.5 s"')
    .replace('"0.1 Hz"', '"4 Hz"')
)


@pytest.fixture
def config(tmp_path: Path) -> Path:
    path = tmp_path / "short.toml"
    path.write_text(SHORT, encoding="utf-8")
    return path


@pytest.mark.parametrize("suffix", [".csv", ".tdms", ".mf4", ".mat"])
def test_every_format_holds_what_the_rig_reads(
    suffix: str, config: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / f"bench{suffix}"
    assert call(["rig", str(config), "-o", str(file)]) == 0
    out, err = capsys.readouterr()
    assert "101 samples over 0.5 s, at 200 Hz" in out
    assert "not saturated" in out
    assert max(map(len, out.splitlines())) <= 80
    assert str(file) in err
    truth, found = load_rig(config).run(), it.read_record(file)
    assert np.allclose(found.force, truth.force, rtol=0.0, atol=1e-9)
    assert np.allclose(found.displacement, truth.displacement, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("name", ["rig_friction", "rig_fit"])
def test_examples_are_the_experiments_of_the_paper(name: str) -> None:
    request = load_rig(EXAMPLES / f"{name}.toml")
    elements = {e.label: e.value for e in request.rig.device.elements()}
    inertance, frequency = {"rig_friction": (5.0, 0.1), "rig_fit": (113.0, 3.0)}[name]
    assert elements == {"ks": 1e6, "cs": 3200.0, "b": inertance, "f": 10.0}
    assert request.signal.make().period == pytest.approx(1.0 / frequency)
    assert request.rig.force_range == pytest.approx(980.665)


def test_friction_is_the_level_of_the_square_wave() -> None:
    record = load_rig(EXAMPLES / "rig_friction.toml").run()
    level = np.median(np.abs(record.force[np.abs(np.gradient(record.displacement, record.time)) > 1e-4]))
    assert level == pytest.approx(10.0, rel=0.02)


def test_a_load_cell_at_its_limit_is_told(config: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    config.write_text(SHORT.replace('"100 kgf"', '"5 N"'), encoding="utf-8")
    assert call(["rig", str(config), "-o", str(tmp_path / "bench.csv")]) == 0
    assert "saturated in" in capsys.readouterr().out


BAD = {
    "unit": (('"30 s"', '"30 m"'), "rig.duration"),
    "kind of signal": (('"cosine"', '"cosinus"'), "signal.kind"),
    "road": (('kind = "cosine"\namplitude = "1 mm"\nfrequency = "4 Hz"', 'kind = "multisine"'), "shape of a road"),
    "input": (('kind = "cosine"', 'kind = "cosine"\ninput = "road"'), "signal.input"),
    "element": (('"(ks | cs) - (b | f)"', '"(ks | cs) - (b | g)"'), "layouts.screw"),
    "range of a value": (('"5 kg" ', '{ from = "1 kg", to = "9 kg" } '), "elements.b"),
    "key": (("force_noise", "force_nois"), "rig.force_nois"),
    "rate": (('"200 Hz"', '"0 Hz"'), "rig.sampling"),
    "noise": (('"0.2 um"', '"-0.2 um"'), "negative"),
    "too short": (('"0.5 s"', '"1 ms"'), "less than 4 samples"),
    "stuck": (('"(ks | cs) - (b | f)"', '"b | f"'), "not determined"),
    "no rig": (("[rig]", "[sensors]"), "rig: missing"),
    "no device": (('screw = "(ks | cs) - (b | f)"', ""), "layouts"),
}


@pytest.mark.parametrize(("change", "words"), BAD.values(), ids=BAD)
def test_what_is_wrong_is_said(
    change: tuple[str, str], words: str, config: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = SHORT.replace('"0.5 s"', '"30 s"') if change[0] == '"30 s"' else SHORT
    assert change[0] in text
    config.write_text(text.replace(*change), encoding="utf-8")
    assert call(["rig", str(config), "-o", str(tmp_path / "bench.csv")]) == 2
    err = capsys.readouterr().err
    assert words in err
    assert err.startswith("inerter: short.toml: ")
    assert "Traceback" not in err
    assert not (tmp_path / "bench.csv").exists()


def test_only_a_record_of_its_own_is_replaced(config: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "bench.csv"
    assert call(["rig", str(config), "-o", str(file)]) == 0
    assert call(["rig", str(config), "-o", str(file)]) == 2
    assert "Replace it with --force" in capsys.readouterr().err
    assert call(["rig", str(config), "-o", str(file), "--force"]) == 0
    file.write_text("measured")
    for options in ([], ["--force"]):
        assert call(["rig", str(config), "-o", str(file), *options]) == 2
        message = capsys.readouterr().err
        assert "was not replaced" in message
        assert "--force" not in message
    assert file.read_text() == "measured"


def test_a_record_never_replaces_what_it_is_made_from(
    config: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    other = tmp_path / "config.txt"
    other.hardlink_to(config)
    assert call(["rig", str(config), "-o", str(other), "--force"]) == 2
    assert "was not replaced" in capsys.readouterr().err
    assert config.read_text(encoding="utf-8") == other.read_text(encoding="utf-8") == SHORT


def test_a_suffix_and_a_folder_are_needed(config: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = sorted(tmp_path.rglob("*"))
    for name, words in (
        ("bench.xlsx", ".tdms"),
        ("no/bench.csv", "folder not found"),
        ("", "is a folder"),
    ):
        assert call(["rig", str(config), "-o", str(tmp_path / name)]) == 2
        assert words in capsys.readouterr().err
    assert sorted(tmp_path.rglob("*")) == before
