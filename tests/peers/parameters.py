"""The parameters of the node, as every ROS 2 tool sees and sets them."""
import math
import re

import yaml

import ros2wire as rw
from checks import RawClient, malformed
from lineshaft_msgs import EXPORTS, LAYERS, Answer, AxesRequest, ExportRequest, ExportResponse, ImportRequest, ResetRequest
from report import Checklist, Failure, show, told

BOOL, INTEGER, DOUBLE, STRING, INTEGERS = 1, 2, 3, 4, 7
LOWEST, HIGHEST = -2 ** 63, 2 ** 63 - 1

# Values that agree with the rest of an axis of the demo, where one from the range alone may not.
AGREED = {"syncmfpar": [23], "syncmwinm": [300], "syncmwins": [300],
          "dfltvel": [30], "dfltacc": [30], "home_vel": [-30], "home_ramp": [30], "neglimit": [-1000],
          "poslimit": [1000], "velmax": [65535.0], "wf.md7": [1],
          "amc.speed_reference": [0.001], "min_position": [-0.01, None], "max_position": [0.3, None]}
# What is said of a parameter whose function is missing.
MISSING = re.compile("(does|do) not exist yet")
# What is said of values in the range that the rest of the axis forbids.
FORBIDDEN = {"amc.action_on_event": "waits for a latch", "amc.reference_select": "follows a master",
             "amc.reference_select_trigger": "follows a master",
             **dict.fromkeys(("i_refswitch", "i_poslimitsw", "i_neglimitsw"), "digital inputs"),
             **dict.fromkeys(("i_break", "i_continue", "i_errclr"), "digital inputs"),
             **dict.fromkeys(("o_axmove", "o_brake", "o_error"), "digital outputs"),
             "posdrct": "inverts the position loop", "velmax": "must not be below", "revers": "asks for outputs",
             **dict.fromkeys(("encodertype", "mencodertype"), "is no type of encoder"), "encoderfreq": "is no clock rate",
             "wf.md4": "asks for words in Gray code",
             "pulsvel": "starts the virtual master", "vmenctyp": "is not allowed", "vmencmtyp": "digital inputs",
             **{f"wf.md{n}": "breaks the falling order" for n in range(43, 49)}}


def client_of(peer, node):
    return peer.once(f"{node} parameters", lambda: rw.ParameterClient(peer.dp, node))


def parameters(peer, a):
    """One call of one of the six services, as the tools make it."""
    client = client_of(peer, a.node)
    if a.op == "list":
        show(list=client.list(a.args, a.depth))
    elif a.op in ("get", "types", "describe"):
        show(**{a.op: getattr(client, a.op)(*a.args)})
    else:
        values = [x.split("=", 1) for x in a.args]
        request = rw.ParametersRequest([rw.Parameter(k, rw.ParameterValue.of(rw.parsed(v))) for k, v in values])
        show(**{a.op: (client.c_set if a.op == "set" else client.c_atomic).call(request)})


def events(peer, a):
    """The parameter events since the last call, after waiting for those of `until`."""
    s = peer.once("/parameter_events", lambda: rw.Subscription(peer.dp, "/parameter_events", rw.ParameterEvent,
                                                               rw.PARAMETER_QOS))
    seen = []

    def arrived():
        seen.extend(m for m in s.take() if m.node == a.node)
        return not a.until or any(p.name == a.until for m in seen for p in m.changed_parameters)
    rw.wait_until(arrived, rw.REPLY_S, f"no event of {a.until}")
    show(events=[{"stamp": m.stamp, "new": len(m.new_parameters), "deleted": len(m.deleted_parameters),
                  "changed": {p.name: p.value.get() for p in m.changed_parameters}} for m in seen])


def layers(peer, a):
    if a.what == "reset":
        client = peer.service(a.node, "reset_parameters", "ResetParameters", ResetRequest, Answer)
        layer = LAYERS.index(a.layer) if a.layer in LAYERS else int(a.layer)
        return told(client.call(ResetRequest(a.axes, layer)))
    client = peer.service(a.node, f"{a.what}_parameters", "AxesCommand", AxesRequest, Answer)
    told(client.call(AxesRequest(a.axes)))


def exported(peer, node, axes=(), which=0):
    client = peer.service(node, "export_parameters", "ExportParameters", ExportRequest, ExportResponse)
    return client.call(ExportRequest(list(axes), which))


