//! `jstsph plot`, and the pictures at the end of a run.

mod common;

use common::Place;

/// Runs the block, whose 35 particles meet a wall.
fn run(options: &str) -> (Place, common::Outcome) {
    let place = Place::new();
    let outcome = place.jstsph(&format!("jstsph run @/block.toml --out @/r {options}"));
    (place, outcome)
}

/// Width and height of a PNG file.
fn png_size(bytes: &[u8]) -> (u32, u32) {
    assert!(bytes.starts_with(b"\x89PNG\r\n\x1a\n"), "no PNG file");
    let number = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().expect("4 bytes"));
    (number(16), number(20))
}

fn assert_is_picture(place: &Place, name: &str) {
    let (width, height) = png_size(&place.bytes(name));
    // Two pixels per CSS pixel: about as wide as a column of a paper, not a thumbnail, no poster.
    assert!(
        (500..2600).contains(&width) && (400..2600).contains(&height),
        "{name}: {width} x {height}"
    );
}

#[test]
fn a_run_ends_with_pictures_unless_they_are_not_wanted() {
    let (place, outcome) = run("");
    assert_eq!(outcome.code, 0, "{}", outcome.err);
    for name in ["final.png", "energies.png"] {
        assert_is_picture(&place, &format!("r/{name}"));
        assert!(outcome.out.contains(name), "{}", outcome.out);
    }
    assert!(
        outcome.out.contains("next: jstsph report "),
        "{}",
        outcome.out
    );

    let (place, outcome) = run("--no-pictures");
    assert_eq!(outcome.code, 0, "{}", outcome.err);
    assert!(!place.path("r/final.png").exists());
    assert!(!outcome.out.contains("final.png"), "{}", outcome.out);
}

#[test]
fn a_failed_run_shows_its_last_good_state() {
    let (place, outcome) = run("--set time.cfl=4 --quiet");
    assert_eq!(outcome.code, 1, "{}", outcome.err);
    assert_is_picture(&place, "r/final.png");
    assert_is_picture(&place, "r/energies.png");
}

#[test]
fn pictures_are_drawn_into_the_results_folder_by_default() {
    let (place, _) = run("--quiet --no-pictures");
    for (options, name) in [
        ("", "equivalent_plastic_strain-20us.png"),
        ("--field velocity_y --time first", "velocity_y-0s.png"),
        (
            "--field pressure --time first,1e-5 --time last --range=-1e9,1e9",
            "pressure-0s-10us-20us.png",
        ),
        (
            "--view oblique --time 10us",
            "equivalent_plastic_strain-10us.png",
        ),
        ("--history energies", "energies.png"),
        ("--history balance", "balance.png"),
        ("--history time_step", "time_step.png"),
        ("--history probes", "probes.png"),
        ("--history length,force_wall_y", "length-force_wall_y.png"),
    ] {
        let plot = place.jstsph(&format!("jstsph plot @/r {options}"));
        assert_eq!(plot.code, 0, "{options}: {}", plot.err);
        assert!(
            plot.out.starts_with("wrote ") && plot.out.contains(name),
            "{}",
            plot.out
        );
        assert_is_picture(&place, &format!("r/{name}"));
    }
}

#[test]
fn an_svg_picture_says_what_it_shows() {
    let (place, _) = run("--quiet --no-pictures");
    let plot =
        place.jstsph("jstsph plot @/r --field von_mises_stress --time first,last -o @/f.svg");
    assert_eq!(plot.code, 0, "{}", plot.err);
    let svg = place.text("f.svg");
    for text in [
        ">a block against a wall<",
        ">t = 0 s<",
        ">t = 20 µs<",
        ">von Mises stress (MPa)<",
        ">x (mm)<",
        // The undeformed block beside the deformed one.
        "stroke-dasharray",
    ] {
        assert!(svg.contains(text), "{text}");
    }
    place.jstsph("jstsph plot @/r --history length,force_wall_y -o @/h.svg");
    let svg = place.text("h.svg");
    for text in [">time (µs)<", ">length (mm)<", ">force wall y ("] {
        assert!(svg.contains(text), "{text}");
    }
}

