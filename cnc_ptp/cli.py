"""The command line. Exit status: 0 done, 1 the run ended in an error, 2 wrong usage or input, 130 interrupted."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from cnc_ptp import KERNEL
from cnc_ptp.commands.completion import (
    complete_axis,
    complete_command,
    complete_shown_unit,
    complete_unit,
    complete_word,
)
from cnc_ptp.commands.console import print_error
from cnc_ptp.commands.run.web_options import web_options, web_port_option
from cnc_ptp.commands.run.web_users import web_users
from cnc_ptp.errors import WRONG_INPUT, CncError
from cnc_ptp.number_range import DURATION, PERCENT, POSITIVE, RATE, STATES_PER_SECOND
from cnc_ptp.ros_arguments import client_namespace_option, namespace_option, ros_arguments
from cnc_ptp.ros_arguments import split as split_ros_arguments
from cnc_ptp.start_options import start_options, take_start

if TYPE_CHECKING:
    from cnc_ptp.recording.recorder_options import RecorderOptions

MACHINE = click.argument("machine", type=click.Path(dir_okay=False))
RECORDING = click.argument("recording", type=click.Path())
SCENARIO = click.option("--scenario", type=click.Path(dir_okay=False), help="Timed PLC commands (YAML).")
PROGRAM = click.option("--program", type=click.Path(dir_okay=False), help="NC program for the first channel.")
CLIENTS = ("status", "do", "jog", "watch", "web")
MCAP_MAGIC = b"\x89MCAP"
LIST_KINDS = ("axis", "channel", "tool", "zero", "clamp", "compensation", "startup")
STARTS_NODES = ("run", "replay", *CLIENTS)
"""Commands that take ROS arguments."""


DIALECT = click.option(
    "--dialect",
    type=click.Choice(("twincat", "iso")),
    help="Vocabulary of the program; default: that of the machine file (P-CHAN-90010).",
)
DIALECT_OF_A_FILE = click.option(
    "--dialect", type=click.Choice(("twincat", "iso")), default="twincat", show_default=True, help="Vocabulary."
)


def run_options(function: Callable[..., Any]) -> Callable[..., Any]:
    """Options that offline run and graph share."""
    for option in (
        start_options,
        click.option("--strict", is_flag=True, help="A refused command makes the exit status 1."),
        click.option(
            "--compression",
            type=click.Choice(("zstd", "lz4", "none")),
            default="zstd",
            show_default=True,
            help="Compression of the recording.",
        ),
        click.option(
            "--split", help="Record in parts of a size or a time, 500MB or 10min; the recording is a folder then."
        ),
        click.option("--record-when", help="Begin the recording when a field has this value: 'x.set_velocity != 0'."),
        click.option("--record", type=click.Path(), help="Write an MCAP recording."),
        click.option(
            "--duration", type=DURATION, help="End after this many seconds; default: when everything is finished."
        ),
        click.option(
            "--plc", type=click.Path(dir_okay=False), help="PLC in a file: a Python class Plc with cycle(io)."
        ),
        SCENARIO,
        DIALECT,
        PROGRAM,
        MACHINE,
    ):
        function = option(function)
    return function


class Group(click.Group):
    """Prints a refusal as one text and ends with status 2; no traceback. ROS arguments are its context's object."""

    def main(self, args: Sequence[str] | None = None, *rest: Any, **options: Any) -> Any:
        try:
            own, ros = split_ros_arguments(sys.argv[1:] if args is None else args)
        except CncError as error:
            print_error(error)
            sys.exit(WRONG_INPUT)
        return super().main(own, *rest, obj=ros, **options)

    def invoke(self, context: click.Context) -> Any:
        try:
            return super().invoke(context)
        except CncError as error:
            print_error(error)
            sys.exit(WRONG_INPUT)


@click.group(cls=Group, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="cnc_ptp", message=f"%(prog)s %(version)s, {KERNEL}")
@click.pass_context
def main(context: click.Context) -> None:
    """CNC and axis kernel: run NC programs and PLC scenarios offline or as a ROS 2 graph, record, replay, report."""
    if context.invoked_subcommand not in STARTS_NODES:
        ros_arguments().require_none(f"cnc_ptp {context.invoked_subcommand}")
    if context.invoked_subcommand in CLIENTS:
        ros_arguments().require_for_client(f"cnc_ptp {context.invoked_subcommand}")


