"""What all elements have in common: a value with a unit, a name, and the roles in which others meet them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, ClassVar

import numpy as np

from inerter.checks import is_number
from inerter.errors import DesignError, NetworkError
from inerter.fields import Field
from inerter.networks.elements.algebra import Complex, Network
from inerter.networks.elements.drawing import BOX, Line
from inerter.networks.elements.roles import Guard, Linear, Statistical, Switch
from inerter.networks.elements.values import Free, Tied, Value, check_name


class Element(Network):
    """One value with a unit, an optional name, and what it is to whom.

    A kind of element is a frozen dataclass whose fields are its value, what else it is made of (`more`), and `name`,
    in this order; its class attributes are its roles. A kind whose law is none of `Linear`, or whose modes are none of
    `Switch`, overrides `as_linear` or `as_piecewise`.
    """

    # to the parser
    key: ClassVar[str]  # the kind in words
    symbol: ClassVar[str]
    quantity: ClassVar[str]
    unit: ClassVar[str]
    sentence: ClassVar[str]
    example: ClassVar[str]  # of a value with its unit
    more: ClassVar[tuple[Field, ...]] = ()  # numbers beside the value, all positive
    # to analysis
    linear: ClassVar[Linear]
    switch: ClassVar[Switch | None] = None
    statistical: ClassVar[Statistical] = Statistical.ITSELF
    effect: ClassVar[str] = ""  # what linear analysis does not see of what switches, such as "play"; else the kind
    # to design
    may_vanish: ClassVar[bool] = False  # a friction or a gap of zero is an element that is not there
    tried: ClassVar[tuple[float, float] | None] = None  # where a budget is looked for if the value is zero
    # to the drawing
    drawing: ClassVar[tuple[Line, ...]] = BOX
    name: str | None

    def __post_init__(self) -> None:
        check_name(self.name)
        value = self.value
        if isinstance(value, Tied):
            self._check_more()
            return
        number = value.lower if isinstance(value, Free) else value
        what = f"{self.quantity.replace('_', ' ').capitalize()}" + (f" of {self.name!r}" if self.name else "")
        if not is_number(number):
            raise NetworkError(f"{what} must be a finite number of {self.unit} or free(lower, upper), got {value!r}.")
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
                f"{what} must be positive, got {self.symbol} = {number:g} {self.unit}. "
                f"To leave the element out, drop its branch from the network."
            )
        object.__setattr__(self, self.quantity, float(number))

    def _check_more(self) -> None:
        for field in self.more:
            number = getattr(self, field.name)
            if not is_number(number) or number <= 0.0:
                what = field.name.replace("_", " ").capitalize()
                raise NetworkError(f"{what} must be a positive number of {field.unit}, got {number!r}.")

    @classmethod
    def fields(cls) -> tuple[Field, ...]:
        """All numbers that it is made of, the value first."""
        return (Field(cls.quantity, cls.unit, cls.sentence), *cls.more)

    @classmethod
    def of(cls, value: Value, name: str | None = None, **more: float) -> Element:
        """An element of this kind."""
        given: dict[str, Any] = {cls.quantity: value, "name": name, **more}
        return cls(**given)

    @property
    def value(self) -> Value:
        """The element's one number, in SI units, or the `Free` or `Tied` that stands for it."""
        return getattr(self, self.quantity)  # type: ignore[no-any-return]

    @property
    def gain(self) -> float:
        """What its law multiplies beside the value, such as the square of a transmission."""
        return 1.0

    @property
    def coefficient(self) -> float:
        """The number in its law: a stiffness, damping, inertance, force or half-width.

        Raises `DesignError` if its value is free.
        """
        value = self.value
        if isinstance(value, Free | Tied):
            raise DesignError(f"The value of {self.label!r} is still free. Fix it with with_values(...).")
        return value * self.gain

    @property
    def limits(self) -> tuple[float, float]:
        """Between which forces [N], or elongations [m], what switches is in its middle state: plus and minus its value.

        A kind whose law is not even in both directions has others. One that is infinite is never met; where both are
        the same, the force, or the length, is always that one.
        """
        return -self.coefficient, self.coefficient

    def checked_limits(self) -> tuple[float, float]:
        """`limits`; raises `DesignError` if a kind gives two that it cannot be between."""
        lower, upper = self.limits
        if not (is_number(lower) or is_number(upper)) or not -np.inf <= lower <= upper <= np.inf:
            raise DesignError(
                f"{self.key.capitalize()} {self.label!r} switches at {lower} and {upper}; expected two numbers in "
                f"order, of which one may be infinite."
            )
        return lower, upper

    @property
    def even(self) -> bool:
        """Whether its limits are minus and plus its value, also while that is free."""
        return type(self).limits is Element.limits

    @property
    def is_damped(self) -> bool:
        """Whether statistical linearisation has a damper for it: for dry friction alike in both directions."""
        return self.acts and self.even and self.statistical is Statistical.DAMPER

    @property
    def acts(self) -> bool:
        """Whether it switches, by limits that are apart or still to be chosen."""
        if self.switch is None or isinstance(self.value, Free | Tied):
            return self.switch is not None
        lower, upper = self.limits
        return lower < upper

    @property
    def possible(self) -> tuple[int, ...]:
        """The states in which what switches can be, the middle one first; with limits in one place, 1 alone."""
        if not self.acts:
            return (1,)
        lower, upper = self.limits
        return (0, *((1,) if upper < np.inf else ()), *((-1,) if lower > -np.inf else ()))

    @property
    def always_holds(self) -> bool:
        """Whether what switches gives way to no force that is small enough: friction with a force, a closed gap."""
        if self.switches_by(Guard.FORCE):
            lower, upper = self.limits
            return lower < 0.0 < upper
        return not self.acts

    @property
    def role(self) -> tuple[bool, bool]:
        """All that a mechanism's motions depend on beside its kind: whether it switches, and whether it holds."""
        if self.even:
            return self.coefficient > 0.0, True  # as a friction or a gap does, of whichever size
        return self.acts, self.always_holds

    def switches_by(self, guard: Guard) -> bool:
        """Whether it switches under this guard."""
        return self.switch is not None and self.switch.guard is guard

    @property
    def label(self) -> str:
        """Its name, else the name of its free value, else its symbol."""
        if self.name is not None:
            return self.name
        value = self.value
        return value.name if isinstance(value, Free) and value.name is not None else self.symbol

    def with_value(self, value: Value) -> Element:
        """The same element with another value."""
        more = [getattr(self, field.name) for field in self.more] if self.more else []
        return type(self)(value, *more, self.name)  # type: ignore[call-arg]  # thrice as quick as `replace`

    def elements(self) -> Iterator[Element]:
        yield self

    def as_linear(self) -> Network:
        """What linear analysis takes in its place, also where its value is free."""
        return self

    def as_piecewise(self) -> Network:
        """What simulation takes in its place: elements whose laws are linear, or switch.

        Raises `DesignError` if its value is free and parts of it cannot be.
        """
        return self

    @property
    def is_switching(self) -> bool:
        """Whether simulation takes it as it is."""
        return type(self).as_piecewise is Element.as_piecewise

    @property
    def plain(self) -> bool:
        """Whether its value is the one coefficient of its one law."""
        return self.gain == 1.0 and self.is_switching and type(self).as_linear is Element.as_linear

    def fraction(self, s: Complex) -> tuple[Complex, Complex]:
        view = self.as_linear()
        if view is not self:
            return view.fraction(s)
        zero, one = np.full_like(s, 0.0), np.full_like(s, 1.0)
        match self.linear:
            case Linear.STIFFNESS:
                return np.full_like(s, self.coefficient), s
            case Linear.DAMPING:
                return np.full_like(s, self.coefficient), one
            case Linear.MASS:
                return np.full_like(s, self.coefficient) * s, one
            case Linear.OPEN:
                return zero, one
            case Linear.CLOSED:
                return one, zero
