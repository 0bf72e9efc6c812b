"""Networks with the same set of admittances over all positive values, and the transformation of their values.

Classes are the closure of three transformations of linear networks, applied to any part of a network:

- Zobel: p | (q - X) = p' - (q' | X'), where p and q are elements of one kind and X' is X with all values scaled.
- Cauer and Foster: the admittance of a network of two kinds has real poles and zeros (in s, or in s^2) that alternate.
  A series-parallel network of two kinds has every such admittance of its degree and of its behaviour for low and high
  frequencies; those of fewer poles only in part. Elements of one kind in series or in parallel are one element.
- Star and triangle: three elements of one kind in a star act as three in a triangle, and four around a fifth arm as
  two, which makes a bridge with such arms a series-parallel network.

Numerical fits found no further pair of equal series-parallel networks of up to five springs, dampers and inerters:
the 551 networks form 221 classes. A bridge of two kinds has no admittance that Foster's network of its degree lacks,
but may lack some; such bridges are not in the class of that network.

Sources: Zobel, Bell System Technical Journal 2 (1923) 1; Cauer, Archiv fuer Elektrotechnik 17 (1926) 355; Foster, Bell
System Technical Journal 3 (1924) 259; Morelli and Smith, Passive Network Synthesis, SIAM (2019).
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from decimal import Decimal, localcontext
from functools import partial
from itertools import combinations, islice, pairwise
from math import isfinite
from operator import itemgetter

from inerter.errors import NetworkError
from inerter.networks.elements import Damper, Inerter, Spring
from inerter.networks.enumeration import BRIDGE, PARALLEL, SERIES, Topology, Tree, arrangements, canonical_tree, leaves

_LINEAR = (Spring.symbol, Damper.symbol, Inerter.symbol)  # in ascending powers of s
_DUAL = {PARALLEL: SERIES, SERIES: PARALLEL}
_DIGITS = 60  # carried through a chain of transformations
_ONE, _ZERO = Decimal(1), Decimal(0)


def equivalence_classes(topologies: Iterable[Topology]) -> list[tuple[Topology, ...]]:
    """Networks with the same set of admittances, in classes: the smallest network first, then by expression.

    >>> from inerter.networks.enumeration import enumerate_networks
    >>> equivalence_classes(enumerate_networks(3, kinds=(Spring, Damper)))
    [(Topology('c1 - (k1 | c2)'), Topology('c1 | k1 - c2')), (Topology('k1 - (k2 | c1)'), Topology('k1 | k2 - c1'))]
    """
    members = sorted(set(topologies))
    parent: dict[Tree, Tree] = {}

    def root(tree: Tree) -> Tree:
        while parent[tree] != tree:
            parent[tree] = tree = parent[parent[tree]]
        return tree

    pending = [topology.tree for topology in members]
    parent.update((tree, tree) for tree in pending)
    while pending:
        tree = pending.pop()
        for step in _steps(tree):
            if step.result not in parent:
                parent[step.result] = step.result
                pending.append(step.result)
            parent[root(step.result)] = root(tree)
    classes: dict[Tree, list[Topology]] = {}
    for topology in members:
        classes.setdefault(root(topology.tree), []).append(topology)
    return [tuple(each) for each in classes.values()]


def transform_values(one: Topology, values: Sequence[float], other: Topology) -> tuple[float, ...]:
    """Values of `other` with which it has the admittance of `one` with `values`, in the order of the expressions.

    Where `other` has more elements, like elements share a value equally.

    Raises `NetworkError` if the values do not fit `one`, the networks are of different classes, or fewer elements have
    the admittance, such as if two branches of `one` have the same pole.

    >>> transform_values(Topology(("|", "k", ("-", "k", "c"))), [1.0, 1.0, 1.0], Topology(("-", "k", ("|", "k", "c"))))
    (2.0, 2.0, 4.0)
    """
    numbers = tuple(map(float, values))
    if len(numbers) != one.size or not all(isfinite(number) and number > 0.0 for number in numbers):
        raise NetworkError(f"Network {one.expression!r} requires {one.size} positive values, got {values!r}.")
    path = _find_path(one.tree, other.tree)
    with localcontext() as context:
        context.prec = _DIGITS
        tree = _insert_values(one.tree, iter(map(Decimal, numbers)))
        try:
            for step in path:
                tree = _replace_group(tree, step)
            found = tuple(float(_value(leaf)) for leaf in leaves(tree))
        except ArithmeticError:  # a division by zero
            found = ()
    if not found or not all(isfinite(number) and number > 0.0 for number in found):
        raise NetworkError(
            f"{other.expression!r} has the admittance of {one.expression!r} with values {values!r} only in a limit: "
            f"fewer elements have it, since two poles coincide or a bridge is balanced. Change a value slightly."
        )
    return found


class _ElementWithValue(str):
    """An element with its value: equal to its symbol, so that trees with and without values are equal."""

    __slots__ = ("value",)
    value: Decimal


def _element(symbol: str, value: Decimal) -> str:
    element = _ElementWithValue(symbol)
    element.value = value
    return element


def _value(leaf: str) -> Decimal:
    """Value of an element, 1 where none is given."""
    return leaf.value if isinstance(leaf, _ElementWithValue) else _ONE


def _insert_values(tree: Tree, values: Iterator[Decimal]) -> Tree:
    if isinstance(tree, str):
        return _element(tree, next(values))
    return (tree[0], *[_insert_values(part, values) for part in tree[1:]])


def _without_values(tree: Tree) -> Tree:
    return str(tree) if isinstance(tree, str) else (tree[0], *map(_without_values, tree[1:]))


def _scale(tree: Tree, factor: Decimal) -> Tree:
    return _insert_values(tree, (factor * _value(leaf) for leaf in leaves(tree)))


@dataclass(frozen=True)
class _Step:
    """A tree in which `before` is replaced by `after`, which makes it `result`."""

    before: Tree
    after: Tree
    result: Tree


def _steps(tree: Tree) -> Iterator[_Step]:
    """Applications of a transformation to a part of the tree; none adds an element."""
    for group, rebuild in _groups(tree):
        for form in map(_without_values, _forms(group)):
            yield _Step(group, form, rebuild(form))


def _groups(tree: Tree) -> Iterator[tuple[Tree, Callable[[Tree], Tree]]]:
    """Parts of a tree that are networks themselves, each with the function that returns the tree with it replaced."""
    yield tree, canonical_tree
    if isinstance(tree, str):
        return
    operator, *parts = tree
    for i, part in enumerate(parts):
        for group, rebuild in _groups(part):
            yield group, partial(_rebuild, (operator, *parts[:i]), rebuild, parts[i + 1 :])
    if operator != BRIDGE:
        for number in range(2, len(parts)):
            for chosen in combinations(range(len(parts)), number):
                others = [part for i, part in enumerate(parts) if i not in chosen]
                yield (
                    (operator, *[parts[i] for i in chosen]),
                    partial(_rebuild, (operator, *others), canonical_tree, []),
                )


def _rebuild(before: tuple[Tree, ...], rebuild: Callable[[Tree], Tree], after: Sequence[Tree], form: Tree) -> Tree:
    return canonical_tree((*before, rebuild(form), *after))


def _forms(group: Tree) -> Iterator[Tree]:
    """Other networks with the admittances of a group, of at most as many elements."""
    kinds = set(leaves(group))
    if isinstance(group, str) or not kinds <= set(_LINEAR):
        return
    if group[0] == BRIDGE:
        yield from (reduction.form() for reduction in _reductions(group))
    elif len(kinds) <= 2 and _is_series_parallel(group):
        yield from (form for form in _foster_forms(group) if form != group)
    else:
        yield from map(canonical_tree, _zobel_forms(group))


def _is_series_parallel(tree: Tree) -> bool:
    return isinstance(tree, str) or (tree[0] != BRIDGE and all(map(_is_series_parallel, tree[1:])))


# Zobel's transformation


def _zobel_forms(group: Tree) -> Iterator[Tree]:
    """The form p' - (q' | X') of p | (q - X), and the dual."""
    operator, *parts = group
    if len(parts) != 2 or not isinstance(parts[0], str) or isinstance(parts[1], str) or parts[1][0] == BRIDGE:
        return
    dual, *inner = parts[1]
    for i, leaf in enumerate(inner):
        if leaf == parts[0]:
            rest = inner[:i] + inner[i + 1 :]
            x = (dual, *rest) if len(rest) > 1 else rest[0]
            sign = 1 if operator == PARALLEL else -1  # in series compliances take the place of values
            p, q = _value(parts[0]) ** sign, _value(leaf) ** sign
            ratio = (p + q) / q
            first, second = (_element(leaf, value**sign) for value in (p + q, p * ratio))
            yield (dual, first, (operator, second, _scale(x, ratio ** (2 * sign))))
            return


