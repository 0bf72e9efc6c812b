"""A place of a study file, such as `road.speed`, and the values that a sweep gives the number there."""

from __future__ import annotations

from dataclasses import dataclass, field

ELEMENTS = "elements"


@dataclass(frozen=True)
class Place:
    """A section and what follows it, such as "elements" and "k"."""

    section: str
    key: str

    @property
    def label(self) -> str:
        """Name of the place in results and files; an element without its section."""
        return self.key if self.section == ELEMENTS and "." not in self.key else f"{self.section}.{self.key}"


def place_of(text: str) -> Place:
    """The place that a file names; an element may go by its name alone.

    >>> place_of("k") == place_of("elements.k"), place_of("road.speed").label
    (True, 'road.speed')
    """
    section, _, key = text.partition(".")
    return Place(section, key) if key else Place(ELEMENTS, section)


def element_at(place: Place) -> str:
    """Name of the element at a place; empty if the place is not in an element."""
    return place.key.partition(".")[0] if place.section == ELEMENTS else ""


@dataclass(frozen=True)
class Sweep:
    """The values that the number at a place takes in turn, in its SI unit."""

    place: Place
    values: tuple[float, ...]
    unit: str
    words: str  # what is swept
    written: str = field(default="", compare=False)  # the unit in which the file gives the values; empty if in several

    @property
    def label(self) -> str:
        """Name of the swept place in results."""
        return self.place.label
