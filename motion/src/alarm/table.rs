//! The one list of alarms and warnings: number, cause and remedy in English and Chinese.

use postcard_schema::Schema;
use postcard_schema::schema::NamedType;
use serde::{Deserialize, Serialize};

/// Defines [`Code`]. A template may use `{0}`…`{3}` for the figures and `{w}` for the word's letter.
macro_rules! codes {
    ($($(#[$doc:meta])* $name:ident = $number:literal, $cause:literal, $help:literal, $zh:literal, $zh_help:literal;)*) => {
        /// Every alarm and warning. Numbers up to 999 are those GSK and FANUC users know; 4000–4899 are alarms of our
        /// own, 4900–4999 warnings.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
        #[serde(into = "u16", try_from = "u16")]
        #[repr(u16)]
        #[non_exhaustive]
        pub enum Code {
            $($(#[$doc])* $name = $number,)*
        }

        impl Code {
            /// All of them, in the order of the table.
            pub const ALL: &[Self] = &[$(Self::$name,)*];

            /// The number shown to the user.
            #[must_use]
            pub const fn number(self) -> u16 {
                self as u16
            }

            /// The condition with this number; `None` where there is none.
            #[must_use]
            pub const fn from_number(number: u16) -> Option<Self> {
                match number {
                    $($number => Some(Self::$name),)*
                    _ => None,
                }
            }

            /// Cause, as a template.
            #[must_use]
            pub const fn cause(self, lang: Lang) -> &'static str {
                match (self, lang) {
                    $((Self::$name, Lang::En) => $cause, (Self::$name, Lang::Zh) => $zh,)*
                }
            }

            /// What to change, as a template.
            #[must_use]
            pub const fn help(self, lang: Lang) -> &'static str {
                match (self, lang) {
                    $((Self::$name, Lang::En) => $help, (Self::$name, Lang::Zh) => $zh_help,)*
                }
            }
        }
    };
}

/// On the wire a code is its number.
impl From<Code> for u16 {
    fn from(code: Code) -> Self {
        code.number()
    }
}

impl TryFrom<u16> for Code {
    type Error = &'static str;

    fn try_from(number: u16) -> Result<Self, Self::Error> {
        Self::from_number(number).ok_or("no alarm has this number")
    }
}

impl Schema for Code {
    const SCHEMA: &'static NamedType = u16::SCHEMA;
}

/// Language of the texts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Lang {
    /// English.
    #[default]
    En,
    /// Chinese.
    Zh,
}

impl Code {
    /// True for a condition that is reported and does not stop anything.
    #[must_use]
    pub const fn is_warning(self) -> bool {
        // One of the storage stands with the alarms that it tells of beforehand.
        self.number() >= 4900 || matches!(self, Self::StorageWorn)
    }
}

codes! {

    // -- 00xx–01xx, 3000: macros and program flow, the numbers of FANUC; `language` ------------------------------------
    /// M98, G65, G66 or M97 without P.
    CallWithoutTarget = 76, "this call does not say what it calls: P is missing", "write P with the number of the program (M97: the number N of a block)",
        "该调用没有指定对象：缺少 P", "请用 P 写程序号（M97 为程序段号 N）";
    /// Calls inside calls; {0} how many there may be.
    CallsTooDeep = 77, "calls are nested more than {0} deep", "let a subprogram return before the next one is called; does one call itself?",
        "调用嵌套超过 {0} 层", "请先返回再调用；是否有子程序调用自身？";
    /// No such program in the file; {0} its number.
    ProgramNotFound = 78, "there is no program O{0} in {1}, and no file `{2}`", "write the subprogram into the same file, with O{0} in front and M99 at its end, or save it as that file",
        "{1} 中没有程序 O{0}，也没有文件 `{2}`", "请将子程序写入同一文件，开头为 O{0}，结尾为 M99，或另存为该文件";
    /// A result beyond the range of numbers.
    MacroOverflow = 111, "the result is too large to be a number", "correct the values of this calculation",
        "计算结果过大", "请修改参与计算的值";
    /// A division by zero, or the tangent of a right angle.
    DivisionByZero = 112, "this divides by zero", "test the divisor by IF before; TAN has no value at 90°",
        "除数为零", "请先用 IF 判断除数；90° 没有正切值";
    /// A macro statement that is not written as it must be.
    MacroStatement = 114, "this macro statement is not complete, or has something else in this place",
        "write `#1=…`, `IF[…]GOTO n`, `IF[…]THEN #1=…`, `GOTO n`, `WHILE[…]DO1` … `END1`, `G65 P… L…`, `M98 P…`",
        "宏语句不完整，或此处出现了别的内容", "请写 `#1=…`、`IF[…]GOTO n`、`IF[…]THEN #1=…`、`GOTO n`、`WHILE[…]DO1` … `END1`、`G65 P… L…`、`M98 P…`";
    /// A variable that does not exist, or that no value is known for here; {0} its number.
    VariableNumber = 115, "there is no variable #{0}", "use #1 to #33, #100 to #199 or #500 to #999; `docs/language.md` lists the system variables",
        "没有变量 #{0}", "请使用 #1 至 #33、#100 至 #199 或 #500 至 #999；系统变量见 `docs/language.md`";
    /// A variable that cannot be written; {0} its number.
    VariableReadOnly = 116, "variable #{0} can only be read", "write another variable", "变量 #{0} 只能读取", "请写入其他变量";
    /// Brackets inside brackets; {0} how many there may be.
    BracketsTooDeep = 118, "brackets are nested more than {0} deep", "put a part of it into a variable first",
        "括号嵌套超过 {0} 层", "请先把一部分存入变量";
    /// A value for which a function, or an operation on bits, has no result.
    FunctionArgument = 119, "there is no result for this value", "SQRT takes 0 or more, LN more than 0, ASIN and ACOS −1 to 1, BIN and BCD whole numbers of 8 digits, AND OR XOR numbers of 32 bits",
        "该值没有结果", "SQRT 的参数不小于 0，LN 大于 0，ASIN 和 ACOS 为 −1 至 1，BIN 和 BCD 为 8 位以内整数，AND OR XOR 为 32 位整数";
    /// G66 inside G66; {0} how many there may be.
    ModalCallsTooMany = 122, "more than {0} modal calls (G66) are in force", "write G67 first", "模态调用（G66）超过 {0} 层", "请先写 G67";
    /// DO and END that do not belong together; {0} the number.
    LoopUnmatched = 124, "DO{0} and END{0} do not belong together", "write one END{0} for each DO{0}, in the same program; loops inside each other have other numbers and do not cross",
        "DO{0} 与 END{0} 不对应", "请在同一程序中为每个 DO{0} 写一个 END{0}；嵌套的循环使用不同的编号，且不得交叉";
    /// An expression that is not written as it must be.
    Formula = 125, "the expression cannot be read here", "write numbers, variables, functions and brackets with operators between them: `#1+SIN[#2]*[3-#4]`",
        "此处的表达式无法识别", "请用运算符连接数值、变量、函数和方括号：`#1+SIN[#2]*[3-#4]`";
    /// DO or END without 1, 2 or 3.
    LoopNumber = 126, "DO and END take 1, 2 or 3", "write DO1 … END1, and DO2, DO3 for loops inside it", "DO 和 END 的编号为 1、2 或 3", "请写 DO1 … END1，内层循环用 DO2、DO3";
    /// Words and a macro statement in one block.
    MacroAndWords = 127, "words and a macro statement stand in one block", "write them in two blocks", "字与宏语句在同一程序段中", "请分成两个程序段";
    /// A jump to a block that is not there, or to the inside of a loop; {0} its number.
    JumpTarget = 128, "there is no N{0} here to go to", "write N{0} in front of a block of the same program; a jump into a loop is not possible",
        "此处没有可跳转的 N{0}", "请在同一程序的程序段前写 N{0}；不能跳入循环内部";
    /// A letter that no macro takes as an argument.
    ArgumentAddress = 129, "{w} is no argument of a macro", "write arguments after G65 with the letters A–F, H–K, M, Q–Z", "{w} 不能作为宏程序的参数", "请在 G65 之后用字母 A–F、H–K、M、Q–Z 写参数";
    /// #3000 = n, or H99 of G65; {0} the number of the alarm.
    ProgramAlarm = 3000, "the program itself raises alarm {0}", "the program says in this block what is wrong", "程序自身发出报警 {0}", "原因见该程序段";
    // -- 0061–0069: contour cycles G70–G73 --------------------------------------------------------------------------
    /// P or Q of a contour cycle is missing.
    ContourNumbers = 61, "the contour of this cycle is not told: {w} is missing",
        "write P with the N number of the contour's first block and Q with that of its last",
        "未指定该循环的轮廓：缺少 {w}", "请用 P 写出轮廓首段的 N 号，用 Q 写出末段的 N 号";
    /// A depth of cut that is not above zero, a retract below zero, or fewer than one pass.
    ContourDepth = 62, "{w} of this cycle is out of range", "write a depth of cut above zero, a retract of zero or more, and one pass or more",
        "该循环的 {w} 超出范围", "切深应大于零，退刀量不小于零，粗车次数至少为 1";
    /// The block ns or nf does not exist, or nf stands before ns; {0} its N number.
    ContourMissing = 63, "the contour has no block N{0}, or its last block stands before its first",
        "give the contour's first and last block the N numbers of P and Q, in this order",
        "轮廓中没有 N{0} 程序段，或末段在首段之前", "请使轮廓首段和末段的 N 号与 P、Q 一致，且首段在前";
    /// The contour goes back on itself; {0} the axis, {1} by how much.
    ContourTurnsBack = 64, "the contour turns back in {0}, by {1}",
        "let the contour go one way only: along the strokes always, in depth too unless the first block has both X and Z (type II)",
        "轮廓在 {0} 方向折返 {1}", "轮廓应单向变化：沿切削方向必须单调；首段不同时写 X 和 Z（类型 I）时，进刀方向也必须单调";
    /// The first block of a contour does not fit its cycle.
    ContourFirst = 65, "the first block of the contour cannot begin this cycle",
        "write G00 or G01 in that block, with X alone (G71), Z alone (G72), both (type II of either), or any of them (G70, G73)",
        "轮廓首段不符合该循环的要求", "首段中须写 G00 或 G01：G71 只写 X，G72 只写 Z，类型 II 两者都写，G70、G73 任意";
    /// A word or a code that a contour may not have.
    ContourWord = 66, "{w} may not stand in the contour of a cycle",
        "write moves G00 to G03 with their chamfers there, and F, S, T, M; calls, jumps and other cycles before or after",
        "循环的轮廓中不能使用 {w}", "轮廓中只写 G00 至 G03 及倒角、F、S、T、M；调用、跳转和其他循环请写在轮廓之外";
    /// The contour is longer than what is held; {0} the most.
    ContourLong = 67, "the contour has more than {0} blocks that move", "divide the contour between two cycles",
        "轮廓的移动程序段超过 {0} 段", "请将轮廓分给两个循环";
    /// More pockets than the cycle can hold; {0} how many, {1} how many one inside another.
    ContourPockets = 68, "the contour has too many pockets: {0} of 32 at most, or {1} of 8 at most one inside another",
        "cut some pockets with a cycle of their own", "轮廓的凹槽过多：共 {0} 个（最多 32），嵌套 {1} 层（最多 8）", "请用单独的循环加工部分凹槽";
    /// After a place above the start the contour comes down below the start again.
    ContourAboveStart = 69, "the contour rises above the start of the cycle before here, and comes down again",
        "start the cycle outside the whole contour", "轮廓在此之前超出循环起点，随后又低于起点", "请将循环起点设在整个轮廓之外";

    // -- 02xx–03xx: the trade's own numbers -------------------------------------------------------------------------
    /// Rigid tap: S missing, zero or above what it may be; {0} the highest.
    TapSpeed = 200, "rigid tapping needs a spindle speed S of 1 to {0} rpm",
        "write S in the block of the rigid M code (5200.0 = 0) or in the block of G84 or G88 (5200.0 = 1); parameters 5241 and 3772 set the highest",
        "刚性攻丝需要 1 至 {0} rpm 的主轴转速 S", "请在刚性攻丝 M 代码程序段（5200.0 = 0）或 G84、G88 程序段（5200.0 = 1）中写 S；最高转速由参数 5241、3772 设定";
    /// Tap without a feed, or with a lead of zero.
    TapFeed = 201, "the tap has no lead: F is missing, zero or out of range", "write F in the block of G84 or G88 (G98: lead times S; G99: the lead); after a change between G98 and G99 write it again",
        "攻丝没有导程：F 缺少、为零或超出范围", "请在 G84 或 G88 程序段中写 F（G98：导程乘 S；G99：导程）；G98 与 G99 切换后需重新写";
    /// The rigid M code or its S in the wrong place; {0} the M code.
    TapModePlace = 203, "M{0} and its S stand right before G84 or G88, once, and not with 5200.0 = 1",
        "write M{0} S in the block right before G84 or G88; after G80 write it again",
        "M{0} 及其 S 应紧接在 G84 或 G88 的前一段，只写一次；5200.0 = 1 时不写", "请在 G84 或 G88 的前一程序段写 M{0} S；G80 之后需重新写";
    /// An axis moves between the rigid M code and its G84 or G88; {0} the M code.
    TapModeAxis = 204, "an axis moves between M{0} and G84 or G88", "move before M{0}",
        "M{0} 与 G84 或 G88 之间有轴移动", "请在 M{0} 之前移动";
    /// Another plane in rigid mode.
    TapPlane = 206, "the plane changes in rigid tapping", "write G17, G18 or G19 before the rigid M code, or after G80",
        "刚性攻丝方式中切换平面", "请在刚性攻丝 M 代码之前或 G80 之后写 G17、G18 或 G19";
    /// The bottom on the wrong side of R, at R, or d > Q.
    TapDepth = 207, "the tap cannot go this way: its bottom is at R or on the side of the initial level, or D is more than Q",
        "let the tool come from the initial level through R to the bottom, and D be at most Q",
        "攻丝方向不对：孔底在 R 点或在初始平面一侧，或 D 大于 Q", "应由初始平面经 R 点到孔底，D 不大于 Q";
    /// F or I of a thread missing, zero, negative or out of range; {0} and {1} the range, of F where both are missing.
    LeadMissing = 313, "the thread has no lead: F or I is missing, or outside {0} to {1}",
        "write F (lead per turn) or I (turns per inch) in a thread block",
        "螺纹没有导程：F 或 I 缺少，或超出 {0} 至 {1}", "请在螺纹程序段中写 F（每转导程）或 I（每英寸牙数）";

    /// The thread angle is above 99°.
    ThreadAngleRange = 315, "thread angle {0}° is outside 0–99°", "give the angle of the tool in the last two digits of P",
        "螺纹角度 {0}° 超出 0–99°", "请在 P 的最后两位写刀具角度";
    /// Δdmin is larger than the whole depth k.
    MinStepAboveHeight = 316, "the smallest step {0} is larger than the thread height {1}",
        "make the step smaller (Q of the first block; where there is none, parameter 5140), or the height larger (P; in one block K)",
        "最小切削量 {0} 大于牙高 {1}", "请减小最小切削量（第一段的 Q；没有时为参数 5140），或增大牙高（P；单段格式为 K）";
    /// k or Δd of a thread missing, zero or negative; {0} the letter.
    ThreadDepth = 317, "the thread needs {0} above zero: its height (P; in one block K), or the depth of its first pass (Q; in one block D)",
        "write both, positive, in the block with X and Z",
        "螺纹需要大于零的 {0}：牙高（P；单段格式为 K）或第一刀切深（Q；单段格式为 D）", "请在含 X、Z 的程序段中写入两者，且均为正";
    /// Δd of a groove is negative.
    GrooveRelief = 318, "the relief R at the bottom of the groove is negative", "write R without a sign, or leave it out",
        "槽底退刀量 R 为负", "请写不带符号的 R，或省略";
    /// A step of a groove is missing or zero where one is needed.
    GrooveStepMissing = 319, "the groove needs a step here and has none",
        "write the infeed (P of G75, Q of G74), and the step along the other axis (Q of G75, P of G74) where its end differs from the start",
        "切槽缺少进刀量或进刀量为零", "请写每次进刀量（G75 为 P，G74 为 Q）；另一轴终点与起点不同时还要写其步距（G75 为 Q，G74 为 P）";
    /// A step of a groove is negative.
    GrooveStepNegative = 320, "the step {w} of the groove is negative", "write {w} without a sign",
        "切槽进刀量 {w} 为负", "请写不带符号的 {w}";

    // -- 4001–4099 text and words: program/ -------------------------------------------------------------------------
    /// A character that starts no word, comment or block.
    UnknownCharacter = 4001, "this character has no meaning here", "write a word: a letter and a number",
        "此处的字符没有意义", "请写一个字：字母加数字";
    /// A character outside ASCII outside a comment.
    NotAscii = 4002, "a character other than ASCII stands outside a comment",
        "write letters, digits, signs and spaces of the plain (half-width) kind; full-width parentheses are read in UTF-8 alone, not in GBK",
        "注释之外出现非 ASCII 字符", "请使用半角字母、数字、符号和空格；全角括号只在 UTF-8 文件中有效，GBK 文件请用半角括号";
    /// A letter without a number.
    NumberMissing = 4003, "{w} has no number", "write a number behind the letter, or remove it",
        "{w} 后没有数字", "请在字母后写数字，或去掉该字母";
    /// More digits than a number may have; {0} how many it may have.
    NumberTooLong = 4004, "the number of {w} has more than {0} digits", "write fewer digits",
        "{w} 的数字超过 {0} 位", "请减少位数";
    /// Two points in one number.
    SecondPoint = 4005, "the number of {w} has two points", "write one decimal point",
        "{w} 的数字有两个小数点", "请只写一个小数点";
    /// A line beyond the limit; {0} the limit in bytes.
    LineTooLong = 4006, "the line is longer than {0} bytes", "break it into several blocks",
        "该行超过 {0} 字节", "请分成几个程序段";
    /// `(` without `)`.
    CommentOpen = 4007, "this comment is not closed", "write `)` at its end; only after `;` or alone may it go on over the line",
        "注释没有结束", "请在末尾写 `)`；只有在 `;` 之后或单独成行时注释才可跨行";
    /// `)` without `(`.
    CommentClosed = 4008, "this `)` closes no comment", "write `(` where the comment begins",
        "此 `)` 没有对应的注释", "请在注释开始处写 `(`";
    /// `/` after other words.
    SkipNotFirst = 4009, "`/` stands after words of its block", "write `/` at the front of the block",
        "`/` 在程序段的字之后", "请把 `/` 写在程序段开头";
    /// `%` after words.
    PercentInBlock = 4010, "`%` stands in a block", "give `%` a line of its own",
        "`%` 在程序段中", "请让 `%` 单独占一行";
    /// A variable or an expression.
    MacroNotAvailable = 4011, "a macro cannot be read in this place", "write `#1=…`, or a letter with `#1` or `[…]`; a lone board reads numbers only",
        "此处不能读取宏", "请写 `#1=…`，或字母加 `#1` 或 `[…]`；控制板单独运行时只能读取数字";
    /// A letter this control has no word for.
    UnknownAddress = 4012, "there is no word {w} on this lathe", "use X Z C, or U W H for their increments",
        "本车床没有字 {w}", "请使用 X Z C，增量用 U W H";
    /// A word twice in a block.
    WordTwice = 4013, "{w} stands twice in this block", "remove one, or start a new block",
        "{w} 在此程序段中出现两次", "请去掉一个，或另起程序段";
    /// N or O after other words.
    WordNotFirst = 4014, "{w} stands after other words", "write {w} at the front of its block",
        "{w} 在其他字之后", "请把 {w} 写在程序段开头";
    /// X with U, Z with W, C with H; {0} and {1} the letters.
    AbsoluteAndIncrement = 4015, "{0} and {1} place the same axis in one block", "write {0} or {1}",
        "{0} 与 {1} 在同一程序段中指定同一轴", "请只写 {0} 或 {1}";
    /// Two G codes of one group; {0} and {1}.
    GroupTwice = 4016, "{0} and {1} exclude each other in one block", "write them in two blocks",
        "{0} 与 {1} 不能在同一程序段中", "请分成两个程序段";
    /// Two M codes of one group; {0} and {1}.
    MGroupTwice = 4017, "M{0} and M{1} exclude each other in one block", "write them in two blocks",
        "M{0} 与 M{1} 不能在同一程序段中", "请分成两个程序段";
    /// No such G code; {0}.
    UnknownG = 4018, "there is no {0}", "correct the code", "没有 {0}", "请修改代码";
    /// No such M code; {0} its number.
    UnknownM = 4019, "there is no M{0}", "correct the code", "没有 M{0}", "请修改代码";
    /// A G code that exists and is not built; {0}.
    GNotAvailable = 4020, "{0} is not available here", "write the moves with G00 to G03 or another cycle",
        "{0} 在此不可用", "请用 G00 至 G03 或其他循环编写运动";
    /// An M code that exists and is not built; {0} its number.
    MNotAvailable = 4021, "M{0} cannot be carried out in this place", "give it a block of its own, and write G80 before it where a cycle is in force",
        "此处不能执行 M{0}", "请单独写成一个程序段；若有循环有效，请先写 G80";
    /// G33 [D19].
    G33Tapping = 4022, "G33 is a tapping cycle on one control and a thread on another",
        "write G32, G92 or G76 for a thread", "G33 在不同系统中含义不同（攻丝或螺纹）", "切螺纹请用 G32、G92 或 G76";
    /// A point in a word that is a whole number.
    PointInInteger = 4023, "{w} is a whole number and has a point", "write it without a point",
        "{w} 为整数，不能有小数点", "请去掉小数点";
    /// A sign in a word that is a count.
    SignInInteger = 4024, "{w} takes no sign", "write it without a sign", "{w} 不能带符号", "请去掉符号";
    /// A number beyond its range; {0} and {1} the range.
    WordOutOfRange = 4025, "{w} is outside {0} to {1}", "write a value from {0} to {1}",
        "{w} 超出 {0} 至 {1}", "请写 {0} 至 {1} 之间的值";
    /// A digit other than 0 beyond the input increment; {0} the increment.
    DigitBeyondIncrement = 4026, "{w} has a digit beyond the smallest step {0}", "round it to {0}",
        "{w} 含有小于最小单位 {0} 的数字", "请舍入到 {0}";
    /// A target beyond what the machine arithmetic carries; {0} the limit.
    PositionOutOfRange = 4027, "this leads further than {0} from the machine's zero", "correct {w} or the coordinate system",
        "目标位置离机床零点超过 {0}", "请修改 {w} 或坐标系";
    /// A word that no code of the block uses.
    WordWithoutUse = 4028, "{w} belongs to no code of this block", "remove it, or write the code it belongs to",
        "{w} 不属于此程序段的任何代码", "请去掉它，或写出它所属的代码";
    /// Two codes that both take the axis words; {0} and {1}.
    AxisWordsTwice = 4029, "{0} and {1} both take the axis words of this block", "write them in two blocks",
        "{0} 与 {1} 都要使用此程序段的轴字", "请分成两个程序段";
    /// A second O number.
    SecondProgram = 4030, "a second program O{0} begins without M30 or M02 in front", "end the program before it with M30",
        "O{0} 之前的程序没有 M30 或 M02", "请在前面的程序末尾写 M30";
    /// A code without the words it needs; {0} the code.
    CodeNeedsWords = 4031, "{0} stands without words", "write the words that it needs",
        "{0} 没有所需的字", "请写出所需的字";
    /// P and X or U in G04.
    DwellTwice = 4032, "the time of the dwell stands twice", "write P (milliseconds) or X (seconds)",
        "暂停时间写了两次", "请只写 P（毫秒）或 X（秒）";
    /// U, W or H with G53.
    IncrementInMachineCoordinates = 4033, "{w} is an increment, and G53 takes machine coordinates", "write X, Z or C",
        "{w} 为增量，而 G53 使用机床坐标", "请写 X、Z 或 C";
    /// A cut without F; {0} the code.
    FeedMissing = 4034, "{0} cuts and no feed is set", "write F; after a change between G98 and G99 write it again",
        "{0} 为切削，但没有进给速度", "请写 F；G98 与 G99 切换后需重新写 F";
    /// S above the spindle's limit; {0} S, {1} the limit.
    SpeedWordTooHigh = 4035, "S{0} is above the spindle's {1} rpm (parameter 3772)", "write a smaller S",
        "S{0} 超过主轴最高转速 {1}（参数 3772）", "请减小 S";
    /// An offset number that does not exist; {0} the number, {1} the last one.
    ToolOffset = 4036, "there is no tool offset {0}", "write Txxyy with yy from 01 to {1}, or 00 for none",
        "没有刀补号 {0}", "请写 Txxyy，yy 为 01 至 {1}，00 表示取消";
    /// G02 or G03 outside the X–Z plane; {0} the code, {1} the plane.
    ArcPlane = 4037, "{0} in the plane of {1}: this lathe has arcs in X–Z only", "write G18 before it",
        "{0} 在 {1} 平面内：本车床只有 X–Z 平面圆弧", "请在前面写 G18";
    /// An arc without R, I and K; {0} the code.
    ArcCentreMissing = 4038, "{0} has neither R nor I and K", "write R, or I and K (from the start to the centre, radius)",
        "{0} 没有 R，也没有 I、K", "请写 R，或 I、K（起点到圆心，半径值）";
    /// R with I or K.
    ArcTwoCentres = 4039, "R and {w} both give the centre of the arc", "write R, or I and K",
        "R 与 {w} 都指定了圆心", "请只写 R，或 I、K";
    /// R0, or I0 K0.
    ArcWithoutRadius = 4040, "the arc has radius zero", "write the real R, or I and K",
        "圆弧半径为零", "请写实际的 R，或 I、K";
    /// R with the end equal to the start.
    FullCircleByRadius = 4041, "the end of the arc is its start: R does not say where the circle lies",
        "write I and K for a full circle", "圆弧终点与起点相同：R 不能确定圆的位置", "整圆请写 I 和 K";
    /// R shorter than half of the chord; {0} the shortest.
    ArcRadiusTooSmall = 4042, "no circle of this R reaches from start to end", "write R of at least {0}, or correct the end",
        "此 R 的圆弧不能从起点到达终点", "请写不小于 {0} 的 R，或修改终点";
    /// Start and end at different distances from the centre; {0} the difference.
    ArcEndOffCircle = 4043, "the end of the arc lies {0} off the circle", "correct the end, or I and K",
        "圆弧终点偏离圆周 {0}", "请修改终点，或 I、K";
    /// P(m)(r)(a) that is not up to six bare digits.
    PDigits = 4044, "P(m)(r)(a) is up to six digits without point and sign", "write two digits each for m, r and a: P020560",
        "P(m)(r)(a) 最多六位数字，不带小数点和符号", "请为 m、r、a 各写两位：P020560";
    /// A point in a word that counts increments; {0} the count meant.
    PointInIncrements = 4045, "{w} counts input increments and has a point", "write {w}{0}, or set parameter 182.7 = 1 for mm and inches",
        "{w} 以最小输入增量为单位，不能有小数点", "请写 {w}{0}，或设参数 182.7 = 1 使用 mm/inch";
    /// A minus in a word the sheets call unsigned.
    Negative = 4046, "{w} is negative here", "write {w} without a sign", "{w} 在此不能为负", "请写不带符号的 {w}";
    /// D other than 0 and 1.
    InfeedMode = 4047, "D is neither 0 nor 1", "write D0 (equal steps) or D1 (decreasing steps)",
        "D 既不是 0 也不是 1", "请写 D0（等距进刀）或 D1（递减进刀）";
    /// L outside 1–99.
    Starts = 4048, "L is outside 1 to 99", "write the number of thread starts, or leave L out for one",
        "L 超出 1 至 99", "请写螺纹头数，单头可省略 L";
    /// F and I in one thread block.
    TwoLeads = 4049, "F and I both give the lead", "write F (lead per turn) or I (turns per inch)",
        "F 与 I 同时指定导程", "请只写 F（每转导程）或 I（每英寸牙数）";
    /// G75 with a cycle word and no X or U.
    GrooveWithoutX = 4050, "the groove has no bottom", "write X or U", "切槽没有槽底", "请写 X 或 U";
    /// A zero byte, or the mark of UTF-16.
    WideText = 4051, "this is UTF-16 text (two bytes a character), or no text at all", "save the program as UTF-8 or plain ASCII (in an editor: Save as, Encoding: UTF-8)",
        "这是 UTF-16 文本（每字符两个字节），或者根本不是文本", "请将程序另存为 UTF-8 或纯 ASCII（编辑器：另存为 → 编码：UTF-8）";

    /// G74 with a cycle word and no Z or W.
    PeckingWithoutZ = 4054, "the pecking along Z has no bottom", "write Z or W", "Z 向啄式切削没有终点", "请写 Z 或 W";
    /// G96 with a thread or a tap.
    SurfaceSpeedInCycle = 4055, "a thread or a tap needs a spindle speed that stays, and G96 is in force", "write G97 S before it, with the speed in rpm",
        "螺纹与攻丝需要恒定转速，而当前为 G96", "请在前面写 G97 S（转速，rpm）";
    /// The first G96 without S.
    SurfaceSpeedMissing = 4056, "G96 has no surface speed", "write G96 S in m/min (G20: ft/min)",
        "G96 没有线速度", "请写 G96 S，单位 m/min（G20：ft/min）";
    /// G90, G92 or G94 before its end point is known; {0} the code, {1} the axis.
    CycleEndMissing = 4052, "{0} does not know where its cut ends in {1} yet", "write X and Z (or U and W) in its first block",
        "{0} 尚不知道 {1} 方向的终点", "请在首个程序段写 X 和 Z（或 U 和 W）";
    /// R of G90 or G94 against the infeed and longer than the infeed; {0} R, {1} the infeed.
    TaperAgainstInfeed = 4053, "R {0} points against the infeed of {1} and is longer: the cut would begin on the other side of the start",
        "reverse the sign of R, make it shorter, or start further out", "R {0} 与进刀 {1} 方向相反且更长：切削起点将越过循环起点",
        "请改变 R 的符号、减小 R，或将起点移远";

    /// J of an earlier G78 or G92 in force at a stroke of G32; {0} J.
    RunOutWithoutSide = 4057, "the run-out J {0} of an earlier G78 or G92 is in force, and says not to which side this stroke leaves the thread",
        "write J with its sign in this block (J plus: towards plus on the short axis, X on the radius), or J0 for no run-out",
        "此前 G78 或 G92 的退尾 J {0} 仍然有效，但没有说明本段向哪一侧退尾", "请在本段写带符号的 J（短轴正方向为正，X 为半径值），或写 J0 不退尾";
    /// J or K in a thread stroke of a control that has none; {0} the letter, {1} the code.
    StrokeWithoutRunOut = 4058, "{0} is no word of {1} on this control: a stroke ends where its block ends, without a run-out",
        "leave {0} out and lift the tool by the next block, or cut the thread by G92 or G76, which run out of it; J and K are words of the GSK controls (--dialect gsk980td)",
        "该系统的 {1} 没有 {0}：单段螺纹在段终点结束，不退尾", "请去掉 {0} 并在下一段退刀，或改用带退尾的 G92、G76；J、K 是 GSK 系统的字（--dialect gsk980td）";

    /// G34 without K.
    LeadChangeMissing = 4059, "G34 needs K, by how much the lead changes in each turn", "write K (minus where the lead becomes shorter), or G32 for a lead that stays",
        "G34 需要 K，即每转导程的变化量", "请写 K（导程变短时为负），导程不变时请用 G32";

    // 4060–4079: tapping.
    /// G84 or G88 without rigid mode and with a standing spindle; {0} the code, {1} the rigid M code.
    TapSpindleStands = 4060, "{0} without rigid mode, and the spindle stands",
        "for rigid tapping write M{1} S in the block before (or set 5200.0 = 1 and write S in the block of {0}); for ordinary tapping turn the spindle by M03 S or M04 S",
        "{0} 未指令刚性方式，且主轴静止",
        "刚性攻丝请在前一程序段写 M{1} S（或设 5200.0 = 1 并在 {0} 程序段中写 S）；普通攻丝请先用 M03 S 或 M04 S 使主轴旋转";
    /// The tap axis would be Y; {0} the code, {1} the plane.
    TapAxisMissing = 4061, "{0} in the plane of {1} taps along Y, and this lathe has no Y",
        "choose another plane before it, or set 5209.0 = 1 (G84 Z, G88 X)",
        "{0} 在 {1} 平面内沿 Y 轴攻丝，而本车床没有 Y 轴", "请先切换平面，或设 5209.0 = 1（G84 为 Z，G88 为 X）";
    /// No bottom; {0} the code, {1} the letter of its axis.
    TapBottomMissing = 4062, "{0} has no bottom", "write {1}, or its increment from the R plane", "{0} 没有孔底", "请写 {1}，或写距 R 平面的增量";
    /// K neither 1 to 99 nor 198.
    TapRepeats = 4063, "K is neither 1 to 99 nor 198", "write how often to tap, K198 to stay at the bottom, or leave K out",
        "K 既不是 1 至 99，也不是 198", "请写攻丝次数，停在孔底写 K198，或省略";
    /// A block that would tear the tap off or lose its phase; {0} the line of the K198.
    TapLocked = 4064, "the tap stands in its hole since K198 of line {0}, and this would take it out of phase",
        "go on with G84 or G88 to a deeper bottom, same axis, lead, hand and spindle, without R, hole position or the rigid M code",
        "自第 {0} 行 K198 起丝锥停在孔内，此段会使其失去同步", "请继续写 G84 或 G88：孔底更深，攻丝轴、导程、旋向、主轴不变，不写 R、孔位置和刚性攻丝 M 代码";
    /// A cycle or another motion while a tapping cycle is kept; {0} the code.
    TapCycleKept = 4065, "{0} while a tapping cycle is in force", "write G80 before it", "攻丝循环有效时指令 {0}", "请在前面写 G80";
    /// A spindle command in rigid mode.
    TapSpindleBusy = 4066, "the spindle is in position mode for tapping and takes no {w} here", "write G80 before it",
        "主轴处于攻丝位置方式，此处不能指令 {w}", "请在前面写 G80";
    /// A clamp code whose successor means something else; {0} and {1} the codes.
    TapClampCode = 4067, "M{0} cannot clamp: its successor M{1}, which would unclamp, means something else", "write another clamp code",
        "M{0} 不能用于夹紧：其后继 M{1}（松开）另有含义", "请写其他夹紧代码";
    /// K198 and nothing after it; {0} the line.
    TapLeftInHole = 4068, "the program ends with the tap in its hole", "go on with G84 or G88 to a deeper bottom, without K198",
        "程序结束时丝锥仍在孔内", "请继续写 G84 或 G88 到更深的孔底，不写 K198";
    /// K198 in ordinary tapping; {0} the rigid M code.
    TapStayNotRigid = 4078, "K198 needs rigid mode: only there the tap can stay in its hole", "write M{0} S before the cycle, or leave K198 out",
        "K198 需要刚性方式：只有刚性攻丝才能停在孔内", "请在循环前写 M{0} S，或省略 K198";

    // 4080–4089: the tapping return (G30 P99).
    /// G30 P99 with 5200.0 = 1.
    TapReturnByGCode = 4080, "the tapping return does not work with 5200.0 = 1", "set parameter 5200.0 to 0 for G30 P99",
        "参数 5200.0 = 1 时不能执行刚性攻丝返回", "执行 G30 P99 前请将参数 5200.0 设为 0";
    /// G20 and G21 changed since the hole; {0} the code in force, {1} that of the hole.
    TapReturnUnit = 4081, "{0} is in force, and the hole was tapped under {1}", "write {1} before G30 P99",
        "当前为 {0}，而攻丝时为 {1}", "请在 G30 P99 之前写 {1}";
    /// G30 P99, and no tap is in a hole.
    TapReturnNothing = 4082, "no tap is in a hole: the tap journal has nothing to return from", "nothing needs to be done; move the axis by hand or by program",
        "没有丝锥在孔内：攻丝记录中没有可返回的信息", "无需处理；可手动或用程序移动该轴";
    /// Motion after G30 P99; {0} the line of G30 P99.
    TapReturnNotLast = 4083, "after the tapping return in line {0} only the board knows where the tool is: nothing moves here",
        "end the program after G30 P99, and start another", "第 {0} 行刚性攻丝返回之后，程序不知道刀具位置，不能移动",
        "请在 G30 P99 之后结束程序，再启动另一个程序";

    // 4084: threads by strokes.
    /// A stroke of G32 or G34 after another, to which it cannot be joined.
    StrokeAfterStroke = 4084, "this stroke begins in the thread of the stroke before, and the tool would stop there while the spindle turns on",
        "write nothing but N, F, I, J, K and Q between strokes of G32, so that they are one thread (G34 cannot be joined), or lift the tool by G00",
        "本段从前一段的螺纹中开始，而刀具会停在该处，主轴仍在旋转", "G32 各段之间只写 N、F、I、J、K、Q，使其连成一条螺纹（G34 不能连接），或用 G00 退刀";

    /// A hole without a depth, on the wrong side of R, or of more than 9999 pecks.
    HoleDepth = 4085, "this hole has no depth below R, R is not between the initial level and the bottom, or Q makes more than 9999 pecks of it",
        "write a bottom beyond R, R as its distance from the initial level with its sign, and Q in the unit of this control",
        "该孔在 R 平面以下没有深度，或 R 不在初始平面与孔底之间，或 Q 使进给次数超过 9999", "请将孔底写在 R 平面之外，R 写为距初始平面的带符号距离，Q 使用本系统的单位";

    /// A line given by its angle, whose end is not told.
    AngleEnd = 4089, "the angle {w} and the words beside it do not tell where this line ends",
        "write {w} with X or Z of the end, whichever the line moves along: the other is calculated; or {w} alone, and next a line with {w}, X and Z, where the two meet",
        "角度 {w} 与同段的字不足以确定该直线的终点", "请将 {w} 与直线所移动轴的终点 X 或 Z 同写，另一个由系统计算；或只写 {w}，下一段直线写 {w}、X 和 Z，两线相交于一点";
    /// A feed per turn or a lead without a point, where numbers without one count increments.
    FeedWithoutPoint = 4090, "{w} has no point, and numbers without one count increments here (3401.0 = 0): for a feed per turn controls count 0.01, 0.001 or 0.0001 mm", "write it with a point, as F0.2",
        "{w} 没有小数点，而此处省略小数点的数以最小增量为单位（3401.0 = 0）；每转进给的单位因系统而异（0.01、0.001 或 0.0001 mm）", "请带小数点书写，如 F0.2";
    /// I in a thread of a control that does not count turns per inch; {0} the code of the thread [D440].
    TurnsPerInch = 4091, "{w} in {0} is turns per inch on a GSK and a taper on an old FANUC, and has no meaning here",
        "for turns per inch write F, the lead: 25.4 divided by them (G20: 1 divided by them); for a taper write R, the radius at the start less that at the end",
        "{0} 中的 {w} 在 GSK 上为每英寸牙数，在旧 FANUC 上为锥度，此处没有意义", "每英寸牙数请写成导程 F（25.4 除以牙数；G20 时为 1 除以牙数）；锥度请写 R，即起点半径减去终点半径";
    /// The same as 4085 on a Haas, whose R is a coordinate.
    HoleLevels = 4092, "this hole has no depth below R, R is not between the initial level and the bottom, or Q makes more than 9999 pecks of it",
        "write a bottom beyond R, R as a coordinate between the place where the tool stands before the cycle and the bottom, and Q in millimetres or inches",
        "该孔在 R 平面以下没有深度，或 R 不在初始平面与孔底之间，或 Q 使进给次数超过 9999", "请将孔底写在 R 平面之外，R 写为坐标值（位于循环前刀具位置与孔底之间），Q 以毫米或英寸为单位";
    /// G27 and G29; {0} the code.
    ReferenceMove = 4093, "{0}, a move about the reference point, is not built", "leave it out, or write G00",
        "未实现参考点指令 {0}", "请省略，或写 G00";
    /// G35 and G36; {0} the code.
    CircularThread = 4094, "{0}, a thread along an arc, is not built", "write G32 for each piece of the thread that is straight: strokes that follow each other are one thread",
        "未实现圆弧螺纹 {0}", "请将螺纹分成直线段，用连续的 G32 编写：相连的各段为同一螺纹";
    /// G7.1, G107, G12.1, G112; {0} the code.
    PolarMoves = 4095, "{0} moves X and C as one plane for a live tool, and is not built", "let the CAM system write these moves with X, Z and C of their own (without polar or cylindrical interpolation), the spindle stopped (M05) and F per minute (G98; FANUC B, C: G94)",
        "未实现 {0}（动力刀具的极坐标或圆柱插补）", "请让 CAM 系统直接输出 X、Z、C 的移动（不用极坐标或圆柱插补），主轴停止（M05），F 为每分进给（G98；FANUC B、C 为 G94）";
    /// A code of FANUC or Haas that does something, and is not built; {0} the code.
    OtherControls = 4097, "{0} of other controls is not built",
        "write it with codes of this control",
        "未实现其他系统的 {0}", "请用本系统的代码编写";
    /// A length without a point that is too large and may have been meant as increments; {0} what it is, {1} as increments.
    LengthWithoutPoint = 4098, "{w} has no point and is {0} here, which cannot be; as a count of increments it would be {1}",
        "write it with a point; where the whole program counts increments, read it with `--set 3401.0=0` (`leadscrew params set 3401.0=0` for good)",
        "{w} 没有小数点，此处为 {0}，不可能；若按最小增量计则为 {1}", "请带小数点书写；若整个程序都以最小增量为单位，请用 `--set 3401.0=0` 读取（`leadscrew params set 3401.0=0` 为永久设定）";
    /// GOTO, IF, WHILE, DO, END in the contour of a cycle.
    ContourFlow = 4099, "a jump or a loop may not stand in the contour of a cycle", "write the blocks of the contour one after the other; jumps and loops stand before or after, and `#1=` may stand between",
        "循环的轮廓中不能使用跳转或循环语句", "请依次书写轮廓各段；跳转和循环语句写在轮廓之外，赋值语句可写在其中";
    // 4086–4088: the program as a whole; `common` and `language`.
    /// A comment with DIALECT that names none.
    DialectUnknown = 4086, "there is no dialect of this name", "write one of gsk980td, gsk988, fanuc-a, fanuc-b, fanuc-c, haas: `(DIALECT FANUC-B)`",
        "没有该名称的方言", "请写下列之一：gsk980td、gsk988、fanuc-a、fanuc-b、fanuc-c、haas，如 `(DIALECT FANUC-B)`";

    /// The highest speed in a subprogram's file with another dialect; {0} its code.
    SpeedLimitElsewhere = 4087, "{0} S in a file of another dialect: under G97 it limits the speed on FANUC and Haas, and not on GSK", "set the highest speed in the program that was started, before the call, or write this file in the dialect of that program",
        "其他方言的文件中有 {0} S：在 G97 下，FANUC 和 Haas 受其限制，GSK 不受限制", "请在主程序调用之前设定最高转速，或用主程序的方言编写此文件";
    /// P and L of G10 name nothing that a table has.
    DataPlace = 4088, "G10 does not say which offset it writes",
        "write P0 (shift of all work offsets), P1 to P32 (wear) or P10001 to P10032 (geometry); with L2 P0 to P6 (shift, G54 to G59); with L10, L11, L12 (geometry, wear, radius) P1 to P32",
        "G10 未指明写入哪个偏置", "请写 P0（工件零点平移）、P1 至 P32（磨损）或 P10001 至 P10032（几何）；L2 时 P0 至 P6（平移、G54 至 G59）；L10、L11、L12（几何、磨损、半径）时 P1 至 P32";

    // -- 4100–4199 geometry of cycles: cycle/ -----------------------------------------------------------------------

    /// d leaves nothing to rough.
    AllowanceTooLarge = 4100, "the finishing allowance {0} is not smaller than the thread height {1}",
        "write a smaller R in the first block, or a larger P (height); R without a point is millimetres: 50 increments are R0.05",
        "精车余量 {0} 不小于牙高 {1}", "请减小第一段的 R，或增大牙高 P；R 省略小数点时以毫米为单位：50 个最小增量为 R0.05";
    /// W = 0.
    ThreadWithoutLength = 4101, "the thread has no length along Z", "write a Z that differs from the start, or W other than 0",
        "螺纹在 Z 向没有长度", "请写与起点不同的 Z，或不为 0 的 W";
    /// U = 0.
    ThreadWithoutSide = 4102, "start and end of the thread stand at one X: outside or inside cannot be told",
        "start away from the thread's X, by more than its height",
        "螺纹起点与终点 X 相同，无法判断内外螺纹", "请使起点 X 离开螺纹，距离大于牙高";
    /// A lies deeper than a crest; {0} how far, on the diameter: the board knows no coordinates but the machine's.
    StartInsideThread = 4103, "the start lies inside the work, {0} on the diameter below the crest of the thread",
        "start further from the work, or correct X, the height (P; in one block K) or the taper (R; in one block I)",
        "起点在工件内：低于螺纹牙顶 {0}（直径值）", "请使起点远离工件，或修改 X、牙高（P；单段格式为 K）或锥度（R；单段格式为 I）";
    /// The stroke of a pass is used up by run-in and run-out.
    StrokeTooShort = 4104, "pass {0} has no room to cut: stroke {1}, run-in {2}, run-out {3}",
        "start further away, or shorten the run-out (K; of a G76 in one block parameter 5130) or the run-in (E)",
        "第 {0} 刀没有切削行程：行程 {1}，旋进 {2}，退尾 {3}", "请使起点更远，或缩短退尾（K；G76 单段格式为参数 5130）或旋进（E）";
    /// The shift along the flank reaches the end of the thread.
    PassStartsBeyondEnd = 4105, "pass {0} would start {1} from the start point, and the thread is only {2} long",
        "start further away along Z, or use a smaller angle",
        "第 {0} 刀的切入点距起点 {1}，而螺纹长度只有 {2}", "请使起点沿 Z 向更远，或减小角度";
    /// The taper rises as fast as the run-out.
    RunOutIntoThread = 4106, "the run-out retracts {0} over {1}, but the taper rises {2} there: it would cut into the thread",
        "write a larger J or a smaller K (G76 in one block: a smaller parameter 5130; in G32 also mind the sign of J)",
        "退尾在 {1} 内退 {0}，而锥面在此上升 {2}，将切入螺纹", "请增大 J 或减小 K（G76 单段格式：减小参数 5130；G32 中还应检查 J 的符号）";
    /// E where X is the long axis.
    RunInWithLongX = 4107, "a run-in E is not possible where X is the long axis", "leave E out, or reduce the taper R",
        "X 为长轴时不能使用旋进 E", "请去掉 E，或减小锥度 R";
    /// More rough passes than the sequence may have.
    TooManyPasses = 4108, "the thread would take more than {0} rough passes", "write a larger Q (first depth) or a larger smallest step",
        "粗车次数将超过 {0} 次", "请增大第一刀切深 Q 或最小切削量";
    /// X_D = X_A in a groove.
    GrooveWithoutDepth = 4109, "the groove has no depth: its bottom is where it starts", "write an X (G74: Z) that differs from the start, or U (W) other than 0",
        "切槽没有深度：槽底与起点相同", "请写与起点不同的 X（G74 为 Z），或不为 0 的 U（W）";
    /// A length in a cycle is negative, zero or beyond the range of the machine arithmetic.
    CycleLengthRange = 4110, "{0} is not possible here: it must be a real length within ±4398 m",
        "correct the value", "此处不能为 {0}：必须是 ±4398 m 以内的有效长度", "请修改该值";

    /// L = 0.
    CycleStartsRange = 4111, "a thread has at least one start", "write L1 to L99, or leave L out",
        "螺纹至少有一个头", "请写 L1 至 L99，或省略 L";
    /// Infeeds of a column, columns, and the most of both together.
    TooManyGrooveInfeeds = 4112, "the groove would take {0} infeeds in each of {1} columns, and may take {2} altogether",
        "write a larger infeed or step (P and Q of G75, Q and P of G74); without a point and with 182.7 = 0 they count input increments, not millimetres",
        "切槽每列进刀 {0} 次，共 {1} 列，总次数超过 {2}", "请增大每次进刀量或步距（G75 为 P 和 Q，G74 为 Q 和 P）；182.7 = 0 时它们以最小输入增量为单位，不是毫米";
    /// An infeed of a groove, its retract, and how many infeeds that may be at most; on the radius.
    GrooveRetractTooLong = 4113, "each infeed of the groove is {0} on the radius (G74: along Z), and each retract R(e) of {1} takes back more than {2} of them",
        "write a larger infeed, P of G75, Q of G74 (with 182.7 = 0 it counts input increments, not millimetres), or a smaller R in the block before",
        "切槽每次进刀 {0}（G75 为半径值），而每次退刀 R(e) 为 {1}，超过进刀量的 {2} 倍", "请增大进刀量，G75 为 P，G74 为 Q（182.7 = 0 时以最小输入增量为单位，不是毫米），或减小前一段的 R";
    /// The lead of G34 outside 0.0001–500 mm; at the start, at the end.
    LeadLeavesRange = 4114, "the lead goes from {0} at the start to {1} at the end, and must stay between 0.0001 mm and 500 mm",
        "correct F or K, or write a shorter stroke", "导程从起点的 {0} 变到终点的 {1}，必须在 0.0001 mm 至 500 mm 之间", "请修改 F 或 K，或缩短行程";
    /// The lead of G34 reaches zero; F, where, the stroke.
    LeadUsedUp = 4115, "the lead {0} becomes shorter and is used up after {1}; the stroke is {2} long",
        "write a K nearer to zero, a larger F or a shorter stroke", "导程 {0} 逐渐变短，在 {1} 处已减为零；行程为 {2}", "请使 K 更接近零、增大 F 或缩短行程";
    /// A stroke of G34 beyond what its law is exact for; its length, the limit.
    VariableStrokeTooLong = 4116, "the stroke is {0} long; with a lead that changes it may be {1}", "write a shorter stroke",
        "行程为 {0}；变导程时不得超过 {1}", "请缩短行程";
    /// A chain of strokes that a board cannot hold; {0} the limit.
    ChainTooLong = 4117, "strokes of G32 that are joined may be {0}", "lift the tool by G00 and begin another thread, or write longer strokes",
        "相连的 G32 不得超过 {0} 段", "请用 G00 退刀后另起一条螺纹，或加长每段";
    /// A hole with too many infeeds; {0} the limit.
    TooManyPecks = 4130, "the hole would take more than {0} infeeds", "write a larger Q", "孔的进刀次数超过 {0}", "请增大 Q";
    /// A tap call that cannot be; for calls that no program made.
    TapCallRange = 4131, "speeds of a tap are above zero, and it goes on from between R and its bottom", "write S, or correct the depth",
        "攻丝转速应大于零，继续攻丝的起点应在 R 与孔底之间", "请写 S，或修改深度";

    // -- 4200–4299 physics: feasible/, motion/, spindle/ -------------------------------------------------------------
    /// A move would need a ramp longer than the profile can hold.
    SpeedOutOfReach = 4200, "reaching {0} takes longer than {1} ticks", "raise acceleration (1620) or jerk (1622), or lower the rapid rate (1420) or the feed",
        "达到 {0} 需要超过 {1} 个插补周期", "请提高加速度（1620）或加加速度（1622），或降低快速速度（1420）或进给速度";
    /// A feed of zero, or too slow to be told from it.
    FeedZero = 4201, "the feed is zero", "write F",
        "进给速度为零", "请写 F";
    /// A position beyond what the core computes with.
    MoveTooFar = 4202, "this move starts or ends more than {0} from zero", "correct the coordinates or the offsets",
        "该移动的起点或终点距零点超过 {0}", "请修正坐标或偏置";
    /// The centre of an arc is its start or its end.
    ArcNoRadius = 4203, "the arc has no radius", "write the centre with I and K, measured from the start of the arc",
        "圆弧没有半径", "请用 I 和 K 写出从圆弧起点到圆心的距离";
    /// Start and end of an arc are not equally far from its centre.
    ArcEndOff = 4204, "the arc starts {0} from its centre and ends {1} from it", "correct I and K or the end point: the two may differ by 10 µm, and by a quarter of the radius",
        "圆弧起点距圆心 {0}，终点距圆心 {1}", "请修正 I、K 或终点：两者之差不得超过 10 µm，也不得超过半径的四分之一";
    /// An arc with a rotary axis.
    ArcMovesC = 4205, "C cannot move in an arc", "move C in a block of its own",
        "圆弧中不能移动 C 轴", "请在单独的程序段中移动 C 轴";

    // 4250–4299: threads and the spindle.
    /// A thread, or a feed per turn, with a spindle that does not turn (or turns the other way).
    SpindleStopped = 4250, "the spindle does not turn", "start it before this block: M03 or M04 with S; where it is to stand because C moves, feed per minute (G98; FANUC B, C: G94)",
        "主轴没有旋转", "请在此程序段之前用 M03 或 M04 加 S 启动主轴；若因 C 轴移动而须停止，请用每分进给（G98；FANUC B、C 为 G94）";
    /// Lead times spindle speed above what the long axis may do.
    LeadTooFast = 4251, "at {3} the lead asks {1} of {0}; it may do {2}", "lower S or the lead",
        "主轴 {3} 时导程要求 {0} 轴达到 {1}，允许值为 {2}", "请降低 S 或减小导程";
    /// The run-out asks more of the short axis than its feed.
    RunOutTooFast = 4252, "at {3} the run-out asks {1} of {0}; it may do {2}", "lower S, or write a longer K or a smaller J (G76 in one block: a larger parameter 5130)",
        "主轴 {3} 时退尾要求 {0} 轴达到 {1}，允许值为 {2}", "请降低 S，或加大 K、减小 J（G76 单段格式：加大参数 5130）";
    /// Less than one pitch in the shortest stroke.
    PitchTooLong = 4253, "the pitch {0} is longer than the shortest stroke {1}", "F is the lead of the thread in length per turn, not a feed rate: write the lead",
        "螺距 {0} 大于最短行程 {1}", "F 是每转导程而不是进给速度，请写导程";
    /// Joining the helix and braking do not fit into the stroke.
    StrokeTooShortForSpeed = 4254, "at {3} the stroke {0} is too short: getting onto the lead takes {1} and leaving it {2}", "lower S or start further away",
        "主轴 {3} 时行程 {0} 太短：进入导程需 {1}，离开需 {2}", "请降低 S 或加大起刀距离";
    /// The run-in is too short for the short axis at this speed.
    RunInTooFast = 4255, "at {1} the run-in needs a length of {0}", "lower S or write a larger E",
        "主轴 {1} 时切入需要长度 {0}", "请降低 S 或加大 E";
    /// Commanded speed above the spindle's greatest.
    SpeedAboveSpindle = 4256, "S {0} is above the spindle's greatest speed {1}", "write a smaller S",
        "S {0} 超过主轴最高转速 {1}", "请减小 S";
    /// Measured speed above what the pass was planned for.
    SpindleTooFast = 4257, "the spindle turns at {0}, the pass is planned for at most {1}", "wait until it has settled, or check spindle and parameter 9010",
        "主轴转速为 {0}，该刀按不超过 {1} 规划", "请等待转速稳定，或检查主轴与参数 9010";
    /// The end of a move, or an arc's extreme, is beyond a soft limit.
    SoftLimit = 4258, "in machine coordinates {0} would go to {1}; its soft limit is {2}", "keep the program within the machine's travel, or check offsets and parameters 1320 and 1321",
        "{0} 轴将到达机床坐标 {1}，软限位为 {2}", "请使程序在行程之内，或检查偏置与参数 1320、1321";
    /// A stroke of a chain is used up by the corners at its ends; the stroke, both, the speed.
    StrokeTooShortInChain = 4265, "at {3} the stroke {0} of this chain is too short: the corner before it takes {1}, and the corner after it {2}",
        "lower S, or join fewer and longer strokes", "主轴 {3} 时链中该段 {0} 太短：其前的拐角需 {1}，其后需 {2}", "请降低 S，或减少段数并加长每段";
    /// The next stroke of a chain was not there in time.
    StrokeLate = 4266, "the next stroke of the chain was not planned in time", "this is a fault of the controller, not of the program: report it",
        "链中的下一段未及时规划好", "这是控制器的故障而不是程序错误，请报告";
    /// The moves handed over as one pass of a thread are not one.
    ThreadMovesMixed = 4259, "these moves are not one pass of a thread", "this is a fault of the controller, not of the program: report it",
        "这些动作不构成一刀螺纹", "这是控制器的故障而不是程序错误，请报告";
    /// A spindle that this machine does not have; {0} its number, {1} how many there are.
    TapSpindleNotAvailable = 4262, "there is no spindle {0} to tap with: the machine has {1} (parameter 9014)", "write another E or another of M24 to M27, or check the selection signals",
        "没有 {0} 号攻丝主轴：机床有 {1} 个（参数 9014）", "请改写 E 或 M24 至 M27，或检查主轴选择信号";
    /// The X drive and the spindle's act at different times; {0} and {1} the latencies in µs.
    TapDrivesApart = 4264, "a tap along X would leave its line: the X drive acts after {0} µs, the spindle's and Z's after {1} µs (9003)", "set up both drives alike, with 9003.X equal to 9003.Z, or tap along Z",
        "沿 X 轴攻丝将偏离同步：X 轴驱动延迟 {0} µs，主轴与 Z 轴驱动延迟 {1} µs（9003）", "请使两个驱动器相同（9003.X 等于 9003.Z），或沿 Z 轴攻丝";
    /// Two selection signals at once; {0} and {1} the spindles.
    TapSpindlesSelected = 4263, "the signals select spindle {0} and spindle {1} at once", "leave one of SWS1 to SWS4 on (5200.7 = 1: RGTSP1 to RGTSP4), or write E",
        "信号同时选择了 {0} 号和 {1} 号主轴", "请只接通 SWS1 至 SWS4（5200.7 = 1 时为 RGTSP1 至 RGTSP4）中的一个，或写 E";
    /// The spindle of an ordinary tap runs on; its speed.
    FloatSpindleRuns = 4270, "the spindle does not stop at the end of a stroke: it still turns at {0}",
        "check the spindle drive and parameter 9004; the holder had to give way",
        "行程结束时主轴没有停止：转速仍为 {0}", "请检查主轴驱动器和参数 9004；浮动夹头已被压缩";
    /// An ordinary tap by another spindle; {0} its number.
    FloatSpindleWithoutEncoder = 4271, "spindle {0} has no encoder here: an ordinary tap follows spindle 1 only", "write E1 or M24, or tap in rigid mode",
        "{0} 号主轴没有编码器：普通攻丝只能跟随 1 号主轴", "请写 E1 或 M24，或使用刚性攻丝";
    /// A gain of a drive that no position loop has: number of the parameter, value in tenths per second.
    GainTooLow = 4434, "a position loop with a gain of {1} times 0.1 /s ({0}) is too slow to be made up for", "write the gain of the drive, 50 (5 /s) or more, or 0 where nothing is to be taken off",
        "位置环增益 {1} × 0.1 /s（{0}）过低，无法补偿", "请填写驱动器的增益（至少 50，即 5 /s），不补偿时填 0";
    /// An axis that homes by a switch at the board, and no input is that switch.
    HomeSwitchNone = 4435, "axis {0} homes by a switch at the board (9050.{0} = 2), and no input is its switch", "set 9051.{0} to the input of the machine to which the switch is wired, 1 to 32, or to that of its drive, 33 to 35",
        "{0} 轴用接在控制板上的开关回零（9050.{0} = 2），但未指定开关的输入", "请将 9051.{0} 设为开关所接的机床输入（1 至 32），或其驱动器的输入（33 至 35）";
    /// The node of the input and output block is that of a drive, or the board's own.
    BlockNodeTaken = 4436, "the input and output block (9461) cannot have node {0}: a drive has it, or the board itself", "set the switch of the block to a node that is free, and 9461 to the same; drives are 9015 and 9016",
        "输入输出模块（9461）不能使用节点号 {0}：已由驱动器或控制板占用", "请将模块的节点开关和 9461 设为同一个空闲节点号；驱动器的节点号见 9015 和 9016";
    /// An input or output of a block that there is not; its number.
    BlockMissing = 4437, "input or output {0} is one of a block on the bus (17 to 32), and 9461 names none", "set 9461 to the node of the block (CiA 401), or use an input or output of the board, 1 to 16",
        "输入或输出 {0} 属于总线上的模块（17 至 32），但 9461 未指定模块", "请将 9461 设为模块（CiA 401）的节点号，或改用控制板的输入输出（1 至 16）";
    /// A zone with one of its two sizes: parameters of the size that is 0, and of the other.
    ZoneHalf = 4438, "a zone has a length and a diameter: {0} is 0, and {1} is not", "set both in one command (chuck: 9092 and 9093, jaws: 9094 and 9095), or both to 0 where there is no zone",
        "禁区须同时有长度和直径：{0} 为 0，而 {1} 不为 0", "请在一条命令中设定两者（卡盘：9092 和 9093，卡爪：9094 和 9095）；没有禁区时两者都设为 0";
    /// The two limit switches of an axis are one input.
    LimitSwitchShared = 4439, "both hard limit switches of axis {0} (9064.{0}, 9065.{0}) are one input: where it is on, nobody can tell which way leads off it", "wire each switch to an input of its own, or set the one of 9064.{0} and 9065.{0} that has no switch to 0",
        "{0} 轴的两个硬限位开关（9064.{0}、9065.{0}）是同一个输入：接通时无法判断应向哪个方向退出", "请把每个开关接到单独的输入；没有开关的一端（9064.{0} 或 9065.{0}）设为 0";
    /// A turret whose inputs and outputs are missing, or do not fit.
    TurretUnusable = 4433, "the turret (9451 = 2) cannot work", "set its stations (9452: 2 or more), the output that turns it (9454), the first input of its code (9455; the code needs inputs up to 32 at most) and the input of its clamp (9456)",
        "刀塔（9451 = 2）不能工作", "请设定工位数（9452，不少于 2）、转位输出（9454）、工位码的第一个输入（9455，全部码位不超过输入 32）和锁紧输入（9456）";
    /// A gear that is set in part, or that no drive can follow; {0} is its number.
    GearUnusable = 4432, "gear {0} cannot work", "set all three, 9430 + {0}, 9435 + {0} and 9440 + {0}, or none; at most 15 turns of the motor for one of the spindle, increments of the drive (9013) for a turn of the spindle that are a whole number, and a speed of at most 3772",
        "第 {0} 档不能工作", "9430 + {0}、9435 + {0}、9440 + {0} 应全部设定或全部为 0；电机与主轴圈数之比不超过 15，主轴每转的驱动脉冲数（9013）须为整数，转速不超过 3772";
    /// An encoder whose edges are not timed shakes an axis on this lead: lead, noise and limit in m/s², the longest lead.
    LeadForEncoder = 4272, "the counts of the spindle encoder would shake the axis by up to {1} m/s² on a lead of {0}; its acceleration is {2} m/s²",
        "write a lead of {3} or less, or let `leadscrew tune spindle` find the spindle's swing (9034), with which the angle is learned, or use an encoder with more lines or timed edges (3720, 9006.0), or lower 9005",
        "主轴编码器的计数在导程 {0} 上会使该轴抖动达 {1} m/s²，而其加速度为 {2} m/s²",
        "请写不大于 {3} 的导程，或用 `leadscrew tune spindle` 测出主轴摆动频率（9034）以便学习角度，或使用线数更多或捕获边沿时间的编码器（3720、9006.0），或减小 9005";
    /// An encoder tells too little of so slow a spindle: S, counts a second, the least S.
    SpeedForEncoder = 4273, "at {0} the spindle encoder gives {1} counts a second, too few to know its speed",
        "write S{2} or more, or use an encoder with more lines or timed edges (3720, 9006.0), or lower 9005",
        "主轴 {0} 时编码器每秒只有 {1} 个计数，不足以测定转速",
        "请写 S{2} 以上，或使用线数更多或捕获边沿时间的编码器（3720、9006.0），或减小 9005";
    /// The change of a lead accelerates an axis too much: axis, acceleration, what it may be, speed.
    LeadChangeTooFast = 4274, "at {3} the change of the lead accelerates {0} by {1} m/s² all the way; it may take {2} m/s²",
        "lower S, or write a K nearer to zero", "主轴 {3} 时导程变化使 {0} 轴全程加速 {1} m/s²，允许值为 {2} m/s²", "请降低 S，或使 K 更接近零";
    /// The spindle has not turned at one speed for long enough, so an encoder of few counts has not learned its swings:
    /// speed.
    SpindleNotSteady = 4275, "the spindle does not keep its speed of {0}, so an encoder of so few counts does not know its angle",
        "let the encoder learn the spindle's swing first (9034: `leadscrew tune spindle --write` finds it); then wait until the spindle keeps its speed, check its drive and belt, or use an encoder of 1000 counts with timed edges or more (3720, 9006.0)",
        "主轴不能稳定在 {0}，计数如此少的编码器无法得知其角度", "请先让编码器学习主轴的摆动（9034：`leadscrew tune spindle --write` 可测得）；然后等待主轴转速稳定，检查主轴驱动器和皮带，或使用捕获边沿时间且不少于 1000 个计数的编码器（3720、9006.0）";
    /// The spindle swings by more than an axis can follow: axis, speed.
    SpindleSwings = 4276, "at {1} the spindle swings by more than {0} can follow on this lead: the tool is farther beside the thread than 9035 allows",
        "where the encoder has few counts, let it learn the swing first (9034: `leadscrew tune spindle --write` finds it); then lower S or the lead, check the spindle's drive, belt and load, or raise the axis' acceleration and jerk if the machine allows",
        "主轴 {1} 时的摆动超出 {0} 轴在此导程上的跟随能力：刀具偏离螺纹超过 9035 的允许值", "编码器计数少时，请先让它学习摆动（9034：`leadscrew tune spindle --write` 可测得）；然后降低 S 或导程，检查主轴驱动器、皮带和负载，或在机床允许时增大该轴的加速度和加加速度";
    /// An encoder without times of edges knows the angle too badly for a thread: lead, the error along it, the
    /// greatest that is allowed, speed.
    EncoderUncertain = 4277, "at {3} the encoder knows the spindle within {1} along a lead of {0}; at most {2} is allowed",
        "write a smaller lead or S, use an encoder with more lines or timed edges (3720, 9006.0), or allow more (9035)",
        "主轴 {3} 时编码器在导程 {0} 上的误差可达 {1}；最多允许 {2}", "请减小导程或 S，使用线数更多或捕获边沿时间的编码器（3720、9006.0），或放宽允许值（9035）";
    /// No index within two turns and a second.
    NoIndex = 4260, "no index pulse from the spindle encoder", "check the encoder and its cable",
        "没有收到主轴编码器的零位脉冲", "请检查编码器及其电缆";
    /// The index came where none belongs.
    IndexSlipped = 4261, "the spindle encoder has lost or gained {0} counts", "check the encoder, its cable and parameter 3720",
        "主轴编码器丢失或多出 {0} 个计数", "请检查编码器、电缆与参数 3720";

    // -- 4300–4399 machine: board/, bus/ -----------------------------------------------------------------------------
    /// The operator's emergency stop.
    EmergencyStop = 4300, "emergency stop", "free the tool, then reset",
        "急停", "请先退出刀具，然后复位";
    /// A parameter set that does not pass its own checks.
    ParametersUnusable = 4301, "the parameters cannot work", "run `leadscrew params validate`, it names the reason",
        "参数无法工作", "请运行 `leadscrew params validate`，它会说明原因";
    /// A position that the drive's 32-bit target cannot hold.
    BeyondDriveRange = 4302, "the position of axis {0} is beyond what its drive can count",
        "check the drive increment (9001, 9002) and the soft limits (1320, 1321)",
        "{0} 轴的位置超出驱动器的计数范围", "请检查驱动器当量（9001、9002）和软限位（1320、1321）";
    /// The spindle does not reach its commanded speed.
    SpindleNotArrived = 4303, "the spindle turns at {0} instead of {1}", "check the spindle drive, its load and parameters 9004 and 9007",
        "主轴转速为 {0}，而不是 {1}", "请检查主轴驱动器、负载以及参数 9004 和 9007";
    /// RGTAP stays 1 where rigid mode ends.
    RigidNotReleased = 4306, "rigid tapping does not end: signal RGTAP has been 1 for a second", "take RGTAP away when the mode ends, or set 5200.2 to 0",
        "刚性攻丝方式无法解除：信号 RGTAP 持续为 1 已达 1 秒", "解除方式时请使 RGTAP 变为 0，或将 5200.2 设为 0";
    /// The clamp of the C axis does not hold, or no longer [D137].
    ClampOpen = 4307, "the clamp does not hold: its feedback is open", "check the clamp and its contact, then reset",
        "夹紧装置未夹紧：反馈触点断开", "请检查夹紧装置及其触点，然后复位";
    /// The clamp of the C axis does not let go [D191].
    ClampShut = 4308, "the clamp does not let go: its feedback is closed", "check the clamp and its contact, then reset",
        "夹紧装置未松开：反馈触点闭合", "请检查夹紧装置及其触点，然后复位";
    /// The spindle does not come to a stand for tapping.
    SpindleNotStopped = 4305, "the spindle still turns at {0} and cannot go into position mode", "check the spindle drive and parameter 9004",
        "主轴仍以 {0} 旋转，不能进入位置方式", "请检查主轴驱动器和参数 9004";

    /// M19: where the spindle stands, where it should, both within the turn.
    SpindleNotOriented = 4304, "the spindle has not arrived at its angle: it stands at {0} instead of {1}", "look at what holds the spindle; check its drive, its increments for a turn (9013) and its encoder (3720); then reset",
        "主轴未到达指定角度：位于 {0}，应为 {1}", "请检查主轴是否被卡住，以及其驱动器、每转脉冲数（9013）和编码器（3720）；然后复位";

    /// So many erases of each page of the storage, and how many its maker guarantees. A warning.
    StorageWorn = 4309, "the board's storage is worn: each of its pages has been erased {0} times, and {1} are guaranteed",
        "get another board in time; save what this one keeps (`leadscrew params pull`, `leadscrew tools pull`). A storage that takes nothing any more begins no hole (4311)",
        "控制板的存储器磨损：每页已擦除 {0} 次，保证次数为 {1} 次", "请及早准备更换控制板，并备份其保存的内容（`leadscrew params pull`、`leadscrew tools pull`）。存储器无法再写入时不再开始攻丝（4311）";

    /// Motion, or a spindle command, while a tap is in its hole; {0} its axis, {1} the bottom.
    TapInHole = 4310, "a tap is in its hole (axis {0}, bottom {1}): nothing but the tapping return may move", "run G30 P99; or drop the entry of the tap journal if no tap is there",
        "丝锥仍在孔内（{0} 轴，孔底 {1}）：只能执行刚性攻丝返回", "请执行 G30 P99；若孔内没有丝锥，请删除攻丝记录";
    /// The tap journal cannot be written before a hole.
    TapJournalNotWritten = 4311, "the tap journal could not be written: the hole is not begun", "check the board's storage, then reset",
        "攻丝记录写入失败：不开始攻丝", "请检查控制板的存储器，然后复位";
    /// The tap journal cannot be read at power-up.
    TapJournalDamaged = 4312, "the tap journal is damaged: whether a tap is in a hole is not known", "look at the machine; if no tap is in a hole, erase the board's storage (docs/hardware.md)",
        "攻丝记录已损坏：不知道孔内是否有丝锥", "请查看机床；若孔内没有丝锥，请擦除控制板的存储器（见 docs/hardware.md）";

    // 4330–4339: the board as a node.
    /// The heartbeat of the gateway has stayed away (9025 = 1).
    GatewayLost = 4330, "the gateway has fallen silent while a program ran", "look at its cable and at the program that operates the board; reset, and begin again",
        "程序运行中网关失去联系", "请检查网关电缆和操作程序；复位后重新开始";
    /// An NMT master has stopped or restarted the board while a program ran.
    NetworkStop = 4331, "the network has stopped the board while it worked (NMT)", "start the node again (NMT start), then reset",
        "控制板在工作中被网络停止（NMT）", "请重新启动节点（NMT start），然后复位";
    /// Somebody else sends as the board's node.
    NodeTwice = 4332, "another node on the bus has the number of this board", "give each board a number of its own, then restart both",
        "总线上另有节点使用本控制板的节点号", "请为每块控制板设置不同的节点号，然后重新启动";
    /// The cyclic frames do not fit: load in per cent, tick in µs, drives, kbit/s.
    BusOverload = 4333, "the cycle would take {0} of the bus: SYNC, {2} drives and the board's status every {1} µs at {3} kbit/s",
        "make the tick (9000) longer, let the drives (9021) or the board (9022) send their status less often, or raise the bit rate (9020)",
        "周期通信将占用总线 {0}：每 {1} µs 发送 SYNC、{2} 个驱动和控制板状态，波特率 {3} kbit/s", "请加长周期（9000）、减少驱动（9021）或控制板（9022）的状态发送次数，或提高波特率（9020）";
    /// `run` has come where no program waits for it. A warning in the event log.
    NothingToRun = 4334, "`run` did nothing: no program waits for it", "load a program first, also after a reset or an alarm; `resume` goes on after a feed hold",
        "“运行”命令无效：没有等待运行的程序", "请先装入程序（复位或报警之后也是如此）；进给保持之后请用“恢复”";

    // 4329, 4340–4349: the parameters that the board keeps.
    /// An image of another parameter table: its key, and the board's.
    ImageForeign = 4329, "the image is of parameter table {0}, and the board's is {1}: it has not been taken", "use the program and the board of one release, or migrate the file (`leadscrew params migrate`)",
        "该映像属于参数表 {0}，而控制板的参数表为 {1}：未采用", "请使用同一版本的程序与控制板，或转换参数文件（`leadscrew params migrate`）";
    /// The newest set stored is damaged, and the one before is whole.
    ParametersOlder = 4340, "the newest parameter set stored in the board is damaged: the last good one before it is loaded, and nothing may move",
        "compare it with the machine's file (`leadscrew params diff FILE`), then take it (`leadscrew params restore`, 5010h:05 = 1), or push another set",
        "控制板中最新保存的参数集已损坏：已装入之前最后一份完好的参数集，禁止运动", "请与机床参数文件比较（`leadscrew params diff FILE`），然后采用该参数集（`leadscrew params restore`，5010h:05 = 1），或写入另一参数集";
    /// Nothing whole is stored, and something was.
    ParametersLost = 4341, "the parameter sets stored in the board are damaged: the built-in set is loaded only to be talked to, and nothing may move",
        "push the machine's parameter set; or take the built-in one (1011h:01 = \"load\") if this is such a machine",
        "控制板中保存的参数集均已损坏：仅为通信装入了内置参数集，禁止运动", "请写入本机床的参数集；若机床与内置参数集相符，可采用内置参数集（1011h:01 = “load”）";
    /// The newest set belongs to another parameter table: schema and key of it, and of this board.
    ParametersForeign = 4342, "the stored parameter set has schema {0} (table {1}), this board has schema {2} (table {3}): it is not read, and nothing may move",
        "migrate the machine's file (`leadscrew params migrate`), then push it; or put back the software that stored the set",
        "保存的参数集为方案 {0}（表 {1}），本控制板为方案 {2}（表 {3}）：未读取，禁止运动", "请转换机床参数文件（`leadscrew params migrate`）后写入，或恢复写入该参数集时的软件";
    /// A set that was taken could not be stored.
    ParametersNotStored = 4343, "the parameter set could not be stored: the set before stays in force", "check the board's storage, then write it again",
        "参数集保存失败：原参数集继续有效", "请检查控制板的存储器，然后重新写入";
    /// A parameter is written while the machine works.
    ParametersAtWork = 4344, "parameters cannot be written while the machine works, or while a change is still being stored", "wait for the end of the program, or reset; then write again",
        "机床工作时或上一次修改尚未保存完时，不能写参数", "请等程序结束或复位后再写";
    /// 9026.0 is 0.
    ParametersProtected = 4345, "parameters are write-protected (9026.0 is 0)", "set 9026.0 to 1 first",
        "参数写保护（9026.0 为 0）", "请先将 9026.0 设为 1";
    /// A password is set, and was not given.
    PasswordMissing = 4346, "writing parameters needs the password (9028), which has not been given", "give the password first (5010h:06, `--password`)",
        "写参数需要密码（9028），尚未输入", "请先输入密码（5010h:06，`--password`）";
    /// A wrong password, or one that comes too soon; {0} how many in a row, {1} seconds until the next is heard.
    PasswordWrong = 4347, "wrong password, {0} in a row: the next one is heard after {1} s", "wait, then give the right one",
        "密码错误，已连续 {0} 次：{1} 秒后才接受下一次输入", "请等待，然后输入正确的密码";
    /// An image that is damaged, too short or too long.
    ParametersIncomplete = 4348, "the parameter set came damaged or incomplete, and has not been taken", "send it again",
        "收到的参数集损坏或不完整，未采用", "请重新发送";
    /// A value of an image is outside its range; {0} the number.
    ParametersOutOfRange = 4349, "parameter {0} of the set is outside its range; the set has not been taken", "correct the value (`leadscrew params validate`), then send the set again",
        "参数集中的参数 {0} 超出范围，未采用该参数集", "请改正该值（`leadscrew params validate`），然后重新发送";

    // 4350–4362: drives. {0} is the drive's letter, {1} its node.
    /// No status from a drive after it was started.
    DriveNoAnswer = 4350, "drive {0} (node {1}) does not answer",
        "check its supply, the bus wiring and termination, its node number and bit rate",
        "驱动器 {0}（节点 {1}）无应答", "请检查供电、总线接线与终端电阻、节点号和波特率";
    /// A drive stays in not ready to switch on, or in fault reaction.
    DriveNotInitialised = 4351, "drive {0} (node {1}) does not finish starting: statusword {2}",
        "wait for it to start; read the message on the drive", "驱动器 {0}（节点 {1}）未完成启动：状态字 {2}",
        "请等待其启动；查看驱动器上的信息";
    /// A drive does not leave quick stop.
    DriveNotReleased = 4352, "drive {0} (node {1}) stays in quick stop: statusword {2}",
        "read the message on the drive", "驱动器 {0}（节点 {1}）停留在快速停止状态：状态字 {2}", "请查看驱动器上的信息";
    /// A drive does not reach ready to switch on.
    DriveNotReady = 4353, "drive {0} (node {1}) did not become ready to switch on: statusword {2}",
        "check its enable and safe-torque-off inputs", "驱动器 {0}（节点 {1}）未进入准备接通状态：状态字 {2}",
        "请检查使能输入和安全转矩关断输入";
    /// A drive does not reach switched on.
    DriveNotSwitchedOn = 4354, "drive {0} (node {1}) did not switch on: statusword {2}",
        "check its power supply", "驱动器 {0}（节点 {1}）未接通：状态字 {2}", "请检查动力电源";
    /// A drive does not reach operation enabled.
    DriveNotEnabled = 4355, "drive {0} (node {1}) did not enable operation: statusword {2}",
        "check its enable input, brake and motor feedback", "驱动器 {0}（节点 {1}）未使能运行：状态字 {2}",
        "请检查使能输入、制动器和电机反馈";
    /// A drive stays in fault although it was reset.
    DriveFaultNotReset = 4356, "the fault of drive {0} (node {1}) stays after the reset: statusword {2}",
        "remove its cause, which the drive shows, and reset again", "驱动器 {0}（节点 {1}）复位后故障仍在：状态字 {2}",
        "请排除驱动器显示的故障原因后再复位";
    /// A drive reports a fault.
    DriveFault = 4357, "drive {0} (node {1}) has a fault: statusword {2}, error code {3}",
        "look the error code up in the drive's manual, remove the cause, then reset",
        "驱动器 {0}（节点 {1}）故障：状态字 {2}，错误代码 {3}", "请在驱动器手册中查找错误代码，排除原因后复位";
    /// A drive left operation enabled without being told to.
    DriveLost = 4358, "drive {0} (node {1}) left operation enabled by itself: statusword {2}",
        "check its enable and safe-torque-off inputs and its supply, then reset",
        "驱动器 {0}（节点 {1}）自行退出运行使能：状态字 {2}", "请检查使能输入、安全转矩关断输入和供电，然后复位";
    /// A drive restarted while it was in use.
    DriveRestarted = 4359, "drive {0} (node {1}) restarted", "check its supply, then reset",
        "驱动器 {0}（节点 {1}）重新启动", "请检查供电，然后复位";
    /// No status from an enabled drive.
    DriveSilent = 4360, "drive {0} (node {1}) has sent no status for {2} ticks",
        "check the bus wiring and the drive's TPDO1 (transmission type), then reset",
        "驱动器 {0}（节点 {1}）已有 {2} 个周期未发送状态", "请检查总线接线和驱动器的 TPDO1（传输类型），然后复位";
    /// An enabled drive is too far from its target for too long.
    FollowingError = 4361, "following error of drive {0} (node {1}): {2}, limit {3} (parameter 1828)",
        "check for a collision, the drive's tuning and the latency that is set for it (9003: a wrong one makes an error that grows with the speed), or lower acceleration and feed, then reset",
        "驱动器 {0}（节点 {1}）跟随误差 {2}，极限 {3}（参数 1828）", "请检查是否碰撞、驱动器参数，以及为其设定的延迟（9003：设错时误差随速度增大），或降低加速度和进给，然后复位";
    /// A drive was enabled, and its first demand is not where it stands.
    DriveJump = 4362, "drive {0} (node {1}) would have jumped by {2} after being enabled",
        "reset; if it comes again, report it as a fault of the program in the board",
        "驱动器 {0}（节点 {1}）使能后将跳动 {2}", "请复位；若再次出现，请作为控制板程序故障报告";

    // 4363–4369: the firmware of the board, as told at its next start.
    /// A watchdog has started the board anew: ticks since the start before.
    FirmwareHung = 4363, "the board's firmware hung, {0} ticks after its start, and its watchdog started it anew", "report it as a fault of the program in the board; then reset",
        "控制板固件在启动后 {0} 个周期停止响应，已由看门狗重新启动", "请作为控制板程序故障报告；然后复位";
    /// A fault of the processor: address of the instruction, return address, ticks since power-up, version.
    FirmwareFault = 4364, "the board's firmware stopped: processor fault at {0}, called from {1}, {2} ticks after power-up (firmware {3})",
        "report these figures as a fault of the program in the board; then reset",
        "控制板固件已停止：处理器故障，地址 {0}，调用自 {1}，上电后 {2} 个周期（固件 {3}）", "请将这些数据作为控制板程序故障报告；然后复位";
    /// A panic: addresses of the call and of the one its function came from, ticks since power-up, version.
    FirmwarePanic = 4365, "the board's firmware stopped: panic at {0}, called from {1}, {2} ticks after power-up (firmware {3})",
        "report these figures as a fault of the program in the board; then reset",
        "控制板固件已停止：panic，地址 {0}，调用自 {1}，上电后 {2} 个周期（固件 {3}）", "请将这些数据作为控制板程序故障报告；然后复位";
    /// The stack has left its memory: ticks since power-up, version.
    FirmwareStack = 4366, "the board's firmware stopped: its stack ran over, {0} ticks after power-up (firmware {1})",
        "report these figures as a fault of the program in the board; then reset",
        "控制板固件已停止：堆栈溢出，上电后 {0} 个周期（固件 {1}）", "请将这些数据作为控制板程序故障报告；然后复位";

    /// A brown-out: ticks since the start before.
    PowerDropped = 4367, "the supply of the board dropped for a moment, {0} ticks after its start", "check the supply and its wiring; then reset",
        "控制板供电在启动后 {0} 个周期瞬时跌落", "请检查电源及其接线；然后复位";
    /// No reset helps: how many failures, number of the last one's alarm, its place and what it was called from.
    FailsAgain = 4368, "the board has failed {0} times in a row, the last time with alarm {1} (place {2}, called from {3}): it stays at rest",
        "report these figures as a fault of the board; it moves again when it has been switched off for ten seconds or its processor has been reset",
        "控制板已连续失效 {0} 次，最近一次为报警 {1}（位置 {2}，调用自 {3}）：保持静止",
        "请将这些数据作为控制板故障报告；断电十秒或复位处理器后方可再次运动";
    /// The processor was reset by its button or a debugger: a warning, in the event log.
    ResetFromOutside = 4369, "the board's processor was reset from outside: its button, or a debugger",
        "nothing needs to be done where that was meant; else check the wiring of its reset pin",
        "控制板处理器由外部复位：复位按钮或调试器", "若为有意操作则无需处理；否则请检查复位引脚的接线";

    // 4370–4389: the bus as a whole.
    /// The controller has left the bus; errors counted while sending and receiving.
    BusOff = 4370, "bus-off: the board's CAN controller has left the bus ({0} errors sending, {1} receiving)",
        "check wiring, termination (120 Ω at both ends) and bit rate; once the board is back on the bus, start its node and reset",
        "总线脱离（bus-off）：控制板的 CAN 控制器已离开总线（发送错误 {0}，接收错误 {1}）",
        "请检查接线、终端电阻（两端各 120 Ω）和波特率；控制板重新上线后，启动节点并复位";
    /// The controller is error passive; errors counted while sending and receiving.
    BusPassive = 4371, "the board's CAN controller is error passive ({0} errors sending, {1} receiving)",
        "check wiring, termination (120 Ω at both ends) and bit rate, then reset",
        "控制板的 CAN 控制器处于被动错误状态（发送错误 {0}，接收错误 {1}）", "请检查接线、终端电阻（两端各 120 Ω）和波特率，然后复位";
    /// Setpoints came late for their SYNC; how many, and how many may.
    SetpointsLate = 4372, "{0} setpoints came late for their SYNC within a second, limit {1} (parameter 9027)",
        "take load off the bus and off the computer that is the board, or make the tick (9000) longer; then reset",
        "1 秒内有 {0} 个位置指令晚于其 SYNC，极限 {1}（参数 9027）", "请降低总线负载及控制板计算机的负载，或加长周期（9000），然后复位";
    /// Somebody else sends SYNC.
    SecondSync = 4373, "another node on the bus sends SYNC", "one alone gives the beat: give a second board a wire of its own, switch off any other node's SYNC (1005h bit 30); then reset",
        "总线上另有节点发送 SYNC", "节拍只能由一方给出：若为另一块控制板，请为其单独布线；若为其他节点，请关闭其 SYNC（1005h 第 30 位）；然后复位";
    /// Somebody else sends setpoints; the drive's letter and node.
    SecondSetpoints = 4374, "another node sends setpoints to drive {0} (node {1})", "take the second master off the bus, then reset",
        "另有节点向驱动器 {0}（节点 {1}）发送位置指令", "请将第二主站从总线上移除，然后复位";
    /// Somebody else stops or restarts a drive while the machine works; its letter and node.
    SecondManager = 4375, "another node has stopped or restarted drive {0} (node {1}) by NMT", "find who sends NMT commands to the drives, then reset",
        "另有节点通过 NMT 停止或重启了驱动器 {0}（节点 {1}）", "请查明由谁向驱动器发送 NMT 命令，然后复位";
    /// The staged set has another identity than the one that is to be committed.
    StagedSetGone = 4376, "the staged parameter set is not the one that is to come into force: somebody else has changed parameters meanwhile", "send the set again",
        "暂存的参数集不是要生效的参数集：其间另有人修改了参数", "请重新发送参数集";
    /// Two drives of a parameter set have one number; their letters, and the number.
    DriveNodeTwice = 4377, "drives {0} and {1} have the same node, {2}",
        "give each drive a number of its own: 9015 for an axis, 9016 for spindle 1, which spindles 2 to 4 (9014) follow",
        "驱动器 {0} 和 {1} 的节点号相同：{2}", "请为每个驱动器设置不同的节点号：各轴用 9015，1 号主轴用 9016，2 至 4 号主轴（9014）依次递增";
    /// A drive of the parameter set has the number of the board; its letter, and the number.
    DriveNodeOfBoard = 4378, "drive {0} has node {1}, which is the board's own",
        "give the drive another number (9015 for an axis, 9016 for the spindles), or start the board with another one",
        "驱动器 {0} 的节点号 {1} 与控制板自身相同", "请更改驱动器的节点号（各轴用 9015，主轴用 9016），或以其他节点号启动控制板";
    /// A set with setpoints in a frame of CAN FD, for a board that sends none.
    NoFd = 4383, "this board sends no frames of CAN FD, and 9031 asks for one with all setpoints",
        "set 9031 to 0: each drive gets its setpoints by its RPDO1",
        "本控制板不能发送 CAN FD 帧，而 9031 要求用一个 CAN FD 帧发送全部设定值", "请将 9031 设为 0：各驱动器用各自的 RPDO1 接收设定值";
    /// Rates of CAN FD that do not go together: of the data, nominal.
    FdRate = 4384, "the data of CAN FD frames cannot go at {0} kbit/s on a bus of {1} kbit/s",
        "set 9032 to 1000, 2000, 4000, 5000 or 8000, and not below the bit rate of the bus (9020)",
        "总线波特率为 {1} kbit/s 时，CAN FD 帧的数据段不能用 {0} kbit/s", "请将 9032 设为 1000、2000、4000、5000 或 8000，且不低于总线波特率（9020）";
    /// With setpoints in one frame a drive gets ready that is told nothing; its letter, its node, its statusword.
    DriveOverhears = 4385, "drive {0} (node {1}) gets ready before it is told to: it takes its setpoints from another drive's place in the frame for all ({2})",
        "map its RPDO1 (1600h) for its own place (`params push` with its section), then reset",
        "驱动器 {0}（节点 {1}）未收到指令即进入就绪：它从合并帧中其他驱动器的位置接收设定值（{2}）", "请按其自身位置映射其 RPDO1（1600h，用 `params push` 及其驱动器段），然后复位";
    /// A spindle in position mode stands, far from where it is told to be: letter and node of its drive, by how many
    /// increments, and how many are a quarter of a turn.
    SpindleStands = 4387, "the spindle of drive {0} (node {1}) stands {2} increments from where it is told to be, limit {3} (a quarter of a turn)",
        "a tap may be in its hole and not in phase any more: look before anything moves; check the spindle, its brake and its drive, then reset",
        "驱动器 {0}（节点 {1}）的主轴停止在距指令位置 {2} 个增量处，极限 {3}（四分之一转）", "丝锥可能在孔中且已失去同步：移动前请先查看；请检查主轴、其制动器和驱动器，然后复位";
    /// The controller could not read its own message memory, and has stopped sending [D193].
    BusRestricted = 4386, "the board's CAN controller has stopped sending: it could not read its own message memory in time",
        "start the board's node and reset; if it comes again, report it as a fault of the board",
        "控制板的 CAN 控制器已停止发送：未能及时读取其报文存储器", "请启动控制板节点并复位；若再次出现，请作为控制板故障报告";

    /// A data rate of CAN FD that this board's controller does not have; the nearest that it has.
    FdRateOfBoard = 4388, "this board's CAN controller cannot send the data of CAN FD frames at {0} kbit/s",
        "set 9032 to {1}, and the drives to the same rate",
        "本控制板的 CAN 控制器不能以 {0} kbit/s 发送 CAN FD 帧的数据段", "请将 9032 设为 {1}，并使各驱动器使用相同波特率";

    /// No frame fits between the setpoints: free µs, those of a frame, tick in µs, kbit/s.
    BusNoGap = 4389, "between the setpoints of two SYNCs {0} µs of the bus are free, and a frame takes {1} µs (every {2} µs at {3} kbit/s)",
        "make the tick (9000) longer: requests, answers and statuses go between the setpoints, or SYNC comes late",
        "两次 SYNC 的设定值之间总线只空闲 {0} µs，而一帧需要 {1} µs（周期 {2} µs，{3} kbit/s）", "请加长周期（9000）：请求、应答和状态在设定值之间发送，否则 SYNC 会推迟";

    // -- 4400–4499 parameters: params/ -------------------------------------------------------------------------------
    // Up to 4419 the figures are texts (keys, values, ranges), put in by whoever reads the file or the command line.
    /// A parameter file that is not TOML; {0} what the reader says.
    ParamSyntax = 4400, "this is not TOML: {0}", "write one value a line: `\"1420.X\" = \"12000 mm/min\"`",
        "不符合 TOML 格式：{0}", "每行写一个值：`\"1420.X\" = \"12000 mm/min\"`";
    /// A key that is no number, alias or name; {0} the key.
    ParamUnknown = 4401, "there is no parameter `{0}`", "`leadscrew params list` prints all numbers and names",
        "没有参数 `{0}`", "`leadscrew params list` 列出全部参数号和名称";
    /// The same where a name is near; {0} the key, {1} the name.
    ParamUnknownNear = 4402, "there is no parameter `{0}`", "did you mean `{1}`?",
        "没有参数 `{0}`", "是否为 `{1}`？";
    /// A number that has axes or bits, and none is named; {0} the key, {1} the choices.
    ParamPartMissing = 4403, "`{0}` does not say which bit or axis it means", "write {1}",
        "`{0}` 没有指明位或轴", "请写 {1}";
    /// An axis or bit that the number does not have; {0} the key, {1} the choices.
    ParamNoSuchPart = 4404, "there is no `{0}`", "write {1}",
        "没有 `{0}`", "请写 {1}";
    /// A value that is not a decimal number; {0} the parameter, {1} the text, {2} an example.
    ParamNotANumber = 4405, "{0}: `{1}` is not a decimal number", "write a value such as {2}",
        "{0}：`{1}` 不是十进制数", "请写如 {2} 的值";
    /// A value with a unit of another kind; {0} the parameter, {1} the text, {2} the spellings.
    ParamWrongUnit = 4406, "{0}: `{1}` has a unit that does not belong to it", "write one of these units: {2}",
        "{0}：`{1}` 的单位不对", "请用下列单位之一：{2}";
    /// A unit for a value that has none; {0} the parameter, {1} the text, {2} an example.
    ParamNoUnit = 4407, "{0}: `{1}` is more than a number, and the value has no unit", "write a plain number such as {2}",
        "{0}：`{1}` 不是单纯的数，而该值没有单位", "请写不带单位的数，如 {2}";
    /// A value in a file without its unit; {0} the parameter, {1} the text, {2} what to write.
    ParamUnitMissing = 4408, "{0}: `{1}` does not say its unit", "write {2}",
        "{0}：`{1}` 没有写单位", "请写 {2}";
    /// More digits than the smallest step has; {0} the parameter, {1} the text, {2} the step.
    ParamTooFine = 4409, "{0}: `{1}` is finer than can be kept", "round it to steps of {2}",
        "{0}：`{1}` 的位数超过可存储的精度", "请取整到 {2} 的倍数";
    /// A value outside its range; {0} the parameter, {1} the text, {2} and {3} the range.
    ParamOutOfRange = 4410, "{0}: `{1}` is out of range", "write a value from {2} to {3}",
        "{0}：`{1}` 超出范围", "请写 {2} 到 {3} 之间的值";
    /// One parameter twice in a file, under whichever of its names; {0} the parameter, {1} the line of the first.
    ParamTwice = 4411, "{0} is already set in line {1}", "keep one of the two",
        "{0} 已在第 {1} 行设定", "请只保留其中一个";
    /// A value of a TOML kind that no parameter has; {0} the parameter, {1} an example.
    ParamKind = 4412, "{0}: a value is a whole number, or a text with a unit", "write a value such as {1}",
        "{0}：值应为整数，或带单位的文本", "请写如 {1} 的值";
    /// A file for another version of the table; {0} its version, {1} this one.
    ParamSchema = 4413, "the file is of schema {0}, and this program reads schema {1}",
        "`leadscrew params migrate FILE` shows what has changed, and with `-o` writes a file of schema {1}",
        "该文件的参数表版本（schema）是 {0}，本程序读取版本 {1}",
        "`leadscrew params migrate FILE` 可查看有何变化，加 `-o` 可写出版本 {1} 的文件";
    /// A parameter file in another encoding; {0} its name.
    ParamEncoding = 4414, "this file is {0} text, and a machine file is UTF-8", "save it as UTF-8 (in an editor: Save as, Encoding: UTF-8)",
        "该文件的编码是 {0}，而机床参数文件应为 UTF-8", "请另存为 UTF-8（编辑器：另存为 → 编码：UTF-8）";
    /// A parameter file with a byte that is no text; {0} the byte.
    ParamNoText = 4415, "the byte {0} here is no UTF-8 text", "save the file as UTF-8 (in an editor: Save as, Encoding: UTF-8), or name another file",
        "此处的字节 {0} 不是 UTF-8 文本", "请将文件另存为 UTF-8（编辑器：另存为 → 编码：UTF-8），或指定另一个文件";
    /// A dialect in a file that is none; {0} what is written, {1} those that there are.
    ParamDialect = 4416, "there is no dialect {0}", "write one of {1}, as a text: `dialect = \"fanuc-b\"`",
        "没有方言 {0}", "请写下列之一（文本）：{1}，如 `dialect = \"fanuc-b\"`";
    /// `allow` in a file that is no list of numbers which can be silenced.
    ParamAllow = 4417, "`allow` is a list of numbers of what looks wrong: 4800 to 4811, 4976 to 4978, 4980 to 4991", "write `allow = [4800, 4985]`",
        "`allow` 是可疑之处的编号列表：4800 至 4811、4976 至 4978、4980 至 4991", "请写如 `allow = [4800, 4985]`";
    /// A ramp does not fit a profile: axis with the longest part of it, ticks, most ticks.
    RampTooLong = 4420, "speeding up takes {1} ticks, {0} most of them, and a profile holds {2}",
        "raise 1620.{0} or 1622.{0}, lower 1420.{0}, or make the tick (9000) longer",
        "加速需要 {1} 个周期（主要是 {0} 轴），超过上限 {2}", "请增大 1620.{0} 或 1622.{0}，减小 1420.{0}，或加长周期（9000）";
    /// Travel limits the wrong way round: axis.
    SoftLimitsInverted = 4421, "the travel limits of {0} leave no room: 1321.{0} is not below 1320.{0}",
        "make 1320.{0} larger than 1321.{0}; of C alone both may be \"none\", for no limit",
        "{0} 轴软限位之间没有行程：1321.{0} 不小于 1320.{0}", "1320.{0} 须大于 1321.{0}；仅 C 轴可都写 \"none\"，表示不设限位";
    /// Cutting faster than rapid: axis.
    FeedAboveRapid = 4422, "the cutting feed of {0} (1430.{0}) is above its rapid rate (1420.{0})",
        "lower 1430.{0} or raise 1420.{0}",
        "{0} 轴最大切削进给（1430.{0}）高于快移速度（1420.{0}）", "请减小 1430.{0} 或增大 1420.{0}";
    /// The observer cannot be that fast: bandwidth, tick in µs, highest bandwidth.
    ObserverTooFast = 4423, "an observer of {0} Hz cannot work on samples {1} µs apart",
        "set 9005 below {2} Hz, or make the tick (9000) shorter",
        "采样间隔 {1} µs 时 {0} Hz 的观测器不能工作", "9005 须小于 {2} Hz，或缩短周期（9000）";
    /// The spindle turns half a turn in a tick: highest speed of 3772, tick in µs, highest possible.
    SpindleTooFastForTick = 4424, "at {0} the spindle turns half a turn or more in one tick of {1} µs",
        "lower 3772 to {2}, or make the tick (9000) shorter",
        "{0} 时主轴在一个周期（{1} µs）内转过半圈以上", "请将 3772 减小到 {2}，或缩短周期（9000）";
    /// Travel beyond the 32 bits of a drive's target: axis.
    TravelBeyondDrive = 4425, "the travel of {0}, or the position of its mark, in drive increments does not fit the 32 bits of the target position",
        "make the increments coarser (9001.{0} / 9002.{0}) or the travel (1320.{0}, 1321.{0}) shorter, or correct 9058.{0}",
        "{0} 轴行程或参考标记位置的驱动脉冲数超过目标位置的 32 位", "请加大驱动当量（9001.{0}／9002.{0}）、缩短行程（1320.{0}、1321.{0}）或修改 9058.{0}";
    /// A following-error limit below one increment: axis.
    IncrementAboveLimit = 4426, "one drive increment of {0} is larger than its following-error limit (1828.{0})",
        "make the increments finer (9001.{0} / 9002.{0}) or the limit larger",
        "{0} 轴一个驱动脉冲大于跟随误差极限（1828.{0}）", "请减小驱动当量（9001.{0}／9002.{0}）或增大极限";
    /// Sixteen or more drive increments to a nanometre: axis.
    IncrementTooFine = 4428, "a nanometre of {0} is sixteen drive increments or more",
        "make the increments coarser (9001.{0} / 9002.{0}) and set the drive to them",
        "{0} 轴每纳米达到或超过 16 个驱动脉冲", "请加大驱动当量（9001.{0}／9002.{0}），并在驱动器中作相同设置";
    /// 9007 above 9010: both in per cent.
    ToleranceAboveVariation = 4427, "a spindle counts as arrived within {0} (9007), and threads keep room for {1} only (9010)",
        "lower 9007 or raise 9010",
        "主轴到达判据为 {0}（9007），而螺纹只为 {1}（9010）预留余地", "请减小 9007 或增大 9010";
    /// 5210 names a code with another meaning; {0} the code.
    TapCodeTaken = 4429, "M{0} cannot be the code of rigid tapping (5210): it means something else", "set 5210 to 0 (M29), or to a code that is free",
        "M{0} 不能作为刚性攻丝的 M 代码（5210）：它另有含义", "请将 5210 设为 0（M29）或未使用的代码";
    /// A value of the table of machine functions is no row; {0} is the value.
    FunctionUnusable = 4431, "{0} is no row of the table of machine functions", "write CCC H OO A II TTTT (docs/functions.md): each M code once, and none that has a meaning of its own",
        "{0} 不是机床功能表的有效行", "请按 CCC H OO A II TTTT 填写（见 docs/functions.md）：每个 M 代码一次，且不得已有含义";
    /// An encoder whose edges are not timed and that has too few counts for any thread: counts, counts that would do.
    EncoderCoarse = 4430, "an encoder of {0} counts a turn without the times of their edges tells too little of the spindle",
        "use an encoder of {1} counts (3720) or more, or hardware that times its edges (9006.0)",
        "每转 {0} 个计数且不捕获边沿时间的编码器不足以测定主轴",
        "请使用不少于 {1} 个计数的编码器（3720），或使用能捕获边沿时间的硬件（9006.0）";
    // 4440–4446, inputs, outputs and machine functions of parameter files: the figures are texts.
    /// No input or output of this name; {0} the name, {1} `input` or `output`.
    IoUnknown = 4440, "there is no {1} `{0}`", "name one: `[io.{0}]` with `at = \"{1}:1\"`, or write its place, as `{1}:1`",
        "没有名为 `{0}` 的 {1}", "请先命名：`[io.{0}]` 与 `at = \"{1}:1\"`，或直接写位置，如 `{1}:1`";
    /// An input where an output has to be, or the reverse; {0} the name, {1} what has to be.
    IoOtherSide = 4441, "`{0}` is no {1}", "write the name of an {1}, or its place, as `{1}:1`",
        "`{0}` 不是 {1}", "请写 {1} 的名称，或直接写位置，如 `{1}:1`";
    /// A key that such a table does not have; {0} the table, {1} the key, {2} those that there are.
    FieldUnknown = 4442, "{0} has no `{1}`", "write {2}",
        "{0} 中没有 `{1}`", "请写 {2}";
    /// A value of such a table; {0} the table, {1} the key, {2} what is written, {3} what can be.
    FieldValue = 4443, "{0}: `{1}` cannot be {2}", "write {3}",
        "{0}：`{1}` 不能是 {2}", "请写 {3}";
    /// A key that is missing; {0} the table, {1} the key, {2} an example.
    FieldMissing = 4444, "{0} needs `{1}`", "write {2}",
        "{0} 缺少 `{1}`", "请写 {2}";
    /// A key beside which another one has no meaning; {0} the table, {1} the key, {2} the other.
    FieldIdle = 4445, "{0}: `{1}` and `{2}` do not go together", "leave out one of them",
        "{0}：`{1}` 与 `{2}` 不能同时使用", "请删去其中之一";
    /// All rows are taken; {0} the M code.
    RowsTaken = 4446, "there is no row left for M{0}", "leave out another M code: a board has sixteen rows (9401 to 9416)",
        "M{0} 没有空行可用", "请删去另一个 M 代码：控制板共有 16 行（9401 至 9416）";
    // 4450–4459, drive sections of parameter files: the figures are texts.
    /// `[drive.NAME]` of a drive that no machine has; {0} the name.
    DriveUnknown = 4450, "there is no drive `{0}`", "write `[drive.X]`, Z, C, or S1 to S4 for a spindle",
        "没有驱动器 `{0}`", "请写 `[drive.X]`，或 Z、C，主轴为 S1 至 S4";
    /// A name that no object of a drive has; {0} the drive, {1} the key.
    DriveObjectUnknown = 4451, "drive {0}: there is no object called `{1}`",
        "write one of the names that `leadscrew params docs` lists, or index and sub-index in hexadecimal: `\"60C2.1\"`",
        "驱动器 {0}：没有名为 `{1}` 的对象",
        "请写 `leadscrew params docs` 列出的名称，或十六进制的索引和子索引：`\"60C2.1\"`";
    /// An object whose length nobody knows; {0} the drive, {1} the key.
    DriveType = 4452, "drive {0}: `{1}` does not say its type",
        "write both: `\"{1}\".type = \"u16\"` and `\"{1}\".value = 0`; types are u8 u16 u32 i8 i16 i32",
        "驱动器 {0}：`{1}` 没有写明类型",
        "请写类型和值：`\"{1}\".type = \"u16\"` 和 `\"{1}\".value = 0`；类型有 u8 u16 u32 i8 i16 i32";
    /// What an object cannot be; {0} the drive, {1} the key, {2} what stands there, {3} what may stand there.
    DriveValue = 4453, "drive {0}: `{1}` cannot be {2}", "write {3}",
        "驱动器 {0}：`{1}` 的值不能是 {2}", "请写 {3}";
    /// An object twice in one file; {0} the drive, {1} the object, {2} the line of the first.
    DriveTwice = 4454, "drive {0}: {1} is already set in line {2}", "keep one of the two",
        "驱动器 {0}：{1} 已在第 {2} 行设定", "请只保留其中一个";
    /// A drive that would interpolate over another time than the tick; {0} the drive, {1} its period, {2} the tick.
    DrivePeriod = 4455, "drive {0} would interpolate over {1} (60C2h), and a setpoint comes every {2} (9000)",
        "give both the same time", "驱动器 {0} 的插补周期为 {1}（60C2h），而设定值每 {2} 到达一次（9000）",
        "请把两者设为相同的时间";
    /// A drive that would answer at another rate than the board expects; {0} the drive, {1} its, {2} the board's.
    DriveRate = 4456, "drive {0} would send its status at every {1} SYNCs (1800h:02h), and the board expects it at every {2} (9021)",
        "give both the same number", "驱动器 {0} 每 {1} 个 SYNC 发送一次状态（1800h:02h），而控制板要求每 {2} 个（9021）",
        "请把两者设为相同的数";
    /// A PDO with other contents than the board's; {0} the drive, {1} the mapping object, {2} its, {3} the board's.
    DriveMapping = 4457, "drive {0}: {1} would be {2}, and the board needs {3}", "write {3}, or leave the mapping out",
        "驱动器 {0}：{1} 的映射为 {2}，而控制板需要 {3}", "请写 {3}，或不写该映射";

    /// A PDO under another identifier than the board's; {0} the drive, {1} the object, {2} its, {3} the board's.
    DriveCobId = 4458, "drive {0}: {1} would be {2}, and the board uses {3}", "write {3}, or leave it out: a drive has it by itself; its number is 9015, or 9016 for spindle 1",
        "驱动器 {0}：{1} 为 {2}，而控制板使用 {3}", "请写 {3}，或不写（驱动器默认即为此值）；节点号由 9015 给出，1 号主轴为 9016";
    /// What a drive cannot be by its profile; {0} the drive, {1} why.
    DriveProfile = 4459, "drive {0} cannot be set up by its profile: {1}",
        "correct what is named, or name another profile (`leadscrew drives list`), or leave `profile` out and write the objects in `[drive.{0}]`",
        "驱动器 {0} 无法按其配置文件设置：{1}",
        "请改正上述内容，或选择其他配置文件（`leadscrew drives list`），或不写 `profile` 而在 `[drive.{0}]` 中写各对象";

    // -- 4580–4589 offsets and tools: offsets/, board/ ------------------------------------------------------------------
    /// A table comes while a program is under way, held, or about to begin.
    OffsetsAtWork = 4580, "offsets and tools do not change while a program is under way or held", "let the program end, or reset it; then write again",
        "程序运行或保持期间不能修改偏置和刀具数据", "请等程序结束或复位，然后重新写入";
    /// A program or a change that was made with another revision; {0} its revision, {1} the board's.
    OffsetsOtherRevision = 4581, "this was made with revision {0} of the tool table, and the board has revision {1}", "somebody has changed offsets or tools meanwhile: look at them, then begin again",
        "此操作基于刀具表修订号 {0}，而控制板的修订号为 {1}", "期间有人修改了偏置或刀具数据：请查看后重新开始";
    /// A value out of its range, or finer than 0.1 µm; {0} its record.
    OffsetsOutOfRange = 4582, "record {0} of the tool table (1 to 32 tools, 33 the picked-up thread, 54 to 59 work offsets, 0 the shift) has a value out of its range; nothing has been written",
        "geometry up to 9999.9999 mm, wear up to 99.9999 mm, radius 0 to 99.9999 mm, work offsets up to 99999.9999 mm, tip 0 to 9, station 0 to 32, an angle below 360°; in steps of 0.0001 mm and 0.0001°",
        "刀具表记录 {0}（1 至 32 为刀具，33 为已拾取的螺纹，54 至 59 为工件零点，0 为平移）的值超出范围；未写入任何内容",
        "几何值不超过 9999.9999 mm，磨损不超过 99.9999 mm，半径 0 至 99.9999 mm，工件零点不超过 99999.9999 mm，刀尖方向 0 至 9，刀位 0 至 32，角度小于 360°；最小单位 0.0001 mm 和 0.0001°";
    /// The newest stored table is damaged, or of another layout; {0} the revision that is in force instead.
    OffsetsDamaged = 4583, "the newest tool table that the board has stored cannot be read; revision {0} is in force, and no program runs with it",
        "look at the table (`leadscrew tools list`), correct it, and write it again (`leadscrew tools push FILE`)",
        "控制板中最新的刀具表无法读取；当前为修订号 {0}，不能用它运行程序", "请查看刀具表（`leadscrew tools list`），改正后重新写入（`leadscrew tools push FILE`）";
    /// A table that could not be stored.
    OffsetsNotStored = 4584, "the tool table could not be stored; the one before stays in force", "check the board's storage, then write it again",
        "刀具表未能保存；之前的刀具表仍然有效", "请检查控制板的存储器，然后重新写入";
    /// Bytes that are no table, or a commit of a table that is not staged.
    OffsetsIncomplete = 4585, "this is no whole tool table, or not the one that was staged: it has not been taken", "send it again; use the program and the board of one release",
        "刀具表不完整，或与暂存的不同：未采用", "请重新发送；程序与控制板应为同一版本";
    /// A lead that changes, while threads follow a groove that was picked up.
    PickedUpVariable = 4586, "G34 cannot follow the groove that was picked up: its lead changes", "`leadscrew pickup --clear`, then start again; a groove of one lead is followed by G32, G76, G78 and G92",
        "G34 不能沿已拾取的牙槽切削：其螺距是变化的", "请先 `leadscrew pickup --clear`，再重新开始；G32、G76、G78、G92 可沿定螺距的牙槽切削";
    /// A thread that is picked up while the spindle turns; {0} its speed.
    PickupTurning = 4587, "the spindle turns at {0}, and a thread is picked up with the spindle standing", "stop the spindle (M05), turn it by hand until the tip sits in the groove, then try again",
        "主轴正以 {0} 旋转，拾取螺纹时主轴必须静止", "请停止主轴（M05），用手转动使刀尖落入牙槽，然后重试";
    /// A thread that is picked up before the index of the spindle has come.
    PickupNoIndex = 4588, "the spindle has not passed its index, so its angle is not known", "let the spindle turn once or twice (M03 with S, or by hand), stop it, then try again",
        "主轴尚未经过零位标记，角度未知", "请让主轴转一两圈（M03 与 S，或用手转动），停止后重试";
    // -- 4500–4599 operating: board/ ---------------------------------------------------------------------------------
    /// A request that the present mode does not let in: the mode that is needed, and the present one.
    WrongMode = 4501, "this needs the machine in mode {0}, and it is in mode {1}", "change the mode first (`leadscrew mode {0}`), while the machine stands",
        "此操作需要 {0} 方式，而机床处于 {1} 方式", "请先在机床静止时切换方式（`leadscrew mode {0}`）";
    /// A request that has to wait for the end of the program.
    ProgramUnderWay = 4502, "a program is under way", "wait for its end, or reset; then ask again",
        "程序正在运行", "请等待其结束或复位，然后重试";
    /// A request to a machine that stands on an alarm.
    AlarmStands = 4504, "the machine stands on an alarm", "remove its cause and reset; then ask again",
        "机床处于报警状态", "请排除原因并复位，然后重试";
    /// Another session moves the machine by hand.
    AnotherOperator = 4505, "another operator moves the machine by hand", "let them finish; one moves it at a time",
        "另一操作者正在手动移动机床", "请等其结束；同一时间只能由一人移动";
    /// Something keeps the machine from starting, turning its spindle or moving; {0} the
    /// [interlock](crate::operating::Interlock).
    Interlocked = 4506, "{0} keeps the machine from this", "remove what keeps it; then give the order again, and resume what is held",
        "{0}禁止此操作", "请先排除；然后重新下达指令，并恢复被保持的程序";
    /// The machine starts, comes to rest, or is moved by hand.
    NotAtRest = 4507, "the machine is not at rest", "wait until it stands and its drives are up, then ask again",
        "机床未静止", "请等待其停止且驱动器就绪，然后重试";
    /// An order without an echo of the board's time, or with an old one.
    OrderTooOld = 4508, "an order came too late, or did not say when it was given: it has not been carried out",
        "give it again; a sender of its own has to send back the beat of 5002h:01 (9047)",
        "指令到达过晚或未注明发出时间：未执行", "请重新下达；自编的发送方须回传 5002h:01 的节拍（9047）";
    /// More steps than wait.
    StepsWait = 4511, "three steps wait already: this one has not been taken", "wait until the axis has made them",
        "已有三步在等待：此步未被接受", "请等待该轴走完";
    /// A handwheel is to lead a program, and none follows it.
    NothingFollows = 4513, "no program follows the handwheel", "begin one that does (`leadscrew run PROGRAM --handwheel`)",
        "没有程序跟随手轮", "请以手轮方式运行程序（`leadscrew run 程序 --handwheel`）";
    /// A step that would leave the travel: axis, how far is free.
    StepBeyondLimit = 4540, "the step would leave the travel of axis {0}: {1} are free", "make a shorter step, or look at the soft limits (1320, 1321)",
        "该步将超出 {0} 轴行程：尚余 {1}", "请减小步距，或检查软限位（1320、1321）";
    /// The tip of a tool would enter a zone: the zone, the axis in which it goes less far into it, how far.
    ZoneEntered = 4541, "the tip of the tool would enter the zone of {0}: along {1} by {2}", "keep it away from there, or check the offsets, the geometry of the tool and the zones (9091 to 9097)",
        "刀尖将进入{0}禁区：沿 {1} 轴进入 {2}", "请避开该区域，或检查偏置、刀具几何值和禁区参数（9091 至 9097）";
    /// An axis is on its hard limit switch, or would go on towards it: the axis, the side, the side of the way off it.
    HardLimit = 4542, "axis {0} is on its hard limit switch on the {1} side", "reset, then move it off by hand: `leadscrew jog {0}{2} --hold`; if the axis is not there, look at the switch, its wire and its level (9064, 9065; 9421)",
        "{0} 轴压在 {1} 侧硬限位开关上", "请先复位，再手动退出：`leadscrew jog {0}{2} --hold`；若该轴不在该处，请检查开关、接线及电平（9064、9065；9421）";
    /// A drive does not tell its inputs, one of which is a hard limit switch: the axis.
    LimitInputsUntold = 4533, "the drive of axis {0} does not tell its inputs (60FDh), and a hard limit switch is one of them (9064.{0}, 9065.{0})", "map 60FDh into its TPDO2, sent on change and at every 16th SYNC at least (1801h:02 = 255, 1801h:05 its event time; `params push` with its section); then reset",
        "{0} 轴驱动器未报告其输入（60FDh），而硬限位开关是其中之一（9064.{0}、9065.{0}）", "请将 60FDh 映射到其 TPDO2，变化时发送且至少每 16 个 SYNC 发送一次（1801h:02 = 255，1801h:05 为其事件时间；用 `params push` 及其驱动器段）；然后复位";
    /// Zones are set, and where the tip of the tool is nobody knows: the number of its offset; 0: no tool was called.
    TipUnknown = 4543, "zones are set, and where the tip of tool {0} is was not measured in X and Z", "touch it off (`leadscrew touch`), or call a tool that was before the first move; zones are parameters 9091 to 9097",
        "已设置禁区，但 {0} 号刀具的刀尖位置未在 X 和 Z 方向测量", "请先对刀（`leadscrew touch`），或在首次移动前调用已测量的刀具；禁区为参数 9091 至 9097";
    /// A start in the middle of a program that its lines do not allow: {0} the line.
    NoStartHere = 4590, "the program cannot be started at line {0}", "start at the block that begins what this line belongs to, or at an earlier straight block with absolute X and Z",
        "程序不能从第 {0} 行开始", "请从该行所属循环或路径的起始程序段开始，或从更前面含绝对 X、Z 的直线程序段开始";
    /// A program was left, and reset, stopped or lost meanwhile.
    WayBackLost = 4591, "the program that was left is given up: the point where it was held is not known any more", "look where the tool is, then start the program again, or at a line (`leadscrew run PROGRAM --from N`)",
        "中途离开的程序已放弃：其保持点已不再有效", "请确认刀具位置，然后重新启动程序，或从某行启动（`leadscrew run PROGRAM --from N`）";
    /// A program is to begin, and a required axis has no reference; {0} to {2} the axes.
    NotReferenced = 4503, "not referenced: {0} {1} {2}", "home first (`leadscrew home`)",
        "未回零：{0} {1} {2}", "请先回零（`leadscrew home`）";
    /// An M code that has no meaning and no row in the table of machine functions.
    FunctionMissing = 4550, "M{0} has no row in the table of machine functions", "add it in one of the parameters 9401 to 9416 (docs/functions.md), or correct the code",
        "M{0} 在机床功能表中没有对应行", "请在参数 9401 至 9416 之一中添加（见 docs/functions.md），或修改代码";
    /// A function's answer has not come in its time: M code, input, time in ms.
    AnswerLate = 4551, "M{0} has not been answered: input {1} did not come to its level within {2} ms", "look what the function waits for, at the machine and at its input (`leadscrew status`); then reset",
        "M{0} 没有应答：输入 {1} 在 {2} ms 内未达到要求电平", "请检查机床及其输入（`leadscrew status`），然后复位";
    /// The answer of a function that is switched on has gone: input, output.
    AnswerLost = 4552, "input {0}, which answered for output {1}, has gone while that is on", "look at what the output switches, and at its input; then reset",
        "输出 {1} 接通期间，其应答输入 {0} 消失", "请检查该输出控制的装置及其输入，然后复位";
    /// Nothing is heard of the input and output block; its node, and the longest silence in ms.
    BlockSilent = 4553, "the input and output block, node {0}, is silent: no heartbeat for {1} ms", "look at its supply, its wire and its node and bit rate (9461, 9020), and whether it was set up (`params push`); then reset",
        "输入输出模块（节点 {0}）无响应：{1} ms 内没有心跳", "请检查其电源、接线、节点号和波特率（9461、9020），以及是否已配置（`params push`）；然后复位";
    /// The block has restarted; its node.
    BlockRestarted = 4560, "the input and output block, node {0}, has restarted: its outputs went off", "look at its supply; then reset, and switch on again what is needed (its outputs are as 9463 says)",
        "输入输出模块（节点 {0}）已重新启动：其输出曾断开", "请检查其电源；然后复位，并重新接通所需的输出（当前输出按 9463）";
    /// The block is not operational; its node.
    BlockStopped = 4561, "the input and output block, node {0}, is not operational", "look whether another program or master has stopped it, and at its own display; then reset",
        "输入输出模块（节点 {0}）不在运行状态", "请检查是否有其他程序或主站将其停止，并查看模块的显示；然后复位";
    /// The block sends heartbeats and no inputs; its node, and the longest silence in ms.
    BlockMute = 4562, "the input and output block, node {0}, sends heartbeats and no inputs (its TPDO1) for {1} ms", "set it up (`params push`: TPDO1 on change and every 100 ms), and look whether node {0} is such a block; then reset",
        "输入输出模块（节点 {0}）有心跳，但 {1} ms 内没有输入报文（TPDO1）", "请配置模块（`params push`：TPDO1 变化时及每 100 ms 发送），并确认节点 {0} 是此类模块；然后复位";
    /// The turret has not come to its station in its time; {0} is the station, {1} its code now, {2} the time in ms.
    TurretLate = 4570, "the turret has not come to station {0} within {2} ms: its code is {1}", "look at what keeps it, and at its output and code; then reset, and T again",
        "刀塔在 {2} ms 内未到达工位 {0}：当前工位码为 {1}", "请检查卡阻、输出和工位码；然后复位并重新执行 T";
    /// T where the turret would not be clear of the work; {0} is the axis.
    OutsideChange = 4571, "{0} is not where the turret may turn", "move X to 9458 and Z to 9459, or beyond, before T",
        "{0} 轴不在允许刀塔转位的位置", "请在 T 之前将 X 移到 9458、Z 移到 9459 或更远处";
    /// The turret is clamped at another station; {0} is the station, {1} its code.
    WrongStation = 4572, "the turret is clamped at station {1} instead of {0}", "look at its code and its stop; then reset, and T again",
        "刀塔锁紧在工位 {1}，而不是 {0}", "请检查工位码和定位；然后复位并重新执行 T";
    /// The turret is not clamped in its time; {0} is the station.
    NotClamped = 4573, "the turret is not clamped at station {0}", "look at its clamp and at the input of 9456; then reset, and T again",
        "刀塔在工位 {0} 未锁紧", "请检查锁紧机构和 9456 的输入；然后复位并重新执行 T";
    /// A station that the turret does not have; {0} is the station, {1} those that it has.
    StationMissing = 4574, "T names station {0}, and the turret has {1}", "correct T, or 9452",
        "T 指定工位 {0}，而刀塔只有 {1} 个工位", "请改正 T 或 9452";
    /// Motion while a turret stands between its stations.
    TurretBetween = 4575, "the turret was stopped on its way: nobody knows which tool is in", "T first; `leadscrew mdi T0101` does it, too",
        "刀塔在转位途中停止：不知道当前是哪把刀", "请先执行 T，例如 `leadscrew mdi T0101`";
    /// A speed with no gear selected.
    GearUnknown = 4554, "no gear is known, so the spindle cannot turn", "select one first: M41 to M44 (after power-up, too: nobody knows which one is in)",
        "档位未知，主轴不能旋转", "请先用 M41 至 M44 选择档位（上电后也须选择：此时档位未知）";
    /// A gear is selected while the spindle turns; {0} is the M code.
    GearTurning = 4556, "M{0} while the spindle is told to turn", "write M05 before it, and the speed after it",
        "主轴旋转时不能执行 M{0}", "请在其前写 M05，在其后写转速";
    /// S above the highest speed of the gear; {0} is S, {1} that speed, {2} the gear.
    SpeedAboveGear = 4557, "S{0} is above the {1} rpm of gear {2} (parameter 9440 + {2})", "write a smaller S, or select another gear (M41 to M44)",
        "S{0} 超过第 {2} 档的最高转速 {1}（参数 9440 + {2}）", "请减小 S，或选择另一档（M41 至 M44）";
    /// M41 to M44 for a gear that there is not; {0} is the M code.
    GearMissing = 4558, "M{0} selects a gear that this machine does not have", "correct the code, or set the gear's parameters (9431 to 9444)",
        "M{0} 选择的档位不存在", "请改正代码，或设定该档的参数（9431 至 9444）";
    /// The spindle is to be turned by hand, and its drive is in position mode.
    SpindleHeld = 4563, "the spindle is held at an angle (M19, or rigid tapping): it is not turned by hand", "let it go with M05 (`leadscrew mdi M5`), then press again",
        "主轴被保持在某一角度（M19 或刚性攻丝），不能点动", "请先用 M05 释放（`leadscrew mdi M5`），再重新点动";
    /// The spindle is to be turned by hand too fast; {0} is the speed, {1} the highest.
    SpindleJogTooFast = 4564, "a spindle jog at {0} rpm is above the spindle's {1} rpm (3772)", "ask for a lower speed, or lower 9049",
        "主轴点动转速 {0} 超过主轴最高转速 {1}（参数 3772）", "请降低所要求的转速，或减小 9049";
    /// Something that holds the work has let go while the spindle was on; {0} is the interlock.
    ClampingLost = 4555, "{0} while the spindle is on: the tool is withdrawn, the spindle is stopped", "look at what holds the work before anything turns again; then reset",
        "主轴接通时{0}：刀具退出，主轴停止", "再次旋转前请检查工件夹持；然后复位";
    // 4520–4529: homing. {0} is the axis.
    /// The drive has not found its mark within 9061 and 9062.
    HomeNotFound = 4520, "axis {0} has not found its reference mark within what 9061 and 9062 allow", "look whether the switch and its wire work, and at the way to home (9050, 9052; 6098h in the drive); then reset and home again",
        "{0} 轴在 9061 和 9062 允许的时间或距离内未找到参考标记", "请检查开关及其接线，以及回零方式（9050、9052；驱动器的 6098h）；然后复位并重新回零";
    /// A switch that stays on, is not where it was left, or that nobody tells; {1} its number (9051).
    HomeSwitchStuck = 4526, "the reference switch of axis {0}, input {1}, does not follow the axis: it stays on, is not where the axis has left it, or is not told at all", "look at the switch, its wire and its level (9421; at the drive, inputs 33 to 35, the drive's own setting); it has to stay on over the way in which the axis brakes from 9053, and be off within 9062",
        "{0} 轴的参考点开关（输入 {1}）不随轴动作：一直接通、不在轴离开它的位置，或没有输入信号", "请检查开关、接线及电平（9421；驱动器上的输入 33 至 35 由驱动器设定）；从 9053 制动的距离内开关应保持接通，并在 9062 之内断开";
    /// A homing was ended by the operator, by a stop, or by the loss of its operator.
    HomeCancelled = 4521, "homing was cancelled: its axis is not referenced", "home again, after a reset where the machine stands on this alarm",
        "回零已取消：该轴未回零", "请重新回零；机床处于此报警时请先复位";
    /// The drive reports an error, or has not started; {1} its statusword.
    HomeError = 4522, "the drive of axis {0} could not home: statusword {1}", "look at the drive's homing settings (6098h, 6099h, 609Ah), its switches and its own display; then reset and home again",
        "{0} 轴驱动器回零失败：状态字 {1}", "请检查驱动器回零设置（6098h、6099h、609Ah）、其开关及显示；然后复位并重新回零";
    /// A home offset in a drive; {0} the drive, {1} 607Ch.
    HomeOffset = 4524, "drive {0}: the home offset (607Ch) would be {1}, and has to be 0", "write the position of the mark into 9058 instead: drives differ in the sign of 607Ch",
        "驱动器 {0}：原点偏移（607Ch）为 {1}，必须为 0", "请将参考标记的位置写入 9058：各驱动器对 607Ch 的符号处理不同";
    /// A homing method that is not among those of the page; {0} the drive, {1} 6098h.
    HomeMethodUnknown = 4531, "drive {0}: homing method {1} (6098h) is none that the board knows the mark of", "write one of 1, 2, 7 to 14, 17 to 30, 33 to 35, 37",
        "驱动器 {0}：回零方式 {1}（6098h）不在已知方式之列", "请写 1、2、7 至 14、17 至 30、33 至 35 或 37 之一";
    /// An axis is to be homed that has no method; {0} the axis.
    HomeMethodNone = 4528, "axis {0} has no way to home: 9050.{0} is 0", "set 9050.{0} to the way in which it finds its reference; an axis without one needs none",
        "{0} 轴没有回零方式：9050.{0} 为 0", "请将 9050.{0} 设为其回零方式；没有回零方式的轴无需回零";
    /// A drive stays in its mode instead of homing; {0} the axis, {1} 6061h.
    HomeModeRefused = 4530, "the drive of axis {0} does not go into homing: its mode (6061h) is {1}", "look whether it has mode 6, and map 6060h into its RPDO2, and 6061h and 60FDh into its TPDO2 (`params push` with its section)",
        "{0} 轴驱动器未进入回零模式：其运行模式（6061h）为 {1}", "请确认其支持模式 6，并将 6060h 映射到其 RPDO2，将 6061h 和 60FDh 映射到其 TPDO2（用 `params push` 及其驱动器段）";
    /// A drive does not tell its inputs, one of which is the switch; {1} its number (9051).
    HomeInputsUntold = 4532, "the drive of axis {0} does not tell its inputs (60FDh), and its reference switch is one of them (9051.{0} = {1})", "map 60FDh into its TPDO2, sent on change and at every 16th SYNC at least (1801h:02 = 255, 1801h:05 its event time; `params push` with its section); then reset and home again",
        "{0} 轴驱动器未报告其输入（60FDh），而参考点开关是其中之一（9051.{0} = {1}）", "请将 60FDh 映射到其 TPDO2，变化时发送且至少每 16 个 SYNC 发送一次（1801h:02 = 255，1801h:05 为其事件时间；用 `params push` 及其驱动器段）；然后复位并重新回零";
    /// A drive moves by itself where it should stand: letter, node, how far it is from where it is held.
    DriveMovesOn = 4523, "drive {0} (node {1}) does not stand after homing: it is {2} from where it is told to be", "look at the drive's settings for halt and quick stop (605Dh, 605Ah) and at its load; then reset and home again",
        "驱动器 {0}（节点 {1}）回零后未停止：距指令位置 {2}", "请检查驱动器的暂停与急停设置（605Dh、605Ah）及负载；然后复位并重新回零";
    /// A drive is not in the mode that it was given: letter, node, 6061h; 0: not reported.
    DriveNotInMode = 4529, "drive {0} (node {1}) does not take the mode it is told: 6061h is {2}", "map 6060h into its RPDO2, and 6061h and 60FDh into its TPDO2 (`params push` with its section); then reset",
        "驱动器 {0}（节点 {1}）未进入指令的运行模式：6061h 为 {2}", "请将 6060h 映射到其 RPDO2，将 6061h 和 60FDh 映射到其 TPDO2（用 `params push` 及其驱动器段）；然后复位";

    // -- 4800–4811: what a program hardly means; a number may be allowed -----------------------------------------------
    /// A thread of a height that its pitch hardly has; {0} height, {1} pitch, {2} their ratio.
    ThreadHeightOdd = 4800, "a height of {0} on a pitch of {1} is {2} of it, and threads have 0.15 to 1.2",
        "correct P (in one block K) or F: without a point P may count increments (0.001 mm, or 0.0001 mm with parameter 1004.1 = 1; millimetres with 182.7 = 1); write L for further starts; `(ALLOW 4800)` in the program if it is meant",
        "牙高 {0}、螺距 {1}，比值 {2}，而螺纹一般为 0.15 至 1.2", "请修改 P（单段格式为 K）或 F：不带小数点的 P 可能以最小增量计（0.001 mm；1004.1 = 1 时 0.0001 mm；182.7 = 1 时为 mm）；多头螺纹请写 L；确实如此请在程序中写 `(ALLOW 4800)`";
    /// A first pass deeper than the thread; {0} its depth, {1} the height.
    FirstPassAboveHeight = 4801, "the first pass is {0} deep, and the thread {1}", "write a Q smaller than P (in one block a D smaller than K), both in the same unit; `(ALLOW 4801)` if it is meant",
        "第一刀切深 {0}，而牙高只有 {1}", "请写小于 P 的 Q（单段格式为小于 K 的 D），且单位相同；确实如此请写 `(ALLOW 4801)`";
    /// Hundreds of pecks; {0} pecks, {1} columns, {2} depth, {3} peck.
    PecksMany = 4802, "{0} pecks in each of {1} columns: {2} deep by {3}", "write P and Q in the unit of this control: a FANUC, and a GSK 980TD by 182.7, count increments (Q5000 is 5 mm), a Haas and a GSK 988 write millimetres (Q5.); `(ALLOW 4802)` if it is meant",
        "每列 {0} 次进给，共 {1} 列：深 {2}，每次 {3}", "请按本系统的单位写 P、Q：FANUC 和 GSK 980TD（182.7）为增量数（Q5000 即 5 mm），Haas 和 GSK 988 为 mm（Q5.）；确实如此请写 `(ALLOW 4802)`";
    /// A feed that makes sense in the other of G98 and G99 alone; {0} the feed, {1} S.
    FeedOfOtherMode = 4803, "F {0} at {1} turns a minute makes sense in the other of G98 and G99 alone", "write G98 (per minute) or G99 (per turn) before it, or another F; `(ALLOW 4803)` if it is meant",
        "主轴 {1} r/min 时 F {0} 只在 G98/G99 的另一方式下才合理", "请在前面写 G98（每分）或 G99（每转），或修改 F；确实如此请写 `(ALLOW 4803)`";
    /// A feed per turn that an axis cannot keep up with; {0} F, {1} the speed, {2} the speed that would do.
    FeedBeyondAxis = 4806, "F {0} at {1} turns a minute is more than an axis feeds (parameter 1430)", "write a smaller F, or S {2} at most; `(ALLOW 4806)` if it is meant",
        "主轴 {1} r/min 时 F {0} 超过轴的最高切削进给（参数 1430）", "请减小 F，或使 S 不超过 {2}；确实如此请写 `(ALLOW 4806)`";
    /// A cut deeper than a usual insert, or a feed per turn above its nose radius; {0} the figure, {1} the most.
    CutBeyondInsert = 4807, "this cut takes {0} where its insert takes {1}: a depth of 8 mm at most, and a feed per turn of the nose radius at most", "cut in more passes, write a smaller F, or correct parameters 9201 to 9216 (nose radius) or the comment `(STOCK ..)`; `(ALLOW 4807)` if it is meant",
        "此切削为 {0}，刀片最多 {1}：背吃刀量不超过 8 mm，每转进给不超过刀尖半径", "请分多次切削、减小 F，或修改参数 9201 至 9216（刀尖半径）或注释 `(STOCK ..)`；确实如此请写 `(ALLOW 4807)`";
    /// C moves with another axis while the spindle turns.
    TurningAxisTurns = 4808, "C moves together with another axis, and the spindle turns by itself", "write `,C` for a chamfer (L on a GSK); stop the spindle by M05, and feed per minute (G98; FANUC B, C: G94), for the C axis; `(ALLOW 4808)` if it is meant",
        "C 与其他轴同时移动，而主轴正在旋转", "倒角请写 `,C`（GSK 为 L）；使用 C 轴请先用 M05 停主轴，并用每分进给（G98；FANUC B、C 为 G94）；确实如此请写 `(ALLOW 4808)`";

    // -- 4850–4868, 4876, 4877 program flow: `language` ---------------------------------------------------------------
    /// A loop that goes on for ever; {0} how many statements it may have without a motion.
    RunawayLoop = 4850, "this loop has carried out {0} statements without a motion", "correct the condition that ends it",
        "该循环已执行 {0} 条语句而没有移动", "请修改结束循环的条件";
    /// A subprogram that does not return; {0} the number by which it was called.
    SubprogramOpen = 4851, "what P{0} called ends without M99", "write M99 at its end", "P{0} 调用的程序末尾没有 M99", "请在末尾写 M99";
    /// Loops that go on for ever; {0} how often they may begin again in one program.
    EndlessProgram = 4852, "loops of this program have begun again {0} times: it seems to have no end",
        "correct the condition that ends this one; a program that is to repeat itself has M99 at its end",
        "本程序的循环已重复 {0} 次，似乎没有结束", "请修改结束该循环的条件；需要重复执行的程序应在末尾写 M99";
    /// A program that is not in the file, and whose number is too long for a file of its own; {0} its number.
    ProgramNotInFile = 4853, "there is no program O{0} in this file", "write the subprogram into the same file, with O{0} in front and M99 at its end; files of their own have numbers up to O9999",
        "本文件中没有程序 O{0}", "请将子程序写入同一文件，开头为 O{0}，结尾为 M99；单独成文件的程序号最大为 O9999";
    /// The file of a subprogram begins with another number; {0} the number that was called, {1} the one that it has.
    ProgramFileOfOther = 4854, "the file of program O{0} holds O{1}, and no O{0}", "write O{0} in front of it, or call it by its own number from a file of that name",
        "程序 O{0} 的文件中是 O{1}，没有 O{0}", "请在开头写 O{0}，或以文件名所示的程序号调用";
    /// A subprogram in a file of its own that is too long; {0} the lines that it may have.
    SubprogramLong = 4855, "a subprogram in a file of its own may have {0} lines", "write it into the file of the program, which may have any length", "单独成文件的子程序最多 {0} 行", "请将它写入主程序文件，该文件长度不限";
    /// A line of the file of variables that is none; {0} the line.
    VariableEntry = 4856, "`{0}` is no value of a variable that is kept", "write `#500 = 1.5` with a number from #500 to #999, or remove the line; `--variables` names another file",
        "“{0}”不是保持型变量的值", "请写如 `#500 = 1.5`（#500 至 #999），或删去该行；`--variables` 可指定另一个文件";
    /// A variable that the file of variables has twice; {0} its number, {1} the first line.
    VariableEntryTwice = 4857, "#{0} is here a second time, after line {1}", "remove one of the two lines",
        "#{0} 重复，首次出现在第 {1} 行", "请删去其中一行";
    // 4858–4862: system variables whose value nobody knows where the text is read.
    /// A clock or a date; {0} its number.
    ClockVariable = 4858, "#{0} is a clock of the machine, and a program is calculated before the machine moves",
        "write G04 to wait; `simulate` tells how long a program takes; keep a date or a figure of your own in #500 to #999",
        "#{0} 是机床的时钟，而程序在机床运动之前就已计算", "等待请用 G04；程序用时见 `simulate`；日期或自定的数值可存入 #500 至 #999";
    /// The parts that were made, or are to be made; {0} its number.
    PartsVariable = 4859, "#{0} counts parts on the machine, and a program is calculated before the machine moves",
        "count in a variable that is kept, with `#500=#500+1` in front of M30; `run --passes 10` repeats a main program with M99 ten times",
        "#{0} 是机床的工件计数，而程序在机床运动之前就已计算", "请用保持型变量计数，在 M30 之前写 `#500=#500+1`；`run --passes 10` 将以 M99 结尾的主程序重复十次";
    /// What would keep single block, feed hold, the override or the exact stop from acting; {0} its number.
    InhibitVariable = 4860, "#{0} can only be 0 here: nothing in a program takes single block, feed hold or the override from the operator",
        "leave it out",
        "#{0} 在此只能为 0：程序不得使操作者的单段、进给保持或倍率失效", "请省略";
    /// An input or output; {0} its number.
    SignalVariable = 4861, "#{0} is a signal of the machine, and a program is calculated before the machine moves",
        "give the signal an M code of its own in the table of machine functions: it sets an output, or waits for an input",
        "#{0} 是机床信号，而程序在机床运动之前就已计算", "请在机床功能表中为该信号指定 M 代码：用于输出，或等待输入";
    /// The modal code of a group, or word, that the control does not have; {0} its number.
    GroupVariable = 4862, "#{0} tells a code that this control does not have",
        "leave it out: there is nothing to keep and to put back; `docs/language.md` lists those that there are, and the tool offset is part of T (#4120)",
        "#{0} 所指的代码本系统没有", "请省略：没有需要保存或恢复的内容；现有各组见 `docs/language.md`，刀偏号包含在 T（#4120）中";
    // 4863–4865: words and codes of other controls.
    /// I, J or K of G71 and G72 on a GSK.
    RoughWordOfGsk = 4863, "{w} in the block with P and Q is an allowance of the strokes on FANUC and Haas, and another word on a GSK",
        "leave it out: the contour is always checked, and its last pass is always cut; for the allowance write `(DIALECT FANUC-A)`, or D in the same block",
        "在含 P、Q 的程序段中，{w} 在 FANUC 和 Haas 上是粗车余量，在 GSK 上是另一个字", "请省略：轮廓总是经过检查，最后一刀总会执行；若为余量请写 `(DIALECT FANUC-A)`，或在同一段写 D";
    /// A code for what this machine does not have; {0} the code.
    PartOfOtherMachine = 4864, "{0} is for something that this machine does not have",
        "leave it out, or make the part without it",
        "{0} 用于本机没有的部件", "请省略，或不用它加工";
    /// DPRNT and what belongs to it.
    PrintStatement = 4865, "DPRNT, BPRNT, POPEN and PCLOS print to a serial port, and there is none here",
        "leave them out; a value is kept for the next run, and in the file of variables, with `#500=#1`",
        "DPRNT、BPRNT、POPEN、PCLOS 向串口输出，本机没有串口", "请省略；用 `#500=#1` 可将数值保存到变量文件，供下次运行使用";
    /// I or K that moves the walls of a pocket, or the wall in front of the contour.
    PocketAllowance = 4866, "{w} moves all walls of the contour the same way, and the strokes would cut into the one in front of a pocket or of the contour",
        "leave {w} out where the contour has pockets or its first block cuts a slope; the allowance across the strokes (I of G71, K of G72) may stay",
        "{w} 使轮廓的所有侧壁向同一方向移动，粗车会切入凹槽前方或轮廓前方的侧壁", "轮廓有凹槽、或首段为斜向切削时请省略 {w}；垂直于切削方向的余量（G71 的 I、G72 的 K）可保留";
    /// I or K that leads into the part; {0} its length.
    RoughLeftInside = 4868, "{w} of {0} leads into the part: the strokes would cut below the finished contour",
        "turn its sign, or leave {w} out", "{0} 的 {w} 指向工件内部：粗车会切到成品轮廓以下", "请改变其符号，或省略 {w}";
    /// The contour's first block has a number that another block has, too; {0} the number, {1} and {2} their lines.
    ContourTwice = 4876, "N{0} stands in lines {1} and {2} of this program, and nothing tells which of them begins the contour",
        "give the contour numbers that stand once; where one was roughed before with the same P and Q, G70 takes that",
        "N{0} 在本程序第 {1} 行和第 {2} 行重复，无法确定轮廓从哪一段开始", "请使轮廓的 N 号在程序中唯一；若前面已用相同的 P、Q 粗车，G70 采用该轮廓";
    /// R or C of a wear that is not zero.
    WearRadius = 4877, "{w} writes a wear of the nose radius, and a tool has one radius and no wear of it",
        "write the radius itself: G10 P10001 R0.8 (P: 10000 and the number of the offset; Haas: L10); R0 may stay",
        "{w} 写入刀尖半径磨损，而刀具只有一个半径，没有半径磨损", "请直接写半径：G10 P10001 R0.8（P 为 10000 加刀偏号；Haas 用 L10）；R0 可保留";
    /// M99 as the end of a line that was typed.
    LineRepeats = 4867, "M99 repeats a main program, and a line that was typed has nothing to repeat", "type the line without M99; a program that repeats itself is run from its file (`leadscrew run`)",
        "M99 使主程序重复执行，而键入的单行没有可重复的内容", "请去掉 M99 后重新键入；需要重复执行的程序请存为文件运行（`leadscrew run`）";
    // -- 4870–4874 pitch errors: `params` ---------------------------------------------------------------------
    /// Errors of the pitch that no screw has: axis, the point before the step, its slope in µm/mm.
    PitchErrorSteep = 4870, "the pitch error of {0} changes by {2} µm/mm from point {1} to the next, and no screw does so by more than 5", "correct 1870 + {1} or the next (a value in mm typed as µm, a sign), or the spacing, 1862.{0}",
        "{0} 轴的螺距误差从第 {1} 点到下一点每毫米变化 {2} µm，丝杠不会超过 5 µm/mm", "请更正 1870 + {1} 或下一点的值（单位或符号有误），或间距 1862.{0}";
    /// Errors of the pitch that bend too sharply for the rapid rate: axis, point, share in per cent.
    PitchErrorBent = 4871, "the pitch errors of {0} bend at point {1} so sharply that taking them off takes {2} % of the acceleration or jerk of the axis at its rapid rate, and less than 4 are kept for it", "check the values about 1870 + {1}; set the points farther apart (1862.{0}), or 1420.{0} lower",
        "{0} 轴的螺距误差在第 {1} 点转折过急：按快速移动速度补偿需占用该轴加速度或加加速度的 {2} %，而只为此保留 4 % 以下", "请检查 1870 + {1} 附近的值；或加大点距（1862.{0}），或降低 1420.{0}";
    /// A drive takes too little of its targets: axis, what is left of its jerk and of its acceleration in per cent.
    TargetsTooSlow = 4879, "what the drive of {0} takes of its targets (9077.{0}, 9078.{0}) leaves {1} % of the jerk of the axis and {2} % of its acceleration, and 10 are needed", "9077 and 9078 are 607Fh and 60C5h of the drive, in the units of the axis: raise them in the drive and here, or lower 1420.{0}, 1430.{0} and 1620.{0}",
        "{0} 轴驱动器允许的目标（9077.{0}、9078.{0}）只剩该轴加加速度的 {1} % 和加速度的 {2} %，至少需 10 %", "9077 和 9078 为驱动器的 607Fh 和 60C5h，以轴的单位表示：请在驱动器和此处一并提高，或降低 1420.{0}、1430.{0}、1620.{0}";
    // -- 4875 the spindle at an angle --------------------------------------------------------------------------------
    /// M19 with an encoder too coarse for it; {0} its counts, {1} how many would do.
    EncoderTooCoarseToOrient = 4875, "an encoder of {0} counts a turn does not tell where the spindle is to 0.1 degrees", "use an encoder of {1} counts (3720) or more; or give M19 a row in the table of machine functions, where the drive or a PLC orients the spindle",
        "每转 {0} 个计数的编码器无法以 0.1 度的精度测定主轴角度", "请使用不少于 {1} 个计数的编码器（3720）；若由驱动器或 PLC 定向，请在机床功能表中为 M19 添加一行";
    // -- 0033–0055 and 4600–4619 nose compensation and corners: language/ --------------------------------------------
    /// The offset elements of an inside corner do not meet; {0} the nose radius.
    NoseNoIntersection = 33, "the nose of radius {0} finds no place in this inside corner: the offset elements do not meet",
        "use a tool with a smaller nose, or make the elements at the corner longer",
        "半径 {0} 的刀尖无法到达该内角：偏置后的轨迹没有交点", "请使用刀尖半径较小的刀具，或加长该角处的轨迹";
    /// The compensation begins or ends in an arc.
    NoseStartUpArc = 34, "the nose compensation begins or ends in an arc", "write G41, G42 or G40 for a straight move (G00 or G01) before or after the arc",
        "刀尖半径补偿在圆弧段建立或取消", "请在圆弧之前或之后的直线段（G00 或 G01）建立或取消补偿";
    /// Nothing would be left of a motion, or the nose would cut another element; {0} the nose radius.
    NoseInterference = 41, "the nose of radius {0} does not fit into the path here and would cut too deep",
        "use a tool with a smaller nose than the groove, step or inside arc; check R of the offset table, and G41 against G42",
        "半径 {0} 的刀尖在此处放不下，会产生过切", "请使用刀尖半径小于槽宽、台阶或内圆弧的刀具；请检查刀补表中的 R 以及 G41、G42";
    /// No motion after a chamfer or rounding.
    CornerNextMissing = 51, "no motion follows the chamfer or rounding", "let a G01, G02 or G03 with a way to go be the next motion; where C of a FANUC or a Haas is the axis, stop the spindle by M05 before",
        "倒角或倒圆之后没有移动", "倒角或倒圆的下一个移动应为有移动量的 G01、G02 或 G03；若 FANUC 或 Haas 的 C 指 C 轴，请先用 M05 停主轴";
    /// The chamfer or rounding does not stand between two cutting motions.
    CornerNextWrong = 52, "a chamfer or rounding stands between two motions of G01, G02 or G03", "write G01, G02 or G03 before and after it",
        "倒角或倒圆应位于两个 G01、G02 或 G03 移动之间", "请在其前后使用 G01、G02 或 G03";
    /// A leg of a chamfer or rounding is longer than its element, or has the wrong direction.
    CornerTooLong = 55, "the chamfer or rounding does not fit between its two motions", "make it smaller or the motions longer; its sign, if it has one, is the direction of the next motion; where C of a FANUC or a Haas is the axis, stop the spindle by M05 before",
        "倒角或倒圆在两段移动之间放不下", "请减小倒角或倒圆，或加长移动；若带符号，应与下一段移动方向一致；若 FANUC 或 Haas 的 C 指 C 轴，请先用 M05 停主轴";
    /// Too many blocks without motion; {0} the limit.
    NoseStill = 4600, "more than {0} blocks without motion follow this one in nose compensation", "move some of them before G41 or G42, or after G40",
        "刀尖半径补偿中此段之后无移动的程序段超过 {0} 个", "请将部分程序段移到 G41、G42 之前或 G40 之后";
    /// Side or nose changes right after the start.
    NoseSideChange = 4601, "the side or the nose changes in the block after the compensation began, or in the one after that",
        "cut two blocks first, or cancel with G40 and begin anew",
        "刀尖半径补偿刚建立即改变方向或刀尖", "请先执行两个程序段，或用 G40 取消后重新建立";

    /// A cycle, or a motion of C, while G41 or G42 is in force; a stroke or a tap behind G40 without a move.
    NoseInCycle = 4602, "a cycle or a motion of C cannot follow the round nose, and no move with G40 has ended G41 or G42", "write a move of G00 or G01 with G40 before it",
        "循环或 C 轴移动不能在刀尖半径补偿（G41/G42）中执行，此前没有带 G40 的移动取消补偿", "请在前面写带 G40 的 G00 或 G01 移动";

    // -- 4900–4919 warnings: program/ --------------------------------------------------------------------------------
    /// P(r) of G78 above 4 [D7]; {0} the value.
    CutInMode = 4900, "cut-in mode {0} does not exist: parameter 5144 decides", "write 00 to 04 as the middle two digits of P",
        "切入方式 {0} 不存在：由参数 5144 决定", "请把 P 的中间两位写成 00 至 04";
    /// The limit of G50 S cuts a speed down; {0} the speed, {1} the limit.
    SpeedLimited = 4901, "S{0} is above {1} rpm, the highest speed of the spindle (3772) or of this program (G50 S), so {1} rpm is the limit", "write G50 S{1}",
        "S{0} 超过 {1} rpm（主轴最高转速 3772，或本程序的 G50 S），按 {1} rpm 限制", "请写 G50 S{1}";
    /// The extraction override asks for more than the tap may; {0} asked, {1} the limit.
    TapExtractionLimited = 4902, "the retract at {0} is cut down to {1} rpm (parameters 5241 and 3772)", "write a smaller J, or lower 5211",
        "退刀转速 {0} 被限制为 {1} rpm（参数 5241、3772）", "请减小 J，或减小 5211";
    /// An M code of the machine in a simulation; {0} its number.
    MachineCodePassed = 4903, "M{0} switches something of a machine that is not simulated", "nothing needs to be done here; a board refuses it (4550)",
        "M{0} 控制的装置不在仿真范围内", "此处无需处理；控制板会拒绝该代码（4550）";
    /// Q in a stroke that goes on with the one before.
    StartAngleJoined = 4904, "{w} has no effect: this stroke goes on with the thread of the stroke before", "leave Q out",
        "{w} 不起作用：本段与前一段的螺纹相连", "请省略 Q";
    /// Threads follow a groove that was picked up: {0} and {1} axis and place, {2} the angle there,
    /// {3} the start angle of this thread.
    PickedUp = 4905, "threads follow the groove that the tip touched at {0} {1} and the spindle at {2}: this one begins at {3}",
        "`leadscrew pickup --clear` ends that. The cut is in the groove where the lag of its axis is compensated (9070): else it lies beside it by the speed over the gain",
        "螺纹将沿刀尖在 {0} {1}、主轴 {2} 处所碰的牙槽切削：本螺纹从 {3} 开始", "`leadscrew pickup --clear` 可取消。须已补偿该轴滞后（9070），否则切削将偏离牙槽（速度除以增益）";
    /// J in ordinary tapping.
    TapExtractionNotRigid = 4909, "J has no effect in ordinary tapping: the tap comes out at S", "leave J out, or tap in rigid mode",
        "普通攻丝中 J 不起作用：退刀转速为 S", "请省略 J，或使用刚性攻丝";

    /// J in rigid tapping where the parameters leave the way out to others.
    TapExtractionOff = 4910, "J has no effect: it sets the speed of the retract only with 5200.4 = 1 and 5201.4 = 1",
        "set both parameters to 1, or leave J out",
        "J 不起作用：仅当 5200.4 = 1 且 5201.4 = 1 时 J 才指定退刀转速", "请将两个参数都设为 1，或省略 J";
    /// J outside the range it may have; {0} and {1} the range, in turns a minute.
    TapExtractionRange = 4911, "J is outside {0} to {1}, and has no effect: the tap comes out at S",
        "write a J in this range (5202.6 sets how wide it is), or leave J out",
        "J 超出 {0} 至 {1}，不起作用：退刀转速为 S", "请写此范围内的 J（范围由 5202.6 决定），或省略 J";

    /// S of G50 beside coordinates, where it is no limit.
    SpeedNoLimit = 4912, "{w} beside the coordinates of G50 is an ordinary S on this control, and limits no speed",
        "for the highest speed write G50 S in a block of its own; where the speed itself is meant, write M03 or M04 beside it",
        "该系统中 G50 坐标旁的 {w} 为普通 S 字，不限制转速", "要限制最高转速，请将 G50 S 单独写成一段；若指转速本身，请同段写 M03 或 M04";

    // -- 4920–4939 warnings: cycle/ ----------------------------------------------------------------------------------

    /// Δd moves the tool sideways at the bottom of a full slot.
    ReliefInSlot = 4920, "the relief of {0} at the bottom has no room in the first column of a groove",
        "leave R out of the block with X, unless the material beside the first column is gone",
        "槽底退刀 {0}：第一列没有退刀空间", "请在含 X 的程序段中省略 R，除非第一列旁边已无材料";
    /// An infeed of a groove, and its retract; on the radius.
    GrooveRetractLong = 4921, "each infeed of the groove is {0} on the radius (G74: along Z), and each retract R(e) takes back {1}: more than it",
        "write a larger infeed (P of G75, Q of G74), or a smaller R in the block before (without one: parameter 056)",
        "切槽每次进刀 {0}（G75 为半径值），而每次退刀 R(e) 为 {1}，大于进刀量", "请增大进刀量（G75 为 P，G74 为 Q），或减小前一段的 R（未写 R 时为参数 056）";

    // -- 4940–4959 warnings: feasible/, motion/, spindle/ --------------------------------------------------------------
    /// The tool has to start far away to be on the lead at the material.
    LeadInLong = 4940, "start at least {0} before the material: {1} to get onto the lead, {2} for the shift of the starts", "lower S, or start further away",
        "起刀点距工件至少 {0}：进入导程 {1}，起点偏移 {2}", "请降低 S 或加大起刀距离";
    /// The axis leaves the lead before the run-out begins.
    FallingLead = 4941, "the last {0} before the end of the thread are cut with a falling lead", "lower S, or give the thread a run-out of {1} or more: K; where it has no such word, r in P of G76, or parameter 5130 (G76 in one block, too)",
        "螺纹末端 {0} 的导程逐渐减小", "请降低 S，或使退尾长度不小于 {1}：写 K；没有 K 时用 G76 的 P 中的 r，或参数 5130（G76 单段格式亦同）";
    /// The short axis cannot make up inside K what it lags.
    RunOutLags = 4942, "the run-out is {0} short of its height at its end", "lower S, or give it a length of {1} or more: K; where the thread has no such word, r in P of G76, or parameter 5130 (G76 in one block, too)",
        "退尾结束时距其高度还差 {0}", "请降低 S，或使其长度不小于 {1}：写 K；没有 K 时用 G76 的 P 中的 r，或参数 5130（G76 单段格式亦同）";
    /// Parameter 107 is not followed.
    RunOutSpeedIgnored = 4943, "parameter 107 is {0}, and the run-out stays as J and K say", "set parameter 107 to 0",
        "参数 107 为 {0}，退尾仍按 J、K 执行", "请将参数 107 设为 0";
    /// Parameter 5129 asks for overlapping moves [D59].
    HighSpeedNotBuilt = 4944, "the high-speed mode (parameter 5129) is not available yet: moves between passes stop exactly",
        "nothing needs to be done; set parameter 5129 to 0 to silence this",
        "高速模式（参数 5129）尚不可用：各刀之间准确停止", "无需处理；将参数 5129 设为 0 可取消此提示";
    /// A tap too shallow for its speed; {0} S, {1} what is reached.
    TapSpeedNotReached = 4945, "S {0} is not reached in the depth: the tap turns at {1} at most, in phase",
        "nothing needs to be done; a smaller S, or shorter ramps (5261), would be reached",
        "在孔深范围内达不到 S {0}：最高 {1}，仍保持同步", "无需处理；减小 S 或缩短 5261 的时间即可达到";
    /// Somebody has to change the tool; {0} is its station.
    ToolByHand = 4953, "change to tool {0}, then press start", "`leadscrew resume`, once it is in and nothing is in the way",
        "请换上 {0} 号刀，然后按启动", "换好且无干涉后执行 `leadscrew resume`";
    /// A thread or a tap of a program that follows the handwheel.
    RunsByItself = 4954, "this runs by itself, without the handwheel: press start", "`leadscrew resume`, once nothing is in the way; a thread or a tap goes with its spindle",
        "此段自行运行，不随手轮：请按启动", "确认无障碍后执行 `leadscrew resume`；螺纹与攻丝随主轴运行";
    /// A handwheel that is followed is too far ahead of its axis.
    WheelTooFast = 4955, "the handwheel is turned faster than its axis follows: some of its counts are dropped", "turn it slower, take a smaller factor, or raise 9046 or 9045",
        "手轮转动过快，轴无法跟随：部分脉冲已舍去", "请放慢转动、减小倍率，或增大 9046 或 9045";
    /// An ordinary tap whose spindle could not be stopped in time; {0} S, {1} what is reached.
    FloatSpeedNotReached = 4956, "S {0} is not reached: the spindle goes in at {1} at most, so that it can be stopped in the hole",
        "nothing needs to be done; a smaller S, a deeper Q or a shorter spindle ramp (9004) would be reached",
        "达不到 S {0}：为使主轴能在孔内停止，最高转速为 {1}", "无需处理；减小 S、增大 Q 或缩短主轴加减速时间（9004）即可达到";
    /// Getting onto the lead takes much of the depth; {0} the way, {1} what the holder takes.
    FloatJoinLong = 4957, "R should lie {0} or more before the material: nearer to it the holder has to take up to {1}",
        "write an R further out, or a smaller S", "R 平面应距工件至少 {0}，否则浮动夹头需补偿至多 {1}", "请加大 R 平面距离或减小 S";

    // -- 4980–4999 warnings: what a program hardly means ---------------------------------------------------------------
    /// A first pass that cuts next to nothing; {0} its depth, {1} the height.
    FirstPassTiny = 4981, "the first pass is {0} deep, of a thread of {1}", "is Q (in one block D) in the unit of this control? `(ALLOW 4981)` if it is meant",
        "第一刀切深仅 {0}，牙高 {1}", "Q（单段格式为 D）的单位是否正确？确实如此请写 `(ALLOW 4981)`";
    /// A peck far beyond the depth; {0} peck, {1} depth.
    PeckBeyondDepth = 4982, "a step of {0} is beyond the whole way of {1} that it is to divide", "is it in the unit of this control? A FANUC, and a GSK 980TD by 182.7, count increments (Q5000 is 5 mm); a Haas and a GSK 988 write millimetres (Q5.); `(ALLOW 4982)` if it is meant",
        "每步 {0} 超过需分割的全长 {1}", "单位是否正确？FANUC 和 GSK 980TD（182.7）为增量数（Q5000 即 5 mm），Haas 和 GSK 988 为 mm（Q5.）；确实如此请写 `(ALLOW 4982)`";
    /// A feed per minute, or a groove, with a spindle that nothing has started.
    CutStanding = 4984, "this feeds with the spindle standing: no M03 or M04 with S is in force here",
        "start the spindle before this block: M03 or M04 with S; where the tool cuts nothing, or a driven tool cuts, nothing needs to be done",
        "主轴静止时进行切削进给：此处没有生效的 M03 或 M04 加 S", "请在此程序段之前用 M03 或 M04 加 S 启动主轴；若刀具未切削，或由动力刀具切削，则无需处理";
    /// A lead that threads hardly have; {0} it.
    LeadOdd = 4985, "a pitch of {0} is none that threads have (0.05 to 50 mm)", "is F the lead, and not a feed? `(ALLOW 4985)` if it is meant",
        "螺距 {0} 不在一般螺纹范围内（0.05 至 50 mm）", "F 是导程而非进给速度吗？确实如此请写 `(ALLOW 4985)`";
    /// A rapid through the declared stock; {0} X and {1} Z where it enters.
    RapidInStock = 4987, "this rapid goes into the material at X {0}, Z {1}", "go around it, cut it away first, or correct the comment `(STOCK ..)`; `(ALLOW 4987)` if it is meant",
        "此快速移动在 X {0}、Z {1} 处进入毛坯", "请绕开、先切除，或修改注释 `(STOCK ..)`；确实如此请写 `(ALLOW 4987)`";
    /// An allowance into the part, or a depth that hardly any tool takes; {w} the word, {0} its length.
    AllowanceOdd = 4989, "{w} {0} does not suit this contour: the allowance goes into the part, or the depth is more than 10 mm, or than half of the declared stock, or so small that there are more than 250 strokes", "outside U is positive and in a bore negative; toward the chuck W is positive; with a pocket write W0, in G72 U0; a depth, U (G72: W) of the first block or D, is a length on the radius: D2., and not D2000, where no point means whole lengths; `(ALLOW 4989)` if it is meant",
        "{w} {0} 与此轮廓不符：余量进入工件，或背吃刀量超过 10 mm 或所声明毛坯的一半，或过小而超过 250 刀", "外圆 U 为正，内孔 U 为负；朝卡盘方向 W 为正；轮廓有凹槽时请写 W0（G72 为 U0）；背吃刀量（第一段的 U，G72 为 W，或 D）为半径方向的长度：不带小数点即整数长度时写 D2. 而不是 D2000；确实如此请写 `(ALLOW 4989)`";
    /// A contour cycle that begins between the lowest and the highest point of its contour; {0} how far below.
    StartInContour = 4990, "the cycle begins inside its contour, which goes {0} further out than the tool stands", "move outside the stock before this block; `(ALLOW 4990)` if it is meant",
        "循环起点位于轮廓之内，轮廓比刀具位置还高出 {0}", "请先移动到毛坯之外；确实如此请写 `(ALLOW 4990)`";
    /// A word without a point that leaves the travel as millimetres only; {w} it, {0} what it would be in increments.
    PointMissing = 4991, "{w} has no point and is read as millimetres here; in increments it would be {0}", "write the point; where the whole program counts increments, set parameter 3401.0 = 0 (`--set 3401.0=0`; a GSK 980TD has none); `(ALLOW 4991)` if it is meant",
        "{w} 没有小数点，此处按 mm 读取；按最小增量则为 {0}", "请写小数点；若整个程序以最小增量为单位，请设参数 3401.0 = 0（`--set 3401.0=0`；GSK 980TD 无此参数）；确实如此请写 `(ALLOW 4991)`";

    // -- 4992–4999 warnings: `language` -----------------------------------------------------------------------------------
    /// M99 in the main program.
    MainRepeats = 4992, "M99 begins the main program again: it is read once here", "nothing needs to be done; write M30 where the program ends",
        "M99 使主程序重新开始：此处只执行一遍", "无需处理；程序结束处请写 M30";

    /// The rapid at the end of a contour of G71 or G72 that leads back beside the part.
    ContourWayBack = 4997, "the contour of this cycle ends before this rapid, which leads back clear of it: the cycle returns by itself", "nothing needs to be done; G70 follows this rapid as it is written",
        "循环的轮廓到此快速移动之前为止：该移动在轮廓之外返回，循环自行返回起点", "无需处理；G70 仍按程序执行此快速移动";

    /// A number with more digits than the increment has; {0} what it counts as.
    DigitsRounded = 4998, "{w} has a digit beyond the smallest step: it counts as {0}, and further words are rounded the same way", "nothing needs to be done where half a step does not matter; else write so many digits as the control has",
        "{w} 含有小于最小单位的数字：按 {0} 处理，其余的字同样舍入", "若半个最小单位无关紧要则无需处理；否则请按控制系统的位数书写";

    /// The main program stands after its subprogram; {0} its number.
    MainBehind = 4999, "the main program is O{0}: what stands in front of it is called by it and has no end of its own", "nothing needs to be done; write the main program first where another one is meant",
        "主程序为 O{0}：其前面的程序由它调用，且没有程序结束代码", "无需处理；若另有主程序，请将其写在文件最前面";

    /// G41 or G42 with a tool whose radius is zero; {0} the number of the offset.
    NoseRadiusMissing = 4993, "the nose radius of tool {0} is 0: the path is cut as it is written", "set radius and tip direction of this tool (`leadscrew tools set T{0}.radius=0.4 T{0}.tip=3`, without a tool table parameters 9201 to 9216 and 9301 to 9316), and call the tool before it",
        "{0} 号刀具的刀尖半径为 0：按程序轨迹加工", "请设定该刀具的半径和刀尖方向（`leadscrew tools set T{0}.radius=0.4 T{0}.tip=3`；无刀具表时为参数 9201…9216 和 9301…9316），并先调用刀具";

    /// M99 in the main program, in a run.
    MainBeginsAgain = 4996, "M99 begins the main program again and again", "Ctrl-C brings the machine to a stop, and `--passes 20` ends the run after 20 passes; write M30 where the program is to end",
        "M99 使主程序不断重新开始", "按 Ctrl-C 可使机床停止，`--passes 20` 使其运行 20 遍后结束；程序结束处请写 M30";

    /// A text that looks as if it was written for another control; {0} that one, {1} the one that is set.
    LooksLike = 4994, "this looks like a program for {0}, and it is read as one for {1}", "write `--dialect {0}`, `(DIALECT {0})` in front of the program, or `dialect = \"{0}\"` in its machine file",
        "这像是 {0} 的程序，而当前按 {1} 读取", "请用 `--dialect {0}`，或在程序开头写 `(DIALECT {0})`，或在机床文件中写 `dialect = \"{0}\"`";

    /// The comment that declares the stock, and says it in another way.
    StockUnreadable = 4995, "this comment does not declare the stock: X (diameter) and L (length) in millimetres, perhaps X0= (bore) and Z (face)", "write `(STOCK X60 L100)` or `(STOCK X60 L100 X0=20 Z1)`",
        "此注释未能说明毛坯：应为 X（直径）和 L（长度），可加 X0=（孔径）和 Z（端面），单位 mm", "请写 `(STOCK X60 L100)` 或 `(STOCK X60 L100 X0=20 Z1)`";
    // -- 4975–4978 warnings: what a program hardly means, `language`; 4976 to 4978 may be allowed -------------------------
    /// A comment with ALLOW names what is no number that may be allowed.
    AllowUnknown = 4975, "this comment silences nothing here: there is no such number, or it may not be silenced", "write numbers from 4800 to 4811, 4976 to 4978 or 4980 to 4991, as `(ALLOW 4800 4985)`",
        "此处的 ALLOW 无效：没有该编号，或该编号不能屏蔽", "请写 4800 至 4811、4976 至 4978 或 4980 至 4991，如 `(ALLOW 4800 4985)`";
    /// The text is over, and the program has not ended itself.
    EndMissing = 4976, "the program ends without M30, M02 or M99", "write M30 in its last block; on many controls the spindle and the coolant go on without it",
        "程序末尾没有 M30、M02 或 M99", "请在最后一段写 M30；许多系统若无此代码，主轴和冷却液不会停止";
    /// A program with an end of its own stands behind the one that runs, which does not call it; {0} its number.
    ProgramBehind = 4977, "O{0} stands behind the end of the program, and is not carried out", "write it to a file of its own, or call it with M98 and end it with M99; where blocks in front of its O number are its head, write them behind it",
        "O{0} 位于程序结束之后，不会执行", "请将其存为单独的文件，或用 M98 调用并以 M99 结束；若 O 号之前的程序段是其开头，请移到 O 号之后";
    /// A cut at a few turns a minute; {0} their number.
    SpeedOdd = 4978, "the spindle cuts at {0} turns a minute from here on", "write the speed itself, as S600; where S1 to S4 is a gear of the spindle on another control, its speed there; a gear here is M41 to M44; `(ALLOW 4978)` if it is meant",
        "从此处起主轴以 {0} r/min 进行切削", "请直接写转速，如 S600；若 S1 至 S4 在其他系统上表示主轴换挡，请写该挡的转速；此处换挡用 M41 至 M44；确实如此请写 `(ALLOW 4978)`";
    // -- 4960–4979 warnings: params/, board/ ---------------------------------------------------------------------------
    /// 5241 above 3772: both speeds.
    TapSpeedAboveSpindle = 4960, "the highest tapping speed {0} (5241) is above that of the spindle, {1} (3772)",
        "lower 5241; the spindle's limit holds",
        "攻丝最高转速 {0}（5241）高于主轴最高转速 {1}（3772）", "请减小 5241；以主轴限制为准";
    /// 5213 is 0.
    NoPeckReturn = 4961, "peck tapping does not come back between its infeeds (5213 is 0)",
        "set 5213 to the length that breaks the chip, less than Q",
        "深孔攻丝每次进刀后不退刀（5213 为 0）", "请将 5213 设为断屑所需长度（小于 Q）";
    /// 5201.4 without 5200.4.
    ExtractionOverrideOff = 4962, "J of a tapping cycle has no effect: 5201.4 is 1 and 5200.4 is 0",
        "set 5200.4 to 1, or 5201.4 to 0",
        "攻丝循环的 J 不起作用：5201.4 为 1 而 5200.4 为 0", "请将 5200.4 设为 1，或将 5201.4 设为 0";
    /// The observer is too fast to smooth much: bandwidth, tick in µs, bandwidth that would.
    ObserverNoisy = 4963, "an observer of {0} Hz smooths little on samples {1} µs apart",
        "set 9005 to {2} Hz or less, or make the tick (9000) shorter",
        "采样间隔 {1} µs 时 {0} Hz 的观测器几乎不起平滑作用", "9005 设为 {2} Hz 以下，或缩短周期（9000）";
    /// A write of the tap journal failed inside a hole, or after the hole.
    TapJournalStale = 4970, "the tap journal could not be written: after a loss of power it would tell of an earlier moment of this hole",
        "finish the hole, then check the board's storage",
        "攻丝记录写入失败：断电后其内容为本孔较早时刻的信息", "请完成该孔，然后检查控制板的存储器";
    /// Power-up with a tap in its hole; {0} its axis, {1} the bottom.
    TapInHoleSincePower = 4971, "the power went with a tap in its hole: {0} now counts from the bottom {1}",
        "run G30 P99: it turns the tap further out than it may need, in phase, which is harmless; then reference {0}",
        "断电时丝锥在孔内：{0} 轴以孔底 {1} 为当前位置", "请执行 G30 P99：丝锥同步退出的距离可能多于所需，无害；之后请重新对 {0} 轴回零";
    /// Power-up of a board in which nothing was ever stored.
    ParametersBuiltIn = 4972, "no parameter set is stored in the board: its built-in one is in force",
        "push the machine's parameter set; or store the built-in one (1010h:01 = \"save\") if this is such a machine",
        "控制板中未保存参数集：内置参数集有效", "请写入本机床的参数集；若机床与内置参数集相符，请保存内置参数集（1010h:01 = “save”）";
    /// The set is stored, and the mark that would tell of its damage is not.
    ParametersUnmarked = 4973, "the parameter set is stored; the note which set is the newest could not be stored", "check the board's storage, then write the set again",
        "参数集已保存，但未能记下哪一份最新", "请检查控制板的存储器，然后重新写入参数集";
    /// The table is stored, and the mark that would tell of its damage is not.
    OffsetsUnmarked = 4974, "the tool table is stored; the note which one is the newest could not be stored", "check the board's storage, then write the table again",
        "刀具表已保存，但未能记下哪一份最新", "请检查控制板的存储器，然后重新写入刀具表";
    /// A speed beyond what a setpoint can step: axis, tick in µs.
    RapidBeyondTick = 4964, "in one tick of {1} µs {0} cannot go as far as its rapid rate (1420.{0}) asks, and moves slower",
        "make the tick (9000) shorter, or lower 1420.{0}",
        "{0} 轴在一个周期（{1} µs）内走不了快移速度（1420.{0}）对应的距离，实际速度较低", "请缩短周期（9000）或减小 1420.{0}";
}