# Bridges with like arms


@dataclass(frozen=True)
class _Rule:
    """Replacement of equal arms of a bridge: values of the new elements, and a factor of those of the other arms."""

    convert: Callable[..., tuple[Sequence[Decimal], Decimal]]
    invert: Callable[..., tuple[Sequence[Decimal], Decimal]]
    join: Callable[..., Tree]  # the new elements, then the other arms


@dataclass(frozen=True)
class _Reduction:
    """A rule with the arms of a bridge to which it applies."""

    rule: _Rule
    like: tuple[str, ...]
    others: tuple[Tree, ...]

    def form(self) -> Tree:
        values, factor = self.rule.convert(*map(_value, self.like))
        others = [_scale(other, factor) for other in self.others]
        return canonical_tree(self.rule.join(*[_element(self.like[0], value) for value in values], *others))


def _reductions(bridge: Tree) -> Iterator[_Reduction]:
    for a, b, c, d, e in arrangements(bridge[1:]):
        if isinstance(a, str) and a == c == e:
            yield _Reduction(_TRIANGLE, (a, c, e), (b, d))
        if isinstance(a, str) and a == b == e:
            yield _Reduction(_STAR, (a, b, e), (c, d))
        if isinstance(a, str) and a == b == c == d != e:
            yield _Reduction(_LATTICE, (a, b, c, d), (e,))


