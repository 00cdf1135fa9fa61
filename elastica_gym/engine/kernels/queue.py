"""A queue of environments, from which threads take one at a time."""

from llvmlite import ir
from numba import types
from numba.core.types import int64
from numba.extending import intrinsic


@intrinsic
def fetch_add(typing_context, queue):
    """Atomically increment the int64 in a one-element array and return its old value; no two threads get the same."""
    if not (isinstance(queue, types.Array) and queue.dtype == int64):
        return None

    def generate(context, builder, signature, arguments):
        counter = context.make_array(signature.args[0])(context, builder, arguments[0]).data
        return builder.atomic_rmw("add", counter, ir.Constant(ir.IntType(64), 1), "monotonic")

    return int64(queue), generate
