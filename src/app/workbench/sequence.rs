//! The sequence of an RGB-D session: tracked frame after frame in the background, and looked at one frame at a time.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Instant;

use crate::app::jobs::{JobOutcome, JobWatch, Slot, Wake};
use crate::odometry::align::aligned;
use crate::odometry::{DepthImage, Estimator, Match, OdometryOptions, RgbdFrame};
use crate::session::sequence::{FrameError, FrameRecord, Sequence, SequenceError, SequenceRun, TrackedSequence};
use crate::session::{Session, measure};
use crate::watch::{Cancelled, Watch};

use super::{Results, Workbench};

/// What is asked of a sequence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SequenceCommand {
    /// Shows the pictures of a frame, by its place in the sequence.
    Look(usize),
    /// Tracks the sequence in another way.
    Track(TrackOptions),
}

/// How a sequence is tracked.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrackOptions {
    /// How the motion is estimated.
    pub estimator: Estimator,
    /// Only a frame every so many seconds is used.
    pub period_s: Option<f64>,
}

/// A frame that was tracked, with its points.
#[derive(Clone, Debug, PartialEq)]
pub struct SeenFrame {
    /// What is known of it.
    pub record: FrameRecord,
    /// Corners seen, px.
    pub features: Vec<[f32; 2]>,
    /// Points seen before and now.
    pub matches: Vec<Match>,
}

/// The pictures of a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct FramePictures {
    /// The frame's place in the sequence.
    pub frame_idx: usize,
    /// What the cameras saw; or why it cannot be had.
    pub pictures: Result<(RgbdFrame, DepthImage), FrameError>,
}

/// What a sequence was tracked by, and what came of it.
#[derive(Debug)]
struct Known {
    key: Key,
    tracked: Arc<TrackedSequence>,
}

#[derive(Clone, Debug, PartialEq)]
struct Key {
    folder: PathBuf,
    options: TrackOptions,
}

/// What the worker tells.
enum News {
    Opened(Arc<Sequence>),
    Frame(Box<SeenFrame>),
    Done(Known),
}

/// The sequence on the bench.
#[derive(Debug, Default)]
pub struct SequenceBench {
    options: TrackOptions,
    run: u64,
    sequence: Option<Arc<Sequence>>,
    seen: Vec<SeenFrame>,
    known: Option<Known>,
    news: Option<Receiver<News>>,
    looking: Slot<FramePictures>,
    pictures: Option<Arc<FramePictures>>,
    /// The frame to be looked at once the one under way is there.
    wanted: Option<usize>,
}

/// Points are kept of so many frames; of later ones only what is known of the frame.
const MOST_WITH_POINTS: usize = 5000;

impl SequenceBench {
    /// How it is tracked.
    #[must_use]
    pub const fn options(&self) -> TrackOptions {
        self.options
    }

    /// Another number, another run through a sequence.
    #[must_use]
    pub const fn run(&self) -> u64 {
        self.run
    }

    /// The sequence, once its lists are read.
    #[must_use]
    pub fn sequence(&self) -> Option<&Sequence> {
        self.sequence.as_deref()
    }

    /// The frames that were tracked so far.
    #[must_use]
    pub fn seen(&self) -> &[SeenFrame] {
        &self.seen
    }

    /// All of it, once it was tracked to its end.
    #[must_use]
    pub fn tracked(&self) -> Option<&TrackedSequence> {
        self.known.as_ref().map(|known| &*known.tracked)
    }

    /// The pictures of the frame that was looked at last.
    #[must_use]
    pub const fn pictures(&self) -> Option<&Arc<FramePictures>> {
        self.pictures.as_ref()
    }

    /// The frame that is or will be looked at.
    #[must_use]
    pub fn is_looking_for(&self, frame_idx: usize) -> bool {
        let is_there = self.pictures.as_ref().is_some_and(|pictures| pictures.frame_idx == frame_idx);
        is_there || self.wanted == Some(frame_idx)
    }

    pub(super) const fn is_busy(&self) -> bool {
        self.looking.is_running()
    }

    /// Nothing seen yet, in another run that is tracked in the same way.
    fn begun_anew(&self, news: Option<Receiver<News>>) -> Self {
        Self { options: self.options, run: self.run + 1, news, ..Self::default() }
    }
}

impl Workbench {
    /// The sequence of an RGB-D session.
    #[must_use]
    pub const fn sequence(&self) -> &SequenceBench {
        &self.sequence
    }

    pub(super) fn command_sequence(&mut self, command: SequenceCommand) {
        match command {
            SequenceCommand::Look(frame_idx) => {
                self.sequence.wanted = Some(frame_idx);
                self.look_at_wanted();
            }
            SequenceCommand::Track(options) => {
                if self.sequence.options != options {
                    // They are of the way as it was tracked before.
                    self.report.clear();
                    self.bootstrap.clear();
                    self.comparison.clear();
                }
                self.sequence.options = options;
                self.start_solving();
            }
        }
    }

