//! `alula-sil identify`: a vehicle learned from its log, by the commands of the page.

use alula_sim::experiment::Document;
use alula_sim::flight_log::log;
use alula_sim::simulate::fly;

/// From the log to a vehicle that flies, by the commands of the page; each number of the file says whether it was measured.
#[test]
fn a_log_becomes_a_vehicle() {
    let folder = tempfile::tempdir().unwrap();
    let of_the_page = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../examples/identification.toml"
    );
    let document = Document::load(of_the_page).unwrap();
    let experiment = document.checked().unwrap();
    let record = fly(&experiment).unwrap();
    let log = log(&experiment, &record).unwrap();
    let file = std::fs::File::create(folder.path().join("flight.ulg")).unwrap();
    alula_logs::ulog::write(&log, file).unwrap();
    let run = |arguments: &str| {
        let output = crate::alula(folder.path(), &arguments.split(' ').collect::<Vec<_>>());
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        (output.status.success(), said)
    };
    let (good, said) =
        run("identify flight.ulg --mass-kg 2.4 --wing-m2 0.4 --cruise-m-s 18 --out found");
    assert!(good, "{said}");
    let known = std::fs::read_to_string(folder.path().join("found/known.toml")).unwrap();
    for line in known.lines() {
        let source = line.split_once("# ").map_or("", |(_, source)| source);
        let says = ["measured", "assumed", "given", "flown"]
            .iter()
            .any(|word| source.starts_with(word));
        assert!(says, "{line}");
    }
    assert!(folder.path().join("found/report.html").exists());
    // The flight may miss its goals; the files are there.
    let (_, said) = run("new mine --from found/known.toml");
    assert!(folder.path().join("mine/vehicle.h").exists(), "{said}");
}
