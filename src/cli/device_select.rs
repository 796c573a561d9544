//! Keeps Mesa's device selection from printing errors in runs that succeed.
//!
//! Mesa's Vulkan layer `VK_LAYER_MESA_device_select` asks a Wayland display for its GPU. Where `XDG_RUNTIME_DIR` is no absolute path, as in
//! containers, libwayland prints `error: XDG_RUNTIME_DIR is invalid or not set in the environment.` to stderr. The Vulkan loader
//! switches the layer off for processes that start with `NODEVICE_SELECT` in their environment, and there is no other way to switch off
//! this layer alone. Where the user asks the layer for a device, it stays on and gets an `XDG_RUNTIME_DIR` without a display instead. A
//! process may not change its own environment safely, so the program replaces itself: same process, same arguments, one more variable.

/// Starts the program again with the layer off or quiet, if the layer would print an error. Returns if that is not needed or not possible.
///
/// The line still appears where `/proc` is missing, and where the loader was started with the program as its argument
/// (`ld.so caustica`).
pub(super) fn without_device_select() {
    #[cfg(target_os = "linux")]
    linux::without_device_select();
}

#[cfg(target_os = "linux")]
mod linux {
    use std::env::{args_os, current_exe, var_os};
    use std::fs::read_to_string;
    use std::os::unix::process::CommandExt;
    use std::path::{Path, PathBuf};
    use std::process::Command;

    /// Switches the layer off. Once it is set, the program does not start itself again.
    const OFF: &str = "NODEVICE_SELECT";
    /// What the user asks the layer for: where one of them is set, the layer stays on.
    const REQUESTS: [&str; 2] = ["MESA_VK_DEVICE_SELECT", "DRI_PRIME"];
    /// Folder in which the layer looks for a display. Only its path has to be absolute: in this one there is none.
    const DISPLAY: &str = "XDG_RUNTIME_DIR";
    const WITHOUT_DISPLAY: &str = "/nonexistent";

    pub(super) fn without_device_select() {
        let has_display = var_os(DISPLAY).is_some_and(|dir| Path::new(&dir).is_absolute());
        let is_set = |name: &&str| var_os(name).is_some();
        if has_display || is_set(&OFF) {
            return;
        }
        let (name, value) = if REQUESTS.iter().any(is_set) {
            (DISPLAY, WITHOUT_DISPLAY)
        } else {
            (OFF, "1")
        };
        let Some(program) = own_program() else {
            return;
        };
        let mut arguments = args_os();
        let mut command = Command::new(program);
        if let Some(own_name) = arguments.next() {
            command.arg0(own_name);
        }
        // Returns only if it fails.
        let _ = command.args(arguments).env(name, value).exec();
        ignore_closed_pipes();
    }

    /// The file of this program. `None` where `/proc` is missing, and where the process is another program that has loaded this one, as
    /// `/lib64/ld-linux-x86-64.so.2 caustica` does: then the code of this function is in another file than the process's own.
    fn own_program() -> Option<PathBuf> {
        let program = current_exe().ok()?;
        let own_code = own_program as fn() -> Option<PathBuf> as usize;
        let maps = read_to_string("/proc/self/maps").ok()?;
        let file = maps.lines().find_map(|line| file_at(line, own_code))?;
        (Path::new(file) == program).then_some(program)
    }

    /// The file of a line of `/proc/self/maps`, such as `5555e000-555a0000 r-xp 00000000 08:01 42    /usr/bin/caustica`, if the line is the
    /// one of `address`.
    fn file_at(line: &str, address: usize) -> Option<&str> {
        let (range, _) = line.split_once(' ')?;
        let (start, end) = range.split_once('-')?;
        let limit = |text: &str| usize::from_str_radix(text, 16).ok();
        let has_address = (limit(start)?..limit(end)?).contains(&address);
        has_address.then(|| line.find('/').map(|at| &line[at..]))?
    }

    /// A failed `exec` leaves SIGPIPE at its default, which ends the process when the reader of stderr or stdout has gone. A handler, which
    /// stays after the runtime that installs it, turns that into an error of the write again.
    fn ignore_closed_pipes() {
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_io()
            .build();
        if let Ok(runtime) = runtime {
            runtime.block_on(async {
                let _ = tokio::signal::unix::signal(tokio::signal::unix::SignalKind::pipe());
            });
        }
    }
}
