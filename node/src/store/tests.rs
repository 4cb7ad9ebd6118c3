//! Tests the store with failing disks, damaged files and changed cells.

mod exact;
mod unfit;

use super::*;
use crate::cell::Cell;
use lineshaft_core::parameter::MachineParameters;
use std::fs;
use tempfile::TempDir;

/// Two axes, each with a few own values.
const CELL: &str = "\
lineshaft: 1
cycle: 1 ms
backends: {plant: {type: sim}}
axes:
  x: {type: linear, unit: mm, scale: {increments: 1000, per: 1 mm}, drive: {backend: plant, address: 0}, min_position: 0 mm,
      max_position: 1000 mm, max_velocity: 1 m/s, max_acceleration: 100 m/s^2, sim: {model: ideal}}
  table: {type: rotary, unit: deg, scale: {increments: 1000, per: 3 rev}, drive: virtual, velmax: 1000, rampmin: 500}
";

fn config() -> MachineConfig {
    Cell::parse("cell.yaml", CELL).expect("the cell of the tests").machine
}

/// A folder with a store.
struct Bench {
    folder: TempDir,
    config: MachineConfig,
}

impl Bench {
    fn new() -> Self {
        Self { folder: tempfile::tempdir().expect("a folder"), config: config() }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn open(&self) -> Result<Store, StoreError> {
        Store::open(&self.path("p.yaml"))
    }

    /// Returns parameters of both axes with values derived from `n`.
    fn user(&self, n: i64) -> Vec<AxisParameters> {
        let mut user: Vec<_> = self.config.axes.iter().map(|axis| axis.parameters).collect();
        for axis in &mut user {
            axis.jerk_times[0] = n * 1_000_000;
            axis.in_position_window = n;
        }
        user
    }

    /// Saves `n`; returns the generation.
    fn save(&self, n: i64) -> u64 {
        let mut store = self.open().expect("a store");
        assert!(store.keep(&self.config, &self.user(n)).expect("a disk"), "{n} was there");
        store.generation()
    }

    /// Returns the `n` of all values; `None` if nothing is saved.
    fn loaded(&self) -> Result<Option<i64>, StoreError> {
        let store = self.open()?;
        let mut config = self.config.clone();
        store.load(&mut config)?;
        let sets: Vec<_> = config.axes.iter().filter_map(|axis| axis.saved).collect();
        let Some(n) = sets.first().map(|set| set.in_position_window) else { return Ok(None) };
        assert_eq!(sets, self.user(n), "a mixture");
        Ok(Some(n))
    }

    fn files(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path()).expect("the folder");
        let mut names: Vec<_> =
            entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }
}

/// Proves: MACS-STO-04, MACS-STO-06
#[test]
fn what_was_saved_is_there_for_the_next_program_and_what_is_unchanged_is_not_written() {
    let bench = Bench::new();
    assert_eq!(bench.loaded().unwrap(), None);
    assert_eq!(bench.files(), [".p.yaml.lock"], "nothing was saved, and no file is made");
    assert_eq!((bench.save(1), bench.save(2)), (1, 2));
    assert_eq!(bench.loaded().unwrap(), Some(2));
    assert_eq!(bench.files(), [".p.yaml.lock", "p.yaml", "p.yaml.previous"]);

    let before = fs::metadata(bench.path("p.yaml")).unwrap();
    let mut store = bench.open().unwrap();
    assert!(!store.keep(&bench.config, &bench.user(2)).unwrap());
    use std::os::unix::fs::MetadataExt;
    assert_eq!(fs::metadata(bench.path("p.yaml")).unwrap().ino(), before.ino(), "it was written again");
    // Deleting all values is a change, which is written.
    let init: Vec<_> = bench.config.axes.iter().map(|axis| axis.parameters).collect();
    assert!(store.keep(&bench.config, &init).unwrap());
    drop(store);
    assert_eq!(bench.loaded().unwrap(), None);
    assert!(
        fs::read_to_string(bench.path("p.yaml")).unwrap().contains("\ngeneration: 3\naxes:\nparameters:\nsha256: ")
    );
}

