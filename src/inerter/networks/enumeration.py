"""Enumeration of networks: every way to connect a number of springs, dampers and inerters, each once."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence, Set
from dataclasses import dataclass
from functools import cached_property, lru_cache, reduce
from itertools import chain, combinations, combinations_with_replacement, product
from operator import or_, sub
from typing import Any, TypeAlias

from inerter.errors import NetworkError
from inerter.networks.elements import ELEMENT_TYPES, Bridge, Damper, Element, Inerter, Network, Spring
from inerter.validation import checked, is_listed, is_whole

Tree: TypeAlias = Any  # a leaf is the symbol of an element; else (operator, part, part, ...) with an operator below
PARALLEL, SERIES, BRIDGE = OPERATORS = ("|", "-", "bridge")  # a bridge has five arms, as `Bridge`

_MOST = 20  # elements, far beyond what any computer can list
_RANK = {kind.symbol: rank for rank, kind in enumerate(ELEMENT_TYPES)}


@dataclass(frozen=True)
class Topology:
    """A network without values: the kinds of its elements and their connection, in canonical form.

    `tree` is the symbol of an element ("k", "c", "b") or an operator and its parts: ("|", "k", ("-", "c", "b")). A
    bridge has the operator "bridge" and five arms. Trees that differ only in the order of parts, or in the symmetric
    arrangements of a bridge, give equal topologies. Topologies are ordered by size, then by expression.

    >>> Topology(("|", ("-", "b", "c"), "k"))
    Topology('k1 | c1 - b1')
    """

    tree: Tree

    def __post_init__(self) -> None:
        object.__setattr__(self, "tree", canonical_tree(self.tree))

    def __repr__(self) -> str:
        return f"Topology({self.expression!r})"

    def __lt__(self, other: Topology) -> bool:
        return (self.size, self.expression) < (other.size, other.expression)

    @property
    def kinds(self) -> tuple[str, ...]:
        """Symbols of the elements in the order of the expression."""
        return tuple(leaves(self.tree))

    @property
    def size(self) -> int:
        """Number of elements."""
        return len(self.kinds)

    @property
    def counts(self) -> Counter[str]:
        """Number of elements by symbol."""
        return Counter(self.kinds)

    def names(self, taken: Set[str] = frozenset()) -> tuple[str, ...]:
        """Names of the elements in the order of the expression, numbered by kind, without those `taken`.

        >>> Topology(("|", "k", ("-", "c", "b"))).names(taken={"k1"})
        ('k2', 'c1', 'b1')
        """
        used: Counter[str] = Counter()
        return tuple(_numbered_name(symbol, used, taken) for symbol in self.kinds)

    @cached_property
    def expression(self) -> str:
        """The network in the syntax of `network`, with these names: "k1 | c1 - b1"."""
        return self.format_expression(self.names())

    def format_expression(self, names: Sequence[str]) -> str:
        """The expression with other names, one for each element in the order of the expression."""
        rest = iter(names)

        def text(tree: Tree, inside: str) -> str:
            if isinstance(tree, str):
                return next(rest)
            operator, *parts = tree
            if operator == BRIDGE:
                return f"bridge({', '.join([text(part, '') for part in parts])})"
            joined = f" {operator} ".join([text(part, operator) for part in parts])
            return f"({joined})" if inside == SERIES else joined

        return text(self.tree, "")

    def network(self, elements: Sequence[Network]) -> Network:
        """The network of these elements, given in the order of the expression.

        Raises `NetworkError` if their number is not that of the elements.

        >>> Topology(("|", "k", ("-", "c", "b"))).network([Spring(1e5), Damper(2e3), Inerter(30.0)])
        Parallel(parts=(Spring(stiffness=100000.0, name=None), Series(parts=(Damper(damping=2000.0, name=None),
        Inerter(inertance=30.0, name=None)))))
        """
        if len(elements) != self.size:
            raise NetworkError(
                f"Network {self.expression!r} requires {self.size} elements, one for each name; got {len(elements)}."
            )
        rest = iter(elements)

        def build(tree: Tree) -> Network:
            if isinstance(tree, str):
                return next(rest)
            operator, *parts = tree
            return _JOIN[operator]([build(part) for part in parts])

        return build(self.tree)


@checked(NetworkError)
def enumerate_networks(
    elements: int,
    *,
    kinds: Sequence[type[Element]] = (Spring, Damper, Inerter),
    like_neighbours: bool = False,
    bridges: bool = False,
) -> Iterator[Topology]:
    """Every network of this number of elements, each once, ordered by expression.

    Networks are combined in parallel and in series, with `bridges` also by bridges. Elements of one kind next to each
    other in one parallel or series connection act as one element and are left out unless `like_neighbours`.

    Raises `NetworkError` if the number of elements is not a positive integer, or the kinds are not different kinds of
    elements.

    >>> [topology.expression for topology in enumerate_networks(2)]
    ['c1 - b1', 'c1 | b1', 'k1 - b1', 'k1 - c1', 'k1 | b1', 'k1 | c1']
    >>> [len(list(enumerate_networks(n))) for n in (1, 2, 3, 4)]
    [3, 6, 20, 90]
    """
    if not is_whole(elements, 1, _MOST):
        raise NetworkError(
            f"The number of elements must be a positive integer such as 4, of at most {_MOST}, got {elements!r}."
        )
    checked = tuple(kinds) if is_listed(kinds) else ()
    if not checked or not all(isinstance(kind, type) and issubclass(kind, Element) for kind in checked):
        raise NetworkError(f"kinds must be kinds of elements such as (Spring, Damper, Inerter), got {kinds!r}.")
    symbols = [kind.symbol for kind in checked]
    if len(set(symbols)) < len(symbols):
        raise NetworkError(f"kinds must differ, got {', '.join(kind.__name__ for kind in checked)}.")
    return iter(sorted(map(Topology, _Trees(symbols, like_neighbours, bridges).of_size(int(elements)))))


class _Trees:
    """Canonical trees by outermost operator and number of elements; the smaller ones are kept."""

    def __init__(self, symbols: Sequence[str], like_neighbours: bool, bridges: bool) -> None:
        self.symbols = list(symbols)
        self.like_neighbours = like_neighbours
        self.operators = OPERATORS if bridges else (PARALLEL, SERIES)
        self.known: dict[tuple[str, int], list[Tree]] = {}

    def of_size(self, size: int) -> Iterator[Tree]:
        if size == 1:
            return iter(self.symbols)
        return chain.from_iterable(self._combinations(operator, size) for operator in self.operators)

    def _combinations(self, operator: str, size: int) -> Iterator[Tree]:
        """Trees of two or more elements with this outermost operator."""
        if operator == BRIDGE:
            return self._bridges(size)
        return (
            canonical_tree((operator, *parts))
            for sizes in _partitions(size, size - 1)
            for parts in self._part_selections(operator, sizes)
        )

    def _part_selections(self, operator: str, sizes: Sequence[int]) -> Iterator[tuple[Tree, ...]]:
        """Parts of these sizes in every selection, without regard to order."""
        selections = (self._select(operator, size, number) for size, number in Counter(sizes).items())
        return (tuple(chain.from_iterable(selected)) for selected in product(*selections))

    def _select(self, operator: str, size: int, number: int) -> Iterator[tuple[Tree, ...]]:
        if size == 1 and not self.like_neighbours:
            return combinations(self.symbols, number)
        return combinations_with_replacement(self._parts(size, without=operator), number)

    def _bridges(self, size: int) -> Iterator[Tree]:
        for sizes in product(range(1, size - 3), repeat=5):
            if sum(sizes) == size:
                for arms in product(*map(self._parts, sizes)):
                    if canonical_tree((BRIDGE, *arms)) == (BRIDGE, *arms):
                        yield (BRIDGE, *arms)

    def _parts(self, size: int, without: str = "") -> list[Tree]:
        """Trees of this size but those with one outermost operator."""
        if size == 1:
            return self.symbols
        return [
            tree for operator in self.operators if operator != without for tree in self._known_trees(operator, size)
        ]

    def _known_trees(self, operator: str, size: int) -> list[Tree]:
        if (operator, size) not in self.known:
            self.known[operator, size] = list(self._combinations(operator, size))
        return self.known[operator, size]


def _partitions(total: int, largest: int) -> Iterator[tuple[int, ...]]:
    """Partitions of `total` into parts of at most `largest`, in descending order."""
    if total == 0:
        yield ()
    for part in range(min(total, largest), 0, -1):
        for rest in _partitions(total - part, part):
            yield (part, *rest)


def canonical_tree(tree: Tree) -> Tree:
    """The tree with nested connections of one operator merged, parts sorted, and bridges in one of four arrangements.

    Raises `NetworkError` if `tree` is not a tree.
    """
    if isinstance(tree, str):
        return tree
    if not _is_node(tree):
        raise NetworkError(
            f"A tree must be a symbol such as 'k', or an operator and its parts such as ('|', 'k', ('-', 'c', 'b')), "
            f"('bridge', 'k', 'c', 'b', 'c', 'k'); got {tree!r}."
        )
    operator, *parts = tree[0], *map(canonical_tree, tree[1:])
    if operator == BRIDGE:
        return (BRIDGE, *min(arrangements(parts), key=lambda arms: [_order(arm) for arm in arms]))
    flat = chain.from_iterable(part[1:] if part[0] == operator else (part,) for part in parts)
    return (operator, *sorted(flat, key=_order))


def _is_node(tree: Tree) -> bool:
    if not isinstance(tree, tuple) or not tree or tree[0] not in OPERATORS:
        return False
    return len(tree) == 6 if tree[0] == BRIDGE else len(tree) > 2


def arrangements(arms: Sequence[Tree]) -> Iterator[tuple[Tree, ...]]:
    """Arms of the same bridge with its sides, its ends, or both exchanged."""
    a, b, c, d, e = arms
    yield from ((a, b, c, d, e), (c, d, a, b, e), (b, a, d, c, e), (d, c, b, a, e))


@lru_cache(maxsize=1 << 16)
def _order(tree: Tree) -> tuple[Any, ...]:
    """Sort key of a part: elements first, by kind; else by size."""
    if isinstance(tree, str):
        return 1, _RANK.get(tree, len(_RANK)), tree
    return sum(1 for _ in leaves(tree)), OPERATORS.index(tree[0]), *map(_order, tree[1:])


def leaves(tree: Tree) -> Iterator[str]:
    """The elements of a tree from left to right."""
    if isinstance(tree, str):
        yield tree
    else:
        for part in tree[1:]:
            yield from leaves(part)


def _numbered_name(symbol: str, used: Counter[str], taken: Set[str]) -> str:
    """Next name of an element of a kind that is not `taken`; counts in `used`."""
    used[symbol] += 1
    name = f"{symbol}{used[symbol]}"
    return _numbered_name(symbol, used, taken) if name in taken else name


_JOIN: dict[str, Callable[[Sequence[Network]], Network]] = {
    PARALLEL: lambda parts: reduce(or_, parts),
    SERIES: lambda parts: reduce(sub, parts),
    BRIDGE: lambda arms: Bridge(*arms),
}
