"""How the kernels are compiled: stages that vectorise, entries that are cached on disk.

A *stage* is one piece of physics. Two settings make it fast. Its array arguments are declared not
to overlap, without which LLVM cannot vectorise a loop over more than a handful of rows; and it is
inlined into its caller by LLVM, which keeps dozens of array descriptors out of the call. Numba has
the first only as a flag of its compiler pipeline, so a pipeline of our own sets it.

A processor keeps a few hundred instructions in flight, and a loop is fast if its iterations overlap:
a long chain of dependent operations, such as an inverse root followed by a polynomial, should be a
stage of its own with a short body, rather than part of a long one.

An *entry* is a function that Python calls; its machine code is cached on disk (`.cache`).
"""

import importlib
from collections.abc import Callable
from typing import Any

import numba
import numpy as np
from numba import _dynfunc  # type: ignore[attr-defined]  # a C extension
from numba.core import lowering
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import register_pass
from numba.core.typed_passes import NativeLowering

from ..model import LEAD
from .cache import EntryCache

# Slots are unsigned integers: Numba wraps negative indices around, and loops do not vectorise unless
# LLVM can prove that a signed index is not negative.
ONE = np.uint64(1)
FIRST = np.uint64(LEAD)

# only contraction into multiply-adds is allowed: reassociation would cost reproducibility
# (nothing is allocated, so arrays need no reference counts, which would take half of the step)
_COMMON: dict[str, Any] = {
    "_nrt": False,
    "nogil": True,
    "error_model": "numpy",
    "fastmath": {"contract"},
    "no_cfunc_wrapper": True,
}
# functions that only kernels call need no Python wrapper, which for a Model and a State takes long to compile
_INNER: dict[str, Any] = {**_COMMON, "no_cpython_wrapper": True}


class _WideLowering(lowering.Lower):
    """Numba's lowering, with 512-bit vectors allowed on CPUs that have them.

    By default LLVM uses 256 bits on most of these CPUs, which costs the step a third of its speed.
    On other CPUs the attribute has no effect.
    """

    def setup_function(self, fndesc: Any) -> None:
        super().setup_function(fndesc)
        # llvmlite supports only attributes without a value, and writes this one verbatim
        set.add(self.function.attributes, '"prefer-vector-width"="512"')


class _EntryLibrary(JITCodeLibrary):
    """The code of an entry, optimised as a whole, once.

    Numba also optimises each function beforehand, and the whole cheaply, to prune reference counts.
    """

    def _optimize_functions(self, ll_module: Any) -> None:
        ll_module.data_layout = self._codegen._data_layout

    def _optimize_final_module(self) -> None:
        manager, builder = self._codegen._module_pass_manager()
        manager.run(self._final_module, builder)


class _StageLibrary(_EntryLibrary):
    """The code of a stage, vectorised by itself, independently of the entry around it."""

    def _finalize_final_module(self) -> None:
        """Skip machine code, which takes long to generate: only entries are called."""
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True


class _PartLibrary(_StageLibrary):
    """The code of other parts of entries, optimised there."""

    def _optimize_final_module(self) -> None:
        pass


@register_pass(mutates_CFG=True, analysis_only=False)
class _EntryLowering(NativeLowering):
    def run_pass(self, state: Any) -> bool:
        state.library = _EntryLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
        state.library.enable_object_caching()
        return super().run_pass(state)


@register_pass(mutates_CFG=True, analysis_only=False)
class _PartLowering(NativeLowering):
    library_class: type[_StageLibrary] = _PartLibrary

    def run_pass(self, state: Any) -> bool:
        state.library = self.library_class(state.targetctx.codegen(), state.func_id.func_qualname)
        state.flags.no_compile = True
        super().run_pass(state)
        state.library.finalize()
        # callers find the code by a handle, which without machine code is a dummy
        result = state["cr"]
        handle = _dynfunc.make_function(result.fndesc.lookup_module(), state.func_id.func_name, "", 0, result.env, ())
        state.targetctx.insert_user_function(handle, result.fndesc, [state.library])
        state["cr"] = result._replace(cfunc=handle)
        return True


@register_pass(mutates_CFG=True, analysis_only=False)
class _StageLowering(_PartLowering):
    library_class = _StageLibrary

    @property
    def lowering_class(self) -> type:
        return _WideLowering


class _Pipeline(CompilerBase):
    """Numba's default pipeline, with a lowering of our own."""

    lowering_pass: type[NativeLowering]

    def define_pipelines(self) -> list:
        manager = DefaultPassBuilder.define_nopython_pipeline(self.state)
        manager.passes = [
            (self.lowering_pass, name) if each is NativeLowering else (each, name) for each, name in manager.passes
        ]
        return [manager]


class _EntryPipeline(_Pipeline):
    lowering_pass = _EntryLowering


class _PartPipeline(_Pipeline):
    lowering_pass = _PartLowering


class _StagePipeline(_Pipeline):
    """With wide vectors, and the promise that no two array arguments overlap."""

    lowering_pass = _StageLowering

    def define_pipelines(self) -> list:
        self.state.flags.noalias = True
        return super().define_pipelines()


def stage(function: Callable) -> Callable:
    """Compile one stage of the step; no two arguments may overlap."""
    return numba.njit(pipeline_class=_StagePipeline, forceinline=True, **_INNER)(function)


def inline(function: Callable) -> Callable:
    """Compile a function that only kernels call, inlined into them: a driver of stages, or scalar physics."""
    return numba.njit(pipeline_class=_PartPipeline, forceinline=True, **_INNER)(function)


def apart(function: Callable) -> Callable:
    """Compile a function that kernels call without inlining: physics of few models, which would bloat the step."""
    return numba.njit(pipeline_class=_PartPipeline, **_INNER)(function)


def entry(function: Callable) -> Callable:
    """Compile a function that Python calls, cached on disk and announced when it is compiled."""
    dispatcher = numba.njit(pipeline_class=_EntryPipeline, **_COMMON)(function)
    dispatcher._cache = EntryCache(dispatcher.py_func)
    return dispatcher


class Bound:
    """An entry with its first arguments bound, for frequent calls.

    Numba determines the types of the arguments at each call, which for the arrays of a Model and a State takes longer
    than the call itself. Here it does so once: the other arguments must have the same types at each call.
    """

    def __init__(self, function: Any, *arguments: Any) -> None:
        self._function, self._arguments = function, arguments
        self._code: Callable | None = None

    def __call__(self, *others: Any) -> Any:
        """Call the entry with all its arguments."""
        if self._code is None:
            types = tuple(numba.typeof(each) for each in (*self._arguments, *others))
            self._code = self._function.compile(types)
        return self._code(*self._arguments, *others)

    def __reduce__(self) -> tuple[Any, ...]:
        # a copy, here or in another process, looks the code up again
        return _bind, (self._function.__module__, self._function.__name__, *self._arguments)


def _bind(module: str, name: str, *arguments: Any) -> Bound:
    return Bound(getattr(importlib.import_module(module), name), *arguments)
