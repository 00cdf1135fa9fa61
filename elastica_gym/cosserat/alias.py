"""Alias the name ``elastica`` to this library, so that PyElastica scripts run unchanged.

``python -m elastica_gym.cosserat script.py [arguments]`` runs a script this way; in a notebook or a test, call
`stand_in_for_elastica` before the first import.
"""

import importlib
import os
import sys
from collections import defaultdict
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any

import numpy as np

NAME, LIBRARY = "elastica", __package__


def stand_in_for_elastica() -> None:
    """Make ``import elastica`` and imports from it return this library from now on.

    Raises
    ------
    RuntimeError
        If PyElastica itself is already imported.
    """
    found = sys.modules.get(NAME)
    if found is not None and not isinstance(found, _Alias):
        raise RuntimeError(f"{NAME} is already imported, from {found.__file__}; call this before")
    if not any(isinstance(finder, _Finder) for finder in sys.meta_path):
        sys.meta_path.insert(0, _Finder())


class _Alias(ModuleType):
    """The package under its alias, with its attributes and those that PyElastica's star import leaks."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self._library = importlib.import_module(LIBRARY)
        self.np, self.os, self.defaultdict = np, os, defaultdict
        self.__all__ = [*self._library.__all__, "np", "os", "defaultdict"]

    def __getattr__(self, name: str) -> Any:
        return getattr(self._library, name)


class _Finder(MetaPathFinder, Loader):
    """Finds the library's modules under the alias, as the same objects."""

    def find_spec(self, fullname: str, path: Any = None, target: Any = None) -> ModuleSpec | None:
        if fullname != NAME and not fullname.startswith(f"{NAME}."):
            return None
        return ModuleSpec(fullname, self, is_package=fullname == NAME)

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        return _Alias(spec.name) if spec.name == NAME else None

    def exec_module(self, module: ModuleType) -> None:
        # the import returns whatever is in sys.modules afterwards
        if module.__name__ != NAME:
            sys.modules[module.__name__] = importlib.import_module(LIBRARY + module.__name__.removeprefix(NAME))
