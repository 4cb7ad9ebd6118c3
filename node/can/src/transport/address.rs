//! Addresses of CAN buses in a cell file.
//!
//! Law      `slcan:/dev/ttyACM0`, `slcan-tcp:HOST:PORT`, `socketcan:can0`, `udp:GROUP:PORT`; an address is written as it is read
//! Reads    one text
//! Refuses  another kind; an empty path or host; a port outside 1 to 65535; an invalid interface name; a group that is not an IPv4
//!          multicast address
//! Source   Linux `dev_valid_name` (net/core/dev.c), RFC 5771

use std::fmt;
use std::net::Ipv4Addr;
use std::path::PathBuf;
use std::str::FromStr;

/// Reason why a text is not an address of a bus.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AddressError {
    /// Unknown kind of address.
    #[error(
        "'{0}' is no CAN bus; allowed are slcan:/dev/ttyACM0, slcan-tcp:HOST:PORT, socketcan:can0, udp:239.74.163.2:43113"
    )]
    Kind(String),
    /// Missing path.
    #[error("'{0}' names no serial line; allowed is slcan: and the path of a device, such as slcan:/dev/ttyACM0")]
    Path(String),
    /// Missing host or port.
    #[error(
        "'{0}' names no adapter behind TCP; allowed is slcan-tcp:HOST:PORT with a port of 1 to 65535, and an IPv6 address in brackets"
    )]
    Host(String),
    /// Invalid interface name.
    #[error(
        "'{0}' names no CAN interface; allowed are 1 to 15 bytes without '/', ':' and blanks, such as socketcan:can0"
    )]
    Interface(String),
    /// Missing or invalid group or port.
    #[error(
        "'{0}' names no multicast group; allowed is udp:GROUP:PORT with 224.0.0.0 to 239.255.255.255 and a port of 1 to 65535"
    )]
    Group(String),
}

/// Address of a bus.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Address {
    /// slcan adapter on a serial line or a pseudo terminal.
    Slcan(PathBuf),
    /// slcan adapter behind TCP: `host:port`.
    SlcanTcp(String),
    /// CAN interface of Linux.
    SocketCan(String),
    /// Datagrams on loopback, compatible with the bus `udp_multicast` of python-can: for development.
    Udp {
        /// Multicast address.
        group: Ipv4Addr,
        /// Port, 1 to 65535.
        port: u16,
    },
}

impl FromStr for Address {
    type Err = AddressError;

    fn from_str(text: &str) -> Result<Self, AddressError> {
        let given = || text.to_owned();
        let (kind, rest) = text.split_once(':').ok_or_else(|| AddressError::Kind(given()))?;
        match kind {
            "slcan" if rest.is_empty() || rest.contains('\0') => Err(AddressError::Path(given())),
            "slcan" => Ok(Self::Slcan(rest.into())),
            "slcan-tcp" => match rest.rsplit_once(':') {
                Some((host, number)) if is_host(host) && port(number).is_some() => Ok(Self::SlcanTcp(rest.to_owned())),
                _ => Err(AddressError::Host(given())),
            },
            "socketcan" if is_interface(rest) => Ok(Self::SocketCan(rest.to_owned())),
            "socketcan" => Err(AddressError::Interface(given())),
            "udp" => group_and_port(rest).ok_or_else(|| AddressError::Group(given())),
            _ => Err(AddressError::Kind(given())),
        }
    }
}

fn is_host(host: &str) -> bool {
    let is_in_brackets = host.starts_with('[') && host.ends_with(']');
    !host.is_empty()
        && !host.contains(|c: char| c.is_whitespace() || c == '/')
        && (is_in_brackets || !host.contains(':'))
}

/// Parses a port without sign and without leading zeros, so that it is written as it is read.
fn port(text: &str) -> Option<u16> {
    text.parse().ok().filter(|port: &u16| *port != 0 && port.to_string() == text)
}

