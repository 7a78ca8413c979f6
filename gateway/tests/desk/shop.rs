//! `contrib/shop`: what it begins it ends, and what it lacks it names. Broker and Prometheus are stood in for.

use std::fs;
use std::net::TcpListener;
use std::os::unix::fs::PermissionsExt as _;
use std::path::PathBuf;
use std::process::{Command, Output};
use std::time::Instant;

use crate::{LIMIT, User, good, text};

/// The shop of a user, with programs that do nothing in the place of those of a distribution.
struct Shop {
    user: User,
    port: u16,
    programs: PathBuf,
}

impl Shop {
    fn new(programs: &[&str]) -> Self {
        let user = User::new();
        let folder = user.0.join("bin");
        fs::create_dir_all(&folder).unwrap();
        for name in programs {
            let path = folder.join(name);
            // It ends by itself, whatever becomes of the test.
            fs::write(&path, "#!/bin/sh\nexec sleep 600\n").unwrap();
            fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
        }
        // Nobody has it at this moment.
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = listener.local_addr().unwrap().port();
        Self {
            user,
            port,
            programs: folder,
        }
    }

    fn does(&self, what: &str, path: &str) -> Output {
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../contrib/shop/shop");
        Command::new("sh")
            .args([script, what])
            .env("PATH", format!("{}:{path}", self.programs.display()))
            .env("SHOP_FOLDER", self.user.0.join("shop"))
            .env("SHOP_MACHINES", "2")
            .env("SHOP_METRICS", self.port.to_string())
            // No broker is there.
            .env("SHOP_MQTT", "1")
            .env("LEADSCREW", env!("CARGO_BIN_EXE_leadscrew"))
            .output()
            .unwrap()
    }

    fn notes(&self) -> usize {
        fs::read_dir(self.user.0.join("shop/pids")).map_or(0, Iterator::count)
    }
}

impl Drop for Shop {
    fn drop(&mut self) {
        let _ = self.does("down", "/usr/bin:/bin");
    }
}

#[test]
fn a_shop_is_ended_as_it_was_begun() {
    let shop = Shop::new(&["mosquitto", "prometheus"]);
    let usual = "/usr/bin:/bin";
    let told = good(&shop.does("up", usual));
    assert!(told.contains("lathe1 to lathe2"), "{told}");
    let status = good(&shop.does("status", usual));
    for name in ["mosquitto", "prometheus", "agent"] {
        assert!(status.contains(&format!("{name}: process ")), "{status}");
    }
    for machine in ["lathe1", "lathe2"] {
        assert!(status.contains(&format!("{machine}: node 1 ")), "{status}");
    }
    let pages = || {
        good(&shop.does("status", usual))
            .matches("page http://127.0.0.1:")
            .count()
    };
    let end = Instant::now() + LIMIT;
    while pages() < 2 {
        assert!(Instant::now() < end, "no pages");
    }
    // A second one in its place is refused, and the first stays.
    let second = shop.does("up", usual);
    assert_eq!(second.status.code(), Some(1));
    assert!(text(&second.stderr).contains("there is a shop in"));
    let socket = shop.user.0.join("shop/run/leadscrew/lathe1.sock");
    assert!(socket.exists());
    good(&shop.does("down", usual));
    assert!(!socket.exists());
    assert_eq!(shop.notes(), 0);
    let status = good(&shop.does("status", usual));
    assert!(status.contains("agent: does not run"), "{status}");
}

#[test]
fn what_a_shop_lacks_is_named_and_a_folder_of_another_is_left_alone() {
    let shop = Shop::new(&["mosquitto"]);
    let installed = ["/usr/bin", "/usr/sbin", "/bin", "/usr/local/sbin"]
        .iter()
        .any(|folder| PathBuf::from(folder).join("prometheus").exists());
    if !installed {
        let refused = shop.does("up", "/usr/bin:/bin");
        assert_eq!(refused.status.code(), Some(1));
        let said = text(&refused.stderr);
        assert!(said.contains("apt-get install prometheus\n"), "{said}");
    }
    let shop = Shop::new(&["mosquitto", "prometheus"]);
    let folder = shop.user.0.join("shop");
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join("mine"), "").unwrap();
    let refused = shop.does("up", "/usr/bin:/bin");
    assert_eq!(refused.status.code(), Some(1));
    assert!(text(&refused.stderr).contains("no folder of a shop"));
    assert!(folder.join("mine").exists() && !folder.join("run").exists());
    let unknown = shop.does("sell", "/usr/bin:/bin");
    assert_eq!(unknown.status.code(), Some(2));
    assert!(text(&unknown.stdout).contains("usage: shop up | status | down"));
}
