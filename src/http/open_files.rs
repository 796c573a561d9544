//! The limit of open files, and how many connections it leaves room for.

/// Files that connections leave free: those of the GPU driver, of a second device while a lost one is replaced, of shaders and
/// caches.
#[cfg(unix)]
const RESERVED: u64 = 128;

/// The number of connections, at most `wanted`, that the limit of open files leaves room for. The limit is raised as far as needed
/// and allowed.
#[cfg(unix)]
pub(super) fn connections_within_limit(wanted: u32) -> u32 {
    match rlimit::increase_nofile_limit(u64::from(wanted) + RESERVED) {
        Ok(files) => {
            let most = wanted.min(room(files));
            if most < wanted {
                tracing::warn!(
                    open_files = files,
                    wanted,
                    most,
                    "the limit of open files lowers the number of connections"
                );
            }
            most
        }
        Err(error) => {
            tracing::warn!(%error, "the limit of open files is not known");
            wanted
        }
    }
}

/// Sockets do not count as files here.
#[cfg(not(unix))]
pub(super) fn connections_within_limit(wanted: u32) -> u32 {
    wanted
}

/// Connections that a limit of open files leaves room for; where the limit is very low, a quarter of it.
#[cfg(unix)]
fn room(files: u64) -> u32 {
    let room = files.saturating_sub(RESERVED).max(files / 4).max(1);
    u32::try_from(room).unwrap_or(u32::MAX)
}
