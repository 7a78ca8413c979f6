//! A page of the documentation as it is typed: its commands one after the other into one shell, and what the page shows of
//! each. And what belongs to an hour at a machine and is on no page.
//!
//! A `console` block has commands after `$ ` and, below each, what it prints on either output; `...` stands for what the
//! page leaves out. It must not know what the commands are about, nor on which machine they are typed.

use std::io::{BufRead as _, BufReader, Write as _};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};

/// Where the finished shaft of `docs/first-hour.md` begins, and before it [`MORE`] is typed.
pub const SHAFT: &str = "## The finished shaft\n";

/// A program by handwheel, and a door that is opened.
pub const MORE: &str = r#"
```console
$ printf 'G98 G1 W-10 F3000\nM30\n' > wheel.nc
$ timeout 250 leadscrew run wheel.nc --handwheel > wheel.txt 2>&1 &
$ leadscrew status
node 1   running, line 1, move ...   mode automatic
...
$ leadscrew handwheel path x100 20
node 1: the wheel was turned by 20 counts
$ leadscrew status
node 1   running, line 1, move ...   mode automatic
...
$ for turn in $(seq 60); do grep -q ': done:' wheel.txt && break; leadscrew handwheel path x100 20; done > told 2>&1
$ wait $!; echo $?
0
$ leadscrew status
node 1   idle   mode automatic
X 0  Z -10  C 0   (machine coordinates, X a diameter)
...
$ printf 'M3 S600\nG98 G1 W-30 F60\nM30\n' > door.nc
$ timeout 250 leadscrew run door.nc > door.txt 2>&1 &
$ leadscrew status
node 1   running, line 2, move ...   mode automatic
...
$ leadscrew sim door open
...
power on, door open, emergency stop released, feed hold released
...
$ leadscrew status
node 1   feed hold, line 2, move ...   mode automatic
...
$ leadscrew resume
error: ...4506 ...door...
$ leadscrew sim door close
...
power on, door closed, emergency stop released, feed hold released
...
$ leadscrew status
node 1   feed hold, line 2, move ...   mode automatic
...
inputs on: 1; outputs on: none
$ leadscrew resume
node 1: ..., line 2
$ leadscrew status
node 1   running, line 2, move ...   mode automatic
...
$ leadscrew reset
node 1: ...
$ wait $!; echo $?
4
$ rm wheel.nc wheel.txt told door.nc door.txt
$ leadscrew mdi "G53 G0 X0 Z0"
...
after   G00 G18 G21 G54 G98 G97 S0 M05 T--00   X 0  Z 400   (machine X 0  Z 0)
```

"#;

/// The page of the first hour with [`MORE`].
///
/// # Panics
/// Where the page is built otherwise.
pub fn hour(page: &str) -> String {
    let (before, behind) = page.split_once(SHAFT).expect("the page has its shaft");
    format!("{before}{MORE}{SHAFT}{behind}")
}

/// Where the shell is between two commands, with the exit code of the last one.
const MARK: &str = "---- exit code ";

/// A command of the page, and what it prints.
#[derive(Debug, PartialEq, Eq)]
pub struct Step {
    /// The line of the page.
    pub line: usize,
    /// What is typed.
    pub command: String,
    /// What it prints.
    pub shown: String,
}

/// The commands of a page in their order.
///
/// # Panics
/// Where a block begins with no command.
pub fn steps(page: &str) -> Vec<Step> {
    let mut steps: Vec<Step> = Vec::new();
    let mut inside = false;
    for (index, line) in page.lines().enumerate() {
        if line.starts_with("```") {
            inside = line == "```console";
        } else if let Some(command) = line.strip_prefix("$ ").filter(|_| inside) {
            steps.push(Step {
                line: index + 1,
                command: command.to_owned(),
                shown: String::new(),
            });
        } else if inside {
            let step = steps.last_mut().expect("a block begins with a command");
            step.shown += line;
            step.shown += "\n";
        }
    }
    steps
}

/// True where `told` is `shown`, with anything for each `...`.
pub fn is_shown(shown: &str, told: &str) -> bool {
    let mut pieces = shown.split("...");
    let Some(mut rest) = pieces.next().and_then(|first| told.strip_prefix(first)) else {
        return false;
    };
    let mut pieces = pieces.peekable();
    if pieces.peek().is_none() {
        return rest.is_empty();
    }
    while let Some(piece) = pieces.next() {
        if pieces.peek().is_none() {
            return rest.ends_with(piece);
        }
        let Some(at) = rest.find(piece) else {
            return false;
        };
        rest = &rest[at + piece.len()..];
    }
    false
}

