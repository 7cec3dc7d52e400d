//! PLY: the header, and the vertices in text or either binary order.

use std::io::Read as _;

use crate::geometry::Vec3;
use crate::watch::Watch;

use super::{CloudFileError, Gathered, REPORT_EVERY, Refused, Source, WITHIN_LIMIT, said, source_error};

/// A header longer than this is none.
const MOST_HEADER_LINES: u64 = 1000;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Number {
    Int8,
    UInt8,
    Int16,
    UInt16,
    Int32,
    UInt32,
    Float32,
    Float64,
}

impl Number {
    fn by_name(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::Int8,
            "uchar" | "uint8" => Self::UInt8,
            "short" | "int16" => Self::Int16,
            "ushort" | "uint16" => Self::UInt16,
            "int" | "int32" => Self::Int32,
            "uint" | "uint32" => Self::UInt32,
            "float" | "float32" => Self::Float32,
            "double" | "float64" => Self::Float64,
            _ => return None,
        })
    }

    const fn size(self) -> usize {
        match self {
            Self::Int8 | Self::UInt8 => 1,
            Self::Int16 | Self::UInt16 => 2,
            Self::Int32 | Self::UInt32 | Self::Float32 => 4,
            Self::Float64 => 8,
        }
    }

    /// The number in the first bytes, which are as many as its size at least.
    fn read(self, bytes: &[u8], encoding: Encoding) -> f64 {
        let mut ordered = [0; 8];
        let ordered = &mut ordered[..self.size()];
        ordered.copy_from_slice(&bytes[..self.size()]);
        if encoding == Encoding::BigEndian {
            ordered.reverse();
        }
        match *ordered {
            [a] if self == Self::Int8 => f64::from(i8::from_le_bytes([a])),
            [a] => f64::from(a),
            [a, b] if self == Self::Int16 => f64::from(i16::from_le_bytes([a, b])),
            [a, b] => f64::from(u16::from_le_bytes([a, b])),
            [a, b, c, d] if self == Self::Int32 => f64::from(i32::from_le_bytes([a, b, c, d])),
            [a, b, c, d] if self == Self::Float32 => f64::from(f32::from_le_bytes([a, b, c, d])),
            [a, b, c, d] => f64::from(u32::from_le_bytes([a, b, c, d])),
            [a, b, c, d, e, f, g, h] => f64::from_le_bytes([a, b, c, d, e, f, g, h]),
            _ => f64::NAN,
        }
    }
}

/// A list of things in the file; only the vertices are read.
#[derive(Debug)]
struct Element {
    name: String,
    num: u64,
    properties: Vec<(String, Number)>,
    has_list: bool,
}

impl Element {
    fn row_size(&self) -> u64 {
        self.properties.iter().map(|(_, number)| number.size() as u64).sum()
    }

    fn place_of(&self, name: &str) -> Option<usize> {
        self.properties.iter().position(|(property, _)| property == name)
    }
}

/// Reads the vertices of a file whose first line is `ply`.
pub(super) fn read(source: &mut Source, gathered: &mut Gathered, watch: &mut dyn Watch) -> Result<(), CloudFileError> {
    let (encoding, elements) = header(source)?;
    for element in elements {
        let is_vertex = element.name == "vertex";
        if element.has_list {
            let found = format!("a list in the element {}", element.name);
            return Err(source.wrong_line(&found, "vertices before any lists, and none in them"));
        }
        match encoding {
            Encoding::Text => {
                let mut line = Vec::new();
                let places = if is_vertex { Some(Places::of(source, &element)?) } else { None };
                for num in 0..element.num {
                    if !source.next_line(&mut line)? {
                        let found = format!("the end of the file after {num} of {} {}", element.num, element.name);
                        source.line += 1;
                        return Err(source.wrong_line(&found, "as many as the header says"));
                    }
                    if let Some(places) = &places {
                        read_text(source, places, &line, gathered)?;
                        if num % REPORT_EVERY as u64 == 0 {
                            source.report(watch)?;
                        }
                    }
                }
            }
            _ => read_binary(source, &element, encoding, is_vertex, gathered, watch)?,
        }
        if is_vertex {
            return Ok(());
        }
    }
    Err(source.wrong_line("a header without vertices", "\"element vertex\" with a number"))
}

