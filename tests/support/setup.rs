//! Sets the peers up in `target/peers`: a Python environment, and a C++ program with the libraries that it needs.
//!
//! This is done once, and again only when the sources have changed. Concurrent test processes wait for the first one.

use std::{
    env,
    fs::{self, File},
    path::{Path, PathBuf},
    process::{Command, Output},
    sync::OnceLock,
};

/// Returns the folder with the sources of the peers.
pub(crate) fn sources() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the crate is in the workspace").join("tests/peers")
}

/// Returns the Python interpreter with all packages of `requirements.txt`.
///
/// Panics with the remedy when the environment cannot be created.
pub(crate) fn python() -> &'static Path {
    static PYTHON: OnceLock<PathBuf> = OnceLock::new();
    PYTHON.get_or_init(|| {
        let requirements = sources().join("requirements.txt");
        let folder = made("venv", &read(&requirements), |folder| make_environment(folder, &requirements));
        folder.join("bin/python")
    })
}

/// Returns the Python interpreter with all packages of `can/requirements.txt`.
///
/// Panics with the remedy when the environment cannot be created.
pub(crate) fn can_python() -> &'static Path {
    static PYTHON: OnceLock<PathBuf> = OnceLock::new();
    PYTHON.get_or_init(|| {
        let requirements = sources().join("can/requirements.txt");
        let folder = made("can-venv", &read(&requirements), |folder| make_environment(folder, &requirements));
        folder.join("bin/python")
    })
}

/// Returns the Fast DDS peer, built.
///
/// Panics with the packages to install when it cannot be built.
pub(crate) fn fastdds_peer() -> &'static Path {
    static PEER: OnceLock<PathBuf> = OnceLock::new();
    PEER.get_or_init(|| {
        let code = sources().join("fastdds_peer.cpp");
        let parts = ["wire", "move", "load", "values", "visits", "joints", "states"]
            .map(|name| format!("fastdds_{name}.hpp"))
            .map(|name| read(&sources().join(name)));
        made("fastdds", &(read(&code) + &parts.concat()), |folder| build(folder, &code)).join("fastdds_peer")
    })
}

/// Returns the library that changes the system clock of processes, built from the source in the Python package
/// `libfaketime`.
///
/// Panics with the packages to install when it cannot be built.
pub(crate) fn fake_clock() -> &'static Path {
    static LIBRARY: OnceLock<PathBuf> = OnceLock::new();
    LIBRARY.get_or_init(|| {
        let requirements = read(&sources().join("requirements.txt"));
        let where_is = "import sysconfig; print(sysconfig.get_path('purelib'))";
        let packages =
            require(run(Command::new(python()).args(["-c", where_is])), "The Python of the tests does not work");
        let source = Path::new(packages.trim()).join("libfaketime/vendor/libfaketime/src");
        made("fake-clock", &requirements, |folder| {
            fs::create_dir_all(folder).unwrap_or_else(|e| panic!("{} cannot be made: {e}", folder.display()));
            // The same options as in its Makefile.
            let mut compiler = Command::new("gcc");
            compiler.current_dir(&source).args(["-std=gnu99", "-O1", "-w", "-fPIC", "-shared"]);
            compiler.args(["-DFAKE_INTERNAL_CALLS", "-DPREFIX=\"\"", "-DLIBDIRNAME=\"\""]);
            compiler
                .args(["libfaketime.c", "-Wl,--version-script=libfaketime.map", "-o"])
                .arg(folder.join("libfaketime.so"));
            compiler.args(["-lpthread", "-ldl", "-lm", "-lrt"]);
            require(
                run(&mut compiler),
                "libfaketime does not build with this system's C compiler (Debian: apt-get install gcc)",
            );
        })
        .join("libfaketime.so")
    })
}

/// Returns the folder `name` with the output of `make`. `from` is everything that the output depends on, and is stored
/// in a stamp file.
fn made(name: &str, from: &str, make: impl FnOnce(&Path)) -> PathBuf {
    let peers = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().expect("it is inside the target folder").join("peers");
    fs::create_dir_all(&peers).unwrap_or_else(|e| panic!("{} cannot be made: {e}", peers.display()));
    let lock = File::create(peers.join(format!("{name}.lock"))).expect("the folder was just made");
    lock.lock().expect("the file system of the target folder has locks");

    let (folder, stamp) = (peers.join(name), peers.join(format!("{name}.stamp")));
    let from = format!("{}\n{from}", folder.display()); // an environment does not work at another place
    if fs::read_to_string(&stamp).is_ok_and(|made_from| made_from == from) {
        return folder;
    }
    for old in [fs::remove_file(&stamp), fs::remove_dir_all(&folder)] {
        drop(old); // they may not exist
    }
    make(&folder);
    fs::write(&stamp, from).unwrap_or_else(|e| panic!("{} cannot be written: {e}", stamp.display()));
    folder
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|e| panic!("{} cannot be read: {e}", path.display()))
}

