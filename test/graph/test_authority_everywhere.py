"""Refusals of a closed unit: offline, composed and in the graph the same, to the bit."""

from authority_support import END, closed_file
from client_support import beside_composed_run
from graph_support import run, states_equal, verified

from cnc_ptp import msg


def test_offline_composed_and_graph_are_equal(tmp_path):
    """The scenario moves both axes; that of the closed one is refused at the same cycle, and replay repeats it."""
    file = closed_file(tmp_path, "plc")
    scenario = tmp_path / "moves.yaml"
    moves = (f"- {{at: 0.1, to: {axis}, do: move_absolute, target: 5, velocity: 50}}\n" for axis in ("x", '"y"'))
    scenario.write_text("".join(moves))
    recordings = [tmp_path / f"{name}.mcap" for name in ("offline", "composed", "graph")]
    run("simulate", file, "--scenario", scenario, "--record", recordings[0])
    run("run", file, "--scenario", scenario, "--composed", "--record", recordings[1])
    run("run", file, "--scenario", scenario, "--record", recordings[2])
    rule = "the machine file closes it to the PLC (closed_to_plc, P-MACH-00080)"
    wanted = [(100, "x", "move_absolute", 26218, f"axis x: move_absolute refused: {rule}{END}")]
    for recording in recordings:
        assert states_equal(recordings[0], recording) == []
        refused = [record for record in verified(recording).commands if not record.accepted]
        found = [(each.cycle, each.target, each.command, each.error_id, each.message) for each in refused]
        assert found == wanted


def test_a_lost_plc_holds_nothing_that_it_could_not_release(tmp_path):
    with beside_composed_run(closed_file(tmp_path, "plc")) as client:
        client.write("/plc/life_sign", msg.LifeSign, counter=1)
        client.spin_until(lambda: any(event.error_id == 26103 for event in client.events), "the event")
        (text,) = (event.text for event in client.events if event.error_id == 26103)
        assert text.endswith("; feed hold is set on y")
        client.wait_blocks("x")
        assert not client.commands("x", "feed_hold")