@main.command("simulate")
@run_options
@click.option(
    "--checkpoints",
    type=click.FloatRange(min=0.0),
    default=10.0,
    show_default=True,
    help="Machine time in s between two checkpoints in the recording, from which a replay can begin; 0: none.",
)
def simulate_command(**options: Any) -> None:
    """Run a machine offline, as fast as possible."""
    from cnc_ptp.commands.run.simulate import simulate
    from cnc_ptp.recording.recorder_options import FROM_THE_START

    recorder = take_recorder(options) or FROM_THE_START
    sys.exit(simulate(begin=take_start(options, options["program"]), recorder=recorder, **options))


@main.command("run")
@run_options
@click.option(
    "--foxglove",
    type=click.IntRange(1, 65535),
    is_flag=False,
    flag_value=8765,
    metavar="[PORT]",
    help="Stream the messages of a recording to Foxglove at ws://localhost:PORT; without PORT 8765.",
)
@web_port_option
@click.option("--free-run", is_flag=True, help="As fast as all nodes follow, instead of in real time.")
@click.option("--composed", is_flag=True, help="All nodes in one process.")
@namespace_option
@click.option(
    "--recorder", "on_demand", is_flag=True, help="A recorder that records on demand: do recorder start FILE."
)
@click.option("--keep", type=POSITIVE, help="Keep the last seconds in memory: do recorder snapshot FILE.")
@click.option("--snapshots", type=click.Path(file_okay=False), help="Folder for a snapshot at each error; with --keep.")
@click.option(
    "--snapshot-when",
    help="A snapshot also when a field comes to a value: 'x.following_error > 0.1'; with --snapshots.",
)
@click.option("--stay", is_flag=True, help="Continue when everything is at a standstill, for commands, until Ctrl-C.")
@click.option(
    "--state-rate", type=STATES_PER_SECOND, help="Live states per second on /<unit>/state, 0 = none (P-MACH-00070)."
)
def run_command(**options: Any) -> None:
    """Run a machine as a ROS graph, one process per node."""
    if not options["composed"]:
        from cnc_ptp.nodes.forked import start_server

        start_server()  # first: it imports for all nodes, which takes as long as what comes now
    from cnc_ptp.commands.run.run import run

    recorder = take_recorder(options)
    if options["stay"] and options["duration"] is not None:
        raise click.UsageError("--stay and --duration exclude each other: --duration stays for that many seconds.")
    if options["stay"] and options["free_run"]:
        raise click.UsageError("--stay and --free-run exclude each other: a machine is commanded in real time.")
    ros_arguments().require_for_all_nodes("cnc_ptp run")
    sys.exit(run(begin=take_start(options, options["program"]), recorder=recorder, **options))


def take_recorder(options: dict[str, Any]) -> RecorderOptions | None:
    """Takes the options of the recorder out of the others; None where there is none. Raises UsageError."""
    from cnc_ptp.recording.recorder_options import RecorderOptions

    when, split, keep = options.pop("record_when"), options.pop("split"), options.pop("keep", None)
    folder, snapshot_when = options.pop("snapshots", None), options.pop("snapshot_when", None)
    on_demand = options.pop("on_demand", False) or keep is not None
    compression, record = options.pop("compression"), options["record"]
    needs = (
        (when, record, "--record-when needs --record"),
        (split, record or on_demand or None, "--split needs --record"),
        (folder, keep, "--snapshots needs --keep"),
        (snapshot_when, folder, "--snapshot-when needs --snapshots"),
    )
    for given, needed, text in needs:
        if given is not None and needed is None:
            raise click.UsageError(text)
    if record is None and not on_demand and options.get("foxglove") is None:
        return None
    scenario, plc = options["scenario"], options["plc"]
    return RecorderOptions(when, split, compression, keep or 0.0, folder, snapshot_when, scenario, plc)


