//! Who may see the machine: the token of the link, and the cookies that were given for it.
//!
//! Values in, answers out; chance is an argument. This file must not know sockets, time, a page or a machine.

use std::collections::VecDeque;

use crate::refusal::Refusal;

/// Cookies that count; the oldest is forgotten.
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

/// All that are logged in.
pub struct Sessions {
    token: Token,
    cookies: VecDeque<Token>,
}

impl Sessions {
    /// Nobody is.
    pub const fn new(token: Token) -> Self {
        Self {
            token,
            cookies: VecDeque::new(),
        }
    }

    /// Makes `fresh` the cookie of who has the token.
    pub fn login(&mut self, token: &str, fresh: Token) -> Result<Token, Refusal> {
        if !self.token.is(token) {
            return Err(Refusal::Token);
        }
        if self.cookies.len() == COOKIES {
            self.cookies.pop_front();
        }
        self.cookies.push_back(fresh);
        Ok(fresh)
    }

    /// Lets the owner of a cookie in.
    pub fn admit(&self, cookie: Option<&str>) -> Result<(), Refusal> {
        let known = cookie.is_some_and(|text| self.cookies.iter().any(|own| own.is(text)));
        known.then_some(()).ok_or(Refusal::Login)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_token_gives_a_cookie_and_nothing_else_does() {
        let mut sessions = Sessions::new(Token::new([7; 16]));
        let good = Token::new([7; 16]).text();
        assert_eq!(good, "07".repeat(16));
        assert_eq!(sessions.admit(Some(&good)), Err(Refusal::Login));
        for wrong in ["", "07", &good[1..], &format!("{good}0"), &"08".repeat(16)] {
            let answer = sessions.login(wrong, Token::new([1; 16]));
            assert_eq!(answer.err(), Some(Refusal::Token), "{wrong}");
        }
        assert_eq!(sessions.admit(Some(&"01".repeat(16))), Err(Refusal::Login));
        assert!(sessions.login(&good, Token::new([1; 16])).is_ok());
        assert_eq!(sessions.admit(Some(&"01".repeat(16))), Ok(()));
        assert_eq!(sessions.admit(None), Err(Refusal::Login));
        assert_eq!(sessions.admit(Some("")), Err(Refusal::Login));
    }

    #[test]
    fn the_oldest_cookie_goes() {
        let mut sessions = Sessions::new(Token::new([7; 16]));
        let good = Token::new([7; 16]).text();
        for number in 0..=COOKIES as u8 {
            assert!(sessions.login(&good, Token::new([number; 16])).is_ok());
        }
        let text = |number| Token::new([number; 16]).text();
        assert_eq!(sessions.admit(Some(&text(0))), Err(Refusal::Login));
        assert_eq!(sessions.admit(Some(&text(1))), Ok(()));
        assert_eq!(sessions.admit(Some(&text(COOKIES as u8))), Ok(()));
    }
}
