"""Arguments behind `--ros-args`: what ROS knows of them, and what makes sense for whom."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import click

from cnc_ptp.errors import CncError

REFUSED = 26130
REMAPS = ("-r", "--remap")
PARAMETERS = ("-p", "--param", "--params-file")
LOGS = ("stdout", "rosout", "external-lib")
WITH_VALUE = (*REMAPS, *PARAMETERS, "--log-level", "--log-file-name", "--log-config-file", "-e", "--enclave")
SWITCHES = tuple(f"--{state}-{log}-logs" for state in ("enable", "disable") for log in LOGS)
NODE_NAME = ("__node", "__name")
NAMESPACE_NAME = "__ns"
LEVEL = "[A-Za-z_][A-Za-z0-9_]*"


class RosArgument(NamedTuple):
    """One option with its value; switches have an empty one."""

    option: str
    value: str = ""

    def __str__(self) -> str:
        return f"{self.option} {self.value}".strip()

    @property
    def rule(self) -> tuple[str, str, str]:
        """Node (empty: all), left and right side of a value like `[NODE:]LEFT:=RIGHT`."""
        left, _, right = self.value.partition(":=")
        node, _, name = left.rpartition(":")
        return node, name, right.strip()

    def refusal(self, reason: str) -> CncError:
        return CncError(REFUSED, f"ROS argument '{self}' is refused: {reason}", "nothing was started")


@dataclass(frozen=True)
class RosArguments:
    """All ROS arguments of a command."""

    given: tuple[RosArgument, ...] = ()

    @property
    def words(self) -> list[str]:
        """For rclpy.init and for the command lines of other nodes."""
        return ["--ros-args", *(word for argument in self.given for word in argument if word)] if self.given else []

    @property
    def namespace(self) -> str:
        """Namespace of all nodes, like /cell; empty if there is none. ROS takes the first of several rules."""
        rules = (argument.rule for argument in self._remaps())
        first = next((right for node, left, right in rules if not node and left == NAMESPACE_NAME), "")
        return first.rstrip("/")

    def with_namespace(self, namespace: str) -> RosArguments:
        """With `namespace` for all nodes. Raises CncError 26130 when another one is given."""
        for argument in self._remaps():
            if argument.rule[1] == NAMESPACE_NAME and self.namespace != namespace:
                raise argument.refusal(f"--namespace says {namespace or '/'}")
        rule = RosArgument("-r", f"{NAMESPACE_NAME}:={namespace}")
        return RosArguments((*self.given, rule)) if namespace else self

    def require_none(self, command: str) -> None:
        """Raises CncError 26130 when something is given: `command` starts no node."""
        for argument in self.given:
            raise argument.refusal(f"{command} starts no ROS node")

    def require_name(self, name: str) -> None:
        """Raises CncError 26130 when the node `name` is to be called otherwise: the others know it by its name."""
        for argument in self._remaps():
            node, left, right = argument.rule
            if left in NODE_NAME and node in ("", name) and right != name:
                raise argument.refusal(f"the other nodes know this one as '{name}'")

    def require_for_all_nodes(self, command: str) -> None:
        """Raises CncError 26130 for what makes no sense for `command`, which starts all nodes of a machine."""
        self._require(
            no_parameters=f"{command} takes all parameters from the machine file",
            no_name=f"{command} starts many nodes, named as in the machine file",
        )

    def require_for_client(self, command: str) -> None:
        """Raises CncError 26130 for what makes no sense for `command`, which talks to a running machine."""
        self._require(
            no_parameters=f"{command} has no parameters",
            no_name=f"{command} names its node after its process, so that several run side by side",
        )

    def _require(self, *, no_parameters: str, no_name: str) -> None:
        """Raises CncError 26130 with these reasons for parameters, names, and namespaces of single nodes."""
        for argument in self.given:
            node, left, _ = argument.rule
            if argument.option in PARAMETERS and not is_wall_time(argument):
                raise argument.refusal(no_parameters)
            if argument.option in REMAPS and left in NODE_NAME:
                raise argument.refusal(no_name)
            if argument.option in REMAPS and left == NAMESPACE_NAME and node:
                raise argument.refusal("all nodes of a machine are in one namespace")

    def _remaps(self) -> Iterator[RosArgument]:
        return (argument for argument in self.given if argument.option in REMAPS)


def is_wall_time(argument: RosArgument) -> bool:
    """True for `-p use_sim_time:=false`, which launch files give to everybody; launch adds the `...` of YAML."""
    _, name, value = argument.rule
    return name == "use_sim_time" and value.partition("\n")[0].lower() == "false"


def split(words: Iterable[str]) -> tuple[list[str], RosArguments]:
    """The words of a command line without and behind `--ros-args`; a `--` ends the latter.

    Raises CncError 26130 for words that ROS does not know.
    """
    own: list[str] = []
    given: list[RosArgument] = []
    behind = False
    rest = iter(words)
    for word in rest:
        if word == "--ros-args":
            behind = True
        elif not behind:
            own.append(word)
        elif word == "--":
            behind = False
        else:
            given.append(_argument(word, rest))
    return own, RosArguments(tuple(given))


def _argument(option: str, rest: Iterator[str]) -> RosArgument:
    if option in SWITCHES:
        return RosArgument(option)
    if option not in WITH_VALUE:
        raise RosArgument(option).refusal(f"ROS does not know it, but {', '.join((*WITH_VALUE, *SWITCHES))}")
    value = next(rest, None)
    if value is None:
        raise RosArgument(option).refusal("its value is missing")
    return RosArgument(option, value)


def ros_arguments() -> RosArguments:
    """Those of the command that is being executed."""
    context = click.get_current_context(silent=True)
    found = context.find_object(RosArguments) if context else None
    return found or RosArguments()


def _add_namespace(context: click.Context, parameter: click.Parameter, value: str | None) -> None:
    if value is None:
        return
    if not re.fullmatch(f"/|/?{LEVEL}(/{LEVEL})*/?", value):
        raise click.BadParameter(f"'{value}' is no namespace: names of letters, digits and _, separated by /.")
    levels = value.strip("/")
    given = context.find_object(RosArguments) or RosArguments()
    context.obj = given.with_namespace(f"/{levels}" if levels else "")


def _namespace_option(text: str) -> Callable[[Any], Any]:
    """--namespace: the same as `--ros-args -r __ns:=/NAME`."""
    return click.option("--namespace", metavar="NAME", expose_value=False, callback=_add_namespace, help=text)


namespace_option = _namespace_option(
    "ROS namespace of all nodes: machines in different namespaces run at the same time."
)
client_namespace_option = _namespace_option("ROS namespace of the machine to talk to.")
