//! Time that the CAN master takes in the cycle thread, without a real bus.
//!
//! `cargo bench -p lineshaft-can --bench exchange` measures: the exchange of one cycle with 1, 2 and 8 drives whose answers are available
//! at once; packing and unpacking of a PDO; reading a number by SDO; counting the bits of a frame.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use lineshaft_can::config::{BusConfig, DeviceConfig};
use lineshaft_can::load;
use lineshaft_can::master::CanBackend;
use lineshaft_can::pdo_image::PdoImage;
use lineshaft_can::sdo::Client;
use lineshaft_can::transport::{Transport, TransportError};
use lineshaft_can::{Frame, Id, Monitoring, NodeId};
use lineshaft_cia402::mapping::{CommandedValue, ReportedValue};
use lineshaft_cia402::object::Object;
use lineshaft_core::drive::{Backend, DriveInput, DriveOutput, Inputs, MODE_CSP, Outputs};
use std::hint::black_box;

/// Transport that returns the PDOs of all drives after each SYNC.
struct Loopback {
    answers: Vec<PdoImage<ReportedValue>>,
    next: usize,
    position: i64,
}

impl Transport for Loopback {
    fn send(&mut self, frame: &Frame) -> Result<(), TransportError> {
        if frame.id() == Id::SYNC {
            (self.next, self.position) = (0, self.position + 10);
        }
        black_box(frame);
        Ok(())
    }

    fn flush(&mut self) -> Result<(), TransportError> {
        Ok(())
    }

    fn receive(&mut self) -> Result<Option<Frame>, TransportError> {
        let answer = self.answers.get(self.next);
        self.next += 1;
        let position = self.position;
        let frame = answer.map(|image| {
            image.frame(|word| match word {
                ReportedValue::Status => 0x1637,
                ReportedValue::Mode => MODE_CSP.into(),
                ReportedValue::Position => position,
                _ => 0,
            })
        });
        Ok(frame)
    }
}

fn node(number: usize) -> NodeId {
    NodeId::new(number as u8).expect("1 to 8")
}

fn drive(place: usize) -> DeviceConfig {
    DeviceConfig::plain_drive(place, node(place + 1), Monitoring::Heartbeat { time_ns: 100_000_000 })
}

fn bus(drives: usize) -> BusConfig {
    BusConfig {
        name: "bus0".to_owned(),
        transport: "socketcan:can0".parse().expect("an address"),
        bit_rate: Some(1_000_000),
        serial_baudrate: None,
        cycle_ns: 1_000_000,
        sync_overflow: None,
        sdo_timeout_ns: 500_000_000,
        time_ns: None,
        master: None,
        devices: (0..drives).map(drive).collect(),
    }
}

fn exchange(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("exchange");
    for drives in [1, 2, 8] {
        let config = bus(drives);
        let answers = config.devices.iter().flat_map(|drive| drive.layout.told.iter().map(PdoImage::of)).collect();
        let mut backend = CanBackend::started(&config, Box::new(Loopback { answers, next: 0, position: 0 }));
        let mut inputs = Inputs { drive: vec![DriveInput::default(); drives], ..Inputs::default() };
        let mut outputs = Outputs { drive: vec![DriveOutput::default(); drives], ..Outputs::default() };
        outputs.drive.iter_mut().for_each(|drive| drive.control = 0x0F);
        let mut cycle = 0;
        let mut once = || {
            inputs.begin(cycle, 0);
            backend.read(&mut inputs);
            for (output, input) in outputs.drive.iter_mut().zip(&inputs.drive) {
                output.position = input.count + 10;
            }
            backend.write(&outputs);
            cycle += 1;
            inputs.drive.iter().all(|drive| drive.online && drive.fresh)
        };
        // Only an exchange in which all drives take part is measured.
        once();
        assert!(once(), "all drives answer");
        group.throughput(Throughput::Elements(drives as u64));
        group.bench_function(BenchmarkId::new("drives", drives), |bencher| bencher.iter(&mut once));
    }
    group.finish();
}

fn pdo(criterion: &mut Criterion) {
    let drive = drive(0);
    let asked = drive.layout.asked.first().map(PdoImage::of).expect("RPDO 1");
    let mut told = drive.layout.told.first().map(PdoImage::of).expect("TPDO 1");
    let value = |word| match word {
        CommandedValue::Control => 0x0F,
        CommandedValue::Position | CommandedValue::Velocity => black_box(-123_456),
        CommandedValue::Mode => 8,
        _ => 0,
    };
    criterion.bench_function("pdo/encode", |bencher| bencher.iter(|| asked.frame(value)));
    let frame = told.frame(|_| black_box(-77));
    criterion.bench_function("pdo/decode", |bencher| {
        bencher.iter(|| {
            assert!(told.update(black_box(&frame)));
            told.values().map(|(_, value)| value).sum::<i64>()
        });
    });
    criterion.bench_function("bits of a frame", |bencher| bencher.iter(|| load::bits(black_box(&frame))));
}

fn sdo(criterion: &mut Criterion) {
    let node = node(1);
    let mut client = Client::new(node.sdo_request(), node.sdo_response(), 500_000_000);
    let object = Object { index: 0x1000, sub: 0 };
    let answer = Frame::of(node.sdo_response(), [0x43, 0, 0x10, 0, 0x92, 1, 2, 0]);
    let mut room = Some(Vec::with_capacity(256));
    criterion.bench_function("sdo/number", |bencher| {
        bencher.iter(|| {
            let mut data = room.take().unwrap_or_default();
            data.clear();
            client.upload(object, data, false, 0).expect("one at a time");
            black_box(client.next_frame());
            let done = client.receive(black_box(&answer), 0).expect("all that there is");
            assert!(done.result.is_ok());
            room = Some(done.data);
        });
    });
}

criterion_group!(benches, exchange, pdo, sdo);
criterion_main!(benches);
