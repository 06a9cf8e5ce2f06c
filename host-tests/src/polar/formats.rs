//! Polars as files: this program's CSV, XFOIL's polar files, XFLR5's exports (of sections and wings), AVL's total forces.

use anyhow::{Context, anyhow, ensure};

use super::Read;
use super::made::WING;

/// The rows of `text`; `origin` stands for it in errors. CSV with the columns `alpha_deg`, `cl` and `cd`, or one of these formats:
///
/// - XFOIL (`PACC`) and XFLR5: a line with the names `alpha`, `CL` and `CD`, and rows of numbers under it, parted by blanks, commas,
///   semicolons or tabs. What stands above the names is a comment; rules of dashes are left out.
/// - AVL: one or several outputs of total forces (`FT`, `ST`), each with `Alpha =`, `CLtot =` and `CDtot =`.
pub fn read(origin: &str, text: &str) -> anyhow::Result<Read> {
    if text.contains("CLtot") {
        return avl(origin, text);
    }
    let mut lines = text.lines().enumerate();
    match lines.find_map(|(n, line)| Some((n, columns(line)?))) {
        Some((place, columns)) => under(origin, text, place, columns),
        None => table(origin, text),
    }
}

/// The cells of a line.
fn cells(line: &str) -> impl Iterator<Item = &str> {
    let parted = line.split(|c: char| c.is_whitespace() || matches!(c, ',' | ';'));
    parted.filter(|cell| !cell.is_empty())
}

/// Where α, c_L and c_D stand in a line of names.
fn columns(line: &str) -> Option<[usize; 3]> {
    if line.starts_with('#') {
        return None;
    }
    let names: Vec<String> = cells(line).map(str::to_lowercase).collect();
    let place = |name: &str| names.iter().position(|known| known == name);
    Some([place("alpha")?, place("cl")?, place("cd")?])
}

/// A table with the columns `alpha_deg`, `cl` and `cd`.
fn table(origin: &str, text: &str) -> anyhow::Result<Read> {
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let header = reader
        .headers()
        .with_context(|| format!("{origin}:1"))?
        .clone();
    // The reader places the header before the comments.
    let above = text.lines().take_while(|line| line.starts_with('#'));
    let header_line = 1 + above.count();
    let column = |name: &'static str| {
        let found = header.iter().position(|cell| cell == name);
        found.ok_or_else(|| anyhow!("{origin}:{header_line}: no column {name}"))
    };
    let columns = [column("alpha_deg")?, column("cl")?, column("cd")?];
    let (mut lines, mut rows) = (Vec::new(), Vec::new());
    for record in reader.records() {
        let record = record.map_err(|error| {
            let line = error.position().map_or(1, csv::Position::line);
            anyhow!("{origin}:{line}: not as many cells as columns")
        })?;
        let line = record.position().map_or(0, csv::Position::line);
        let mut row = [0.0; 3];
        for (value, index) in row.iter_mut().zip(columns) {
            let cell = &record[index];
            *value = cell
                .parse()
                .map_err(|_| anyhow!("{origin}:{line}: {cell:?} is not a number"))?;
        }
        lines.push(line);
        rows.push(row);
    }
    let mut comments = text.lines().filter(|line| line.starts_with('#'));
    Ok(Read {
        lines,
        rows,
        of_wing: comments.any(|line| line.contains(WING)),
    })
}

/// The rows under the names in line `place`, counted from 0. Induced drag is a wing's.
fn under(origin: &str, text: &str, place: usize, columns: [usize; 3]) -> anyhow::Result<Read> {
    let (mut numbers, mut rows) = (Vec::new(), Vec::new());
    for (n, line) in text.lines().enumerate().skip(place + 1) {
        let cells: Vec<&str> = cells(line).collect();
        let is_rule = line.chars().all(|c| c == '-' || c.is_whitespace());
        if is_rule || cells.first().is_none_or(|cell| cell.starts_with('#')) {
            continue;
        }
        // XFLR5 puts several polars into one file, each under names of its own.
        ensure!(
            self::columns(line).is_none(),
            "{origin}:{}: a second polar begins here: one file, one polar",
            n + 1
        );
        let mut row = [0.0; 3];
        for (value, column) in row.iter_mut().zip(columns) {
            let cell = cells.get(column);
            let cell =
                cell.ok_or_else(|| anyhow!("{origin}:{}: not as many cells as names", n + 1))?;
            *value = cell
                .parse()
                .map_err(|_| anyhow!("{origin}:{}: {cell:?} is not a number", n + 1))?;
        }
        numbers.push(n as u64 + 1);
        rows.push(row);
    }
    let names = text.lines().nth(place).unwrap_or_default();
    let of_wing = cells(names).any(|name| name.eq_ignore_ascii_case("CDi"));
    Ok(sorted(numbers, rows, of_wing))
}

