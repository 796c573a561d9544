//! Bodies with a `Content-Encoding`.

use std::io::Write as _;

use axum::body::Body;
use axum::http::Request;
use caustica::config::Limits;
use caustica::http::ProblemKind;
use flate2::Compression;
use flate2::write::{GzEncoder, ZlibEncoder};
use serde_json::Value;

use super::support::{Reply, Service, scenes};

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 3 2\n";

fn gzip(text: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(text).unwrap();
    encoder.finish().unwrap()
}

fn deflate(text: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(text).unwrap();
    encoder.finish().unwrap()
}

async fn post(service: &Service, path: &str, kind: &str, encoding: &str, body: Vec<u8>) -> Reply {
    let request = Request::post(path)
        .header("content-type", kind)
        .header("content-encoding", encoding)
        .body(Body::from(body));
    service.send(request.unwrap()).await
}

#[tokio::test]
async fn encoded_scenes_and_meshes_are_those_that_were_encoded() {
    let service = Service::start().await;
    let scene = scenes::small().to_string();
    let plain = service.post_json("/v1/render", &scene).await;
    for (encoding, body) in [
        ("gzip", gzip(scene.as_bytes())),
        ("x-gzip", gzip(scene.as_bytes())),
        ("GZip", gzip(scene.as_bytes())),
        ("identity, gzip", gzip(scene.as_bytes())),
        ("deflate", deflate(scene.as_bytes())),
        ("identity", scene.clone().into_bytes()),
        ("", scene.clone().into_bytes()),
    ] {
        let reply = post(&service, "/v1/render", "application/json", encoding, body).await;
        assert_eq!(reply.status, 200, "{encoding}: {}", reply.text());
        assert_eq!(reply.header("etag"), plain.header("etag"), "{encoding}");
    }
    let plan = gzip(scene.as_bytes());
    let plan = post(&service, "/v1/plan", "application/json", "gzip", plan).await;
    assert_eq!(plan.status, 200);

    let plain: Value = service
        .post("/v1/meshes", "model/obj", TRIANGLE)
        .await
        .json();
    let body = gzip(TRIANGLE.as_bytes());
    let reply = post(&service, "/v1/meshes", "model/obj", "gzip", body).await;
    assert_eq!(reply.status, 200, "stored already");
    assert_eq!(reply.json::<Value>()["id"], plain["id"]);
    let form = format!(
        "--cut\r\ncontent-disposition: form-data; name=\"obj\"; filename=\"t.obj\"\r\n\r\n{TRIANGLE}\r\n--cut--\r\n"
    );
    let body = gzip(form.as_bytes());
    let kind = "multipart/form-data; boundary=cut";
    let reply = post(&service, "/v1/meshes", kind, "gzip", body).await;
    assert_eq!(reply.json::<Value>()["id"], plain["id"]);
}

/// As `cat a.gz b.gz` and bgzip write them.
#[tokio::test]
async fn all_members_of_a_gzip_body_are_read() {
    let service = Service::start().await;
    let scene = scenes::small().to_string();
    let plain = service.post_json("/v1/render", &scene).await;
    let (start, end) = scene.as_bytes().split_at(scene.len() / 2);
    let two = [gzip(start), gzip(end)].concat();
    let with_empty = [gzip(b""), gzip(start), gzip(b""), gzip(end), gzip(b"")].concat();
    for body in [two, with_empty] {
        let reply = post(&service, "/v1/render", "application/json", "gzip", body).await;
        assert_eq!(reply.status, 200, "{}", reply.text());
        assert_eq!(reply.header("etag"), plain.header("etag"));
    }
}

#[tokio::test]
async fn bytes_after_the_end_of_an_encoding_are_an_error() {
    let service = Service::start().await;
    let scene = scenes::small().to_string();
    let gzip = gzip(scene.as_bytes());
    let deflate = deflate(scene.as_bytes());
    for (encoding, encoded) in [("gzip", gzip), ("deflate", deflate)] {
        // Less than a header, more than a header, half a member.
        for rest in [b"x".to_vec(), vec![b'x'; 100], encoded[..9].to_vec()] {
            let body = [encoded.clone(), rest].concat();
            let reply = post(&service, "/v1/render", "application/json", encoding, body).await;
            let problem = reply.problem(ProblemKind::MalformedBody);
            let expected = format!("the body is not valid {encoding} from start to end: ");
            assert!(problem.detail.contains(&expected), "{}", problem.detail);
        }
    }
    service.assert_whole().await;
}

