//! Queues: buffers whose head holds the size of the dispatch that empties them. Also the limit on workgroups of a dispatch.

use super::Groups;

/// Words at the head of a queue: the workgroups of the dispatch that empties it, and the count.
pub const QUEUE_HEAD_WORDS: u64 = 4;
/// The head of an empty queue.
pub const EMPTY_QUEUE: [u32; QUEUE_HEAD_WORDS as usize] = [0, 1, 1, 0];
/// Most workgroups of a dispatch along one axis.
pub const MOST_GROUPS: u32 = 65_535;
/// Workgroups that share one wide footprint.
pub const WIDE_GROUPS: u32 = 16;

/// A dispatch of at least `groups` workgroups. If they do not fit one axis, they are arranged in rows of equal length; shaders skip the
/// surplus at the end.
pub fn in_columns(groups: u32) -> Groups {
    let rows = groups.div_ceil(MOST_GROUPS).max(1);
    Groups::Direct([groups.div_ceil(rows).max(1), rows, 1])
}
