"""`cnc_ptp users`: who may log in to the pages, and tokens of machines."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from cnc_ptp.commands.group import Group
from cnc_ptp.web.options import require_packages

ROLES = ("viewer", "operator", "commissioner")
FILE = click.option(
    "--users", "file", type=click.Path(dir_okay=False), required=True, help="File of users; made if it is not there."
)
ROLE = click.option("--role", type=click.Choice(ROLES), required=True, help="What may be done.")
NAME = click.argument("name")


def given_password() -> str:
    """Of somebody at a terminal, or from a pipe; empty without either."""
    if sys.stdin is None:
        return ""
    if sys.stdin.isatty():
        return str(click.prompt("Password", hide_input=True, confirmation_prompt=True))
    return sys.stdin.readline().rstrip("\r\n")


@click.group("users", cls=Group)
def web_users() -> None:
    """Users of the pages: add, remove, list; tokens of machines."""
    require_packages()


@web_users.command("add")
@NAME
@FILE
@ROLE
@click.option("--password", help="Without it you are asked, or the first line of the standard input is taken.")
def add(name: str, file: str, role: str, password: str | None) -> None:
    """Add a user, or give one another role and password."""
    from cnc_ptp.web.access.users import add_user

    add_user(Path(file), name, role, given_password() if password is None else password)
    print(f"{name} is {role}")


@web_users.command("token")
@NAME
@FILE
@ROLE
def token(name: str, file: str, role: str) -> None:
    """Make a token for a machine, which sends it as `Authorization: Bearer TOKEN`. It is shown once."""
    from cnc_ptp.web.access.users import add_token

    print(add_token(Path(file), name, role))


@web_users.command("remove")
@NAME
@FILE
def remove(name: str, file: str) -> None:
    """Remove a user or a token; open pages of it end."""
    from cnc_ptp.web.access.users import remove as remove_entry

    remove_entry(Path(file), name)
    print(f"{name} is removed")


@web_users.command("list")
@FILE
def list_users(file: str) -> None:
    """List users and tokens with their roles."""
    from cnc_ptp.web.access.users import read_users

    for kind, entries in read_users(Path(file)).items():
        for user in entries.values():
            print(f"{kind.removesuffix('s'):6} {user.role:13} {user.name}")
