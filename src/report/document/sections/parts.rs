//! A scanned part: its planes, the angles between them, its teeth and diameter.

use crate::report::document::{Block, Cell, Column, Fact, Table, typeset, typeset_numbers};
use crate::report::evidence::{MeasuredPart, PartEvidence};
use crate::scan::{Deviation, Measured, PlaneFit, Region, Teeth, angle_between};
use crate::session::Known;
use crate::text::report as words;
use crate::text::workpiece as text;
use crate::verify::Figures;

pub(super) fn blocks(part: &PartEvidence, part_idx: usize) -> Vec<Block> {
    let mut blocks = vec![Block::Heading(words::part_heading(&part.name))];
    let measured = match &part.outcome {
        Ok(measured) => measured,
        Err(error) => {
            blocks.push(Block::Paragraph(error.to_string()));
            return blocks;
        }
    };
    let num_points = text::grouped(measured.cloud.len());
    blocks.push(Block::Paragraph(words::part_line(&num_points, part.num_profiles, &part.calibration)));
    let suffix = if part_idx == 0 { String::new() } else { format!("-part-{}", part_idx + 1) };
    blocks.extend(planes(measured, &part.known, &suffix));
    match &measured.shapes.teeth {
        Some(Ok(teeth)) => blocks.extend(of_teeth(teeth, &part.known, &suffix)),
        Some(Err(error)) => blocks.push(Block::Facts(vec![Fact::new(words::TEETH, error.to_string())])),
        None => {}
    }
    let round = measured.shapes.round.as_ref().map(|round| match round {
        Ok(round) => typeset_numbers(&text::round_line(round, part.known.diameter_mm)),
        Err(error) => error.to_string(),
    });
    blocks.extend(round.map(|line| Block::Facts(vec![Fact::new(words::DIAMETER, line)])));
    blocks
}

fn planes(measured: &MeasuredPart, known: &Known, suffix: &str) -> Vec<Block> {
    if measured.regions.is_empty() {
        return vec![Block::Paragraph(words::NO_PLANES.to_owned())];
    }
    let mm = |value: f64| Cell::number(value, text::DISTANCE_DECIMALS);
    let row = |region: &Region| {
        let Ok(fit) = &region.plane else {
            return std::iter::once(Cell::words(&region.name)).chain((1..9).map(|_| Cell::missing())).collect();
        };
        let crate::scan::Plane { normal, offset_mm } = fit.plane;
        let sizes: Vec<f64> = region.distances_mm.iter().map(|distance| distance.abs()).collect();
        let figures = Figures::of(&sizes);
        let height = Cell { text: text::height_std(fit), ..Cell::number(fit.height_std_mm(), 4) };
        vec![
            Cell::words(&region.name),
            Cell::figures(typeset(&text::equation(&fit.equation())), normal.x, vec![normal.y, normal.z, offset_mm]),
            height,
            Cell::number(fit.normal_std_rad().to_degrees(), 4),
            Cell { text: text::grouped(fit.num_points), ..Cell::count(fit.num_points) },
            mm(figures.mean_mm),
            mm(figures.std_mm),
            mm(figures.max_mm),
            mm(figures.rms_mm),
        ]
    };
    let optimistic = measured
        .regions
        .iter()
        .filter_map(|region| Some(format!("{}: {}", region.name, text::optimistic(region.plane.as_ref().ok()?)?)));
    let notes: Vec<String> = optimistic.collect();
    let failed = measured
        .regions
        .iter()
        .filter_map(|region| Some(Block::Paragraph(format!("{}: {}", region.name, region.plane.as_ref().err()?))));
    let drawn = [(words::MEAN, "mean"), (words::SPREAD, "sd"), (words::MAXIMUM, "max"), (words::RMS, "rms")];
    let table = Table {
        id: format!("planes{suffix}"),
        title: words::PLANES.to_owned(),
        columns: [
            Column::words(words::PLANE, "plane"),
            Column::figures(words::EQUATION, "normal_x", &["normal_y", "normal_z", "offset_mm"]),
            Column::number(words::HEIGHT, Some("mm"), "height_std_mm").under(words::KNOWN_TO),
            Column::number(words::NORMAL, Some("°"), "normal_std_deg").under(words::KNOWN_TO),
            Column::number("points", None, "points"),
        ]
        .into_iter()
        .chain(
            drawn.map(|(title, name)| Column::number(title, None, format!("distance_{name}_mm")).under(words::DRAWN)),
        )
        .collect(),
        rows: measured.regions.iter().map(row).collect(),
        note: (!notes.is_empty()).then(|| notes.join(" · ")),
    };
    std::iter::once(Block::Table(table)).chain(failed).chain(angles(&measured.regions, known, suffix)).collect()
}

