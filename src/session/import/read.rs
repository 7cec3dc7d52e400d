//! All sources together: recognised, read one after the other, and put together.

use std::sync::Arc;

use crate::geometry::PoseNotation;
use crate::session::{Edit, EditRefusal, Reading, parse};
use crate::sheet::text::{excerpt, without_mark};
use crate::watch::{Cancelled, Watch};

use super::gather::Gathered;
use super::profiles::{self, NamedProfile};
use super::recognise::{Recognised, recognise};
use super::{
    Bag, ImportError, ImportOptions, Imported, Kind, Note, Part, Preview, Source, abb, bag, fanuc, kuka, matching,
    printed, table, ur,
};

/// How far the import is, for those who wait for it.
pub(super) struct Progress<'w> {
    watch: &'w mut dyn Watch,
    done: usize,
    total: usize,
}

impl Progress<'_> {
    /// Asks whether to go on; called every few hundred rows.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn tick(&mut self) -> Result<(), Cancelled> {
        self.watch.report(self.done, self.total)
    }

    /// The same within a source that takes long.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn tick_within(&mut self, done: usize, total: usize) -> Result<(), Cancelled> {
        self.watch.report(done.min(total), total)
    }
}

/// Reads sources; see [`super::read()`].
pub(super) fn read(
    sources: &[Source],
    options: &ImportOptions,
    notation: &PoseNotation,
    watch: &mut dyn Watch,
) -> Result<Imported, ImportError> {
    let mut progress = Progress { watch, done: 0, total: sources.len() };
    progress.tick()?;
    let mut reading = Import::new(options, notation);
    // What the options say is meant for the first source with poses; others speak for themselves.
    let others = ImportOptions {
        notation: options.notation,
        base_from_user_frame: options.base_from_user_frame,
        profile_length_unit: options.profile_length_unit,
        is_z_mirrored: options.is_z_mirrored,
        bag: options.bag.clone(),
        ..ImportOptions::default()
    };
    let main_idx = main_source(sources, notation);
    for (idx, source) in sources.iter().enumerate() {
        progress.done = idx;
        progress.tick()?;
        let is_main = idx == main_idx;
        let options = if is_main { options } else { &others };
        if let Some(bag) = source.bag() {
            reading.take_bag(source, bag, options, is_main, &mut progress)?;
            continue;
        }
        let text = without_mark(source.text());
        match recognise(&source.name, text, options.kind, options, notation) {
            Some(recognised) => reading.take(source, text, recognised, options, is_main, &mut progress)?,
            None => reading.not_recognised.push(source.name.clone()),
        }
    }
    reading.finish(sources)
}

/// The first source with poses, else the first of all.
fn main_source(sources: &[Source], notation: &PoseNotation) -> usize {
    if sources.len() < 2 {
        return 0;
    }
    let options = ImportOptions::default();
    let has_poses = |source: &Source| {
        let text = without_mark(source.text());
        source.bag().is_some()
            || recognise(&source.name, text, None, &options, notation).is_some_and(|recognised| recognised.has_poses())
    };
    sources.iter().position(has_poses).unwrap_or_default()
}

struct Import<'o> {
    fallback: &'o PoseNotation,
    imported: Imported,
    gathered: Gathered,
    profiles: Vec<NamedProfile>,
    has_profile_columns: bool,
    not_recognised: Vec<String>,
}

impl<'o> Import<'o> {
    fn new(options: &ImportOptions, fallback: &'o PoseNotation) -> Self {
        Self {
            fallback,
            imported: Imported {
                options: options.clone(),
                parts: Vec::new(),
                preview: Preview::default(),
                stations: Vec::new(),
                problems: Vec::new(),
                num_problems: 0,
                notes: Vec::new(),
                published: None,
                session: None,
            },
            gathered: Gathered::new(options.notation.unwrap_or(*fallback)),
            profiles: Vec::new(),
            has_profile_columns: false,
            not_recognised: Vec::new(),
        }
    }

