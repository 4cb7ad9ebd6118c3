//! Converts tables of form y to form xy, and back.
//!
//! Law      form y: point i of N is at i L / (N - 1) of the period L of the master; the points do not change
//! Refuses  positions that are no integer increments, positions at unequal distances, words

use lineshaft_core::table::{CamSetting, Form, Table, TableError};

/// Reason why a table cannot be converted.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) enum FormError {
    #[error("words of a data block have no places; a table of form words stays one")]
    Words,
    #[error("one point has no distance to another; 2 are needed")]
    Few,
    #[error("{points} points divide a period of {master} inc into parts of {master}/{} inc; places are whole increments", points - 1)]
    Parts { points: usize, master: i64 },
    #[error("the first place is {0}; form y begins at 0")]
    First(i64),
    #[error(
        "place {place} of point {point} is {distance} inc after the one before it, the first ones {first} inc; form y has equal distances"
    )]
    Uneven {
        /// Number of the point, from 1, like line numbers.
        point: usize,
        place: i64,
        distance: i64,
        first: i64,
    },
    #[error("{0}")]
    Table(#[from] TableError),
}

/// Returns the points with a position each, over a period of the master.
pub(crate) fn with_places(table: &Table, master: i64) -> Result<Table, FormError> {
    match table.form() {
        Form::Xy => return Ok(table.clone()),
        Form::Words => return Err(FormError::Words),
        Form::Y => {}
    }
    let spans = i64::try_from(table.len() - 1).ok().filter(|spans| *spans > 0).ok_or(FormError::Few)?;
    if master < spans || master % spans != 0 {
        return Err(FormError::Parts { points: table.len(), master });
    }
    let places: Vec<i64> = (0..=spans).map(|i| i * (master / spans)).collect();
    // For form xy the positions define the length.
    Ok(Table::new(Form::Xy, &places, table.y())?.with_cam(CamSetting { length: None, ..table.cam_setting() }))
}

/// Returns the points without their positions, which must be at equal distances.
pub(crate) fn without_places(table: &Table) -> Result<Table, FormError> {
    match table.form() {
        Form::Y => return Ok(table.clone()),
        Form::Words => return Err(FormError::Words),
        Form::Xy => {}
    }
    let (&first, &second) = table.x().first().zip(table.x().get(1)).ok_or(FormError::Few)?;
    if first != 0 {
        return Err(FormError::First(first));
    }
    for (point, pair) in (2..).zip(table.x().windows(2)) {
        if let [before, place] = *pair
            && place - before != second
        {
            return Err(FormError::Uneven { point, place, distance: place - before, first: second });
        }
    }
    let length = table.x().last().copied();
    Ok(Table::new(Form::Y, &[], table.y())?.with_cam(CamSetting { length, ..table.cam_setting() }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn even(y: &[i64]) -> Table {
        Table::new(Form::Y, &[], y).expect("points")
    }

    fn uneven(x: &[i64]) -> Table {
        Table::new(Form::Xy, x, &vec![0; x.len()]).expect("points")
    }

    #[test]
    fn places_that_are_no_whole_increments_are_refused() {
        let said = |table: &Table, master| with_places(table, master).expect_err("refused").to_string();
        let parts = "4 points divide a period of 20000 inc into parts of 20000/3 inc; places are whole increments";
        assert_eq!(said(&even(&[0, 1, 2, 3]), 20_000), parts);
        assert!(said(&even(&[0, 1, 2, 3]), 2).contains("parts of 2/3 inc"));
        assert_eq!(said(&even(&[0]), 20), "one point has no distance to another; 2 are needed");
        let words = Table::new(Form::Words, &[], &[0, 1]).expect("words");
        assert_eq!(with_places(&words, 1), Err(FormError::Words));
        assert_eq!(without_places(&words), Err(FormError::Words));
    }

    #[test]
    fn places_at_unequal_distances_are_refused_by_their_point() {
        let said = |x: &[i64]| without_places(&uneven(x)).expect_err("refused").to_string();
        assert_eq!(
            said(&[0, 10, 20, 31]),
            "place 31 of point 4 is 11 inc after the one before it, the first ones 10 inc; form y has equal distances"
        );
        assert_eq!(said(&[5, 10, 15]), "the first place is 5; form y begins at 0");
        assert_eq!(said(&[0]), "one point has no distance to another; 2 are needed");
    }

    proptest! {
        #[test]
        fn a_form_and_back_is_the_same_table(y in proptest::collection::vec(any::<i32>(), 2..30), part in 1_i64..100) {
            let table = even(&y.into_iter().map(i64::from).collect::<Vec<_>>());
            let master = part * (table.len() as i64 - 1);
            let placed = with_places(&table, master).expect("whole places");
            prop_assert_eq!(placed.x().last(), Some(&master));
            let long = CamSetting { length: Some(master), ..CamSetting::default() };
            prop_assert_eq!(without_places(&placed), Ok(table.with_cam(long)));
        }
    }
}
