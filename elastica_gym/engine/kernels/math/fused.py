"""Fused multiply-add, where the compiler must not choose which operations to fuse."""

from llvmlite import ir
from numba.core.types import float64
from numba.extending import intrinsic

from ...jit.compiler import inline


@intrinsic
def _fused(typing_context, a, b, c):
    def generate(context, builder, signature, arguments):
        double = ir.DoubleType()
        fused = builder.module.declare_intrinsic("llvm.fmuladd", [double], ir.FunctionType(double, [double] * 3))
        return builder.call(fused, arguments)

    return float64(float64, float64, float64), generate


@inline
def multiply_add(a, b, c):
    """Return a b + c, rounded once if the CPU supports it, else twice."""
    return _fused(a, b, c)  # type: ignore[call-arg]  # the compiler adds the first
