//! Settings of a ROS node from environment variables: domain and networks.

use std::net::{IpAddr, Ipv4Addr};

/// Maximum domain ID with valid ports (RTPS 2.5, 9.6.2.3: 7400 + 250 * domain and the next 250).
const MAX_DOMAIN: u16 = 232;

/// Invalid environment variable.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EnvironmentError {
    /// `ROS_DOMAIN_ID` is not a domain ID.
    #[error("ROS_DOMAIN_ID is {given:?}, only 0..{MAX_DOMAIN} are allowed")]
    Domain {
        /// Given value.
        given: String,
    },
    /// A variable has an unknown value.
    #[error("{variable} is {given:?}, only {allowed} are allowed")]
    Value {
        /// Name of the variable.
        variable: &'static str,
        /// Given value.
        given: String,
        /// Allowed values.
        allowed: &'static str,
    },
    /// Discovery is switched off.
    #[error(
        "ROS_AUTOMATIC_DISCOVERY_RANGE is OFF, but without discovery nobody finds the node; LOCALHOST keeps it on this host"
    )]
    DiscoveryOff,
    /// A network interface is missing.
    #[error("interface {given:?} does not exist, this host has {existing}")]
    Interface {
        /// Given name or address.
        given: String,
        /// Existing names and addresses.
        existing: String,
    },
    /// The host did not list its interfaces.
    #[error("the interfaces of this host cannot be read: {0}")]
    Interfaces(String),
}

/// Networks that a node uses.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Networks {
    /// Only processes of this host.
    Loopback,
    /// All networks of the host.
    All,
    /// Networks with these addresses.
    Only(Vec<Ipv4Addr>),
}

impl Networks {
    /// Returns the addresses to which the participant is restricted.
    pub(super) fn addresses(&self) -> Option<&[Ipv4Addr]> {
        match self {
            Self::Loopback => Some(&[Ipv4Addr::LOCALHOST]),
            Self::All => None,
            Self::Only(addresses) => Some(addresses),
        }
    }
}

/// IPv4 interface of the host.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Interface {
    /// Name in the system, for example `eth0`.
    pub name: String,
    /// Address.
    pub address: Ipv4Addr,
    /// Whether the interface is up and running.
    pub is_up: bool,
}

impl Interface {
    /// Returns the IPv4 interfaces of this host; an interface with several addresses is listed several times.
    pub fn of_host() -> Result<Vec<Self>, EnvironmentError> {
        let interfaces = if_addrs::get_if_addrs().map_err(|error| EnvironmentError::Interfaces(error.to_string()))?;
        let ipv4 = interfaces.into_iter().filter_map(|interface| match interface.ip() {
            IpAddr::V4(address) => Some(Self { is_up: interface.is_oper_up(), name: interface.name, address }),
            IpAddr::V6(_) => None,
        });
        Ok(ipv4.collect())
    }
}

/// Domain and networks of a node.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Environment {
    /// Domain ID, 0 to 232; nodes of different domains do not see each other.
    pub domain: u16,
    /// Networks.
    pub networks: Networks,
}

impl Environment {
    /// Reads `ROS_DOMAIN_ID`, `ROS_LOCALHOST_ONLY` and `ROS_AUTOMATIC_DISCOVERY_RANGE`.
    pub fn read() -> Result<Self, EnvironmentError> {
        if std::env::var("ROS_STATIC_PEERS").is_ok_and(|peers| !peers.is_empty()) {
            tracing::warn!("ROS_STATIC_PEERS is not supported: other hosts are found by multicast only");
        }
        Self::from_variables(|name| std::env::var_os(name).map(|value| value.to_string_lossy().into_owned()))
    }

    /// Reads the variables from `get`, like [`Environment::read`]; an empty value counts as not set.
    pub fn from_variables(get: impl Fn(&str) -> Option<String>) -> Result<Self, EnvironmentError> {
        let get = |name| get(name).filter(|value| !value.is_empty());
        Ok(Self { domain: domain(get("ROS_DOMAIN_ID"))?, networks: range(get)? })
    }

    /// Restricts the networks to these interfaces, given as names or IPv4 addresses; an empty list changes nothing. If the environment
    /// restricts the node to this host, it stays there.
    pub fn with_interfaces(self, given: &[String], existing: &[Interface]) -> Result<Self, EnvironmentError> {
        let mut addresses = Vec::new();
        for wanted in given {
            let found = existing.iter().filter(|i| i.name == *wanted || i.address.to_string() == *wanted);
            let before = addresses.len();
            addresses.extend(found.map(|interface| interface.address));
            if addresses.len() == before {
                let existing = existing.iter().map(|i| format!("{} ({})", i.name, i.address));
                let existing = existing.collect::<Vec<_>>().join(", ");
                return Err(EnvironmentError::Interface { given: wanted.clone(), existing });
            }
        }
        match self.networks {
            Networks::Loopback => Ok(self),
            _ if addresses.is_empty() => Ok(self),
            _ => Ok(Self { networks: Networks::Only(addresses), ..self }),
        }
    }

