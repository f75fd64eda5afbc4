//! `jstsph reproduce`, with the cheapest runs of the shipped study.

mod common;

use common::Place;

const COMMAND: &str = "jstsph reproduce greto2019 --quick --any-version --out @/r";

fn json(place: &Place) -> serde_json::Value {
    serde_json::from_str(&place.text("r/reproduction.json")).expect("JSON")
}

fn quantity<'a>(json: &'a serde_json::Value, id: &str) -> &'a serde_json::Value {
    let all = json["quantities"].as_array().expect("a list");
    all.iter()
        .find(|quantity| quantity["id"] == id)
        .unwrap_or_else(|| panic!("no quantity {id}"))
}

#[test]
fn a_study_runs_measures_compares_and_writes_its_page_once() {
    let place = Place::new();
    let outcome = place.jstsph(&format!("{COMMAND} --only bar-bonds-1,block-particles-1"));
    assert_eq!(outcome.code, 0, "{}", outcome.err);
    assert!(outcome.out.contains("not run"), "{}", outcome.out);
    assert!(outcome.err.contains("bar-bonds-1\n"), "{}", outcome.err);

    let found = json(&place);
    let radius = quantity(&found, "table-1");
    // The first run of the quantity was not made, so there is no verdict, but the other has its row.
    assert_eq!(radius["verdict"], "not_run");
    let rows = radius["rows"].as_array().expect("rows");
    let row = rows
        .iter()
        .find(|row| row["run"] == "bar-bonds-1")
        .expect("a row");
    let value = row["values"][0].as_f64().expect("a number");
    // In mm; the same bar as in tests/validation, coarser than the paper's.
    assert!((6.9..7.2).contains(&value), "{value}");
    assert_eq!(row["particles"], 273);
    assert_eq!(row["difference"].as_f64(), Some(value / 6.98 - 1.0));
    let strain = quantity(&found, "fig-8");
    assert_eq!(strain["pictures"].as_array().map(Vec::len), Some(1));

    let markdown = place.text("r/reproduction.md");
    assert!(markdown.contains("pictures/fig-8-4.png"), "{markdown}");
    assert!(place.path("r/pictures/fig-8-4.png").is_file());
    let html = place.text("r/reproduction.html");
    assert!(html.contains("src=\"data:image/png;base64,"));
    assert!(!html.contains("src=\"pictures"));

    // A second time nothing is run, asked for or not, and the same comes out.
    let again = place.jstsph(&format!("{COMMAND} --only bar-bonds-1"));
    assert_eq!(again.code, 0, "{}", again.err);
    assert_eq!(
        again.err.matches("finished earlier").count(),
        2,
        "{}",
        again.err
    );
    assert_eq!(json(&place)["quantities"], found["quantities"]);

    let printed = place.jstsph("jstsph reproduce greto2019 --from @/r/reproduction.json");
    assert_eq!(printed.code, 0, "{}", printed.err);
    let row = "| jstsph, bonds | 273 |";
    assert!(printed.out.contains(row) && markdown.contains(row));

    let short = place
        .text("r/reproduction.json")
        .replace("\"fig-16-inner\"", "\"fig-17\"");
    place.write("short.json", &short);
    let stale = place.jstsph("jstsph reproduce greto2019 --from @/short.json");
    assert_eq!(stale.code, 2);
    assert!(
        stale.err.contains("quantity `fig-16-inner` is missing"),
        "{}",
        stale.err
    );
}

#[test]
fn an_interrupted_study_goes_on_where_it_was() {
    let place = Place::new();
    let command = format!("{COMMAND} --only bar-bonds-1,block-bonds-1");
    let outcome = place.until("block-bonds-1", &command);
    assert_eq!(outcome.code, 130, "{}", outcome.err);
    assert!(
        outcome.err.contains("finished runs are kept"),
        "{}",
        outcome.err
    );
    assert!(!place.path("r/reproduction.json").exists());

    let again = place.jstsph(&command.replace(",block-bonds-1", ""));
    assert_eq!(again.code, 0, "{}", again.err);
    assert_eq!(
        again.err.matches("finished earlier").count(),
        1,
        "{}",
        again.err
    );
}

#[test]
fn names_are_checked() {
    let place = Place::new();
    let listed = place.jstsph("jstsph reproduce");
    assert_eq!(
        (listed.code, listed.out.starts_with("greto2019 ")),
        (0, true)
    );
    let wrong = place.jstsph("jstsph reproduce greto2018");
    assert_eq!(wrong.code, 2);
    assert!(
        wrong.err.contains("did you mean `greto2019`?"),
        "{}",
        wrong.err
    );
    let wrong = place.jstsph("jstsph reproduce greto2019 --only bar --out @/r");
    assert_eq!(wrong.code, 2);
    assert!(wrong.err.contains("unknown run `bar`"), "{}", wrong.err);
    assert!(!place.path("r").exists());
}
