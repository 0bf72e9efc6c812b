"""Tables of excitations: what a search would tabulate again for each design is kept."""

import numpy as np

from inerter.methods.excitation import ExcitedInputs, NoiseExcitation


def test_noise_of_thousands_of_samples_on_two_axles_is_tabulated_once():
    drive = ExcitedInputs(NoiseExcitation(period=30.0), 1e-3, (0.0, 0.0816, None, None))
    table, power = drive.realisation(3)
    again, same_power = drive.realisation(3)
    assert again is table
    assert same_power is power
    assert not np.array_equal(drive.realisation(4)[0].value, table.value)


def test_a_repeated_period_of_held_noise_keeps_one_array_of_slopes():
    table, _ = ExcitedInputs(NoiseExcitation(period=0.1), 1e-3, (0.0, None)).realisation(0)
    assert table.slope_before is table.slope
    assert np.array_equal(table.value_before[0], table.value_before[-1])
    assert not np.array_equal(table.value_before, table.value)
