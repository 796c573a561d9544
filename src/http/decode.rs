//! Encodings of request bodies (`Content-Encoding`).

use std::io;
use std::pin::Pin;
use std::task::{Context, Poll, ready};

use async_compression::tokio::bufread::{GzipDecoder, ZlibDecoder};
use axum::BoxError;
use axum::body::{Body, Bytes, HttpBody};
use axum::extract::Request;
use axum::http::{HeaderMap, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use http_body_util::BodyExt as _;
use hyper::body::Frame;
use tokio::io::{AsyncRead, ReadBuf};
use tokio_util::io::StreamReader;

use super::error::ApiError;

/// Encodings that are decoded, as `Accept-Encoding` lists them.
pub(super) const ACCEPTED: &str = "gzip, deflate";

/// Most bytes of a decoded body that are handed on at a time.
const CHUNK_BYTES: usize = 8192;

/// An encoding that is decoded.
#[derive(Clone, Copy, Debug)]
enum Encoding {
    Gzip,
    Deflate,
}

impl Encoding {
    fn name(self) -> &'static str {
        match self {
            Self::Gzip => "gzip",
            Self::Deflate => "deflate",
        }
    }
}

/// A body that is not in the encoding that its header names.
#[derive(Debug, thiserror::Error)]
#[error(
    "Content-Encoding is {encoding}, but the body is not valid {encoding} from start to end: {reason}"
)]
pub(super) struct Undecodable {
    /// The encoding that the header names.
    encoding: &'static str,
    reason: io::Error,
}

/// A body that did not arrive, whatever its encoding.
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
struct Broken(axum::Error);

/// A body that is decoded as it is read.
struct Decoded {
    encoding: Encoding,
    reader: Pin<Box<dyn AsyncRead + Send>>,
}

impl Decoded {
    fn new(encoding: Encoding, body: Body) -> Self {
        // The body's own errors are marked, so that they are not taken for those of the decoder.
        let body = body.map_err(|error| io::Error::other(Broken(error)));
        let arriving = StreamReader::new(body.into_data_stream());
        // A gzip file may have several members (RFC 1952, 2.2). With several members allowed, bytes after the last one that are no
        // member are an error; otherwise they would be ignored. Therefore the same is set for deflate.
        let reader: Pin<Box<dyn AsyncRead + Send>> = match encoding {
            Encoding::Gzip => {
                let mut decoder = GzipDecoder::new(arriving);
                decoder.multiple_members(true);
                Box::pin(decoder)
            }
            Encoding::Deflate => {
                let mut decoder = ZlibDecoder::new(arriving);
                decoder.multiple_members(true);
                Box::pin(decoder)
            }
        };
        Self { encoding, reader }
    }

    /// The error of a read: that of the body itself, or of its encoding.
    fn error(&self, error: io::Error) -> BoxError {
        match error.downcast::<Broken>() {
            Ok(Broken(error)) => error.into(),
            Err(reason) => Undecodable {
                encoding: self.encoding.name(),
                reason,
            }
            .into(),
        }
    }
}

impl HttpBody for Decoded {
    type Data = Bytes;
    type Error = BoxError;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, BoxError>>> {
        let mut chunk = [0; CHUNK_BYTES];
        let mut chunk = ReadBuf::new(&mut chunk);
        let read = ready!(self.reader.as_mut().poll_read(context, &mut chunk));
        Poll::Ready(match (read, chunk.filled()) {
            (Err(error), _) => Some(Err(self.error(error))),
            (Ok(()), []) => None,
            (Ok(()), bytes) => Some(Ok(Frame::data(Bytes::copy_from_slice(bytes)))),
        })
    }
}

/// The middleware: hands bodies on decoded. Nothing is held: the limit of a body's size is applied to the decoded bytes as they are
/// read.
pub(super) async fn decode(mut request: Request, next: Next) -> Response {
    let encoding = match encoding(request.headers()) {
        Ok(encoding) => encoding,
        Err(error) => return error.into_response(),
    };
    let headers = request.headers_mut();
    headers.remove(header::CONTENT_ENCODING);
    if let Some(encoding) = encoding {
        // That is the length of the encoded body.
        headers.remove(header::CONTENT_LENGTH);
        request = request.map(|body| Body::new(Decoded::new(encoding, body)));
    }
    next.run(request).await
}

/// The encoding of a body, if it has one that is decoded.
fn encoding(headers: &HeaderMap) -> Result<Option<Encoding>, ApiError> {
    let lines = headers.get_all(header::CONTENT_ENCODING).iter();
    let text: Vec<_> = lines
        .map(|line| String::from_utf8_lossy(line.as_bytes()).to_ascii_lowercase())
        .collect();
    let text = text.join(", ");
    let named: Vec<&str> = text
        .split(',')
        .map(str::trim)
        .filter(|name| !matches!(*name, "" | "identity"))
        .collect();
    match named.as_slice() {
        [] => Ok(None),
        ["gzip" | "x-gzip"] => Ok(Some(Encoding::Gzip)),
        ["deflate"] => Ok(Some(Encoding::Deflate)),
        _ => Err(ApiError::UnsupportedEncoding {
            found: named.join(", ").chars().take(60).collect(),
        }),
    }
}
