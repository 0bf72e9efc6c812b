"""Performance of the best designs at speeds other than that of the study, as sentences and data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from inerter.decision.results import Improvement
from inerter.figures.labels import (
    NOTICEABLE,
    index_title,
    index_unit,
    indices,
    one_method,
    swept_places,
)
from inerter.files.study.speeds import AT_SPEEDS
from inerter.formatting import capital, format_quantity
from inerter.methods.registry import brief_words_of
from inerter.report.index_summary import extremes, place_text
from inerter.report.json_data import json_data
from inerter.report.verdicts import best_layouts

_OTHER_SPEEDS = (0, 2)  # numbers of the speeds that are not that of the study
_LOST = 0.5  # of an improvement, or of a value's own size, that is much to lose
_TUNED = 0.1  # by which a value may exceed what it would be if the speed only made the road rougher


@dataclass(frozen=True)
class SpeedSentences:
    """Sentences on designs with a large loss or doubtful values at other speeds, and on the others."""

    doubts: list[str]
    others: list[str]


def at_speeds(results: xr.Dataset, names: Mapping[str, Any]) -> list[dict[str, float | str | None]]:
    """Value of one design at each of the other speeds, and its improvement over the baseline's design there [%]."""
    where = {name: names[name] for name in ("layout", "index", *swept_places(results))}
    if not np.isfinite(results[f"{AT_SPEEDS}value"].sel(where)).all() and not _reason(results, where):
        return []
    keys = {"value": "value", "error_bound": "error_bound", "improvement": "improvement_percent"}
    doubts = _messages(results, where)
    return [
        {
            "speed": float(results[f"{AT_SPEEDS}speed"][i]),
            **{key: json_data(float(_there(results, where, name)[i])) for name, key in keys.items()},
            "message": "; ".join(doubts),
        }
        for i in _OTHER_SPEEDS
    ]


def speed_sentences(results: xr.Dataset) -> SpeedSentences:
    """Sentences on the best design of each index at other speeds, separated by whether they are doubts."""
    found = SpeedSentences([], [])
    for index in indices(results) if f"{AT_SPEEDS}value" in results else ():
        where = _best(results, index)
        if where is None:
            continue
        if np.isfinite(results[f"{AT_SPEEDS}value"].sel(where)).all():
            lost, sentence = _speed_sentence(results, where)
            late = np.ptp(_beyond_speed(results, where)) > 1e-6
            doubts = _messages(results, where)
            if doubts:
                begin = capital(sentence)
                found.doubts.append(f"Not certain at other speeds: {'; '.join(doubts)}. {begin}")
            elif lost:
                found.doubts.append(f"Not certain away from {_at(results, 1)}: {sentence}")
            elif late:
                found.others.append(capital(sentence))
        elif reason := _reason(results, where):
            found.doubts.append(
                f"Not certain away from {_at(results, 1)}: what the best design{_of(results, where)} "
                f"for {index_title(results, index)}, {where['layout']}, has at other speeds could not be computed: "
                f"{reason}."
            )
    return found


def _speed_sentence(results: xr.Dataset, where: Mapping[str, Any]) -> tuple[bool, str]:
    """Whether the design is doubtful at other speeds, and a sentence on its values there."""
    index, layout = where["index"], where["layout"]
    better, beyond = _there(results, where, "improvement"), _beyond_speed(results, where)
    method = results[f"{AT_SPEEDS}value"].attrs["methods"]
    of = _of(results, where)
    by = f" by {' and '.join(brief_words_of(one) for one in method.split())}"
    ends = [_value_at(results, where, i) for i in _OTHER_SPEEDS]
    here = _value_at(results, where, 1)
    tuned = bool(max(beyond[0], beyond[2]) > 1.0 + _TUNED)
    lost = np.isfinite(better[1]) and better[1] >= NOTICEABLE and min(better[0], better[2]) < _LOST * better[1]
    doubt = bool(lost or tuned)
    design = f"the best design{of} for {index_title(results, index)}, {layout}, has {here}"
    sentence = f"{design}{', but' if doubt else ';'}{by} {' and '.join(ends)}"
    if tuned:
        sentence += f", where the speed alone would make it {_alone(results, where)}"
    advice = ". Sweep road.speed, or give [[conditions]] of several speeds" if doubt else ""
    return doubt, f"{sentence}{advice}."


