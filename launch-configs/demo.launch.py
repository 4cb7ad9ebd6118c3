"""Runs a cell as a ROS 2 node; without arguments the built-in demo cell, simulated.

    ros2 launch lineshaft demo.launch.py
    ros2 launch lineshaft demo.launch.py robot_state_publisher:=true
    ros2 launch lineshaft demo.launch.py cell:=/home/me/cell.yaml sim:=true namespace:=/press params_file:=/home/me/p.yaml
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
    ("cell", "", "The cell file; empty: the built-in demo cell"),
    ("namespace", "", "Namespace of the node; empty: as the cell says"),
    ("name", "", "Name of the node; empty: as the cell says"),
    ("params_file", "", "YAML file of ROS parameters for the start; empty: none. Also parameters:="),
    ("record", "", "Record the run: NAME.mcap, or a new folder; empty: no recording. Also recording:="),
    ("urdf", "", "URDF for robot_state_publisher; empty: that of the demo cell"),
]
SWITCHES = [
    ("sim", "Put simulation in the place of every backend. Also simulation:="),
    ("robot_state_publisher", "Also start robot_state_publisher, which publishes /tf from joint_states"),
]


def load_arguments():
    """Returns the module that checks arguments: next to this file, or installed in launch-configs."""
    here = Path(__file__).parent
    folders = [here, here.parent / "launch-configs"]
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

    arguments = ["run"]
    if given("cell"):
        arguments.append(given("cell"))
    if given("sim") == "true":
        arguments.append("--sim")
    if given("record"):
        arguments += ["--record", given("record")]
    nodes = [
        Node(
            package="lineshaft",
            executable="lineshaft",
            arguments=arguments,
            name=given("name") or None,
            namespace=given("namespace") or None,
            parameters=[given("params_file")] if given("params_file") else [],
            output="screen",
            # After Ctrl-C the axes come to rest in a controlled way; a second signal would end the program in mid-motion.
            sigterm_timeout="30",
            sigkill_timeout="30",
        )
    ]
    if given("robot_state_publisher") == "true":
        demo = Path(get_package_share_directory("lineshaft")) / "launch-configs" / "demo.urdf"
        urdf = Path(given("urdf") or demo).read_text(encoding="utf-8")
        nodes.append(
            Node(
                package="robot_state_publisher",
                executable="robot_state_publisher",
                namespace=given("namespace") or None,
                parameters=[{"robot_description": ParameterValue(urdf, value_type=str)}],
                output="screen",
            )
        )
    return nodes


def generate_launch_description():
    arguments = [DeclareLaunchArgument(name, default_value=default, description=text) for name, default, text in ARGUMENTS]
    switches = [
        DeclareLaunchArgument(name, default_value="false", choices=["true", "false"], description=text)
        for name, text in SWITCHES
    ]
    return LaunchDescription([OpaqueFunction(function=check), *arguments, *switches, OpaqueFunction(function=start)])
