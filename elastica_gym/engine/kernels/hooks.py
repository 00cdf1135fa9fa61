"""Calls from compiled code into Python: of a C function by its address."""

from llvmlite import ir
from numba import types
from numba.core.types import float64, int64
from numba.extending import intrinsic


@intrinsic
def call(typing_context, address, time):
    """Call the function at ``address`` with a time and return its status, an int64."""
    if not (isinstance(address, types.Integer) and isinstance(time, types.Float)):
        return None

    def generate(context, builder, signature, arguments):
        function = ir.FunctionType(ir.IntType(64), [ir.DoubleType()])
        where = builder.inttoptr(arguments[0], function.as_pointer())
        return builder.call(where, [arguments[1]])

    return int64(int64, float64), generate
