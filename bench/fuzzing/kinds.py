"""The table of kinds: one row for each."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from bench.fuzzing import command_line, messages, programs, recordings, texts, web_messages
from bench.fuzzing.engine import Kind, Target


def programs_of(dialect: str, _folder: Path) -> Target:
    return programs.target(dialect)


KINDS = {
    kind.name: kind
    for kind in (
        Kind("program", partial(programs_of, ""), 400),
        Kind("program-iso", partial(programs_of, "iso"), 200),
        Kind("machine", texts.machines, 100),
        Kind("offsets-tools", texts.named_files, 300),
        Kind("scenario", texts.scenarios, 300),
        Kind("lists", texts.lists, 100),
        Kind("csv", texts.csv_tables, 500),
        Kind("sweep", texts.sweeps, 300),
        Kind("sweep-journal", texts.journals, 300),
        Kind("sweep-table", texts.tables, 200),
        Kind("users", texts.users, 300),
        Kind("mcap-every", recordings.every_byte, 150),
        *(Kind(name, prepare, 200) for name, prepare in recordings.kinds().items()),
        Kind("checkpoint", recordings.checkpoints, 300),
        Kind("block", messages.blocks, 500),
        Kind("topic", messages.topics, 500),
        Kind("command", messages.commands, 300),
        Kind("function-block", messages.function_blocks, 200),
        Kind("command-line", command_line.command_lines, 200),
        Kind("web", web_messages.socket_messages, 300),
        Kind("http", web_messages.http_requests, 300),
    )
}
