"""Options of the commands that run a machine, and which of them go together."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from cnc_ptp.commands.arguments import DIALECT, MACHINE, PROGRAM, RECORDING, SCENARIO, option_group
from cnc_ptp.commands.run.web_options import run_web_options
from cnc_ptp.number_range import DURATION, PERCENT, POSITIVE, RATE, STATES_PER_SECOND
from cnc_ptp.ros_arguments import namespace_option
from cnc_ptp.start_options import start_options

if TYPE_CHECKING:
    from cnc_ptp.recording.recorder_options import RecorderOptions

WHAT_IF = ("begin", "end", "parameters", "override", "program", "commands", "output", "diff", "page")

run_options = option_group(
    MACHINE,
    PROGRAM,
    DIALECT,
    SCENARIO,
    click.option("--plc", type=click.Path(dir_okay=False), help="PLC in a file: a Python class Plc with cycle(io)."),
    click.option(
        "--duration", type=DURATION, help="End after this many seconds; default: when everything is finished."
    ),
    click.option("--record", type=click.Path(), help="Write an MCAP recording."),
    click.option(
        "--checkpoints",
        type=DURATION,
        default=10.0,
        show_default=True,
        help="Machine time in s between two checkpoints in the recording, from which a replay can begin; 0: none.",
    ),
    click.option("--record-when", help="Begin the recording when a field has this value: 'x.set_velocity != 0'."),
    click.option(
        "--split", help="Record in parts of a size or a time, 500MB or 10min; the recording is a folder then."
    ),
    click.option(
        "--compression",
        type=click.Choice(("zstd", "lz4", "none")),
        default="zstd",
        show_default=True,
        help="Compression of the recording.",
    ),
    click.option("--strict", is_flag=True, help="A refused command makes the exit status 1."),
    start_options,
)
"""Options that offline run and graph share."""

graph_options = option_group(
    click.option(
        "--foxglove",
        type=click.IntRange(1, 65535),
        is_flag=False,
        flag_value=8765,
        metavar="[PORT]",
        help="Stream the messages of a recording to Foxglove at ws://localhost:PORT; without PORT 8765.",
    ),
    run_web_options,
    click.option("--isolated", is_flag=True, help="In a network of its own, that no other process reaches: enter."),
    click.option("--free-run", is_flag=True, help="As fast as all nodes follow, instead of in real time."),
    click.option("--composed", is_flag=True, help="All nodes in one process."),
    namespace_option,
    click.option(
        "--recorder", "on_demand", is_flag=True, help="A recorder that records on demand: do recorder start FILE."
    ),
    click.option("--keep", type=POSITIVE, help="Keep the last seconds in memory: do recorder snapshot FILE."),
    click.option(
        "--snapshots", type=click.Path(file_okay=False), help="Folder for a snapshot at each error; with --keep."
    ),
    click.option(
        "--snapshot-when",
        help="A snapshot also when a field comes to a value: 'x.following_error > 0.1'; with --snapshots.",
    ),
    click.option(
        "--stay", is_flag=True, help="Continue when everything is at a standstill, for commands, until Ctrl-C."
    ),
    click.option(
        "--state-rate", type=STATES_PER_SECOND, help="Live states per second on /<unit>/state, 0 = none (P-MACH-00070)."
    ),
)
"""Options of the graph alone."""

sweep_options = option_group(
    MACHINE,
    PROGRAM,
    DIALECT,
    SCENARIO,
    click.option("--duration", type=DURATION, help="End each run after this many seconds."),
    click.option(
        "--vary", multiple=True, required=True, help="x.getriebe.0.kv=2000:8000:13, =a,b,c, =normal:mean:sigma ..."
    ),
    click.option(
        "--goal", "goals", multiple=True, required=True, help="max(following_error.x), max:mean(path_velocity) ..."
    ),
    click.option("-o", "--output", required=True, type=click.Path(dir_okay=False), help="Parquet file to write."),
    click.option("--page", type=click.Path(dir_okay=False), help="HTML page to write."),
    click.option("--random", type=click.IntRange(min=1), metavar="N", help="N random variants, instead of a grid."),
    click.option("--optimise", type=click.IntRange(min=1), metavar="N", help="N variants chosen by their results."),
    click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Of random values."),
    click.option("--workers", type=click.IntRange(min=1), help="Processes; default: one for each processor."),
    click.option("--scheduler", metavar="ADDRESS", help="Dask scheduler (tcp://host:8786) instead of processes."),
)
"""What varies, what is measured, where it is computed."""

replay_options = option_group(
    RECORDING,
    click.option(
        "--verify", is_flag=True, help="Compute the run again and compare every setpoint to the bit (the default)."
    ),
    click.option("--publish", is_flag=True, help="Publish the recorded topics again."),
    click.option("--rate", type=RATE, default=1.0, show_default=True, help="Factor for --publish, 1 = real time."),
    click.option("--inputs", is_flag=True, help="Publish PLC inputs too: a machine on this ROS domain acts on them."),
    click.option(
        "--checkpoints",
        type=POSITIVE,
        metavar="S",
        help="Compute it once and keep its state every S seconds beside it.",
    ),
    click.option("--from", "begin", type=DURATION, help="What if: changes count from this time on, s."),
    click.option("--to", "end", type=DURATION, help="What if: to this time, s."),
    click.option("--set", "parameters", multiple=True, metavar="UNIT.NAME=VALUE", help="What if: another parameter."),
    click.option("--override", type=PERCENT, help="What if: override of the channels, percent."),
    click.option("--program", type=click.Path(dir_okay=False), help="What if: in place of the loaded program."),
    click.option("--commands", type=click.Path(dir_okay=False), help="What if: further commands, as a scenario."),
    click.option("--output", "-o", type=click.Path(dir_okay=False), help="What if: record the changed run."),
    click.option("--diff", is_flag=True, help="What if: print the difference (always without --output)."),
    click.option("--diff-page", "page", type=click.Path(dir_okay=False), help="What if: a page of both runs (.html)."),
    namespace_option,
)
"""What a replay does, and what is changed in it."""


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


def require_an_end(options: dict[str, Any]) -> None:
    """Raises UsageError when options of `run` say two ends, or an end that a machine for commands has not."""
    if options["stay"] and options["duration"] is not None:
        raise click.UsageError("--stay and --duration exclude each other: --duration stays for that many seconds.")
    if options["stay"] and options["free_run"]:
        raise click.UsageError("--stay and --free-run exclude each other: a machine is commanded in real time.")


def require_variants(options: dict[str, Any]) -> None:
    """Raises UsageError unless options of `sweep` say what runs, where, and one way to vary it."""
    if options["random"] is not None and options["optimise"] is not None:
        raise click.UsageError("--random and --optimise exclude each other.")
    if options["workers"] is not None and options["scheduler"] is not None:
        raise click.UsageError("--workers and --scheduler exclude each other: a scheduler has its own workers.")
    if options["program"] is None and options["scenario"] is None:
        raise click.UsageError("--program or --scenario is needed.")


def take_changes(options: dict[str, Any]) -> dict[str, Any] | None:
    """Takes what is changed in a replay out of its options; None where nothing is. Raises UsageError."""
    changes = {name: options.pop(name) for name in WHAT_IF}
    if all(value in (None, (), False) for value in changes.values()):
        return None
    if options["verify"] or options["publish"] or options.pop("checkpoints") is not None:
        others = "--verify, --publish and --checkpoints"
        raise click.UsageError(f"{others} do not go with a changed run; nothing was replayed")
    changes["begin"] = changes["begin"] or 0.0
    return changes
