//! `params docs`: the manual of all parameters, as Markdown. `docs/parameters.md` is its output.

use std::fmt::Write as _;

use leadscrew_core::alarm::Lang;
use leadscrew_core::params::{Entry, Params};

use super::{json_list, unit_text};
use crate::cli::Global;
use crate::failure::Outcome;
use crate::output;
use crate::params::drives::KNOWN;
use crate::params::{CHAPTERS, meaning, name, value_text};
use crate::setup;

/// Prints the manual.
pub fn run(global: &Global, eds: bool) -> Outcome {
    if eds {
        return output::write(super::eds::sheet().as_bytes());
    }
    if global.json {
        let loaded = setup::load(global)?;
        return output::write(&json_list(Entry::all().iter(), &loaded, global.lang()));
    }
    output::write(markdown(global.lang()).as_bytes())
}

const INTRO_EN: &str = "# Parameters

Made by `leadscrew params docs` from the definitions in `params/*.toml`; do not edit it by hand.

A set of parameters is the built-in machine (column *Built in*), over it the files of `--params FILE` in their order, over
them the options `--set NO[.BIT|.AXIS]=VALUE`. A file is TOML, one value a key. A key is a number or a name, with its bit
or axis; zeros before a number do not count. In a file a value is written with its unit, on the command line it may be left
out.

```toml
\"1420.X\" = \"12000 mm/min\"    # or rapid_rate.X, or [1420] and X = … under it
acceleration.Z = \"3 m/s²\"
182.7 = 1
```

An unknown key, a wrong unit, a value out of its range, a digit too many or a key written twice is an alarm, never
ignored. So is a set that cannot work as a whole; `leadscrew params validate` tells why.

`schema = N` at the top says which release's table a file is for; pulled files have it. A file of another one is refused
with both numbers, and `leadscrew params migrate FILE` shows what has changed and, with `-o`, writes a new file. What stands
under `[drive.X]` goes to the drive itself (at the end of this page).

Offsets and noses (1221 to 1226, 9101 to 9132, 9201 to 9216, 9301 to 9316) count only where there is no [tool table](tools.md).

X: travel, speeds, accelerations and limits are those of the slide, on the radius. Offsets are diameters, as they are
programmed. Speeds and limits of C are in degrees.
";

const INTRO_ZH: &str = "# 参数

由 `leadscrew params docs` 根据 `params/*.toml` 中的定义生成，请勿手工修改。

一组参数由内置机床的值（“内置值”一栏）、其上按顺序叠加的 `--params FILE` 文件、最后叠加的 `--set NO[.BIT|.AXIS]=VALUE` 选项组成。文件为
TOML 格式，每个键一个值。键为参数号或名称，加位号或轴名；参数号前的零不计。文件中的值须写单位，命令行中可省略。

```toml
\"1420.X\" = \"12000 mm/min\"    # 或 rapid_rate.X，或 [1420] 下的 X = …
acceleration.Z = \"3 m/s²\"
182.7 = 1
```

未知的键、错误的单位、超出范围、位数过多、重复设定均为报警，不会被忽略。整体上不能工作的一组参数也是报警；`leadscrew params validate` 说明原因。

文件开头的 `schema = N` 说明它属于哪一版参数表；`params pull` 写出的文件带有它。其它版本的文件会被拒绝并指出两个版本号，
`leadscrew params migrate FILE` 显示有何变化，加 `-o` 则写出新文件。`[drive.X]` 下的内容写入驱动器本身（见本页末尾）。

偏置与刀尖参数（1221 至 1226、9101 至 9132、9201 至 9216、9301 至 9316）只在没有[刀具表](tools.md)时有效。

X 轴：行程、速度、加速度和极限均按滑板（半径值）计；偏置按编程为直径值。C 轴的速度和极限以度为单位。
";

const DRIVES_EN: &str = "
## Drives

`[drive.X]`, Z, C, S1 to S4: objects of the drives, written to them in order by `leadscrew params push`. A key is one of these
names, or index and sub-index in hexadecimal; an object without a name says its type (u8 u16 u32 i8 i16 i32). A drive keeps
its values in units of its own, so they are plain numbers.

```toml
[drive.X]
rpdo1 = [\"6040/16\", \"607A/32\"]        # a mapping: objects with their bits; also rpdo2, tpdo1, tpdo2
interpolation_period = \"1 ms\"           # both sub-indices of 60C2h
max_profile_velocity = 500000
\"2105.3\" = { type = \"u16\", value = 7 }
```

