"""Conversion factors of frequent units: with them, most quantities are read without loading pint.

Each number is that of pint's registry (tests/test_units.py compares them).
"""

FREQUENT: dict[str, tuple[str, float, float]] = {  # by unit: SI unit, SI units in one of it, and one SI unit in it
    **{
        unit: (unit, 1.0, 1.0)
        for unit in ("kg", "kg m^2", "m", "m/s", "m/s^2", "m^3", "m^3/cycle", "cycle/m", "s", "Hz")
    },
    **{unit: (unit, 1.0, 1.0) for unit in ("N", "N/m", "N s/m")},
    "": ("", 1.0, 1.0),  # of a dimensionless number
    "g": ("kg", 0.001, 1000.0),
    "t": ("kg", 1000.0, 0.001),
    "mm": ("m", 0.001, 1000.0),
    "um": ("m", 1e-06, 1000000.0),
    "km/h": ("m/s", 0.2777777777777778, 3.6),
    "ms": ("s", 0.001, 1000.0),
    "us": ("s", 1e-06, 1000000.0),
    "kN": ("N", 1000.0, 0.001),
    "kN/m": ("N/m", 1000.0, 0.001),
    "MN/m": ("N/m", 1000000.0, 1e-06),
    "kN s/m": ("N s/m", 1000.0, 0.001),
    "MN s/m": ("N s/m", 1000000.0, 1e-06),
}
