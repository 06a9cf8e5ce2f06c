//! Which of several topics of one quantity is in force, row by row: estimators and sensors are switched in flight.
//!
//! ArduPilot names the estimator's core that is in force in `XKF4.PI` (`NKF4.PI` of EKF2), the estimator in `ATT.AEKF` (2 or 3), the airspeed sensor in `ARSP.Pri`; a receiver
//! of satellites is in use where `GPS.U` is 1, and has a place and a velocity where `GPS.Status` is 3 and more. Until 4.0 each core had messages of
//! its own: `NKF6` is `NKF1` of the second, and `NKF11` that of the third. PX4 logs what is in force under one name.

use crate::{Column, Log, Topic};
use std::borrow::Cow;
use std::collections::BTreeMap;

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
            let time = (time * 1e3).round() / 1e3;
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

    fn estimators(&mut self) {
        let primary = |status: &str| {
            let rows = self.numbers(status, "PI").into_iter();
            Choice::of(rows.map(|(t, core)| (t, (0, core))).collect(), (0, 0))
        };
        let cores = ["XKF4", "NKF4"].map(primary);
        let active: Vec<(f64, u8)> = self.numbers("ATT", "AEKF");
        let both = FAMILIES.map(|family| active.iter().any(|(_, active)| *active == family));
        // Every time at which something changes.
        let family = Choice::of(
            active
                .iter()
                .filter(|(_, active)| FAMILIES.contains(active))
                .map(|(t, active)| (*t, (*active, 0)))
                .collect(),
            (0, 0),
        );
        let all = cores.iter().chain([&family]).flat_map(|choice| &choice.0);
        let times: Vec<f64> = all.map(|(time, _)| *time).collect();
        let of = |index: usize| {
            let rows = times
                .iter()
                .map(|t| (*t, (FAMILIES[index], cores[index].at(*t).1)));
            Choice::of(rows.collect(), (FAMILIES[index], 0))
        };
        // One estimator where one is in force, or logged; else the one that is said to be.
        let choices = match both {
            [true, true] => {
                let rows = times.iter().map(|t| {
                    let estimator = family.at(*t).0;
                    let index = FAMILIES.iter().position(|f| *f == estimator).unwrap_or(0);
                    (*t, (estimator, cores[index].at(*t).1))
                });
                let both = || Choice::of(rows.clone().collect(), (3, 0));
                [Some(both()), Some(both())]
            }
            [false, true] => [None, Some(of(1))],
            [true, false] => [Some(of(0)), None],
            [false, false] => [Some(of(0)), Some(of(1))],
        };
        for (names, later) in ESTIMATORS {
            let mut parts: Vec<(Key, &Topic)> = Vec::new();
            for (index, name) in names.into_iter().enumerate() {
                let estimator = FAMILIES[index];
                let own = self.instances(name);
                parts.extend(
                    own.iter()
                        .map(|topic| ((estimator, topic.instance()), *topic)),
                );
                for (core, names) in (1..).zip(later).filter(|_| own.len() == 1) {
                    let topic = self.log.topic(names[index]);
                    parts.extend(topic.map(|topic| ((estimator, core), topic)));
                }
            }
            for (index, name) in names.into_iter().enumerate() {
                let Some(choice) = &choices[index] else {
                    self.chosen.insert(name, None);
                    continue;
                };
                let own = |(key, _): &&(Key, &Topic)| both == [true; 2] || key.0 == FAMILIES[index];
                let parts: Vec<(Key, &Topic)> = parts.iter().filter(own).copied().collect();
                if !parts.is_empty() {
                    self.chosen.insert(name, merged(name, &parts, choice));
                }
            }
        }
        // An estimator's core has the accelerometer of its own number, unless the vehicle is told otherwise.
        let used = choices.iter().flatten().find(|choice| {
            let estimator = choice.at(0.0).0;
            let logged = |name: &&str| self.log.topic(name).is_some();
            let index = FAMILIES.iter().position(|f| *f == estimator);
            index.is_some_and(|i| ESTIMATORS.iter().any(|(names, _)| logged(&names[i])))
        });
        let used = used.map(|choice| {
            let cores = choice.0.iter().map(|(t, (_, core))| (*t, (0, *core)));
            Choice::of(cores.collect(), (0, 0))
        });
        if let Some(choice) = used {
            self.sensors("IMU", ["IMU2", "IMU3"], &choice);
        }
        let told = choices.iter().flatten().find_map(|choice| {
            let estimator = choice.at(0.0).0;
            choice.note(&match both {
                [true, true] => "the estimator".to_owned(),
                _ => format!("EKF{estimator}"),
            })
        });
        self.notes.extend(told);
        let others = active.iter().filter(|(_, a)| !FAMILIES.contains(a)).count();
        if others > 0 && others < active.len() {
            self.notes.push(format!(
                "ATT.AEKF: in {others} of {} rows another estimator than EKF2 and EKF3 was in force; what those say is taken there, too",
                active.len()
            ));
        }
    }

    fn airspeed(&mut self) {
        let rows = self.numbers("ARSP", "Pri").into_iter();
        let choice = Choice::of(rows.map(|(t, sensor)| (t, (0, sensor))).collect(), (0, 0));
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
        if parts.len() > 1 {
            self.chosen.insert(name, merged(name, &parts, choice));
        }
    }
}

/// Of the topics `parts` the rows that are in force. Where the one in force is not logged, those of the first.
fn merged<'a>(name: &str, parts: &[(Key, &'a Topic)], choice: &Choice) -> Option<Cow<'a, Topic>> {
    let logged = |key: Key| parts.iter().any(|(own, _)| *own == key);
    let first = parts.iter().min_by_key(|(key, _)| *key)?;
    let in_force = |time: f64| {
        let key = choice.at(time);
        if logged(key) { key } else { first.0 }
    };
    let mut used = choice
        .0
        .iter()
        .map(|(_, key)| if logged(*key) { *key } else { first.0 });
    let one = used.next()?;
    if used.all(|key| key == one) {
        let topic = parts.iter().find(|(key, _)| *key == one)?;
        return Some(Cow::Borrowed(topic.1));
    }
    let taken = |key: Key, topic: &Topic, row: usize| in_force(topic.time()[row]) == key;
    rows(name, parts, taken).map(Cow::Owned)
}

/// One topic of the rows of `parts` that are `taken`; none if there are none. It has the columns that all have.
fn rows(
    name: &str,
    parts: &[(Key, &Topic)],
    taken: impl Fn(Key, &Topic, usize) -> bool,
) -> Option<Topic> {
    let mut order: Vec<(f64, usize, usize)> = Vec::new();
    for (part, (key, topic)) in parts.iter().enumerate() {
        let rows = topic.time().iter().enumerate();
        let rows = rows.filter(|(row, _)| taken(*key, topic, *row));
        order.extend(rows.map(|(row, time)| (*time, part, row)));
    }
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
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
            let values = order
                .iter()
                .map(|(_, part, row)| own[*part][*row])
                .collect();
            Column::new(&first.name, &first.unit, values)
        });
    let columns: Vec<Column> = columns.collect();
    let time = order.iter().map(|(time, ..)| *time).collect();
    (!order.is_empty()).then(|| Topic::unchecked(name, time, columns))
}