fn make_environment(folder: &Path, requirements: &Path) {
    let venv = run(Command::new("python3").args(["-m", "venv"]).arg(folder));
    require(venv, "The tests need Python 3.10 to 3.13 with its module venv (Debian: apt-get install python3-venv)");
    let pip = run(Command::new(folder.join("bin/python"))
        .args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--only-binary", ":all:", "-r"])
        .arg(requirements));
    require(
        pip,
        "The tests need, once, the Python packages of tests/peers/requirements.txt and tests/peers/can/requirements.txt for \
         Python 3.10 to 3.13: connect to the network or point pip to a mirror (pip config set global.index-url URL)",
    );
}

fn build(folder: &Path, code: &Path) {
    fs::create_dir_all(folder).unwrap_or_else(|e| panic!("{} cannot be made: {e}", folder.display()));
    let root = if Path::new("/usr/include/fastdds/dds/domain/DomainParticipant.hpp").exists() {
        PathBuf::from("/")
    } else {
        unpack_library(folder)
    };
    let multiarch = run(Command::new("g++").arg("-print-multiarch"));
    let multiarch = require(multiarch, "The tests need a C++ compiler (Debian: apt-get install g++)");
    let (include, lib) = (root.join("usr/include"), root.join("usr/lib").join(multiarch.trim()));
    let mut compiler = Command::new("g++");
    compiler.args(["-std=c++17", "-O0", "-w"]).arg(code).arg("-o").arg(folder.join("fastdds_peer"));
    if root != Path::new("/") {
        compiler.arg("-isystem").arg(&include).arg("-isystem").arg(include.join(multiarch.trim()));
        // The older kind of run path (RPATH) also applies to the dependencies of the libraries.
        compiler.arg("-L").arg(&lib).arg(format!("-Wl,--disable-new-dtags,-rpath,{}", lib.display()));
    }
    let libraries = ["fastrtps", "fastcdr", "foonathan_memory", "tinyxml2", "ssl", "crypto", "pthread"];
    compiler.args(libraries.map(|name| format!("-l{name}")));
    require(run(&mut compiler), "The Fast DDS peer does not build with this system's libfastrtps-dev (2.x is needed)");
}

/// Unpacks Debian's Fast DDS and the missing packages that it needs into `folder`, without installing them; returns the
/// library folder.
fn unpack_library(folder: &Path) -> PathBuf {
    const NEED: &str = "The tests need Fast DDS 2 for C++: install libfastrtps-dev (Debian, Ubuntu), or run `apt-get \
                        update` as root so that the tests can fetch it themselves";
    let (debs, root) = (folder.join("debs"), folder.join("root"));
    for new in [&debs, &root] {
        fs::create_dir_all(new).unwrap_or_else(|e| panic!("{} cannot be made: {e}", new.display()));
    }
    // Missing or outdated package lists are updated if that is permitted.
    let fetched = fetch(&debs).or_else(|_| {
        if rustix::process::geteuid().is_root() {
            drop(run(Command::new("apt-get").args(["update", "-qq"])));
        }
        fetch(&debs)
    });
    require(fetched, NEED);
    for deb in fs::read_dir(&debs).expect("the folder was just made") {
        let deb = deb.expect("the folder was just made").path();
        require(run(Command::new("dpkg").arg("-x").arg(deb).arg(&root)), NEED);
    }
    root
}

/// Downloads the packages that an installation of libfastrtps-dev would add to this system.
fn fetch(debs: &Path) -> Result<String, String> {
    let plan = run(Command::new("apt-get").args(["install", "-s", "--no-install-recommends", "libfastrtps-dev"]))?;
    let names: Vec<_> = plan.lines().filter_map(|l| l.strip_prefix("Inst ")?.split_whitespace().next()).collect();
    run(Command::new("apt-get").arg("download").args(names).current_dir(debs))
}

/// Returns the standard output of a successful command, or its error.
fn run(command: &mut Command) -> Result<String, String> {
    // The output of the tools is parsed and shown in one language.
    match command.env("LC_ALL", "C").output() {
        Ok(Output { status, stdout, .. }) if status.success() => Ok(String::from_utf8_lossy(&stdout).into_owned()),
        Ok(Output { status, stderr, .. }) => {
            Err(format!("{} ended with {status}: {}", name(command), String::from_utf8_lossy(&stderr).trim()))
        }
        Err(e) => Err(format!("{}: {e}", name(command))),
    }
}

fn name(command: &Command) -> String {
    command.get_program().to_string_lossy().into_owned()
}

/// Panics with the remedy, followed by the error.
fn require(result: Result<String, String>, sentence: &str) -> String {
    result.unwrap_or_else(|e| panic!("{sentence}. {e}"))
}
