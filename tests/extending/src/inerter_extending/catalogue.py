"""A task: the best value of an element among those of a catalogue, with everything else optimised for each."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass

import inerter as it
from inerter import tasks


@tasks.keyed_dataclass
class CatalogueKeys:
    """Keys of the task in [study]."""

    catalogue_of: str | None = tasks.key(
        tasks.TEXT, "Element whose value is from the catalogue.", 'catalogue_of = "c"', default=None
    )
    catalogue: tuple[str, ...] = tasks.key(
        tasks.SWEEP_LIST, "Values in the catalogue.", 'catalogue = ["1 kN s/m", "2 kN s/m"]', default=()
    )


it.TASKS.add(it.TaskEntry("catalogues", "inerter_extending.catalogue:Catalogues", CatalogueKeys))


@dataclass(frozen=True)
class CataloguePart(tasks.TaskPart["CatalogueAnswer"]):
    """Part of the task: best value of the catalogue for one index of a layout."""

    layout: str
    index: str

    @property
    def name(self) -> str:
        """Name of the part in messages."""
        return f"catalogue for {self.layout} {self.index}"

    def compute(self, study: tasks.Study, designs: tasks.Designs, threads: int) -> CatalogueAnswer:
        """The value with the lowest index."""
        keys = study.tasks["catalogues"]
        element = study.elements[keys.catalogue_of]
        found = {}
        for text in keys.catalogue:
            fixed = study.with_values({keys.catalogue_of: tasks.parse_quantity(text, element.unit)})
            outcome = tasks.run_case(fixed, tasks.Case(self.layout, self.index), threads)
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

    def failed_result(self, study: tasks.Study, message: str) -> CatalogueAnswer:
        """Result without numbers."""
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
class CatalogueAnswer(tasks.Answer):
    """Best value of the catalogue, and the index with it."""

    of = CataloguePart
    index: str
    element: str
    best: str
    value: float
    unit: str


class Catalogues(tasks.Task[CatalogueAnswer]):
    """Task: best values of a catalogue."""

    key = "catalogues"
    title = "From the catalogue"
    answer = CatalogueAnswer

    def parts(self, study: tasks.Study) -> list[CataloguePart]:
        """Parts in the order of indices and layouts; layouts without the element are left out."""
        having = tasks.elements_used(study).get(study.tasks["catalogues"].catalogue_of, ())
        return [CataloguePart(layout, index) for index in study.indices for layout in having]

    def problems(self, study: tasks.Study, given: Collection[str]) -> Iterator[tasks.Problem]:
        """Problems of the keys: an unknown element, an empty catalogue, or a value in a unit of another kind."""
        keys = study.tasks["catalogues"]
        if keys.catalogue_of is None:
            return
        element = study.elements.get(keys.catalogue_of)
        if element is None:
            yield tasks.at(("study", "catalogue_of"), got=keys.catalogue_of, expected="an element")
        elif not keys.catalogue:
            yield tasks.at(("study", "catalogue"), fault="missing", expected='catalogue = ["1 kN s/m", "2 kN s/m"]')
        else:
            for text in keys.catalogue:
                try:
                    tasks.parse_quantity(text, element.unit)
                except it.InerterError as error:
                    yield tasks.at(
                        ("study", "catalogue"), got=text, expected=f"a unit of {element.unit}", hint=str(error)
                    )

    def description(self, study: tasks.Study) -> Mapping[str, list[str]]:
        """Values in the catalogue, by the heading of the report."""
        return {"Catalogue": list(study.tasks["catalogues"].catalogue)}

    def table(self, results: tasks.TaskResults[CatalogueAnswer]) -> tasks.Table:
        """One row for each design; columns with a heading are for people, those with a key are in the CSV file."""
        columns = [
            tasks.Column("Design"),
            tasks.Column(key="layout"),
            tasks.Column(key="index"),
            tasks.Column(key="element"),
            tasks.Column("Best value", "best", words=True),
            tasks.Column("Index", "value"),
            tasks.Column(key="unit"),
            tasks.Column(key="status"),
        ]
        rows = []
        for one in results.answers:
            value = tasks.Quantity(one.value, one.unit)
            labels = tasks.cells(f"{one.layout}, {one.index}", one.layout, one.index)
            found = tasks.cells(one.element, one.best, value, one.unit, one.status_text)
            rows.append(tasks.Row([*labels, *found], status=one.doubt))
        return tasks.Table("Best values of the catalogue", columns, rows)

    def sentences(self, results: tasks.TaskResults[CatalogueAnswer]) -> Iterator[str]:
        """Best value of the catalogue for each index."""
        for index in results.study.indices:
            own = [one for one in results.answers if one.index == index]
            known = [one for one in own if one.value < float("inf")]  # a failed answer has none
            failed = "".join(f"Not certain ({one.status_text}). " for one in own if not one.ok)
            if known:
                best = min(known, key=lambda one: one.value)
                yield f"{failed}From the catalogue, {best.element} = {best.best} in {best.layout} is best for {index}."
            elif own:
                yield f"{failed}From the catalogue, no value is known for {index}."
