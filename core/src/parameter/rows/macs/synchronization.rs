//! Synchronization and markers (AXS).

use super::super::{Applies, BASE, Effect, Group, MLONG, Range, Row, System, Value};

const SYNCHRONIZATION_ROW: Row =
    Row { system: System::Macs, group: Group::Synchronization, applies: Applies::Any, ..BASE };

/// A mark: units digit 0 to 3, tens digit an input.
const SLAVE_MARK: [(i64, i64); 10] = marks();
/// The same with hundreds, which may be negative.
const MARK: [(i64, i64); 190] = {
    let signed: [(i64, i64); 100] = marks();
    let mut ranges = [(0, 0); 190];
    let mut place = 0;
    while place < 190 {
        ranges[place] = if place < 90 {
            let (low, high) = signed[99 - place];
            (-high, -low)
        } else {
            signed[place - 90]
        };
        place += 1;
    }
    ranges
};

const fn marks<const N: usize>() -> [(i64, i64); N] {
    let mut ranges = [(0, 0); N];
    let mut place = 0;
    while place < N {
        ranges[place] = (place as i64 * 10, place as i64 * 10 + 3);
        place += 1;
    }
    ranges
}

pub(in super::super) const ROWS: &[Row] = rows! {
    "syncfactm": SYNCHRONIZATION_ROW, axis.sync_master {
        mnemonic: "SYNCFACTM", number: "49", unit: "inc", range: Range::Int(-MLONG, MLONG), default: Value::Int(1),
        effect: Effect::NextSynchronize,
        description: "Gear factor, master side, where a synchronize gives 0 : 0; negative turns the direction round, 0 is refused by the \
            synchronize.",
        source: "MACS-SYNC-02, MACS-DIR-04", note: "D20: the name is damaged in the text; the spelling of the number is taken." }
    "syncfacts": SYNCHRONIZATION_ROW, axis.sync_slave {
        mnemonic: "SYNCFACTS", number: "50", unit: "inc", range: Range::Int(1, MLONG), default: Value::Int(1),
        effect: Effect::NextSynchronize,
        description: "Gear factor, slave side, where a synchronize gives 0 : 0: syncfacts increments of the slave for syncfactm of the \
            master.",
        source: "MACS-SYNC-02", note: "D20: the name is damaged in the text; the spelling of the number is taken." }
    "syncaccuracy": SYNCHRONIZATION_ROW, axis.sync_accuracy {
        mnemonic: "SYNCACCURACY", number: "55", unit: "inc", range: Range::Int(-MLONG, MLONG), default: Value::Int(1000),
        effect: Effect::NextSynchronize,
        description: "Error up to which a coupling counts as accurate; negative: the same, and x.sync.error keeps its sign.",
        source: "MACS-SYNC-16, MACS-STO-09" }
    "syncmmaxcorr": SYNCHRONIZATION_ROW, axis.marks.largest {
        mnemonic: "SYNCMMAXCORR", number: "6", unit: "inc", range: Range::Int(-MLONG, MLONG), default: Value::Int(0),
        description: "Largest correction for a mark, either way; 0 no bound, negative no correction at all.", source: "MACS-MARK-18",
        note: "D20: the name is damaged in the text; the spelling of the number is taken." }
    "syncofftime": SYNCHRONIZATION_ROW, axis.sync.offset_time {
        mnemonic: "SYNCOFFTIME", number: "16", unit: "ms", range: Range::Int(0, MLONG), default: Value::Int(0),
        description: "Time in which an offset as long as the distance of the master's marks is worked off; 0: as fast as the rates allow.",
        source: "MACS-SYNC-14", note: "A-34: an older rule rounds to whole increments per ms; the trapezoid of the newer one is taken." }
    "syncmfpar": SYNCHRONIZATION_ROW, axis.marks.options {
        mnemonic: "SYNCMFPAR", number: "17", range: Range::Among(&[(0, 7), (16, 23), (64, 71), (80, 87)]), default: Value::Int(0),
        description: "Bits of the filter of marks: 1 with a fixed time, 2 without a correction of the gear, 4 corrections by syncmftime, \
            16 the correction alone is filtered, 64 also while not coupled.",
        source: "MACS-MARK-08",
        note: "D20: the name is damaged in the text; the spelling of the number is taken. A-36: bits 2, 4 and 16 are described in two \
            ways; the formulas are taken." }
    "syncmftime": SYNCHRONIZATION_ROW, axis.marks.filter_time {
        mnemonic: "SYNCMFTIME", number: "18", unit: "ms", range: Range::Int(-MLONG, MLONG), default: Value::Int(0),
        description: "Time in which the filter of the master's marks settles; 0 no filter.", source: "MACS-MARK-09",
        note: "D20: the name is damaged in the text; the spelling of the number is taken. A-37: negative values are not explained; they \
            are treated as 0." }
    "synctype": SYNCHRONIZATION_ROW, axis.sync.options {
        mnemonic: "SYNCTYPE", number: "51", range: Range::Among(&[(0, 0), (2, 2), (4, 4), (6, 6)]), default: Value::Int(0),
        effect: Effect::NextSynchronize,
        description: "2: a cam catches up with all that the axis can, whatever its goal says; 4: backward motion of the master is kept \
            back, and goes before further forward motion; 6: both.",
        source: "MACS-SYNC-05" }
    "syncmarkm": SYNCHRONIZATION_ROW, axis.marks.per_master {
        mnemonic: "SYNCMARKM", number: "52", range: Range::Int(0, 10_000), default: Value::Int(1),
        description: "Marks of the master for one comparison; 0 is taken as 1.", source: "MACS-MARK-02",
        note: "D20: the name is damaged in the text; the spelling of the number is taken." }
    "syncmarks": SYNCHRONIZATION_ROW, axis.marks.per_slave {
        mnemonic: "SYNCMARKS", number: "53", range: Range::Int(0, 10_000), default: Value::Int(1),
        description: "Marks of the slave for one comparison; 0 is taken as 1.", source: "MACS-MARK-02",
        note: "D18: unit and default are missing in the overview; 1 is taken." }
    "syncposoffs": SYNCHRONIZATION_ROW, axis.sync.offset {
        mnemonic: "SYNCPOSOFFS", number: "54", unit: "inc", range: Range::Int(-MLONG, MLONG), default: Value::Int(0),
        description: "Offset of the slave against the master, in the master's increments, for couplings that keep a position; positive is \
            ahead in the direction of the coupling.",
        source: "MACS-SYNC-13", note: "A-57: whose increments they are is not said; the master's are taken." }
    "syncready": SYNCHRONIZATION_ROW, axis.marks.ready {
        mnemonic: "SYNCREADY", number: "56", range: Range::Int(0, 10_000), default: Value::Int(1),
        description: "Accurate comparisons of marks in a row until the coupling is ready.", source: "MACS-MARK-20",
        note: "D17: the default is 0 in the overview; 1 is taken." }
    "syncfault": SYNCHRONIZATION_ROW, axis.marks.fault {
        mnemonic: "SYNCFAULT", number: "57", range: Range::Int(0, 10_000), default: Value::Int(10),
        description: "Inaccurate comparisons of marks in a row that are tolerated; one more is a fault.", source: "MACS-MARK-21",
        note: "D20: the name is damaged in the text; the spelling of the number is taken. A-42: the reset of the count is not explained; a \
            comparison of the other kind does it." }
    "syncmpulsm": SYNCHRONIZATION_ROW, axis.sync.mark_distance {
        mnemonic: "SYNCMPULSM", number: "58", unit: "inc", range: Range::Int(0, 2 * MLONG), default: Value::Int(500),
        description: "Distance of the master's marks; syncofftime is the time for it. 0 is no distance.", source: "MACS-MARK-03",
        note: "D20: the name is damaged in the text; the spelling of the number is taken." }
    "syncmpulss": SYNCHRONIZATION_ROW, axis.marks.slave_distance {
        mnemonic: "SYNCMPULSS", number: "59", unit: "inc", range: Range::Int(0, 2 * MLONG / 9), default: Value::Int(500),
        description: "Distance of the slave's marks.", source: "MACS-MARK-04",
        note: "D20: the name is damaged in the text; the spelling of the number is taken." }
    "syncmtypm": SYNCHRONIZATION_ROW, axis.marks.master_type {
        mnemonic: "SYNCMTYPM", number: "60", range: Range::Among(&MARK), default: Value::Int(0), effect: Effect::NextSynchronize,
        description: "Mark of the master: units digit 0, 1 index up, down, 2, 3 input up, down; tens digit its input; hundreds n with \
            sign: only while input n is high, or low.",
        source: "MACS-MARK-05", note: "D20: the name is damaged in the text; the spelling of the number is taken." }
    "syncmtyps": SYNCHRONIZATION_ROW, axis.marks.slave_type {
        mnemonic: "SYNCMTYPS", number: "61", range: Range::Among(&SLAVE_MARK), default: Value::Int(0), effect: Effect::NextSynchronize,
        description: "Mark of the slave: units digit 0, 1 index up, down, 2, 3 input up, down; tens digit its input.",
        source: "MACS-MARK-06" }
    "syncmstart": SYNCHRONIZATION_ROW, axis.marks.start {
        mnemonic: "SYNCMSTART", number: "62", range: Range::Among(&[(0, 7), (1000, 1007), (2000, 2000)]), default: Value::Int(0),
        effect: Effect::NextSynchronize,
        description: "Which marks are brought together first: 0 to 6 by their order or nearness, 7 along a smooth curve, 1000 more: with \
            the offset after the first correction only, 2000 for cams.",
        source: "MACS-MARK-14",
        note: "D20: the name is damaged in the text; the spelling of the number is taken. A-33: when the offset begins is described in two \
            ways." }
    "syncvftime": SYNCHRONIZATION_ROW, axis.sync.filter_time {
        mnemonic: "SYNCVFTIME", number: "65", unit: "us", range: Range::Int(-MLONG, MLONG), default: Value::Int(0),
        description: "Time of the filter of the master's velocity; -999 to 999 by the table of mencoder, which at 0 has none. Positive for \
            coupled velocities only, negative for positions, too.",
        source: "MACS-SYNC-08", note: "A-31: the table has gaps; between its rows 10^7 / mencoder - 500 is taken." }
    "syncvelrel": SYNCHRONIZATION_ROW, axis.sync.velocity_band {
        mnemonic: "SYNCVELREL", number: "66", unit: "%", range: Range::Int(0, 100), default: Value::Int(0),
        description: "How far the slave's velocity may leave the master's while it catches up; 0: as far as its rates allow.",
        source: "MACS-SYNC-12" }
    "syncmwinm": SYNCHRONIZATION_ROW, axis.marks.master_window {
        mnemonic: "SYNCMWINM", number: "68", unit: "inc", range: Range::Int(0, MLONG), default: Value::Int(0),
        description: "How far a mark of the master may be from where it is expected; others are left out. 0: not asked. It acts at once, \
            in a coupling, too.",
        source: "MACS-MARK-07" }
    "syncmwins": SYNCHRONIZATION_ROW, axis.marks.slave_window {
        mnemonic: "SYNCMWINS", number: "69", unit: "inc", range: Range::Int(0, MLONG), default: Value::Int(0),
        description: "How far a mark of the slave may be from where it is expected; others are left out. 0: not asked. It acts at once, in \
            a coupling, too.",
        source: "MACS-MARK-07" }
    "syncsftime": SYNCHRONIZATION_ROW, axis.marks.slave_filter_time {
        mnemonic: "SYNCSFTIME", number: "106", unit: "ms", range: Range::Int(0, MLONG), default: Value::Int(0),
        description: "Time in which the filter of the slave's marks settles; 0 no filter.", source: "MACS-MARK-19",
        note: "D19: the unit is missing in the overview; ms is taken." }
    "syncffvel": SYNCHRONIZATION_ROW, axis.sync.feed_forward {
        mnemonic: "SYNCFFVEL", number: "109", unit: "1/1000 of VCMD", range: Range::Int(0, MLONG), default: Value::Int(0),
        description: "How far the slave is led ahead, in parts of what it moves in one ms; 0 not.", source: "MACS-SYNC-15",
        note: "D20: the name is damaged in the text; the spelling of the number is taken." }
    "syncvflimit": SYNCHRONIZATION_ROW, axis.sync.filter_limit {
        mnemonic: "SYNCVFLIMIT", number: "110", unit: "inc", range: Range::Int(0, MLONG), default: Value::Int(0),
        description: "Error of the filtered master beyond which its filter becomes faster; 0: never.", source: "MACS-SYNC-11",
        note: "A-32: which error is meant is described in two ways; that of the filter is taken." }
};