    fn take(
        &mut self,
        source: &Source,
        text: &str,
        recognised: Recognised,
        options: &ImportOptions,
        is_main: bool,
        progress: &mut Progress<'_>,
    ) -> Result<(), ImportError> {
        let kind = recognised.kind();
        self.gathered.begin_source(&source.name);
        let poses_before = self.gathered.num_poses();
        let readings_before = self.profiles.len() + self.gathered.num_points();
        let mut preview = Preview::default();
        let mut filled = ImportOptions { kind: Some(kind), ..options.clone() };
        match recognised {
            Recognised::Session => self.take_session(source, text)?,
            Recognised::Printed(tables) => {
                let notation = options.notation.unwrap_or_else(|| printed::notation(self.fallback));
                self.gathered.set_notation(notation, options.base_from_user_frame, None);
                let published = printed::read(source, &tables, &mut self.gathered, &mut preview);
                self.imported.published = self.imported.published.take().or(published);
                filled.notation = Some(notation);
            }
            Recognised::PosePairs(pairs) => {
                let notation = pairs.notation(self.fallback);
                self.gathered.set_notation(notation, None, None);
                pairs.read(source, &mut self.gathered, &mut preview);
                filled.notation = Some(notation);
            }
            Recognised::Yaml(document) => {
                if document.has_poses() {
                    let notation = options.notation.unwrap_or_else(|| document.notation(self.fallback));
                    self.gathered.set_notation(notation, options.base_from_user_frame, None);
                    filled.notation = Some(notation);
                }
                let read = document.read(source, options, &mut self.gathered, &mut preview, progress)?;
                self.profiles.extend(read);
            }
            Recognised::Program(kind) => {
                let mut own_frame = None;
                let recognised = match kind {
                    Kind::AbbModule => {
                        let frames = abb::frames(text);
                        own_frame = frames.base_from_user;
                        abb::notation(&frames, self.fallback)
                    }
                    Kind::KukaProgram => kuka::notation(self.fallback),
                    Kind::UrScript => ur::notation(text, self.fallback),
                    _ => fanuc::notation(self.fallback),
                };
                let notation = options.notation.unwrap_or(recognised);
                self.gathered.set_notation(notation, options.base_from_user_frame, own_frame);
                let read = match kind {
                    Kind::AbbModule => abb::read,
                    Kind::KukaProgram => kuka::read,
                    Kind::UrScript => ur::read,
                    _ => fanuc::read,
                };
                read(source, text, &mut self.gathered, &mut preview, progress)?;
                filled.notation = Some(notation);
                filled.base_from_user_frame = self.gathered.user_frame_numbers();
            }
            Recognised::Table(Kind::PoseTable, layout, columns) => {
                let notation = options.notation.unwrap_or_else(|| table::notation(&layout, &columns, self.fallback));
                self.gathered.set_notation(notation, options.base_from_user_frame, None);
                table::read(source, text, &layout, &columns, &mut self.gathered, &mut preview, progress)?;
                filled = ImportOptions {
                    separator: Some(layout.separator),
                    decimal_comma: Some(layout.has_decimal_comma),
                    has_header: Some(columns.has_header),
                    roles: Some(columns.roles),
                    notation: Some(notation),
                    ..filled
                };
            }
            Recognised::Table(_, layout, _) => {
                let has_columns = kind == Kind::ProfileColumns;
                let read = profiles::read(source, text, &layout, has_columns, options, &mut self.gathered, progress)?;
                self.profiles.extend(read);
                self.has_profile_columns |= has_columns;
                filled.separator = Some(layout.separator);
                filled.decimal_comma = Some(layout.has_decimal_comma);
                filled.profile_length_unit = profiles::length_unit(&layout, has_columns, options);
                preview.header.clone_from(layout.header.as_ref().unwrap_or(&Vec::new()));
            }
        }
        let num_readings = self.profiles.len() + self.gathered.num_points() - readings_before;
        self.end_part(source, kind, poses_before, num_readings, (filled, preview), is_main);
        Ok(())
    }

    /// A bag gives poses together with their profiles.
    fn take_bag(
        &mut self,
        source: &Source,
        bag: &Bag,
        options: &ImportOptions,
        is_main: bool,
        progress: &mut Progress<'_>,
    ) -> Result<(), ImportError> {
        self.gathered.begin_source(&source.name);
        let poses_before = self.gathered.num_poses();
        let mut preview = Preview::default();
        let mut filled = ImportOptions { kind: Some(Kind::RosBag), ..options.clone() };
        let (gathered, fallback) = (&mut self.gathered, self.fallback);
        let report = bag::read(&source.name, bag, &mut filled, fallback, gathered, &mut preview, progress)?;
        let num_readings = report.num_profiles;
        gathered.notes.push(Note::Bag(Box::new(report)));
        self.end_part(source, Kind::RosBag, poses_before, num_readings, (filled, preview), is_main);
        Ok(())
    }

