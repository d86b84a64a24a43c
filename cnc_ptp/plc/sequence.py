"""Sequence numbers of PLC messages."""


def is_newer(sequence: int, last: int) -> bool:
    """False for repeated and older numbers. 0 is not checked; 1 starts a new count; the count may wrap around."""
    return sequence == 0 or (sequence == 1 and last != 1) or 0 < (sequence - last) % 2**32 < 2**31
