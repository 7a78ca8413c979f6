//! What a broker retains of a group, as machines with their sets. Anybody may have put anything there: what is no set is
//! named and counted, and nothing else.

use std::time::{Duration, SystemTime, UNIX_EPOCH};

use leadscrew_agent::mqtt::retained::{self, hear};
use leadscrew_agent::set::{self, Set, Whose};
use leadscrew_agent::sparkplug::Names;

use super::words;
use crate::cli::{Asked, Global};
use crate::commands::broker;
use crate::diagnostics::say;
use crate::failure::Outcome;
use crate::in_force::shown;
use crate::json::Json;
use crate::words::{Both, both};

/// Messages that are no sets, which are named.
const NAMED: usize = 10;

/// A machine that an agent has told of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Machine {
    /// Whose it is.
    pub whose: Whose,
    /// Its set.
    pub set: Set,
}

/// All that was heard.
#[derive(Debug, Default)]
pub struct Fleet {
    /// In the order of their names.
    pub machines: Vec<Machine>,
    /// Topics of messages that are no sets, and why not.
    ignored: Vec<(String, Both)>,
    /// How many more there are.
    more: u64,
}

/// Asks the broker.
pub fn ask(global: &Global, asked: &Asked) -> Outcome<Fleet> {
    let group = &asked.access.group;
    Names::new(group, "node", []).map_err(|error| broker::wrong_name(&error))?;
    let login = broker::login(&asked.access)?;
    let tls = broker::tls(&asked.broker, &asked.access)?;
    if login.is_some()
        && let Some(warning) = broker::in_the_clear(&asked.broker)
    {
        say(&format!("{}\n", warning.get(global.lang())));
    }
    let topics = set::topics(group);
    let heard = hear(
        &asked.broker,
        login.as_ref(),
        tls.as_ref(),
        &client(),
        &topics,
        Duration::from_secs(asked.wait),
    );
    let heard = heard.map_err(|deaf| words::deaf(&deaf, asked, &topics))?;
    Ok(Fleet::of(heard))
}

/// What this process is called at the broker, which ends an older client of the same name.
fn client() -> String {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    let ns = since.map_or(0, |since| since.subsec_nanos());
    format!("leadscrew-fleet-{}-{ns}", std::process::id())
}

impl Fleet {
    fn of(heard: retained::Heard) -> Self {
        let mut fleet = Self {
            more: heard.left_out,
            ..Self::default()
        };
        for (topic, message) in heard.messages {
            match (Whose::of(&topic), Set::read(&message)) {
                (Some(whose), Ok(set)) => fleet.machines.push(Machine { whose, set }),
                (None, _) => fleet.ignore(
                    topic,
                    both!("no agent has such a topic", "代理程序不使用这样的主题"),
                ),
                (_, Err(why)) => fleet.ignore(topic, words::no_set(&why)),
            }
        }
        for topic in heard.huge {
            fleet.ignore(topic, both!("too large for a set", "对参数集而言过大"));
        }
        fleet.machines.sort_by(|a, b| a.whose.cmp(&b.whose));
        fleet
    }

    fn ignore(&mut self, topic: String, why: Both) {
        if self.ignored.len() < NAMED {
            self.ignored.push((shown(&topic), why));
        } else {
            self.more += 1;
        }
    }

    /// Says what is no set.
    ///
    /// # Errors
    /// Nobody was heard: a group without agents looks as one whose sets this user may not read [D459].
    pub fn tell(&self, global: &Global, asked: &Asked) -> Outcome {
        let lang = global.lang();
        let tell = |words: &Both| say(&format!("{}\n", words.get(lang)));
        for (topic, why) in &self.ignored {
            tell(&both!(
                "left out: {topic}: {en}",
                "已忽略：{topic}：{zh}",
                en = why.en,
                zh = why.zh
            ));
        }
        if self.more > 0 {
            let more = self.more;
            tell(&both!(
                "left out: {more} more messages",
                "另有 {more} 条消息已忽略"
            ));
        }
        if self.machines.is_empty() {
            return Err(words::nobody(asked));
        }
        Ok(())
    }

    /// `"ignored"` and `"ignored_more"` in the machine format.
    pub fn fields(&self, global: &Global, json: &mut Json) {
        json.array_at("ignored", |list| {
            for (topic, why) in &self.ignored {
                list.object(|o| {
                    o.text("topic", topic);
                    o.text("why", why.get(global.lang()));
                });
            }
        });
        json.number("ignored_more", self.more);
    }
}

impl Machine {
    /// What it is and since when, in the machine format.
    pub fn fields(&self, json: &mut Json) {
        let set = &self.set;
        json.text("machine", &self.whose.machine);
        json.text("node", &self.whose.node);
        json.text("serial", &format!("{:08x}", set.serial));
        json.text("firmware", &set.firmware);
        json.text("parameters", &format!("{:08x}", set.parameters));
        json.text("since", &words::time(set.since));
        match set.after {
            Some(after) => json.text("after", &words::time(after)),
            None => json.null("after"),
        }
        json.text("seen", &words::time(set.seen));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::{BTreeMap, BTreeSet};

    const GOOD: &[u8] = br#"{"serial":"00000001","firmware":"1","parameters":"00000002","schema":2,"since":3,"after":null,"seen":4,"values":null}"#;

    #[test]
    fn what_is_no_set_is_named_and_counted() {
        let mut messages = BTreeMap::new();
        for (node, machine) in [("b", "lathe"), ("a", "lathe"), ("a", "mill")] {
            messages.insert(set::topic("g", node, machine), GOOD.to_vec());
        }
        messages.insert(set::topic("g", "a", "\u{1b}[2J"), GOOD.to_vec());
        for number in 0..100 {
            let topic = set::topic("g", "x", &format!("m{number}"));
            messages.insert(topic, vec![0xFF; number + 1]);
        }
        let fleet = Fleet::of(retained::Heard {
            messages,
            huge: BTreeSet::from(["a\u{9b}".repeat(100)]),
            left_out: 5,
        });
        let whose: Vec<(&str, &str)> = fleet
            .machines
            .iter()
            .map(|of| (&*of.whose.machine, &*of.whose.node))
            .collect();
        assert_eq!(whose, [("lathe", "a"), ("lathe", "b"), ("mill", "a")]);
        assert_eq!(fleet.ignored.len(), NAMED);
        assert_eq!(fleet.more, 5 + 102 - NAMED as u64);
        for (topic, _) in &fleet.ignored {
            assert!(!topic.contains(char::is_control), "{topic:?}");
        }
    }
}
