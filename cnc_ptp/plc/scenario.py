"""Scenario files: a timed list of PLC commands, checked as a whole before a run starts."""

from __future__ import annotations

import re
import reprlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import yaml

from cnc_ptp import yaml_text
from cnc_ptp.axis.external_commands import SETPOINTS
from cnc_ptp.errors import CncError
from cnc_ptp.plc.cam_file import parse_cam
from cnc_ptp.plc.setpoint_file import check_setpoints, parse_setpoints
from cnc_ptp.protocol.blocks import Command
from cnc_ptp.protocol.commands import (
    BAD_ARGUMENT,
    COMMANDS,
    INTERNAL,
    OF_CHANNELS,
    OF_PLC,
    check_command,
    current_names,
    sources_of,
)
from cnc_ptp.protocol.run_time import LONGEST_RUN

BAD_SCENARIO = 25101
CAMS = ("couple_cam", "change_cam")
LONGEST_NAME = 200
"""Characters of a unit or command in an error's text."""
SWITCH_WORDS = {"on": True, "off": False}


ReadFile = Callable[[str, str], str]
"""Gives the text of a file: what it is ("NC program"), its path in the scenario."""


class ScenarioError(CncError):
    """The scenario cannot be used; the message lists every fault with number, file and line. Nothing was started."""


@dataclass(frozen=True, slots=True)
class Entry:
    """A command of the scenario; `at` in s, takes effect at the first block that starts at or after it."""

    at: float
    command: Command


_Loader: Any = type(
    "ScenarioLoader",
    (yaml_text.PARSER,),
    {
        "__doc__": "YAML as people write it: `on` is a word (not true), 1e3 a number.",
        "yaml_implicit_resolvers": {
            first: [(tag, pattern) for tag, pattern in resolvers if not tag.endswith((":bool", ":float"))]
            for first, resolvers in yaml.SafeLoader.yaml_implicit_resolvers.items()
        },
    },
)
_BOOL = re.compile(r"^(?:true|True|TRUE|false|False|FALSE)$")
_FLOAT = re.compile(
    r"^[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?$|^[-+]?\.(?:inf|Inf|INF)$|^\.(?:nan|NaN|NAN)$"
)
_Loader.add_implicit_resolver("tag:yaml.org,2002:bool", _BOOL, list("tTfF"))
_Loader.add_implicit_resolver("tag:yaml.org,2002:float", _FLOAT, list("-+0123456789."))


def read_value(text: str) -> Any:
    """A value as in a scenario. Raises yaml.YAMLError."""
    return yaml_text.load(text, _Loader)


def parse_scenario(text: str, file: str, kinds: Mapping[str, str], read: ReadFile | None = None) -> list[Entry]:
    """The entries in the order of their time (file order within one time).

    `kinds` maps the names of the machine's units to axis, spindle, channel or plc; `read` gives the text of a
    file that an entry names, or raises CncError. Raises ScenarioError (25101) with all faults.
    """
    try:
        root = yaml.compose(text, _Loader)
    except (yaml.YAMLError, UnicodeEncodeError) as error:
        raise ScenarioError(BAD_SCENARIO, f"scenario {file} is not YAML: {error}", "nothing was started") from None
    if root is None:
        return []
    if not isinstance(root, yaml.SequenceNode):
        raise ScenarioError(
            BAD_SCENARIO, f"scenario {file}: a list of entries {{at, to, do, ...}} is expected", "nothing was started"
        )
    entries, faults = [], []
    for node in root.value:
        try:
            entries.append(_entry(node, kinds, read))
        except CncError as error:
            faults.append(f"{file}:{node.start_mark.line + 1}: {error.message}")
    if faults:
        lines = f"\nP-ERR-{BAD_SCENARIO} ".join(faults)
        raise ScenarioError(BAD_SCENARIO, f"{lines}\nnothing was started")
    return sorted(entries, key=lambda entry: entry.at)


