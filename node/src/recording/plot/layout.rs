//! Where the parts of a figure stand (px).

use super::{Figure, HEIGHTS, Problem, WIDTHS};

pub(super) const TITLE: f64 = 17.0;
pub(super) const LABEL: f64 = 12.0;
pub(super) const TICK: f64 = 11.0;
pub(super) const SMALL: f64 = 11.0;
/// Names of states in narrow places.
pub(super) const SMALLEST: f64 = 9.5;

/// Free on all sides.
pub(super) const MARGIN: f64 = 14.0;
const TITLE_HEIGHT: f64 = 30.0;
/// The tags of events, with the way to their marks.
pub(super) const TAGS_HEIGHT: f64 = 30.0;
const GAP: f64 = 16.0;
pub(super) const LANE_HEIGHT: f64 = 26.0;
const AXIS_HEIGHT: f64 = 46.0;
pub(super) const ROW_HEIGHT: f64 = 17.0;
pub(super) const NOTE_HEIGHT: f64 = 15.0;
pub(super) const LEGEND_HEIGHT: f64 = 17.0;
const LOWEST_PANEL: f64 = 64.0;
const HIGHEST_PANEL: f64 = 560.0;

/// What has to find its place.
#[derive(Clone, Debug, Default)]
pub(super) struct Parts {
    pub(super) has_title: bool,
    /// Entries of each panel's legend.
    pub(super) panels: Vec<usize>,
    pub(super) lanes: usize,
    /// Entries of the legend beside the lanes.
    pub(super) states: usize,
    /// Rows of the list of events.
    pub(super) rows: usize,
    pub(super) has_tags: bool,
    /// Lines of small text at the end.
    pub(super) notes: usize,
}

/// Where they are: upper and lower edges, from above.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Layout {
    pub(super) height: u32,
    /// Middle of the title.
    pub(super) title: f64,
    /// Upper edge of the tags.
    pub(super) tags: f64,
    pub(super) panels: Vec<(f64, f64)>,
    pub(super) lanes: (f64, f64),
    /// Lower edge of the last panel or lane.
    pub(super) axis: f64,
    /// Upper edge of the list of events.
    pub(super) list: f64,
    /// Upper edge of the small text.
    pub(super) notes: f64,
}

impl Parts {
    /// # Errors
    /// [`Problem::Width`], [`Problem::Height`], [`Problem::Low`], [`Problem::High`]
    pub(super) fn layout(&self, figure: &Figure<'_>) -> Result<Layout, Problem> {
        if !(WIDTHS.0..=WIDTHS.1).contains(&figure.width) {
            return Err(Problem::Width { given: figure.width });
        }
        let around = self.around();
        let height = match figure.height {
            Some(given) if !(HEIGHTS.0..=HEIGHTS.1).contains(&given) => return Err(Problem::Height { given }),
            Some(given) => self.shared(around, given)?,
            None => self.natural(),
        };
        let layout = self.place(&height);
        if layout.height > HEIGHTS.1 {
            return Err(Problem::High { panels: self.words(), needed: layout.height });
        }
        Ok(layout)
    }

    /// Heights of the panels where nobody gives the height of the figure.
    fn natural(&self) -> Vec<f64> {
        let usual = match self.panels.len() {
            0..=2 => 210.0,
            3..=4 => 170.0,
            _ => 140.0,
        };
        self.panels.iter().map(|&entries| (entries as f64 * LEGEND_HEIGHT + 8.0).clamp(usual, HIGHEST_PANEL)).collect()
    }

    /// The rest of a given height, in equal parts.
    fn shared(&self, around: f64, given: u32) -> Result<Vec<f64>, Problem> {
        let count = self.panels.len();
        let needed = (around + LOWEST_PANEL * count as f64).ceil() as u32;
        if given < needed {
            return Err(Problem::Low { panels: self.words(), needed, given });
        }
        Ok(vec![(f64::from(given) - around) / count.max(1) as f64; count])
    }

