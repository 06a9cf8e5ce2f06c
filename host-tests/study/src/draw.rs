//! The experiment that is drawn for one flight of a campaign.

use rand::{Rng, RngExt};
use toml::Value;

use super::{Campaign, Dispersion, DrawnReference};
use alula_sim::experiment::{Document, Experiment, FieldError, stream};

/// What was drawn for a flight.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawn {
    /// The experiment.
    pub experiment: Experiment,
    /// The same as a document.
    pub document: Document,
    /// Values of the dispersed fields, in the campaign's order; of a name its place in the list.
    pub values: Vec<f64>,
    /// The reference, if the campaign draws it.
    pub reference: Option<DrawnReference>,
    /// The fault, if the campaign has any.
    pub fault: Option<DrawnFault>,
}

/// A fault that was drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawnFault {
    /// Which of the campaign's.
    pub index: usize,
    /// From when \[s\].
    pub from_s: f64,
    /// Until when \[s\].
    pub to_s: f64,
}

impl Dispersion {
    /// The field's value, where so much is `drawn` already.
    fn draw(
        &self,
        base: &Document,
        drawn: &Document,
        random: &mut impl Rng,
    ) -> Result<f64, FieldError> {
        let value = match (&self.scale, &self.add, &self.to) {
            (Some(scale), ..) => base.number(&self.field)? * scale.draw(random),
            (_, Some(add), _) => base.number(&self.field)? + add.draw(random),
            (.., Some(to)) => to.draw(random),
            (None, None, None) => unreachable!("validated when loaded"),
        };
        let mut product = value;
        for (field, exponent) in &self.powers {
            product *= drawn.number(field)?.powf(*exponent);
        }
        let mut value = match &self.plus {
            Some(field) => product + drawn.number(field)?,
            None => product,
        };
        for (field, factor) in &self.at_most {
            value = value.min(factor * drawn.number(field)?);
        }
        Ok(value)
    }
}

impl Campaign {
    /// What flight `number` flies, which is `base` but for what is drawn. Each flight has a stream of random numbers of
    /// its own, and depends on no other.
    pub fn draw(&self, base: &Document, number: u64) -> Result<Drawn, FieldError> {
        let mut random = stream(self.seed, number);
        let mut document = base.clone();
        // TOML's integers have a sign.
        let seed = i64::try_from(random.next_u64() >> 1).expect("63 bits");
        document.set("seed", Value::Integer(seed))?;
        let mut values = Vec::with_capacity(self.disperse.len());
        for dispersion in &self.disperse {
            let (value, number) = match &dispersion.names {
                Some(names) => {
                    let index = random.random_range(0..names.len());
                    (Value::String(names[index].clone()), index as f64)
                }
                None => {
                    let number = dispersion.draw(base, &document, &mut random)?;
                    (Value::Float(number), number)
                }
            };
            document.set(&dispersion.field, value)?;
            values.push(number);
        }
        let reference = self.reference.as_ref().map(|r| r.draw(&mut random));
        if let Some(reference) = &reference {
            document.set("reference", reference.value())?;
        }
        let mut fault = None;
        if !self.faults.is_empty() {
            let index = random.random_range(0..self.faults.len());
            let from_s = self.faults[index].from_s.draw(&mut random);
            let to_s = from_s + self.faults[index].lasts_s.draw(&mut random);
            let kind = Value::try_from(self.faults[index].kind).expect("a name");
            let size = self.faults[index].size.as_ref();
            let size = size.map(|size| ("size", Value::Float(size.draw(&mut random))));
            let table = [
                ("kind", kind),
                ("from_s", Value::Float(from_s)),
                ("to_s", Value::Float(to_s)),
            ];
            let table = table.into_iter().chain(size);
            let table = table.map(|(key, value)| (key.to_owned(), value));
            let list = vec![Value::Table(table.collect())];
            document.set("sensors.faults", Value::Array(list))?;
            fault = Some(DrawnFault {
                index,
                from_s,
                to_s,
            });
        }
        Ok(Drawn {
            experiment: document.experiment()?,
            document,
            values,
            reference,
            fault,
        })
    }
}

impl DrawnFault {
    /// The fault's last control step of `experiment`; none if no step falls into it.
    pub(super) fn last_step(&self, experiment: &Experiment) -> Option<usize> {
        let (steps, rate) = (experiment.steps(), experiment.control_rate_hz);
        let lasts = |step: &usize| {
            let t = *step as f64 / rate;
            (self.from_s..self.to_s).contains(&t)
        };
        let near = (self.to_s * rate).ceil() as usize + 1;
        (0..=near.min(steps)).rev().find(lasts)
    }
}
