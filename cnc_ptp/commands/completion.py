"""Shell completion: units of the running machine or of --machine, their commands and arguments."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import click
from click.shell_completion import CompletionItem

from cnc_ptp.errors import CncError

PATIENCE = 1.5
"""Seconds to look for a running machine."""
RECORDER = "recorder"

COMPLETE_FROM = click.option(
    "--machine",
    type=click.Path(dir_okay=False),
    help="Machine file from which completion takes units; without it the running machine.",
)


def complete_unit(context: click.Context, parameter: click.Parameter, incomplete: str) -> list[CompletionItem]:
    kinds = unit_kinds_of(context)
    return matching(kinds | {RECORDER: "not a unit"} if kinds else kinds, incomplete)


def complete_shown_unit(context: click.Context, parameter: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Units that have a state to show."""
    return matching({unit: kind for unit, kind in unit_kinds_of(context).items() if kind != "plc"}, incomplete)


def complete_axis(context: click.Context, parameter: click.Parameter, incomplete: str) -> list[CompletionItem]:
    axes = {unit: kind for unit, kind in unit_kinds_of(context).items() if kind == "axis"}
    return matching(axes, incomplete)


def complete_command(context: click.Context, parameter: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Commands of the unit that have a service, with the names of their arguments."""
    from cnc_ptp.nodes.client.machine_client import arguments_of, services_of

    unit = context.params["unit"]
    kind = kind_of(context, unit)
    if kind is None:
        return []
    commands = {command: " ".join(arguments_of(kind, unit, command)) for command in services_of(kind)}
    return matching(commands, incomplete)


def complete_word(context: click.Context, parameter: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Names of arguments that are not given yet, and their values where there is a choice."""
    from cnc_ptp.nodes.client.machine_client import arguments_of

    unit, command = context.params["unit"], context.params["command"]
    kind = kind_of(context, unit)
    try:
        known = {} if kind is None else arguments_of(kind, unit, command)
    except CncError:
        return []
    given = {word.partition("=")[0] for word in context.params.get("words") or ()}
    words: dict[str, str] = {}
    for name, argument in known.items():
        values: Iterable[str] = ("on", "off") if argument.kind == "switch" else argument.choices
        if incomplete.startswith(f"{name}="):
            words |= {f"{name}={value}": "" for value in values}
        elif name not in given:
            words[f"{name}="] = argument.kind if argument.required else f"{argument.kind}, may be left out"
    return matching(words, incomplete)


def matching(words: Mapping[str, str], incomplete: str) -> list[CompletionItem]:
    return [CompletionItem(word, help=text or None) for word, text in words.items() if word.startswith(incomplete)]


def kind_of(context: click.Context, unit: str) -> str | None:
    """Of the recorder its own name: it is no unit, and the same for every machine."""
    return RECORDER if unit == RECORDER else unit_kinds_of(context).get(unit)


def unit_kinds_of(context: click.Context) -> dict[str, str]:
    """Unit -> kind; empty without a machine file and a running machine."""
    try:
        if context.params.get("machine"):
            from cnc_ptp.machine.wiring import unit_kinds
            from cnc_ptp.parameters import read_machine

            return unit_kinds(read_machine(context.params["machine"]))
        from cnc_ptp.nodes.client.machine_client import connected

        with context.scope(cleanup=False), connected(patience=PATIENCE) as client:
            return dict(client.kinds)
    except CncError:
        return {}
