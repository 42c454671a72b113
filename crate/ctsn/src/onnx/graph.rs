//! Puts an ONNX graph together, node by node. Values are named by the stage of the network they belong to.

use super::message::{self, Attribute, Dimension, FLOAT, INT64, Node, Shape, Tensor, Type, ValueInfo};
use std::ops::Range;

/// A result or constant of the graph, by its name.
#[derive(Clone, Debug)]
pub struct Value(String);

/// A graph in the making.
#[derive(Default)]
pub struct Graph {
    stage: String,
    message: message::Graph,
}

impl Graph {
    /// A graph under a name.
    pub fn new(name: &str) -> Self {
        Self { message: message::Graph { name: name.to_owned(), ..Default::default() }, ..Default::default() }
    }

    /// What follows belongs to the stage `name`.
    pub fn stage(&mut self, name: &str) {
        self.stage = name.to_owned();
    }

    /// An input of floats of this shape, and what a reader should know of it.
    pub fn input(&mut self, name: &str, shape: &[usize], meaning: &str) -> Value {
        self.message.input.push(info(name, shape, meaning));
        Value(name.to_owned())
    }

    /// Makes `value` an output of floats of this shape.
    pub fn output(&mut self, name: &str, shape: &[usize], meaning: &str, value: &Value) {
        self.message.output.push(info(name, shape, meaning));
        let (input, output) = (vec![value.0.clone()], vec![name.to_owned()]);
        let op_type = "Identity".to_owned();
        self.message.node.push(Node { input, output, name: name.to_owned(), op_type, attribute: Vec::new() });
    }

    /// The graph, complete.
    pub fn finish(self) -> message::Graph {
        self.message
    }

    /// A constant of floats.
    pub fn floats(&mut self, shape: &[usize], values: &[f32]) -> Value {
        self.constant(shape, FLOAT, values.iter().flat_map(|value| value.to_le_bytes()).collect())
    }

    /// A constant of indices.
    pub fn indices(&mut self, shape: &[usize], values: impl Iterator<Item = usize>) -> Value {
        self.constant(shape, INT64, values.flat_map(|value| (value as i64).to_le_bytes()).collect())
    }

    fn constant(&mut self, shape: &[usize], data_type: i32, raw_data: Vec<u8>) -> Value {
        let name = format!("{}/constant.{}", self.stage, self.message.initializer.len());
        let dims = shape.iter().map(|length| *length as i64).collect();
        self.message.initializer.push(Tensor { dims, data_type, name: name.clone(), raw_data });
        Value(name)
    }

    /// The result of an operator without attributes.
    pub fn node(&mut self, operator: &str, inputs: &[&Value]) -> Value {
        self.node_with(operator, inputs, Vec::new())
    }

    /// The result of an operator with attributes.
    pub fn node_with(&mut self, operator: &str, inputs: &[&Value], attribute: Vec<Attribute>) -> Value {
        let name = format!("{}/{operator}.{}", self.stage, self.message.node.len());
        let input = inputs.iter().map(|value| value.0.clone()).collect();
        let (output, op_type) = (vec![name.clone()], operator.to_owned());
        self.message.node.push(Node { input, output, name: name.clone(), op_type, attribute });
        Value(name)
    }

    /// The same numbers in another shape.
    pub fn reshape(&mut self, x: &Value, shape: &[usize]) -> Value {
        let shape = self.indices(&[shape.len()], shape.iter().copied());
        self.node("Reshape", &[x, &shape])
    }

    /// Sum over an axis, which is dropped.
    pub fn sum(&mut self, x: &Value, axis: usize) -> Value {
        let axes = self.indices(&[1], [axis].into_iter());
        self.node_with("ReduceSum", &[x, &axes], vec![integer("keepdims", 0)])
    }

    /// Mean over an axis, which stays with length 1.
    pub fn mean(&mut self, x: &Value, axis: i64) -> Value {
        self.node_with("ReduceMean", &[x], vec![integers("axes", &[axis])])
    }

    /// Part of an axis.
    pub fn slice(&mut self, x: &Value, axis: usize, range: Range<usize>) -> Value {
        let [start, end, axis] = [range.start, range.end, axis].map(|at| self.indices(&[1], [at].into_iter()));
        self.node("Slice", &[x, &start, &end, &axis])
    }

    /// Values one after the other along an axis.
    pub fn concat(&mut self, parts: &[&Value], axis: i64) -> Value {
        self.node_with("Concat", parts, vec![integer("axis", axis)])
    }

    /// Axes in another order.
    pub fn transpose(&mut self, x: &Value, order: &[i64]) -> Value {
        self.node_with("Transpose", &[x], vec![integers("perm", order)])
    }

    /// Rows of `x` by their indices.
    pub fn gather(&mut self, x: &Value, rows: &Value) -> Value {
        self.node_with("Gather", &[x, rows], vec![integer("axis", 0)])
    }
}

/// An attribute of one integer.
pub fn integer(name: &str, value: i64) -> Attribute {
    Attribute { name: name.to_owned(), i: Some(value), ints: Vec::new(), kind: 2 }
}

/// An attribute of several.
fn integers(name: &str, values: &[i64]) -> Attribute {
    Attribute { name: name.to_owned(), i: None, ints: values.to_vec(), kind: 7 }
}

fn info(name: &str, shape: &[usize], meaning: &str) -> ValueInfo {
    let dim = shape.iter().map(|length| Dimension { dim_value: Some(*length as i64) }).collect();
    let tensor = message::TensorType { elem_type: FLOAT, shape: Some(Shape { dim }) };
    ValueInfo { name: name.to_owned(), kind: Some(Type { tensor_type: Some(tensor) }), doc_string: meaning.to_owned() }
}
