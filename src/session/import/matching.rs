//! Which profile belongs to which pose: by the table's column, by the numbers in the names, or by order.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::sync::Arc;

use crate::session::{Reading, Station};
use crate::sheet::natural_key;

use super::gather::ProfileKey;
use super::profiles::NamedProfile;

/// Puts the profiles into the captures, by the first of these rules that fits:
///
/// 1. the table names the profile of a pose, by its file (ending and folder may be missing) or its number;
/// 2. the names have one number that changes, and each is the number in the label of a station with one capture;
/// 3. the names have two numbers that change: the station's, and the place of the capture in it;
/// 4. there are as many profiles as poses: in the order of the names;
/// 5. as 2 and 3, as far as they go.
///
/// Where several folders have poses, the profiles of each go to its own. No place takes two profiles.
///
/// Gives the names of the profiles that found no pose.
pub(super) fn assign(
    stations: &mut [Station],
    keys: &[ProfileKey],
    source_starts: &[(usize, String)],
    mut profiles: Vec<NamedProfile>,
    in_columns: bool,
) -> Vec<String> {
    if !in_columns {
        profiles.sort_by_cached_key(|profile| natural_key(&profile.name));
    }
    let folder_of: Vec<&str> = (0..stations.len())
        .map(|idx| {
            let source = source_starts.partition_point(|(first, _)| *first <= idx);
            source_starts.get(source.wrapping_sub(1)).map_or("", |(_, folder)| folder.as_str())
        })
        .collect();
    let with_poses: BTreeSet<&str> = folder_of.iter().copied().collect();
    // The nearest folder with poses around a profile; of a single one all profiles are.
    let nearest = |name: &str| {
        let mut folder = name;
        while let Some((outer, _)) = folder.rsplit_once(['/', '\\']) {
            if with_poses.contains(outer) {
                return outer.to_owned();
            }
            folder = outer;
        }
        String::new()
    };
    let mut groups: BTreeMap<String, Vec<NamedProfile>> = BTreeMap::new();
    for profile in profiles {
        let folder = if with_poses.len() > 1 { nearest(&profile.name) } else { String::new() };
        groups.entry(folder).or_default().push(profile);
    }
    let mut without_pose = Vec::new();
    for (folder, profiles) in groups {
        let is_of_all = with_poses.len() < 2 || !with_poses.contains(folder.as_str());
        let members: Vec<usize> = (0..stations.len()).filter(|idx| is_of_all || folder_of[*idx] == folder).collect();
        let names: Vec<&str> = profiles.iter().map(|profile| profile.name.as_str()).collect();
        let places = places(stations, &members, keys, &names);
        let mut taken = HashSet::new();
        for (NamedProfile { name, profile }, place) in profiles.into_iter().zip(places) {
            let free = place.filter(|place| taken.insert(*place));
            let capture = free
                .and_then(|(station_idx, capture_idx)| stations.get_mut(station_idx)?.captures.get_mut(capture_idx));
            match capture {
                Some(capture) => capture.reading = Reading::Profile(Arc::new(profile)),
                None => without_pose.push(name),
            }
        }
    }
    without_pose
}

/// The station and capture of each profile, among the stations that are asked about.
fn places(stations: &[Station], members: &[usize], keys: &[ProfileKey], names: &[&str]) -> Vec<Option<(usize, usize)>> {
    let is_member = |key: &&ProfileKey| members.binary_search(&key.station_idx).is_ok();
    let keys: Vec<&ProfileKey> = keys.iter().filter(is_member).collect();
    if !keys.is_empty() {
        return by_key(&keys, names);
    }
    let num_captures = members.iter().map(|idx| stations[*idx].captures.len()).sum::<usize>();
    let by_number = by_number(stations, members, names);
    let is_one_to_one = by_number.iter().flatten().collect::<HashSet<_>>().len() == names.len();
    if is_one_to_one || names.len() != num_captures {
        return by_number;
    }
    let all =
        members.iter().flat_map(|idx| (0..stations[*idx].captures.len()).map(move |capture| Some((*idx, capture))));
    all.collect()
}

/// The name of a file without folders and ending.
fn stem(name: &str) -> &str {
    let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
    file.rsplit_once('.').map_or(file, |(stem, _)| stem)
}

fn by_key(keys: &[&ProfileKey], names: &[&str]) -> Vec<Option<(usize, usize)>> {
    let mut place_of: HashMap<String, (usize, usize)> = HashMap::new();
    for key in keys {
        let place = (key.station_idx, key.capture_idx);
        place_of.entry(key.name.replace('\\', "/").to_lowercase()).or_insert(place);
        place_of.entry(stem(&key.name).to_lowercase()).or_insert(place);
    }
    let number_of = |name: &str| numbers(stem(name)).last().map(u64::to_string);
    names
        .iter()
        .map(|name| {
            let known = |name: &str| place_of.get(&name.to_lowercase()).copied();
            known(name).or_else(|| known(stem(name))).or_else(|| known(&number_of(name)?))
        })
        .collect()
}

/// The numbers in a name, in order.
fn numbers(name: &str) -> Vec<u64> {
    natural_key(name).into_iter().filter_map(|(_, number)| number).collect()
}

fn by_number(stations: &[Station], members: &[usize], names: &[&str]) -> Vec<Option<(usize, usize)>> {
    let mut lists: Vec<Vec<u64>> = names
        .iter()
        .map(|name| {
            let without_ending = name.rsplit_once('.').map_or(*name, |(before, _)| before);
            numbers(without_ending)
        })
        .collect();
    drop_constant(&mut lists);
    let mut station_of: HashMap<u64, usize> = HashMap::new();
    for idx in members {
        if let Some(number) = numbers(&stations[*idx].label).last() {
            station_of.entry(*number).or_insert(*idx);
        }
    }
    // Captures are numbered from 0 or from 1; the smallest number tells.
    let first_capture = lists.iter().filter_map(|list| list.get(1)).min().copied().unwrap_or_default().min(1);
    lists
        .iter()
        .map(|list| match list.as_slice() {
            [station] => {
                let idx = *station_of.get(station)?;
                (stations[idx].captures.len() == 1).then_some((idx, 0))
            }
            [station, capture] => {
                let capture_idx = usize::try_from(capture - first_capture).ok()?;
                Some((*station_of.get(station)?, capture_idx))
            }
            _ => None,
        })
        .collect()
}

/// Leaves of each list only what differs between the names: a date or a cell's number is in all of them.
fn drop_constant(lists: &mut [Vec<u64>]) {
    let Some(first) = lists.first().cloned() else { return };
    if lists.len() < 2 || lists.iter().any(|list| list.len() != first.len()) {
        // Of a single name, or of names that are built differently, the last number counts.
        for list in lists {
            list.drain(..list.len().saturating_sub(1));
        }
        return;
    }
    let is_constant: Vec<bool> = (0..first.len()).map(|idx| lists.iter().all(|list| list[idx] == first[idx])).collect();
    for list in lists {
        let mut idx = 0;
        list.retain(|_| {
            idx += 1;
            !is_constant[idx - 1]
        });
    }
}
