//! Who may see the machine and who may order too: the tokens of the links, and the cookies that were given for them.
//!
//! Values in, answers out; chance is an argument. This file must not know sockets, time, a page or a machine.

use std::collections::VecDeque;
use std::sync::Arc;

use crate::refusal::Refusal;

/// Cookies that count; the least recently used is forgotten. There are more than those that watch and the one
/// that operates.
const COOKIES: usize = 64;

/// A secret of 128 bits.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Token([u8; 16]);

impl Token {
    /// From chance.
    #[must_use]
    pub const fn new(chance: [u8; 16]) -> Self {
        Self(chance)
    }

    /// As text: 32 hexadecimal digits.
    #[must_use]
    pub fn text(self) -> String {
        self.0.iter().map(|byte| format!("{byte:02x}")).collect()
    }

    /// Whether the text is this token, in a time that does not tell where they differ.
    fn is(self, text: &str) -> bool {
        let own = self.text();
        let differ = own.bytes().zip(text.bytes());
        own.len() == text.len() && differ.fold(0, |differ, (a, b)| differ | (a ^ b)) == 0
    }
}

/// What a link is good for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Right {
    /// To see the machine.
    Look,
    /// To order too.
    Operate,
}

/// The tokens of the links.
#[derive(Clone, Copy)]
pub struct Tokens {
    /// For those who look.
    pub look: Token,
    /// For those who order too; `None`: nobody does.
    pub operate: Option<Token>,
}

/// What somebody holds as long as he watches.
pub type Watching = Arc<()>;

struct Cookie {
    token: Token,
    right: Right,
    watching: Watching,
}

/// All that are logged in.
pub struct Sessions {
    tokens: Tokens,
    /// The one that was used last is the last.
    cookies: VecDeque<Cookie>,
}

impl Sessions {
    /// Nobody is.
    pub const fn new(tokens: Tokens) -> Self {
        Self {
            tokens,
            cookies: VecDeque::new(),
        }
    }

    /// Makes `fresh` the cookie of who has a token. `None`: the one that he has is good for as much, and stays; a browser
    /// has one for all its pages. Neither who watches nor `operator` is forgotten for it.
    pub fn login(
        &mut self,
        token: &str,
        own: Option<&str>,
        operator: Option<&str>,
        fresh: Token,
    ) -> Result<Option<Token>, Refusal> {
        let operates = self.tokens.operate.is_some_and(|own| own.is(token));
        let right = match (operates, self.tokens.look.is(token)) {
            (true, _) => Right::Operate,
            (false, true) => Right::Look,
            (false, false) => return Err(Refusal::Token),
        };
        if self.admit(own).is_ok_and(|has| has >= right) {
            return Ok(None);
        }
        if self.cookies.len() >= COOKIES {
            let idle = |cookie: &Cookie| {
                Arc::strong_count(&cookie.watching) == 1
                    && operator.is_none_or(|text| !cookie.token.is(text))
            };
            let oldest = self.cookies.iter().position(idle);
            oldest.and_then(|at| self.cookies.remove(at));
        }
        self.cookies.push_back(Cookie {
            token: fresh,
            right,
            watching: Watching::default(),
        });
        Ok(Some(fresh))
    }

    /// Lets the owner of a cookie in, and says what he may do.
    pub fn admit(&mut self, cookie: Option<&str>) -> Result<Right, Refusal> {
        self.used(cookie).map(|cookie| cookie.right)
    }

    /// Lets the owner of a cookie watch.
    pub fn watch(&mut self, cookie: Option<&str>) -> Result<Watching, Refusal> {
        let cookie = self.used(cookie)?;
        Ok(Arc::clone(&cookie.watching))
    }

