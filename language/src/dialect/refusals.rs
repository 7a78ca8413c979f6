//! Codes of other controls that are refused by name, each with what to write in its place.
//!
//! A code may be another one on each control, and a row is for those that it names. The alarm has the number of its row in
//! its second figure, so that whoever tells it finds the words that fit this code.

use leadscrew_core::alarm::{Alarm, Arg, Code, Lang};

use super::Control;

/// Codes that are refused for one reason.
#[derive(Clone, Copy, Debug)]
pub(super) struct Refusal {
    pub(super) code: Code,
    /// The codes as they are written.
    written: &'static str,
    /// The same in tenths: from and to.
    tenths: &'static [(u16, u16)],
    /// The controls that have them with this meaning.
    of: Of,
    en: &'static str,
    zh: &'static str,
}

/// The controls that a row is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Of {
    All,
    Gsk,
    Fanuc,
    Haas,
    /// All but a Haas.
    NoHaas,
    /// Those with G85.
    WithG85,
    /// Those without.
    WithoutG85,
}

impl Of {
    const fn has(self, control: Control) -> bool {
        let is_haas = matches!(control, Control::Haas);
        let has_g85 = !control.is_gsk();
        match self {
            Self::All => true,
            Self::Gsk => control.is_gsk(),
            Self::Fanuc => !control.is_gsk() && !is_haas,
            Self::Haas => is_haas,
            Self::NoHaas => !is_haas,
            Self::WithG85 => has_g85,
            Self::WithoutG85 => !has_g85,
        }
    }
}

const fn row(
    code: Code,
    of: Of,
    written: &'static str,
    tenths: &'static [(u16, u16)],
    en: &'static str,
    zh: &'static str,
) -> Refusal {
    Refusal {
        code,
        written,
        tenths,
        of,
        en,
        zh,
    }
}

