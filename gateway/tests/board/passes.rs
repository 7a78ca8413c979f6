//! Programs of several files and several passes on a board.

use crate::server::{Options, Server};
use crate::{good, json, leadscrew};

#[test]
fn a_board_carries_out_pass_after_pass_and_tells_the_files_of_its_lines() {
    let folder = std::env::temp_dir().join(format!("leadscrew-passes-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let file = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    let (program, kept) = (file("p.nc"), file("kept"));
    let main = "O1\nG50 X80 Z20\nG99 M3 S800\n#500=#500+1\nM98 P20\nG0 X80 Z20\nM99\n";
    std::fs::write(&program, main).unwrap();
    std::fs::write(
        file("O0020.nc"),
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
        .args(args(&file("other")))
        .output()
        .unwrap();
    assert_eq!(ran["moves"], json(&simulated)["moves"]);
    std::fs::remove_dir_all(&folder).unwrap();
}
