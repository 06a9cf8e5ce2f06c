//! Polars as files: tables with names above them (of spreadsheets, XFOIL, XFLR5, VSPAERO, AeroDyn and this program), tables without (of AeroDyn 13 and
//! QBlade), and AVL's total forces.

pub(super) mod foreign;
mod several;

use anyhow::{anyhow, bail, ensure};

use super::Read;
use super::made::WING;

/// The columns, as this program writes them, and what other programs call them: the first that is there is taken. VSPAERO and XFLR5 have parts
/// of lift and drag besides the whole.
const NAMES: [(&str, &[&str]); 3] = [
    (
        "alpha_deg",
        &[
            "alpha_deg",
            "alpha",
            "aoa",
            "α",
            "alfa",
            "aoa_deg",
            "alpha_rad",
        ],
    ),
    ("cl", &["cltot", "cl_tot", "cl", "c_l"]),
    ("cd", &["cdtot", "cd_tot", "cd", "c_d"]),
];
/// Coefficients of one angle in two rows that are the same: XFOIL comes to an angle from two sides.
const AGAIN: f64 = 0.01;
/// Greatest angle that is taken for radians: more than π, of which tables of a whole circle may have roundings.
const RADIANS: f64 = 3.2;
/// What comments begin with.
const SIGNS: [&str; 4] = ["#", "!", "%", "//"];

/// The rows of `text`; `origin` stands for it in errors. It is one of these:
///
/// - a table: a line with the names `alpha_deg` (or `alpha`, `aoa`), `cl` and `cd` (or `CLtot`, `CDtot`), in small letters or capitals, with a unit in brackets or without, and
///   rows of numbers under it. The names may stand behind the sign of a comment, and under them a row of units. Cells are parted by semicolons, tabs,
///   commas or blanks; where it is not by commas, a comma may part decimals. What stands above the names or behind such a sign is a comment;
///   rules of dashes or underscores are left out. So write spreadsheets, XFOIL (`PACC`), XFLR5, VSPAERO (`.polar`) and AeroDyn 14 and 15.
/// - AeroDyn 13's or QBlade's: numbers without names, α, c_L, c_D and others.
/// - AVL: one or several outputs of total forces (`FT`, `ST`), each with `Alpha =`, `CLtot =` and `CDtot =`.
pub fn read(origin: &str, text: &str) -> anyhow::Result<Read> {
    if let Some((line, what)) = foreign::named(text) {
        bail!("{origin}:{line}: {what}");
    }
    match (foreign::is_avl(text), Header::find(text)) {
        (true, _) => foreign::avl(origin, text),
        (false, Some(header)) if header.is_whole() => table(origin, text, &header),
        (false, _) if foreign::is_nameless(text) => foreign::nameless(origin, text),
        (false, Some(header)) => table(origin, text, &header),
        (false, None) => bail!(
            "{origin}: no line with the names alpha_deg (or alpha), cl and cd above the numbers"
        ),
    }
}

/// Whether `text` holds a polar, readable or not: names over numbers, or a form of another program.
pub fn is_polar(text: &str) -> bool {
    let numbers = |header: &Header| {
        let below = text.lines().skip(header.place as usize);
        below.take(4).any(|line| {
            let cells = cells(line);
            cells.len() > 2 && cells.iter().all(|cell| number(cell).is_some())
        })
    };
    let table = Header::find(text)
        .is_some_and(|header| header.is_whole() && (!header.commented || numbers(&header)));
    table || foreign::is_avl(text) || foreign::is_nameless(text)
}

/// The cells of a line. An empty one counts, but for those at the end. What stands in quotes parts none.
fn cells(line: &str) -> Vec<&str> {
    let line = line.trim();
    let mut quoted = false;
    let outside = |c: char| {
        quoted ^= c == '"';
        if quoted { '"' } else { c }
    };
    // The same without what stands in quotes, place by place.
    let bare: Vec<(usize, char)> = std::iter::zip(
        line.char_indices().map(|(place, _)| place),
        line.chars().map(outside),
    )
    .collect();
    let has = |wanted: &char| bare.iter().any(|(_, c)| c == wanted);
    let separator = [';', '\t', ','].into_iter().find(has);
    let separator = separator.filter(|separator| *separator != ',' || !parts_decimals(line));
    let parts = |c: char| separator.map_or(c.is_whitespace(), |separator| c == separator);
    let mut cells = Vec::new();
    let mut begin = 0;
    for (place, c) in bare {
        if parts(c) {
            cells.push(&line[begin..place]);
            begin = place + c.len_utf8();
        }
    }
    cells.push(&line[begin..]);
    // Several blanks part no more than one.
    cells.retain(|cell| separator.is_some() || !cell.is_empty());
    let mut cells: Vec<&str> = cells
        .into_iter()
        .map(|cell| cell.trim().trim_matches('"').trim())
        .collect();
    let last = cells.iter().rposition(|cell| !cell.is_empty());
    cells.truncate(last.map_or(0, |last| last + 1));
    cells
}

