"""The error catalogue as data: for every number name, class, severity, reaction, texts, cause, remedy, manual page.

    from cnc_ptp.catalogue import catalogue, entry

    alarm = entry(70349)
    print(alarm.cause, alarm.remedy, [reaction.stop for reaction in alarm.reactions])
    errors = [each for each in catalogue().values() if each.severity == "error"]

`entry(number)` is None for a number that does not exist; `numbers_in(line)` finds the numbers in a line of a run. The
files are read at the first call. Causes, remedies and reactions are declared in entries/*.yaml; texts.yaml is made from
the places where the numbers are raised (`python -m cnc_ptp.catalogue.collect`), and a test compares both with the code.
"""

from cnc_ptp.catalogue.entry import CLASSES, SEVERITIES, Entry, Reaction, Text, Value
from cnc_ptp.catalogue.store import catalogue, entry, neighbours, numbers_in, range_of

__all__ = [
    "CLASSES",
    "SEVERITIES",
    "Entry",
    "Reaction",
    "Text",
    "Value",
    "catalogue",
    "entry",
    "neighbours",
    "numbers_in",
    "range_of",
]
