"""The error catalogue against the sources, both ways, and against the manuals."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

from cnc_ptp.catalogue import CLASSES, SEVERITIES, catalogue, entry, neighbours, numbers_in, range_of
from cnc_ptp.catalogue.collect import lines, templates
from cnc_ptp.catalogue.reader import Placeholder, Template
from cnc_ptp.catalogue.reference import reference_markdown
from cnc_ptp.catalogue.sources import Site, sites
from cnc_ptp.commands.language.explain import explain
from cnc_ptp.errors import CncError
from cnc_ptp.protocol.event_values import MEANINGS, SAME, common_unit

ROOT = Path(__file__).parents[2]
CATALOGUE = ROOT / "cnc_ptp" / "catalogue"
HOW = """
A number is declared in cnc_ptp/catalogue/entries/<range>.yaml, under a group ("title") that it belongs to:
    23999:
      name: THE_CONSTANT
      cause: Why it comes.
      remedy: What its user does.
      reactions: [axis]            # only if not those of its group; keys of cnc_ptp/catalogue/reactions.yaml
      manual: TX1250 2.1           # only if a manual has it
Then: .venv/bin/python -m cnc_ptp.catalogue.collect > /tmp/t && mv /tmp/t cnc_ptp/catalogue/texts.yaml
      .venv/bin/python -m cnc_ptp.catalogue.reference > docs/errors.md"""


@cache
def found() -> list[Site]:
    return sites()


# declared and raised


def test_every_number_that_is_raised_is_declared() -> None:
    missing = {site.number: f"{site.number} in cnc_ptp/{site.file}:{site.line}" for site in found()}
    missing = {number: where for number, where in missing.items() if number not in catalogue()}
    assert not missing, f"raised, but not declared: {', '.join(missing.values())}{HOW}"


def test_every_number_that_is_declared_is_raised() -> None:
    unused = set(catalogue()) - {site.number for site in found()}
    assert not unused, f"declared in cnc_ptp/catalogue/entries, but raised nowhere; take out: {sorted(unused)}"


def test_texts_are_those_of_the_sources() -> None:
    """Rewrite texts.yaml and docs/errors.md after a change of a text."""
    assert (CATALOGUE / "texts.yaml").read_text(encoding="utf-8") == "".join(lines()), f"a text was changed{HOW}"


def test_texts_have_one_ellipsis() -> None:
    assert "…" not in (CATALOGUE / "texts.yaml").read_text(encoding="utf-8"), "texts write ..."


def test_page_is_up_to_date() -> None:
    assert (ROOT / "docs" / "errors.md").read_text(encoding="utf-8") == reference_markdown(), HOW


def test_every_number_has_a_text() -> None:
    assert not [number for number, each in catalogue().items() if not each.texts]


def test_entries_are_complete() -> None:
    for each in catalogue().values():
        assert each.error_class in CLASSES and each.severity in SEVERITIES, each.number
        assert each.cause.endswith(".") and each.remedy.endswith("."), each.number
        assert each.reactions and range_of(each.number), each.number
        assert re.fullmatch(r"[A-Z][A-Z0-9_]+", each.name), each.number
        assert (ROOT / "docs" / each.page).is_file(), each.number


# what is declared against how it is raised

STOPS_AXIS = {"axis", "axis_with_master", "lost", "emergency"}
STOPS_SPINDLE = {"spindle", "lost", "emergency"}
STOPS_CHANNEL = {"channel", "lost", "emergency"}
REFUSED = {"refused", "not_started", "spindle_refused", "function_block", "command"}
BY_CALL = (
    (r"axis/.*", r"fault|_fault_before", STOPS_AXIS),
    (r"spindle/.*", r"fault", STOPS_SPINDLE),
    (r"channel/.*", r"_fault", STOPS_CHANNEL),
    (r"plc/plc_unit.py", r"_fail", {"run", "lost", "emergency"}),
    (r".*", r"fail", {"spindle_refused"}),
    (r".*", r"refuse|_refuse|refusal|_refusal", REFUSED),
    (r".*", r"Fault|ProgramError", {"program"}),
    (r".*", r"problem|Problem|BadValue|add_problem", {"no_start"}),
    (r".*", r"notice", {"corrected"}),
    (r".*", r"warning_text|warn", {"none", "axis_stops", "refused"}),
)
"""File, what is called with the number, and the reactions of which it has one."""


def test_reactions_are_those_of_the_raise_sites() -> None:
    wrong = []
    for site in found():
        called = site.call.rpartition(".")[2]
        for file, call, reactions in BY_CALL:
            if re.fullmatch(file, site.file) and re.fullmatch(call, called):
                if not reactions & {reaction.key for reaction in catalogue()[site.number].reactions}:
                    wrong.append(
                        f"{site.number} in cnc_ptp/{site.file}:{site.line} {called}: one of {sorted(reactions)}"
                    )
                break
    assert not wrong


def test_a_fault_is_an_error_and_a_notice_a_warning() -> None:
    for site in found():
        called = site.call.rpartition(".")[2]
        severity = catalogue()[site.number].severity
        if called in ("warning_text", "notice", "warn", "_warn", "_report_warning"):
            assert severity == "warning" or len(catalogue()[site.number].reactions) > 1, site
        elif called in ("_fault", "problem"):
            assert severity == "error" or len(catalogue()[site.number].reactions) > 1, site


# texts and tests


def pieces(tree: ast.Module) -> Iterator[str]:
    """The texts of a test, with the replacement fields left out."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value
        elif isinstance(node, ast.JoinedStr):
            yield "".join(str(each.value) if isinstance(each, ast.Constant) else "\0" for each in node.values)


