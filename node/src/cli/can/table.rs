//! Formats columns of text.

/// Returns lines with aligned columns, two spaces between columns, and no trailing space.
pub(super) fn columns(rows: &[Vec<String>]) -> String {
    let count = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..count).map(width).collect();
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:width$}"));
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned()
    };
    rows.iter().map(line).collect::<Vec<_>>().join("\n")
}

/// Formats a number of 32 bits; `-` if there is none.
pub(super) fn word(number: Option<u32>) -> String {
    number.map_or_else(|| "-".to_owned(), |number| format!("{number:08X}h"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_begin_below_each_other() {
        let row = |cells: &[&str]| cells.iter().map(|cell| (*cell).to_owned()).collect();
        let table = columns(&[row(&["a", "bcd", "e"]), row(&["fgh", "", "i"]), row(&["j"])]);
        assert_eq!(table, "a    bcd  e\nfgh       i\nj");
        assert_eq!(columns(&[]), "");
        assert_eq!((word(None), word(Some(0x1F))), ("-".to_owned(), "0000001Fh".to_owned()));
    }
}