def imported(peer, node, text):
    client = peer.service(node, "import_parameters", "ImportParameters", ImportRequest, Answer)
    return client.call(ImportRequest(text))


def export_text(peer, a):
    which = EXPORTS.index(a.which) if a.which in EXPORTS else int(a.which)
    r = exported(peer, a.node, a.axes, which)
    told(r, text=r.text)


def import_text(peer, a):
    """`;` breaks the line."""
    told(imported(peer, a.node, " ".join(a.text).replace(";", "\n") + "#" * a.pad))


def import_of_export(peer, a):
    """What was exported is imported again, for every choice: nothing may change."""
    client, checks = client_of(peer, a.node), Checklist()
    before = everything(client)
    for which, name in enumerate(EXPORTS):
        r = exported(peer, a.node, [], which)
        show(export=name, lines=len(r.text.splitlines()))
        checks.check(f"the export of {name} is taken", lambda: imported(peer, a.node, r.text), lambda r: r.success)
        checks.check(f"after {name} every value is what it was", lambda: differences(client, before), [])
        checks.check(f"the export of {name} is the same", lambda: exported(peer, a.node, [], which).text == r.text,
                     True)
    checks.close()


def everything(client):
    names = list(client.list().names)
    return dict(zip(names, client.get(*names), strict=True))


def differences(client, before):
    now = everything(client)
    return sorted(k for k in before.keys() | now.keys() if now.get(k) != before.get(k))


def described(peer, a):
    """Lists, describes, and reads every parameter of the node, all in one call each and one by one."""
    client, checks = client_of(peer, a.node), Checklist()
    listed = client.list()
    names = list(listed.names)
    show(parameters=len(names), prefixes=list(listed.prefixes))
    if not names or names != sorted(set(names)):
        raise Failure("names are not ascending, or there are none")
    descriptors = client.describe(*names)
    values = client.c_get.call(rw.NamesRequest(names)).values
    types = client.types(*names)
    if not len(names) == len(descriptors) == len(values) == len(types):
        raise Failure(f"{len(descriptors)} descriptors, {len(values)} values, {len(types)} types of {len(names)}")
    wrong = [n for n, d, v, t in zip(names, descriptors, values, types) if not is_sound(n, d, v, t)]
    checks.check("every descriptor fits its name and its value", lambda: wrong, [])
    single = [n for n, d in zip(names[::9], descriptors[::9]) if client.describe(n) != [d]]
    checks.check("one by one they are the same", lambda: single, [])
    for call in (client.get, client.types, client.describe):
        checks.check("one unknown name among them leaves the answer empty",
                     lambda: list(call(names[0], "x.no_such_key", names[1])), [])
        checks.check("no name, no answer", lambda: list(call()), [])
    show(read_only=sum(d.read_only for d in descriptors), unset=types.count(0),
         kinds={k: sum(d.type == k for d in descriptors) for k in (BOOL, INTEGER, DOUBLE, STRING)})
    checks.close()


def is_sound(name, d, value, kind):
    if "Source: " not in d.description:  # of the node itself, without a row of the catalogue
        return d.name == name and d.description and value.type == kind == d.type
    ranges = {BOOL: (0, 0), INTEGER: (1, 0), DOUBLE: (0, 1), STRING: (0, 0), INTEGERS: (1, 0)}
    return (d.name == name and d.type in ranges and len(d.description) > 10
            and (len(d.integer_range), len(d.floating_point_range)) == ranges[d.type]
            and all(r.from_value <= r.to_value for r in [*d.integer_range, *d.floating_point_range])
            and (d.type != STRING or d.additional_constraints.startswith("one of "))
            and value.type == kind and (kind == d.type or (kind == 0 and (d.dynamic_typing or d.read_only))))


