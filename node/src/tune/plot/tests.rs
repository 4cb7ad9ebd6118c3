//! The picture, by what stands in it.

use super::*;
use crate::tune::test_axes::{before, cascade, effort_record, subject, velocity_record, wish};

#[test]
fn a_file_is_written_by_its_ending() {
    let folder = tempfile::tempdir().unwrap();
    let record = velocity_record();
    let found = Findings::find(subject(), &record, &wish(), &before()).unwrap();
    for (name, begins) in [("a.svg", &b"<svg"[..]), ("a.PNG", &b"\x89PNG"[..])] {
        let path = folder.path().join(name);
        write_plot(&found, &record, &path).unwrap();
        assert!(std::fs::read(&path).unwrap().starts_with(begins), "{name}");
    }
    let refused = write_plot(&found, &record, &folder.path().join("a.pdf")).unwrap_err();
    assert!(matches!(refused, Problem::Ending { .. }));
    if let Ok(to) = std::env::var("LINESHAFT_TUNE_PLOT") {
        write_plot(&found, &record, &Path::new(&to).join("velocity.png")).unwrap();
        let (wish, loops) = cascade();
        let record = effort_record();
        let found = Findings::find(subject(), &record, &wish, &loops).unwrap();
        write_plot(&found, &record, &Path::new(&to).join("effort.png")).unwrap();
    }
}