#[test]
fn the_file_is_what_the_documentation_shows() {
    let bench = Bench::new();
    bench.save(7);
    let text = fs::read_to_string(bench.path("p.yaml")).unwrap();
    let lines: Vec<_> = text.lines().filter(|line| !line.starts_with('#') && !line.starts_with("sha256: ")).collect();
    let expected = [
        "lineshaft_store: 1",
        "generation: 1",
        "axes:",
        "  x: 1000000 inc/m",
        "  table: 1000/3 inc/rev",
        "parameters:",
        "  x.in_position_window: 7 inc",
        "  x.jerkmin2: 7000000 ns",
        "  table.in_position_window: 7 inc",
        "  table.jerkmin2: 7000000 ns",
    ];
    // A virtual axis may have fewer of them.
    let of_table = |line: &&str| line.starts_with("  table.");
    assert_eq!(
        lines.iter().filter(|line| !of_table(line)).collect::<Vec<_>>(),
        expected.iter().filter(|line| !of_table(line)).collect::<Vec<_>>()
    );
}

/// A disk that fails at any step: the previous set is complete, and the next save works.
///
/// Proves: MACS-STO-06
#[test]
fn after_any_failed_step_the_old_or_the_new_set_is_stored() {
    let mut steps = Vec::new();
    {
        let bench = Bench::new();
        bench.save(1);
        let mut store = bench.open().unwrap();
        let mut note = |step| {
            steps.push(step);
            Ok(())
        };
        store.keep_while(&bench.config, (&bench.user(2), &MachineParameters::default()), &mut note).unwrap();
    }
    assert_eq!(steps, ["clear", "create", "write", "sync", "link", "keep", "rename", "sync folder"]);
    for failing in &steps {
        let bench = Bench::new();
        bench.save(1);
        bench.save(2);
        let mut store = bench.open().unwrap();
        let mut fail = |step: &'static str| {
            if step == *failing { Err(io::Error::from(io::ErrorKind::StorageFull)) } else { Ok(()) }
        };
        let error = store
            .keep_while(&bench.config, (&bench.user(3), &MachineParameters::default()), &mut fail)
            .unwrap_err()
            .to_string();
        assert!(error.contains("p.yaml: parameters cannot be written: ") && error.contains("storage"), "{error}");
        drop(store);
        // The new set is valid only after the names were changed, and it is not confirmed.
        let expected = if *failing == "sync folder" { 3 } else { 2 };
        assert_eq!(bench.loaded().unwrap(), Some(expected), "{failing}");
        assert_eq!(bench.files(), [".p.yaml.lock", "p.yaml", "p.yaml.previous"], "{failing}");
        bench.save(4);
        assert_eq!(bench.loaded().unwrap(), Some(4), "{failing}");
        fs::write(bench.path("p.yaml"), "").unwrap();
        assert_eq!(bench.loaded().unwrap(), Some(expected), "{failing}: the generation before");
    }
}

/// The program ends between two steps, and leaves all its files.
#[test]
fn after_any_last_step_the_next_program_reads_a_complete_set() {
    for left in 0..9 {
        let bench = Bench::new();
        bench.save(1);
        bench.save(2);
        let files = Files::of(&bench.path("p.yaml")).unwrap();
        let user = bench.user(3);
        let sets: Vec<_> = std::iter::zip(&bench.config.axes, &user).collect();
        let text = text::whole(3, &text::body(&sets));
        let mut step = 0;
        let _ = files.steps(&text, Present::Good, &mut |_| {
            step += 1;
            if step > left { Err(io::Error::other("killed")) } else { Ok(()) }
        });
        let found = bench.loaded().unwrap();
        assert!(found == Some(2) || found == Some(3), "{left}: {found:?}");
        assert_eq!(found == Some(3), left >= 7, "{left}: {found:?}");
        bench.save(9);
        assert_eq!(bench.loaded().unwrap(), Some(9));
        fs::write(bench.path("p.yaml"), "").unwrap();
        assert_eq!(bench.loaded().unwrap(), found, "{left}: the generation before");
    }
}