@cache
def everything_tested() -> str:
    """All texts of the tests."""
    texts = [text for path in ROOT.glob("test/**/*.py") for text in pieces(ast.parse(path.read_text(encoding="utf-8")))]
    files = [path.read_text(encoding="utf-8", errors="replace") for path in ROOT.glob("test/**/*.nc")]
    return "\n".join([*texts, *files])


def is_tested(template: Template) -> bool:
    """A test has the longest part of the text, or four words of it that follow each other."""
    literals = [part for part in template.parts if isinstance(part, str)]
    longest = max(literals, key=len, default="").strip(" ;:,.()'\"")
    words = longest.split()
    runs = [" ".join(words[at : at + 4]) for at in range(len(words) - 3)]
    return len(longest) < 4 or any(part in everything_tested() for part in (longest, *runs))


def test_every_text_is_executed_by_a_test() -> None:
    unseen = {number: text.text for number, texts in templates().items() for text in texts if not is_tested(text)}
    assert not unseen, "no test has these texts; execute each and compare it word for word"


# against the manuals: typed in from them

OF_THE_MANUALS = {
    60254: ("TF5200 spindle", (25, 31)),
    70252: ("TF5200 spindle", (16,)),
    70348: ("TF5200 feedforward", (20, 30)),
    70349: ("TF5200 feedforward", (17, 30)),
    70350: ("TF5200 feedforward", (17,)),
    70351: ("TF5200 feedforward", (19,)),
    70495: ("TF5200 friction compensation", (17, 22)),
    110086: ("TF5200 spindle", (73,)),
    110386: ("TF5200 spindle", (73,)),
    110465: ("TF5200 feedforward", (28,)),
    110473: ("TF5200 feedforward", (28,)),
    110579: ("TF5200 feedforward", (32,)),
    110591: ("TF5200 friction compensation", (14, 15)),
    110592: ("TF5200 friction compensation", (15,)),
    110641: ("TF5200 friction compensation", (24,)),
}


@pytest.mark.parametrize("number", OF_THE_MANUALS)
def test_number_of_a_manual_has_its_page(number: int) -> None:
    book, pages = OF_THE_MANUALS[number]
    assert catalogue()[number].manual == f"{book} p. {', '.join(map(str, pages))}"


# explain


def test_a_number_is_explained(capsys: pytest.CaptureFixture[str]) -> None:
    assert explain(["70349"]) == 0
    assert capsys.readouterr().out == (
        "P-WARN-70349 VELOCITY_DELAY_TOO_LONG (correction, warning)\n"
        "  group:    Corrections and doubtful values\n"
        "  text:     delay <delay> µs is not below <cycles> interpolator cycles (<limit> µs), 0 is used\n"
        "  cause:    The delay of velocity feedforward (P-AXIS-00389) is not below six cycles of the interpolator; "
        "0 is used.\n"
        "  remedy:   Give a shorter one.\n"
        "  reaction: The node starts with the corrected value that the text gives, or as it is written.\n"
        "  docs:     docs/errors.md#p-err-70349, docs/control.md\n"
        "  manual:   TF5200 feedforward p. 17, 30\n"
    )