    /// Lists a source with what it gave; the preview is that of the first with poses.
    fn end_part(
        &mut self,
        source: &Source,
        kind: Kind,
        poses_before: usize,
        num_readings: usize,
        (filled, preview): (ImportOptions, Preview),
        is_main: bool,
    ) {
        let num_poses = self.gathered.num_poses() - poses_before;
        let notation = filled.notation.filter(|_| num_poses > 0);
        if is_main {
            self.imported.options = filled;
            self.imported.preview = preview;
        }
        self.imported.parts.push(Part { name: source.name.clone(), kind, num_poses, num_readings, notation });
    }

    /// A session of ours: the first is the one, the stations of others are added to it.
    fn take_session(&mut self, source: &Source, text: &str) -> Result<(), ImportError> {
        let session = parse(text.as_bytes(), &source.name)?;
        self.imported.session = Some(Box::new(match self.imported.session.take() {
            None => session,
            Some(first) => {
                let edit = Edit::InsertStations { at: usize::MAX, stations: session.stations };
                let refused = |refusal: EditRefusal| ImportError::NotAdded {
                    file: source.name.clone(),
                    problem: refusal.to_string(),
                };
                edit.apply(&first).map_err(refused)?
            }
        }));
        Ok(())
    }

    fn finish(self, sources: &[Source]) -> Result<Imported, ImportError> {
        let Self { mut imported, mut gathered, profiles, has_profile_columns, not_recognised, .. } = self;
        let first_name = || sources.first().map(|source| source.name.clone()).unwrap_or_default();
        if imported.parts.is_empty() {
            let text = sources.first().map_or("", |source| without_mark(source.text()).trim());
            let line = excerpt(text.lines().next().unwrap_or_default());
            let found = if line.is_empty() { "nothing".to_owned() } else { format!("\"{line}\"") };
            return Err(ImportError::NotRecognised { file: first_name(), found });
        }
        gathered.finish();
        if !profiles.is_empty() {
            let names = matching::assign(
                &mut gathered.stations,
                &gathered.profile_keys,
                &gathered.source_starts,
                profiles,
                has_profile_columns,
            );
            if !names.is_empty() {
                gathered.notes.push(Note::ProfilesWithoutPose { names });
            }
        }
        let without_reading = gathered.num_without_reading();
        if without_reading > 0 {
            gathered.notes.push(Note::PosesWithoutReading { num_poses: without_reading });
        }
        if !not_recognised.is_empty() {
            gathered.notes.push(Note::SourcesLeftOut { names: not_recognised });
        }
        if let Some(published) = &mut imported.published {
            // One row a station: beside stations of other sources it fits no more.
            for rows in [&mut published.target_in_base_mm, &mut published.error_from_first_mm] {
                if rows.len() != gathered.stations.len() {
                    rows.clear();
                }
            }
        }
        imported.stations = gathered.stations;
        imported.problems = gathered.problems;
        imported.num_problems = gathered.num_problems;
        imported.notes = gathered.notes;
        if let Some(session) = &imported.session {
            imported.stations.splice(0..0, session.stations.iter().cloned());
        }
        let has_profiles = imported.parts.iter().any(|part| part.num_readings > 0 && part.num_poses == 0);
        let has_preview = imported.preview.num_rows > 0;
        if imported.stations.is_empty() && !has_profiles && imported.session.is_none() {
            match imported.problems.first() {
                Some(problem) if !has_preview => return Err(ImportError::NothingLeft(problem.clone())),
                Some(_) => {}
                None => {
                    return Err(ImportError::NotRecognised { file: first_name(), found: "no pose".to_owned() });
                }
            }
        }
        Ok(imported)
    }
}

impl Gathered {
    /// Captures that have neither a profile nor a point.
    fn num_without_reading(&self) -> usize {
        let captures = self.stations.iter().flat_map(|station| &station.captures);
        let is_without = |reading: &Reading| match reading {
            Reading::Profile(profile) => Arc::ptr_eq(profile, &self.no_profile),
            Reading::Point(_) | Reading::Pose(_) => false,
        };
        captures.filter(|capture| is_without(&capture.reading)).count()
    }
}