/// Every bit flipped, and the text cut at every length: reading gives the same set, or the previous generation.
///
/// Proves: MACS-STO-06
#[test]
fn damage_is_found_wherever_it_is_and_the_generation_before_is_used() {
    let bench = Bench::new();
    bench.save(1);
    bench.save(2);
    let path = bench.path("p.yaml");
    let whole = fs::read(&path).unwrap();
    let files = Files::of(&path).unwrap();
    let check = |bytes: &[u8], what: &str| {
        fs::write(&path, bytes).unwrap();
        let found = files.find().unwrap();
        assert_eq!(found.present, Present::Damaged, "{what}");
        let (used, text) = found.text.unwrap();
        assert_eq!((used, text::generation_of(&text)), (files.previous.clone(), Some(1)), "{what}");
    };
    for place in 0..whole.len() {
        check(&whole[..place], &format!("cut at {place}"));
        for bit in 0..8 {
            let mut bytes = whole.clone();
            bytes[place] ^= 1 << bit;
            check(&bytes, &format!("bit {bit} of byte {place}"));
        }
    }
    check(&[&whole[..], b"\n"].concat(), "one more line");
    check(&[&whole[..], &whole[..]].concat(), "twice");
    check(&[0; 4096], "zeros");
    check(&[0xff; 100], "no text");
    assert_eq!(bench.loaded().unwrap(), Some(1));
    // The damaged file does not become the previous generation: the valid one is kept until there is a newer one.
    let mut store = bench.open().unwrap();
    assert!(store.keep(&bench.config, &bench.user(1)).unwrap(), "the same set, and yet the file is mended");
    assert!(store.keep(&bench.config, &bench.user(5)).unwrap());
    drop(store);
    assert_eq!(bench.loaded().unwrap(), Some(5));
    fs::write(&path, "").unwrap();
    assert_eq!(bench.loaded().unwrap(), Some(1));
}

#[test]
fn without_a_good_generation_nothing_starts() {
    let bench = Bench::new();
    bench.save(1);
    fs::write(bench.path("p.yaml"), "").unwrap();
    let alone = bench.loaded().unwrap_err().to_string();
    assert!(alone.contains("p.yaml: it is damaged: it is empty. There is no generation before. "), "{alone}");
    fs::write(bench.path("p.yaml.previous"), [0xff; 9]).unwrap();
    let both = bench.loaded().unwrap_err().to_string();
    assert!(both.contains("The generation before, "), "{both}");
    assert!(both.contains("p.yaml.previous, too: it is not UTF-8 text"), "{both}");
    assert!(both.contains("delete it to begin with the values of the cell"), "{both}");
    fs::write(bench.path("p.yaml"), vec![b'#'; (4 << 20) + 1]).unwrap();
    assert!(bench.loaded().unwrap_err().to_string().contains("it is longer than 4194304 bytes"));
}

#[test]
fn without_the_file_nothing_is_saved_and_the_previous_generation_is_removed() {
    let bench = Bench::new();
    bench.save(1);
    bench.save(2);
    fs::remove_file(bench.path("p.yaml")).unwrap();
    assert_eq!(bench.loaded().unwrap(), None);
    bench.save(3);
    assert_eq!(bench.files(), [".p.yaml.lock", "p.yaml"], "it would bring back what was taken away");
}

/// At run time: the next saved set is on the disk again, even if it is the set that the file had.
#[test]
fn removed_file_is_written_by_the_next_save() {
    for (next, generation) in [(2, 3), (1, 3), (7, 3)] {
        let bench = Bench::new();
        bench.save(1);
        let mut store = bench.open().unwrap();
        assert!(store.keep(&bench.config, &bench.user(2)).unwrap());
        fs::remove_file(bench.path("p.yaml")).unwrap();
        assert!(store.keep(&bench.config, &bench.user(next)).unwrap(), "{next} was taken for saved");
        assert!(!store.keep(&bench.config, &bench.user(next)).unwrap());
        assert_eq!(store.generation(), generation);
        drop(store);
        assert_eq!(bench.loaded().unwrap(), Some(next));
    }
    // Without saved values no file is needed.
    let bench = Bench::new();
    bench.save(1);
    let mut store = bench.open().unwrap();
    fs::remove_file(bench.path("p.yaml")).unwrap();
    let init: Vec<_> = bench.config.axes.iter().map(|axis| axis.parameters).collect();
    assert!(!store.keep(&bench.config, &init).unwrap());
    assert!(!bench.path("p.yaml").exists());
}

#[test]
fn what_a_killed_program_left_is_replaced() {
    let bench = Bench::new();
    bench.save(1);
    for left in [".p.yaml.new", ".p.yaml.old"] {
        fs::write(bench.path(left), "half of a te").unwrap();
    }
    assert_eq!(bench.loaded().unwrap(), Some(1));
    bench.save(2);
    assert_eq!(bench.loaded().unwrap(), Some(2));
    assert_eq!(bench.files(), [".p.yaml.lock", "p.yaml", "p.yaml.previous"]);
}