def sweep_options(function: Callable[..., Any]) -> Callable[..., Any]:
    """What varies, what is measured, where it is computed."""
    for option in (
        click.option("--scheduler", metavar="ADDRESS", help="Dask scheduler (tcp://host:8786) instead of processes."),
        click.option("--workers", type=click.IntRange(min=1), help="Processes; default: one for each processor."),
        click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Of random values."),
        click.option("--optimise", type=click.IntRange(min=1), metavar="N", help="N variants chosen by their results."),
        click.option("--random", type=click.IntRange(min=1), metavar="N", help="N random variants, instead of a grid."),
        click.option("--page", type=click.Path(dir_okay=False), help="HTML page to write."),
        click.option("-o", "--output", required=True, type=click.Path(dir_okay=False), help="Parquet file to write."),
        click.option(
            "--goal", "goals", multiple=True, required=True, help="max(following_error.x), max:mean(path_velocity) ..."
        ),
        click.option(
            "--vary", multiple=True, required=True, help="x.getriebe.0.kv=2000:8000:13, =a,b,c, =normal:mean:sigma ..."
        ),
        click.option("--duration", type=DURATION, help="End each run after this many seconds."),
        SCENARIO,
        DIALECT,
        PROGRAM,
        MACHINE,
    ):
        function = option(function)
    return function


@main.command("sweep")
@sweep_options
def sweep_command(**options: Any) -> None:
    """Run a machine offline with many values of parameters.

    The runs are compared by goals. There is one for each combination of the values, or for --random ones, or for those
    that an optimiser chooses. What is finished is kept: the same command computes only what is missing.
    """
    if options["random"] is not None and options["optimise"] is not None:
        raise click.UsageError("--random and --optimise exclude each other.")
    if options["workers"] is not None and options["scheduler"] is not None:
        raise click.UsageError("--workers and --scheduler exclude each other: a scheduler has its own workers.")
    if options["program"] is None and options["scenario"] is None:
        raise click.UsageError("--program or --scenario is needed.")
    from cnc_ptp.commands.run.sweep import sweep

    sys.exit(sweep(**options))


COMPLETE_FROM = click.option(
    "--machine",
    type=click.Path(dir_okay=False),
    help="Machine file from which completion takes units; without it the running machine.",
)
UNIT = click.argument("unit", shell_complete=complete_unit)


@main.command("status")
@client_namespace_option
def status_command(**options: Any) -> None:
    """Show all units of the running machine.

    State, position, speed, override, error.
    """
    from cnc_ptp.commands.client.status import status

    sys.exit(status(**options))


@main.command("do", context_settings={"ignore_unknown_options": True})
@UNIT
@click.argument("command", shell_complete=complete_command)
@click.argument("words", nargs=-1, metavar="[NAME=VALUE]...", shell_complete=complete_word)
@click.option(
    "--wait",
    is_flag=True,
    help="Wait until the axis is at a standstill (in its target window, or its actual velocity is 0), the spindle is "
    "at a standstill or has reached its commanded speed (within the tolerance P-AXIS-00217), or the program has ended.",
)
@COMPLETE_FROM
@client_namespace_option
def do_command(machine: str | None, **options: Any) -> None:
    """Give one COMMAND to a UNIT of the running machine.

    Arguments are name=value: `do x move_absolute target=100 velocity=50`. Where a command must have just one, its
    value is enough: `do channel mdi "G1 X10 F500"`. Status 1 when the machine refuses.
    """
    from cnc_ptp.commands.client.do import do

    sys.exit(do(**options))


@main.command("jog")
@click.argument("axis", shell_complete=complete_axis)
@click.argument("direction", type=click.Choice(["+", "-"]))
@click.option("--speed", type=POSITIVE, required=True, help="Speed of the axis in mm/s or deg/s.")
@click.option("--distance", type=POSITIVE, help="End the jog after about this distance in mm or deg.")
@click.option("--time", "seconds", type=POSITIVE, help="End the jog after this many seconds.")
@COMPLETE_FROM
@client_namespace_option
def jog_command(machine: str | None, **options: Any) -> None:
    """Move an AXIS of the running machine while this command runs.

    Ctrl-C halts it.
    """
    from cnc_ptp.commands.client.jog import jog

    sys.exit(jog(**options))


@main.command("watch")
@click.argument("units", nargs=-1, metavar="[UNIT]...", shell_complete=complete_shown_unit)
@click.option("--rate", type=RATE, default=5.0, show_default=True, help="Updates per second.")
@click.option("--time", "seconds", type=POSITIVE, help="End after this many seconds; default: at Ctrl-C.")
@COMPLETE_FROM
@client_namespace_option
def watch_command(machine: str | None, **options: Any) -> None:
    """Show units of the running machine in a table, kept up to date.

    All units if none is named.
    """
    from cnc_ptp.commands.client.status import watch

    sys.exit(watch(**options))


