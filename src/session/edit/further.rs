//! Edits of the further targets of a session.

use crate::session::limits;
use crate::session::model::{FurtherTarget, Known, Session, Target};

use super::EditRefusal;
use super::labels::{Labels, repeated};
use super::setup::{check_known, check_target};
use super::valid::{check_label, check_stations, within};

fn at(session: &mut Session, further_idx: usize) -> Result<&mut FurtherTarget, EditRefusal> {
    session.further.get_mut(further_idx).ok_or(EditRefusal::NoSuchFurther { further_idx })
}

fn names(session: &Session) -> impl Iterator<Item = &str> {
    session.further.iter().map(|further| further.name.as_str())
}

pub(super) fn add(session: &mut Session, added: &FurtherTarget) -> Result<(), EditRefusal> {
    if matches!(added.target, Target::Rgbd { .. }) {
        return Err(EditRefusal::NoSequenceAsFurther);
    }
    check_label(&added.name)?;
    check_target(&added.target)?;
    check_known(&added.known, &added.target)?;
    added.profile_std_mm.map_or(Ok(()), |std| within(std, &limits::LENGTH_STD_MM))?;
    let mut added = added.clone();
    added.name = Labels::of(names(session)).claim(&added.name);
    check_stations(&mut added.stations, &added.target, &mut Labels::of_stations(&[]))?;
    session.further.push(added);
    Ok(())
}

pub(super) fn remove(session: &mut Session, further_idx: usize) -> Result<(), EditRefusal> {
    at(session, further_idx)?;
    session.further.remove(further_idx);
    Ok(())
}

pub(super) fn rename(session: &mut Session, further_idx: usize, name: &str) -> Result<(), EditRefusal> {
    check_label(name)?;
    name.clone_into(&mut at(session, further_idx)?.name);
    match repeated(names(session)) {
        Some(name) => Err(EditRefusal::NameTaken { name: name.to_owned() }),
        None => Ok(()),
    }
}

pub(super) fn set_known(session: &mut Session, further_idx: usize, known: &Known) -> Result<(), EditRefusal> {
    let further = at(session, further_idx)?;
    check_known(known, &further.target)?;
    further.known = *known;
    Ok(())
}

pub(super) fn use_stations(
    session: &mut Session,
    further_idx: usize,
    station_idxs: &[usize],
    used: bool,
) -> Result<(), EditRefusal> {
    let FurtherTarget { name, stations, .. } = at(session, further_idx)?;
    for &station_idx in station_idxs {
        let station = stations
            .get_mut(station_idx)
            .ok_or_else(|| EditRefusal::NoSuchFurtherStation { name: name.clone(), station_idx })?;
        station.enabled = used;
    }
    Ok(())
}
