//! The folder of programs against names that lead elsewhere, links, pipes, and several who write.

use std::os::unix::fs::symlink;
use std::sync::atomic::{AtomicU32, Ordering};

use super::*;

/// A folder of its own, with another beside it.
struct Bench {
    around: PathBuf,
    programs: Arc<Programs>,
}

impl Bench {
    fn new() -> Self {
        static NEXT: AtomicU32 = AtomicU32::new(0);
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let name = format!("ls-programs-{}-{number}", std::process::id());
        let around = std::env::temp_dir().join(name);
        fs::create_dir_all(around.join("programs")).unwrap();
        let programs = Arc::new(Programs::open(&around.join("programs")).unwrap());
        Self { around, programs }
    }

    fn inside(&self, name: &str) -> PathBuf {
        self.around.join("programs").join(name)
    }

    /// What is in the folder, hidden files too.
    fn all(&self) -> Vec<String> {
        let entries = fs::read_dir(self.around.join("programs")).unwrap();
        let name = |entry: io::Result<fs::DirEntry>| entry.unwrap().file_name();
        let mut all: Vec<_> = entries
            .map(|entry| name(entry).into_string().unwrap())
            .collect();
        all.sort();
        all
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.around);
    }
}

#[test]
fn a_program_is_written_read_and_listed() {
    let bench = Bench::new();
    let tag = bench
        .programs
        .write("shaft.nc", When::New, b"M30\n")
        .unwrap();
    let text = bench.programs.read("shaft.nc").unwrap();
    assert_eq!((&*text.bytes, &text.tag), (&b"M30\n"[..], &tag));
    let next = bench
        .programs
        .write("shaft.nc", When::Is(&tag), b"M31\n")
        .unwrap();
    assert_ne!(next, tag);
    bench.programs.write("A", When::New, b"").unwrap();
    fs::create_dir(bench.inside("folder")).unwrap();
    fs::write(bench.inside(".hidden"), "M30\n").unwrap();
    fs::write(bench.inside("no name"), "M30\n").unwrap();
    symlink(bench.inside("A"), bench.inside("link.nc")).unwrap();
    let listed = |name: &str, size| Listed {
        name: name.into(),
        size,
    };
    let list = vec![listed("A", 0), listed("shaft.nc", 4)];
    assert_eq!(bench.programs.list(), Ok((list, 0)));
}

#[test]
fn what_somebody_else_has_written_meanwhile_stays() {
    let bench = Bench::new();
    let programs = &bench.programs;
    let first = programs.write("a.nc", When::New, b"1").unwrap();
    assert_eq!(
        programs.write("a.nc", When::New, b"2"),
        Err(Refusal::Changed)
    );
    let second = programs.write("a.nc", When::Is(&first), b"2").unwrap();
    let late = programs.write("a.nc", When::Is(&first), b"3");
    assert_eq!(late, Err(Refusal::Changed));
    assert_eq!(programs.read("a.nc").unwrap().bytes, b"2");
    // The same by somebody who does not ask the panel.
    fs::write(bench.inside("a.nc"), "4").unwrap();
    let late = programs.write("a.nc", When::Is(&second), b"5");
    assert_eq!(late, Err(Refusal::Changed));
    let gone = programs.write("b.nc", When::Is(&first), b"5");
    assert_eq!(gone, Err(Refusal::Changed));
    assert_eq!(bench.all(), ["a.nc"]);
}

#[test]
fn of_many_who_write_at_once_each_replaces_what_it_has_seen() {
    let bench = Bench::new();
    let programs = &bench.programs;
    let start = programs.write("a.nc", When::New, b"0").unwrap();
    let done: usize = std::thread::scope(|scope| {
        let writers: Vec<_> = (0..8)
            .map(|number: u32| {
                let start = &start;
                scope.spawn(move || {
                    let text = number.to_string().repeat(5_000);
                    let one = programs.write("a.nc", When::Is(start), text.as_bytes());
                    let new = programs.write("b.nc", When::New, text.as_bytes());
                    usize::from(one.is_ok()) + usize::from(new.is_ok())
                })
            })
            .collect();
        writers.into_iter().map(|one| one.join().unwrap()).sum()
    });
    assert_eq!(done, 2);
    for name in ["a.nc", "b.nc"] {
        let bytes = programs.read(name).unwrap().bytes;
        assert!(bytes.len() == 5_000 && bytes.iter().all(|byte| *byte == bytes[0]));
    }
    assert_eq!(bench.all(), ["a.nc", "b.nc"]);
}

