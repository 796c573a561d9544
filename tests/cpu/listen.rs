//! Where the service listens: what is accepted, and exit codes of what is not.

use std::net::TcpListener;
use std::process::{Command, Output};

use caustica::config::{ListenAddress, ListenHost};

fn serve(listen: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_caustica"))
        .args(["serve", "--listen", listen])
        .output()
        .unwrap()
}

#[test]
fn hosts_are_addresses_names_or_nothing() {
    let read = |text: &str| text.parse::<ListenAddress>().unwrap();
    let ip = |text: &str| ListenHost::Ip(text.parse().unwrap());
    for (text, host, port) in [
        ("127.0.0.1:8080", ip("127.0.0.1"), 8080),
        ("0.0.0.0:0", ip("0.0.0.0"), 0),
        ("[::1]:8080", ip("::1"), 8080),
        ("[::]:65535", ip("::"), 65535),
        ("localhost:80", ListenHost::Name("localhost".to_owned()), 80),
        (
            "render-1.example.org:1",
            ListenHost::Name("render-1.example.org".to_owned()),
            1,
        ),
        (":8080", ListenHost::All, 8080),
    ] {
        let address = read(text);
        assert_eq!((&address.host, address.port), (&host, port), "{text}");
        assert_eq!(address.to_string(), text);
    }
}

#[test]
fn what_is_refused_says_what_is_accepted() {
    for (text, why) in [
        ("8080", "the host is missing (:8080 is all interfaces)"),
        ("0.0.0.0", "the port is missing"),
        ("::1", "the port is missing"),
        ("[::1]", "the port is missing"),
        ("localhost", "the port is missing"),
        ("", "the port is missing"),
        ("localhost:", "the port is not a number"),
        ("localhost:http", "the port is not a number"),
        ("localhost:65536", "the port is not a number"),
        ("localhost:+80", "the port is not a number"),
        ("fe80::1:99999", "the port is not a number"),
        (
            "2001:db8:0:0:0:0:0:0:8080",
            "an IPv6 address needs brackets",
        ),
        ("[localhost]:80", "no IPv6 address in the brackets"),
        ("1.2.3:80", "neither an address nor a name"),
        ("1.2.3.999:80", "neither an address nor a name"),
        ("http://localhost:80", "neither an address nor a name"),
        ("a b:80", "neither an address nor a name"),
    ] {
        let said = text.parse::<ListenAddress>().unwrap_err();
        assert!(said.contains(why), "{text}: {said}");
        for form in ["127.0.0.1:8080", "[::1]:8080", "localhost:8080", " :8080"] {
            assert!(said.contains(form), "{said}");
        }
    }
}

#[test]
fn exit_codes_say_whether_a_retry_is_worth_it() {
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port();
    for (listen, code, place) in [
        ("8080".to_owned(), 2, "the host is missing"),
        // TEST-NET-1 (RFC 5737) belongs to no machine.
        ("192.0.2.1:0".to_owned(), 2, "cannot listen on 192.0.2.1:0"),
        (
            format!("127.0.0.1:{port}"),
            1,
            "cannot listen on 127.0.0.1:",
        ),
        ("no-such-host.invalid:80".to_owned(), 1, "does not resolve"),
    ] {
        let out = serve(&listen);
        let said = String::from_utf8(out.stderr).unwrap();
        assert_eq!(out.status.code(), Some(code), "{listen}: {said}");
        assert!(said.contains(place), "{listen}: {said}");
    }
}

#[test]
fn origins_that_are_none_are_refused() {
    let out = Command::new(env!("CARGO_BIN_EXE_caustica"))
        .args(["serve", "--cors-origin", "http://a.example,localhost:3000"])
        .output()
        .unwrap();
    let said = String::from_utf8(out.stderr).unwrap();
    assert_eq!(out.status.code(), Some(2), "{said}");
    assert!(said.contains("the scheme is missing"), "{said}");
    assert!(said.contains("http://localhost:3000"), "{said}");
}

#[test]
fn the_exit_code_does_not_depend_on_a_reader_of_the_error() {
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let status = Command::new(env!("CARGO_BIN_EXE_caustica"))
        // TEST-NET-1 (RFC 5737) belongs to no machine.
        .args(["serve", "--listen", "192.0.2.1:0"])
        .stderr(writer)
        .status()
        .unwrap();
    assert_eq!(status.code(), Some(2), "{status}");
}
