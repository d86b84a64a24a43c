"""Makes the package `figures` and the helper module of these tests importable (pytest runs in importlib mode)."""

import sys
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parents[2]), str(Path(__file__).parent)]
