//! MCAP files, record by record: never more than one chunk in memory, and no length believed that the file has no room for.
//!
//! The framing (an opcode and a length before each record) and the few records that are needed are read here, so that a file
//! that was cut off or damaged gives what stands before; the `mcap` crate, which believes the lengths of texts, unpacks the
//! chunks.

use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io::{BufReader, Read as _, Seek as _, SeekFrom};
use std::path::Path;

use mcap::records::op;
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::storage::{FileTopic, RawMessage, Take};
use super::{BagError, unreadable};
use crate::session::import::ImportError;

/// Opcode and length.
const HEAD_BYTES: usize = 9;
/// No record or chunk of ours is larger, packed or not.
const MAX_RECORD_BYTES: u64 = 256 << 20;
/// Nor is a list of the messages in a chunk.
const MAX_LIST_BYTES: u64 = 16 << 20;
/// Unpacked, a chunk is at most so many times as long as the whole file, ...
const MAX_EXPANSION: u64 = 300;
/// ... or so long, in a file that is small.
const MIN_CHUNK_LIMIT: u64 = 1 << 20;

/// Why a walk along a file ended before the file did.
enum Stop {
    /// The file is damaged here.
    Damage(String),
    /// Whoever takes the records wants no more.
    Error(ImportError),
}

type OnRecord<'r> = &'r mut dyn FnMut(Record<'_>) -> Result<(), Stop>;

/// A record that tells of topics or messages.
enum Record<'b> {
    Schema {
        id: u16,
        name: String,
    },
    Channel {
        id: u16,
        schema_id: u16,
        topic: String,
        encoding: String,
    },
    Message {
        channel_id: u16,
        log_time_ns: i64,
        data: &'b [u8],
    },
    /// Messages by channel.
    Counts(HashMap<u16, u64>),
    /// From when to when the messages of a chunk were recorded, and where it is listed which those of a channel are.
    Chunk {
        recorded_ns: [i64; 2],
        listed_at: Vec<(u16, u64)>,
    },
    Other,
}

/// The fields of a record, one after the other.
struct Fields<'b>(&'b [u8]);

impl<'b> Fields<'b> {
    fn bytes<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*first)
    }

    fn u16(&mut self) -> Option<u16> {
        self.bytes().map(u16::from_le_bytes)
    }

    fn u32(&mut self) -> Option<u32> {
        self.bytes().map(u32::from_le_bytes)
    }

    fn u64(&mut self) -> Option<u64> {
        self.bytes().map(u64::from_le_bytes)
    }

    fn block(&mut self) -> Option<&'b [u8]> {
        let length = usize::try_from(self.u32()?).ok()?;
        let (block, rest) = self.0.split_at_checked(length)?;
        self.0 = rest;
        Some(block)
    }

    fn text(&mut self) -> Option<String> {
        self.block().map(|block| String::from_utf8_lossy(block).into_owned())
    }
}

/// Reads a record; `None` if it is too short for what it says.
fn parse(opcode: u8, body: &[u8]) -> Option<Record<'_>> {
    let mut fields = Fields(body);
    Some(match opcode {
        op::SCHEMA => Record::Schema { id: fields.u16()?, name: fields.text()? },
        op::CHANNEL => Record::Channel {
            id: fields.u16()?,
            schema_id: fields.u16()?,
            topic: fields.text()?,
            encoding: fields.text()?,
        },
        op::MESSAGE => {
            let (channel_id, _sequence) = (fields.u16()?, fields.u32()?);
            let (log_time, _publish_time) = (fields.u64()?, fields.u64()?);
            Record::Message { channel_id, log_time_ns: time(log_time), data: fields.0 }
        }
        op::STATISTICS => {
            // Numbers of messages, schemas, channels, attachments, metadata and chunks, and two times.
            fields.bytes::<{ 8 + 2 + 4 * 4 + 2 * 8 }>()?;
            let mut entries = Fields(fields.block()?);
            let mut counts = HashMap::new();
            while !entries.0.is_empty() {
                counts.insert(entries.u16()?, entries.u64()?);
            }
            Record::Counts(counts)
        }
        op::CHUNK_INDEX => {
            let recorded_ns = [fields.u64()?, fields.u64()?].map(time);
            // Where the chunk begins, and its length.
            fields.bytes::<{ 2 * 8 }>()?;
            let mut entries = Fields(fields.block()?);
            let mut listed_at = Vec::new();
            while !entries.0.is_empty() {
                listed_at.push((entries.u16()?, entries.u64()?));
            }
            Record::Chunk { recorded_ns, listed_at }
        }
        _ => Record::Other,
    })
}

