//! `jstsph reproduce`: runs every case of a published study and compares with what it reports.

mod findings;
mod frame;
mod html;
mod judge;
mod markdown;
mod measure;
mod page;
mod pictures;
mod runs;
mod series;
mod study;
mod unfilled;

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use jstsph_output::{OutputError, atomic_write};

use crate::arguments::ReproduceOptions;
use crate::console::Console;
use crate::error::CliError;
use findings::{Findings, QuantityFinding};
use judge::Verdict;
use study::Study;

/// Runs, measures, compares, writes the page.
pub(crate) fn run(
    options: &ReproduceOptions,
    command: &[OsString],
    console: &mut Console<'_>,
    interrupted: &AtomicBool,
) -> Result<u8, CliError> {
    let Some(name) = &options.study else {
        for name in study::names() {
            console.print(format_args!("{name}  {}\n", Study::named(&name)?.title));
        }
        return Ok(0);
    };
    let study = Study::named(name)?;
    if let Some(file) = &options.from {
        let findings = Findings::read(&study, file)?;
        console.print(format_args!(
            "<!-- Written by `jstsph reproduce {name} --from FILE`; do not edit. -->\n\n{}",
            markdown::text(&page::blocks(&study, &findings))
        ));
        return Ok(0);
    }
    if let Some(id) = options.only.iter().find(|id| study.run(id).is_none()) {
        return Err(CliError::UnknownName {
            what: "run",
            name: id.clone(),
            allowed: study.runs.iter().map(|run| run.id.clone()).collect(),
        });
    }
    let suffix = if options.quick { "-quick" } else { "" };
    let out = options
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from("results").join(format!("reproduce-{name}{suffix}")));
    let io = |action, path: &Path| {
        let path = path.to_path_buf();
        move |source| {
            CliError::Page(OutputError::Io {
                action,
                path,
                source,
            })
        }
    };
    let folder = out.join("pictures");
    std::fs::create_dir_all(&folder).map_err(io("create", &folder))?;

    let Some(runs) = runs::make(&study, options, &out, command, console, interrupted) else {
        return Ok(130);
    };
    let mut findings = Findings::new(&study, options.quick);
    for quantity in &study.quantities {
        let mut found = QuantityFinding::measure(quantity, &runs.findings, &runs.results);
        match pictures::draw(quantity, &found, &runs.results, &out) {
            Ok(drawn) => found.pictures = drawn,
            // Numbers are worth a page without a picture.
            Err(error) => console.error(format_args!("warning: {}: {error}\n", quantity.id)),
        }
        findings.quantities.push(found);
    }
    findings.runs = runs.findings;
    write(&study, &findings, &out)?;

    let counts = Verdict::ALL
        .iter()
        .map(|verdict| (findings.count(*verdict), verdict.text()));
    for (count, text) in counts.filter(|(count, _)| *count > 0) {
        console.print(format_args!("{count:4} {text}\n"));
    }
    console.print(format_args!(
        "wrote {}\n",
        out.join("reproduction.html").display()
    ));
    Ok(0)
}

/// Writes `reproduction.json`, `.md` and `.html`.
fn write(study: &Study, findings: &Findings, out: &Path) -> Result<(), CliError> {
    let blocks = page::blocks(study, findings);
    let json = serde_json::to_string_pretty(findings).map_err(|source| {
        CliError::Page(OutputError::Json {
            path: out.join("reproduction.json"),
            source,
        })
    })?;
    let page = html::text(&study.title, &blocks, |file| {
        std::fs::read(out.join(file)).ok()
    });
    for (ending, text) in [
        ("json", json + "\n"),
        ("md", markdown::text(&blocks)),
        ("html", page),
    ] {
        let path = out.join(format!("reproduction.{ending}"));
        atomic_write(&path, |writer| writer.write_all(text.as_bytes())).map_err(CliError::Page)?;
    }
    Ok(())
}