    fn used(&mut self, text: Option<&str>) -> Result<&Cookie, Refusal> {
        let is = |cookie: &Cookie| text.is_some_and(|text| cookie.token.is(text));
        let found = self.cookies.iter().position(is);
        let cookie = found.and_then(|at| self.cookies.remove(at));
        self.cookies.extend(cookie);
        let used = found.and(self.cookies.back());
        used.ok_or(Refusal::Login)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OPERATE: Token = Token::new([7; 16]);
    const LOOK: Token = Token::new([9; 16]);

    fn sessions(operate: Option<Token>) -> Sessions {
        Sessions::new(Tokens {
            look: LOOK,
            operate,
        })
    }

    /// Of a browser that is not logged in yet.
    fn login(sessions: &mut Sessions, token: &str, fresh: u8) -> Result<Option<Token>, Refusal> {
        sessions.login(token, None, None, Token::new([fresh; 16]))
    }

    fn text(number: u8) -> String {
        Token::new([number; 16]).text()
    }

    #[test]
    fn a_token_gives_a_cookie_and_nothing_else_does() {
        let mut sessions = sessions(Some(OPERATE));
        let good = OPERATE.text();
        assert_eq!(good, "07".repeat(16));
        assert_eq!(sessions.admit(Some(&good)), Err(Refusal::Login));
        for wrong in ["", "07", &good[1..], &format!("{good}0"), &"08".repeat(16)] {
            let answer = login(&mut sessions, wrong, 1);
            assert_eq!(answer.err(), Some(Refusal::Token), "{wrong}");
        }
        assert_eq!(sessions.admit(Some(&text(1))), Err(Refusal::Login));
        assert!(login(&mut sessions, &good, 1).is_ok());
        assert!(login(&mut sessions, &LOOK.text(), 2).is_ok());
        assert_eq!(sessions.admit(Some(&text(1))), Ok(Right::Operate));
        assert_eq!(sessions.admit(Some(&text(2))), Ok(Right::Look));
        assert_eq!(sessions.admit(None), Err(Refusal::Login));
        assert_eq!(sessions.admit(Some("")), Err(Refusal::Login));
    }

    #[test]
    fn where_nobody_operates_no_token_is_good_for_it() {
        let mut sessions = sessions(None);
        let answer = login(&mut sessions, &OPERATE.text(), 1);
        assert_eq!(answer.err(), Some(Refusal::Token));
        assert!(login(&mut sessions, &LOOK.text(), 1).is_ok());
        assert_eq!(sessions.admit(Some(&text(1))), Ok(Right::Look));
    }

    #[test]
    fn a_link_takes_no_right_from_a_browser_that_has_it() {
        let mut sessions = sessions(Some(OPERATE));
        let (operate, look) = (OPERATE.text(), LOOK.text());
        let mut login = |token: &str, own, fresh| {
            let fresh = Token::new([fresh; 16]);
            let given = sessions.login(token, Some(&text(own)), None, fresh);
            given.map(|cookie| cookie.is_some())
        };
        assert_eq!(login(&look, 9, 1), Ok(true));
        assert_eq!(login(&look, 1, 2), Ok(false));
        assert_eq!(login(&operate, 1, 3), Ok(true));
        for token in [&operate, &look] {
            assert_eq!(login(token, 3, 4), Ok(false));
        }
        assert_eq!(login(&text(3), 3, 4), Err(Refusal::Token));
        assert_eq!(sessions.admit(Some(&text(3))), Ok(Right::Operate));
        assert_eq!(sessions.admit(Some(&text(1))), Ok(Right::Look));
    }

    #[test]
    fn the_cookie_goes_that_was_used_least_lately_and_none_that_watches_or_operates() {
        let mut sessions = sessions(Some(OPERATE));
        let good = OPERATE.text();
        for number in 0..4 {
            assert!(login(&mut sessions, &good, number).is_ok());
        }
        let watching = sessions.watch(Some(&text(1))).unwrap();
        for number in 4..=200 {
            // It is used now and then.
            assert_eq!(sessions.admit(Some(&text(2))), Ok(Right::Operate));
            let fresh = Token::new([number; 16]);
            assert!(sessions.login(&good, None, Some(&text(3)), fresh).is_ok());
        }
        assert_eq!(sessions.cookies.len(), COOKIES);
        for gone in [0, 4, 200 - (COOKIES as u8 - 3)] {
            assert_eq!(sessions.admit(Some(&text(gone))), Err(Refusal::Login));
        }
        for kept in [1, 2, 3, 200 - (COOKIES as u8 - 4), 200] {
            assert_eq!(
                sessions.admit(Some(&text(kept))),
                Ok(Right::Operate),
                "{kept}"
            );
        }
        // Who watches no more is forgotten as others are.
        drop(watching);
        for number in 0..COOKIES as u8 {
            assert!(login(&mut sessions, &good, number + 100).is_ok());
        }
        assert_eq!(sessions.admit(Some(&text(1))), Err(Refusal::Login));
    }
}
