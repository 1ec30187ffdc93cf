//! The particle set: N particles of C columns, in blocks of [`BLOCK`] particles.
//!
//! Storage is `[block][column][lane]`: a block is contiguous, so that a thread takes whole blocks,
//! and inside it every column is a contiguous slice, so that SIMD lanes are neighbouring particles.
//! The last block is padded; padding is never seen from outside.

use crate::threads::parallel;

/// Particles in a block. Part of the determinism contract: never the number of threads.
///
/// A model that works on several particles side by side has idle lanes at the end of a block: of 64
/// particles, contact steps would take 2.5 % longer. Of more than 128 few filters would have one
/// for each thread.
pub const BLOCK: usize = 128;

/// Threads that can do something for a filter of so many particles: one for every block.
///
/// ```
/// assert_eq!(stickslip_filter::useful_threads(500), 4);
/// ```
pub fn useful_threads(particles: usize) -> usize {
    particles.div_ceil(BLOCK)
}

/// N particles of C columns each.
#[derive(Clone, Debug)]
pub struct ParticleSet {
    particles: usize,
    columns: usize,
    data: Vec<f64>,
    /// The other half of the double buffer: resampled particles are written here.
    spare: Vec<f64>,
}

impl ParticleSet {
    /// `particles` x `columns` zeros. Both are at least 1.
    pub fn zeros(particles: usize, columns: usize) -> Self {
        assert!(
            particles > 0 && columns > 0,
            "a particle set of {particles} particles x {columns} columns is empty"
        );
        assert!(
            u32::try_from(particles).is_ok(),
            "particles are numbered in u32"
        );
        let data = vec![0.0; particles.div_ceil(BLOCK) * BLOCK * columns];
        ParticleSet {
            particles,
            columns,
            spare: data.clone(),
            data,
        }
    }

    /// Appends `count` columns of zeros; the values of the others stay.
    pub fn append_columns(&mut self, count: usize) {
        if count == 0 {
            return;
        }
        let mut grown = Self::zeros(self.particles, self.columns + count);
        let (stride, grown_stride) = (self.columns * BLOCK, grown.columns * BLOCK);
        let blocks = grown.data.chunks_exact_mut(grown_stride);
        for (to, from) in blocks.zip(self.data.chunks_exact(stride)) {
            to[..stride].copy_from_slice(from);
        }
        *self = grown;
    }

    /// A set of as many particles as there are `ancestors`, particle i a copy of `ancestors[i]`.
    ///
    /// # Panics
    /// If there are no ancestors, or one is not in the set.
    #[must_use]
    pub fn gathered(&self, ancestors: &[u32]) -> Self {
        let mut gathered = Self::zeros(ancestors.len(), self.columns);
        let blocks = gathered.data.chunks_exact_mut(self.columns * BLOCK);
        for (block, ancestors) in blocks.zip(ancestors.chunks(BLOCK)) {
            gather_block(&self.data, ancestors, block);
        }
        gathered
    }

    /// The number N of particles.
    #[expect(clippy::len_without_is_empty, reason = "a particle set is never empty")]
    pub fn len(&self) -> usize {
        self.particles
    }

    /// The number C of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// The number of blocks, ceil(N / BLOCK).
    pub fn block_count(&self) -> usize {
        self.particles.div_ceil(BLOCK)
    }

