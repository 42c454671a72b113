//! Symmetric block-sparse matrix with 3×3 blocks and its sparse Cholesky factorisation (faer, AMD ordering).
//! Body contact, friction and pins only touch diagonal blocks, so one symbolic analysis serves until cloth meets cloth.

use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::cholesky::{LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};
use glam::{DMat3, DVec3};

use crate::{Error, Result};

/// `a bᵀ`.
pub(super) fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// Where a 3×3 block lies in the values: element (u, v) at `start + stride v - v(v+1)/2 + u`.
/// The columns of a block column shorten by one each, because only the lower triangle is stored.
#[derive(Clone, Copy, Debug)]
pub(super) struct Address {
    start: u32,
    stride: u32,
}

/// Sparsity pattern of the lower triangle, column by column, and its symbolic factorisation.
#[derive(Debug)]
pub(super) struct Pattern {
    columns: Vec<usize>,
    rows: Vec<usize>,
    /// Per block column: the block rows at or below the diagonal, ascending.
    blocks: Vec<Vec<usize>>,
    symbolic: SymbolicCholesky<usize>,
}

impl Pattern {
    /// Pattern of `n` block rows in which the vertices of every clique couple.
    pub fn new<'a>(n: usize, cliques: impl Iterator<Item = &'a [usize]>) -> Result<Self> {
        let mut blocks: Vec<Vec<usize>> = (0..n).map(|i| vec![i]).collect();
        for clique in cliques {
            for &column in clique {
                blocks[column].extend(clique.iter().filter(|&&row| row > column));
            }
        }
        for column in &mut blocks {
            column.sort_unstable();
            column.dedup();
        }
        let (mut columns, mut rows) = (vec![0], Vec::new());
        for column in &blocks {
            for v in 0..3 {
                rows.extend(column.iter().flat_map(|row| 3 * row..3 * row + 3).skip(v));
                columns.push(rows.len());
            }
        }
        let matrix = SymbolicSparseColMatRef::new_checked(3 * n, 3 * n, &columns, None, &rows);
        let symbolic = factorize_symbolic_cholesky(matrix, Side::Lower, SymmetricOrdering::Amd, Default::default())
            .map_err(|error| Error::Simulation(format!("symbolic factorisation of {n} vertices: {error}")))?;
        Ok(Self { columns, rows, blocks, symbolic })
    }

    /// Address of block (i, j), either order; the pair must be in the pattern.
    pub fn address(&self, i: usize, j: usize) -> Address {
        let (row, column) = (i.max(j), i.min(j));
        let blocks = &self.blocks[column];
        let place = blocks.partition_point(|&other| other < row);
        debug_assert_eq!(blocks.get(place), Some(&row));
        Address { start: (self.columns[3 * column] + 3 * place) as u32, stride: 3 * blocks.len() as u32 }
    }

    /// Whether all vertices of a group couple.
    pub fn holds(&self, group: &[usize]) -> bool {
        let couple = |&i: &usize, &j: &usize| self.blocks[i.min(j)].binary_search(&i.max(j)).is_ok();
        group.iter().all(|i| group.iter().all(|j| couple(i, j)))
    }

    /// Number of stored values.
    pub fn len(&self) -> usize {
        self.rows.len()
    }
}

/// Numeric values of a matrix with a [`Pattern`], its factor and the memory to compute it.
pub(super) struct Matrix {
    pattern: Arc<Pattern>,
    values: Vec<f64>,
    factor: Vec<f64>,
    factor_scratch: MemBuffer,
    solve_scratch: MemBuffer,
}

impl Matrix {
    /// The zero matrix.
    pub fn new(pattern: Arc<Pattern>) -> Self {
        let symbolic = &pattern.symbolic;
        Self {
            values: vec![0.0; pattern.len()],
            factor: vec![0.0; symbolic.len_val()],
            factor_scratch: MemBuffer::new(symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default())),
            solve_scratch: MemBuffer::new(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq)),
            pattern,
        }
    }

    /// Sets every value to zero.
    pub fn clear(&mut self) {
        self.values.fill(0.0);
    }

    /// Adds `block`, given as (row vertex, column vertex) with row > column, or a symmetric diagonal block.
    pub fn add(&mut self, Address { start, stride }: Address, block: DMat3, diagonal: bool) {
        let (start, stride) = (start as usize, stride as usize);
        for v in 0..3 {
            let offset = start + stride * v - v * (v + 1) / 2;
            let column = block.col(v);
            for u in if diagonal { v } else { 0 }..3 {
                self.values[offset + u] += column[u];
            }
        }
    }

    /// Factorises the values; false when the matrix is not positive definite.
    pub fn factorise(&mut self) -> bool {
        let Pattern { columns, rows, symbolic, .. } = &*self.pattern;
        let size = columns.len() - 1;
        let structure = SymbolicSparseColMatRef::new_checked(size, size, columns, None, rows);
        let matrix = SparseColMatRef::new(structure, self.values.as_slice());
        let stack = MemStack::new(&mut self.factor_scratch);
        let regular = LltRegularization::default();
        let params = Default::default();
        symbolic
            .factorize_numeric_llt::<f64>(&mut self.factor, matrix, Side::Lower, regular, Par::Seq, stack, params)
            .is_ok()
    }

    /// Solves with the last factor: `-gradient` [n] -> step [n].
    pub fn step(&mut self, gradient: &[DVec3]) -> Vec<DVec3> {
        let mut rhs: Vec<f64> = gradient.iter().flat_map(|g| [-g.x, -g.y, -g.z]).collect();
        let size = rhs.len();
        let stack = MemStack::new(&mut self.solve_scratch);
        let matrix = MatMut::from_column_major_slice_mut(&mut rhs, size, 1);
        let factor = LltRef::new(&self.pattern.symbolic, &self.factor);
        factor.solve_in_place_with_conj(Conj::No, matrix, Par::Seq, stack);
        rhs.chunks_exact(3).map(DVec3::from_slice).collect()
    }
}