@main.command("web")
@web_options
@client_namespace_option
def web_command(**options: Any) -> None:
    """Serve pages of a machine or RECORDING to browsers.

    On this computer alone, at http://localhost:8080.
    """
    from cnc_ptp.commands.run.web import web

    sys.exit(web(**options))


main.add_command(web_users)


@main.command("explain")
@click.argument("words", nargs=-1, required=True, metavar="WORD...")
@DIALECT_OF_A_FILE
def explain_command(**options: Any) -> None:
    """Say what a word of the NC language or an error number means.

    G61, M03, $FOR, #CS, SIN, V.A.ABS ...; 70349, P-ERR-23004, or a whole line that a run has printed.
    """
    from cnc_ptp.commands.language.explain import explain

    sys.exit(explain(**options))


@main.command("format")
@click.argument("program", type=click.Path(dir_okay=False))
@click.option("--in-place", is_flag=True, help="Write the file instead of printing it.")
@DIALECT_OF_A_FILE
@click.option("--check", "check_only", is_flag=True, help="Only say whether it would change (status 1).")
def format_command(**options: Any) -> None:
    """Print an NC program in one style.

    Capitals, one blank between words, structures indented. Comments, texts and the meaning of each line stay.
    """
    from cnc_ptp.commands.language.format import format_program

    sys.exit(format_program(**options))


@main.command("check")
@click.argument("program", type=click.Path(dir_okay=False))
@click.option("--machine", type=click.Path(dir_okay=False), help="Also check against the axes and limits of a machine.")
@DIALECT
@click.option("--canonical", is_flag=True, help="Print the blocks that result: line, functions, machine positions.")
@click.option("--as-subroutine", is_flag=True, help="The file is called by others: it ends with M17, M29 or M99.")
@start_options
def check_command(**options: Any) -> None:
    """Check an NC program: syntax and modal states.

    Errors are shown with line and column. With --start-line or --start-block: what a start there does first.
    """
    from cnc_ptp.commands.look.check import check

    sys.exit(check(begin=take_start(options, options["program"]), **options))


@main.command("replay")
@RECORDING
@click.option(
    "--verify", is_flag=True, help="Compute the run again and compare every setpoint to the bit (the default)."
)
@click.option("--publish", is_flag=True, help="Publish the recorded topics again.")
@click.option("--rate", type=RATE, default=1.0, show_default=True, help="Factor for --publish, 1 = real time.")
@click.option("--inputs", is_flag=True, help="Publish PLC inputs too: a machine on this ROS domain acts on them.")
@click.option("--from", "begin", type=DURATION, help="What if: changes count from this time on, s.")
@click.option("--to", "end", type=DURATION, help="What if: to this time, s.")
@click.option("--set", "parameters", multiple=True, metavar="UNIT.NAME=VALUE", help="What if: another parameter.")
@click.option("--override", type=PERCENT, help="What if: override of the channels, percent.")
@click.option("--program", type=click.Path(dir_okay=False), help="What if: in place of the loaded program.")
@click.option("--commands", type=click.Path(dir_okay=False), help="What if: further commands, as a scenario.")
@click.option("--output", "-o", type=click.Path(dir_okay=False), help="What if: record the changed run.")
@click.option("--diff", is_flag=True, help="What if: print the difference (always without --output).")
@click.option("--diff-page", "page", type=click.Path(dir_okay=False), help="What if: a page of both runs (.html).")
@namespace_option
def replay_command(**options: Any) -> None:
    """Compute a recorded run again, also changed, or publish it."""
    from cnc_ptp.commands.run.replay import replay

    names = ("begin", "end", "parameters", "override", "program", "commands", "output", "diff", "page")
    changes = {name: options.pop(name) for name in names}
    if any(value not in (None, (), False) for value in changes.values()):
        if options["verify"] or options["publish"]:
            raise click.UsageError("--verify and --publish do not go with a changed run; nothing was replayed")
        from cnc_ptp.commands.run.what_if import what_if

        changes["begin"] = changes["begin"] or 0.0
        sys.exit(what_if(options["recording"], **changes))
    if not options["publish"]:
        ros_arguments().require_none("cnc_ptp replay without --publish")
        if options["inputs"] or options["rate"] != 1.0:
            raise click.UsageError("--inputs and --rate are options of --publish; nothing was replayed")
    sys.exit(replay(**options))