    /// Block `index`.
    pub fn block(&self, index: usize) -> Block<'_> {
        let stride = self.columns * BLOCK;
        Block {
            data: &self.data[index * stride..][..stride],
            span: Span::of(index, self.particles),
        }
    }

    /// The blocks in order.
    pub fn blocks(&self) -> impl ExactSizeIterator<Item = Block<'_>> {
        (0..self.block_count()).map(|index| self.block(index))
    }

    /// Column `column` of all particles in order, N values.
    pub fn column(&self, column: usize) -> impl Iterator<Item = f64> + '_ {
        self.blocks()
            .flat_map(move |block| block.column(column).iter().copied())
    }

    /// The value of one particle in one column.
    pub fn value(&self, particle: usize, column: usize) -> f64 {
        assert!(
            particle < self.particles,
            "particle {particle} of {}",
            self.particles
        );
        self.block(particle / BLOCK).column(column)[particle % BLOCK]
    }

    /// Runs `body` on every block, in parallel if the pool has threads.
    #[track_caller]
    pub fn for_each_block(&mut self, body: impl Fn(&mut BlockMut<'_>) + Sync) {
        self.advance(None, 0..self.block_count(), |block, _| body(block));
    }

    /// Runs `body(block, its item of with)` on every block, in parallel if the pool has threads.
    ///
    /// With `ancestors`, particle i first becomes a copy of particle `ancestors[i]`; each block is
    /// copied just before `body` runs on it, while it is in the cache.
    #[track_caller]
    pub fn advance<T>(
        &mut self,
        ancestors: Option<&[u32]>,
        with: impl ExactSizeIterator<Item = T> + DoubleEndedIterator + Send,
        body: impl Fn(&mut BlockMut<'_>, T) + Sync,
    ) {
        assert_eq!(with.len(), self.block_count(), "an item for every block");
        let (particles, stride) = (self.particles, self.columns * BLOCK);
        let Some(ancestors) = ancestors else {
            let blocks = self.data.chunks_mut(stride).zip(with).enumerate();
            return parallel::for_each(blocks, |(index, (data, item))| {
                let span = Span::of(index, particles);
                body(&mut BlockMut { data, span }, item);
            });
        };
        assert_eq!(ancestors.len(), particles);
        let (source, blocks) = (&self.data, self.spare.chunks_mut(stride));
        parallel::for_each(blocks.zip(with).enumerate(), |(index, (data, item))| {
            let span = Span::of(index, particles);
            gather_block(source, &ancestors[span.range()], data);
            body(&mut BlockMut { data, span }, item);
        });
        std::mem::swap(&mut self.data, &mut self.spare);
    }

    /// Runs `body(block, its item of with)` on every block, in parallel if the pool has threads.
    #[track_caller]
    pub fn visit<T>(
        &self,
        with: impl ExactSizeIterator<Item = T> + DoubleEndedIterator + Send,
        body: impl Fn(&Block<'_>, T) + Sync,
    ) {
        assert_eq!(with.len(), self.block_count(), "an item for every block");
        parallel::for_each(with.enumerate(), |(index, item)| {
            body(&self.block(index), item)
        });
    }

    /// `map` of every block, combined over a fixed tree: the same bits on any number of threads.
    pub fn reduce<A: Send>(
        &self,
        map: impl Fn(&Block<'_>) -> A + Sync,
        combine: impl Fn(A, A) -> A + Sync,
    ) -> A {
        parallel::tree_reduce(
            0..self.block_count(),
            &|index| map(&self.block(index)),
            &combine,
        )
    }
}

fn gather_block(source: &[f64], ancestors: &[u32], target: &mut [f64]) {
    let stride = target.len();
    for (column, target) in target.chunks_exact_mut(BLOCK).enumerate() {
        for (value, &ancestor) in target.iter_mut().zip(ancestors) {
            let (block, lane) = (ancestor as usize / BLOCK, ancestor as usize % BLOCK);
            *value = source[block * stride + column * BLOCK + lane];
        }
    }
}

/// Particles of a block: the first one and their number.
#[derive(Clone, Copy, Debug)]
struct Span {
    first: usize,
    len: usize,
}

impl Span {
    fn of(block: usize, particles: usize) -> Self {
        let first = block * BLOCK;
        Span {
            first,
            len: BLOCK.min(particles - first),
        }
    }

    fn range(self) -> std::ops::Range<usize> {
        self.first..self.first + self.len
    }
}

/// Up to [`BLOCK`] neighbouring particles, read-only.
#[derive(Clone, Copy, Debug)]
pub struct Block<'a> {
    data: &'a [f64],
    span: Span,
}

#[expect(clippy::len_without_is_empty, reason = "a block is never empty")]
impl<'a> Block<'a> {
    /// The number of particles, in 1..=BLOCK; every column slice has this length.
    #[inline]
    pub fn len(&self) -> usize {
        self.span.len
    }

    /// The index of the first particle in its set.
    #[inline]
    pub fn first_particle(&self) -> u32 {
        self.span.first as u32
    }

    /// The indices of the block's particles in their set.
    pub fn range(&self) -> std::ops::Range<usize> {
        self.span.range()
    }

    /// One column.
    #[inline]
    pub fn column(&self, column: usize) -> &'a [f64] {
        &self.data[column * BLOCK..][..self.span.len]
    }
}

/// Up to [`BLOCK`] neighbouring particles, mutable.
#[derive(Debug)]
pub struct BlockMut<'a> {
    data: &'a mut [f64],
    span: Span,
}

#[expect(clippy::len_without_is_empty, reason = "a block is never empty")]
impl BlockMut<'_> {
    /// The number of particles, in 1..=BLOCK; every column slice has this length.
    #[inline]
    pub fn len(&self) -> usize {
        self.span.len
    }

    /// The index of the first particle in its set.
    #[inline]
    pub fn first_particle(&self) -> u32 {
        self.span.first as u32
    }

    /// (lane, index in the set) of the block's particles; the index is the random streams'
    /// `particle`.
    #[inline]
    pub fn particles(&self) -> impl ExactSizeIterator<Item = (usize, u32)> + use<> {
        let first = self.first_particle();
        (0..self.span.len).map(move |lane| (lane, first + lane as u32))
    }

    /// The block, read-only.
    #[inline]
    pub fn as_block(&self) -> Block<'_> {
        Block {
            data: self.data,
            span: self.span,
        }
    }

    /// One column.
    #[inline]
    pub fn column(&self, column: usize) -> &[f64] {
        &self.data[column * BLOCK..][..self.span.len]
    }

    /// One column, mutable.
    #[inline]
    pub fn column_mut(&mut self, column: usize) -> &mut [f64] {
        &mut self.data[column * BLOCK..][..self.span.len]
    }

    /// Several different columns, mutable at the same time.
    ///
    /// # Panics
    /// If a column is named twice or does not exist.
    pub fn columns_mut<const K: usize>(&mut self, columns: [usize; K]) -> [&mut [f64]; K] {
        let len = self.span.len;
        match self
            .data
            .get_disjoint_mut(columns.map(|c| c * BLOCK..c * BLOCK + len))
        {
            Ok(slices) => slices,
            Err(error) => panic!("columns {columns:?}: {error}"),
        }
    }

    /// All columns in order, mutable.
    pub fn all_columns_mut(&mut self) -> impl ExactSizeIterator<Item = &mut [f64]> {
        let len = self.span.len;
        self.data
            .chunks_exact_mut(BLOCK)
            .map(move |column| &mut column[..len])
    }
}
