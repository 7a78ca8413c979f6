//! Errors between this side and a board: each with the node, the object, the code and the remedy.

use leadscrew_can::{CanError, Suspicion};
use leadscrew_core::alarm::{Alarm, Lang};
use leadscrew_core::bus::{Abort, Object, SdoError};
use leadscrew_core::link::Version;

use crate::diagnostics::alarm_words;
use crate::failure::Failure;
use crate::words::{Both, both};

/// A result of the link.
pub type LinkResult<T = ()> = Result<T, Trouble>;

/// Reasons why a board cannot be reached or does not obey.
#[derive(Debug)]
pub enum Trouble {
    /// An error of the bus.
    Can(CanError),
    /// No node answers under this number.
    NoBoard {
        /// The requested number.
        node: u8,
        /// The bus.
        bus: String,
        /// Its heartbeats say that it has been stopped.
        stopped: bool,
        /// Other nodes that were heard.
        others: Vec<u8>,
        /// What the error frames suggest.
        suspicion: Option<Suspicion>,
    },
    /// More than one node answers under this number.
    TwoBoards {
        /// The number.
        node: u8,
        /// The bus.
        bus: String,
    },
    /// Another device has this number.
    NotABoard {
        /// The number.
        node: u8,
        /// Its product code, if it has one.
        product: Option<u32>,
    },
    /// The board uses another version of the link.
    Version {
        /// The number.
        node: u8,
        /// The board's version.
        theirs: Version,
        /// This side's version.
        ours: Version,
    },
    /// The board was heard before and is silent now.
    Lost {
        /// The number.
        node: u8,
        /// The bus.
        bus: String,
        /// What the error frames suggest.
        suspicion: Option<Suspicion>,
    },
    /// An NMT command has stopped the board in the middle of its work.
    Stopped {
        /// The number.
        node: u8,
        /// The bus.
        bus: String,
    },
    /// The board has started again and has forgotten its orders.
    Restarted {
        /// The number.
        node: u8,
        /// The bus.
        bus: String,
    },
    /// A transfer failed.
    Transfer {
        /// The number.
        node: u8,
        /// The object.
        object: Object,
        /// True for a write.
        write: bool,
        /// The error.
        error: SdoError,
    },
    /// The board has another parameter table.
    Table {
        /// The number.
        node: u8,
        /// The board's key.
        theirs: u32,
        /// This side's key.
        ours: u32,
    },
    /// The board refuses a change of its parameters or cannot store it.
    Parameters {
        /// The number.
        node: u8,
        /// The reason, if the board tells it.
        reason: Option<Alarm>,
    },
    /// The board refuses a change of its offsets and tools or cannot store it.
    Offsets {
        /// The number.
        node: u8,
        /// The reason, if the board tells it.
        reason: Option<Alarm>,
    },
    /// The board has accepted a change of its parameters and does not tell the result.
    Unsettled {
        /// The number.
        node: u8,
        /// It has started again meanwhile; otherwise it is still storing.
        restarted: bool,
    },
    /// The same of its offsets and tools.
    UnsettledOffsets {
        /// The number.
        node: u8,
        /// It has started again meanwhile; otherwise it is still storing.
        restarted: bool,
    },
    /// The board does not confirm an order.
    Unconfirmed {
        /// The number.
        node: u8,
        /// The order, as typed.
        order: &'static str,
        /// It has taken another order meanwhile, or has started again.
        overtaken: bool,
    },
    /// The board does not carry an order out.
    Refused {
        /// The number.
        node: u8,
        /// The reason.
        reason: Alarm,
    },
    /// The board's answer makes no sense.
    Strange {
        /// The number.
        node: u8,
        /// The object.
        object: Object,
    },
}

impl From<CanError> for Trouble {
    fn from(error: CanError) -> Self {
        Self::Can(error)
    }
}

/// The name of an object for people; only of objects that this side uses.
fn object_name(object: Object) -> Both {
    match object.index {
        0x1000..0x2000 => both!("communication object", "通信对象"),
        0x2000..0x5000 => both!("parameter {no}", "参数 {no}", no = object.index - 0x2000),
        0x5000 => both!("command", "命令"),
        0x5001 => both!("status", "状态"),
        0x5002 => both!("operation by hand", "手动操作"),
        0x5010 => both!("parameter set", "参数集"),
        0x5011 => both!("offsets and tools", "偏置与刀具"),
        0x5020 => both!("program", "程序"),
        0x5030 => both!("tap journal", "攻丝记录"),
        0x5040 => both!("event log", "事件日志"),
        0x5041 | 0x5042 => both!("certificate", "精度证书"),
        0x5060 => both!("signals", "信号"),
        0x5061..=0x5064 => both!("inputs and outputs", "输入和输出"),
        _ => both!("object", "对象"),
    }
}