fn time(ns: u64) -> i64 {
    i64::try_from(ns).unwrap_or(i64::MAX)
}

/// The checksum and the name of the compression of a chunk, and what is packed in it.
fn chunk(body: &[u8]) -> Option<(u32, &[u8], &[u8])> {
    let mut fields = Fields(body);
    // Two times and the size of the records.
    fields.bytes::<{ 3 * 8 }>()?;
    let (checksum, compression) = (fields.u32()?, fields.block()?);
    let length = usize::try_from(fields.u64()?).ok()?;
    Some((checksum, compression, fields.0.get(..length)?))
}

fn bad_record() -> Stop {
    Stop::Damage("a record that is shorter than what it holds".to_owned())
}

struct Walk {
    file: BufReader<File>,
    left: u64,
    body: Vec<u8>,
    unpacker: LinearReader,
}

impl Walk {
    fn open(path: &Path) -> Result<Self, BagError> {
        let opened = File::open(path).and_then(|file| Ok((file.metadata()?.len(), file)));
        let (left, file) = opened.map_err(|error| unreadable(path, &error.to_string()))?;
        let limit = left.saturating_mul(MAX_EXPANSION).clamp(MIN_CHUNK_LIMIT, MAX_RECORD_BYTES);
        let options = LinearReaderOptions::default()
            .with_skip_start_magic(true)
            .with_skip_end_magic(true)
            .with_prevalidate_chunk_crcs(true)
            .with_record_length_limit(usize::try_from(limit).unwrap_or(usize::MAX));
        let unpacker = LinearReader::new_with_options(options);
        Ok(Self { file: BufReader::new(file), left, body: Vec::new(), unpacker })
    }

    fn seek(&mut self, to: u64, num_bytes: u64) -> Result<(), String> {
        self.left = num_bytes.checked_sub(to).ok_or("a place beyond the file's end")?;
        self.file.seek(SeekFrom::Start(to)).map(drop).map_err(|error| error.to_string())
    }

    /// The times in a list of the messages of a channel in a chunk; `None` where there is no such list.
    fn listed_times(&mut self, at: u64, num_bytes: u64) -> Option<Vec<i64>> {
        self.seek(at, num_bytes).ok()?;
        let mut head = [0; HEAD_BYTES];
        self.file.read_exact(&mut head).ok()?;
        let [opcode, length @ ..] = head;
        let length = u64::from_le_bytes(length);
        if opcode != op::MESSAGE_INDEX || length > MAX_LIST_BYTES || length > self.left {
            return None;
        }
        let mut body = vec![0; usize::try_from(length).ok()?];
        self.file.read_exact(&mut body).ok()?;
        let mut fields = Fields(&body);
        fields.u16()?;
        let mut entries = Fields(fields.block()?);
        let mut times = Vec::new();
        while !entries.0.is_empty() {
            let (log_time, _offset) = (entries.u64()?, entries.u64()?);
            times.push(time(log_time));
        }
        Some(times)
    }

