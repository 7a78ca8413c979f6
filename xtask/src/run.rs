//! Starts other programs. Where one fails, the error names it and gives its output.

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};

/// The folder of the workspace.
pub fn root() -> PathBuf {
    let mut path = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    path.pop();
    path
}

/// The workspace of the board images.
pub fn firmware() -> PathBuf {
    root().join("firmware")
}

/// `program` with `args`, run in `dir`.
pub fn command(dir: &Path, program: &str, args: &[&str]) -> Command {
    let mut command = Command::new(program);
    command.args(args).current_dir(dir);
    command
}

/// Cargo, run in `dir` (whose `.cargo/config.toml` then counts).
pub fn cargo(dir: &Path, args: &[&str]) -> Command {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".into());
    let mut command = command(dir, &cargo, args);
    seed(&mut command);
    // The variables that cargo set for this program must not be taken for settings of the inner build.
    for (name, _) in std::env::vars() {
        if name.starts_with("CARGO_PKG_") || name.starts_with("CARGO_MANIFEST_") {
            command.env_remove(name);
        }
    }
    command
}

/// Gives a command the seed of this run: one run has one seed, even where a commit is made meanwhile.
pub fn seed(command: &mut Command) {
    command.env(
        leadscrew_seed::VARIABLE,
        leadscrew_seed::fresh().to_string(),
    );
}

/// What this thread starts from now on takes the processors only while others do not want them: tests that wait for
/// machines in real time beside it then find a quiet computer.
pub fn give_way() {
    // Where this is refused, the others have to share.
    let _ = rustix::process::nice(10);
}

/// What cargo selects from: the whole workspace, with the features of all tests. Every step builds with the same selection,
/// because a library is built again where another selection gives it other features.
pub const WHOLE: [&str; 3] = [
    "--workspace",
    "--features",
    "leadscrew-tests/vcan,leadscrew-tests/emulated,leadscrew-web/browser,leadscrew/browser",
];

/// An example that is quickly built: beside a target of this kind cargo selects the features as for tests.
const AS_FOR_TESTS: [&str; 2] = ["--example", "tick"];

/// Builds programs of the workspace, given as `--bin` or `--example`; gives their folder.
pub fn programs(which: &[&str]) -> Result<PathBuf> {
    let build = ["build", "--quiet"];
    let args = [&build[..], &WHOLE, &AS_FOR_TESTS, which].concat();
    show(cargo(&root(), &args))?;
    Ok(root().join("target").join("debug"))
}

/// Builds the tests with this name; gives the path of the program.
pub fn test_program(name: &str) -> Result<PathBuf> {
    built_tests(&["--quiet", "--test", name])?
        .iter()
        .find(|message| message["target"]["name"] == name && message["executable"].is_string())
        .and_then(|message| message["executable"].as_str().map(PathBuf::from))
        .with_context(|| format!("cargo named no program of the tests `{name}`"))
}

/// Builds tests of the workspace; gives what cargo tells of each part.
pub fn built_tests(which: &[&str]) -> Result<Vec<serde_json::Value>> {
    let build = ["test", "--no-run"];
    let told = ["--message-format", "json-render-diagnostics"];
    let args = [&build[..], &WHOLE, &told, which].concat();
    let told = answer(cargo(&root(), &args))?;
    let messages = told.lines().map(serde_json::from_str);
    messages
        .collect::<Result<_, _>>()
        .context("cargo told what is not JSON")
}

/// What cargo says of a workspace. The lock file stays as it is.
pub fn metadata(workspace: &Path, more: &[&str]) -> Result<serde_json::Value> {
    let ask = ["metadata", "--locked", "--format-version", "1"];
    let text = read(cargo(workspace, &[&ask[..], more].concat()))?;
    serde_json::from_str(&text).context("cargo metadata is not JSON")
}

/// The tests in what a program of tests prints for `--list`.
pub fn listed(list: &str) -> impl Iterator<Item = &str> {
    list.lines().filter_map(|line| line.strip_suffix(": test"))
}

fn line_of(command: &Command) -> String {
    let program = Path::new(command.get_program());
    let mut line = program
        .file_name()
        .unwrap_or(program.as_os_str())
        .to_string_lossy()
        .into_owned();
    for arg in command.get_args() {
        line.push(' ');
        line.push_str(&arg.to_string_lossy());
    }
    line
}

