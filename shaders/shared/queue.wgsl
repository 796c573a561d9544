// Queues of beams. Words 0–2 are the workgroups of the dispatch that empties the queue (at most 65 535 along x; the pass loops over the
// rest), word 3 is the count, then come the items.

const QUEUE_COUNT: u32 = 3u;
const QUEUE_HEAD: u32 = 4u;
const MOST_GROUPS: u32 = 65535u;

// The split queue's head is longer: word 3 + l counts the parts of level l (0: whole beams). Behind it lie the beams (a word each), then
// two lists of parts (beam and path, two words each) that the levels use alternately, and a list of wide footprints.
const SPLIT_HEAD: u32 = 16u;
// In that head: the count of wide footprints, and the dispatch over them.
const SPLIT_WIDE_COUNT: u32 = 12u;
const SPLIT_WIDE_GROUPS: u32 = 13u;
// Workgroups that share a wide footprint.
const SPLIT_WIDE_SHARE: u32 = 16u;
// Queued beams or parts that a workgroup of the split pass takes.
const SPLIT_GROUP: u32 = 64u;
