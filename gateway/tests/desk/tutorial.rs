//! The page `docs/first-hour.md`: its commands, typed one after the other into one shell, print what the page shows.

use std::path::Path;

use crate::typed_page::{Shell, hour, steps};
use crate::{LIMIT, User, good};

#[test]
fn the_page_of_the_first_hour_prints_what_it_shows() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let page = std::fs::read_to_string(root.join("docs/first-hour.md")).unwrap();
    let user = User::new();
    for folder in ["examples", "params"] {
        std::os::unix::fs::symlink(root.join(folder), user.0.join(folder)).unwrap();
    }
    let mut shell = user.with_path();
    shell.env_remove("LEADSCREW_BUS");
    let mut shell = Shell::start(shell);
    let steps = steps(&hour(&page));
    assert!(steps.len() > 30, "{}", steps.len());
    for step in &steps {
        shell.does(step, &[], LIMIT);
        // This computer has other work: a command may be silent for a second, and frames of a step by hand come late. At
        // five times the speed whoever does not read for a tenth of a second is dropped, so that it stays at one.
        if step.command.starts_with("leadscrew up") {
            good(&user.does(&["params", "set", "9024=0", "9040=500"]));
        } else if step.command == "leadscrew sim speed 5" {
            good(&user.does(&["sim", "speed", "1"]));
        }
    }
    shell.end();
}