#[test]
fn a_solid_is_cut_through_its_axis() {
    let place = Place::new();
    place.write(
        "bar.toml",
        r#"
title = "a short bar"
dimension = "3d"
[time]
end = "1 us"
[[body]]
name = "bar"
shape = { cylinder = { base = [0, 0, 0], axis = "z", radius = "3 mm", height = "6 mm" } }
lattice = { per_radius = 2, layers = 5 }
material = "copper_taylor"
velocity = [0, 0, "-100 m/s"]
[[obstacle]]
name = "wall"
plane = { point = [0, 0, 0], normal = [0, 0, 1] }
"#,
    );
    let run = place.jstsph("jstsph run @/bar.toml --out @/r --quiet");
    assert_eq!(run.code, 0, "{}", run.err);
    assert_is_picture(&place, "r/final.png");
    for (options, texts) in [
        ("", [">x (mm)<", ">z (mm)<"]),
        ("--view yz --section", [">y (mm)<", ">z (mm)<"]),
        ("--view oblique --section", [">x<", " mm<"]),
    ] {
        let plot = place.jstsph(&format!("jstsph plot @/r -o @/f.svg {options}"));
        assert_eq!(plot.code, 0, "{}", plot.err);
        let svg = place.text("f.svg");
        for text in texts {
            assert!(svg.contains(text), "{options}: {text}");
        }
    }
}

#[test]
fn mistakes_are_told_with_what_is_allowed_and_draw_nothing() {
    let (place, _) = run("--quiet --no-pictures");
    let folder = place.folder.path().display().to_string();
    for (options, texts) in [
        (
            "@/r --field von_mises_strain",
            &[
                "error: unknown field `von_mises_strain`",
                "allowed: jacobian, determinant, von_mises_stress, pressure",
                "velocity_x",
                "cauchy_stress_xy",
                "did you mean `von_mises_stress`?",
            ][..],
        ),
        (
            "@/r --time 3ms",
            &["error: time `3ms`", "5 frames from 0.0000 s to 20.0000 us"],
        ),
        ("@/r --time 3mm", &["it is a length"]),
        (
            "@/r --history heat",
            &[
                "`heat`",
                "energies, balance, time_step, probes",
                "force_wall_y",
            ],
        ),
        (
            "@/r --field pressure --range 1mm,2mm",
            &["the range of `pressure` is given as a length", "unit is Pa"],
        ),
        ("@/r --range 2,1", &["must be smaller"]),
        ("@/r -o @/f.pdf", &["ends with .png or .svg"]),
        (
            "@/r --history energies --field pressure",
            &["cannot be used with"],
        ),
        ("@/r --view zx", &["oblique"]),
        ("@/nothing", &["is not a folder of results", "case.toml"]),
    ] {
        let plot = place.jstsph(&format!("jstsph plot {options}"));
        assert_eq!(plot.code, 2, "{options}: {}", plot.err);
        for text in texts {
            assert!(plot.err.contains(text), "`{text}` is not in:\n{}", plot.err);
        }
    }
    std::fs::remove_dir_all(place.path("r/frames")).expect("removed");
    let plot = place.jstsph("jstsph plot @/r");
    assert_eq!(plot.code, 2);
    assert!(plot.err.contains("has no frames"), "{}", plot.err);
    let left = std::fs::read_dir(folder).expect("a folder").count();
    assert_eq!(left, 2, "the case and the results");
}

