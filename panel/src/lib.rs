//! The page at the machine, and the server that gives it out.
//!
//! ```text
//! browser ── http ──► server ─► guard     may this request be answered at all
//!                       │ ├──► session    who may see the machine
//!                       │ └──► assets     the page
//!                       └◄─── feed ◄───   the side of the bus tells what the machine does
//! ```
//!
//! This crate must not know a bus, a board or an alarm: what the machine says comes to it as JSON. Nothing here orders.
//! Each connection has a thread, there are few of them, and each reading and writing has an end [D395].

mod assets;
mod feed;
mod guard;
mod http;
mod refusal;
mod server;
mod session;

pub use feed::Feed;
pub use refusal::Refusal;
pub use server::{CONNECTIONS, STREAMS, Server, fresh_token};
pub use session::Token;
