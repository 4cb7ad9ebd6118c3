//! Topics, services, actions and types as people read them: in a terminal, and as docs/interfaces.md.
//!
//! All of it is made of the tables that the program uses: what the surface opens, the catalogue of parameters, and the
//! interface files.

mod markdown;
mod terminal;

pub(crate) use markdown::replaced;
pub use markdown::{markdown, renewed};
pub use terminal::{details, listing, meant};

use lineshaft_ros::layer::Qos;
use lineshaft_ros::surface::table::Kind;

/// As in the first column of the page.
fn kind_text(kind: Kind) -> &'static str {
    match kind {
        Kind::Publisher => "pub",
        Kind::Subscription => "sub",
        Kind::Service => "srv",
        Kind::Action => "action",
    }
}

/// In the words of ROS 2: reliability, durability, depth; lifespan, where there is one.
fn qos_text(qos: Qos) -> String {
    let reliability = if qos.reliable { "reliable" } else { "best effort" };
    let durability = if qos.latched { "transient local" } else { "volatile" };
    let lifespan = qos.lifespan.map_or(String::new(), |age| format!(", lifespan {} s", age.as_secs_f64()));
    format!("{reliability}, {durability}, {}{lifespan}", qos.depth)
}

/// `lineshaft_msgs/action/MoveAxis` as it is said: without its middle.
pub(crate) fn short(interface: &str) -> String {
    match interface.split('/').collect::<Vec<_>>().as_slice() {
        [package, _, name] => format!("{package}/{name}"),
        _ => interface.to_owned(),
    }
}

#[cfg(test)]
mod tests;