#[tokio::test]
async fn other_encodings_are_refused_with_those_that_are_decoded() {
    let service = Service::start().await;
    for (encoding, found) in [
        ("br", "br"),
        ("zstd", "zstd"),
        ("gzip, gzip", "gzip, gzip"),
        ("Klingon", "klingon"),
    ] {
        for (path, kind) in [
            ("/v1/render", "application/json"),
            ("/v1/plan", "application/json"),
            ("/v1/accuracy", "application/json"),
            ("/v1/meshes", "model/obj"),
        ] {
            let reply = post(&service, path, kind, encoding, b"x".to_vec()).await;
            let problem = reply.problem(ProblemKind::UnsupportedEncoding);
            assert_eq!(
                problem.detail,
                format!("Content-Encoding is {found}; accepted: one of gzip, deflate, or none")
            );
            assert_eq!(reply.header("accept-encoding"), "gzip, deflate");
        }
    }
    // Where there is no route, the address is what is wrong.
    let reply = post(&service, "/v1/rendr", "application/json", "br", Vec::new()).await;
    reply.problem(ProblemKind::NotFound);
    service.assert_whole().await;
}

#[tokio::test]
async fn broken_encodings_are_reported_as_such() {
    let service = Service::start().await;
    let whole = gzip(scenes::small().to_string().as_bytes());
    let mut flipped = whole.clone();
    let middle = flipped.len() / 2;
    flipped[middle] ^= 0xff;
    for (what, body) in [
        ("plain", scenes::small().to_string().into_bytes()),
        ("cut", whole[..whole.len() / 2].to_vec()),
        ("flipped", flipped),
    ] {
        for (path, kind) in [
            ("/v1/render", "application/json"),
            ("/v1/meshes", "model/obj"),
            ("/v1/meshes", "multipart/form-data; boundary=cut"),
        ] {
            let reply = post(&service, path, kind, "gzip", body.clone()).await;
            assert_eq!(reply.status, 400, "{what} {path} {kind}");
            let problem = reply.problem(ProblemKind::MalformedBody);
            assert!(
                problem.detail.contains("the body is not valid gzip"),
                "{what} {path} {kind}: {}",
                problem.detail
            );
        }
    }
    service.assert_whole().await;
}

#[tokio::test]
async fn the_size_limit_is_that_of_the_decoded_body() {
    let limits = Limits {
        max_body_bytes: 4096,
        ..Limits::default()
    };
    let service = Service::start_limited(limits).await;
    // 64 MiB of spaces in 64 KiB.
    let bomb = gzip(&vec![b' '; 64 << 20]);
    // The same in members that are smaller than the limit.
    let many = gzip(&[b' '; 4000]).repeat(1000);
    for (path, kind) in [
        ("/v1/render", "application/json"),
        ("/v1/meshes", "text/plain"),
        ("/v1/meshes", "multipart/form-data; boundary=cut"),
    ] {
        for bomb in [&bomb, &many] {
            let reply = post(&service, path, kind, "gzip", bomb.clone()).await;
            reply.problem(ProblemKind::BodyTooLarge);
        }
    }
    let scene = scenes::small().to_string();
    assert!(scene.len() < 4096, "the scene fits");
    let mut padded = scene.into_bytes();
    padded.resize(4096, b' ');
    let fits = post(
        &service,
        "/v1/render",
        "application/json",
        "gzip",
        gzip(&padded),
    )
    .await;
    assert_eq!(fits.status, 200, "{}", fits.text());
    padded.push(b' ');
    let over = post(
        &service,
        "/v1/render",
        "application/json",
        "gzip",
        gzip(&padded),
    )
    .await;
    over.problem(ProblemKind::BodyTooLarge);
}
