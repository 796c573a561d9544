//! What the tests share: a scripted backend (`fake`), a service around it (`service`), requests and answers (`client`), and
//! inputs (`scenes`).

pub(crate) mod client;
pub(crate) mod fake;
pub(crate) mod scenes;
pub(crate) mod service;

pub(crate) use client::Reply;
pub(crate) use fake::{Behaviour, Control};
pub(crate) use service::Service;
