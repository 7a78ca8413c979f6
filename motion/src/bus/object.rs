//! The interface between an SDO server and the objects of its node, and the abort codes.
//!
//! The server moves bytes and must not know types. An implementation of [`Objects`] knows the meaning, the length and
//! the allowed values of each object. Values are little-endian, as everywhere in CANopen.

use crate::alarm::Lang;

/// An entry of the object dictionary.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Object {
    /// Index, 0000h–FFFFh.
    pub index: u16,
    /// Sub-index, 0–FFh; 0 for an object that is a single value.
    pub sub: u8,
}

impl Object {
    /// Sub-index `sub` of object `index`.
    #[must_use]
    pub const fn new(index: u16, sub: u8) -> Self {
        Self { index, sub }
    }
}

/// The objects of a node, as its SDO server sees them.
///
/// A server calls in a fixed order, one transfer at a time:
///
/// - **Read.** [`size`](Self::size) once, then [`read`](Self::read) with offsets that mostly grow. In a block transfer
///   an offset goes back after lost frames. Therefore the bytes at an offset must not change until the next `size` of
///   the same object: `size` copies a value that changes by itself. There is no call for the end of a read.
/// - **Write.** [`begin_write`](Self::begin_write), then [`write`](Self::write) with the whole value in pieces, in
///   order, without gap or repetition, then [`end_write`](Self::end_write): only here the value takes effect. If
///   `begin_write` succeeds and `end_write` does not follow for any reason (a refusal of `write`, for example), the
///   write is [abandoned](Self::abandon). A refusal of `end_write` ends the write too; `abandon` does not follow it.
///
/// A refusal is the abort code that the client gets.
pub trait Objects {
    /// Begins a read and gives the length in bytes; 0 is a valid length.
    fn size(&mut self, object: Object) -> Result<u32, Abort>;

    /// Fills `into` with the bytes from `offset` on and returns their number; it is less than the length of `into` only
    /// at the end of the value.
    fn read(&mut self, object: Object, offset: u32, into: &mut [u8]) -> Result<usize, Abort>;

    /// Begins a write of `size` bytes; `None`: the client did not give the length.
    fn begin_write(&mut self, object: Object, size: Option<u32>) -> Result<(), Abort>;

    /// Takes the next bytes, at `offset`. They take no effect yet.
    fn write(&mut self, object: Object, offset: u32, bytes: &[u8]) -> Result<(), Abort>;

    /// The client has sent all `length` bytes and has confirmed it: checks the value and puts it into effect, all or
    /// nothing.
    fn end_write(&mut self, object: Object, length: u32) -> Result<(), Abort>;

    /// Discards a write that was begun.
    fn abandon(&mut self, object: Object);
}

macro_rules! aborts {
    ($($code:literal $name:ident $en:literal $zh:literal;)*) => {
        /// The abort codes of CiA 301: the reasons to refuse or abort a transfer.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[repr(u32)]
        pub enum Abort {
            $(#[doc = concat!(stringify!($code), ": ", $en, ".")] $name = $code,)*
        }

        impl Abort {
            /// All of them, by code.
            pub const ALL: &[Self] = &[$(Self::$name,)*];

            /// The abort with this code; `None` for a code that CiA 301 does not define.
            #[must_use]
            pub const fn from_code(code: u32) -> Option<Self> {
                match code {
                    $($code => Some(Self::$name),)*
                    _ => None,
                }
            }

            /// The meaning in English, as a part of a sentence.
            #[must_use]
            pub const fn text(self) -> &'static str {
                match self {
                    $(Self::$name => $en,)*
                }
            }

            /// The meaning in the language `lang`.
            #[must_use]
            pub const fn text_in(self, lang: Lang) -> &'static str {
                match (lang, self) {
                    (Lang::En, _) => self.text(),
                    $((Lang::Zh, Self::$name) => $zh,)*
                }
            }
        }
    };
}

