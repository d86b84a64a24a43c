"""ros2 launch cnc_ptp machine.launch.py machine:=config/mill.yaml program:=examples/bracket.nc record:=runs/demo.mcap

Thin on purpose: the supervisor of `cnc_ptp run` starts one process a node and ends them in order.
"""

from launch.actions import DeclareLaunchArgument, OpaqueFunction, Shutdown
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

from launch import LaunchDescription

OPTIONS = ("program", "scenario", "duration", "record")


def start(context):
    arguments = [LaunchConfiguration("machine").perform(context)]
    for option in OPTIONS:
        value = LaunchConfiguration(option).perform(context)
        arguments += [f"--{option}", value] if value else []
    return [Node(package="cnc_ptp", executable="run", arguments=arguments, output="screen", on_exit=Shutdown())]


def generate_launch_description():
    declared = [DeclareLaunchArgument("machine", description="machine file (ROS parameters YAML)")]
    declared += [DeclareLaunchArgument(option, default_value="") for option in OPTIONS]
    return LaunchDescription([*declared, OpaqueFunction(function=start)])
