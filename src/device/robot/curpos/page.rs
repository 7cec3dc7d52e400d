//! The page `CURPOS.DG`: where the robot is, as text for people; pure, in both directions.

use crate::device::error::MessageError;
use crate::device::robot::mappdk::messages::Xyzwpr;

/// Where the page is.
pub const PATH: &str = "/MD/CURPOS.DG";
/// The numbers have two decimals.
pub const RESOLUTION_MM: f64 = 0.01;

/// What the page says of the first group of axes.
#[derive(Clone, Debug, PartialEq)]
pub struct CurposPage {
    /// The active tool.
    pub tool: u8,
    /// The active user frame; not that of [`Self::world`].
    pub frame: u8,
    /// Joint angles, degrees.
    pub joints_deg: Vec<f64>,
    /// The pose of the active tool in the user frame.
    pub in_user_frame: Xyzwpr,
    /// The pose of the active tool in the world.
    pub world: Xyzwpr,
}

impl CurposPage {
    /// The page as a controller writes it.
    #[must_use]
    pub fn encode(&self) -> String {
        use std::fmt::Write as _;
        let mut page = String::from(
            "<HTML><HEAD><TITLE>CURRENT POSITION</TITLE></HEAD>\r\n<BODY><PRE>\r\nF Number: F00000\r\nVERSION : HandlingTool\r\n$VERSION: V8.3000\r\nDATE:     01-JAN-00 00:00\r\n\r\nCURRENT ROBOT POSITION::\r\nGroup #:  1\r\n \r\nCURRENT JOINT POSITION:\r\n",
        );
        // Writing to a string cannot fail.
        for (idx, angle) in self.joints_deg.iter().enumerate() {
            let _ = write!(page, "Joint   {}: {:>9}\r\n", idx + 1, real(*angle));
        }
        let pose = |page: &mut String, Xyzwpr(values): &Xyzwpr| {
            for (name, value) in ["X", "Y", "Z", "W", "P", "R"].into_iter().zip(values) {
                let _ = write!(page, "{name}: {:>9}\r\n", real(*value));
            }
            page.push_str("CFG: N U T, 0, 0, 0\r\n\r\n");
        };
        let _ =
            write!(page, "\r\nFrame #:  {}  Tool #:  {}\r\nCURRENT USER FRAME POSITION:\r\n", self.frame, self.tool);
        pose(&mut page, &self.in_user_frame);
        let _ = write!(page, "Tool #:  {}\r\nCURRENT WORLD POSITION:\r\n", self.tool);
        pose(&mut page, &self.world);
        page.push_str("</PRE></BODY></HTML>\r\n");
        page
    }

    /// Reads the page.
    ///
    /// # Errors
    /// [`MessageError`] if the first group has no pose in the world, or the tool is not said.
    pub fn parse(page: &str) -> Result<Self, MessageError> {
        let lines: Vec<&str> = page.lines().map(str::trim).collect();
        let at = |lines: &[&str], words: &str| lines.iter().position(|line| line.contains(words));
        let missing = |expected: &str| MessageError::new("a page without it", expected);
        let start = lines
            .iter()
            .position(|line| value_of(line, "Group #").is_some_and(|group| group == "1"))
            .ok_or_else(|| missing("Group #: 1"))?;
        // The next group has a pose of its own.
        let end = lines[start + 1..].iter().position(|line| line.starts_with("Group #")).map(|at| start + 1 + at);
        let group = &lines[start..end.unwrap_or(lines.len())];
        if let Some(line) = group.iter().find(|line| line.contains("cannot be calculated")) {
            return Err(MessageError::new(line, "a pose; jog the robot away from where its wrist is stretched"));
        }
        let world_at =
            at(group, "CURRENT WORLD POSITION").ok_or_else(|| missing("CURRENT WORLD POSITION of group 1"))?;
        let number_of = |name: &str| {
            let line = group[..world_at].iter().rev().find(|line| line.contains(name))?;
            line[line.find(name)?..].split(':').nth(1)?.split_ascii_whitespace().next()?.parse::<u8>().ok()
        };
        let joints_at = at(group, "CURRENT JOINT POSITION").unwrap_or(0);
        let joints_deg = group[joints_at..]
            .iter()
            .skip(1)
            .skip_while(|line| line.is_empty())
            .map_while(|line| line.strip_prefix("Joint")?.split_once(':')?.1.trim().parse::<f64>().ok())
            .filter(|angle| angle.is_finite())
            .collect();
        let world = pose_after(&group[world_at..])?;
        let user_at = at(&group[..world_at], "CURRENT USER FRAME POSITION");
        Ok(Self {
            tool: number_of("Tool #").ok_or_else(|| missing("Tool #: and a number before the pose"))?,
            frame: number_of("Frame #").unwrap_or(0),
            joints_deg,
            in_user_frame: user_at.map_or(Ok(world), |user_at| pose_after(&group[user_at..world_at]))?,
            world,
        })
    }
}

/// Two decimals, and no zero before the point: `-.06`.
fn real(value: f64) -> String {
    let text = format!("{value:.2}");
    match text
        .strip_prefix("-0.")
        .map(|rest| format!("-.{rest}"))
        .or_else(|| text.strip_prefix("0.").map(|rest| format!(".{rest}")))
    {
        Some(short) => short,
        None => text,
    }
}

fn value_of<'a>(line: &'a str, name: &str) -> Option<&'a str> {
    line.strip_prefix(name)?.trim_start().strip_prefix(':').map(str::trim)
}

/// Six numbers in the lines that follow a heading; blank lines may come between.
fn pose_after(lines: &[&str]) -> Result<Xyzwpr, MessageError> {
    let mut values = [0.0; 6];
    let mut rest = lines.iter().skip(1).filter(|line| !line.is_empty());
    for (value, name) in values.iter_mut().zip(["X", "Y", "Z", "W", "P", "R"]) {
        let line = rest.next().copied().unwrap_or_default();
        *value = value_of(line, name)
            .and_then(|number| number.parse::<f64>().ok())
            .filter(|number| number.is_finite())
            .ok_or_else(|| MessageError::new(line, format!("{name}: and a number")))?;
    }
    Ok(Xyzwpr(values))
}
