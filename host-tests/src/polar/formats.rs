//! Polars as files: tables of spreadsheets and this program (CSV), of XFOIL and XFLR5 (of sections and wings), and AVL's total forces.

use anyhow::{anyhow, ensure};

use super::Read;
use super::made::WING;

/// The columns, as this program writes them.
const NAMES: [&str; 3] = ["alpha_deg", "cl", "cd"];
/// Coefficients of one angle in two rows that are the same: XFOIL comes to an angle from two sides.
const AGAIN: f64 = 0.01;

/// The rows of `text`; `origin` stands for it in errors. It is one of these:
///
/// - a table: a line with the names `alpha_deg` (or `alpha`, `aoa`), `cl` and `cd`, in small letters or capitals, with a unit in brackets or without, and rows of
///   numbers under it. Cells are parted
///   by semicolons, tabs, commas or blanks; where it is not by commas, a comma may part decimals. What stands above the names or behind `#` is a
///   comment; rules of dashes or underscores are left out. So write spreadsheets, XFOIL (`PACC`) and XFLR5.
/// - AVL: one or several outputs of total forces (`FT`, `ST`), each with `Alpha =`, `CLtot =` and `CDtot =`.
pub fn read(origin: &str, text: &str) -> anyhow::Result<Read> {
    match text.contains("CLtot") {
        true => avl(origin, text),
        false => table(origin, text),
    }
}

/// The cells of a line. An empty one counts, but for those at the end.
fn cells(line: &str) -> Vec<&str> {
    let line = line.trim();
    let separator = [';', '\t', ','].into_iter().find(|c| line.contains(*c));
    let mut cells: Vec<&str> = match separator {
        Some(separator) => (line.split(separator))
            .map(|cell| cell.trim().trim_matches('"'))
            .collect(),
        None => line.split_whitespace().collect(),
    };
    let last = cells.iter().rposition(|cell| !cell.is_empty());
    cells.truncate(last.map_or(0, |last| last + 1));
    cells
}

/// The names in a line of names, in small letters, without units in brackets. Where cells are parted by blanks a unit is a cell.
fn named(line: &str) -> Vec<String> {
    let bare = |cell: &str| {
        let end = cell.find(['(', '[']).unwrap_or(cell.len());
        cell[..end].trim().to_lowercase()
    };
    let is_unit = |cell: &&str| cell.starts_with(['(', '[']);
    let cells = cells(line).into_iter().filter(|cell| !is_unit(cell));
    cells.map(bare).collect()
}

/// Where α, c_L and c_D stand in a line of names.
fn columns(line: &str) -> [Option<usize>; 3] {
    let names = named(line);
    NAMES.map(|name| {
        let is = |known: &String| {
            known == name || (name == NAMES[0] && (known == "alpha" || known == "aoa"))
        };
        names.iter().position(is)
    })
}

/// The rows under a line of names. Induced drag is a wing's.
fn table(origin: &str, text: &str) -> anyhow::Result<Read> {
    let is_comment = |line: &str| line.trim_start().starts_with('#');
    let is_rule = |line: &str| {
        line.chars()
            .all(|c| matches!(c, '-' | '_') || c.is_whitespace())
    };
    let lines: Vec<(u64, &str)> = (1..)
        .zip(text.lines())
        .filter(|(_, line)| !is_comment(line) && !is_rule(line))
        .collect();
    let known = |(_, line): &&(u64, &str)| columns(line).iter().flatten().count();
    // The first with the most names.
    let header = lines.iter().rev().max_by_key(known);
    let &(place, header) = header.unwrap_or(&(1, ""));
    let found = columns(header);
    ensure!(
        found.iter().any(Option::is_some),
        "{origin}: no line with the names alpha_deg (or alpha), cl and cd above the numbers"
    );
    let names = named(header);
    let mut columns_of = [0; 3];
    for ((column, found), name) in columns_of.iter_mut().zip(found).zip(NAMES) {
        *column = found.ok_or_else(|| {
            let names = names.join(", ");
            anyhow!("{origin}:{place}: no column {name} among {names}")
        })?;
    }
    let mut rows = Vec::new();
    for &(line, text) in lines.iter().filter(|(line, _)| *line > place) {
        let cells = cells(text);
        if cells.is_empty() {
            continue;
        }
        // XFLR5 puts several polars into one file, each under names of its own.
        ensure!(
            columns(text).contains(&None),
            "{origin}:{line}: a second polar begins here: one file, one polar"
        );
        let mut row = [0.0; 3];
        for (value, column) in row.iter_mut().zip(columns_of) {
            let cell = cells.get(column).filter(|_| cells.len() <= names.len());
            let cell =
                cell.ok_or_else(|| anyhow!("{origin}:{line}: not as many cells as columns"))?;
            *value = (cell.replace(',', ".").parse())
                .map_err(|_| anyhow!("{origin}:{line}: {cell:?} is not a number"))?;
        }
        rows.push((line, row));
    }
    let induced = names.iter().any(|name| name == "cdi");
    let mut comments = text.lines().filter(|line| is_comment(line));
    sorted(
        origin,
        rows,
        induced || comments.any(|line| line.contains(WING)),
    )
}