#[test]
fn runs_are_compared_side_by_side_and_in_one_diagram() {
    let (place, _) = run("--quiet --no-pictures");
    let outcome =
        place.jstsph("jstsph run @/block.toml --out @/s --set time.cfl=0.3 --quiet --no-pictures");
    assert_eq!(outcome.code, 0, "{}", outcome.err);
    let outcome = place.jstsph("jstsph plot @/r @/s --time first,last -o @/both.svg");
    assert_eq!(outcome.code, 0, "{}", outcome.err);
    let svg = place.text("both.svg");
    for title in ["r, t = 0 s", "r, t = 20 µs", "s, t = 0 s", "s, t = 20 µs"] {
        assert!(svg.contains(title), "{title}");
    }
    let outcome = place.jstsph("jstsph plot @/r @/s --history length,dt -o @/length.svg");
    assert_eq!(outcome.code, 0, "{}", outcome.err);
    let svg = place.text("length.svg");
    for label in [">r<", ">s<", ">length (mm)<", ">dt (ns)<"] {
        assert!(svg.contains(label), "{label}");
    }
    let plot = "jstsph plot @/r @/s --label coarse --label fine --title Energies -o @/e.svg \
                --history kinetic_energy,rate(plastic_energy) --over length --log y";
    let outcome = place.jstsph(plot);
    assert_eq!(outcome.code, 0, "{}", outcome.err);
    let svg = place.text("e.svg");
    for label in [
        ">Energies<",
        ">coarse<",
        ">length (mm)<",
        ">rate of plastic energy (W",
    ] {
        assert!(svg.contains(label), "{label} in {svg}");
    }
    let outcome = place.jstsph("jstsph plot @/r @/s --history length --against steps -o @/n.svg");
    assert_eq!(outcome.code, 0, "{}", outcome.err);
    assert!(place.text("n.svg").contains(">steps<"));
    for (dpi, name) in [(96, "small.png"), (192, "usual.png")] {
        let outcome = place.jstsph(&format!("jstsph plot @/r --dpi {dpi} -o @/{name}"));
        assert_eq!(outcome.code, 0, "{}", outcome.err);
    }
    let [small, usual] = ["small.png", "usual.png"].map(|name| png_size(&place.bytes(name)));
    assert_eq!((2 * small.0, 2 * small.1), usual);
    let outcome = place.jstsph("jstsph plot @/r @/s --label one");
    assert_eq!(outcome.code, 2);
    assert!(
        outcome.err.contains("1 of --label for 2 folders"),
        "{}",
        outcome.err
    );
    let outcome = place.jstsph("jstsph plot @/r @/s --animate @/a.gif");
    assert_eq!(outcome.code, 2);
    assert!(
        outcome.err.contains("2 folders are given"),
        "{}",
        outcome.err
    );
}

#[test]
fn animations_hold_every_frame() {
    let (place, _) = run("--quiet --no-pictures");
    let frames = std::fs::read_dir(place.path("r/frames")).expect("frames");
    let frames = frames
        .filter(|entry| {
            let path = entry.as_ref().expect("readable").path();
            path.extension().is_some_and(|extension| extension == "vtu")
        })
        .count();
    let outcome = place.jstsph("jstsph plot @/r --animate @/a.gif --field velocity_y --view xy");
    assert_eq!(outcome.code, 0, "{}", outcome.err);
    let gif = place.bytes("a.gif");
    assert!(gif.starts_with(b"GIF89a"));
    // Each picture has a graphic control extension of four bytes.
    let pictures = gif
        .windows(3)
        .filter(|bytes| *bytes == [0x21, 0xf9, 4])
        .count();
    assert_eq!(pictures, frames);
    let outcome = place.jstsph("jstsph plot @/r --animate @/a.png");
    assert_eq!(outcome.code, 0, "{}", outcome.err);
    let png = place.bytes("a.png");
    let at = png
        .windows(4)
        .position(|bytes| bytes == b"acTL")
        .expect("animated");
    let number = png[at + 4..at + 8].try_into().expect("4 bytes");
    assert_eq!(u32::from_be_bytes(number) as usize, frames);
    let outcome = place.jstsph("jstsph plot @/r --animate @/a.mp4");
    assert_eq!(outcome.code, 2);
    assert!(
        outcome.err.contains(".gif, .png or .apng"),
        "{}",
        outcome.err
    );
}
