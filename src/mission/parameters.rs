//! How missions are flown.

use crate::parameters::Parameters;

crate::parameters! {
    /// How missions are flown. What the vehicle can do is not here: it follows from what is believed of it.
    #[non_exhaustive]
    pub struct MissionParameters, "Mission" {
        cruise_speed: "m/s", 1.0, 340.0, f32::NAN, "ALU_M_CRUISE",
            "Airspeed of the items before the first that changes the speed.";
        bank: "rad", 0.05, 1.2, 0.5, "ALU_M_BANK",
            "Bank of turns on the wing. Less where the wing does not carry it.";
        acceleration: "m/s^2", 0.1, 10.0, 2.0, "ALU_M_ACC",
            "Acceleration on the way to a speed. On the wing it slows down by drag alone.";
        braking: "m/s^2", 0.1, 10.0, 1.5, "ALU_M_BRAKE",
            "Deceleration on the way to a place of hover.";
        braking_climb: "m", 0.0, 1e3, 100.0, "ALU_M_BCLIMB",
            "Greatest climb in which it brakes from the wing to hover, at 3 m/s². A vehicle that does not hold its wing across the air takes 1.67 V²/2g of it, and brakes level where that is more; the others brake level.";
        climb: "m/s", 0.1, 50.0, 3.0, "ALU_M_CLIMB",
            "Greatest climb.";
        sink: "m/s", 0.1, 50.0, 1.5, "ALU_M_SINK",
            "Greatest sink in hover.";
        hover_speed: "m/s", 0.1, 50.0, 4.0, "ALU_M_HOVER",
            "Speed over ground between places that are too near to each other for the wing.";
        glide_share: "", 0.1, 1.0, 0.8, "ALU_M_GLIDE",
            "Steepest descent on the wing, in multiples of the glide without thrust.";
        yield_share: "", 0.0, 1.0, 0.9, "ALU_M_YIELD",
            "Least airspeed that is asked for on the wing, in multiples of the one there is: the wing cannot brake.";
        safe_height: "m", 1.0, 1e4, 20.0, "ALU_M_SAFE",
            "Least height over the take-off to return at, and to go around to.";
        flare_height: "m", 0.5, 100.0, 3.0, "ALU_M_FLARE",
            "Height over the place of landing below which it is approached with landing_speed.";
        landing_speed: "m/s", 0.1, 2.0, 0.4, "ALU_M_LAND",
            "Sink at touch-down.";
        spool_time: "s", 0.1, 10.0, 0.4, "ALU_M_SPOOL",
            "Time in which the thrust grows to the weight before take-off.";
        hover_downwash: "m/s", 1.0, 100.0, 10.0, "ALU_M_DOWNWASH",
            "Speed that the propellers give the air in hover, at their discs. For the energy.";
    }
}

impl MissionParameters {
    /// The parameters of a vehicle with this speed of cruise [m/s], all others at their defaults.
    pub const fn cruising_at(speed: f32) -> Self {
        Self {
            cruise_speed: speed,
            ..Self::DEFAULT
        }
    }
}
