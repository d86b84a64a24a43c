"""Makes the helper modules of these tests, and the curves of the spindle tests, importable (importlib mode)."""

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent / "spindle")]
