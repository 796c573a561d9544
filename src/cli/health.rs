//! `caustica health`: asks whether the service accepts work. For containers without curl.

use std::io;
use std::time::Duration;

use clap::Args;
use tokio::net::TcpStream;

use super::error::CliError;

/// Most bytes of an answer that are read.
const MAX_ANSWER_BYTES: usize = 64 << 10;

/// Which service to ask.
#[derive(Clone, Debug, Args)]
pub struct HealthArgs {
    /// Address of the service.
    #[arg(long, env = "CAUSTICA_URL", default_value = "http://127.0.0.1:8080")]
    pub url: ServiceUrl,
    /// Seconds to wait for the whole answer.
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u64).range(1..=3600))]
    pub timeout_s: u64,
}

/// `http://host[:port][/prefix]`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ServiceUrl {
    /// `host:port`; port 80 if none is given.
    pub authority: String,
    /// The path before `/readyz`, without a trailing slash.
    pub prefix: String,
}

impl std::str::FromStr for ServiceUrl {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let refused = || "accepted: http://host[:port][/prefix]".to_owned();
        let rest = text.strip_prefix("http://").ok_or_else(refused)?;
        let (authority, prefix) = match rest.split_once('/') {
            Some((authority, prefix)) => (authority, format!("/{prefix}")),
            None => (rest, String::new()),
        };
        let is_plain = |c: char| c.is_ascii_graphic() && !matches!(c, '@' | '?' | '#' | '\\');
        if !text.chars().all(is_plain) {
            return Err(refused());
        }
        // Skip the colons inside the brackets of an IPv6 address.
        let after_host = authority
            .rsplit_once(']')
            .map_or(authority, |(_, rest)| rest);
        let (host, port) = match after_host.rsplit_once(':') {
            Some((_, port)) => (&authority[..authority.len() - port.len() - 1], port),
            None => (authority, "80"),
        };
        if host.is_empty() || port.parse::<u16>().is_err() {
            return Err(refused());
        }
        Ok(Self {
            authority: format!("{host}:{port}"),
            prefix: prefix.trim_end_matches('/').to_owned(),
        })
    }
}

impl std::fmt::Display for ServiceUrl {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "http://{}{}", self.authority, self.prefix)
    }
}

/// Asks `GET /readyz`.
///
/// # Errors
///
/// [`CliError::NotReady`] unless the answer is 200 in time.
pub fn run(args: &HealthArgs) -> Result<(), CliError> {
    let not_ready = |reason: String| CliError::NotReady {
        url: args.url.to_string(),
        reason,
    };
    let limit = Duration::from_secs(args.timeout_s);
    let answer = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .and_then(|runtime| {
            runtime.block_on(async {
                tokio::time::timeout(limit, ask(&args.url))
                    .await
                    .unwrap_or_else(|_| {
                        Err(io::Error::other(format!("no answer within {limit:?}")))
                    })
            })
        })
        .map_err(|error| not_ready(error.to_string()))?;
    match status_of(&answer) {
        Some(200) => Ok(()),
        Some(status) => Err(not_ready(format!("HTTP {status} {}", body_of(&answer)))),
        None => Err(not_ready("the answer is not HTTP".to_owned())),
    }
}

/// Sends the request and reads until the service closes the connection.
async fn ask(url: &ServiceUrl) -> io::Result<Vec<u8>> {
    let stream = TcpStream::connect(&url.authority).await?;
    let request = format!(
        "GET {}/readyz HTTP/1.1\r\nHost: {}\r\nAccept: */*\r\nConnection: close\r\n\r\n",
        url.prefix, url.authority
    );
    let mut unsent = request.as_bytes();
    while !unsent.is_empty() {
        stream.writable().await?;
        match stream.try_write(unsent) {
            Ok(count) => unsent = &unsent[count..],
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
            Err(error) => return Err(error),
        }
    }
    let mut answer = Vec::new();
    let mut chunk = [0; 4096];
    while answer.len() < MAX_ANSWER_BYTES {
        stream.readable().await?;
        match stream.try_read(&mut chunk) {
            Ok(0) => break,
            Ok(count) => answer.extend_from_slice(&chunk[..count]),
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
            Err(error) => return Err(error),
        }
    }
    Ok(answer)
}

/// The number of the status line.
fn status_of(answer: &[u8]) -> Option<u16> {
    let line = answer.split(|byte| *byte == b'\r').next()?;
    let line = std::str::from_utf8(line).ok()?;
    let (version, rest) = line.split_once(' ')?;
    if !version.starts_with("HTTP/1.") {
        return None;
    }
    rest.split(' ').next()?.parse().ok()
}

/// The body, which has the reason, as one line.
fn body_of(answer: &[u8]) -> String {
    let text = String::from_utf8_lossy(answer);
    let body = text.split_once("\r\n\r\n").map_or("", |(_, body)| body);
    body.split_whitespace().collect::<Vec<_>>().join(" ")
}