def doors(peer, a):
    """Holds every parameter of one object at its two doors, and sets each that can be set to another value."""
    client, checks = client_of(peer, a.node), Checklist()
    names = list(client.list([a.object]).names)
    descriptors, before = client.describe(*names), everything(client)
    counts = dict.fromkeys(("settable", "read_only", "other_values", "not_built", "forbidden", "bad_values"), 0)
    for d in descriptors:
        key, now = d.name.split(".", 1)[1], before[d.name]
        if d.read_only:
            counts["read_only"] += 1
            takes_its_own(checks, client, d, now)
            other = {bool: lambda: not now, str: lambda: now + "x", type(None): lambda: 1}
            refused(checks, client, d, other.get(type(now), lambda: 2 * now + 1)(), "read-only")
            continue
        counts["settable"] += 1
        takes_its_own(checks, client, d, now)
        for bad in beyond(d):
            if bad != now:  # the default is taken wherever it lies
                refused(checks, client, d, bad, key)
                counts["bad_values"] += 1
        for new in AGREED.get(key) or others(d, now):
            r = client.set({d.name: new})[0]
            if MISSING.search(d.additional_constraints):
                got = (r.successful, MISSING.search(r.reason) is not None)
                checks.check_quietly(f"{d.name} = {new}: its function does not exist", lambda: got, (False, True))
                counts["not_built"] += 1
                continue
            if not r.successful and FORBIDDEN.get(key, "\0") in r.reason:
                counts["forbidden"] += 1
                continue
            counts["other_values"] += 1
            got = client.get(d.name)[0]
            checks.check_quietly(f"{d.name} = {new}", lambda: (r.successful, same(d, got, new)), (True, True),
                                 f"{r.reason} {got}")
            reset(peer, a)
    checks.check("in the end every value is what it was", lambda: differences(client, before), [])
    show(object=a.object, parameters=len(names), **counts)
    checks.close()


def takes_its_own(checks, client, d, now):
    """Also of what is read-only, and of a view of a value that was given by another one and is outside its own range."""
    for door in (client.set, lambda kv: [client.set_atomically(kv)]):
        checks.check_quietly(f"{d.name} takes its own value {now}",
                             lambda: [(r.successful, r.reason) for r in door({d.name: now})], [(True, "")])


def reset(peer, a):
    client = peer.service(a.node, "reset_parameters", "ResetParameters", ResetRequest, Answer)
    # The machine goes with all axes.
    axes = [] if a.object == "machine" else [a.object]
    r = client.call(ResetRequest(axes, LAYERS.index("init")))
    if not r.success:
        raise Failure(r.message)


def same(d, got, want):
    """Of numbers in steps the nearest is taken."""
    if d.type != DOUBLE or got is None or want is None:
        return got == want
    return abs(got - want) <= 0.5001 * d.floating_point_range[0].step


def refused(checks, client, d, bad, word):
    """At both doors, in company of a good value, with a sentence; nothing else may change."""
    good = client.get("x.max_velocity")[0]
    for parameters in ({d.name: bad}, {"x.max_velocity": good * 0.5, d.name: bad}):
        r = client.set_atomically(parameters)
        checks.check_quietly(f"{d.name} = {bad} is refused atomically", lambda: (r.successful, word in r.reason),
                             (False, True), r.reason)
    r = client.set({d.name: bad})[0]
    checks.check_quietly(f"{d.name} = {bad} is refused", lambda: (r.successful, word in r.reason), (False, True),
                         r.reason)
    checks.check_quietly(f"after {d.name} = {bad}", lambda: client.get("x.max_velocity")[0], good)


def beyond(d):
    """Values that are none for it: beyond its range, of another type, no numbers."""
    if d.type == BOOL:
        return [1, "true"]
    if d.type == STRING:
        return ["", "no_such_name", 1, True]
    wrong = ["1", True, [1.0]] if d.dynamic_typing else ["1", True, [1.0], None]
    if d.type == INTEGER:
        r = d.integer_range[0]
        return wrong + [v for v in (r.from_value - 1, r.to_value + 1, LOWEST, HIGHEST)
                        if not r.from_value <= v <= r.to_value] + [0.5]
    r = d.floating_point_range[0]
    below = 0.0 if "more than 0" in d.additional_constraints else r.from_value - abs(r.from_value) / 1000 - 1 - r.step
    return wrong + [below, r.to_value * 1.001 + r.step + 1, math.nan, math.inf, -math.inf, 1e300, -1e300]


