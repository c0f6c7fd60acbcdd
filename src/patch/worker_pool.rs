//! A step of all blocks, by several threads where the patch is large enough to gain.
//!
//! Blocks are dealt out in batches, and what the batches add up to is added in their order: numbers do not depend on
//! who did what. Threads end with the step, since a master may unload the FMU after it: starting them is all that a
//! step allocates. Patches that one thread does best start none.

use std::num::NonZero;
use std::sync::Mutex;
use std::thread;

use super::block::ElementBlock;
use super::block_contacts::{ElementRange, FaceMotion, StepSums};
use super::face::BLOCK;
use super::state::{Springs, SpringsMut};
use crate::element::ResampledLaw;
use crate::math::Number;

/// Most batches of a step.
const MAX_BATCHES: usize = 128;
/// Blocks of a batch, at least.
const MIN_BLOCKS: usize = 16;
/// Elements times substeps that are worth a thread: starting one is next to nothing beside them.
const WORTH_A_THREAD: f64 = 16384.0;

/// The workers of a patch, and the sums of their batches.
#[derive(Clone, Debug)]
pub(super) struct WorkerPool<T> {
    block: Box<ElementBlock<T>>,
    workers: Vec<Worker<T>>,
    sums: Vec<StepSums<T>>,
}

/// A worker. It has a law of its own, since intervals of a law are computed when they are first needed.
#[derive(Clone, Debug)]
struct Worker<T> {
    block: Box<ElementBlock<T>>,
    law: ResampledLaw,
}

/// Blocks that follow each other, and where their results go.
struct Batch<'a, T> {
    start: usize,
    count: usize,
    next: SpringsMut<'a>,
    sums: &'a mut StepSums<T>,
}

/// How many threads do steps of so many elements times substeps.
pub(super) fn threads(work: f64) -> usize {
    let threads = thread::available_parallelism().map_or(1, NonZero::get);
    threads.min((work / WORTH_A_THREAD) as usize)
}

impl<T: Number + Send + Sync> WorkerPool<T> {
    /// For steps of so many elements times substeps or more: as many as the processor serves at once and the steps are
    /// worth.
    pub(super) fn new(work: f64, law: &ResampledLaw) -> Self {
        Self::with_threads(threads(work), law)
    }

    /// One, or `threads` of them.
    // Not inlined, here and below: a step without derivatives then does without the stack of one with them.
    #[inline(never)]
    pub(super) fn with_threads(threads: usize, law: &ResampledLaw) -> Self {
        let worker = || Worker { block: Box::new(ElementBlock::new()), law: law.clone() };
        Self {
            block: Box::new(ElementBlock::new()),
            workers: (1..threads).map(|_| worker()).collect(),
            sums: vec![StepSums::zero(); MAX_BATCHES],
        }
    }

    /// Does `work` for every block of a step, from the springs in `springs` to those in `next`; returns the sums.
    #[inline(never)]
    pub(super) fn work(
        &mut self,
        step: &FaceMotion<'_, T>,
        law: &mut ResampledLaw,
        (springs, next): (&Springs, &mut Springs),
        work: impl Fn(&mut ElementBlock<T>, &mut ResampledLaw, &mut StepSums<T>) + Sync,
    ) -> StepSums<T> {
        let Self { block, workers, sums } = self;
        let range = step.elements();
        // Divide the blocks into batches of equal size.
        let size = range.count.div_ceil(MAX_BATCHES).next_multiple_of(BLOCK).max(MIN_BLOCKS * BLOCK);
        let batches = range.count.div_ceil(size);
        let sums = &mut sums[..batches];
        let queue = Mutex::new(batches_of(sums, next.all(), range.first + range.shift, range.count, size));
        // Every worker takes the next batch until none is left.
        let take = || queue.lock().ok().and_then(|mut queue| queue.next());
        let serve = |block: &mut ElementBlock<T>, law: &mut ResampledLaw| {
            while let Some(mut batch) = take() {
                batch.serve(range, springs, block, |block, sums| work(block, law, sums));
            }
        };
        // Start no more threads than there are batches beside this one's.
        let wanted = workers.len().min(batches.saturating_sub(1));
        if wanted == 0 {
            serve(block, law);
        } else {
            let serve = &serve;
            thread::scope(|scope| {
                for Worker { block, law: own } in &mut workers[..wanted] {
                    own.set_temperature(law.temperature());
                    // Those whom the system gives no thread are done without.
                    if thread::Builder::new().spawn_scoped(scope, move || serve(block, own)).is_err() {
                        break;
                    }
                }
                serve(block, law);
            });
        }
        // Add the batches up in their order, whoever did them.
        drop(queue);
        sums.iter().fold(StepSums::zero(), |mut all, batch| {
            all.add(batch);
            all
        })
    }
}

/// The batches of `count` elements, `size` of them each; the first element is at `first` in `next`.
fn batches_of<'a, T: Number>(
    sums: &'a mut [StepSums<T>],
    mut next: SpringsMut<'a>,
    first: isize,
    count: usize,
    size: usize,
) -> impl Iterator<Item = Batch<'a, T>> {
    sums.iter_mut().enumerate().map(move |(i, sums)| {
        let start = i * size;
        let count = size.min(count - start);
        let end = first + (start + count) as isize;
        Batch { start, count, next: next.split_off_to(end.max(0).unsigned_abs()), sums }
    })
}

impl<T: Number> Batch<'_, T> {
    fn serve(
        &mut self,
        range: ElementRange,
        springs: &Springs,
        block: &mut ElementBlock<T>,
        mut work: impl FnMut(&mut ElementBlock<T>, &mut StepSums<T>),
    ) {
        *self.sums = StepSums::zero();
        for start in (self.start..self.start + self.count).step_by(BLOCK) {
            let size = BLOCK.min(self.start + self.count - start);
            let index = range.first + start as isize;
            block.reset(start, size);
            springs.load(block, index, size);
            work(block, self.sums);
            self.next.store(block, index + range.shift, size);
        }
    }
}
