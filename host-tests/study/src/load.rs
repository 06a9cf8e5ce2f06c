//! Reading a campaign: its text, its base's, and whether both go together.

use std::path::Path;

use anyhow::Context;
use serde::{Deserialize, Serialize};

use super::random_reference::REFERENCE;
use super::{Campaign, Dispersion, Expected, FaultDraw, Limit};
use alula_sim::experiment::{Document, FieldError, assigned, finite, from_toml, require};
use alula_sim::figures;
use alula_sim::kind::Kind;
use alula_sim::named::{Named, built_in, in_shell};

/// Name and TOML text of every built-in campaign.
pub const BUILT_IN: &[(&str, &str)] = built_in! { "campaigns", ".toml";
    "dispersed",
    "faults",
    "envelope",
    "upsets",
    "vehicles",
    "mass-and-area",
    "lift-and-thrust-line",
    "faults-in-space",
    "paths",
    "steep-turns",
    "fast-starts",
    "tail-sitters",
    "tail-sitter-falls",
    "tail-sitter-hover",
    "cruise",
};

/// Most flights of a campaign: months on one core.
const MAX_FLIGHTS: u64 = 1_000_000_000;

/// A campaign with all that decides its results: what a folder of results keeps.
#[derive(Clone, Debug, PartialEq)]
pub struct CampaignSource {
    /// Texts.
    pub texts: Texts,
    /// What the campaign says.
    pub campaign: Campaign,
    /// The experiment that its flights depart from.
    pub base: Document,
    /// What the command line calls it, from the working directory, where that is not its name.
    argument: Option<String>,
    /// What the command line changes.
    changes: Vec<String>,
    /// Number of flights of what the command line calls so.
    own_flights: u64,
}

/// The texts that decide a campaign's results.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Texts {
    /// Version that flies.
    pub version: String,
    /// Built-in name, or the file's name.
    pub name: String,
    /// Number of flights.
    pub flights: u64,
    /// The campaign's TOML text.
    pub campaign: String,
    /// The base's, whole.
    pub base: String,
}

impl Texts {
    /// What decides each flight by its number: all but how many there are.
    #[cfg(feature = "store")]
    pub(super) fn flown(&self) -> Self {
        Self {
            flights: 0,
            ..self.clone()
        }
    }
}

impl CampaignSource {
    /// The campaign that `argument` names, a built-in or else a TOML file, with `flights` in place of its own number.
    pub fn load(argument: &str, flights: Option<u64>) -> anyhow::Result<Self> {
        Self::load_changed(argument, flights, &[])
    }

    /// The same with `changes`, each `PATH=VALUE`, to what all flights have.
    pub fn load_changed(
        argument: &str,
        flights: Option<u64>,
        changes: &[String],
    ) -> anyhow::Result<Self> {
        let mut named = Named::find("campaign", BUILT_IN, argument)?;
        if !changes.is_empty() {
            named.text = changed(&named.text, changes).context(named.origin.clone())?;
        }
        // Where the base is, the text itself must say.
        Kind::Campaign.expect(&named.origin, named.text.as_bytes())?;
        let campaign: Campaign = from_toml(&named.origin, &named.text, |_| Ok(()))?;
        let base = Document::named_in(&named, &campaign.base);
        let base = base.with_context(|| format!("{}: base", named.origin))?;
        // With the extension, without the folder: how the command is to be given beside the file.
        let name = Path::new(argument).file_name().unwrap_or_default();
        let texts = Texts {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            name: name.to_string_lossy().into_owned(),
            flights: flights.unwrap_or(campaign.flights),
            campaign: named.text,
            base: base.text(),
        };
        Ok(Self {
            argument: Some(argument.to_owned()),
            changes: changes.to_vec(),
            ..Self::from_texts(texts, &named.origin)?
        })
    }

