//! `handeye import`: poses and profiles from elsewhere into a session file.

mod bag;

use std::fmt::Write as _;
use std::io::Read as _;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::ValueEnum;

use crate::calibrate::Mount;
use crate::geometry::notation::{AngleUnit, LengthUnit, OrientationForm};
use crate::geometry::{PoseConvention, PoseNotation, Tcp, Transform};
use crate::session::import::{
    BagOptions, ImportError, ImportOptions, Imported, Kind, MAX_FILE_BYTES, Part, Role, Separator, Source, read,
    read_paths, with_stations,
};
use crate::session::{Edit, EditRefusal, Session, SetupField, Target, load, save};
use crate::text::import_cli as text;
use crate::watch::Unwatched;

use super::{EXIT_WRONG_INPUT, fail};
use crate::text::import_bag as bag_text;
pub use bag::BagArgs;

/// Arguments of `handeye import`.
#[derive(Clone, Debug, clap::Args)]
pub struct ImportArgs {
    /// Files and folders; `-` is the standard input.
    #[arg(required = true, value_name = "PATH")]
    pub paths: Vec<PathBuf>,
    /// The session file to write.
    #[arg(long, value_name = "FILE", required_unless_present = "list_topics")]
    pub out: Option<PathBuf>,
    /// Overwrite it.
    #[arg(long)]
    pub force: bool,
    /// Add the stations to those of this session file.
    #[arg(long, value_name = "SESSION", conflicts_with_all = ["name", "target", "radius_mm"])]
    pub append_to: Option<PathBuf>,
    /// Leave out what cannot be read.
    #[arg(long)]
    pub skip_problems: bool,
    /// The session's name; the first file's if none is given.
    #[arg(long)]
    pub name: Option<String>,
    /// What was measured; if nothing is said a plate where the poses have an edge each, a pose where they have the
    /// target's, else a ball.
    #[arg(long, value_enum)]
    pub target: Option<TargetArg>,
    /// The ball's radius, mm.
    #[arg(long)]
    pub radius_mm: Option<f64>,
    /// The sensor stands beside the robot, and the target is on the flange.
    #[arg(long, conflicts_with = "append_to")]
    pub fixed: bool,
    /// How the input is to be read.
    #[command(flatten)]
    pub reading: ReadingArgs,
    /// How bags are to be read.
    #[command(flatten)]
    pub bag: BagArgs,
}

/// How the input is to be read; what is not said is recognised.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct ReadingArgs {
    /// What the file with the poses is.
    #[arg(long, value_enum)]
    pub kind: Option<KindArg>,
    /// Between the cells of a table.
    #[arg(long, value_enum)]
    pub separator: Option<SeparatorArg>,
    /// 1,5 is one and a half.
    #[arg(long)]
    pub decimal_comma: bool,
    /// What the columns are: x,y,z,a,b,c (angles) or q1,q2,q3,q4, px,py,pz, tx,ty,tz and t1 to t4 (the target's
    /// pose), label, side, edge, use, step, profile, notation, - for none.
    #[arg(long, value_parser = columns, value_name = "LIST")]
    pub columns: Option<Columns>,
    /// How three angles are written, as `pose_convention` of session files, e.g. kuka-abc.
    #[arg(long, value_parser = convention, value_name = "ID")]
    pub notation: Option<&'static PoseConvention>,
    /// Unit of the angles.
    #[arg(long, value_enum)]
    pub angle_unit: Option<AngleUnitArg>,
    /// Unit of the positions.
    #[arg(long, value_enum)]
    pub length_unit: Option<LengthUnitArg>,
    /// The orientation is a quaternion of this order.
    #[arg(long, value_enum, conflicts_with = "notation")]
    pub quaternion: Option<QuaternionArg>,
    /// The frame that the positions are in: six numbers as the poses are written.
    #[arg(long, value_parser = six_numbers, allow_hyphen_values = true, value_name = "n,n,n,n,n,n")]
    pub base_from_user_frame: Option<SixNumbers>,
    /// The tool point that the poses are of: six numbers as the poses are written.
    #[arg(long, value_parser = six_numbers, allow_hyphen_values = true, value_name = "n,n,n,n,n,n")]
    pub flange_from_tcp: Option<SixNumbers>,
    /// The poses are those of the base in the flange.
    #[arg(long)]
    pub inverse: bool,
    /// Unit of the profiles.
    #[arg(long, value_enum)]
    pub profile_unit: Option<LengthUnitArg>,
    /// z of the profiles points the other way.
    #[arg(long)]
    pub mirror_z: bool,
}

/// What was measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TargetArg {
    /// A ball.
    Ball,
    /// Two perpendicular edges.
    Plate,
    /// A tip or pin.
    Point,
    /// A part that was scanned.
    Workpiece,
    /// A marker or board whose whole pose was seen.
    Pose,
}

