//! Long dispatches in pieces: drivers abort work that runs for seconds, and a running dispatch cannot be cancelled.
//!
//! A piece is a box of workgroups. WebGPU has no base workgroup for a dispatch, so a uniform holds the offset of the piece:
//! [`with_piece_offset`] rewrites the builtins of any entry point to add it. Passes need no change.

use bytemuck::{Pod, Zeroable};

use super::GpuError;
use super::shader::Module;

/// Name of the uniform with the offset of the current piece.
pub const PIECE: &str = "piece_of_dispatch";

/// Longest time that a piece should run, ms. The target is half of it, since the next piece may be more expensive than the last.
pub const LONGEST_MS: f64 = 50.0;

/// Largest ratio of a piece's size to the last one's: the time of few workgroups says little about many.
const GROWTH: f64 = 16.0;

/// Content of the uniform: first workgroup of the piece, and workgroups of the whole dispatch.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct PieceUniform {
    first: [u32; 4],
    all: [u32; 4],
}

/// A box of workgroups of a dispatch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Piece {
    /// Its first workgroup.
    pub first: [u32; 3],
    /// Its workgroups along each axis.
    pub groups: [u32; 3],
}

impl Piece {
    /// The piece after the first `done` workgroups of `all`, with at most `most` of them: whole layers, else whole rows, else a part of a
    /// row. `None` when all are done.
    pub fn after(all: [u32; 3], done: u64, most: u64) -> Option<Self> {
        let [x, y, z] = all.map(u64::from);
        if done >= x * y * z {
            return None;
        }
        let at = [done % x, done / x % y, done / (x * y)];
        let most = most.max(1);
        let groups = if at[0] == 0 && at[1] == 0 && most >= x * y {
            [x, y, (most / (x * y)).min(z - at[2])]
        } else if at[0] == 0 && most >= x {
            [x, (most / x).min(y - at[1]), 1]
        } else {
            [most.min(x - at[0]), 1, 1]
        };
        // No component exceeds that of `all`, so each fits u32.
        let narrow = |v: [u64; 3]| v.map(|v| u32::try_from(v).unwrap_or(u32::MAX));
        Some(Self {
            first: narrow(at),
            groups: narrow(groups),
        })
    }

    /// Number of its workgroups.
    pub fn count(&self) -> u64 {
        self.groups.map(u64::from).iter().product()
    }

    /// The uniform for its entry point.
    pub fn uniform(&self, all: [u32; 3]) -> PieceUniform {
        let wide = |[x, y, z]: [u32; 3]| [x, y, z, 0];
        PieceUniform {
            first: wide(self.first),
            all: wide(all),
        }
    }
}

/// Largest number of workgroups for the piece after one of `groups` workgroups that took `ms`.
pub fn next_size(groups: u64, ms: f64) -> u64 {
    let factor = (0.5 * LONGEST_MS / ms.max(1e-3)).min(GROWTH);
    ((groups as f64 * factor) as u64).max(1)
}

/// The shader text with entry point `entry` rewritten to run in pieces, by means of the uniform [`PIECE`]: `workgroup_id` and
/// `global_invocation_id` count from the start of the whole dispatch, `num_workgroups` is that of the whole dispatch.
///
/// # Errors
/// When `entry` is not there, or its parameters cannot be read.
pub fn with_piece_offset(module: &Module, path: &str, entry: &str) -> Result<String, GpuError> {
    let fault = |message: &str| GpuError::Shader {
        shader: path.to_owned(),
        message: format!("`{entry}` cannot be run in pieces: {message}"),
    };
    let point = module.ir.entry_points.iter().find(|e| e.name == entry);
    let [x, y, z] = point
        .ok_or_else(|| fault("it is not there"))?
        .workgroup_size;
    let globals = module.ir.global_variables.iter();
    let bound = globals.filter_map(|(_, v)| v.binding).map(|b| b.binding);
    let binding = bound.max().map_or(0, |last| last + 1);
    let text = &module.text;
    let opening = format!("fn {entry}(");
    let start = text.find(&opening).ok_or_else(|| fault("no such text"))? + opening.len();
    let body = start
        + text[start..]
            .find('{')
            .ok_or_else(|| fault("it has no body"))?;
    let mut signature = text[start..body].to_owned();
    let mut lines = String::new();
    let per_axis = format!("vec3u({x}u, {y}u, {z}u)");
    for (builtin, value) in [
        ("workgroup_id", format!("PARAMETER + {PIECE}.first")),
        ("num_workgroups", format!("{PIECE}.all")),
        (
            "global_invocation_id",
            format!("PARAMETER + {PIECE}.first * {per_axis}"),
        ),
    ] {
        let attribute = format!("@builtin({builtin})");
        let Some(at) = signature.find(&attribute) else {
            continue;
        };
        let rest = &signature[at + attribute.len()..];
        let (name, _) = rest
            .split_once(':')
            .ok_or_else(|| fault("a parameter has no type"))?;
        let name = name.trim().to_owned();
        let parameter = format!("{name}_in_piece");
        signature = signature.replacen(
            &format!("{attribute} {name}:"),
            &format!("{attribute} {parameter}:"),
            1,
        );
        lines += &format!(" let {name} = {};", value.replace("PARAMETER", &parameter));
    }
    if lines.is_empty() {
        return Err(fault(
            "it reads no builtin with its position in the dispatch",
        ));
    }
    Ok(format!(
        "{}{signature}{{{lines}{}\nstruct PieceOfDispatch {{ first: vec3u, all: vec3u }}\n\
         @group(0) @binding({binding}) var<uniform> {PIECE}: PieceOfDispatch;\n",
        &text[..start],
        &text[body + 1..]
    ))
}
