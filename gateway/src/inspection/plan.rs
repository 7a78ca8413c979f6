//! The threads of a program that has been checked, and in words why there is no plan of them.

use leadscrew_inspection::{Declared, Finder, Plan, Refusal, Wish};
use leadscrew_metrology::NotKnown;

use crate::failure::{Failure, Outcome};
use crate::number::measured;
use crate::setup::Setup;
use crate::source::SourceFile;
use crate::walk::Walk;
use crate::words::{Both, both};

/// The threads of a program, on the stock that it declares.
///
/// # Errors
/// The program cannot be read; a name says nothing, or there are not as many names as threads.
pub fn plan(setup: &Setup, source: &SourceFile, wish: &Wish) -> Outcome<Plan> {
    let mut walk = Walk::open(setup, source)?;
    let stock = walk.stock().copied();
    let wish = Wish {
        stock: stock.map(|stock| Declared::new(stock.outside, stock.bore, stock.face)),
        ..wish.clone()
    };
    let mut finder = Finder::default();
    while let Some(call) = walk.next_call(|_, each| finder.step(each))? {
        finder.call(&call);
    }
    finder
        .plan(&wish)
        .map_err(|why| Failure::Usage(words(&why)))
}

fn words(why: &Refusal) -> Both {
    match why {
        Refusal::Names { names, threads } => both!(
            "`--thread` names {names} threads, and the program has {threads}: name one for all, or each",
            "`--thread` 给出 {names} 个螺纹，而程序有 {threads} 个：请给出一个（用于全部）或逐个给出"
        ),
        Refusal::Pitch {
            name,
            line,
            named,
            cut,
        } => both!(
            "`--thread {name}` has a pitch of {named} mm, and line {line} cuts one of {cut} mm",
            "`--thread {name}` 的螺距是 {named} mm，而第 {line} 行车削的螺距是 {cut} mm",
            named = measured(named.0),
            cut = measured(cut.0)
        ),
        Refusal::Starts {
            name,
            line,
            named,
            cut,
        } => both!(
            "`--thread {name}` has {starts} with a lead of {lead} mm, and line {line} cuts {own} with one of {cut} mm: write it \
             as `M30x4P2` (lead, pitch)",
            "`--thread {name}` 为 {from} 头、导程 {lead} mm，而第 {line} 行车削 {to} 头、导程 {cut} mm：写法如 `M30x4P2`（导程、螺距）",
            starts = counted(named.0),
            own = counted(cut.0),
            from = named.0,
            to = cut.0,
            lead = measured(named.1.0),
            cut = measured(cut.1.0)
        ),
        Refusal::Name { name, reason } => {
            let why = reason_in_words(*reason);
            both!(
                "`--thread {name}`: {en}",
                "`--thread {name}`：{zh}",
                en = why.en,
                zh = why.zh
            )
        }
    }
}

fn counted(starts: u8) -> String {
    match starts {
        1 => "one start".to_owned(),
        starts => format!("{starts} starts"),
    }
}

fn reason_in_words(reason: NotKnown) -> Both {
    match reason {
        NotKnown::Form => both!(
            "names are written `M40x3-6g`, `M30x4P2-6H` (lead, pitch), `1/4-20UNC-2A`, `1/2-14NPT`",
            "名称写成 `M40x3-6g`、`M30x4P2-6H`（导程、螺距）、`1/4-20UNC-2A`、`1/2-14NPT`"
        ),
        NotKnown::Pitch => both!(
            "this size has no coarse pitch in the table: write the pitch, `M41x2-6g`",
            "表中没有该直径的粗牙螺距：请写明螺距，如 `M41x2-6g`"
        ),
        NotKnown::Class => both!(
            "it needs a tolerance class that is known: `6g` or `5g6g` for a bolt, `6H` for a nut; `2A`, `2B`",
            "需要已知的公差带：外螺纹如 `6g`、`5g6g`，内螺纹如 `6H`；或 `2A`、`2B`"
        ),
        NotKnown::Side => both!(
            "its class is one of the other side: small letters and A are bolts, capital letters and B are nuts",
            "公差带属于另一侧：小写字母和 A 为外螺纹，大写字母和 B 为内螺纹"
        ),
        NotKnown::Size => both!(
            "B1.20.1 has no such size among those that are known, up to `2-11.5NPT`",
            "B1.20.1 的已知规格中没有该尺寸，最大为 `2-11.5NPT`"
        ),
    }
}
