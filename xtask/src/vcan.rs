//! A virtual CAN bus for tests: in the running kernel, or, where that has no CAN, in a kernel booted as a program
//! (user-mode Linux) on the files of this machine. The tests run in two such kernels beside each other: each has one
//! processor, a bus of its own and a folder of its own for what its tests write. Those against a drive in Python come
//! after them, in one kernel.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{fs, thread};

use anyhow::{Context, Result, anyhow, bail};

use crate::{canopen, run, setup};

/// The interface that all tests use.
pub const INTERFACE: &str = "vcan0";

/// Printed around the output of the commands inside, to tell it from the kernel's messages.
const BEGIN: &str = "-- inside: begin";
const END: &str = "-- inside: end";

/// Names of tests against a drive in Python, in real time, begin like this. A second kernel would take the processor that
/// they need: such a drive then answers too late.
const ALONE: &str = "python::";
/// The longest of the other tests, and how many seconds they took in full volume; and what the rest takes, each.
const LONG: [(&str, u32); 4] = [
    (
        "by_hand::whoever_jogs_is_killed_and_the_axis_rests_in_time_and_stays",
        165,
    ),
    ("killed::in_a_tap_the_hole_is_finished", 102),
    ("hour::the_first_hour_is_the_same_on_the_bus", 101),
    ("killed::in_a_push_the_old_set_counts_or_the_new_one", 37),
];
const SHORT: u32 = 9;

/// The time limit inside, in seconds: more than five times as long as the tests of one kernel take.
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
    match place() {
        Place::Here => {
            let mut here = run::command(&run::root(), "sh", &["-c", script]);
            here.env("TERMINAL", terminal.unwrap_or_default());
            run::watch(here, seen)
        }
        Place::Booted => booted(name, script, terminal, &registers()?, |line| {
            println!("{line}");
            seen(line);
        }),
    }
}

