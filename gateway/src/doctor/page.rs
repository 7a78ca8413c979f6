//! The table of all rules, as `doctor --rules` prints it and `docs/doctor.md` has it.

use leadscrew_core::alarm::Lang;

use super::rules;
use crate::words::pick;

/// A row a rule, in Markdown.
#[must_use]
pub fn table(lang: Lang) -> String {
    let mut text = pick(
        lang,
        "| rule | what is wrong | remedy | it needs, and does not take for a fault |\n|---:|---|---|---|\n",
        "| 规则 | 问题 | 措施 | 判断条件与例外 |\n|---:|---|---|---|\n",
    )
    .to_owned();
    for rule in rules::all() {
        let of = |words: rules::Words| pick(lang, words.0, words.1);
        let (fault, remedy, guard) = (of(rule.fault), of(rule.remedy), of(rule.guard));
        let number = rule.number;
        text.push_str(&format!("| {number} | {fault} | {remedy} | {guard} |\n"));
    }
    text
}