    /// Height of all but the panels.
    fn around(&self) -> f64 {
        f64::from(self.place(&vec![0.0; self.panels.len()]).height)
    }

    fn lanes_height(&self) -> f64 {
        if self.lanes == 0 {
            return 0.0;
        }
        (self.lanes as f64 * LANE_HEIGHT).max(self.states as f64 * LEGEND_HEIGHT + 4.0)
    }

    fn place(&self, heights: &[f64]) -> Layout {
        let mut layout = Layout::default();
        let mut y = MARGIN;
        if self.has_title {
            layout.title = y + 8.0;
            y += TITLE_HEIGHT;
        }
        layout.tags = y;
        if self.has_tags {
            y += TAGS_HEIGHT;
        }
        for height in heights {
            layout.panels.push((y, y + height));
            y += height + GAP;
        }
        if self.lanes > 0 {
            layout.lanes = (y, y + self.lanes_height());
            y += self.lanes_height() + GAP;
        }
        y -= GAP;
        layout.axis = y;
        y += AXIS_HEIGHT;
        layout.list = y;
        y += self.rows as f64 * ROW_HEIGHT + if self.rows > 0 { 6.0 } else { 0.0 };
        layout.notes = y;
        y += self.notes as f64 * NOTE_HEIGHT;
        layout.height = (y + MARGIN).ceil().max(0.0) as u32;
        layout
    }

    fn words(&self) -> String {
        let count = |count: usize, word: &str| format!("{count} {word}{}", if count == 1 { "" } else { "s" });
        format!("{} and {}", count(self.panels.len(), "panel"), count(self.lanes, "lane"))
    }
}

#[cfg(test)]
mod tests {
    use super::super::Across;
    use super::*;

    fn figure(width: u32, height: Option<u32>) -> Figure<'static> {
        let (from, to, across) = (None, None, Across::Time);
        Figure { title: String::new(), signals: Vec::new(), marks: &[], from, to, across, width, height }
    }

    fn parts() -> Parts {
        Parts { has_title: true, panels: vec![2, 1, 3], lanes: 2, rows: 4, has_tags: true, notes: 1, states: 0 }
    }

    #[test]
    fn parts_stand_below_one_another() {
        let layout = parts().layout(&figure(1200, None)).unwrap();
        let mut edges = vec![layout.title, layout.tags];
        edges.extend(layout.panels.iter().flat_map(|&(top, end)| [top, end]));
        edges.extend([layout.lanes.0, layout.lanes.1, layout.list, layout.notes, f64::from(layout.height)]);
        assert!(edges.windows(2).all(|pair| pair[0] < pair[1]), "{edges:?}");
        assert_eq!(layout.axis, layout.lanes.1);
    }

    #[test]
    fn a_given_height_is_met() {
        let layout = parts().layout(&figure(1200, Some(700))).unwrap();
        assert!(layout.height.abs_diff(700) <= 1, "{}", layout.height);
    }

    #[test]
    fn a_legend_makes_room_for_itself() {
        let layout = Parts { panels: vec![20], ..Parts::default() }.layout(&figure(1200, None)).unwrap();
        assert!(layout.panels[0].1 - layout.panels[0].0 >= 20.0 * LEGEND_HEIGHT);
    }

    #[test]
    fn sizes_that_hold_no_figure_are_refused_with_what_is_needed() {
        let problem = |height| parts().layout(&figure(1200, Some(height))).unwrap_err().to_string();
        assert_eq!(problem(300), "3 panels and 2 lanes need a height of 515 px or more, not 300 px");
        assert_eq!(problem(90), "height 90 px is outside 200 to 20000 px");
        let narrow = parts().layout(&figure(100, None)).unwrap_err();
        assert_eq!(narrow.to_string(), "width 100 px is outside 500 to 8000 px");
        let many = Parts { lanes: 1000, ..Parts::default() }.layout(&figure(1200, None)).unwrap_err();
        assert!(many.to_string().starts_with("0 panels and 1000 lanes would need a height of 26"), "{many}");
    }
}
