"""The command line. Exit status: 0 done, 1 the run ended in an error, 2 wrong usage or input, 130 interrupted."""

from __future__ import annotations

import sys
from typing import Any

import click

from cnc_ptp import KERNEL
from cnc_ptp.commands.arguments import DIALECT, DIALECT_OF_A_FILE, MACHINE, RECORDING, words
from cnc_ptp.commands.commissioning.groups import curve_commands, identify_commands
from cnc_ptp.commands.commissioning.options import circle_options, require_one_state
from cnc_ptp.commands.completion import (
    COMPLETE_FROM,
    complete_axis,
    complete_command,
    complete_shown_unit,
    complete_unit,
    complete_word,
)
from cnc_ptp.commands.group import Group
from cnc_ptp.commands.lists_commands import lists_commands
from cnc_ptp.commands.look.options import is_text, part_options, program_options, require_none, take_plot
from cnc_ptp.commands.look.params_commands import params_commands
from cnc_ptp.commands.run.options import (
    graph_options,
    replay_options,
    require_an_end,
    require_variants,
    run_options,
    sweep_options,
    take_changes,
    take_recorder,
)
from cnc_ptp.commands.run.web_options import take_web, web_options
from cnc_ptp.commands.run.web_users import web_users
from cnc_ptp.number_range import POSITIVE, RATE
from cnc_ptp.ros_arguments import client_namespace_option, ros_arguments
from cnc_ptp.start_options import start_options, take_start

CLIENTS = ("status", "do", "jog", "watch", "web")
STARTS_NODES = ("run", "replay", *CLIENTS)
"""Commands that take ROS arguments."""


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
def simulate_command(**options: Any) -> None:
    """Run a machine offline, as fast as possible."""
    from cnc_ptp.commands.run.simulate import simulate
    from cnc_ptp.recording.recorder_options import FROM_THE_START

    recorder = take_recorder(options) or FROM_THE_START
    sys.exit(simulate(begin=take_start(options, options["program"]), recorder=recorder, **options))


@main.command("run")
@run_options
@graph_options
def run_command(**options: Any) -> None:
    """Run a machine as a ROS graph, one process per node."""
    options["web"] = take_web(options)
    if options.pop("isolated"):
        from cnc_ptp.commands.run.isolated import isolate

        options["listening"] = isolate(options)  # first: no thread must have been started
    if not options["composed"]:
        from cnc_ptp.nodes.forked import start_server

        start_server()  # first: it imports for all nodes, which takes as long as what comes now
    from cnc_ptp.commands.run.run import run

    recorder = take_recorder(options)
    require_an_end(options)
    ros_arguments().require_for_all_nodes("cnc_ptp run")
    sys.exit(run(begin=take_start(options, options["program"]), recorder=recorder, **options))


@main.command("sweep")
@sweep_options
def sweep_command(**options: Any) -> None:
    """Run a machine offline with many values of parameters.

    The runs are compared by goals. There is one for each combination of the values, or for --random ones, or for those
    that an optimiser chooses. What is finished is kept: the same command computes only what is missing.
    """
    require_variants(options)
    from cnc_ptp.commands.run.sweep import sweep

    sys.exit(sweep(**options))


@main.command("status")
@client_namespace_option
def status_command(**options: Any) -> None:
    """Show all units of the running machine.

    State, position, speed, override, error.
    """
    from cnc_ptp.commands.client.status import status

    sys.exit(status(**options))


@main.command("do", context_settings={"ignore_unknown_options": True})
@click.argument("unit", shell_complete=complete_unit)
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


@main.command("enter", context_settings={"ignore_unknown_options": True, "allow_interspersed_args": False})
@client_namespace_option
@click.argument("words", nargs=-1, required=True, metavar="COMMAND...", type=click.UNPROCESSED)
def enter_command(**options: Any) -> None:
    """Run a COMMAND inside of an isolated run (run --isolated).

    Only the user of that run may. `cnc_ptp enter cnc_ptp status`, `cnc_ptp enter python client.py`.
    """
    from cnc_ptp.commands.client.enter import enter

    enter(**options)


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
@replay_options
def replay_command(**options: Any) -> None:
    """Compute a recorded run again, also changed, or publish it."""
    changes = take_changes(options)
    if changes is not None:
        from cnc_ptp.commands.run.what_if import what_if

        sys.exit(what_if(options["recording"], **changes))
    from cnc_ptp.commands.run.replay import replay

    if not options["publish"]:
        ros_arguments().require_none("cnc_ptp replay without --publish")
        if options["inputs"] or options["rate"] != 1.0:
            raise click.UsageError("--inputs and --rate are options of --publish; nothing was replayed")
    sys.exit(replay(**options))


