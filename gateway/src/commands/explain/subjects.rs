//! What the numbers are about, and the page of the manual that tells of it. It must not know what raises them.

/// Numbers that belong together: the last of them, their subject, and the page to read.
pub(super) const SUBJECTS: &[(u16, &str, &str, &str)] = &[
    (60, "nose radius and corners", "刀尖半径与倒角", "nose.md"),
    (69, "contour cycles", "轮廓循环", "contours.md"),
    (
        199,
        "macros and program flow",
        "宏与程序流程",
        "language.md",
    ),
    (
        399,
        "threads, grooves and taps",
        "螺纹、切槽与攻丝",
        "decisions.md",
    ),
    (
        3999,
        "macros and program flow",
        "宏与程序流程",
        "language.md",
    ),
    (4099, "the text of a program", "程序文本", "language.md"),
    (4199, "the geometry of cycles", "循环的几何", "decisions.md"),
    (
        4299,
        "what the machine can do",
        "机床的能力",
        "how-it-works.md",
    ),
    (4399, "the machine and its bus", "机床与总线", "bus.md"),
    (4499, "parameters", "参数", "parameters.md"),
    (
        4549,
        "operating by hand, reference",
        "手动操作与回零",
        "operating.md",
    ),
    (4579, "machine functions", "机床辅助功能", "functions.md"),
    (4589, "offsets and tools", "偏置与刀具", "tools.md"),
    (
        4599,
        "away and back, start at a line",
        "离开与返回、从某行启动",
        "operating.md",
    ),
    (4699, "nose radius and corners", "刀尖半径与倒角", "nose.md"),
    (
        4849,
        "what a program hardly means",
        "程序可疑之处",
        "language.md",
    ),
    (4899, "program flow", "程序流程", "language.md"),
    (4919, "the text of a program", "程序文本", "language.md"),
    (4959, "cycles and motion", "循环与运动", "how-it-works.md"),
    (
        4979,
        "parameters and the board",
        "参数与控制板",
        "parameters.md",
    ),
    (
        u16::MAX,
        "what a program hardly means",
        "程序可疑之处",
        "language.md",
    ),
];
