//! The one list of alarms and warnings: number, cause and remedy in English and Chinese.

/// Defines [`Code`]. A template may use `{0}`…`{3}` for the figures and `{w}` for the word's letter.
macro_rules! codes {
    ($($(#[$doc:meta])* $name:ident = $number:literal, $cause:literal, $help:literal, $zh:literal, $zh_help:literal;)*) => {
        /// Every alarm and warning. Numbers up to 999 are those GSK and FANUC users know; 4000–4899 are alarms of our
        /// own, 4900–4999 warnings.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
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
        self.number() >= 4900
    }
}

codes! {

    // -- 02xx–03xx: the trade's own numbers -------------------------------------------------------------------------
    /// F or I of a thread missing, zero, negative or out of range.
    LeadMissing = 313, "the thread has no lead", "write F (lead per turn) or I (turns per inch) in a thread block",
        "螺纹没有导程", "请在螺纹程序段中写 F（每转导程）或 I（每英寸牙数）";

    /// The thread angle is above 99°.
    ThreadAngleRange = 315, "thread angle {0}° is outside 0–99°", "give the angle of the tool in the last two digits of P",
        "螺纹角度 {0}° 超出 0–99°", "请在 P 的最后两位写刀具角度";
    /// Δdmin is larger than the whole depth k.
    MinStepAboveHeight = 316, "the smallest step {0} is larger than the thread height {1}",
        "write a smaller Q in the first block, or a larger P (height)",
        "最小切削量 {0} 大于牙高 {1}", "请减小第一段的 Q，或增大牙高 P";
    /// A step of a groove is missing or zero where one is needed.
    GrooveStepMissing = 319, "the groove needs a step here and has none",
        "write P (peck along X), and Q (step along Z) where Z differs from the start",
        "切槽缺少进刀量或进刀量为零", "请写 P（X 向每次进刀量）；Z 与起点不同时还要写 Q（Z 向进刀量）";

    // -- 4001–4099 text and words: program/ -------------------------------------------------------------------------
    /// A character that starts no word, comment or block.
    UnknownCharacter = 4001, "this character has no meaning here", "write a word: a letter and a number",
        "此处的字符没有意义", "请写一个字：字母加数字";

    // -- 4100–4199 geometry of cycles: cycle/ -----------------------------------------------------------------------

    /// d leaves nothing to rough.
    AllowanceTooLarge = 4100, "the finishing allowance {0} is not smaller than the thread height {1}",
        "write a smaller R in the first block, or a larger P (height)",
        "精车余量 {0} 不小于牙高 {1}", "请减小第一段的 R，或增大牙高 P";
    /// W = 0.
    ThreadWithoutLength = 4101, "the thread has no length along Z", "write a Z that differs from the start, or W other than 0",
        "螺纹在 Z 向没有长度", "请写与起点不同的 Z，或不为 0 的 W";
    /// U = 0.
    ThreadWithoutSide = 4102, "start and end of the thread stand at one X: outside or inside cannot be told",
        "start away from the thread's X, by more than its height",
        "螺纹起点与终点 X 相同，无法判断内外螺纹", "请使起点 X 离开螺纹，距离大于牙高";
    /// A lies deeper than a crest.
    StartInsideThread = 4103, "the start X {0} lies inside the work: the crest of the thread is at X {1}",
        "start further from the work, or correct X, P (height) or R (taper)",
        "起点 X {0} 在工件内：螺纹牙顶在 X {1}", "请使起点远离工件，或修改 X、P（牙高）或 R（锥度）";
    /// The stroke of a pass is used up by run-in and run-out.
    StrokeTooShort = 4104, "pass {0} has no room to cut: stroke {1}, run-in {2}, run-out {3}",
        "start further away, or shorten the run-out (K) or the run-in (E)",
        "第 {0} 刀没有切削行程：行程 {1}，旋进 {2}，退尾 {3}", "请使起点更远，或缩短退尾（K）或旋进（E）";
    /// The shift along the flank reaches the end of the thread.
    PassStartsBeyondEnd = 4105, "pass {0} would start {1} from the start point, and the thread is only {2} long",
        "start further away along Z, or use a smaller angle",
        "第 {0} 刀的切入点距起点 {1}，而螺纹长度只有 {2}", "请使起点沿 Z 向更远，或减小角度";
    /// The taper rises as fast as the run-out.
    RunOutIntoThread = 4106, "the run-out retracts {0} over {1}, but the taper rises {2} there: it would cut into the thread",
        "write a larger J or a smaller K",
        "退尾在 {1} 内退 {0}，而锥面在此上升 {2}，将切入螺纹", "请增大 J 或减小 K";
    /// E where X is the long axis.
    RunInWithLongX = 4107, "a run-in E is not possible where X is the long axis", "leave E out, or reduce the taper R",
        "X 为长轴时不能使用旋进 E", "请去掉 E，或减小锥度 R";
    /// More rough passes than the sequence may have.
    TooManyPasses = 4108, "the thread would take more than {0} rough passes", "write a larger Q (first depth) or a larger smallest step",
        "粗车次数将超过 {0} 次", "请增大第一刀切深 Q 或最小切削量";
    /// X_D = X_A in a groove.
    GrooveWithoutDepth = 4109, "the groove has no depth: its bottom is at the start X", "write an X that differs from the start, or U other than 0",
        "切槽没有深度：槽底 X 与起点相同", "请写与起点不同的 X，或不为 0 的 U";
    /// A length in a cycle is negative, zero or beyond the range of the machine arithmetic.
    CycleLengthRange = 4110, "{0} is not possible here: it must be a real length within ±4398 m",
        "correct the value", "此处不能为 {0}：必须是 ±4398 m 以内的有效长度", "请修改该值";

    /// L = 0.
    CycleStartsRange = 4111, "a thread has at least one start", "write L1 to L99, or leave L out",
        "螺纹至少有一个头", "请写 L1 至 L99，或省略 L";

    // -- 4200–4299 physics: feasible/, motion/, spindle/ -------------------------------------------------------------
    /// A move would need a ramp longer than the profile can hold.
    SpeedOutOfReach = 4200, "reaching {0} takes longer than {1} ticks", "raise acceleration (1620) or jerk (1622), or lower the rapid rate (1420) or the feed",
        "达到 {0} 需要超过 {1} 个插补周期", "请提高加速度（1620）或加加速度（1622），或降低快速速度（1420）或进给速度";
    /// A feed of zero, or too slow to be told from it.
    FeedZero = 4201, "the feed is zero", "write F; a feed per turn (G99) also needs a spindle speed S",
        "进给速度为零", "请写 F；每转进给（G99）还需要主轴转速 S";
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
    SpindleStopped = 4250, "the spindle does not turn", "start it before this block: M03 or M04 with S",
        "主轴没有旋转", "请在此程序段之前用 M03 或 M04 加 S 启动主轴";
    /// Lead times spindle speed above what the long axis may do.
    LeadTooFast = 4251, "at {3} the lead asks {1} of {0}; it may do {2}", "lower S or the lead",
        "主轴 {3} 时导程要求 {0} 轴达到 {1}，允许值为 {2}", "请降低 S 或减小导程";
    /// The run-out asks more of the short axis than its feed.
    RunOutTooFast = 4252, "at {3} the run-out asks {1} of {0}; it may do {2}", "lower S, or write a longer K or a smaller J",
        "主轴 {3} 时退尾要求 {0} 轴达到 {1}，允许值为 {2}", "请降低 S，或加大 K、减小 J";
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
    SoftLimit = 4258, "{0} would go to {1}; its soft limit is {2}", "keep the program within the machine's travel, or check offsets and parameters 1320 and 1321",
        "{0} 轴将到达 {1}，软限位为 {2}", "请使程序在行程之内，或检查偏置与参数 1320、1321";
    /// The moves handed over as one pass of a thread are not one.
    ThreadMovesMixed = 4259, "these moves are not one pass of a thread", "this is a fault of the controller, not of the program: report it",
        "这些动作不构成一刀螺纹", "这是控制器的故障而不是程序错误，请报告";
    /// No index within two turns and a second.
    NoIndex = 4260, "no index pulse from the spindle encoder", "check the encoder and its cable",
        "没有收到主轴编码器的零位脉冲", "请检查编码器及其电缆";
    /// The index came where none belongs.
    IndexSlipped = 4261, "the spindle encoder has lost or gained {0} counts", "check the encoder, its cable and parameter 3720",
        "主轴编码器丢失或多出 {0} 个计数", "请检查编码器、电缆与参数 3720";

    // -- 4300–4399 machine: board/, bus/ -----------------------------------------------------------------------------

    // 4350–4399: drives. {0} is the drive's letter, {1} its node.
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
        "check for a collision and the drive's tuning, or lower acceleration and feed, then reset",
        "驱动器 {0}（节点 {1}）跟随误差 {2}，极限 {3}（参数 1828）", "请检查是否碰撞及驱动器参数，或降低加速度和进给，然后复位";
    /// A position does not fit the 32 bits of the drive's target.
    DriveRange = 4362, "position {1} of drive {0} is beyond the 32 bits of its increments",
        "use a coarser increment (parameters 9001, 9002) or less travel",
        "驱动器 {0} 的位置 {1} 超出 32 位增量范围", "请使用更粗的增量（参数 9001、9002）或减小行程";

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
    /// A ramp does not fit a profile: axis, ticks, most ticks.
    RampTooLong = 4420, "speeding {0} up to its rapid rate takes {1} ticks, and a profile holds {2}",
        "raise 1620.{0} or 1622.{0}, lower 1420.{0}, or make the tick (9000) longer",
        "{0} 轴加速到快移速度需要 {1} 个周期，超过上限 {2}", "请增大 1620.{0} 或 1622.{0}，减小 1420.{0}，或加长周期（9000）";
    /// Travel limits the wrong way round: axis.
    SoftLimitsInverted = 4421, "the travel limits of {0} leave no room: 1321.{0} is not below 1320.{0}",
        "make 1320.{0} larger than 1321.{0}, or write \"none\" for no limit",
        "{0} 轴软限位之间没有行程：1321.{0} 不小于 1320.{0}", "1320.{0} 须大于 1321.{0}；不设限位请写 \"none\"";
    /// Cutting faster than rapid: axis.
    FeedAboveRapid = 4422, "the cutting feed of {0} (1430.{0}) is above its rapid rate (1420.{0})",
        "lower 1430.{0} or raise 1420.{0}",
        "{0} 轴最大切削进给（1430.{0}）高于快移速度（1420.{0}）", "请减小 1430.{0} 或增大 1420.{0}";
    /// The observer cannot be that fast: bandwidth, tick in µs, highest bandwidth.
    ObserverTooFast = 4423, "an observer of {0} Hz is not stable with a tick of {1} µs",
        "set 9005 to {2} Hz at most, or make the tick (9000) shorter",
        "周期 {1} µs 时带宽 {0} Hz 的观测器不稳定", "9005 最大设为 {2} Hz，或缩短周期（9000）";
    /// The spindle turns half a turn in a tick: highest speed of 3772, tick in µs, highest possible.
    SpindleTooFastForTick = 4424, "at {0} the spindle turns half a turn or more in one tick of {1} µs",
        "lower 3772 to {2}, or make the tick (9000) shorter",
        "{0} 时主轴在一个周期（{1} µs）内转过半圈以上", "请将 3772 减小到 {2}，或缩短周期（9000）";
    /// Travel beyond the 32 bits of a drive's target: axis.
    TravelBeyondDrive = 4425, "the travel of {0} in drive increments does not fit the 32 bits of the target position",
        "make the increments coarser (9001.{0} / 9002.{0}) or the travel (1320.{0}, 1321.{0}) shorter",
        "{0} 轴行程的驱动脉冲数超过目标位置的 32 位", "请加大驱动当量（9001.{0}／9002.{0}）或缩短行程（1320.{0}、1321.{0}）";
    /// A following-error limit below one increment: axis.
    IncrementAboveLimit = 4426, "one drive increment of {0} is larger than its following-error limit (1828.{0})",
        "make the increments finer (9001.{0} / 9002.{0}) or the limit larger",
        "{0} 轴一个驱动脉冲大于跟随误差极限（1828.{0}）", "请减小驱动当量（9001.{0}／9002.{0}）或增大极限";
    /// 9007 above 9010: both in per cent.
    ToleranceAboveVariation = 4427, "a spindle counts as arrived within {0} (9007), and threads keep room for {1} only (9010)",
        "lower 9007 or raise 9010",
        "主轴到达判据为 {0}（9007），而螺纹只为 {1}（9010）预留余地", "请减小 9007 或增大 9010";

    // -- 4900–4919 warnings: program/ --------------------------------------------------------------------------------

    // -- 4920–4939 warnings: cycle/ ----------------------------------------------------------------------------------

    /// Δd moves the tool sideways at the bottom of a full slot.
    ReliefInSlot = 4920, "the relief of {0} at the bottom has no room in the first column of a groove",
        "leave R out of the block with X, unless the material beside the first column is gone",
        "槽底退刀 {0}：第一列没有退刀空间", "请在含 X 的程序段中省略 R，除非第一列旁边已无材料";

    // -- 4940–4959 warnings: feasible/, motion/, spindle/ --------------------------------------------------------------
    /// The tool has to start far away to be on the lead at the material.
    LeadInLong = 4940, "start at least {0} before the material: {1} to get onto the lead, {2} for the shift of the starts", "lower S, or start further away",
        "起刀点距工件至少 {0}：进入导程 {1}，起点偏移 {2}", "请降低 S 或加大起刀距离";
    /// The axis leaves the lead before the run-out begins.
    FallingLead = 4941, "the last {0} before the end of the thread are cut with a falling lead", "lower S, or write a run-out with K of {1} or more",
        "螺纹末端 {0} 的导程逐渐减小", "请降低 S，或写 K 不小于 {1} 的退尾";
    /// The short axis cannot make up inside K what it lags.
    RunOutLags = 4942, "the run-out is {0} short of J at the end of K", "lower S, or write K{1} or more",
        "退尾在 K 结束时距 J 还差 {0}", "请降低 S，或写 K{1} 以上";
    /// Parameter 107 is not followed.
    RunOutSpeedIgnored = 4943, "parameter 107 is {0}, and the run-out stays as J and K say", "set parameter 107 to 0",
        "参数 107 为 {0}，退尾仍按 J、K 执行", "请将参数 107 设为 0";

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
}
