//! The routine tasks of the project, one command for each: `cargo xtask demo | setup | test | bench …`.
//!
//! Each command prints what it does, stops at the first fault, and says how to mend it. Leadscrew itself needs none of
//! them to build or run: `cargo build` and `cargo run` are enough.

mod audit;
mod axe;
mod bench;
mod bench_can;
mod bench_long;
mod bench_real_time;
mod bits;
mod callgraph;
mod canopen;
mod chip;
mod demo;
mod dist;
mod docs;
mod emulated;
mod emulator;
mod files;
mod held;
mod image;
mod licences;
mod manual;
mod packages;
mod page;
mod pages;
mod pictures;
mod renew;
mod rules;
mod run;
mod setup;
mod shop;
mod sizes;
mod soak;
mod stack;
mod target;
mod test;
mod tools;
mod vcan;
mod wasm;

use std::process::ExitCode;

const HELP: &str = "\
usage: cargo xtask COMMAND

  demo       checks, runs and draws examples/shaft.nc on the simulated machine
  setup      what the other commands need: Debian packages, a few Python packages, the ARM target
  test       what a change must pass first; installs what it needs
  test --full  everything that a change must pass, in full volume
  vcan       the tests on a CAN bus alone (vcan NAME: those with this in their name)
  emulated   the board on the emulated Cortex-M4F, driven by `leadscrew` (emulated NAME: tests with this in their name)
  canopen    the board's CANopen services against the Python package canopen
  chip       the flashed image on a model of its chip (chip NAME: tests with this in their name; --all: in full volume)
  bench      instruction counts and wall times, as the tables of docs/performance.md (--write puts them there)
  bench can  the cost of receiving and recording a CAN frame, likewise
  bench real-time  how a board in real time keeps a beat of 1 kHz on this host, likewise
  bench long a program of a hundred megabytes through a board with 2 KiB for it, likewise; takes minutes
  bench shop what many machines give to one broker, and how fast a query over 10 million certificates is (bench shop --help)
  shop       agents, broker and database: nothing lost, nothing doubled, each query (shop NAME: a module of tests/shop alone)
  audit      the link test: no panic is reachable from what runs on the board
  ticks      instructions per tick on the emulated Cortex-M4F, against firmware/audit/ticks.txt (--write renews the table)
  bits       the setpoints of every example and of random programs on the emulated Cortex-M4F, against
             firmware/mps2-an386/hashes.txt (--write renews it), and of new random programs, against this host
  soak       a machine at work for ten million ticks, disturbed at random, on all cores (--ticks N or --hours H, --seed S)
  image      what is flashed onto a NUCLEO-G474RE, as out/nucleo-g474re.elf, .bin and .hex
  sizes      flash and RAM of the board's images, against firmware/audit/sizes.txt (--write renews it)
  docs       the documentation, without warnings, with every link alive and every picture current
  manual     docs/ as a book, in target/manual (--check: no dead link, no page left out, each program good)
  page       the lathe in a browser tab, as static files in out/page (--check: opens it in headless Chromium and runs programs;
             --long: the page at the machine for ten minutes, with a long path, and left in 500 presses)
  pictures   docs/shop.md and its pictures, from the programs of examples/shop
  renew      every page, picture and golden file that the program writes, anew; read the difference afterwards
  dist       what a release holds, in target/dist: programs for Linux, Debian packages, firmware, page, bills of materials,
             checksums (--check: takes it apart and runs it)
  packages   what is published on crates.io: each crate says what it is; then `cargo publish` of all, without the upload
  licences   the licence of every dependency
  rules      the house rules that no compiler checks

LEADSCREW_SEED: what random tests try beside their fixed cases; without it the beginning of the commit's hash
LEADSCREW_FULL: 1 for full volumes, as in `test --full`
";

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    let result = match args.as_slice() {
        ["setup"] => setup::everything(),
        ["test"] => test::test(),
        ["test", "--full"] => test::full(),
        ["demo"] => demo::demo(),
        ["bench"] => bench::bench(false),
        ["bench", "can"] => bench_can::bench(false),
        ["bench", "can", "--write"] => bench_can::bench(true),
        ["bench", "long"] => bench_long::bench(false),
        ["bench", "long", "--write"] => bench_long::bench(true),
        ["bench", "real-time"] => bench_real_time::bench(false),
        ["bench", "real-time", "--write"] => bench_real_time::bench(true),
        ["bench", "--write"] => bench::bench(true),
        ["bench", "shop", rest @ ..] => shop::bench(rest),
        ["shop"] => shop::check(None).map(drop),
        ["shop", name] => shop::check(Some(name)).map(drop),
        ["vcan"] => test::vcan(""),
        ["vcan", filter] => test::vcan(filter),
        ["emulated"] => test::emulated(""),
        ["emulated", filter] => test::emulated(filter),
        ["chip", rest @ ..] => chip::command(rest),
        ["canopen"] => canopen::check().map(drop),
        ["audit"] => target::ensure().and_then(|()| audit::audit()),
        ["ticks"] => setup::everything().and_then(|()| emulator::ticks(false)),
        ["bits"] => setup::everything().and_then(|()| bits::bits(false)),
        ["bits", "--write"] => setup::everything().and_then(|()| bits::bits(true)),
        ["ticks", "--write"] => setup::everything().and_then(|()| emulator::ticks(true)),
        ["soak", rest @ ..] => soak::soak(rest),
        ["image"] => target::ensure().and_then(|()| image::image()),
        ["sizes"] => target::ensure().and_then(|()| sizes::sizes(false)),
        ["sizes", "--write"] => target::ensure().and_then(|()| sizes::sizes(true)),
        ["docs"] => docs::check(),
        ["manual"] => manual::write(),
        ["manual", "--check"] => manual::check(),
        ["page"] => page::write(),
        ["page", "--check"] => test::page(),
        ["page", "--long"] => page::long(),
        ["pictures"] => pictures::write(),
        ["renew"] => renew::all(),
        ["dist"] => dist::make(),
        ["dist", "--check"] => dist::check(),
        ["packages"] => packages::build(),
        ["licences"] => licences::check(),
        ["rules"] => rules::check(),
        ["help" | "--help" | "-h"] => {
            print!("{HELP}");
            return ExitCode::SUCCESS;
        }
        _ => {
            eprint!("{HELP}");
            return ExitCode::from(2);
        }
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("\nxtask: {error:#}");
            ExitCode::FAILURE
        }
    }
}
