//! A virtual CAN bus for tests: in the running kernel, or, where that has no CAN, in a kernel booted as a program
//! (user-mode Linux) on the files of this machine.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, bail};

use crate::{canopen, run, setup};

/// The interface that all tests use.
pub const INTERFACE: &str = "vcan0";

/// Printed around the output of the commands inside, to tell it from the kernel's messages.
const BEGIN: &str = "-- inside: begin";
const END: &str = "-- inside: end";

/// The time limit inside, in seconds: five times as long as the tests take.
const LIMIT: &str = "3000";
/// Frames that the kernel keeps between a sender on its virtual interface and the receivers. The usual limit is a
/// thousand; frames above it are lost without a report. A sender may run for the ten milliseconds of a timer tick
/// before the kernel processes its frames.
const BACKLOG: &str = "1000000";

/// The kernel with the bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// The running kernel.
    Here,
    /// A kernel booted for the bus.
    Booted,
}

impl Place {
    /// The place in words.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Here => "on this kernel's vcan0",
            Self::Booted => "on vcan0 of a kernel booted as a program",
        }
    }
}

/// Finds the place of the bus. Makes the interface in the running kernel where this is possible.
pub fn place() -> Place {
    let there = || Path::new("/sys/class/net").join(INTERFACE).is_dir();
    if !there() && run::is_root() {
        let quietly = |program: &str, args: &[&str]| {
            // A failure here is an answer too.
            let _ = run::read(run::command(Path::new("/"), program, args));
        };
        quietly("modprobe", &["--all", "vcan", "slcan"]);
        quietly("ip", &["link", "add", "dev", INTERFACE, "type", "vcan"]);
        quietly("ip", &["link", "set", INTERFACE, "mtu", "72", "up"]);
    }
    if there() { Place::Here } else { Place::Booted }
}

/// Runs a shell script where the bus is, in the folder of the workspace. Shows its lines and passes them to `seen`.
/// True where the script succeeded.
pub fn run(name: &str, script: &str, seen: impl FnMut(&str)) -> Result<bool> {
    run_with(name, script, None, seen)
}

/// The same with this terminal as a serial line of the machine; the script finds it as `$TERMINAL`.
pub fn run_with(
    name: &str,
    script: &str,
    terminal: Option<&str>,
    mut seen: impl FnMut(&str),
) -> Result<bool> {
    setup::tools(setup::CAN)?;
    let root = run::root();
    match place() {
        Place::Here => {
            let mut here = run::command(&root, "sh", &["-c", script]);
            here.env("TERMINAL", terminal.unwrap_or_default());
            run::watch(here, seen)
        }
        Place::Booted => {
            let dir = run::scratch("vcan")?;
            let status = dir.join(format!("{name}.status"));
            let init = dir.join(format!("{name}.init"));
            // The status of an earlier run would be taken for this run's.
            match fs::remove_file(&status) {
                Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                    return Err(error).context("the status of the last run cannot be removed");
                }
                _ => {}
            }
            write_script(&init, &boot(&root, script, &status)?)?;
            let mut inside = false;
            let command = kernel(&init, terminal, &registers()?);
            run::watch_some(command, |line| match line.trim_end() {
                BEGIN => {
                    inside = true;
                    false
                }
                END => {
                    inside = false;
                    false
                }
                line if inside => {
                    seen(line);
                    true
                }
                _ => false,
            })?;
            let code = fs::read_to_string(&status).map_err(|_| {
                anyhow!(
                    "the kernel with CAN ended without a result (limit {LIMIT} s); its script is {}",
                    init.display()
                )
            })?;
            Ok(code.trim() == "0")
        }
    }
}

/// A library that lets the kernel start on processors whose registers are larger than the kernel expects.
fn registers() -> Result<PathBuf> {
    let root = run::root();
    run::show(run::cargo(
        &root,
        &["build", "--quiet", "-p", "leadscrew-regset"],
    ))?;
    Ok(root.join("target/debug/libleadscrew_regset.so"))
}