    /// The campaign of `texts`; `origin` stands for the campaign's in errors.
    pub fn from_texts(texts: Texts, origin: &str) -> anyhow::Result<Self> {
        let document = Document::new(&Named::new(&texts.name, origin, &texts.base))?;
        let base = |campaign: &Campaign| {
            let mut base = document.clone();
            for (path, value) in &campaign.set {
                base.set(path, value.clone()).map_err(|e| at("set", e))?;
            }
            // A vehicle that is dispersed is not what the controller believes in.
            if campaign
                .disperse
                .iter()
                .any(|d| d.field.starts_with("vehicle"))
            {
                base.pin_belief().map_err(|e| at("set", e))?;
            }
            Ok(base)
        };
        let mut campaign: Campaign = from_toml(origin, &texts.campaign, |campaign: &Campaign| {
            campaign.validate(&base(campaign)?)
        })?;
        let own_flights = campaign.flights;
        campaign.flights = texts.flights;
        if !(1..=MAX_FLIGHTS).contains(&campaign.flights) {
            anyhow::bail!("{origin}: flights: must be from 1 to {MAX_FLIGHTS}");
        }
        let base = base(&campaign).expect("validated above");
        Ok(Self {
            texts,
            campaign,
            base,
            argument: None,
            changes: Vec::new(),
            own_flights,
        })
    }

    /// Its name without an extension: that of its folder.
    pub fn stem(&self) -> &str {
        self.texts.name.trim_end_matches(".toml")
    }

    /// Its results are in `folder`, which names it from now on: where its file is, if it has one, is not known.
    pub fn is_found_in(&mut self, folder: &Path) {
        self.argument = Some(folder.display().to_string());
        self.changes.clear();
        self.own_flights = self.texts.flights;
    }

    /// The command that flies flight `number` again and leaves its trace.
    pub fn refly(&self, number: u64) -> String {
        let name = self.argument.as_ref().unwrap_or(&self.texts.name);
        let set = self.changes.iter();
        let set: String = set.map(|c| format!(" --set {}", in_shell(c))).collect();
        let more = match number < self.own_flights {
            true => String::new(),
            false => format!(" --flights {}", self.texts.flights),
        };
        format!(
            "alula-sil campaign {}{set}{more} --refly {number}",
            in_shell(name)
        )
    }
}

/// A campaign's `text` with these changes in its table `set`. What is set is not drawn, and no map is over it.
fn changed(text: &str, changes: &[String]) -> anyhow::Result<String> {
    let mut campaign: toml::Table = text.parse()?;
    let mut is_set = Vec::new();
    let set = campaign.entry("set").or_insert(toml::Table::new().into());
    let set = set.as_table_mut().context("set: must be a table")?;
    for change in changes {
        let (path, value) = assigned(change)?;
        set.insert(path.to_owned(), value);
        is_set.push(path);
    }
    for (list, fields) in [
        ("disperse", &["field"][..]),
        ("maps", &["x.field", "y.field"]),
    ] {
        let Some(entries) = campaign.get_mut(list).and_then(toml::Value::as_array_mut) else {
            continue;
        };
        entries.retain(|entry| {
            !fields.iter().any(|field| {
                let mut keys = field.split('.');
                let value = keys.try_fold(entry, |value, key| value.get(key));
                value
                    .and_then(toml::Value::as_str)
                    .is_some_and(|field| is_set.contains(&field))
            })
        });
    }
    Ok(toml::to_string(&campaign)?)
}

/// The experiment's error under the campaign's field.
fn at(field: &str, error: FieldError) -> FieldError {
    FieldError::new(field, format!("{}: {}", error.field, error.problem))
}

impl Campaign {
    fn validate(&self, base: &Document) -> Result<(), FieldError> {
        let experiment = base.experiment().map_err(|e| at("set", e))?;
        for (i, dispersion) in self.disperse.iter().enumerate() {
            let field = format!("disperse[{i}]");
            dispersion.validate(&field, base)?;
            let mut earlier = self.disperse[..i].iter();
            let again = earlier.any(|d| d.field == dispersion.field);
            require(!again, field, "this field is dispersed already")?;
        }
        let borne = self.faults.is_empty() || experiment.controller.kind == "guidance";
        require(borne, "faults", "only the guidance can be given faults")?;
        for (i, fault) in self.faults.iter().enumerate() {
            fault.validate(&format!("faults[{i}]"))?;
        }
        if let Some(reference) = &self.reference {
            let problem = "can be drawn only for an experiment in a vertical plane, with knots";
            require(experiment.in_plane(), "reference", problem)?;
            reference.validate()?;
        }
        for (i, map) in self.maps.iter().enumerate() {
            let dispersed = |name: &str| self.disperse.iter().any(|d| d.field == name);
            let drawn = |name: &str| self.reference.is_some() && REFERENCE.contains(&name);
            let figure = |name: &str| figures::index(name).is_some();
            let known = |name: &str| dispersed(name) || drawn(name) || figure(name);
            map.validate(&format!("maps[{i}]"), known, figure)?;
        }
        for (i, limit) in self.limits.iter().enumerate() {
            limit.validate(&format!("limits[{i}]"))?;
        }
        // The first flight stands for what ranges cannot tell.
        self.draw(base, 0)
            .map(|_| ())
            .map_err(|e| at("disperse", e))
    }
}

