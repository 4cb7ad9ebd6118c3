//! Parses values of EDS files that contain the node ID.
//!
//! Law      `$NODEID` alone, or a sum with it in either order
//! Refuses  any other text, and numbers above 64 bits
//! Source   CiA 306-1, "number notation"

use lineshaft_cia402::dictionary::{number::number, quoted};

/// Returns the number that is added to the node ID; `None` if the text does not contain `$NODEID`.
pub(super) fn plus_node_id(text: &str) -> Option<Result<u64, String>> {
    const NODE_ID: &str = "$NODEID";
    let text = text.trim();
    let upper = text.to_ascii_uppercase();
    let (before, after) = upper.split_once(NODE_ID)?;
    let (before, after) = (before.trim(), after.trim());
    let summand = match (before.is_empty(), after.is_empty()) {
        (true, true) => return Some(Ok(0)),
        (true, false) => after.strip_prefix('+'),
        (false, true) => before.strip_suffix('+'),
        (false, false) => None,
    };
    // The copy in upper case has `0X`, which is accepted like `0x`.
    let value = summand.and_then(|summand| number(summand).ok()).and_then(|number| u64::try_from(number.value).ok());
    Some(value.ok_or_else(|| format!("{} is neither $NODEID, $NODEID+number nor number+$NODEID", quoted(text))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn node_id_is_parsed_on_either_side_of_sum() {
        assert_eq!(plus_node_id("0x180"), None);
        let rows = [
            ("$NODEID", 0),
            ("$NODEID+0x180", 0x180),
            ("$nodeid + 512", 512),
            ("1280+$NODEID", 1280),
            (" 0x80000000 + $NodeID ", 0x8000_0000),
        ];
        for (text, offset) in rows {
            assert_eq!(plus_node_id(text), Some(Ok(offset)), "{text}");
        }
        for text in ["$NODEID+", "+$NODEID", "$NODEID*2", "$NODEID-1", "$NODEID+-1", "1+$NODEID+1", "$NODEID+$NODEID"] {
            assert!(plus_node_id(text).unwrap().unwrap_err().contains("neither $NODEID"), "{text}");
        }
    }

    proptest::proptest! {
        #[test]
        fn any_text_is_read_or_refused(text in ".{0,40}") {
            let _ = plus_node_id(&text);
        }
    }
}