def _to_bridge(group: Tree, bridge: Tree) -> Tree:
    """The bridge with values, of which a group of elements with values is a series-parallel form."""
    marks = [Decimal(1 + i) for i, _ in enumerate(leaves(bridge))]
    for reduction in _reductions(_insert_values(bridge, iter(marks))):
        rule, like = reduction.rule, [_value(leaf) for leaf in reduction.like]
        values, _ = rule.convert(*like)
        new = [Decimal(-1 - i) for i, _ in enumerate(values)]
        form = canonical_tree(rule.join(*[_element(reduction.like[0], mark) for mark in new], *reduction.others))
        if form == group:
            found = {_value(mark): _value(leaf) for mark, leaf in zip(leaves(form), leaves(group), strict=True)}
            old, factor = rule.invert(*[found[mark] for mark in new])
            scaled = {mark: found[mark] * factor for mark in marks if mark not in like}
            scaled |= dict(zip(like, old, strict=True))
            return _insert_values(bridge, (scaled[mark] for mark in marks))
    raise AssertionError(f"{group!r} is no form of {bridge!r}")


def _star(x: Decimal, y: Decimal, z: Decimal) -> tuple[Sequence[Decimal], Decimal]:
    """Legs of the star of a triangle, each to the corner opposite to z, y, x."""
    total = x * y + x * z + y * z
    return (total / z, total / y, total / x), _ONE


def _triangle(x: Decimal, y: Decimal, z: Decimal) -> tuple[Sequence[Decimal], Decimal]:
    """Sides of the triangle of a star, between the ends of x and y, x and z, y and z."""
    total = x + y + z
    return (x * y / total, x * z / total, y * z / total), _ONE


def _open_lattice(a: Decimal, b: Decimal, c: Decimal, d: Decimal) -> tuple[Sequence[Decimal], Decimal]:
    """The p, q of p | (q - X'), of four like arms around X, and X' / X."""
    difference = a / (a + b) - c / (c + d)  # of the motions of both sides of an open bridge
    stiffness = 1 / (1 / (a + b) + 1 / (c + d))
    return (a * b / (a + b) + c * d / (c + d), difference**2 * stiffness), difference**2


