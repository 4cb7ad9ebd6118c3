"""Loads a launch file with stand-ins for the modules of ROS 2 and prints what it starts, as JSON: a command line for each node.

usage: stand_in.py LAUNCH_FILE SHARE [NAME:=VALUE..]

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
        return context[self.name]


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


def main(path, share, *given):
    description = load(path, share).generate_launch_description()
    given = dict(argument.split(":=", 1) for argument in given)
    context = {}
    for action in description:
        if isinstance(action, DeclareLaunchArgument):
            value = context[action.name] = given.pop(action.name, action.default)
            if action.choices and value not in action.choices:
                sys.exit(f"{action.name} is {value}; {action.choices} are allowed")
    if given:
        sys.exit(f"not declared: {given}")
    functions = [action.function for action in description if isinstance(action, OpaqueFunction)]
    nodes = [node for function in functions for node in function(context)]
    print(json.dumps([{"command": node.command, "parameters": node.parameters} for node in nodes]))


if __name__ == "__main__":
    main(*sys.argv[1:])
