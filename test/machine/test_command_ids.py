"""The record of a command that came in a block carries the command's number; an input can be taken back."""

from pathlib import Path

from cnc_ptp.machine.offline import OfflineMachine
from cnc_ptp.machine.run_entries import read_entries
from cnc_ptp.machine.wiring import build_unit, build_units
from cnc_ptp.parameters import read_machine
from cnc_ptp.protocol.blocks import ChannelBlock, Command, CycleTick, PlcBlock

CONFIG = Path(__file__).parents[2] / "config"
PTP, MILL = CONFIG / "ptp.yaml", CONFIG / "mill.yaml"


def test_a_record_names_the_command_it_carries_out():
    axis = build_unit(read_machine(PTP), "x")
    assert axis.command(Command("x", "power", {"enabled": True}, 41), 0).id == 41
    assert axis.command(Command("x", "move_absolute", {"target": 1e9}, 42), 0).id == 42
    assert axis.command(Command("x", "halt", {}), 0).id == 0
    assert [record.id for record in axis.take_records()] == [41, 42, 0]


def test_inputs_of_the_plc_are_numbered_when_they_go_out_and_until_then_can_be_taken_back():
    plc = build_unit(read_machine(PTP), "plc")
    first, twin, other = (Command("x", name, {}) for name in ("halt", "halt", "stop"))
    for command in (first, twin, other):
        plc.input(command)
    assert plc.withdraw(twin) and not plc.withdraw(twin)
    block = plc.step(CycleTick(0, 10), {})
    assert [(command.command, command.id) for command in block.commands] == [("halt", 1), ("stop", 2)]
    assert block.commands[0] is first and twin.id == 0
    assert not plc.withdraw(first)
    plc.input(twin)
    assert [command.id for command in plc.step(CycleTick(10, 10), {}).commands] == [3]


def test_commands_of_channel_and_plc_are_found_again_by_number(tmp_path):
    program = tmp_path / "m3.nc"
    program.write_text("%ids\nN10 G135 M3 S1000\nN20 G1 X2 F6000\nN30 M5\nN40 M30\n")
    machine = read_machine(MILL)
    run = OfflineMachine(
        machine, build_units(machine, scenario=read_entries(machine, program=str(program), scenario=None))
    )
    sent = {PlcBlock: [], ChannelBlock: []}
    records = []
    for _ in range(300):
        for output in run.tick().values():
            if type(output.block) in sent:
                sent[type(output.block)] += output.block.commands
            records += output.records
    for commands in sent.values():
        assert [command.id for command in commands] == list(range(1, len(commands) + 1)) != []
    numbered = {(each.target, each.command, each.id) for commands in sent.values() for each in commands}
    assert {(each.target, each.command, each.id) for each in records if each.id} == numbered
