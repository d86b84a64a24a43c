"""`cnc_ptp run --isolated`: the door of the pages is opened, then the process leaves the networks of the computer."""

from __future__ import annotations

from collections.abc import Mapping
from socket import socket
from typing import Any

import click

from cnc_ptp.commands.run.beside_run import listen_for_pages
from cnc_ptp.nodes.isolation import isolated
from cnc_ptp.ros_arguments import ros_arguments


def isolate(options: Mapping[str, Any]) -> socket | None:
    """The socket of the pages if there are any; this process is isolated until its end.

    Raises UsageError for a stream that nobody could reach, CncError 26214, 26215 (isolation), 26230 to 26232 (pages).
    """
    if options["foxglove"] is not None:
        raise click.UsageError("--isolated and --foxglove exclude each other: nobody outside reaches the stream.")
    listening = None if options["web"] is None else listen_for_pages(options["web"])
    click.get_current_context().with_resource(isolated(ros_arguments().namespace))
    return listening
