//! Converts a log: `convert IN OUT [TOPIC]`. The kind of OUT is that of its name: `.ulg`, `.mcap`, `.csv`. CSV holds one
//! topic, TOPIC, or the log's first; `TOPIC.1` is its second instance. With TOPIC `states` what is written is the state of
//! the flight, found under the autopilot's names, on one time base; what the log does not hold is named.

#[cfg(not(target_os = "none"))]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    use std::fs::File;
    use std::io::BufWriter;
    use std::path::Path;

    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (from, to) = match arguments.as_slice() {
        [from, to] | [from, to, _] => (Path::new(from), Path::new(to)),
        _ => return Err("usage: convert IN OUT [TOPIC]".into()),
    };
    let mut log = alula_logs::read(from)?;
    if arguments.get(2).is_some_and(|topic| topic == "states") {
        let states = alula_logs::states::find(&log)?;
        log.notes
            .extend(states.missing.iter().map(ToString::to_string));
        log.notes.extend_from_slice(&states.notes);
        log.topics = vec![states.topic()];
    }
    log.notes
        .iter()
        .for_each(|note| eprintln!("{}: {note}", from.display()));
    let out = || File::create(to).map(BufWriter::new);
    match to.extension().and_then(|e| e.to_str()) {
        Some("ulg") => alula_logs::ulog::write(&log, out()?)?,
        Some("mcap") => alula_logs::mcap::write(&log, out()?)?,
        Some("csv") => {
            let topic = match arguments.get(2) {
                None => log.topics.first(),
                Some(name) => match name.rsplit_once('.') {
                    Some((name, instance)) => log.instance(name, instance.parse()?),
                    None => log.topic(name),
                },
            };
            alula_logs::csv::write(topic.ok_or("no such topic")?, out()?)?;
        }
        _ => return Err("OUT must end in .ulg, .mcap or .csv".into()),
    }
    Ok(())
}

#[cfg(target_os = "none")]
fn main() {}
