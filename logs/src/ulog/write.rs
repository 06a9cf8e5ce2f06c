//! The writer.

use super::{MAGIC, UNITS};
use crate::error::{output, problem};
use crate::fields::{Field, fields, identifier, rows_by_time, twice};
use crate::{Error, Log, Topic};
use std::io::Write;

/// Writes `log` as ULog, all topics in the order of time.
///
/// Neighbouring columns `q[0]`, `q[1]`, … become one array; in other names what ULog does not allow becomes an
/// underscore. A column whose every value is a single-precision number is written as `float`, any other as `double`: no
/// value changes. Times are rounded to the microsecond, which is ULog's resolution. PX4's Flight Review takes a row at
/// the time 0 for one that was never filled in, so let time begin later.
///
/// # Errors
/// [`Error::Write`]: a time before 0, or beyond what 64 bits of microseconds hold; two topics of one name and instance, or of one
/// name and different columns; two columns whose names become one; a row of more than 65,533 bytes; more than 65,536 topics.
/// [`Error::Io`]: `out` refuses.
pub fn write(log: &Log, mut out: impl Write) -> Result<(), Error> {
    let plans = plan(log)?;
    let rows = rows_by_time(&log.topics, 1e6)?;
    let start = rows.first().map_or(0, |first| first.ticks);

    let mut bytes = [&MAGIC[..], &[1]].concat();
    bytes.extend(start.to_le_bytes());
    message(&mut bytes, b'B', &[&[0; 40]])?;
    let system = b"alula";
    let key = format!("char[{}] sys_name", system.len());
    message(
        &mut bytes,
        b'I',
        &[&[length(&key)?], key.as_bytes(), system],
    )?;
    for plan in plans.iter().filter(|plan| plan.defines) {
        message(&mut bytes, b'F', &[plan.format.as_bytes()])?;
        for (field, _) in &plan.fields {
            let unit = field.columns.first().map_or("", |c| c.unit.as_str());
            if !unit.is_empty() {
                let value = format!("{}.{}={unit}", plan.name, field.name);
                let key = format!("char[{}] {UNITS}", value.len());
                message(
                    &mut bytes,
                    b'M',
                    &[&[0, length(&key)?], key.as_bytes(), value.as_bytes()],
                )?;
            }
        }
    }
    for (id, (plan, topic)) in plans.iter().zip(&log.topics).enumerate() {
        let [low, high] = number(id)?.to_le_bytes();
        message(
            &mut bytes,
            b'A',
            &[&[topic.instance(), low, high], plan.name.as_bytes()],
        )?;
    }
    let mut payload = Vec::new();
    for timed in rows {
        payload.clear();
        payload.extend(number(timed.topic)?.to_le_bytes());
        payload.extend(timed.ticks.to_le_bytes());
        for (field, single) in &plans[timed.topic].fields {
            for value in field.columns.iter().map(|column| column.values[timed.row]) {
                if *single {
                    payload.extend((value as f32).to_le_bytes());
                } else {
                    payload.extend(value.to_le_bytes());
                }
            }
        }
        message(&mut bytes, b'D', &[&payload])?;
        if bytes.len() > 1 << 16 {
            out.write_all(&bytes).map_err(output)?;
            bytes.clear();
        }
    }
    out.write_all(&bytes).map_err(output)?;
    out.flush().map_err(output)
}

/// How one topic is written.
struct Plan<'a> {
    name: String,
    /// Fields, and whether each is written in single precision.
    fields: Vec<(Field<'a>, bool)>,
    format: String,
    /// Whether it is the first of its name, so that its format is written.
    defines: bool,
}

fn plan(log: &Log) -> Result<Vec<Plan<'_>>, Error> {
    let mut plans: Vec<Plan> = Vec::new();
    for (index, topic) in log.topics.iter().enumerate() {
        let name = identifier(topic.name());
        let fields = fields(topic);
        let named = fields.iter().map(|field| field.name.as_str());
        if let Some(twice) = twice(named.chain(["timestamp"])) {
            return problem(format!("topic `{name}` has two fields `{twice}`"));
        }
        let one_name = |other: &&Topic| identifier(other.name()) == name;
        let same: Vec<&Topic> = log.topics.iter().filter(one_name).collect();
        if same
            .iter()
            .filter(|other| other.instance() == topic.instance())
            .count()
            > 1
        {
            return problem(format!(
                "topic `{name}` is there twice as instance {}",
                topic.instance()
            ));
        }
        // One format serves all instances.
        let columns = |topic: &Topic| {
            topic
                .columns()
                .iter()
                .map(|c| c.name.clone())
                .collect::<Vec<_>>()
        };
        if same.iter().any(|other| columns(other) != columns(topic)) {
            return problem(format!(
                "the instances of topic `{name}` have different columns"
            ));
        }
        let exact = |v: &f64| v.is_nan() || f64::from(*v as f32) == *v;
        let single = |field: &Field| {
            let columns = same.iter().flat_map(|t| {
                t.columns()
                    .iter()
                    .skip(field.first)
                    .take(field.columns.len())
            });
            columns.flat_map(|c| &c.values).all(exact)
        };
        let fields: Vec<_> = fields
            .into_iter()
            .map(|field| {
                let single = single(&field);
                (field, single)
            })
            .collect();
        let mut format = format!("{name}:uint64_t timestamp;");
        for (field, single) in &fields {
            let kind = if *single { "float" } else { "double" };
            let count = if field.array {
                format!("[{}]", field.columns.len())
            } else {
                String::new()
            };
            format += &format!("{kind}{count} {};", field.name);
        }
        let defines = !log.topics[..index].iter().any(|other| one_name(&other));
        plans.push(Plan {
            name,
            fields,
            format,
            defines,
        });
    }
    Ok(plans)
}

