"""The network syntax in strings: `network("k | c - b", k=..., c=..., b=...)`. Parsed, never evaluated."""

from __future__ import annotations

import re
from collections.abc import Callable, Container, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import NoReturn

from inerter.errors import NetworkError
from inerter.networks.elements import Bridge, Element, Network, Parallel, Series, check_network

BRIDGE = "bridge"  # before a bracket it begins a bridge; else it is a name
_ARMS = 5
_DEEPEST = 100


class ExpressionError(NetworkError):
    """An invalid network expression, and the position of its error, counted from 0."""

    def __init__(self, text: str, at: int) -> None:
        super().__init__(text, at)
        self.at = at

    def __str__(self) -> str:
        return str(self.args[0])


_NAME = re.compile(rf"({BRIDGE}(?=\s*\())|[A-Za-z][A-Za-z0-9_]*")
_TOKEN = re.compile(r"\s*(?:([A-Za-z][A-Za-z0-9_]*)|([|(),\-]))")


def network(expression: str, /, **parts: Network) -> Network:
    """The network that `expression` describes, with each name replaced by the given element or network.

    `|` is parallel, `-` is series and binds tighter, brackets group; `bridge(a, b, c, d, e)` is a `Bridge` whose arms
    are expressions. An element without a name takes its name in the expression.

    Raises `NetworkError` for a syntax error or an undefined name; given names need not be used.

    >>> from inerter.networks.elements import Inerter, Spring
    >>> network("k - b", k=Spring(1e3), b=Inerter(20.0))
    Series(parts=(Spring(stiffness=1000.0, name='k'), Inerter(inertance=20.0, name='b')))
    """
    known = {name: _with_name(check_network(part), name) for name, part in parts.items()}
    return _build(parse_expression(expression, known), known)


@dataclass(frozen=True)
class ExpressionPart:
    """A part of an expression: a name, or combined parts; it is `expression[begin:end]`, without outer brackets."""

    begin: int
    end: int
    name: str = ""
    sign: str = ""  # operator of its parts: "|" or "-", or `BRIDGE`
    parts: tuple[ExpressionPart, ...] = ()


def parse_expression(expression: str, known: Container[str] | None = None) -> ExpressionPart:
    """The syntax tree of an expression, each part with its position in the text.

    Raises `ExpressionError` for a syntax error, or for a name that is not `known` where that is given.
    """
    return _Parser(expression, _tokens(expression), known).parse()


def names(expression: str) -> tuple[str, ...]:
    """The names in `expression`, each once, in order of first appearance.

    Raises `NetworkError` for characters that are not part of the syntax.
    """
    tokens = [text for text, _ in _tokens(expression)]
    following = [*tokens[1:], ""]
    return tuple(dict.fromkeys(t for t, after in zip(tokens, following, strict=True) if _is_name(t, after)))


def rename_in_expression(expression: str, names: Mapping[str, str]) -> str:
    """The expression with other names, all else as it is written; it need not be a network yet.

    >>> rename_in_expression("c | k - (c |", {"c": "k", "k": "c"})
    'k | c - (k |'
    """
    return _NAME.sub(lambda found: found[1] or names.get(found[0], found[0]), expression)


def replace_in_expression(expression: str, networks: Mapping[str, str]) -> str:
    """The expression with networks, as expressions, in place of names, and with the brackets that this requires.

    Raises `ExpressionError` for a syntax error.

    >>> replace_in_expression("k | any", {"any": "c - b"}), replace_in_expression("k - any", {"any": "c | b"})
    ('k | c - b', 'k - (c | b)')
    """
    replaced = {name: parse_expression(each) for name, each in networks.items()}

    def text(part: ExpressionPart, inside: str, others: Mapping[str, ExpressionPart]) -> str:
        if part.name:
            return text(others[part.name], inside, {}) if part.name in others else part.name
        if part.sign == BRIDGE:
            return f"{BRIDGE}({', '.join([text(arm, '', others) for arm in part.parts])})"
        joined = f" {part.sign} ".join([text(each, part.sign, others) for each in part.parts])
        return f"({joined})" if part.sign == "|" and inside == "-" else joined

    return text(parse_expression(expression), "", replaced)


