//! Checks the names of the surface after remapping: no two services, actions or topics may have the same name.

use super::table::{Kind, ROWS};
use crate::layer::Names;
use std::collections::HashMap;

/// Services of an action.
const PARTS: [&str; 3] = ["send_goal", "get_result", "cancel_goal"];

/// Checks that all endpoints have different names. If two services had the same name, both would execute each request.
///
/// # Errors
/// Two endpoints have the same name, or ROS does not allow a name.
pub fn check_names(names: &Names) -> Result<(), String> {
    let (mut topics, mut services) = (HashMap::new(), HashMap::new());
    for row in ROWS {
        let error = |error: crate::layer::NameError| error.to_string();
        let of_part = |part: &str| names.service(&format!("{}/_action/{part}", names.action(row.name)?));
        let (known, full) = match row.kind {
            Kind::Publisher | Kind::Subscription => (&mut topics, vec![names.topic(row.name).map_err(error)?]),
            Kind::Service => (&mut services, vec![names.service(row.name).map_err(error)?]),
            Kind::Action => (&mut services, PARTS.into_iter().map(of_part).collect::<Result<_, _>>().map_err(error)?),
        };
        for full in full {
            if let Some(other) = known.insert(full.to_string(), row.name) {
                return Err(format!(
                    "-r: {other} and {} are both called {full}; each needs a name of its own",
                    row.name
                ));
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layer::{NodeName, RosArguments};

    fn check(rules: &[&str]) -> Result<(), String> {
        let words = rules.iter().flat_map(|rule| ["-r".to_owned(), (*rule).to_owned()]);
        let (arguments, _) = RosArguments::take(std::iter::once("--ros-args".to_owned()).chain(words)).unwrap();
        check_names(&arguments.names(&NodeName::new("/", "shaft").unwrap()).unwrap())
    }

    #[test]
    fn endpoints_with_same_name_are_refused() {
        check(&[]).unwrap();
        check(&["~/enable:=on", "~/events:=on", "~/move_axis:=on"]).unwrap();
        // The names are swapped.
        check(&["~/enable:=~/disable", "~/disable:=~/enable"]).unwrap();
        let sentence = "-r: ~/enable and ~/disable are both called /shaft/disable; each needs a name of its own";
        assert_eq!(check(&["~/enable:=~/disable"]), Err(sentence.to_owned()));
        for rule in
            ["~/move_axis:=~/probe_axis", "~/enable:=~/move_axis/_action/send_goal", "joint_states:=~/axis_states"]
        {
            assert!(check(&[rule]).is_err(), "{rule}");
        }
    }
}
