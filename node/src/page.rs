//! Generated pages in docs.

use std::path::Path;

/// Compares a page with its generated content; with LINESHAFT_RENEW it writes the page instead. `filter` selects the
/// test that does so.
#[track_caller]
pub(crate) fn check(name: &str, filter: &str, made: impl FnOnce(&str) -> String) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs").join(name);
    let page = std::fs::read_to_string(&path).unwrap_or_default();
    let made = made(&page);
    if std::env::var_os("LINESHAFT_RENEW").is_some() {
        return std::fs::write(&path, &made).expect("a page that can be written");
    }
    let different = page.lines().zip(made.lines()).find(|(there, made)| there != made);
    let hint = format!("write it anew: LINESHAFT_RENEW=1 cargo test -p lineshaft --lib {filter}");
    assert_eq!(different, None, "{hint}");
    assert!(page == made, "{hint}");
}
