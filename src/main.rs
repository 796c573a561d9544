//! The `caustica` program; everything is in [`caustica::cli`].

use std::process::ExitCode;

fn main() -> ExitCode {
    caustica::cli::main()
}
