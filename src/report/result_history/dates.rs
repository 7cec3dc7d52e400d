//! Dates in files and in the names of files.

/// Days since 1970 of the first date in a text: `2026-03-01`, `2026_3_1`, `20260301`, and a time of day behind it
/// (`T14:30:05`, `_14-30`, ` 1430`), which is brought to UTC where its zone stands behind it (`Z`, `+02:00`); others are taken for
/// UTC. `None` if there is none.
pub(super) fn days_in(text: &str) -> Option<f64> {
    let chars: Vec<char> = text.chars().collect();
    (0..chars.len()).filter(|at| *at == 0 || !chars[at - 1].is_ascii_digit()).find_map(|at| {
        let (year, at) = digits(&chars, at, 4, 4)?;
        let (parted, month_at) = separator(&chars, at, &['-', '_', '.', '/']);
        let (month, at) = digits(&chars, month_at, if parted { 1 } else { 2 }, 2)?;
        let (parted_again, day_at) = separator(&chars, at, &['-', '_', '.', '/']);
        let (day, at) = digits(&chars, day_at, if parted { 1 } else { 2 }, 2)?;
        let is_date = (1970..2200).contains(&year) && parted == parted_again && day <= days_of(year, month)? && day > 0;
        // Longer numbers are something else.
        let ends_here = chars.get(at).is_none_or(|c| !c.is_ascii_digit());
        (is_date && ends_here).then(|| f64::from(days_since_1970(year, month, day)) + time_of_day(&chars, at))
    })
}

/// A number of so many digits, and what stands behind it.
fn digits(chars: &[char], at: usize, least: usize, most: usize) -> Option<(u32, usize)> {
    let count = chars.iter().skip(at).take(most).take_while(|c| c.is_ascii_digit()).count();
    let number =
        chars.iter().skip(at).take(count).filter_map(|c| c.to_digit(10)).fold(0, |sum, digit| sum * 10 + digit);
    (count >= least).then_some((number, at + count))
}

fn separator(chars: &[char], at: usize, wanted: &[char]) -> (bool, usize) {
    let is_there = chars.get(at).is_some_and(|c| wanted.contains(c));
    (is_there, at + usize::from(is_there))
}

/// As a part of a day; 0 if there is none.
fn time_of_day(chars: &[char], at: usize) -> f64 {
    const WITHIN: [char; 5] = [':', '-', '_', '.', 'h'];
    let read = || {
        let (parted, at) = separator(chars, at, &['T', 't', ' ', '_', '-']);
        let (hours, at) = digits(chars, at, 2, 2).filter(|_| parted)?;
        let (within_parts, minutes_at) = separator(chars, at, &WITHIN);
        let (minutes, minutes_end) = digits(chars, minutes_at, 2, 2)?;
        // Parted as hours and minutes are: what stands behind another sign is a zone, or a number.
        let (within_again, seconds_at) = separator(chars, minutes_end, &chars[at..minutes_at]);
        let seconds = digits(chars, seconds_at, 2, 2).filter(|_| within_again == within_parts);
        let (seconds, at) = seconds.unwrap_or((0, minutes_end));
        let of_day = f64::from(hours * 3600 + minutes * 60 + seconds) / 86_400.0;
        (hours < 24 && minutes < 60 && seconds < 61).then(|| of_day - offset(&chars[at..]))
    };
    read().unwrap_or(0.0)
}

/// By how much a time zone is ahead of UTC, as a part of a day: `+02:00`, `+0200`, `+02`, and `-05:00` with its colon, as other
/// numbers in names of files have a hyphen before them too. 0 if there is none.
fn offset(behind_time: &[char]) -> f64 {
    let read = || {
        let fraction = match behind_time.first() {
            Some('.' | ',') => 1 + behind_time.iter().skip(1).take_while(|c| c.is_ascii_digit()).count(),
            _ => 0,
        };
        let sign = behind_time.get(fraction).filter(|sign| matches!(sign, '+' | '-'))?;
        let (hours, at) = digits(behind_time, fraction + 1, 2, 2)?;
        let (parted, at) = separator(behind_time, at, &[':']);
        let minutes = digits(behind_time, at, 2, 2);
        let ahead = f64::from(hours * 60 + minutes.map_or(0, |(minutes, _)| minutes)) / 1440.0;
        let is_zone = hours < 24 && (*sign == '+' || parted && minutes.is_some());
        is_zone.then_some(if *sign == '+' { ahead } else { -ahead })
    };
    read().unwrap_or(0.0)
}

const fn is_leap(year: u32) -> bool {
    year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400))
}

const fn days_of(year: u32, month: u32) -> Option<u32> {
    match month {
        1 | 3 | 5 | 7 | 8 | 10 | 12 => Some(31),
        4 | 6 | 9 | 11 => Some(30),
        2 => Some(if is_leap(year) { 29 } else { 28 }),
        _ => None,
    }
}

fn days_since_1970(year: u32, month: u32, day: u32) -> u32 {
    let years: u32 = (1970..year).map(|year| if is_leap(year) { 366 } else { 365 }).sum();
    let months: u32 = (1..month).filter_map(|month| days_of(year, month)).sum();
    years + months + day - 1
}

/// A number of days since 1970 as `2026-03-01`.
pub(super) fn date_text(days: f64) -> String {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "dates of 1970 to 2199")]
    let mut left = days.clamp(0.0, 84_000.0) as u32;
    let (mut year, mut month) = (1970, 1);
    loop {
        let days = if is_leap(year) { 366 } else { 365 };
        if left < days {
            break;
        }
        (left, year) = (left - days, year + 1);
    }
    while let Some(days) = days_of(year, month).filter(|days| left >= *days) {
        (left, month) = (left - days, month + 1);
    }
    format!("{year}-{month:02}-{:02}", left + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_found_as_people_write_them_in_names_of_files() {
        for (text, expected) in [
            ("cell-3_2026-03-01.json", Some("2026-03-01")),
            ("20240229-result.json", Some("2024-02-29")),
            ("result 2026_3_1.json", Some("2026-03-01")),
            ("1999-12-31", Some("1999-12-31")),
            ("20230229.json", None),
            ("result-20261301", None),
            ("serial-120260301", None),
            ("202603011", None),
            ("result-7.json", None),
            ("", None),
        ] {
            assert_eq!(days_in(text).map(date_text).as_deref(), expected, "{text}");
        }
        assert_eq!(days_in("1970-01-02"), Some(1.0));
        for noon in ["2026-03-01T12:00:00Z", "20260301_1200", "2026-03-01 12-00"] {
            assert_eq!(days_in(noon).map(f64::fract), Some(0.5), "{noon}");
        }
        assert_eq!(days_in("20260301-7.json").map(f64::fract), Some(0.0));
        for (text, minutes) in [
            ("2026-03-01T14:30:00+02:00", 750),
            ("2026-03-01T14:30:00.25+0200", 750),
            ("20260301T143000+02.json", 750),
            ("2026-03-01T14:30-05:30", 1200),
            ("2026-03-01T00:30+02:00", -90),
            ("20260301_1430-05.json", 870),
            ("20260301_1430-0500.json", 870),
        ] {
            let found = days_in(text).zip(days_in("2026-03-01")).map_or(f64::NAN, |(found, day)| found - day);
            assert!((found * 1440.0 - f64::from(minutes)).abs() < 1e-6, "{text}: {found}");
        }
        assert_eq!(days_in("2026-03-01T00:30+02:00").map(date_text).as_deref(), Some("2026-02-28"));
    }
}
