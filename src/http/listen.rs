//! Opening the port.

use std::io;
use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr};

use socket2::{Domain, Protocol, Socket, Type};
use tokio::net::TcpListener;

use super::server::ServeError;
use crate::config::{ListenAddress, ListenHost};

/// Connections that the operating system keeps until they are accepted.
const BACKLOG: i32 = 1024;

/// Opens the port.
///
/// # Errors
/// [`ServeError::Resolve`] and [`ServeError::Listen`].
pub(super) async fn listen(address: &ListenAddress) -> Result<TcpListener, ServeError> {
    let port = address.port;
    let candidates: Vec<SocketAddr> = match &address.host {
        ListenHost::Ip(ip) => vec![(*ip, port).into()],
        // The first serves IPv4 too; the second is for machines without IPv6.
        ListenHost::All => vec![
            (Ipv6Addr::UNSPECIFIED, port).into(),
            (Ipv4Addr::UNSPECIFIED, port).into(),
        ],
        ListenHost::Name(name) => resolve(name, port).await?,
    };
    let mut failure = None;
    for candidate in candidates {
        match open(candidate, address.host == ListenHost::All) {
            Ok(listener) => return Ok(listener),
            Err(source) => {
                // A port that is taken, or not allowed, on one address of a host is not looked for on the next.
                let ends = matches!(
                    source.kind(),
                    io::ErrorKind::AddrInUse | io::ErrorKind::PermissionDenied
                );
                failure = Some((candidate, source));
                if ends {
                    break;
                }
            }
        }
    }
    let (candidate, source) = failure.expect("a host has an address");
    Err(ServeError::Listen {
        address: match &address.host {
            ListenHost::Name(name) => format!("{candidate} ({name})"),
            ListenHost::All | ListenHost::Ip(_) => candidate.to_string(),
        },
        source,
    })
}

/// The addresses of a name, IPv4 first; at least one.
async fn resolve(name: &str, port: u16) -> Result<Vec<SocketAddr>, ServeError> {
    let unresolved = |source| ServeError::Resolve {
        name: name.to_owned(),
        source,
    };
    let found = tokio::net::lookup_host((name, port)).await;
    let mut addresses: Vec<SocketAddr> = found.map_err(unresolved)?.collect();
    if addresses.is_empty() {
        return Err(unresolved(io::Error::other("the name has no address")));
    }
    addresses.sort_by_key(SocketAddr::is_ipv6);
    Ok(addresses)
}

fn open(address: SocketAddr, both_families: bool) -> io::Result<TcpListener> {
    let socket = Socket::new(
        Domain::for_address(address),
        Type::STREAM,
        Some(Protocol::TCP),
    )?;
    // As the standard library does: elsewhere the option has another meaning.
    #[cfg(unix)]
    socket.set_reuse_address(true)?;
    if both_families && address.is_ipv6() {
        socket.set_only_v6(false)?;
    }
    socket.set_nonblocking(true)?;
    socket.bind(&address.into())?;
    socket.listen(BACKLOG)?;
    TcpListener::from_std(socket.into())
}
