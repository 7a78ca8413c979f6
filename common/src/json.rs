//! JSON by hand: one flat-out writer for move lists and one-object results alike, with exact decimals.

use crate::number;

/// Writes one object or array element by element. It writes the commas; the caller gets braces by [`Json::object`] and
/// brackets by [`Json::array_at`].
#[derive(Debug, Default)]
pub struct Json {
    out: Vec<u8>,
    comma: bool,
}

impl Json {
    /// Empty.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The written bytes.
    #[must_use]
    pub fn into_bytes(self) -> Vec<u8> {
        self.out
    }

    fn separate(&mut self) {
        if self.comma {
            self.out.push(b',');
        }
        self.comma = true;
    }

    fn key(&mut self, key: &str) {
        self.separate();
        string(&mut self.out, key);
        self.out.push(b':');
    }

    /// `{ … }` as an element or as the whole.
    pub fn object(&mut self, fill: impl FnOnce(&mut Self)) {
        self.separate();
        self.braces(b'{', b'}', fill);
    }

    /// `"key": { … }`.
    pub fn object_at(&mut self, key: &str, fill: impl FnOnce(&mut Self)) {
        self.key(key);
        self.braces(b'{', b'}', fill);
    }

    /// `"key": [ … ]`.
    pub fn array_at(&mut self, key: &str, fill: impl FnOnce(&mut Self)) {
        self.key(key);
        self.braces(b'[', b']', fill);
    }

    fn braces(&mut self, open: u8, close: u8, fill: impl FnOnce(&mut Self)) {
        self.out.push(open);
        self.comma = false;
        fill(self);
        self.out.push(close);
        self.comma = true;
    }

    /// `"key": "text"`.
    pub fn text(&mut self, key: &str, value: &str) {
        self.key(key);
        string(&mut self.out, value);
    }

    /// `"key": true`.
    pub fn flag(&mut self, key: &str, value: bool) {
        self.key(key);
        self.out
            .extend_from_slice(if value { b"true" } else { b"false" });
    }

    /// `"key": value`.
    pub fn integer(&mut self, key: &str, value: i64) {
        self.decimal::<0>(key, value);
    }

    /// `"key": value · 10^−D`.
    pub fn decimal<const D: u32>(&mut self, key: &str, value: i64) {
        self.key(key);
        number::decimal::<D>(&mut self.out, value);
    }

    /// `"key": digits`, for digits that are a JSON number already.
    pub fn number(&mut self, key: &str, digits: impl std::fmt::Display) {
        self.key(key);
        self.out.extend_from_slice(digits.to_string().as_bytes());
    }

    /// A text as an element.
    pub fn text_item(&mut self, value: &str) {
        self.separate();
        string(&mut self.out, value);
    }

    /// A number as an element: digits that are a JSON number already.
    pub fn item(&mut self, digits: &str) {
        self.separate();
        self.out.extend_from_slice(digits.as_bytes());
    }

    /// `"key": null`.
    pub fn null(&mut self, key: &str) {
        self.key(key);
        self.out.extend_from_slice(b"null");
    }
}

/// Appends a JSON string.
pub fn string(out: &mut Vec<u8>, text: &str) {
    out.push(b'"');
    for c in text.chars() {
        match c {
            '"' => out.extend_from_slice(b"\\\""),
            '\\' => out.extend_from_slice(b"\\\\"),
            '\n' => out.extend_from_slice(b"\\n"),
            '\r' => out.extend_from_slice(b"\\r"),
            '\t' => out.extend_from_slice(b"\\t"),
            c if u32::from(c) < 0x20 => {
                out.extend_from_slice(format!("\\u{:04x}", u32::from(c)).as_bytes())
            }
            c => out.extend_from_slice(c.encode_utf8(&mut [0; 4]).as_bytes()),
        }
    }
    out.push(b'"');
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nests_and_escapes() {
        let mut json = Json::new();
        json.object(|o| {
            o.text("a", "q\"\\\n\u{1}\u{86ba}");
            o.array_at("b", |b| {
                b.object(|_| {});
                b.object(|o| o.flag("c", true));
            });
            o.decimal::<6>("d", -1_500_000);
            o.object_at("e", |_| {});
            o.null("f");
        });
        let text = String::from_utf8(json.into_bytes()).unwrap();
        let expected = "{\"a\":\"q\\\"\\\\\\n\\u0001\u{86ba}\",\"b\":[{},{\"c\":true}],\"d\":-1.5,\"e\":{},\"f\":null}";
        assert_eq!(text, expected);
        assert!(serde_json::from_str::<serde_json::Value>(&text).is_ok());
    }
}
