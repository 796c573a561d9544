//! Writes files so that nobody ever sees half of one, where the file system allows it.
//!
//! A file is written under a temporary name beside its target, synced, and renamed over the target (`pending`). The target is the file
//! that the path leads to: a symbolic link stays a link (`target`). An existing file keeps its mode. Where a renamed file would break
//! something or renaming is impossible, the file is written in place, which is not atomic: files with several hard links or another
//! owner or group, files that are mounted alone, files in a folder without write permission, files whose mode cannot be set. Devices and pipes are written straight
//! through.
//!
//! A process that is killed leaves its temporary file. The next one that writes the same file removes it (`temporary`): a temporary file
//! is locked while it is written, so one that can be locked is left over.

mod pending;
mod target;
mod temporary;

pub use pending::{Pending, check, write};
pub use target::{is_open_file, is_same_file, is_stdout, target_of};
pub use temporary::clear_leftovers;