/// Whether the commas of a line part decimals: each stands between two digits, one in a word, and blanks part the words.
fn parts_decimals(line: &str) -> bool {
    let digit = |c: Option<char>| c.is_some_and(|c| c.is_ascii_digit());
    let decimal = |word: &str| match word.split_once(',') {
        Some((whole, part)) => {
            digit(whole.chars().last()) && digit(part.chars().next()) && !part.contains(',')
        }
        None => true,
    };
    line.split_whitespace().count() > 2 && line.split_whitespace().all(decimal)
}

/// The number in a cell: with a point or a comma, and an exponent of E or, as FORTRAN has it, D.
fn number(cell: &str) -> Option<f64> {
    cell.replace(',', ".").replace(['D', 'd'], "e").parse().ok()
}

/// A line without the sign of a comment, and whether it had one.
fn bare(line: &str) -> (&str, bool) {
    let line = line.trim();
    match SIGNS.iter().any(|sign| line.starts_with(sign)) {
        true => (line.trim_start_matches(['#', '!', '%', '/']).trim(), true),
        false => (line, false),
    }
}

/// A rule of dashes or underscores, or an empty line.
fn is_rule(line: &str) -> bool {
    let drawn = |c: char| matches!(c, '-' | '_' | '=') || c.is_whitespace();
    line.chars().all(drawn)
}

/// A name in a line of names, in small letters, how many it had in capitals, and its unit in brackets.
#[derive(Clone, Debug, PartialEq)]
struct Name {
    text: String,
    capitals: usize,
    unit: String,
}

/// The names in a line of names. Where cells are parted by blanks a unit is a cell, behind that of its name.
fn names_in(line: &str) -> Vec<Name> {
    let mut names: Vec<Name> = Vec::new();
    for cell in cells(line) {
        let (text, unit) = cell.split_at(cell.find(['(', '[']).unwrap_or(cell.len()));
        let unit = bare_unit(unit);
        match names.last_mut() {
            Some(last) if text.is_empty() && !unit.is_empty() => last.unit = unit,
            _ => names.push(Name {
                text: text.trim().to_lowercase(),
                capitals: text.chars().filter(|c| c.is_uppercase()).count(),
                unit,
            }),
        }
    }
    names
}

/// A unit without its brackets, in small letters.
fn bare_unit(unit: &str) -> String {
    let unit = unit.trim_matches(|c: char| "()[]\"".contains(c) || c.is_whitespace());
    unit.to_lowercase()
}

/// Whether angles of this unit are radians; none if it is no unit of angles.
fn is_radians(unit: &str) -> Option<bool> {
    match unit {
        "" | "deg" | "deg." | "degree" | "degrees" | "°" | "-" | "–" | "none" => Some(false),
        "rad" | "radian" | "radians" => Some(true),
        _ => None,
    }
}

/// The line of names above a table.
struct Header {
    /// Its line.
    place: u64,
    names: Vec<Name>,
    /// Where α, c_L and c_D stand.
    columns: [Option<usize>; 3],
    /// Whether it stands behind the sign of a comment.
    commented: bool,
}

impl Header {
    fn of(place: u64, line: &str) -> Self {
        let (text, commented) = bare(line);
        let names = names_in(text);
        let columns = NAMES.map(|(_, known)| {
            // `Cl` beside `CL` is the rolling moment.
            let place = |known: &&str| {
                let same = names.iter().enumerate().rev();
                let same = same.filter(|(_, name)| name.text == **known);
                same.max_by_key(|(_, name)| name.capitals)
            };
            Some(known.iter().find_map(place)?.0)
        });
        Self {
            place,
            names,
            columns,
            commented,
        }
    }

