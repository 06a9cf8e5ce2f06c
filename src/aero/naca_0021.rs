//! The NACA 0021 section over 180 degrees, by Sheldahl and Klimas.
//!
//! R. E. Sheldahl and P. C. Klimas, *Aerodynamic Characteristics of Seven Symmetrical Airfoil Sections Through
//! 180-Degree Angle of Attack for Use in Aerodynamic Analysis of Vertical Axis Wind Turbines*, SAND80-2114, Sandia
//! National Laboratories, March 1981 (doi:10.2172/6548367), a report of the US government. The figures were read from
//! `test/Airfoil_Section_Data/NACA_0021.dat` of github.com/sandialabs/CACTUS at 4ae4fafdf1d598428d9df43f1951a80170dc7780
//! (BSD-3-Clause); the copies in ShipSIM and turbinesFoam agree with them at every common angle.
//!
//! These are **not raw measurements**: the report is a synthesis of wind-tunnel data and of data computed with Eppler's
//! PROFILE. Rows from 30° on do not depend on the Reynolds number, and are the same for NACA 0015, 0018, 0021 and 0025.
//! The leap of drag past stall (from 12° on at Re = 160e3, from 20° on at 5e6) is the source's own.

use super::table::{Node, Polar};

/// Rows of the table at Re = 160e3: α [°], c_L, c_D.
#[rustfmt::skip]
const ROWS_RE_160E3: [[f32; 3]; 51] = [
    [0.0, 0.0, 0.0139], [1.0, 0.0842, 0.014], [2.0, 0.1879, 0.0143],
    [3.0, 0.2861, 0.0148], [4.0, 0.38, 0.0155], [5.0, 0.4687, 0.0163],
    [6.0, 0.5486, 0.0174], [7.0, 0.6209, 0.0187], [8.0, 0.6745, 0.0204],
    [9.0, 0.7148, 0.0222], [10.0, 0.7374, 0.0243], [11.0, 0.7443, 0.0266],
    [12.0, 0.7363, 0.0292], [13.0, 0.7255, 0.086], [14.0, 0.6993, 0.158],
    [16.0, 0.6487, 0.196], [18.0, 0.6098, 0.238], [20.0, 0.592, 0.282],
    [22.0, 0.6023, 0.329], [25.0, 0.6664, 0.405], [30.0, 0.855, 0.57],
    [35.0, 0.98, 0.745], [40.0, 1.035, 0.92], [45.0, 1.05, 1.075],
    [50.0, 1.02, 1.215], [55.0, 0.955, 1.345], [60.0, 0.875, 1.47],
    [65.0, 0.76, 1.575], [70.0, 0.63, 1.665], [75.0, 0.5, 1.735],
    [80.0, 0.365, 1.78], [85.0, 0.23, 1.8], [90.0, 0.09, 1.8],
    [95.0, -0.05, 1.78], [100.0, -0.185, 1.75], [105.0, -0.32, 1.7],
    [110.0, -0.45, 1.635], [115.0, -0.575, 1.555], [120.0, -0.67, 1.465],
    [125.0, -0.76, 1.35], [130.0, -0.85, 1.225], [135.0, -0.93, 1.085],
    [140.0, -0.98, 0.925], [145.0, -0.9, 0.755], [150.0, -0.77, 0.575],
    [155.0, -0.67, 0.42], [160.0, -0.635, 0.32], [165.0, -0.68, 0.23],
    [170.0, -0.85, 0.14], [175.0, -0.66, 0.055], [180.0, 0.0, 0.025],
];

