//! The places of a template: which number of a pose stands there, in which unit, with how many digits.

/// A place in a template.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Field {
    /// A number of the pose.
    Number(Place),
    /// The name of the tool.
    Name,
    /// The number of the tool.
    ToolNumber,
    /// What the parent is called in ROS.
    ParentFrame,
    /// The name of an angle in the convention, from 0.
    AngleName(usize),
}

/// A number of the pose and how it is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    pub quantity: Quantity,
    /// The written number is the quantity times this.
    pub factor: f64,
    pub decimals: usize,
    /// Negative numbers stand in parentheses.
    pub parenthesised: bool,
}

/// A number of the pose: translations in mm, angles in degrees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quantity {
    Translation(usize),
    Angle(usize),
    /// w x y z.
    Quaternion(usize),
    /// Row and column.
    Rotation(usize, usize),
}

impl Place {
    /// Half a unit of its last digit, in the unit of the quantity.
    pub fn half_unit(&self) -> f64 {
        0.5 * 10.0_f64.powi(-i32::try_from(self.decimals).unwrap_or(i32::MAX)) / self.factor
    }
}

impl Field {
    /// By its name in a template: `x` mm, `x_m` metres, `x_um` micrometres; `a` `b` `c` degrees, `a_rad` radians, `a_e2` and
    /// `a_e4` hundredths and ten-thousandths of a degree; `qw`; `r01`; `name`, `number`, `parent`, `a_name`. A `!` at the end
    /// puts negative numbers in parentheses.
    pub fn parse(text: &str) -> Option<Self> {
        match text {
            "name" => return Some(Self::Name),
            "number" => return Some(Self::ToolNumber),
            "parent" => return Some(Self::ParentFrame),
            "a_name" => return Some(Self::AngleName(0)),
            "b_name" => return Some(Self::AngleName(1)),
            "c_name" => return Some(Self::AngleName(2)),
            _ => {}
        }
        let (text, parenthesised) = text.strip_suffix('!').map_or((text, false), |text| (text, true));
        let (stem, unit) = text.split_once('_').unwrap_or((text, ""));
        let place = |quantity, factor, decimals| Self::Number(Place { quantity, factor, decimals, parenthesised });
        if let Some(axis) = position(stem, &["x", "y", "z"]) {
            let quantity = Quantity::Translation(axis);
            return match unit {
                "" => Some(place(quantity, 1.0, 3)),
                "m" => Some(place(quantity, 1e-3, 6)),
                "um" => Some(place(quantity, 1e3, 0)),
                _ => None,
            };
        }
        if let Some(idx) = position(stem, &["a", "b", "c"]) {
            let quantity = Quantity::Angle(idx);
            return match unit {
                "" => Some(place(quantity, 1.0, 4)),
                "rad" => Some(place(quantity, 1.0_f64.to_radians(), 7)),
                "e2" => Some(place(quantity, 1e2, 0)),
                "e4" => Some(place(quantity, 1e4, 0)),
                _ => None,
            };
        }
        if let Some(idx) = position(stem, &["qw", "qx", "qy", "qz"]) {
            return Some(place(Quantity::Quaternion(idx), 1.0, 8));
        }
        let [b'r', row @ b'0'..=b'2', column @ b'0'..=b'2'] = stem.as_bytes() else { return None };
        Some(place(Quantity::Rotation(usize::from(row - b'0'), usize::from(column - b'0')), 1.0, 9))
    }
}

fn position(name: &str, names: &[&str]) -> Option<usize> {
    names.iter().position(|known| *known == name)
}