fn is_interface(name: &str) -> bool {
    let is_foreign = |c: char| c.is_whitespace() || matches!(c, '/' | ':' | '\0');
    (1..=15).contains(&name.len()) && !matches!(name, "." | "..") && !name.contains(is_foreign)
}

fn group_and_port(text: &str) -> Option<Address> {
    let (group, number) = text.split_once(':')?;
    let group: Ipv4Addr = group.parse().ok()?;
    group.is_multicast().then_some(Address::Udp { group, port: port(number)? })
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Slcan(path) => write!(f, "slcan:{}", path.display()),
            Self::SlcanTcp(host) => write!(f, "slcan-tcp:{host}"),
            Self::SocketCan(interface) => write!(f, "socketcan:{interface}"),
            Self::Udp { group, port } => write!(f, "udp:{group}:{port}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_four_kinds_are_read() {
        let group = Ipv4Addr::new(239, 74, 163, 2);
        let read = [
            ("slcan:/dev/ttyACM0", Address::Slcan("/dev/ttyACM0".into())),
            ("slcan-tcp:127.0.0.1:3333", Address::SlcanTcp("127.0.0.1:3333".to_owned())),
            ("slcan-tcp:wican.local:23", Address::SlcanTcp("wican.local:23".to_owned())),
            ("slcan-tcp:[::1]:65535", Address::SlcanTcp("[::1]:65535".to_owned())),
            ("socketcan:can0", Address::SocketCan("can0".to_owned())),
            ("udp:239.74.163.2:43113", Address::Udp { group, port: 43113 }),
        ];
        for (text, address) in read {
            assert_eq!(text.parse(), Ok(address.clone()));
            assert_eq!(address.to_string(), text);
        }
    }

    #[test]
    fn other_addresses_are_refused_with_allowed_forms() {
        let refused = [
            (["", "can0", "pcan:usb1"], "is no CAN bus; allowed are slcan:/dev/ttyACM0, "),
            (["Slcan:/dev/ttyACM0", " slcan:/dev/ttyACM0", "slcan"], "is no CAN bus; "),
            (["slcan:", "slcan:", "slcan:a\0b"], "names no serial line; allowed is slcan: and "),
            (["slcan-tcp:", "slcan-tcp:host", "slcan-tcp::1"], "names no adapter behind TCP; allowed is "),
            (["slcan-tcp:h:0", "slcan-tcp:h:65536", "slcan-tcp:h:+1"], "with a port of 1 to 65535"),
            (["slcan-tcp:::1:80", "slcan-tcp:a b:1", "slcan-tcp:h:080"], "an IPv6 address in brackets"),
            (
                ["socketcan:", "socketcan:sixteen-bytes-it", "socketcan:a/b"],
                "names no CAN interface; allowed are 1 to 15",
            ),
            (["socketcan:can 0", "socketcan:..", "socketcan:a:b"], "such as socketcan:can0"),
            (
                ["udp:", "udp:239.74.163.2", "udp:192.168.0.1:43113"],
                "names no multicast group; allowed is udp:GROUP:PORT",
            ),
            (["udp:239.1.1:1", "udp:239.74.163.2:0", "udp:239.74.163.2:99999"], "224.0.0.0 to 239.255.255.255"),
        ];
        for (texts, sentence) in refused {
            for text in texts {
                let error = text.parse::<Address>().unwrap_err().to_string();
                assert!(error.starts_with(&format!("'{text}' ")) && error.contains(sentence), "{error}");
            }
        }
    }

    proptest! {
        /// An address is written as it is read.
        #[test]
        fn address_is_written_as_read(kind in "slcan|slcan-tcp|socketcan|udp", rest in "[ -~]{0,20}", host in "[a-z.0-9:\\[\\]]{1,12}",
                                 group: u32, port: u16) {
            for text in [format!("{kind}:{rest}"), format!("{kind}:{host}:{port}"), format!("{kind}:{}:{port}", Ipv4Addr::from(group))] {
                if let Ok(address) = text.parse::<Address>() {
                    prop_assert_eq!(address.to_string(), text);
                }
            }
        }
    }
}