def _lattice(p: Decimal, q: Decimal) -> tuple[Sequence[Decimal], Decimal]:
    """Four arms, the opposite ones equal, of which p | (q - X) is the form."""
    spread = (q * (p + q)).sqrt()
    stiff, soft = p + q + spread, p * (p + q) / (p + q + spread)
    return (stiff, soft, soft, stiff), (p + q) / q


_TRIANGLE = _Rule(
    _star,
    _triangle,
    lambda top, left, right, b, d: (SERIES, top, (PARALLEL, (SERIES, left, b), (SERIES, right, d))),
)
_STAR = _Rule(
    _triangle,
    _star,
    lambda across, upper, lower, c, d: (PARALLEL, across, (SERIES, (PARALLEL, upper, c), (PARALLEL, lower, d))),
)
_LATTICE = _Rule(_open_lattice, _lattice, lambda p, q, x: (PARALLEL, p, (SERIES, q, x)))


# Networks of two kinds: partial fractions


@dataclass(frozen=True)
class _Fractions:
    """P + Q x + sum of r x / (x + w): the admittance, or the impedance, of a network of two kinds.

    For the admittance, x is the admittance of an element of the second kind over that of one of the first, both of
    value 1, and the whole is divided by the latter. For the impedance, x is the reciprocal. Then both are such sums.
    """

    constant: Decimal = _ZERO
    slope: Decimal = _ZERO
    terms: tuple[tuple[Decimal, Decimal], ...] = ()  # r, w

    def reciprocal(self) -> _Fractions:
        """The same sum for 1 / F(1 / y) as a function of y."""
        P, Q, terms = self.constant, self.slope, self.terms
        found = []
        for root in self._roots():
            slope = Q + sum((r * w / (w - root) ** 2 for r, w in terms), _ZERO)
            found.append((1 / (slope * root), 1 / root))
        return _Fractions(
            _ZERO if Q else 1 / (P + sum((r for r, _ in terms), _ZERO)),
            _ZERO if P else 1 / (Q + sum((r / w for r, w in terms), _ZERO)),
            tuple(sorted(found, key=itemgetter(1))),
        )

    def _roots(self) -> Iterator[Decimal]:
        """The x for which the sum at -x is zero: one between two poles, as it decreases from each."""
        poles = sorted(w for _, w in self.terms)
        brackets = list(pairwise(poles))
        if self.slope:
            lower = poles[-1] if poles else _ZERO
            upper = 2 * lower if poles else self.constant / self.slope
            while self._at_negative(upper) > 0:
                upper *= 2
            brackets.append((lower, upper))
        if self.constant and poles:
            brackets.append((_ZERO, poles[0]))
        if poles or (self.constant and self.slope):
            yield from (self._bisect(*bracket) for bracket in brackets)

    def _bisect(self, lower: Decimal, upper: Decimal) -> Decimal:
        while lower < (middle := (lower + upper) / 2) < upper:
            if self._at_negative(middle) > 0:
                lower = middle
            else:
                upper = middle
        return upper

    def _at_negative(self, x: Decimal) -> Decimal:
        return self.constant - self.slope * x + sum((r * x / (x - w) for r, w in self.terms), _ZERO)


def _expand(tree: Tree, operator: str, first: str) -> _Fractions:
    """Admittance (`operator` of a parallel connection) or impedance of a network of `first` and another kind."""
    if isinstance(tree, str):
        value = _value(tree) if operator == PARALLEL else 1 / _value(tree)
        return _Fractions(constant=value) if tree == first else _Fractions(slope=value)
    if tree[0] != operator:
        return _expand(tree, _DUAL[operator], first).reciprocal()
    parts = [_expand(part, operator, first) for part in tree[1:]]
    return _Fractions(
        sum((part.constant for part in parts), _ZERO),
        sum((part.slope for part in parts), _ZERO),
        tuple(term for part in parts for term in part.terms),
    )


