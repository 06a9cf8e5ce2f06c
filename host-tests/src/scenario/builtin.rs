//! The scenarios that come with the program.

/// What is flown when nothing is asked for.
pub const DEFAULT: &str = "hover-to-cruise";

/// Name and TOML text of every built-in scenario.
pub const BUILT_IN: &[(&str, &str)] = &[
    (
        "hover-to-cruise",
        include_str!("../../scenarios/hover-to-cruise.toml"),
    ),
    ("matched", include_str!("../../scenarios/matched.toml")),
    (
        "large-angle",
        include_str!("../../scenarios/large-angle.toml"),
    ),
    (
        "cruise-to-hover",
        include_str!("../../scenarios/cruise-to-hover.toml"),
    ),
    (
        "steep-climb",
        include_str!("../../scenarios/steep-climb.toml"),
    ),
];