/// A shell in which the commands are typed.
pub struct Shell {
    child: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
}

impl Shell {
    /// Starts it. Both outputs are one.
    ///
    /// # Panics
    /// Where it does not start.
    pub fn start(mut shell: Command) -> Self {
        let shell = shell.stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut child = shell.spawn().expect("a shell");
        let mut shell = Self {
            input: child.stdin.take().expect("its input"),
            output: BufReader::new(child.stdout.take().expect("its output")),
            child,
        };
        assert_eq!(shell.types("exec 2>&1"), "");
        shell
    }

    /// Types the command of a step until it prints what is shown; lines that end with one of `beside` are passed over.
    /// Somebody who looks too early looks again.
    ///
    /// # Panics
    /// Where it prints something else, or does not print that within `limit`.
    #[track_caller]
    pub fn does(&mut self, step: &Step, beside: &[&str], limit: Duration) {
        let Step {
            line,
            command,
            shown,
        } = step;
        let end = Instant::now() + limit;
        loop {
            let mut told = self.types(command);
            if !beside.is_empty() {
                let lines = told.split_inclusive('\n');
                told = lines
                    .filter(|line| !beside.iter().any(|end| line.trim_end().ends_with(end)))
                    .collect();
            }
            if is_shown(shown, &told) {
                return;
            }
            let again = command.starts_with("leadscrew status") && Instant::now() < end;
            assert!(
                again,
                "line {line}: `{command}` is to print\n{shown}and prints\n{told}"
            );
        }
    }

    /// Ends it.
    ///
    /// # Panics
    /// Where it does not end.
    pub fn end(self) {
        let Self {
            mut child, input, ..
        } = self;
        drop(input);
        child.wait().expect("its end");
    }

    /// Types a command. Gives what has been printed until the shell takes the next one.
    ///
    /// # Panics
    /// Where the shell has ended.
    pub fn types(&mut self, command: &str) -> String {
        // The exit code stays what it was, for a page that asks for it.
        let typed = format!("{command}\nlast=$?; echo; echo \"{MARK}$last\"; (exit $last)\n");
        self.input.write_all(typed.as_bytes()).expect("a shell");
        let mut told = String::new();
        loop {
            let mut line = String::new();
            let count = self.output.read_line(&mut line).expect("a shell");
            assert!(count > 0, "the shell has ended behind `{command}`: {told}");
            if line.starts_with(MARK) {
                break;
            }
            told += &line;
        }
        told.strip_suffix('\n').unwrap_or(&told).to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_chinese_first_hour_types_and_shows_what_the_english_one_does() {
        let of = |page| {
            let steps = steps(page).into_iter();
            let typed: Vec<_> = steps.map(|step| (step.command, step.shown)).collect();
            typed
        };
        let english = of(include_str!("../../docs/first-hour.md"));
        assert!(english.len() > 30, "{}", english.len());
        assert_eq!(of(include_str!("../../docs/zh/first-hour.md")), english);
    }

    #[test]
    fn a_page_is_taken_apart_and_compared_to_the_letter() {
        let page = "text\n$ no\n```sh\n$ no\n```\n```console\n$ a b\nx ... y\n$ c\n```\n";
        let step = |line, command: &str, shown: &str| Step {
            line,
            command: command.to_owned(),
            shown: shown.to_owned(),
        };
        assert_eq!(steps(page), [step(7, "a b", "x ... y\n"), step(9, "c", "")]);
        for (shown, told, same) in [
            ("", "", true),
            ("", "x\n", false),
            ("x\n", "x\n", true),
            ("x\n", "x\ny\n", false),
            ("x\n...\nz\n", "x\ny\ny\nz\n", true),
            ("x\n...\nz\n", "x\ny\nzz\n", false),
            ("x ... z\n", "x z\n", false),
            ("a...b...c\n", "a1b2c\n", true),
            ("a...b...c\n", "a1c\n", false),
            ("...c\n", "abc\n", true),
            ("a\n...\n", "a\nb\n", true),
            ("a\n...\n", "b\na\n", false),
        ] {
            assert_eq!(is_shown(shown, told), same, "{shown:?} {told:?}");
        }
    }
}
