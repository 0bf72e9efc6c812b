"""The compiler's type of numbers in several lanes (a vector of LLVM), its arithmetic, and the code of instructions.

A definition gets the typing context of the compiler and the types of its arguments.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from functools import cache
from typing import Any

import numba
from llvmlite import ir as _ir
from numba.core import cgutils as _cgutils
from numba.core import typeconv as _typeconv
from numba.core.registry import cpu_target
from numba.core.typing import templates as _templates
from numba.np import arrayobj as _arrays

from inerter.kernels.lanes import GROUP, WIDTH

types: Any = numba.types
extending: Any = numba.extending
cgutils: Any = _cgutils
templates: Any = _templates
arrays: Any = _arrays
ir: Any = _ir
Conversion: Any = _typeconv.Conversion  # type: ignore[attr-defined]

Definition = tuple[Any, Callable[..., Any]]  # a signature, and the function that writes the code
ARITHMETIC = {"add": "fadd", "sub": "fsub", "mul": "fmul", "truediv": "fdiv"}
_LINE = 64  # bytes of a line of the processor's cache


class LanesType(types.Type):  # type: ignore[misc]
    """A vector of one number for each lane; a scalar stands for a vector of equal numbers."""

    def __init__(self, width: int) -> None:
        super().__init__(name=f"Lanes({width})")
        self.width = width

    def can_convert_from(self, typingctx: Any, other: Any) -> Any:
        return Conversion.safe if isinstance(other, (types.Float, types.Integer)) else None

    def unify(self, typingctx: Any, other: Any) -> Any:
        return self if isinstance(other, (types.Float, types.Integer)) else None


@extending.register_model(LanesType)
class _LanesModel(extending.models.PrimitiveModel):  # type: ignore[misc]
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, ir.VectorType(ir.DoubleType(), kind.width))


def _spread(context: Any, builder: Any, given: Any, wanted: Any, value: Any) -> Any:
    """A number in all lanes."""
    number, vector = context.cast(builder, value, given, types.float64), ir.VectorType(ir.DoubleType(), wanted.width)
    nothing = ir.Constant(vector, ir.Undefined)
    first = builder.insert_element(nothing, number, _places([0]).constant[0])
    return builder.shuffle_vector(first, nothing, _places([0] * wanted.width))


def _places(lanes: list[int]) -> Any:
    """Numbers of lanes, as a constant."""
    return ir.Constant(ir.VectorType(ir.IntType(32), len(lanes)), [ir.Constant(ir.IntType(32), lane) for lane in lanes])


@cache
def lanes_type(width: int) -> Any:
    """The type of numbers in `width` lanes; from now on the compiler knows its arithmetic."""
    kind = LanesType(width)
    for scalar in (types.Float, types.Integer):
        extending.lower_cast(scalar, LanesType)(_spread)
    for name, instruction in ARITHMETIC.items():
        for prefix in ("", "i"):
            _declare(getattr(operator, prefix + name), kind, 2, _instruction, instruction)
    _declare(operator.neg, kind, 1, _instruction, "fneg")
    _declare(abs, kind, 1, _call, "llvm.fabs")
    cpu_target.typing_context.refresh()
    cpu_target.target_context.refresh()
    return kind


def _instruction(name: str, *given: Any) -> Callable[[Any], Any]:
    """An instruction of LLVM."""
    return operator.methodcaller(name, *given)


def _call(name: str, *given: Any) -> Callable[[Any], Any]:
    """Call of a function of LLVM for the type of its arguments."""

    def make(builder: Any) -> Any:
        kind = given[0].type
        suffix = f"v{kind.count}f64" if isinstance(kind, ir.VectorType) else "f64"
        declared = ir.FunctionType(kind, [kind] * len(given))
        return builder.call(cgutils.get_or_insert_function(builder.module, declared, f"{name}.{suffix}"), list(given))

    return make


def _declare(of: Any, kind: Any, arity: int, make: Any, instruction: str) -> None:
    """Declare an operator of Python for lanes: `make` gives its code from the instruction and its arguments."""
    operands = (kind,) * arity

    class _Typing(templates.ConcreteTemplate):  # type: ignore[misc]
        cases = [templates.signature(kind, *operands)]  # noqa: RUF012

    def code(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        return make(instruction, *given)(builder)

    templates.infer_global(of)(_Typing)
    extending.lower_builtin(of, *operands)(code)


def _common(*given: Any) -> Any:
    """The type in which numbers meet: that of lanes if one of them has it."""
    return next((each for each in given if isinstance(each, LanesType)), types.float64)


def _constant(context: Any, builder: Any, kind: Any, value: float) -> Any:
    return context.cast(builder, context.get_constant(types.float64, value), types.float64, kind)


def is_between(typing: Any, x: Any, low: Any, high: Any) -> Definition:
    """Definition of `lanes.is_between`."""
    kind = _common(x, low, high)

    def code(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        value, below, above = given
        inside = builder.and_(builder.fcmp_ordered("<", below, value), builder.fcmp_ordered("<", value, above))
        return builder.select(inside, *(_constant(context, builder, kind, number) for number in (1.0, 0.0)))

    return kind(kind, kind, kind), code


def choose(typing: Any, condition: Any, x: Any, y: Any) -> Definition:
    """Definition of `lanes.choose`."""
    kind = _common(condition, x, y)

    def code(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        return builder.select(
            builder.fcmp_unordered("!=", given[0], _constant(context, builder, kind, 0.0)), *given[1:]
        )

    return kind(kind, kind, kind), code


def larger(typing: Any, x: Any, y: Any) -> Definition:
    """Definition of `lanes.larger`."""
    kind = _common(x, y)

    def code(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        return builder.select(builder.fcmp_ordered(">", *given), *given)

    return kind(kind, kind), code


def smaller(typing: Any, x: Any, y: Any) -> Definition:
    """Definition of `lanes.smaller`."""
    kind = _common(x, y)

    def code(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        return builder.select(builder.fcmp_ordered("<", *given), *given)

    return kind(kind, kind), code


def largest_lane(typing: Any, x: Any) -> Definition:
    """Definition of `lanes.largest_lane`: halves against each other."""

    def code(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        (value,) = given
        if not isinstance(value.type, ir.VectorType):
            return value
        while value.type.count > 1:
            half = value.type.count // 2
            halves = [builder.shuffle_vector(value, value, _places(list(range(k, k + half)))) for k in (0, half)]
            value = builder.select(builder.fcmp_ordered(">", *halves), *halves)
        return builder.extract_element(value, _places([0]).constant[0])

    return types.float64(_common(x)), code


def lane(typing: Any, x: Any, j: Any) -> Definition:
    """Definition of `lanes.lane`."""

    def code(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        return builder.extract_element(*given) if isinstance(x, LanesType) else given[0]

    return types.float64(x, types.int64), code


def root(typing: Any, x: Any) -> Definition:
    """Definition of `lanes.root`."""
    return _definition_of("llvm.sqrt", x)


def fused_multiply_add(typing: Any, a: Any, b: Any, product: Any) -> Definition:
    """Definition of `double_double.fused_multiply_add`."""
    return _definition_of("llvm.fma", a, b, product)


def multiply_add(typing: Any, a: Any, b: Any, c: Any) -> Definition:
    """Definition of `lanes.multiply_add`."""
    return _definition_of("llvm.fmuladd", a, b, c)


def _definition_of(name: str, *operands: Any) -> Definition:
    kind = _common(*operands)

    def code(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        return _call(name, *given)(builder)

    return kind(*[kind] * len(operands)), code


def in_lanes(typing: Any, flat: Any, shape: Any) -> Definition:
    """Definition of `lanes.in_lanes`: the room is used from where the first line of the cache begins."""
    kind = types.Array(lanes_type(WIDTH), shape.count, "C", aligned=False)

    def code(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        room = arrays.make_array(flat)(context, builder, given[0])
        address = builder.add(builder.ptrtoint(room.data, cgutils.intp_t), cgutils.intp_t(_LINE - 1))
        start, sizes = builder.and_(address, cgutils.intp_t(-_LINE)), cgutils.unpack_tuple(builder, given[1])
        return _view(context, builder, room, start, kind, sizes, 8 * WIDTH)

    return kind(flat, shape), code


def in_numbers(typing: Any, lanes: Any) -> Definition:
    """Definition of `lanes.in_numbers`."""
    kind, width = types.Array(types.float64, 2, "C"), lanes.dtype.width

    def code(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        room = arrays.make_array(lanes)(context, builder, given[0])
        start, (count,) = builder.ptrtoint(room.data, cgutils.intp_t), cgutils.unpack_tuple(builder, room.shape)
        return _view(context, builder, room, start, kind, [count, cgutils.intp_t(width)], 8)

    return kind(lanes), code


def as_numbers(typing: Any, array: Any, first: Any, shape: Any) -> Definition:
    """Definition of `lanes.as_numbers`."""
    return _over_numbers(array, shape, 1)


def in_groups(typing: Any, array: Any, first: Any, shape: Any) -> Definition:
    """Definition of `lanes.in_groups`."""
    return _over_numbers(array, shape, GROUP)


def _over_numbers(array: Any, shape: Any, width: int) -> Definition:
    """Numbers of an array in groups of this width."""
    kind = types.Array(lanes_type(width) if width > 1 else types.float64, shape.count, "C", aligned=False)

    def code(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        room, sizes = arrays.make_array(array)(context, builder, given[0]), cgutils.unpack_tuple(builder, given[2])
        sizes[-1] = builder.sdiv(sizes[-1], cgutils.intp_t(width))
        start = builder.ptrtoint(builder.gep(room.data, [given[1]]), cgutils.intp_t)
        return _view(context, builder, room, start, kind, sizes, 8 * width)

    return kind(array, types.int64, shape), code


def constant_at(typing: Any, array: Any, i: Any, j: Any) -> Definition:
    """Definition of `lanes.constant_at`: a load that no store can change."""

    def code(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        room = arrays.make_array(array)(context, builder, given[0])
        shape, strides = (cgutils.unpack_tuple(builder, packed) for packed in (room.shape, room.strides))
        place = cgutils.get_item_pointer2(context, builder, room.data, shape, strides, "C", list(given[1:]))
        value = builder.load(place)
        value.align = 8
        value.set_metadata("invariant.load", builder.module.add_metadata([]))
        return value

    return array.dtype(array, types.int64, types.int64), code


def real_eigenvectors(typing: Any, transposed: Any, real: Any, imaginary: Any, rows: Any) -> Definition:
    """Definition of `eigenproblem.real_eigenvectors`, by LAPACK's dgeev.

    Numba's own `eig` takes matrices as complex for this, in twice the time; the call here is by the symbol that it
    uses.
    """

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        found = [arrays.make_array(t)(context, builder, a) for t, a in zip(signature.args, arguments, strict=True)]
        a, wr, wi, vr = (builder.bitcast(array.data, cgutils.voidptr_t) for array in found)
        n, one = cgutils.unpack_tuple(builder, found[1].shape, 1)[0], context.get_constant(types.intp, 1)
        letters = [ir.Constant(ir.IntType(8), ord(letter)) for letter in "dNV"]
        given = [*letters, n, a, n, wr, wi, vr, one, vr, n]  # left eigenvectors, not asked for, have no place
        kind = ir.FunctionType(ir.IntType(32), [value.type for value in given])
        info = builder.call(cgutils.get_or_insert_function(builder.module, kind, "numba_ez_rgeev"), given)
        return builder.sext(info, ir.IntType(64))

    return types.int64(transposed, real, imaginary, rows), code


def _view(context: Any, builder: Any, room: Any, start: Any, kind: Any, sizes: list[Any], item: int) -> Any:
    """Array of another type in the memory of `room`, from an address on."""
    result, stride, strides = arrays.make_array(kind)(context, builder), cgutils.intp_t(item), list[Any]()
    for size in reversed(sizes):
        strides.insert(0, stride)
        stride = builder.mul(stride, size)
    place, memory = builder.inttoptr(start, result.data.type), room.meminfo
    arrays.populate_array(result, place, sizes, strides, cgutils.intp_t(item), memory)
    if context.enable_nrt:
        context.nrt.incref(builder, types.MemInfoPointer(types.voidptr), memory)
    return result._getvalue()