/// What a file is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[expect(missing_docs, reason = "the names say it")]
pub enum KindArg {
    Session,
    Poses,
    Printed,
    Fanuc,
    Abb,
    Kuka,
    Ur,
    Profile,
    ProfileColumns,
    Yaml,
    PosePairs,
}

/// What separates the cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[expect(missing_docs, reason = "the names say it")]
pub enum SeparatorArg {
    Comma,
    Semicolon,
    Tab,
    Blanks,
}

impl From<SeparatorArg> for Separator {
    fn from(separator: SeparatorArg) -> Self {
        match separator {
            SeparatorArg::Comma => Self::Comma,
            SeparatorArg::Semicolon => Self::Semicolon,
            SeparatorArg::Tab => Self::Tab,
            SeparatorArg::Blanks => Self::Blanks,
        }
    }
}

/// Unit of angles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[expect(missing_docs, reason = "the names say it")]
pub enum AngleUnitArg {
    Deg,
    Rad,
}

/// Unit of lengths.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[expect(missing_docs, reason = "the names say it")]
pub enum LengthUnitArg {
    Mm,
    M,
}

impl From<LengthUnitArg> for LengthUnit {
    fn from(unit: LengthUnitArg) -> Self {
        match unit {
            LengthUnitArg::Mm => Self::Millimetres,
            LengthUnitArg::M => Self::Metres,
        }
    }
}

/// Order of the parts of a quaternion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[expect(missing_docs, reason = "the names say it")]
pub enum QuaternionArg {
    Wxyz,
    Xyzw,
}

/// The columns of a table, one word each.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Columns(Vec<Role>);

/// A frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SixNumbers([f64; 6]);

fn columns(list: &str) -> Result<Columns, String> {
    let role = |word: &str| {
        Ok(match word.trim().to_lowercase().as_str() {
            "-" | "" => Role::Ignore,
            "x" => Role::Position(0),
            "y" => Role::Position(1),
            "z" => Role::Position(2),
            "a" | "w" | "rx" | "q1" => Role::Orientation(0),
            "b" | "p" | "ry" | "q2" => Role::Orientation(1),
            "c" | "r" | "rz" | "q3" => Role::Orientation(2),
            "q4" => Role::Orientation(3),
            "px" => Role::Point(0),
            "py" => Role::Point(1),
            "pz" => Role::Point(2),
            "tx" => Role::Target(0),
            "ty" => Role::Target(1),
            "tz" => Role::Target(2),
            "t1" => Role::Target(3),
            "t2" => Role::Target(4),
            "t3" => Role::Target(5),
            "t4" => Role::Target(6),
            "label" => Role::Label,
            "side" => Role::Side,
            "edge" => Role::Edge,
            "use" => Role::Used,
            "step" => Role::Step,
            "profile" => Role::Profile,
            "notation" => Role::Notation,
            other => {
                return Err(format!(
                    "found {other}, expected x, y, z, a, b, c, q1 to q4, px, py, pz, tx, ty, tz, t1 to t4, label, side, edge, use, step, profile, notation or -"
                ));
            }
        })
    };
    list.split(',').map(role).collect::<Result<_, _>>().map(Columns)
}

fn convention(id: &str) -> Result<&'static PoseConvention, String> {
    PoseConvention::by_id(id)
        .ok_or_else(|| format!("found {id}, expected the name of a convention such as fanuc-wpr or kuka-abc"))
}

fn six_numbers(list: &str) -> Result<SixNumbers, String> {
    let numbers: Vec<f64> = list.split(',').filter_map(|number| number.trim().parse().ok()).collect();
    let numbers: Option<[f64; 6]> = numbers.try_into().ok();
    numbers
        .filter(|numbers| numbers.iter().all(|number| number.is_finite()) && list.split(',').count() == 6)
        .map(SixNumbers)
        .ok_or_else(|| format!("found {list}, expected six numbers with commas between them"))
}

impl ReadingArgs {
    /// What can be said before anything is recognised.
    fn options(&self) -> ImportOptions {
        ImportOptions {
            kind: self.kind.map(|kind| match kind {
                KindArg::Session => Kind::Session,
                KindArg::Poses => Kind::PoseTable,
                KindArg::Printed => Kind::PrintedTable,
                KindArg::Fanuc => Kind::FanucProgram,
                KindArg::Abb => Kind::AbbModule,
                KindArg::Kuka => Kind::KukaProgram,
                KindArg::Ur => Kind::UrScript,
                KindArg::Profile => Kind::Profile,
                KindArg::ProfileColumns => Kind::ProfileColumns,
                KindArg::Yaml => Kind::Yaml,
                KindArg::PosePairs => Kind::PosePairs,
            }),
            separator: self.separator.map(Separator::from),
            decimal_comma: self.decimal_comma.then_some(true),
            has_header: None,
            roles: self.columns.as_ref().map(|columns| columns.0.clone()),
            notation: None,
            base_from_user_frame: self.base_from_user_frame.map(|numbers| numbers.0),
            profile_length_unit: self.profile_unit.map(LengthUnit::from),
            is_z_mirrored: self.mirror_z,
            bag: BagOptions::default(),
        }
    }

