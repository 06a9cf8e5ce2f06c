//! Polars made of others: of a wing with a section, with a stall that is told, with fewer rows.

use anyhow::{anyhow, ensure};

use super::{Apart, Polar, Read, resampled, wing};

/// What stands in the comments of a table of a wing that this program wrote.
pub(super) const WING: &str = "For an aspect ratio of";

impl Polar {
    /// The polar that stalls at `degrees`: what was read beyond is left out, on both sides.
    pub fn stalling_at(&self, degrees: f64) -> anyhow::Result<Self> {
        let name = self.name;
        let Read {
            lines,
            rows,
            of_wing,
        } = self.read;
        let last = rows.last().map_or(0.0, |row| row[0]);
        ensure!(self.seam.is_some(), "{name} goes through its stall already");
        ensure!(
            degrees <= last,
            "{name}:{}: ends at {last}°, before a stall at {degrees}°: rows up to the stall are needed",
            self.last_line()
        );
        let inside = |row: &[f64; 3]| row[0].abs() < degrees - 1e-6;
        let kept = lines.iter().zip(rows).filter(|(_, row)| inside(row));
        let (mut lines, mut cut): (Vec<u64>, Vec<[f64; 3]>) = kept.unzip();
        // A row at the stall itself, on the straight line between its neighbours.
        let above = rows.partition_point(|row| row[0] < degrees - 1e-6);
        if let (Some(low), Some(high)) = (rows.get(above.wrapping_sub(1)), rows.get(above)) {
            let part = (degrees - low[0]) / (high[0] - low[0]);
            let between = |i: usize| low[i] + part * (high[i] - low[i]);
            cut.push([degrees, between(1), between(2)]);
            lines.push(self.read.lines[above]);
        }
        let read = Read {
            lines,
            rows: cut,
            of_wing: *of_wing,
        };
        Self::of_read(name, read, None)
    }

    /// The polar of a wing of `aspect_ratio` with this section. That of a whole wing has its induced drag already: the ratio counts for how it
    /// is extended alone.
    pub(super) fn of_wing(&self, aspect_ratio: f64) -> anyhow::Result<Self> {
        let name = self.name;
        if self.is_of_wing() {
            return Self::of_read(name, self.read.clone(), Some(aspect_ratio));
        }
        let given = self.seam.map(|seam| seam.given_deg);
        let (rows, seam) = wing::of_section(&self.degrees(), given, aspect_ratio)
            .map_err(|e| anyhow!("{name}: of the wing: {e}"))?;
        Ok(Self {
            seam: Some(seam),
            ..Self::from_rows(name, &[], &rows)?
        })
    }

    /// The polar of a wing of `aspect_ratio`, or this one if none is said, and in sentences how it came about.
    pub fn finite(&self, aspect_ratio: Option<f64>) -> anyhow::Result<(Self, Vec<String>)> {
        let (wing, sentence) = match aspect_ratio {
            None => (
                *self,
                "Without an aspect ratio: the wing is taken for the polar as it is".to_owned(),
            ),
            Some(ratio) if self.is_of_wing() => (
                self.of_wing(ratio)?,
                format!(
                    "{WING} {ratio}: the polar is that of a whole wing already, and stays as it is; the ratio counts for its extension alone"
                ),
            ),
            Some(ratio) => (
                self.of_wing(ratio)?,
                format!(
                    "{WING} {ratio}: Prandtl's lifting line up to stall, with a span efficiency of {}",
                    wing::SPAN_EFFICIENCY
                ),
            ),
        };
        let seam = wing.seam.map(|seam| seam.text());
        Ok((wing, [sentence].into_iter().chain(seam).collect()))
    }

    /// The polar of at most `count` of its rows, and how far it is from this one.
    pub fn of_rows(&self, count: usize) -> anyhow::Result<(Self, Apart)> {
        let (rows, apart) = resampled(self.rows, count);
        let degrees: Vec<[f64; 3]> = rows
            .iter()
            .map(|&[a, l, d]| [a.to_degrees(), l, d])
            .collect();
        Ok((
            Self {
                seam: self.seam,
                read: self.read,
                ..Self::from_rows(self.name, &[], &degrees)?
            },
            apart,
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plane of XFLR5 has its induced drag: an aspect ratio changes how it is extended, and no row that was given. Nor does what this
    /// program wrote of a wing become one a second time.
    #[test]
    fn a_wing_does_not_become_a_wing_twice() {
        let rows: String = (-12..=14)
            .map(|a| {
                let lift = 0.9 * (0.1 * f64::from(a)).sin();
                format!(
                    "{a} 0 {lift:.4} {:.4} 0.01 {:.4} 0\n",
                    0.05 * lift * lift,
                    0.01 + 0.05 * lift * lift
                )
            })
            .collect();
        let text = format!("xflr5 v6.47\n Plane name : mine\n alpha Beta CL CDi CDv CD CY\n{rows}");
        let plane = Polar::from_text("x", &text).unwrap();
        assert!(plane.is_of_wing());
        let again = plane.of_wing(6.0).unwrap();
        let given = |polar: &Polar| {
            let rows = polar.degrees().into_iter();
            rows.filter(|row| row[0].abs() <= 14.0).collect::<Vec<_>>()
        };
        assert_eq!(given(&again), given(&plane));
        assert!(again.seam.unwrap().most_drag < plane.seam.unwrap().most_drag - 0.5);
        let section = Polar::from_text("x", &text.replace("CDi", "CDp")).unwrap();
        assert!(!section.is_of_wing() && given(&section.of_wing(6.0).unwrap()) != given(&section));
        let written = section.of_wing(6.0).unwrap().csv(&[format!("{WING} 6: …")]);
        let written = Polar::from_text("x", &written).unwrap();
        let twice = written.of_wing(6.0).unwrap();
        assert!(written.is_of_wing() && twice.rows == written.rows);
    }

    #[test]
    fn a_stall_that_is_told_cuts_the_table() {
        let rows: String = (-10..=16)
            .map(|a| format!("{a} {} 0.01\n", 0.1 * f64::from(a)))
            .collect();
        let text = format!("alpha CL CD\n{rows}");
        let polar = Polar::from_text("x", &text).unwrap();
        assert!(polar.ends_straight());
        let cut = polar.stalling_at(11.5).unwrap();
        assert_eq!(cut.seam.unwrap().given_deg, [0.0, 11.5]);
        let most = cut
            .degrees()
            .iter()
            .filter(|row| row[0] < 12.0)
            .fold(0.0, |m: f64, r| m.max(r[1]));
        assert!((most - 1.15).abs() < 1e-9);
        assert!(polar.stalling_at(20.0).is_err());
        assert!(
            Polar::load("naca-0012-re-160e3")
                .unwrap()
                .stalling_at(8.0)
                .is_err()
        );
    }
}