/// The rows of AVL's outputs, one each.
fn avl(origin: &str, text: &str) -> anyhow::Result<Read> {
    let mut rows = Vec::new();
    let mut alpha = None;
    let mut lift = None;
    for (n, line) in text.lines().enumerate() {
        let value = |name: &str| -> anyhow::Result<Option<f64>> {
            let mut words = line.split_whitespace().skip_while(|word| *word != name);
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
            rows.push((n as u64 + 1, [alpha, lift, drag]));
        }
    }
    ensure!(!rows.is_empty(), "{origin}: no CDtot");
    sorted(origin, rows, true)
}

/// By increasing angle: sweeps run either way, and from 0 both ways. An angle that comes again with the same coefficients is left out.
fn sorted(origin: &str, mut rows: Vec<(u64, [f64; 3])>, of_wing: bool) -> anyhow::Result<Read> {
    rows.sort_by(|a, b| a.1[0].total_cmp(&b.1[0]));
    let comes_again = |first: &[f64; 3], again: &[f64; 3]| (again[0] - first[0]).abs() < 1e-6;
    for pair in rows.windows(2) {
        let [(first, a), (again, b)] = pair else {
            continue;
        };
        let same = (1..3).all(|i| (a[i] - b[i]).abs() <= AGAIN);
        ensure!(
            same || !comes_again(a, b),
            "{origin}:{again}: {}° stands in line {first} already, with other coefficients",
            b[0]
        );
    }
    rows.dedup_by(|again, first| comes_again(&first.1, &again.1));
    let (lines, rows) = rows.into_iter().unzip();
    Ok(Read {
        lines,
        rows,
        of_wing,
    })
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
            "x:2: not as many cells as columns"
        );
        let two = "alpha CL CD\n1 0.1 0.1\nalpha CL CD\n";
        assert!(error(two).starts_with("x:3: a second polar"));
        assert!(error("CLtot = 0.1\nCDtot = 0.1\n").contains("without Alpha"));
        // Units in brackets, as cells of their own or in those of the names, and rules of underscores.
        for units in [
            "Alpha (deg),Cl,Cd [-]\n1,0.1,0.02\n",
            "AoA (deg) CL CD\n_____ ____ ____\n1 0.1 0.02\n",
        ] {
            assert_eq!(read("x", units).unwrap().rows, [[1.0, 0.1, 0.02]]);
        }
        // Separators alone are an empty line.
        assert_eq!(read("x", "alpha CL CD\n,,\n").unwrap().rows.len(), 0);
        // A cell that is empty does not move those behind it, and a comma that parts decimals as well as cells makes too many.
        let empty = "alpha,Re,cl,cd,cm\n1,,0.1,0.02,-0.1\n";
        assert_eq!(read("x", empty).unwrap().rows, [[1.0, 0.1, 0.02]]);
        assert_eq!(
            error("alpha_deg,cl,cd\n0,5,0,1,0,02\n"),
            "x:2: not as many cells as columns"
        );
        assert_eq!(
            error("Polar of mine\n\nalpha;cl;drag\n"),
            "x:3: no column cd among alpha, cl, drag"
        );
        for nameless in ["", "0 0 0.01\n5 0.5 0.02\n"] {
            assert_eq!(
                error(nameless),
                "x: no line with the names alpha_deg (or alpha), cl and cd above the numbers"
            );
        }
        let again = "alpha_deg,cl,cd\n0,0,0.01\n9,0.8,0.03\n5,0.5,0.02\n9,0.9,0.03\n";
        assert_eq!(
            error(again),
            "x:5: 9° stands in line 3 already, with other coefficients"
        );
    }

    /// Semicolons, tabs, commas, blanks and decimal commas, as spreadsheets have them, and rows in any order: the same table.
    #[test]
    fn every_separator_is_read() {
        let comma = "alpha_deg,cl,cd\n9,0.8,0.03\n5,0.5,0.02\n5,0.505,0.02\n0,0,0.01\n";
        let want = [[0.0, 0.0, 0.01], [5.0, 0.5, 0.02], [9.0, 0.8, 0.03]];
        let decimal_commas = comma.replace(',', ";").replace('.', ",");
        for text in [
            comma.to_owned(),
            comma.replace(',', ";"),
            comma.replace(',', "\t"),
            comma.replace(',', "  "),
            comma.replace(',', " , ").replace('\n', ",\r\n"),
            decimal_commas.replace(';', "\t"),
            decimal_commas,
            comma.replace("alpha_deg,cl,cd", "\"Alpha\",\"CL\",\"CD\""),
        ] {
            assert_eq!(read("x", &text).unwrap().rows, want, "{text}");
        }
    }
}
