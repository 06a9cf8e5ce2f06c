//! Parameters of the core by name: every range, default and meaning is read from the core's own table.

use alula::{ParameterError, Parameters, Requirement, Row, VehicleParameters};
use serde::de::DeserializeOwned;
use toml::{Table, Value};

use super::document::{Document, FieldError, read};
use super::vehicle::VehicleSpec;
use crate::named::hint;

/// Name of a parameter in files: the core's name and its unit. Angles are in degrees there.
pub fn file_name(row: &Row) -> String {
    let unit = match row.unit {
        "" => return row.name.to_owned(),
        "rad" => "deg".to_owned(),
        unit => unit
            .replace('^', "")
            .replace(['/', ' '], "_")
            .to_lowercase(),
    };
    // Gains and coefficients have no unit in their names: theirs say nothing to anybody.
    match row.name {
        "k1" | "k2" | "k3" | "c2" | "c3" | "k_l" | "k_d" => row.name.to_owned(),
        name => format!("{name}_{unit}"),
    }
}

/// A value of the core in double precision: the shortest decimal that reads back to it, as somebody may have written it.
pub fn double(value: f32) -> f64 {
    let text = value.to_string();
    text.parse().expect("a number reads back")
}

/// An angle \[rad\] of the core in degrees: as [`double`], if that reads back to it.
pub(crate) fn degrees(value: f32) -> f64 {
    let exact = f64::from(value).to_degrees();
    let short = double(exact as f32);
    match short.to_radians() as f32 == value {
        true => short,
        false => exact,
    }
}

/// The value of a parameter in files, in the unit of [`file_name`].
pub fn file_value(row: &Row, value: f32) -> f64 {
    match row.unit {
        "rad" => degrees(value),
        _ => double(value),
    }
}

/// A refusal of the core under the name that the field has in files. A relation may be to a parameter of the vehicle.
pub fn refused<P: Parameters>(error: ParameterError) -> FieldError {
    let mut rows = P::ROWS.iter().chain(VehicleParameters::ROWS);
    let row = rows.find(|row| row.name == error.parameter);
    let field = row.map_or(error.parameter.to_owned(), file_name);
    // Ranges of the core are in radians.
    let error = match error.requirement {
        Requirement::Within {
            min,
            max,
            unit: "rad",
        } => {
            let range = [min, max].map(f32::to_degrees);
            ParameterError::range(error.parameter, error.problem, range, "°")
        }
        _ => error,
    };
    FieldError::new(field, error.to_string())
}

/// A table whose fields are taken out one by one.
pub struct Fields {
    table: Table,
    /// The names that were asked for.
    known: Vec<String>,
}

impl From<Table> for Fields {
    fn from(table: Table) -> Self {
        let known = Vec::new();
        Self { table, known }
    }
}

impl Fields {
    /// The fields of a table.
    pub fn new(table: Value) -> Result<Self, FieldError> {
        Ok(read::<Table>(table)?.into())
    }

    /// The field `key`, if it is there.
    pub fn take<T: DeserializeOwned>(&mut self, key: &str) -> Result<Option<T>, FieldError> {
        self.known.push(key.to_owned());
        let value = self.table.remove(key).map(read::<T>).transpose();
        value.map_err(|e| e.inside(key))
    }

    /// What a controller believes about the vehicle: a table, or the name of a document whose vehicle it is.
    pub fn belief(&mut self) -> Result<Option<VehicleSpec>, FieldError> {
        let Some(Value::String(name)) = self.table.get("vehicle").cloned() else {
            return self.take("vehicle");
        };
        self.table.remove("vehicle");
        let document = Document::load(&name);
        let vehicle = document.and_then(|d| d.vehicle().map_err(|e| d.located(e)));
        let error = |e: anyhow::Error| FieldError::new("vehicle", format!("{e:#}"));
        vehicle.map(Some).map_err(error)
    }

    /// The parameters of a table in the core, each at its default if it is left out.
    pub fn parameters<P: Parameters>(&mut self) -> Result<P, FieldError> {
        let mut parameters = P::DEFAULT;
        for (i, row) in P::ROWS.iter().enumerate() {
            let name = file_name(row);
            match self.take::<f64>(&name)? {
                Some(value) if row.unit == "rad" => {
                    parameters.set(i, value.to_radians() as f32);
                }
                Some(value) => parameters.set(i, value as f32),
                None if row.default.is_nan() => return Err(self.missing::<P>(name)),
                None => {}
            }
        }
        parameters.check().map_err(refused::<P>)?;
        Ok(parameters)
    }

    /// The refusal for want of `name`: a field that is none, whose name is near to it, is meant for it.
    fn missing<P: Parameters>(&self, name: String) -> FieldError {
        let known = |key: &&String| P::ROWS.iter().any(|row| file_name(row) == **key);
        let mut others = self.table.keys().filter(|key| !known(key));
        let meant = others.find_map(|key| {
            let hint = hint(key, &[&name]);
            (!hint.is_empty()).then(|| FieldError::new(key, format!("unknown field `{key}`{hint}")))
        });
        meant.unwrap_or_else(|| FieldError::new(name, "is missing"))
    }

