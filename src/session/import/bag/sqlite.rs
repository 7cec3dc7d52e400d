//! The `SQLite` files of rosbag2, `.db3`: a table of topics and one of messages.

use std::collections::HashMap;
use std::path::Path;

use rusqlite::{Connection, OpenFlags};

use super::storage::{FileTopic, RawMessage, Take};
use super::{BagError, unreadable};
use crate::session::import::ImportError;

fn open(path: &Path) -> Result<Connection, BagError> {
    // Nothing is ever written; a damaged schema must not run code of its own.
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    Connection::open_with_flags(path, flags)
        .and_then(|connection| connection.execute_batch("PRAGMA trusted_schema = OFF").map(|()| connection))
        .map_err(|error| unreadable(path, &error.to_string()))
}

/// The topics, with the number of messages of each.
pub(super) fn topics(path: &Path) -> Result<Vec<FileTopic>, BagError> {
    let connection = open(path)?;
    let read = || -> rusqlite::Result<Vec<FileTopic>> {
        let mut counts: HashMap<i64, (u64, [i64; 2])> = HashMap::new();
        let mut query = connection
            .prepare("SELECT topic_id, COUNT(*), MIN(timestamp), MAX(timestamp) FROM messages GROUP BY topic_id")?;
        let mut rows = query.query([])?;
        while let Some(row) = rows.next()? {
            let count = u64::try_from(row.get::<_, i64>(1)?).unwrap_or_default();
            counts.insert(row.get(0)?, (count, [row.get(2)?, row.get(3)?]));
        }
        let mut query = connection.prepare("SELECT id, name, type, serialization_format FROM topics")?;
        let mut rows = query.query([])?;
        let mut topics = Vec::new();
        while let Some(row) = rows.next()? {
            let counted = counts.get(&row.get(0)?).copied();
            let (num_messages, recorded_ns) = counted.map_or((0, None), |(count, times)| (count, Some(times)));
            let (name, type_name, encoding) = (row.get(1)?, row.get(2)?, row.get(3)?);
            topics.push(FileTopic { name, type_name, encoding, num_messages, recorded_ns });
        }
        Ok(topics)
    };
    read().map_err(|error| unreadable(path, &error.to_string()))
}

/// See [`super::storage::stream`].
pub(super) fn stream(
    path: &Path,
    wanted: &dyn Fn(&str, &str) -> Option<usize>,
    take: Take<'_>,
) -> Result<Option<String>, ImportError> {
    let connection = open(path)?;
    let mut refused = None;
    let mut read = || -> rusqlite::Result<()> {
        let mut topic_of: HashMap<i64, usize> = HashMap::new();
        let mut query = connection.prepare("SELECT id, name, type FROM topics")?;
        let mut rows = query.query([])?;
        while let Some(row) = rows.next()? {
            if let Some(topic_idx) = wanted(&row.get::<_, String>(1)?, &row.get::<_, String>(2)?) {
                topic_of.insert(row.get(0)?, topic_idx);
            }
        }
        // In the order of the file, which is that of the recording: sorting would need room for all of them.
        let mut query = connection.prepare("SELECT topic_id, timestamp, data FROM messages")?;
        let mut rows = query.query([])?;
        while let Some(row) = rows.next()? {
            let Some(topic_idx) = topic_of.get(&row.get(0)?) else { continue };
            let data = row.get_ref(2)?.as_blob().unwrap_or_default();
            let message = RawMessage { topic_idx: *topic_idx, log_time_ns: row.get(1)?, data };
            if let Err(error) = take(message) {
                refused = Some(error);
                break;
            }
        }
        Ok(())
    };
    let damage = read().err().map(|error| error.to_string());
    match refused {
        Some(error) => Err(error),
        None => Ok(damage),
    }
}
