//! Studies: which runs are compared with which published numbers. One data file each, in `studies/`.

use std::collections::{BTreeMap, HashSet};

use jstsph_case::units::parse_quantity;
use serde::{Deserialize, Deserializer};

use super::judge::Expectation;
use super::measure::Measure;
use crate::error::CliError;

/// Names and data files of the studies; another one is another line here.
const STUDIES: &[(&str, &str)] = &[
    ("greto2019", include_str!("../../studies/greto2019.toml")),
    ("ba-gakwaya", include_str!("../../studies/ba-gakwaya.toml")),
];

/// A publication, what to run for it and what it reports.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Study {
    /// Name on the command line.
    #[serde(skip)]
    pub(super) name: String,
    /// One line.
    pub(super) title: String,
    /// The publication.
    pub(super) citation: String,
    /// What a reader of the page has to know.
    pub(super) introduction: String,
    /// Simulations.
    #[serde(rename = "run")]
    pub(super) runs: Vec<Run>,
    /// Published numbers and figures, in their order.
    #[serde(rename = "quantity")]
    pub(super) quantities: Vec<Quantity>,
}

/// A shipped case with overrides.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Run {
    /// Name within the study, also of its folder.
    pub(super) id: String,
    /// Shipped case.
    pub(super) case: String,
    /// What distinguishes it in tables, beside the number of particles. Runs of one scheme are one
    /// series over the resolution.
    pub(super) scheme: String,
    /// Overrides of the full study, as after `--set`; `None` leaves the run out of it.
    pub(super) full: Option<BTreeMap<String, String>>,
    /// The same for the quick study.
    pub(super) quick: Option<BTreeMap<String, String>>,
}

impl Run {
    /// Overrides for the full or the quick study, if the run is part of it.
    pub(super) fn overrides(&self, is_quick: bool) -> Option<&BTreeMap<String, String>> {
        if is_quick { &self.quick } else { &self.full }.as_ref()
    }
}

/// A published number, statement or figure.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Quantity {
    /// Name within the study, anchor on the page.
    pub(super) id: String,
    /// Heading of the page under which it stands, when a new one begins.
    #[serde(default)]
    pub(super) part: Option<String>,
    /// Heading.
    pub(super) title: String,
    /// Table, figure, section.
    pub(super) source: String,
    /// What the paper says, in words where only a figure shows it.
    pub(super) paper: String,
    /// Further numbers of the source, as printed.
    #[serde(default)]
    pub(super) references: Vec<Reference>,
    /// Unit of all numbers here and on the page; none for pure numbers.
    #[serde(default)]
    pub(super) unit: String,
    /// What the measured numbers are.
    pub(super) measured: String,
    /// How our number is read off a run.
    pub(super) measure: Measure,
    /// The paper's statement in a few words, for the overview; a number speaks for itself.
    #[serde(default)]
    pub(super) claim: String,
    /// When it agrees.
    pub(super) expect: Expectation,
    /// Runs it is read off. The verdict is that of the first one that is part of the study (full
    /// or quick), or of its scheme.
    pub(super) runs: Vec<String>,
    /// Why it differs, or what to know when it does not.
    #[serde(default)]
    pub(super) reason: String,
    /// What to draw.
    #[serde(default)]
    pub(super) pictures: Vec<Picture>,
}

/// A number of somebody else beside ours.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Reference {
    /// Whose.
    pub(super) label: String,
    /// In the unit of the quantity.
    pub(super) value: f64,
}

/// A picture on the page.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub(super) enum Picture {
    /// The body of a run, coloured by a field, at several times.
    Body {
        run: String,
        field: String,
        times: Vec<String>,
        #[serde(default)]
        range: Option<[f64; 2]>,
        caption: String,
    },
    /// Columns of `history.csv` over time, as after `jstsph plot --history`.
    History {
        run: String,
        columns: String,
        caption: String,
    },
    /// The values of the quantity along a line of points, one curve per run.
    Profile { caption: String },
    /// The values of the quantity over the number of particles, one curve per scheme.
    Convergence { caption: String },
}

impl Picture {
    /// The run drawn, if it is one of its own.
    fn run(&self) -> Option<&str> {
        match self {
            Self::Body { run, .. } | Self::History { run, .. } => Some(run),
            Self::Profile { .. } | Self::Convergence { .. } => None,
        }
    }
}

impl Quantity {
    /// SI value of one unit.
    pub(super) fn unit_in_si(&self) -> f64 {
        // A unit that is not one is found when the study is read.
        unit_in_si(&self.unit).unwrap_or(1.0)
    }
}

fn unit_in_si(unit: &str) -> Option<f64> {
    if unit.is_empty() {
        return Some(1.0);
    }
    parse_quantity(&format!("1 {unit}")).ok().map(|(si, _)| si)
}

/// A number in SI units, or a text with a unit.
pub(super) fn si<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Text {
        Number(f64),
        WithUnit(String),
    }
    match Text::deserialize(deserializer)? {
        Text::Number(value) => Ok(value),
        Text::WithUnit(text) => parse_quantity(&text)
            .map(|(value, _)| value)
            .map_err(serde::de::Error::custom),
    }
}

