//! Describes topics, services, actions and types: in a terminal, and in docs/interfaces.md.
//!
//! The texts are made from the tables that the program uses: the interfaces of the surface, the catalogue of
//! parameters, and the interface files.

mod markdown;
mod terminal;

pub(crate) use markdown::replaced;
pub use markdown::{markdown, renewed};
pub use terminal::{details, listing, meant};

use lineshaft_ros::layer::Qos;
use lineshaft_ros::surface::table::Kind;

/// Returns the text of the first column of the page.
fn kind_text(kind: Kind) -> &'static str {
    match kind {
        Kind::Publisher => "pub",
        Kind::Subscription => "sub",
        Kind::Service => "srv",
        Kind::Action => "action",
    }
}

/// Returns the QoS in ROS 2 terms: reliability, durability, depth; lifespan, if there is one.
fn qos_text(qos: Qos) -> String {
    let reliability = if qos.reliable { "reliable" } else { "best effort" };
    let durability = if qos.latched { "transient local" } else { "volatile" };
    let lifespan = qos.lifespan.map_or(String::new(), |age| format!(", lifespan {} s", age.as_secs_f64()));
    format!("{reliability}, {durability}, {}{lifespan}", qos.depth)
}

/// Returns the short name of `lineshaft_msgs/action/MoveAxis`, without its middle part.
pub(crate) fn short(interface: &str) -> String {
    match interface.split('/').collect::<Vec<_>>().as_slice() {
        [package, _, name] => format!("{package}/{name}"),
        _ => interface.to_owned(),
    }
}

#[cfg(test)]
mod tests;
