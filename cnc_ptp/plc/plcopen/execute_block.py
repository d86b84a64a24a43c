"""The state machine of all function blocks with the input `execute` (PLCopen Motion Control part 1, 2.4.1)."""

from __future__ import annotations

from typing import Any, ClassVar

from cnc_ptp.plc.plcopen.buffer_mode import SPINDLE_MODES, mode_arguments
from cnc_ptp.plc.plcopen.faults import BAD_BUFFER_MODE, CAME_TO_REST
from cnc_ptp.plc.plcopen.unit_reference import UnitReference, unit_of
from cnc_ptp.protocol.jobs import JobStatus
from cnc_ptp.protocol.unit import STOP_HOLDS

UNANSWERED = -1


class ExecuteBlock:
    """A function block that a rising edge of `execute` starts; called once in each PLC cycle.

    The edge latches the inputs. One of `busy`, `done`, `command_aborted` and `error` is true while `execute` is, and
    until the block has ended; after that, when `execute` has fallen before, for one call. `active` goes with `busy`
    while the unit carries the command out. A falling edge cancels nothing; a new rising edge starts again and tells
    nothing of the command before.
    """

    moves: ClassVar[bool] = True
    """It is refused while MC_Stop holds the unit."""
    waits_for_job: ClassVar[bool] = True
    """It ends with its job; otherwise with the answer of the unit."""

    def __init__(self, unit: UnitReference) -> None:
        self.unit = unit_of(self, unit)
        self.execute = False
        """The input, as in the last call."""
        self.busy = False
        self.active = False
        self.done = False
        self.command_aborted = False
        self.error = False
        self.error_id = 0
        self.error_text = ""
        self._ticket = 0
        self._job = UNANSWERED

    def _rises(self, execute: bool) -> bool:
        """Takes `execute`; True at a rising edge, at which a command is to be given. Otherwise the outputs follow."""
        before, self.execute = self.execute, bool(execute)
        if self.execute and not before:
            self._clear()
            return True
        if self.busy:
            self._follow()
        elif not self.execute:
            self._clear()
        return False

    def _start(self, command: str, buffer_mode: str = "", **arguments: Any) -> None:
        """Gives the command in a buffer mode, if it has one, with all arguments that are not None."""
        refused = f"{self._where}: {command} refused"
        if self.moves and self.unit.stops:
            self._fail(STOP_HOLDS, f"{refused}: MC_Stop holds it while execute is true; nothing was changed")
            return
        of_mode = mode_arguments(self.unit.kind, command, buffer_mode) if buffer_mode else {}
        if of_mode is None:
            reason = f"buffer_mode = '{buffer_mode}' is not {' or '.join(SPINDLE_MODES)}"
            self._fail(BAD_BUFFER_MODE, f"{refused}: {reason}; nothing was changed")
            return
        given = {name: value for name, value in arguments.items() if value is not None}
        self.busy = True
        self._ticket, self._job = self.unit.give(command, **given, **of_mode), UNANSWERED

    @property
    def _where(self) -> str:
        return f"{self.unit.kind} {self.unit.name}"

    def _follow(self) -> None:
        """What has become of the command."""
        if self._job == UNANSWERED:
            answer = self.unit.answer(self._ticket)
            if answer is None:
                return
            if answer.error_id:
                self._refused(answer.error_id, answer.message)
                return
            self._job = answer.job
        if self.waits_for_job and self._job:
            self._follow_job()
        else:
            self._follow_unit()

    def _follow_job(self) -> None:
        status = self.unit.job_status(self._job)
        if status == JobStatus.ACTIVE:
            self.active = True
            self._while_active()
        elif status == JobStatus.DONE:
            self._job_done()
        elif status == JobStatus.ABORTED:
            self._abort()
        elif status == JobStatus.FAILED:
            error = self.unit.job_error(self._job)
            self._fail(error, f"{self._where}: its motion has ended with error {error}")

    # for subclasses

    def _refused(self, error_id: int, text: str) -> None:
        """The unit has refused the command."""
        self._fail(error_id, text)

    def _follow_unit(self) -> None:
        """The unit has accepted, and no job is waited for."""
        self._finish()

    def _while_active(self) -> None:
        """The job is active."""

    def _job_done(self) -> None:
        """The job has ended in full."""
        self._finish()

    # ends

    def _finish(self) -> None:
        self._clear()
        self.done = True

    def _abort(self) -> None:
        self._clear()
        self.command_aborted = True

    def _fail(self, error_id: int, text: str) -> None:
        self._clear()
        self.error, self.error_id, self.error_text = True, error_id, text

    def _clear(self) -> None:
        """All outputs false."""
        self.busy = self.active = self.done = self.command_aborted = self.error = False
        self.error_id, self.error_text = 0, ""


class EndlessBlock(ExecuteBlock):
    """A block whose command has no end of its own.

    It stays busy while the unit does what was commanded, also after `execute` has fallen, until another command aborts
    it.
    """

    def __init__(self, unit: UnitReference) -> None:
        super().__init__(unit)
        self._reached = False

    def _clear(self) -> None:
        super()._clear()
        self._reached = False

    def _job_done(self) -> None:
        reason = "its motion has come to rest without a command, at a soft limit for instance"
        self._fail(CAME_TO_REST, f"{self._where}: {reason}")
