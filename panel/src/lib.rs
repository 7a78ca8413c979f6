//! The page at the machine, and the server that gives it out.
//!
//! ```text
//! browser ── http ──► server ─► guard     may this request be answered at all
//!                       │ ├──► session    who may see the machine, and who may order
//!                       │ ├──► assets     the page
//!                       │ ├──► texts ─► programs   a folder of programs; the machine: what is to be known of one
//!                       │ └──► posted     ledger, lease; the machine: the side of the bus does an order
//!                       └◄─── feed ◄───   it tells what the machine does, at the pace of both
//! ```
//!
//! This crate must not know a bus, a board or an alarm: what the machine says comes to it as JSON, and an order is a name
//! to it. Each connection has a thread, there are few of them, and each reading and writing has an end [D395].

mod assets;
mod feed;
mod guard;
mod http;
mod lease;
mod ledger;
mod machine;
mod pace;
mod posted;
mod programs;
mod refusal;
mod seats;
mod server;
mod session;
mod texts;

pub use feed::Feed;
pub use machine::{Jog, Machine, Order, Sheet, View};
pub use pace::Pace;
pub use programs::{Claim, LONGEST, Listed, Programs, Text, When};
pub use refusal::Refusal;
pub use server::{CONNECTIONS, STREAMS, Server, fresh_token};
pub use session::{Token, Tokens};
