"""Makes the helper modules of these tests and of the control tests importable (pytest runs in importlib mode)."""

import sys
from pathlib import Path

for folder in ("control", "machine"):
    sys.path.insert(0, str(Path(__file__).parents[1] / folder))
