"""`python -m cnc_ptp.catalogue.reference`: docs/errors.md, from the catalogue."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby

from cnc_ptp.catalogue.entry import CLASSES, Entry, Text
from cnc_ptp.catalogue.store import RANGES, catalogue, range_of

SHOWN_TEXTS = 3
INTRODUCTION = """# Errors, warnings and messages
Made from the error catalogue by `make docs`; `cnc_ptp explain 70349` prints one row with all its texts, and
`cnc_ptp explain "P-ERR-23004 axis x: …"` takes a whole line of a run. Programs read the catalogue as data:
`cnc_ptp.catalogue` ([architecture.md](architecture.md#error-catalogue)).

Every text is `P-ERR-<number> <where>: <reason>; <effect>`, or P-WARN. *…* stands for what the run puts there. Events
carry the numbers of their text with units, and of them the limit, the actual, the faulty, the expected and the
corrected value as fields of their own ([interfaces.md](interfaces.md)). A number that a manual has is the vendor's; its
page is given.

## Classes
| class | what it is |
|---|---|
"""


def reference_markdown() -> str:
    """The whole page."""
    return "".join(_lines()).rstrip("\n") + "\n"


def _lines() -> Iterator[str]:
    yield INTRODUCTION
    yield from (f"| {name} | {text} |\n" for name, text in CLASSES.items())
    yield "\n## Reactions\n| reaction | which stop | what stops | what happens |\n|---|---|---|---|\n"
    used = {reaction for each in catalogue().values() for reaction in each.reactions}
    for reaction in sorted(used):
        yield f"| {reaction.key} | {reaction.stop} | {reaction.axes} | {reaction.text} |\n"
    yield "\n## Ranges\n| numbers | about |\n|---|---|\n"
    yield from (f"| {first} … {last} | {text} |\n" for first, last, text in RANGES)
    for text, of_range in groupby(catalogue().values(), key=lambda each: range_of(each.number)):
        rows = list(of_range)
        yield f"\n## {rows[0].number} to {rows[-1].number}: {text}\n"
        yield "| number | text | cause | remedy | class, reaction |\n|---|---|---|---|---|\n"
        yield from map(_row, rows)


def _row(each: Entry) -> str:
    name = f'<a id="p-err-{each.number}"></a>{each.number} {each.name}'
    texts = "<br>".join(_text(text) for text in each.texts[:SHOWN_TEXTS])
    if len(each.texts) > SHOWN_TEXTS:
        texts += f"<br>and {len(each.texts) - SHOWN_TEXTS} more"
    kind = f"{each.error_class}; {', '.join(reaction.key for reaction in each.reactions)}"
    manual = f" ({each.manual})" if each.manual else ""
    cells = (name, texts, _escaped(each.cause) + manual, _escaped(each.remedy), f"{kind}; [{each.page}]({each.page})")
    return f"| {' | '.join(cells)} |\n"


def _text(text: Text) -> str:
    shown = text.shown("…")
    return f"`{_escaped(shown)}`" if "`" not in shown else _escaped(shown)


def _escaped(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")


if __name__ == "__main__":
    print(reference_markdown(), end="")
