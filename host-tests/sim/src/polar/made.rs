//! Polars made of others: of a wing with a section, with a stall that is told, with fewer rows.

use anyhow::{anyhow, ensure};

use super::spacing::CLOSEST;
use super::stall::{kinks, stall};
use super::{Apart, Polar, Read, Seam, Upto, resampled, wing};

/// What stands in the comments of a table of a wing that this program wrote.
pub(super) const WING: &str = "For an aspect ratio of";

impl Polar {
    /// The polar that stalls at `degrees`, and in a sentence what was left out: what was read beyond, on both sides.
    pub fn stalling_at(&self, degrees: f64) -> anyhow::Result<(Self, Option<String>)> {
        let name = self.name;
        let Read {
            lines,
            rows,
            of_wing,
        } = self.read;
        let last = rows.last().map_or(0.0, |row| row[0]);
        ensure!(
            degrees <= last + 1e-6,
            "{name}:{}: ends at {last}°, before a stall at {degrees}°: rows up to the stall are needed",
            self.last_line()
        );
        // A row at the stall itself, on the straight line between its neighbours, and none that comes close to it.
        let inside = |row: &[f64; 3]| (-degrees - 1e-6..degrees - CLOSEST).contains(&row[0]);
        let kept = lines.iter().zip(rows).filter(|(_, row)| inside(row));
        let (mut lines, mut cut): (Vec<u64>, Vec<[f64; 3]>) = kept.unzip();
        let above = rows.partition_point(|row| row[0] < degrees - 1e-6);
        if let (Some(low), Some(high)) = (rows.get(above.wrapping_sub(1)), rows.get(above)) {
            let part = (degrees - low[0]) / (high[0] - low[0]);
            let between = |i: usize| low[i] + part * (high[i] - low[i]);
            cut.push([degrees, between(1), between(2)]);
            lines.push(self.read.lines[above]);
        }
        let left_out = left_out(rows, [-degrees, degrees]);
        let read = Read {
            lines,
            rows: cut,
            of_wing: *of_wing,
        };
        let cut = Self {
            told: true,
            ..Self::of_read(name, read, None)?
        };
        let sentence =
            left_out.map(|left_out| format!("The stall was told, {degrees}°: {left_out}"));
        Ok((cut, sentence))
    }

