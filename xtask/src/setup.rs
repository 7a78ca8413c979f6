//! What the commands need from the machine, installed where that is possible and named where it is not.

use std::path::Path;

use anyhow::{Context, Result, bail};

use crate::{canopen, run, target};

/// A program and the Debian package it comes in.
pub struct Tool {
    pub program: &'static str,
    pub package: &'static str,
}

/// Runs the Cortex-M4F images.
pub const EMULATOR: Tool = Tool {
    program: "qemu-system-arm",
    package: "qemu-system-arm",
};
/// Counts instructions on the host.
pub const VALGRIND: Tool = Tool {
    program: "valgrind",
    package: "valgrind",
};

/// A virtual CAN bus and the programs that judge it. Where the running kernel has no CAN, a kernel that has it is booted
/// as a program.
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

/// All that any command needs. Quick where it is already there.
pub fn everything() -> Result<()> {
    tools(&[EMULATOR, VALGRIND])?;
    tools(CAN)?;
    canopen::python()?;
    target::ensure()
}

/// Installs the packages of the programs that are missing; without the right to, says what to type.
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

/// Installs packages; without the right to, says what to type.
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
    let mut install = run::command(Path::new("/"), "sh", &["-c", &line]);
    install.env("DEBIAN_FRONTEND", "noninteractive");
    run::read(install).with_context(|| {
        format!("the packages did not install; see that the package mirror is reachable, then type: {line}")
    })?;
    Ok(())
}
