//! `jstsph report`.

mod common;

use common::{BLOCK, Place};

/// Runs the block, whose 35 particles meet a wall, under another title, and writes its report.
fn report(title: &str, options: &str) -> (Place, String) {
    let place = Place::new();
    let quoted = format!(
        "title = {}",
        serde_json::to_string(title).expect("a string")
    );
    place.write(
        "block.toml",
        &BLOCK.replace("title = \"a block against a wall\"", &quoted),
    );
    let run = place.jstsph("jstsph run @/block.toml --out @/r --quiet --no-pictures");
    assert_eq!(run.code, 0, "{}", run.err);
    let outcome = place.jstsph(&format!("jstsph report @/r {options}"));
    assert_eq!(outcome.code, 0, "{}", outcome.err);
    assert!(outcome.out.starts_with("wrote "), "{}", outcome.out);
    assert!(outcome.out.contains("5 frames"), "{}", outcome.out);
    let name = if options.is_empty() {
        "r/report.html"
    } else {
        "other.html"
    };
    let text = place.text(name);
    (place, text)
}

/// Content of a script element that holds data.
fn piece<'a>(text: &'a str, id: &str) -> &'a str {
    let (_, rest) = text
        .split_once(&format!("id=\"{id}\">"))
        .unwrap_or_else(|| panic!("no {id}"));
    rest.split_once("</script>").expect("an end").0
}

#[test]
fn a_report_holds_the_numbers_of_the_run_in_one_file() {
    let (place, text) = report("a block against a wall", "");
    assert!(text.len() < 2_000_000, "{} bytes", text.len());
    let data: serde_json::Value = serde_json::from_str(piece(&text, "data")).expect("JSON");
    assert_eq!(data["heading"], "a block against a wall");
    assert_eq!(data["case"], "block");
    let summary: serde_json::Value =
        serde_json::from_str(&place.text("r/summary.json")).expect("JSON");
    assert_eq!(data["summary"], summary);
    assert_eq!(data["case_text"], place.text("r/case.toml"));
    assert_eq!(data["original_case"], place.text("block.toml"));
    assert_eq!(data["log"], place.text("r/run.log"));
    assert_eq!(data["obstacles"][0]["name"], "wall");
    let frames = &data["frames"];
    assert_eq!(
        (&frames["particles"], &frames["axes"]),
        (&35.into(), &2.into())
    );
    let kept = frames["kept"].as_array().expect("frames");
    assert_eq!(kept.len(), 5);
    for number in 0..kept.len() {
        assert!(piece(&text, &format!("frame-{number}")).len() > 100);
    }
    let fields = frames["fields"].as_array().expect("fields");
    let units: Vec<_> = fields
        .iter()
        .map(|f| (f["name"].as_str(), f["unit"].as_str()))
        .collect();
    for field in [
        ("equivalent_plastic_strain", ""),
        ("cauchy_stress_xy", "Pa"),
        ("velocity", "m/s"),
    ] {
        assert!(units.contains(&(Some(field.0), Some(field.1))), "{field:?}");
    }

    // The curves are those of the table.
    let history = place.text("r/history.csv");
    let rows = history.lines().count() - 1;
    let diagrams = data["diagrams"].as_array().expect("diagrams");
    let titles: Vec<_> = diagrams
        .iter()
        .filter_map(|d| d["title"].as_str())
        .collect();
    for title in [
        "Energies",
        "Energy balance",
        "Time step",
        "Probes: length",
        "Reactions",
    ] {
        assert!(titles.contains(&title), "{titles:?}");
    }
    let energies = &diagrams[0];
    assert_eq!(
        energies["abscissas"][0].as_array().map(Vec::len),
        Some(rows)
    );
    let last = energies["series"][0]["values"]
        .as_array()
        .and_then(|v| v.last());
    assert_eq!(last, Some(&summary["energies"]["kinetic"]));
}

#[test]
fn a_report_refers_to_nothing_outside_of_it() {
    let (_place, text) = report("t", "-o @/other.html");
    for reference in [
        "://",
        "@import",
        "url(",
        "fetch(",
        "XMLHttpRequest",
        "import(",
    ] {
        assert!(!text.contains(reference), "{reference}");
    }
    for (before, _) in text
        .match_indices("href=\"")
        .chain(text.match_indices("src=\""))
    {
        let target = &text[before..text.len().min(before + 12)];
        assert!(
            target.contains("\"#") || target.contains("\"data:,"),
            "{target}"
        );
    }
    assert!(text.contains("default-src 'none'"));
}

#[test]
fn a_title_cannot_become_a_part_of_the_page() {
    let title = "</title><img onerror=x></script><script>alert(1)</script><!-- & \" {{data}}";
    let (_place, text) = report(title, "");
    for hostile in ["<img", "<script>alert", "</script><script>a", "<!-- &"] {
        assert!(!text.contains(hostile), "{hostile}");
    }
    let data: serde_json::Value = serde_json::from_str(piece(&text, "data")).expect("JSON");
    assert_eq!(data["heading"], title);
    assert_eq!(text.matches("id=\"data\"").count(), 1);
}

#[test]
fn folders_without_usable_results_are_refused_with_the_reason() {
    let (place, _) = report("t", "");
    let refused = |folder: &str, reason: &str| {
        let outcome = place.jstsph(&format!("jstsph report @/{folder}"));
        assert_eq!(outcome.code, 2, "{}", outcome.out);
        assert!(outcome.err.contains(reason), "{}", outcome.err);
    };
    std::fs::create_dir(place.path("empty")).expect("a folder");
    refused("empty", "is not a folder of results: it has no case.toml");
    refused("nowhere", "is not a folder of results");

    let old = place.bytes("r/report.html");
    let frame = place.bytes("r/frames/frame_000002.vtu");
    std::fs::write(
        place.path("r/frames/frame_000002.vtu"),
        &frame[..frame.len() / 2],
    )
    .expect("written");
    refused("r", "frame_000002.vtu");
    std::fs::write(place.path("r/frames/frame_000002.vtu"), &frame).expect("written");
    let summary = place.text("r/summary.json");
    place.write("r/summary.json", "{");
    refused("r", "summary.json");
    assert_eq!(
        place.bytes("r/report.html"),
        old,
        "a failure leaves the old report"
    );

    // A run that was killed has no summary; its report says so.
    std::fs::remove_file(place.path("r/summary.json")).expect("removed");
    let killed = place.jstsph("jstsph report @/r");
    assert_eq!(killed.code, 0, "{}", killed.err);
    place.write("r/summary.json", &summary);
    std::fs::remove_file(place.path("r/frames/frames.pvd")).expect("removed");
    refused("r", "has no frames");
}

#[test]
fn a_run_names_the_report_as_the_next_step() {
    let place = Place::new();
    let run = place.jstsph("jstsph run @/block.toml --out @/r --no-pictures");
    let next = format!("next: jstsph report {}", place.path("r").display());
    assert!(run.out.contains(&next), "{}", run.out);
}
