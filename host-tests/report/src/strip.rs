//! What a controller did and said, over time: rows of words.

use std::fmt::Write as _;

use super::svg::{Drawn, escape, width};

/// A row: one quantity, and when it was which word.
pub struct Row {
    /// What the words are.
    pub name: &'static str,
    /// One after the other.
    pub spans: Vec<Span>,
    /// Whether the words are sets of flags.
    pub flags: bool,
}

/// A word over a time.
#[derive(Clone, Debug, PartialEq)]
pub struct Span {
    /// Beginning \[s\].
    pub from: f64,
    /// End \[s\].
    pub to: f64,
    /// The word.
    pub word: String,
}

/// Rows of words over a time.
pub struct Strip {
    /// Length \[s\].
    pub duration: f64,
    /// The rows.
    pub rows: Vec<Row>,
}

/// Words that say that all is well.
const QUIET: [&str; 6] = ["", "ok", "flying", "tracking", "velocity", "cruise"];
/// Classes of the others, by first appearance, again and again.
const LOUD: [&str; 8] = [
    "word0", "word1", "word2", "word3", "word4", "word5", "word6", "word7",
];

/// The class of every word of a row of flags, which may be raised in any combination.
const FLAGS: &str = "flags";

/// Units per second in which the spans are written.
const UNITS: f64 = 1000.0;

const WIDE: f64 = 1200.0;
const LEFT: f64 = 70.0;
const HIGH: f64 = 22.0;

impl Row {
    /// The row of a word at every time; `None` if there is never one.
    pub fn of(
        name: &'static str,
        words: impl Iterator<Item = (f64, Option<String>)>,
    ) -> Option<Self> {
        let mut spans: Vec<Span> = Vec::new();
        for (t, word) in words {
            let Some(word) = word else { continue };
            match spans.last_mut() {
                Some(last) if last.word == word => last.to = t,
                last => {
                    if let Some(last) = last {
                        last.to = t;
                    }
                    spans.push(Span {
                        from: t,
                        to: t,
                        word,
                    });
                }
            }
        }
        (!spans.is_empty()).then_some(Self {
            name,
            spans,
            flags: name == "status",
        })
    }
}

impl Strip {
    /// Every word with its class, by first appearance.
    fn classes(&self) -> Vec<(&str, &'static str)> {
        let mut classes: Vec<(&str, &'static str)> = Vec::new();
        let mut loud = LOUD.iter().cycle();
        for row in &self.rows {
            for Span { word, .. } in &row.spans {
                if classes.iter().any(|(known, _)| known == word) {
                    continue;
                }
                let class = match QUIET.contains(&word.as_str()) {
                    true => "quiet",
                    false if row.flags => FLAGS,
                    false => loud.next().expect("a cycle"),
                };
                classes.push((word, class));
            }
        }
        classes
    }

    /// What the colours are: each with its class.
    pub fn key(&self) -> Vec<(String, &'static str)> {
        let classes = self.classes();
        let words = classes
            .iter()
            .filter(|(_, class)| *class != "quiet" && *class != FLAGS);
        let mut key: Vec<_> = words
            .map(|(word, class)| ((*word).to_owned(), *class))
            .collect();
        if classes.iter().any(|(_, class)| *class == FLAGS) {
            key.push(("a status flag: the cursor tells which".to_owned(), FLAGS));
        }
        key
    }

    /// The rows' names.
    pub fn names(&self) -> String {
        let names: Vec<&str> = self.rows.iter().map(|row| row.name).collect();
        names.join(", ")
    }

    /// The strip as a drawing; the page's script reads the spans from it.
    pub fn draw(&self) -> Drawn {
        let mut body = String::from(
            "<text class=\"title\" x=\"2\" y=\"15\">what the controller did and said</text>\n",
        );
        let scale = (WIDE - LEFT - 14.0) / (self.duration * UNITS).max(1.0);
        let key = self.classes();
        for (i, row) in self.rows.iter().enumerate() {
            let top = 24.0 + HIGH * i as f64;
            let middle = top + 0.5 * HIGH + 3.0;
            let _ = writeln!(
                body,
                "<text class=\"tick y\" x=\"{}\" y=\"{middle}\">{}</text>",
                LEFT - 8.0,
                row.name
            );
            for (word, class) in &key {
                let mut data = String::new();
                for Span { from, to, .. } in row.spans.iter().filter(|span| span.word == *word) {
                    let (from, to) = ((from * UNITS).round(), (to * UNITS).round());
                    let long = to - from;
                    let _ = write!(data, "M{from} 0h{long}v1h-{long}z");
                }
                if !data.is_empty() {
                    let _ = writeln!(
                        body,
                        "<path class=\"span {class}\" data-row=\"{i}\" data-of=\"{}\" data-word=\"{}\" transform=\"translate({LEFT} {top}) scale({scale:.6} {})\" d=\"{data}\"/>",
                        row.name,
                        escape(word),
                        HIGH - 4.0
                    );
                }
            }
            for Span { from, to, word } in &row.spans {
                if width(word, 12.0) + 10.0 < (to - from) * UNITS * scale {
                    let quiet = key
                        .iter()
                        .any(|(known, class)| known == word && *class == "quiet");
                    let _ = writeln!(
                        body,
                        "<text class=\"word{}\" x=\"{:.1}\" y=\"{middle}\">{}</text>",
                        if quiet { " quietly" } else { "" },
                        LEFT + from * UNITS * scale + 5.0,
                        escape(word)
                    );
                }
            }
        }
        Drawn {
            size: [WIDE, 32.0 + HIGH * self.rows.len() as f64],
            attributes: format!(
                "class=\"strip\" data-duration=\"{}\" data-units=\"{UNITS}\"",
                self.duration
            ),
            body,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row() -> Row {
        let words = ["tracking", "tracking", "crossing", "tracking"];
        let all = words
            .iter()
            .enumerate()
            .map(|(i, word)| (i as f64, Some((*word).to_owned())));
        Row::of("phase", all).unwrap()
    }

    #[test]
    fn equal_words_are_one_span() {
        let spans = row().spans;
        let expected = [
            ([0.0, 2.0], "tracking"),
            ([2.0, 3.0], "crossing"),
            ([3.0, 3.0], "tracking"),
        ];
        let expected = expected.map(|([from, to], word)| Span {
            from,
            to,
            word: word.to_owned(),
        });
        assert_eq!(spans, expected);
        assert!(Row::of("mode", [(0.0, None)].into_iter()).is_none());
    }

    #[test]
    fn only_what_is_out_of_the_ordinary_is_loud() {
        let strip = Strip {
            duration: 3.0,
            rows: vec![row()],
        };
        assert_eq!(strip.key(), [("crossing".to_owned(), "word0")]);
        let drawn = strip.draw().body;
        assert!(drawn.contains("d=\"M2000 0h1000v1h-1000z\""), "{drawn}");
        // A span of no length has no room for its word.
        assert_eq!(drawn.matches(">tracking<").count(), 1);
    }
}
