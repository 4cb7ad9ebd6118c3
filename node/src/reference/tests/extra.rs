//! Files with the keys that no example file has. Their problems do not matter: a reader records the expected kind of a
//! value before it refuses the value.

/// Cells.
pub(super) const CELLS: &[&str] = &[CAN, PLANT];

const CAN: &str = "
lineshaft: 1
cycle: 4 ms
ros: {shaft_rate: 50 Hz, controller_manager: /controller_manager, interfaces: [eth0], on_loss: none, loss_timeout: 1 s, request_timeout: 5 s, record_topics: [/rosout]}
backends:
  bus0:
    type: can
    transport: 'slcan:/dev/ttyACM0'
    bitrate: 1000000
    serial_baudrate: 2000000
    sync_counter: 240
    sdo_timeout: 1 s
    time: 1 s
    master: {node: 126, heartbeat: 50 ms}
    nodes:
      - node: 10
        eds: io.eds
        guarding: {time: 100 ms, factor: 3}
        identity: {vendor: 1, product: 2, revision: 3, serial: 4}
        startup: [{index: 0x2080, sub: 1, type: u8, value: 5}]
      - {node: 11, heartbeat: 50 ms}
axes:
  x:
    type: linear
    joint: slide
    scale: {increments: 1000, per: 1 mm}
    drive:
      backend: bus0
      node: 3
      interface: velocity
      mode: csv
      enable_timeout: 10 s
      guarding: {time: 100 ms, factor: 3}
      identity: {vendor: 1, product: 2, revision: 3, serial: 4}
      startup: [{index: 0x2080, sub: 1, type: u8, value: 5}]
      rated_effort: 5 N
    max_velocity: 1 m/s
    max_acceleration: 1 m/s^2
  y:
    type: linear
    scale: {increments: 1000, per: 1 mm}
    drive: {backend: bus0, node: 4, interface: velocity, drivetype: 11}
    max_velocity: 1 m/s
    max_acceleration: 1 m/s^2
  gantry:
    type: linear
    scale: {increments: 1000, per: 1 mm}
    drives:
      - backend: bus0
        node: 5
        interface: position
        regulator: pid
        missed_cycles: 5
        enable_timeout: 10 s
        mode: csp
        eds: drive.eds
        guarding: {time: 100 ms, factor: 3}
        identity: {vendor: 1, product: 2, revision: 3, serial: 4}
        startup: [{index: 0x2080, sub: 1, type: u8, value: 5}]
        probe_1: rising
        probe_2: index
        feed: 10 mm
        velocity_factor: {numerator: 10, denominator: 1}
        missed_pdo: extrapolate
        rated_effort: 5 N
      - {backend: bus0, node: 6, heartbeat: 50 ms, drivetype: 11}
    max_skew: 1 mm
    max_velocity: 1 m/s
    max_acceleration: 1 m/s^2
";

const PLANT: &str = "
lineshaft: 1
cycle: 1 ms
backends: {plant: {type: sim}}
io:
  lamp: {type: do, backend: plant, address: 0}
  b1: {type: do, backend: plant, address: 1}
  seen: {type: di, output: lamp}
  s1: {type: di, backend: plant, address: 1}
  s2: {type: di, backend: plant, address: 2}
  s3: {type: di, backend: plant, address: 3}
  s4: {type: di, backend: plant, address: 4}
memory: {feed: {type: i32}}
encoders:
  table:
    backend: plant
    address: 0
    type: rotary
    scale: {increments: 4096, per: 1 rev}
    steps: 4096
    turns: 4
    code: gray
    parity: even
    omitted: 0
    overflow: false
    error_correction: true
    max_step: 1 deg