    /// Returns a message about used interfaces that are down, which explains why clients do not find the node. `None` if all relevant ones
    /// are up: with all networks the loopback and one more, otherwise the loopback alone.
    pub fn unreachable(&self, existing: &[Interface]) -> Option<String> {
        let is_used = |interface: &&Interface| match &self.networks {
            Networks::Loopback => interface.address == Ipv4Addr::LOCALHOST,
            Networks::All => true,
            Networks::Only(addresses) => addresses.contains(&interface.address),
        };
        let is_any_up = existing.iter().filter(is_used).any(|interface| interface.is_up);
        // Bridges without a port are down on many hosts. Named interfaces and the loopback should be up.
        let matters =
            |interface: &&Interface| !is_any_up || self.networks != Networks::All || interface.address.is_loopback();
        let down: Vec<_> =
            existing.iter().filter(is_used).filter(matters).filter(|interface| !interface.is_up).collect();
        let names: Vec<_> = down.iter().map(|down| format!("{} ({})", down.name, down.address)).collect();
        let (names, is) = (names.join(", "), if down.len() == 1 { "is" } else { "are" });
        match (down.first(), is_any_up) {
            (None, true) => None,
            (None, false) => {
                Some("no client finds the node: this host has no IPv4 interface that it may use".to_owned())
            }
            (Some(first), true) => {
                Some(format!("{names} {is} down: clients there do not find the node; `ip link set {} up`", first.name))
            }
            (Some(first), false) => {
                Some(format!("no client finds the node: {names} {is} down; `ip link set {} up`", first.name))
            }
        }
    }
}

fn domain(given: Option<String>) -> Result<u16, EnvironmentError> {
    match given {
        None => Ok(0),
        Some(given) => match given.parse() {
            Ok(domain) if domain <= MAX_DOMAIN => Ok(domain),
            _ => Err(EnvironmentError::Domain { given }),
        },
    }
}