/// The remedy for an abort.
fn remedy(error: SdoError) -> Both {
    match error {
        SdoError::TimedOut => both!(
            "look whether the board is still on and its bus not overloaded, then try again; whether a write took effect \
             is not known",
            "请检查控制板是否还在工作、总线是否过载，然后重试；写操作是否已生效不得而知"
        ),
        _ => match error.abort() {
            Some(Abort::State) => both!(
                "the machine is in a state that does not allow it: `leadscrew status` shows which, `leadscrew reset` \
                 ends it",
                "机床当前状态不允许：`leadscrew status` 可查看状态，`leadscrew reset` 可结束它"
            ),
            Some(Abort::LocalControl) => both!(
                "parameter write is off: switch it on first",
                "参数写保护已打开：请先打开参数写入开关"
            ),
            Some(Abort::NoObject | Abort::NoSubIndex) => both!(
                "the board's software does not have it; bring both to one version",
                "控制板软件没有此对象；请把两边更新到同一版本"
            ),
            Some(Abort::TooHigh | Abort::TooLow | Abort::Value) => both!(
                "write a value within the range (`leadscrew params get`)",
                "请写入范围之内的值（见 `leadscrew params get`）"
            ),
            Some(
                Abort::Toggle | Abort::Specifier | Abort::Sequence | Abort::Crc | Abort::BlockSize,
            ) => both!(
                "another program on this bus may be talking to the same board, or frames get lost: end it, look at the \
                 wiring, then try again",
                "总线上可能有另一个程序正在与同一控制板通信，或有报文丢失：请结束它、检查接线后重试"
            ),
            _ => both!(
                "try again; if it stays, look at `leadscrew status`",
                "请重试；若仍如此，请看 `leadscrew status`"
            ),
        },
    }
}

/// Code and text of the abort.
#[must_use]
pub fn reason(error: SdoError) -> Both {
    let text = |lang| {
        error
            .abort()
            .map_or_else(String::new, |abort| abort.text_in(lang).to_owned())
    };
    let code = match error {
        SdoError::Refused(code) => code,
        SdoError::Broken(abort) => abort.code(),
        SdoError::TimedOut => Abort::TimedOut.code(),
    };
    let unknown = error.abort().is_none();
    let en = if unknown {
        "maker's own code".into()
    } else {
        text(Lang::En)
    };
    let zh = if unknown {
        "厂家自定义代码".into()
    } else {
        text(Lang::Zh)
    };
    match error {
        SdoError::Refused(_) => both!(
            "refused with abort code {code:08X}h ({en})",
            "被拒绝，中止代码 {code:08X}h（{zh}）"
        ),
        SdoError::Broken(_) => both!(
            "broken off from this side with abort code {code:08X}h ({en})",
            "由本侧中止，中止代码 {code:08X}h（{zh}）"
        ),
        SdoError::TimedOut => both!(
            "timed out, abort code {code:08X}h ({en})",
            "超时，中止代码 {code:08X}h（{zh}）"
        ),
    }
}

/// Why a board has refused a change, if it says so.
fn why(reason: Option<&Alarm>) -> Both {
    reason.map_or_else(
        || {
            both!(
                "it gives no reason; try again, and look at `leadscrew status`",
                "它没有给出原因；请重试，并查看 `leadscrew status`"
            )
        },
        alarm_words,
    )
}

fn suspected(suspicion: Option<Suspicion>) -> Both {
    suspicion.map_or_else(Both::default, |suspicion| {
        both!(
            "; the bus itself looks wrong: {suspicion}",
            "；总线本身似乎有问题：{zh}",
            zh = suspicion.chinese()
        )
    })
}

impl Trouble {
    /// True where the other side has refused with this abort code.
    #[must_use]
    pub fn is_abort(&self, abort: Abort) -> bool {
        matches!(self, Self::Transfer { error, .. } if error.abort() == Some(abort))
    }

    /// The abort code of a refusal by the other side; `None` for a disturbed transfer.
    #[must_use]
    pub fn refusal(&self) -> Option<u32> {
        match self {
            Self::Transfer {
                error: SdoError::Refused(code),
                ..
            } if *code != Abort::TimedOut.code() => Some(*code),
            _ => None,
        }
    }

