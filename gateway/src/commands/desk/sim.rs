//! `sim`: door, contacts, faults, power and time of a machine that `up` keeps running.

use leadscrew_can::MachineName;
use leadscrew_desk::clock::Speed;
use leadscrew_desk::control::Request;
use leadscrew_desk::hand::wrong_speed;

use super::{asked, contact_words, json, name, note, words};
use crate::cli::{Global, SimCommand};
use crate::diagnostics;
use crate::failure::{Failure, Outcome};
use crate::output;
use crate::words::both;

/// Does what was typed, and tells how the machine is then.
pub fn sim(global: &Global, named: Option<&MachineName>, command: SimCommand) -> Outcome {
    let request = match command {
        SimCommand::Door { to } => Request::Door { to },
        SimCommand::Estop { to } => Request::Estop { to },
        SimCommand::Hold { to } => Request::Hold { to },
        SimCommand::Power { to } => Request::Power { to },
        SimCommand::Speed { factor } => {
            let speed = Speed::of_thousandths(factor.0);
            let speed = speed.ok_or_else(|| Failure::Usage(wrong_speed()))?;
            Request::Speed {
                thousandths: speed.thousandths(),
            }
        }
        SimCommand::Wheel { counts } => Request::Wheel { counts },
        SimCommand::Turret { to } => Request::Turret { to },
        SimCommand::Block { to } => Request::Block { to },
        SimCommand::Drive { which, to } => Request::Drive { which, to },
        SimCommand::Spindle { percent } => Request::Spindle { percent },
        SimCommand::Encoder { to } => Request::Encoder { to },
        SimCommand::Bus { to } => Request::Bus { to },
        SimCommand::Flash { to } => Request::Flash { to },
        SimCommand::Input { number, to } => Request::Input { number, to },
        SimCommand::State | SimCommand::Outputs => Request::State,
    };
    let answer = asked(&name(global, named)?, &request)?;
    if global.json {
        return json(&answer);
    }
    let lang = global.lang();
    if let Some(note) = note(&answer) {
        let told = both!("note: {en}\n", "注意：{zh}\n", en = note.en, zh = note.zh);
        diagnostics::say(told.get(lang));
    }
    let text = answer.machine.as_ref().map(|view| match command {
        SimCommand::Outputs | SimCommand::Input { .. } => contact_words(view, lang),
        _ => words(view, lang),
    });
    output::write(text.unwrap_or_default().as_bytes())
}
