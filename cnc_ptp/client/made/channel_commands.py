"""The commands of an NC channel as methods. Made by cnc_ptp/client/make_commands.py; do not edit."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from cnc_ptp.client.asking import Asking
from cnc_ptp.client.job import Answer, Job, ProgramJob


class ChannelCommands(Asking):
    """What an NC channel can be told. A refusal raises the error of the unit; nothing has changed then."""

    def load(
        self,
        program: str,
        *,
        text: str | None = None,
        files: Mapping[str, str] | None = None,
        dialect: Literal["twincat", "iso"] | None = None,
    ) -> Answer:
        """Reads and checks an NC program.

        program  NC program; file
        text  the program itself; left out: `program` is read
        files  texts of the programs that it calls, by name; left out: they are read
        dialect  vocabulary of the program: twincat or iso; left out: that of P-CHAN-90010
        """
        return self._answer("load", program=program, text=text, files=files, dialect=dialect)

    def start(
        self,
        *,
        line: int | None = None,
        block_number: int | None = None,
        in_program: str | None = None,
        pass_number: int | None = None,
    ) -> ProgramJob:
        """Starts the program at its beginning, a line or block; resumes it after M00, M01, single block.

        line  begins at this line; left out: the beginning
        block_number  begins at the block with this N number; left out: the beginning
        in_program  of the line or block: one that is called; left out: the loaded one
        pass_number  of several passes of the line; left out: the first one
        """
        return self._program_job(
            "start",
            line=line,
            block_number=block_number,
            in_program=in_program,
            pass_number=pass_number,
        )

    def feed_hold(self, enabled: bool) -> Answer:
        """Stops the path on its ramp, and resumes it.

        enabled  on or off
        """
        return self._answer("feed_hold", enabled=enabled)

    def set_override(self, percent: float) -> Answer:
        """Override of the path.

        percent [%]  override
        """
        return self._answer("set_override", percent=percent)

    def single_block(self, enabled: bool, *, mode: Literal["block", "motion"] | None = None) -> Answer:
        """Stops after each NC block, or after each motion.

        enabled  on or off
        mode  behind what the program stops; left out: `block`
        """
        return self._answer("single_block", enabled=enabled, mode=mode)

    def optional_stop(self, enabled: bool) -> Answer:
        """Whether M01 stops.

        enabled  on or off
        """
        return self._answer("optional_stop", enabled=enabled)

    def block_skip(self, enabled: bool, *, level: int | None = None) -> Answer:
        """Whether blocks with `/` are left out, from the next start on.

        enabled  on or off
        level  skip level 1 … 10 (`/` is `/1`); left out: 1
        """
        return self._answer("block_skip", enabled=enabled, level=level)

    def reset(self) -> Job:
        """Aborts the program; path and spindles stop on their ramps."""
        return self._job("reset")

    def mdi(self, text: str, *, files: Mapping[str, str] | None = None) -> ProgramJob:
        """Executes NC text (manual data input).

        text  NC text
        files  texts of the programs that it calls, by name; left out: they are read
        """
        return self._program_job("mdi", text=text, files=files)

    def acknowledge(self, id: int) -> Answer:
        """Acknowledges a handshake request.

        id  number of the request
        """
        return self._answer("acknowledge", id=id)

    def measuring_event(self) -> Answer:
        """The probe has switched: ends a measuring run (G100), sends functions of type MNE_SNS."""
        return self._answer("measuring_event")

    def set_zero_offset(self, index: int, axis: str, value: float) -> Answer:
        """A value of a zero offset; it counts when the offset is selected next.

        index  of the zero offset: 1 is G54, up to 96
        axis  its name in programs
        value [mm, °]  offset of the axis
        """
        return self._answer("set_zero_offset", index=index, axis=axis, value=value)

    def teach_zero_offset(self, index: int, *, axis: str | None = None, value: float | None = None) -> Answer:
        """The present position becomes a zero offset.

        index  of the zero offset: 1 is G54, up to 96
        axis  its name in programs; left out: all axes of the channel
        value [mm, °]  what programs will call the position; left out: 0
        """
        return self._answer("teach_zero_offset", index=index, axis=axis, value=value)

    def set_clamp_position(self, index: int) -> Answer:
        """Clamp position of the next program.

        index  0 to 149, one of the machine file
        """
        return self._answer("set_clamp_position", index=index)