#[test]
fn two_programs_do_not_write_one_store() {
    let bench = Bench::new();
    bench.save(1);
    let first = bench.open().unwrap();
    let refused = bench.open().unwrap_err().to_string();
    assert!(
        refused
            .ends_with("p.yaml: another program keeps its parameters there; end it, or name another file with --store")
    );
    let mut beside = Store::open_read_only_if_used(&bench.path("p.yaml")).unwrap();
    let mut config = bench.config.clone();
    beside.load(&mut config).unwrap();
    assert_eq!(config.axes[0].saved.unwrap().in_position_window, 1);
    assert!(!beside.keep(&bench.config, &bench.user(1)).unwrap(), "that is there");
    let error = beside.keep(&bench.config, &bench.user(2)).unwrap_err().to_string();
    assert!(error.contains("p.yaml: parameters are not kept there: another program"), "{error}");
    drop((first, beside));
    assert_eq!(bench.loaded().unwrap(), Some(1));
}

/// A change of the file by another program at run time is detected by the next save, even of an unchanged set: garbage,
/// a part, the set of another machine, another kind of file, no file.
#[test]
fn a_file_that_was_overwritten_from_outside_is_written_again() {
    let bench = Bench::new();
    let mut store = bench.open().unwrap();
    assert!(store.keep(&bench.config, &bench.user(1)).unwrap());
    assert!(store.keep(&bench.config, &bench.user(2)).unwrap());
    let path = bench.path("p.yaml");
    let good = fs::read_to_string(&path).unwrap();
    for (what, text) in [("garbage", "garbage"), ("nothing", ""), ("a part", &good[..good.len() / 2])] {
        fs::write(&path, text).unwrap();
        assert!(store.keep(&bench.config, &bench.user(2)).unwrap(), "{what}");
        assert!(!store.keep(&bench.config, &bench.user(2)).unwrap(), "once");
        // A damaged file does not become the previous generation.
        let before = fs::read_to_string(bench.path("p.yaml.previous")).unwrap();
        assert!(before.contains("generation: 1\n"), "{what}: {before}");
    }
    // A valid set of another program becomes the previous generation.
    let other = Bench::new();
    for n in 1..=40 {
        other.save(n);
    }
    fs::copy(other.path("p.yaml"), &path).unwrap();
    assert!(store.keep(&bench.config, &bench.user(2)).unwrap());
    assert_eq!(store.generation(), 41);
    assert_eq!(fs::read(bench.path("p.yaml.previous")).unwrap(), fs::read(other.path("p.yaml")).unwrap());
    fs::remove_file(&path).unwrap();
    assert!(store.keep(&bench.config, &bench.user(2)).unwrap());
    // A folder cannot be replaced, which is reported; a pipe can, and opening it does not block.
    fs::remove_file(&path).unwrap();
    fs::create_dir(&path).unwrap();
    let error = store.keep(&bench.config, &bench.user(2)).unwrap_err().to_string();
    assert!(error.contains("p.yaml: parameters cannot be written: "), "{error}");
    fs::remove_dir(&path).unwrap();
    assert!(std::process::Command::new("mkfifo").arg(&path).status().unwrap().success());
    assert!(store.keep(&bench.config, &bench.user(2)).unwrap());
    drop(store);
    assert_eq!(bench.loaded().unwrap(), Some(2));
}

/// A previous generation that is no file is ignored, and opening it does not block.
#[test]
fn a_pipe_in_the_place_of_a_store_is_not_waited_for() {
    let bench = Bench::new();
    assert_eq!((bench.save(1), bench.save(2)), (1, 2));
    fs::write(bench.path("p.yaml"), "garbage").unwrap();
    fs::remove_file(bench.path("p.yaml.previous")).unwrap();
    assert!(std::process::Command::new("mkfifo").arg(bench.path("p.yaml.previous")).status().unwrap().success());
    let error = bench.open().unwrap_err().to_string();
    assert!(error.contains("it is a named pipe; a regular file is expected"), "{error}");
    fs::rename(bench.path("p.yaml.previous"), bench.path("p.yaml")).unwrap();
    assert!(bench.open().unwrap_err().to_string().contains("p.yaml: it is no file"));
}

#[test]
fn a_place_that_is_none_is_refused() {
    let bench = Bench::new();
    let refused = |path: PathBuf| Store::open(&path).unwrap_err().to_string();
    assert!(refused(bench.path("no/p.yaml")).contains("p.yaml: there is no folder "));
    assert!(refused(bench.path("")).contains("it is no file"));
    assert!(refused(PathBuf::from("/dev/null")).contains("/dev/null: it is no file"));
    assert!(refused(PathBuf::from("/")).contains("/: it is no name of a file"));
}

