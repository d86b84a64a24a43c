"""--ros-args at the command line: what is taken, and the exact text of what is refused."""

import pytest
from commands_support import MILL, PTP, ROOT, call

from cnc_ptp.ros_arguments import RosArgument, RosArguments, split

PROGRAM = ROOT / "examples" / "bracket.nc"
KNOWN = (
    "-r, --remap, -p, --param, --params-file, --log-level, --log-file-name, --log-config-file, -e, --enclave, "
    "--enable-stdout-logs, --enable-rosout-logs, --enable-external-lib-logs, "
    "--disable-stdout-logs, --disable-rosout-logs, --disable-external-lib-logs"
)


def refused(*arguments):
    """The text of a refusal with exit status 2."""
    result = call(*arguments)
    assert result.exit_code == 2, result.output
    return result.stderr.removeprefix("P-ERR-26130 ROS argument ").removesuffix("; nothing was started\n")


def test_words_are_split_as_rcl_splits_them():
    words = ["a", "--ros-args", "-r", "b:=c", "--disable-rosout-logs", "--", "-d", "--ros-args", "-p", "x:e:=[1, 2]"]
    own, ros = split(words)
    assert own == ["a", "-d"]
    assert ros.words == ["--ros-args", "-r", "b:=c", "--disable-rosout-logs", "-p", "x:e:=[1, 2]"]
    assert [argument.rule for argument in ros.given] == [("", "b", "c"), ("", "", ""), ("x", "e", "[1, 2]")]
    assert split(["--ros-args"]) == ([], RosArguments()) and split(["--ros-args"])[1].words == []


def test_rcl_takes_what_is_taken_here():
    """Every option that is known here, read by ROS itself."""
    rclpy = pytest.importorskip("rclpy")
    values = {"-r": "a:=b", "--remap": "__ns:=/", "-p": "a:=1", "--param": "x:b:=y", "--params-file": str(MILL)}
    values |= {"--log-level": "x:=warn", "--log-file-name": "name", "-e": "/e", "--enclave": "/e"}
    words = [
        word for option in KNOWN.split(", ") if option != "--log-config-file" for word in option_with(values, option)
    ]
    own, ros = split(["--ros-args", *words])
    assert own == [] and ros.words == ["--ros-args", *words]
    context = rclpy.Context()
    context.init(args=ros.words)
    context.shutdown()


def option_with(values, option):
    return [option, values[option]] if option in values else [option]


@pytest.mark.parametrize(
    ("words", "namespace"),
    [
        ([], ""),
        (["-r", "__ns:=/cell"], "/cell"),
        (["--remap", "__ns:=/a/b", "-r", "__ns:=/c"], "/a/b"),
        (["-r", "__ns:=/"], ""),
        (["-r", "x:__ns:=/one"], ""),
        (["-p", "__ns:=/one"], ""),
    ],
)
def test_namespace(words, namespace):
    assert split(["--ros-args", *words])[1].namespace == namespace


@pytest.mark.parametrize("command", ["check", "params"])
def test_offline_commands_take_the_empty_arguments_of_launch(command):
    argument = {"check": PROGRAM, "params": "P-AXIS-00099"}[command]
    assert call(command, argument, "--ros-args").exit_code == 0
    assert call(command, "--ros-args", "--", argument).exit_code == 0


@pytest.mark.parametrize(
    ("command", "arguments"),
    [
        ("simulate", [MILL]),
        ("check", [PROGRAM]),
        ("report", ["a.mcap", "-o", "a.html"]),
        ("params", []),
        ("identify", ["friction", "x", "--machine", MILL]),
        ("circle", [MILL, "--radius", 10, "--feed", 1000]),
        ("curve", ["fit", "hyperbola"]),
    ],
)
def test_offline_commands_start_no_node(command, arguments):
    text = refused(command, *arguments, "--ros-args", "-r", "__ns:=/cell")
    assert text == f"'-r __ns:=/cell' is refused: cnc_ptp {command} starts no ROS node"


def test_replay_starts_a_node_only_to_publish():
    text = "is refused: cnc_ptp replay without --publish starts no ROS node"
    assert refused("replay", "a.mcap", "--ros-args", "--log-level", "debug") == f"'--log-level debug' {text}"
    assert refused("replay", "a.mcap", "--namespace", "cell") == f"'-r __ns:=/cell' {text}"


