"""Base class of all elements: a value with a unit, a name, and its roles in analysis, simulation and drawing."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, ClassVar

import numpy as np

from inerter.errors import DesignError, NetworkError
from inerter.field_metadata import Field
from inerter.formatting import format_quantity, in_words
from inerter.networks.elements.algebra import Complex, Network
from inerter.networks.elements.drawing import BOX, SymbolLine
from inerter.networks.elements.roles import GuardRole, LinearRole, StatisticalRole, SwitchRole
from inerter.networks.elements.values import Free, Tied, Value, check_name
from inerter.validation import check_positive, in_message, is_number


class Element(Network):
    """Base of an element: one value with a unit, an optional name, and its roles.

    A kind of element is a frozen dataclass whose fields are its value, its further numbers (`more`), and `name`, in
    this order; its class attributes are its roles. A kind whose law is not in `LinearRole`, or whose modes are not
    those of a `SwitchRole`, overrides `as_linear` or `as_piecewise`.

    >>> import inerter as it
    >>> part = it.Spring(120e3, name="main")
    >>> isinstance(part, it.Element), part.label, part.value, part.unit
    (True, 'main', 120000.0, 'N/m')
    """

    # to the parser
    key: ClassVar[str]  # the kind in words
    symbol: ClassVar[str]
    quantity: ClassVar[str]
    unit: ClassVar[str]
    sentence: ClassVar[str]
    unit_note: ClassVar[str] = ""  # after the unit, where the value alone may be misread
    example: ClassVar[str]  # of a value with its unit
    more: ClassVar[tuple[Field, ...]] = ()  # further numbers, all positive
    # to analysis
    linear: ClassVar[LinearRole]
    switch: ClassVar[SwitchRole | None] = None
    statistical: ClassVar[StatisticalRole] = StatisticalRole.ITSELF
    effect: ClassVar[str] = ""  # effect neglected in linear analysis, such as "backlash"; default: the kind
    # to design
    may_vanish: ClassVar[bool] = False  # whether zero is allowed, as for a friction or a gap without effect
    tried: ClassVar[tuple[float, float] | None] = None  # search range of a break-even value if the value is zero
    # to the drawing
    drawing: ClassVar[tuple[SymbolLine, ...]] = BOX
    name: str | None

    def __post_init__(self) -> None:
        check_name(self.name)
        value = self.value
        if isinstance(value, Tied):
            self._check_more()
            return
        number = value.lower if isinstance(value, Free) else value
        what = f"{in_words(self.quantity).capitalize()}" + (f" of {self.name!r}" if self.name else "")
        if not is_number(number):
            raise NetworkError(
                f"{what} must be a finite number of {self.unit} or free(lower, upper), got {in_message(value)}."
            )
        if self.more:
            self._check_more()
        if isinstance(value, Free):
            if number == 0.0 and not self.may_vanish:
                raise NetworkError(
                    f"{what} must be positive, but its lower bound is 0 {self.unit}. Give a small positive bound; "
                    f"to leave the element out, drop its branch from the network."
                )
            return
        if number < 0.0 or (number == 0.0 and not self.may_vanish):
            raise NetworkError(
                f"{what} must be positive, got {self.symbol} = {format_quantity(number, self.unit)}. "
                f"To leave the element out, drop its branch from the network."
            )
        object.__setattr__(self, self.quantity, float(number))

    def _check_more(self) -> None:
        for field in self.more:
            number = getattr(self, field.name)
            check_positive(NetworkError, in_words(field.name).capitalize(), number, field.unit)

    @classmethod
    def fields(cls) -> tuple[Field, ...]:
        """Fields of the numbers of the element, the value first."""
        return (Field(cls.quantity, cls.unit, cls.sentence), *cls.more)

    @classmethod
    def of(cls, value: Value, name: str | None = None, **more: float) -> Element:
        """An element of this kind."""
        given: dict[str, Any] = {cls.quantity: value, "name": name, **more}
        return cls(**given)

    @property
    def value(self) -> Value:
        """Value of the element in SI units, or its `Free` or `Tied`."""
        return getattr(self, self.quantity)  # type: ignore[no-any-return]

    @property
    def gain(self) -> float:
        """Further factor in the law, such as the square of a transmission ratio."""
        return 1.0

    @property
    def coefficient(self) -> float:
        """The number in its law: a stiffness, damping, inertance, force or half-width.

        Raises `DesignError` if its value is free.
        """
        value = self.value
        if isinstance(value, Free | Tied):
            raise DesignError(f"The value of {self.label!r} is free. Fix it with with_values(...).")
        return value * self.gain

    @property
    def limits(self) -> tuple[float, float]:
        """Limits of force [N] or elongation [m] in the middle state of a switching element: minus and plus its value.

        A kind whose law differs by direction has others. An infinite limit is never reached; where both are equal, the
        force, or the length, is constant.
        """
        return -self.coefficient, self.coefficient

    def checked_limits(self) -> tuple[float, float]:
        """`limits`; raises `DesignError` if they are not ordered numbers."""
        lower, upper = self.limits
        if not (is_number(lower) or is_number(upper)) or not -np.inf <= lower <= upper <= np.inf:
            raise DesignError(
                f"{self.key.capitalize()} {self.label!r} switches at {lower} and {upper}; expected two numbers in "
                f"order, of which one may be infinite."
            )
        return lower, upper

    @property
    def even(self) -> bool:
        """Whether the limits are minus and plus the value, also while that is free."""
        return type(self).limits is Element.limits

    @property
    def is_damped(self) -> bool:
        """Whether statistical linearisation replaces it by a damper: dry friction equal in both directions."""
        return self.acts and self.even and self.statistical is StatisticalRole.DAMPER

    @property
    def acts(self) -> bool:
        """Whether it switches: its limits are apart or still free."""
        if self.switch is None or isinstance(self.value, Free | Tied):
            return self.switch is not None
        lower, upper = self.limits
        return lower < upper

    @property
    def possible(self) -> tuple[int, ...]:
        """Possible states of a switching element, the middle one first; only 1 if both limits are equal."""
        if not self.acts:
            return (1,)
        lower, upper = self.limits
        return (0, *((1,) if upper < np.inf else ()), *((-1,) if lower > -np.inf else ()))

    @property
    def always_holds(self) -> bool:
        """Whether a switching element holds against small forces: friction with a force, a closed gap."""
        if self.switches_by(GuardRole.FORCE):
            lower, upper = self.limits
            return lower < 0.0 < upper
        return not self.acts

    @property
    def role(self) -> tuple[bool, bool]:
        """Properties besides the kind on which the motions of a mechanism depend: whether it switches, and holds."""
        if self.even:
            return self.coefficient > 0.0, True  # as a friction or a gap of any size does
        return self.acts, self.always_holds

    def switches_by(self, guard: GuardRole) -> bool:
        """Whether it switches under this guard."""
        return self.switch is not None and self.switch.guard is guard

    @property
    def label(self) -> str:
        """Name of the element, else the name of its free value, else its symbol."""
        if self.name is not None:
            return self.name
        value = self.value
        return value.name if isinstance(value, Free) and value.name is not None else self.symbol

    def with_value(self, value: Value) -> Element:
        """Copy of the element with another value."""
        more = [getattr(self, field.name) for field in self.more] if self.more else []
        return type(self)(value, *more, self.name)  # type: ignore[call-arg]  # thrice as quick as `replace`

    def elements(self) -> Iterator[Element]:
        return iter((self,))

    def as_linear(self) -> Network:
        """Network that replaces the element in linear analysis, also where its value is free."""
        return self

    def as_piecewise(self) -> Network:
        """Network that replaces the element in simulation, of elements with linear or switching laws.

        Raises `DesignError` if its value is free but must not be.
        """
        return self

    @property
    def is_switching(self) -> bool:
        """Whether simulation uses the element itself."""
        return type(self).as_piecewise is Element.as_piecewise

    @property
    def plain(self) -> bool:
        """Whether its value is the only coefficient of its only law."""
        return self.gain == 1.0 and self.is_switching and type(self).as_linear is Element.as_linear

    def fraction(self, s: Complex) -> tuple[Complex, Complex]:
        view = self.as_linear()
        if view is not self:
            return view.fraction(s)
        zero, one = np.full_like(s, 0.0), np.full_like(s, 1.0)
        match self.linear:
            case LinearRole.STIFFNESS:
                return np.full_like(s, self.coefficient), s
            case LinearRole.DAMPING:
                return np.full_like(s, self.coefficient), one
            case LinearRole.MASS:
                return np.full_like(s, self.coefficient) * s, one
            case LinearRole.OPEN:
                return zero, one
            case LinearRole.CLOSED:
                return one, zero
