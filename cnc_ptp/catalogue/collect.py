"""`python -m cnc_ptp.catalogue.collect > cnc_ptp/catalogue/texts.yaml`: the texts of all numbers, from the sources."""

from __future__ import annotations

import json
from collections.abc import Iterator

from cnc_ptp.catalogue.reader import Placeholder, Template
from cnc_ptp.catalogue.sources import sites

HEAD = """\
# Made from the raise sites by `python -m cnc_ptp.catalogue.collect` (make docs); not to be edited.
"""


def templates() -> dict[int, list[Template]]:
    """By number its wordings, each once, in the order of the sources."""
    found: dict[int, dict[str, Template]] = {}
    for site in sites():
        for template in site.templates:
            found.setdefault(site.number, {}).setdefault(template.text, template)
    return {number: list(texts.values()) for number, texts in sorted(found.items())}


def lines() -> Iterator[str]:
    yield HEAD
    for number, texts in templates().items():
        yield f"{number}:\n"
        for template in texts:
            yield f"- text: {json.dumps(template.text, ensure_ascii=False)}\n"
            kinds = {each.name: kind(each) for each in template.placeholders}
            if kinds:
                yield f"  values: {{{', '.join(f'{name}: {text}' for name, text in kinds.items())}}}\n"


def kind(placeholder: Placeholder) -> str:
    unit = f" {json.dumps(placeholder.unit, ensure_ascii=False)}" if placeholder.unit else ""
    return (
        json.dumps(f"number {placeholder.unit}".strip(), ensure_ascii=False) if placeholder.is_number else f"text{unit}"
    )


if __name__ == "__main__":
    print("".join(lines()), end="")
