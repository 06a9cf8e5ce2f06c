//! Which of several topics of one quantity is in force, row by row: estimators and sensors are switched in flight.
//!
//! ArduPilot names the estimator's core that is in force in `XKF4.PI` (`NKF4.PI` of EKF2), the estimator in `ATT.AEKF`
//! (2 or 3), the airspeed sensor in `ARSP.Pri`. A receiver of satellites is in use where `GPS.U` is 1, and has a place
//! and a velocity where `GPS.Status` is 3 and more. Until 4.0 each core had messages of its own: `NKF6` is `NKF1` of
//! the second, and `NKF11` that of the third. PX4 logs what is in force under one name.

use crate::{Column, Log, Topic};
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

/// The topics of a log, with what is in force in place of several.
pub(super) struct Topics<'a> {
    pub log: &'a Log,
    chosen: BTreeMap<&'static str, Option<Cow<'a, Topic>>>,
    /// Where the choice changed, in words.
    pub notes: Vec<String>,
}

/// One choice: the first core, the second receiver. Of estimators, with the digit of the estimator.
type Key = (u8, u8);

/// What is in force from which time on \[s\].
struct Choice(Vec<(f64, Key)>);

impl Choice {
    /// As the values of these columns say; without them the one `otherwise`.
    fn of(mut rows: Vec<(f64, Key)>, otherwise: Key) -> Self {
        rows.sort_by(|a, b| a.0.total_cmp(&b.0));
        rows.dedup_by_key(|row| row.1);
        match rows.is_empty() {
            true => Self(vec![(0.0, otherwise)]),
            false => Self(rows),
        }
    }

    /// At a time; before the first as then.
    fn at(&self, time: f64) -> Key {
        let after = self.0.partition_point(|(from, _)| *from <= time);
        self.0[after.saturating_sub(1)].1
    }

    /// Where it changed, of `what`.
    fn note(&self, what: &str) -> Option<String> {
        /// Changes that are told one by one.
        const TOLD: usize = 3;
        let changes = self.0.windows(2).map(|pair| {
            let [(_, before), (time, after)] = [pair[0], pair[1]];
            let word = |(estimator, core): Key| match estimator {
                0 => core.to_string(),
                _ if before.0 == after.0 => core.to_string(),
                _ => format!("EKF{estimator} {core}"),
            };
            let time = rounded(time);
            format!("from {} to {} at {time} s", word(before), word(after))
        });
        let all: Vec<String> = changes.collect();
        let more = match all.len().checked_sub(TOLD) {
            Some(more) if more > 0 => format!(", and {more} times more"),
            _ => String::new(),
        };
        (!all.is_empty()).then(|| {
            format!(
                "{what}: the primary changed {}{more}: each row is of the one in force",
                all[..all.len().min(TOLD)].join(", ")
            )
        })
    }
}

/// A time to the millisecond.
fn rounded(time: f64) -> f64 {
    (time * 1e3).round() / 1e3
}

/// The messages of estimators that are looked for, and what the second and the third core have in their place in old logs. X stands for EKF3, N for EKF2.
const ESTIMATORS: [([&str; 2], [[&str; 2]; 2]); 4] = [
    (["XKQ", "NKQ"], [["", ""], ["", ""]]),
    (["XKQ1", "NKQ1"], [["XKQ2", "NKQ2"], ["XKQ3", "NKQ3"]]),
    (["XKF1", "NKF1"], [["XKF6", "NKF6"], ["XKF11", "NKF11"]]),
    (["XKF2", "NKF2"], [["XKF7", "NKF7"], ["XKF12", "NKF12"]]),
];
/// Which of the two of a pair above is which estimator.
const FAMILIES: [u8; 2] = [3, 2];

impl<'a> Topics<'a> {
    pub(super) fn new(log: &'a Log) -> Self {
        let mut topics = Self {
            log,
            chosen: BTreeMap::new(),
            notes: Vec::new(),
        };
        topics.estimators();
        topics.airspeed();
        topics.receivers();
        topics
    }

    /// The topic `name`: what is in force of it, or else that of the lowest instance.
    pub(super) fn get(&self, name: &str) -> Option<&Topic> {
        match self.chosen.get(name) {
            Some(chosen) => chosen.as_deref(),
            None => self.log.topic(name),
        }
    }