def others(d, now):
    """Values that it should take, other than the present one."""
    if d.type == BOOL:
        return [not now]
    if d.type == STRING:
        names = d.additional_constraints.split(";")[0].removeprefix("one of ").split(", ")
        return [n for n in names if n != now]
    if d.type == INTEGER:
        r = d.integer_range[0]
        middle = [] if "," in d.additional_constraints else [(r.from_value + r.to_value) // 2]
        return [v for v in [r.from_value, r.to_value, *middle] if v != now]
    r = d.floating_point_range[0]
    if now:
        return [now * 0.5 if now * 0.5 >= r.from_value else now * 1.5]
    return [min(r.to_value, 0.125)]


def bad_requests(peer, a):
    """Malformed requests to the services that change something: none may be done."""
    client = client_of(peer, a.node)
    before = everything(client)
    bad = []
    for c, name in ((client.c_set, "SetParameters"), (client.c_atomic, "SetParametersAtomically")):
        raw = RawClient(c, f"rcl_interfaces::srv::dds_::{name}_Request_").wait()
        request = rw.ParametersRequest([rw.Parameter("x.max_velocity", rw.ParameterValue.of(0.125))])
        good = c.Req(raw.client, 0, request).serialize(use_version_2=False)
        shapes = malformed(good, length_at=24)  # of the name, after encapsulation, header and count
        many = [rw.Parameter("x.no_such_key", rw.ParameterValue.of(1.0))] * 1000
        shapes["1000 unknown names"] = c.Req(raw.client, 0, rw.ParametersRequest(many)).serialize(use_version_2=False)

        def yes(r):
            results = r.results if hasattr(r, "results") else [r.result]
            return any(x.successful for x in results)
        bad += raw.deliver(shapes, yes, {"1000 unknown names"})
    show(changed=differences(client, before))
    if bad or differences(client, before):
        raise Failure(f"accepted or not answered: {bad}, changed: {differences(client, before)}")


def dump(peer, a):
    """`ros2 param dump`: what is listed, nested at the dots, what has no value as null."""
    values = everything(client_of(peer, a.node))
    tree = {}
    for name in sorted(values):
        *groups, key = name.split(".")
        place = tree
        for group in groups:
            place = place.setdefault(group, {})
        place[key] = values[name]
    with open(a.file, "w", encoding="utf-8") as file:
        yaml.dump({a.node: {"ros__parameters": tree}}, file, default_flow_style=False)
    show(values=values)


def guessed(text):
    """rclpy's get_parameter_value: what YAML 1.1 makes of a text. At another error of YAML `ros2 param load` ends with a traceback."""
    try:
        return rw.ParameterValue.of(text if (v := yaml.safe_load(text)) is None else v)
    except yaml.parser.ParserError:
        return rw.ParameterValue.of(text)


def unrolled(tree, prefix=""):
    for key, value in tree.items():
        if isinstance(value, dict):
            yield from unrolled(value, f"{prefix}{key}.")
        else:
            # As rclpy does it: whatever the file holds becomes a text, and is guessed anew.
            yield rw.Parameter(prefix + key, guessed(str(value)))


def load(peer, a):
    """`ros2 param load`: all values of a file in one request, each set by itself."""
    with open(a.file, encoding="utf-8") as file:
        tree = yaml.safe_load(file)[a.node]["ros__parameters"]
    parameters = list(unrolled(tree))
    results = client_of(peer, a.node).c_set.call(rw.ParametersRequest(parameters)).results
    show(set=len(results), failed={p.name: r.reason for p, r in zip(parameters, results, strict=True)
                                   if not r.successful})


def values(peer, a):
    show(values=everything(client_of(peer, a.node)))


def add_commands(command):
    for name, run in (("param-dump", dump), ("param-load", load)):
        command(name, run).add_argument("file")
    command("param-values", values)
    p = command("params", parameters, depth=0)
    p.add_argument("op", choices=("list", "get", "types", "describe", "set", "set_atomically"))
    p.add_argument("args", nargs="*", help="names, prefixes, or name=value with a value in JSON")
    p = command("parameter-events", events)
    p.add_argument("--until", help="wait for a change of this parameter")
    p = command("layers", layers, layer="user")
    p.add_argument("what", choices=("save", "delete", "reset"))
    p.add_argument("axes", nargs="*")
    p = command("export", export_text, which="all")
    p.add_argument("axes", nargs="*")
    p = command("import", import_text, pad=0)
    p.add_argument("text", nargs="*", help="a ; breaks the line")
    command("import-of-export", import_of_export)
    command("described-parameters", described)
    command("parameter-doors", doors, object="x")
    command("bad-parameter-requests", bad_requests)