/// Rows of the table at Re = 5e6: α [°], c_L, c_D.
#[rustfmt::skip]
const ROWS_RE_5E6: [[f32; 3]; 54] = [
    [0.0, 0.0, 0.0078], [1.0, 0.11, 0.0078], [2.0, 0.22, 0.0079],
    [3.0, 0.33, 0.0081], [4.0, 0.44, 0.0083], [5.0, 0.55, 0.0086],
    [6.0, 0.66, 0.0091], [7.0, 0.7354, 0.0097], [8.0, 0.8334, 0.0104],
    [9.0, 0.9222, 0.0112], [10.0, 1.0049, 0.0121], [11.0, 1.0787, 0.0132],
    [12.0, 1.1453, 0.0143], [13.0, 1.1979, 0.0156], [14.0, 1.241, 0.017],
    [15.0, 1.268, 0.0186], [16.0, 1.286, 0.0205], [17.0, 1.2977, 0.0224],
    [18.0, 1.3031, 0.0245], [19.0, 1.3066, 0.0268], [20.0, 1.3054, 0.0293],
    [22.0, 1.313, 0.329], [25.0, 1.3476, 0.405], [30.0, 0.855, 0.57],
    [35.0, 0.98, 0.745], [40.0, 1.035, 0.92], [45.0, 1.05, 1.075],
    [50.0, 1.02, 1.215], [55.0, 0.955, 1.345], [60.0, 0.875, 1.47],
    [65.0, 0.76, 1.575], [70.0, 0.63, 1.665], [75.0, 0.5, 1.735],
    [80.0, 0.365, 1.78], [85.0, 0.23, 1.8], [90.0, 0.09, 1.8],
    [95.0, -0.05, 1.78], [100.0, -0.185, 1.75], [105.0, -0.32, 1.7],
    [110.0, -0.45, 1.635], [115.0, -0.575, 1.555], [120.0, -0.67, 1.465],
    [125.0, -0.76, 1.35], [130.0, -0.85, 1.225], [135.0, -0.93, 1.085],
    [140.0, -0.98, 0.925], [145.0, -0.9, 0.755], [150.0, -0.77, 0.575],
    [155.0, -0.67, 0.42], [160.0, -0.635, 0.32], [165.0, -0.68, 0.23],
    [170.0, -0.85, 0.14], [175.0, -0.66, 0.055], [180.0, 0.0, 0.025],
];

/// NACA 0021 at Re = 160e3.
pub static NACA_0021_RE_160E3: Polar<50> = polar(&ROWS_RE_160E3);

/// NACA 0021 at Re = 5e6.
pub static NACA_0021_RE_5E6: Polar<53> = polar(&ROWS_RE_5E6);

/// The table through `rows`; wrong rows stop the compilation.
const fn polar<const ROWS: usize, const N: usize>(rows: &[[f32; 3]; ROWS]) -> Polar<N> {
    let mut nodes = [Node::from_degrees(0.0, 0.0, 0.0); ROWS];
    let mut i = 0;
    while i < ROWS {
        nodes[i] = Node::from_degrees(rows[i][0], rows[i][1], rows[i][2]);
        i += 1;
    }
    match Polar::new(&nodes) {
        Ok(polar) => polar,
        Err(_) => panic!("a shipped table is wrong"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aero::{Aerodynamics, Table};
    use crate::air::AngleOfAttack;

    /// The tables as the compiler made them, and as they are made now; and every row is on its table.
    #[test]
    fn the_tables_hold_their_rows() {
        fn check<const ROWS: usize, const N: usize>(rows: &[[f32; 3]; ROWS], shipped: &Polar<N>) {
            let made: Polar<N> = polar(rows);
            assert_eq!(made, *shipped);
            let table = Table::new(&made);
            for [alpha, c_l, c_d] in rows {
                let c = table.coefficients(AngleOfAttack::from_radians(alpha.to_radians()));
                // Roundings of numbers below 2; at 90° and more the angle's are 2e-7 rad, times slopes of 8.
                assert!((c.c_l - c_l).abs() < 3e-6, "{alpha} {c:?}");
                assert!((c.c_d - c_d).abs() < 3e-6, "{alpha} {c:?}");
            }
        }
        check(&ROWS_RE_160E3, &NACA_0021_RE_160E3);
        check(&ROWS_RE_5E6, &NACA_0021_RE_5E6);
    }
}