    /// From the present place to the end of the data, or to the footer.
    fn records(&mut self, on_record: OnRecord<'_>) -> Result<(), Stop> {
        loop {
            let mut head = [0; HEAD_BYTES];
            self.left = (self.left.checked_sub(HEAD_BYTES as u64))
                .ok_or_else(|| Stop::Damage("the file ends before its last record".to_owned()))?;
            self.file.read_exact(&mut head).map_err(|error| Stop::Damage(error.to_string()))?;
            let [opcode, length @ ..] = head;
            let length = u64::from_le_bytes(length);
            self.left = self.left.checked_sub(length).ok_or_else(|| {
                Stop::Damage(format!("the file ends {} bytes within a record of {length} bytes", self.left))
            })?;
            match opcode {
                op::DATA_END | op::FOOTER => return Ok(()),
                op::SCHEMA | op::CHANNEL | op::MESSAGE | op::CHUNK | op::STATISTICS | op::CHUNK_INDEX => {}
                _ => {
                    let length = i64::try_from(length).map_err(|_| Stop::Damage("a record without end".to_owned()))?;
                    self.file.seek_relative(length).map_err(|error| Stop::Damage(error.to_string()))?;
                    continue;
                }
            }
            if length > MAX_RECORD_BYTES {
                return Err(Stop::Damage(format!("a record of {length} bytes, more than {MAX_RECORD_BYTES}")));
            }
            // At most the file's own size, and 256 MB.
            self.body.resize(usize::try_from(length).unwrap_or_default(), 0);
            self.file.read_exact(&mut self.body).map_err(|error| Stop::Damage(error.to_string()))?;
            self.record(opcode, head, on_record)?;
        }
    }

    fn record(&mut self, opcode: u8, head: [u8; HEAD_BYTES], on_record: OnRecord<'_>) -> Result<(), Stop> {
        let damage = |error: ::mcap::McapError| Stop::Damage(error.to_string());
        if opcode != op::CHUNK {
            return on_record(parse(opcode, &self.body).ok_or_else(bad_record)?);
        }
        let (checksum, compression, packed) = chunk(&self.body).ok_or_else(bad_record)?;
        if compression.is_empty() {
            if checksum != 0 && crc32(packed) != checksum {
                return Err(Stop::Damage("a chunk that does not match its checksum".to_owned()));
            }
            return plain_records(packed, on_record);
        }
        // The unpacker takes chunks one after the other, each as it stands in the file.
        let mut parts = [&head[..], &self.body[..]].into_iter();
        let mut rest: &[u8] = &[];
        while let Some(event) = self.unpacker.next_event() {
            match event.map_err(damage)? {
                LinearReadEvent::ReadRequest(wanted) => {
                    while rest.is_empty() {
                        // Behind the whole chunk it asks for the next record.
                        let Some(next) = parts.next() else { return Ok(()) };
                        rest = next;
                    }
                    // To give nothing would mean that the file ends.
                    let (given, later) = rest.split_at(wanted.clamp(1, rest.len()));
                    self.unpacker.insert(given.len()).copy_from_slice(given);
                    self.unpacker.notify_read(given.len());
                    rest = later;
                }
                LinearReadEvent::Record { data, opcode } => {
                    if is_ours(opcode) {
                        on_record(parse(opcode, data).ok_or_else(bad_record)?)?;
                    }
                }
            }
        }
        Ok(())
    }
}

const fn is_ours(opcode: u8) -> bool {
    matches!(opcode, op::SCHEMA | op::CHANNEL | op::MESSAGE)
}

/// The records of a chunk that is not packed.
fn plain_records(mut data: &[u8], on_record: OnRecord<'_>) -> Result<(), Stop> {
    let short = || Stop::Damage("a chunk that ends within a record".to_owned());
    while !data.is_empty() {
        let (&[opcode, length @ ..], rest) = data.split_first_chunk::<HEAD_BYTES>().ok_or_else(short)?;
        let length = usize::try_from(u64::from_le_bytes(length)).map_err(|_| short())?;
        let (body, rest) = rest.split_at_checked(length).ok_or_else(short)?;
        if is_ours(opcode) {
            on_record(parse(opcode, body).ok_or_else(bad_record)?)?;
        }
        data = rest;
    }
    Ok(())
}

