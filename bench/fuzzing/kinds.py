"""The table of kinds: one row for each."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from bench.fuzzing import command_line, doors, messages, programs, recordings, texts, web_messages
from bench.fuzzing.engine import Kind, Target


def programs_of(dialect: str, _folder: Path) -> Target:
    return programs.target(dialect)


KINDS = {
    kind.name: kind
    for kind in (
        Kind("program", partial(programs_of, ""), 150),
        Kind("program-iso", partial(programs_of, "iso"), 100),
        Kind("machine", texts.machines, 60),
        Kind("offsets-tools", texts.named_files, 100),
        Kind("scenario", texts.scenarios, 150),
        Kind("lists", texts.lists, 30),
        Kind("csv", texts.csv_tables, 200),
        Kind("sweep", texts.sweeps, 100),
        Kind("sweep-journal", texts.journals, 200),
        Kind("sweep-table", texts.tables, 200),
        Kind("users", texts.users, 200),
        Kind("mcap-every", recordings.every_byte, 90),
        *(Kind(name, prepare, 40) for name, prepare in recordings.kinds().items()),
        Kind("checkpoint", recordings.checkpoints, 15),
        Kind("block", messages.blocks, 300),
        Kind("topic", doors.topics, 200),
        Kind("service", doors.services, 150),
        Kind("goal", doors.goals, 60),
        Kind("command", messages.commands, 60),
        Kind("function-block", messages.function_blocks, 100),
        Kind("command-line", command_line.command_lines, 12),
        Kind("web", web_messages.socket_messages, 200),
        Kind("http", web_messages.http_requests, 100),
    )
}
