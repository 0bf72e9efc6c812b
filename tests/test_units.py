"""Quantities as text: what they are worth, what is refused, and that they survive the way there and back."""

import importlib
import math
import re
import subprocess
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st

from inerter import units
from inerter.errors import UnitError
from inerter.frequent_units import FREQUENT
from inerter.networks.elements.registry import kinds_by_unit, parse_element
from inerter.units import parse_one_of, parse_quantity, quote_value

UNITS = (*kinds_by_unit(), "kg m^2", "m/s", "m^3/cycle", "rad/s")


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("120 kN/m", "N/m", 120e3),
        ("120kN/m", "N/m", 120e3),
        (" 120  kN / m ", "N/m", 120e3),
        ("120 N/mm", "N/m", 120e3),
        ("1.2e5 N m^-1", "N/m", 120e3),
        ("3000 N s/m", "N s/m", 3000.0),
        ("3000 N*s/m", "N s/m", 3000.0),
        ("3 kN·s/m", "N s/m", 3000.0),
        ("3000 kg/s", "N s/m", 3000.0),
        ("0.3 t", "kg", 300.0),
        ("250 g", "kg", 0.25),
        ("0.3 mm", "m", 0.0003),
        ("90 km/h", "m/s", 25.0),
        ("200 kg m^2", "kg m^2", 200.0),
        ("200 kg m²", "kg m^2", 200.0),
        ("5e-7 m^3/cycle", "m^3/cycle", 5e-7),
        ("6.28 rad/s", "rad/s", 6.28),
        ("-10 N", "N", -10.0),
        ("+.5 N", "N", 0.5),
    ],
)
def test_quantity(text, unit, value):
    assert parse_quantity(text, unit) == value


def test_imperial_units_by_their_definitions():
    pound_force = 0.45359237 * 9.80665  # exact: international pound and standard gravity
    assert parse_quantity("10 lbf/in", "N/m") == pytest.approx(10 * pound_force / 0.0254, rel=1e-12)


def test_powers_of_prefixes():
    assert parse_quantity("500 mm^3/cycle", "m^3/cycle") == pytest.approx(5e-7, rel=1e-14)


DENSITY = "(m/s^2)^2/Hz"


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("2 (m/s^2)^2/Hz", DENSITY, 2.0),
        ("2 m^2/s^4/Hz", DENSITY, 2.0),
        ("2 (mm/s²)²/Hz", DENSITY, 2e-6),
        ("2 (m/s^2)**2/kHz", DENSITY, 2e-3),
        ("2 m^2/s^3/rad", DENSITY, 4.0 * math.pi),  # per rad/s: 2 pi of them in a hertz
        ("2 N^2 s/rad", "N^2/Hz", 4.0 * math.pi),
        ("2 kN^2/Hz", "N^2/Hz", 2e6),
        ("2 (N m)^2/Hz", "(N m)^2/Hz", 2.0),
    ],
)
def test_densities_are_per_hertz_or_per_radian(text, unit, value):
    assert parse_quantity(text, unit) == pytest.approx(value, rel=1e-14)
    assert parse_one_of(text, {"N": "", unit: ""}, unit) == (unit, pytest.approx(value, rel=1e-14))


@pytest.mark.parametrize("text", ["1 m^2/s^3", "1 (m/s^2)^2 s", "1 N^2 s", "1 (N m)^2 s"])
def test_a_density_that_may_be_either_is_refused(text):
    unit = {"m": DENSITY, "(m": DENSITY, "N": "N^2/Hz", "(N": "(N m)^2/Hz"}[re.split(r"[ ^/]", text)[1]]
    for read in (parse_quantity, lambda text, unit: parse_one_of(text, {unit: ""}, unit)):
        with pytest.raises(UnitError, match="ambiguous density, per Hz or per rad/s"):
            read(text, unit)


@pytest.mark.parametrize(
    ("text", "unit", "expected"),
    [
        ("3 dB", "", "a ratio without a unit: 20 dB is 10 times an amplitude, and 100 times a power"),
        ("3 dB", "1", "a ratio without a unit"),
        ("3 Np", "1", "a ratio without a unit"),
        ("3 octave", "1", "a ratio without a unit"),
        ("0 dBm", "W", 'a number with a unit of W, such as "120 W"'),
        ("20 degC", "K", 'a number with a unit of K, such as "120 K"'),
    ],
)
def test_a_unit_of_which_twice_the_number_is_not_twice_the_quantity_is_refused(text, unit, expected):
    for read in (parse_quantity, lambda text, unit: parse_one_of(text, {unit: ""}, unit)):
        with pytest.raises(UnitError, match=f"is a logarithmic unit, or one with another zero; expected {expected}"):
            read(text, unit)


