"""Synchronous operation of spindles: coupling groups are defined, enabled and disabled (TF5200 spindle 2.8.3).

#SET AX LINK [group, [slave=master, num, den], ...] defines, also without the inner brackets (without a ratio 1 / 1),
#ENABLE AX LINK [group] starts, #DISABLE AX LINK [group] ends. Group 0 comes from the channel parameters. Definitions
are kept for later programs; couplings end with the program.
"""

import re
from collections.abc import Sequence

from cnc_ptp.errors import Value
from cnc_ptp.nc import faults, spindle_faults
from cnc_ptp.nc.canonical import Function, SpindleLink
from cnc_ptp.nc.faults import Fault, ProgramError
from cnc_ptp.nc.lexer import NUMBER
from cnc_ptp.nc.modal_state import ModalState, Pair, Pairs
from cnc_ptp.nc.program import Channel, HashCommand, NcBlock, Spindle
from cnc_ptp.nc.spindles import current_main, name_of, names
from cnc_ptp.spindle.ratio import LARGEST_RATIO, SMALLEST_RATIO, is_permitted

DEFINITION = "[group, slave=master, ...] or [group, [slave=master, num, den], ...]"
_NUMBER = re.compile(NUMBER, re.ASCII)


class _Command:
    """One #AX LINK command while it is carried out."""

    def __init__(self, channel: Channel, state: ModalState, block: NcBlock, command: HashCommand) -> None:
        self.channel, self.state, self.block, self.command = channel, state, block, command

    def fault(self, fault: Fault, **values: Value) -> ProgramError:
        """The error at the place of the command."""
        return fault.at(self.block.source, self.command.column, **values)

    def syntax(self, syntax: str) -> ProgramError:
        """The error for a command with wrong syntax."""
        name = f"#{self.command.name}"
        written = f"{name} {syntax}" if syntax else "without arguments"
        return self.fault(spindle_faults.COMMAND_ARGUMENTS, command=name, syntax=written)

    def group(self, text: str, first: int) -> int:
        """Number of a coupling group, from `first` on."""
        last = self.channel.table.link_groups - 1
        if not text.isdecimal() or not first <= int(text) <= last:
            raise self.fault(spindle_faults.LINK_GROUP, group=text or "without a number", first=first, last=last)
        return int(text)

    def called(self, key: str) -> str:
        """The name by which the program calls a spindle now."""
        return name_of(self.channel, self.state, key)

    def pairs_of(self, arguments: Sequence[str]) -> Pairs:
        """`slave=master` by key, each followed by the ratio `num, den` or by none, or with it in brackets."""
        pairs: list[Pair] = []
        rest = list(arguments)
        while rest:
            if rest[0].startswith("["):
                pairs.append(self._bracketed(rest))
                continue
            pair = self._pair(rest.pop(0))
            if rest and "=" not in rest[0]:
                pair = self._with_ratio(pair, rest)
            pairs.append(pair)
        return tuple(pairs)

    def _pair(self, text: str) -> Pair:
        """`slave=master`."""
        slave, equals, master = text.partition("=")
        if not equals:
            raise self.syntax(DEFINITION)
        return Pair(self.spindle(slave.strip()), self.spindle(master.strip()))

    def _bracketed(self, rest: list[str]) -> Pair:
        """Takes `[slave=master, num, den]` or `[slave=master]` from `rest`."""
        last = next((index for index, word in enumerate(rest) if word.endswith("]")), -1)
        words = [word.strip() for word in ",".join(rest[: last + 1])[1:-1].split(",")]
        del rest[: last + 1]
        if words[1:2] == ["G"]:
            raise self.fault(spindle_faults.LINK_GANTRY, slave=words[0].partition("=")[0].strip())
        if last < 0 or len(words) > 3 or "[" in "".join(words):
            raise self.syntax(DEFINITION)
        pair = self._pair(words[0])
        if len(words) == 2:
            raise self.fault(spindle_faults.LINK_DENOMINATOR, num=words[1], spindle=self.called(pair.slave))
        return self._with_ratio(pair, words[1:]) if len(words) == 3 else pair

    def _with_ratio(self, pair: Pair, rest: list[str]) -> Pair:
        """Takes two numbers from `rest`."""
        if len(rest) < 2 or "=" in rest[1]:
            raise self.syntax(DEFINITION)
        num, den = rest.pop(0), rest.pop(0)
        ratio = [float(text) for text in (num, den) if _NUMBER.fullmatch(text)]
        if len(ratio) < 2 or 0.0 in ratio or not is_permitted(ratio[0] / ratio[1]):
            raise self.fault(
                spindle_faults.LINK_RATIO,
                num=num or "nothing",
                den=den or "nothing",
                spindle=self.called(pair.slave),
                smallest=f"{SMALLEST_RATIO:g}",
                largest=f"{LARGEST_RATIO:g}",
            )
        return pair._replace(num=ratio[0], den=ratio[1])

    def spindle(self, name: str) -> str:
        """Key of a spindle by name, or by its logical axis number."""
        known = names(self.channel, self.state)
        if name.isdecimal():
            spindle = next((spindle for spindle in known.values() if spindle.number == int(name) > 0), None)
        else:
            spindle = known.get(name)
        if spindle is None:
            raise self.fault(faults.SPINDLE_UNKNOWN, word=name, known=", ".join(known) or "none")
        self.require_unit(spindle)
        return spindle.key

    def require_unit(self, spindle: Spindle) -> None:
        """A spindle that the PLC moves cannot follow or lead (P-CHAN-00069)."""
        if spindle.plc_control:
            word = f"#{self.command.name}"
            raise self.fault(spindle_faults.PLC_SPINDLE, word=word, spindle=self.called(spindle.key))

    def pairs(self, group: int) -> Pairs:
        """The pairs of a group that can be enabled."""
        pairs = self.channel.table.default_link if group == 0 else self.state.spindle.links.get(group, ())
        if not pairs:
            raise self.fault(spindle_faults.LINK_EMPTY, group=group)
        return pairs

    def check_group(self, pairs: Pairs) -> None:
        """No spindle follows itself or two masters, none is slave and master."""
        slaves = [pair.slave for pair in pairs]
        for slave, master, _, _ in pairs:
            for spindle in self.channel.table.spindles:
                if spindle.key in (slave, master):
                    self.require_unit(spindle)
            if slave == master:
                raise self.fault(spindle_faults.LINK_ITSELF, spindle=self.called(slave))
            if slaves.count(slave) > 1:
                raise self.fault(spindle_faults.SLAVE_TWICE, spindle=self.called(slave))
            if master in slaves:
                raise self.fault(spindle_faults.SLAVE_AND_MASTER, spindle=self.called(master))

    def check_others(self, pairs: Pairs) -> None:
        """The pairs against all groups that are active."""
        main = current_main(self.channel, self.state).key
        for slave, master, _, _ in pairs:
            for group in self.state.spindle.active:
                for other_slave, other_master, _, _ in self.state.spindle.links[group]:
                    self.check_pair(slave, master, other_slave, other_master, group)
            if slave == main:
                raise self.fault(spindle_faults.SLAVE_IS_MAIN, spindle=self.called(slave))

    def check_pair(self, slave: str, master: str, other_slave: str, other_master: str, group: int) -> None:
        """One pair against one that is active in `group`."""
        if slave == other_slave:
            raise self.fault(spindle_faults.SLAVE_ELSEWHERE, spindle=self.called(slave), group=group)
        if slave == other_master:
            raise self.fault(spindle_faults.SLAVE_MASTERS, spindle=self.called(slave), group=group)
        if master == other_slave:
            raise self.fault(spindle_faults.MASTER_FOLLOWS, spindle=self.called(master), group=group)