/// The checksum of chunks (CRC-32 as in zip files).
fn crc32(bytes: &[u8]) -> u32 {
    const TABLE: [u32; 256] = {
        let mut table = [0; 256];
        let (mut idx, mut byte) = (0, 0_u32);
        while idx < 256 {
            let mut entry = byte;
            let mut bit = 0;
            while bit < 8 {
                entry = if entry & 1 == 1 { 0xedb8_8320 ^ (entry >> 1) } else { entry >> 1 };
                bit += 1;
            }
            table[idx] = entry;
            (idx, byte) = (idx + 1, byte + 1);
        }
        table
    };
    !bytes.iter().fold(u32::MAX, |crc, byte| TABLE[((crc ^ u32::from(*byte)) & 0xff) as usize] ^ (crc >> 8))
}

/// Channels with their schemas, and how many messages each has.
#[derive(Default)]
struct Directory {
    schemas: HashMap<u16, String>,
    /// By number, so that topics come in one order each time: the schema's number, the topic, the encoding.
    channels: BTreeMap<u16, (u16, String, String)>,
    counts: HashMap<u16, u64>,
    /// When the first and the last message of a channel were recorded.
    recorded_ns: HashMap<u16, [i64; 2]>,
    /// The chunks with the first and the last of a channel: when they begin or end, and where its messages are listed.
    ends: HashMap<u16, [(i64, u64); 2]>,
}

impl Directory {
    fn take_time(&mut self, channel_id: u16, time_ns: i64) {
        let [first, last] = self.recorded_ns.entry(channel_id).or_insert([time_ns; 2]);
        (*first, *last) = ((*first).min(time_ns), (*last).max(time_ns));
    }

    fn take(&mut self, record: Record<'_>) {
        match record {
            Record::Schema { id, name } => drop(self.schemas.insert(id, name)),
            Record::Channel { id, schema_id, topic, encoding } => {
                self.channels.insert(id, (schema_id, topic, encoding));
            }
            Record::Message { channel_id, log_time_ns, .. } => {
                *self.counts.entry(channel_id).or_default() += 1;
                self.take_time(channel_id, log_time_ns);
            }
            Record::Counts(counts) => self.counts = counts,
            Record::Chunk { recorded_ns: [from_ns, to_ns], listed_at } => {
                for (channel_id, at) in listed_at {
                    let [first, last] = self.ends.entry(channel_id).or_insert([(from_ns, at), (to_ns, at)]);
                    *first = (*first).min((from_ns, at));
                    *last = (*last).max((to_ns, at));
                }
            }
            Record::Other => {}
        }
    }

    fn topics(self) -> Vec<FileTopic> {
        let Self { schemas, channels, counts, recorded_ns, .. } = self;
        let topic = |(id, (schema_id, name, encoding)): (u16, (u16, String, String))| FileTopic {
            name,
            type_name: schemas.get(&schema_id).cloned().unwrap_or_default(),
            encoding,
            num_messages: counts.get(&id).copied().unwrap_or_default(),
            recorded_ns: recorded_ns.get(&id).copied(),
        };
        channels.into_iter().map(topic).collect()
    }
}

/// The topics from the summary at the file's end, or, where there is none, by looking through the file.
pub(super) fn topics(path: &Path) -> Result<(Vec<FileTopic>, Option<String>), BagError> {
    if let Some(directory) = summary(path)? {
        return Ok((directory.topics(), None));
    }
    let mut walk = Walk::open(path)?;
    let num_bytes = walk.left;
    let mut directory = Directory::default();
    let magic = ::mcap::MAGIC.len() as u64;
    let outcome = walk.seek(magic, num_bytes).map_err(Stop::Damage).and_then(|()| {
        walk.records(&mut |record| {
            directory.take(record);
            Ok(())
        })
    });
    let damage = match outcome {
        Err(Stop::Damage(damage)) => Some(damage),
        _ => None,
    };
    Ok((directory.topics(), damage))
}

