"""A task: which value of a catalogue is best for an element, with everything else optimised for it."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass

import inerter as it
from inerter.files.common.codec import key, keyed_dataclass
from inerter.files.common.entries import SWEEP_LIST, TEXT
from inerter.files.common.problem import Problem, at
from inerter.files.study.cases import Case, run_case
from inerter.files.study.study import Study, elements_used
from inerter.files.study.tasks import Answer, Designs, Task, TaskPart, TaskResults
from inerter.formatting import format_quantity
from inerter.table import Cell, Row, Table, Writer
from inerter.units import parse_quantity


@keyed_dataclass
class CatalogueKeys:
    """What [study] says of it."""

    catalogue_of: str | None = key(TEXT, "The element that is bought.", 'catalogue_of = "c"', default=None)
    catalogue: tuple[str, ...] = key(
        SWEEP_LIST, "The values that are sold.", 'catalogue = ["1 kN s/m", "2 kN s/m"]', default=()
    )


it.TASKS.add(it.TaskRow("catalogues", "inerter_extending.catalogue:Catalogues", CatalogueKeys))


@dataclass(frozen=True)
class CataloguePart(TaskPart["CatalogueAnswer"]):
    """Which value of the catalogue is best for an index of a layout?"""

    layout: str
    index: str

    @property
    def name(self) -> str:
        """What it is, in messages."""
        return f"catalogue for {self.layout} {self.index}"

    def answer(self, study: Study, designs: Designs, threads: int) -> CatalogueAnswer:
        """The value with the least index."""
        keys = study.tasks["catalogues"]
        element = study.elements[keys.catalogue_of]
        found = {}
        for text in keys.catalogue:
            fixed = study.with_values({keys.catalogue_of: parse_quantity(text, element.unit)})
            outcome = run_case(fixed, Case(self.layout, self.index), threads)
            found[text] = outcome.values.get(study.evaluate[0], {}).get(self.index, float("inf")), outcome
        best = min(found, key=lambda text: found[text][0])
        value, outcome = found[best]
        return CatalogueAnswer(
            layout=self.layout,
            index=self.index,
            element=keys.catalogue_of,
            best=best,
            value=value,
            unit=study.unit(self.index),
            status=outcome.kind,
            message=outcome.message,
        )

    def failure_answer(self, study: Study, message: str) -> CatalogueAnswer:
        """The answer without numbers."""
        return CatalogueAnswer(
            layout=self.layout,
            index=self.index,
            element=study.tasks["catalogues"].catalogue_of,
            best="",
            value=float("nan"),
            unit=study.unit(self.index),
            status="failed",
            message=message,
        )


@dataclass(frozen=True, kw_only=True)
class CatalogueAnswer(Answer):
    """The value that is best."""

    index: str
    element: str
    best: str
    value: float
    unit: str

    @property
    def part(self) -> CataloguePart:
        """What it answers."""
        return CataloguePart(self.layout, self.index)


class Catalogues(Task[CatalogueAnswer]):
    """Which of the values that are sold is best."""

    key = "catalogues"
    title = "From the catalogue"
    answer = CatalogueAnswer

    def parts(self, study: Study) -> list[CataloguePart]:
        """In the order of indices, layouts; those that have the element."""
        having = elements_used(study).get(study.tasks["catalogues"].catalogue_of, ())
        return [CataloguePart(layout, index) for index in study.indices for layout in having]

    def problems(self, study: Study, given: Collection[str]) -> Iterator[Problem]:
        """An element that there is not, a catalogue that is empty, or a value in the unit of another kind."""
        keys = study.tasks["catalogues"]
        if keys.catalogue_of is None:
            return
        element = study.elements.get(keys.catalogue_of)
        if element is None:
            yield at(("study", "catalogue_of"), got=keys.catalogue_of, expected="an element")
        elif not keys.catalogue:
            yield at(("study", "catalogue"), fault="missing", expected='catalogue = ["1 kN s/m", "2 kN s/m"]')
        else:
            for text in keys.catalogue:
                try:
                    parse_quantity(text, element.unit)
                except it.InerterError as error:
                    yield at(("study", "catalogue"), got=text, expected=f"a unit of {element.unit}", hint=str(error))

    def description(self, study: Study) -> Mapping[str, list[str]]:
        """The values that are sold."""
        return {"Catalogue": list(study.tasks["catalogues"].catalogue)}

    def csv(self, study: Study, answers: Sequence[CatalogueAnswer]) -> Iterator[Sequence[object]]:
        """One row a design."""
        yield ["layout", "index", "element", "best", "value", "unit", "status"]
        for one in answers:
            yield [one.layout, one.index, one.element, one.best, one.value, one.unit, one.status_text]

    def lines(self, results: TaskResults[CatalogueAnswer], width: int) -> Iterator[str]:
        """A line for each design."""
        yield from ("", "from the catalogue:")
        for one in results.answers:
            yield f"  {one.layout} {one.index}: {one.element} = {one.best}, {format_quantity(one.value, one.unit)}"

    def tables(self, results: TaskResults[CatalogueAnswer]) -> list[Table]:
        """One table."""
        rows = [
            Row(
                f"{one.layout}, {one.index}",
                [Cell(one.best), Cell(format_quantity(one.value, one.unit))],
                status=one.doubt,
            )
            for one in results.answers
        ]
        return [Table("Best of the catalogue", ["Design", "Value that is sold", "Index"], rows)]

    def sentences(self, results: TaskResults[CatalogueAnswer], write: Writer) -> Iterator[str]:
        """The best value for each index."""
        for index in results.study.indices:
            own = [one for one in results.answers if one.index == index]
            known = [one for one in own if one.value < float("inf")]  # a failed answer has none
            failed = "".join(f"Not certain ({one.status_text}). " for one in own if not one.ok)
            if known:
                best = min(known, key=lambda one: one.value)
                yield f"{failed}From the catalogue, {best.element} = {best.best} in {best.layout} is best for {index}."
            elif own:
                yield f"{failed}From the catalogue, no value is known for {index}."
