//! As much of HTTP as reading one page takes; pure, in both directions.

use crate::device::error::MessageError;

/// The page is some kilobytes; what is longer is another one.
pub const MAX_RESPONSE_BYTES: usize = 256 * 1024;

/// A request for a page; the connection ends with the answer.
#[must_use]
pub fn encode_get(host: &str, path: &str) -> String {
    format!("GET {path} HTTP/1.0\r\nHost: {host}\r\nAccept: text/html\r\nConnection: close\r\n\r\n")
}

/// The path of a request, once its head has come.
///
/// # Errors
/// [`MessageError`] if it is no GET, or too long.
pub fn parse_get(bytes: &[u8]) -> Result<Option<String>, MessageError> {
    /// Longer heads are not asked for a page.
    const MAX_HEAD_BYTES: usize = 16 * 1024;
    let Some(head_len) = head_len(bytes) else {
        return if bytes.len() > MAX_HEAD_BYTES {
            Err(MessageError::new(bytes, format!("a head of at most {MAX_HEAD_BYTES} bytes")))
        } else {
            Ok(None)
        };
    };
    let head = String::from_utf8_lossy(&bytes[..head_len]);
    let mut words = head.lines().next().unwrap_or_default().split(' ');
    match (words.next(), words.next(), words.next()) {
        (Some("GET"), Some(path), Some(version)) if version.starts_with("HTTP/") => Ok(Some(path.to_owned())),
        _ => Err(MessageError::new(bytes, "GET, a path and HTTP/1.0 or 1.1")),
    }
}

/// What a server answers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Response {
    /// 200 if all is well.
    pub status: u16,
    /// The page.
    pub body: Vec<u8>,
}

impl Response {
    /// The response with its length said.
    #[must_use]
    pub fn encode(&self) -> Vec<u8> {
        let reason = if self.status == 200 { "OK" } else { "Error" };
        let head = format!(
            "HTTP/1.0 {} {reason}\r\nContent-Type: text/html\r\nContent-Length: {}\r\nConnection: close\r\n\r\n",
            self.status,
            self.body.len()
        );
        [head.as_bytes(), &self.body].concat()
    }

    /// Reads a response from all that has come; `None` if more must come. `is_closed`: nothing more will.
    ///
    /// # Errors
    /// [`MessageError`] if it is none, is too long, or was cut.
    pub fn parse(bytes: &[u8], is_closed: bool) -> Result<Option<Self>, MessageError> {
        if bytes.len() > MAX_RESPONSE_BYTES {
            return Err(MessageError::new(bytes, format!("a page of at most {MAX_RESPONSE_BYTES} bytes")));
        }
        let cut = || if is_closed { Err(MessageError::new(bytes, "a page that is not cut")) } else { Ok(None) };
        // Told at once from another protocol, rather than at the deadline.
        let begins = b"HTTP/1.";
        let num_seen = bytes.len().min(begins.len());
        if bytes[..num_seen] != begins[..num_seen] {
            return Err(MessageError::new(bytes, "HTTP/1.0 or 1.1"));
        }
        let Some(head_len) = head_len(bytes) else { return cut() };
        let head = String::from_utf8_lossy(&bytes[..head_len]);
        let status = head
            .split_ascii_whitespace()
            .nth(1)
            .and_then(|status| status.parse().ok())
            .ok_or_else(|| MessageError::new(bytes, "HTTP/1.0 or 1.1 and a status"))?;
        let field = |name: &str| {
            head.lines().skip(1).find_map(|line| {
                let (found, value) = line.split_once(':')?;
                found.trim().eq_ignore_ascii_case(name).then(|| value.trim().to_ascii_lowercase())
            })
        };
        let rest = &bytes[head_len..];
        if field("transfer-encoding").is_some_and(|coding| coding.contains("chunked")) {
            return match unchunked(rest)? {
                Some(body) => Ok(Some(Self { status, body })),
                None => cut(),
            };
        }
        match field("content-length") {
            Some(len) => {
                let len: usize = len
                    .parse()
                    .ok()
                    .filter(|len| *len <= MAX_RESPONSE_BYTES)
                    .ok_or_else(|| MessageError::new(&len, format!("a length of at most {MAX_RESPONSE_BYTES}")))?;
                match rest.get(..len) {
                    Some(body) => Ok(Some(Self { status, body: body.to_vec() })),
                    None => cut(),
                }
            }
            // Without a length the page ends with the connection.
            None if is_closed => Ok(Some(Self { status, body: rest.to_vec() })),
            None => Ok(None),
        }
    }
}

/// Where the head ends; some servers write bare line feeds.
fn head_len(bytes: &[u8]) -> Option<usize> {
    let ends = [&b"\r\n\r\n"[..], b"\n\n"];
    ends.iter().filter_map(|end| bytes.windows(end.len()).position(|part| part == *end).map(|at| at + end.len())).min()
}

/// Joins chunks: a size in hexadecimal on a line, so many bytes, an end of line; the last has size 0.
fn unchunked(mut rest: &[u8]) -> Result<Option<Vec<u8>>, MessageError> {
    let mut body = Vec::new();
    loop {
        let Some(end) = rest.iter().position(|byte| *byte == b'\n') else { return Ok(None) };
        let line = std::str::from_utf8(&rest[..end]).unwrap_or_default();
        let size = usize::from_str_radix(line.split(';').next().unwrap_or_default().trim(), 16)
            .ok()
            .filter(|size| *size <= MAX_RESPONSE_BYTES)
            .ok_or_else(|| MessageError::new(&rest[..end], "the size of a chunk"))?;
        if size == 0 {
            return Ok(Some(body));
        }
        let Some(chunk) = rest.get(end + 1..end + 1 + size) else { return Ok(None) };
        body.extend_from_slice(chunk);
        let after = &rest[end + 1 + size..];
        rest = match after {
            [b'\r', b'\n', rest @ ..] | [b'\n', rest @ ..] => rest,
            [] | [b'\r'] => return Ok(None),
            _ => return Err(MessageError::new(after, "the end of a chunk")),
        };
    }
}