/// The number of a topic.
fn number(index: usize) -> Result<u16, Error> {
    index
        .try_into()
        .or_else(|_| problem("more than 65,536 topics".into()))
}

fn length(key: &str) -> Result<u8, Error> {
    key.len()
        .try_into()
        .or_else(|_| problem(format!("`{key}` is too long a name")))
}

fn message(bytes: &mut Vec<u8>, kind: u8, parts: &[&[u8]]) -> Result<(), Error> {
    let size = parts.iter().map(|part| part.len()).sum::<usize>();
    let Ok(size) = u16::try_from(size) else {
        return problem(format!("a message `{}` of {size} bytes", char::from(kind)));
    };
    bytes.extend(size.to_le_bytes());
    bytes.push(kind);
    parts.iter().for_each(|part| bytes.extend(*part));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::read;
    use super::*;
    use crate::Column;

    fn round_trip(log: &Log) -> Log {
        let mut bytes = Vec::new();
        write(log, &mut bytes).unwrap();
        read("f", &bytes).unwrap()
    }

    #[test]
    fn what_is_written_reads_back_as_the_same_log() {
        let column = |name: &str, unit: &str, first: f64| {
            Column::new(name, unit, vec![first, first + 0.1, 1.0 / 3.0])
        };
        let single = Column::new("single", "m", vec![0.5, f64::INFINITY, -f64::from(0.1f32)]);
        let attitude = vec![
            column("q[0]", "", 1.0),
            column("q[1]", "", 2.0),
            column("x", "m/s", 3.0),
            single,
        ];
        let times = |first: f64| vec![first, first + 0.25, first + 1e3];
        let topics = vec![
            Topic::new("attitude", 0, times(1.0), attitude).unwrap(),
            Topic::new("wind", 1, times(0.5), vec![column("n", "m/s", 7.0)]).unwrap(),
            Topic::new("wind", 0, times(1.5), vec![column("n", "m/s", 8.0)]).unwrap(),
        ];
        let mut back = round_trip(&Log {
            topics: topics.clone(),
            notes: Vec::new(),
        });
        assert!(back.notes.is_empty(), "{:?}", back.notes);
        // Topics come back in the order of their first rows.
        back.topics.swap(0, 1);
        assert_eq!(back.topics, topics);
    }

    #[test]
    fn times_keep_the_microsecond() {
        let time: Vec<f64> = (0..1000).map(|i| 1e5 + f64::from(i) * 1e-6).collect();
        let x = Column::new("x", "", vec![0.0; time.len()]);
        let log = Log {
            topics: vec![Topic::new("t", 0, time.clone(), vec![x]).unwrap()],
            ..Log::default()
        };
        let back = round_trip(&log);
        // 1e5 s has a spacing of 1.5e-11 s in double precision; a microsecond lost is 1e-6.
        let worst = std::iter::zip(back.topics[0].time(), &time)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        assert!(worst < 2e-11, "{worst}");
    }

    #[test]
    fn what_ulog_cannot_hold_is_refused() {
        let topic = |name: &str, instance, time: f64, columns: &[&str]| {
            let columns = columns
                .iter()
                .map(|c| Column::new(c, "", vec![0.0]))
                .collect();
            Topic::new(name, instance, vec![time], columns).unwrap()
        };
        let refusal = |topics: Vec<Topic>| {
            write(
                &Log {
                    topics,
                    ..Log::default()
                },
                Vec::new(),
            )
            .unwrap_err()
            .to_string()
        };
        assert!(refusal(vec![topic("t", 0, -1.0, &["x"])]).contains("time -1 s"));
        assert!(
            refusal(vec![topic("t", 0, u64::MAX as f64 / 1e6, &["x"])])
                .contains("time 18446744073709.55 s")
        );
        assert!(refusal(vec![topic("t", 0, 0.0, &["a.b", "a-b"])]).contains("two fields `a_b`"));
        assert!(
            refusal(vec![topic("t", 0, 0.0, &["timestamp"])]).contains("two fields `timestamp`")
        );
        assert!(
            refusal(vec![topic("t", 0, 0.0, &["x"]), topic("t", 0, 0.0, &["x"])])
                .contains("twice as instance 0")
        );
        assert!(
            refusal(vec![topic("t", 0, 0.0, &["x"]), topic("t", 1, 0.0, &["y"])])
                .contains("different columns")
        );
        let wide: Vec<String> = (0..20_000).map(|i| format!("c{i}")).collect();
        let wide: Vec<&str> = wide.iter().map(String::as_str).collect();
        assert!(refusal(vec![topic("t", 0, 0.0, &wide)]).contains("bytes"));
    }
}
