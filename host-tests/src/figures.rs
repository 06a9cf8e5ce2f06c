//! Figures of merit of a flight.

use serde::Serialize;

use crate::flight::Row;
use crate::reference::wrap;

/// The figures of merit. Those of |F_p| and ω are the controller's own, the others the plant's.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Figures {
    /// Largest |v − v_r| at a control step \[m/s\].
    pub max_velocity_error_m_s: f64,
    /// When.
    pub max_velocity_error_time_s: f64,
    /// Smallest |F_p| as the controller computes it \[N\]; none if every step was a fault.
    pub min_fp_n: Option<f64>,
    /// When.
    pub min_fp_time_s: Option<f64>,
    /// Largest |ω| commanded \[rad/s\].
    pub max_rate_rad_s: f64,
    /// When.
    pub max_rate_time_s: f64,
    /// |v − v_r| at the end \[m/s\].
    pub final_velocity_error_m_s: f64,
    /// True angle of attack at the end \[°\].
    pub final_alpha_deg: f64,
    /// True orientation at the end, in [−180, 180) \[°\].
    pub final_theta_deg: f64,
    /// Thrust over the true weight at the end.
    pub final_thrust_to_weight: f64,
    /// Control steps that ended in a fault and flew the safe command.
    pub faults: usize,
}

impl Figures {
    /// The figures of a flight of at least one row.
    pub fn of(rows: &[Row]) -> Self {
        let error = |row: &Row| row.velocity_error().norm();
        let rate = |row: &Row| f64::from(row.command().rate).abs();
        let largest = |value: &dyn Fn(&Row) -> f64| {
            let row = rows
                .iter()
                .max_by(|a, b| value(a).total_cmp(&value(b)))
                .expect("a flight has at least one row");
            (value(row), row.t)
        };
        let (max_velocity_error_m_s, max_velocity_error_time_s) = largest(&error);
        let (max_rate_rad_s, max_rate_time_s) = largest(&rate);
        let min_fp = rows
            .iter()
            .filter_map(|row| Some((f64::from(row.answer.ok()?.diagnostics.f_p_norm), row.t)))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let last = rows.last().expect("a flight has at least one row");
        Self {
            max_velocity_error_m_s,
            max_velocity_error_time_s,
            min_fp_n: min_fp.map(|(value, _)| value),
            min_fp_time_s: min_fp.map(|(_, time)| time),
            max_rate_rad_s,
            max_rate_time_s,
            final_velocity_error_m_s: error(last),
            final_alpha_deg: last.alpha.to_degrees(),
            final_theta_deg: wrap(last.truth.theta).to_degrees(),
            final_thrust_to_weight: last.thrust_to_weight,
            faults: rows.iter().filter(|row| row.answer.is_err()).count(),
        }
    }

    /// Label, value with unit, and where a peak lies its time: one line of the table each.
    pub fn table(&self) -> Vec<[String; 3]> {
        let line = |label: &str, value: String, at: Option<f64>| {
            let at = at.map_or(String::new(), |t| format!("at {t:.3} s"));
            [label.to_owned(), value, at]
        };
        let or_none = |value: Option<f64>| value.map_or("none".to_owned(), |v| format!("{v:.2} N"));
        vec![
            line(
                "largest velocity error",
                format!("{:.4} m/s", self.max_velocity_error_m_s),
                Some(self.max_velocity_error_time_s),
            ),
            line("smallest |F_p|", or_none(self.min_fp_n), self.min_fp_time_s),
            line(
                "largest angular rate",
                format!("{:.3} rad/s", self.max_rate_rad_s),
                Some(self.max_rate_time_s),
            ),
            line(
                "final velocity error",
                format!("{:.4} m/s", self.final_velocity_error_m_s),
                None,
            ),
            line(
                "final angle of attack",
                format!("{:.3}°", self.final_alpha_deg),
                None,
            ),
            line(
                "final orientation",
                format!("{:.3}°", self.final_theta_deg),
                None,
            ),
            line(
                "final thrust to weight",
                format!("{:.4}", self.final_thrust_to_weight),
                None,
            ),
            line("steps with a fault", self.faults.to_string(), None),
        ]
    }
}
