"""The index of the best designs in each operating condition, as tables."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray as xr

from inerter.figures.labels import (
    NOTICEABLE,
    by_which,
    compared_layouts,
    design_quantity,
    improvement_over_baseline,
    improvement_text,
    index_unit,
    index_words,
    indices,
    indices_with_values,
    layouts,
    marked_layouts,
    one_method,
)
from inerter.files.study.conditions import CONDITION, IN_CONDITIONS, MOST_LISTED
from inerter.files.study.running import DATASET, SUMMARY
from inerter.files.study.sections import OVER
from inerter.formatting import choose_scale, format_list, format_share
from inerter.report.index_summary import is_compared
from inerter.table import Cell, Column, Row, Table, columns

OTHERS_AT = f"Values in each condition are in {SUMMARY} and {DATASET}."


def condition_names(results: xr.Dataset) -> list[str]:
    """Names of the operating conditions; empty unless there are several, with values in each."""
    known = f"{IN_CONDITIONS}value" in results and results.sizes[CONDITION] > 1
    return list(map(str, results[CONDITION].values)) if known else []


def in_condition(results: xr.Dataset, number: int) -> xr.Dataset:
    """The results with values and improvements in the condition of that number, from 0, in place of those over all."""
    here = results.isel({CONDITION: number}, drop=True)
    own = [name for name in map(str, here.data_vars) if name.startswith(IN_CONDITIONS)]
    return here.assign({name.removeprefix(IN_CONDITIONS): here[name] for name in own})


def condition_tables(results: xr.Dataset) -> list[Table]:
    """Tables of value and improvement of each layout in each condition, one per index with values.

    Empty for fewer than two conditions.
    """
    if not condition_names(results):
        return []
    return [_table(one_method(results), index) for index in indices_with_values(results)]


def brief_condition_tables(results: xr.Dataset) -> list[Table] | None:
    """Tables of the best and the worst condition of each layout, where there are many conditions; else None."""
    if len(condition_names(results)) <= MOST_LISTED:
        return None
    return [_extreme_table(one_method(results), index) for index in indices_with_values(results)]


def swept_condition_sentences(results: xr.Dataset) -> Iterator[str]:
    """Sentences on layouts that are worse than the baseline in a condition, though not over all, at swept values."""
    if not condition_names(results):
        return
    one = one_method(results)
    for index in indices(results):
        for name in compared_layouts(results):
            design = one.sel(index=index, layout=name)
            better = (design["improvement"] > 0.0).values
            each = [_is_worse(in_condition(design, i)) & better for i in range(results.sizes[CONDITION])]
            told = [f"{label} at {int(at.sum())}" for label, at in zip(condition_names(results), each, strict=True)]
            shown = [text for text, at in zip(told, each, strict=True) if at.any()]
            if shown:
                over = f"{results.attrs['baseline']} in condition"
                yield (
                    f"{index}: {name}, better over all conditions, is worse than {over} {format_list(shown)} of "
                    f"{better.size} points{by_which(one)}."
                )


def _is_worse(design: xr.Dataset) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    """Whether a design is worse than the baseline by more than its errors, over the dimensions of `design`."""
    errors = design["improvement_error"].fillna(0.0) if "improvement_error" in design else 0.0
    return np.asarray((design["improvement"] + 2.0 * errors <= -NOTICEABLE).values)


def _table(results: xr.Dataset, index: str) -> Table:
    """Conditions in rows, with their shares if they matter, layouts in columns, the index over all conditions below."""
    over = str(results[CONDITION].attrs["over"])
    labels = condition_names(results)
    each = [*(in_condition(results, i) for i in range(len(labels))), results]
    shares = [*(format_share(float(share)) for share in results[f"{IN_CONDITIONS}share"].values), None]
    by_share = over == OVER[0]
    scale = choose_scale(
        results[f"{IN_CONDITIONS}value"].sel(index=index).values.ravel().tolist(), index_unit(results, index)
    )
    rows = []
    for label, share, data in zip([*labels, over], shares, each, strict=True):
        cells = [Cell(label), *([Cell(share)] if by_share else [])]
        for name in layouts(results):
            design = data.sel(index=index, layout=name)
            cells.append(Cell(design_quantity(design, scale.unit, scale), improvement_over_baseline(design)))
        rows.append(Row(cells, strong=data is results))
    heads = [Column("Condition", words=True), *columns(*(["Share"] if by_share else []), *marked_layouts(results))]
    unit = f", in {scale.unit}" if scale.unit else ""
    return Table(f"{_caption(results, index)}{unit}", heads, rows)


def _extreme_table(results: xr.Dataset, index: str) -> Table:
    """Best and worst condition of each layout: by the improvement where there is one, else by the value."""
    versus, unit = is_compared(results, index), index_unit(results, index)
    labels = condition_names(results)
    rows = []
    for name in compared_layouts(results) if versus else layouts(results):
        each = [in_condition(results, i).sel(index=index, layout=name) for i in range(len(labels))]
        values = np.array([-float(one["improvement"]) if versus else float(one["value"]) for one in each])
        known = np.flatnonzero(~np.isnan(values))
        places = [int(known[find(values[known])]) for find in (np.argmin, np.argmax)] if known.size else []
        texts = [
            f"{improvement_text(each[i]) if versus else design_quantity(each[i], unit)} in condition {labels[i]}"
            for i in places
        ]
        rows.append(Row([Cell(name), *(Cell(text) for text in texts or (None, None))]))
    than = f", compared with {results.attrs['baseline']}" if versus else ""
    return Table(f"{_caption(results, index)}{than}", columns("Layout", "Best", "Worst"), rows)


def _caption(results: xr.Dataset, index: str) -> str:
    return f"Best for {index_words(results, index)}{by_which(results)}: values in each condition"
