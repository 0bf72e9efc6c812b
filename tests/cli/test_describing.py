"""What tells of files: `inerter explain`, of every key of every kind."""

import tomllib

import pytest

from inerter.cli.main import call
from inerter.files.common.keys import ANY_NAME, find_keys, keys_of, keys_of_files
from inerter.files.common.kinds import kinds
from inerter.files.study import KIND
from inerter.indices.registry import INDICES

KEYS = keys_of_files()
PLACES = list(dict.fromkeys(key.place for key in KEYS))
OF_STUDIES = keys_of(KIND.schema())


def told(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    assert call(["explain", *arguments]) == 0
    out = capsys.readouterr().out
    assert all(len(line) <= 80 and line == line.rstrip() for line in out.split("\n"))
    return out


def words(text: str) -> str:
    return " ".join(text.split())


def test_every_key_is_told_by_its_place_and_by_its_end(capsys):
    assert len(PLACES) > 40
    for place in PLACES:
        out = told(capsys, place.replace(ANY_NAME, "front_spring"))
        for key in KEYS:
            if key.place == place:
                assert key.sentence in words(out)
                assert key.unit in out
        assert "(," not in out
        assert "()" not in out
        name = place.rpartition(".")[2]
        if name != ANY_NAME:
            assert place in {key.place for key in find_keys(KEYS, name)}


def test_an_example_is_a_line_of_the_file(capsys):
    lines = [line for place in PLACES for line in told(capsys, place).split("\n") if line.startswith("  example  ")]
    assert len(lines) > 30
    for line in lines:
        assert tomllib.loads(line.removeprefix("  example  ").partition("    in [")[0])


def test_keys_of_conditions_and_limits_are_told(capsys):
    assert "Share of the operating time" in told(capsys, "conditions.share")
    assert 'example  name = "loaded"    in [[conditions]]' in told(capsys, "conditions.name")
    assert told(capsys, "study.subject_to.suspension-travel").startswith("study.subject_to.NAME: Limit of an index")
    assert 'S3 = "' in told(capsys, "layouts.S1")


def test_a_key_that_others_may_replace_is_told_with_them(capsys):
    """As `inerter check` says of a file that has none of them."""
    text = told(capsys, "road.roughness")
    assert 'default  none: required, or class = "C", or profile = "road.csv"' in text
    assert "none: required\n" in told(capsys, "road.speed")


def test_all_keys_in_a_table(capsys):
    """The bounds of a quantity that may be free are a mark beside its unit; those of a range alone are rows."""
    out = told(capsys)
    rows = [line.split() for line in out.partition("\n\n")[0].split("\n")[1:] if line[:1].strip()]
    assert words(out).endswith(": record, model, fit, signal, rig, simulation")
    marked = {row[0] for row in rows if "*" in row}
    units = {key.place: key.unit for key in OF_STUDIES}
    bounds = [place for place in units if place.endswith((".from", ".to")) and units.get(place.rpartition(".")[0])]
    assert {place.rpartition(".")[0] for place in bounds} == marked
    assert "vehicle.sprung_mass" in marked
    assert [row[0] for row in rows] == [place for place in units if place not in bounds]
    assert "\n* or a table of bounds, from and to: a design variable\n" in out
    for key in OF_STUDIES:
        assert key.place in bounds or key.sentence in words(out)


def test_every_section_of_every_kind_of_file_is_told(capsys):
    sections = {kind.plural: kind.schema()["properties"] for kind in kinds()}
    for section in {name for own in sections.values() for name in own}:
        text = told(capsys, section)
        having = [plural for plural, own in sections.items() if section in own]
        assert ("\n  in  " in text) == (KIND.plural not in having)
        assert KIND.plural in having or all(plural in words(text) for plural in having)


def test_a_key_of_a_simulation_is_told_with_its_kinds_and_units(capsys):
    text = told(capsys, "signal.amplitude")
    assert text.count("signal.amplitude (sine, cosine, chirp): Amplitude.") == 1
    assert "  in       rig files and simulation files\n  unit     m or N or N m or m/s^2\n" in text
    assert "simulation.step: " in told(capsys, "step")


def test_a_section_is_told_with_its_keys(capsys):
    out = told(capsys, "road")
    assert "road.speed" in out
    assert "m/s" in out
    assert "study.seed" not in out


@pytest.mark.parametrize("word", [*INDICES, "norm", "half-car", "spring"])
def test_words_that_keys_take_are_told_too(word, capsys):
    out = told(capsys, word)
    assert out.startswith(f"{word} (")
    assert f"{word}:" not in out


@pytest.mark.parametrize(
    ("key", "said"),
    [
        ("road.sped", 'Did you mean "road.speed"?'),
        ("spedd", 'Did you mean "speed"?'),
        ("sprung_mas", 'Did you mean "sprung_mass"?'),
        ("tyre", "Keys that mention it: vehicle.tyre_stiffness"),
        ("tire", "Keys that mention it: vehicle.tyre_stiffness"),
        ("xyz.abc", "inerter explain"),
        ("", "inerter explain"),
        ("...", "inerter explain"),
        ("simulation.stp", 'Did you mean "simulation.step"?'),
        ("study.forse", 'Did you mean "study.force"?'),
        ("NAME", "inerter explain"),
    ],
)
def test_a_key_that_there_is_not(key, said, capsys):
    assert call(["explain", key]) == 2
    error = capsys.readouterr().err
    assert error.startswith("inerter: ")
    assert said in error
    assert error.count("\n") == 1
