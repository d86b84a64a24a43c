"""Processes of a graph that die or are held up at random moments, and what became of the machine."""

from __future__ import annotations

import os
import random
import re
import signal
import time
from collections.abc import Iterator
from contextlib import ExitStack, suppress
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import psutil

from campaign import motion
from campaign.cases import CASES, THREAD_END, Case
from campaign.graph import SERVER, SUPERVISOR, Graph, free_domain
from campaign.witness import Witness
from cnc_ptp.errors import CncError
from cnc_ptp.nodes.forked import SERVER_ENDED
from cnc_ptp.parameters import MachineParameters, read_machine
from cnc_ptp.recording.node_figures import LATENESS_MAX
from cnc_ptp.recording.reader import Recorded, read_recording

KILL, TERM, HOLD = "SIGKILL", "SIGTERM", "SIGSTOP"
END_PATIENCE = 45.0
"""Seconds in which a run must have ended after a fault."""
SURVIVED_AFTER = 3.0
"""Seconds after which a run that goes on has survived."""
SHORTEST, LONGEST = 0.05, 10.0
"""Seconds for which a process is held up."""
FLUSHED = 600
"""Cycles that a recorder that dies may not have written yet."""
RETRACTED = 0.01
"""mm; the retract begins within a block of its event."""
HELD_SHARE, TERM_SHARE = 0.3, 0.2
INTERRUPTED = "P-ERR-26106"
ENDLESS = "does not end"
RETRACTS = re.compile(r"axis (\w+) retracts by ([0-9.]+) mm while the path follows")
NEAR_END = 1.0
"""mm of a thread in which it may have ended before somebody notices a fault."""


@dataclass
class Fault:
    """What happens, and when."""

    case: str
    node: str
    signal: str
    hold: float
    """Seconds of SIGSTOP, 0 for the others."""
    moment: float
    """Seconds after the first cycle."""


@dataclass
class Row:
    """A fault and its consequences; `problems` is empty if all was as it must be."""

    fault: Fault
    outcome: str = ""
    """stopped, survived, ENDLESS; over: the run had ended before; empty: it did not begin."""
    problems: list[str] = field(default_factory=list)
    seconds: float = 0.0
    """From the fault to the end of the run."""
    cycles: int = 0
    own_stops: dict[str, int] = field(default_factory=dict)
    """Cycles in which drives have braked on their own, by unit."""
    torn: dict[str, list[float]] = field(default_factory=dict)
    """How far coupled units came apart, and how far they may."""
    load: float = 0.0

    @property
    def good(self) -> bool:
        return not self.problems

    def as_json(self) -> dict[str, Any]:
        return asdict(self) | {"good": self.good}


def faults(seed: int) -> Iterator[Fault]:
    """Without an end: case after case, everything else at random."""
    choose = random.Random(seed)
    for number in range(1_000_000_000):
        case = CASES[number % len(CASES)]
        machine = read_machine(str(case.machine))
        units = [*machine.axes, *machine.spindles]
        nodes = [*units, *units, *machine.channels, "plc", "clock", "recorder", SUPERVISOR, SERVER]
        what = choose.random()
        name = HOLD if what < HELD_SHARE else TERM if what < HELD_SHARE + TERM_SHARE else KILL
        hold = round(SHORTEST * (LONGEST / SHORTEST) ** choose.random(), 3) if name == HOLD else 0.0
        yield Fault(case.name, choose.choice(nodes), name, hold, round(choose.uniform(0.1, case.seconds), 3))


def run(fault: Fault, folder: Path, *, domain: int) -> Row:
    """Starts the case of the fault, lets it happen, and checks everything."""
    case = next(each for each in CASES if each.name == fault.case)
    row = Row(fault, load=os.getloadavg()[0])
    try:
        run_into(row, case, folder, domain)
    except Exception as error:  # whatever it is, the faults behind it are tried
        row.problems.append(f"not looked at to the end: {error!r}")
    return row