    /// The polar of a wing of `aspect_ratio` with this section. That of a whole wing has its induced drag already: the ratio counts for how it
    /// is extended alone.
    pub(super) fn of_wing(&self, aspect_ratio: f64) -> anyhow::Result<Self> {
        let name = self.name;
        if self.is_of_wing() {
            let wing = Self::of_read(name, self.read.clone(), Some(aspect_ratio))?;
            return Ok(Self {
                told: self.told,
                ..wing
            });
        }
        let given = self.seam.map(|seam| seam.given_deg);
        let (rows, seam) = wing::of_section(&self.degrees(), given, self.told, aspect_ratio)
            .map_err(|e| anyhow!("{name}: of the wing: {e}"))?;
        Ok(Self {
            seam: Some(seam),
            told: self.told,
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
        let cut = wing.seam.map_or(Vec::new(), |seam| self.cut(seam.upto));
        let seam = wing.seam.map(|seam| seam.text());
        let sentences = [sentence].into_iter().chain(seam).chain(cut);
        Ok((wing, sentences.collect()))
    }

    /// The same with `added` to the drag coefficient at every angle, as by a fuselage.
    pub fn with_drag(&self, added: f64) -> anyhow::Result<Self> {
        let rows = self.degrees().into_iter();
        let rows: Vec<[f64; 3]> = rows
            .map(|[alpha, lift, drag]| [alpha, lift, drag + added])
            .collect();
        Ok(Self {
            seam: self.seam,
            read: self.read,
            told: self.told,
            ..Self::new(self.name, &rows)?
        })
    }

    /// In sentences what was left out of this section where it became a wing, and the falls of lift that were not taken for its stall.
    fn cut(&self, upto: Upto) -> Vec<String> {
        let Upto::Section(used) = upto else {
            return Vec::new();
        };
        let rows = &self.read.rows;
        // Of a symmetric section the rows below 0° are used as those above.
        let used = match used {
            [first, last] if first > -1e-6 => [-last, last],
            used => used,
        };
        let inside = |row: &&[f64; 3]| (used[0] - 1e-6..=used[1] + 1e-6).contains(&row[0]);
        let most = rows.iter().filter(inside);
        let most = most.max_by(|a, b| a[1].total_cmp(&b[1]));
        let most = most.map(|[at, lift, _]| format!("Its greatest c_L is {lift:.3}, at {at:.1}°"));
        let top = rows.partition_point(|row| row[0] <= used[1] + 1e-6);
        let zero = rows.partition_point(|row| row[0] < -1e-6);
        let above = rows.get(zero..top).unwrap_or_default();
        let kinks = kinks(above, above.len().saturating_sub(1));
        let kinks = kinks.into_iter().map(|at| {
            let [from, lift, _] = above[at];
            let behind = above[at..].iter().take_while(|row| row[1] <= lift);
            let least = behind.fold(lift, |least, row| least.min(row[1]));
            format!(
                "Behind {from:.1}° c_L falls by {:.3} and comes back: no stall",
                lift - least
            )
        });
        let left_out = left_out(rows, used);
        most.into_iter()
            .chain(left_out.map(|text| format!("Of the section {text}")))
            .chain(kinks)
            .collect()
    }

    /// Angle of the stall \[°\]: as it was told, or of the greatest lift of the section that became this wing, or as its rows show it; none if they show
    /// none.
    pub fn stall_deg(&self) -> Option<f64> {
        let of_section = |seam: &Seam| seam.upto != Upto::Given;
        match self.seam {
            Some(seam) if self.told => Some(seam.given_deg[1]),
            Some(seam) if of_section(&seam) => {
                let rows = self.degrees();
                let [from, to] = seam.given_deg.map(|end| end.abs() + 1e-9);
                let given = rows.iter().filter(|row| (-from..=to).contains(&row[0]));
                // Of several with the same lift the first.
                let most = given.rev().max_by(|a, b| a[1].total_cmp(&b[1]));
                most.map(|row| row[0])
            }
            // What was read goes before its extension.
            _ => {
                let of = |rows: &[[f64; 3]]| stall(rows).map(|at| rows[at][0]);
                of(&self.read.rows).or_else(|| of(&self.degrees()))
            }
        }
    }

    /// The polar of at most `count` of its rows, and how far it is from this one.
    pub fn of_rows(&self, count: usize) -> anyhow::Result<(Self, Apart)> {
        let (rows, apart) = resampled(self.rows, count);
        let degrees: Vec<[f64; 3]> = rows
            .iter()
            .map(|&[a, l, d]| [a.to_degrees(), l, d])
            .collect();
        // What is flown and coded is what the file says.
        let written = Self::from_rows(self.name, &[], &degrees)?.written();
        Ok((
            Self {
                seam: self.seam,
                read: self.read,
                told: self.told,
                ..Self::from_rows(self.name, &[], &written)?
            },
            apart,
        ))
    }
}

/// How many of the `rows` are not used, beyond these angles \[°\], and what lift they have.
fn left_out(rows: &[[f64; 3]], used: [f64; 2]) -> Option<String> {
    let below = rows.iter().filter(|row| row[0] < used[0] - 1e-6);
    let above = rows.iter().filter(|row| row[0] > used[1] + 1e-6);
    let sides = [below.collect::<Vec<_>>(), above.collect()];
    let count: usize = sides.iter().map(Vec::len).sum();
    let ranges = sides.iter().filter_map(|side| {
        let (first, last) = side.first().zip(side.last())?;
        let lift = |row: &&[f64; 3]| row[1];
        let least = side.iter().map(lift).fold(f64::INFINITY, f64::min);
        let most = side.iter().map(lift).fold(f64::NEG_INFINITY, f64::max);
        Some(format!(
            "{:.1}° to {:.1}° (c_L from {least:.3} to {most:.3})",
            first[0], last[0]
        ))
    });
    let ranges: Vec<String> = ranges.collect();
    (count > 0).then(|| {
        format!(
            "{count} of {} rows are left out: {}",
            rows.len(),
            ranges.join(" and ")
        )
    })
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
        assert!(
            polar
                .no_stall()
                .unwrap()
                .starts_with("x:28: lift still grows")
        );
        let (cut, said) = polar.stalling_at(11.5).unwrap();
        assert_eq!(
            said.unwrap(),
            "The stall was told, 11.5°: 5 of 27 rows are left out: 12.0° to 16.0° (c_L from 1.200 to 1.600)"
        );
        assert_eq!(cut.seam.unwrap().given_deg, [0.0, 11.5]);
        let most = cut
            .degrees()
            .iter()
            .filter(|row| row[0] < 12.0)
            .fold(0.0, |m: f64, r| m.max(r[1]));
        assert!((most - 1.15).abs() < 1e-9);
        assert!(polar.stalling_at(20.0).is_err());
        // A whole table is cut, too, and extended.
        let whole = Polar::load("naca-0012-re-160e3").unwrap();
        let (cut, _) = whole.stalling_at(8.0).unwrap();
        assert_eq!(cut.seam.unwrap().given_deg, [0.0, 8.0]);
        // At a row, and next to one.
        for degrees in [11.0, 11.01, 11.99] {
            let (cut, _) = polar.stalling_at(degrees).unwrap();
            assert_eq!(cut.seam.unwrap().given_deg[1], degrees);
        }
    }
}
