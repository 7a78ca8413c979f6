//! What to do about an alarm, where that depends on the word that it blames: one number of an alarm then has several
//! remedies.

use leadscrew_core::alarm::{Alarm, Arg, Code, Lang};
use leadscrew_core::program::{LETTER_O, LETTERS};

use super::Control;
use super::refusals::{REFUSALS, refusal};

/// Alarms whose remedy depends on a number that they name: the number, how it is written, and what to do.
#[rustfmt::skip]
const BY_NUMBER: &[(Code, &[Arg], &str, [&str; 2])] = &[
    (Code::NumberMissing, &[Arg::Int(LETTER_O)], "GO, X5O", [
        "write the digit 0, and not the letter O",
        "请写数字 0，而不是字母 O",
    ]),
    (Code::NumberMissing, &[Arg::Int(LETTERS)], "ROUGH", [
        "put a remark in parentheses: (ROUGH); or write a number behind each letter",
        "注释请写在括号内：(ROUGH)；或在每个字母后写数字",
    ]),
    (Code::InhibitVariable, &[Arg::Int(3003)], "#3003", [
        "leave it out: a thread, or a chain of G32, stops at its end alone in any case",
        "请省略：螺纹及连续的 G32 总是在其终点才停",
    ]),
    (Code::InhibitVariable, &[Arg::Int(3004)], "#3004", [
        "leave it out; in place of 4, no exact stop, write G64 before the cuts that are to be joined",
        "请省略；代替 4（不准停）请在需连续切削的程序段之前写 G64",
    ]),
    (Code::CodeNeedsWords, &[Arg::GCode(40)], "G04", [
        "write the time: P in milliseconds, or X or U in seconds",
        "请写时间：P 为毫秒，X 或 U 为秒",
    ]),
    (Code::CodeNeedsWords, &[Arg::GCode(100)], "G10", [
        "write P, the number of the offset, and X, Z, R or Q",
        "请写刀偏号 P，以及 X、Z、R 或 Q",
    ]),
    (Code::CodeNeedsWords, &[Arg::GCode(280)], "G28", [
        "write the axes: G28 U0 W0; a Haas alone goes home with both without a word (`--dialect haas`)",
        "请写轴：G28 U0 W0；只有 Haas 不写轴时两轴都回零（`--dialect haas`）",
    ]),
    (Code::CodeNeedsWords, &[Arg::GCode(300)], "G30", [
        "write the axes: G30 U0 W0",
        "请写轴：G30 U0 W0",
    ]),
    (Code::CodeNeedsWords, &[Arg::GCode(500), Arg::GCode(920)], "G50 (FANUC B, C: G92)", [
        "write S, the highest speed of the spindle, or X and Z, the place where the tool is",
        "请写 S（主轴最高转速），或 X、Z（刀具当前位置）",
    ]),
    (Code::CodeNeedsWords, &[Arg::GCode(530)], "G53", [
        "write X or Z, in coordinates of the machine",
        "请写机床坐标 X 或 Z",
    ]),
];

