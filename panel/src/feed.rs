//! What the machine says, for all who watch: each kind of message has its newest text, and a slow reader gets that one.
//!
//! Nobody who reads keeps the writer waiting. This file must not know what the texts mean.

use std::collections::BTreeMap;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

#[derive(Default)]
struct Told {
    /// Rises with each message.
    number: u64,
    newest: BTreeMap<&'static str, (u64, String)>,
    over: bool,
}

/// The newest of each kind.
#[derive(Default)]
pub struct Feed {
    told: Mutex<Told>,
    news: Condvar,
}

impl Feed {
    /// Tells a message, in place of the last one of its kind. It is one line of JSON.
    pub fn tell(&self, kind: &'static str, json: String) {
        let mut told = self.told();
        told.number += 1;
        let number = told.number;
        told.newest.insert(kind, (number, json));
        drop(told);
        self.news.notify_all();
    }

    /// Who comes from now on is not told the newest message of this kind: it holds no more.
    pub fn forget(&self, kind: &'static str) {
        self.told().newest.remove(kind);
    }

    /// Nothing will be told any more.
    pub fn end(&self) {
        self.told().over = true;
        self.news.notify_all();
    }

    /// What has been told behind message `last`, the oldest first; empty where that takes longer than `patience`. `None`
    /// at the end.
    pub(crate) fn behind(
        &self,
        last: u64,
        patience: Duration,
    ) -> Option<Vec<(u64, &'static str, String)>> {
        let told = self.told();
        let waits = |told: &mut Told| !told.over && told.number == last;
        let (told, _) = self
            .news
            .wait_timeout_while(told, patience, waits)
            .unwrap_or_else(PoisonError::into_inner);
        if told.over {
            return None;
        }
        let newer = told.newest.iter().filter(|(_, (number, _))| *number > last);
        let mut list: Vec<_> = newer
            .map(|(kind, (number, json))| (*number, *kind, json.clone()))
            .collect();
        list.sort();
        Some(list)
    }

    fn told(&self) -> MutexGuard<'_, Told> {
        // A text is whole or not there.
        self.told.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_is_slow_gets_the_newest_of_each_kind() {
        let feed = Feed::default();
        assert_eq!(feed.behind(0, Duration::ZERO), Some(Vec::new()));
        feed.tell("hello", "a".into());
        feed.tell("s", "1".into());
        feed.tell("log", "x".into());
        feed.tell("s", "2".into());
        let all = vec![
            (1, "hello", "a".to_owned()),
            (3, "log", "x".to_owned()),
            (4, "s", "2".to_owned()),
        ];
        assert_eq!(feed.behind(0, Duration::ZERO), Some(all.clone()));
        assert_eq!(feed.behind(3, Duration::ZERO), Some(all[2..].to_vec()));
        assert_eq!(feed.behind(4, Duration::ZERO), Some(Vec::new()));
        feed.forget("s");
        assert_eq!(
            feed.behind(0, Duration::ZERO),
            Some(vec![all[0].clone(), all[1].clone()])
        );
        assert_eq!(feed.behind(4, Duration::ZERO), Some(Vec::new()));
        feed.end();
        assert_eq!(feed.behind(0, Duration::ZERO), None);
    }
}