#[test]
fn no_name_leads_out_of_the_folder() {
    let bench = Bench::new();
    fs::write(bench.around.join("secret"), "M30\n").unwrap();
    let long = "x".repeat(NAME + 1);
    for name in [
        "",
        ".",
        "..",
        "../secret",
        "/etc/passwd",
        ".hidden",
        "a/b",
        "a\\b",
        "a b",
        "a\0",
        "a\n",
        "%2e%2e",
        "x%00",
        "é.nc",
        "~",
        "a:b",
        &long,
    ] {
        assert_eq!(
            bench.programs.read(name).err(),
            Some(Refusal::Name),
            "{name:?}"
        );
        let written = bench.programs.write(name, When::New, b"M30\n");
        assert_eq!(written, Err(Refusal::Name), "{name:?}");
        assert_eq!(bench.programs.path(name), Err(Refusal::Name), "{name:?}");
    }
    let longest = "x".repeat(NAME);
    assert!(bench.programs.write(&longest, When::New, b"").is_ok());
    assert_eq!(bench.all(), [longest]);
}

#[test]
fn a_link_is_not_followed_and_a_pipe_keeps_nobody_waiting() {
    let bench = Bench::new();
    let secret = bench.around.join("secret");
    fs::write(&secret, "M30\n").unwrap();
    symlink(&secret, bench.inside("link")).unwrap();
    symlink(&bench.around, bench.inside("up")).unwrap();
    symlink("nowhere", bench.inside("dangling")).unwrap();
    fs::create_dir(bench.inside("folder")).unwrap();
    let made = std::process::Command::new("mkfifo")
        .arg(bench.inside("pipe"))
        .status();
    assert!(made.unwrap().success());
    let before = bench.all();
    let tag = tag(b"M30\n");
    for name in ["link", "up", "dangling", "folder", "pipe"] {
        assert_eq!(
            bench.programs.read(name).err(),
            Some(Refusal::NoProgram),
            "{name}"
        );
        assert!(bench.programs.path(name).is_err(), "{name}");
        assert!(bench.programs.claim(name, &tag).is_err(), "{name}");
        for when in [When::New, When::Is(&tag)] {
            let written = bench.programs.write(name, when, b"x");
            assert_eq!(written, Err(Refusal::Changed), "{name} {when:?}");
        }
    }
    assert_eq!(fs::read(&secret).unwrap(), b"M30\n");
    assert_eq!(bench.all(), before);
}

#[test]
fn a_program_is_no_longer_than_it_may_be() {
    let bench = Bench::new();
    let long = vec![b'x'; LONGEST + 1];
    let written = bench.programs.write("a.nc", When::New, &long);
    assert_eq!(written, Err(Refusal::TooLong));
    assert!(bench.programs.write("a.nc", When::New, &long[1..]).is_ok());
    assert_eq!(bench.programs.read("a.nc").unwrap().bytes.len(), LONGEST);
    fs::write(bench.inside("b.nc"), &long).unwrap();
    assert_eq!(bench.programs.read("b.nc"), Err(Refusal::TooLong));
}

#[test]
fn a_program_that_runs_is_the_one_that_was_seen_and_stays_so() {
    let bench = Bench::new();
    let programs = &bench.programs;
    let tag = programs.write("a.nc", When::New, b"1").unwrap();
    assert_eq!(
        programs.claim("a.nc", "other").err(),
        Some(Refusal::Changed)
    );
    let claim = programs.claim("a.nc", &tag).unwrap();
    assert_eq!(claim.path.file_name().unwrap(), "a.nc");
    assert_eq!(
        programs.write("a.nc", When::Is(&tag), b"2"),
        Err(Refusal::Runs)
    );
    assert_eq!(programs.claim("a.nc", &tag).err(), Some(Refusal::Runs));
    assert!(programs.write("b.nc", When::New, b"2").is_ok());
    drop(claim);
    assert!(programs.write("a.nc", When::Is(&tag), b"2").is_ok());
}

#[test]
fn a_program_that_has_run_is_let_go_while_another_is_written() {
    let bench = Bench::new();
    let tag = bench.programs.write("a.nc", When::New, b"1").unwrap();
    let claim = bench.programs.claim("a.nc", &tag).unwrap();
    // A disk that takes its time.
    let written = bench.programs.written();
    let (send, gone) = std::sync::mpsc::channel();
    std::thread::spawn(move || {
        drop(claim);
        send.send(()).unwrap();
    });
    let limit = std::time::Duration::from_secs(60);
    assert_eq!(gone.recv_timeout(limit), Ok(()));
    drop(written);
    assert!(bench.programs.claim("a.nc", &tag).is_ok());
}
