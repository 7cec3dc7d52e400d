//! What survives a run that ends badly: a copy of the unsaved session, kept on disk while one works.
//!
//! Each running program has a pair of files in the recovery folder: an ordinary session file with one more field, which
//! says where it came from, and a lock beside it. The lock is free as soon as the program has ended, however it ended; a
//! copy with a free lock is offered at the next start. Whoever offers a copy holds its lock, so that no two programs
//! offer the same.
//!
//! A thread of its own does all of that: copies are written in the order they were asked for and none after its session
//! was saved, they are written even while the window does not answer, and in between it sleeps.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::process;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant, SystemTime};

use serde_json::{Map, Value, json};

use crate::session::format::{self, Stamp, unix_ms};
use crate::session::{Session, SessionError};
use crate::whole_file;

use super::jobs::Wake;

/// Time from one copy to the next while one edits. With the time that writing takes, less than 10 s are lost at worst.
pub const INTERVAL: Duration = Duration::from_secs(3);

/// The field that a copy has beside those of its session.
const FIELD: &str = "handeye_recovery";
const COPY_EXTENSION: &str = "json";
const LOCK_EXTENSION: &str = "lock";

/// Where copies are kept, and how often they are written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecoverySettings {
    /// The folder; it is made when the first copy is written.
    pub folder: PathBuf,
    /// Time from one copy to the next.
    pub interval: Duration,
}

impl RecoverySettings {
    /// Copies in this folder, as often as is usual.
    #[must_use]
    pub const fn new(folder: PathBuf) -> Self {
        Self { folder, interval: INTERVAL }
    }
}

/// What is known of an unsaved session beside its contents.
#[derive(Clone, Debug, PartialEq)]
pub struct Origin {
    /// What the window called it.
    pub title: String,
    /// Its file, if it had one.
    pub path: Option<PathBuf>,
    /// When the copy was written.
    pub written_at: SystemTime,
    /// Steps of the history that the file does not hold.
    pub num_edits: usize,
    /// The last of them.
    pub last_edit: Option<String>,
    /// The file as it was when it was read or written last.
    pub stamp: Option<Stamp>,
}

/// What a run that ended badly left behind.
#[derive(Clone, Debug, PartialEq)]
pub struct Recoverable {
    /// The copy.
    pub file: PathBuf,
    /// What it is a copy of, or why it cannot be read.
    pub origin: Result<Origin, SessionError>,
}

/// A session as it was at some moment.
#[derive(Clone, Debug)]
pub(super) struct Snapshot {
    pub session: Arc<Session>,
    pub origin: Origin,
}

#[derive(Debug)]
enum Order {
    /// There is a newer state to keep.
    Keep(Snapshot),
    /// Nothing is unsaved any more.
    Forget,
    /// Read this copy.
    Read(PathBuf),
    /// What this copy holds is on the bench, or unwanted: remove it.
    Discard(PathBuf),
}

/// What the thread has to tell.
#[derive(Debug)]
pub(super) enum News {
    /// All that may be recovered now.
    Found(Vec<Recoverable>),
    /// A copy was read.
    Read { file: PathBuf, outcome: Box<Result<(Session, Origin), SessionError>> },
    /// A copy was written.
    Kept,
    /// A copy could not be written; told once until one could be again.
    NotKept { folder: PathBuf, problem: String },
}

/// The workbench's end of the thread.
#[derive(Debug)]
pub(super) struct Recovery {
    orders: Option<Sender<Order>>,
    news: Receiver<News>,
    thread: Option<JoinHandle<()>>,
}

impl Recovery {
    /// Starts the thread, which looks for copies left behind first.
    pub fn start(settings: RecoverySettings, wake: Wake) -> io::Result<Self> {
        let (orders, for_thread) = channel();
        let (to_workbench, news) = channel();
        let thread = thread::Builder::new().name("keep recovery copies".to_owned()).spawn(move || {
            let tell = move |news| {
                // Nobody listens any more while the workbench goes away.
                to_workbench.send(news).ok();
                wake();
            };
            Keeper::new(settings, tell).run(&for_thread);
        })?;
        Ok(Self { orders: Some(orders), news, thread: Some(thread) })
    }

    pub fn keep(&self, snapshot: Snapshot) {
        self.order(Order::Keep(snapshot));
    }

    pub fn forget(&self) {
        self.order(Order::Forget);
    }

    pub fn read(&self, file: PathBuf) {
        self.order(Order::Read(file));
    }

    pub fn discard(&self, file: PathBuf) {
        self.order(Order::Discard(file));
    }

