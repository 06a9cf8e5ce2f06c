//! The flights of a campaign, chunk by chunk, as columns.

use std::iter::repeat_n;

use super::random_reference::REFERENCE;
use super::{
    Campaign, CampaignFlight, Column, Drawn, DrawnReference, FlightResult, Frame, SAMPLED, Sample,
};
use alula_sim::figures::FIGURES;

/// Flights of a part that is whole.
pub const CHUNK: u64 = 50;

impl Campaign {
    /// Number of chunks.
    pub fn chunks(&self) -> u64 {
        self.flights.div_ceil(CHUNK)
    }

    /// The flights of `chunk`.
    pub fn chunk(&self, chunk: u64) -> std::ops::Range<u64> {
        chunk * CHUNK..((chunk + 1) * CHUNK).min(self.flights)
    }

    /// Number of flights in `chunks`.
    pub fn flights_in(&self, chunks: impl Iterator<Item = u64>) -> u64 {
        let size = |range: std::ops::Range<u64>| range.end - range.start;
        chunks.map(|chunk| size(self.chunk(chunk))).sum()
    }

    /// Flights and samples as columns.
    pub fn frames(&self, all: &[CampaignFlight]) -> (Frame, Frame) {
        let mut flights = Frame::default();
        let real = |of: &dyn Fn(&Drawn, &FlightResult) -> f64| {
            Column::Real(all.iter().map(|x| of(&x.drawn, &x.result)).collect())
        };
        let flag = |of: &dyn Fn(&FlightResult) -> bool| {
            Column::Flag(all.iter().map(|x| of(&x.result)).collect())
        };
        let numbers = all.iter().map(|x| x.number as i64);
        flights.push("flight", Column::Integer(numbers.collect()));
        for (i, dispersion) in self.disperse.iter().enumerate() {
            flights.push(&dispersion.field, real(&|d, _| d.values[i]));
        }
        let reference = |of: fn(&DrawnReference) -> f64| {
            real(&move |d, _| d.reference.as_ref().map_or(f64::NAN, of))
        };
        if self.reference.is_some() {
            flights.push(REFERENCE[0], reference(DrawnReference::speed));
            flights.push(REFERENCE[1], reference(DrawnReference::sink));
            flights.push(REFERENCE[2], reference(DrawnReference::stops));
        }
        if !self.faults.is_empty() {
            let index = |d: &Drawn| d.fault.map_or(-1, |fault| fault.index as i64);
            let indices = all.iter().map(|x| index(&x.drawn));
            flights.push("fault", Column::Integer(indices.collect()));
            let nan = f64::NAN;
            flights.push(
                "fault_from_s",
                real(&|d, _| d.fault.map_or(nan, |x| x.from_s)),
            );
            flights.push("fault_to_s", real(&|d, _| d.fault.map_or(nan, |x| x.to_s)));
        }
        for (i, figure) in FIGURES.iter().enumerate() {
            flights.push(figure.name, real(&|_, f| f.figures[i]));
        }
        flights.push("passed", flag(&|f| self.passed(f)));
        flights.push("departed", flag(&|f| self.departed(f)));
        flights.push("fault_as_stated", flag(&|f| f.fault_as_stated));
        flights.push("diverged", flag(&|f| f.diverged));

        let mut samples = Frame::default();
        let number = |x: &CampaignFlight| repeat_n(x.number as i64, x.result.samples.len());
        let numbers = all.iter().flat_map(number);
        samples.push("flight", Column::Integer(numbers.collect()));
        let single = |of: &dyn Fn(&Sample) -> f32| {
            let rows = all.iter().flat_map(|x| &x.result.samples);
            Column::Single(rows.map(of).collect())
        };
        samples.push("t_s", single(&|row| row.0));
        for (i, name) in SAMPLED.into_iter().enumerate() {
            samples.push(name, single(&|row| row.1[i]));
        }
        (flights, samples)
    }

    /// Whether `result` keeps every limit, whatever share of the flights has to.
    fn passed(&self, result: &FlightResult) -> bool {
        self.limits
            .iter()
            .all(|limit| limit.excess(limit.of(result)) <= 0.0)
    }

    fn departed(&self, result: &FlightResult) -> bool {
        let outside = |l: &super::Limit| l.departure && l.excess(l.of(result)) > 0.0;
        self.limits.iter().any(outside)
    }
}

impl super::Limit {
    fn of(&self, result: &FlightResult) -> f64 {
        result.figure(&self.figure)
    }
}