fn header(source: &mut Source) -> Result<(Encoding, Vec<Element>), CloudFileError> {
    let mut line = Vec::new();
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    loop {
        if !source.next_line(&mut line)? {
            return Err(source.wrong_line("the end of the file", "\"end_header\""));
        }
        let text = std::str::from_utf8(&line)
            .map_err(|_| source.wrong_line("bytes that are no text", "a line of a PLY header"))?;
        let words: Vec<&str> = text.split_whitespace().collect();
        let wrong = |expected: &str| Err(source.wrong_line(&said(&line), expected));
        if source.line > MOST_HEADER_LINES {
            return wrong("\"end_header\" long before");
        }
        match *words.as_slice() {
            ["ply"] if source.line == 1 => {}
            ["comment" | "obj_info", ..] | [] => {}
            ["format", name, "1.0"] => {
                encoding = Some(match name {
                    "ascii" => Encoding::Text,
                    "binary_little_endian" => Encoding::LittleEndian,
                    "binary_big_endian" => Encoding::BigEndian,
                    _ => return wrong("ascii, binary_little_endian or binary_big_endian"),
                });
            }
            ["element", name, num] => match num.parse() {
                Ok(num) => {
                    elements.push(Element { name: name.to_owned(), num, properties: Vec::new(), has_list: false });
                }
                Err(_) => return wrong("a number of elements"),
            },
            ["property", "list", _, _, _] => match elements.last_mut() {
                Some(element) => element.has_list = true,
                None => return wrong("an element before its properties"),
            },
            ["property", kind, name] => match (elements.last_mut(), Number::by_name(kind)) {
                (Some(element), Some(number)) => element.properties.push((name.to_owned(), number)),
                (None, _) => return wrong("an element before its properties"),
                (_, None) => return wrong("char, uchar, short, ushort, int, uint, float or double"),
            },
            ["end_header"] => break,
            _ if source.line == 1 => return wrong("\"ply\""),
            _ => return wrong("format, element, property, comment or end_header"),
        }
    }
    match encoding {
        Some(encoding) => Ok((encoding, elements)),
        None => Err(source.wrong_line("a header without a format", "\"format ascii 1.0\" or a binary one")),
    }
}

/// Where the coordinates stand among the properties of a vertex.
struct Places {
    xyz: [usize; 3],
    profile: Option<usize>,
    num: usize,
}

impl Places {
    fn of(source: &Source, element: &Element) -> Result<Self, CloudFileError> {
        let place = |name: &str| {
            let missing = || source.wrong_line(&format!("vertices without {name}"), "the properties x, y and z");
            element.place_of(name).ok_or_else(missing)
        };
        let xyz = [place("x")?, place("y")?, place("z")?];
        Ok(Self { xyz, profile: element.place_of("profile"), num: element.properties.len() })
    }
}

fn read_text(source: &Source, places: &Places, line: &[u8], gathered: &mut Gathered) -> Result<(), CloudFileError> {
    let wrong = || source.wrong_line(&said(line), &format!("{} numbers", places.num));
    let text = std::str::from_utf8(line).map_err(|_| wrong())?;
    let (mut point, mut profile, mut num) = (Vec3::zeros(), 0.0, 0);
    for (place, word) in text.split_ascii_whitespace().enumerate() {
        num += 1;
        let axis = places.xyz.iter().position(|wanted| *wanted == place);
        if axis.is_none() && places.profile != Some(place) {
            continue;
        }
        let value: f64 = word.parse().map_err(|_| wrong())?;
        match axis {
            Some(axis) => point[axis] = value,
            None => profile = value,
        }
    }
    if num != places.num {
        return Err(wrong());
    }
    gathered.take(point, profile_of(profile)).map_err(|refused| match refused {
        Refused::TooFar(found) => source.wrong_line(&found, WITHIN_LIMIT),
        Refused::TooMany(problem) => CloudFileError::TooLarge { file: source.path.clone(), problem },
    })
}

fn read_binary(
    source: &mut Source,
    element: &Element,
    encoding: Encoding,
    is_vertex: bool,
    gathered: &mut Gathered,
    watch: &mut dyn Watch,
) -> Result<(), CloudFileError> {
    let row_size = element.row_size();
    let left = source.size.saturating_sub(source.byte);
    if u128::from(element.num) * u128::from(row_size) > u128::from(left) {
        let found = format!("{left} bytes for {} {} of {row_size} bytes", element.num, element.name);
        return Err(source.wrong_byte(&found, "as many as the header says"));
    }
    let places = if is_vertex { Some(Places::of(source, element)?) } else { None };
    let starts: Vec<usize> =
        element.properties.iter().scan(0, |at, (_, number)| Some(std::mem::replace(at, *at + number.size()))).collect();
    let mut row = vec![0; usize::try_from(row_size).unwrap_or(usize::MAX)];
    let value = |row: &[u8], place: usize| element.properties[place].1.read(&row[starts[place]..], encoding);
    // A row without bytes takes no time to read, however many there are said to be.
    let num_rows = if row_size == 0 { 0 } else { element.num };
    for num in 0..num_rows {
        source.reader.read_exact(&mut row).map_err(|problem| source_error(&source.path, problem))?;
        if let Some(places) = &places {
            let [x, y, z] = places.xyz.map(|place| value(&row, place));
            let profile = places.profile.map_or(0.0, |place| value(&row, place));
            gathered.take(Vec3::new(x, y, z), profile_of(profile)).map_err(|refused| match refused {
                Refused::TooFar(found) => source.wrong_byte(&found, WITHIN_LIMIT),
                Refused::TooMany(problem) => CloudFileError::TooLarge { file: source.path.clone(), problem },
            })?;
            if num % REPORT_EVERY as u64 == 0 {
                source.report(watch)?;
            }
        }
        source.byte += row_size;
    }
    Ok(())
}

/// What is no index of a profile is the first.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the conversion saturates")]
pub(super) const fn profile_of(value: f64) -> u32 {
    value as u32
}
