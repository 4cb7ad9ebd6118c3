//! Descriptions of tables: segments of the master, each with a travel of the slave and a motion law.
//!
//! Law      point i of N is the plan at i L / (N - 1), for form xy at the nearest integer increment, rounded to the
//!          nearest increment; the first point is 0, the last one the end of the plan
//! Reads    a document: form, points, cyclic, master, segments
//! Refuses  a last segment that does not end with the period, invalid plans, points with steps of 2^15 or more

use super::csv::Refused;
use crate::document::{Document, Map, Place, Value};
use lineshaft_core::law::{Law, Plan, PlanError, Segment};
use lineshaft_core::table::{CurveError, Form, MAX_NUMBERS, Table};

/// Maximum step between two points of a cam, in inc.
const LONGEST_STEP: f64 = 32_767.0;
/// Maximum of positions and travels of a description, in inc.
const WIDEST: i64 = i32::MAX as i64;
const FORMS: [(&str, Form); 2] = [("y", Form::Y), ("xy", Form::Xy)];

/// Description of a table.
#[derive(Clone, Debug)]
pub(crate) struct Description {
    pub(crate) form: Form,
    pub(crate) points: usize,
    /// Period of the master, in increments.
    pub(crate) master: i64,
    pub(crate) segments: Vec<Segment>,
    pub(crate) plan: Plan,
    /// Location for problems with the number of points.
    place: Place,
}

impl Description {
    /// Reads the description in a document; problems are added to the document.
    pub(crate) fn read(document: &Document) -> Option<Self> {
        let root = document.root("the description")?;
        let mut map = root.map("the description")?;
        if ["lineshaft", "axes", "scenario"].iter().any(|key| map.has(key)) && !map.has("segments") {
            let hint =
                "such a file has `points`, `master` and `segments`; `lineshaft new cam FILE` writes one".to_owned();
            map.refuse("this is no description of a table", Some(hint));
            return None;
        }
        let form = map.optional("form").map_or(Some(Form::Y), |form| form.choice(&FORMS));
        let given = map.required("points");
        let points = given.as_ref().and_then(|points| points.integer(2..=MAX_NUMBERS));
        let is_cyclic = map.optional("cyclic").map_or(Some(true), |cyclic| cyclic.boolean());
        let period = map.required("master");
        let master = period.as_ref().and_then(|master| master.integer(1..=WIDEST));
        let list = map.required("segments");
        map.finish();
        let (list, places) = (list?, given?.place());
        let items = list.list()?;
        let segments: Vec<_> = items.iter().map(segment).collect();
        let segments = segments.into_iter().collect::<Option<Vec<_>>>()?;
        let (form, points, is_cyclic, master) = (form?, points?, is_cyclic?, master?);
        let plan = match Plan::new(&segments, is_cyclic) {
            Ok(plan) => plan,
            Err(error) => {
                offending_value(&items, &error).unwrap_or(list).refuse(error.to_string(), None);
                return None;
            }
        };
        if plan.length() != master as f64 {
            let sentence =
                format!("the last segment ends at {}; {master}, the period of the master, is needed", plan.length());
            items.last().and_then(|last| member(last, "to")).unwrap_or(list).refuse(sentence, None);
            return None;
        }
        if plan.end().abs() > WIDEST as f64 {
            let sentence = format!("the ways of all segments are {} together; 32 bits are possible", plan.end());
            list.refuse(sentence, None);
            return None;
        }
        Some(Self { form, points, master, segments, plan, place: places })
    }

    /// Returns the start and the end of each segment.
    pub(crate) fn spans(&self) -> impl Iterator<Item = (f64, f64)> {
        let starts = std::iter::once(0.0).chain(self.segments.iter().map(|segment| segment.to));
        starts.zip(self.segments.iter().map(|segment| segment.to))
    }