    /// In words.
    #[must_use]
    pub fn words(&self) -> Both {
        match self {
            Self::Can(error) => Both {
                en: error.to_string(),
                zh: error.chinese(),
            },
            Self::NoBoard {
                node,
                bus,
                stopped: true,
                ..
            } => both!(
                "node {node} on `{bus}` has been stopped by NMT, and a node that is stopped answers nothing: whoever has stopped \
                 it has to start it (`cansend IFACE 000#01{node:02X}`)",
                "`{bus}` 上的节点 {node} 已被 NMT 停止，停止状态的节点不作应答：须由停止它的一方重新启动（`cansend IFACE \
                 000#01{node:02X}`）"
            ),
            Self::NoBoard {
                node,
                bus,
                stopped: false,
                others,
                suspicion,
            } => {
                let suspicion = suspected(*suspicion);
                let heard = if others.is_empty() {
                    both!("nobody else was heard there", "那里也没有听到任何其它节点")
                } else {
                    let list: Vec<String> = others.iter().map(u8::to_string).collect();
                    let list = list.join(", ");
                    both!("heard there: node {list}", "那里听到的节点：{list}")
                };
                both!(
                    "no board answers as node {node} on `{bus}`: is it on, is this its number (`--node`), do wiring and bit \
                     rate fit? {heard_en}{en}",
                    "`{bus}` 上没有控制板以节点 {node} 应答：它通电了吗？节点号（`--node`）、接线和波特率对吗？{heard_zh}{zh}",
                    heard_en = heard.en,
                    heard_zh = heard.zh,
                    en = suspicion.en,
                    zh = suspicion.zh
                )
            }
            Self::TwoBoards { node, bus } => both!(
                "two boards answer as node {node} on `{bus}`: switch one of them off, give it another number, then go on",
                "`{bus}` 上有两块控制板同时以节点 {node} 应答：请先关掉其中一块并改用别的节点号"
            ),
            Self::NotABoard { node, product } => {
                let product = match product {
                    Some(product) => {
                        both!("product code {product:08X}h", "产品代码 {product:08X}h")
                    }
                    None => both!("no identity object 1018h", "没有标识对象 1018h"),
                };
                both!(
                    "node {node} is no Leadscrew board ({en}): name the board's number with `--node`",
                    "节点 {node} 不是 Leadscrew 控制板（{zh}）：请用 `--node` 指定控制板的节点号",
                    en = product.en,
                    zh = product.zh
                )
            }
            Self::Version { node, theirs, ours } => both!(
                "node {node} speaks version {theirs} of the link, this program version {ours}: bring board and `leadscrew` \
                 to one version",
                "节点 {node} 的链路版本是 {theirs}，本程序是 {ours}：请把控制板和 `leadscrew` 更新到同一版本"
            ),
            Self::Lost {
                node,
                bus,
                suspicion,
            } => {
                let suspicion = suspected(*suspicion);
                both!(
                    "node {node} on `{bus}` has gone silent: was it switched off or unplugged? What the machine does then is \
                     its own decision (parameter of the gateway's loss); go and look{en}",
                    "`{bus}` 上的节点 {node} 不再应答：是否断电或拔线？此时机床的动作由其参数决定，请到现场查看{zh}",
                    en = suspicion.en,
                    zh = suspicion.zh
                )
            }
            Self::Stopped { node, bus } => both!(
                "somebody on `{bus}` has stopped node {node} by NMT (000#02{node:02X}, or 000#0200 for all nodes): what moved comes \
                 to a controlled stop with alarm 4331, and a node that is stopped answers nothing. Find out which program sends \
                 that and end it, start the node (`cansend IFACE 000#01{node:02X}`), look at the machine, `leadscrew reset`, then \
                 run the program again",
                "`{bus}` 上有人用 NMT 停止了节点 {node}（000#02{node:02X}，或对所有节点的 000#0200）：正在进行的运动受控停止并报警 \
                 4331，停止状态的节点不作应答。请找出并结束发送该命令的程序，启动节点（`cansend IFACE 000#01{node:02X}`），查看机床，\
                 执行 `leadscrew reset`，然后重新运行程序"
            ),
            Self::Restarted { node, bus } => both!(
                "node {node} on `{bus}` has started again in the middle of the program and has forgotten it (it was asked, and says \
                 that it has another program or none): was its supply interrupted, or has somebody reset it? The axes stand where \
                 their drives stopped; look at the machine before anything moves",
                "`{bus}` 上的节点 {node} 在程序运行中重新启动，程序已丢失（经询问，它没有该程序）：供电是否中断，或有人将它复位？各轴停在驱动器停止的位置；\
                 再次运动前请查看机床"
            ),
            Self::Transfer {
                node,
                object,
                write,
                error,
            } => {
                let (name, reason, remedy) = (object_name(*object), reason(*error), remedy(*error));
                let doing = if *write {
                    both!("writing", "写")
                } else {
                    both!("reading", "读")
                };
                let (index, sub) = (object.index, object.sub);
                both!(
                    "node {node}: {doing_en} object {index:04X}h:{sub:02X}h ({name_en}) {en}; {remedy_en}",
                    "节点 {node}：{doing_zh}对象 {index:04X}h:{sub:02X}h（{name_zh}）{zh}；{remedy_zh}",
                    doing_en = doing.en,
                    doing_zh = doing.zh,
                    name_en = name.en,
                    name_zh = name.zh,
                    en = reason.en,
                    zh = reason.zh,
                    remedy_en = remedy.en,
                    remedy_zh = remedy.zh
                )
            }
            Self::Table { node, theirs, ours } => both!(
                "node {node} has parameter table {theirs:08X}h (object 1020h:02h), this program has {ours:08X}h (schema {schema}): \
                 bring board and `leadscrew` to one version; a file goes over with `leadscrew params migrate`",
                "节点 {node} 的参数表是 {theirs:08X}h（对象 1020h:02h），本程序的是 {ours:08X}h（schema {schema}）：请把控制板和 \
                 `leadscrew` 更新到同一版本；文件可用 `leadscrew params migrate` 转换",
                schema = leadscrew_core::params::SCHEMA
            ),
            Self::Parameters { node, reason } => {
                let why = why(reason.as_ref());
                both!(
                    "node {node} has not taken the parameters, and its set has not been changed: {en}",
                    "节点 {node} 未接受参数，其参数集未作改动：{zh}",
                    en = why.en,
                    zh = why.zh
                )
            }
            Self::Offsets { node, reason } => {
                let why = why(reason.as_ref());
                both!(
                    "node {node} has not taken the offsets and tools, and nothing has been changed: {en}",
                    "节点 {node} 未接受偏置与刀具数据，未作任何改动：{zh}",
                    en = why.en,
                    zh = why.zh
                )
            }
            Self::Unsettled {
                node,
                restarted: true,
            } => both!(
                "node {node} has started again while it stored the parameters: whether it has the new set or the old one is \
                 not known; push again",
                "节点 {node} 在保存参数时重新启动：其参数集是新的还是旧的不得而知；请重新写入"
            ),
            Self::Unsettled {
                node,
                restarted: false,
            } => both!(
                "node {node} has not stored the parameters in time (object 5010h:02h): whether it has the new set or the old \
                 one is not known; push again",
                "节点 {node} 未能按时保存参数（对象 5010h:02h）：其参数集是新的还是旧的不得而知；请重新写入"
            ),
            Self::UnsettledOffsets {
                node,
                restarted: true,
            } => both!(
                "node {node} has started again while it stored the offsets and tools: look at what it has \
                 (`leadscrew offsets list`, `leadscrew tools list`), and make the change again where it is missing",
                "节点 {node} 在保存偏置与刀具数据时重新启动：请查看现有数据（`leadscrew offsets list`、`leadscrew tools list`），\
                 缺少的改动请重新写入"
            ),
            Self::UnsettledOffsets {
                node,
                restarted: false,
            } => both!(
                "node {node} has not stored the offsets and tools in time (object 5011h:02h): whether it has the new table \
                 or the old one is not known; look at what it has (`leadscrew offsets list`, `leadscrew tools list`)",
                "节点 {node} 未能按时保存偏置与刀具数据（对象 5011h:02h）：其数据是新的还是旧的不得而知；请查看现有数据\
                 （`leadscrew offsets list`、`leadscrew tools list`）"
            ),
            Self::Unconfirmed {
                node,
                order,
                overtaken: true,
            } => both!(
                "another console has given node {node} an order since `{order}` was sent, or the board has begun anew; `{order}` \
                 is not sent again: look at the machine",
                "发出 `{order}` 之后，另一个操作台向节点 {node} 下达了命令，或控制板已重新启动；不再重发 `{order}`：请查看机床"
            ),
            Self::Unconfirmed { node, order, .. } => both!(
                "node {node} does not confirm `{order}` (object 5001h:05h, count of the last order): look at the machine; its \
                 own stop button works without this bus",
                "节点 {node} 没有确认 `{order}`（对象 5001h:05h，最后一条命令的计数）：请查看机床；机床自带的急停不依赖此总线"
            ),
            Self::Refused { node, reason } => {
                let why = alarm_words(reason);
                both!(
                    "node {node} does not do it: {en}",
                    "节点 {node} 未执行：{zh}",
                    en = why.en,
                    zh = why.zh
                )
            }
            Self::Strange { node, object } => both!(
                "node {node}: object {index:04X}h:{sub:02X}h holds bytes that mean nothing to this program: bring board and \
                 `leadscrew` to one version",
                "节点 {node}：对象 {index:04X}h:{sub:02X}h 的内容本程序无法识别：请把控制板和 `leadscrew` 更新到同一版本",
                index = object.index,
                sub = object.sub
            ),
        }
    }
}

impl From<Trouble> for Failure {
    fn from(trouble: Trouble) -> Self {
        match trouble {
            Trouble::Parameters { .. } | Trouble::Offsets { .. } | Trouble::Refused { .. } => {
                Self::WrongBecause(trouble.words())
            }
            _ => Self::Bus(trouble.words()),
        }
    }
}
