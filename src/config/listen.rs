//! The address that the service listens on, as text.

use std::fmt;
use std::net::{IpAddr, Ipv6Addr, SocketAddr};
use std::str::FromStr;

/// What `--listen` accepts.
const ACCEPTED: &str = "accepted: HOST:PORT, where HOST is an IPv4 address, an IPv6 address in brackets, a name, or nothing for all \
                        interfaces; as in 127.0.0.1:8080, [::1]:8080, localhost:8080, :8080";

/// `HOST:PORT` to listen on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ListenAddress {
    /// Where the port is opened.
    pub host: ListenHost,
    /// TCP port; 0 for any free one.
    pub port: u16,
}

/// The interfaces to listen on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ListenHost {
    /// All interfaces, IPv6 and IPv4.
    All,
    /// The interface with this address.
    Ip(IpAddr),
    /// The interface with the address of this name, which is resolved at the start.
    Name(String),
}

impl From<SocketAddr> for ListenAddress {
    fn from(address: SocketAddr) -> Self {
        Self {
            host: ListenHost::Ip(address.ip()),
            port: address.port(),
        }
    }
}

impl FromStr for ListenAddress {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let refused = |why: &str| Err(format!("{why}; {ACCEPTED}"));
        if !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit()) {
            return refused(&format!("the host is missing (:{text} is all interfaces)"));
        }
        if text.parse::<IpAddr>().is_ok() || (text.starts_with('[') && text.ends_with(']')) {
            return refused("the port is missing");
        }
        let Some((host, port)) = text.rsplit_once(':') else {
            return refused("the port is missing");
        };
        let Some(port) = decimal(port) else {
            return refused("the port is not a number of 0 … 65535");
        };
        let bracketed = host.strip_prefix('[').and_then(|h| h.strip_suffix(']'));
        let host = if host.is_empty() {
            ListenHost::All
        } else if let Some(address) = bracketed {
            match address.parse::<Ipv6Addr>() {
                Ok(address) => ListenHost::Ip(address.into()),
                Err(_) => return refused("there is no IPv6 address in the brackets"),
            }
        } else if let Ok(address) = host.parse::<IpAddr>() {
            if address.is_ipv6() {
                return refused("an IPv6 address needs brackets");
            }
            ListenHost::Ip(address)
        } else if is_name(host) {
            ListenHost::Name(host.to_owned())
        } else {
            return refused("the host is neither an address nor a name");
        };
        Ok(Self { host, port })
    }
}

impl fmt::Display for ListenAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.host {
            ListenHost::All => write!(f, ":{}", self.port),
            ListenHost::Ip(address) => SocketAddr::new(*address, self.port).fmt(f),
            ListenHost::Name(name) => write!(f, "{name}:{}", self.port),
        }
    }
}

/// A port in decimal digits, without a sign.
fn decimal(text: &str) -> Option<u16> {
    let digits = text.bytes().all(|byte| byte.is_ascii_digit());
    text.parse().ok().filter(|_| digits)
}

/// Whether a text can be the name of a host. Names of digits and dots only are addresses with a mistake.
fn is_name(text: &str) -> bool {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'.' | b'_');
    text.bytes().all(plain)
        && text.bytes().any(|byte| byte.is_ascii_alphabetic())
        && !text.starts_with(['-', '.'])
}
