"""The programs that G80 to G89 call."""

from collections.abc import Mapping


def cycle_file(code: str, cycles: Mapping[str, str]) -> str:
    """The program that G80 … G89 call: that of `cycles`, else g80.nc … g89.nc."""
    return cycles.get(code) or f"{code.lower()}.nc"


def cycle_parameter(code: str) -> str:
    """P-CHAN-00160 … P-CHAN-00169 name the programs of G80 … G89."""
    return f"P-CHAN-001{code[1:].replace('8', '6', 1)}"