def _of(results: xr.Dataset, where: Mapping[str, Any]) -> str:
    """The place in a sweep of a design, in words; empty without a sweep."""
    places = {k: v for k, v in where.items() if k in swept_places(results)}
    return f" of {place_text(results, places, named=True)}" if places else ""


def _reason(results: xr.Dataset, where: Mapping[str, Any]) -> str:
    """Reason why a design has no finite values at other speeds; empty if they were not requested."""
    return str(results[f"{AT_SPEEDS}message"].sel(where).item()).rstrip(".")


def _messages(results: xr.Dataset, where: Mapping[str, Any]) -> list[str]:
    """Messages on doubtful values at other speeds, of a design and of the baseline."""
    every = dict.fromkeys([where["layout"], results.attrs["baseline"] or where["layout"]])
    found = [str(results[f"{AT_SPEEDS}message"].sel({**where, "layout": layout}).item()) for layout in every]
    return list(dict.fromkeys(message.rstrip(".") for message in found if message))


def _alone(results: xr.Dataset, where: Mapping[str, Any]) -> str:
    value, unit = float(results[f"{AT_SPEEDS}value"].sel(where)[1]), index_unit(results, where["index"])
    speeds = results[f"{AT_SPEEDS}speed"].values
    return " and ".join(format_quantity(value * float(np.sqrt(speeds[i] / speeds[1])), unit) for i in _OTHER_SPEEDS)


def _beyond_speed(results: xr.Dataset, where: Mapping[str, Any]) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Values over what they would be if the speed only made the road's velocity larger."""
    values, speeds = results[f"{AT_SPEEDS}value"].sel(where).values, results[f"{AT_SPEEDS}speed"].values
    with np.errstate(divide="ignore", invalid="ignore"):  # of values that are zero
        return np.asarray(values / values[1] / np.sqrt(speeds / speeds[1]))


def _value_at(results: xr.Dataset, where: Mapping[str, Any], place: int) -> str:
    """Value at one of the speeds, with its improvement over the baseline's design there."""
    value, bound, better, uncertain = (
        float(_there(results, where, name)[place])
        for name in ("value", "error_bound", "improvement", "improvement_bound")
    )
    text = f"{format_quantity(value, index_unit(results, where['index']), bound=bound)} at {_at(results, place)}"
    baseline = results.attrs["baseline"]
    if not np.isfinite(better) or where["layout"] == baseline:
        return text
    return f"{text} ({Improvement(better, bound=uncertain).than(baseline)})"


def _at(results: xr.Dataset, place: int) -> str:
    speed = 3.6 * float(results[f"{AT_SPEEDS}speed"].values[place])
    return format_quantity(speed, "km/h")


def _there(results: xr.Dataset, where: Mapping[str, Any], name: str) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Values of a design at all speeds, their relative error bounds, or improvements; nan where none is known."""
    name = f"{AT_SPEEDS}{name}"
    return np.asarray(
        results[name].sel(where) if name in results else np.full(results.sizes[f"{AT_SPEEDS}speed"], np.nan)
    )


def _best(results: xr.Dataset, index: str) -> dict[str, Any] | None:
    """The layout, and over a sweep the place, that the answer is about."""
    if not swept_places(results):
        return next(({"layout": name, "index": index} for name in best_layouts(results, index)), None)
    one = one_method(results)
    quantity = "improvement" if results.attrs["baseline"] else "value"
    found = []
    for name in results["layout"].values.tolist():
        ends = extremes(one[quantity].sel(index=index, layout=name))
        if ends is not None and name != results.attrs["baseline"]:
            value, place = (ends[1][0], ends[1][1]) if results.attrs["baseline"] else (-ends[0][0], ends[0][1])
            found.append((value, name, place))
    if not found:
        return None
    _, name, place = max(found, key=lambda one: one[0])
    return {"layout": name, "index": index, **place}