def _entry(node: yaml.Node, kinds: Mapping[str, str], read: ReadFile | None) -> Entry:
    arguments = _construct(node)
    if not {"at", "to", "do"} <= arguments.keys():
        raise CncError(BAD_SCENARIO, "an entry needs at (seconds), to (unit) and do (command)")
    at, to, do = (arguments.pop(name) for name in ("at", "to", "do"))
    if isinstance(at, bool) or not isinstance(at, (int, float)) or not 0.0 <= at <= LONGEST_RUN:
        shown = reprlib.repr(at) if isinstance(at, (list, dict)) else repr(at)
        raise CncError(BAD_SCENARIO, f"at = {shown} must be a time in seconds, 0 to {LONGEST_RUN:.0f}")
    to, do = str(to)[:LONGEST_NAME], str(do)[:LONGEST_NAME]
    if to not in kinds:
        raise CncError(BAD_SCENARIO, f"unit '{to}' does not exist in the machine. Known: {', '.join(sorted(kinds))}")
    if do in INTERNAL:
        raise CncError(BAD_SCENARIO, f"'{do}' is given by watchdogs only")
    arguments = current_names(kinds[to], do, arguments)
    _read_switches(kinds[to], do, arguments)
    if do == SETPOINTS and kinds[to] == "axis":
        _read_setpoints(to, arguments, read)
    if do in CAMS and read and isinstance(arguments.get("file"), str) and "table" not in arguments:
        file = arguments.pop("file")
        arguments["table"] = parse_cam(read("cam file", file), file)
    check_command(kinds[to], to, do, arguments, sources_of(kinds))
    for name in sorted((OF_CHANNELS | OF_PLC).intersection(arguments)):
        giver = "for channels only" if name in OF_CHANNELS else "filled in by the PLC"
        raise CncError(
            BAD_ARGUMENT,
            f"argument '{name}' is {giver}",
            "nothing was changed",
            where=f"{kinds[to]} {to}: {do} refused",
            argument=name,
        )
    _check_master(kinds, to, do, arguments.get("master"))
    if do == "load" and "text" not in arguments and read:
        arguments["text"] = read("NC program", arguments["program"])
    return Entry(float(at), Command(to, do, arguments))


def _check_master(kinds: Mapping[str, str], slave: str, command: str, master: object) -> None:
    """A master that is given must be a unit of the slave's kind."""
    kind = kinds[slave]
    known = sorted(unit for unit in kinds if kinds[unit] == kind and unit != slave)
    if master is not None and master != slave and master not in known:
        reason = f"there is no {kind} '{master}'. Known: {', '.join(known) or 'none'}"
        raise CncError(BAD_SCENARIO, reason, "nothing was changed", where=f"{kind} {slave}: {command} refused")


def _read_setpoints(axis: str, arguments: dict[str, Any], read: ReadFile | None) -> None:
    """The rows of a file of external setpoints; an entry may also have them itself, as `setpoints`."""
    if "setpoints" in arguments:
        rows = arguments["setpoints"]
        check_setpoints(axis, rows if isinstance(rows, list) else [])
        return
    file = arguments.get("file")
    if not isinstance(file, str):
        where = f"axis {axis}: {SETPOINTS} refused"
        raise CncError(BAD_ARGUMENT, "argument 'file' is missing", "nothing was changed", where=where)
    if read:
        arguments["setpoints"] = parse_setpoints(read("setpoint file", arguments.pop("file")), file)


def _construct(node: yaml.Node) -> dict[str, Any]:
    """The keys and values of an entry; empty when it is no mapping. Raises CncError for what YAML cannot construct."""
    if not isinstance(node, yaml.MappingNode):
        return {}
    try:
        yaml_text.require_few(node)
    except (yaml.YAMLError, RecursionError) as error:
        reason = yaml_text.reason_of(error)
        raise CncError(BAD_SCENARIO, f"a value cannot be read: {reason}") from None
    keys = [key.value for key, _ in node.value]
    for key in keys:
        if keys.count(key) > 1:
            raise CncError(BAD_SCENARIO, f"'{key}' appears twice in the entry")
    try:
        value = _Loader("").construct_object(node, deep=True)
    except (yaml.YAMLError, *yaml_text.UNFIT) as error:
        reason = yaml_text.reason_of(error)
        raise CncError(BAD_SCENARIO, f"a value cannot be read: {reason}") from None
    return {str(name): argument for name, argument in value.items()}


def _read_switches(kind: str, command: str, arguments: dict[str, Any]) -> None:
    for name, argument in COMMANDS[kind].get(command, {}).items():
        word = arguments.get(name)
        if argument.kind == "switch" and isinstance(word, str):
            arguments[name] = SWITCH_WORDS.get(word, word)