    /// Returns the table with the points.
    pub(crate) fn table(&self) -> Result<Table, Refused> {
        let refused = |sentence| Refused { place: Some(self.place), sentence };
        let spans = self.points as i64 - 1;
        if self.form == Form::Xy && spans > self.master {
            let most = self.master + 1;
            return Err(refused(format!(
                "points is {}; {most} is the most for form xy, one at each increment",
                self.points
            )));
        }
        // Below 2^31 times 10^6: exact.
        let at = |i: i64| (i * self.master) as f64 / spans as f64;
        let places: Vec<f64> = match self.form {
            Form::Xy => (0..=spans).map(|i| at(i).round()).collect(),
            _ => (0..=spans).map(at).collect(),
        };
        let y: Vec<i64> = places.iter().map(|x| self.plan.at(*x).s.round() as i64).collect();
        let x: Vec<i64> = places.iter().filter(|_| self.form == Form::Xy).map(|x| *x as i64).collect();
        let table = Table::new(self.form, &x, &y).map_err(|error| refused(error.to_string()))?;
        match table.shape() {
            Ok(_) => Ok(table),
            Err(CurveError::Step(_)) => Err(refused(self.too_steep())),
            Err(_) => Err(refused("the points are no curve".to_owned())),
        }
    }

    /// Returns the error for too few points for the velocity.
    fn too_steep(&self) -> String {
        // Each end of a step, and for form xy its position, may be rounded by half an increment.
        let v = self.plan.peaks().v.value;
        let room = LONGEST_STEP - 1.0 - if self.form == Form::Xy { v } else { 0.0 };
        let needed = if room > 0.0 { (self.master as f64 * v / room).ceil() + 1.0 } else { f64::INFINITY };
        let most = if self.form == Form::Xy { MAX_NUMBERS.min(self.master as usize + 1) } else { MAX_NUMBERS };
        let steps = format!("points is {}; with so few the steps between them are 32768 inc and more", self.points);
        if needed > most as f64 {
            return format!(
                "{steps}, and no number of points would do: the velocity is {v:.6} inc per inc of the master"
            );
        }
        format!("{steps}; {needed} would do")
    }

    /// Returns the comments at the start of a file with the points.
    pub(crate) fn comments(&self) -> Vec<String> {
        let form = self.form.name();
        let round = if self.plan.is_cyclic() { "cyclic" } else { "once" };
        let head = format!(
            "form {form}, {} points, {round}; period {} inc of the master, way {} inc",
            self.points,
            self.master,
            self.plan.end()
        );
        let tell = |segment: &Segment| format!("to {}: travel {}, {}", segment.to, segment.travel, segment.law.name());
        std::iter::once(head).chain(self.segments.iter().map(tell)).collect()
    }
}

fn segment(item: &Value<'_>) -> Option<Segment> {
    let mut map = item.map(item.label())?;
    let whole = |map: &mut Map<'_>, key: &str, least: i64| {
        let value = map.required(key);
        value.and_then(|value| value.integer(least..=WIDEST)).map(|value| value as f64)
    };
    let (to, travel) = (whole(&mut map, "to", 1), whole(&mut map, "travel", -WIDEST));
    let law = map.required("law").and_then(|law| law.choice(&Law::ALL.map(|(law, name)| (name, law))));
    map.finish();
    Some(Segment { to: to?, travel: travel?, law: law? })
}

/// Returns the value that makes a plan invalid.
fn offending_value<'d>(items: &[Value<'d>], error: &PlanError) -> Option<Value<'d>> {
    let (segment, key) = match *error {
        PlanError::Empty => return None,
        PlanError::NotFinite { segment, name, .. } => (segment, name),
        PlanError::Order { segment, .. } => (segment, "to"),
        PlanError::DwellTravel { segment, .. }
        | PlanError::NoTravel { segment, .. }
        | PlanError::Size { segment, .. } => (segment, "travel"),
        PlanError::VelocityJump { segment, .. } => (segment, "law"),
    };
    items.get(segment.checked_sub(1)?).and_then(|item| member(item, key))
}