fn kernel(init: &Path, terminal: Option<&str>, registers: &Path) -> std::process::Command {
    let init = format!("init={}", init.display());
    let mut command = run::command(
        &run::root(),
        "timeout",
        &[
            "--kill-after=5",
            LIMIT,
            "linux.uml",
            "mem=1024M",
            "rootfstype=hostfs",
            "root=/dev/root",
            "rootflags=/",
            "rw",
            &init,
            "con=null",
            "con0=fd:0,fd:1",
            "ssl=null",
            "quiet",
        ],
    );
    command.env("LD_PRELOAD", registers);
    if let Some(terminal) = terminal {
        command.arg(format!("ssl0=tty:{terminal}"));
    }
    command
}

/// The first program of the booted kernel.
fn boot(root: &Path, script: &str, status: &Path) -> Result<String> {
    let modules = modules()?;
    let mut text = String::from(
        "#!/bin/sh\n\
         mount -t proc proc /proc\n\
         mount -t sysfs sys /sys\n\
         mount -t tmpfs tmpfs /run\n",
    );
    // Writing to a string cannot fail.
    for module in modules {
        let _ = writeln!(text, "insmod {}", module.display());
    }
    let path = std::env::var("PATH").unwrap_or_default();
    // The booted kernel has none of the variables of this machine.
    let settings = leadscrew_seed::settings(leadscrew_seed::fresh(), leadscrew_seed::full());
    let _ = write!(
        text,
        "export PATH='{path}:/usr/sbin:/usr/bin:/sbin:/bin' LEADSCREW_BOOTED=1 TERMINAL=/dev/ttyS0 {settings}\n\
         echo {BACKLOG} > /proc/sys/net/core/netdev_max_backlog\n\
         ip link set lo up\n\
         ip link add dev {INTERFACE} type vcan && ip link set {INTERFACE} mtu 72 up\n\
         cd '{}'\n\
         echo '{BEGIN}'\n\
         ( {script}\n) 2>&1\n\
         echo $? > '{}'\n\
         echo '{END}'\n\
         sync\n\
         halt -f -p\n",
        root.display(),
        status.display()
    );
    Ok(text)
}

/// The modules, each after those that it needs.
fn modules() -> Result<Vec<PathBuf>> {
    let all = Path::new("/usr/lib/uml/modules");
    let mut found = Vec::new();
    for name in [
        "can", "can-raw", "can-bcm", "can-gw", "can-dev", "vcan", "slcan",
    ] {
        let file = run::read(run::command(
            all,
            "find",
            &[".", "-name", &format!("{name}.ko")],
        ))?;
        match file.lines().next() {
            Some(file) => found.push(all.join(file.trim_start_matches("./"))),
            None => bail!("the package user-mode-linux has no module {name}.ko any more"),
        }
    }
    Ok(found)
}

fn write_script(path: &Path, text: &str) -> Result<()> {
    use std::os::unix::fs::PermissionsExt as _;
    fs::write(path, text).with_context(|| format!("cannot write {}", path.display()))?;
    fs::set_permissions(path, fs::Permissions::from_mode(0o755))?;
    Ok(())
}

/// Builds the tests that need a bus, and the programs that they start, and runs them where the bus is.
pub fn tests(filter: &str, seen: impl FnMut(&str)) -> Result<bool> {
    let leadscrew = run::programs(&["--bin", "leadscrew", "--bin", "board-sim"])?.join("leadscrew");
    let program = run::test_program("vcan")?;
    let (python, eds) = (canopen::python()?, canopen::sheet(&leadscrew)?);
    println!("{}", place().name());
    // The tests share one bus, so they run one at a time.
    run(
        "tests",
        &format!(
            "CANOPEN_PYTHON='{}' CANOPEN_EDS='{}' '{}' --test-threads=1 --color=never {filter}",
            python.display(),
            eds.display(),
            program.display()
        ),
        seen,
    )
}
