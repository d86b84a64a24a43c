"""Makes the helper modules of these tests, of control and of the spindle tests importable (importlib mode)."""

import sys
from pathlib import Path

for folder in ("control", "spindle", "machine"):
    sys.path.insert(0, str(Path(__file__).parents[1] / folder))