tables: {knife: {form: y, points: [0, 5, 0], cam: {length: 1000, cyclic: false}}}
axes:
  winding:
    type: rotary
    scale: {increments: 4096, per: 1 rev}
    drive: {backend: plant, address: 0, interface: voltage}
    feedback:
      {steps: 4096, turns: 4, code: gray, parity: even, omitted: 0, overflow: false, error_correction: true, max_step: 1 deg}
    max_velocity: 10 rev/s
    max_acceleration: 10 rev/s^2
    brake: {output: b1, inverted: true}
    sim:
      model: motor
      inertia: 0.001 kg*m^2
      counts_per_turn: 4096
      voltage: 48 V
      resistance: 1 Ohm
      torque_constant: 0.1 Nm/A
      back_emf: 0.1 V*s/rad
      load_static_friction: 0.1 Nm
      dead_time: 1 ms
      noise: 1 inc
      seed: 7
  gantry:
    type: linear
    scale: {increments: 1000, per: 1 mm}
    drives: [{backend: plant, address: 1}, {backend: plant, address: 2}]
    max_skew: 1 mm
    max_velocity: 1 m/s
    max_acceleration: 1 m/s^2
    sim:
      model: ideal
      home_switch: {from: 0 mm, to: 1 mm, input: s4, normally_closed: true}
      second:
        start: 1 mm
        index: {every: 10 mm, at: 1 mm}
        home_switch: {from: 0 mm, to: 1 mm, input: s1, normally_closed: true}
        negative_limit_switch: {at: -10 mm, input: s2, normally_closed: true}
        positive_limit_switch: {at: 500 mm, input: s3, normally_closed: true}
functions:
  own:
    slot: 0
    type: apsf
    cycle_factor: 2
    outputs: [{name: lamp, inverted: true}]
    reads: [winding.actual.position]
    writes: [feed]
groups:
  hand:
    axes: [winding]
    trajectory_limits: {margin: 0.02, max_stretch: 2, on_excess: refuse}
    angle_wraparound: true
    max_duration: 60 s
    controller_state_rate: 20
    gripper: {allow_stalling: true}
";

/// The cell of [`SCENARIO`].
pub(super) const SCENARIO_CELL: &str = "
lineshaft: 1
cycle: 1 ms
backends: {plant: {type: sim}}
io:
  start: {type: di, backend: plant, address: 0}
  level: {type: ai, backend: plant, address: 0}
memory: {feed: {type: i16}}
encoders:
  belt: {backend: plant, address: 0, type: linear, scale: {increments: 40, per: 1 mm}}
axes:
  x: {type: linear, scale: {increments: 1000, per: 1 mm}, drive: {backend: plant, address: 0}, max_velocity: 1 m/s,
      max_acceleration: 1 m/s^2}
";

pub(super) const SCENARIO: &str = "
scenario: keys that no example has
cell: extra.yaml
cycles: 2000
drive:
  - {signal: start, csv: {file: none.csv, column: start}}
  - {signal: belt.count, ramp: {from: 0, per_cycle: 1/3, until: 500, wrap: 16}}
  - {signal: level, sine: {mean: 1, amplitude: 2, period: 1 s}}
  - {signal: feed, values: [1, 2], then: {hold: 10 ms}}
steps:
  - {at: 0, do: {enable: {}}, optional: true, refused: {code: 98, text: limit}}
  - {when: {signal: x.actual.position, plus: x.command.position, minus: x.target.position, is: 0}, do: {halt: {}}}
  - {when: {signal: x.output.control, mask: 0x0F, not: 1}, do: {halt: {}}}
  - {when: {parameter: x.max_velocity, is: 1 m/s}, do: {halt: {}}}
  - when:
      any:
        - {signal: x.actual.position, plus: x.command.position, minus: x.target.position, min: 0, max: 1}
        - {signal: x.output.control, mask: 0x0F, not: 1}
        - {parameter: x.max_velocity, is: 1 m/s}
        - {any: [{signal: x.enabled, is: 1}]}
    do: {halt: {}}
expect:
  - {signal: x.actual.position, from: 0, every: 10, values: [0, 0], within: 1}
  - {signal: x.actual.position, plus: x.command.position, is: 0}
  - {signal: x.output.control, mask: 0x0F, not: 1}
  - {parameter: x.max_velocity, is: 1 m/s}
  - {any: [{signal: x.enabled, is: 1}]}
  - {event: {severity: error, age_ns: 5}, count: 0}
";
