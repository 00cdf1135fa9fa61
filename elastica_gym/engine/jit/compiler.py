"""How the kernels are compiled: stages that vectorise, entries that are cached on disk.

A *stage* is one piece of physics. Two settings make it fast. Its array arguments are declared not
to overlap, without which LLVM cannot vectorise a loop over more than a handful of rows; and it is
inlined into its caller by LLVM, which keeps dozens of array descriptors out of the call. Numba has
the first only as a flag of its compiler pipeline, so a pipeline of our own sets it.

A processor keeps some hundred instructions in flight, and a loop is as fast as it can overlap its
turns: a long chain of dependent operations, such as an inverse root followed by a polynomial, makes
a stage of its own with a short body, rather than a part of a long one.

An *entry* is what Python calls; its machine code is kept on disk (`.cache`).
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

# Slots are counted with unsigned integers: a signed index may be negative, which Numba's wrap-around
# must then handle, and loops do not vectorise where LLVM cannot prove that it is not.
ONE = np.uint64(1)
FIRST = np.uint64(LEAD)

# contraction into multiply-adds is all that is relaxed: reassociation would cost reproducibility
# (and nothing is allocated, so that arrays need no reference counts: they would take half of the step)
_COMMON: dict[str, Any] = {
    "_nrt": False,
    "nogil": True,
    "error_model": "numpy",
    "fastmath": {"contract"},
    "no_cfunc_wrapper": True,
}
# what only kernels call needs no way in from Python, which for a Model and a State takes long to compile
_INNER: dict[str, Any] = {**_COMMON, "no_cpython_wrapper": True}


class _WideLowering(lowering.Lower):
    """Numba's lowering, with leave for LLVM to use all 512 bits of a CPU that has them.

    By default LLVM keeps to 256 bits on most of these CPUs, which costs the step a third of its speed.
    Elsewhere the attribute is without effect.
    """

    def setup_function(self, fndesc: Any) -> None:
        super().setup_function(fndesc)
        # llvmlite knows only attributes without a value, and lists this one as it stands
        set.add(self.function.attributes, '"prefer-vector-width"="512"')


class _EntryLibrary(JITCodeLibrary):
    """The code of an entry, optimised as a whole, once.

    Numba also optimises each function before, and all of it cheaply, to find reference counts that cancel.
    """

    def _optimize_functions(self, ll_module: Any) -> None:
        ll_module.data_layout = self._codegen._data_layout

    def _optimize_final_module(self) -> None:
        manager, builder = self._codegen._module_pass_manager()
        manager.run(self._final_module, builder)


class _StageLibrary(_EntryLibrary):
    """The code of a stage, vectorised by itself: what surrounds it in an entry has no part in that."""

    def _finalize_final_module(self) -> None:
        """Make no machine code, which takes long: only entries are called."""
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True


class _PartLibrary(_StageLibrary):
    """The code of what else is part of entries, and is optimised there."""

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
        # callers find the code by a handle, which without machine code there is only in name
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
    """Compile one stage of the step; its caller promises that no two arguments overlap."""
    return numba.njit(pipeline_class=_StagePipeline, forceinline=True, **_INNER)(function)


def inline(function: Callable) -> Callable:
    """Compile a function that only kernels call, inlined into them: a driver of stages, or scalar physics."""
    return numba.njit(pipeline_class=_PartPipeline, forceinline=True, **_INNER)(function)


def apart(function: Callable) -> Callable:
    """Compile a function that kernels call, for physics that few models have: it leaves the step's code small."""
    return numba.njit(pipeline_class=_PartPipeline, **_INNER)(function)


def entry(function: Callable) -> Callable:
    """Compile a function that Python calls, cached on disk and announced when it is compiled."""
    dispatcher = numba.njit(pipeline_class=_EntryPipeline, **_COMMON)(function)
    dispatcher._cache = EntryCache(dispatcher.py_func)
    return dispatcher


class Bound:
    """An entry whose first arguments are given, for those who call it often.

    Numba finds out at each call what types the arguments are, which for the arrays of a Model and a State takes it
    longer than to call. Here it does so once: all other arguments have to be of the same types at each call.
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
        # copies, here or in another process, find the code by themselves
        return _bind, (self._function.__module__, self._function.__name__, *self._arguments)


def _bind(module: str, name: str, *arguments: Any) -> Bound:
    return Bound(getattr(importlib.import_module(module), name), *arguments)
