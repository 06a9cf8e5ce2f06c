//! tail-sitter, as tail-sitter.toml has it: `alula-sil code tail-sitter.toml` makes it anew. `mod vehicle;`, then `vehicle::guidance()`, once.

use alula::aero::{Node, Polar};
use alula::{
    Guidance, GuidanceParameters, ParameterError, Parameters as _, Table, Vehicle,
    VehicleParameters,
};

// Angle of attack to the zero-lift line [rad], c_L, c_D.
#[rustfmt::skip]
#[allow(clippy::approx_constant)] // a row at 30° is no constant of mathematics
static POLAR: Polar<59> = match Polar::new(&[
    Node { alpha: 0.0, c_l: 0.0, c_d: 0.044586 },
    Node { alpha: 0.017453292, c_l: 0.11, c_d: 0.044686 },
    Node { alpha: 0.034906585, c_l: 0.22, c_d: 0.045086 },
    Node { alpha: 0.05235988, c_l: 0.33, c_d: 0.045686 },
    Node { alpha: 0.06981317, c_l: 0.44, c_d: 0.046686 },
    Node { alpha: 0.08726646, c_l: 0.55, c_d: 0.048286 },
    Node { alpha: 0.10471976, c_l: 0.66, c_d: 0.049486 },
    Node { alpha: 0.12217305, c_l: 0.746, c_d: 0.051286 },
    Node { alpha: 0.13962634, c_l: 0.8274, c_d: 0.052786 },
    Node { alpha: 0.15707964, c_l: 0.8527, c_d: 0.054586 },
    Node { alpha: 0.17453292, c_l: 0.1325, c_d: 0.053086 },
    Node { alpha: 0.19198622, c_l: 0.1095, c_d: 0.110286 },
    Node { alpha: 0.20943952, c_l: 0.1533, c_d: 0.168286 },
    Node { alpha: 0.2268928, c_l: 0.203, c_d: 0.186286 },
    Node { alpha: 0.2443461, c_l: 0.2546, c_d: 0.205286 },
    Node { alpha: 0.2617994, c_l: 0.3082, c_d: 0.224286 },
    Node { alpha: 0.27925268, c_l: 0.362, c_d: 0.244286 },
    Node { alpha: 0.29670596, c_l: 0.42, c_d: 0.265286 },
    Node { alpha: 0.31415927, c_l: 0.4768, c_d: 0.286286 },
    Node { alpha: 0.33161256, c_l: 0.5322, c_d: 0.308286 },
    Node { alpha: 0.34906584, c_l: 0.587, c_d: 0.331286 },
    Node { alpha: 0.36651915, c_l: 0.6414, c_d: 0.354286 },
    Node { alpha: 0.38397244, c_l: 0.6956, c_d: 0.378286 },
    Node { alpha: 0.40142572, c_l: 0.7497, c_d: 0.403286 },
    Node { alpha: 0.41887903, c_l: 0.8034, c_d: 0.428286 },
    Node { alpha: 0.43633232, c_l: 0.8572, c_d: 0.454286 },
    Node { alpha: 0.4537856, c_l: 0.9109, c_d: 0.480286 },
    Node { alpha: 0.4712389, c_l: 0.9646, c_d: 0.507286 },
    Node { alpha: 0.5235988, c_l: 0.915, c_d: 0.604286 },
    Node { alpha: 0.61086524, c_l: 1.02, c_d: 0.779286 },
    Node { alpha: 0.6981317, c_l: 1.075, c_d: 0.954286 },
    Node { alpha: 0.7853982, c_l: 1.085, c_d: 1.109286 },
    Node { alpha: 0.87266463, c_l: 1.04, c_d: 1.249286 },
    Node { alpha: 0.9599311, c_l: 0.965, c_d: 1.379286 },
    Node { alpha: 1.0471976, c_l: 0.875, c_d: 1.504286 },
    Node { alpha: 1.134464, c_l: 0.765, c_d: 1.609286 },
    Node { alpha: 1.2217305, c_l: 0.65, c_d: 1.699286 },
    Node { alpha: 1.3089969, c_l: 0.515, c_d: 1.769286 },
    Node { alpha: 1.3962634, c_l: 0.37, c_d: 1.814286 },
    Node { alpha: 1.4835298, c_l: 0.22, c_d: 1.834286 },
    Node { alpha: 1.5707964, c_l: 0.07, c_d: 1.834286 },
    Node { alpha: 1.6580628, c_l: -0.07, c_d: 1.814286 },
    Node { alpha: 1.7453293, c_l: -0.22, c_d: 1.784286 },
    Node { alpha: 1.8325957, c_l: -0.37, c_d: 1.734286 },
    Node { alpha: 1.9198622, c_l: -0.51, c_d: 1.669286 },
    Node { alpha: 2.0071287, c_l: -0.625, c_d: 1.589286 },
    Node { alpha: 2.0943952, c_l: -0.735, c_d: 1.499286 },
    Node { alpha: 2.1816616, c_l: -0.84, c_d: 1.384286 },
    Node { alpha: 2.268928, c_l: -0.91, c_d: 1.259286 },
    Node { alpha: 2.3561945, c_l: -0.945, c_d: 1.119286 },
    Node { alpha: 2.443461, c_l: -0.945, c_d: 0.959286 },
    Node { alpha: 2.5307274, c_l: -0.91, c_d: 0.789286 },
    Node { alpha: 2.6179938, c_l: -0.85, c_d: 0.609286 },
    Node { alpha: 2.7052603, c_l: -0.74, c_d: 0.454286 },
    Node { alpha: 2.7925267, c_l: -0.66, c_d: 0.354286 },
    Node { alpha: 2.8797932, c_l: -0.675, c_d: 0.264286 },
    Node { alpha: 2.9670596, c_l: -0.85, c_d: 0.174286 },
    Node { alpha: 3.0543263, c_l: -0.69, c_d: 0.089286 },
    Node { alpha: 3.1415927, c_l: 0.0, c_d: 0.059286 },
]) {
    Ok(polar) => polar,
    // A row that is wrong does not compile.
    Err(_) => panic!(),
};