@pytest.mark.parametrize("text", ["1 ((m)^9)^9 N", "1 ((km^9)^9)^9/m N"])
def test_a_power_of_a_power_of_a_bracket_is_no_unit(text):
    with pytest.raises(UnitError, match="unknown unit"):
        parse_quantity(text, "N")


def test_a_number_beyond_all_is_told():
    for text in ("1 (Ym^9)^9/(ym^9)^9 N", "1 (ym^9)^9/(Ym^9)^9 N"):
        with pytest.raises(UnitError, match="too large a number"):
            parse_quantity(text, "N")


def test_a_hertz_is_two_pi_radians_per_second():
    assert parse_quantity("1 Hz", "rad/s") == pytest.approx(2 * math.pi, rel=1e-15)


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("120 kN/m", "N/m", 120e3),
        ("3.2 kN s/m", "N s/m", 3200.0),
        ("0.3 t", "kg", 300.0),
        ("1 kgf", "N", 9.80665),
        ("0.1 mm", "m", 1e-4),
    ],
)
def test_the_unit_tells_the_element(text, unit, value):
    assert parse_element(text) == (unit, value)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("120", ("unit missing", '"120 N/m"')),
        ("120 kN", ("incompatible unit", "kilonewton", '"120 kN/m"')),
        ("10 kn/m", ("knot", "N/m")),
        ("10 KN/m", ("unknown unit", "case-sensitive")),
        ("10 foo", ("unknown unit", '"foo"')),
        ("5 kNs/m", ("unknown unit", "space", '"5 N/m"')),
        ("N/m", ("begin with a number",)),
        ("", ("begin with a number",)),
        ("stiff", ("begin with a number",)),
        ("1,5 N/m", ("comma", "point")),
        ("1_000 N/m", ("separators", '"1000 N/m"')),
        ("1 250 000 N/m", ("separators", '"1250000 N/m"')),
        ("60'000.5 N/m", ("separators", '"60000.5 N/m"')),
        ("60\u202f000", ("separators",)),
        ("60 000 stiff", ("separators",)),
        ("nan N/m", ("not a finite number",)),
        ("-inf N/m", ("not a finite number",)),
        ("Infinity N/m", ("not a finite number",)),
        ("1e400 N/m", ("too large",)),
        ("1e308 GN/m", ("too large",)),
        ("5 degC", ("incompatible unit",)),
        ("5 N/m/deg", ("incompatible unit",)),
        ("5 N rad/m", ("incompatible unit",)),
        ("5 dBm", ("incompatible unit",)),
        ("5 N/m)", ("unknown unit",)),
        ("5 N/m*", ("unknown unit",)),
        ("5 m^9^9^9^9", ("unknown unit",)),
        ("5 __import__('os')", ("unknown unit",)),
        ("5 " + "(" * 5000, ("unknown unit",)),
        ("5\nN\n/m\nx", ("unknown unit", r"\n")),
        (120, ("unit missing", '"120 N/m"')),
        (10**400, ("unit missing",)),
        (True, ("not a quantity", "true")),
        (None, ("not a quantity",)),
        (["120 N/m"], ("not a quantity", "a list")),
        ({"from": "1 N/m"}, ("not a quantity", "a table")),
    ],
)
def test_what_is_not_a_stiffness_is_refused_in_one_sentence(text, words):
    with pytest.raises(UnitError) as caught:
        parse_quantity(text, "N/m")
    message = str(caught.value)
    assert all(word in message for word in (*words, "expected", "such as"))
    assert "\n" not in message
    assert len(message) < 300


@pytest.mark.parametrize(
    ("text", "unit", "meant"),
    [
        ("5 kNs/m", "N s/m", "5 kN s/m"),
        ("1400 kgm^2", "kg m^2", "1400 kg m^2"),
        ("7 Ns/mm", "N s/m", "7 N s/mm"),
        ("5 kNm", "N m", "5 kN m"),
        ("1222 kg m2", "kg m^2", "1222 kg m^2"),
        ("2 g/cm3", "kg/m^3", "2 g/cm^3"),
        ("90 kmh", "m/s", "90 km/h"),
        ("90 Km/H", "m/s", "90 km/h"),
        ("250 KG", "kg", "250 kg"),
        ("10 KN/m", "N/m", "10 kN/m"),
        ("3 HZ", "Hz", "3 Hz"),
    ],
)
def test_a_usual_spelling_that_is_no_unit_is_proposed_as_one_and_with_its_prefix(
    text: str, unit: str, meant: str
) -> None:
    with pytest.raises(UnitError, match=re.escape(f'such as "{meant}"')):
        parse_quantity(text, unit)
    assert parse_quantity(meant, unit) > 0.0