    /// The rows of the parameters of a table in the core that are there.
    pub fn given<P: Parameters>(&self) -> Vec<usize> {
        let rows = P::ROWS.iter().enumerate();
        let there = rows.filter(|(_, row)| self.table.contains_key(&file_name(row)));
        there.map(|(i, _)| i).collect()
    }

    /// The parameters in the inner table `key`, if it is there.
    pub fn inner<P: Parameters>(&mut self, key: &str) -> Result<Option<P>, FieldError> {
        let Some(table) = self.take::<Table>(key)? else {
            return Ok(None);
        };
        let mut fields = Self::from(table);
        let parameters = fields.parameters();
        let all = parameters.and_then(|parameters| fields.end().map(|()| Some(parameters)));
        all.map_err(|e| e.inside(key))
    }

    /// Refuses what has not been taken.
    pub fn end(self) -> Result<(), FieldError> {
        let Some(name) = self.table.keys().next() else {
            return Ok(());
        };
        let known: Vec<&str> = self.known.iter().map(String::as_str).collect();
        let problem = format!("unknown field `{name}`{}", hint(name, &known));
        Err(FieldError::new(name, problem))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alula::planar::GainParameters;
    use alula::{CombinedParameters, GuidanceParameters};

    fn fields(text: &str) -> Fields {
        text.parse::<Table>().unwrap().into()
    }

    #[test]
    fn names_have_units() {
        let names = |rows: &[Row]| rows.iter().map(file_name).collect::<Vec<_>>().join(" ");
        assert_eq!(
            names(VehicleParameters::ROWS),
            "mass_kg k_a_kg_m delta_deg c_y gravity_m_s2 thrust_min_n thrust_max_n authority_rad_s2 authority_slipstream_rad_s2 \
             authority_difference_rad_s2 authority_airflow_rad_m2 wing_moment_rad_m2 roll_authority_rad_m_s2 surface_reaction_m hover_downwash_m_s \
             zero_thrust_speed_m_s"
        );
        assert_eq!(names(GainParameters::ROWS), "k1 k2 k3 tau_n");
        // As the tables of `[vehicle.aerodynamics]` have them.
        assert_eq!(
            names(CombinedParameters::ROWS),
            "c0 c1 c2 c3 alpha_bar_deg k_l k_d"
        );
        assert!(names(GuidanceParameters::ROWS).starts_with(
            "natural_frequency_rad_s damping thrust_rate_1_s gain_schedule_floor_mg tau_mg"
        ));
    }

    #[test]
    fn values_are_read_by_name_and_the_rest_is_refused() {
        let text = "mass_kg = 2\nk_a_kg_m = 0.1\ndelta_deg = 90\nthrust_max_n = 50\nspan_m = 1";
        let mut table = fields(text);
        let vehicle: VehicleParameters = table.parameters().unwrap();
        assert_eq!((vehicle.mass, vehicle.gravity), (2.0, 9.81));
        assert_eq!(vehicle.delta, std::f32::consts::FRAC_PI_2);
        assert_eq!(
            table.end().unwrap_err().to_string(),
            "span_m: unknown field `span_m`"
        );
        // In the unit of the file, not of the core.
        let turned = VehicleParameters::DEFAULT
            .mass(2.0)
            .k_a(0.1)
            .thrust_max(50.0)
            .delta(7.0);
        assert_eq!(
            refused::<VehicleParameters>(turned.check().unwrap_err()).to_string(),
            "delta_deg: delta must be from -180 to 180 °"
        );
        let mut slip = fields("mass_kg = 2\nk_a_kg_m = 0.1\ndelta_dge = 90\nthrust_max_n = 50");
        slip.parameters::<VehicleParameters>().unwrap();
        assert_eq!(
            slip.end().unwrap_err().to_string(),
            "delta_dge: unknown field `delta_dge`; did you mean `delta_deg`?"
        );
        // An old name is refused with the new one, even where it is near to another.
        let mut old = fields("force_floor_mg = 0.5");
        old.parameters::<GuidanceParameters>().unwrap();
        assert_eq!(
            old.end().unwrap_err().to_string(),
            "force_floor_mg: unknown field `force_floor_mg`; its name is `gain_schedule_floor_mg` now"
        );
        let error = |text: &str| {
            let read = fields(text).parameters::<VehicleParameters>();
            read.unwrap_err().to_string()
        };
        assert_eq!(error("mass_kg = 1"), "k_a_kg_m: is missing");
        // Not "mass_kg: is missing"; and a name that is known is not meant for another.
        assert_eq!(
            error("mass = 2.2\nk_a_kg_m = 1\nthrust_max_n = 9"),
            "mass: unknown field `mass`; did you mean `mass_kg`?"
        );
        assert_eq!(
            error("mass_kg = 1\nk_a_kg_m = 1\nthrust_min_n = 1"),
            "thrust_max_n: is missing"
        );
        let text = "mass_kg = 1\nk_a_kg_m = 1\nthrust_max_n = 9\n";
        assert!(error(&format!("{text}delta_deg = 200")).starts_with("delta_deg: delta must be"));
        assert!(error(&format!("{text}gravity_m_s2 = 'g'")).starts_with("gravity_m_s2: invalid"));
    }
}
