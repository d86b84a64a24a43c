"""All words of the NC language with their explanations, from the tables of the language."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from cnc_ptp import yaml_text
from cnc_ptp.commands.language.word_errors import errors_of
from cnc_ptp.errors import CncError, did_you_mean, nearest
from cnc_ptp.nc.canonical import code_name
from cnc_ptp.nc.expressions.functions import CONSTANTS, NUMERIC, TEXTUAL
from cnc_ptp.nc.expressions.readable import READABLE, forms
from cnc_ptp.nc.gears import GEAR_M
from cnc_ptp.nc.program import GCode, Vocabulary
from cnc_ptp.nc.vocabularies import VOCABULARIES

UNKNOWN_WORD = 26123


class Explanation(NamedTuple):
    """A row of explanations.yaml; `meaning`: one sentence or a few, `example`: lines of a program."""

    syntax: str
    meaning: str
    example: str = ""


class Entry(NamedTuple):
    """One word: its explanation, the modal group of a code, what is not built yet."""

    name: str
    kind: str
    explanation: Explanation
    group: str = ""
    modal: bool = True
    later: str = ""
    errors: tuple[int, ...] = ()
    """Numbers of those that it may have besides those of any line."""


TEXTS = {"twincat": "explanations.yaml", "iso": "iso_explanations.yaml"}


def explanations(dialect: str = "twincat") -> dict[str, dict[Any, Explanation]]:
    """The texts of a vocabulary by kind and word."""
    sections = yaml_text.load(Path(__file__).with_name(TEXTS[dialect]).read_text(encoding="utf-8"))
    return {kind: {word: Explanation(*row) for word, row in rows.items()} for kind, rows in sections.items()}


def examples() -> dict[str, dict[str, str]]:
    """By kind and name those of words whose other texts are beside their code."""
    loaded: dict[str, dict[str, str]] = yaml_text.load(
        Path(__file__).with_name("examples.yaml").read_text(encoding="utf-8")
    )
    return loaded


def entries(dialect: str = "twincat") -> list[Entry]:
    """All words of a vocabulary in the order of the reference."""
    texts, vocabulary = explanations(dialect), VOCABULARIES[dialect]
    codes = texts["G function"]
    blockwise = BLOCKWISE[dialect]
    found = [g_entry(vocabulary.g_codes[float(number)], codes[number], blockwise) for number in sorted(codes)]
    found += [m_entry(vocabulary, number, text) for number, text in texts["M function"].items()]
    if dialect == "iso":
        found += [Entry(name, "word", text) for name, text in texts["word"].items()]
        return [entry._replace(errors=tuple(errors_of(entry.name, entry.kind, dialect))) for entry in found]
    for kind in ("word", "operator", "control statement"):
        found += [Entry(name, kind, text) for name, text in texts[kind].items()]
    found += [Entry(f"#{name}", "command", text) for name, text in texts["command"].items()]
    found += [Entry(name, "function", function_text(NUMERIC[name].text)) for name in NUMERIC]
    found += [Entry(name, "function", function_text(TEXTUAL[name].text)) for name in TEXTUAL]
    found += [Entry(name, "constant", Explanation(name, f"{value:.6g}")) for name, value in CONSTANTS.items()]
    found += [readable_entry(name) for name in READABLE]
    shown = examples()
    found = [with_listed_example(entry, shown.get(entry.kind, {})) for entry in found]
    return [entry._replace(errors=tuple(errors_of(entry.name, entry.kind))) for entry in found]


def m_entry(vocabulary: Vocabulary, number: int, text: Explanation) -> Entry:
    code = vocabulary.m_codes.get(number)
    group = code.group if code is not None else "gear" if number in GEAR_M else ""
    modal = group in ("spindle", "gear")
    return Entry(code_name("M", number), "M function", with_example(text), group, modal)


def with_example(text: Explanation) -> Explanation:
    """A code that stands alone is its own example."""
    alone = re.fullmatch(r"[GM][\d.]+", text.syntax)
    return text._replace(example=text.syntax) if alone and not text.example else text


def with_listed_example(entry: Entry, listed: Mapping[str, str]) -> Entry:
    """With that of examples.yaml."""
    if entry.name not in listed:
        return entry
    return entry._replace(explanation=entry.explanation._replace(example=listed[entry.name]))


def readable_entry(name: str) -> Entry:
    rows = [reading for _, reading in READABLE[name]]
    meaning = "; ".join(reading.text for reading in rows)
    if any(reading.write for reading in rows):
        meaning += "; can be assigned"
    if any(reading.synchronises for reading in rows):
        meaning += "; the path stands when it is read"
    return Entry(name, "readable state", Explanation(forms(name), meaning))


def g_entry(code: GCode, text: Explanation, blockwise: tuple[int, ...]) -> Entry:
    modal = code.modal and not (code.function is not None or code.spindle or code.number in blockwise)
    text = text if code.later else with_example(text)
    return Entry(code.name, "G function", text, code.group, modal, code.later)


BLOCKWISE = {"twincat": (9, 60, 61, 166), "iso": (9, 30, 53)}
"""Codes without a function or a motion that count for their block alone."""


def free_m_entry(number: int) -> Entry:
    """A function of the machine."""
    name = code_name("M", number)
    meaning = "Function for the PLC, if the machine has it (P-CHAN-00041); with a value as in M52=-345."
    explanation = Explanation(f"{name}, {name}=value", meaning, name)
    return Entry(name, "free M function", explanation, errors=tuple(errors_of(name, "free M function")))


def function_text(text: str) -> Explanation:
    syntax, _, meaning = text.partition(": ")
    return Explanation(syntax, meaning)


def find(word: str, dialect: str = "twincat") -> list[Entry]:
    """The entries of a word as somebody may type it: g1, G01, $if, #cs, sin; #timer: all its commands.

    Raises CncError 26123.
    """
    wanted = normal(word)
    known = {normal(entry.name): entry for entry in entries(dialect)}
    if wanted in known:
        return [known[wanted]]
    plain = {name.lstrip("#$"): entry for name, entry in known.items()}
    bare = wanted.lstrip("#$")
    found = [plain[bare]] if bare in plain else [entry for name, entry in plain.items() if name.startswith(f"{bare} ")]
    if found:
        return found
    shorter = re.fullmatch(r"(.+)(?: \S+|\.[^.]+|\[[^\]]*\])", wanted)
    if shorter is not None and wanted.startswith(("#", "$", "V.")):
        return find(shorter[1], dialect)
    if dialect == "twincat" and re.fullmatch(r"M\d{1,4}", wanted):
        return [free_m_entry(int(wanted[1:]))]
    close = did_you_mean([known[name].name for name in nearest(wanted, known, most=3, cutoff=0.5)])
    raise CncError(UNKNOWN_WORD, f"'{word}' is no word of the NC language{close}")


def normal(word: str) -> str:
    """Upper case, codes without leading zeros."""
    text = " ".join(word.upper().split())
    code = re.fullmatch(r"([GM])0*(\d+(?:\.\d)?)(=.*)?", text)
    return f"{code[1]}{code[2]}" if code else text