fn angles(regions: &[Region], known: &Known, suffix: &str) -> Option<Block> {
    let fits: Vec<(&str, &PlaneFit)> =
        regions.iter().filter_map(|region| Some((region.name.as_str(), region.plane.as_ref().ok()?))).collect();
    let pairs =
        fits.iter().enumerate().flat_map(|(idx, first)| fits[idx + 1..].iter().map(move |second| (first, second)));
    let rows: Vec<Vec<Cell>> = pairs
        .map(|((first_name, first), (second_name, second))| {
            let found = angle_between(first, second);
            let angle = Cell::figures(
                typeset(&text::angle(first, second, known.angle_deg)),
                found.angle_rad.to_degrees(),
                vec![found.std_rad.to_degrees()],
            );
            vec![Cell::words(format!("{first_name}, {second_name}")), angle]
        })
        .collect();
    (!rows.is_empty()).then(|| {
        Block::Table(Table {
            id: format!("angles{suffix}"),
            title: words::ANGLES.to_owned(),
            columns: vec![
                Column::words(words::PLANES_OF_ANGLE, "planes"),
                Column::figures(words::ANGLE_WITH_STD, "angle_deg", &["angle_std_deg"]),
            ],
            rows,
            note: None,
        })
    })
}

fn of_teeth(teeth: &Teeth, known: &Known, suffix: &str) -> Vec<Block> {
    let measured = |measured: Option<Measured>| {
        [Cell::maybe(measured.map(|found| found.value_mm), 3), Cell::maybe(measured.map(|found| found.std_mm), 3)]
    };
    let rows = teeth.teeth.iter().enumerate().map(|(idx, tooth)| {
        [Cell::words((idx + 1).to_string()), Cell::number(tooth.place_mm, 3)]
            .into_iter()
            .chain(measured(tooth.pitch))
            .chain(measured(tooth.height))
            .collect()
    });
    let mut columns = vec![Column::words(words::TOOTH, "tooth"), Column::number(words::PLACE, Some("mm"), "place_mm")];
    for (group, name) in [(words::PITCH, "pitch"), (words::HEIGHT, "height")] {
        columns.push(Column::number(words::VALUE, Some("mm"), format!("{name}_mm")).under(group));
        columns.push(Column::number(words::STD, Some("mm"), format!("{name}_std_mm")).under(group));
    }
    let table = Table {
        id: format!("teeth{suffix}"),
        title: words::TEETH.to_owned(),
        columns,
        rows: rows.collect(),
        note: None,
    };
    let compared = [
        (words::PITCHES, teeth.pitches().collect::<Vec<_>>(), known.pitch_mm),
        (words::HEIGHTS, teeth.heights().collect(), known.height_mm),
    ];
    let facts = compared.into_iter().filter_map(|(name, values, nominal_mm)| {
        let deviation = Deviation::of(values.into_iter(), nominal_mm?)?;
        Some(Fact::new(name, typeset_numbers(&text::deviation_words(&deviation, nominal_mm?))))
    });
    vec![Block::Table(table), Block::Facts(facts.collect())]
}