def split(text: str) -> list[str]:
    """Words with commas or blanks between."""
    return text.replace(",", " ").split()


def words(_context: click.Context, _option: click.Parameter, values: tuple[str, ...]) -> tuple[str, ...]:
    """The words of an option that may be given again and again."""
    return tuple(word for value in values for word in split(value))


def part_options(function: Callable[..., Any]) -> Callable[..., Any]:
    """Options for the part of a recording to draw."""
    for option in (
        click.option("--axes", callback=words, multiple=True, help="Axes and spindles, the others are left out: x,s"),
        click.option("--to", "end", type=float, help="Seconds of the recording; without it to its end."),
        click.option("--from", "begin", type=float, help="Seconds of the recording; without it from its start."),
    ):
        function = option(function)
    return function


@main.command("diff")
@click.argument("first", type=click.Path(dir_okay=False))
@click.argument("second", type=click.Path(dir_okay=False))
@click.option("--output", "-o", type=click.Path(dir_okay=False), help="Page of both runs on top of each other (.html).")
def diff_command(**options: Any) -> None:
    """Compare two recorded runs of a machine, also as a page."""
    from cnc_ptp.commands.look.diff import diff

    sys.exit(diff(**options))


@main.command("report")
@RECORDING
@part_options
@click.option("--compare", type=click.Path(dir_okay=False), help="Another recording, drawn on top of this one.")
@click.option(
    "--align",
    type=click.Choice(("program", "start")),
    default="program",
    show_default=True,
    help="With --compare: starts of the programs, or of the recordings, at the same time.",
)
@click.option("-o", "--output", required=True, type=click.Path(dir_okay=False), help="HTML file to write.")
def report_command(**options: Any) -> None:
    """Make one self-contained HTML page of a recording.

    It shows plots, events, errors and statistics; with --compare two recordings and what differs.
    """
    from cnc_ptp.commands.look.report import report

    sys.exit(report(**options))


@main.command("layout")
@MACHINE
@click.option("--for", "program", type=click.Choice(("foxglove", "plotjuggler")), required=True, help="Program.")
@click.option("-o", "--output", required=True, type=click.Path(dir_okay=False), help="File: .json, or .xml.")
def layout_command(**options: Any) -> None:
    """Write a layout of Foxglove or PlotJuggler for a machine.

    It has a tab for each channel, axis and spindle, for threads and for circles, with the topics of recordings and of
    the running machine.
    """
    from cnc_ptp.commands.look.layout import layout

    sys.exit(layout(**options))


@main.command("export")
@click.argument("recording", type=click.Path())
@click.option("--topic", required=True, help="Topic to write: /x/state, /events, /commands ...")
@click.option("--fields", callback=words, multiple=True, help="Fields of it; without them all: set_position,error_id")
@click.option("--from", "begin", type=float, help="Seconds of the recording; without it from its start.")
@click.option("--to", "end", type=float, help="Seconds of the recording; without it to its end.")
@click.option("-o", "--output", required=True, type=click.Path(dir_okay=False), help="File: .csv, .parquet or .npz.")
def export_command(**options: Any) -> None:
    """Write a topic of a recording as a table: CSV, Parquet or NumPy.

    RECORDING may be a folder with a recording in several files. The first column is the time in s.
    """
    from cnc_ptp.commands.look.export import export

    sys.exit(export(**options))


@main.command("recover")
@RECORDING
@click.option("-o", "--output", required=True, type=click.Path(dir_okay=False), help="MCAP file to write.")
def recover_command(**options: Any) -> None:
    """Save what is whole of a damaged or cut recording in a new file.

    Says what is lost. The recording itself is unchanged.
    """
    from cnc_ptp.commands.look.recover import recover_file

    sys.exit(recover_file(**options))


def program_options(function: Callable[..., Any]) -> Callable[..., Any]:
    """Options of a plot that are for an NC program alone."""
    for option in (
        click.option("--override", type=POSITIVE, help="Override of the path in %; default: 100."),
        DIALECT,
        click.option("--colour", type=click.Choice(("feed", "acceleration", "block")), help="Of the path; or feed."),
        click.option(
            "--machine", type=click.Path(dir_okay=False), help="FILE is an NC program: run it on this machine."
        ),
    ):
        function = option(function)
    return function


