"""Chooses between the compiled and the interpreted kernel when `cnc_ptp` is imported."""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Iterable, Mapping
from importlib import import_module
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ExtensionFileLoader, ModuleSpec
from importlib.util import spec_from_loader
from types import ModuleType

from cnc_ptp.compiled.sources import FAILURE, LIBRARY, NAME, hashes, library_file, read_state, recipe, sources

INTERPRET = "CNC_PTP_PURE"
"""Environment variable: 1 chooses the interpreted kernel."""


capsule_pointer = ctypes.PYFUNCTYPE(ctypes.c_void_p, ctypes.py_object, ctypes.c_char_p)(
    ("PyCapsule_GetPointer", ctypes.pythonapi)
)


class KernelFinder(MetaPathFinder, Loader):
    """Finds the modules of the compiled kernel in its library."""

    def __init__(self, modules: Iterable[str]) -> None:
        self._modules = frozenset(modules)
        self._library = str(library_file(LIBRARY))

    def find_spec(self, name: str, path: object = None, target: object = None) -> ModuleSpec | None:
        if name in self._modules:
            return spec_from_loader(name, self, origin=self._library)
        if name == NAME:
            return spec_from_loader(name, ExtensionFileLoader(name, self._library), origin=self._library)
        return None

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        """Lets the library make and execute a module, as mypyc's own shim per module does."""
        function = f"init_{spec.name.replace('.', '___')}"
        pointer = capsule_pointer(getattr(import_module(NAME), function), f"{NAME}.{function}".encode())
        module: ModuleType = ctypes.PYFUNCTYPE(ctypes.py_object)(pointer)()
        return module

    def exec_module(self, module: ModuleType) -> None:
        """It has been executed already."""


class Kernel:
    """Which kernel runs. `interpreted_because`: empty when it is the compiled one; `remedy`: what would change that."""

    def __init__(self) -> None:
        self.interpreted_because = ""
        self.remedy = ""

    def choose(self) -> None:
        """Installs the finder when the library is what the sources are."""
        if os.environ.get(INTERPRET, "") not in ("", "0"):
            self.interpreted_because = f"{INTERPRET} is set"
            return
        built, present = read_state(LIBRARY), sources()
        failure = built.pop(FAILURE, "")
        if not built:
            self.interpreted_because = failure or "it was not compiled"
        elif change := changed(built, hashes(present | recipe())):
            since = "its last compilation began" if failure else "it was compiled"
            self.interpreted_because = f"{change} since {since}"
        elif failure:
            self.interpreted_because = failure
        else:
            self._load(KernelFinder(present))
        if self.interpreted_because:
            self.remedy = "make setup compiles it again"

    def _load(self, finder: KernelFinder) -> None:
        sys.meta_path.insert(0, finder)
        try:
            import_module(NAME)
        except ImportError as error:
            sys.meta_path.remove(finder)
            self.interpreted_because = f"it cannot be loaded: {error}"

    @property
    def kind(self) -> str:
        return "kernel interpreted" if self.interpreted_because else "kernel compiled"

    def __str__(self) -> str:
        return f"{self.kind} ({self.interpreted_because})" if self.interpreted_because else self.kind


def changed(built: Mapping[str, str], current: Mapping[str, str]) -> str:
    """What differs between two states of the sources, in words; empty when nothing does."""
    names = [name for name in sorted({*built, *current}) if built.get(name) != current.get(name)]
    if not names:
        return ""
    files = f"{'/'.join(names[0].split('.'))}.py"
    if len(names) > 1:
        return f"{files} and {len(names) - 1} more have changed"
    return f"{files} has changed"
