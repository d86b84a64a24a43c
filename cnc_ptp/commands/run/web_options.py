"""Options of the web face, apart from what it loads."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from cnc_ptp.commands.arguments import option_group
from cnc_ptp.web.options import DEFAULT_PORT, HOST, WebOptions

FILE = click.Path(dir_okay=False)


def page_options(prefix: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """How pages are reached and who may: options whose names begin with `prefix`, as WebOptions has them."""
    return option_group(
        click.option(f"--{prefix}host", "host", default=HOST, show_default=True, help="Address on which pages listen."),
        click.option(f"--{prefix}name", "names", multiple=True, help="A further name under which they are asked for."),
        click.option(f"--{prefix}tls-cert", "certificate", type=FILE, help="Certificate of the pages for TLS, PEM."),
        click.option(f"--{prefix}tls-key", "key", type=FILE, help="Its private key, PEM."),
        click.option(f"--{prefix}users", "users", type=FILE, help="File of users of the pages; without it no login."),
    )


run_web_options = option_group(
    click.option(
        "--web",
        type=click.IntRange(1, 65535),
        is_flag=False,
        flag_value=DEFAULT_PORT,
        metavar="[PORT]",
        help=f"Pages of the machine for browsers at http://localhost:PORT; without PORT {DEFAULT_PORT}.",
    ),
    page_options("web-"),
)
"""Of `cnc_ptp run`."""
web_options = option_group(
    click.argument("recording", required=False, type=click.Path()),
    click.option("--port", type=click.IntRange(1, 65535), default=DEFAULT_PORT, show_default=True, help="Port."),
    page_options(""),
    click.option(
        "--programs", type=click.Path(file_okay=False), default=".", show_default=True, help="Folder of NC programs."
    ),
    click.option("--machine", type=FILE, help="Machine file of the running machine."),
    click.option("--listening", type=int, hidden=True, help="Descriptor of a socket that listens already."),
)
"""Options of `cnc_ptp web`."""
OPTIONS = {"host": "host", "names": "name", "certificate": "tls-cert", "key": "tls-key", "users": "users"}
"""Fields of WebOptions -> options, without their prefix."""


def take_web(options: dict[str, Any]) -> WebOptions | None:
    """Takes the options of the pages out of those of `run`; None without pages. Raises UsageError."""
    port, given = options.pop("web"), {field: options.pop(field) for field in OPTIONS}
    if port is not None:
        folder = str(Path(options["program"]).parent) if options["program"] else "."
        return WebOptions(port=port, programs=folder, machine=options["machine"], **given)
    for field, value in given.items():
        if value not in (None, (), HOST):
            raise click.UsageError(f"--web-{OPTIONS[field]} needs --web.")
    return None
