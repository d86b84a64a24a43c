"""What every command of the command line shares: refusals as one text, exit status 2, ROS arguments."""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Sequence
from typing import Any

import click

from cnc_ptp.commands.console import RUN_FAILED, print_error
from cnc_ptp.errors import WRONG_INPUT, CncError
from cnc_ptp.ros_arguments import RosArguments
from cnc_ptp.ros_arguments import split as split_ros_arguments

NOT_DONE = {
    "simulate": "nothing was started",
    "run": "nothing was started",
    "sweep": "nothing was started",
    "circle": "nothing was started",
    "identify": "nothing was made",
    "check": "nothing was checked",
    "replay": "nothing was computed",
    "verify": "nothing was checked",
    "diff": "nothing was compared",
    "plot": "nothing was drawn",
    "layout": "nothing was written",
    "lists": "nothing was written",
    "params": "no parameters were read",
    "web": "nothing was served",
}
"""What commands do not do with a machine file that is wrong."""


NO_ROOM_TO_PRINT = 26208
NAME_TOO_LONG = 26209
LONGEST_SHOWN = 40
"""Characters of a name that is too long."""
OF_ANOTHER = "enter"
"""The command whose arguments are another command line: ROS arguments among them are for that one."""


class Command(click.Command):
    """Refuses an option that is given twice with its values: click would take the last one without a word."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        _, _, given = self.make_parser(ctx).parse_args(args=[*args])
        single = [each for each in given if isinstance(each, click.Option) and not (each.multiple or each.is_flag)]
        for option in single:
            if single.count(option) > 1 and not ctx.resilient_parsing:
                raise click.UsageError(f"{option.opts[0]} is given {single.count(option)} times, and takes one value.")
        return super().parse_args(ctx, args)


class Group(click.Group):
    """Prints a refusal as one text and ends with status 2; no traceback. ROS arguments are its context's object."""

    command_class = Command
    group_class = type
    """Groups in it are of this kind too."""

    def main(self, args: Sequence[str] | None = None, *rest: Any, **options: Any) -> Any:
        words = sys.argv[1:] if args is None else list(args)
        try:
            own, ros = (words, RosArguments()) if words[:1] == [OF_ANOTHER] else split_ros_arguments(words)
        except CncError as error:
            print_error(error)
            sys.exit(WRONG_INPUT)
        return super().main(own, *rest, obj=ros, **options)

    def invoke(self, context: click.Context) -> Any:
        try:
            return super().invoke(context)
        except CncError as error:
            effect = NOT_DONE.get(context.find_root().invoked_subcommand or "")
            print_error(error if effect is None else error.meaning(effect))
            sys.exit(WRONG_INPUT)
        except OSError as error:  # of a file that the command writes it is a CncError
            if error.errno == errno.ENAMETOOLONG:
                name = str(error.filename)
                reason = f"'{name[:LONGEST_SHOWN]}...' has {len(name)} characters: {error.strerror}"
                print_error(CncError(NAME_TOO_LONG, reason, "nothing was done"))
                sys.exit(WRONG_INPUT)
            if error.errno != errno.ENOSPC:
                raise
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # Python would try again at its end
            reason = f"standard output cannot be written: {error.strerror}"
            print_error(CncError(NO_ROOM_TO_PRINT, reason, "what the command has printed is incomplete"))
            sys.exit(RUN_FAILED)


class WordsOrCommand(Group):
    """A group whose arguments are those of its command `search`, unless the first one is another command."""

    def parse_args(self, context: click.Context, args: list[str]) -> list[str]:
        first = args[0] if args else ""
        if first not in (*self.commands, *context.help_option_names):
            args = ["search", *args]
        return super().parse_args(context, args)
