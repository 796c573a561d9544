//! Ripples around obstacles, in steps of time: against exact solutions, their own symmetries, and hard cases.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use caustica::config::Limits;
use caustica::kept::Kept;
use caustica::mesh::{Mesh, obj};
use caustica::physics::constants::GRAVITY_M_PER_S2;
use caustica::physics::oscillator::{Elapsed, Oscillator};
use caustica::scene::{ResolvedScene, RippleDrop, Scene, Walls, Wave};
use caustica::waves::{Surface, slope_lost};
use serde_json::{Value, json};

/// Depth of the water, m: waves run at 0.99 m/s.
const DEPTH_M: f64 = 0.1;

/// A mesh that cuts no water of these tests.
const AWAY: [f64; 3] = [0.0, -50.0, 0.0];

fn speed_m_per_s() -> f64 {
    (GRAVITY_M_PER_S2 * DEPTH_M).sqrt()
}

/// A box around the origin with these sides.
fn block(sides_m: [f64; 3]) -> Arc<Mesh> {
    let [x, y, z] = sides_m.map(|side_m| 0.5 * side_m);
    let mut text = String::new();
    for corner in 0..8 {
        let sign = |bit: u32| if corner >> bit & 1 == 0 { -1.0 } else { 1.0 };
        text += &format!("v {} {} {}\n", sign(0) * x, sign(1) * y, sign(2) * z);
    }
    for [a, b, c, d] in [
        [1, 3, 4, 2],
        [5, 6, 8, 7],
        [1, 2, 6, 5],
        [3, 7, 8, 4],
        [1, 5, 7, 3],
        [2, 4, 8, 6],
    ] {
        text += &format!("f {a} {b} {c}\nf {a} {c} {d}\n");
    }
    Arc::new(obj::read(text.as_bytes(), &[], &Limits::default()).unwrap())
}

/// An upright sheet without thickness from one (x, z) to the next.
fn sheet(corners_m: &[[f64; 2]]) -> Arc<Mesh> {
    let mut text = String::new();
    for [x, z] in corners_m {
        text += &format!("v {x} -1 {z}\nv {x} 1 {z}\n");
    }
    for i in 0..corners_m.len() - 1 {
        let first = 2 * i + 1;
        text += &format!("f {} {} {}\n", first, first + 1, first + 2);
        text += &format!("f {} {} {}\n", first + 1, first + 2, first + 3);
    }
    Arc::new(obj::read(text.as_bytes(), &[], &Limits::default()).unwrap())
}

/// A basin with the fields `waves` in shallow water; its obstacles are `meshes`, each moved by its translation.
struct Basin {
    resolved: ResolvedScene,
}

impl Basin {
    fn new(waves: Value, meshes: &[(Arc<Mesh>, [f64; 3])]) -> Self {
        let mut fields = json!({ "kind": "ripples", "min_m": [-0.5, -0.5], "max_m": [0.5, 0.5], "dispersion": "shallow",
            "obstacles": (0..meshes.len()).collect::<Vec<_>>() });
        let waves = waves.as_object().unwrap().clone();
        fields.as_object_mut().unwrap().extend(waves);
        let objects: Vec<Value> = meshes
            .iter()
            .map(|(mesh, translation_m)| json!({ "mesh": mesh.id, "translation_m": translation_m }))
            .collect();
        let scene: Scene = serde_json::from_value(json!({
            "water": { "waves": [fields] }, "floor": { "depth_m": DEPTH_M, "size_m": [8, 8] }, "objects": objects
        }))
        .unwrap();
        let mut resolved = ResolvedScene::bare(scene);
        resolved.meshes = meshes.iter().map(|(mesh, _)| Arc::clone(mesh)).collect();
        Self { resolved }
    }

    /// Without an obstacle in the water, but computed in steps.
    fn stepped(waves: Value) -> Self {
        Self::new(waves, &[(block([0.1; 3]), AWAY)])
    }

    /// The same without obstacles.
    fn exact(&self) -> Self {
        let mut exact = self.afresh();
        exact.waves_mut().obstacles.clear();
        exact
    }

