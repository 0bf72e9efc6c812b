"""`modelDescription.xml` of an FMU: variables with units, and which of them act on which outputs at once."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from xml.sax.saxutils import quoteattr

import numpy as np

from inerter.exports.kinds.fmu.switching import SwitchingSystem
from inerter.exports.named_system import NamedQuantity

_ORDERS = ("", "_rate", "_rate2", "_rate3")  # of the derivatives of an input
_BASE = {
    "m": {"m": 1},
    "kg": {"kg": 1},
    "kg m^2": {"kg": 1, "m": 2},
    "N": {"kg": 1, "m": 1, "s": -2},
    "N/m": {"kg": 1, "s": -2},
    "N s/m": {"kg": 1, "s": -1},
    "N m": {"kg": 1, "m": 2, "s": -2},
    "rad": {"rad": 1},
}
_RATE = re.compile(r"(.*?)(?:/s(?:\^(\d+))?)?")
_TOOL = "inerter"
_OF_STRUTS = (
    (NamedQuantity("mean_force", "N"), "Mean of strut_force over the last step."),
    (NamedQuantity("inertance", "kg"), "Gain of strut_force at once for each m/s^2 of upper_acceleration."),
    (NamedQuantity("coupling_ratio"), "inertance (1/upper_mass + 1/lower_mass): below one for an explicit host."),
)


@dataclass(frozen=True, eq=False)
class FmuModel:
    """A model with its identifier in C, and the token that ties library and description together."""

    name: str
    token: str
    title: str
    switches: SwitchingSystem


@dataclass(frozen=True)
class Variable:
    """A variable, and what of the others acts on it at once."""

    quantity: NamedQuantity
    causality: str
    variability: str
    start: float | None = None
    on: tuple[str, ...] = ()
    description: str = ""


def description_2(model: FmuModel, source: str) -> str:
    """The description after FMI 2.0: indices from 1."""
    variables = list(_variables(model.switches, 1))
    lines = [
        *_head(model, "2.0", f"guid={quoteattr(model.token)}"),
        f'  <CoSimulation modelIdentifier="{model.name}" canHandleVariableCommunicationStepSize="true"'
        ' canInterpolateInputs="true" canGetAndSetFMUstate="true" canSerializeFMUstate="true"'
        ' providesDirectionalDerivative="true">',
        f'    <SourceFiles><File name="{source}"/></SourceFiles>',
        "  </CoSimulation>",
        *_units(variables),
        "  <ModelVariables>",
    ]
    for reference, one in enumerate(variables):
        lines.append(
            f"    <ScalarVariable {_attributes(one, reference)}><Real{_unit_and_start(one)}/></ScalarVariable>"
        )
    places = {one.quantity.name: i for i, one in enumerate(variables, start=1)}
    outputs = [one for one in variables if one.causality == "output"]
    lines += ["  </ModelVariables>", "  <ModelStructure>"]
    if outputs:
        lines.append("    <Outputs>")
        lines += [f'      <Unknown index="{places[o.quantity.name]}"{_dependencies(o, places)}/>' for o in outputs]
        lines += ["    </Outputs>", "    <InitialUnknowns>"]
        lines += [f'      <Unknown index="{places[o.quantity.name]}"/>' for o in outputs]
        lines.append("    </InitialUnknowns>")
    return "\n".join([*lines, "  </ModelStructure>", "</fmiModelDescription>", ""])


def description_3(model: FmuModel) -> str:
    """The description after FMI 3.0, which has no derivatives of inputs: they are inputs of their own."""
    variables = list(_variables(model.switches, len(_ORDERS)))
    lines = [
        *_head(model, "3.0", f"instantiationToken={quoteattr(model.token)}"),
        f'  <CoSimulation modelIdentifier="{model.name}" canHandleVariableCommunicationStepSize="true"'
        ' canGetAndSetFMUState="true" canSerializeFMUState="true" providesDirectionalDerivatives="true"/>',
        *_units(variables, "s"),
        "  <ModelVariables>",
        '    <Float64 name="time" valueReference="0" causality="independent" variability="continuous" unit="s"/>',
    ]
    for reference, one in enumerate(variables, start=1):
        lines.append(f"    <Float64 {_attributes(one, reference)}{_unit_and_start(one)}/>")
    references = {one.quantity.name: i for i, one in enumerate(variables, start=1)}
    outputs = [one for one in variables if one.causality == "output"]
    lines += ["  </ModelVariables>", "  <ModelStructure>"]
    for what in ("Output", "InitialUnknown"):
        for one in outputs:
            on = _dependencies(one, references) if what == "Output" else ""
            lines.append(f'    <{what} valueReference="{references[one.quantity.name]}"{on}/>')
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


def _variables(switches: SwitchingSystem, orders: int) -> Iterator[Variable]:
    """All variables in the order of their references: inputs with so many orders, motions, outputs, parameters."""
    for order, ending in enumerate(_ORDERS[:orders]):
        for given in switches.host_inputs:
            rate = NamedQuantity(f"{given.name}{ending}", _rate_unit(given.unit, order))
            yield Variable(rate, "input", "continuous", 0.0)
    for motion in switches.motions:
        yield Variable(motion.quantity, "input", "continuous", 0.0)
    for i, one in enumerate(switches.system.outputs):
        yield Variable(one, "output", "continuous", on=tuple(_acts_at_once(switches, i)))
    for quantity, text in _OF_STRUTS if switches.motions else ():
        yield Variable(quantity, "output", "continuous", description=text)
    for parameter in switches.parameters:
        quantity = NamedQuantity(parameter.name, parameter.unit)
        variability = "tunable" if parameter.is_tunable else "fixed"
        yield Variable(quantity, "parameter", variability, parameter.value, description=parameter.description)


def _acts_at_once(switches: SwitchingSystem, output: int) -> Iterator[str]:
    """Names of the inputs that act on an output at once, by way of what sticks or touches too."""
    direct, count = switches.system.D[output] != 0.0, len(switches.inputs)
    late = switches.distances or (0.0,) * count
    reaches = direct[:count] | (bool(direct[count:].any()) & (np.array(late) == 0.0))
    sources = {switches.sources_of_inputs[j] for j in np.flatnonzero(reaches)}
    yield from (one.name for i, one in enumerate(switches.host_inputs) if i in sources)
    yield from (motion.quantity.name for motion in switches.motions)


def _head(model: FmuModel, version: str, token: str) -> list[str]:
    text = " ".join([f"{model.title}.", *model.switches.system.notes])
    description = "".join(one for one in text if one.isprintable())  # XML has no control characters
    return [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<fmiModelDescription fmiVersion="{version}" modelName={quoteattr(model.name)} {token}'
        f' description={quoteattr(description)} generationTool="{_TOOL}" variableNamingConvention="flat">',
    ]


def _attributes(one: Variable, reference: int) -> str:
    description = f" description={quoteattr(one.description)}" if one.description else ""
    initial = {"output": ' initial="calculated"', "parameter": ' initial="exact"'}.get(one.causality, "")
    return (
        f'name={quoteattr(one.quantity.name)} valueReference="{reference}" causality="{one.causality}"'
        f' variability="{one.variability}"{initial}{description}'
    )


def _unit_and_start(one: Variable) -> str:
    """Attributes of the type of a variable."""
    unit = f" unit={quoteattr(one.quantity.unit)}" if one.quantity.unit else ""
    return unit if one.start is None else f'{unit} start="{one.start!r}"'


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


def _units(variables: list[Variable], *also: str) -> list[str]:
    """Definitions of units by the base units of SI."""
    lines = []
    for unit in sorted({one.quantity.unit for one in variables} - {""} | set(also)):
        whole, power = ("", -1) if unit == "s" else _split_rate(unit)
        base = dict(_BASE.get(whole, {}))
        base["s"] = base.get("s", 0) - power
        exponents = "".join(f' {name}="{value}"' for name, value in base.items() if value)
        known = whole in _BASE or unit == "s"
        inner = f"<BaseUnit{exponents}/>" if known else ""
        lines.append(f"    <Unit name={quoteattr(unit)}>{inner}</Unit>")
    return ["  <UnitDefinitions>", *lines, "  </UnitDefinitions>"] if lines else []


def _dependencies(one: Variable, places: dict[str, int]) -> str:
    numbers = [places[name] for name in one.on]
    kinds = " ".join("dependent" for _ in numbers)
    return f' dependencies="{" ".join(map(str, numbers))}" dependenciesKind="{kinds}"'
