//! A small machine for tests: line is virtual, x has a drive; 1000 inc/mm, 1 m/s, 5 m/s^2.

use lineshaft_core::config::{AxisConfig, MachineConfig};
use lineshaft_core::parameter::{AxisParameters, ParameterImage};
use lineshaft_core::unit::{Fraction, Quantity, Scale, Unit};

pub(in crate::surface) fn config() -> MachineConfig {
    let per = Quantity::new(Fraction::from_integer(1), Unit::MILLIMETRE);
    let scale = Scale::new(Fraction::from_integer(1000), per).and_then(|scale| scale.with_unit(Unit::MILLIMETRE));
    let scale = scale.expect("a sound scale");
    let parameters = AxisParameters::new(1_000_000.0, 5_000_000.0);
    let axis = |name: &str, drive: Option<u32>| {
        AxisConfig::new(name.to_owned(), scale, drive.map(lineshaft_core::drive::Capabilities::all), parameters)
    };
    MachineConfig {
        cycle_ns: 1_000_000,
        axes: vec![axis("line", None), axis("x", Some(0))],
        ..MachineConfig::default()
    }
}

/// Returns the image at the start of the machine.
pub(in crate::surface) fn image(config: &MachineConfig) -> ParameterImage {
    let parameters: Vec<AxisParameters> = config.axes.iter().map(|axis| axis.parameters).collect();
    ParameterImage { effective: parameters.clone(), user: parameters, ..ParameterImage::default() }
}
