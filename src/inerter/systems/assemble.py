"""`state_space`: from a vehicle without free values to its linear system."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from inerter.errors import LinearSystemError
from inerter.systems.descriptor import close, describe
from inerter.systems.linear import LinearSystem, check_names
from inerter.vehicle.vehicle import Vehicle, check_fixed, check_vehicle


def state_space(
    vehicle: Vehicle, inputs: Sequence[str] | str | None = None, outputs: Sequence[str] | str | None = None
) -> LinearSystem:
    """State matrices of a vehicle, with road velocities [m/s] and external forces [N] as inputs.

    States are node velocities and spring elongations. Outputs are `<coordinate>_velocity`, `_acceleration` and
    `_displacement`, `<strut>_force` and `_travel`, `<tyre>_load` and `_deflection`, in SI units. By default all
    inputs, and every output that needs no further state: a displacement above a moving road drifts with the road, and
    comes only when it is named.

    Raises `DesignError` if a value is free, `MechanismError` if the mechanism is ill-posed, `LinearSystemError` for
    an input or output that is not there, or where rounding leaves nothing of the matrices.

    >>> import inerter as it
    >>> system = it.state_space(it.QuarterCar(250.0, 35.0, 180e3, it.Spring(20e3)), "road", "sprung_acceleration")
    >>> system.A.shape, system.inputs, system.outputs
    ((4, 4), ('road',), ('sprung_acceleration',))
    """
    check_vehicle(vehicle)
    mechanism = vehicle.mechanism()
    check_fixed(mechanism)
    inputs = None if inputs is None else check_names("inputs", inputs)
    outputs = None if outputs is None else check_names("outputs", outputs)
    descriptor = describe(mechanism, inputs, outputs)
    if descriptor.precision_warning:
        raise LinearSystemError(
            f"{descriptor.precision_warning} Indices do not need these matrices: evaluate(...) gives them."
        )
    system = close(descriptor, {})
    if system.fine is not None and not np.all(np.isfinite(system.fine.errors[0])):
        raise LinearSystemError(
            "The values of this mechanism lie so far apart that no digit of its matrices is certain. Its indices do "
            "not need them: evaluate(...) gives them all the same."
        )
    return system
