//! Ranges of one buffer, handed out first-fit.

/// What a frame needs at once cannot fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{things} of {needed_bytes} bytes are needed at once, the budget is {budget_bytes} bytes")]
pub struct ArenaError {
    /// Name of what is kept.
    pub things: &'static str,
    /// Bytes needed at once.
    pub needed_bytes: u64,
    /// The budget.
    pub budget_bytes: u64,
}

/// Free ranges, sorted by offset, never touching each other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Arena {
    size: u64,
    free: Vec<(u64, u64)>,
}

impl Arena {
    /// An empty arena of `size` bytes.
    pub fn new(size: u64) -> Self {
        Self {
            size,
            free: vec![(0, size)],
        }
    }

    /// The offset of a range of `bytes`, or `None` when no free range is long enough.
    pub fn allocate(&mut self, bytes: u64) -> Option<u64> {
        let index = self.free.iter().position(|&(_, length)| length >= bytes)?;
        let (offset, length) = self.free[index];
        if length == bytes {
            self.free.remove(index);
        } else {
            self.free[index] = (offset + bytes, length - bytes);
        }
        Some(offset)
    }

    /// Frees a range and merges it with its free neighbours.
    pub fn free(&mut self, offset: u64, bytes: u64) {
        let index = self.free.partition_point(|&(start, _)| start < offset);
        self.free.insert(index, (offset, bytes));
        if index + 1 < self.free.len() && offset + bytes == self.free[index + 1].0 {
            self.free[index].1 += self.free[index + 1].1;
            self.free.remove(index + 1);
        }
        if index > 0 && self.free[index - 1].0 + self.free[index - 1].1 == offset {
            self.free[index - 1].1 += self.free[index].1;
            self.free.remove(index);
        }
    }

    /// Frees everything.
    pub fn clear(&mut self) {
        self.free = vec![(0, self.size)];
    }

    /// Number of free bytes, and number of free ranges.
    pub fn free_bytes(&self) -> (u64, usize) {
        (
            self.free.iter().map(|&(_, length)| length).sum(),
            self.free.len(),
        )
    }
}