/// A folder without write permission: the existing file is read, and saving reports the reason of its failure.
#[test]
fn a_store_that_cannot_be_locked_is_read() {
    let bench = Bench::new();
    bench.save(1);
    fs::remove_file(bench.path(".p.yaml.lock")).unwrap();
    fs::create_dir(bench.path(".p.yaml.lock")).unwrap();
    assert_eq!(bench.loaded().unwrap(), Some(1));
    let error = bench.open().unwrap().keep(&bench.config, &bench.user(2)).unwrap_err().to_string();
    assert!(error.contains("parameters are not kept there: ") && error.contains(".p.yaml.lock"), "{error}");
}

#[test]
fn a_link_stays_one_and_the_rights_of_the_file_too() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let bench = Bench::new();
    fs::create_dir(bench.path("far")).unwrap();
    fs::write(bench.path("far/q.yaml"), "").unwrap();
    fs::remove_file(bench.path("far/q.yaml")).unwrap();
    let mut far = Store::open(&bench.path("far/q.yaml")).unwrap();
    far.keep(&bench.config, &bench.user(1)).unwrap();
    drop(far);
    fs::set_permissions(bench.path("far/q.yaml"), fs::Permissions::from_mode(0o640)).unwrap();
    symlink(bench.path("far/q.yaml"), bench.path("p.yaml")).unwrap();
    bench.save(2);
    assert!(fs::symlink_metadata(bench.path("p.yaml")).unwrap().is_symlink());
    // Also if the target does not exist yet.
    symlink("far/new.yaml", bench.path("new.yaml")).unwrap();
    Store::open(&bench.path("new.yaml")).unwrap().keep(&bench.config, &bench.user(3)).unwrap();
    assert!(fs::symlink_metadata(bench.path("new.yaml")).unwrap().is_symlink());
    assert!(bench.path("far/new.yaml").is_file());
    assert_eq!(fs::metadata(bench.path("far/q.yaml")).unwrap().permissions().mode() & 0o777, 0o640);
    assert_eq!(bench.loaded().unwrap(), Some(2));
}

/// Parameters of the machine are stored like those of axes, and read back; values equal to those of the cell are not
/// stored.
#[test]
fn parameters_of_the_machine_are_kept() {
    let bench = Bench::new();
    let mut config = bench.config.clone();
    let io = |name: &str, kind| lineshaft_core::config::IoConfig { name: name.into(), kind, latch: false };
    config.io.push(io("out", lineshaft_core::config::IoKind::DigitalOutput));
    config.global.parameters.o_error = 1;
    let user: Vec<AxisParameters> = config.axes.iter().map(|axis| axis.parameters).collect();
    let machine = MachineParameters { o_error: -1, ainftime: 7, ..config.global.parameters };
    let mut store = bench.open().unwrap();
    assert!(store.keep_all(&config, &user, &machine).unwrap());
    assert!(!store.keep_all(&config, &user, &machine).unwrap(), "that is there");
    drop(store);
    let text = fs::read_to_string(bench.open().unwrap().path()).unwrap();
    assert!(text.contains("parameters:\n  machine.o_error: -1\n  machine.ainftime: 7\n"), "{text}");
    let mut loaded = config.clone();
    bench.open().unwrap().load(&mut loaded).unwrap();
    assert_eq!(loaded.global.saved, Some(machine));
    assert!(loaded.axes.iter().all(|axis| axis.saved.is_none()));
    // This program does not write it; a velocity that moves the virtual master must not be applied at the start.
    let sets: Vec<_> = std::iter::zip(&config.axes, &user).collect();
    let body = text::body_with(&sets, (&config.global.parameters, &MachineParameters { pulsvel: 7, ..machine }));
    let error = read::read_store("p", &text::whole(3, &body), &config).map(drop).unwrap_err().to_string();
    assert!(error.contains("machine: pulsvel begins anew with each start and is never saved"), "{error}");
    // Back to the values of the cell: nothing is stored.
    assert!(bench.open().unwrap().keep_all(&config, &user, &config.global.parameters).unwrap());
    let mut loaded = config.clone();
    bench.open().unwrap().load(&mut loaded).unwrap();
    assert_eq!(loaded, config);
}