/// All of them. The first row that fits counts.
#[rustfmt::skip]
pub(super) const REFUSALS: &[Refusal] = &[
    row(Code::PolarMoves, Of::All, "G7.1, G107, G12.1, G112", &[(71, 71), (1070, 1070), (121, 121), (1120, 1120)],
        "let the CAM system write X, Z and C themselves (no polar or cylindrical interpolation), with M05 and F per minute (G98; B, C: G94)",
        "请让 CAM 系统直接输出 X、Z、C（不用极坐标或圆柱插补），用 M05 和每分进给（G98；B、C 为 G94）"),
    row(Code::OtherControls, Of::Fanuc, "G05, G05.1, G08", &[(50, 51), (80, 80)],
        "leave it out: cuts that are joined (G64) look ahead anyway",
        "请省略：相连的切削（G64）始终预读"),
    row(Code::OtherControls, Of::Gsk, "G05", &[(50, 50)],
        "write the arc with G02 or G03, and R or I and K",
        "请用 G02 或 G03 加 R（或 I、K）编写圆弧"),
    row(Code::OtherControls, Of::Gsk, "G6.2, G6.3, G7.2, G7.3", &[(62, 63), (72, 73)],
        "write the curve as short lines or arcs, as with `WHILE` and `#` variables",
        "请将曲线写成短直线或圆弧，例如用 `WHILE` 和 `#` 变量"),
    row(Code::OtherControls, Of::All, "G09", &[(90, 90)],
        "write G61 in this block and G64 in the next one",
        "本段写 G61，下一段写 G64"),
    row(Code::OtherControls, Of::All, "G22", &[(220, 220)],
        "leave it out: the soft limits (1320, 1321) hold always",
        "请省略：软限位（1320、1321）始终有效"),
    row(Code::OtherControls, Of::All, "G26", &[(260, 260)],
        "leave it out: threads and taps watch the speed of the spindle anyway",
        "请省略：螺纹和攻丝始终监视主轴转速"),
    row(Code::OtherControls, Of::Haas, "G51", &[(510, 510)],
        "write G50 with U and W the other way, or call the offset 0 (T0100)",
        "请用 G50 反向写 U、W，或取消刀偏（T0100）"),
    row(Code::OtherControls, Of::NoHaas, "G51", &[(510, 510)],
        "nothing is scaled here: write the lengths as they are to be cut",
        "本系统不缩放：请按要切削的尺寸编写"),
    row(Code::OtherControls, Of::All, "G52", &[(520, 520)],
        "write the shifted zero into a coordinate system that is free, as with G10 L2 P6 X… Z…, and choose that (G59)",
        "请将偏移后的零点写入未使用的坐标系，如 G10 L2 P6 X… Z…，并选用它（G59）"),
    row(Code::OtherControls, Of::All, "G54.1, G110 to G129, G154", &[(541, 541), (1100, 1290), (1540, 1540)],
        "write one of G54 to G59: there are six coordinate systems",
        "请用 G54 至 G59：共有六个坐标系"),
    row(Code::OtherControls, Of::All, "G68", &[(680, 680)],
        "leave it out: this machine has one turret",
        "请省略：本机只有一个刀架"),
    row(Code::OtherControls, Of::All, "G84.1, G88.1, G184", &[(841, 841), (881, 881), (1840, 1840)],
        "a thread of the left hand: write M04 in front of G84 (G88), or for a rigid tap a negative S",
        "左旋螺纹：在 G84（G88）之前写 M04，刚性攻丝时写负的 S"),
    row(Code::OtherControls, Of::WithG85, "G86", &[(860, 860)],
        "write G85, which comes out at feed; or G01 to the bottom, M05, and G00 out",
        "请用 G85（以进给退出）；或写 G01 到孔底、M05、G00 退出"),
    row(Code::OtherControls, Of::WithoutG85, "G86", &[(860, 860)],
        "write G01 to the bottom, M05, and G00 out",
        "请写 G01 到孔底、M05、G00 退出"),
    row(Code::OtherControls, Of::Haas, "G87", &[(870, 870)],
        "write G01 to the bottom, M05, and M00, so that the operator moves the tool out by hand",
        "请写 G01 到孔底、M05，再写 M00，由操作者手动退刀"),
    row(Code::OtherControls, Of::Haas, "G91", &[(910, 910)],
        "write U and W (H for C) for increments, or G91 beside X and Z, or G28, in each block: it counts for that alone",
        "增量请用 U、W（C 用 H）；或在每一段把 G91 与 X、Z 或 G28 写在一起：它只在本段有效"),
    row(Code::OtherControls, Of::Haas, "G187 E", &[(1870, 1870)],
        "leave E out: parameter 9033 is the tolerance at corners",
        "请省略 E：拐角允差为参数 9033"),
    row(Code::OtherControls, Of::NoHaas, "G187", &[(1870, 1870)],
        "leave it out: parameter 9033 is the tolerance at corners",
        "请省略：拐角允差为参数 9033"),
    row(Code::PartOfOtherMachine, Of::Haas, "G05, G195, G196", &[(50, 50), (1950, 1960)],
        "this machine has no live tool of this kind: write the moves of the part without it",
        "本机没有此类动力刀具：请不用它编写加工"),
    row(Code::PartOfOtherMachine, Of::Haas, "G95, G186", &[(950, 950), (1860, 1860)],
        "this machine has no live tool that taps; where G95 is to be the feed per turn, write G99",
        "本机没有攻丝动力刀具；若 G95 指每转进给，请写 G99"),
    row(Code::PartOfOtherMachine, Of::Haas, "G14, G15, G198, G199", &[(140, 150), (1980, 1990)],
        "this machine has no second spindle: the other side of the part is a program of its own",
        "本机没有副主轴：工件另一端请另编程序"),
    row(Code::PartOfOtherMachine, Of::All, "G31", &[(310, 310)],
        "this machine has no probe: set the offsets by touching off (`leadscrew touch`), and leave it out",
        "本机没有测头：请对刀设定刀偏（`leadscrew touch`），并省略此代码"),
    row(Code::PartOfOtherMachine, Of::Gsk, "G36, G37", &[(360, 370)],
        "this machine has no contact that sets tools: touch off (`leadscrew touch`), and leave it out",
        "本机没有对刀仪：请手动对刀（`leadscrew touch`），并省略此代码"),
    row(Code::PartOfOtherMachine, Of::Fanuc, "G37", &[(370, 370)],
        "this machine has no contact that sets tools: touch off (`leadscrew touch`), and leave it out",
        "本机没有对刀仪：请手动对刀（`leadscrew touch`），并省略此代码"),
    row(Code::PartOfOtherMachine, Of::Fanuc, "G50.2, G51.2", &[(502, 502), (512, 512)],
        "this machine has no tool that turns geared to the work: mill the flats at rest with C",
        "本机没有与工件同步旋转的刀具：请用 C 轴定位后铣平面"),
    row(Code::PartOfOtherMachine, Of::Haas, "G100, G101", &[(1000, 1010)],
        "this machine mirrors nothing: write the signs as they are to be cut",
        "本机没有镜像：请按实际方向写正负号"),
    row(Code::PartOfOtherMachine, Of::Haas, "G105", &[(1050, 1050)],
        "this machine has no bar feeder: write M00, and let an operator pull the bar",
        "本机没有送料机：请写 M00，由操作者拉料"),
    row(Code::ReferenceMove, Of::All, "G27", &[(270, 270)],
        "leave it out: it moves nothing that G28 does not",
        "请省略：G28 已能完成同样的移动"),
    row(Code::ReferenceMove, Of::All, "G29", &[(290, 290)],
        "write G00 to the point where the work goes on",
        "请用 G00 移到继续加工的位置"),
    row(Code::CircularThread, Of::All, "G35, G36", &[(350, 360)],
        "write G32 for each piece of the thread that is straight: strokes that follow each other are one thread",
        "请将螺纹分成直线段，用连续的 G32 编写：相连的各段为同一螺纹"),
];

