"""Chooses between the compiled and the interpreted kernel when `cnc_ptp` is imported."""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Sequence
from importlib import import_module
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import EXTENSION_SUFFIXES, ExtensionFileLoader, ModuleSpec
from importlib.util import spec_from_loader
from types import ModuleType

from cnc_ptp.compiled.sources import LIBRARY, NAME, PACKAGE, built_hashes, hashes, sources

INTERPRET = "CNC_PTP_PURE"
"""Environment variable: 1 chooses the interpreted kernel."""


class KernelFinder(MetaPathFinder, Loader):
    """Finds the modules of the compiled kernel in its library."""

    def __init__(self, modules: Sequence[str]) -> None:
        self._modules = frozenset(modules)
        self._library = str(LIBRARY / f"{NAME}{EXTENSION_SUFFIXES[0]}")

    def find_spec(self, name: str, path: object = None, target: object = None) -> ModuleSpec | None:
        if name in self._modules:
            return spec_from_loader(name, self, origin=self._library)
        if name == NAME:
            return spec_from_loader(name, ExtensionFileLoader(name, self._library), origin=self._library)
        return None

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        """Lets the library make and execute a module, as mypyc's own shim per module does."""
        capsule_name = f"{NAME}.init_{spec.name.replace('.', '___')}"
        capsule = getattr(import_module(NAME), capsule_name.partition(".")[2])
        pointer = ctypes.pythonapi.PyCapsule_GetPointer
        pointer.restype, pointer.argtypes = ctypes.c_void_p, (ctypes.py_object, ctypes.c_char_p)
        initialise = ctypes.PYFUNCTYPE(ctypes.py_object)(pointer(capsule, capsule_name.encode()))
        module: ModuleType = initialise()
        return module

    def exec_module(self, module: ModuleType) -> None:
        """It has been executed already."""


def choose_kernel() -> str:
    """Installs the finder when the library is what the sources are; returns why not otherwise."""
    if os.environ.get(INTERPRET, "") not in ("", "0"):
        return f"{INTERPRET} is set"
    built = built_hashes()
    if built is None:
        return "it was not compiled"
    if changed := changes(built, hashes(sources())):
        return f"{changed} since it was compiled"
    sys.meta_path.insert(0, KernelFinder([*built]))
    return ""


def changes(built: dict[str, str], current: dict[str, str]) -> str:
    """What differs between two states of the sources; empty when nothing does."""
    different = [name for name in sorted({*built, *current}) if built.get(name) != current.get(name)]
    if not different:
        return ""
    first = different[0]
    file = f"{PACKAGE.name}/{'/'.join(first.split('.')[1:])}.py"
    verb = "edited" if first in built and first in current else "added" if first in current else "removed"
    more = f" and {len(different) - 1} more" if len(different) > 1 else ""
    return f"{file}{more} was {verb}" if not more else f"{file}{more} were changed"
