"""Checks the arguments of a launch file of Lineshaft before anything starts.

`ros2 launch` accepts unknown arguments and ignores them. Here they are refused, because a misspelled `sim:=true` would start
the real machine instead of a simulation.
"""

import difflib
import sys
from pathlib import Path

# Other spellings, and the arguments that they stand for.
SPELLINGS = {"simulation": "sim", "recording": "record", "parameters": "params_file"}

# Launch configurations that launch and launch_ros read or set themselves.
OF_LAUNCH = {
    "emulate_tty",
    "global_params",
    "launch-prefix",
    "launch-prefix-filter",
    "ros_namespace",
    "ros_remaps",
    "sigkill_timeout",
    "sigterm_timeout",
}


def is_launched(command_line, file):
    """Returns whether the user launches this file; otherwise another launch file includes it."""
    for place, word in enumerate(command_line):
        path = Path(word)
        if path.name == Path(file).name:
            return "lineshaft" in command_line[:place] or (path.exists() and path.samefile(file))
    return False


def near_name(name, declared):
    """Returns the declared argument that resembles `name` most, or None."""
    spellings = {spelling: spelling for spelling in declared}
    spellings |= {spelling: name for spelling, name in SPELLINGS.items() if name in declared}
    found = difflib.get_close_matches(name.lower().replace("-", "_"), spellings, n=1)
    return spellings[found[0]] if found else None


def unknown_argument(file, name, declared):
    """Returns the message for an argument that the launch file does not have."""
    near = near_name(name, declared)
    hint = f" (did you mean {near}?)" if near else ""
    others = [spelling for spelling, real in SPELLINGS.items() if real in declared]
    return f"{file}: argument {name} is unknown{hint}, allowed are {', '.join(declared)} (also {', '.join(others)})"


def switch_value(name, value):
    """Returns "true" or "false" for what the conditions of launch accept; raises an error for anything else."""
    text = value.strip().lower()
    if text in ("true", "1"):
        return "true"
    if text in ("false", "0"):
        return "false"
    raise RuntimeError(f"{name} is {value!r}: must be true or false")


def checked(file, given, launched, declared, switches):
    """Returns the arguments to set; raises an error for those that are unknown, contradict each other or have a wrong value.

    `given` are the launch configurations before arguments have their defaults. In a file that another one includes
    (`launched` is false) unknown names may belong to that one. Even so, a name that resembles `sim` is refused if `sim` is
    missing.
    """
    unknown = [name for name in given if name not in {*declared, *SPELLINGS, *OF_LAUNCH}]
    unknown += [name for name in given if name in SPELLINGS and SPELLINGS[name] not in declared]
    if launched and unknown:
        raise RuntimeError(unknown_argument(file, unknown[0], declared))
    values = {name: given[name] for name in declared if name in given}
    for spelling, name in SPELLINGS.items():
        # What an including file calls so may mean something else. For `sim` alone that cannot be ignored.
        if not launched and (name != "sim" or "sim" in values):
            continue
        if spelling in given and name in declared:
            value = values.setdefault(name, given[spelling])
            both = [switch_value(name, text) if name in switches else text for text in (value, given[spelling])]
            if both[0] != both[1]:
                raise RuntimeError(f"{file}: {name} is {value!r} and {spelling} is {given[spelling]!r}: give one of them")
    if "sim" not in values:
        for name in unknown:
            if near_name(name, ["sim"]):
                raise RuntimeError(f"{file}: {name} is unknown and resembles sim, which is missing: give sim:=true or sim:=false")
    return {name: switch_value(name, value) if name in switches else value for name, value in values.items()}


def check(context, file, declared, switches):
    """Applies `checked` to the context of a launch. It must be the first action, before arguments have their defaults."""
    given = dict(context.launch_configurations)
    values = checked(Path(file).name, given, is_launched(sys.argv, file), declared, switches)
    context.launch_configurations.update(values)