    /// The recognised notation with what the arguments say otherwise; `None` if they say nothing.
    fn notation(&self, recognised: &PoseNotation) -> Option<PoseNotation> {
        let mut notation = *recognised;
        if let Some(convention) = self.notation {
            notation.convention = convention;
        }
        match self.quaternion {
            Some(QuaternionArg::Wxyz) => notation.orientation = OrientationForm::QuaternionWxyz,
            Some(QuaternionArg::Xyzw) => notation.orientation = OrientationForm::QuaternionXyzw,
            None => {}
        }
        match self.angle_unit {
            Some(AngleUnitArg::Deg) => notation.angle_unit = AngleUnit::Degrees,
            Some(AngleUnitArg::Rad) => notation.angle_unit = AngleUnit::Radians,
            None => {}
        }
        if let Some(unit) = self.length_unit {
            notation.length_unit = unit.into();
        }
        if let Some(SixNumbers(numbers)) = self.flange_from_tcp {
            let angles = PoseNotation {
                orientation: OrientationForm::Angles,
                flange_from_tcp: None,
                is_inverse: false,
                ..notation
            };
            let frame = angles.base_from_flange(&numbers).ok();
            notation.flange_from_tcp = frame.map(|frame| Transform::<_, Tcp>::from_rigid(*frame.rigid()));
        }
        notation.is_inverse |= self.inverse;
        (notation != *recognised).then_some(notation)
    }
}

/// Imports and writes the session.
#[must_use]
pub fn run(args: &ImportArgs) -> ExitCode {
    match import(args) {
        Ok(said) => match super::print(&said) {
            Ok(()) => ExitCode::SUCCESS,
            Err(exit_code) => exit_code,
        },
        Err(message) => fail(EXIT_WRONG_INPUT, &message),
    }
}

/// The topics of the bags among the sources.
fn topics(args: &ImportArgs) -> Result<String, String> {
    let sources = sources(args).map_err(|error| error.to_string())?;
    let bags = sources.iter().filter_map(|source| Some(bag_text::topics(&source.name, source.bag()?)));
    let listed: String = bags.collect();
    if listed.is_empty() { Err(text::no_bag(sources.first().map_or("-", |source| &source.name))) } else { Ok(listed) }
}

fn import(args: &ImportArgs) -> Result<String, String> {
    let Some(out_path) = args.out.as_ref().filter(|_| !args.bag.list_topics) else { return topics(args) };
    let out = out_path.display().to_string();
    let is_own = args.append_to.as_ref() == Some(out_path);
    if out_path.exists() && !args.force && !is_own {
        return Err(text::out_exists(&out));
    }
    let sources = sources(args).map_err(|error| error.to_string())?;
    let options = ImportOptions { bag: args.bag.options(), ..args.reading.options() };
    let imported = read_as_told(&sources, &args.reading, &options).map_err(|error| error.to_string())?;
    if let Some(problem) = imported.problems.first()
        && (!args.skip_problems || imported.stations.is_empty())
    {
        return Err(text::problem_refusal(problem, imported.num_problems - 1));
    }
    if imported.stations.is_empty() && imported.session.is_none() {
        return Err(text::no_stations(sources.first().map_or("-", |source| source.name.as_str())));
    }
    let mut said = listing(&imported);
    let num_without_edge = imported.stations.iter().filter(|station| station.edge.is_none()).count();
    let session = session(args, &sources, imported)?;
    save(&session, out_path).map_err(|error| error.to_string())?;
    if session.target == Target::RightAnglePlate && num_without_edge > 0 {
        said.push_str(&text::edges_missing_line(num_without_edge));
    }
    said.push_str(&text::imported_line(&out, session.stations.len(), session.num_captures()));
    Ok(said)
}

fn sources(args: &ImportArgs) -> Result<Vec<Source>, ImportError> {
    let mut sources = Vec::new();
    for path in &args.paths {
        if path.as_os_str() == "-" {
            let mut bytes = Vec::new();
            let read = std::io::stdin().take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes);
            let problem = |problem: String| ImportError::Unreadable { file: "-".to_owned(), problem };
            let found_bytes = read.map_err(|error| problem(error.to_string()))? as u64;
            if found_bytes > MAX_FILE_BYTES {
                let limit_bytes = MAX_FILE_BYTES;
                return Err(ImportError::TooLarge { file: "-".to_owned(), found_bytes, limit_bytes });
            }
            sources.push(Source::from_bytes("-".to_owned(), bytes));
        } else {
            sources.extend(read_paths(std::slice::from_ref(path))?);
        }
    }
    Ok(sources)
}