def test_a_whole_line_is_explained(capsys: pytest.CaptureFixture[str]) -> None:
    line = "P-ERR-23004 axis x: move_absolute refused: velocity 900 mm/s is above the maximum 500 mm/s (P-AXIS-00212)"
    explain([line])
    whole = capsys.readouterr().out
    explain(line.split())
    assert capsys.readouterr().out == whole
    assert whole.startswith("P-ERR-23004 VELOCITY_TOO_HIGH (refusal, warning)\n  group:    Values of a motion\n")
    assert "velocity <velocity> mm/s (deg/s) is above the maximum <limit> mm/s (deg/s) (P-AXIS-00212)" in whole


def test_what_stops_is_said(capsys: pytest.CaptureFixture[str]) -> None:
    explain(["P-ERR-60254"])
    assert (
        "  stops:    ramp of the spindle (the spindle, its slaves, and the path that depends on it)\n"
        in capsys.readouterr().out
    )


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["70347"], "there is no number 70347, its range is about position control, as the vendor has them; nearest are: "
         "70348 ACCELERATION_DELAY_TOO_LONG, 70349 VELOCITY_DELAY_TOO_LONG, 70350 NO_ADDITIVE_VELOCITY"),
        (["5"], "there is no number 5, no range has it; nearest are: 17744 FOLLOWING_ERROR, 20008 FEED_MISSING, "
         "20013 DWELL_TWICE"),
    ],
)  # fmt: skip
def test_an_unknown_number_names_its_neighbours(words: list[str], text: str) -> None:
    with pytest.raises(CncError) as refused:
        explain(words)
    assert str(refused.value) == f"P-ERR-26124 {text}"
    assert refused.value.number == 26124


def test_numbers_in_what_is_pasted() -> None:
    assert numbers_in("warning: P-WARN-23012 axis x: … P-ERR-22012 in P-AXIS-00212") == [23012, 22012]
    assert numbers_in("0x4550") == [17744]
    assert numbers_in("G61") == numbers_in("M0x") == numbers_in("") == []
    assert entry(1) is None
    assert neighbours(70395)[0].number == 70394


# values of events

ROOMS = (
    "axis/",
    "spindle/",
    "channel/",
    "path/",
    "plc/plc_unit.py",
    "plc/setpoint_queue.py",
    "protocol/",
    "control/commands.py",
    "motion/",
)
"""Where errors and warnings are raised that become events."""
IN_TEXT_ALONE = {
    22032: "the unit of a rotary axis of the channel is chosen where it is raised",
    22083: "what the block needs at its begin and at its end, beside what is missing",
    22101: "two radii, beside what is missed",
    23004: "a part of a text; the refusal has velocity and limit",
    23011: "a part of a text; the refusal has velocity and limit",
    23052: "the smallest step of a table, a constant",
    23064: "what is wrong with a point of a trajectory is of many kinds; the text names it",
    26121: "a note at the end of a run, no event",
    120002: "the name of a limit",
    120003: "the name of a limit",
}  # fmt: skip
"""Numbers of which a text has a number that is no value, and why."""


def of_events() -> Iterator[tuple[Site, Placeholder]]:
    for site in found():
        if site.file.startswith(ROOMS) and site.call != "Fault" and site.number not in IN_TEXT_ALONE:
            for template in site.templates:
                yield from ((site, each) for each in template.placeholders if each.is_number)


def test_numbers_of_a_text_are_values_of_its_event() -> None:
    missing = {
        f"{site.number} in cnc_ptp/{site.file}:{site.line}: {each.name} (pass it: values={{…}}, or as a keyword)"
        for site, each in of_events()
        if each.name not in site.values and "**" not in site.values
    }
    assert not missing


def unit_of(site: Site, name: str) -> str | None:
    """That an event gives a value; None where only the run knows."""
    if MEANINGS[name].unit != SAME:
        return MEANINGS[name].unit
    if "argument" in site.values or "**" in site.values:
        return None
    return common_unit(dict.fromkeys(site.values, 0.0))


def test_units_of_values_are_those_of_the_text() -> None:
    """u in the text of a unit is mm or deg; a channel counts in mm, a spindle in deg."""
    wrong, unknown = [], set()
    for site, each in of_events():
        if each.name not in site.values:
            continue
        if each.name not in MEANINGS:
            unknown.add(each.name)
            continue
        unit = unit_of(site, each.name)
        if each.unit and unit is not None and unit not in (each.unit, each.unit.replace("mm", "u").replace("deg", "u")):
            wrong.append(
                f"{site.number} {site.file}:{site.line} {each.name}: {each.unit} in the text, {unit} in the event"
            )
    assert not unknown, "name them in MEANINGS of cnc_ptp/protocol/event_values.py"
    assert not wrong
