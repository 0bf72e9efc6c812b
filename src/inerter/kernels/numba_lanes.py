"""The compiler's type of a number in several lanes: vectors of LLVM, and arithmetic for them."""

from __future__ import annotations

import operator
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.registry import cpu_target
from numba.core.typeconv import Conversion
from numba.core.typing.templates import ConcreteTemplate, infer_global, signature
from numba.extending import lower_builtin, lower_cast, make_attribute_wrapper, models, register_model  # noqa: F401
from numba.np.arrayobj import make_array, populate_array

ARITHMETIC = {"add": "fadd", "sub": "fsub", "mul": "fmul", "truediv": "fdiv"}


class LanesType(types.Type):  # type: ignore[misc]
    """As many numbers as there are lanes."""

    def __init__(self, width: int) -> None:
        super().__init__(name=f"Lanes({width})")
        self.width = width

    @property
    def key(self) -> int:
        return self.width

    def can_convert_from(self, typingctx: Any, other: Any) -> Any:
        return Conversion.safe if isinstance(other, (types.Float, types.Integer)) else None

    def unify(self, typingctx: Any, other: Any) -> Any:
        return self if isinstance(other, (types.Float, types.Integer)) else None


@register_model(LanesType)
class _LanesModel(models.PrimitiveModel):  # type: ignore[misc]
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, ir.VectorType(ir.DoubleType(), kind.width))


LANES: dict[int, Any] = {}


@lower_cast(types.Float, LanesType)
@lower_cast(types.Integer, LanesType)
def _spread(context: Any, builder: Any, given: Any, wanted: Any, value: Any) -> Any:
    number = context.cast(builder, value, given, types.float64)
    vector = ir.VectorType(ir.DoubleType(), wanted.width)
    one = builder.insert_element(ir.Constant(vector, ir.Undefined), number, ir.Constant(ir.IntType(32), 0))
    mask = ir.Constant(ir.VectorType(ir.IntType(32), wanted.width), [0] * wanted.width)
    return builder.shuffle_vector(one, ir.Constant(vector, ir.Undefined), mask)


def lanes_type(width: int) -> Any:
    """The type of numbers in `width` lanes, with its arithmetic."""
    if width not in LANES:
        LANES[width] = kind = LanesType(width)
        _declare(kind)
        cpu_target.typing_context.refresh()
        cpu_target.target_context.refresh()
    return LANES[width]


def _declare(kind: Any) -> None:
    for name, instruction in ARITHMETIC.items():
        for prefix in ("", "i"):
            _binary(getattr(operator, prefix + name), kind, instruction)
    _unary(operator.neg, kind, lambda builder, x: builder.fneg(x))
    _unary(abs, kind, lambda builder, x: builder.call(_intrinsic(builder, "llvm.fabs", x), [x]))


def _binary(of: Any, kind: Any, instruction: str) -> None:
    @infer_global(of)
    class _Typing(ConcreteTemplate):  # type: ignore[misc]
        cases = [signature(kind, kind, kind)]  # noqa: RUF012

    @lower_builtin(of, kind, kind)
    def code(context: Any, builder: Any, sig: Any, given: Any) -> Any:
        return getattr(builder, instruction)(*given)


def _unary(of: Any, kind: Any, make: Any) -> None:
    @infer_global(of)
    class _Typing(ConcreteTemplate):  # type: ignore[misc]
        cases = [signature(kind, kind)]  # noqa: RUF012

    @lower_builtin(of, kind)
    def code(context: Any, builder: Any, sig: Any, given: Any) -> Any:
        return make(builder, *given)


def _intrinsic(builder: Any, name: str, *given: Any) -> Any:
    kind = given[0].type
    suffix = f"v{kind.count}f64" if isinstance(kind, ir.VectorType) else "f64"
    return cgutils.get_or_insert_function(builder.module, ir.FunctionType(kind, [kind] * len(given)), f"{name}.{suffix}")


def _same(*given: Any) -> Any:
    """The type in which numbers meet: that of lanes if one of them has it."""
    return next((each for each in given if isinstance(each, LanesType)), types.float64)


def is_between(x: Any, low: Any, high: Any) -> Any:
    """Signature and code of `lanes.is_between`."""
    kind = _same(x, low, high)

    def code(context: Any, builder: Any, sig: Any, given: Any) -> Any:
        value, below, above = given
        one, zero = (context.cast(builder, context.get_constant(types.float64, v), types.float64, kind) for v in (1.0, 0.0))
        inside = builder.and_(
            builder.fcmp_ordered("<", below, value), builder.fcmp_ordered("<", value, above)
        )
        return builder.select(inside, one, zero)

    return kind(kind, kind, kind), code