def format_expression(network: Network, names: Iterable[str]) -> str:
    """The expression of a network whose elements have these names, in the order of the expression.

    >>> from inerter.networks.elements import Damper, Inerter, Spring
    >>> format_expression((Spring(1e3) | Damper(10.0)) - Inerter(20.0), ["k", "c", "b"])
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
            case Bridge():
                return f"{BRIDGE}({', '.join([text(arm, '') for arm in part.parts])})"
        return next(rest)

    return text(network, "")


def _build(part: ExpressionPart, known: Mapping[str, Network]) -> Network:
    """The network of a part of an expression."""
    if part.name:
        return known[part.name]
    parts = [_build(each, known) for each in part.parts]
    if part.sign == BRIDGE:
        return Bridge(*parts)
    first, *rest = parts
    for other in rest:
        first = first | other if part.sign == "|" else first - other
    return first


@dataclass
class _Parser:
    expression: str
    tokens: list[tuple[str, int]]
    known: Container[str] | None
    position: int = 0
    depth: int = 0

    def parse(self) -> ExpressionPart:
        result = self._parallel()
        if self._next() is not None:
            self._fail("'|', '-' or the end expected here")
        return result

    def _parallel(self) -> ExpressionPart:
        return self._several("|", lambda: self._several("-", self._atom))

    def _several(self, sign: str, one: Callable[[], ExpressionPart]) -> ExpressionPart:
        """One part, or all parts combined by `sign`."""
        begin, parts = self._place(), [one()]
        while self._next() == sign:
            self.position += 1
            parts.append(one())
        return parts[0] if len(parts) == 1 else ExpressionPart(begin, self._end(), sign=sign, parts=tuple(parts))

    def _atom(self) -> ExpressionPart:
        token = self._next()
        if token == "(":
            (result,) = self._in_brackets(1)
            return result
        if token is None or not token[0].isalpha():
            self._fail("element name or '(' expected here")
        if not _is_name(token, self._next(1)):
            begin = self._place()
            self.position += 1
            arms = self._in_brackets(_ARMS)
            return ExpressionPart(begin, self._end(), sign=BRIDGE, parts=arms)
        if self.known is not None and token not in self.known:
            names = ", ".join(self.known) if isinstance(self.known, Iterable) else ""
            self._fail(f"undefined element {token!r}; defined: {names or 'none'}")
        begin = self._place()
        self.position += 1
        return ExpressionPart(begin, begin + len(token), token)

    def _in_brackets(self, count: int) -> tuple[ExpressionPart, ...]:
        """`count` expressions between brackets, with commas between them."""
        self.position += 1
        self.depth += 1
        if self.depth > _DEEPEST:
            self._fail(f"more than {_DEEPEST} nested brackets")
        parts = [self._parallel()]
        while len(parts) < count:
            if self._next() != ",":
                self._fail(f"',' expected here, as a bridge has {count} arms: a, b, c, d, e")
            self.position += 1
            parts.append(self._parallel())
        self.depth -= 1
        if self._next() != ")":
            self._fail("')' expected here")
        self.position += 1
        return tuple(parts)

    def _next(self, ahead: int = 0) -> str | None:
        at = self.position + ahead
        return self.tokens[at][0] if at < len(self.tokens) else None

    def _place(self) -> int:
        """Position of the next token."""
        return self.tokens[self.position][1] if self.position < len(self.tokens) else len(self.expression)

    def _end(self) -> int:
        """End position of the last token."""
        token, begin = self.tokens[self.position - 1]
        return begin + len(token)

    def _fail(self, problem: str) -> NoReturn:
        raise _wrong(self.expression, self._place(), f"{problem}.")


def _is_name(token: str, after: str | None) -> bool:
    """Whether a token is the name of an element, with the token after it."""
    return token[0].isalpha() and not (token == BRIDGE and after == "(")


def _wrong(expression: str, place: int, problem: str) -> ExpressionError:
    return ExpressionError(f"Network {expression!r}, column {place + 1}: {problem}", place)


def _tokens(expression: str) -> list[tuple[str, int]]:
    if not isinstance(expression, str):
        raise NetworkError(f"A network expression must be a string such as 'k | c - b', got {expression!r}.")
    result: list[tuple[str, int]] = []
    position, end = 0, len(expression.rstrip())
    while position < end:
        match = _TOKEN.match(expression, position)
        if match is None:
            place = position + len(expression[position:]) - len(expression[position:].lstrip())
            remedy = "Use names, '|' (parallel), '-' (series), brackets and bridge(a, b, c, d, e)."
            raise _wrong(expression, place, f"{expression[place]!r} is not part of the syntax. {remedy}")
        result.append((match.group(1) or match.group(2), match.start(match.lastindex or 0)))
        position = match.end()
    if not result:
        raise ExpressionError("A network expression is empty. Write, for example, 'k | c - b'.", 0)
    return result


def _with_name(part: Network, name: str) -> Network:
    if isinstance(part, Element) and part.name is None:
        return replace(part, name=name)  # type: ignore[type-var]
    return part