impl Dispersion {
    fn validate(&self, field: &str, base: &Document) -> Result<(), FieldError> {
        if let Some(names) = &self.names {
            let others = [&self.scale, &self.add, &self.to];
            let alone = others.iter().all(|other| other.is_none())
                && self.powers.is_empty()
                && self.plus.is_none()
                && self.at_most.is_empty();
            require(alone, field, "names stand alone")?;
            require(!names.is_empty(), format!("{field}.names"), "is empty")?;
            return names.iter().try_for_each(|name| {
                let mut document = base.clone();
                document
                    .set(&self.field, toml::Value::String(name.clone()))
                    .map_err(|e| at(&format!("{field}.names"), e))
            });
        }
        let kinds = [("scale", &self.scale), ("add", &self.add), ("to", &self.to)];
        let mut given = kinds
            .iter()
            .filter_map(|(kind, d)| Some((kind, d.as_ref()?)));
        let (Some((kind, distribution)), None) = (given.next(), given.next()) else {
            return Err(FieldError::new(
                field,
                "needs one of scale, add, to and names",
            ));
        };
        distribution.validate(&format!("{field}.{kind}"))?;
        let problem = "duration_s is the same in all flights: they are sampled together";
        require(self.field != "duration_s", field, problem)?;
        if self.to.is_none() {
            base.number(&self.field).map_err(|e| at(field, e))?;
        }
        let mut document = base.clone();
        document
            .set(&self.field, toml::Value::Float(0.0))
            .map_err(|e| at(field, e))
    }
}

impl FaultDraw {
    fn validate(&self, field: &str) -> Result<(), FieldError> {
        self.from_s.validate(&format!("{field}.from_s"))?;
        self.lasts_s.validate(&format!("{field}.lasts_s"))?;
        let size = format!("{field}.size");
        match (&self.size, self.kind.has_size()) {
            (Some(distribution), true) => distribution.validate(&size)?,
            (None, true) => return Err(FieldError::new(size, "this kind has a size")),
            (Some(_), false) => return Err(FieldError::new(size, "this kind has no size")),
            (None, false) => {}
        }
        finite(&format!("{field}.sinks_m"), self.sinks_m.unwrap_or(0.0))?;
        self.during.validate(&format!("{field}.during"))?;
        self.after.validate(&format!("{field}.after"))
    }
}

impl Expected {
    fn validate(&self, field: &str) -> Result<(), FieldError> {
        let known = |part: &str, name: Option<&str>, names: &[&str]| match name {
            Some(name) => is_one_of(names, &format!("{field}.{part}"), name),
            None => Ok(()),
        };
        let modes = ["safe", "holding", "flying"];
        known("mode", self.mode.as_deref(), &modes)?;
        let airs = ["velocity", "wind", "held-wind", "none", "pitot"];
        known("air", self.air.as_deref(), &airs)?;
        let all = alula::guidance::Status::all().to_string();
        let flags: Vec<&str> = all.split('|').collect();
        for (part, list) in [("status", &self.status), ("not_status", &self.not_status)] {
            for flag in list {
                known(part, Some(flag), &flags)?;
            }
        }
        Ok(())
    }
}

impl Limit {
    fn validate(&self, field: &str) -> Result<(), FieldError> {
        let known = figures::index(&self.figure).is_some();
        require(
            known,
            format!("{field}.figure"),
            figures::unknown(&self.figure),
        )?;
        let given = self.least.is_some() || self.most.is_some();
        require(given, field, "needs least or most")?;
        let crossed = self.least.zip(self.most).is_some_and(|(l, m)| l > m);
        require(!crossed, field, "least must not exceed most")?;
        for (part, value) in [("least", self.least), ("most", self.most)] {
            finite(&format!("{field}.{part}"), value.unwrap_or(0.0))?;
        }
        let share = (0.0..=1.0).contains(&self.share);
        require(share, format!("{field}.share"), "must be from 0 to 1")
    }
}

/// `name` must be one of `names`.
fn is_one_of(names: &[&str], field: &str, name: &str) -> Result<(), FieldError> {
    let problem = format!("{name} is none of {}", names.join(", "));
    require(names.contains(&name), field, problem)
}