`profile = \"maxon-epos4\"` adds what the board needs of such a drive and the section does not say
([Drives as they are](drives.md#set-up-by-a-profile)).

Where 9031 is 1, a drive takes its place in the one frame of the board ([The board on a CAN bus](bus.md)): Z of board 1

```toml
[drive.Z]
rpdo1_cob_id = 0x481
rpdo1 = [\"0007/32\", \"0006/16\", \"6040/16\", \"607A/32\"]
```

| Object | Name | Type | Meaning |
|---|---|---|---|
";

const DRIVES_ZH: &str = "
## 驱动器

`[drive.X]`、Z、C、S1 至 S4：驱动器自身的对象，由 `leadscrew params push` 按顺序写入。键为下列名称，或十六进制的索引和子索引；没有名称的对象须写明
类型（u8 u16 u32 i8 i16 i32）。数值采用驱动器自己的单位，因此写成纯数字。

```toml
[drive.X]
rpdo1 = [\"6040/16\", \"607A/32\"]        # 映射：对象及其位数；另有 rpdo2、tpdo1、tpdo2
interpolation_period = \"1 ms\"           # 60C2h 的两个子索引
max_profile_velocity = 500000
\"2105.3\" = { type = \"u16\", value = 7 }
```

9031 为 1 时，驱动器在控制板的合并帧中取自己的位置（[总线说明](bus.md)）：1 号控制板的 Z 轴

```toml
[drive.Z]
rpdo1_cob_id = 0x481
rpdo1 = [\"0007/32\", \"0006/16\", \"6040/16\", \"607A/32\"]
```

| 对象 | 名称 | 类型 | 含义 |
|---|---|---|---|
";

/// The objects of drives that have names.
fn drives(out: &mut String, lang: Lang) {
    out.push_str(match lang {
        Lang::En => DRIVES_EN,
        Lang::Zh => DRIVES_ZH,
    });
    for known in KNOWN {
        let meaning = match lang {
            Lang::En => known.en,
            Lang::Zh => known.zh,
        };
        let _ = writeln!(
            out,
            "| {:04X}h:{:02X}h | `{}` | {} | {meaning} |",
            known.object.index,
            known.object.sub,
            known.name,
            known.kind.name()
        );
    }
}

/// The manual.
pub fn markdown(lang: Lang) -> String {
    let mut out = String::from(match lang {
        Lang::En => INTRO_EN,
        Lang::Zh => INTRO_ZH,
    });
    for chapter in &CHAPTERS {
        let title = chapter.title(lang);
        let head = match lang {
            Lang::En => "| No. | Alias | Name | Unit | Range | Built in | Meaning | Source |",
            Lang::Zh => "| 号 | 别号 | 名称 | 单位 | 范围 | 内置值 | 含义 | 出处 |",
        };
        // Writing into a string cannot fail.
        let _ = writeln!(
            out,
            "\n## {title}\n\n{head}\n|---|---|---|---|---|---|---|---|"
        );
        for entry in Entry::all().iter().filter(|e| (chapter.numbers)(e.no)) {
            row(&mut out, entry, lang);
        }
    }
    drives(&mut out, lang);
    out
}

/// One line of the table; of a family only the first member, for all of them.
fn row(out: &mut String, entry: &Entry, lang: Lang) {
    let mut number = entry.to_string();
    let mut names = format!("`{}`", name(entry));
    let mut meaning = meaning(entry, lang).to_owned();
    if let Some((first, last)) = entry.text().family {
        if entry.no != first {
            return;
        }
        let of_last = Entry::find(last, Some(entry.part)).map(|e| (e.to_string(), name(e)));
        if let Ok((last_number, last_name)) = of_last {
            number = format!("{number} … {last_number}");
            names = format!("{names} … `{last_name}`");
            meaning.push_str(match lang {
                Lang::En => "; and so on",
                Lang::Zh => "；其余类推",
            });
        }
    }
    let alias = entry.alias().map(|a| a.to_string()).unwrap_or_default();
    let unit = unit_text(entry, lang);
    let (min, max) = (
        entry.unit().number(entry.min()),
        entry.unit().number(entry.max()),
    );
    let none = match (entry.none(), lang) {
        (None, _) => "",
        (Some(_), Lang::En) => ", or `none`",
        (Some(_), Lang::Zh) => "，或 `none`",
    };
    let built_in = value_text(entry, Params::slant_bed().get(entry));
    let sheet = entry.text().sheet;
    let _ = writeln!(
        out,
        "| {number} | {alias} | {names} | {unit} | {min} … {max}{none} | {built_in} | {meaning} | {sheet} |"
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_manual_in_the_repository_is_current() {
        let kept = include_str!("../../../../docs/parameters.md");
        assert!(
            kept == markdown(Lang::En),
            "docs/parameters.md is not current: `cargo xtask renew` writes it anew"
        );
    }

    #[test]
    fn every_parameter_is_in_the_manual_in_both_languages() {
        for lang in [Lang::En, Lang::Zh] {
            let text = markdown(lang);
            for entry in Entry::all() {
                let first = entry
                    .text()
                    .family
                    .is_none_or(|(first, _)| first == entry.no);
                let rows = text.matches(&format!("\n| {entry} ")).count();
                assert_eq!(rows, usize::from(first), "{entry}");
            }
            // Eight columns everywhere, four for the drives: no text breaks the table.
            let (set, drives) = text.rsplit_once("\n## ").unwrap();
            for (text, bars) in [(set, 9), (drives, 5)] {
                for line in text.lines().filter(|line| line.starts_with('|')) {
                    assert_eq!(line.matches('|').count(), bars, "{line}");
                }
            }
        }
    }
}
