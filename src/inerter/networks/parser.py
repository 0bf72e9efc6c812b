"""The network syntax in strings: `network("k | c - b", k=..., c=..., b=...)`. Parsed, never evaluated."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import NoReturn

from inerter.errors import NetworkError
from inerter.networks.elements import Element, Network, Parallel, Series, check_network

_DEEPEST = 100
_TOKEN = re.compile(r"\s*(?:([A-Za-z][A-Za-z0-9_]*)|([|()\-]))")


def network(expression: str, /, **parts: Network) -> Network:
    """The network that `expression` describes, with each name replaced by the given element or network.

    `|` is parallel, `-` is series and binds tighter, brackets group. An element without a name takes the name that
    it has in the expression.

    Raises `NetworkError` for a syntax error or for a name that is not given; names that are given need not be used.

    >>> from inerter.networks.elements import Inerter, Spring
    >>> network("k - b", k=Spring(1e3), b=Inerter(20.0))
    Series(parts=(Spring(stiffness=1000.0, name='k'), Inerter(inertance=20.0, name='b')))
    """
    return _Parser(expression, _tokens(expression), {n: _named(check_network(p), n) for n, p in parts.items()}).parse()


def names(expression: str) -> tuple[str, ...]:
    """The names in `expression`, each once, in the order in which they first appear.

    Raises `NetworkError` where the text has characters that are not part of the syntax.
    """
    return tuple(dict.fromkeys(text for text, _ in _tokens(expression) if text[0].isalpha()))


def written(network: Network, names: Iterable[str]) -> str:
    """The expression of a network whose elements have these names, in the order in which they are written.

    >>> from inerter.networks.elements import Damper, Inerter, Spring
    >>> written((Spring(1e3) | Damper(10.0)) - Inerter(20.0), ["k", "c", "b"])
    '(k | c) - b'
    """
    rest = iter(names)

    def text(part: Network, inside: str) -> str:
        match part:
            case Parallel(parts):
                joined = " | ".join([text(each, "|") for each in parts])
                return f"({joined})" if inside else joined
            case Series(parts):
                joined = " - ".join([text(each, "-") for each in parts])
                return f"({joined})" if inside == "-" else joined
        return next(rest)

    return text(network, "")


@dataclass
class _Parser:
    expression: str
    tokens: list[tuple[str, int]]
    parts: Mapping[str, Network]
    position: int = 0
    depth: int = 0

    def parse(self) -> Network:
        result = self._parallel()
        if self._next() is not None:
            self._fail("expected '|', '-' or the end here")
        return result

    def _parallel(self) -> Network:
        result = self._series()
        while self._next() == "|":
            self.position += 1
            result = result | self._series()
        return result

    def _series(self) -> Network:
        result = self._atom()
        while self._next() == "-":
            self.position += 1
            result = result - self._atom()
        return result

    def _atom(self) -> Network:
        token = self._next()
        if token == "(":
            self.position += 1
            self.depth += 1
            if self.depth > _DEEPEST:
                self._fail(f"more than {_DEEPEST} brackets inside each other")
            result = self._parallel()
            self.depth -= 1
            if self._next() != ")":
                self._fail("expected ')' here")
            self.position += 1
            return result
        if token is None or not token[0].isalpha():
            self._fail("expected a name or '(' here")
        if token not in self.parts:
            known = ", ".join(self.parts) or "none"
            self._fail(f"there is no element named {token!r} (defined: {known})")
        self.position += 1
        return self.parts[token]

    def _next(self) -> str | None:
        return self.tokens[self.position][0] if self.position < len(self.tokens) else None

    def _fail(self, problem: str) -> NoReturn:
        inside = self.position < len(self.tokens)
        column = self.tokens[self.position][1] if inside else len(self.expression)
        raise NetworkError(f"Network {self.expression!r}, column {column + 1}: {problem}.")


def _tokens(expression: str) -> list[tuple[str, int]]:
    if not isinstance(expression, str):
        raise NetworkError(f"A network expression is a string such as 'k | c - b', got {expression!r}.")
    result: list[tuple[str, int]] = []
    position, end = 0, len(expression.rstrip())
    while position < end:
        match = _TOKEN.match(expression, position)
        if match is None:
            column = position + len(expression[position:]) - len(expression[position:].lstrip()) + 1
            raise NetworkError(
                f"Network {expression!r}, column {column}: {expression[column - 1]!r} is not part of the syntax. "
                f"Use names, '|' (parallel), '-' (series) and brackets."
            )
        result.append((match.group(1) or match.group(2), match.start(match.lastindex or 0)))
        position = match.end()
    if not result:
        raise NetworkError("A network expression is empty. Write, for example, 'k | c - b'.")
    return result


def _named(part: Network, name: str) -> Network:
    if isinstance(part, Element) and part.name is None:
        return replace(part, name=name)  # type: ignore[type-var]
    return part
