"""`cnc_ptp params`: the parameter reference on the terminal."""

from __future__ import annotations

from cnc_ptp.parameters.reference import describe, reference_markdown


def params(name: str | None) -> int:
    """Prints one parameter, or all."""
    print(describe(name) if name else reference_markdown())
    return 0
