"""Runs the arm of arm6.yaml, simulated, with robot_state_publisher and RViz.

    ros2 launch lineshaft arm6.launch.py
    ros2 launch lineshaft arm6.launch.py rviz:=false record:=/tmp/arm
    ros2 launch lineshaft arm6.launch.py cell:=/home/me/arm.yaml urdf:=/home/me/arm.urdf

move_group is started by the launch file of a MoveIt configuration: docs/moveit.md.
"""

import importlib.util
from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

# Name, default, what it is for.
ARGUMENTS = [
    ("cell", "", "The cell file; empty: arm6.yaml"),
    ("urdf", "", "URDF for robot_state_publisher; empty: arm6.urdf"),
    ("record", "", "Record the run: NAME.mcap, or a new folder; empty: no recording. Also recording:="),
]
# Name, default, what it is for.
SWITCHES = [
    ("sim", "true", "Put simulation in the place of every backend. Also simulation:="),
    ("rviz", "true", "Also start RViz"),
]


def load_arguments():
    """Returns the module that checks arguments: next to this file, or installed in launch-configs."""
    here = Path(__file__).parent
    folders = [here.parent, here.parent / "launch-configs"]
    path = next(path for path in (folder / "launch_arguments.py" for folder in folders) if path.exists())
    spec = importlib.util.spec_from_file_location("launch_arguments", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def check(context):
    declared = [name for name, *_ in [*ARGUMENTS, *SWITCHES]]
    load_arguments().check(context, __file__, declared, [name for name, *_ in SWITCHES])


def start(context):
    def given(name):
        return LaunchConfiguration(name).perform(context)

    if given("cell") and not given("urdf"):
        raise RuntimeError("urdf is missing: give the URDF of the cell, urdf:=FILE")
    folder = Path(get_package_share_directory("lineshaft")) / "launch-configs" / "arm6"
    arguments = ["run", given("cell") or str(folder / "arm6.yaml")]
    if given("sim") == "true":
        arguments.append("--sim")
    if given("record"):
        arguments += ["--record", given("record")]
    urdf = Path(given("urdf") or folder / "arm6.urdf").read_text(encoding="utf-8")
    nodes = [
        Node(
            package="lineshaft",
            executable="lineshaft",
            arguments=arguments,
            output="screen",
            # After Ctrl-C the axes come to rest in a controlled way; a second signal would end the program in mid-motion.
            sigterm_timeout="30",
            sigkill_timeout="30",
        ),
        Node(
            package="robot_state_publisher",
            executable="robot_state_publisher",
            parameters=[{"robot_description": ParameterValue(urdf, value_type=str)}],
            output="screen",
        ),
    ]
    if given("rviz") == "true":
        nodes.append(Node(package="rviz2", executable="rviz2", arguments=["-d", str(folder / "arm6.rviz")], output="log"))
    return nodes


def generate_launch_description():
    arguments = [DeclareLaunchArgument(name, default_value=default, description=text) for name, default, text in ARGUMENTS]
    switches = [
        DeclareLaunchArgument(name, default_value=default, choices=["true", "false"], description=text)
        for name, default, text in SWITCHES
    ]
    return LaunchDescription([OpaqueFunction(function=check), *arguments, *switches, OpaqueFunction(function=start)])
