//! Origins whose web pages may use the service, as text.

use std::fmt;
use std::str::FromStr;

/// What `--cors-origin` accepts.
const ACCEPTED: &str = "accepted: `*` for every origin, or SCHEME://HOST[:PORT] without a path, as in http://localhost:3000";

/// An origin that browsers may send requests from (CORS).
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CorsOrigin {
    /// Every origin.
    Any,
    /// `scheme://host[:port]` in the form that browsers send: lower case, without the scheme's usual port.
    One(String),
}

impl FromStr for CorsOrigin {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim();
        if text == "*" {
            return Ok(Self::Any);
        }
        let refused = |why: &str| Err(format!("{why}; {ACCEPTED}"));
        let Some((scheme, authority)) = text.split_once("://") else {
            return refused("the scheme is missing");
        };
        let of_scheme = |c: char| c.is_ascii_alphanumeric() || matches!(c, '+' | '-' | '.');
        if !scheme.starts_with(|c: char| c.is_ascii_alphabetic()) || !scheme.chars().all(of_scheme)
        {
            return refused("the scheme is not valid");
        }
        if authority.contains(['/', '?', '#']) {
            return refused("an origin has no path and does not end in `/`");
        }
        // Skip the colons inside the brackets of an IPv6 address.
        let after_host = authority
            .rsplit_once(']')
            .map_or(authority, |(_, rest)| rest);
        let (host, port) = match after_host.rsplit_once(':') {
            Some((_, port)) => (
                &authority[..authority.len() - port.len() - 1],
                Some(port.parse::<u16>()),
            ),
            None => (authority, None),
        };
        let of_host = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '.' | '_');
        let address = host.strip_prefix('[').and_then(|h| h.strip_suffix(']'));
        let is_host = match address {
            Some(address) => address.parse::<std::net::Ipv6Addr>().is_ok(),
            None => !host.is_empty() && host.chars().all(of_host),
        };
        if !is_host {
            return refused("the host is not valid");
        }
        let (scheme, host) = (scheme.to_ascii_lowercase(), host.to_ascii_lowercase());
        Ok(Self::One(match (scheme.as_str(), port) {
            (_, Some(Err(_))) => return refused("the port is not a number of 0 … 65535"),
            ("http", Some(Ok(80))) | ("https", Some(Ok(443))) | (_, None) => {
                format!("{scheme}://{host}")
            }
            (_, Some(Ok(port))) => format!("{scheme}://{host}:{port}"),
        }))
    }
}

impl fmt::Display for CorsOrigin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Any => f.write_str("*"),
            Self::One(origin) => f.write_str(origin),
        }
    }
}
