//! Programs for the machine of the page, and what comes of them on this host.

use leadscrew_web::{Session, answer};
use serde_json::{Value, json};

/// A message about a program.
pub fn job(what: &str, folder: &str, text: &str) -> Value {
    json!({"do": what, "text": text, "folder": folder, "zh": false, "ripple": null, "counts": null, "kv": null})
}

/// What is found in a program before it moves, then hash, ticks and alarms at its end, on this host.
pub fn on_host(folder: &str, text: &str) -> Value {
    let mut session = Session::default();
    let mut ask = |message: &Value| -> Value {
        serde_json::from_slice(&answer(&mut session, message.to_string().as_bytes())).expect("JSON")
    };
    let loaded = ask(&job("load", folder, text));
    if loaded["good"] != true {
        return json!({"found": loaded["found"]});
    }
    let mut told = Vec::new();
    loop {
        let said = ask(&json!({"do": "step", "ticks": 10_000}));
        told.extend(said["told"].as_array().expect("a list").clone());
        let state = &said["state"];
        if state["over"] == true {
            return json!({"found": loaded["found"], "told": told,
                "hash": state["setpoint_hash"], "ticks": state["hashed_ticks"]});
        }
    }
}