@main.command("verify")
@RECORDING
@click.option(
    "--motion", is_flag=True, help="Check the motion by its numbers alone: continuity, limits, power, owners."
)
@click.option("--json", "as_json", is_flag=True, help="With --motion: everything that was found as JSON.")
def verify_command(recording: str, *, motion: bool, as_json: bool) -> None:
    """Compute a recorded run again to the bit, or check its motion.

    With --motion nothing is computed again: the setpoints of each cycle are integrated and compared with the next one,
    within bounds that follow from the machine file and from the commands of the recording. Status 1 when anything
    differs or exceeds a limit.
    """
    if motion:
        from cnc_ptp.commands.look.verify import verify_motion

        sys.exit(verify_motion(recording, as_json=as_json))
    if as_json:
        raise click.UsageError("--json is an option of --motion; nothing was verified")
    from cnc_ptp.commands.run.replay import replay

    sys.exit(replay(recording, verify=True, publish=False, rate=1.0))


@main.command("diff")
@click.argument("first", type=click.Path())
@click.argument("second", type=click.Path())
@click.option("--from", "begin", type=float, help="Seconds of the run; without it from the start of both.")
@click.option("--to", "end", type=float, help="Seconds of the run; without it to the end.")
@click.option("--output", "-o", type=click.Path(dir_okay=False), help="Page of both runs on top of each other (.html).")
def diff_command(**options: Any) -> None:
    """Compare two recorded runs of a machine, also as a page."""
    from cnc_ptp.commands.look.diff import diff

    sys.exit(diff(**options))


@main.command("report")
@RECORDING
@part_options
@click.option("--compare", type=click.Path(), help="Another recording, drawn on top of this one.")
@click.option(
    "--align",
    type=click.Choice(("program", "start", "run")),
    default="program",
    show_default=True,
    help="With --compare: starts of the programs, of the recordings, or of the runs at the same time.",
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
@click.option("-o", "--output", required=True, type=click.Path(), help="MCAP file to write; of parts a folder.")
def recover_command(**options: Any) -> None:
    """Save what is whole of a damaged or cut recording in a new file.

    The folder of a recording in parts becomes a folder of parts. Says what is lost. The recording itself is unchanged.
    """
    from cnc_ptp.commands.look.recover import recover_file

    sys.exit(recover_file(**options))


@main.command("plot")
@click.argument("recording", type=click.Path(), metavar="FILE")
@click.argument("more_topics", metavar="[TOPIC]...", nargs=-1)
@click.option("--topics", callback=words, multiple=True, help="Fields to draw: x/set_velocity s/actual_speed_rpm")
@part_options
@program_options
@click.option("-o", "--output", type=click.Path(dir_okay=False), help=".svg, .png or .html; RECORDING.svg without it.")
def plot_command(more_topics: tuple[str, ...], **options: Any) -> None:
    """Draw a recording over time, or the path of an NC program.

    Of a recording, a TOPIC is a unit and a field of its state, x/set_velocity, or a field of all units that move,
    following_error. Without one each axis that moves is drawn with position, velocity, acceleration and following
    error, each spindle with its speed.

    With --machine FILE is an NC program. It is run offline and becomes an HTML page: the path in space, programmed and
    run; velocity, acceleration and jerk over time and over the path; a table of its blocks.
    """
    of_program, of_recording = take_plot(options, more_topics)
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


@main.command("init")
@click.argument("kind", type=click.Choice(("lathe", "mill", "ptp")))
@click.option("-o", "--output", type=click.Path(dir_okay=False), help="File to write; default: KIND.yaml.")
def init_command(kind: str, output: str | None) -> None:
    """Write a commented machine file to begin with; it runs as it is."""
    from cnc_ptp.commands.init.init import init

    sys.exit(init(kind, output))


@main.command("circle")
@circle_options
def circle_command(**options: Any) -> None:
    """Circle test of a machine, run offline.

    Shows circular deviation (ISO 230-4), quadrant peaks and a polar plot.
    """
    from cnc_ptp.commands.commissioning.circle import circle

    require_one_state(options)
    options["feedforward"] = bool(options["feedforward"])
    sys.exit(circle(**options))


for group in (params_commands, lists_commands, identify_commands, curve_commands, web_users):
    main.add_command(group)