@main.command("plot")
@click.argument("recording", type=click.Path(), metavar="FILE")
@click.argument("more_topics", metavar="[TOPIC]...", nargs=-1)
@click.option("--topics", callback=words, multiple=True, help="Fields to draw: x/set_velocity s/actual_speed_rpm")
@part_options
@program_options
@click.option("-o", "--output", type=click.Path(dir_okay=False), help=".svg, .png or .html; RECORDING.svg without it.")
def plot_command(more_topics: tuple[str, ...], topics: tuple[str, ...], **options: Any) -> None:
    """Draw a recording over time, or the path of an NC program.

    Of a recording, a TOPIC is a unit and a field of its state, x/set_velocity, or a field of all units that move,
    following_error. Without one each axis that moves is drawn with position, velocity, acceleration and following
    error, each spindle with its speed.

    With --machine FILE is an NC program. It is run offline and becomes an HTML page: the path in space, programmed and
    run; velocity, acceleration and jerk over time and over the path; a table of its blocks.
    """
    of_program = {name: options.pop(name) for name in ("machine", "colour", "dialect", "override")}
    of_recording: dict[str, Any] = {"topics": (*topics, *(word for text in more_topics for word in split(text)))}
    of_recording |= {name: options.pop(name) for name in ("begin", "end", "axes")}
    if of_program["machine"] is not None:
        require_none(of_recording, "is of a recording; with --machine an NC program is drawn")
        from cnc_ptp.commands.look.program_plot import plot_program

        given = {name: value for name, value in of_program.items() if value is not None}
        sys.exit(plot_program(options["recording"], output=options["output"], **given))
    require_none(of_program, "needs --machine: it is of an NC program")
    if is_text(options["recording"]):
        raise click.UsageError(
            f"{options['recording']} is no recording; --machine draws an NC program; nothing was drawn"
        )
    from cnc_ptp.commands.look.plot import plot

    sys.exit(plot(**options, **of_recording))


def is_text(file: str) -> bool:
    """Whether a file exists and begins as no recording does."""
    try:
        with Path(file).open("rb") as stream:
            first = stream.read(1)
    except OSError:
        return False
    return first != MCAP_MAGIC[:1] and not file.endswith(".mcap")


def require_none(options: dict[str, Any], why: str) -> None:
    """Raises UsageError for an option that was given."""
    names = {"begin": "--from", "end": "--to", "topics": "TOPIC"}
    for name, value in options.items():
        if value not in (None, ()):
            raise click.UsageError(f"{names.get(name, f'--{name}')} {why}; nothing was drawn")


class WordsOrCommand(Group):
    """A group whose arguments are those of its command `search`, unless the first one is another command."""

    def parse_args(self, context: click.Context, args: list[str]) -> list[str]:
        first = args[0] if args else ""
        if first not in (*self.commands, *context.help_option_names):
            args = ["search", *args]
        return super().parse_args(context, args)


@main.group("params", cls=WordsOrCommand)
def params_group() -> None:
    """Show the parameter reference; compare and check machine files.

    `cnc_ptp params WORD...` shows what matches the words (id, number, parts of names, text), without words all groups.
    """


@params_group.command("search")
@click.argument("words", nargs=-1, metavar="[WORD]...")
@click.option("--list", "list_name", help="Only this list: axis, channel, P-COMP ...")
@click.option("--topic", help="Only parameters of a topic, or of topics that have this word.")
@click.option("--changed", type=click.Path(dir_okay=False), help="Only what this machine file sets otherwise.")
def params_command(words: tuple[str, ...], **options: Any) -> None:
    """What matches the WORDs (id, number, parts of names, text), or all groups."""
    from cnc_ptp.commands.look.params import params

    sys.exit(params(" ".join(words), **options))


@params_group.command("diff")
@click.argument("first", type=click.Path(dir_okay=False))
@click.argument("second", type=click.Path(dir_okay=False))
def params_diff_command(first: str, second: str) -> None:
    """In which parameters two machine files differ, defaults included. Status 1 if they do."""
    from cnc_ptp.commands.look.machine_params import diff

    sys.exit(diff(first, second))