    /// The first line with the most names; of several one that is no comment.
    fn find(text: &str) -> Option<Self> {
        let lines = (1..).zip(text.lines());
        let lines = lines.filter(|(_, line)| !is_rule(line));
        let mut all: Vec<Self> = lines.map(|(place, line)| Self::of(place, line)).collect();
        all.reverse();
        let rank = |header: &Self| {
            let known = header.columns.iter().flatten().count();
            // What is said in a comment of one or two names is a sentence.
            let said = header.commented && known < 3;
            (if said { 0 } else { known }, !header.commented)
        };
        let best = all.into_iter().max_by_key(rank)?;
        (rank(&best).0 > 0).then_some(best)
    }

    /// Whether every column is named.
    fn is_whole(&self) -> bool {
        self.columns.iter().all(Option::is_some)
    }
}

/// The unit of the angles in a line of units under the names, where α stands in the column `alpha`; none if it is no such line.
fn units(line: &str, alpha: usize) -> Option<String> {
    let cells: Vec<String> = cells(bare(line).0).into_iter().map(bare_unit).collect();
    let is_number = |cell: &String| cell != "1" && number(cell).is_some();
    let unit = cells.get(alpha)?;
    let all = cells.len() > 1 && !cells.iter().any(is_number) && is_radians(unit).is_some();
    all.then(|| unit.clone())
}

/// The rows under a line of names. Induced drag is a wing's.
fn table(origin: &str, all: &str, header: &Header) -> anyhow::Result<Read> {
    let place = header.place;
    let mut columns = [0; 3];
    for ((column, given), (name, _)) in columns.iter_mut().zip(header.columns).zip(NAMES) {
        *column = given.ok_or_else(|| {
            let names: Vec<&str> = header.names.iter().map(|name| &*name.text).collect();
            anyhow!(
                "{origin}:{place}: no column {name} among {}",
                names.join(", ")
            )
        })?;
    }
    let (mut rows, mut whole) = (Vec::new(), Vec::new());
    let alpha = &header.names[columns[0]];
    let mut radians = is_radians(&alpha.unit).ok_or_else(|| {
        anyhow!(
            "{origin}:{place}: the angles' unit is {:?}, which is neither deg nor rad",
            alpha.unit
        )
    })?;
    radians |= alpha.text == "alpha_rad";
    for (line, text) in (1..).zip(all.lines()).skip(place as usize) {
        if is_rule(text) {
            continue;
        }
        // XFLR5 puts several polars into one file, each under names of its own.
        let another = Header::of(line, text);
        ensure!(
            !another.is_whole() || another.commented != header.commented,
            "{origin}:{line}: a second polar begins here{}",
            several::listed(all)
        );
        if rows.is_empty()
            && let Some(unit) = units(text, columns[0])
        {
            radians |= is_radians(&unit) == Some(true);
            continue;
        }
        let cells = cells(text);
        if another.commented && number(cells.first().unwrap_or(&"")).is_none() || cells.is_empty() {
            continue;
        }
        if foreign::is_end(text) {
            ensure!(
                !several::goes_on(all, line as usize),
                "{origin}:{line}: another table follows{}",
                several::listed(all)
            );
            break;
        }
        if !rows.is_empty() && cells.iter().any(|cell| number(cell).is_none()) {
            let several = several::listed_if_several(all);
            ensure!(
                several.is_empty(),
                "{origin}:{line}: another table begins here{several}"
            );
        }
        let mut row = [0.0; 3];
        for (value, column) in row.iter_mut().zip(columns) {
            let cell = cells.get(column);
            let cell = cell.filter(|_| cells.len() <= header.names.len());
            let cell =
                cell.ok_or_else(|| anyhow!("{origin}:{line}: not as many cells as columns"))?;
            *value =
                number(cell).ok_or_else(|| anyhow!("{origin}:{line}: {cell:?} is not a number"))?;
        }
        if radians {
            row[0] = row[0].to_degrees();
        }
        rows.push((line, row));
        let numbers = cells.iter().map(|cell| number(cell).unwrap_or(f64::NAN));
        whole.push((line, numbers.collect()));
    }
    let names: Vec<&str> = header.names.iter().map(|name| &*name.text).collect();
    several::by_column(origin, &names, &whole)?;
    let farthest = rows
        .iter()
        .fold(0.0, |most, row| f64::max(most, row.1[0].abs()));
    ensure!(
        !radians || farthest < RADIANS.to_degrees(),
        "{origin}:{place}: the angles' unit is rad, and there are some beyond {RADIANS}: are they degrees?"
    );
    let mut comments = all.lines().filter(|line| bare(line).1);
    let of_wing = names.contains(&"cdi") || comments.any(|line| line.contains(WING));
    sorted(origin, all, rows, of_wing)
}