/// What the summary says; `None` where it is missing or damaged.
fn summary(path: &Path) -> Result<Option<Directory>, BagError> {
    /// Footer and magic bytes at the end.
    const END_BYTES: usize = 9 + 20 + 8;
    let mut walk = Walk::open(path)?;
    let num_bytes = walk.left;
    let mut end = [0; END_BYTES];
    let is_read = num_bytes > END_BYTES as u64
        && walk.seek(num_bytes - END_BYTES as u64, num_bytes).is_ok()
        && walk.file.read_exact(&mut end).is_ok();
    if !is_read || end[0] != op::FOOTER || !end.ends_with(::mcap::MAGIC) {
        return Ok(None);
    }
    let summary_start = Fields(&end[HEAD_BYTES..]).u64().unwrap_or_default();
    let mut directory = Directory::default();
    let mut has_counts = false;
    if summary_start == 0 || walk.seek(summary_start, num_bytes).is_err() {
        return Ok(None);
    }
    let outcome = walk.records(&mut |record| {
        // Writers that do not count leave the counts empty.
        has_counts |= matches!(&record, Record::Counts(counts) if !counts.is_empty());
        directory.take(record);
        Ok(())
    });
    if outcome.is_err() || !has_counts || directory.channels.is_empty() {
        return Ok(None);
    }
    // Of each channel the lists of its first and of its last chunk.
    for (channel_id, ends) in std::mem::take(&mut directory.ends) {
        for (_, at) in ends {
            for time_ns in walk.listed_times(at, num_bytes).unwrap_or_default() {
                directory.take_time(channel_id, time_ns);
            }
        }
    }
    Ok(Some(directory))
}

/// See [`super::storage::stream`].
pub(super) fn stream(
    path: &Path,
    wanted: &dyn Fn(&str, &str) -> Option<usize>,
    take: Take<'_>,
) -> Result<Option<String>, ImportError> {
    let mut walk = Walk::open(path)?;
    let num_bytes = walk.left;
    let mut topic_of: HashMap<u16, usize> = HashMap::new();
    let mut types: HashMap<u16, String> = HashMap::new();
    let outcome = walk.seek(::mcap::MAGIC.len() as u64, num_bytes).map_err(Stop::Damage).and_then(|()| {
        walk.records(&mut |record| {
            match record {
                Record::Schema { id, name } => drop(types.insert(id, name)),
                Record::Channel { id, schema_id, topic, .. } => {
                    if let Some(topic_idx) = wanted(&topic, types.get(&schema_id).map_or("", String::as_str)) {
                        topic_of.insert(id, topic_idx);
                    }
                }
                Record::Message { channel_id, log_time_ns, data } => {
                    if let Some(topic_idx) = topic_of.get(&channel_id) {
                        take(RawMessage { topic_idx: *topic_idx, log_time_ns, data }).map_err(Stop::Error)?;
                    }
                }
                Record::Counts(_) | Record::Chunk { .. } | Record::Other => {}
            }
            Ok(())
        })
    });
    match outcome {
        Ok(()) => Ok(None),
        Err(Stop::Damage(damage)) => Ok(Some(damage)),
        Err(Stop::Error(error)) => Err(error),
    }
}

#[cfg(test)]
mod tests {
    use super::{Directory, Record, crc32};

    #[test]
    fn channels_come_by_number_with_their_types() {
        let mut directory = Directory::default();
        for id in [9, 3, 5] {
            let (topic, encoding) = ("/points".to_owned(), "cdr".to_owned());
            directory.take(Record::Channel { id, schema_id: id, topic, encoding });
            directory.take(Record::Schema { id, name: format!("type {id}") });
        }
        let types: Vec<String> = directory.topics().into_iter().map(|topic| topic.type_name).collect();
        assert_eq!(types, ["type 3", "type 5", "type 9"]);
    }

    #[test]
    fn the_checksum_is_that_of_zip_files() {
        // The check value of the catalogue of checksums.
        assert_eq!(crc32(b"123456789"), 0xcbf4_3926);
    }
}
