//! Converts a log: `convert IN OUT [TOPIC]`. The kind of OUT is that of its name: `.ulg`, `.mcap`, `.csv`. CSV holds one
//! topic, TOPIC, or the log's first; `TOPIC.1` is its second instance.

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
    let log = alula_logs::read(from)?;
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
