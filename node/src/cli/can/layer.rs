//! `lineshaft can lss`.

use super::Failure;
use super::args::{BusArgs, IdentityArgs, LssWords};
use super::open::Known;
use crate::cli::say;
use crate::progress::{MOMENT, Progress};
use lineshaft_can::lss::LssCommand;

pub(super) fn lss(words: &LssWords) -> Result<(), Failure> {
    match words {
        LssWords::Scan { bus } => scan(bus),
        LssWords::SetId { node, device, bus } => {
            set(bus, *device, LssCommand::NodeId(*node))?;
            say(&format_args!("the device is {node} now; `lss store` makes it keep that"));
            Ok(())
        }
        LssWords::BitRate { rate, device, bus } => {
            set(bus, *device, LssCommand::BitRate(*rate))?;
            say(&"the device has taken the bit rate, for its next start; `lss store` makes it keep that");
            Ok(())
        }
        LssWords::Store { device, bus } => {
            set(bus, *device, LssCommand::Store)?;
            say(&"the device has stored its node id and its bit rate");
            Ok(())
        }
    }
}

fn scan(bus: &BusArgs) -> Result<(), Failure> {
    let mut session = Known::of(bus)?.open()?;
    let mut progress = Progress::new("questions", MOMENT);
    let found = session.search(&mut |done, of| progress.set(done, Some(of)));
    drop(progress);
    match found? {
        Some([vendor, product, revision, serial]) => {
            say(&format_args!(
                "--vendor 0x{vendor:08X} --product 0x{product:08X} --revision 0x{revision:08X} --serial 0x{serial:08X}"
            ));
            Ok(())
        }
        None => Err(Failure::Bus("no device without a node id has answered".to_owned())),
    }
}

fn set(bus: &BusArgs, device: IdentityArgs, command: LssCommand) -> Result<(), Failure> {
    let mut session = Known::of(bus)?.open()?;
    let identity = [device.vendor, device.product, device.revision, device.serial];
    Ok(session.send_lss_command(identity, command)?)
}