/// The rows of AVL's outputs, one each.
fn avl(origin: &str, text: &str) -> anyhow::Result<Read> {
    let (mut numbers, mut rows) = (Vec::new(), Vec::new());
    let mut alpha = None;
    let mut lift = None;
    for (n, line) in text.lines().enumerate() {
        let value = |name: &str| -> anyhow::Result<Option<f64>> {
            let mut words = cells(line).skip_while(|word| *word != name);
            let after = words.nth(2);
            let parsed = after.map(|word| {
                let bad = |_| anyhow!("{origin}:{}: {word:?} is not a number", n + 1);
                word.parse().map_err(bad)
            });
            parsed.transpose()
        };
        alpha = value("Alpha")?.or(alpha);
        lift = value("CLtot")?.or(lift);
        if let Some(drag) = value("CDtot")? {
            let (Some(alpha), Some(lift)) = (alpha.take(), lift.take()) else {
                return Err(anyhow!(
                    "{origin}:{}: CDtot without Alpha and CLtot above it",
                    n + 1
                ));
            };
            numbers.push(n as u64 + 1);
            rows.push([alpha, lift, drag]);
        }
    }
    ensure!(!rows.is_empty(), "{origin}: no CDtot");
    Ok(sorted(numbers, rows, true))
}

/// By increasing angle: sweeps run either way, and from 0 both ways. An angle that comes again is left out.
fn sorted(numbers: Vec<u64>, rows: Vec<[f64; 3]>, of_wing: bool) -> Read {
    let mut all: Vec<(u64, [f64; 3])> = numbers.into_iter().zip(rows).collect();
    all.sort_by(|a, b| a.1[0].total_cmp(&b.1[0]));
    all.dedup_by(|again, first| (again.1[0] - first.1[0]).abs() < 1e-6);
    let (lines, rows) = all.into_iter().unzip();
    Read {
        lines,
        rows,
        of_wing,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const XFOIL: &str = "
       XFOIL         Version 6.99

 Calculated polar for: NACA 4415

 1 1 Reynolds number fixed          Mach number fixed

 xtrf =   1.000 (top)        1.000 (bottom)
 Mach =   0.000     Re =     0.160 e 6     Ncrit =   9.000

   alpha    CL        CD       CDp       CM     Top_Xtr  Bot_Xtr
  ------ -------- --------- --------- -------- -------- --------
   0.000   0.4512   0.01243   0.00475  -0.0921   0.6312   0.9104
   2.000   0.6613   0.01310   0.00512  -0.0903   0.5710   1.0000
  -2.000   0.2398   0.01311   0.00590  -0.0935   0.6905   0.7712
";

    const WING: &str = "xflr5 v6.47
 Wing name : mine
   alpha      Beta       CL          CDi        CDv        CD         CY
  -1.000      0.000   -0.080131   0.000271   0.010421   0.010692   0.000000
   1.000      0.000    0.080131   0.000271   0.010421   0.010692   0.000000
";

    const AVL: &str = "
  Alpha =   2.00000     pb/2V =   0.00000
  Beta  =   0.00000     qc/2V =   0.00000
  CXtot =   0.00120     Cltot =   0.00000     Cl'tot =   0.00000
  CLtot =   0.17230
  CDtot =   0.01154
  CDvis =   0.01000     CDind = 0.0015388
  Alpha =   0.00000     pb/2V =   0.00000
  CLtot =   0.00000
  CDtot =   0.01000
";

    #[test]
    fn each_program_is_read() {
        let rows = |text: &str| read("x", text).unwrap().rows;
        let xfoil = rows(XFOIL);
        let angles: Vec<f64> = xfoil.iter().map(|row| row[0]).collect();
        assert_eq!(angles, [-2.0, 0.0, 2.0]);
        assert_eq!(xfoil[2], [2.0, 0.6613, 0.0131]);
        // The drag of a wing is the whole, not the induced nor the viscous part.
        assert_eq!(rows(WING)[1], [1.0, 0.080131, 0.010692]);
        assert_eq!(rows(AVL), [[0.0, 0.0, 0.01], [2.0, 0.1723, 0.01154]]);
        let of_wing = |text: &str| read("x", text).unwrap().of_wing;
        assert!(of_wing(WING) && of_wing(AVL) && !of_wing(XFOIL));
        let commas = "alpha,CL,CD\n1,0.1,0.01\n0,0,0.01\n";
        assert_eq!(rows(commas), [[0.0, 0.0, 0.01], [1.0, 0.1, 0.01]]);
        let csv = "# cl odd, cd even in alpha\nalpha_deg,cl,cd\n0,0,1\n";
        assert_eq!(rows(csv), [[0.0, 0.0, 1.0]]);
    }

    #[test]
    fn errors_name_the_line() {
        let error = |text: &str| read("x", text).unwrap_err().to_string();
        assert_eq!(
            error("alpha CL CD\n1 a 0.1\n"),
            "x:2: \"a\" is not a number"
        );
        assert_eq!(
            error("alpha CL CD\n1 0.1\n"),
            "x:2: not as many cells as names"
        );
        let two = "alpha CL CD\n1 0.1 0.1\nalpha CL CD\n";
        assert!(error(two).starts_with("x:3: a second polar"));
        assert!(error("CLtot = 0.1\nCDtot = 0.1\n").contains("without Alpha"));
        // Separators alone are an empty line.
        assert_eq!(read("x", "alpha CL CD\n,,\n").unwrap().rows.len(), 0);
    }
}
