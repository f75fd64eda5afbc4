//! The page: template, style, program and data in one text.

use serde::Serialize;

use super::frames::{FrameIndex, PackedFrames};
use super::{Files, Report};
use crate::plot::{ColourMap, LinePlot, SeriesStyle};
use crate::{RunRecord, Summary};

const TEMPLATE: &str = include_str!("report.html");
const STYLE: &str = include_str!("report.css");
/// The program, one concept a file, in the order of definition.
const PROGRAM: [&str; 9] = [
    include_str!("quantity.js"),
    include_str!("data.js"),
    include_str!("chart.js"),
    include_str!("camera.js"),
    include_str!("scene.js"),
    include_str!("overlay.js"),
    include_str!("view.js"),
    include_str!("summary.js"),
    include_str!("main.js"),
];

/// Most points of a curve; of longer ones every second, third, ... is kept, and the page says so.
const MOST_POINTS: usize = 5_000;
/// Most characters of the log, from its end.
const MOST_LOG: usize = 200_000;

/// Everything but the frames.
#[derive(Serialize)]
struct Data<'a> {
    case: &'a str,
    heading: &'a str,
    version: &'a str,
    is_solid: bool,
    spacing: f64,
    energy_unit: &'a str,
    probe_units: std::collections::BTreeMap<&'a str, &'a str>,
    summary: Option<&'a Summary>,
    record: Option<&'a RunRecord>,
    frames: &'a FrameIndex,
    undeformed: Vec<Vec<[f64; 3]>>,
    obstacles: Vec<ObstacleData<'a>>,
    diagrams: Vec<Diagram<'a>>,
    colour_maps: Vec<(&'static str, &'static [[u8; 3]])>,
    case_text: &'a str,
    /// As its author wrote it; empty if it is not known.
    original_case: &'a str,
    log: &'a str,
}

#[derive(Serialize)]
struct ObstacleData<'a> {
    name: &'a str,
    walls: Vec<WallData>,
    /// Displacement at each frame of the report; empty if it rests.
    displacements: Vec<[f64; 3]>,
}

#[derive(Serialize)]
struct WallData {
    line: Vec<[f64; 3]>,
    is_hatched: bool,
}

#[derive(Serialize)]
struct Diagram<'a> {
    title: &'a str,
    x: Axis<'a>,
    y: Axis<'a>,
    /// Horizontal coordinates, shared by curves.
    abscissas: Vec<Vec<f64>>,
    series: Vec<Curve<'a>>,
    /// Every how many points of the curves are here.
    stride: usize,
}

#[derive(Serialize)]
struct Axis<'a> {
    label: &'a str,
    unit: &'a str,
}

#[derive(Serialize)]
struct Curve<'a> {
    label: &'a str,
    abscissa: usize,
    values: Vec<f64>,
    is_dashed: bool,
    has_markers: bool,
}

/// The whole file.
pub(super) fn page(
    report: &Report<'_>,
    packed: &PackedFrames,
    files: &Files,
) -> serde_json::Result<String> {
    let data = Data {
        // The copy of a case in a results folder has another name than the case.
        case: files
            .summary
            .as_ref()
            .map_or(report.case, |summary| &summary.case),
        heading: report.heading,
        version: env!("CARGO_PKG_VERSION"),
        is_solid: report.is_solid,
        spacing: report.spacing * sparsity(&packed.index),
        energy_unit: &report.energy_unit,
        probe_units: report
            .probe_units
            .iter()
            .map(|(name, unit)| (name.as_str(), unit.as_str()))
            .collect(),
        summary: files.summary.as_ref(),
        record: files.record.as_ref(),
        frames: &packed.index,
        undeformed: report.undeformed.iter().map(|line| points(line)).collect(),
        obstacles: obstacles(report, &packed.index),
        diagrams: report.diagrams.iter().map(diagram).collect(),
        colour_maps: ColourMap::ALL
            .iter()
            .map(|(name, map)| (*name, map.table().as_slice()))
            .collect(),
        case_text: &files.case,
        original_case: &files.original,
        log: tail(&files.log),
    };
    let mut pieces = format!(
        "<script type=\"application/json\" id=\"data\">{}</script>\n",
        embedded_json(&data)?
    );
    for (name, text) in &packed.pieces {
        pieces += &format!("<script type=\"text/plain\" id=\"{name}\">{text}</script>\n");
    }
    let program = PROGRAM.concat();
    // One pass over the template: nothing that is put in is looked at again.
    let mut text =
        String::with_capacity(TEMPLATE.len() + STYLE.len() + program.len() + pieces.len());
    let mut rest = TEMPLATE;
    while let Some((before, after)) = rest.split_once("{{") {
        let Some((name, after)) = after.split_once("}}") else {
            break;
        };
        text += before;
        match name {
            "title" => text += &escape_html(report.heading),
            "style" => text += STYLE,
            "data" => text += &pieces,
            "program" => text += &program,
            _ => {}
        }
        rest = after;
    }
    Ok(text + rest)
}

