"""Options of the web face, apart from what it loads."""

from __future__ import annotations

import click

from cnc_ptp.commands.arguments import option_group
from cnc_ptp.web.options import DEFAULT_PORT, HOST

web_port_option = click.option(
    "--web",
    type=click.IntRange(1, 65535),
    is_flag=False,
    flag_value=DEFAULT_PORT,
    metavar="[PORT]",
    help=f"Pages of the machine for browsers at http://localhost:PORT; without PORT {DEFAULT_PORT}.",
)
"""Of `cnc_ptp run`."""

web_users_option = click.option(
    "--web-users", type=click.Path(dir_okay=False), help="File of users of these pages; without it there is no login."
)
"""Of `cnc_ptp run`, as --users of `cnc_ptp web`."""


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
