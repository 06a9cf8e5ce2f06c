//! The columns of a record in space, each declared once: for the trace, the charts and the README.

use alula::guidance::Unreachable;

use super::{Experiment, Step};
use crate::columns::{Cell, columns, double, single, word};

columns! { Experiment, Step;
    "t_s", "time", |_, s| double(s.t);
    "north_m", "position", |_, s| double(s.truth.position.x);
    "east_m", "position", |_, s| double(s.truth.position.y);
    "down_m", "position", |_, s| double(s.truth.position.z);
    "v_north_m_s", "velocity", |_, s| double(s.truth.velocity.x);
    "v_east_m_s", "velocity", |_, s| double(s.truth.velocity.y);
    "v_down_m_s", "velocity", |_, s| double(s.truth.velocity.z);
    "q_w", "attitude: quaternion to north-east-down from x = belly, y = right wing, z = tail", |_, s| double(s.truth.attitude.w);
    "q_x", "attitude", |_, s| double(s.truth.attitude.i);
    "q_y", "attitude", |_, s| double(s.truth.attitude.j);
    "q_z", "attitude", |_, s| double(s.truth.attitude.k);
    "rate_belly_rad_s", "body rate about the belly axis: yaw in cruise", |_, s| double(s.truth.rates.x);
    "rate_wing_rad_s", "body rate about the right wing: pitch", |_, s| double(s.truth.rates.y);
    "rate_tail_rad_s", "body rate about the tail axis: roll to the left in cruise", |_, s| double(s.truth.rates.z);
    "true_thrust_n", "thrust", |_, s| double(s.truth.thrust);
    "wind_north_m_s", "wind", |_, s| double(s.wind.x);
    "wind_east_m_s", "wind", |_, s| double(s.wind.y);
    "wind_down_m_s", "wind", |_, s| double(s.wind.z);
    "path_north_m", "position on the path", |_, s| double(s.target.position.x);
    "path_east_m", "position on the path", |_, s| double(s.target.position.y);
    "path_down_m", "position on the path", |_, s| double(s.target.position.z);
    "path_v_north_m_s", "velocity on the path", |_, s| double(s.target.velocity.x);
    "path_v_east_m_s", "velocity on the path", |_, s| double(s.target.velocity.y);
    "path_v_down_m_s", "velocity on the path", |_, s| double(s.target.velocity.z);
    "heading_rad", "heading asked for; NaN if it is free", |_, s| double(s.target.heading.unwrap_or(f64::NAN));
    "velocity_error_m_s", "\\|v − v_r\\|", |_, s| double(s.velocity_error());
    "position_error_m", "\\|x − x_r\\|", |_, s| double(s.position_error());
    "altitude_m", "altitude over the path", |_, s| double(s.altitude());
    "airspeed_m_s", "\\|v_a\\|", |_, s| double((s.truth.velocity - s.wind).norm());
    "sideslip_rad", "angle of the air velocity from the plane of symmetry; below 1 m/s as at 1 m/s", |_, s| double(s.sideslip());
    "alpha_rad", "angle of attack of the body: from the nose to the air velocity in the plane of symmetry", |_, s| double(s.alpha());
    "bank_rad", "angle of the right wing below the horizontal", |_, s| double(s.bank());
    "pitch_rad", "angle of the nose over the horizontal", |_, s| double(s.pitch());
    "load_factor", "specific force over g: 1 in hover and in level cruise", |_, s| double(s.load_factor);
    "thrust_n", "thrust commanded", |_, s| single(s.guided.command.thrust);
    "command_belly_rad_s", "body rate commanded", |_, s| single(s.guided.command.rates.j);
    "command_wing_rad_s", "body rate commanded", |_, s| single(s.guided.command.rates.w);
    "command_tail_rad_s", "body rate commanded", |_, s| single(s.guided.command.rates.i);
    "margin_k", "the guidance's margin: k", |_, s| single(s.guided.margin.k);
    "margin_fold_rad", "the guidance's margin: angle to the nearest fold, first order", |_, s| single(s.guided.margin.fold);
    "mode", "the guidance's mode", |_, s| word(Some(s.guided.mode.name()));
    "phase", "what the guidance does: `tracking`, `crossing`, `coasting` or `recovering`", |_, s| word(Some(s.guided.progress.phase.name()));
    "unreachable", "why the path cannot be had: `sink`, `speed` or `thrust`; empty if it can", |_, s| word(Some(s.guided.progress.unreachable.map_or("", Unreachable::name)));
    "status", "the guidance's flags", |_, s| Some(Cell::Word(s.guided.status.to_string().into()));
}

impl Step {
    /// |v − v_r| \[m/s\].
    pub fn velocity_error(&self) -> f64 {
        (self.truth.velocity - self.target.velocity).norm()
    }

    /// |x − x_r| \[m\].
    pub fn position_error(&self) -> f64 {
        (self.truth.position - self.target.position).norm()
    }

    /// Altitude over the path \[m\].
    pub fn altitude(&self) -> f64 {
        self.target.position.z - self.truth.position.z
    }

    /// Angle of the air velocity from the plane of symmetry \[rad\].
    pub fn sideslip(&self) -> f64 {
        let v_a = self.truth.velocity - self.wind;
        let [_, _, right] = self.truth.axes();
        (v_a.dot(&right) / v_a.norm().max(1.0)).asin()
    }

    /// Angle from the nose to the air velocity in the plane of symmetry \[rad\].
    pub fn alpha(&self) -> f64 {
        let v_a = self.truth.velocity - self.wind;
        let [tail, belly, _] = self.truth.axes();
        v_a.dot(&belly).atan2(-v_a.dot(&tail))
    }

    /// Angle of the right wing below the horizontal \[rad\].
    pub fn bank(&self) -> f64 {
        let [_, _, right] = self.truth.axes();
        right.z.clamp(-1.0, 1.0).asin()
    }

    /// Angle of the nose over the horizontal \[rad\].
    pub fn pitch(&self) -> f64 {
        let [tail, ..] = self.truth.axes();
        tail.z.clamp(-1.0, 1.0).asin()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The README's table of columns is this one.
    #[test]
    fn every_column_is_documented() {
        let readme = include_str!("../../../README.md");
        for (i, column) in COLUMNS.iter().enumerate() {
            assert!(COLUMNS[..i].iter().all(|c| c.name != column.name));
            let line = format!(
                "| `{}` | {} | {} |",
                column.name,
                column.unit(),
                column.meaning
            );
            assert!(readme.contains(&line), "README.md lacks the line {line}");
        }
    }
}
