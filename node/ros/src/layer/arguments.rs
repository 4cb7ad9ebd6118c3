//! `--ros-args`, as `ros2 run` and launch files give them.

/// Arguments that cannot be followed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ArgumentError {
    /// One that ROS knows and this program does not, or that nobody knows.
    #[error(
        "ROS argument {given:?} is not supported, only -r __node:=NAME, -r __name:=NAME and -r __ns:=NAMESPACE are"
    )]
    Unsupported {
        /// The argument.
        given: String,
    },
    /// A remapping that is none.
    #[error("{flag} is followed by {given:?}, only FROM:=TO is allowed")]
    Remap {
        /// `-r` or `--remap`.
        flag: String,
        /// What follows it.
        given: String,
    },
    /// A flag at the end.
    #[error("{flag} is not followed by anything, FROM:=TO is needed")]
    Missing {
        /// `-r` or `--remap`.
        flag: String,
    },
}

/// What `--ros-args` said.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RosArguments {
    /// `-r __node:=` or `-r __name:=`.
    pub name: Option<String>,
    /// `-r __ns:=`.
    pub namespace: Option<String>,
}

impl RosArguments {
    /// Takes the ROS arguments out of a command line; the rest comes back in its order.
    ///
    /// They stand between `--ros-args` and `--` or the end, and may stand there several times.
    pub fn take(arguments: impl IntoIterator<Item = String>) -> Result<(Self, Vec<String>), ArgumentError> {
        let (mut taken, mut rest, mut inside) = (Self::default(), Vec::new(), false);
        let mut arguments = arguments.into_iter();
        while let Some(argument) = arguments.next() {
            match (inside, argument.as_str()) {
                (_, "--ros-args") => inside = true,
                (true, "--") => inside = false,
                (true, "-r" | "--remap") => match arguments.next() {
                    Some(rule) => taken.remap(argument, rule)?,
                    None => return Err(ArgumentError::Missing { flag: argument }),
                },
                (true, _) => return Err(ArgumentError::Unsupported { given: argument }),
                (false, _) => rest.push(argument),
            }
        }
        Ok((taken, rest))
    }

    fn remap(&mut self, flag: String, rule: String) -> Result<(), ArgumentError> {
        match rule.split_once(":=") {
            Some(("__node" | "__name", name)) => self.name = Some(name.to_owned()),
            Some(("__ns", namespace)) => self.namespace = Some(namespace.to_owned()),
            Some(_) => return Err(ArgumentError::Unsupported { given: format!("{flag} {rule}") }),
            None => return Err(ArgumentError::Remap { flag, given: rule }),
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn take(line: &str) -> Result<(RosArguments, Vec<String>), ArgumentError> {
        RosArguments::take(line.split_whitespace().map(str::to_owned))
    }

    fn names(name: Option<&str>, namespace: Option<&str>) -> RosArguments {
        RosArguments { name: name.map(str::to_owned), namespace: namespace.map(str::to_owned) }
    }

    #[test]
    fn names_are_taken_and_the_rest_is_left() {
        let (taken, rest) = take("run cell.yaml --ros-args -r __node:=shaft --remap __ns:=/cell -- --sim").unwrap();
        assert_eq!(taken, names(Some("shaft"), Some("/cell")));
        assert_eq!(rest, ["run", "cell.yaml", "--sim"]);
        assert_eq!(take("--ros-args -r __name:=a --ros-args -r __name:=b").unwrap().0, names(Some("b"), None));
        assert_eq!(take("run -r x").unwrap(), (names(None, None), vec!["run".into(), "-r".into(), "x".into()]));
        assert_eq!(take("run --ros-args").unwrap(), (names(None, None), vec!["run".into()]));
    }

    #[test]
    fn what_is_not_supported_is_named() {
        let error = |line| take(line).unwrap_err().to_string();
        assert!(
            error("--ros-args --params-file p.yaml").starts_with(r#"ROS argument "--params-file" is not supported"#)
        );
        assert!(error("--ros-args -r /a:=/b").starts_with(r#"ROS argument "-r /a:=/b" is not supported"#));
        assert_eq!(error("--ros-args -r __node=x"), r#"-r is followed by "__node=x", only FROM:=TO is allowed"#);
        assert_eq!(error("--ros-args --remap"), "--remap is not followed by anything, FROM:=TO is needed");
    }
}