/// Returns a value of a mapping that has been read.
fn member<'d>(item: &Value<'d>, key: &str) -> Option<Value<'d>> {
    item.entries()?.into_iter().find(|(name, _)| name.peek() == Some(key)).map(|(_, value)| value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const KNIFE: &str = "points: 5\nmaster: 20000\nsegments:\n  - {to: 5000, travel: 0, law: dwell}\n  - {to: 12000, travel: 8000, law: \
                         modified_sine}\n  - {to: 20000, travel: -8000, law: polynomial_5}\n";

    fn read(text: &str) -> Result<Description, String> {
        let document = Document::parse("cam.yaml", text);
        let read = Description::read(&document);
        let problems = document.into_problems();
        assert_eq!(read.is_none(), !problems.is_empty(), "{problems}");
        read.ok_or_else(|| problems.to_string())
    }

    fn said(text: &str) -> String {
        read(text).expect_err("refused")
    }

    #[test]
    fn a_description_is_a_plan_and_its_points() {
        let knife = read(KNIFE).expect("good");
        assert_eq!((knife.form, knife.points, knife.master, knife.plan.is_cyclic()), (Form::Y, 5, 20_000, true));
        let table = knife.table().expect("points");
        // At 0, 5000: standstill. 10000: 5000 of 7000 into the rise. 15000: 3000 of 8000 into the fall, 1 - 10 z^3 + 15
        // z^4 - 6 z^5 = 0.72469 at z = 3/8.
        let z: f64 = 5.0 / 7.0;
        let k = 1.0 / (4.0 + std::f64::consts::PI);
        let phase = (4.0 * z + 1.0) * std::f64::consts::PI / 3.0;
        let rise = k * (2.0 + std::f64::consts::PI * z - 2.25 * phase.sin());
        assert_eq!(table.y(), [0, 0, (8000.0 * rise).round() as i64, 5798, 0]);
        let comments = knife.comments();
        assert_eq!(comments[0], "form y, 5 points, cyclic; period 20000 inc of the master, way 0 inc");
        assert_eq!(comments[2], "to 12000: travel 8000, modified_sine");
    }

    #[test]
    fn points_of_form_xy_stand_at_whole_places() {
        let text =
            "form: xy\npoints: 4\nmaster: 100\ncyclic: false\nsegments: [{to: 100, travel: 100, law: straight}]\n";
        let table = read(text).expect("good").table().expect("points");
        assert_eq!((table.x(), table.y()), (&[0, 33, 67, 100][..], &[0, 33, 67, 100][..]));
        let Refused { place, sentence } = read(&text.replace('4', "102")).expect("good").table().expect_err("too many");
        assert_eq!(place, Some(Place { line: 2, col: 9 }));
        assert_eq!(sentence, "points is 102; 101 is the most for form xy, one at each increment");
    }

    #[test]
    fn typos_and_ranges_are_told_with_their_place() {
        for (from, to, sentence) in [
            (
                "points: 5",
                "pionts: 5",
                "cam.yaml:1:1: unknown key `pionts` in the description, did you mean `points`?\n",
            ),
            ("points: 5", "points: 1", "cam.yaml:1:9: points is 1; 2..1000000 is allowed\n"),
            ("points: 5", "points: 1000001", "cam.yaml:1:9: points is 1000001; 2..1000000 is allowed\n"),
            ("points: 5", "form: words\npoints: 5", "cam.yaml:1:7: form is `words`; one of y, xy is allowed\n"),
            (
                "master: 20000",
                "master: 2e4.5",
                "cam.yaml:2:9: master is `2e4.5`; a whole number 1..2147483647 is allowed\n",
            ),
            (
                "master: 20000",
                "master: 19000",
                "cam.yaml:6:10: the last segment ends at 20000; 19000, the period of the master, is needed\n",
            ),
            (
                "law: dwell",
                "law: dwel",
                "cam.yaml:4:32: law is `dwel`; one of dwell, straight, simple_sine, modified_sine, modified_trapezoid, \
                 polynomial_5, polynomial_7 is allowed, did you mean `dwell`?\n",
            ),
            (
                "travel: 0, law: dwell",
                "travel: 7, law: dwell",
                "cam.yaml:4:24: segment 1: travel is 7; 0 is needed for law dwell\n",
            ),
            (
                "to: 12000",
                "to: 4000",
                "cam.yaml:5:10: segment 2: to is 4000; more than 5000, where the segment begins, is needed\n",
            ),
            ("travel: 8000, ", "", "cam.yaml:5:5: missing key `travel` in segments[1]\n"),
            ("to: 5000", "too: 5000", "cam.yaml:4:6: unknown key `too` in segments[0], did you mean `to`?\n"),
        ] {
            assert_eq!(said(&KNIFE.replacen(from, to, 1)), sentence);
        }
        let none = "points: 5\nmaster: 7\nsegments: []\n";
        assert_eq!(said(none), "cam.yaml:3:11: a plan has 0 segments; 1 at least is needed\n");
        let jump = said(&KNIFE.replacen("modified_sine", "straight", 1));
        assert!(jump.starts_with("cam.yaml:5:36: segment 2 (straight): it begins at 5000 with velocity"), "{jump}");
        let wide = KNIFE.replacen("-8000", "2147483647", 1);
        assert!(said(&wide).contains("the ways of all segments are 2147491647 together; 32 bits are possible"));
    }

    #[test]
    fn a_plan_that_is_too_steep_is_told_how_many_points_would_do() {
        let steep = |points: usize, form: &str| {
            let text = format!(
                "form: {form}\npoints: {points}\nmaster: 100000\nsegments:\n  - {{to: 50000, travel: 9000000, law: polynomial_5}}\n  \
                 - {{to: 100000, travel: -9000000, law: polynomial_5}}\n"
            );
            read(&text).expect("a plan").table()
        };
        // 1.875 * 9000000 / 50000 = 337.5 inc per inc, at most 32766 inc per step: 1030.03 steps, up to 1031.
        let sentence = "points is 900; with so few the steps between them are 32768 inc and more; 1032 would do";
        assert_eq!(
            steep(900, "y"),
            Err(Refused { place: Some(Place { line: 2, col: 9 }), sentence: sentence.to_owned() })
        );
        assert_eq!(steep(1032, "y").expect("enough").len(), 1032);
        // Rounding of the position by half an increment at either end requires 337.5 more: 1040.75.
        assert!(steep(900, "xy").expect_err("steep").sentence.ends_with("; 1042 would do"));
        assert_eq!(steep(1042, "xy").expect("enough").len(), 1042);
        let text = "points: 2\nmaster: 1\ncyclic: false\nsegments: [{to: 1, travel: 2147483647, law: straight}]\n";
        assert!(read(text).expect("a plan").table().expect_err("steep").sentence.contains("; 65542 would do"));
        let text = text.replace("points", "form: xy\npoints");
        let sentence = read(&text).expect("a plan").table().expect_err("steep").sentence;
        assert!(
            sentence
                .ends_with("no number of points would do: the velocity is 2147483647.000000 inc per inc of the master")
        );
    }

    proptest! {
        /// For any number of points, they begin at 0, end with the plan, and are within half an increment of it.
        #[test]
        fn points_are_the_plan_rounded(
            points in 2_usize..500,
            master in 1_000_i64..100_000,
            travel in -20_000_i64..20_000,
            law in 3_usize..7,
            xy in any::<bool>(),
        ) {
            prop_assume!(travel != 0);
            let (law, half) = (Law::ALL[law].1, master / 2);
            let form = if xy { "xy" } else { "y" };
            let text = format!(
                "form: {form}\npoints: {points}\nmaster: {master}\nsegments:\n  - {{to: {half}, travel: {travel}, law: {law}}}\n  \
                 - {{to: {master}, travel: 77, law: {law}}}\n"
            );
            let description = read(&text).expect("a plan");
            let table = description.table().expect("points");
            prop_assert_eq!((table.len(), table.y()[0], table.y()[points - 1]), (points, 0, travel + 77));
            for (i, y) in table.y().iter().enumerate() {
                let x = table.x().get(i).map_or(i as f64 * master as f64 / (points - 1) as f64, |x| *x as f64);
                prop_assert!((description.plan.at(x).s - *y as f64).abs() < 0.5 + 1e-6);
            }
        }
    }
}
