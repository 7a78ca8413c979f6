//! Who may see the machine and who may order too: the tokens of the links, and the cookies that were given for them.
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

/// What a link is good for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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

/// All that are logged in.
pub struct Sessions {
    tokens: Tokens,
    cookies: VecDeque<(Token, Right)>,
}

impl Sessions {
    /// Nobody is.
    pub const fn new(tokens: Tokens) -> Self {
        Self {
            tokens,
            cookies: VecDeque::new(),
        }
    }

    /// Makes `fresh` the cookie of who has a token.
    pub fn login(&mut self, token: &str, fresh: Token) -> Result<Token, Refusal> {
        let operates = self.tokens.operate.is_some_and(|own| own.is(token));
        let right = match (operates, self.tokens.look.is(token)) {
            (true, _) => Right::Operate,
            (false, true) => Right::Look,
            (false, false) => return Err(Refusal::Token),
        };
        if self.cookies.len() == COOKIES {
            self.cookies.pop_front();
        }
        self.cookies.push_back((fresh, right));
        Ok(fresh)
    }

    /// Lets the owner of a cookie in, and says what he may do.
    pub fn admit(&self, cookie: Option<&str>) -> Result<Right, Refusal> {
        let known = |text| self.cookies.iter().find(|(own, _)| own.is(text));
        let found = cookie.and_then(known);
        found.map(|(_, right)| *right).ok_or(Refusal::Login)
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

    #[test]
    fn a_token_gives_a_cookie_and_nothing_else_does() {
        let mut sessions = sessions(Some(OPERATE));
        let good = OPERATE.text();
        assert_eq!(good, "07".repeat(16));
        assert_eq!(sessions.admit(Some(&good)), Err(Refusal::Login));
        for wrong in ["", "07", &good[1..], &format!("{good}0"), &"08".repeat(16)] {
            let answer = sessions.login(wrong, Token::new([1; 16]));
            assert_eq!(answer.err(), Some(Refusal::Token), "{wrong}");
        }
        let cookie = |byte| Token::new([byte; 16]).text();
        assert_eq!(sessions.admit(Some(&cookie(1))), Err(Refusal::Login));
        assert!(sessions.login(&good, Token::new([1; 16])).is_ok());
        assert!(sessions.login(&LOOK.text(), Token::new([2; 16])).is_ok());
        assert_eq!(sessions.admit(Some(&cookie(1))), Ok(Right::Operate));
        assert_eq!(sessions.admit(Some(&cookie(2))), Ok(Right::Look));
        assert_eq!(sessions.admit(None), Err(Refusal::Login));
        assert_eq!(sessions.admit(Some("")), Err(Refusal::Login));
    }

    #[test]
    fn where_nobody_operates_no_token_is_good_for_it() {
        let mut sessions = sessions(None);
        let answer = sessions.login(&OPERATE.text(), Token::new([1; 16]));
        assert_eq!(answer.err(), Some(Refusal::Token));
        assert!(sessions.login(&LOOK.text(), Token::new([1; 16])).is_ok());
        let cookie = Token::new([1; 16]).text();
        assert_eq!(sessions.admit(Some(&cookie)), Ok(Right::Look));
    }

    #[test]
    fn the_oldest_cookie_goes() {
        let mut sessions = sessions(Some(OPERATE));
        let good = OPERATE.text();
        for number in 0..=COOKIES as u8 {
            assert!(sessions.login(&good, Token::new([number; 16])).is_ok());
        }
        let text = |number| Token::new([number; 16]).text();
        assert_eq!(sessions.admit(Some(&text(0))), Err(Refusal::Login));
        for kept in [1, COOKIES as u8] {
            assert_eq!(sessions.admit(Some(&text(kept))), Ok(Right::Operate));
        }
    }
}
