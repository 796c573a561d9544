// Queues of beams. Words 0–2 are the workgroups of the dispatch that empties the queue (at most 65 535 along x; the pass
// strides over the rest), word 3 the count, then the items.

const QUEUE_COUNT: u32 = 3u;
const QUEUE_HEAD: u32 = 4u;
const MOST_GROUPS: u32 = 65535u;