@pytest.mark.parametrize("option", [["--inputs"], ["--rate", "2"]])
def test_options_of_publish_need_it(option):
    done = call("replay", "a.mcap", *option)
    assert done.exit_code == 2
    assert "--inputs and --rate are options of --publish; nothing was replayed" in done.stderr


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["--foo", "bar"], f"'--foo' is refused: ROS does not know it, but {KNOWN}"),
        (["-r__ns:=/a"], f"'-r__ns:=/a' is refused: ROS does not know it, but {KNOWN}"),
        (["--remap"], "'--remap' is refused: its value is missing"),
        (
            ["-r", "__node:=mill"],
            "'-r __node:=mill' is refused: cnc_ptp run starts many nodes, named as in the machine file",
        ),
        (
            ["-r", "x:__name:=y"],
            "'-r x:__name:=y' is refused: cnc_ptp run starts many nodes, named as in the machine file",
        ),
        (["-r", "x:__ns:=/a"], "'-r x:__ns:=/a' is refused: all nodes of a machine are in one namespace"),
        (["-p", "x:a:=1"], "'-p x:a:=1' is refused: cnc_ptp run takes all parameters from the machine file"),
        (
            ["-p", "use_sim_time:=true"],
            "'-p use_sim_time:=true' is refused: cnc_ptp run takes all parameters from the machine file",
        ),
        (
            ["--params-file", "m.yaml"],
            "'--params-file m.yaml' is refused: cnc_ptp run takes all parameters from the machine file",
        ),
    ],
)
def test_run_refuses_by_name(words, text):
    assert refused("run", PTP, "--ros-args", *words) == text


def test_run_takes_what_launch_gives_to_everybody():
    words = ["-p", "use_sim_time:=false\n...\n", "--log-level", "debug", "-r", "a:=b", "-r", "__ns:=/cell"]
    split(["--ros-args", *words])[1].require_for_all_nodes("cnc_ptp run")


def test_namespace_option_is_the_same_as_the_rule():
    for name in ("cell", "/cell", "cell/"):
        assert refused("replay", "a.mcap", "--namespace", name).startswith("'-r __ns:=/cell' is refused")
    assert RosArguments().with_namespace("/cell") == RosArguments((RosArgument("-r", "__ns:=/cell"),))
    assert RosArguments().with_namespace("") == RosArguments()
    text = refused("run", PTP, "--namespace", "cell", "--ros-args", "-r", "__ns:=/other")
    assert text == "'-r __ns:=/other' is refused: --namespace says /cell"
    text = refused("run", PTP, "--namespace", "/", "--ros-args", "-r", "__ns:=/other")
    assert text == "'-r __ns:=/other' is refused: --namespace says /"


CLIENTS = [["status"], ["do", "x", "halt"], ["jog", "x", "+", "--speed", 1], ["watch", "x"]]


@pytest.mark.parametrize("client", CLIENTS, ids=lambda words: words[0])
@pytest.mark.parametrize(
    ("words", "reason"),
    [
        ("-p a:=1", "{} has no parameters"),
        ("-p use_sim_time:=true", "{} has no parameters"),
        ("--params-file m.yaml", "{} has no parameters"),
        ("-r __node:=me", "{} names its node after its process, so that several run side by side"),
        ("-r x:__ns:=/a", "all nodes of a machine are in one namespace"),
    ],
)
def test_clients_refuse_by_name(client, words, reason):
    text = refused(*client, "--ros-args", *words.split())
    assert text == f"'{words}' is refused: {reason.format(f'cnc_ptp {client[0]}')}"


@pytest.mark.parametrize("client", CLIENTS, ids=lambda words: words[0])
def test_clients_have_the_namespace_of_run(client):
    text = refused(*client, "--namespace", "cell", "--ros-args", "-r", "__ns:=/other")
    assert text == "'-r __ns:=/other' is refused: --namespace says /cell"
    result = call(*client, "--namespace", "1!")
    assert result.exit_code == 2
    assert "Invalid value for '--namespace': '1!' is no namespace: names of letters, digits and _" in result.stderr
    split(["--ros-args", "-p", "use_sim_time:=false", "-r", "x/jog:=y/jog"])[1].require_for_client("cnc_ptp jog")


@pytest.mark.parametrize("name", ["9", "a b", "a//b", "", "ä", "__ns:=/a", "//"])
def test_no_namespace(name):
    result = call("run", PTP, "--namespace", name)
    assert result.exit_code == 2
    assert (
        f"Invalid value for '--namespace': '{name}' is no namespace: names of letters, digits and _, separated by /."
        in result.stderr
    )


def test_refusal_is_printed_as_it_is():
    """No :a: becomes a picture."""
    assert "-p x:a:=1" in call("run", PTP, "--ros-args", "-p", "x:a:=1").stderr


def test_help_of_the_commands_shows_the_namespace():
    for command in ("run", "replay", "status", "do", "jog", "watch"):
        assert "--namespace NAME" in call(command, "--help").output


def test_a_machine_that_stays_runs_in_real_time():
    """Its jogs end by wall time, after which an axis in free run would have gone on for seconds of its own."""
    result = call("run", PTP, "--stay", "--free-run")
    assert result.exit_code == 2
    assert "--stay and --free-run exclude each other: a machine is commanded in real time." in result.stderr


@pytest.mark.parametrize(("speed", "text"), [("inf", "inf is not finite."), ("nan", "nan is not a number.")])
def test_a_speed_is_a_finite_number(speed, text):
    done = call("jog", "x", "+", "--speed", speed)
    assert done.exit_code == 2 and text in done.stderr
