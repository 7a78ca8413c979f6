//! Rule 52: the board stands on an alarm. It is asked last: the board may know what the wire does not show.

use leadscrew_core::alarm::{Code, Lang};

use super::{Found, Group, Rule, Verdict, found};
use crate::diagnostics::blanks;
use crate::doctor::heard::Heard;
use crate::doctor::mend::Mend;
use crate::words::both;

/// Rule 52.
pub const RULES: &[Rule] = &[Rule {
    number: 52,
    group: Group::Board,
    fault: ("the board stands on an alarm", "控制板停在报警"),
    remedy: (
        "remove the cause of the alarm, which `leadscrew status` has with its figures, then reset",
        "排除报警原因（`leadscrew status` 给出其数值），然后复位",
    ),
    guard: (
        "its last status, emergency or 5001h:04 has the alarm; not one that was reset meanwhile",
        "其最后状态、紧急报文或 5001h:04 中有该报警；期间已复位的不算",
    ),
    judge: standing,
}];

fn standing(heard: &Heard) -> Verdict {
    let Some(number) = heard.board.standing else {
        return Verdict::Clean;
    };
    let hits = heard.board.alarms.get(&number).filter(|hits| hits.enough());
    found(hits.map(|hits| {
        let [en, zh] = [Lang::En, Lang::Zh].map(|lang| {
            let code = Code::from_number(number);
            code.map_or_else(String::new, |code| blanks(code.cause(lang)))
        });
        let said = both!("{number} {en}", "{number} {zh}");
        Found::at(heard.machine.board, hits, said).mended_by(Mend::Explain(number))
    }))
}
