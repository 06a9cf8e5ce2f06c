//! The columns of a record in space, each declared once: for the trace, the charts and the README.

use std::io::Write;

use alula::guidance::Unreachable;

use super::Step;
use crate::columns::Cell;

/// A column.
pub struct Column {
    /// Its name, with its unit.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// What it is.
    pub meaning: &'static str,
    /// Its cell in a row.
    pub read: fn(&Step) -> Cell,
}

macro_rules! columns {
    ($($name:literal, $unit:literal, $meaning:literal, $read:expr;)*) => {
        /// Every column, in the order of the trace.
        pub static COLUMNS: &[Column] = &[$(Column {
            name: $name,
            unit: $unit,
            meaning: $meaning,
            read: $read,
        }),*];
    };
}

fn double(value: f64) -> Cell {
    Cell::Double(value)
}

fn single(value: f32) -> Cell {
    Cell::Single(value)
}

fn word(name: &'static str) -> Cell {
    Cell::Word(name.into())
}

columns! {
    "t_s", "s", "time", |s| double(s.t);
    "north_m", "m", "position", |s| double(s.truth.position.x);
    "east_m", "m", "position", |s| double(s.truth.position.y);
    "down_m", "m", "position", |s| double(s.truth.position.z);
    "v_north_m_s", "m/s", "velocity", |s| double(s.truth.velocity.x);
    "v_east_m_s", "m/s", "velocity", |s| double(s.truth.velocity.y);
    "v_down_m_s", "m/s", "velocity", |s| double(s.truth.velocity.z);
    "q_w", "", "attitude: quaternion to north-east-down from x = belly, y = right wing, z = tail", |s| double(s.truth.attitude.w);
    "q_x", "", "attitude", |s| double(s.truth.attitude.i);
    "q_y", "", "attitude", |s| double(s.truth.attitude.j);
    "q_z", "", "attitude", |s| double(s.truth.attitude.k);
    "rate_belly_rad_s", "rad/s", "body rate about the belly axis: yaw in cruise", |s| double(s.truth.rates.x);
    "rate_wing_rad_s", "rad/s", "body rate about the right wing: pitch", |s| double(s.truth.rates.y);
    "rate_tail_rad_s", "rad/s", "body rate about the tail axis: roll to the left in cruise", |s| double(s.truth.rates.z);
    "true_thrust_n", "N", "thrust", |s| double(s.truth.thrust);
    "wind_north_m_s", "m/s", "wind", |s| double(s.wind.x);
    "wind_east_m_s", "m/s", "wind", |s| double(s.wind.y);
    "wind_down_m_s", "m/s", "wind", |s| double(s.wind.z);
    "path_north_m", "m", "position on the path", |s| double(s.target.position.x);
    "path_east_m", "m", "position on the path", |s| double(s.target.position.y);
    "path_down_m", "m", "position on the path", |s| double(s.target.position.z);
    "path_v_north_m_s", "m/s", "velocity on the path", |s| double(s.target.velocity.x);
    "path_v_east_m_s", "m/s", "velocity on the path", |s| double(s.target.velocity.y);
    "path_v_down_m_s", "m/s", "velocity on the path", |s| double(s.target.velocity.z);
    "heading_rad", "rad", "heading asked for; NaN if it is free", |s| double(s.target.heading.unwrap_or(f64::NAN));
    "velocity_error_m_s", "m/s", "\\|v − v_r\\|", |s| double(s.velocity_error());
    "position_error_m", "m", "\\|x − x_r\\|", |s| double(s.position_error());
    "altitude_m", "m", "altitude over the path", |s| double(s.altitude());
    "airspeed_m_s", "m/s", "\\|v_a\\|", |s| double((s.truth.velocity - s.wind).norm());
    "sideslip_rad", "rad", "angle of the air velocity from the plane of symmetry; below 1 m/s as at 1 m/s", |s| double(s.sideslip());
    "alpha_rad", "rad", "angle of attack of the body: from the nose to the air velocity in the plane of symmetry", |s| double(s.alpha());
    "bank_rad", "rad", "angle of the right wing below the horizontal", |s| double(s.bank());
    "pitch_rad", "rad", "angle of the nose over the horizontal", |s| double(s.pitch());
    "load_factor", "", "specific force over g: 1 in hover and in level cruise", |s| double(s.load_factor);
    "thrust_n", "N", "thrust commanded", |s| single(s.guided.command.thrust);
    "command_belly_rad_s", "rad/s", "body rate commanded", |s| single(s.guided.command.rates.j);
    "command_wing_rad_s", "rad/s", "body rate commanded", |s| single(s.guided.command.rates.w);
    "command_tail_rad_s", "rad/s", "body rate commanded", |s| single(s.guided.command.rates.i);
    "margin_k", "", "the guidance's margin: k", |s| single(s.guided.margin.k);
    "margin_fold_rad", "rad", "the guidance's margin: angle to the nearest fold, first order", |s| single(s.guided.margin.fold);
    "mode", "", "the guidance's mode", |s| word(s.guided.mode.name());
    "phase", "", "what the guidance does: `tracking`, `crossing`, `coasting` or `recovering`", |s| word(s.guided.progress.phase.name());
    "unreachable", "", "why the path cannot be had: `sink`, `speed` or `thrust`; empty if it can", |s| word(s.guided.progress.unreachable.map_or("", Unreachable::name));
    "status", "", "the guidance's flags", |s| Cell::Word(s.guided.status.to_string().into());
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

/// The column of this name.
pub fn column(name: &str) -> Option<&'static Column> {
    COLUMNS.iter().find(|column| column.name == name)
}

impl Column {
    /// The number in a row; NaN where there is none.
    pub fn number(&self, step: &Step) -> f64 {
        match (self.read)(step) {
            Cell::Single(value) => value.into(),
            Cell::Double(value) => value,
            Cell::Word(_) => f64::NAN,
        }
    }
}

/// Writes the trace of a flight as CSV: every column, one row per control step.
pub fn write_trace(record: &[Step], mut to: impl Write) -> std::io::Result<()> {
    let names: Vec<&str> = COLUMNS.iter().map(|column| column.name).collect();
    let mut text = names.join(",").into_bytes();
    for step in record {
        text.push(b'\n');
        for (i, column) in COLUMNS.iter().enumerate() {
            if i > 0 {
                text.push(b',');
            }
            (column.read)(step).push(&mut text);
        }
        if text.len() > 1 << 16 {
            to.write_all(&text)?;
            text.clear();
        }
    }
    text.push(b'\n');
    to.write_all(&text)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The README's table of columns is this one.
    #[test]
    fn every_column_is_documented() {
        let readme = include_str!("../../README.md");
        for (i, column) in COLUMNS.iter().enumerate() {
            assert!(COLUMNS[..i].iter().all(|c| c.name != column.name));
            let line = format!(
                "| `{}` | {} | {} |",
                column.name, column.unit, column.meaning
            );
            assert!(readme.contains(&line), "README.md lacks the line {line}");
        }
    }
}
