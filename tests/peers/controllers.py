"""The services of controller_manager as ros2_control of Jazzy (4.31 and later) has them. The first word is its name."""
from dataclasses import dataclass, field

from cyclonedds.idl import IdlStruct, types as t

import ros2wire as rw
from lifecycle import Empty, State
from report import Failure, plain, show
from trajectories import Duration

STRICTNESS = {"": 0, "best-effort": 1, "strict": 2, "auto": 3, "force-auto": 4}


@dataclass
class ChainConnection(IdlStruct, typename="controller_manager_msgs::msg::dds_::ChainConnection_"):
    name: str = ""
    reference_interfaces: t.sequence[str] = field(default_factory=list)


@dataclass
class ControllerState(IdlStruct, typename="controller_manager_msgs::msg::dds_::ControllerState_"):
    name: str = ""
    state: str = ""
    type: str = ""
    is_async: bool = False
    update_rate: t.uint16 = 0
    claimed_interfaces: t.sequence[str] = field(default_factory=list)
    required_command_interfaces: t.sequence[str] = field(default_factory=list)
    required_state_interfaces: t.sequence[str] = field(default_factory=list)
    is_chainable: bool = False
    is_chained: bool = False
    exported_state_interfaces: t.sequence[str] = field(default_factory=list)
    reference_interfaces: t.sequence[str] = field(default_factory=list)
    chain_connections: t.sequence[ChainConnection] = field(default_factory=list)


@dataclass
class HardwareInterface(IdlStruct, typename="controller_manager_msgs::msg::dds_::HardwareInterface_"):
    name: str = ""
    data_type: str = ""
    is_available: bool = False
    is_claimed: bool = False


@dataclass
class HardwareComponentState(IdlStruct, typename="controller_manager_msgs::msg::dds_::HardwareComponentState_"):
    name: str = ""
    type: str = ""
    is_async: bool = False
    rw_rate: t.uint16 = 0
    class_type: str = ""
    plugin_name: str = ""
    state: State = field(default_factory=State)
    command_interfaces: t.sequence[HardwareInterface] = field(default_factory=list)
    state_interfaces: t.sequence[HardwareInterface] = field(default_factory=list)


@dataclass
class ListControllersResponse(IdlStruct, typename="ListControllersResponse"):
    controller: t.sequence[ControllerState] = field(default_factory=list)


@dataclass
class ListControllerTypesResponse(IdlStruct, typename="ListControllerTypesResponse"):
    types: t.sequence[str] = field(default_factory=list)
    base_classes: t.sequence[str] = field(default_factory=list)


@dataclass
class ListHardwareComponentsResponse(IdlStruct, typename="ListHardwareComponentsResponse"):
    component: t.sequence[HardwareComponentState] = field(default_factory=list)


@dataclass
class ListHardwareInterfacesResponse(IdlStruct, typename="ListHardwareInterfacesResponse"):
    command_interfaces: t.sequence[HardwareInterface] = field(default_factory=list)
    state_interfaces: t.sequence[HardwareInterface] = field(default_factory=list)


@dataclass
class SwitchControllerRequest(IdlStruct, typename="SwitchControllerRequest"):
    activate_controllers: t.sequence[str] = field(default_factory=list)
    deactivate_controllers: t.sequence[str] = field(default_factory=list)
    strictness: t.int32 = 0
    activate_asap: bool = False
    timeout: Duration = field(default_factory=Duration)


@dataclass
class SwitchControllerResponse(IdlStruct, typename="SwitchControllerResponse"):
    ok: bool = False
    message: str = ""


@dataclass
class LoadRequest(IdlStruct, typename="LoadRequest"):
    name: str = ""


@dataclass
class ReloadRequest(IdlStruct, typename="ReloadRequest"):
    force_kill: bool = False


@dataclass
class Done(IdlStruct, typename="Done"):
    ok: bool = False


LOADS = {"load_controller": ("LoadController", LoadRequest), "unload_controller": ("UnloadController", LoadRequest),
         "reload_controller_libraries": ("ReloadControllerLibraries", ReloadRequest)}
LISTS = {"list_controllers": ("ListControllers", ListControllersResponse),
         "list_controller_types": ("ListControllerTypes", ListControllerTypesResponse),
         "list_hardware_components": ("ListHardwareComponents", ListHardwareComponentsResponse),
         "list_hardware_interfaces": ("ListHardwareInterfaces", ListHardwareInterfacesResponse)}


def client(peer, manager, service, srv, request, response):
    name = f"{manager}/{service}"
    return peer.once(name, lambda: rw.ServiceClient(peer.dp, name, f"controller_manager_msgs/{srv}", request, response))


def ask(peer, a):
    srv, response = LISTS[a.what]
    show(**plain(client(peer, a.node, a.what, srv, Empty, response).call(Empty())))


def switch(peer, a):
    c = client(peer, a.node, "switch_controller", "SwitchController", SwitchControllerRequest, SwitchControllerResponse)
    r = c.call(SwitchControllerRequest(a.activate, a.deactivate, STRICTNESS[a.strictness]))
    show(ok=r.ok, message=r.message)
    if not r.ok:
        raise Failure(r.message)


def load(peer, a):
    """What the services answer that load and unload controllers."""
    show(**{service: client(peer, a.node, service, srv, request, Done).call(request()).ok
            for service, (srv, request) in LOADS.items()})


def add_commands(command):
    command("load-controllers", load)
    p = command("controller-manager", ask)
    p.add_argument("what", choices=LISTS)
    p = command("switch-controller", switch)
    p.add_argument("--activate", nargs="*", default=[])
    p.add_argument("--deactivate", nargs="*", default=[])
    p.add_argument("--strictness", choices=STRICTNESS, default="strict")
