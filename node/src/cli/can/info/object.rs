//! Describes a device, its drive and its PDOs as JSON objects (docs/json.md).

use lineshaft_can::NodeId;
use lineshaft_can::commission::words::nmt_state;
use lineshaft_can::commission::{Device, Drive, PdoConfiguration, ReportedState};
use lineshaft_can::eds::Dictionary;
use lineshaft_cia402::dictionary::Direction;
use lineshaft_cia402::texts::drive_state;
use lineshaft_core::drive::DriveState;
use serde_json::{Value as Json, json};

pub(super) fn of_device(node: NodeId, device: &Device, heard: ReportedState) -> Json {
    let [vendor, product, revision, serial] = device.identity;
    let [name, hardware, software] = &device.texts;
    let state = match heard {
        ReportedState::State(state) => Some(nmt_state(state)),
        ReportedState::None | ReportedState::Silent => None,
    };
    json!({
        "node": node.get(),
        "name": name,
        "hardware": hardware,
        "software": software,
        "device_type": device.device_type,
        "profile": device.device_type.map(|device_type| device_type & 0xFFFF),
        "vendor": vendor,
        "product_code": product,
        "revision": revision,
        "serial": serial,
        "nmt_state": state,
        "heartbeat_ms": device.heartbeat_ms,
        "error_register": device.register,
        "error_history": device.history,
    })
}

pub(super) fn of_drive(drive: &Drive) -> Json {
    let factors =
        drive.factors.iter().map(|(index, what, values)| json!({"index": index, "name": what, "values": values}));
    json!({
        "status_word": drive.status,
        "state": drive.status.map(|status| drive_state(DriveState::from_status(status))),
        "supported_modes": drive.modes,
        "mode": drive.mode,
        "error_code": drive.error,
        "position": drive.position,
        "digital_inputs": drive.inputs,
        "factors": factors.collect::<Json>(),
    })
}

pub(super) fn of_pdo(pdo: &PdoConfiguration, dictionary: Option<&Dictionary>) -> Json {
    let mapped = pdo.mapped.iter().map(|mapped| {
        let object = mapped.object;
        json!({
            "index": object.index,
            "subindex": object.sub,
            "bits": mapped.bits,
            "name": dictionary.and_then(|dictionary| dictionary.name(object)),
        })
    });
    json!({
        "direction": if pdo.direction == Direction::Transmit { "transmit" } else { "receive" },
        "number": pdo.number,
        "cob_id": pdo.cob_id.id(),
        "valid": pdo.cob_id.is_valid(),
        "transmission": pdo.transmission,
        "inhibit_us": pdo.inhibit.map(|inhibit| u64::from(inhibit) * 100),
        "event_timer_ms": pdo.event_timer,
        "mapped": mapped.collect::<Json>(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use lineshaft_can::eds::CobId;
    use lineshaft_can::{NmtState, eds};
    use lineshaft_cia402::dictionary::Mapped;
    use lineshaft_cia402::object::Object;

    #[test]
    fn device_has_its_numbers_and_null_for_those_that_it_lacks() {
        let device = Device {
            device_type: Some(0x0002_0192),
            identity: [Some(0xFB), Some(2), None, Some(u32::MAX)],
            texts: [Some("a\"b".to_owned()), None, None],
            register: Some(0x21),
            history: Some(vec![0x7121]),
            heartbeat_ms: Some(50),
        };
        let node = NodeId::new(3).unwrap();
        let expected = json!({
            "node": 3, "name": "a\"b", "hardware": null, "software": null, "device_type": 131_474, "profile": 402,
            "vendor": 251, "product_code": 2, "revision": null, "serial": 4_294_967_295_u32,
            "nmt_state": "pre-operational", "heartbeat_ms": 50, "error_register": 33, "error_history": [28_961]
        });
        assert_eq!(of_device(node, &device, ReportedState::State(NmtState::PreOperational)), expected);
        assert_eq!(of_device(node, &device, ReportedState::Silent)["nmt_state"], Json::Null);
        assert_eq!(of_device(node, &Device::default(), ReportedState::None)["error_history"], Json::Null);
    }

    #[test]
    fn drive_has_its_state_and_factors() {
        // 0237h is operation enabled (CiA 402-2).
        let drive = Drive {
            status: Some(0x0237),
            mode: Some(-1),
            position: Some(-5),
            factors: vec![(0x608F, "position encoder resolution", vec![10_000, 1])],
            ..Drive::default()
        };
        let object = of_drive(&drive);
        assert_eq!((&object["status_word"], &object["state"]), (&json!(567), &json!("operation enabled")));
        assert_eq!(
            (&object["mode"], &object["position"], &object["error_code"]),
            (&json!(-1), &json!(-5), &Json::Null)
        );
        let factor = json!({"index": 0x608F, "name": "position encoder resolution", "values": [10_000, 1]});
        assert_eq!(object["factors"], json!([factor]));
    }

    #[test]
    fn pdo_has_times_in_us_and_ms_and_names_of_the_eds() {
        let known = eds::parse(include_bytes!("../../../../../launch-configs/can/cia402_sim.eds"), Some(3)).unwrap();
        let pdo = PdoConfiguration {
            direction: Direction::Transmit,
            number: 1,
            cob_id: CobId(0x8000_0183),
            transmission: Some(255),
            inhibit: Some(30),
            event_timer: None,
            mapped: vec![Mapped { object: Object { index: 0x6064, sub: 0 }, bits: 32 }],
        };
        let object = of_pdo(&pdo, Some(&known));
        let mapped = json!({"index": 0x6064, "subindex": 0, "bits": 32, "name": "Position actual value"});
        let expected = json!({
            "direction": "transmit", "number": 1, "cob_id": 0x183, "valid": false, "transmission": 255,
            "inhibit_us": 3000, "event_timer_ms": null, "mapped": [mapped]
        });
        assert_eq!(object, expected);
        assert_eq!(of_pdo(&pdo, None)["mapped"][0]["name"], Json::Null);
    }
}
