//! Writes the generated meshes of `scenes/meshes` again: `cargo run --release --example make_teapot [folder]`.

mod meshes;

use std::path::PathBuf;

fn main() -> std::io::Result<()> {
    let folder = std::env::args_os()
        .nth(1)
        .map_or_else(|| PathBuf::from("scenes/meshes"), PathBuf::from);
    std::fs::create_dir_all(&folder)?;
    for (name, text) in meshes::all() {
        let path = folder.join(name);
        std::fs::write(&path, &text)?;
        println!("{}: {} bytes", path.display(), text.len());
    }
    Ok(())
}