/// Runs a command to its end and shows its output.
pub fn show(mut command: Command) -> Result<()> {
    let line = line_of(&command);
    let status = command
        .status()
        .with_context(|| format!("cannot start `{line}`"))?;
    if !status.success() {
        bail!("`{line}` failed ({status})");
    }
    Ok(())
}

/// Runs a command to its end and keeps its output; shows it only where the command fails.
pub fn read(command: Command) -> Result<String> {
    let line = line_of(&command);
    let output = output(command)?;
    String::from_utf8(output.stdout).with_context(|| format!("`{line}` printed what is not UTF-8"))
}

/// The same of what it says beside its output, as cargo does.
pub fn told(command: Command) -> Result<String> {
    let output = output(command)?;
    Ok(String::from_utf8_lossy(&output.stderr).into_owned())
}

/// Runs a command to its end and keeps its output. What it says beside its output is shown at once.
pub fn answer(mut command: Command) -> Result<String> {
    let line = line_of(&command);
    let output = command
        .stdin(Stdio::null())
        .stderr(Stdio::inherit())
        .output()
        .with_context(|| format!("cannot start `{line}`"))?;
    if !output.status.success() {
        bail!("`{line}` failed ({})", output.status);
    }
    String::from_utf8(output.stdout).with_context(|| format!("`{line}` printed what is not UTF-8"))
}

fn output(mut command: Command) -> Result<Output> {
    let line = line_of(&command);
    let output = command
        .stdin(Stdio::null())
        .output()
        .with_context(|| format!("cannot start `{line}`"))?;
    if !output.status.success() {
        bail!(
            "`{line}` failed ({})\n{}{}",
            output.status,
            String::from_utf8_lossy(&output.stdout),
            String::from_utf8_lossy(&output.stderr)
        );
    }
    Ok(output)
}

/// Runs a command to its end, shows its standard output line by line and passes each line to `seen`. True where the
/// command succeeded.
pub fn watch(mut command: Command, mut seen: impl FnMut(&str)) -> Result<bool> {
    let line = line_of(&command);
    let mut child = command
        .stdout(Stdio::piped())
        .spawn()
        .with_context(|| format!("cannot start `{line}`"))?;
    if let Some(stdout) = child.stdout.take() {
        for text in BufReader::new(stdout).lines() {
            let text = text?;
            println!("{text}");
            seen(&text);
        }
    }
    Ok(child.wait()?.success())
}

/// As [`watch`], but shows nothing. Succeeds where the command ended.
pub fn each_line(mut command: Command, mut seen: impl FnMut(&str)) -> Result<()> {
    let line = line_of(&command);
    let mut child = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .with_context(|| format!("cannot start `{line}`"))?;
    if let Some(mut stdout) = child.stdout.take().map(BufReader::new) {
        let mut bytes = Vec::new();
        // A kernel's messages need not be text.
        while stdout.read_until(b'\n', &mut bytes)? > 0 {
            let text = String::from_utf8_lossy(&bytes);
            seen(text.trim_end_matches(['\r', '\n']));
            bytes.clear();
        }
    }
    child.wait()?;
    Ok(())
}

/// Runs a command for at most `limit` and shows nothing. True where it succeeded in time.
pub fn try_quietly(mut command: Command, limit: Duration) -> bool {
    let started = Instant::now();
    let child = command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn();
    let Ok(mut child) = child else { return false };
    loop {
        match child.try_wait() {
            Ok(Some(status)) => return status.success(),
            Ok(None) if started.elapsed() < limit => std::thread::sleep(Duration::from_millis(50)),
            _ => {
                // It has ended by itself or is ended here; in both cases it did not succeed in time.
                let _ = child.kill();
                let _ = child.wait();
                return false;
            }
        }
    }
}

/// True where a program of this name is on the path.
pub fn have(program: &str) -> bool {
    std::env::var_os("PATH")
        .is_some_and(|path| std::env::split_paths(&path).any(|dir| dir.join(program).is_file()))
}

/// True where this process may install packages.
pub fn is_root() -> bool {
    read(command(Path::new("/"), "id", &["-u"])).is_ok_and(|id| id.trim() == "0")
}

/// A folder for downloads and scratch images, below the build folder.
pub fn scratch(name: &str) -> Result<PathBuf> {
    let dir = root().join("target").join("xtask").join(name);
    std::fs::create_dir_all(&dir).with_context(|| format!("cannot make {}", dir.display()))?;
    Ok(dir)
}
