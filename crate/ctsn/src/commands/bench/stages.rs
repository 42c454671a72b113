//! Every operation of a prediction beside what its flops and bytes would take at the machine's limits, one thread.

use anyhow::Result;
use ctsn_core::cpu::{Cpu, Level, limits};
use ctsn_core::device::Device;
use ctsn_core::model::HostModel;
use ctsn_core::network::{Activations, predict};
use ctsn_core::operation::Operation;
use ctsn_core::{Confidence, Streams};
use std::cell::Cell;
use std::hint::black_box;
use std::time::Instant;

/// An operation of the pass.
struct Row {
    name: &'static str,
    flops: f64,
    /// When every operand is moved once.
    bytes: f64,
    /// Seconds, one for each prediction.
    times: Vec<f64>,
}

/// The CPU, with a watch in its hand.
struct Watched {
    cpu: Cpu,
    rows: Vec<Row>,
    /// Operations of this pass so far.
    next: usize,
}

impl Device for Watched {
    type Buffer = Vec<f32>;
    type Indices = Vec<u32>;

    fn run(&mut self, mut operation: Operation<&Vec<f32>, &mut Vec<f32>, &Vec<u32>>) {
        if self.next == self.rows.len() {
            let name = operation.name();
            let numbers = Cell::new(0);
            let count = |length: usize| {
                numbers.set(numbers.get() + length);
                length
            };
            let lengths = operation.lend().map(|it| count(it.len()), |it| count(it.len()), |it| count(it.len()));
            let (flops, bytes) = (lengths.flops() as f64, 4.0 * numbers.get() as f64);
            self.rows.push(Row { name, flops, bytes, times: Vec::new() });
        }
        let start = Instant::now();
        self.cpu.run(operation);
        self.rows[self.next].times.push(start.elapsed().as_secs_f64());
        self.next += 1;
    }
}

/// What one thread of this machine can do at its best.
struct Limits {
    /// Floating-point operations a second.
    flops: f64,
    /// Bytes read a second from memory that no cache holds.
    bytes: f64,
}

impl Limits {
    /// The best of many short measurements: between them others may have had the processor.
    fn measure(level: Level) -> Self {
        let best = |count: f64, run: &dyn Fn()| {
            let seconds = |_| {
                let start = Instant::now();
                run();
                start.elapsed().as_secs_f64()
            };
            count / (0..40).map(seconds).fold(f64::INFINITY, f64::min)
        };
        let (rounds, far) = (1_000_000, vec![1.0; 1 << 27]);
        let (count, _) = limits::multiply_adds(level, rounds, 0.5);
        let flops = best(count, &|| {
            black_box(limits::multiply_adds(level, rounds, black_box(0.5)));
        });
        let bytes = best(4.0 * far.len() as f64, &|| {
            black_box(limits::read(level, black_box(&far)));
        });
        Self { flops, bytes }
    }
}

/// Predicts `poses` in turn, `runs` times, by the whole network, by the skeleton stream with the repair and without:
/// prints a row for each operation in the order of the pass.
pub fn run(model: &HostModel, poses: &[&[f32]], runs: usize) -> Result<()> {
    let limits = Limits::measure(Level::new());
    let (flops, bytes) = (limits.flops / 1e9, limits.bytes / 1e9);
    println!("one thread can do {flops:.0} Gflop/s, and read {bytes:.1} GB/s from memory; medians of {runs}");
    println!(
        "limit: what the flops or the bytes take at that speed, whichever takes longer. Bytes that a cache still holds"
    );
    println!("come faster than from memory: shares above 100 % are possible");
    let bare = HostModel { body: None, ..model.clone() };
    let passes = [
        ("the whole network", model, Streams::Both),
        ("coarse: the skeleton stream and the repair", model, Streams::Skeleton),
        ("coarse, of a model without a body", &bare, Streams::Skeleton),
    ];
    for (name, model, streams) in passes {
        println!("\n{name}");
        print(&time(model, streams, poses, runs)?, &limits);
    }
    Ok(())
}

/// The operations of one pass, timed in `runs` of them.
fn time(model: &HostModel, streams: Streams, poses: &[&[f32]], runs: usize) -> Result<Vec<Row>> {
    let mut room = Activations::new(model, |_, length| vec![0.0; length]);
    let mut device = Watched { cpu: Cpu::new(), rows: Vec::new(), next: 0 };
    let mut confidence = Confidence::new(model);
    for run in 0..runs {
        model.rig.read(poses[run % poses.len()], &mut room.joints)?;
        let share = confidence.as_mut().map_or(1.0, |confidence| confidence.of(&model.rig, &room.joints));
        (room.skeleton_share[0], room.mesh_share[0]) = (share, share);
        device.next = 0;
        predict(&mut device, model, streams, &mut room);
    }
    Ok(device.rows)
}

fn print(rows: &[Row], limits: &Limits) {
    let times: Vec<f64> = rows.iter().map(|row| super::median(&row.times)).collect();
    let whole: f64 = times.iter().sum();
    println!("operation         ms  of all      Mflop      MB   Gflop/s     GB/s    limit, ms   share of it");
    for (row, time) in rows.iter().zip(&times) {
        let [by_flops, by_bytes] = [row.flops / limits.flops, row.bytes / limits.bytes];
        println!(
            "{:<10} {:>9.3} {:>6.1} % {:>10.2} {:>7.2} {:>9.1} {:>8.1} {:>9.3} {} {:>8.0} %",
            row.name,
            1e3 * time,
            100.0 * time / whole,
            row.flops / 1e6,
            row.bytes / 1e6,
            row.flops / time / 1e9,
            row.bytes / time / 1e9,
            1e3 * by_flops.max(by_bytes),
            if by_flops > by_bytes { "flops" } else { "bytes" },
            100.0 * by_flops.max(by_bytes) / time,
        );
    }
    println!("all        {:>9.3}", 1e3 * whole);
}