impl Refusal {
    /// What to write in its place.
    pub(super) const fn help(&self, lang: Lang) -> &'static str {
        match lang {
            Lang::En => self.en,
            Lang::Zh => self.zh,
        }
    }

    /// The codes, with the controls that the row is for.
    pub(super) fn heading(&self, lang: Lang) -> String {
        let (en, zh) = match self.of {
            Of::All => ("", ""),
            Of::Gsk => (" (GSK)", "（GSK）"),
            Of::Fanuc => (" (FANUC)", "（FANUC）"),
            Of::Haas => (" (Haas)", "（Haas）"),
            Of::NoHaas => (" (GSK, FANUC)", "（GSK、FANUC）"),
            Of::WithG85 => (" (FANUC, Haas)", "（FANUC、Haas）"),
            Of::WithoutG85 => (" (GSK)", "（GSK）"),
        };
        let note = match lang {
            Lang::En => en,
            Lang::Zh => zh,
        };
        format!("{}{note}", self.written)
    }

    /// The first and the last code of each range, in tenths, where the row is for this control.
    #[cfg(test)]
    pub(super) fn codes(&self, control: Control) -> Vec<u16> {
        let ends = |(from, to): &(u16, u16)| [*from, *to];
        match self.of.has(control) {
            true => self.tenths.iter().flat_map(ends).collect(),
            false => Vec::new(),
        }
    }

    fn has(&self, control: Control, tenths: u16) -> bool {
        let is_in = |(from, to): &(u16, u16)| (*from..=*to).contains(&tenths);
        self.of.has(control) && self.tenths.iter().any(is_in)
    }
}

/// The alarm of a code that there is not, as the one that says what it is, where other controls have it.
pub(super) fn by_name(control: Control, mut alarm: Alarm, tenths: u16) -> Option<Alarm> {
    let mut rows = (0..).zip(REFUSALS);
    let (number, refusal) = rows.find(|(_, refusal)| refusal.has(control, tenths))?;
    alarm.code = refusal.code;
    alarm.args[1] = Arg::Int(number);
    Some(alarm)
}

/// The alarm of a code that there is not; its second figure has a bit for each other control that has it.
pub(super) fn of_another(control: Control, mut alarm: Alarm, tenths: u16) -> Alarm {
    let has = |other: &Control| {
        let code = i64::from(tenths / 10);
        *other != control && tenths.is_multiple_of(10) && other.has_of_its_own(code)
    };
    // Nothing is said where the text may be a hand's slip in a code that none of them has.
    let with_it = (0..).zip(Control::ALL).filter(|(_, other)| has(other));
    let bits = with_it.fold(0, |bits, (number, _)| bits | 1_i64 << number);
    if bits != 0 {
        alarm.args[1] = Arg::Int(bits);
    }
    alarm
}

/// The row of an alarm.
pub(super) fn refusal(alarm: &Alarm) -> Option<&'static Refusal> {
    let Arg::Int(number) = alarm.args[1] else {
        return None;
    };
    let row = REFUSALS.get(usize::try_from(number).ok()?)?;
    (row.code == alarm.code).then_some(row)
}
