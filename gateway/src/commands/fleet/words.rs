//! What `fleet` says of a broker that tells nothing, and of times, in two languages.

use std::time::{Duration, UNIX_EPOCH};

use leadscrew_agent::Moment;
use leadscrew_agent::mqtt::retained::Deaf;
use leadscrew_agent::mqtt::{Fault, WireError};
use leadscrew_agent::set::{NoSet, Set};

use crate::cli::Asked;
use crate::commands::broker::{no_use, no_way};
use crate::failure::Failure;
use crate::origin::utc;
use crate::words::{Both, both};

/// An agent that reads a board sees a change within this time, in milliseconds.
const WATCHED: u64 = 60_000;

/// A time, in UTC.
pub fn time(at: Moment) -> String {
    // A message with a time behind the year 9999 is no set.
    let at = UNIX_EPOCH.checked_add(Duration::from_millis(at.0));
    at.map_or_else(String::new, utc)
}

/// Since when a set has been in force, as far as its agent knows.
pub fn since(set: &Set) -> Both {
    let since = time(set.since);
    match set.after {
        None => both!("{since} or earlier", "{since} 或更早"),
        Some(after) if set.since.0.saturating_sub(after.0) <= WATCHED => Both::same(since),
        Some(after) => {
            let after = time(after);
            both!("between {after} and {since}", "{after} 与 {since} 之间")
        }
    }
}

/// Why a message is no set.
pub fn no_set(why: &NoSet) -> Both {
    match why {
        NoSet::Form { line, column } => {
            both!("{why}", "不是参数集的 JSON：第 {line} 行第 {column} 列")
        }
        NoSet::Field(name) => both!("{why}", "`{name}` 的内容不可能"),
    }
}

/// Nobody was heard.
pub fn nobody(asked: &Asked) -> Failure {
    let (broker, group) = (&asked.broker, &asked.access.group);
    Failure::Bus(both!(
        "{broker} retains no set of the group `{group}`: is this the --group of the agents, are they of a version that tells \
         sets, have they met their boards, and does the broker's access list let them write and this user read \
         leadscrew/v1/#?",
        "{broker} 上没有组 `{group}` 的参数集：请检查 --group 是否与代理程序一致、代理程序的版本是否发布参数集、是否已连接控制板，以及代理服务器的\
         访问列表是否允许写入和读取 leadscrew/v1/#"
    ))
}

/// The broker has not told all.
pub fn deaf(deaf: &Deaf, asked: &Asked, topics: &str) -> Failure {
    let (broker, wait) = (&asked.broker, asked.wait);
    Failure::Bus(match deaf {
        Deaf::Wire(WireError::Tls(error)) => both!(
            "the certificate of {broker} is not believed, or its TLS is another: {error}; look at --ca and at the name of the host",
            "{broker} 的证书不可信，或 TLS 不符：{error}；请检查 --ca 和主机名"
        ),
        Deaf::Wire(error) => {
            let why = no_way(error);
            both!(
                "{broker} is not reached: {en}; is it on, and is this its address?",
                "无法连接 {broker}：{zh}；请检查其是否运行、地址是否正确",
                en = why.en,
                zh = why.zh
            )
        }
        Deaf::Broker(Fault::Login) => both!(
            "{broker} refuses user and password: look at the file of --login, and at the broker's list of users",
            "{broker} 拒绝用户名和密码：请检查 --login 的文件和代理服务器的用户表"
        ),
        Deaf::Broker(Fault::Orders) => both!(
            "{broker} does not let this user hear {topics}: its access list is in docs/agent.md",
            "{broker} 不允许此用户接收 {topics}：访问列表见 docs/agent.md"
        ),
        Deaf::Broker(fault) => {
            let why = no_use(fault);
            both!(
                "{broker} tells nothing: {en}; is this the address of an MQTT broker?",
                "{broker} 没有提供数据：{zh}；请检查这是否是 MQTT 代理服务器的地址",
                en = why.en,
                zh = why.zh
            )
        }
        Deaf::NoAnswer => both!(
            "{broker} has not answered within {wait} s: is this the address of an MQTT broker? --wait gives it longer",
            "{broker} 在 {wait} 秒内没有应答：请检查这是否是 MQTT 代理服务器的地址；可用 --wait 延长时间"
        ),
        Deaf::NoEnd => both!(
            "{broker} has not told all within {wait} s: --wait gives it longer",
            "{broker} 在 {wait} 秒内没有发送完毕：可用 --wait 延长时间"
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_says_how_well_it_is_known() {
        let set = |since, after: Option<u64>| Set {
            serial: 0,
            firmware: String::new(),
            parameters: 0,
            schema: 2,
            since: Moment(since),
            after: after.map(Moment),
            seen: Moment(0),
            values: None,
        };
        let day = 86_400_000;
        for (set, en) in [
            (set(day, None), "1970-01-02T00:00:00Z or earlier"),
            (set(day, Some(day - 2_000)), "1970-01-02T00:00:00Z"),
            (
                set(2 * day, Some(day)),
                "between 1970-01-02T00:00:00Z and 1970-01-03T00:00:00Z",
            ),
        ] {
            assert_eq!(since(&set).en, en);
        }
        assert_eq!(time(Moment(253_402_300_799_999)), "9999-12-31T23:59:59Z");
    }
}
