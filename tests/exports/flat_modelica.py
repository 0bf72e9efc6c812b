"""Frequency responses of a Modelica model, from the flat equations that pymoca makes of its source.

Every equation of such a model is linear in its variables and their derivatives, so that each becomes a row of a matrix
whose entries are polynomials in s. Nothing here knows what a vehicle is.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from pymoca import ast, parser, tree

LIBRARY = Path(__file__).with_name("translational.mo").read_text(encoding="utf-8")
Form = dict[str, np.ndarray]  # polynomials in s, lowest power first, of each variable; "" is the constant
_POWERS = 4


class FlatModel:
    """The variables and the equations of a flat model, and its responses."""

    def __init__(self, source: str, name: str) -> None:
        library = parser.parse(LIBRARY)
        library.extend(parser.parse(source))
        (model,) = tree.flatten(library, ast.ComponentRef.from_string(name)).classes.values()
        self.parameters: dict[str, float] = {}
        pending = {s.name: s.value for s in model.symbols.values() if {"parameter", "constant"} & {*s.prefixes}}
        for symbol, value in pending.items():
            self.parameters[symbol] = float(self.form(value).get("", polynomial(0.0))[0])
        self.inputs = [s.name for s in model.symbols.values() if "input" in s.prefixes]
        self.units = {s.name: s.unit.value for s in model.symbols.values() if isinstance(s.unit, ast.Primary)}
        self.outputs = [s.name for s in model.symbols.values() if "output" in s.prefixes]
        self.variables = [s.name for s in model.symbols.values() if s.name not in {*pending, *self.inputs}]
        self.equations = [self.minus(self.form(e.left), self.form(e.right)) for e in model.equations]

    def response(self, omega: np.ndarray) -> np.ndarray:
        """Responses (frequency, output, input)."""
        places = {name: i for i, name in enumerate([*self.variables, *self.inputs])}
        rows = np.zeros((_POWERS, len(self.equations), len(places)))
        for row, equation in enumerate(self.equations):
            for name, coefficients in equation.items():
                rows[:, row, places[name]] += coefficients
        known = len(self.variables)
        assert len(self.equations) == known, "as many equations as unknowns"
        found = []
        chosen = [places[name] for name in self.outputs]
        for w in omega:
            whole = sum(rows[k] * (1j * w) ** k for k in range(_POWERS))
            left, right = whole[:, :known], -whole[:, known:]
            size = np.abs(left).max(axis=1, keepdims=True)
            found.append(np.linalg.solve(left / size, right / size)[chosen])
        return np.array(found)

    def minus(self, one: Form, other: Form) -> Form:
        return {name: one.get(name, polynomial(0.0)) - other.get(name, polynomial(0.0)) for name in {**one, **other}}

    def form(self, node: object) -> Form:
        """An expression as a linear form."""
        match node:
            case ast.Primary():
                return {"": polynomial(float(node.value))} if float(node.value) else {}
            case ast.ComponentRef() | ast.Symbol():
                name = str(node.name) if isinstance(node, ast.Symbol) else ".".join(ast.ComponentRef.to_tuple(node))
                if name in self.parameters:
                    return {"": polynomial(self.parameters[name])} if self.parameters[name] else {}
                return {name: polynomial(1.0)}
            case ast.Expression():
                return self.operation(str(node.operator), [self.form(one) for one in node.operands])
        raise TypeError(node)

    def operation(self, operator: str, operands: list[Form]) -> Form:
        if operator == "der":
            assert not operands[0].get("", polynomial(0.0)).any()
            return {name: np.roll(c, 1) for name, c in operands[0].items()}
        if operator in "+-":
            first, *rest = operands if len(operands) > 1 else [{}, *operands]
            for one in rest:
                negative = one if operator == "-" else self.minus({}, one)
                first = self.minus(first, negative)
            return first
        first, second = operands
        if operator == "*" and not set(first) <= {""}:
            first, second = second, first
        if operator == "/":
            first, second = {"": polynomial(1.0 / second[""][0])}, first
        assert set(first) <= {""}, "a product of two variables"
        factor = first.get("", polynomial(0.0))[0]
        return {name: factor * c for name, c in second.items()} if factor else {}


def polynomial(constant: float) -> np.ndarray:
    found = np.zeros(_POWERS)
    found[0] = constant
    return found