@pytest.mark.parametrize(("at_n0", "at_omega0"), [(16, 1), (64, 4), (256, 16), (1024, 64), (4096, 256), (16384, 1024)])
def test_a_roughness_is_given_as_the_standard_gives_it(at_n0, at_omega0):
    """Geometric means of the classes of ISO 8608, Tables C.1 and C.2, [1e-6 m^3]; those of C.2 are rounded."""
    kappa = parse_quantity(f"{at_n0}e-6 m^3", "m^3/cycle")
    assert kappa == pytest.approx(0.5 * at_n0 * 1e-6 * 0.1**2)
    assert parse_quantity(f"{at_n0 * 1e3} mm^3 ", "m^3/cycle") == pytest.approx(kappa)
    assert parse_quantity(f"{at_omega0}e-6 m^3/rad", "m^3/cycle") == pytest.approx(kappa, rel=0.02)
    assert parse_quantity(f"{kappa!r} m^3/cycle", "m^3/cycle") == kappa


def test_what_is_no_roughness_is_refused():
    for text in ("5e-7 m^2", "5e-7 m^2/cycle", "5e-7 m/cycle", "16e-6 m^3 rad", "16e-6 m^3/deg", "1e-6 m^3/turn"):
        with pytest.raises(UnitError, match="incompatible unit"):
            parse_quantity(text, "m^3/cycle")


@pytest.mark.parametrize("given", ["256e-6", 256e-6, "256e-6 m^2", "0.000256 kg"])
def test_a_refused_roughness_is_never_answered_by_a_rougher_one(given):
    """The form that a message recommends is that of class C, whatever number was given."""
    with pytest.raises(UnitError, match=r'such as "256e-6 m\^3"\.$'):
        parse_quantity(given, "m^3/cycle")


@pytest.mark.parametrize(
    ("text", "unit"),
    [("1 kg/deg", "kg"), ("1 kg m^2/rad", "kg m^2"), ("3 kN/turn", "N"), ("5 m/s/rad", "m/s"), ("3 deg", "1")],
)
def test_an_angle_is_no_number(text, unit):
    with pytest.raises(UnitError, match=r"incompatible unit .*; expected a number with a unit of"):
        parse_quantity(text, unit)
    with pytest.raises(UnitError, match="is not the unit of any element"):
        parse_element(text)


def test_a_mass_in_carats_is_a_misspelt_one():
    with pytest.raises(UnitError, match=r'^Got "1 ct": unknown unit "ct" .*; expected a number with a unit of kg'):
        parse_quantity("1 ct", "kg")


def test_an_angular_frequency_in_cycles_is_not_taken_for_radians():
    with pytest.raises(UnitError, match="incompatible unit"):
        parse_quantity("1 cycle/s", "rad/s")


@pytest.mark.parametrize("text", ["1 m/s", "1 N m", "1 kg m^2", "1 rad", "1 percent"])
def test_the_unit_of_no_element_is_refused_with_all_five(text):
    with pytest.raises(UnitError) as caught:
        parse_element(text)
    assert all(f"{unit} ({kind.key}" in str(caught.value) for unit, kind in kinds_by_unit().items())


@given(st.floats(allow_nan=False, allow_infinity=False), st.sampled_from(UNITS))
def test_si_text_reads_back_to_the_last_bit(value, unit):
    assert parse_quantity(f"{value!r} {unit}", unit) == value


@pytest.mark.parametrize("unit", ["", "1", "%", "m", "m^2", "N m", "Hz", "N^2/Hz", *UNITS])
def test_a_quantity_of_any_unit_is_read_or_refused_where_another_is_expected(unit):
    for other in " % k M m mm km/h kN/m MN/m kN kg t deg Hz m^3/cycle".split(" "):
        text, refused = f"3 {other}".strip(), ""
        try:
            assert math.isfinite(parse_quantity(text, unit))
        except UnitError as error:
            refused = str(error)
        assert not refused or text in refused


@given(st.text(max_size=30), st.sampled_from(UNITS))
def test_any_text_is_a_number_or_a_unit_error(text, unit):
    for candidate in (text, "1 " + text):
        try:
            value = parse_quantity(candidate, unit)
        except UnitError:
            continue
        assert math.isfinite(value)


@pytest.mark.parametrize("value", ["x" * 500, 10**400, "a\nb\x7f\x85\u2028", '"' * 500])
def test_shown_is_one_short_line(value):
    assert len(quote_value(value)) < 70
    assert len(quote_value(value).splitlines()) == 1