/// Reads once to recognise, and again where the arguments say otherwise.
fn read_as_told(sources: &[Source], args: &ReadingArgs, options: &ImportOptions) -> Result<Imported, ImportError> {
    let fallback = args.notation.map_or_else(PoseNotation::default, PoseNotation::of);
    let imported = read(sources, options, &fallback, &mut Unwatched)?;
    let recognised = imported.options.notation.unwrap_or(fallback);
    let Some(notation) = args.notation(&recognised) else { return Ok(imported) };
    // One notation is then that of all poses, so it must be the same whichever source it was recognised in.
    let mut with_poses = imported.parts.iter().filter_map(|part| Some((part, part.notation?)));
    let wanted = |recognised: &PoseNotation| args.notation(recognised).unwrap_or(*recognised);
    if let Some((other, _)) = with_poses.find(|(_, recognised)| wanted(recognised) != notation) {
        let mut parts =
            imported.parts.iter().filter(|part| part.notation.is_some_and(|found| wanted(&found) == notation));
        let name = |part: &Part| part.name.clone();
        let first = parts.next().map(name).unwrap_or_default();
        return Err(ImportError::SeveralNotations { first, other: name(other) });
    }
    read(sources, &ImportOptions { notation: Some(notation), ..options.clone() }, &fallback, &mut Unwatched)
}

fn listing(imported: &Imported) -> String {
    let mut listing = String::new();
    for part in &imported.parts {
        listing.push_str(&text::part_line(part));
    }
    listing.push_str(&text::options_line(&imported.options));
    for note in &imported.notes {
        listing.push_str(&text::note_line(note));
    }
    for problem in &imported.problems {
        // Writing to a string cannot fail.
        let _ = write!(listing, "{}", text::left_out_line(problem));
    }
    if imported.num_problems > imported.problems.len() {
        listing.push_str(&text::more_left_out_line(imported.num_problems - imported.problems.len()));
    }
    listing
}

fn session(args: &ImportArgs, sources: &[Source], imported: Imported) -> Result<Session, String> {
    let session = session_as_read(args, sources, imported)?;
    Ok(if args.fixed { Session { mount: Mount::Fixed, ..session } } else { session })
}

fn session_as_read(args: &ImportArgs, sources: &[Source], imported: Imported) -> Result<Session, String> {
    if let Some(path) = &args.append_to {
        let session = load(path).map_err(|error| error.to_string())?;
        return with_stations(&session, imported.stations).map_err(|refusal| refusal.to_string());
    }
    let target = match (args.target, args.radius_mm) {
        (None | Some(TargetArg::Ball), Some(radius_mm)) => Some(Target::ball(radius_mm)),
        (Some(TargetArg::Plate | TargetArg::Point | TargetArg::Workpiece | TargetArg::Pose), Some(_)) => {
            return Err(text::RADIUS_OF_NO_BALL.to_owned());
        }
        (Some(TargetArg::Plate), None) => Some(Target::RightAnglePlate),
        (Some(TargetArg::Point), None) => Some(Target::Point),
        (Some(TargetArg::Workpiece), None) => Some(Target::Workpiece),
        (Some(TargetArg::Pose), None) => Some(Target::pose()),
        // A session says itself what was measured.
        (None, None) if imported.session.is_some() => None,
        // Nothing else has whole poses, and nothing else edges.
        (None, None) if imported.has_target_poses() => Some(Target::pose()),
        (None, None) if imported.has_edges() => Some(Target::RightAnglePlate),
        (None | Some(TargetArg::Ball), None) => return Err(text::RADIUS_MISSING.to_owned()),
    };
    if imported.has_edges() && target != Some(Target::RightAnglePlate) {
        return Err(text::EDGES_OF_NO_PLATE.to_owned());
    }
    let refused = |refusal: EditRefusal| refusal.to_string();
    if imported.session.is_some() {
        let name = args.name.clone().map(SetupField::Name);
        let fields = name.into_iter().chain(target.map(SetupField::Target));
        let session = imported.into_session(String::new(), Target::Point).map_err(refused)?;
        return Edit::Several(fields.map(Edit::Setup).collect()).apply(&session).map_err(refused);
    }
    let first = sources.first().map_or("", |source| source.name.as_str());
    let name = args.name.clone().unwrap_or_else(|| first.rsplit_once('.').map_or(first, |(stem, _)| stem).to_owned());
    imported.into_session(name, target.unwrap_or(Target::Point)).map_err(refused)
}