/// Two of them, from and to.
pub(super) fn si_range<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[f64; 2], D::Error> {
    #[derive(Deserialize)]
    struct Si(#[serde(deserialize_with = "si")] f64);
    let [from, to] = <[Si; 2]>::deserialize(deserializer)?;
    Ok([from.0, to.0])
}

/// Any number of them.
pub(super) fn si_list<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<f64>, D::Error> {
    #[derive(Deserialize)]
    struct Si(#[serde(deserialize_with = "si")] f64);
    let values = Vec::<Si>::deserialize(deserializer)?;
    Ok(values.into_iter().map(|value| value.0).collect())
}

/// Names of the studies there are.
pub(super) fn names() -> Vec<String> {
    STUDIES.iter().map(|(name, _)| (*name).to_owned()).collect()
}

impl Study {
    /// The study of that name.
    ///
    /// # Errors
    /// [`CliError::UnknownName`]; [`CliError::Study`] when its data file contradicts itself.
    pub(super) fn named(name: &str) -> Result<Self, CliError> {
        let Some((_, text)) = STUDIES.iter().find(|(known, _)| *known == name) else {
            return Err(CliError::UnknownName {
                what: "study",
                name: name.to_owned(),
                allowed: names(),
            });
        };
        Self::parse(name, text)
    }

    fn parse(name: &str, text: &str) -> Result<Self, CliError> {
        let fail = |reason: String| CliError::Study {
            name: format!("study {name}"),
            reason,
        };
        let mut study: Self = toml::from_str(text).map_err(|error| fail(error.to_string()))?;
        name.clone_into(&mut study.name);
        match study.contradiction() {
            None => Ok(study),
            Some(reason) => Err(fail(reason)),
        }
    }

    /// The first thing that cannot be meant, if there is one.
    fn contradiction(&self) -> Option<String> {
        let mut ids = HashSet::new();
        let all = self.runs.iter().map(|run| &run.id);
        if let Some(id) = all
            .chain(self.quantities.iter().map(|q| &q.id))
            .find(|id| !ids.insert(*id))
        {
            return Some(format!("`{id}` is there twice"));
        }
        for quantity in &self.quantities {
            let about = |reason: String| Some(format!("quantity `{}`: {reason}", quantity.id));
            if quantity.runs.is_empty() {
                return about("it has no run".to_owned());
            }
            let drawn = quantity.pictures.iter().filter_map(Picture::run);
            let unknown = quantity
                .runs
                .iter()
                .map(String::as_str)
                .chain(drawn)
                .find(|id| self.run(id).is_none());
            if let Some(id) = unknown {
                return about(format!("there is no run `{id}`"));
            }
            if unit_in_si(&quantity.unit).is_none() {
                return about(format!("`{}` is no unit", quantity.unit));
            }
        }
        None
    }

    /// The runs of the full or the quick study.
    pub(super) fn part(&self, is_quick: bool) -> impl Iterator<Item = &Run> {
        let is_part = move |run: &&Run| run.overrides(is_quick).is_some();
        self.runs.iter().filter(is_part)
    }

    /// The run of that id.
    pub(super) fn run(&self, id: &str) -> Option<&Run> {
        self.runs.iter().find(|run| run.id == id)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::templates::CASES;

    const SMALL: &str = r#"
title = "t"
citation = "c"
introduction = "i"
[[run]]
id = "r"
case = "taylor-bar"
scheme = "bonds"
full = { "time.end" = "1 us" }
[[quantity]]
id = "q"
title = "radius"
source = "Table 1"
paper = "6.98 mm"
measured = "radius"
unit = "mm"
measure.column = { name = "base_radius", at = "80 us" }
expect.value = { paper = 6.98, met = 0.01, close = 0.05 }
runs = ["r"]
"#;

    #[test]
    fn studies_name_shipped_cases_and_their_overrides_are_understood() {
        for name in names() {
            let study = Study::named(&name).unwrap_or_else(|error| panic!("{error}"));
            for run in &study.runs {
                let (_, text) = CASES
                    .iter()
                    .find(|(case, _)| *case == run.case)
                    .unwrap_or_else(|| panic!("{}: there is no case {}", run.id, run.case));
                assert!(run.full.is_some() || run.quick.is_some(), "{}", run.id);
                for overrides in [&run.full, &run.quick].into_iter().flatten() {
                    let overrides: Vec<(String, String)> = overrides.clone().into_iter().collect();
                    jstsph_case::parse(&run.case, &run.id, text, &overrides)
                        .unwrap_or_else(|error| panic!("{error}"));
                }
            }
        }
    }

    #[test]
    fn numbers_with_units_become_si() {
        let study = Study::parse("small", SMALL).unwrap();
        let quantity = &study.quantities[0];
        assert_eq!(quantity.unit_in_si(), 1e-3);
        let Measure::Column { name, at } = &quantity.measure else {
            panic!("{:?}", quantity.measure);
        };
        assert_eq!((name.as_str(), *at), ("base_radius", 80e-6));
        let run = study.run("r").unwrap();
        assert_eq!(run.overrides(false).unwrap()["time.end"], "1 us");
        assert!(run.overrides(true).is_none());
    }

    #[test]
    fn contradictions_are_named() {
        for (find, replace, reason) in [
            (
                "runs = [\"r\"]",
                "runs = [\"s\"]",
                "quantity `q`: there is no run `s`",
            ),
            ("runs = [\"r\"]", "runs = []", "quantity `q`: it has no run"),
            (
                "unit = \"mm\"",
                "unit = \"mn\"",
                "quantity `q`: `mn` is no unit",
            ),
            ("id = \"q\"", "id = \"r\"", "`r` is there twice"),
            ("80 us", "80 uz", "80 uz"),
            ("unit = \"mm\"", "unti = \"mm\"", "unknown field `unti`"),
        ] {
            let text = SMALL.replace(find, replace);
            let message = Study::parse("small", &text).unwrap_err().to_string();
            assert!(
                message.starts_with("study small: ") && message.contains(reason),
                "{message}"
            );
        }
        assert!(Study::named("greto").is_err());
    }
}