fn range(get: impl Fn(&'static str) -> Option<String>) -> Result<Networks, EnvironmentError> {
    // As in ROS: the older variable, if set to 1, overrides the newer one.
    match get("ROS_LOCALHOST_ONLY").as_deref() {
        Some("1") => return Ok(Networks::Loopback),
        Some("0") | None => {}
        Some(given) => {
            let given = given.to_owned();
            return Err(EnvironmentError::Value { variable: "ROS_LOCALHOST_ONLY", given, allowed: "0 and 1" });
        }
    }
    match get("ROS_AUTOMATIC_DISCOVERY_RANGE").as_deref() {
        None | Some("SUBNET" | "SYSTEM_DEFAULT") => Ok(Networks::All),
        Some("LOCALHOST") => Ok(Networks::Loopback),
        Some("OFF") => Err(EnvironmentError::DiscoveryOff),
        Some(given) => Err(EnvironmentError::Value {
            variable: "ROS_AUTOMATIC_DISCOVERY_RANGE",
            given: given.to_owned(),
            allowed: "SUBNET, LOCALHOST and SYSTEM_DEFAULT",
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(variables: &[(&str, &str)]) -> Result<Environment, EnvironmentError> {
        let find = |name: &str| variables.iter().find(|(n, _)| *n == name).map(|(_, value)| (*value).to_owned());
        Environment::from_variables(find)
    }

    fn networks(variables: &[(&str, &str)]) -> Networks {
        read(variables).unwrap().networks
    }

    #[test]
    fn default_is_domain_0_on_all_networks() {
        let default = Environment { domain: 0, networks: Networks::All };
        assert_eq!(read(&[]).unwrap(), default);
        assert_eq!(read(&[("ROS_DOMAIN_ID", ""), ("ROS_AUTOMATIC_DISCOVERY_RANGE", "")]).unwrap(), default);
    }

    #[test]
    fn domains_end_at_232() {
        assert_eq!(read(&[("ROS_DOMAIN_ID", "0")]).unwrap().domain, 0);
        assert_eq!(read(&[("ROS_DOMAIN_ID", "232")]).unwrap().domain, 232);
        for bad in ["233", "-1", "1.5", "seven", "65536"] {
            let error = read(&[("ROS_DOMAIN_ID", bad)]).unwrap_err();
            assert_eq!(error.to_string(), format!("ROS_DOMAIN_ID is {bad:?}, only 0..232 are allowed"));
        }
    }

    #[test]
    fn the_range_decides_the_networks() {
        const RANGE: &str = "ROS_AUTOMATIC_DISCOVERY_RANGE";
        assert_eq!(networks(&[(RANGE, "SUBNET")]), Networks::All);
        assert_eq!(networks(&[(RANGE, "SYSTEM_DEFAULT")]), Networks::All);
        assert_eq!(networks(&[(RANGE, "LOCALHOST")]), Networks::Loopback);
        assert_eq!(networks(&[("ROS_LOCALHOST_ONLY", "1"), (RANGE, "SUBNET")]), Networks::Loopback);
        assert_eq!(networks(&[("ROS_LOCALHOST_ONLY", "0"), (RANGE, "LOCALHOST")]), Networks::Loopback);
        assert_eq!(read(&[(RANGE, "OFF")]).unwrap_err(), EnvironmentError::DiscoveryOff);
        assert_eq!(
            read(&[(RANGE, "localhost")]).unwrap_err().to_string(),
            r#"ROS_AUTOMATIC_DISCOVERY_RANGE is "localhost", only SUBNET, LOCALHOST and SYSTEM_DEFAULT are allowed"#
        );
        assert_eq!(
            read(&[("ROS_LOCALHOST_ONLY", "true")]).unwrap_err().to_string(),
            r#"ROS_LOCALHOST_ONLY is "true", only 0 and 1 are allowed"#
        );
    }

    #[test]
    fn interfaces_are_names_or_addresses() {
        let address = |last| Ipv4Addr::new(192, 168, 1, last);
        let interface = |name: &str, last| Interface { name: name.to_owned(), address: address(last), is_up: true };
        let existing = [interface("eth0", 5), interface("eth0", 6), interface("wlan0", 9)];
        let all = || Environment { domain: 0, networks: Networks::All };
        let with = |environment: Environment, given: &[&str]| {
            let given: Vec<_> = given.iter().map(|name| (*name).to_owned()).collect();
            environment.with_interfaces(&given, &existing)
        };

        assert_eq!(with(all(), &[]).unwrap(), all());
        let both = with(all(), &["eth0", "192.168.1.9"]).unwrap().networks;
        assert_eq!(both, Networks::Only(vec![address(5), address(6), address(9)]));
        assert_eq!(
            with(all(), &["eth1"]).unwrap_err().to_string(),
            "interface \"eth1\" does not exist, this host has eth0 (192.168.1.5), eth0 (192.168.1.6), wlan0 (192.168.1.9)"
        );
        let local = Environment { domain: 3, networks: Networks::Loopback };
        assert_eq!(with(local.clone(), &["wlan0"]).unwrap(), local, "the environment keeps the node on its host");
    }

    #[test]
    fn node_whose_interfaces_are_down_is_unreachable() {
        let interface =
            |name: &str, address: [u8; 4], is_up| Interface { name: name.to_owned(), address: address.into(), is_up };
        let lo = |is_up| interface("lo", [127, 0, 0, 1], is_up);
        let eth = |is_up| interface("eth0", [10, 0, 0, 5], is_up);
        let bridge = interface("br0", [172, 17, 0, 1], false);
        let why =
            |networks: Networks, existing: &[Interface]| Environment { domain: 0, networks }.unreachable(existing);
        let only = || Networks::Only(vec![Ipv4Addr::new(10, 0, 0, 5)]);

        for networks in [Networks::Loopback, Networks::All, only()] {
            assert_eq!(why(networks, &[lo(true), eth(true), bridge.clone()]), None);
        }
        assert_eq!(why(Networks::Loopback, &[lo(true), eth(false)]), None);
        assert_eq!(why(Networks::All, &[lo(true), eth(false)]), None);
        assert_eq!(
            why(Networks::Loopback, &[lo(false), eth(true)]).unwrap(),
            "no client finds the node: lo (127.0.0.1) is down; `ip link set lo up`"
        );
        assert_eq!(
            why(Networks::All, &[lo(false), eth(true)]).unwrap(),
            "lo (127.0.0.1) is down: clients there do not find the node; `ip link set lo up`"
        );
        assert_eq!(
            why(Networks::All, &[lo(false), eth(false)]).unwrap(),
            "no client finds the node: lo (127.0.0.1), eth0 (10.0.0.5) are down; `ip link set lo up`"
        );
        assert_eq!(
            why(only(), &[lo(true), eth(false)]).unwrap(),
            "no client finds the node: eth0 (10.0.0.5) is down; `ip link set eth0 up`"
        );
        let none = "no client finds the node: this host has no IPv4 interface that it may use";
        for networks in [Networks::Loopback, Networks::All, only()] {
            assert_eq!(why(networks, &[]).unwrap(), none);
        }
    }

    #[test]
    fn this_host_has_a_loopback() {
        let found = Interface::of_host().unwrap();
        assert!(found.iter().any(|interface| interface.address == Ipv4Addr::LOCALHOST), "{found:?}");
    }
}
