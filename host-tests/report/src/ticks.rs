//! Where an axis has its ticks, and what is written there.

/// Ticks of a linear axis between two values, about `count` of them: at 1, 2 or 5 times a power of ten; angles in degrees from 10° on at
/// 15°, 45° and 90°.
pub fn linear((low, high): (f64, f64), count: f64, degrees: bool) -> Vec<f64> {
    let least = (high - low) / count;
    let power = 10.0_f64.powf(least.log10().floor());
    let decimal = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * power);
    let angles = [15.0, 45.0, 90.0, 180.0];
    let steps = if degrees && least > 5.0 {
        angles
    } else {
        decimal
    };
    let step = steps.into_iter().find(|step| *step >= least);
    let step = step.unwrap_or(steps[3]);
    let first = (low / step - 1e-9).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;
    (first..=last).map(|i| i as f64 * step).collect()
}

/// Ticks of a logarithmic axis between two decimal logarithms: the values, at powers of ten, and between few of these at 2 and 5 times
/// them.
pub fn logarithmic((low, high): (f64, f64)) -> Vec<f64> {
    let factors: &[f64] = if high - low > 3.0 {
        &[1.0]
    } else {
        &[1.0, 2.0, 5.0]
    };
    let powers = low.floor() as i32..=high.ceil() as i32;
    let all = powers.flat_map(|power| factors.iter().map(move |f| f * 10.0_f64.powi(power)));
    all.filter(|value| (low..=high).contains(&value.log10()))
        .collect()
}

/// A tick's label: as short as it can be.
pub fn label(value: f64) -> String {
    let rounded = (value * 1e6).round() / 1e6;
    // Not "-0".
    (rounded + 0.0).to_string().replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_ticked_at_right_angles_and_halves() {
        let ticks = linear((-100.0, 190.0), 7.0, true);
        assert_eq!(ticks, [-90.0, -45.0, 0.0, 45.0, 90.0, 135.0, 180.0]);
        assert_eq!(
            linear((-180.0, 180.0), 6.0, true),
            [-180.0, -90.0, 0.0, 90.0, 180.0]
        );
        // A few degrees are a number like any other.
        assert_eq!(linear((0.0, 4.0), 5.0, true), [0.0, 1.0, 2.0, 3.0, 4.0]);
        assert_eq!(linear((0.0, 100.0), 5.0, false).len(), 6);
    }

    #[test]
    fn logarithmic_ticks_lie_inside() {
        assert_eq!(logarithmic((0.2, 2.1)), [2.0, 5.0, 10.0, 20.0, 50.0, 100.0]);
        assert_eq!(logarithmic((-2.0, 3.0)).len(), 6);
    }

    #[test]
    fn labels_are_short() {
        assert_eq!(
            [0.30000000000000004, -0.0, -45.0].map(label),
            ["0.3", "0", "−45"]
        );
    }
}