def test_pint_is_loaded_by_the_first_unit_that_is_not_frequent():
    before, after = (f"assert 'pint' {state} sys.modules" for state in ("not in", "in"))
    frequent, other = (f"inerter.units.parse_quantity('1 {unit}', 'N')" for unit in ("kN", "lbf"))
    code = f"import sys, inerter.units; {frequent}; {before}; {other}; {after}"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("100 lbm", "kg", 45.359237),
        ("1 lbf/in", "N/m", 4.4482216152605 / 0.0254),
        ("600 lbf/in", "N/m", 600 * 4.4482216152605 / 0.0254),
        ("10 lbf s/in", "N s/m", 10 * 4.4482216152605 / 0.0254),
        ("10 lbf*s/in", "N s/m", 10 * 4.4482216152605 / 0.0254),
        ("20 in/s", "m/s", 0.508),
        ("2 in", "m", 0.0508),
        ("65 mph", "m/s", 65 * 1609.344 / 3600),
        ("1 slug", "kg", 4.4482216152605 / 0.3048),
    ],
)
def test_units_of_the_trade(text, unit, value):
    """From their definitions: a pound is 0.45359237 kg, an inch 0.0254 m, standard gravity 9.80665 m/s^2."""
    assert parse_quantity(text, unit) == pytest.approx(value, rel=1e-14)


@pytest.mark.parametrize(
    ("text", "unit", "meant"),
    [
        ("600 lb/in", "N/m", "600 lbf/in"),
        ("600 lbs/in", "N/m", "600 lbf/in"),
        ("600 lbm/in", "N/m", "600 lbf/in"),
        ("5 lb s/in", "N s/m", "5 lbf s/in"),
        ("2 kg/mm", "N/m", "2 kgf/mm"),
    ],
)
def test_a_mass_where_a_force_is_meant(text, unit, meant):
    with pytest.raises(UnitError, match=f'such as "{re.escape(meant)}"'):
        parse_quantity(text, unit)
    with pytest.raises(UnitError, match=f'Did you mean "{re.escape(meant)}"'):
        parse_one_of(text, {"N/m": "spring", "N s/m": "damper"}, "N/m")
    assert parse_quantity(meant, unit) > 0.0


@pytest.mark.parametrize("unit", FREQUENT)
def test_frequent_units_are_those_of_pint(unit: str) -> None:
    """Factors to the last digit; and two of them are of one kind for pint where they are in the table."""
    registry, (base, up, down) = units._registry(), FREQUENT[unit]
    one, other = registry.parse_units(unit), registry.parse_units(base)
    assert (registry.convert(1.0, one, other), registry.convert(1.0, other, one)) == (up, down)
    for name, (others, _, _) in FREQUENT.items():
        assert (registry.parse_units(name).dimensionality == one.dimensionality) == (others == base), name


def test_a_number_without_unit_is_compared_without_the_library_of_units(monkeypatch):
    units._dimension.cache_clear()
    monkeypatch.setattr(units, "_registry", None)
    assert not units.are_compatible("mm", units.PURE)
    assert units.are_compatible(units.PURE, units.PURE)


def test_a_library_that_is_half_imported_by_another_thread_makes_no_unit_unknown(monkeypatch):
    """As pint while another thread imports dask: Python raises once."""
    faults = [ImportError("cannot import name 'annotate' from partially initialized module 'dask.base'")]

    def half_imported(name):
        if faults:
            raise faults.pop()
        return importlib.import_module(name)

    monkeypatch.setattr(units, "import_module", half_imported)
    monkeypatch.setattr(units, "_PAUSE", 0.0)
    units._registry.cache_clear()
    assert units.is_unit("(m/s^2)^2/min")
    assert not faults
    faults += [ImportError("no pint")] * 9
    units._registry.cache_clear()
    with pytest.raises(ImportError):
        units.is_unit("(m/s^2)^2/h")
    faults.clear()
    units._registry.cache_clear()


@pytest.mark.parametrize(("given", "meant"), [("g", "gravity"), ("gal", "Gal"), ("g_n", "gravity"), ("N", "m/s^2")])
def test_an_acceleration_in_grams_or_gallons_is_told_what_is_meant(given, meant):
    with pytest.raises(UnitError, match=f'such as "0.3 {re.escape(meant)}"'):
        parse_quantity(f"0.3 {given}", "m/s^2")
    assert parse_quantity("2 gravity", "m/s^2") == 2.0 * 9.80665
    assert parse_quantity("2 Gal", "m/s^2") == 0.02