def run_into(row: Row, case: Case, folder: Path, domain: int) -> None:
    """What `run` does."""
    fault, recording = row.fault, folder / "run.mcap"
    machine = read_machine(str(case.machine))
    graph, witness = Graph(case.words(folder), recording, domain=domain), None
    with ExitStack() as stack:
        stack.callback(graph.end)
        if not graph.wait_for_start():
            row.problems.append(f"the run did not start: {graph.output[-300:]}")
            return
        if fault.node not in graph.processes:
            row.problems.append(f"there is no process of {fault.node}, but of {', '.join(graph.processes)}")
            return
        begin = time.monotonic()
        if fault.node == "recorder":
            witness = stack.enter_context(Witness(case.machine, folder / "seen.npz", domain))
            witness.wait()
        time.sleep(max(0.0, begin + fault.moment - time.monotonic()))
        if not graph.running:
            row.outcome = "over"
            return
        happened = time.monotonic()
        strike(graph.processes[fault.node], fault)
        row.outcome = await_end(graph, fault)
        row.seconds = round(time.monotonic() - happened, 2)
        row.problems += left_behind(graph, fault, row.outcome)
        whole = check_recording(row, case, recording, happened - begin, graph.lateness)
        if witness is not None and not (whole and row.outcome == "survived"):
            row.problems += (f"seen: {text}" for text in motion.seen_problems(witness.seen(), machine))


def lateness_before(fault: Fault, largest: float) -> float:
    """Seconds by which the machine may have been behind the clock when the fault came; a hold makes it late itself."""
    return max(0.0, largest - fault.hold)


def recorded_lateness(recorded: Recorded) -> float:
    """The largest one of its nodes, s; a killed supervisor tells none."""
    told = (each.values.get(LATENESS_MAX, "0") for each in recorded.diagnostics)
    return max((float(text) for text in told), default=0.0) / 1e3


def strike(process: psutil.Process, fault: Fault) -> None:
    with suppress(psutil.NoSuchProcess):
        process.send_signal(getattr(signal, fault.signal))
        if fault.signal == HOLD:
            time.sleep(fault.hold)
            process.send_signal(signal.SIGCONT)


def await_end(graph: Graph, fault: Fault) -> str:
    """What became of it; one that survived is interrupted.

    Over are also runs that ended as they were to: one that was interrupted only at its end, and one whose recorder,
    which writes to the end when it gets SIGTERM, had written everything.
    """
    if fault.signal == HOLD and not graph.wait(SURVIVED_AFTER):
        graph.interrupt()
        if not graph.wait(END_PATIENCE):
            return ENDLESS
        finished = graph.process.returncode == 0 and INTERRUPTED not in graph.output
        finished = finished or graph.process.returncode == -signal.SIGINT
        return "over" if finished and graph.summed_up else "survived"
    if not graph.wait(END_PATIENCE):
        return ENDLESS
    whole = fault.signal == HOLD or (fault.signal == TERM and fault.node == "recorder")
    return "over" if whole and graph.process.returncode == 0 and graph.summed_up else "stopped"


def left_behind(graph: Graph, fault: Fault, outcome: str) -> Iterator[str]:
    """Orphans, claims, shared memory, and an end that does not say who is to blame."""
    if outcome == ENDLESS:
        yield f"the run had not ended after {END_PATIENCE:g} s"
        return
    status = graph.process.returncode
    expected = {SUPERVISOR: -signal.SIGKILL} if fault.signal == KILL else {}
    if status != expected.get(fault.node, 1) and outcome != "over":
        yield f"exit status {status}"
    if orphans := graph.orphans():
        yield f"orphans: {', '.join(orphans)}"
    if left := graph.leftovers():
        yield f"left behind: {', '.join(left)}"
    output = graph.output
    if "Traceback" in output:
        yield f"a traceback: {output[output.index('Traceback') :][:400]}"
    told = names(fault, graph)
    if outcome == "stopped" and told and not any(name in output for name in told):
        yield f"nobody names {fault.node}: {output[-400:]}"


def names(fault: Fault, graph: Graph) -> list[str]:
    """Texts of which one must be told, if the run has stopped.

    None of a killed supervisor: nobody is left to tell it but the recording, which must have the stops of the drives.
    """
    if fault.node == SUPERVISOR:
        return {TERM: [INTERRUPTED], HOLD: ["P-ERR-"], KILL: []}[fault.signal]
    if fault.node == SERVER:
        return [SERVER_ENDED] if fault.signal != HOLD else ["P-ERR-"]
    died = f"P-ERR-26104 node '{fault.node}' (process {graph.processes[fault.node].pid})"
    return (
        [died] if fault.signal != HOLD else [died, f"no block of '{fault.node}' came", f"of '{fault.node}' is missing"]
    )


