"""Instances of kernel classes without a call of `__init__`, for the restoring of a state."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import cache
from typing import Any

from cnc_ptp.compiled.sources import LIBRARY, library_file

COMPILED = "__mypyc_attrs__"
"""What only compiled classes have: the names of their attributes."""


def is_compiled(cls: type) -> bool:
    """Whether instances of `cls` keep their attributes in the library's own layout."""
    return COMPILED in vars(cls)


def bare_instance(cls: type) -> Any:
    """An instance with the defaults of its class and nothing else.

    `__new__` of a compiled class calls `__init__`. What it calls before that is a function of the library.
    """
    return _setup(cls)(cls) if is_compiled(cls) else object.__new__(cls)


@cache
def _setup(cls: type) -> Callable[[type], Any]:
    """mypyc's function that makes an instance. Its name has the shortest unambiguous end of the module's name."""
    library = ctypes.PyDLL(str(library_file(LIBRARY)))
    parts = cls.__module__.split(".")
    function = f"__mypyc__{cls.__name__}_setup".replace("___", "___3_")
    for begin in range(len(parts) - 1, -1, -1):
        name = f"CPyDef_{'___'.join(parts[begin:])}___{function}"
        if hasattr(library, name):
            setup = getattr(library, name)
            setup.restype, setup.argtypes = ctypes.py_object, [ctypes.py_object]
            return setup  # type: ignore[no-any-return]
    raise TypeError(f"{cls.__module__}.{cls.__name__} has no instances")