aborts! {
    0x0503_0000 Toggle "a segment came twice or one is missing (toggle bit)" "段重复或丢失（翻转位未变化）";
    0x0504_0000 TimedOut "the other side did not answer in time" "SDO 通信超时";
    0x0504_0001 Specifier "command not known or not expected here" "命令符无效或未知";
    0x0504_0002 BlockSize "block size is not 1 to 127" "块大小无效（应为 1–127）";
    0x0504_0003 Sequence "sequence number of a block does not exist" "块内序号无效";
    0x0504_0004 Crc "checksum of the data is wrong" "数据校验（CRC）错误";
    0x0504_0005 OutOfMemory "out of memory" "内存不足";
    0x0601_0000 Access "object does not allow this access" "对象不支持此访问";
    0x0601_0001 WriteOnly "object cannot be read" "对象只写，不可读";
    0x0601_0002 ReadOnly "object cannot be written" "对象只读，不可写";
    0x0602_0000 NoObject "object does not exist" "对象字典中无此对象";
    0x0604_0041 NotMappable "object cannot be mapped into a PDO" "对象不可映射到 PDO";
    0x0604_0042 PdoLength "mapped objects are longer than a PDO" "映射对象超出 PDO 长度";
    0x0604_0043 Incompatible "parameters do not go together" "参数互不兼容";
    0x0604_0047 Internal "device is not compatible with itself" "设备内部不兼容";
    0x0606_0000 Hardware "hardware error" "硬件故障，访问失败";
    0x0607_0010 Length "length does not fit the data type" "数据长度与类型不符";
    0x0607_0012 TooLong "longer than the data type" "数据过长，与类型不符";
    0x0607_0013 TooShort "shorter than the data type" "数据过短，与类型不符";
    0x0609_0011 NoSubIndex "sub-index does not exist" "子索引不存在";
    0x0609_0030 Value "value is not allowed" "参数值无效";
    0x0609_0031 TooHigh "value is too high" "参数值过大";
    0x0609_0032 TooLow "value is too low" "参数值过小";
    0x0609_0036 MaximumBelowMinimum "maximum is less than minimum" "最大值小于最小值";
    0x060A_0023 NoConnection "no SDO connection is free" "无可用的 SDO 连接";
    0x0800_0000 General "general error" "一般错误";
    0x0800_0020 NotStored "data cannot be taken over or stored" "数据无法传送或保存";
    0x0800_0021 LocalControl "data cannot be taken over: device is under local control" "设备处于本地控制，数据无法传送或保存";
    0x0800_0022 State "data cannot be taken over in the present state of the device" "设备当前状态下数据无法传送或保存";
    0x0800_0023 NoDictionary "there is no object dictionary" "对象字典不存在或生成失败";
    0x0800_0024 NoData "there are no data" "无可用数据";
}

impl Abort {
    /// The code on the wire.
    #[must_use]
    pub const fn code(self) -> u32 {
        self as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_is_read_back_and_stands_once() {
        assert_eq!(Abort::ALL.len(), 31);
        for pair in Abort::ALL.windows(2) {
            assert!(pair[0].code() < pair[1].code(), "{pair:?}");
        }
        for &abort in Abort::ALL {
            assert_eq!(Abort::from_code(abort.code()), Some(abort));
            assert!(!abort.text().is_empty());
            assert_eq!(abort.text_in(Lang::En), abort.text());
            assert!(!abort.text_in(Lang::Zh).is_ascii());
        }
        assert_eq!(Abort::from_code(0), None);
        assert_eq!(Abort::from_code(0x0609_0033), None);
    }

    #[test]
    fn codes_that_tools_print() {
        for (abort, code) in [
            (Abort::Toggle, 0x0503_0000),
            (Abort::Crc, 0x0504_0004),
            (Abort::NoObject, 0x0602_0000),
            (Abort::NoSubIndex, 0x0609_0011),
            (Abort::TooHigh, 0x0609_0031),
            (Abort::TooLow, 0x0609_0032),
            (Abort::State, 0x0800_0022),
        ] {
            assert_eq!(abort.code(), code);
        }
    }
}
