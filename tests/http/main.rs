//! The service without a GPU: a scripted backend replaces the renderer.
//!
//! | module | question |
//! |---|---|
//! | `assets` | are files of numbers stored, listed, found, used and forgotten? |
//! | `connections` | real sockets: silence, half headers, eviction, clients that do not read |
//! | `contract` | do `openapi.yaml`, routes, schemas and examples agree? |
//! | `cors` | what pages of other origins may do |
//! | `encodings` | bodies with a `Content-Encoding` |
//! | `errors` | does each bad request get its status and problem, and is the service whole afterwards? |
//! | `log` | a log that fails or stalls costs only its lines |
//! | `meshes` | are meshes stored, listed, found and forgotten? |
//! | `overload` | queue full, deadline, clients that leave |
//! | `recovery` | device loss, panics, failed self-checks, no device |
//! | `render` | images, JSON, entity tags, timings |
//! | `server` | a real socket: start, drain, shutdown |
//! | `service` | health, info, metrics, pages |
//! | `warm` | are level maps built on upload, and does a warm-up that fails take no mesh along? |
//!
//! `BLESS=1 cargo test --test http contract` rewrites `openapi.yaml`.

#![allow(
    clippy::unwrap_used,
    reason = "in a test a panic is the report of a failure"
)]

mod assets;
mod connections;
mod contract;
mod cors;
mod encodings;
mod errors;
#[allow(dead_code, reason = "the tests of files use what is not used here")]
#[path = "../support/field_files.rs"]
mod field_support;
mod log;
mod meshes;
mod overload;
mod recovery;
mod render;
mod server;
mod service;
mod support;
mod warm;
