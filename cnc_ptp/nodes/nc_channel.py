"""`nc_channel MACHINE.yaml NAME`: the node of one NC channel with its path interpolator."""

from __future__ import annotations

import contextlib
from typing import Any

import click

from cnc_ptp import action, msg
from cnc_ptp.channel.channel_unit import ChannelUnit
from cnc_ptp.errors import CncError
from cnc_ptp.machine.command_files import with_program
from cnc_ptp.machine.program_files import read_program
from cnc_ptp.machine.run_entries import add_manual_files, load_arguments, program_search
from cnc_ptp.machine.wiring import build_unit
from cnc_ptp.nodes import convert, node_command_line
from cnc_ptp.nodes.program_topic import ProgramTopic
from cnc_ptp.nodes.topics import EVENTS, handshake_topic, offsets_topic
from cnc_ptp.nodes.unit.jobs import JobServer
from cnc_ptp.nodes.unit.requests import given_arguments
from cnc_ptp.nodes.unit.unit_node import UnitNode
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.parameters.view.authority import OF_SERVICES
from cnc_ptp.protocol.blocks import ChannelBlock, Command, CommandRecord, CycleBlock, PlcBlock
from cnc_ptp.protocol.commands import COMMANDS


class ChannelNode(UnitNode):
    """UnitNode of a channel.

    Publishes besides: /<channel>/handshake (HandshakeRequest) for M, S, T, D and H functions; /<channel>/offsets
    (ChannelOffsets) and /<channel>/program (ProgramState) when they change.
    Action: /<channel>/run_program (RunProgram); cancel = reset.
    """

    def __init__(
        self,
        machine: MachineParameters,
        name: str,
        *,
        program: str | None = None,
        dialect: str | None = None,
        **options: Any,
    ) -> None:
        """`program`: a file that the PLC will load first, in `dialect`; it is interpreted before the clock starts."""
        node_command_line.require_unit(machine, name, ["channel"])
        unit = build_unit(machine, name)
        if program is not None and isinstance(unit, ChannelUnit):
            unit.prepare(program, *read_program(program, program_search(machine, name)), dialect)
        self._search = program_search(machine, name)
        super().__init__(machine, unit, **options)
        self._cycle_time = machine.cycle_time_us * 1e-6
        self._program_topic: ProgramTopic | None = None

    def setup(self) -> None:
        """As UnitNode, with handshakes and the action."""
        super().setup()
        name = self.unit.name
        self._handshake_publisher = self.create_publisher(msg.HandshakeRequest, handshake_topic(name), EVENTS)
        self._offsets_publisher = self.create_publisher(msg.ChannelOffsets, offsets_topic(name), EVENTS)
        if isinstance(self.unit, ChannelUnit):
            self._program_topic = ProgramTopic(self, self.unit, cycle_time=self._cycle_time)
        self._program_job = JobServer(
            self,
            action.RunProgram,
            f"{name}/run_program",
            start=self._start_program,
            halt=Command(name, "reset", {}),
            feedback=program_feedback,
            result=program_result,
        )

    def _start_program(self, goal: Any) -> list[Command]:
        known = COMMANDS["channel"]["start"]
        start = Command(self.unit.name, "start", given_arguments(known, goal))
        return [Command(self.unit.name, "load", {"program": goal.program}), start] if goal.program else [start]

    def command(self, command: Command, source: str | None = OF_SERVICES) -> CommandRecord:
        """As UnitNode; a program is read here, so that the unit and each replay get its text."""
        try:
            command = with_program(command, self._machine, self._loaded)
        except CncError as error:
            return self.refuse(command, error)
        return super().command(command, source)

    def arguments(self, command: str, request: Any) -> dict[str, Any]:
        """As UnitNode, with the programs that come with the request."""
        names, texts = getattr(request, "file_names", ()), getattr(request, "file_texts", ())
        files = {"files": dict(zip(names, texts, strict=False))} if names else {}
        return super().arguments(command, request) | files

    @property
    def _loaded(self) -> dict[str, str]:
        """Channel -> file of its program."""
        unit = self.unit
        return {unit.name: unit.program_view.program} if isinstance(unit, ChannelUnit) else {}

    def complete_commands(self, block: PlcBlock) -> None:
        """Texts of programs do not travel in blocks; a missing file leaves a command that the unit refuses."""
        for command in block.commands:
            if command.target == self.unit.name and command.command == "load" and "text" not in command.arguments:
                with contextlib.suppress(CncError):
                    path = command.arguments["program"]
                    command.arguments.update(load_arguments(path, *read_program(path, self._search)))
        with contextlib.suppress(CncError):
            own = [each for each in block.commands if each.target == self.unit.name]
            add_manual_files(own, self._machine, self._loaded)

    def run_ended(self) -> None:
        self._program_job.end()

    def after_block(self, block: CycleBlock) -> None:
        if isinstance(block, ChannelBlock):
            self._program_job.after_block(block)
            for offsets in block.offsets:
                self._offsets_publisher.publish(convert.offsets_to_message(offsets, self.stamp(offsets.cycle)))
            if self._program_topic is not None:
                self._program_topic.after_block(block)
            for request in block.requests:
                self._handshake_publisher.publish(convert.request_to_message(request, self.stamp(request.cycle)))


def program_feedback(block: CycleBlock, feedback: Any) -> None:
    if isinstance(block, ChannelBlock):
        feedback.line, feedback.block_number = block.line[-1], block.block_number[-1]
        feedback.path_velocity, feedback.distance_to_go = block.path_velocity[-1], block.distance_to_go[-1]
        feedback.progress, feedback.time_left = block.progress, block.time_left
        feedback.state = block.state[-1]


def program_result(block: CycleBlock, result: Any) -> bool | None:
    """The program has ended when the channel is done; in full when all its blocks are finished without an error."""
    if not isinstance(block, ChannelBlock) or not block.done:
        return None
    result.error_id = block.error_id[-1]
    result.cycle = block.first_cycle + block.count - 1
    done = block.error_id[-1] == 0 and block.blocks_done >= block.blocks_total
    result.message = "" if done else f"the program was aborted after block {block.blocks_done} of {block.blocks_total}"
    return done


PROGRAM = click.Option(["--program"], help="NC program that will be loaded first: interpreted before the clock starts.")
DIALECT = click.Option(["--dialect"], type=click.Choice(("twincat", "iso")), help="Vocabulary of --program.")
main = node_command_line.unit_main(ChannelNode, "NC channel", PROGRAM, DIALECT)

if __name__ == "__main__":
    main()