def larger(x: Any, y: Any) -> Any:
    """Signature and code of `lanes.larger`."""
    kind = _same(x, y)

    def code(context: Any, builder: Any, sig: Any, given: Any) -> Any:
        return builder.select(builder.fcmp_ordered(">", *given), *given)

    return kind(kind, kind), code


def choose(condition: Any, x: Any, y: Any) -> Any:
    """Signature and code of `lanes.choose`."""
    kind = _same(condition, x, y)

    def code(context: Any, builder: Any, sig: Any, given: Any) -> Any:
        zero = context.cast(builder, context.get_constant(types.float64, 0.0), types.float64, kind)
        return builder.select(builder.fcmp_unordered("!=", given[0], zero), given[1], given[2])

    return kind(kind, kind, kind), code


def largest_lane(x: Any) -> Any:
    """Signature and code of `lanes.largest_lane`."""

    def code(context: Any, builder: Any, sig: Any, given: Any) -> Any:
        value = given[0]
        if not isinstance(value.type, ir.VectorType):
            return value
        while value.type.count > 1:  # halves against each other
            half, places = value.type.count // 2, ir.IntType(32)
            parts = [
                builder.shuffle_vector(
                    value, value, ir.Constant(ir.VectorType(places, half), list(range(start, start + half)))
                )
                for start in (0, half)
            ]
            value = builder.select(builder.fcmp_ordered(">", *parts), *parts)
        return builder.extract_element(value, ir.Constant(ir.IntType(32), 0))

    return types.float64(_same(x)), code


def fused_multiply_add(a: Any, b: Any, c: Any) -> Any:
    """Signature and code of `double_double.fused_multiply_add`."""
    kind = _same(a, b, c)

    def code(context: Any, builder: Any, sig: Any, given: Any) -> Any:
        return builder.call(_intrinsic(builder, "llvm.fma", *given), list(given))

    return kind(kind, kind, kind), code


def root(x: Any) -> Any:
    """Signature and code of `lanes.root`."""
    kind = _same(x)

    def code(context: Any, builder: Any, sig: Any, given: Any) -> Any:
        return builder.call(_intrinsic(builder, "llvm.sqrt", given[0]), list(given))

    return kind(kind), code


def in_lanes(flat: Any, shape: Any, width: int) -> Any:
    """Signature and code of `lanes.in_lanes`: the room is used from the first multiple of 64 bytes on."""
    kind = types.Array(lanes_type(width), shape.count, "C", aligned=False)

    def code(context: Any, builder: Any, sig: Any, given: Any) -> Any:
        room = make_array(flat)(context, builder, given[0])
        address = builder.ptrtoint(room.data, cgutils.intp_t)
        data = builder.and_(builder.add(address, cgutils.intp_t(63)), cgutils.intp_t(-64))
        sizes = cgutils.unpack_tuple(builder, given[1])
        return _view(context, builder, room, data, kind, sizes, 8 * width)

    return kind(flat, shape), code


def in_numbers(lanes: Any) -> Any:
    """Signature and code of `lanes.in_numbers`."""
    kind, width = types.Array(types.float64, 2, "C"), lanes.dtype.width

    def code(context: Any, builder: Any, sig: Any, given: Any) -> Any:
        room = make_array(lanes)(context, builder, given[0])
        data = builder.ptrtoint(room.data, cgutils.intp_t)
        (count,) = cgutils.unpack_tuple(builder, room.shape)
        return _view(context, builder, room, data, kind, [count, cgutils.intp_t(width)], 8)

    return kind(lanes), code


def _view(context: Any, builder: Any, room: Any, data: Any, kind: Any, sizes: list[Any], item: int) -> Any:
    """Array of another type in the memory of one, from an address on."""
    result = make_array(kind)(context, builder)
    stride, strides = cgutils.intp_t(item), list[Any]()
    for size in reversed(sizes):
        strides.insert(0, stride)
        stride = builder.mul(stride, size)
    place = builder.inttoptr(data, result.data.type)
    memory = room.meminfo
    populate_array(result, place, sizes, strides, cgutils.intp_t(item), memory)
    if context.enable_nrt:
        context.nrt.incref(builder, types.MemInfoPointer(types.voidptr), memory)
    return result._getvalue()
