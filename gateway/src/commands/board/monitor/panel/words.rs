//! What the panel says: what is asked and answered, what the keys do, the page of help.

use leadscrew_core::alarm::Lang;
use leadscrew_core::operating::OperatingMode;

use super::super::keys::Wish;
use super::super::view::{Row, Tone, mode_words};
use super::{Open, Panel};
use crate::link::Seen;
use crate::number;
use crate::words::{Both, both, pick};

impl Panel {
    /// The last line but one: what is asked, typed or answered.
    #[must_use]
    pub fn prompt(&self) -> Row {
        let ask = |words: &Both| Row::new(words.get(self.lang), Tone::Care);
        match &self.open {
            Open::Named(Wish::Resume) => {
                ask(&both!("go on? Enter: yes", "恢复运行？按 Enter 执行"))
            }
            Open::Named(Wish::Reset) => ask(&both!(
                "reset: a program under way is lost? Enter: yes",
                "复位（正在运行的程序将中止）？按 Enter 执行"
            )),
            Open::Named(Wish::Start) => ask(&both!(
                "begin the program that the board has? Enter: yes",
                "启动控制板中的程序？按 Enter 执行"
            )),
            Open::Named(_) => ask(&both!(
                "find the references of all axes? Enter: yes",
                "所有轴回零？按 Enter 执行"
            )),
            Open::Modes => ask(&both!(
                "mode: m manual, i step, w wheel, r reference, d mdi, a automatic",
                "方式：m 手动，i 增量，w 手轮，r 回零，d MDI，a 自动"
            )),
            Open::Line(line) if self.answer.text.is_empty() => {
                Row::new(format!("mdi> {line}\u{2588}"), Tone::Plain)
            }
            Open::Line(line) => Row::new(
                format!("mdi> {line}\u{2588}  {}", self.answer.text),
                self.answer.tone,
            ),
            Open::Nothing | Open::Help => self.answer.clone(),
        }
    }

    /// The last line: what the keys do in this mode.
    #[must_use]
    pub fn hint(&self, seen: &Seen) -> String {
        let step = number::text::<4>(self.increment.tenths);
        let arrows = match self.mode(seen) {
            Some(OperatingMode::Manual) if self.tells_release => both!(
                "arrows, f v: held, Shift rapid",
                "方向键、f v：按住，Shift 快速"
            ),
            Some(OperatingMode::Manual) => both!(
                "no key release here: m i for steps",
                "终端不报告松键：m i 增量"
            ),
            Some(OperatingMode::Step) => {
                both!("arrows: {step} mm (1-4)", "方向键：{step} mm（1-4）")
            }
            Some(OperatingMode::Mdi) => both!(": types a line", ": 输入程序行"),
            Some(OperatingMode::Automatic) => both!("g begins, r goes on", "g 启动，r 恢复"),
            Some(OperatingMode::Reference) => both!("h finds references", "h 回零"),
            Some(mode) => Both::same(mode_words(mode, self.lang)),
            None => Both::default(),
        };
        let arrows = arrows.get(self.lang);
        let keys = pick(
            self.lang,
            "Space hold  s stop  m mode  ? keys  q quit",
            "空格 保持  s 停止  m 方式  ? 按键  q 退出",
        );
        format!("{keys}   {arrows}")
    }
}

/// The page of help.
#[must_use]
pub fn help(lang: Lang) -> Vec<Row> {
    let rows: [(&str, &str, &str); 17] = [
        ("Space, F8", "feed hold, at once", "进给保持，立即"),
        (
            "s, F9",
            "stop, at once (alarm 4300)",
            "停止，立即（报警 4300）",
        ),
        ("r  Enter", "go on after a hold", "保持后恢复运行"),
        ("e  Enter", "reset", "复位"),
        (
            "g  Enter",
            "begin the program that the board has",
            "启动控制板中的程序",
        ),
        (
            "h  Enter",
            "find the references (mode reference)",
            "回零（回零方式）",
        ),
        ("m, a letter", "change the mode", "切换方式"),
        (
            "arrows",
            "up X+  down X-  right Z+  left Z-",
            "上 X+  下 X-  右 Z+  左 Z-",
        ),
        (
            "",
            "manual: while held, Shift at rapid; step: one step",
            "手动方式：按住移动，Shift 快速；增量方式：一步",
        ),
        (
            "f v",
            "manual: turn the spindle while held, as M03, as M04",
            "手动方式：按住转动主轴，同 M03、同 M04",
        ),
        (
            "1 2 3 4",
            "step of 0.001, 0.01, 0.1, 1 mm (X: of the diameter)",
            "步距 0.001、0.01、0.1、1 mm（X 为直径）",
        ),
        ("u j", "feed override up, down", "进给倍率加、减"),
        ("i k", "rapid override up, down", "快速倍率加、减"),
        ("o l", "spindle override up, down", "主轴倍率加、减"),
        ("b", "single block on, off", "单段开、关"),
        (
            ":",
            "type a line (mode mdi): Enter carries it out",
            "输入程序行（MDI 方式）：Enter 执行",
        ),
        (
            "w t  q",
            "positions by the next work offset, tool; leave",
            "下一工件坐标系、刀具的位置显示；退出",
        ),
    ];
    rows.into_iter()
        .map(|(key, en, zh)| Row::new(format!(" {key:<12} {}", pick(lang, en, zh)), Tone::Plain))
        .collect()
}
