"""Commands in words: name = value, with units, for tables and marks."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cnc_ptp.protocol.blocks import CommandRecord, arguments_of
from cnc_ptp.recording.units import unit_of, without_unit

MAIN = {
    "factor": "",
    "target": "",
    "distance": "",
    "position": "",
    "percent": " %",
    "difference": "",
    "weight_percent": " %",
    "speed_rpm": " rpm",
}
"""The arguments that describe a command in brief, and their units if these are not the axis'."""
FEW = 6


def command_words(command: CommandRecord, units: Mapping[str, str]) -> str:
    """`move absolute target = 100 mm, velocity = 50 mm/s`; `units`: mm or deg by axis."""
    arguments = argument_words(command.arguments_json, units.get(command.target, ""))
    return " ".join(filter(None, [command.command.replace("_", " "), arguments]))


def brief(command: CommandRecord) -> str:
    """`move_absolute` with its target 1000.0 becomes 'move absolute 1000'; dynamics are left out."""
    arguments = json_object(command.arguments_json) or {}
    shown = [_value("enabled", arguments["enabled"], "")] if "enabled" in arguments else []
    shown += [f"{arguments[name]:g}{unit}" for name, unit in MAIN.items() if _is_number(arguments.get(name))]
    return " ".join([command.command.replace("_", " "), *shown]).replace("-", "−")


def argument_words(arguments_json: str, distance: str) -> str:
    """Arguments as `name = value unit`; `distance`: mm, deg or empty. Anything but a JSON object is unchanged."""
    values = json_object(arguments_json)
    if values is None:
        return arguments_json
    return ", ".join(f"{_label(name)} = {_value(name, value, distance)}" for name, value in values.items())


def json_object(text: str) -> dict[str, Any] | None:
    try:
        values = arguments_of(text)
    except (ValueError, RecursionError):
        return None
    return values if isinstance(values, dict) else None


def is_load(arguments: Mapping[str, Any]) -> bool:
    """Whether a channel can have taken them with `load`: texts, and texts by name."""
    files = arguments.get("files") or {}
    texts = [arguments.get("program"), *(arguments.get(name) or "" for name in ("text", "dialect"))]
    return isinstance(files, Mapping) and all(isinstance(each, str) for each in [*texts, *files.values()])


def shortened(text: str, letters: int) -> str:
    return text if len(text) <= letters else text[: letters - 1] + "…"


def _label(name: str) -> str:
    """Without the unit, which follows the value."""
    return without_unit(name).replace("_", " ")


def _value(name: str, value: Any, distance: str) -> str:
    if isinstance(value, bool):
        return "on" if value else "off"
    if isinstance(value, int | float):
        return f"{value:.10g} {unit_of(name, distance)}".strip()
    if isinstance(value, dict):
        return ", ".join(f"{_label(key)} {_value(key, inner, distance)}" for key, inner in value.items()) or "none"
    if isinstance(value, list):
        return _list(value)
    lines = str(value).splitlines()
    return "none" if value is None else f"({len(lines)} lines)" if len(lines) > 1 else str(value)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _list(values: list[Any]) -> str:
    """Few plain values one after another; of more, and of rows, the number."""
    if any(isinstance(value, list | dict) for value in values):
        return f"({len(values)} rows)"
    if len(values) > FEW:
        return f"({len(values)} values)"
    return " ".join(_value("", value, "") for value in values) or "none"