def define(channel: Channel, state: ModalState, block: NcBlock, command: HashCommand) -> tuple[Function, ...]:
    """#SET AX LINK [group, slave=master, num, den, ...]: a group with its pairs; an active group cannot be changed."""
    link = _Command(channel, state, block, command)
    arguments = command.arguments or ()
    if len(arguments) < 2:
        raise link.syntax(DEFINITION)
    if arguments[0] == "0":
        raise link.fault(spindle_faults.LINK_GROUP_DEFAULT)
    group = link.group(arguments[0], 1)
    if group in state.spindle.active:
        raise link.fault(spindle_faults.LINK_ACTIVE, group=group)
    pairs = link.pairs_of(arguments[1:])
    link.check_group(pairs)
    state.spindle.links[group] = pairs
    return ()


def enable(channel: Channel, state: ModalState, block: NcBlock, command: HashCommand) -> tuple[Function, ...]:
    """#ENABLE AX LINK [group]: from now on the slaves get the functions of their masters; without a number group 0."""
    link = _Command(channel, state, block, command)
    group = _optional_group(link, 0)
    if group in state.spindle.active:
        return ()
    pairs = link.pairs(group)
    link.check_group(pairs)
    link.check_others(pairs)
    state.spindle.links[group] = pairs
    state.spindle.active += (group,)
    return tuple(SpindleLink(pair.slave, pair.master, True, pair.num, pair.den) for pair in pairs)


def disable(channel: Channel, state: ModalState, block: NcBlock, command: HashCommand) -> tuple[Function, ...]:
    """#DISABLE AX LINK [group]: ends a coupling; without a number the one that was enabled last."""
    link = _Command(channel, state, block, command)
    active = state.spindle.active
    group = _optional_group(link, active[-1] if active else -1)
    if group not in active:
        what = "no coupling group is" if group < 0 else f"coupling group {group} is not"
        raise link.fault(spindle_faults.LINK_NOT_ACTIVE, what=what)
    return _end(state, (group,))


def disable_all(channel: Channel, state: ModalState, block: NcBlock, command: HashCommand) -> tuple[Function, ...]:
    """#AX LINK OFF ALL: ends all couplings."""
    if command.arguments is not None:
        raise _Command(channel, state, block, command).syntax("")
    return end_of_links(state)


def end_of_links(state: ModalState) -> tuple[Function, ...]:
    """All couplings end, as they do with the program."""
    return _end(state, state.spindle.active)


def check_main(channel: Channel, state: ModalState, block: NcBlock, command: HashCommand, key: str) -> None:
    """A spindle that follows another one cannot become the main spindle. Raises ProgramError 21347."""
    slaves = [pair.slave for group in state.spindle.active for pair in state.spindle.links[group]]
    if key in slaves:
        name = name_of(channel, state, key)
        raise spindle_faults.SLAVE_IS_MAIN.at(block.source, command.column, spindle=name)


def _optional_group(link: _Command, without: int) -> int:
    arguments = link.command.arguments
    if arguments is None:
        return without
    if len(arguments) != 1:
        raise link.syntax("[group]")
    return link.group(arguments[0], 0)


def _end(state: ModalState, groups: tuple[int, ...]) -> tuple[Function, ...]:
    ended = [pair for group in groups for pair in state.spindle.links[group]]
    state.spindle.active = tuple(group for group in state.spindle.active if group not in groups)
    return tuple(SpindleLink(pair.slave, pair.master, False) for pair in ended)
