"""`modelDescription.xml` of an FMU: variables with units, and which inputs act on which outputs at once."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from xml.sax.saxutils import quoteattr

from inerter.exports.named_system import NamedQuantity, NamedSystem

_ORDERS = ("", "_rate", "_rate2", "_rate3")  # of the derivatives of an input
_BASE = {"m": {"m": 1}, "N": {"kg": 1, "m": 1, "s": -2}, "N m": {"kg": 1, "m": 2, "s": -2}, "rad": {"rad": 1}}
_RATE = re.compile(r"(.*?)(?:/s(?:\^(\d+))?)?")
_TOOL = "inerter"


@dataclass(frozen=True, eq=False)
class FmuModel:
    """A model with its identifier in C, and the token that ties library and description together."""

    name: str
    token: str
    title: str
    system: NamedSystem

    def direct(self, output: int) -> list[int]:
        """Numbers of the inputs that act on an output at once."""
        return [j for j, gain in enumerate(self.system.D[output].tolist()) if gain != 0.0]


def description_2(model: FmuModel, source: str) -> str:
    """The description after FMI 2.0: indices from 1, the inputs first."""
    system, count = model.system, len(model.system.inputs)
    lines = [
        *_head(model, "2.0", f"guid={quoteattr(model.token)}"),
        f'  <CoSimulation modelIdentifier="{model.name}" canHandleVariableCommunicationStepSize="true"'
        ' canInterpolateInputs="true" canGetAndSetFMUstate="true" canSerializeFMUstate="true"'
        ' providesDirectionalDerivative="true">',
        f'    <SourceFiles><File name="{source}"/></SourceFiles>',
        "  </CoSimulation>",
        *_units(sorted({one.unit for one in (*system.inputs, *system.outputs)} - {""})),
        "  <ModelVariables>",
    ]
    for j, one in enumerate(system.inputs):
        lines += _scalar(one, j, 'causality="input" variability="continuous"', ' start="0"')
    for i, one in enumerate(system.outputs):
        lines += _scalar(one, count + i, 'causality="output" variability="continuous" initial="calculated"', "")
    unknowns = [
        f'      <Unknown index="{count + i + 1}"{_dependencies([j + 1 for j in model.direct(i)])}/>'
        for i in range(len(system.outputs))
    ]
    lines += ["  </ModelVariables>", "  <ModelStructure>"]
    if unknowns:
        lines += ["    <Outputs>", *unknowns, "    </Outputs>", "    <InitialUnknowns>", *unknowns]
        lines += ["    </InitialUnknowns>"]
    return "\n".join([*lines, "  </ModelStructure>", "</fmiModelDescription>", ""])


def description_3(model: FmuModel) -> str:
    """The description after FMI 3.0, which has no derivatives of inputs: they are inputs of their own."""
    system, count = model.system, len(model.system.inputs)
    inputs = list(_inputs_with_rates(system))
    first = 1 + len(inputs)
    lines = [
        *_head(model, "3.0", f"instantiationToken={quoteattr(model.token)}"),
        f'  <CoSimulation modelIdentifier="{model.name}" canHandleVariableCommunicationStepSize="true"'
        ' canGetAndSetFMUState="true" canSerializeFMUState="true" providesDirectionalDerivatives="true"/>',
        *_units(sorted({one.unit for one in (*inputs, *system.outputs)} - {""} | {"s"})),
        "  <ModelVariables>",
        '    <Float64 name="time" valueReference="0" causality="independent" variability="continuous" unit="s"/>',
    ]
    for j, one in enumerate(inputs, start=1):
        lines.append(_float(one, j, 'causality="input" variability="continuous" start="0"'))
    for i, one in enumerate(system.outputs, start=first):
        lines.append(_float(one, i, 'causality="output" variability="continuous" initial="calculated"'))
    known = [
        f'valueReference="{first + i}"{_dependencies([j + 1 for j in model.direct(i)])}/>'
        for i in range(len(system.outputs))
    ]
    lines += ["  </ModelVariables>", "  <ModelStructure>", *(f"    <Output {one}" for one in known)]
    lines += [f"    <InitialUnknown {one}" for one in known]
    assert len(inputs) == len(_ORDERS) * count
    return "\n".join([*lines, "  </ModelStructure>", "</fmiModelDescription>", ""])


def build_description(model: FmuModel, source: str) -> str:
    """`sources/buildDescription.xml` after FMI 3.0."""
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiBuildDescription fmiVersion="3.0">
  <BuildConfiguration modelIdentifier="{model.name}">
    <SourceFileSet language="C99">
      <SourceFile name="{source}"/>
    </SourceFileSet>
  </BuildConfiguration>
</fmiBuildDescription>
"""


def _head(model: FmuModel, version: str, token: str) -> list[str]:
    text = " ".join([model.title, *model.system.notes])
    description = "".join(one for one in text if one.isprintable())  # XML has no control characters
    return [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<fmiModelDescription fmiVersion="{version}" modelName={quoteattr(model.name)} {token}'
        f' description={quoteattr(description)} generationTool="{_TOOL}" variableNamingConvention="flat">',
    ]


def _inputs_with_rates(system: NamedSystem) -> Iterator[NamedQuantity]:
    for order, ending in enumerate(_ORDERS):
        for one in system.inputs:
            yield NamedQuantity(f"{one.name}{ending}", _rate_unit(one.unit, order))


def _rate_unit(unit: str, order: int) -> str:
    """Unit of a derivative; an unknown one has none."""
    if not unit or not order:
        return unit
    whole, power = _split_rate(unit)
    return f"{whole}/s" if power + order == 1 else f"{whole}/s^{power + order}"


def _split_rate(unit: str) -> tuple[str, int]:
    found = _RATE.fullmatch(unit)
    assert found is not None
    return found[1], int(found[2] or 1) if found[1] != unit else 0


def _units(units: list[str]) -> list[str]:
    """Definitions of units by the base units of SI."""
    lines = []
    for unit in units:
        whole, power = ("", -1) if unit == "s" else _split_rate(unit)
        base = dict(_BASE.get(whole, {}))
        base["s"] = base.get("s", 0) - power
        exponents = "".join(f' {name}="{value}"' for name, value in base.items() if value)
        known = whole in _BASE or unit == "s"
        inner = f"<BaseUnit{exponents}/>" if known else ""
        lines.append(f"    <Unit name={quoteattr(unit)}>{inner}</Unit>")
    return ["  <UnitDefinitions>", *lines, "  </UnitDefinitions>"] if lines else []


def _scalar(one: NamedQuantity, reference: int, attributes: str, start: str) -> list[str]:
    unit = f" unit={quoteattr(one.unit)}" if one.unit else ""
    return [
        f'    <ScalarVariable name={quoteattr(one.name)} valueReference="{reference}" {attributes}>'
        f"<Real{unit}{start}/></ScalarVariable>"
    ]


def _float(one: NamedQuantity, reference: int, attributes: str) -> str:
    unit = f" unit={quoteattr(one.unit)}" if one.unit else ""
    return f'    <Float64 name={quoteattr(one.name)} valueReference="{reference}" {attributes}{unit}/>'


def _dependencies(places: list[int]) -> str:
    kinds = " ".join("constant" for _ in places)
    return f' dependencies="{" ".join(map(str, places))}" dependenciesKind="{kinds}"'