/// Its coefficients.
pub type Model = Table<'static>;

/// The guidance of the vehicle.
///
/// # Errors
/// None, unless the numbers are changed.
#[rustfmt::skip]
#[allow(clippy::approx_constant, clippy::excessive_precision)] // numbers as the file came to them
pub fn guidance() -> Result<Guidance<Model>, ParameterError> {
    let mut aircraft = VehicleParameters::DEFAULT;
    aircraft.mass = 3.0;
    aircraft.k_a = 0.214375;
    aircraft.thrust_max = 47.088;
    aircraft.authority = 0.0;
    aircraft.authority_slipstream = 150.0;
    aircraft.authority_difference = 250.0;
    aircraft.authority_airflow = 1.1585517;
    aircraft.wing_moment = 0.21323332;
    aircraft.surface_reaction = 0.20408688;
    aircraft.hover_downwash = 8.0;
    aircraft.zero_thrust_speed = 26.31015;
    let mut parameters = GuidanceParameters::DEFAULT;
    parameters.natural_frequency = 4.0;
    parameters.damping = 0.8;
    parameters.thrust_rate = 3.0;
    parameters.gain_schedule_floor = 0.57;
    parameters.tau = 0.91;
    parameters.altitude_band = 0.33;
    parameters.velocity_band_down = 1.58;
    parameters.velocity_band_forward = 3.3;
    parameters.rate_lag = 0.06;
    parameters.thrust_lag = 0.08;
    parameters.position_gain_down = 1.43;
    parameters.position_gain_forward = 0.81;
    parameters.max_velocity_down = 4.7;
    parameters.max_sink = 1.2;
    parameters.max_velocity_forward = 3.6;
    parameters.integral_gain_down = 0.3;
    parameters.integral_gain_forward = 0.1;
    parameters.max_integral_down = 2.0;
    parameters.max_integral_forward = 1.0;
    parameters.max_lateral_acceleration = 2.0;
    parameters.max_load_factor = 1000.0;
    parameters.max_rate = 2.8;
    parameters.max_slew = 50.0;
    parameters.hold = 0.1;
    parameters.recovery = 0.05;
    parameters.state_age = 0.05;
    parameters.reference_age = 0.5;
    parameters.air_hold = 2.0;
    parameters.max_wind = 40.0;
    parameters.max_wind_step = 10.0;
    parameters.safe_thrust = 0.95;
    Guidance::new(Vehicle::new(aircraft, Table::new(&POLAR))?, &parameters)
}
