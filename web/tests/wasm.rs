//! The machine of the page, as WebAssembly in an interpreter, makes the setpoints of the host and of the emulated board.

use std::path::{Path, PathBuf};
use std::process::Command;

use leadscrew_web::{Desk, FOLDERS, answer};
use serde_json::{Value, json};
use wasmi::{Engine, Instance, Linker, Module, Store, TypedFunc};

#[path = "../../firmware/mps2-an386/src/programs.rs"]
mod programs;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The module, built as for the page.
fn module() -> Vec<u8> {
    let target = root().join("target");
    let status = Command::new(env!("CARGO"))
        .current_dir(root())
        .args([
            "build",
            "--quiet",
            "--locked",
            "--package",
            "leadscrew-web",
            "--lib",
        ])
        .args(["--profile", "page", "--target", "wasm32-unknown-unknown"])
        .arg("--target-dir")
        .arg(&target)
        .status()
        .expect("cargo starts");
    assert!(
        status.success(),
        "the target may be missing: cargo xtask setup"
    );
    std::fs::read(target.join("wasm32-unknown-unknown/page/leadscrew_web.wasm"))
        .expect("it is built")
}

struct Page {
    store: Store<()>,
    instance: Instance,
}

impl Page {
    fn new(engine: &Engine, module: &Module) -> Self {
        let mut store = Store::new(engine, ());
        let instance = Linker::new(engine)
            .instantiate_and_start(&mut store, module)
            .expect("the module needs nothing");
        Self { store, instance }
    }

    fn number(&mut self, name: &str) -> usize {
        let function: TypedFunc<(), i32> =
            self.instance.get_typed_func(&self.store, name).expect(name);
        function.call(&mut self.store, ()).expect("no trap") as usize
    }

    fn ask(&mut self, message: &Value) -> Value {
        let message = message.to_string();
        let room: TypedFunc<i32, i32> = self
            .instance
            .get_typed_func(&self.store, "leadscrew_room")
            .expect("it is exported");
        let at = room
            .call(&mut self.store, message.len() as i32)
            .expect("room") as usize;
        let memory = self
            .instance
            .get_memory(&self.store, "memory")
            .expect("memory");
        memory
            .write(&mut self.store, at, message.as_bytes())
            .expect("room");
        let from = self.number("leadscrew_answer");
        let mut said = vec![0; self.number("leadscrew_length")];
        memory
            .read(&self.store, from, &mut said)
            .expect("an answer");
        serde_json::from_slice(&said).expect("JSON")
    }
}

fn job(what: &str, folder: &str, text: &str) -> Value {
    json!({"do": what, "text": text, "folder": folder, "zh": false, "ripple": null, "counts": null, "kv": null})
}

/// The result of a program: what is found before it moves, then hash, ticks and alarms at the end.
fn run(ask: &mut dyn FnMut(&Value) -> Value, folder: &str, text: &str, most: u64) -> Option<Value> {
    let loaded = ask(&job("load", folder, text));
    if loaded["good"] != true {
        return Some(json!({"found": loaded["found"]}));
    }
    let mut told = Vec::new();
    loop {
        let said = ask(&json!({"do": "step", "ticks": 10_000}));
        told.extend(said["told"].as_array().expect("a list").clone());
        let state = &said["state"];
        if state["over"] == true {
            return Some(
                json!({"found": loaded["found"], "path": loaded["path"], "told": told,
                "hash": state["setpoint_hash"], "ticks": state["hashed_ticks"]}),
            );
        }
        if state["ticks"].as_u64().expect("a number") > most {
            return None;
        }
    }
}

fn on_host(folder: &str, text: &str, most: u64) -> Option<Value> {
    let mut desk = Desk::default();
    let mut ask = |message: &Value| {
        serde_json::from_slice(&answer(&mut desk, message.to_string().as_bytes())).expect("JSON")
    };
    run(&mut ask, folder, text, most)
}

/// The wasm interpreter is slower than the processor by a factor of some fifty: no longer programs in a short run.
fn most_ticks() -> u64 {
    leadscrew_seed::amount(20_000, u64::MAX)
}

#[test]
fn the_module_and_the_host_make_the_same_setpoints() {
    let engine = Engine::default();
    let module = Module::new(&engine, module()).expect("a module");
    let mut page = Page::new(&engine, &module);
    let mut compare = |folder: &str, name: &str, text: &str| {
        let Some(host) = on_host(folder, text, most_ticks()) else {
            return 0;
        };
        let own = run(&mut |message| page.ask(message), folder, text, u64::MAX);
        assert_eq!(own.as_ref(), Some(&host), "{folder}/{name}");
        1
    };
    let mut examples = 0;
    for folder in FOLDERS {
        for (name, text) in folder.programs {
            examples += compare(folder.name, name, text);
        }
    }
    assert!(examples >= 3, "{examples} examples are short enough");
    leadscrew_seed::volume(leadscrew_seed::amount(4, 500), |seed| {
        compare(
            "",
            &format!("random {seed}"),
            programs::random(seed).as_str(),
        );
    });
}

/// The emulated board has read the same programs; its rows are under version control.
#[test]
fn the_page_has_the_setpoints_of_the_emulated_board() {
    let golden = root().join("firmware/mps2-an386/hashes.txt");
    let golden = std::fs::read_to_string(golden).expect("the board's rows are there");
    let most = leadscrew_seed::amount(50_000, u64::MAX);
    let mut compared = 0;
    for row in golden.lines().filter(|row| row.contains(".nc ")) {
        let words: Vec<&str> = row.split_whitespace().collect();
        let (name, hash, ticks) = (words[0], words[1], words[2]);
        let count: u64 = ticks.parse().expect("a number");
        if count == 0 || count > most {
            continue;
        }
        let text = std::fs::read_to_string(root().join("examples").join(name)).expect("an example");
        let own = on_host("", &text, u64::MAX).expect("it ends");
        if words[3] != "0" {
            // The board runs up to the alarm; the page refuses the program before anything moves.
            let found = own["found"].as_array().expect("a list");
            let has = found
                .iter()
                .any(|one| one["number"].to_string() == words[3]);
            assert!(has, "{name}: {found:?}");
            continue;
        }
        assert_eq!(
            (&own["hash"], &own["ticks"]),
            (&json!(hash), &json!(count)),
            "{name}"
        );
        compared += 1;
    }
    assert!(compared >= 5, "{compared} examples");
}

/// A message that makes no sense is refused in words, never by a trap.
#[test]
fn every_refusal_has_a_key_of_the_words() {
    let mut desk = Desk::default();
    let mut ask = |text: &str| -> Value {
        serde_json::from_slice(&answer(&mut desk, text.as_bytes())).expect("JSON")
    };
    assert_eq!(ask("{")["refused"], "message");
    assert_eq!(ask(r#"{"do":"step","ticks":1}"#)["refused"], "nothing");
    assert_eq!(
        ask(&job("check", "none", "").to_string())["refused"],
        "folder"
    );
    let mut wrong = job("load", "", "M30\n");
    wrong["counts"] = json!(1);
    assert_eq!(ask(&wrong.to_string())["refused"], "counts");
    wrong["counts"] = json!(null);
    wrong["ripple"] = json!([99_000, 1]);
    assert_eq!(ask(&wrong.to_string())["refused"], "ripple");
    let found = ask(&job("check", "", "G0 X10\nG1 Q\n").to_string());
    assert_eq!(found["found"][0]["line"], 2, "{found}");
    assert_eq!(found["good"], false);
}