def _realise(tree: Tree, operator: str, first: str, wanted: _Fractions) -> Tree:
    """The tree with values that give it this admittance or impedance, whose type is that of the tree."""
    if isinstance(tree, str):
        value = wanted.constant or wanted.slope
        return _element(tree, value if operator == PARALLEL else 1 / value)
    if tree[0] != operator:
        return _realise(tree, _DUAL[operator], first, wanted.reciprocal())
    types = [_fraction_type(part, operator, first) for part in tree[1:]]
    constants, slopes = (max(1, sum(each[i] for each in types)) for i in (0, 1))
    terms = iter(wanted.terms)
    parts = [
        _Fractions(
            wanted.constant / constants * has_constant, wanted.slope / slopes * has_slope, tuple(islice(terms, n))
        )
        for has_constant, has_slope, n in types
    ]
    return (operator, *[_realise(part, operator, first, each) for part, each in zip(tree[1:], parts, strict=True)])


def _fraction_type(tree: Tree, operator: str, first: str) -> tuple[bool, bool, int]:
    """Whether these partial fractions have a constant and a slope, and the number of their terms."""
    if isinstance(tree, str):
        return tree == first, tree != first, 0
    if tree[0] != operator:
        constant, slope, terms = _fraction_type(tree, _DUAL[operator], first)
        return not slope, not constant, terms - 1 + constant + slope
    types = [_fraction_type(part, operator, first) for part in tree[1:]]
    return any(each[0] for each in types), any(each[1] for each in types), sum(each[2] for each in types)


def _foster_forms(tree: Tree) -> Iterator[Tree]:
    """Foster's parallel and series forms of a series-parallel network of one or two kinds, without values."""
    kinds = sorted(set(leaves(tree)), key=_LINEAR.index)
    for operator, dual in _DUAL.items():
        constant, slope, terms = _fraction_type(tree, operator, kinds[0])
        parts = [kinds[0]] * constant + [kinds[-1]] * slope + [(dual, *kinds)] * terms
        yield canonical_tree((operator, *parts)) if len(parts) > 1 else parts[0]


# Chains of steps


def _convert(group: Tree, form: Tree) -> Tree:
    """The form of a group of elements, with the values that follow from those of the group."""
    if form == group:
        return group
    if not isinstance(form, str) and form[0] == BRIDGE:
        return _to_bridge(group, form)
    kinds = sorted(set(leaves(group)), key=_LINEAR.index)
    if len(kinds) <= 2 and _is_series_parallel(group):
        return _realise(form, PARALLEL, kinds[0], _expand(group, PARALLEL, kinds[0]))
    return next(each for each in _forms(group) if each == form)


def _replace_group(tree: Tree, step: _Step) -> Tree:
    for group, rebuild in _groups(tree):
        if group == step.before and rebuild(step.after) == step.result:
            return rebuild(_convert(group, step.after))
    raise AssertionError(f"{step.before!r} is no part of {tree!r}")


def _find_path(one: Tree, other: Tree) -> list[_Step]:
    """Steps from one tree to another, by the steps from each that add no element and their inverses."""
    neighbours: dict[Tree, list[_Step]] = {one: [], other: []}
    pending = [one, other]
    while pending:
        tree = pending.pop()
        for step in _steps(tree):
            if step.result not in neighbours:
                neighbours[step.result] = []
                pending.append(step.result)
            neighbours[tree].append(step)
            neighbours[step.result].append(_Step(step.after, step.before, tree))
    came_by: dict[Tree, tuple[Tree, _Step] | None] = {one: None}
    queue = deque([one])
    while queue:
        tree = queue.popleft()
        for step in neighbours[tree]:
            if step.result not in came_by:
                came_by[step.result] = (tree, step)
                queue.append(step.result)
    if other not in came_by:
        raise NetworkError(
            f"No transformation of {Topology(one).expression!r} to {Topology(other).expression!r} is known. "
            f"Use two networks of one class of equivalence_classes(...)."
        )
    path: list[_Step] = []
    while (previous := came_by[other]) is not None:
        other, step = previous
        path.append(step)
    return path[::-1]
