//! An aerodynamic model of one's own: the trait has one function, of six numbers. `cargo run --example own_model`
use alula::aero::Coefficients;
use alula::planar::{GainParameters, Gains, Reference, State, VelocityControl};
use alula::{
    Aerodynamics, AngleOfAttack, ParameterError, Parameters, Vehicle, VehicleParameters,
    aerodynamic_constant,
};

/// A thin plate of aspect ratio that is far from small: c_L = s sin 2α, c_D = c_0 + 2 s sin²α.
struct Plate {
    s: f32,
    c_0: f32,
}

impl Aerodynamics for Plate {
    #[inline]
    fn coefficients(&self, alpha: AngleOfAttack) -> Coefficients {
        // sin 2α and cos 2α from sin α and cos α: no trigonometry is computed.
        let (sin, cos) = (alpha.sin, alpha.cos);
        let (sin_2, cos_2) = (2.0 * sin * cos, cos * cos - sin * sin);
        // The derivatives are with respect to α. What is inconsistent here is felt as a wrong equilibrium.
        Coefficients {
            c_l: self.s * sin_2,
            c_d: self.c_0 + 2.0 * self.s * sin * sin,
            dc_l: 2.0 * self.s * cos_2,
            dc_d: 2.0 * self.s * sin_2,
            ddc_l: -4.0 * self.s * sin_2,
            ddc_d: 4.0 * self.s * cos_2,
        }
    }
}

fn main() -> Result<(), ParameterError> {
    let plate = Plate { s: 1.0, c_0: 0.02 };
    // The derivatives against differences.
    for degrees in [-150.0_f32, -20.0, 5.0, 80.0] {
        let at =
            |degrees: f32| plate.coefficients(AngleOfAttack::from_radians(degrees.to_radians()));
        let (before, here, after) = (at(degrees - 0.5), at(degrees), at(degrees + 0.5));
        let slope = (after.c_l - before.c_l) / 1.0_f32.to_radians();
        // A difference over a degree is off by its third derivative: 1.3e-3.
        assert!((slope - here.dc_l).abs() < 2e-3, "{slope} {}", here.dc_l);
    }

    let vehicle = Vehicle::new(
        VehicleParameters::DEFAULT
            .mass(3.0)
            .k_a(aerodynamic_constant(1.2, 0.35)?)
            .thrust_max(47.0),
        plate,
    )?;
    let control = VelocityControl::new(vehicle, Gains::new(GainParameters::PAPER)?);
    let command = control
        .robust(&State::default(), &Reference::default(), None)
        .unwrap_or_default();
    println!("hover: {:.2} N", command.thrust);
    // The weight: there is no air velocity.
    assert!((command.thrust - 3.0 * 9.81).abs() < 0.1);
    Ok(())
}
