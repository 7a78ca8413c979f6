//! The tools that the commands need from the machine. Installs them where possible, and otherwise names them.

use std::path::Path;
use std::time::Duration;

use anyhow::{Context, Result, bail};

use crate::{axe, canopen, run, shop, target, wasm};

/// The number of tries for a package lock, and the time between them: five minutes in all, as long as an upgrade may take.
const TRIES: u32 = 60;
const BETWEEN_TRIES: Duration = Duration::from_secs(5);

/// A program and its Debian package.
pub struct Tool {
    pub program: &'static str,
    pub package: &'static str,
}

/// Runs the Cortex-M4F images.
pub const EMULATOR: Tool = Tool {
    program: "qemu-system-arm",
    package: "qemu-system-arm",
};
/// Opens the page.
pub const BROWSER: Tool = Tool {
    program: "chromium",
    package: "chromium",
};
/// Installs what looks for faults of pages.
pub const NPM: Tool = Tool {
    program: "npm",
    package: "npm",
};
/// Counts instructions on the host.
pub const VALGRIND: Tool = Tool {
    program: "valgrind",
    package: "valgrind",
};

/// A virtual CAN bus and the programs that test with it. Where the running kernel has no CAN, a kernel with CAN is
/// booted as a program.
pub const CAN: &[Tool] = &[
    Tool {
        program: "linux.uml",
        package: "user-mode-linux",
    },
    Tool {
        program: "insmod",
        package: "kmod",
    },
    Tool {
        program: "ip",
        package: "iproute2",
    },
    Tool {
        program: "candump",
        package: "can-utils",
    },
    Tool {
        program: "strace",
        package: "strace",
    },
];

/// Installs the tools of all commands. Fast where they are already there.
pub fn everything() -> Result<()> {
    tools(&[VALGRIND])?;
    for_test(true)
}

/// Installs the tools of `cargo xtask test`, with `--full` or without.
pub fn for_test(full: bool) -> Result<()> {
    if full {
        tools(&[EMULATOR])?;
        tools(CAN)?;
        tools(&[BROWSER])?;
        axe::ensure()?;
        shop::ensure()?;
        wasm::ensure()?;
    }
    canopen::python()?;
    target::ensure()
}

/// Installs the packages of missing programs. Without the right to install, it says what to type.
pub fn tools(wanted: &[Tool]) -> Result<()> {
    let missing = || -> Vec<&str> {
        wanted
            .iter()
            .filter(|tool| !run::have(tool.program))
            .map(|tool| tool.package)
            .collect()
    };
    let packages = missing();
    if packages.is_empty() {
        return Ok(());
    }
    install(&packages)?;
    let still = missing();
    if still.is_empty() {
        Ok(())
    } else {
        bail!("installed, and still not on the path: {}", still.join(", "))
    }
}

/// Installs packages. Without the right to install, it says what to type.
pub fn install(packages: &[&str]) -> Result<()> {
    let line = format!(
        "apt-get update && apt-get install -y --no-install-recommends {}",
        packages.join(" ")
    );
    if !run::have("apt-get") {
        bail!(
            "not installed: {}; this is not Debian, so install them its own way",
            packages.join(", ")
        );
    }
    if !run::is_root() {
        bail!(
            "not installed: {}; type this, then start again:\n\n    sudo sh -c '{line}'\n",
            packages.join(", ")
        );
    }
    println!("installing {}", packages.join(", "));
    let install = || {
        let mut install = run::command(Path::new("/"), "sh", &["-c", &line]);
        // `is_locked` reads the messages, so they must be English.
        install.envs([("DEBIAN_FRONTEND", "noninteractive"), ("LC_ALL", "C")]);
        run::read(install)
    };
    patient(install, || {
        println!("another program holds the package lock: waiting");
        std::thread::sleep(BETWEEN_TRIES);
    })
    .with_context(|| {
        format!("the packages did not install; see that the package mirror is reachable, then type: {line}")
    })
}

/// Tries again while another program holds one of apt's or dpkg's locks, at most [`TRIES`] times.
fn patient(mut install: impl FnMut() -> Result<String>, mut wait: impl FnMut()) -> Result<()> {
    let mut tries = TRIES;
    loop {
        let Err(error) = install() else { return Ok(()) };
        tries -= 1;
        if tries == 0 || !is_locked(&format!("{error:#}")) {
            return Err(error);
        }
        wait();
    }
}

/// True where apt reports that another program holds the lists or the packages.
fn is_locked(told: &str) -> bool {
    [
        "Could not get lock",
        "Unable to acquire the dpkg frontend lock",
        "Unable to lock directory",
    ]
    .iter()
    .any(|words| told.contains(words))
}

#[cfg(test)]
mod tests {
    use anyhow::anyhow;

    use super::*;

    #[test]
    fn a_package_lock_is_waited_for_and_nothing_else_is() {
        let locked = || {
            Err(anyhow!(
                "E: Could not get lock /var/lib/dpkg/lock-frontend. It is held by process 1 (apt)"
            ))
        };
        let (mut tries, mut waits) = (0, 0);
        let third = || {
            tries += 1;
            if tries < 3 {
                locked()
            } else {
                Ok(String::new())
            }
        };
        assert!(patient(third, || waits += 1).is_ok());
        assert_eq!((tries, waits), (3, 2));

        let mut tries = 0;
        let never = || {
            tries += 1;
            locked()
        };
        assert!(patient(never, || {}).is_err());
        assert_eq!(tries, TRIES);

        let mut tries = 0;
        let missing = || {
            tries += 1;
            Err(anyhow!("E: Unable to locate package no-such-thing"))
        };
        assert!(patient(missing, || {}).is_err());
        assert_eq!(tries, 1);
    }
}