    /// Every instance of `name`.
    fn instances(&self, name: &str) -> Vec<&'a Topic> {
        let topics = self.log.topics.iter();
        topics.filter(|topic| topic.name() == name).collect()
    }

    /// The numbers that the instances of `name` have in `column`, with their times.
    fn numbers(&self, name: &str, column: &str) -> Vec<(f64, u8)> {
        let all = self.instances(name).into_iter().flat_map(|topic| {
            let values = topic.column(column).map_or(&[][..], |c| &c.values);
            let numbers = std::iter::zip(topic.time(), values);
            numbers
                .filter(|(_, v)| (0.0..256.0).contains(*v))
                .map(|(t, v)| (*t, *v as u8))
        });
        all.collect()
    }

    /// What is logged of an estimator's message under each of its `names`, X of EKF3 and N of EKF2.
    fn cores(&self, names: [&str; 2], later: [[&str; 2]; 2]) -> Vec<(Key, &'a Topic)> {
        let mut parts: Vec<(Key, &Topic)> = Vec::new();
        for (index, estimator) in FAMILIES.into_iter().enumerate() {
            let own = self.instances(names[index]);
            let cores = own
                .iter()
                .map(|topic| ((estimator, topic.instance()), *topic));
            parts.extend(cores);
            for (core, names) in (1..).zip(later).filter(|_| own.len() == 1) {
                let topic = self.log.topic(names[index]);
                parts.extend(topic.map(|topic| ((estimator, core), topic)));
            }
        }
        parts
    }

    fn estimators(&mut self) {
        let messages = ESTIMATORS.map(|(names, later)| (names, self.cores(names, later)));
        let logged = || messages.iter().flat_map(|(_, parts)| parts);
        let first = |estimator: u8| {
            let own = logged().filter(|(key, _)| key.0 == estimator);
            own.map(|(key, _)| key.1).min().unwrap_or(0)
        };
        // The core in force of each estimator, and the estimator in force.
        let primaries = [0, 1].map(|index| {
            let (status, estimator) = (["XKF4", "NKF4"][index], FAMILIES[index]);
            let rows = self.numbers(status, "PI").into_iter();
            let rows: Vec<(f64, Key)> = rows.map(|(t, core)| (t, (estimator, core))).collect();
            let cores: BTreeSet<Key> = logged()
                .map(|(key, _)| *key)
                .filter(|key| key.0 == estimator)
                .collect();
            if rows.is_empty() && cores.len() > 1 {
                self.notes.push(format!(
                    "EKF{estimator}: no {status}.PI says which of its {} cores was in force: core {} is taken",
                    cores.len(),
                    first(estimator)
                ));
            }
            Choice::of(rows, (estimator, first(estimator)))
        });
        let active: Vec<(f64, u8)> = self.numbers("ATT", "AEKF");
        let known = active.iter().filter(|(_, a)| FAMILIES.contains(a));
        let family = Choice::of(known.map(|(t, a)| (*t, (*a, 0))).collect(), (0, 0));
        let changes = primaries.iter().chain([&family]);
        let times: Vec<f64> = changes
            .flat_map(|choice| choice.0.iter().map(|(time, _)| *time))
            .collect();
        // Where nothing says which estimator is in force, EKF3 goes before EKF2.
        let default = FAMILIES
            .into_iter()
            .find(|estimator| logged().any(|(key, _)| key.0 == *estimator));
        let rows = times.iter().filter_map(|time| {
            let estimator = match family.at(*time).0 {
                0 => default?,
                estimator => estimator,
            };
            let index = FAMILIES.iter().position(|f| *f == estimator)?;
            Some((*time, primaries[index].at(*time)))
        });
        let Some(default) = default else { return };
        let both = FAMILIES.map(|estimator| logged().any(|(key, _)| key.0 == estimator));
        if both == [true; 2] && active.is_empty() {
            self.notes.push(format!(
                "EKF2 and EKF3: no ATT.AEKF says which of them was in force: EKF{default} is taken"
            ));
        }
        let choice = Choice::of(rows.collect(), (default, first(default)));
        let mut missing: BTreeMap<Key, (f64, Vec<&str>)> = BTreeMap::new();
        for (names, parts) in &messages {
            if parts.is_empty() {
                continue;
            }
            for (from, key) in &choice.0 {
                if !parts.iter().any(|(own, _)| own == key) {
                    let index = usize::from(key.0 != FAMILIES[0]);
                    let entry = missing.entry(*key).or_insert((*from, Vec::new()));
                    entry.1.push(names[index]);
                }
            }
            for (name, estimator) in names.iter().zip(FAMILIES) {
                let used = choice.0.iter().any(|(_, key)| key.0 == estimator);
                let rows = used.then(|| merged(name, parts, &choice)).flatten();
                self.chosen.insert(name, rows);
            }
        }
        self.notes.extend(choice.note("the estimator's core"));
        for ((estimator, core), (from, names)) in missing {
            let mut names = names;
            names.dedup();
            self.notes.push(format!(
                "EKF{estimator} core {core}, in force from {} s on, has no {} in the log: of no other core they are taken there",
                rounded(from),
                names.join(", ")
            ));
        }
        // Of several accelerometers an estimator's core has that of its own number, unless the vehicle is told otherwise.
        let cores = choice.0.iter().map(|(t, (_, core))| (*t, (0, *core)));
        let cores = Choice::of(cores.collect(), (0, 0));
        if self.instances("IMU").len() > 1 || self.log.topic("IMU2").is_some() {
            self.sensors("IMU", ["IMU2", "IMU3"], &cores);
        }
        let others = active.iter().filter(|(_, a)| !FAMILIES.contains(a)).count();
        if others > 0 {
            self.notes.push(format!(
                "ATT.AEKF: in {others} of {} rows another estimator than EKF2 and EKF3 was in force; what those say is taken there, too",
                active.len()
            ));
        }
    }

    fn airspeed(&mut self) {
        let rows = self.numbers("ARSP", "Pri").into_iter();
        let first = self.log.topic("ARSP").map_or(0, Topic::instance);
        let rows = rows.map(|(t, sensor)| (t, (0, sensor)));
        let choice = Choice::of(rows.collect(), (0, first));
        self.notes.extend(choice.note("airspeed"));
        self.sensors("ARSP", ["ASP2", ""], &choice);
    }

    /// The rows of receivers that are in use and know where they are.
    fn receivers(&mut self) {
        let instances = self.instances("GPS");
        let says = |topic: &Topic, column: &str, row: usize| {
            topic
                .column(column)
                .and_then(|c| c.values.get(row))
                .copied()
        };
        let known = |topic: &Topic, row: usize| {
            // Of two rows of one time, of two receivers, that of the one in use.
            says(topic, "Status", row).is_none_or(|status| status >= 3.0)
                && says(topic, "U", row).is_none_or(|used| used != 0.0)
        };
        let in_use: Vec<(f64, Key)> = instances
            .iter()
            .flat_map(|topic| {
                let rows = (0..topic.time().len()).filter(|row| known(topic, *row));
                rows.map(|row| (topic.time()[row], (0, topic.instance())))
            })
            .collect();
        let without = instances.iter().all(|topic| topic.column("U").is_none());
        if instances.is_empty() {
            return;
        }
        let first = instances
            .iter()
            .map(|topic| topic.instance())
            .min()
            .unwrap_or(0);
        let choice = match without {
            true => Choice(vec![(0.0, (0, first))]),
            false => Choice::of(in_use, (0, first)),
        };
        self.notes.extend(choice.note("GPS"));
        let parts: Vec<(Key, &Topic)> = instances
            .iter()
            .map(|topic| ((0, topic.instance()), *topic))
            .collect();
        let known = |key: Key, topic: &Topic, row: usize| {
            known(topic, row) && choice.at(topic.time()[row]) == key
        };
        self.chosen
            .insert("GPS", rows("GPS", &parts, known).map(Cow::Owned));
    }

    /// What is in force of a sensor that has several instances, or several names.
    fn sensors(&mut self, name: &'static str, others: [&str; 2], choice: &Choice) {
        let own = self.instances(name);
        let mut parts: Vec<(Key, &Topic)> = own
            .iter()
            .map(|topic| ((0, topic.instance()), *topic))
            .collect();
        for (n, other) in (1..).zip(others).filter(|_| own.len() == 1) {
            parts.extend(self.log.topic(other).map(|topic| ((0, n), topic)));
        }
        let logged = |key: &Key| parts.iter().any(|(own, _)| own == key);
        if let Some((from, (_, number))) = choice.0.iter().find(|(_, key)| !logged(key))
            && !parts.is_empty()
        {
            self.notes.push(format!(
                "{name} {number}, in force from {} s on, is not in the log: of no other it is taken there",
                rounded(*from)
            ));
        }
        if !parts.is_empty() {
            self.chosen.insert(name, merged(name, &parts, choice));
        }
    }
}