    /// How the next one is tracked stays as it was chosen.
    pub(super) fn forget_sequence(&mut self) {
        self.sequence = self.sequence.begun_anew(None);
    }

    fn look_at_wanted(&mut self) {
        if self.sequence.looking.is_running() {
            return;
        }
        let Some(sequence) = self.sequence.sequence.clone() else { return };
        let Some(frame_idx) = self.sequence.wanted else { return };
        if frame_idx >= sequence.frames.len() {
            self.sequence.wanted = None;
            return;
        }
        self.sequence.looking.start("look at a frame", &self.wake, move |_| {
            let pictures = sequence.frame(&sequence.frames[frame_idx]).map(|frame| {
                let aligned = aligned(&frame.depth, &sequence.camera);
                (frame, aligned)
            });
            FramePictures { frame_idx, pictures }
        });
    }

    /// Tracks the sequence, then solves what comes of it.
    pub(super) fn start_tracking(&mut self, session: &Arc<Session>, name: &str, path: Option<&Path>, revision: u64) {
        let folder = path.and_then(Path::parent).map(|folder| folder.join(name));
        let key = folder.map(|folder| Key { folder, options: self.sequence.options });
        let known = self.sequence.known.take().filter(|known| Some(&known.key) == key.as_ref());
        let tracked = known.as_ref().map(|known| Arc::clone(&known.tracked));
        let (sender, news) = channel();
        match known {
            Some(known) => {
                self.sequence.news = None;
                self.sequence.known = Some(known);
            }
            None => self.sequence = self.sequence.begun_anew(Some(news)),
        }
        let session = Arc::clone(session);
        let wake = Arc::clone(&self.wake);
        self.solving.start("track", &self.wake, move |watch| {
            let start = Instant::now();
            let sequence = match (tracked, key) {
                (Some(tracked), _) => Some(Ok(tracked)),
                (None, Some(key)) => Some(track(key, &sender, &wake, watch)?),
                (None, None) => None,
            };
            let measured = measure(&session, None, watch)?;
            let measured = match sequence {
                Some(sequence) => measured.with_sequence(sequence),
                None => measured,
            };
            Results::of(&session, Arc::new(measured), revision, start, watch)
        });
    }

    pub(super) fn poll_sequence(&mut self) -> bool {
        let mut changed = false;
        if let Some(receiver) = &self.sequence.news {
            for news in receiver.try_iter() {
                changed = true;
                match news {
                    News::Opened(sequence) => self.sequence.sequence = Some(sequence),
                    News::Frame(frame) => self.sequence.seen.push(*frame),
                    News::Done(known) => self.sequence.known = Some(known),
                }
            }
        }
        if let Some(outcome) = self.sequence.looking.poll() {
            changed = true;
            match outcome {
                JobOutcome::Done(pictures) => {
                    if self.sequence.wanted == Some(pictures.frame_idx) {
                        self.sequence.wanted = None;
                    }
                    self.sequence.pictures = Some(Arc::new(pictures));
                }
                broken => {
                    self.sequence.wanted = None;
                    self.notify_broken("reading a frame", &broken);
                }
            }
        }
        if self.sequence.wanted.is_some() {
            self.look_at_wanted();
        }
        changed
    }
}

/// Goes through a sequence and tells of every frame; or why it cannot be read.
fn track(
    key: Key,
    sender: &Sender<News>,
    wake: &Wake,
    watch: &mut JobWatch,
) -> Result<Result<Arc<TrackedSequence>, SequenceError>, Cancelled> {
    // Nobody listens any more if another sequence is on the bench: then the watch says so too.
    let tell = |news: News| {
        sender.send(news).ok();
        wake();
    };
    let sequence = match Sequence::open(&key.folder) {
        Ok(sequence) => Arc::new(sequence),
        Err(error) => return Ok(Err(error)),
    };
    tell(News::Opened(Arc::clone(&sequence)));
    let TrackOptions { estimator, period_s } = key.options;
    let mut run = SequenceRun::new(&sequence, OdometryOptions { estimator, period_s, ..OdometryOptions::default() });
    loop {
        watch.report(run.records().len(), sequence.frames.len())?;
        let Some(looked) = run.step(&sequence) else { break };
        let Some(record) = run.records().last().cloned() else { break };
        let (features, matches) = match looked {
            Ok(looked) if run.records().len() <= MOST_WITH_POINTS => (looked.outcome.features, looked.outcome.matches),
            _ => (Vec::new(), Vec::new()),
        };
        tell(News::Frame(Box::new(SeenFrame { record, features, matches })));
    }
    let tracked = Arc::new(TrackedSequence::of(sequence, &run));
    tell(News::Done(Known { key, tracked: Arc::clone(&tracked) }));
    Ok(Ok(tracked))
}
