//! The constants of planner and reference model that were searched for.

crate::parameters! {
    /// The constants of planner and reference model that a search found: `alula-sil tune`, with its objective, flights and seeds, finds them
    /// again. They suit any vehicle; who flies one leaves them as they are. The ranges are those that were searched.
    #[non_exhaustive]
    pub struct Tuning, "Tuning" {
        to_go: "", 0.1, 4.0, 0.76, "ALU_TN_TO_GO",
            "Weight in a plan's cost of the time that errors left at its end take to close.";
        terminal_thrust: "s", 0.5, 50.0, 8.0, "ALU_TN_THRUST",
            "Cost of thrust spent from the beginning to the end of a plan where the wing has lift in reserve, per squared weight.";
        hysteresis: "", 0.01, 0.7, 0.161, "ALU_TN_HYST",
            "Part of a plan's cost, and of a second besides, by which another one must cost less.";
        short_push: "s", 0.002, 0.1, 0.022, "ALU_TN_SHORT",
            "Time of a short push-over, per load factor that the wing can carry.";
        long_push: "s", 0.02, 0.3, 0.0885, "ALU_TN_LONG",
            "Time of a long push-over, per load factor that the wing can carry.";
        push_over: "g", 0.6, 3.0, 1.52, "ALU_TN_PUSH",
            "Acceleration down that a push-over asks for.";
        attitude_gain: "1/s", 3.0, 20.0, 9.0, "ALU_TN_ATT",
            "Rate per attitude error of the servo and of turns.";
        max_correction: "rad", 0.08, 0.8, 0.28, "ALU_TN_STEP",
            "Greatest step of the servo: beyond it the linearisation says nothing.";
        vertical_gain: "1/s", 1.5, 10.0, 4.8, "ALU_TN_VERT",
            "Acceleration down per velocity error that the servo asks for.";
        forward_gain: "1/s", 0.3, 4.0, 1.11, "ALU_TN_FWD",
            "Acceleration forward per velocity error that the servo asks for.";
        max_vertical: "g", 0.6, 2.5, 1.24, "ALU_TN_MAX_VERT",
            "Greatest vertical acceleration that the servo asks for.";
        max_forward: "g", 0.4, 2.5, 1.1, "ALU_TN_MAX_FWD",
            "Greatest forward acceleration that the servo asks for.";
        forward_weight: "", 0.01, 0.6, 0.103, "ALU_TN_WEIGHT",
            "Weight of forward accelerations against vertical ones in the servo's least squares.";
        damping: "mg", 0.05, 2.0, 0.41, "ALU_TN_DAMP",
            "Damping of the servo's step, as a force.";
        resynchronisation: "1/s", 0.5, 20.0, 4.6, "ALU_TN_SYNC",
            "Rate at which the model's velocity goes to the vehicle's where the law has no say.";
    }
}

impl Default for Tuning {
    fn default() -> Self {
        <Self as crate::parameters::Parameters>::DEFAULT
    }
}
