//! What was shown begins, and nothing else.

use std::path::{Path, PathBuf};

use clap::Parser as _;

use super::*;
use crate::cli::Cli;
use crate::setup::Answer;

/// A program with a subprogram and a variable, in a folder of its own.
struct Part(PathBuf);

impl Part {
    fn new() -> Self {
        let folder = std::env::temp_dir().join(format!("leadscrew-start-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let part = Self(folder);
        part.write(
            "part.nc",
            "G98\nG0 X-4 Z-2\nG1 X-6 F3000\nM98 P77\nG1 Z#500\nM30\n",
        );
        part.write("O0077.nc", "O77\nG1 X-8\nM99\n");
        part.write("kept", "#500 = -5.0\n");
        part
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.0.join(name), text).unwrap();
    }

    /// Does it on a machine with these options.
    fn on<T>(&self, options: &str, act: impl FnOnce(&Setup<'_>, &SourceFile) -> T) -> T {
        let kept = self.0.join("kept");
        let kept = ["--variables", kept.to_str().unwrap()];
        let typed = ["leadscrew", "--bus", "sim"].into_iter().chain(kept);
        let typed = typed
            .chain(options.split_whitespace())
            .chain(["check", "part.nc"]);
        let global = Cli::try_parse_from(typed).unwrap().global;
        let source = SourceFile::new(&self.0.join("part.nc"));
        let path: &Path = source.path();
        let setup = Setup::new(&global, Some(path), Answer::Check).unwrap();
        act(&setup, &source)
    }

    fn shown(&self) -> Shown {
        self.on("", |setup, source| {
            let found = find(setup, source, 3).unwrap();
            Shown::of(found, setup, source).unwrap().1
        })
    }

    /// The line that it begins at, or why it does not.
    fn agrees(&self, options: &str, consent: Consent) -> Result<u32, String> {
        let agreed = self.on(options, |setup, source| agree(setup, source, 3, consent));
        agreed
            .map(|start| start.line)
            .map_err(|failure| failure.words().unwrap().en)
    }
}

impl Drop for Part {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

#[test]
fn what_was_shown_begins_and_nothing_else() {
    let part = Part::new();
    let shown = Consent::To(part.shown());
    assert_eq!(part.agrees("", shown), Ok(3));
    let refused = |options: &str, what: &str| {
        let why = part.agrees(options, shown).unwrap_err();
        assert!(
            why.contains(what) && why.contains("look at it again"),
            "{why}"
        );
        // Whoever has not been shown anything has agreed to whatever it is.
        assert_eq!(part.agrees(options, Consent::Given), Ok(3));
    };
    refused("--at X=1", "the place of the axes has changed");
    refused("--set 1420.X=11000", "parameters have changed");
    part.write("kept", "#500 = -6.0\n");
    refused("", "variables that are kept have changed");
    part.write("kept", "#500 = -5.0\n");
    // A subprogram of a line behind the start.
    part.write("O0077.nc", "O77\nG1 X-7\nM99\n");
    refused("", "the program, a subprogram or the gear has changed");
    // Put back, and with what is none of this program beside it, it begins; the language is no part of it.
    part.write("O0077.nc", "O77\nG1 X-8\nM99\n");
    part.write("O0078.nc", "O78\nM99\n");
    assert_eq!(part.agrees("--lang zh", shown), Ok(3));
}

#[test]
fn a_spindle_that_stands_at_an_angle_is_not_shown_as_one_of_no_speed() {
    use leadscrew_core::units::Angle;
    let shown = |spindle: SpindleCall| turning(&spindle).en;
    assert_eq!(
        shown(SpindleCall::orient(Angle::from_udeg(30_500_000))),
        "at 30.5°, and held there (M19)"
    );
    assert_eq!(shown(SpindleCall::speed(Rpm::new(-300))), "-300 rpm");
}
