//! Where a campaign flies: in the vertical plane, or in space.

use alula_sim::columns;
use alula_sim::columns::Flight;
use alula_sim::experiment::{self, Document, FieldError};
use alula_sim::figures;
use alula_sim::space;

/// Where an experiment is flown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// In the vertical plane.
    Plane,
    /// In space: the experiment has a path.
    Space,
}

/// Columns of the record whose course is sampled.
pub const SAMPLED: usize = 6;

impl Place {
    /// That of the experiment in `document`.
    pub fn of(document: &Document) -> Self {
        match document.get("path") {
            Some(_) => Self::Space,
            None => Self::Plane,
        }
    }

    /// Names of the figures, in the order in which a flight has them.
    pub fn figures(self) -> Vec<&'static str> {
        match self {
            Self::Plane => figures::FIGURES.iter().map(|f| f.name).collect(),
            Self::Space => space::FIGURES.iter().map(|f| f.name).collect(),
        }
    }

    /// Place of a figure among them.
    pub fn figure(self, name: &str) -> Option<usize> {
        self.figures().iter().position(|known| *known == name)
    }

    /// The columns of the record whose course is sampled.
    pub fn sampled(self) -> [&'static str; SAMPLED] {
        match self {
            Self::Plane => [
                "altitude_m",
                "forward_m",
                "true_v_forward_m_s",
                "velocity_error_m_s",
                "true_theta_rad",
                "thrust_to_weight",
            ],
            Self::Space => [
                "altitude_m",
                "position_error_m",
                "velocity_error_m_s",
                "airspeed_m_s",
                "bank_rad",
                "load_factor",
            ],
        }
    }

    /// What a column is.
    pub fn meaning(self, name: &str) -> Option<&'static str> {
        match self {
            Self::Plane => columns::column(name).map(|column| column.meaning),
            Self::Space => space::Experiment::column(name).map(|column| column.meaning),
        }
    }
}

/// An experiment of either kind.
#[derive(Clone, Debug, PartialEq)]
pub enum Experiment {
    /// In the vertical plane.
    Plane(Box<experiment::Experiment>),
    /// In space.
    Space(Box<space::Experiment>),
}

impl Experiment {
    /// The experiment of `document`.
    pub fn of(document: &Document) -> Result<Self, FieldError> {
        match Place::of(document) {
            Place::Plane => Ok(Self::Plane(Box::new(document.experiment()?))),
            Place::Space => Ok(Self::Space(Box::new(space::Experiment::checked(document)?))),
        }
    }

    /// That of a flight in the plane.
    pub fn plane(&self) -> Option<&experiment::Experiment> {
        match self {
            Self::Plane(experiment) => Some(experiment),
            Self::Space(_) => None,
        }
    }

    /// That of a flight in space.
    pub fn space(&self) -> Option<&space::Experiment> {
        match self {
            Self::Plane(_) => None,
            Self::Space(experiment) => Some(experiment),
        }
    }

    /// Whether the guidance flies it, to which faults are done.
    pub(super) fn is_guided(&self) -> bool {
        match self {
            Self::Plane(experiment) => experiment.controller.name() == "guidance",
            Self::Space(_) => true,
        }
    }

    /// Number of control periods flown, and their rate \[Hz\].
    pub(super) fn steps(&self) -> (usize, f64) {
        match self {
            Self::Plane(e) => (e.steps(), e.control_rate_hz),
            Self::Space(e) => (e.steps(), e.control_rate_hz),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each place samples columns that its record has, and has the two figures by which a page warns.
    #[test]
    fn every_sampled_column_is_in_the_record() {
        for place in [Place::Plane, Place::Space] {
            for name in place.sampled() {
                assert!(place.meaning(name).is_some(), "{name}");
            }
            for name in ["lost", "altitude_least_m"] {
                assert!(place.figure(name).is_some(), "{name}");
            }
        }
        assert_eq!(Place::Plane.figure("sideslip_rms_deg"), None);
    }
}
