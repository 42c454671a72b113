//! What the mesh stream sees around each vertex of the coarse cloth. network.md §3.

use super::graph::{Graph, Value};
use super::order::Order;
use ctsn_core::cpu::network::surround::STRAIN;
use ctsn_core::model::surroundings::{AROUND, DIRECTIONS, INPUTS, STEPS};

/// Places, standardised [n, 3], potentials [n, 6], transforms of the vertices [3, 4, n] -> h⁰ [n, 54].
pub fn surround(graph: &mut Graph, order: &Order, around: &[u32], [places, potentials, blended]: [&Value; 3]) -> Value {
    let n = order.places.len();
    let linear = graph.slice(blended, 1, 0..3);
    let linear = graph.transpose(&linear, &[2, 0, 1]);
    let rows = order.vertices.iter().flat_map(|vertex| &around[vertex * AROUND..][..AROUND]);
    let around = graph.indices(&[n, AROUND], rows.map(|vertex| order.places[*vertex as usize]));
    let there = graph.gather(potentials, &around);
    let here = graph.reshape(potentials, &[n, 1, 6]);
    let way = graph.node("Sub", &[&there, &here]);
    let [now, rest] = [0..3, 3..6].map(|axes| graph.slice(&way, 2, axes));
    // Rows times a matrix: what its transposed does to columns.
    let turned = graph.node("MatMul", &[&now, &linear]);
    let strain = graph.node("Sub", &[&turned, &rest]);
    let factors: Vec<f32> = (0..AROUND).map(|a| 1.0 / (STRAIN * STEPS[a / DIRECTIONS] as f32)).collect();
    let factors = graph.floats(&[AROUND, 1], &factors);
    let seen = graph.node("Mul", &[&strain, &factors]);
    let seen = graph.reshape(&seen, &[n, INPUTS - 6]);
    let up = graph.slice(&linear, 1, 1..2);
    let up = graph.reshape(&up, &[n, 3]);
    graph.concat(&[places, &up, &seen], 1)
}
