"""Makes the helper modules of this folder and of the machine tests importable (pytest runs in importlib mode)."""

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent / "machine")]
