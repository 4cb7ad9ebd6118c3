//! list_parameters, as in rclcpp.

use super::view::View;
use lineshaft_msgs::foreign::rcl_interfaces::msg::ListParametersResult;
use lineshaft_msgs::foreign::rcl_interfaces::srv::ListParametersRequest;

impl View<'_> {
    /// Returns the names under any of the prefixes (all names without a prefix) whose remaining part has at most `depth` tokens; 0: any
    /// number. In addition returns the prefix of each name up to its last dot, in the order of first occurrence.
    pub(super) fn list(&self, request: &ListParametersRequest) -> ListParametersResult {
        let is_near = |rest: &str| {
            let dots = rest.bytes().filter(|byte| *byte == b'.').count() as u64;
            request.depth == ListParametersRequest::DEPTH_RECURSIVE || dots < request.depth
        };
        let is_under = |name: &str, prefix: &str| {
            let rest = name.strip_prefix(prefix).and_then(|rest| rest.strip_prefix('.'));
            name == prefix || rest.is_some_and(is_near)
        };
        let is_asked = |name: &str| match request.prefixes.as_slice() {
            [] => is_near(name),
            prefixes => prefixes.iter().any(|prefix| is_under(name, prefix)),
        };
        let mut result = ListParametersResult::default();
        for name in self.names().into_iter().filter(|name| is_asked(name)) {
            if let Some((prefix, _)) = name.rsplit_once('.')
                && !result.prefixes.iter().any(|known| known == prefix)
            {
                result.prefixes.push(prefix.to_owned());
            }
            result.names.push(name.to_owned());
        }
        result
    }
}

#[cfg(test)]
mod tests {
    use super::super::catalogue::Catalogue;
    use super::super::fake;
    use super::*;
    use std::collections::BTreeMap;

    fn list(prefixes: &[&str], depth: u64) -> ListParametersResult {
        let prefixes = prefixes.iter().map(|prefix| (*prefix).to_owned()).collect();
        let (config, own) = (fake::config(), BTreeMap::new());
        let (catalogue, image) = (Catalogue::new(&config), fake::image(&config));
        View { catalogue: &catalogue, image: &image, own: &own }.list(&ListParametersRequest { prefixes, depth })
    }

    #[test]
    fn prefixes_and_depth_choose_names() {
        let all = list(&[], 0);
        assert_eq!(all.names.len(), Catalogue::new(&fake::config()).all().len());
        assert!(all.names.is_sorted());
        let of_x = ["x", "x.amc", "x.compensation", "x.homing", "x.saia", "x.wf"];
        let prefixes = [&["line", "line.amc", "line.saia", "line.wf", "machine"], &of_x[..]].concat();
        let mut seen = all.prefixes.clone();
        seen.sort();
        assert_eq!(seen, prefixes);

        let of_x = list(&["x"], 0);
        assert!(of_x.names.iter().all(|name| name.starts_with("x.")));
        assert!(of_x.names.contains(&"x.saia.kprop".to_owned()));
        let direct = list(&["x"], 1);
        assert_eq!(direct.prefixes, ["x"]);
        assert!(direct.names.contains(&"x.max_velocity".to_owned()));
        assert!(!direct.names.contains(&"x.saia.kprop".to_owned()));
        assert_eq!(list(&["x"], 2), of_x);

        assert_eq!(list(&["x.max_velocity"], 0).names, ["x.max_velocity"]);
        let several = list(&["machine.cannr", "x.saia"], 1);
        assert!(several.names.len() > 10 && several.names[0] == "machine.cannr");
        assert_eq!(several.prefixes, ["machine", "x.saia"]);
    }

    #[test]
    fn what_is_no_prefix_lists_nothing() {
        for prefixes in [&["x.max_vel"][..], &[""], &["x."], &["X"], &["no_such_axis"]] {
            assert_eq!(list(prefixes, 0), ListParametersResult::default(), "{prefixes:?}");
        }
        // Without a prefix, every name consists of object, dot and key.
        assert_eq!(list(&[], 1), ListParametersResult::default());
        assert!(list(&[], 2).names.contains(&"x.max_velocity".to_owned()));
        assert!(!list(&[], 2).names.contains(&"x.saia.kprop".to_owned()));
    }
}
