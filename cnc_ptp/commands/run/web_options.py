"""Options of the web face, apart from what it loads."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from cnc_ptp.commands.arguments import option_group
from cnc_ptp.web.options import DEFAULT_PORT, HOST, WebOptions

web_port_option = click.option(
    "--web",
    type=click.IntRange(1, 65535),
    is_flag=False,
    flag_value=DEFAULT_PORT,
    metavar="[PORT]",
    help=f"Pages of the machine for browsers at http://localhost:PORT; without PORT {DEFAULT_PORT}.",
)
run_web_options = option_group(
    web_port_option,
    click.option("--web-host", default=HOST, show_default=True, help="Address on which these pages listen."),
    click.option("--web-name", "web_names", multiple=True, help="A further name under which they may be asked for."),
    click.option("--web-tls-cert", "web_certificate", type=click.Path(dir_okay=False), help="Their certificate, PEM."),
    click.option("--web-tls-key", "web_key", type=click.Path(dir_okay=False), help="Its private key, PEM."),
    click.option(
        "--web-users", type=click.Path(dir_okay=False), help="File of users of these pages; without it no login."
    ),
)
"""Of `cnc_ptp run`, as the options of `cnc_ptp web`."""


def take_web(options: dict[str, Any]) -> WebOptions | None:
    """Takes the options of the pages out of those of `run`; None without pages. Raises UsageError."""
    taken = {
        "--web-host": options.pop("web_host"),
        "--web-name": options.pop("web_names"),
        "--web-tls-cert": options.pop("web_certificate"),
        "--web-tls-key": options.pop("web_key"),
        "--web-users": options.pop("web_users"),
    }
    port = options.pop("web")
    if port is None:
        for option, value in taken.items():
            if value not in (None, (), HOST):
                raise click.UsageError(f"{option} needs --web.")
        return None
    program = options["program"]
    host, names, certificate, key, users = taken.values()
    folder = str(Path(program).parent) if program else "."
    return WebOptions(port, host, names, folder, certificate, key, users, options["machine"])


web_options = option_group(
    click.argument("recording", required=False, type=click.Path()),
    click.option("--port", type=click.IntRange(1, 65535), default=DEFAULT_PORT, show_default=True, help="Port."),
    click.option("--host", default=HOST, show_default=True, help="Address to listen on."),
    click.option("--name", "names", multiple=True, help="A further name under which pages may be asked for."),
    click.option(
        "--programs", type=click.Path(file_okay=False), default=".", show_default=True, help="Folder of NC programs."
    ),
    click.option("--tls-cert", "certificate", type=click.Path(dir_okay=False), help="Certificate for TLS, PEM."),
    click.option("--tls-key", "key", type=click.Path(dir_okay=False), help="Its private key, PEM."),
    click.option("--users", type=click.Path(dir_okay=False), help="File of users; without it there is no login."),
    click.option("--machine", type=click.Path(dir_okay=False), help="Machine file of the running machine."),
    click.option("--listening", type=int, hidden=True, help="Descriptor of a socket that listens already."),
)
"""Options of `cnc_ptp web`."""