/// Of the topics `parts` the rows that are in force; none where that one is not logged.
fn merged<'a>(name: &str, parts: &[(Key, &'a Topic)], choice: &Choice) -> Option<Cow<'a, Topic>> {
    if let [(_, one)] = choice.0[..] {
        let topic = parts.iter().find(|(key, _)| *key == one)?;
        return Some(Cow::Borrowed(topic.1));
    }
    let taken = |key: Key, topic: &Topic, row: usize| choice.at(topic.time()[row]) == key;
    rows(name, parts, taken).map(Cow::Owned)
}

/// One topic of the rows of `parts` that are `taken`; none if there are none. It has the columns that all have.
fn rows(
    name: &str,
    parts: &[(Key, &Topic)],
    taken: impl Fn(Key, &Topic, usize) -> bool,
) -> Option<Topic> {
    /// A row that is taken.
    struct Taken {
        time: f64,
        part: usize,
        row: usize,
    }
    let mut order: Vec<Taken> = Vec::new();
    for (part, (key, topic)) in parts.iter().enumerate() {
        let rows = topic.time().iter().enumerate();
        let rows = rows.filter(|(row, _)| taken(*key, topic, *row));
        order.extend(rows.map(|(row, &time)| Taken { time, part, row }));
    }
    order.sort_by(|a, b| a.time.total_cmp(&b.time));
    let of_all = |column: &&Column| parts.iter().all(|(_, t)| t.column(&column.name).is_some());
    let columns = parts
        .first()?
        .1
        .columns()
        .iter()
        .filter(of_all)
        .map(|first| {
            let own: Vec<&[f64]> = parts
                .iter()
                .map(|(_, topic)| topic.column(&first.name).map_or(&[][..], |c| &c.values))
                .collect();
            let values = order.iter().map(|of| own[of.part][of.row]).collect();
            Column::new(&first.name, &first.unit, values)
        });
    let columns: Vec<Column> = columns.collect();
    let time = order.iter().map(|of| of.time).collect();
    (!order.is_empty()).then(|| Topic::unchecked(name, time, columns))
}