const fn of_lang([en, zh]: [&'static str; 2], lang: Lang) -> &'static str {
    match lang {
        Lang::En => en,
        Lang::Zh => zh,
    }
}

/// What to do about an alarm whose remedy depends on the word that it blames.
#[must_use]
pub fn help(alarm: &Alarm, lang: Lang) -> Option<String> {
    let both = |en, zh| of_lang([en, zh], lang).to_owned();
    let words = match (alarm.code, alarm.args) {
        (Code::FeedOfOtherMode, [Arg::Feed(_), ..]) => both(
            "write G99 (FANUC B, C: G95) before it, or another F; where the program is of a FANUC or a Haas, choose it with \
             `--dialect`; `(ALLOW 4803)` if it is meant",
            "请在前面写 G99（FANUC B、C 为 G95），或修改 F；若为 FANUC 或 Haas 程序，请用 `--dialect` 指定；确实如此请写 \
             `(ALLOW 4803)`",
        ),
        (Code::SpeedLimited, [_, _, Arg::GCode(_), _]) => both(
            "write a higher G50 S (FANUC B, C: G92 S) before this block, where the work may turn so fast; or a lower S here",
            "若工件允许，请在本段之前写更高的 G50 S（FANUC B、C 为 G92 S）；或在此写较低的 S",
        ),
        (Code::PointInIncrements, [Arg::Int(count), Arg::Letter(letter), ..]) => {
            let letter = char::from(letter);
            match lang {
                Lang::En => format!(
                    "write {letter}{count}: on a FANUC {letter} counts increments here, without a point"
                ),
                Lang::Zh => {
                    format!("请写 {letter}{count}：FANUC 在此以最小增量计数，{letter} 不带小数点")
                }
            }
        }
        (Code::FunctionMissing, [Arg::Int(96), ..]) => both(
            "leave it out: no program reads an input; where it is to wait for one, write an M code whose row has that input as \
             its answer (docs/functions.md)",
            "请省略：程序不能读取输入；若需等待输入，请使用以该输入为应答的 M 代码（docs/functions.md）",
        ),
        (Code::FunctionMissing, [Arg::Int(198), ..]) => both(
            "write M98 with the same P, with the program in the same file or in one of its own beside it (M98 P20: `O0020.nc`)",
            "请写 M98 和相同的 P，子程序写在同一文件中，或写成旁边的单独文件（M98 P20：`O0020.nc`）",
        ),
        (Code::ProgramNotFound, [_, Arg::Letter(_), ..]) => both(
            "it stands behind the `%` that ends the program: take that `%` out",
            "该程序位于结束程序的 `%` 之后：请去掉该 `%`",
        ),
        (Code::ContourDepth, [Arg::Length(_), ..]) => both(
            "it is more than ten times what there is to cut: write a length on the radius with a point (D2., in inches D.08); \
             where the whole program counts increments, read it with `--set 3401.0=0`",
            "它超过待切除量的十倍：请写半径方向的长度并带小数点（D2.，英制 D.08）；若整个程序都以最小增量为单位，请用 \
             `--set 3401.0=0` 读取",
        ),
        (Code::ContourWord, _) if matches!(alarm.word, Some(b'C' | b'H')) => both(
            "turn C before or after the cycle; for a chamfer write `,C` (L on a GSK), or, on a FANUC and a Haas, C beside one of \
             X and Z",
            "请在循环之前或之后转动 C；倒角请写 `,C`（GSK 为 L），FANUC 和 Haas 也可在 X、Z 之一旁写 C",
        ),
        (Code::WordWithoutUse, _) if matches!(alarm.word, Some(b'C' | b'R')) => both(
            "remove it, or write the code it belongs to; where a corner between two lines is meant, write `,C` or `,R`",
            "请去掉它，或写出它所属的代码；若指两直线间的拐角，请写 `,C` 或 `,R`",
        ),
        // Only the systems B and C have no G50.
        (Code::UnknownG, [Arg::GCode(500), Arg::None, ..]) => both(
            "write G92 in its place; where the program is one of system A, choose `fanuc-a` with `--dialect`, or `(DIALECT …)` in \
             its first line",
            "请改写为 G92；若为 A 系统程序，请用 `--dialect` 或首行 `(DIALECT …)` 选择 `fanuc-a`",
        ),
        (Code::UnknownG, [_, Arg::Int(with_it), ..]) => {
            let has = |number: usize| with_it >> number & 1 == 1;
            let controls = (0..).zip(Control::ALL).filter(|(number, _)| has(*number));
            let names: Vec<&str> = controls.map(|(_, control)| control.name()).collect();
            match lang {
                Lang::En => format!(
                    "correct the code; it is a code of {}: choose the control that the program is written for with `--dialect`, or \
                     `(DIALECT …)` in its first line",
                    names.join(", ")
                ),
                Lang::Zh => format!(
                    "请修改代码；{} 有此代码：请用 `--dialect` 或首行 `(DIALECT …)` 选择程序所用的系统",
                    names.join("、")
                ),
            }
        }
        _ => {
            let is = |(code, numbers, ..): &&(Code, &[Arg], _, _)| {
                *code == alarm.code && numbers.contains(&alarm.args[0])
            };
            match BY_NUMBER.iter().find(is) {
                Some((.., words)) => of_lang(*words, lang).to_owned(),
                None => refusal(alarm)?.help(lang).to_owned(),
            }
        }
    };
    Some(words)
}

/// All remedies of such a number, each with its words; none for every other number.
#[must_use]
pub fn helps(code: Code, lang: Lang) -> Vec<(String, &'static str)> {
    let numbers = BY_NUMBER.iter().filter(|(known, ..)| *known == code);
    let numbers = numbers.map(|(.., number, words)| ((*number).to_owned(), of_lang(*words, lang)));
    let rows = REFUSALS.iter().filter(|refusal| refusal.code == code);
    let rows = rows.map(|row| (row.heading(lang), row.help(lang)));
    numbers.chain(rows).collect()
}