    pub fn poll(&self) -> Option<News> {
        self.news.try_recv().ok()
    }

    fn order(&self, order: Order) {
        if let Some(orders) = &self.orders {
            // The thread ends with this sender, so it takes the order unless it broke down.
            orders.send(order).ok();
        }
    }
}

impl Drop for Recovery {
    /// Waits until the last order is carried out: a session that a breakdown takes away is on disk then.
    fn drop(&mut self) {
        self.orders = None;
        if let Some(thread) = self.thread.take() {
            thread.join().ok();
        }
    }
}

/// A copy that is offered, with its lock.
#[derive(Debug)]
struct Offered {
    recoverable: Recoverable,
    _lock: Option<File>,
}

/// This program's pair of files.
#[derive(Debug)]
struct Pair {
    copy: PathBuf,
    lock_path: PathBuf,
    _lock: File,
}

/// The thread's state.
struct Keeper<Tell> {
    settings: RecoverySettings,
    tell: Tell,
    pair: Option<Pair>,
    /// What is not on disk yet.
    waiting: Option<Snapshot>,
    /// What is.
    kept: Option<Arc<Session>>,
    last_attempt: Option<Instant>,
    has_failed: bool,
    offered: Vec<Offered>,
}

impl<Tell: Fn(News)> Keeper<Tell> {
    const fn new(settings: RecoverySettings, tell: Tell) -> Self {
        Self {
            settings,
            tell,
            pair: None,
            waiting: None,
            kept: None,
            last_attempt: None,
            has_failed: false,
            offered: Vec::new(),
        }
    }

