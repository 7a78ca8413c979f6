//! The primary host of Sparkplug: a program of the shop that has to hear all, and says by itself whether it is there.
//!
//! It says so in a message that the broker retains, and its will says the opposite. This must not know what is sent, nor
//! when.

use serde::Deserialize;

/// What a host says of itself.
#[derive(Deserialize)]
struct State {
    online: bool,
    timestamp: u64,
}

/// A primary host, as far as it has been heard.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Host {
    topic: String,
    online: bool,
    since: u64,
}

impl Host {
    /// The host of this name, of which nothing has been heard.
    #[must_use]
    pub fn new(name: &str) -> Self {
        Self {
            topic: format!("spBv1.0/STATE/{name}"),
            online: false,
            since: 0,
        }
    }

    /// Where it says whether it is there.
    #[must_use]
    pub fn topic(&self) -> &str {
        &self.topic
    }

    /// It is there.
    #[must_use]
    pub const fn is_online(&self) -> bool {
        self.online
    }

    /// Takes a message. What is older than what was heard counts no more: it is the will of a connection that another has
    /// followed. What is no state is left.
    pub fn take(&mut self, topic: &str, payload: &[u8]) {
        if topic != self.topic {
            return;
        }
        let Ok(state) = serde_json::from_slice::<State>(payload) else {
            return;
        };
        if state.timestamp >= self.since {
            (self.online, self.since) = (state.online, state.timestamp);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_word_of_the_host_counts() {
        let mut host = Host::new("scada");
        assert!(!host.is_online());
        for (topic, payload, online) in [
            (
                "spBv1.0/STATE/scada",
                r#"{"online":true,"timestamp":5}"#,
                true,
            ),
            (
                "spBv1.0/STATE/other",
                r#"{"online":false,"timestamp":6}"#,
                true,
            ),
            (
                "spBv1.0/STATE/scada",
                r#"{"online":false,"timestamp":4}"#,
                true,
            ),
            ("spBv1.0/STATE/scada", "OFFLINE", true),
            ("spBv1.0/STATE/scada", r#"{"online":false}"#, true),
            (
                "spBv1.0/STATE/scada",
                r#"{"online":false,"timestamp":5}"#,
                false,
            ),
            (
                "spBv1.0/STATE/scada",
                r#"{"online":true,"timestamp":7}"#,
                true,
            ),
        ] {
            host.take(topic, payload.as_bytes());
            assert_eq!(host.is_online(), online, "{topic} {payload}");
        }
    }
}