    /// The same with nothing kept.
    fn afresh(&self) -> Self {
        let mut resolved = self.resolved.clone();
        resolved.kept = Kept::default();
        Self { resolved }
    }

    fn waves_mut(&mut self) -> &mut caustica::scene::Ripples {
        match &mut self.resolved.scene.water.waves[0] {
            Wave::Ripples(waves) => waves,
            other => panic!("{other:?}"),
        }
    }

    fn at(&self, time_s: f64) -> Surface {
        let mut resolved = self.resolved.clone();
        resolved.scene.time_s = time_s;
        Surface::of(&resolved)
    }
}

/// Heights at 101 × 101 even places from `min_m` to `max_m`.
fn sampled(surface: &Surface, min_m: [f64; 2], max_m: [f64; 2]) -> Vec<f64> {
    let place = |axis: usize, i: usize| min_m[axis] + (max_m[axis] - min_m[axis]) * i as f64 / 100.0;
    (0..101 * 101)
        .map(|i| surface.at(place(0, i % 101), place(1, i / 101)).height_m)
        .collect()
}

/// Root of the mean square of the differences in the basin of a metre.
fn difference(a: &Surface, b: &Surface) -> f64 {
    let (a, b) = (sampled(a, [-0.5; 2], [0.5; 2]), sampled(b, [-0.5; 2], [0.5; 2]));
    rms(&a.iter().zip(&b).map(|(a, b)| a - b).collect::<Vec<_>>())
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
}

#[test]
fn probe() {
    for walls in ["reflecting", "periodic", "absorbing"] {
        for damping in [0.0, 0.7, 300.0] {
            for t in [0.0, 0.037, 0.3, 0.711, 2.0] {
                let mut line = String::new();
                for samples in [64, 128, 256] {
                    let basin = Basin::stepped(json!({ "samples": samples, "walls": walls, "damping_per_s": damping, "drops": [
                        { "position_m": [-0.1, 0.2], "radius_m": 0.07, "height_m": 1.0, "at_s": 0 },
                        { "position_m": [0.3, -0.15], "radius_m": 0.08, "height_m": -0.7, "at_s": 0.0311 } ] }));
                    let (a, b) = (basin.at(t), basin.exact().at(t));
                    line += &format!(" {:.2e}", difference(&a, &b));
                    if samples == 256 { line += &format!("   of {:.2e}", rms(&sampled(&b, [-0.5; 2], [0.5; 2]))); }
                }
                println!("{walls} γ {damping} t {t}: {line}");
            }
        }
    }
    // What comes back.
    for (max, pos, radius) in [([0.5, 0.5], [0.0, 0.0], 0.05), ([0.5, 0.5], [0.4, 0.4], 0.03), ([0.5, -0.3], [-0.3, -0.4], 0.04), ([0.5, 0.5], [0.0, 0.3], 0.15)] {
        for samples in [32, 256] {
            let basin = Basin::stepped(json!({ "samples": samples, "max_m": max, "walls": "absorbing", "drops": [
                { "position_m": pos, "radius_m": radius, "height_m": 1.0 } ] }));
            let exact = basin.exact();
            let start = rms(&sampled(&exact.at(0.0), [-0.5; 2], max)).powi(2);
            let mut line = String::new();
            for t in [0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 6.0, 20.0] {
                let a = sampled(&basin.at(t), [-0.5; 2], max);
                let b = sampled(&exact.at(t), [-0.5; 2], max);
                let d: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a - b).collect();
                line += &format!(" {:.1e}/{:.1e}", rms(&d).powi(2) / start, rms(&b).powi(2) / start);
            }
            println!("back {max:?} {pos:?} {radius} n {samples}: {line}");
        }
    }
    let start = std::time::Instant::now();
    let basin = Basin::stepped(json!({ "walls": "absorbing", "drops": [{ "position_m": [0, 0], "radius_m": 0.05, "height_m": 1.0 }] }));
    basin.at(10.0);
    println!("10 s: {:?}", start.elapsed());
    let start = std::time::Instant::now();
    basin.at(10.0 + 1.0 / 30.0);
    println!("next frame: {:?}", start.elapsed());
    let start = std::time::Instant::now();
    basin.exact().at(0.5);
    println!("open water: {:?}", start.elapsed());
}
