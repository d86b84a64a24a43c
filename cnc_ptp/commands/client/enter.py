"""`cnc_ptp enter`: a command inside of an isolated run."""

from __future__ import annotations

import os
from typing import NoReturn

import click

from cnc_ptp.nodes.isolation import join
from cnc_ptp.ros_arguments import ros_arguments


def enter(words: tuple[str, ...]) -> NoReturn:
    """Becomes the command `words`, in the namespaces of the run. Raises CncError 26216, 26217, UsageError."""
    join(ros_arguments().namespace)
    try:
        os.execvp(words[0], words)
    except OSError as error:
        raise click.UsageError(f"{words[0]} cannot be run: {error.strerror}.") from None