@params_group.command("check")
@MACHINE
def params_check_command(machine: str) -> None:
    """Everything that is wrong or doubtful in a machine file, at once. Status 2 if it would not start."""
    from cnc_ptp.commands.look.machine_params import check

    sys.exit(check(machine))


@main.command("init")
@click.argument("kind", type=click.Choice(("lathe", "mill", "ptp")))
@click.option("-o", "--output", type=click.Path(dir_okay=False), help="File to write; default: KIND.yaml.")
def init_command(kind: str, output: str | None) -> None:
    """Write a commented machine file to begin with; it runs as it is."""
    from cnc_ptp.commands.init.init import init

    sys.exit(init(kind, output))


@main.group("lists")
def lists_group() -> None:
    """Read and write the vendor's ASCII lists of axes, channels, tools."""


def parse_kinds(
    _context: click.Context, _option: click.Parameter, values: tuple[str, ...]
) -> tuple[tuple[str, str], ...]:
    """FILE=KIND, each."""
    pairs = [(file, kind) for value in values for file, _, kind in [value.rpartition("=")]]
    for file, kind in pairs:
        if not file or kind not in LIST_KINDS:
            raise click.BadParameter(f"FILE=KIND is needed, KIND one of {', '.join(LIST_KINDS)}")
    return tuple(pairs)


@lists_group.command("import")
@click.argument("folder", type=click.Path())
@click.option("-o", "--output", required=True, type=click.Path(), help="Machine file to write.")
@click.option("--report", type=click.Path(), help="File to write what became of each line, and every default.")
@click.option("--as", "kinds", multiple=True, callback=parse_kinds, metavar="FILE=KIND", help="What a list is.")
@click.option("--strict", is_flag=True, help="An unknown line is an error.")
@click.option("--incomplete", is_flag=True, help="Only report what values and lists say against each other.")
@click.option("--force", is_flag=True, help="Overwrite the output.")
def lists_import_command(**options: Any) -> None:
    """Make a machine file of the lists in FOLDER.

    Prints what was corrected and what is unknown; unknown lines and comments are kept for an export.
    """
    from cnc_ptp.commands.lists import import_folder

    sys.exit(import_folder(**options))


@lists_group.command("export")
@MACHINE
@click.option("-o", "--output", required=True, type=click.Path(), metavar="FOLDER", help="Folder to write.")
@click.option("--force", is_flag=True, help="Replace the lists in a folder that is there.")
def lists_export_command(**options: Any) -> None:
    """Write a machine file as lists, one file for each axis, channel and table."""
    from cnc_ptp.commands.lists import export_folder

    sys.exit(export_folder(**options))


def identify_options(function: Callable[..., Any]) -> Callable[..., Any]:
    """Options that all identifications share."""
    for option in (
        click.option("--record", type=click.Path(dir_okay=False), help="Write an MCAP recording of the run."),
        click.option("-o", "--output", type=click.Path(dir_okay=False), help="YAML file to write instead of printing."),
        click.option("--recording", type=click.Path(), help="Evaluate this recording, drive nothing."),
        click.option("--machine", type=click.Path(dir_okay=False), help="Machine file; a recording has its own."),
        click.argument("axis"),
    ):
        function = option(function)
    return function


def require_source(options: dict[str, Any]) -> None:
    """Raises UsageError unless there is something to identify, and only once."""
    if options["machine"] is None and options["recording"] is None:
        raise click.UsageError("--machine (drives the axis offline) or --recording is needed.")
    if options["recording"] is not None and options["record"] is not None:
        raise click.UsageError("--record and --recording exclude each other: a recording is evaluated without a run.")
    if options["recording"] is not None and options.get("velocities"):
        raise click.UsageError("--velocity and --recording exclude each other: a recording is evaluated without a run.")


@main.group("identify")
def identify_group() -> None:
    """Identify the friction or the drive of an axis.

    Gives friction table, drive time constant and position controller gain.
    """


@identify_group.command("friction")
@identify_options
@click.option("--velocity", "velocities", type=float, multiple=True, help="Drive these velocities (mm/s, deg/s) only.")
def identify_friction_command(**options: Any) -> None:
    """Identify the friction of AXIS: drive in both directions at constant velocities, read the torque, write YAML."""
    from cnc_ptp.commands.commissioning.identify import identify_friction

    require_source(options)
    sys.exit(identify_friction(**options))