/// By how much the distance of particles is larger when some are left out; faces still join all.
fn sparsity(index: &FrameIndex) -> f64 {
    if index.has_faces || index.particles == 0 {
        return 1.0;
    }
    let ratio = index.total_particles as f64 / index.particles as f64;
    ratio.powf(1.0 / index.axes as f64)
}

/// JSON that cannot end the script element it stands in, nor begin a comment there.
fn embedded_json(data: &impl Serialize) -> serde_json::Result<String> {
    let text = serde_json::to_string(data)?;
    Ok(text.replace('<', "\\u003c"))
}

fn escape_html(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

fn points(line: &[jstsph_tensor::Vec3]) -> Vec<[f64; 3]> {
    line.iter().map(|x| [x.x, x.y, x.z]).collect()
}

fn obstacles<'a>(report: &'a Report<'_>, index: &FrameIndex) -> Vec<ObstacleData<'a>> {
    let obstacles = report.obstacles.iter();
    obstacles
        .map(|obstacle| ObstacleData {
            name: &obstacle.name,
            walls: obstacle
                .walls
                .iter()
                .map(|wall| WallData {
                    line: points(&wall.line),
                    is_hatched: wall.is_hatched,
                })
                .collect(),
            displacements: if obstacle.displacements.is_empty() {
                Vec::new()
            } else {
                let kept = index.kept.iter();
                let moved = kept.filter_map(|frame| obstacle.displacements.get(frame.number));
                moved.map(|u| [u.x, u.y, u.z]).collect()
            },
        })
        .collect()
}

fn diagram(plot: &LinePlot) -> Diagram<'_> {
    let longest = plot.series.iter().map(|series| series.points.len()).max();
    let stride = longest.unwrap_or(0).div_ceil(MOST_POINTS).max(1);
    let mut abscissas: Vec<Vec<f64>> = Vec::new();
    let mut curves = Vec::new();
    for series in &plot.series {
        let last = series.points.len().saturating_sub(1);
        let kept = series.points.iter().enumerate();
        let kept = kept.filter(|(i, _)| i % stride == 0 || *i == last);
        let (x, values): (Vec<f64>, Vec<f64>) = kept.map(|(_, point)| *point).unzip();
        let known = abscissas.iter().position(|other| *other == x);
        let abscissa = known.unwrap_or_else(|| {
            abscissas.push(x);
            abscissas.len() - 1
        });
        curves.push(Curve {
            label: &series.label,
            abscissa,
            values,
            is_dashed: series.style == SeriesStyle::Dashed,
            has_markers: matches!(
                series.style,
                SeriesStyle::Markers | SeriesStyle::LineWithMarkers
            ),
        });
    }
    Diagram {
        title: &plot.title,
        x: Axis {
            label: &plot.x.name,
            unit: &plot.x.unit,
        },
        y: Axis {
            label: &plot.y.name,
            unit: &plot.y.unit,
        },
        abscissas,
        series: curves,
        stride,
    }
}

/// The end of a long text, from the beginning of a line.
fn tail(text: &str) -> &str {
    if text.len() <= MOST_LOG {
        return text;
    }
    let mut from = text.len() - MOST_LOG;
    while !text.is_char_boundary(from) {
        from += 1;
    }
    let rest = &text[from..];
    rest.split_once('\n').map_or(rest, |(_, lines)| lines)
}
