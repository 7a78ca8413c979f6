//! The board on the emulated Cortex-M4F, driven by `leadscrew`: over its serial line, and over a kernel interface on
//! that line.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Child, Stdio};

use anyhow::{Context, Result};

use crate::{emulator, run, target, vcan};

/// The variables that give the tests the image, and the image with messages.
const IMAGE: &str = "LEADSCREW_IMAGE";
const WITH_MESSAGES: &str = "LEADSCREW_IMAGE_DEFMT";
/// The names of tests that need a kernel with CAN begin like this.
const IN_KERNEL: &str = "kernel::";

/// Builds the images (one in which failures can be provoked, one with messages) and the tests, and runs the tests.
/// Passes each printed line to `seen`. True where the tests passed.
pub fn tests(filter: &str, mut seen: impl FnMut(&str)) -> Result<bool> {
    let root = run::root();
    let built = target::build("mps2-an386", "mps2-bus", &["--features", "provoke"])?;
    let scratch = run::scratch("emulated")?;
    let image = scratch.join("mps2-bus");
    // The next image is built in the same place.
    std::fs::copy(built, &image)?;
    let with_messages = target::build("mps2-an386", "mps2-bus", &["--features", "defmt"])?;
    run::programs(&["--bin", "leadscrew"])?;
    let program = run::test_program("emulated")?;
    let program = program.to_string_lossy();
    let list = run::read(run::command(&root, &program, &["--list", filter]))?;
    let (inside, outside): (Vec<&str>, Vec<&str>) =
        run::listed(&list).partition(|name| name.starts_with(IN_KERNEL));
    let mut passed = true;
    if !outside.is_empty() {
        let args = [&["--color=never", "--exact"], &outside[..]].concat();
        let mut here = run::command(&root, &program, &args);
        here.env(IMAGE, &image).env(WITH_MESSAGES, with_messages);
        passed &= run::watch(here, &mut seen)?;
    }
    for name in inside {
        let board = OnTerminal::start(&image)?;
        println!("{}", vcan::place().name());
        let script =
            format!("LEADSCREW_TERMINAL=$TERMINAL '{program}' --color=never --exact {name}");
        passed &= vcan::run_with("emulated", &script, Some(&board.terminal), &mut seen)?;
    }
    Ok(passed)
}

/// A board on a terminal. It is emulated until this value is dropped.
struct OnTerminal {
    emulator: Child,
    terminal: String,
}

impl OnTerminal {
    fn start(image: &Path) -> Result<Self> {
        let image = image.to_string_lossy();
        let semihosting = format!("enable=on,target=native,arg={image}");
        let mut args = emulator::machine("pty", &semihosting).to_vec();
        args.extend(["-kernel", &image]);
        let mut emulator = run::command(&run::root(), emulator::EMULATOR, &args)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn()
            .context("cannot start `qemu-system-arm`")?;
        // The emulator first prints the name of the terminal.
        let mut line = String::new();
        let said = match emulator.stdout.take() {
            Some(stdout) => first_line(stdout, &mut line),
            None => Ok(0),
        };
        let mut board = Self {
            emulator,
            terminal: String::new(),
        };
        said?;
        board.terminal = terminal(&line)
            .with_context(|| format!("the emulator has made no terminal: {line}"))?
            .to_owned();
        Ok(board)
    }
}

impl Drop for OnTerminal {
    fn drop(&mut self) {
        // An emulator that has ended by itself is gone already.
        let _ = self.emulator.kill();
        let _ = self.emulator.wait();
    }
}

/// Reads one line. A thread discards the rest: a full pipe would stop the emulator.
fn first_line(stdout: impl Read + Send + 'static, line: &mut String) -> std::io::Result<usize> {
    let mut stdout = BufReader::new(stdout);
    let said = stdout.read_line(line);
    // The thread ends with the emulator; an error means that there is nothing left to read.
    std::thread::spawn(move || std::io::copy(&mut stdout, &mut std::io::sink()));
    said
}

/// The terminal in a line of the emulator: `char device redirected to /dev/pts/0 (label serial0)`.
fn terminal(line: &str) -> Option<&str> {
    let (_, place) = line.split_once("redirected to ")?;
    place.split_whitespace().next()
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    #[test]
    fn what_comes_behind_the_first_line_stops_nobody() {
        let (stdout, mut emulator) = std::io::pipe().unwrap();
        let mut line = String::new();
        emulator.write_all(b"first\n").unwrap();
        assert_eq!(first_line(stdout, &mut line).unwrap(), 6);
        assert_eq!(line, "first\n");
        // Far more than a pipe holds.
        emulator.write_all(&vec![b'.'; 1 << 20]).unwrap();
    }

    #[test]
    fn tests_and_terminals_are_told_from_the_words_around_them() {
        let list = "kernel::a: test\nrun::b: test\n\n2 tests, 0 benchmarks\n";
        let line = "char device redirected to /dev/pts/7 (label serial0)\n";
        assert_eq!(terminal(line), Some("/dev/pts/7"));
        assert_eq!(terminal("no room\n"), None);
        assert_eq!(
            run::listed(list).collect::<Vec<_>>(),
            ["kernel::a", "run::b"]
        );
    }
}
