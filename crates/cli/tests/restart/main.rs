//! `jstsph run` when it is killed, or the files around it are not as it left them.

#[path = "../common/mod.rs"]
mod common;
mod disturbed;
#[cfg(unix)]
mod killed;
