//! Falls of a campaign, beside what one who knows the plant needs: `cargo run --release -p alula-study --example falls -- [CAMPAIGN [FLIGHTS]]`.
//!
//! Lost are those that lose more than 100 m or are not back at the end; who is not back counts as infinitely deep.

use alula_sim::experiment::tail_sitter::VEHICLES;
use alula_sim::figures::Figures;
use alula_sim::simulate::fly;
use alula_study::starts::percentile;
use alula_study::{CampaignSource, each, oracle};

/// Height that is lost at most \[m\]: deeper, nothing is looked for.
const DEEPEST: f64 = 200.0;

fn main() -> anyhow::Result<()> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next();
    let name = name.as_deref().unwrap_or("tail-sitter-falls");
    let flights = arguments.next().map(|n| n.parse()).transpose()?;
    let source = CampaignSource::load(name, flights)?;
    let campaign = &source.campaign;
    let kind = campaign
        .disperse
        .iter()
        .position(|d| d.field == "plant.vehicle");
    let numbers: Vec<u64> = (0..campaign.flights).collect();
    let all = each(&numbers, None, |&number| {
        let drawn = campaign.draw(&source.base, number)?;
        let experiment = &drawn.experiment;
        let best = oracle::best(experiment, DEEPEST)?;
        let lost = match fly(experiment) {
            Ok(record) => {
                let figures = Figures::of(experiment, &record);
                let back = figures.get("late_velocity_error_rms_m_s") <= 6.0;
                (-figures.get("altitude_least_m"), back)
            }
            Err(_) => (f64::INFINITY, false),
        };
        let kind = kind.map_or(0, |at| drawn.values[at] as usize);
        Ok((kind, lost, best))
    })?;
    println!("| vehicle | flights | who | lost | median | 95 % | 99 % | most |");
    println!("|---|---:|---|---:|---:|---:|---:|---:|");
    for (kind, (vehicle, _)) in VEHICLES.iter().enumerate() {
        let of: Vec<_> = all.iter().filter(|(k, ..)| *k == kind).collect();
        if of.is_empty() {
            continue;
        }
        let flown = of.iter().map(|(_, flown, _)| match flown {
            (height, true) => *height,
            (_, false) => f64::INFINITY,
        });
        let known = of.iter();
        let known = known.map(|(.., best)| best.map_or(f64::INFINITY, |b| b.height_lost_m));
        let whose: [(_, Vec<f64>); 2] =
            [("guidance", flown.collect()), ("oracle", known.collect())];
        for (who, mut heights) in whose {
            heights.sort_by(f64::total_cmp);
            let lost = heights.iter().filter(|h| **h > 100.0).count();
            let at = |share| percentile(&heights, share);
            println!(
                "| {vehicle} | {} | {who} | {lost} | {:.1} | {:.1} | {:.1} | {:.1} |",
                of.len(),
                at(0.5),
                at(0.95),
                at(0.99),
                at(1.0)
            );
        }
    }
    Ok(())
}