/// Runs a script in a kernel booted for it. Nothing is shown here, but its lines are passed to `seen`. Kernels with
/// different names do not disturb each other.
fn booted(
    name: &str,
    script: &str,
    terminal: Option<&str>,
    registers: &Path,
    mut seen: impl FnMut(&str),
) -> Result<bool> {
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
    // The numbers of processes are the same in every kernel that is booted, and tests name their files by them. The
    // paths of sockets are short, so the folder is not below the workspace.
    let temporary = std::env::temp_dir().join(format!("leadscrew-{name}-{}", std::process::id()));
    fs::create_dir_all(&temporary)
        .with_context(|| format!("cannot make {}", temporary.display()))?;
    write_script(&init, &boot(&run::root(), script, &status, &temporary)?)?;
    let mut inside = false;
    let command = kernel(&init, terminal, registers);
    run::each_line(command, |line| match line.trim_end() {
        BEGIN => inside = true,
        END => inside = false,
        line if inside => seen(line),
        _ => {}
    })?;
    let code = fs::read_to_string(&status).map_err(|_| {
        anyhow!(
            "the kernel with CAN ended without a result (limit {LIMIT} s); its script is {}",
            init.display()
        )
    })?;
    let passed = code.trim() == "0";
    // What a failed test has written may tell why.
    if passed {
        fs::remove_dir_all(&temporary)
            .with_context(|| format!("cannot remove {}", temporary.display()))?;
    }
    Ok(passed)
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
fn boot(root: &Path, script: &str, status: &Path, temporary: &Path) -> Result<String> {
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
         export TMPDIR='{}'\n\
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
        temporary.display(),
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

/// Builds the tests that need a bus, and the programs that they start, and runs them where the bus is. The tests of a
/// bus run one at a time. Where kernels are booted for them and there are two processors, there are two buses.
pub fn tests(filter: &str, mut seen: impl FnMut(&str)) -> Result<bool> {
    setup::tools(setup::CAN)?;
    let leadscrew = run::programs(&["--bin", "leadscrew", "--bin", "board-sim"])?.join("leadscrew");
    let program = run::test_program("vcan")?;
    let (python, eds) = (canopen::python()?, canopen::sheet(&leadscrew)?);
    let program = program.display().to_string();
    let script = |which: &str| {
        format!(
            "CANOPEN_PYTHON='{}' CANOPEN_EDS='{}' '{program}' --test-threads=1 --color=never {which}",
            python.display(),
            eds.display(),
        )
    };
    println!("{}", place().name());
    let list = run::read(run::command(&run::root(), &program, &["--list", filter]))?;
    let names: Vec<&str> = run::listed(&list).collect();
    if let Some((gone, _)) = LONG.iter().find(|(name, _)| !names.contains(name))
        && filter.is_empty()
    {
        bail!(
            "there is no test {gone} any more: renew the table of long tests in xtask/src/vcan.rs"
        );
    }
    let (alone, others): (Vec<&str>, Vec<&str>) =
        names.iter().partition(|name| name.starts_with(ALONE));
    let cores = thread::available_parallelism()?.get();
    if place() == Place::Here || cores < 2 || others.len() < 2 {
        return run("tests", &script(filter), seen);
    }
    let exact = |names: &[&str]| script(&format!("--exact {}", names.join(" ")));
    let registers = registers()?;
    let [first, second] = halves(&others).map(|half| exact(&half));
    let beside = thread::scope(|scope| {
        let second = scope.spawn(|| {
            let mut lines = Vec::new();
            let passed = booted("tests-2", &second, None, &registers, |line| {
                lines.push(line.to_owned());
            });
            (passed, lines)
        });
        let mut show = |line: &str| {
            println!("{line}");
            seen(line);
        };
        let first = booted("tests-1", &first, None, &registers, &mut show);
        let (second, lines) = second
            .join()
            .map_err(|_| anyhow!("the thread of the second kernel has panicked"))?;
        println!("\nin the second kernel, beside the first");
        lines.iter().for_each(|line| show(line));
        Ok::<_, anyhow::Error>(first? & second?)
    })?;
    if alone.is_empty() {
        return Ok(beside);
    }
    println!("\nin a kernel alone");
    Ok(run("tests-3", &exact(&alone), seen)? & beside)
}

/// The tests of two kernels that take about as long as each other: the longest first, each where less is to be done.
fn halves<'a>(names: &[&'a str]) -> [Vec<&'a str>; 2] {
    let seconds = |name: &str| {
        let long = LONG.iter().find(|(long, _)| *long == name);
        long.map_or(SHORT, |(_, seconds)| *seconds)
    };
    let mut names = names.to_vec();
    names.sort_by_key(|name| std::cmp::Reverse(seconds(name)));
    let (mut halves, mut whole) = ([Vec::new(), Vec::new()], [0, 0]);
    for name in names {
        let less = usize::from(whole[1] < whole[0]);
        halves[less].push(name);
        whole[less] += seconds(name);
    }
    halves
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_test_is_in_one_half_and_halves_take_alike_long() {
        let mut names: Vec<String> = (0..54)
            .map(|number| format!("short::{number:02}"))
            .collect();
        names.extend(LONG.iter().map(|(name, _)| String::from(*name)));
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let [first, second] = halves(&names);
        let mut all = [first.clone(), second.clone()].concat();
        all.sort_unstable();
        let mut expected = names.clone();
        expected.sort_unstable();
        assert_eq!(all, expected);
        // 165 s and 37 s against 102 s and 101 s.
        let long = |half: &[&str]| LONG.map(|(name, _)| half.contains(&name));
        assert_eq!(long(&first), [true, false, false, true]);
        assert_eq!(long(&second), [false, true, true, false]);
        assert_eq!(halves(&names), [first, second]);
        assert_eq!(halves(&["a"]), [vec!["a"], vec![]]);
    }
}
