"""Loads a launch file with stand-ins for the modules of ROS 2 and prints what it starts, as JSON: a command line for each node.

usage: stand_in.py [--included] LAUNCH_FILE SHARE [NAME:=VALUE..]
       stand_in.py --show-args LAUNCH_FILE

--included: as if another launch file, which the user launches, includes this one and has set NAME to VALUE.
--show-args: prints the declared arguments and their other spellings.

The stand-ins take the arguments of Jazzy's launch and launch_ros that a launch file here may use, and no others.
"""

import importlib.util
import json
import sys
import types


class DeclareLaunchArgument:
    def __init__(self, name, *, default_value=None, description=None, choices=None):
        assert all(isinstance(text, str) for text in [name, default_value, description, *(choices or [])])
        self.name, self.default, self.choices = name, default_value, choices


class OpaqueFunction:
    def __init__(self, *, function):
        self.function = function


class LaunchDescription(list):
    pass


class LaunchConfiguration:
    def __init__(self, name):
        self.name = name

    def perform(self, context):
        return context.launch_configurations[self.name]


class Context:
    def __init__(self, given):
        self.launch_configurations = dict(given)


class ParameterValue:
    def __init__(self, value, *, value_type):
        assert isinstance(value, value_type)
        self.value = value


class Node:
    def __init__(
        self,
        *,
        package,
        executable,
        arguments=(),
        name=None,
        namespace=None,
        parameters=(),
        output="log",
        sigterm_timeout="5",
        sigkill_timeout="5",
    ):
        assert output in ("screen", "log", "both") and float(sigterm_timeout) > 0 and float(sigkill_timeout) > 0
        rules = [f"__node:={name}"] if name is not None else []
        rules += [f"__ns:={namespace}"] if namespace is not None else []
        self.command = [f"{package}/{executable}", *arguments, "--ros-args"]
        self.command += [part for rule in rules for part in ("-r", rule)]
        self.parameters = {}
        for one in parameters:
            if isinstance(one, str):
                self.command += ["--params-file", one]
            else:
                self.parameters |= {key: value.value for key, value in one.items()}


def load(path, share):
    """The launch file as a module."""

    def module(name, **contents):
        sys.modules[name] = types.ModuleType(name)
        vars(sys.modules[name]).update(contents)

    module("ament_index_python")
    module("ament_index_python.packages", get_package_share_directory=lambda package: f"{share}/{package}")
    module("launch", LaunchDescription=LaunchDescription)
    module("launch.actions", DeclareLaunchArgument=DeclareLaunchArgument, OpaqueFunction=OpaqueFunction)
    module("launch.substitutions", LaunchConfiguration=LaunchConfiguration)
    module("launch_ros")
    module("launch_ros.actions", Node=Node)
    module("launch_ros.parameter_descriptions", ParameterValue=ParameterValue)
    spec = importlib.util.spec_from_file_location("launch_file", path)
    loaded = importlib.util.module_from_spec(spec)
    sys.dont_write_bytecode = True
    spec.loader.exec_module(loaded)
    return loaded


def show_args(path):
    launch_file = load(path, "/nowhere")
    declared = [action.name for action in launch_file.generate_launch_description() if isinstance(action, DeclareLaunchArgument)]
    spellings = launch_file.load_arguments().SPELLINGS
    print(json.dumps({"declared": declared, "also": [name for name, real in spellings.items() if real in declared]}))


def main(path, share, *given, included=False):
    description = load(path, share).generate_launch_description()
    # What `ros2 launch` leaves there, of which it sets the launch configurations.
    sys.argv = ["ros2", "launch", "cell", "cell.launch.py"] if included else ["ros2", "launch", path, *given]
    context = Context(argument.split(":=", 1) for argument in given)
    nodes = []
    for action in description:
        if isinstance(action, DeclareLaunchArgument):
            value = context.launch_configurations.setdefault(action.name, action.default)
            if action.choices and value not in action.choices:
                sys.exit(f"{action.name} is {value}; {action.choices} are allowed")
        elif isinstance(action, OpaqueFunction):
            try:
                nodes += action.function(context) or []
            except RuntimeError as error:
                sys.exit(str(error))
    print(json.dumps([{"command": node.command, "parameters": node.parameters} for node in nodes]))


if __name__ == "__main__":
    if sys.argv[1] == "--show-args":
        show_args(*sys.argv[2:])
    elif sys.argv[1] == "--included":
        main(*sys.argv[2:], included=True)
    else:
        main(*sys.argv[1:])
