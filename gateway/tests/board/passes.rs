//! Programs of several files and several passes on a board.

use crate::folder::Folder;
use crate::server::{Options, Server};
use crate::{good, json, leadscrew};

#[test]
fn a_board_carries_out_pass_after_pass_and_tells_the_files_of_its_lines() {
    let folder = Folder::empty("passes");
    let (program, kept) = (folder.file("p.nc"), folder.file("kept"));
    let main = "O1\nG50 X80 Z20\nG99 M3 S800\n#500=#500+1\nM98 P20\nG0 X80 Z20\nM99\n";
    std::fs::write(&program, main).unwrap();
    std::fs::write(
        folder.file("O0020.nc"),
        "O20\nG0 X24 Z5\nG92 X20 Z-15 F2\nG0 X40\nM99\n",
    )
    .unwrap();
    let server = Server::start(&Options::default());
    let args = |kept| {
        [
            "run",
            &program,
            "--json",
            "--passes",
            "3",
            "--variables",
            kept,
        ]
    };
    let output = leadscrew(&args(&kept), &server.bus());
    good(&output);
    let ran = json(&output);
    let values = std::fs::read_to_string(&kept).unwrap();
    assert!(values.ends_with("#500 = 3.0\n"), "{values}");
    // One thread a pass, each with its own certificate.
    let threads = ran["threads"].as_array().unwrap();
    let places: Vec<_> = threads
        .iter()
        .map(|t| (t["file"].as_str(), t["line"].as_u64()))
        .collect();
    assert_eq!(places, [(Some("O0020.nc"), Some(3)); 3], "{ran}");
    let simulated = std::process::Command::new(env!("CARGO_BIN_EXE_leadscrew"))
        .args(args(&folder.file("other")))
        .output()
        .unwrap();
    assert_eq!(ran["moves"], json(&simulated)["moves"]);
}

/// A bar is counted by the program, which ends itself at the first block of a pass: nothing of that pass is loaded.
#[test]
fn a_program_that_ends_a_pass_at_its_first_block_keeps_what_it_has_counted() {
    let folder = Folder::empty("bar");
    let (program, kept) = (folder.file("p.nc"), folder.file("kept"));
    let main = "O1\nIF[#500LT3]GOTO10\n#3000=1(BAR IS DONE)\nN10 G0 X50\nX40\n#500=#500+1\nM99\n";
    std::fs::write(&program, main).unwrap();
    let server = Server::start(&Options::default());
    let args = ["run", &program, "--json", "--variables", &kept];
    let output = leadscrew(&args, &server.bus());
    assert_eq!(output.status.code(), Some(4));
    let ran = json(&output);
    let alarm = ran["alarms"][0].to_string();
    assert!(alarm.contains("alarm 3001"), "{ran}");
    let values = std::fs::read_to_string(&kept).unwrap();
    assert!(values.ends_with("#500 = 3.0\n"), "{values}");
}