    fn run(mut self, orders: &Receiver<Order>) {
        self.find_offers();
        loop {
            let order = match self.time_to_write(Instant::now()) {
                Some(Duration::ZERO) => {
                    self.write();
                    continue;
                }
                Some(wait) => orders.recv_timeout(wait),
                None => orders.recv().map_err(|_| RecvTimeoutError::Disconnected),
            };
            match order {
                Ok(order) => self.carry_out(order),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
        // The workbench is gone, and whatever it had not saved or given up is kept.
        self.write();
        if self.kept.is_none() {
            self.forget();
        }
    }

    /// How long the newest state may wait, if there is one to be written. The first edit is written at once.
    fn time_to_write(&self, now: Instant) -> Option<Duration> {
        self.waiting.as_ref()?;
        let pause = if self.has_failed { self.settings.interval.max(INTERVAL) } else { self.settings.interval };
        let next = self.last_attempt.map_or(now, |last| last + pause);
        Some(next.saturating_duration_since(now))
    }

    fn carry_out(&mut self, order: Order) {
        match order {
            Order::Keep(snapshot) => {
                let is_kept = self.kept.as_ref().is_some_and(|kept| Arc::ptr_eq(kept, &snapshot.session));
                self.waiting = (!is_kept).then_some(snapshot);
            }
            Order::Forget => self.forget(),
            Order::Read(file) => {
                let outcome = Box::new(read(&file));
                (self.tell)(News::Read { file, outcome });
            }
            Order::Discard(file) => self.discard(&file),
        }
    }

    fn write(&mut self) {
        let Some(snapshot) = self.waiting.take() else { return };
        let outcome = self.make_pair().and_then(|copy| {
            let origin = Origin { written_at: SystemTime::now(), ..snapshot.origin.clone() };
            format::replace_file(&copy, to_json(&snapshot.session, &origin).as_bytes())
        });
        self.last_attempt = Some(Instant::now());
        match outcome {
            Ok(_) => {
                self.kept = Some(snapshot.session);
                self.has_failed = false;
                (self.tell)(News::Kept);
            }
            Err(error) => {
                // It is tried again, unless there is a newer state by then. Disks stay full for a while: it is told once.
                self.waiting = Some(snapshot);
                if !std::mem::replace(&mut self.has_failed, true) {
                    let problem = crate::session::error::system_words(&error);
                    (self.tell)(News::NotKept { folder: self.settings.folder.clone(), problem });
                }
            }
        }
    }

    /// This program's copy; its lock is taken with the first one.
    fn make_pair(&mut self) -> io::Result<PathBuf> {
        if let Some(pair) = &self.pair {
            return Ok(pair.copy.clone());
        }
        fs::create_dir_all(&self.settings.folder)?;
        let start = unix_ms(SystemTime::now());
        // A program that looks for copies may take the new lock for one left behind, and even remove it: then another.
        for attempt in 0..100 {
            let stem = format!("{start}-{}-{attempt}", process::id());
            let lock_path = self.settings.folder.join(&stem).with_extension(LOCK_EXTENSION);
            let lock = match OpenOptions::new().write(true).create_new(true).open(&lock_path) {
                Ok(lock) => lock,
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => continue,
                Err(error) => return Err(error),
            };
            if matches!(lock.try_lock(), Err(TryLockError::WouldBlock)) || !lock_path.exists() {
                continue;
            }
            let copy = self.settings.folder.join(&stem).with_extension(COPY_EXTENSION);
            self.pair = Some(Pair { copy: copy.clone(), lock_path, _lock: lock });
            return Ok(copy);
        }
        Err(io::Error::from(io::ErrorKind::AlreadyExists))
    }

    /// The copy goes first: one without a lock would be offered, a lock without a copy is nothing.
    fn forget(&mut self) {
        self.waiting = None;
        self.kept = None;
        if let Some(pair) = self.pair.take() {
            let _ = fs::remove_file(&pair.copy);
            let _ = fs::remove_file(&pair.lock_path);
        }
    }

    /// What was recovered is given up only once it is on disk anew.
    fn discard(&mut self, file: &Path) {
        self.write();
        if self.waiting.is_some() {
            return;
        }
        self.offered.retain(|offered| {
            let is_it = offered.recoverable.file == file;
            if is_it {
                let _ = fs::remove_file(file);
                let _ = fs::remove_file(file.with_extension(LOCK_EXTENSION));
            }
            !is_it
        });
        self.tell_offers();
    }

    fn find_offers(&mut self) {
        let Ok(entries) = fs::read_dir(&self.settings.folder) else { return };
        whole_file::sweep(&self.settings.folder);
        let has_extension = |path: &Path, wanted: &str| path.extension().is_some_and(|found| found == wanted);
        let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
        paths.sort_unstable();
        for lock_path in paths.iter().filter(|path| has_extension(path, LOCK_EXTENSION)) {
            // Of a program that saved and was killed right then.
            if !lock_path.with_extension(COPY_EXTENSION).exists()
                && let Ok(lock) = OpenOptions::new().write(true).open(lock_path)
                && lock.try_lock().is_ok()
            {
                let _ = fs::remove_file(lock_path);
            }
        }
        for file in paths.into_iter().filter(|path| has_extension(path, COPY_EXTENSION)) {
            let lock_path = file.with_extension(LOCK_EXTENSION);
            let lock = OpenOptions::new().write(true).create(true).truncate(false).open(lock_path).ok();
            let is_alive = lock.as_ref().is_some_and(|lock| matches!(lock.try_lock(), Err(TryLockError::WouldBlock)));
            if !is_alive {
                let origin = read(&file).map(|(_, origin)| origin);
                self.offered.push(Offered { recoverable: Recoverable { file, origin }, _lock: lock });
            }
        }
        if !self.offered.is_empty() {
            self.tell_offers();
        }
    }

    fn tell_offers(&self) {
        (self.tell)(News::Found(self.offered.iter().map(|offered| offered.recoverable.clone()).collect()));
    }
}

/// The session's file with one more field.
fn to_json(session: &Session, origin: &Origin) -> String {
    let mut copy = session.clone();
    copy.unknown.insert(
        FIELD.to_owned(),
        json!({
            "title": origin.title,
            "path": origin.path.as_deref().and_then(Path::to_str),
            "written_at_unix_ms": unix_ms(origin.written_at),
            "num_edits": origin.num_edits,
            "last_edit": origin.last_edit,
            "file": origin.stamp.as_ref().map(Stamp::to_json),
        }),
    );
    crate::session::to_json(&copy)
}

/// A copy, and what it is a copy of. One without that field is a session all the same.
fn read(file: &Path) -> Result<(Session, Origin), SessionError> {
    let mut session = crate::session::load(file)?;
    let field = match session.unknown.shift_remove(FIELD) {
        Some(Value::Object(field)) => field,
        _ => Map::new(),
    };
    let text = |name: &str| field.get(name).and_then(Value::as_str).map(str::to_owned);
    let number = |name: &str| field.get(name).and_then(Value::as_u64).unwrap_or_default();
    let origin = Origin {
        title: text("title").unwrap_or_else(|| session.name.clone()),
        path: text("path").map(PathBuf::from),
        written_at: SystemTime::UNIX_EPOCH + Duration::from_millis(number("written_at_unix_ms")),
        num_edits: usize::try_from(number("num_edits")).unwrap_or(usize::MAX),
        last_edit: text("last_edit"),
        stamp: field.get("file").and_then(Stamp::from_json),
    };
    Ok((session, origin))
}
