//! The origin of a result: the program, the board with its parameters, and the time. A shop keeps it with a part.

use std::time::{SystemTime, UNIX_EPOCH};

use crate::json::Json;
use crate::words::{Both, both};

/// The board that has carried out a program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BoardName {
    /// Its node number.
    pub node: u8,
    /// 1018h:04.
    pub serial: u32,
    /// Version of its software: 100Ah.
    pub version: String,
}

/// The origin of a result.
#[derive(Clone, Debug)]
pub struct Origin {
    /// The program's name as typed.
    pub program: String,
    /// CRC-32 of the parameter set in force (1020h); `None` where no set is in force, or where it is unknown.
    pub parameters: Option<u32>,
    /// The machine file beside the program.
    pub machine: Option<String>,
    /// The board and the start time; `None` for a simulation, which gives the same result at any time.
    pub board: Option<(BoardName, SystemTime)>,
}

impl Origin {
    /// `program`, `parameters`, `machine`, `gateway`, `board` and `started`.
    pub fn fields(&self, json: &mut Json) {
        json.text("program", &self.program);
        match self.parameters {
            Some(identity) => json.text("parameters", &format!("{identity:08x}")),
            None => json.null("parameters"),
        }
        match &self.machine {
            Some(file) => json.text("machine", file),
            None => json.null("machine"),
        }
        json.text("gateway", env!("CARGO_PKG_VERSION"));
        let Some((board, started)) = &self.board else {
            json.null("board");
            json.null("started");
            return;
        };
        json.object_at("board", |json| {
            json.number("node", board.node);
            json.text("serial", &format!("{:08x}", board.serial));
            json.text("version", &board.version);
        });
        json.text("started", &utc(*started));
    }

    /// A line for a person, for a run on a board.
    pub fn line(&self) -> Option<Both> {
        let (board, started) = self.board.as_ref()?;
        let started = utc(*started);
        let (node, serial, version) = (board.node, board.serial, &board.version);
        let parameters = self.parameters?;
        Some(both!(
            "board node {node}, serial number {serial:08x}, version {version}, parameters {parameters:08x}; started {started}\n",
            "控制板 节点 {node}，序列号 {serial:08x}，版本 {version}，参数集 {parameters:08x}；开始于 {started}\n"
        ))
    }
}

/// `2026-11-22T01:38:03Z`. A clock that was never set shows its first instant.
#[must_use]
pub fn utc(time: SystemTime) -> String {
    humantime::format_rfc3339_seconds(time.max(UNIX_EPOCH)).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    fn told(origin: &Origin) -> serde_json::Value {
        let mut json = Json::new();
        json.object(|json| origin.fields(json));
        serde_json::from_slice(&json.into_bytes()).unwrap()
    }

    #[test]
    fn a_time_is_told_in_the_calendar() {
        // As `date -u -d @…` prints them.
        for (seconds, text) in [
            (0, "1970-01-01T00:00:00Z"),
            (951_782_399, "2000-02-28T23:59:59Z"),
            (951_782_400, "2000-02-29T00:00:00Z"),
            (951_868_800, "2000-03-01T00:00:00Z"),
            (1_795_311_483, "2026-11-22T01:38:03Z"),
            (1_798_761_599, "2026-12-31T23:59:59Z"),
            (1_798_761_600, "2027-01-01T00:00:00Z"),
            (4_107_542_399, "2100-02-28T23:59:59Z"),
            (4_107_542_400, "2100-03-01T00:00:00Z"),
        ] {
            assert_eq!(utc(UNIX_EPOCH + Duration::from_secs(seconds)), text);
        }
    }

    #[test]
    fn a_result_says_where_it_comes_from() {
        let mut origin = Origin {
            program: "shaft.nc".into(),
            parameters: Some(0xA5),
            machine: None,
            board: None,
        };
        assert_eq!(origin.line(), None);
        let simulated = told(&origin);
        assert_eq!(
            simulated,
            serde_json::json!({
                "program": "shaft.nc", "parameters": "000000a5", "machine": null, "gateway": env!("CARGO_PKG_VERSION"),
                "board": null, "started": null
            })
        );
        let board = BoardName {
            node: 3,
            serial: 0x1234,
            version: "0.1.0".into(),
        };
        origin.board = Some((board, UNIX_EPOCH + Duration::from_secs(1)));
        let real = told(&origin);
        assert_eq!(real["started"], "1970-01-01T00:00:01Z");
        assert_eq!(
            real["board"],
            serde_json::json!({"node": 3, "serial": "00001234", "version": "0.1.0"})
        );
        assert_eq!(
            origin.line().unwrap().en,
            "board node 3, serial number 00001234, version 0.1.0, parameters 000000a5; started 1970-01-01T00:00:01Z\n"
        );
    }
}
