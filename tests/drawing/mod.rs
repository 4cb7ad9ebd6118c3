//! Draws figures of paths over the positions of an axis, from simulated runs.

mod run;
mod svg;

use crate::support::machine::share;
use run::Path;
use svg::Svg;

/// Fixtures of an axis of launch-configs/homing.yaml, in inc.
#[derive(Clone, Copy)]
pub(crate) struct Fixtures {
    pub axis: &'static str,
    /// Range in which the reference switch is actuated.
    pub home: Option<(i64, i64)>,
    /// Whether it has limit switches at -3000 and 3000.
    pub limits: bool,
    /// Position of an index pulse, and distance between two of them.
    pub index: (i64, i64),
}

#[derive(Clone, Copy)]
pub(crate) enum Scheme {
    Cia402,
    Macs,
}

impl Scheme {
    fn verb(self) -> &'static str {
        match self {
            Self::Cia402 => "cia402",
            Self::Macs => "macs",
        }
    }
}

/// One method, with one or several start positions.
#[derive(Clone)]
pub(crate) struct Panel {
    pub fixtures: Fixtures,
    pub scheme: Scheme,
    pub number: i8,
    pub starts: &'static [i64],
    /// Expected position of the zero; `None`: at the start.
    pub reference: Option<i64>,
}

impl Panel {
    fn title(&self) -> String {
        match self.scheme {
            Scheme::Cia402 => format!("method {}", self.number),
            Scheme::Macs => format!("HOME_TYPE {}", self.number),
        }
    }
}

/// A drawing of docs/images.
pub(crate) struct Figure {
    pub name: &'static str,
    pub panels: Vec<Panel>,
}

const COLUMNS: usize = 4;
const PANEL: f64 = 236.0;
/// Height of the path of one start position.
const LANE: f64 = 44.0;
const HEAD: f64 = 24.0;
const FOOT: f64 = 34.0;
const LEGEND: f64 = 30.0;
/// Positions at the borders of a panel.
const LAST: i64 = 3600;
/// Phases of homing, with their colours.
const PHASES: [(&str, &str); 4] = [
    ("search the switch", "#1f77b4"),
    ("leave it", "#e67700"),
    ("search the index", "#2b8a3e"),
    ("move to the zero", "#862e9c"),
];

impl Figure {
    /// The committed drawing must be the present result of the simulation.
    /// `LINESHAFT_RENEW=1 cargo test --workspace --test end_to_end homing_drawings` regenerates it.
    #[track_caller]
    pub(crate) fn is_in_docs(&self) {
        let _machine = share();
        let file = run::root().join(format!("docs/images/{}.svg", self.name));
        let made = self.draw();
        if std::env::var_os("LINESHAFT_RENEW").is_some() {
            std::fs::write(&file, &made).expect("docs can be written");
            return;
        }
        let there = std::fs::read_to_string(&file).unwrap_or_default();
        let different = there.lines().zip(made.lines()).find(|(there, made)| there != made);
        let hint = "regenerate it: LINESHAFT_RENEW=1 cargo test --workspace --test end_to_end homing_drawings";
        assert_eq!(different, None, "{}: {hint}", self.name);
        assert!(there == made, "{}: {hint}", self.name);
    }

    fn draw(&self) -> String {
        let lanes = self.panels.iter().map(|panel| panel.starts.len()).max().unwrap_or(0);
        let height = HEAD + lanes as f64 * LANE + FOOT;
        let rows = self.panels.len().div_ceil(COLUMNS);
        let mut svg = Svg::new(PANEL * COLUMNS as f64, LEGEND + height * rows as f64);
        legend(&mut svg);
        for (place, panel) in self.panels.iter().enumerate() {
            let (row, column) = (place / COLUMNS, place % COLUMNS);
            draw_panel(&mut svg, panel, column as f64 * PANEL, LEGEND + row as f64 * height, height);
        }
        svg.finish()
    }
}

fn legend(svg: &mut Svg) {
    let mut x = 14.0;
    for (name, colour) in PHASES {
        svg.line((x, 15.0), (x + 22.0, 15.0), colour, 2.5);
        svg.text((x + 28.0, 19.0), name, "start", "#333");
        x += 150.0;
    }
    svg.ring((x, 15.0));
    svg.text((x + 8.0, 19.0), "start", "start", "#333");
    svg.dot((x + 60.0, 15.0));
    svg.text((x + 68.0, 19.0), "zero", "start", "#333");
    svg.text((x + 120.0, 19.0), "time runs downwards", "start", "#666");
}

/// Returns the coordinate of a position in the panel that begins at `left`.
fn at(left: f64, place: i64) -> f64 {
    let share = (place.clamp(-LAST, LAST) + LAST) as f64 / (2 * LAST) as f64;
    left + 10.0 + share * (PANEL - 20.0)
}

fn draw_panel(svg: &mut Svg, panel: &Panel, left: f64, top: f64, height: f64) {
    svg.frame((left + 3.0, top + 3.0), (PANEL - 6.0, height - 6.0));
    svg.text((left + 12.0, top + 19.0), &panel.title(), "start", "#111");
    let floor = top + height - FOOT + 4.0;
    fixtures(svg, panel, left, floor);
    for (lane, start) in panel.starts.iter().enumerate() {
        let path = run::path(panel, *start);
        assert_eq!(path.zero, panel.reference.unwrap_or(*start), "{} from {start}", panel.title());
        draw_path(svg, &path, left, top + HEAD + lane as f64 * LANE + 4.0, floor);
    }
}

/// Draws the switches and the index below the paths.
fn fixtures(svg: &mut Svg, panel: &Panel, left: f64, floor: f64) {
    svg.line((at(left, -LAST), floor), (at(left, LAST), floor), "#888", 1.0);
    let Fixtures { home, limits, index: (first, every), .. } = panel.fixtures;
    let mut index = first - (first + LAST) / every * every;
    while index <= LAST {
        svg.line((at(left, index), floor), (at(left, index), floor - 5.0), PHASES[2].1, 1.0);
        index += every;
    }
    let mut bar = |from: i64, to: i64, colour: &str, name: &str| {
        let (from, to) = (at(left, from), at(left, to));
        svg.bar((from, floor + 3.0), (to - from, 6.0), colour);
        // A name stays within its panel.
        let room = 4.0 + 3.7 * name.len() as f64;
        let middle = ((from + to) / 2.0).clamp(left + room, left + PANEL - room);
        svg.text((middle, floor + 21.0), name, "middle", colour);
    };
    if let Some((from, to)) = home {
        bar(from, to, "#495057", "reference switch");
    }
    if limits {
        bar(-LAST, -3000, "#c92a2a", "-");
        bar(3000, LAST, "#c92a2a", "+");
    }
}

fn draw_path(svg: &mut Svg, path: &Path, left: f64, top: f64, floor: f64) {
    let last = path.legs.iter().flat_map(|(_, points)| points).map(|(cycle, _)| *cycle).max().unwrap_or(0).max(1);
    let point = |&(cycle, place): &(u64, i64)| (at(left, place), top + cycle as f64 / last as f64 * (LANE - 12.0));
    for (phase, points) in &path.legs {
        let points: Vec<_> = points.iter().map(point).collect();
        svg.path(
            &points,
            phase.checked_sub(1).and_then(|place| PHASES.get(place)).map_or("#bbb", |(_, colour)| colour),
        );
    }
    svg.ring((at(left, path.start), top));
    let x = at(left, path.zero);
    let y = path.legs.last().and_then(|(_, points)| points.last()).map_or(top, |last| point(last).1);
    svg.dashes((x, y), (x, floor));
    svg.dot((x, y));
}