@identify_group.command("dynamics")
@identify_options
def identify_dynamics_command(**options: Any) -> None:
    """Identify the drive of AXIS: time constant, dead time, inertia; propose Kv and feedforward as YAML."""
    from cnc_ptp.commands.commissioning.identify import identify_dynamics

    require_source(options)
    sys.exit(identify_dynamics(**options))


@main.command("circle")
@click.argument("machine", type=click.Path(dir_okay=False))
@click.option("--radius", type=float, required=True, help="mm")
@click.option("--feed", type=float, required=True, help="mm/min")
@click.option("--plane", default="XY", show_default=True, help="XY, ZX or YZ.")
@click.option("--centre", type=float, nargs=2, help="Centre in the plane, mm; without it the position of the axes.")
@click.option("--direction", type=click.Choice(["both", "ccw", "cw"]), default="both", show_default=True)
@click.option("--feedforward/--no-feedforward", default=None, help="G135 (off without it, as after a program start).")
@click.option(
    "--friction/--no-friction", default=None, help="Friction compensation (without it as in the machine file)."
)
@click.option(
    "--compare",
    type=click.Choice(["feedforward", "friction", "both"]),
    help="Run without and with it, and draw all in one picture.",
)
@click.option(
    "-o", "--output", "outputs", type=click.Path(dir_okay=False), multiple=True, help="Picture: .svg, .png or .html."
)
@click.option("--magnification", type=float, help="Of the deviations in the picture; without it chosen to fit.")
@click.option(
    "--record",
    type=click.Path(dir_okay=False),
    help="Keep the run in this MCAP file; those of --compare in FILE_1, FILE_2, … in their order.",
)
def circle_command(**options: Any) -> None:
    """Circle test of a machine, run offline.

    Shows circular deviation (ISO 230-4), quadrant peaks and a polar plot.
    """
    from cnc_ptp.commands.commissioning.circle import circle

    compared = options["compare"]
    for name in ("feedforward", "friction"):
        if compared in (name, "both") and options[name] is not None:
            switches = f"--{name} and --no-{name} are for what is not compared."
            raise click.UsageError(f"--compare {compared} runs without and with {name}: {switches}")
    options["feedforward"] = bool(options["feedforward"])
    sys.exit(circle(**options))


@main.group("curve")
def curve_group() -> None:
    """Acceleration curves of spindles (P-AXIS-00202)."""


@curve_group.command("fit")
@click.argument("kind", type=click.Choice(["polynomial", "hyperbola"]))
@click.option(
    "--point", "points", multiple=True, metavar="SPEED:ACCELERATION", help="12000:16000 in --unit and °/s²; ascending."
)
@click.option("--csv", type=click.Path(dir_okay=False), help="Columns acceleration_deg_s2, speed_deg_s or speed_rpm.")
@click.option(
    "--unit",
    type=click.Choice(["deg/s", "rpm"]),
    default="deg/s",
    show_default=True,
    help="Of the speeds in --point, --limit and --top-speed.",
)
@click.option("--limit", type=float, help="Limit speed, one of the points; without it the first.")
@click.option("--top-speed", type=float, help="Speed up to which the curve must hold; without it the last point.")
@click.option("--a-min", type=click.IntRange(0, 2**32 - 1), default=0, show_default=True, help="Floor in °/s².")
@click.option("--spindle", default="s", show_default=True, help="For the lines of the machine file.")
@click.option("--gear", type=click.IntRange(0, 5), default=0, show_default=True, help="Index of getriebe[i].")
@click.option(
    "-o",
    "--output",
    "outputs",
    type=click.Path(dir_okay=False),
    multiple=True,
    help="Picture (.svg, .png, .html), or the lines of the machine file (.yaml) instead of printing them.",
)
def curve_fit_command(**options: Any) -> None:
    """Coefficients b1, b2, b3 of an acceleration curve from interpolation points of the drive.

    The point at the limit speed gives n_grenz and a_konst. Above it 3 points make the polynomial and 2 the hyperbola,
    exactly; with more of them the curve is the least squares fit, and the table shows how far it is off each point.
    """
    from cnc_ptp.commands.commissioning.curve import curve_fit

    if bool(options["points"]) == bool(options["csv"]):
        raise click.UsageError("Either --point (again and again) or --csv is needed.")
    sys.exit(curve_fit(**options))