def check_recording(row: Row, case: Case, recording: Path, moment: float, lateness: float) -> bool:
    """Readable to the last block, all at rest on ramps within limits, nothing torn apart. True for a whole one.

    `moment` of the fault, `lateness` that the run has told, s.
    """
    machine, fault = read_machine(str(case.machine)), row.fault
    try:
        recorded = read_recording(recording)
    except CncError as error:
        row.problems.append(f"the recording is not readable: {error}")
        return False
    row.cycles = recorded.last_cycle + 1
    computed = moment - lateness_before(fault, max(lateness, recorded_lateness(recorded)))
    written = int(computed * 1e6 / machine.cycle_time_us)
    cut = fault.node == "recorder" and fault.signal in (KILL, HOLD)
    unsupervised = fault.node == SUPERVISOR and fault.signal == KILL
    if not recorded.complete and not cut and not unsupervised:
        row.problems.append(f"the recording is not complete: {recorded.missing}")
    if row.cycles < written - FLUSHED - machine.watchdog_ms * 1000 // machine.cycle_time_us:
        row.problems.append(f"the recording ends at cycle {row.cycles}, the fault came at {written}")
    of_recorder = fault.node == "recorder" and (fault.signal != HOLD or not recorded.complete)
    stopped_in = {fault.node} if fault.signal == HOLD else set()
    row.problems += motion.problems(recorded, machine, ended=not of_recorder, stopped_in=stopped_in)
    row.problems += motion.violations(recording)
    row.problems += motion.out_of_step(recorded, case.links, machine)
    row.own_stops = {stop.unit: len(stop.actual_position) for stop in recorded.drive_stops}
    check_links(row, case, recorded)
    row.problems += not_retracted(recorded)
    row.problems += silent_retract(fault, recorded, machine)
    return recorded.complete


def not_retracted(recorded: Recorded) -> Iterator[str]:
    """Threads that are broken off with a retract whose axis has not gone that way, though its process lives."""
    for event in recorded.events:
        told = RETRACTS.search(event.text)
        rows = recorded.states.get(f"/{told[1].lower()}/state") if told else None
        if told is None or rows is None or any(stop.unit == told[1].lower() for stop in recorded.drive_stops):
            continue
        positions = rows["set_position"]
        way = abs(positions[-1] - positions[np.searchsorted(rows["cycle"], event.cycle)])
        if abs(way - float(told[2])) > RETRACTED:
            yield f"{told[1]} has retracted by {way:.3f} mm instead of {told[2]} mm"


def silent_retract(fault: Fault, recorded: Recorded, machine: MachineParameters) -> Iterator[str]:
    """A thread was cut when its spindle or its axis was killed, and nobody says that the tool leaves the groove.

    Channel, PLC and the axis of the retract live then. What goes before the cut, and its end, does not count.
    """
    if fault.case != "thread" or fault.signal != KILL or fault.node not in ("s", "z"):
        return
    states, z = (recorded.states.get(f"/{unit}/state") for unit in (fault.node, "z"))
    threads = recorded.threads.get("channel")
    if states is None or z is None or threads is None or any(RETRACTS.search(event.text) for event in recorded.events):
        return
    lost = int(states["cycle"][-1]) + 1
    before = threads[(threads["cycle"] < lost) & (threads["cycle"] + 2 * machine.block_cycles >= lost)]
    cuts = len(before) and not np.isnan(before["set_phase_error_deg"]).any()
    if cuts and z["set_position"][-1] > THREAD_END + NEAR_END:
        yield f"nobody says that the tool leaves the thread that it cut in cycle {lost}"


def check_links(row: Row, case: Case, recorded: Recorded) -> None:
    machine = read_machine(str(case.machine))
    for link in case.links:
        if not {f"/{link.master}/state", f"/{link.slave}/state"} <= {*recorded.states}:
            continue  # one of them has died before its first block: nothing has moved
        name = f"{link.master}-{link.slave}"
        above = next((other for other in case.links if other.slave == link.master), None)
        if above is not None and f"/{above.master}/state" not in recorded.states:
            above = None
        apart, permitted = motion.torn(recorded, link, machine, above=above)
        row.torn[name] = [round(apart, 3), round(permitted, 3)]
        if apart > permitted:
            row.problems.append(f"{name}: {apart:.3f} apart, {permitted:.3f} permitted")


def campaign(seed: int, count: int, minutes: float, folder: Path, *, first: int = 0) -> Iterator[Row]:
    """Rows until there are `count`, or the time is over; `first`: faults of the seed that are left out."""
    end = time.monotonic() + 60.0 * minutes
    domain = free_domain(seed)
    for number, fault in enumerate(faults(seed)):
        if number < first:
            continue
        if number >= first + count or time.monotonic() > end:
            return
        place = folder / f"{number:04}"
        place.mkdir(parents=True, exist_ok=True)
        row = run(fault, place, domain=domain)
        yield row
        if row.good:
            for each in place.iterdir():
                each.unlink()
            place.rmdir()