/// By increasing angle: sweeps run either way, and from 0 both ways. An angle that comes again with the same coefficients is left out.
fn sorted(
    origin: &str,
    all: &str,
    mut rows: Vec<(u64, [f64; 3])>,
    of_wing: bool,
) -> anyhow::Result<Read> {
    rows.sort_by(|a, b| a.1[0].total_cmp(&b.1[0]));
    let comes_again = |first: &[f64; 3], again: &[f64; 3]| (again[0] - first[0]).abs() < 1e-6;
    for pair in rows.windows(2) {
        let [(first, a), (again, b)] = pair else {
            continue;
        };
        let same = (1..3).all(|i| (a[i] - b[i]).abs() <= AGAIN);
        ensure!(
            same || !comes_again(a, b),
            "{origin}:{again}: {}° stands in line {first} already, with other coefficients{}",
            b[0],
            several::listed_if_several(all)
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

    /// Decimal commas between blanks, and numbers in quotes, whatever parts them.
    #[test]
    fn decimal_commas_are_read_between_blanks_and_in_quotes() {
        let want = [[-2.5, -0.25, 0.0123], [0.0, 0.0, 0.01], [5.0, 0.5, 0.02]];
        let blanks =
            "alpha   CL    CD\n-2,5  -0,25  0,0123\n 0 0,000 1,00E-02\n5,0\u{a0} 0,5 0,02\n";
        let quotes = "\"alpha\",\"CL\",\"CD\"\n\"-2,5\",\"-0,25\",\"0,0123\"\n\"0\",\"0,000\",\"0,01\"\n\"5,0\",\"0,5\",\"0,02\"\n";
        for text in [
            blanks.to_owned(),
            quotes.to_owned(),
            quotes.replace("\",\"", "\" \""),
            quotes.replace("\",\"", "\";\""),
            quotes.replace("\",\"", "\"\t\""),
        ] {
            assert_eq!(read("x", &text).unwrap().rows, want, "{text}");
        }
        // A comma beside a blank parts cells.
        let cells = "alpha, CL, CD\n-2.5, -0.25, 0.0123\n0 ,0 ,0.01\n5, 0.5, 0.02\n";
        assert_eq!(read("x", cells).unwrap().rows, want);
    }

    /// `Cl` is the lift of a section where there is no `CL`, and the rolling moment beside one, whichever stands first.
    #[test]
    fn the_rolling_moment_is_no_lift() {
        for names in [
            "alpha Cl CL CD",
            "alpha Cl CL Cd",
            "alpha Cltot CLtot CDtot",
        ] {
            let text = format!("{names}\n0 0.001 0 0.01\n5 0.002 0.5 0.02\n");
            assert_eq!(
                read("x", &text).unwrap().rows[1],
                [5.0, 0.5, 0.02],
                "{names}"
            );
            let turned = format!("{}\n0 0 0.001 0.01\n5 0.5 0.002 0.02\n", {
                let words: Vec<&str> = names.split(' ').collect();
                [words[0], words[2], words[1], words[3]].join(" ")
            });
            assert_eq!(
                read("x", &turned).unwrap().rows[1],
                [5.0, 0.5, 0.02],
                "{turned}"
            );
        }
        let section = "alpha Cl Cd Cm\n0 0 0.01 0\n5 0.5 0.02 0\n";
        assert_eq!(read("x", section).unwrap().rows[1], [5.0, 0.5, 0.02]);
    }

    /// As AeroDyn 15 has it: a table behind numbers, with names and units behind the sign of a comment.
    #[test]
    fn names_and_units_behind_the_sign_of_a_comment_are_read() {
        let rows = "-180.0 0.0 0.02 0.0\n 0.0 0.1 0.01 0.0\n 180.0 0.0 0.02 0.0\n";
        let want = [[-180.0, 0.0, 0.02], [0.0, 0.1, 0.01], [180.0, 0.0, 0.02]];
        for sign in ["!", "#", "%", "//", "!!  ", ""] {
            for units in ["(deg) (-) (-) (-)", "[deg] [-] [-] [-]", "deg - - -", ""] {
                let above = "! of mine\n 0.75 Re ! in millions\n 3 NumAlf ! rows of the table\n";
                let text = format!("{above}{sign} Alpha Cl Cd Cm\n{sign} {units}\n{rows}");
                assert_eq!(read("x", &text).unwrap().rows, want, "{text}");
                assert!(is_polar(&text), "{text}");
                let twice = format!("{text}{sign} Alpha Cl Cd Cm\n{rows}");
                let error = read("x", &twice).unwrap_err().to_string();
                assert!(error.contains("a second polar begins here"), "{error}");
            }
        }
        // Radians are said to be some, by name or unit; FORTRAN's exponents; names that stand without a sign go before.
        let radians = "# alpha cl cd\nalpha_rad,CL,CD\n0.5,1.0D-1,2.0d-02\n";
        for text in [
            radians.to_owned(),
            radians.replace("alpha_rad,CL,CD", "alpha (rad),CL,CD"),
            radians.replace("alpha_rad,CL,CD", "alpha,CL,CD\nrad,-,-"),
        ] {
            let rows = read("x", &text).unwrap().rows;
            assert_eq!(rows, [[0.5_f64.to_degrees(), 0.1, 0.02]], "{text}");
        }
    }

    /// VSPAERO's `.polar`, of before and after OpenVSP 3.3: of a whole wing, its whole lift and drag.
    #[test]
    fn both_forms_of_vspaero_are_read() {
        let old = "  Beta  Mach  AoA  Re/1e6  CL  CDo  CDi  CDtot  CS\n 0.0 0.05 2.0 0.4 0.2 0.01 0.004 0.014 0.0\n";
        let new = " Surface Integration Forces and Moments\nBeta Mach AoA Re/1e6 CLo CLi CLtot CDo CDi CDtot CSo\n0 0.05 2.0 0.4 0.0 0.2 0.2 0.01 0.004 0.014 0\n";
        for text in [old, new] {
            let read = read("x", text).unwrap();
            assert_eq!((read.rows, read.of_wing), (vec![[2.0, 0.2, 0.014]], true));
        }
    }

    /// AeroDyn 13's and QBlade's tables have no names.
    #[test]
    fn tables_without_names_are_read_where_the_form_is_known() {
        let rows = "-180.0 0.0 0.02 0.0\n0.0 0.1 0.01 0.0\n180.0 0.0 0.02 0.0\n";
        let want = [[-180.0, 0.0, 0.02], [0.0, 0.1, 0.01], [180.0, 0.0, 0.02]];
        let thirteen = "AeroDyn airfoil file. Compatible with AeroDyn v13.0.\nof mine\nof mine\n 1 Number of airfoil tables in this file\n 0.0 Table ID parameter\n 8.0 Stall angle (deg)\n";
        let qblade = "---QBlade Polar File---\nmine POLARNAME - the name\nNACA_0018 FOILNAME\n18 THICKNESS\n0 ISDECOMPOSED\n1e6 REYNOLDS\n";
        for above in [thirteen, qblade] {
            let text = format!("{above}{rows}EOT\n1 2 3 4\n");
            assert_eq!(read("x", &text).unwrap().rows, want);
            assert!(is_polar(&text));
        }
        for several in [
            thirteen.replace(" 1 Number", " 2 Number"),
            qblade.replace("1e6 REY", "1e6 2e6 REY"),
        ] {
            let error = read("x", &format!("{several}{rows}")).unwrap_err();
            assert!(error.to_string().contains("several polars"), "{error}");
        }
    }

    #[test]
    fn forms_that_are_not_read_are_named() {
        let error = |text: &str| read("x", text).unwrap_err().to_string();
        let jsbsim = "\n<?xml version=\"1.0\"?>\n<fdm_config name=\"mine\">\n<tableData>\n-0.2 -0.6\n</tableData>\n";
        let message = error(jsbsim);
        assert!(
            message.starts_with("x:2: JSBSim's XML") && message.contains("alpha_deg"),
            "{message}"
        );
        assert!(error("<html>").contains("HTML"));
        assert!(!is_polar("base = 'paper'\n# alpha cl cd\nx = 1\n"));
    }

    /// A unit of another column is none of the angles'; and what is none of angles is refused.
    #[test]
    fn the_unit_of_the_angles_is_their_own() {
        let rows = "0,0,0.01,0\n2,0.2,0.01,-0.1\n5,0.5,0.02,-0.2\n";
        let angles = |text: &str| -> anyhow::Result<Vec<f64>> {
            Ok(read("x", text)?.rows.iter().map(|row| row[0]).collect())
        };
        for names in [
            "alpha [deg],cl,cd,cm [1/rad]",
            "alpha,cl,cd,cm (rad)",
            "alpha,cl,cd,cm\ndeg,-,-,1/rad",
            "alpha (deg),cl (-),cd (-),cma (per rad)",
        ] {
            assert_eq!(
                angles(&format!("{names}\n{rows}")).unwrap(),
                [0.0, 2.0, 5.0]
            );
            let blanks = format!("{names}\n{rows}").replace(',', "  ");
            if !names.contains("per rad") {
                assert_eq!(angles(&blanks).unwrap(), [0.0, 2.0, 5.0], "{blanks}");
            }
        }
        let small = rows.replace("\n5,", "\n0.5,").replace("\n2,", "\n0.2,");
        for names in [
            "alpha [rad],cl,cd,cm [1/deg]",
            "alpha,cl,cd,cm\nrad,-,-,1/deg",
        ] {
            let radians = angles(&format!("{names}\n{small}")).unwrap();
            assert_eq!(radians[2], 0.5_f64.to_degrees());
            let error = angles(&format!("{names}\n{rows}")).unwrap_err().to_string();
            assert!(error.contains("are they degrees?"), "{error}");
        }
        let error = angles(&format!("alpha [mil],cl,cd,cm\n{rows}")).unwrap_err();
        assert_eq!(
            error.to_string(),
            "x:1: the angles' unit is \"mil\", which is neither deg nor rad"
        );
    }

    /// Several polars in a file: where each begins, and its Reynolds number.
    #[test]
    fn several_polars_are_listed() {
        let error = |text: &str| read("x", text).unwrap_err().to_string();
        let rows = "-2 -0.2 0.01\n0 0 0.01\n2 0.2 0.01\n";
        let more = "-2 -0.3 0.02\n0 0.1 0.03\n2 0.3 0.02\n";
        let names = " alpha CL CD\n ----- --- ---\n";
        let above = |re: &str| format!(" Mach = 0.000   Re = {re}   Ncrit = 9.000\n");
        // Under names of their own, as XFLR5 has them, and under the same.
        for again in [names, ""] {
            let text = [
                &above("0.100 e 6"),
                names,
                rows,
                "\n",
                &above("200000"),
                again,
                more,
            ]
            .concat();
            let message = error(&text);
            assert!(
                message.contains("tables begin in line 4 (Re 100000), line ")
                    && message.contains("(Re 200000). One file, one polar"),
                "{message}"
            );
        }
        // By a column.
        let with = |re: &str, rows: &str| rows.replace('\n', &format!(" {re}\n"));
        let text = format!("alpha CL CD Re\n{}{}", with("1e5", rows), with("2e5", more));
        assert_eq!(
            error(&text),
            "x:2: several polars, by the column re: 100000 (lines 2 to 4), 200000 (lines 5 to 7). One file, one polar: leave the rows of one of them"
        );
        // A sweep at a fixed lift has another in every row.
        let text = "alpha CL CD Re\n0 0 0.01 1e5\n2 0.2 0.01 9e4\n4 0.4 0.01 8e4\n";
        assert_eq!(read("x", text).unwrap().rows.len(), 3);
        // AeroDyn 15's, each behind its own number in millions; and 14's, behind an end.
        let table = format!("0.75 Re ! Reynolds number in millions\n! Alpha Cl Cd\n{rows}");
        let message = error(&format!("{table}{}", table.replace("0.75", "1.5")));
        assert!(
            message.contains("(Re 750000), line 8 (Re 1500000)"),
            "{message}"
        );
        let message = error(&format!("alpha CL CD\n{rows}EOT\n{more}EOT\n"));
        assert!(
            message.starts_with("x:5: another table follows: tables begin in line 2, line 6"),
            "{message}"
        );
    }
}
